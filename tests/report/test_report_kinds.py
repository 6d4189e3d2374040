"""What each kind of result shows, found by its name; every problem file makes a page."""

import io
from dataclasses import replace
from pathlib import Path
from pkgutil import iter_modules

import layout_cases as cases
import pytest
from page_reader import Reader
from rich.console import Console

import gearopt
from gearopt.api import idle_options
from gearopt.optimise.result import Result
from gearopt.report import answer, kinds
from gearopt.report.explained import remedy_words
from gearopt.report.headline import lead
from gearopt.report.kinds import generic, pages_of
from gearopt.report.measures import INCH
from gearopt.report.pages.result import page, sections, tables
from gearopt.report.terminal import show
from gearopt.scenes.reading.kinds import kinds as problem_kinds

FILES = sorted((Path(__file__).parents[2] / "problems").glob("*.toml"))
PROBLEMS = [p for p in FILES if 'status = "evaluated"' not in p.read_text(encoding="utf-8")]


def test_every_module_is_a_kind_of_problem_file():
    assert {m.name for m in iter_modules(kinds.__path__)} - {"generic"} <= set(problem_kinds())


def test_only_a_drive_is_proven_impossible_with_real_valued_teeth():
    rows = {"method": "dual", "conflict": ["span"], "least_violation": 0.5}
    own = Result("bridge", "infeasible", "ipopt", {"name": "mass"}, proof=rows)
    words = "Proof: whatever the design, one of these limits is violated by at least 50 %: span."
    assert answer.proof(own)[0] == words and "teeth" not in " ".join(answer.proof(own))
    drive = answer.proof(replace(own, scene="drive"))
    assert drive[:2] == [words, "This holds even with real-valued teeth and modules."]
    fewer = {"ways_out": {"conflict": ["span"]}}
    more = replace(own, proof=rows | {"conflict": ["span", "height"]}, report=fewer)
    assert "even if all other limits are dropped" in answer.proof(more)[1]


DESIGNED = {  # a file of every kind, which other tests solve too
    "compound": "sandgren_train",
    "drive": "elevator",
    "dynamics": "soft_bearings",
    "epicyclic": "epicyclic_wolfrom",
    "packing": "six_cylinders_row_two_layers",
    "pair": "reference_pair",
    "servo": "servo_axis",
    "strain_wave": "strain_wave_base",
}


@pytest.mark.parametrize("kind", problem_kinds())
def test_a_kind_has_a_drawing_or_says_that_it_has_none(kind, solved):
    """A kind whose designs have no drawing declares `drawn=False` in report/kinds/KIND."""
    assert kind in DESIGNED, f"name a file of kind {kind} in DESIGNED of {__file__}"
    result = solved(DESIGNED[kind])
    drawn = any(section.drawings for section in sections(result))
    assert drawn is pages_of(kind).drawn, f"report/kinds/{kind} draws or declares drawn=False"


@pytest.mark.parametrize("scene", [None, "a_new_kind"])
def test_other_kinds_are_shown_by_what_their_design_holds(scene):
    """Stages as a table and a drawing, the rest by keys with units; the same on the terminal."""
    design = {"stages": cases.drive(cases.ELEVATOR)["stages"], "shift_mm": 1.5, "hubs": [1, 2]}
    result = replace(cases.elevator(), scene=scene, design=design, parts=())
    assert pages_of(scene) is generic.PAGES
    made = {section.heading: section for section in sections(result)}
    assert len(made["Gears with all shafts in one plane"].drawings) == 2
    assert [t.name for t in made["Design"].tables] == ["stages", "totals"]
    out = io.StringIO()
    show(result, Console(file=out, width=99))
    for words in ("face width b [mm]", "shift [mm]", "utilisation, %"):
        assert words in out.getvalue()


def test_a_limit_that_an_unproven_design_does_not_reach_is_not_active(solved):
    proven = solved("elevator")
    low = {n: min(u, 0.97) if n.startswith("k_factor") else u for n, u in proven.limits.items()}
    stopped = replace(proven, status="limit", limits=low)
    assert lead(proven).startswith("the limits on K-factor of stages 1 and 2 determine")
    assert lead(stopped).startswith(
        "in the best design found no limit is active; the closest by utilisation is"
    )


def test_dropping_any_one_is_said_where_it_was_tried():
    ways = {"conflict": ["ratio_low", "span"], "remedies": [], "message": "", "any_resolves": True}
    own = Result("own", "infeasible", "x", {}, scene="drive", report={"ways_out": ways})
    said = (
        "the limits on minimum ratio and span cannot all be met; dropping any one of them makes a "
        "design possible"
    )
    assert lead(own) == said


@pytest.mark.parametrize(
    ("conflict", "said"),
    [
        (
            ["ratio_low"],
            "the limit on minimum ratio cannot be met with what else the file gives, even if all "
            "other limits are dropped",
        ),
        (
            ["ratio_low", "wheel_diameter[1]", "wheel_diameter[2]"],
            "the limits on minimum ratio and wheel diameter of stages 1 and 2 cannot be met "
            "together",
        ),
    ],
)
def test_one_limit_is_not_reported_as_several(conflict, said):
    ways = {"conflict": conflict, "remedies": [], "message": ""}
    own = Result("own", "infeasible", "x", {}, scene="drive", report={"ways_out": ways})
    assert lead(own) == said and remedy_words(ways)[0] == []


@pytest.mark.parametrize(
    ("verified", "label"),
    [
        ({"with_less": "infeasible", "others": "need more"}, "smallest change"),
        ({"with_less": "infeasible", "others": "not all known"}, "smallest found"),
        ({"with_less": "undecided", "others": "need more"}, "smallest found"),
    ],
)
def test_a_change_is_the_smallest_only_where_every_other_is_known_to_need_more(verified, label):
    change = {"key": "limits.span", "write": '"3 m"', "was": '"2 m"', "factor": 1.5}
    way = {"kind": "least", "what": "span", "changes": [change], "bound": None}
    ways = {"conflict": ["span"], "remedies": [way | {"verified": verified}], "message": ""}
    rows, said = remedy_words(ways)
    assert rows[0][0] == label
    assert ("any other limit" in said) is (verified["others"] == "need more")


@pytest.mark.slow
@pytest.mark.parametrize("path", PROBLEMS, ids=lambda p: p.stem)
def test_a_problem_file_makes_a_page(path):
    top = 1 if "top" in idle_options(path, None) else 3
    result = gearopt.solve(path, top=top, budget=gearopt.Budget(1.0))
    again = gearopt.Result.from_json(result.to_json())
    html = page(again, "gearopt solve x.toml")
    words = "".join(Reader(html).text)
    assert result.asked["title"] in words and "What is proven, and how" in words
    assert "None" not in words and "nan" not in words.split()
    assert "What is proven, and how" in page(again, "gearopt solve x.toml", INCH)
    assert all(text.strip() for text in tables(again).values())


@pytest.mark.parametrize("make", [cases.packing, cases.round_packing])
@pytest.mark.parametrize(
    ("clear", "asked", "some"), [(5.08, "0.2 in", True), (5.08, "5 mm", False)]
)
def test_cylinders_at_the_clearance_to_the_walls_are_counted(make, clear, asked, some):
    """Around cylinders that touch the walls, walls 5.08 mm = 0.2 in farther out."""
    near = answer.opening(make())
    assert "cylinders touch the walls" in near
    box = make().design["container"]
    wider = {
        k: v + 2.0 * clear for k, v in box.items() if k in ("diameter_mm", "width_mm", "depth_mm")
    }
    wider |= {k: box[k] - clear for k in ("left_mm", "front_mm")}
    design = make().design | {"container": box | wider}
    found = answer.opening(replace(make(), design=design, asked={"container": {"wall": asked}}))
    count = near.split(" cylinders")[0] if some else near.split(": ")[0] + ": 0 of the "
    assert found.startswith(count) and "at the minimum clearance to the walls" in found


def test_gears_of_several_stages_are_told_apart():
    """Modules and teeth of a row: a stage ends where a semicolon is."""
    stages = [[17, 142], [23, 108]]
    row = {"stages": 2, "status": "optimal", "objective": 1.0, "bound": 1.0, "gap": 0.0}
    row |= {"ratios": [8.353, 4.696], "modules_mm": [2.5, 4.0], "teeth": stages, "seconds": 0.1}
    made = cases.three_stage(report={"counts": [row | {"conflict": []}]})
    assert "2.5, 17/142; 4, 23/108" in page(made, "")
