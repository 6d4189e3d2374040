"""Files are written whole, and never in the place of what a run reads."""

import errno
import os
import stat
from pathlib import Path

import pytest

from gearopt.api import solve
from gearopt.cli.answering import compare
from gearopt.cli.answering import solve as solve_command
from gearopt.cli.reporting import checked, report
from gearopt.cli.writing import Written, check_csv, check_page, write
from gearopt.errors import GearoptError

ELEVATOR = Path(__file__).parents[2] / "problems" / "elevator.toml"


@pytest.fixture
def room(tmp_path, monkeypatch, solved):
    """A folder with a problem file `mine.toml`, links of both sorts to it, and a kept result."""
    (tmp_path / "mine.toml").write_bytes(ELEVATOR.read_bytes())
    (tmp_path / "plain").write_bytes(ELEVATOR.read_bytes())
    (tmp_path / "other.toml").write_bytes(ELEVATOR.read_bytes())
    (tmp_path / "soft.html").symlink_to("mine.toml")
    (tmp_path / "other.html").symlink_to("other.toml")
    os.link(tmp_path / "plain", tmp_path / "hard.html")
    (tmp_path / "tables").mkdir()
    os.link(tmp_path / "plain", tmp_path / "tables" / "stages.csv")
    (tmp_path / "kept.json").write_text(solved("elevator").to_json(), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


PLACES = [
    ("mine.toml", "mine.toml", "which is read"),
    ("mine.toml", "./mine.toml", "which is read"),
    ("mine.toml", "tables/../mine.toml", "which is read"),
    ("mine.toml", "{here}/mine.toml", "which is read"),
    ("mine.toml", "soft.html", "which is read"),
    ("plain", "hard.html", "which is read"),
    ("plain", "plain", "which is read"),
    ("soft.html", "mine.toml", "which is read"),
    ("mine.toml", "new.toml", "problem file"),
    ("mine.toml", "new.TOML", "problem file"),
    ("mine.toml", "other.html", "problem file"),
    ("kept.json", "kept.json", "which is read"),
    ("kept.json", "other.toml", "problem file"),
]


@pytest.mark.parametrize(("given", "place", "said"), PLACES)
def test_a_page_never_replaces_what_is_read(room, given, place, said):
    place = place.format(here=room)
    before = {path: path.read_bytes() for path in room.rglob("*") if path.is_file()}
    call = report if given == "kept.json" else solve_command
    with pytest.raises(GearoptError, match=said) as wrong:
        call(Path(given), html=Path(place))
    assert str(wrong.value).startswith(f"--html {Path(place)}: ") and "\n" not in str(wrong.value)
    if call is solve_command:
        with pytest.raises(GearoptError, match=said):
            compare(Path(given), html=Path(place))
    assert before == {path: path.read_bytes() for path in room.rglob("*") if path.is_file()}


def test_a_page_never_replaces_what_a_kept_result_was_made_of(room):
    (room / "kept.json").write_text(solve("plain").to_json(), encoding="utf-8")
    for place in ("plain", "hard.html"):
        with pytest.raises(GearoptError, match="would replace plain, which is read"):
            report(Path("kept.json"), html=Path(place))
    assert (room / "plain").read_bytes() == ELEVATOR.read_bytes()


@pytest.mark.parametrize("folder", ["tables", "tables/../tables", "{here}/tables"])
def test_tables_never_replace_what_is_read(room, folder):
    folder = Path(folder.format(here=room))
    with pytest.raises(GearoptError, match="would replace plain, which is read"):
        solve_command(Path("plain"), csv=folder)
    with pytest.raises(GearoptError, match="would replace"):
        checked(None, None, folder, "metric", room / "tables" / "stages.csv")
    assert checked(None, None, folder, "metric", Path("mine.toml")).csv == folder


def test_tables_spare_a_problem_file_behind_a_link(room):
    (room / "tables" / "limits.csv").symlink_to(room / "other.toml")
    with pytest.raises(GearoptError, match="problem file"):
        check_csv(Path("tables"), (None, None), Path("mine.toml"))


def test_a_page_and_a_table_are_two_files(room):
    with pytest.raises(GearoptError, match="--csv writes its tables there"):
        check_csv(Path("tables"), (Path("tables/../tables/page.csv"), None))
    check_csv(Path("tables"), (Path("tables/page.html"), None))


def test_a_file_is_written_whole_or_not_at_all(room):
    page = room / "page.html"
    write(Written("--html", page, b"old\n"))
    page.chmod(0o604)
    for data in ("text", 7):
        with pytest.raises(TypeError):
            write(Written("--html", page, data))
        assert page.read_text() == "old\n"
    write(Written("--html", page, b"new\n"))
    assert page.read_text() == "new\n" and stat.S_IMODE(page.stat().st_mode) == 0o604
    assert not [path for path in room.iterdir() if path.name.startswith(".")]


def test_tables_are_written_all_or_none(room, monkeypatch):
    """The disk is full at the second table: the first is as it was, and nothing stays beside."""
    tables = [Path(name) for name in ("a.csv", "b.csv")]
    tables[0].write_text("old")

    def full(self, mode, **given):
        if sum(path.name.startswith(".gearopt-") for path in Path().iterdir()):
            raise OSError(errno.ENOSPC, "No space left on device")
        return plain(self, mode, **given)

    plain = Path.open
    said = "--csv b.csv: No space left on device; nothing was written"
    with monkeypatch.context() as patched, pytest.raises(GearoptError, match=said):
        patched.setattr(Path, "open", full)
        write(*(Written("--csv", path, b"new") for path in tables))
    assert tables[0].read_text() == "old" and not tables[1].exists()
    assert not list(Path().glob(".gearopt-*"))


def test_what_a_killed_run_left_is_removed_by_the_next_one(room):
    """No process has a number beyond 2^22 on Linux; that of the test runs."""
    left, mine = Path(f".gearopt-{2**22 + 1}-ab"), Path(f".gearopt-{os.getpid()}-ab")
    for path in (left, mine):
        path.write_text("half")
    write(Written("--html", Path("page.html"), b"new"))
    assert not left.exists() and mine.exists()


def test_a_link_stays_and_what_it_leads_to_is_written(room):
    (room / "real.html").write_text("old")
    (room / "link.html").symlink_to("real.html")
    check_page("--html", Path("link.html"), Path("mine.toml"))
    write(Written("--html", Path("link.html"), b"new"))
    assert (room / "link.html").is_symlink() and (room / "real.html").read_text() == "new"


def test_a_pipe_is_written_to_as_it_is(room):
    os.mkfifo(room / "pipe")
    reader = os.open(room / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    check_page("--html", Path("pipe"), Path("mine.toml"))
    write(Written("--html", Path("pipe"), b"page"))
    assert os.read(reader, 10) == b"page"
    os.close(reader)


def test_what_the_system_refuses_is_one_message(room):
    (room / "loop.html").symlink_to("loop.html")
    with pytest.raises(GearoptError, match="no folder"):
        check_page("--html", Path("no/such.html"))
    with pytest.raises(GearoptError, match="is a folder"):
        check_page("--html", Path("tables"))
    with pytest.raises(GearoptError, match="--html page.html/x"):
        write(Written("--html", Path("page.html/x"), b"page"))
