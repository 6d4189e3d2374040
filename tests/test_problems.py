"""Every file in problems/ gives the answer it names in its own [x-expected] table."""

import json
import tomllib
from decimal import Decimal
from functools import cache
from pathlib import Path

import pytest

from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.scenes.drive.explain.rated_conflict import conflict
from gearopt.scenes.drive.explain.tried import Case
from gearopt.scenes.reading.load import load

PROBLEMS = sorted((Path(__file__).parents[1] / "problems").glob("*.toml"))
KEYS = {  # of [x-expected], as the tests below read them
    "drive": {
        *("status", "objective", "sizing", "least_factor", "gap", "conflict"),
        *("process_one", "process_two"),
        *(
            "safe",
            "governs",
            "power_capacity_kW",
            "printed",
            "tolerance",
            "digits",
            "within",
            "beside",
        ),
    },
    "packing": {"status", "objective", "tolerance", "bound"},
    "compound": {"status", "objective"},
    "epicyclic": {
        *("status", "objective", "ratio", "efficiency", "torques", "places", "conflict"),
        "least_factor",
    },
    "dynamics": {
        *("status", "objective", "normal_load_N", "deformation_um", "centre_distance_growth_mm"),
        *("pressure_angle_deg", "bearing_force_N", "frequencies_Hz", "unstable_percent"),
        *("dense_maximum_um", "largest_multiplier", "parting_speeds", "rms_um", "peak_to_peak_um"),
        *("maximum_N", "minimum_N", "dynamic_factor"),
    },
    "servo": {
        *("status", "objective", "least_factor", "report"),
    },
    "strain_wave": {
        *("status", "objective", "pairs_in_contact", "equal_pressure_MPa", "shared_pressure_MPa"),
        *("carrying_teeth", "ratcheting_torque_Nm", "straight_deg", "least_clearance_um"),
        "least_radius_mm",
    },
    "pair": {
        *("status", "objective", "contact_ratio", "normal_force_N", "largest_share"),
        *("largest_contact_stress_MPa", "mean_transmission_error_um", "peak_to_peak_um"),
        *("iso_single_stiffness_N_per_mm_um", "iso_mesh_stiffness_N_per_mm_um"),
        *("pinion_diameters_mm", "share_at_ends", "share_beside_single"),
        *("overlap_ratio", "contact_lines_mm", "face_load_factor", "largest_line_load_N_per_mm"),
    },
}
LONG = (
    *(
        "three_stage_by_agma",
        "given_distance",
        "preferred_distance",
        "iso_tr_6336_30_at_distance",
        "wind_pair_at_distance",
        "unit_of_r20",
        "coaxial_unit",
        "helical_unit",
        "elevator_by_both",
        "materials_by_cost",
        "cutting_by_cost",
        "same_materials",
    ),
    "wind_gearbox",
    "relief_two_loads",
    "planetary_or_parallel",
    "idler",
    "planetary_gearhead",
    "planetary_stage",
    "driven_by_transmission_error",
    "planets_that_do_not_fit",
    "elevator_processes_rated",
    "three_stage_by_both",
    "thousand_in_two_stages",
    "three_stage_small_wheels",
    "elevator_small_wheels",
    "elevator_by_agma_small_wheels",
    "servo_gimbal_quick",
    "servo_gimbal_impossible",
    "strain_wave_from_duty",
    "strain_wave_320",
    "strain_wave_half_locus",
    "strain_wave_interferes",
    "strain_wave_discs",
    "strain_wave_modified_involute",
    "least_vibration",
    "least_vibration_parting",
    "unstable_speed",
    "teeth_as_springs",
    "unit_15_kw",
    "unit_15_kw_pair",
    "unit_15_kw_dynamics",
    "light_wheels",
    "wind_pair_sized",
    "servo_gimbal_backlash",
    "servo_gimbal_fine",
    "servo_gimbal_fast",
    "servo_gimbal_light",
    "strain_wave_double_arc",
    "elevator_by_agma",
    "six_stages",
    "five_stages",
    "paper_program",
    "how_many_stages",
    "four_stages",
    "four_stage_box",
    "planetary_box",
    "planetary_or_parallel",
    "three_stage_free_width",
    "three_stage_both_series",
    "three_stage_fine_ratio_coprime",
    "six_cylinders_two_layers",
)
SI = {  # of numbers as a source prints them: their suffix, its value, the suffix of a result
    "_ft_per_min": (0.3048 / 60, "_m_per_s"),
    "_lbf": (0.45359237 * 9.80665, "_N"),
    "_psi": (0.45359237 * 9.80665 / 25.4**2, "_MPa"),
    "_in": (25.4, "_mm"),
    "_N_per_mm_um": (1000.0, "_MPa"),
    "_um": (1e-3, "_mm"),
}
DIGIT = {"objective": 0.06, "sizing": 0.006}  # the values are printed to tenths and hundredths


@cache
def content_of(path):
    return tomllib.loads(path.read_text(encoding="utf-8"))


def case(path):
    """Packings without a proof, gears and box at once, and some ways out take seconds."""
    content = content_of(path)
    long = content["kind"] == "packing" and content["x-expected"]["status"] == "feasible"
    long = long or content.get("layout", {}).get("together", False) or path.stem in LONG
    return pytest.param(path, id=path.stem, marks=[pytest.mark.slow] * long)


HELD = set()  # kinds whose files a test below solves


def of_kind(kind):
    HELD.add(kind)
    return [case(p) for p in PROBLEMS if content_of(p)["kind"] == kind]


@pytest.mark.parametrize("path", of_kind("packing"))
def test_expected_packing(path, solved):
    """tolerance: relative, of the objective; bound: what ours must reach at the least."""
    content = content_of(path)
    expected = content["x-expected"]
    assert content["source"]
    result = solved(path.stem)
    assert result.status == expected["status"]
    assert result.value == pytest.approx(expected["objective"], rel=expected["tolerance"])
    assert expected["bound"] <= result.bound <= result.value
    assert ("not proven" in str(result.report)) == (result.status == "feasible")
    assert result.file == str(path) and len(result.file_sha256) == 64


@pytest.mark.parametrize("path", of_kind("compound"))
def test_expected_compound_train(path, solved):
    expected = content_of(path)["x-expected"]
    result = solved(path.stem)
    assert result.status == expected["status"] and result.gap < 1e-8
    assert result.value == pytest.approx(expected["objective"], rel=1e-9)


@pytest.mark.parametrize("path", of_kind("epicyclic"))
def test_expected_planetary_train(path, solved):
    """torques: from outside over the input's; places: of planets; conflict: of an impossible one.

    Numbers are held to half a unit of the last digit that the file prints.
    """
    text = tomllib.loads(path.read_text(encoding="utf-8"), parse_float=str)
    expected = text["x-expected"]
    result = solved(path.stem)
    assert result.status == expected["status"] and text["source"]
    if "conflict" in expected:
        ways = result.report["ways_out"]
        assert ways["conflict"] == expected["conflict"]
        factors = [way["bound"] or way["factor"] for way in ways["remedies"]]
        assert any(f == pytest.approx(float(expected["least_factor"]), rel=1e-3) for f in factors)
        return
    told = result.design | {"objective": result.value, "places": len(result.design["places"])}
    torques = {member["name"]: member["torque"] for member in result.design["members"]}
    named = {n: (v, told[n]) for n, v in expected.items() if n not in ("status", "torques")}
    named |= {n: (v, torques[n]) for n, v in expected.get("torques", {}).items()}
    for name, (printed, value) in named.items():
        last = Decimal(str(printed)).as_tuple().exponent
        assert value == pytest.approx(float(printed), abs=0.55 * 10.0**last), name


@pytest.mark.parametrize("path", of_kind("servo"))
def test_expected_servo_axis(path, solved):
    """Values are held to half a unit of the last digit that their source prints.

    report: names and values of the result's report, which its JSON holds as they are.
    """
    content = tomllib.loads(path.read_text(encoding="utf-8"), parse_float=str)
    expected = content["x-expected"]
    result = solved(path.stem)
    assert result.status == expected["status"]
    told_in_json = json.loads(result.to_json())["report"]
    told = {
        "objective": lambda: result.value,
        "least_factor": lambda: result.report["ways_out"]["remedies"][0]["bound"],
    }
    named = {name: (expected[name], told[name]()) for name in expected.keys() & told.keys()}
    named |= {name: (v, told_in_json[name]) for name, v in expected.get("report", {}).items()}
    for name, (printed, found) in named.items():
        last = Decimal(printed).as_tuple().exponent
        assert found == pytest.approx(float(printed), abs=0.55 * 10.0**last), name
    assert all(part.status == "optimal" for part in result.parts)
    if result.value is not None:
        assert result.bound <= result.value * (1 + 1e-12) and result.gap < 1e-9
    for remedy in result.report.get("ways_out", {"remedies": ()})["remedies"]:
        assert remedy["verified"]["with"] == "feasible"
        assert remedy["verified"]["with_less"] == "infeasible"


@pytest.mark.parametrize("path", of_kind("pair"))
def test_expected_pair(path, solved):
    """Numbers are held to half a unit of the last digit that the file prints, at its last load."""
    text = tomllib.loads(path.read_text(encoding="utf-8"), parse_float=str)
    expected = text["x-expected"]
    result = solved(path.stem)
    assert result.status == expected.pop("status")
    contact = result.design.get("contact") or result.design["flank"]
    load = contact["loads"][-1]
    told = contact | load | {"objective": result.value}
    if "points" in contact:
        alone = [k for k, share in enumerate(load["share"]) if share == 1.0]
        told["pinion_diameters_mm"] = [point["pinion_diameter_mm"] for point in contact["points"]]
        told["share_at_ends"] = [load["share"][k] for k in (0, -1)]
        told["share_beside_single"] = [load["share"][k] for k in (alone[0] - 1, alone[-1] + 1)]
    if result.value is not None and result.status != "evaluated":
        assert result.bound <= result.value * (1 + 1e-12) and result.gap < 1e-6
    for name, printed in expected.items():
        ending = next((s for s in SI if name.endswith(s)), "")
        unit, ours = SI.get(ending, (1.0, ""))
        found = told[name if ours == "" else name.removesuffix(ending) + ours]
        for value, one in zip(
            *(v if isinstance(v, list) else [v] for v in (found, printed)), strict=True
        ):
            last = 10.0 ** Decimal(str(one)).as_tuple().exponent
            assert value / unit == pytest.approx(float(one), abs=0.55 * last), name


@pytest.mark.parametrize("path", of_kind("strain_wave"))
def test_expected_strain_wave_gearing(path, solved):
    """Numbers are held to half a unit of the last digit that the file prints."""
    text = tomllib.loads(path.read_text(encoding="utf-8"), parse_float=str)
    expected = {k: str(v) for k, v in text["x-expected"].items()}
    result = solved(path.stem)
    assert result.status == expected.pop("status")
    told = result.design | result.design.get("cutter", {}) | {"objective": result.value}
    told["least_clearance_um"] = 1e3 * told["least_clearance_mm"]
    told["least_radius_mm"] = min(told["relative_curvature_mm"])
    for name, printed in expected.items():
        last = 10.0 ** Decimal(printed).as_tuple().exponent
        assert told[name] == pytest.approx(float(printed), abs=0.55 * last), name


@pytest.mark.parametrize("path", of_kind("dynamics"))
def test_expected_motion(path, solved):
    """Numbers are held to half a unit of the last digit that the file prints."""
    text = tomllib.loads(path.read_text(encoding="utf-8"), parse_float=str)
    expected = text["x-expected"]
    result = solved(path.stem)
    assert result.status == expected.pop("status")
    assert (result.value is None) == ("objective" not in expected)
    told = result.design["equilibrium"] | {"objective": result.value}
    for part in ("stability", "chosen"):
        told |= result.design.get(part) or {}
    moved = result.design.get("response", {})
    told |= {n: moved[n] for n in ("rms_mm", "peak_to_peak_mm") if moved}
    told |= moved.get("tooth_load", {})
    for name, printed in expected.items():
        ending = next((s for s in SI if name.endswith(s)), "")
        unit, ours = SI.get(ending, (1.0, ""))
        found = told[name if ours == "" else name.removesuffix(ending) + ours]
        for value, one in zip(
            *(v if isinstance(v, list) else [v] for v in (found, printed)), strict=True
        ):
            last = 10.0 ** Decimal(str(one)).as_tuple().exponent
            assert value / unit == pytest.approx(float(one), abs=0.55 * last), name


@pytest.mark.parametrize("path", of_kind("drive"))
def test_expected_value(path, solved):
    content = content_of(path)
    expected = content["x-expected"]
    assert content["source"]
    result = solved(path.stem)
    assert result.status == expected["status"]
    assert (result.value is None) == ("objective" not in expected)
    if result.value is not None:
        assert result.value == pytest.approx(expected["objective"], abs=DIGIT["objective"])
        assert result.bound <= result.value * (1 + 1e-12)
        assert result.gap <= expected.get("gap", 1e-9)
    if "sizing" in expected:
        part = result.parts[0]
        assert part.name == "sizing" and part.status == "optimal" and part.gap < 1e-9
        assert part.value == pytest.approx(expected["sizing"], abs=DIGIT["sizing"])
    ruled = {p.name.replace(" ", "_"): p for p in result.parts if p.name != "sizing"}
    assert ruled.keys() == expected.keys() & {"process_one", "process_two"} or "layout" in content
    for name in ruled.keys() & expected.keys():
        check_process(ruled[name], expected[name], result)
    if "governs" in expected:
        text = tomllib.loads(path.read_text(encoding="utf-8"), parse_float=str)
        check_rating(result.design["rating"], expected, text["x-expected"].get("printed", {}))
    if "least_factor" in expected:
        ways = result.report["ways_out"]
        assert ways["conflict"] and ways["remedies"][0]["kind"] == "least"
        proven = [way["bound"] for way in ways["remedies"] if way["bound"] is not None]
        assert any(b == pytest.approx(expected["least_factor"], rel=1e-5) for b in proven)
    if "conflict" in expected:
        case = Case(load(path).scene, Clock(Budget(seconds=300.0), None), seconds=60.0)
        assert list(conflict(case).names) == expected["conflict"]
    assert result.file == str(path) and len(result.file_sha256) == 64


def check_rating(rating, expected, printed):
    """What a source prints of the only stage, pinion and wheel or both, within its tolerance.

    tolerance: relative; digits: units of the last printed digit, instead; within: relative, of what
    follows from more digits than are printed.
    """
    assert rating["safe"] == expected["safe"] and rating["governs"] == expected["governs"]
    if "power_capacity_kW" in expected:
        capacity = rating["power_capacity_kW"]
        assert capacity == pytest.approx(expected["power_capacity_kW"], abs=0.006)
    if "beside" in expected:
        check_rating(rating["beside"], expected["beside"], {})
    for name, texts in printed.items():
        ending = next((s for s in SI if name.endswith(s)), "")
        unit, ours = SI.get(ending, (1.0, ""))
        held = [Decimal(text) for text in (texts if isinstance(texts, list) else [texts])]
        found = of_rating(rating, name.removesuffix(ending), ours)[: len(held)]
        for value, one in zip(found, held, strict=True):
            last = 10.0 ** one.as_tuple().exponent
            near = {"abs": expected["digits"] * last} if "digits" in expected else {}
            rel = expected.get("within", {}).get(name, expected.get("tolerance"))
            near = pytest.approx(float(one), **({"rel": rel} if rel else near))
            assert value / unit == near, name


def of_rating(rating, name, ending):
    """A factor, or what gears, teeth or the mesh have by this name."""
    for factor in rating["factors"]:
        if factor["symbol"] == name:
            return [factor["pinion"], factor.get("wheel")]
    rows = next(t for t in ("gears", "teeth", "meshes") if f"{name}{ending}" in rating[t][0])
    return [row[f"{name}{ending}"] for row in rating[rows]]


def check_process(part, expected, best):
    """The gears that a process makes, and its excess over the best."""
    stages = part.design["stages"]
    keys = ("normal_module_mm", "pinion_teeth", "wheel_teeth")
    assert [[s[key] for key in keys] for s in stages] == expected["gears"]
    assert part.status == "feasible" and part.bound == best.bound
    assert part.value == pytest.approx(expected["volume"], abs=DIGIT["objective"])
    assert part.gap == pytest.approx(1 - best.bound / part.value, rel=1e-12)


@pytest.mark.parametrize("path", PROBLEMS, ids=lambda p: p.stem)
def test_every_file_says_what_it_is_held_to(path):
    """A kind that no test above solves, or a key that none reads, would hold a file to nothing."""
    content = content_of(path)
    expected = content["x-expected"]
    assert content["kind"] in HELD, f"no test of this file solves the kind {content['kind']}"
    assert content["title"] and content["source"]
    assert content["kind"] in KEYS, f"KEYS of this file needs the kind {content['kind']}"
    assert expected.keys() <= KEYS[content["kind"]]
    given = {"pair": "contact_ratio", "strain_wave": "pairs_in_contact"}
    given |= {"dynamics": "frequencies_Hz"}
    needed = {
        "infeasible": "least_factor",
        "evaluated": given.get(content["kind"], "governs"),
    }
    needed |= {"infeasible": "conflict"} if "rating" in content else {}
    key = needed.get(expected["status"], "objective")
    assert key in expected, f"[x-expected] of a file that is {expected['status']} needs {key}"


def test_there_are_files():
    assert {"elevator", "three_stage", "six_cylinders"} <= {p.stem for p in PROBLEMS}
