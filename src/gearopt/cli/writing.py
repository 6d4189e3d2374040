"""Output: a standard stream whose reader may leave, and files, whole or not at all."""

import io
import os
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TextIO

from gearopt.errors import GearoptError
from gearopt.frozen import dataclass


class _TolerantOfClosedPipe(io.FileIO):
    """A raw stream that drops what nobody reads; an interface of `io`.

    It has state because a full disk is reported once: what is written after that is dropped.
    """

    refused = False

    def write(self, data: "io.ReadableBuffer") -> int:  # type: ignore[name-defined]
        """Write; GearoptError where the system refuses, unless it is that the reader has left."""
        if not self.refused:
            try:
                return super().write(data)
            except BrokenPipeError:
                self.refused = True
            except OSError as odd:
                self.refused = True
                raise GearoptError(f"the output cannot be written ({odd.strerror})") from odd
        return memoryview(data).nbytes


def tolerant_of_closed_pipe(stream: TextIO) -> TextIO:
    """Return a standard stream that a closed pipe does not disturb; other streams as they are."""
    buffer = getattr(stream, "buffer", None)
    raw = getattr(buffer, "raw", buffer)
    if not isinstance(stream, io.TextIOWrapper) or not isinstance(raw, io.FileIO):
        return stream
    stream.flush()
    return io.TextIOWrapper(
        io.BufferedWriter(_TolerantOfClosedPipe(raw.fileno(), "wb", closefd=False)),
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering or stream.write_through,
    )


BESIDE = ".gearopt-"  # with a process number: files that are being written
PROBLEM, TABLE = ".toml", ".csv"  # endings: of files that are never written, and of tables


def check_page(option: str, path: Path | None, *given: Path) -> None:
    """Raise GearoptError where a page cannot be written, as `check_output` does.

    option: --html or --pdf.
    """
    check_output(path, option, f"page.{option.strip('-')}", *given)


def check_output(path: Path | None, option: str, sample: str, *given: Path) -> None:
    """Raise GearoptError where a file cannot be written, before long work begins.

    sample: a name for it. given: the files that the run reads and those that it writes before. A
    link counts as the file that it leads to.
    """
    if path is None:
        return
    what = f"{option} {path}"
    if path.is_dir():
        raise GearoptError(f"{what}: is a folder; name a file, such as {path / sample}")
    folder = _place(path).parent
    if not folder.is_dir():
        raise GearoptError(f"{what}: there is no folder {folder}")
    plain = path.with_name(f"{path.stem}-{sample}")
    _spare(what, path, given, f"name another file, such as {plain}")
    if _ordinary(path) and not (os.access(folder, os.W_OK) and _writable(path)):
        raise GearoptError(f"{what}: nothing may be written there")


def check_csv(folder: Path | None, pages: Sequence[Path | None], *given: Path) -> None:
    """Raise GearoptError where tables cannot be written, or would replace a file in use.

    pages: of --html and --pdf. The names of the tables are not known before: any file of the
    folder that ends in .csv counts.
    """
    if folder is None:
        return
    whole = _place(folder)
    there = next(path for path in (whole, *whole.parents) if path.exists())
    if not there.is_dir():
        raise GearoptError(f"--csv {folder}: {there} is a file; name a folder for the tables")
    if not os.access(there, os.W_OK):
        raise GearoptError(f"--csv {folder}: nothing may be written into {there}")
    for table in _tables(whole):
        _spare(f"--csv {folder}", table, given, "name another folder")
        if not _writable(table):
            raise GearoptError(f"--csv {folder}: {table} may not be written")
    for page, end in zip(pages, ("html", "pdf"), strict=True):
        if page is not None and _is_table(_place(page)) and _place(page).parent == whole:
            raise GearoptError(f"--{end} {page}: --csv writes its tables there; name a .{end} file")


@dataclass(frozen=True)
class Written:
    """A file that an option names, and its bytes."""

    option: str
    path: Path
    data: bytes


def write(*files: Written) -> None:
    """Write files, all of them or none; GearoptError where the system refuses.

    What a link leads to is replaced, not the link; a pipe or a terminal is written to as it is.
    """
    beside: dict[Path, Path] = {}  # by place
    placed: list[str] = []
    now = files[0] if files else None
    try:
        for now in files:
            if _ordinary(now.path):
                beside[_place(now.path)] = _beside(now)
        for now in files:
            if (draft := beside.get(_place(now.path))) is None:
                now.path.write_bytes(now.data)
            else:
                draft.replace(_place(now.path))
                del beside[_place(now.path)]
            placed.append(str(now.path))
    except OSError as refused:
        assert now is not None
        none = "nothing was written" if len(files) > 1 else ""
        left = f"written were {', '.join(placed)}" if placed else none
        words = "; ".join(filter(None, (refused.strerror, left)))
        raise GearoptError(f"{now.option} {now.path}: {words}") from refused
    finally:
        for draft in beside.values():
            draft.unlink(missing_ok=True)


def _beside(file: Written) -> Path:
    """Return a new file beside the place of another, with its bytes; stale ones are removed."""
    place = _place(file.path)
    for stale in place.parent.glob(f"{BESIDE}*"):
        if not _runs(stale.name.removeprefix(BESIDE).partition("-")[0]):
            stale.unlink(missing_ok=True)
    draft = place.with_name(f"{BESIDE}{os.getpid()}-{os.urandom(4).hex()}")
    try:
        with draft.open("xb") as stream:
            stream.write(file.data)
        if place.exists():
            shutil.copymode(place, draft)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
    return draft


def _runs(number: str) -> bool:
    """Return whether a process runs that has this number; of one that is none, too."""
    if not number.isdecimal() or os.name != "posix":  # signal 0 would end it on Windows
        return True
    try:
        os.kill(int(number), 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


def _spare(what: str, target: Path, given: tuple[Path, ...], instead: str) -> None:
    """Raise GearoptError where a target is a file that the run reads, or a problem file."""
    if (read := next((g for g in given if _same(target, g)), None)) is not None:
        raise GearoptError(f"{what}: would replace {read}, which is read; {instead}")
    if PROBLEM in (target.suffix.lower(), _place(target).suffix.lower()):
        raise GearoptError(f"{what}: a file that ends in .toml is a problem file; {instead}")


def _same(one: Path, other: Path) -> bool:
    """Return whether two paths are one file, in whatever spelling, by links of either sort."""
    if one.exists() and other.exists():
        return one.samefile(other)
    return _place(one) == _place(other)


def _place(path: Path) -> Path:
    """Return where a path leads to; a loop of links is left as it is."""
    return Path(os.path.realpath(path))


def _tables(folder: Path) -> Iterator[Path]:
    return (path for path in folder.iterdir() if _is_table(path)) if folder.is_dir() else iter(())


def _is_table(path: Path) -> bool:
    return path.suffix.lower() == TABLE


def _ordinary(path: Path) -> bool:
    return path.is_file() or not path.exists()


def _writable(path: Path) -> bool:
    return not path.exists() or os.access(path, os.W_OK)
