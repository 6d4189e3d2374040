"""What an answer shows of itself in Python: lines, notebook fragment, page, tables."""

import copy
import csv
import io
import pickle
import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace
from html.parser import HTMLParser
from pathlib import Path

import layout_cases as cases
import pytest
from page_reader import ATTACK, Reader
from rich.console import Console

import gearopt
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.report.terminal import show

ROOT = Path(__file__).parents[2]
ELEVATOR = ROOT / "problems" / "elevator.toml"
CASES = {"packing": cases.packing, "layout": cases.three_stage}
NAMES = (
    *("elevator", "impossible", "sandgren_train", "servo_gimbal_ratio", "packing"),
    *(pytest.param(n, marks=pytest.mark.slow) for n in ("elevator_small_wheels", "layout")),
)


REMEDY = Remedy("one", "", (Change("duty.power", '"9 kW"', '"5 kW"', 1.8),), 1.8, None)


@pytest.fixture(params=NAMES)
def result(request, solved):
    name = request.param
    if name == "impossible":
        return impossible(solved("elevator"))
    return CASES[name]() if name in CASES else solved(name)


def impossible(result):
    """The same request without an answer, and with a way out."""
    ways = {"conflict": ["k_factor[1]"], "message": "", "remedies": [asdict(REMEDY)]}
    proof = {"method": "dual", "sentence": "Proof: made up."}
    return replace(
        result,
        status="infeasible",
        objective=result.objective | {"value": None},
        **dict.fromkeys(("bound", "gap")),
        **dict.fromkeys(("design", "limits", "certificate"), {}),
        parts=(),
        proof=proof,
        report={"ways_out": ways},
        message="no design meets these together: k_factor[1]",
    )


def own(**bounds):
    """Minimise x + y for x y >= 4: both are 2."""
    x, y = (gearopt.Var(n, "mm", *bounds.get(n, (0.5, 9.0)), 3.0, log=True) for n in "xy")

    def evaluate(x, p):
        return gearopt.Terms({"sum": x.x + x.y}, {"area": 4.0 / (x.x * x.y)})

    return gearopt.Problem("corner", (x, y), (), evaluate)


def words(text):
    return re.findall(r"[\w.%/]+", text)


def test_a_result_is_a_few_lines(result):
    shown = repr(result)
    assert 1 <= shown.count("\n") <= 9 and max(map(len, shown.splitlines())) < 310
    assert str(result.asked.get("title") or result.file or result.scene) in shown
    if result.value is None:
        told = "cannot be met together" if "conflict" in result.proof else result.message
        assert "impossible, proven" in shown and told in shown
        assert "possible with " in shown


def test_the_lines_of_a_drive(solved):
    """The teeth are those that brute force and the README have."""
    assert repr(solved("elevator")).splitlines()[:4] == [
        "Two-stage elevator drive: gear volume 5,782.4 cm³, proven optimal",
        "  The limits on K-factor of stages 1 and 2 determine the gear volume; "
        "the ratio error is 63 % of its tolerance of 1 %.",
        "  stage 1: m_n 2 mm, z 21/115",
        "  stage 2: m_n 3 mm, z 23/91",
    ]


def test_the_lines_of_a_problem():
    found = gearopt.solve(own())
    assert repr(found).splitlines()[0] == "corner: sum 4, proven optimal"
    assert repr(found).splitlines()[2] == "  x_mm = 2, y_mm = 2"
    given = gearopt.evaluate(own(), {"x": 1.0, "y": 1.0})
    assert "a limit is exceeded" in repr(given) and "area is violated by 3" in repr(given)
    none = gearopt.solve(own(x=(0.5, 3.0), y=(3.0, 3.0)).at())
    assert "proven" in repr(none) and "2" in none._repr_html_()


class Balanced(HTMLParser):
    """Fails where a tag is not closed by its own end."""

    def __init__(self, html):
        super().__init__()
        self.open = []
        self.feed(html)
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_a_notebook_shows_what_the_terminal_does(result):
    html = result._repr_html_()
    Balanced(html)
    page = Reader(html)
    assert len(html) < 30_000 and not page.scripts and "://" not in html
    console = Console(width=400, record=True, file=io.StringIO())
    show(result, console)
    told = words(re.sub(r"\d+ assumptions?; --.*", "", console.export_text()))  # of the command
    assert len(told) > 20 and set(told) <= set(words(" ".join(page.text)))


def test_a_fragment_has_no_colour_of_its_own(result):
    """So it is read on light and dark: inherited, and shades of the text's colour."""
    colours = re.findall(r"(?:color|background)[\w-]*: ([^;]+);", result._repr_html_())
    assert colours and set(colours) <= {"inherit", "none", "none !important"}


def test_texts_are_escaped(solved):
    found = replace(solved("elevator"), asked={"title": ATTACK})
    assert not Reader(found._repr_html_()).scripts and ATTACK in repr(found)
    assert "<script>alert" not in found.to_html()


def test_the_page_is_that_of_the_command(solved, here, tmp_path, monkeypatch):
    found = solved("elevator")
    (tmp_path / "kept.json").write_text(found.to_json(), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for units in ("metric", "inch"):
        done = here("report", "kept.json", "--units", units, "--html", "page.html")
        assert done.returncode == 0
        assert Path("page.html").read_text(encoding="utf-8") == found.to_html(units=units)
    with pytest.raises(ValueError, match="units='feet': write 'metric' or 'inch'"):
        found.to_html("feet")


def test_tables_are_those_of_the_csv_files(result, here, tmp_path):
    """Every value that a CSV file holds, by its row and column, in full precision."""
    (tmp_path / "kept.json").write_text(result.to_json(), encoding="utf-8")
    here("report", tmp_path / "kept.json", "--csv", tmp_path / "csv")
    files = {p.stem: p for p in (tmp_path / "csv").glob("*.csv")}
    assert set(files) == set(result.tables) and files
    for name in (*result.tables[:3], result.tables[-1]):
        path = files[name]
        kept = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
        rows = result.table(name)
        assert all(len(row) == len(rows[0]) for row in rows)
        texts = sorted(str(v) for row in kept for v in row if v)
        values = [[k for k in rows[0] if k != "name"]]
        values += [[v for v in row.values() if v is not None] for row in rows]
        flat = [str(v) for part in values for v in part if not isinstance(v, list | tuple)]
        assert set(flat) - {""} <= set(texts), name


def test_a_stage_is_a_row(solved):
    found = solved("elevator")
    rows = found.table("stages")
    assert [row["name"] for row in rows] == ["stage 1", "stage 2"]
    for row, stage in zip(rows, found.design["stages"], strict=True):
        assert row["teeth z1"] == stage["pinion_teeth"] and type(row["teeth z1"]) is int
        assert row["reference diameter d2 [mm]"] == stage["wheel_diameter_mm"]
    assert [part["name"] for part in found.table("proof")] == ["drive", "real-valued sizes"]
    assert found.table("proof")[1]["status"] == "proven optimal"
    (totals,) = found.table("totals")
    assert totals["ratio"] == found.design["ratio"]
    inch = found.table("stages", units="inch")
    assert inch[0]["reference diameter d2 [in]"] == pytest.approx(
        rows[0]["reference diameter d2 [mm]"] / 25.4
    )


def test_an_unknown_table_is_told_with_those_there_are(solved):
    with pytest.raises(ValueError, match=r"no table 'stage' \(did you mean 'stages'\?\); tables:"):
        solved("elevator").table("stage")


def test_an_answer_is_copied_kept_and_shown_by_many_threads(solved):
    found = solved("elevator")
    for other in (copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert other == found and repr(other) == repr(found)
    with ThreadPoolExecutor(4) as pool:
        assert len(set(pool.map(lambda k: found._repr_html_(), range(8)))) == 1


def test_an_explanation_shows_itself(solved):
    found = gearopt.explain(own())
    assert "limits reached: area" in repr(found) and repr(found).count("\n") < 8
    Balanced(found._repr_html_())
    way = gearopt.Explanation(
        replace(impossible(solved("elevator")), report={}),
        conflict=("k_factor[1]",),
        remedies=(REMEDY,),
    )
    assert "in conflict: K-factor of stage 1" in repr(way) and 'duty.power = "5 kW"' in repr(way)
    html = way._repr_html_()
    Balanced(html)
    assert "duty.power = &#34;5 kW&#34;" in html


def test_a_comparison_shows_itself():
    found = gearopt.compare(own(), methods=("ipopt",), seeds=1, evaluations=100, seconds=0.1)
    assert repr(found).startswith("corner: methods compared\n") and "ipopt: " in repr(found)
    Balanced(found._repr_html_())
    assert found.to_html().startswith("<!doctype html>")


def test_a_comparison_says_what_was_changed():
    """In its JSON, and in the line that repeats it."""
    changes = {"duty.power": "9 kW"}
    small = {"seeds": 1, "evaluations": 50, "seconds": 0.05}
    found = gearopt.compare(ELEVATOR, changes, methods=["exact"], **small)
    assert found.file == str(ELEVATOR) and dict(found.changes) == changes
    assert gearopt.Comparison.from_json(found.to_json()) == found
    line = f"gearopt.compare({str(ELEVATOR)!r}, {changes!r}, methods=['exact']"
    assert line.replace("'", "&#39;") in found.to_html()


def test_changes_of_a_file_are_told():
    """In the footer, and by the line that makes the page again: no command of the shell does."""
    changes = {"duty.power": "9 kW", "teeth.coprime": True, "source": None}
    html = gearopt.solve(ELEVATOR, changes).to_html()
    assert "…, changed: duty.power = &#34;9 kW&#34;, teeth.coprime = true, no source" in html
    assert f"gearopt.solve({str(ELEVATOR)!r}, {changes!r})".replace("'", "&#39;") in html
