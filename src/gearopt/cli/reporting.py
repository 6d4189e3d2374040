"""`report`: a result that was kept as JSON, shown again; and how every result is written out."""

import json
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from gearopt.cli.app import (
    MORE_OF_FILES,
    Csv,
    Html,
    Pdf,
    Units,
    app,
    console,
    exit_code,
    front_code,
    print_whole,
)
from gearopt.cli.names import result_files
from gearopt.cli.writing import Written, check_csv, check_page, write
from gearopt.errors import GearoptError
from gearopt.frozen import dataclass
from gearopt.optimise.result import Result, loads
from gearopt.report.measures import METRIC, SYSTEMS, Measures
from gearopt.report.pages import pdf as pdf_of
from gearopt.report.pages.title_block import paper
from gearopt.report.words import again
from gearopt.scenes.reading.file_bytes import LARGEST_KEPT, first_bytes

if TYPE_CHECKING:
    from gearopt.optimise.comparing.comparison import Comparison
    from gearopt.optimise.pareto.front import Front

    Kept = Result | Comparison | Front

REASON_LENGTH = 200  # characters shown of what is wrong with a file
HOW = "write one with `gearopt solve FILE --json > result.json`"
HOW_FRONT = "write a front with `gearopt pareto FILE --json > front.json`"


@dataclass(frozen=True)
class Files:
    """Where the page, its PDF and the CSV files of a result go, and in what units."""

    html: Path | None
    pdf: Path | None
    csv: Path | None
    measures: Measures

    @property
    def page(self) -> Path | None:
        """The file that the page names as itself; None where no page is asked for."""
        return self.html or (self.pdf and self.pdf.with_suffix(".html"))


@app.command(rich_help_panel=MORE_OF_FILES)
def report(
    file: Annotated[
        Path,
        typer.Argument(
            help="What `gearopt solve`, `compare` or `pareto` printed with --json.",
            show_default=False,
            autocompletion=result_files,
        ),
    ],
    html: Html = None,
    pdf: Pdf = None,
    csv: Csv = None,
    units: Units = None,
) -> None:
    """Show a kept result, comparison or Pareto front again: on the terminal, as a page, as CSV."""
    from gearopt.optimise.pareto.front import Front

    checked(html, pdf, csv, units or "metric", file)
    kept = _read(file)
    asked = kept.asked if isinstance(kept, Result | Front) else {}
    files = checked(html, pdf, csv, units or asked.get("units", "metric"), file)
    screen = console()
    try:
        with screen.capture() as text, warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            lines = _again(kept, screen, files)
    except GearoptError:
        raise
    except Exception as odd:  # whatever an edited file holds: its reader gets one message
        raise GearoptError(f"{file}: {_fault(odd)}; {HOW}") from odd
    print(text.get(), end="")
    for line in lines:
        print(line)
    if isinstance(kept, Front):
        raise typer.Exit(front_code(kept))
    raise typer.Exit(exit_code(kept) if isinstance(kept, Result) else 0)


def _fault(odd: Exception) -> str:
    """Mistake of a kept result, by the error that showing it met."""
    said = " ".join(str(odd).split())[:REASON_LENGTH]
    if isinstance(odd, UnicodeError):
        return "holds text with half a character (a lone surrogate)"
    if isinstance(odd, ValueError):
        return f"is not a result of gearopt ({said})"
    if isinstance(odd, KeyError):
        return f"lacks the key {said} where it is needed"
    if isinstance(odd, IndexError):
        return "holds a list that is too short"
    if isinstance(odd, ArithmeticError | RuntimeWarning):
        return "holds a number that is zero or too large where it is computed with"
    return "holds a value of the wrong type, or one that no result has"


def _again(kept: "Kept", screen: Console, files: Files) -> list[str]:
    """Show what was kept, write its files (never over its source); return lines about them."""
    from gearopt.optimise.comparing.comparison import Comparison
    from gearopt.optimise.pareto.front import Front

    if kept.file is not None:
        checked(files.html, files.pdf, files.csv, files.measures.name, Path(kept.file))
    if isinstance(kept, Comparison) and files.measures is not METRIC:
        raise GearoptError("--units is not for these; this file holds a comparison")
    _show(kept, screen, files.measures)
    if isinstance(kept, Front):
        return traded(kept, files)
    return written(kept, files) if isinstance(kept, Result) else compared(kept, files)


def _show(found: "Kept", screen: Console, measures: Measures) -> None:
    from gearopt.optimise.pareto.front import Front
    from gearopt.report.terminal import show, show_comparison, show_front

    if isinstance(found, Result):
        show(found, screen, measures)
    elif isinstance(found, Front):
        show_front(found, screen, measures)
    else:
        show_comparison(found, screen)


def answer(found: "Kept", as_json: bool, lines: list[str], measures: Measures = METRIC) -> None:
    """Print an answer as JSON, or show it with lines about what was written."""
    if as_json:
        print_whole(found.to_json())
        return
    _show(found, console(), measures)
    for line in lines:
        print(line)


def compared(found: "Comparison", files: Files) -> list[str]:
    """Write the page and the table of a comparison, once both are made; a line for each."""
    from gearopt.report.pages.comparison import page, tables

    html = "" if files.page is None else page(found, str(files.page))
    return _kept(files, html, {} if files.csv is None else tables(found), {"report": found.head})


def traded(front: "Front", files: Files) -> list[str]:
    """Write the page and the tables of a Pareto front, once all are made; a line for each."""
    from gearopt.report.pages.front import page, tables

    html = "" if files.page is None else page(front, str(files.page), files.measures)
    texts = {} if files.csv is None else tables(front, files.measures)
    return _kept(files, html, texts, front.asked)


def checked(
    html: Path | None, pdf: Path | None, csv: Path | None, units: str, *given: Path
) -> Files:
    """Return where to write; GearoptError for what cannot be, before long work begins.

    given: the files that the run reads, which it never writes.
    """
    check_page("--html", html, *given)
    check_page("--pdf", pdf, *given)
    check_csv(csv, (html, pdf), *given)
    if pdf is not None:
        with _saying(pdf):
            if html is not None and html.resolve() == pdf.resolve():
                raise GearoptError("is the file of --html, too; name a .pdf file")
            pdf_of.browser()
    if units not in SYSTEMS:
        raise GearoptError(f"--units {units}: is not known; write {' or '.join(SYSTEMS)}")
    return Files(html, pdf, csv, SYSTEMS[units])


def written(result: Result, files: Files) -> list[str]:
    """Write the page and the tables, once all are made; return a line for each."""
    if files.page is None and files.csv is None:
        return []
    from gearopt.report.pages.result import page_of, sections, tables_of

    shown, html = sections(result, files.measures), ""
    if files.page is not None:
        html = page_of(
            shown, result, again(result, str(files.page), files.measures), files.measures
        )
    return _kept(files, html, {} if files.csv is None else tables_of(shown), result.asked)


def _kept(files: Files, page: str, found: Mapping[str, str], asked: Mapping[str, Any]) -> list[str]:
    """Write a page, and tables by the names of their files, then the PDF; a line for each."""
    lines, written = [], []
    if files.html is not None:
        written.append(Written("--html", files.html, page.encode()))
        lines.append(f"\nPage: {files.html}")
    if files.csv is not None:
        _make_folder(files.csv)
        paths = {files.csv / name: text for name, text in found.items()}
        # for spreadsheets
        written += [Written("--csv", path, t.encode("utf-8-sig")) for path, t in paths.items()]
        lines.append(f"\nTables: {', '.join(map(str, paths))}")
    write(*written)
    if files.pdf is not None:
        with _saying(files.pdf):
            data = _printed(files, page, paper(asked, files.measures))
        write(Written("--pdf", files.pdf, data))
        lines.append(f"\nPDF: {files.pdf}")
    return lines


def _printed(files: Files, page: str, sheet: str) -> bytes:
    """The PDF of a page; where no browser makes it, the page is kept beside its place."""
    try:
        return pdf_of.printed(page, sheet)
    except GearoptError as wrong:
        if files.html is not None or files.page is None or files.page.exists():
            raise
        write(Written("--pdf", files.page, page.encode()))
        raise GearoptError(f"{wrong}; the page is {files.page}") from wrong


@contextmanager
def _saying(path: Path) -> Iterator[None]:
    """Name the option before what is wrong with a PDF."""
    try:
        yield
    except GearoptError as wrong:
        raise GearoptError(f"--pdf {path}: {wrong}") from wrong


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as refused:
        raise GearoptError(f"--csv {folder}: {refused.strerror}") from refused


def kept_design(file: Path, design: int | None) -> "Front | Result":
    """The result or Pareto front that a file keeps; GearoptError for anything else.

    design: a number is of a front alone, and a front needs one.
    """
    from gearopt.optimise.pareto.front import Front

    kept = _read(file, HOW if design is None else HOW_FRONT)
    if isinstance(kept, Front) and design is None:
        raise GearoptError(f"{file}: is a Pareto front: add --design 1, or another of its designs")
    if isinstance(kept, Front) or (isinstance(kept, Result) and design is None):
        return kept
    what = "result" if design is None else "Pareto front, so --design has none"
    raise GearoptError(f"{file}: is no {what}; {HOW if design is None else HOW_FRONT}")


def _read(file: Path, how: str = HOW) -> "Kept":
    """Result, comparison or front that a file keeps; GearoptError for anything else.

    how: what to write instead.
    """
    from gearopt.optimise.comparing.comparison import Comparison
    from gearopt.optimise.pareto.front import Front

    try:
        text = first_bytes(file, LARGEST_KEPT)
        if len(text) > LARGEST_KEPT:
            raise ValueError(f"is larger than a kept result, at most {LARGEST_KEPT:,} bytes")
        data = loads(text.decode("utf-8-sig"))
        if isinstance(data, dict) and "comparison" in data:
            return Comparison.from_dict(data)
        if isinstance(data, dict) and "front" in data:
            return Front.from_dict(data)
        return Result.from_dict(data)
    except OSError as refused:
        raise GearoptError(f"{file}: cannot be read ({refused.strerror}); {how}") from refused
    except UnicodeDecodeError:
        raise GearoptError(f"{file}: is not UTF-8 text; {how}") from None
    except json.JSONDecodeError as wrong:
        raise GearoptError(
            f"{file}: is not JSON (line {wrong.lineno}: {wrong.msg}); {how}"
        ) from None
    except ValueError as wrong:
        raise GearoptError(f"{file}: {wrong}; {how}") from None
