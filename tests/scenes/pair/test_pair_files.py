"""Files of spur pairs: what they may leave out, what is refused, and what is said instead."""

import copy
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.physics.tooth.ladder import LEVELS, USUAL
from gearopt.scenes.pair import KIND

EXAMPLE = KIND.example.text

GIVEN = tomllib.loads(EXAMPLE)
SIZED = tomllib.loads(KIND.examples["sized-pair"].text)


def with_(tables, edits):
    """Tables with other values by dotted keys; `stage` is the only one; None removes a key."""
    found = copy.deepcopy(tables)
    for key, value in edits.items():
        *path, name = key.split(".")
        place = found
        for part in path:
            place = place.setdefault(part, [{}] if part == "stage" else {})
            place = place[0] if isinstance(place, list) else place
        if value is None:
            del place[name]
        else:
            place[name] = value
    return found


def contact(tables, **edits):
    return gearopt.solve(with_(tables, edits)).design["contact"]


WRONG = [
    ({"stage.pinion_teeth": 8}, r"stage\[1\]\.pinion_teeth = 8: .* contact ratio of 0\.913, below"),
    ({"stage.pinion_teeth": 10, "stage.pinion.profile_shift": 0.8}, "profile_shift = 0.8: .* poin"),
    ({"stage.pinion.bore": "70 mm"}, r'bore = "70 mm": leaves its hub.* Write, for example, bore'),
    ({"gears.bore": "90 mm", "stage.pinion": {}}, r'gears\.bore = "90 mm": leaves its hub, 144 mm'),
    ({"stage.centre_distance": "130 mm"}, 'contact breaks off. Write centre_distance = "112.5 mm"'),
    ({"stage.pinion_teeth": 60}, r"wheel_teeth = 50: is below pinion_teeth.*Exchange"),
    ({"gears.helix_angle": "10 deg", "flank.slices": 3}, r"slices = 3: is too few .*helical gears"),
    ({"flank.slices": 1, "flank.crowning": "5 um"}, r"slices = 1: is too few .*modified along"),
    ({"flank.crowning": "-5 um"}, r"flank\.crowning = .* is below zero"),
    ({"flank.misaligment": "5 um"}, r"flank\.misaligment.*misalignment"),
    ({"flank.crowning": 5}, r"flank\.crowning = 5: is a bare number"),
    (
        {"gears.helix_angle": "10 deg", "relief.shape": "free"},
        r"shape = .* helical gears",
    ),
    ({"flank.crowning": "5 um", "relief.tolerance": "1 um"}, r"tolerance = .* go with \[flank\]"),
    ({"flank.slices": 21, "relief.minimise": "load_jump"}, r"minimise = .*peak_to_peak alone"),
    ({"gears.addendum": 0.5}, r"gears\.addendum = 0\.5: .* contact breaks off.* addendum = 1"),
    ({"stage.module": None}, r"rating: is missing: stage\[1\]\.module is open, and gears that"),
    ({"stage": []}, r"rating: is missing: no table \[\[stage\]\] gives gears"),
    ({"teeth": {}}, "teeth = {}: changes nothing: the gears are given. Remove it"),
    ({"stage.k_factor": "2 MPa"}, r"k_factor = .*changes nothing: the gears are given\. Remove it"),
    ({"gears.treatment": "carburised"}, r"gears\.treatment = .*needs a table \[rating\]"),
    ({"sharing.coupling": "ring"}, 'coupling = "ring": is neither one of .*coupling = "ring tors'),
    ({"sharing.coupling": "0.8 um"}, r"has the unit um of length; units of compliance: um/kN"),
    ({"sharing.coupling": 0.8}, 'needs a unit .* Write coupling = "0.8 um/kN"'),
    (
        {"sharing.level": "profile"},
        r'level = "profile": is not .* Write, for example, level = "profile \+ S',
    ),
    (
        {"stage.pinion": {}, "stage.pinion_teeth": 12, "sharing.level": "Nakada C"},
        r'level = "Nakada C": takes .* pinion are undercut\. Write level = "profile \+ S',
    ),
    ({"sharing.loads": [1, 1]}, r"names a load twice\. Write loads = \[1\.0\]"),
    ({"sharing.loads": []}, r"loads = \[\]: is empty"),
    (
        {"sharing.error": 5},
        r"error = 5: is not greater than 0 and at most 1\. Write error = \"5 %\"",
    ),
    ({"sharing.load": [1]}, r"sharing\.load = .*Write loads, in \[sharing\]"),
    ({"sharing.positions": 3}, "positions = 3: is not a whole number from 12 to 5000"),
    (
        {"stage.face_widht": "3 mm"},
        r"stage\[1\]\.face_widht = .* beside face_width, which may be meant. Remove it",
    ),
    ({"layout": {}}, "layout = .*is not a key here.*kind = .drive. with one"),
]


@pytest.mark.parametrize(("edits", "said"), WRONG, ids=[next(iter(e)) for e, _ in WRONG])
def test_what_is_wrong_is_said_in_one_line_with_what_to_write(edits, said):
    with pytest.raises(SceneError, match=said) as wrong:
        gearopt.load(with_(GIVEN, edits))
    assert "\n" not in str(wrong.value)


def test_what_can_hardly_be_meant_is_said():
    """Steel yields, the gears do not have the ratio; nothing is stiff without load."""
    result = gearopt.solve(with_(GIVEN, {"duty.power": "2000 kW", "duty.ratio": 3}))
    assert (
        "MPa, and hardened steel yields from 4,000 MPa on"
        in result.design["contact"]["validity"][-1]
    )
    assert result.report["notes"] == [
        "The gears have a ratio of 2, 33.3 % below the one asked for."
    ]
    with pytest.raises(SolveError, match="gearopt solve rates a pair"):
        gearopt.rate(GIVEN)


def test_without_a_rim_a_hub_decides_whether_the_bore_has_room():
    wide = {"gears.bore": "45 mm", "gears.hub_over_bore": 1.4, "stage.pinion": {}}
    gearopt.load(with_(GIVEN, wide))
    with pytest.raises(SceneError, match="leaves its hub, 72 mm, no room"):
        gearopt.load(with_(GIVEN, wide | {"gears.hub_over_bore": 1.6}))


def test_a_second_pair_is_a_drive():
    two = GIVEN | {"stage": [*GIVEN["stage"], {}]}
    with pytest.raises(SceneError, match=r'stage\[2\].*is a second pair: kind = "drive" has'):
        gearopt.load(two)


def test_given_gears_need_neither_limits_nor_rating_nor_ratio():
    result = gearopt.solve(GIVEN)
    assert result.status == "evaluated" and result.value is None and result.feasible
    assert "rating" not in result.design
    assert result.design["contact"]["contact_ratio"] == pytest.approx(1.683162262, abs=1e-9)


def test_given_gears_are_rated_where_the_file_asks_for_it():
    rating = {"standard": "agma", "life": "20000 h", "quality": 8}
    tables = with_(GIVEN, {"rating": rating, "gears.treatment": "carburised"})
    result = gearopt.solve(tables)
    assert result.status == "evaluated" and result.design["rating"]["safe"] is False
    drive = gearopt.rate({k: v for k, v in tables.items() if k != "sharing"} | {"kind": "drive"})
    assert result.design["rating"] == drive.design["rating"] and result.limits == drive.limits
    assert result.design["contact"]["loads"][1]["load"] == 1.0


@pytest.mark.slow
def test_duty_and_steel_alone_are_enough_and_the_ranges_left_out_are_usual_ones():
    """The same as a drive with these ranges written out, and the contact of what it finds."""
    result = gearopt.solve(SIZED)
    written = {
        "kind": "drive",
        "stage": [{"face_width_over_diameter": [0.3, 1], "face_width_over_module": [8, 14]}],
        "limits": {"pinion_teeth": [18, 60]},
        "teeth": {"modules": "ISO 54 I"},
    }
    drive = gearopt.solve(SIZED | written)
    assert result.status == "optimal" and result.value == drive.value
    stage = result.design["stages"][0]
    assert stage["pinion_teeth"] == 43 and stage["wheel_teeth"] == 128
    (load,) = result.design["contact"]["loads"]
    radius = 0.5 * stage["pinion_diameter_mm"] * 0.9396926207859084  # cos 20 deg
    assert load["normal_force_N"] * radius == pytest.approx(1e3 * stage["pinion_torque_Nm"])
    held = [words for words in result.report["assumptions"] if "no bore" in words]
    assert len(held) == 2 and "1/3 of its root circle" in held[0]


def test_bores_are_those_of_the_file_and_smaller_ones_give_way_more():
    wide, narrow = (contact(GIVEN, **{"stage.pinion.bore": bore}) for bore in ("35 mm", "20 mm"))
    assert wide["pinion_bore_mm"] == 35.0 and narrow["pinion_bore_mm"] == 20.0
    for stiff, soft in zip(wide["points"], narrow["points"], strict=True):
        assert stiff["pair_stiffness_MPa"] > soft["pair_stiffness_MPa"]


@pytest.mark.parametrize(("width", "plane"), [("18 mm", "strain"), ("17 mm", "stress")])
def test_the_plane_state_follows_from_the_face_width(width, plane):
    assert contact(GIVEN, **{"stage.face_width": width})["plane"] == plane


def test_a_material_of_half_the_modulus_gives_way_about_twice_as_much():
    """The contact's logarithm alone depends on the load, and c' of ISO 6336 is as stiff by half."""
    steel = contact(GIVEN)
    light = contact(GIVEN, **{"gears.elastic_modulus": "103 GPa"})
    ratio = steel["points"][2]["pair_stiffness_MPa"] / light["points"][2]["pair_stiffness_MPa"]
    assert 1.9 < ratio < 2.0
    assert light["iso_single_stiffness_MPa"] == pytest.approx(
        0.5 * steel["iso_single_stiffness_MPa"], rel=1e-12
    )


def test_a_number_for_the_coupling_is_taken_as_it_is():
    found = contact(GIVEN, **{"sharing.coupling": "0.784 um/kN"})
    assert found["coupling"] == "given" and found["coupling_mm_per_N"] == pytest.approx(7.84e-7)


@pytest.mark.parametrize(
    ("edits", "other"),
    [
        ({"sharing.coupling": "5 um/kN"}, ""),
        ({"sharing.coupling": "5 um/kN", "sharing.level": "profile + Sainsot"}, ""),
        ({"sharing.coupling": "784 um/kN", "sharing.level": "Nakada A"}, ""),
        (
            {"sharing.level": "Nakada A", "stage.wheel.bore": "12 mm"},
            ', or level = "profile + Sainsot"',
        ),
    ],
)
def test_a_coupling_beyond_the_compliance_of_a_pair_is_refused(edits, other):
    """A neighbour's load cannot move teeth as far as their own; thin shafts twist a ring far.

    Another model of the teeth is named only where it takes the coupling.
    """
    said = (
        rf'coupling is [\d.]+ um/kN, but .* coupling = "none" or a smaller one{re.escape(other)}$'
    )
    with pytest.raises(SolveError, match=said):
        gearopt.solve(with_(GIVEN, edits))
    if other:
        gearopt.solve(with_(GIVEN, edits | {"sharing.level": USUAL}))


def test_a_model_without_a_ring_beside_a_coupling_by_the_ring_is_said():
    """Nakada's half plane does not turn; Sainsot's ring does."""
    assert (
        'Write coupling = "none"' in contact(GIVEN, **{"sharing.level": "Nakada C"})["validity"][0]
    )
    assert "validity" not in contact(
        GIVEN, **{"sharing.level": "Nakada C", "sharing.coupling": "none"}
    )


def test_a_light_line_load_is_said_to_rest_on_an_unverified_law():
    """17.8 N/mm at a tenth of the example's power, by hand: 2 * 20 N m/(75 mm * 30 mm)."""
    light = gearopt.solve(with_(GIVEN, {"duty.power": "2 kW"})).report["assumptions"]
    assert any("by default it is the finest with a table [relief]" in each for each in light)
    one_model = gearopt.solve(with_(GIVEN, {"sharing.coupling": "none"})).report["assumptions"]
    assert not any("by default it is the finest" in each for each in one_model)
    assert "Unverified" in light[-1] and "here 17.8 N/mm" in light[-1]
    assert not any("Unverified" in each for each in gearopt.solve(GIVEN).report["assumptions"])


def test_a_rim_on_a_web_is_said_to_be_softer():
    """Every model takes a full ring down to the bore."""
    told = {"rim_thickness": "6 mm", "web_thickness": "10 mm", "bore": "50 mm"}
    found = contact(GIVEN, **{"stage.wheel": told})
    assert "wheel has a rim of 2 m_n on a web of 33.3 % of its face" in found["validity"][0]
    del told["rim_thickness"], told["web_thickness"]
    assert (
        found["pair_stiffness_MPa"] == contact(GIVEN, **{"stage.wheel": told})["pair_stiffness_MPa"]
    )


def test_undercut_is_said_and_so_is_a_small_contact_ratio(solved):
    found = solved("undercut_pair").design["contact"]["validity"]
    said = " ".join(found)
    assert (
        "undercut (z = 8" in said
        and "contact ratio that the form circles leave is small, 1.080" in said
    )


@pytest.mark.slow
def test_materials_to_choose_from_have_their_contact_too():
    """The hard one is chosen; half as stiff a one gives way about twice as much."""
    hard = {"name": "hard", "treatment": "carburised"}
    soft = {"name": "soft", "treatment": "through-hardened", "hardness": "200 HB"}
    tables = SIZED | {"gears": {"materials": ["hard", "soft"]}, "material": [hard, soft]}
    result = gearopt.solve(tables)
    stage = result.design["stages"][0]
    assert result.status == "optimal" and stage["pinion_material"] == "hard"
    light = tables | {"material": [hard | {"elastic_modulus": "103 GPa"}, soft]}
    ends = [gearopt.solve(each).design["contact"] for each in (tables, light)]
    steel, other = (end["points"][0]["pair_stiffness_MPa"] for end in ends)
    assert other < 0.9 * steel


@pytest.mark.parametrize("call", ["explain", "compare"])
def test_of_given_gears_nothing_is_chosen(call):
    with pytest.raises(SolveError, match="the gears are given, so that nothing is chosen"):
        getattr(gearopt, call)(GIVEN)
    with pytest.raises(SolveError, match="method exact changes nothing here: the gears are given"):
        gearopt.solve(GIVEN, method="exact")


@pytest.mark.parametrize(("error", "level"), [("20 %", "profile"), ("8 %", "trap")])
def test_the_cheapest_level_is_taken_whose_error_can_be_borne(error, level):
    found = contact(GIVEN, **{"sharing.error": error, "sharing.coupling": "ring torsion"})
    assert found["level"].startswith(level) and max(map(abs, found["error_percent"])) <= 20.0
    with pytest.raises(SceneError, match="error = .*conflicts with level; one is enough"):
        gearopt.load(with_(GIVEN, {"sharing.error": "5 %", "sharing.level": "ISO 6336"}))


def test_a_bore_that_no_model_covers_is_refused():
    for edits in ({}, {"sharing.level": "finite elements"}):
        with pytest.raises(SolveError, match=r"pinion is 6750 times its bore: .*Write a bore of 1"):
            gearopt.solve(GIVEN, {"stage[1].pinion.bore": "0.01 mm"} | edits)


@pytest.mark.parametrize(
    ("level", "at_pitch"),
    [("ISO 6336", 13.309), ("Nakada A as printed", 34.30), ("trapezoid + Sainsot", 13.18)],
)
def test_a_level_is_that_of_its_name(level, at_pitch):
    """N/(mm um) at the pitch point, computed apart from gearopt; the last one as it is here."""
    tables = with_(GIVEN, {"sharing.level": level, "duty.input_speed": "100 rad/s"})
    point = contact(tables)["points"][2]
    assert 1e-3 * point["pair_stiffness_MPa"] == pytest.approx(at_pitch, rel=2e-3)


@pytest.mark.slow
def test_finite_elements_through_the_file():
    """N/(mm um) of five points and the coupling, computed apart from gearopt with other elements.

    The ends of the source lie 0.05 modules inside the path.
    """
    whole = {"sharing.level": "finite elements", "sharing.coupling": "finite elements"}
    found = contact(GIVEN, **whole)
    inner = [1e-3 * row["pair_stiffness_MPa"] for row in found["points"][1:4]]
    assert inner == pytest.approx([12.485, 12.679, 12.615], rel=1e-3)
    assert found["coupling_mm_per_N"] == pytest.approx(4.45e-3 / 5675.6, rel=0.03)
    load = found["loads"][-1]
    assert load["share"][0] == pytest.approx(0.399, abs=0.01)
    assert 1e3 * load["peak_to_peak_mm"] == pytest.approx(4.47, abs=0.25)


def test_an_impossible_duty_is_proven_so_and_has_no_contact():
    result = gearopt.solve(
        with_(SIZED, {"limits": {"pinion_teeth": [18, 60], "wheel_diameter": "90 mm"}}),
        remedies=False,
    )
    assert result.status == "infeasible" and not result.design


def test_the_page_of_the_kind_has_the_errors_of_the_levels():
    page = (Path(__file__).parents[3] / "docs" / "pair.md").read_text(encoding="utf-8")
    rows = re.findall(r"(?m)^\| `([^`]+)`.* \| (\S+) to (\S+) % \| (\S+) µs \|$", page)
    assert len(rows) == 6
    for name, *numbers in rows:
        level = LEVELS[name]
        errors = 100.0 * np.array([*level.error, *level.wider])
        found = [errors.min(), errors.max(), level.cost]
        assert found == pytest.approx([float(n) for n in numbers], rel=5e-3, abs=0.01), name


@pytest.mark.slow
def test_what_couplings_change_is_as_the_page_says():
    """um of the reference pair, whose level is the usual one, and by finite elements alone."""
    problems, found = Path(__file__).parents[3] / "problems", {}
    page = (problems.parent / "docs" / "pair.md").read_text(encoding="utf-8")
    for level in ("profile + Sainsot", "finite elements"):
        for model in ("none", "ring torsion", "finite elements"):
            edits = {"sharing.coupling": model, "sharing.level": level}
            load = gearopt.solve(problems / "reference_pair.toml", edits).design["contact"]["loads"]
            found[level, model] = 1e3 * load[-1]["peak_to_peak_mm"]
    for (level, model), error in found.items():
        if level != "finite elements" or model == level:
            assert f"{error:.1f} µm" in page, (level, model)
    more = found["profile + Sainsot", "ring torsion"] / found["finite elements", model] - 1.0
    assert f"{100.0 * more:.0f} %" in page


def test_finite_elements_are_not_begun_in_a_short_time():
    """They take a second, which no clock divides; other levels have their answer at once."""
    file, short = "problems/relief_two_loads.toml", gearopt.Budget(seconds=0.2)
    level = {"sharing.level": "finite elements"}
    result = gearopt.solve(file, level, budget=short)
    assert result.status == "limit" and not result.design
    assert "allow more time, or write another level" in result.message
    with pytest.raises(gearopt.SolveError, match="allow more time"):
        gearopt.pareto(file, level, objectives="peak_to_peak,harmonics", budget=short)
