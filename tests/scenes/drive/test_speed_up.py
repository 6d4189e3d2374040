"""Drives that increase the speed: the gears of the mirrored reducing drive, to every number."""

import math
import tomllib
from dataclasses import fields
from fractions import Fraction
from pathlib import Path

import pytest
from rated_files import pair, two_stages

import gearopt
from gearopt import units
from gearopt.errors import SceneError, SolveError
from gearopt.report.drawing.train_views import DrawnStage, in_one_line

PROBLEMS = Path(__file__).parents[3] / "problems"
FIRST = {"module": "3 mm", "pinion_teeth": 20, "wheel_teeth": 61, "face_width": "31 mm"}
SECOND = {"module": "4 mm", "pinion_teeth": 18, "wheel_teeth": 67, "face_width": "60 mm"}
RATIO = 61 / 20 * 67 / 18
BOTH = {"standard": "both", "iso6336": {"accuracy_grade": 7}, "oil_viscosity": "40 mPa s"}


def two(stages, speed, **more):
    """The tables of two stages at one power and input speed [rpm]."""
    tables = two_stages(rating=BOTH, duty={"input_speed": f"{speed!r} rpm"} | more)
    return tables | {"gears": tables["gears"] | {"helix_angle": "14 deg"}, "stage": stages}


def rising(stages):
    """Stages in reverse order, driven by their wheels."""
    return [stage | {"driver": "wheel"} for stage in reversed(stages)]


def numbers(rating, stages=0):
    """Numbers of a rating by their rows, magnitudes; stages: so many, counted from the output."""
    every = {}
    for name in ("gears", "meshes", "factors", "shafts", "teeth"):
        for row in rating[name]:
            at = row.get("stage", row.get("shaft"))
            last = stages + ("shaft" in row) + 1
            place = name, last - at if stages else at, row.get("member"), row.get("symbol")
            keys = set(row) - {"stage", "shaft"}
            every |= {(*place, k): abs(row[k]) for k in keys if isinstance(row[k], float)}
    return every


def test_the_same_gears_driven_from_the_other_end():
    """At one power torques, speeds, forces, stresses, cycles and factors are the same."""
    forth = gearopt.rate(two([FIRST, SECOND], 1450.0)).design
    back = gearopt.rate(two(rising([FIRST, SECOND]), 1450.0 / RATIO)).design
    for one, other in zip(
        (forth["rating"], forth["rating"]["beside"]),
        (back["rating"], back["rating"]["beside"]),
        strict=True,
    ):
        assert len(numbers(one)) > 150
        assert numbers(other, 2) == pytest.approx(numbers(one), rel=1e-12)
    assert back["ratio"] * forth["ratio"] == pytest.approx(1.0, rel=1e-14)
    power = back["output_torque_Nm"] * 1450.0 * math.pi / 30
    assert power == pytest.approx(7500.0, rel=1e-12)
    assert [stage["driver"] for stage in back["stages"]] == ["wheel", "wheel"]


def test_a_ratio_below_1_says_that_wheels_drive():
    """Asked by either key, without `driver`; a pinion that drives instead is off the ratio."""
    bare = [SECOND, FIRST]
    told = gearopt.rate(two(rising(bare[::-1]), 100.0)).design["rating"]
    for asked in ({"ratio": "360/4087"}, {"output_speed": f"{100.0 * RATIO!r} rpm"}):
        assert gearopt.rate(two(bare, 100.0, **asked)).design["rating"] == told
    off = gearopt.rate(two([s | {"driver": "pinion"} for s in bare], 100.0, ratio="360/4087"))
    assert any("above the one asked for" in flaw for flaw in off.design["rating"]["flaws"])


def test_one_stage_up_and_one_down():
    """A layshaft of 1:1: the last shaft turns as the first one; thrusts of the layshaft cancel."""
    stages = [FIRST | {"helix_angle": "14 deg"}, FIRST | {"helix_angle": "14 deg"}]
    stages[1] |= {"driver": "wheel"}
    design = gearopt.rate(two(stages, 1450.0)).design
    shafts = design["rating"]["shafts"]
    assert design["ratio"] == pytest.approx(1.0, rel=1e-14)
    assert [s["speed_rpm"] for s in shafts] == pytest.approx([1450.0, 1450.0 * 20 / 61, 1450.0])
    assert shafts[1]["axial_force_N"] == pytest.approx(0.0, abs=1e-9)
    first, *_, last = design["rating"]["gears"]
    assert [g["cycles"] for g in (first, last)] == pytest.approx([1.74e9, 1.74e9 * 20 / 61])


def test_what_drives_is_told():
    page = gearopt.rate(two(rising([FIRST]), 500.0)).to_html()
    assert "driving gear" in page and "turns anticlockwise and is driven" in page
    assert "driving gear" not in gearopt.rate(two([FIRST], 500.0)).to_html()


@pytest.mark.parametrize(
    ("stage", "words"),
    [
        ({"pinion_teeth": 61, "wheel_teeth": 20}, 'driver = "wheel" says that the other one'),
        ({"driver": "gear"}, '"wheel"'),
    ],
)
def test_wrong_files(stage, words):
    with pytest.raises(SceneError, match=words):
        gearopt.rate(pair(**stage))


def test_gears_that_are_chosen_have_no_driver():
    limits = {"pinion_teeth": [17, 30]}
    tables = pair(duty={"ratio": 3}, driver="wheel") | {"limits": limits, "teeth": {}}
    with pytest.raises(SceneError, match="chosen ones follow the ratio"):
        gearopt.solve(tables)


SIZED = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "7.5 kW", "input_speed": "120 rpm", "ratio": "1/12", "ratio_tolerance": 0},
    "stage": [{}, {}],
    "gears": {"face_width_over_diameter": [0.3, 0.8], "treatment": "carburised"},
    "limits": {"pinion_teeth": [20, 24]},
    "teeth": {},
    "rating": {"life": "20000 h", "quality": 9},
}


def sized(duty=None, limits=None, **more):
    """The tables of a drive whose wheels drive, with keys of its tables changed."""
    both = {"duty": SIZED["duty"] | (duty or {}), "limits": SIZED["limits"] | (limits or {})}
    return SIZED | both | more


def by_loads(duty=None, limits=None, **more):
    """The same, limited by K-factor and unit load."""
    loads = {"k_factor": "2.07 MPa", "unit_load": "48 MPa"} | (limits or {})
    gears = {"face_width_over_diameter": [0.3, 0.8]}
    tables = sized(duty, loads, gears=gears, **more)
    return {name: table for name, table in tables.items() if name != "rating"}


def test_the_answer_is_that_of_the_mirrored_file():
    """One drive written both ways: every float of the design, the stages in reverse order."""
    back = gearopt.solve(sized()).design
    forth = gearopt.solve(sized({"ratio": 12, "input_speed": "1440 rpm"})).design
    for one, other in zip(forth["stages"], reversed(back["stages"]), strict=True):
        assert other.pop("driver") == "wheel"
        assert other.pop("pinion_material", "") == one.pop("pinion_material", "")
        assert other == pytest.approx(one, rel=1e-12)
    assert numbers(back["rating"], 2) == pytest.approx(numbers(forth["rating"]), rel=1e-12)
    assert back["gear_volume_mm3"] == pytest.approx(forth["gear_volume_mm3"], rel=1e-12)
    assert back["total_length_mm"] == pytest.approx(forth["total_length_mm"], rel=1e-12)


def test_what_was_sized_is_rated_the_same():
    """`gearopt rate` of the teeth, modules and widths that the search chose."""
    found = gearopt.solve(sized({"ratio_tolerance": 0.02})).design
    stages = [
        {
            "module": f"{s['normal_module_mm']!r} mm",
            "pinion_teeth": s["pinion_teeth"],
            "wheel_teeth": s["wheel_teeth"],
            "face_width": f"{s['face_width_mm']!r} mm",
            "driver": "wheel",
        }
        for s in found["stages"]
    ]
    duty = {k: v for k, v in SIZED["duty"].items() if not k.startswith("ratio")}
    bare = {k: v for k, v in SIZED.items() if k not in ("limits", "teeth")}
    rated = gearopt.rate(bare | {"duty": duty, "stage": stages}).design["rating"]
    assert numbers(rated) == pytest.approx(numbers(found["rating"]), rel=1e-12)


@pytest.mark.slow
def test_an_impossible_file_is_explained_by_its_own_keys():
    """The first stage has the large torque; what is written makes the file possible."""
    limits = {"module": ["1 mm", "3 mm"]}
    stages = [{"wheel_diameter": "150 mm"}, {}]
    tables = by_loads({"ratio_tolerance": 0.01}, limits, stage=stages)
    why = gearopt.explain(tables)
    assert why.result.status == "infeasible" and "wheel_diameter[1]" in why.conflict
    keys = {"stage[1].wheel_diameter", "duty.power", "stage[1].face_width_over_diameter"}
    assert keys <= {c.key for way in why.remedies for c in way.changes}
    (one,) = (w.changes[0] for w in why.remedies if w.changes[0].key == "stage[1].wheel_diameter")
    written = one.write.strip('"')
    assert gearopt.solve(tables, {"stage[1].wheel_diameter": written}).status == "optimal"
    less = f"{float(written.split()[0]) * 0.999:.3f} mm"
    assert gearopt.solve(tables, {"stage[1].wheel_diameter": less}).status == "infeasible"


@pytest.mark.slow
def test_the_end_of_the_ratio_is_that_of_input_over_output_speed():
    """71 70/(20 21): the ratio 0.0845 lies above 1/12 (1 + 0.2 %)."""
    stages = [{"pinion_teeth": 21, "wheel_teeth": 70}, {"pinion_teeth": 20, "wheel_teeth": 71}]
    why = gearopt.explain(by_loads({"ratio_tolerance": 0.002}, stage=stages))
    assert "ratio_high" in why.conflict and "ratio_low" not in why.conflict
    ways = {c.key: c.write for way in why.remedies for c in way.changes}
    assert float(ways["duty.ratio"]) == pytest.approx(420 / 4970, rel=1e-4)
    percent = float(ways["duty.ratio_tolerance"].strip('"% '))
    assert percent == pytest.approx(100 * (420 / 4970 * 12 - 1), rel=1e-4)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"layout": {"shaft_stress": "40 MPa"}}, "layout = .* is for drives that reduce the speed"),
        ({"process_one": {"stage_ratios": [3, 4]}}, "process_one = .* is for drives that reduce"),
    ],
)
def test_what_is_for_reducing_drives_is_refused(more, words):
    with pytest.raises(SceneError, match=words):
        gearopt.solve(by_loads(**more))
    with pytest.raises(SceneError, match="ratio_tolerance lets this one increase it"):
        gearopt.solve(by_loads({"ratio": 1, "ratio_tolerance": 0.01}, **more))


def test_real_valued_gears_by_ratings_need_pinions_that_drive():
    tables = sized()
    del tables["teeth"]
    with pytest.raises(SolveError, match=r"ratios that may be below 1 .* write a table \[teeth\]"):
        gearopt.solve(tables)


@pytest.mark.slow
def test_both_sides_of_1_are_told():
    tables = sized({"ratio": 1, "ratio_tolerance": 0.05}, stage=[{}], teeth={"coprime": True})
    result = gearopt.solve(tables, top=12)
    assert "in turn" in result.proof["sentence"]
    assert any("both were searched" in line for line in result.report["assumptions"])
    ratios = [train["ratio"] for train in result.report["trains"]]
    down = [z / (z + 1) for z in range(20, 25)]
    assert sorted(ratios) == pytest.approx(sorted([*down, *(1 / i for i in down)]), rel=1e-12)
    values = [train["objective"] for train in result.report["trains"]]
    assert values == sorted(values) and values[0] == pytest.approx(result.value, rel=1e-12)
    front = gearopt.pareto(tables, objectives=["gear_volume", "total_length"])
    assert front.status == "complete"
    assert min(p.values[0] for p in front.points) == pytest.approx(result.value, rel=1e-12)


def test_the_drawing_begins_with_the_gear_that_drives():
    design = gearopt.rate(two(rising([FIRST, SECOND]), 100.0)).design
    picked = [
        DrawnStage(**{f.name: s[f.name] for f in fields(DrawnStage) if f.name in s})
        for s in design["stages"]
    ]
    train, _ = in_one_line(picked)
    names = [[g.name for g in train.gears if g.shaft == k] for k in (1, 2, 3)]
    assert names == [["wheel 1"], ["pinion 1", "wheel 2"], ["pinion 2"]]


FILES = ("given_distance", "materials_by_cost", "light_wheels", "coaxial_unit", "unit_of_r20")


@pytest.mark.slow
@pytest.mark.parametrize("name", [*FILES, "elevator_by_both", "three_stage_by_agma"])
def test_problem_files_written_both_ways(name):
    """At the ratio of its best teeth, exactly: the mirrored file has the best drive mirrored."""
    content = tomllib.loads((PROBLEMS / f"{name}.toml").read_text(encoding="utf-8"))
    content = {k: v for k, v in content.items() if k not in ("layout", "place", "process_one")}
    best = gearopt.solve(content).design["stages"]
    ratio = math.prod(Fraction(s["wheel_teeth"], s["pinion_teeth"]) for s in best)
    duty = {k: v for k, v in content["duty"].items() if k not in ("output_speed", "ratio")}
    duty |= {"ratio": str(ratio), "ratio_tolerance": 0}
    forth = gearopt.solve(content | {"duty": duty})
    speed = units.parse(duty["input_speed"], "speed")
    slow = f"{float(speed.number / ratio)!r} {speed.unit}"
    more = {"duty": duty | {"ratio": str(1 / ratio), "input_speed": slow}}
    more |= {"stage": content["stage"][::-1]} if "stage" in content else {}
    back = gearopt.solve(content | more)
    assert back.status == forth.status == "optimal"
    assert back.value == pytest.approx(forth.value, rel=1e-10)
    teeth = [
        [(s["pinion_teeth"], s["wheel_teeth"]) for s in result.design["stages"]]
        for result in (forth, back)
    ]
    assert teeth[0] == teeth[1][::-1]
