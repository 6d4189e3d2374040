"""Gears that are chosen at given centre distances: shifts follow; against looking at all pairs."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.drive.teeth import rated
from gearopt.formulations.drive.teeth.tables import stage_tables
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import (
    active_root_diameters,
    contact_path,
    specific_sliding,
)
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.profile_shift import Meshing, equal_sliding
from gearopt.physics.geometry.tooth import tip_thickness
from gearopt.scenes.reading.load import load

PAIR = """
gearopt = 1
kind = "drive"
[duty]
power = "15 kW"
input_speed = "1480 rpm"
ratio = 4
ratio_tolerance = "3 %"
[gears]
helix_angle = "12 deg"
treatment = "carburised"
grade = 2
iso_material = "Eh"
iso_quality = "MQ"
flank_rz = "4.8 um"
root_rz = "20 um"
face_width_over_diameter = [0.3, 1.0]
[[stage]]
centre_distance = "125 mm"
[limits]
pinion_teeth = [14, 40]
[teeth]
[rating]
standard = "both"
life = "20000 h"
quality = 10
overload_factor = 1.25
mounting = "precision"
minimum_bending_safety = 1.4
minimum_contact_safety = 1.1
oil_viscosity = "40 mPa s"
[rating.iso6336]
accuracy_grade = 6
oil_grade = "220 mm^2/s"
helix_modification = "helix corrected"
"""
SAFETY = 1.4, 1.1
TWO = PAIR.replace("ratio = 4", "ratio = 14").replace(
    '[[stage]]\ncentre_distance = "125 mm"',
    '[[stage]]\ncentre_distance = "100 mm"\n[[stage]]\ncentre_distance = "160 mm"',
)


def written(tmp_path, text):
    path = tmp_path / "pair.toml"
    path.write_text(text)
    return path


def possible(train, k, module, z1, z2, limits, shift=None):
    """The pair of a distance where it keeps the limits; else None. shift: x1, else the rule's."""
    cut = train.stages[k].toothing
    numbers = cut.helix_angle, cut.racks
    made = Meshing(module, (z1, z2), *numbers, cut.working_distance)
    if not -1.0 <= made.shift_sum <= 2.0:
        return None
    x1 = float(equal_sliding(made)) if shift is None else shift
    shifts = x1, float(made.shift_sum) - x1
    bare = GearPair.of_teeth(module, z1, z2, 1.0, *(numbers[0], cut.racks[0]), shifts)
    shorter = float(made.tip_alteration)
    cut_gears = [
        replace(g, tip_alteration=shorter, body_diameter=g.reference_diameter + 2.0 * x * module)
        for g, x in zip(bare.gears, shifts, strict=True)
    ]
    pair = GearPair(*cut_gears, cut.working_distance)
    path = contact_path(pair)
    slides = [specific_sliding(path, z2 / z1, s)[i] for i, s in ((0, path.start), (1, path.end))]
    sharp, contact, sliding = limits
    thin = min(float(tip_thickness(g)) for g in pair.gears)
    rack, sine = cut.racks[0], np.sin(pair.pinion.transverse_pressure_angle)
    straight = rack.dedendum - rack.tip_radius * (1.0 - np.sin(rack.pressure_angle))
    rows = zip((z1, z2), shifts, strict=True)
    deep = max(straight - x - z * sine**2 / np.cos(numbers[0]) / 2.0 for z, x in rows)
    good = thin >= sharp * module and path.transverse_ratio >= contact and deep <= 0.01
    starts = zip(active_root_diameters(pair), pair.gears, strict=True)
    good &= all(lowest >= form_diameter(gear) for lowest, gear in starts)
    return pair if good and min(slides) >= -sliding else None


def narrowest(train, k, pair, torque):
    """The least width that carries a torque: on a hundred widths, and between two of them again.

    Wider than 20 and 40 mm a gear has larger deviations, and may carry less.
    """
    face, d = train.stages[k].face_width, float(pair.pinion.reference_diameter)
    option, low, high = train.stages[k].options[0], float(face.low) * d, float(face.high) * d
    for _ in range(5):
        widths = np.unique([*np.linspace(low, high, 100), *np.clip((20.0, 40.0), low, high)])
        rows = option.utilisations(pair.of_width(widths), torque, train.speed_at(torque), SAFETY)
        good = np.flatnonzero(np.maximum.reduce(np.broadcast_arrays(*rows.values())) <= 1.0)
        if not len(good):
            return np.inf
        if good[0] == 0:
            return low
        low, high = widths[good[0] - 1], widths[good[0]]
    return high


def shares(train, k, torque, ratios, limits=(0.2, 1.1, 3.0), shift=None):
    """Volume and teeth of every pair of a stage that carries, of ratios between two."""
    for module in map(float, train.stages[k].modules):
        low, high = train.stages[k].pinion_teeth
        for z1 in range(low, high + 1):
            first, last = int(np.ceil(ratios[0] * z1)), int(np.floor(ratios[1] * z1))
            for z2 in range(first, last + 1):
                pair = possible(train, k, module, z1, z2, limits, shift)
                if pair is not None:
                    width = narrowest(train, k, pair, torque)
                    yield float(pair.of_width(width).volume), module, z1, z2


@pytest.mark.parametrize(
    "limits", [(0.2, 1.3, 3.0), pytest.param((0.2, 1.1, 2.0), marks=pytest.mark.slow)]
)
def test_the_best_pair_of_a_distance_is_that_of_all_pairs(limits, tmp_path, monkeypatch):
    """And of every pair its best module, whether they are tried at once or one by one.

    Between modules that the limits allow and those that no shifts fit some are not allowed: cheaper
    ones, too.
    """
    modules = '[teeth]\nmodules = ["3.4 mm", "3.5 mm", "3.55 mm", "3.6 mm", "3.75 mm"]\n'
    modules += f"[shift]\ncontact_ratio = {limits[1]}\nspecific_sliding = {limits[2]}"
    path = written(tmp_path, PAIR.replace("[14, 40]", "[13, 14]").replace("[teeth]", modules))
    train = load(path).scene.train()
    ratios = float(train.lowest_ratio), float(train.highest_ratio)
    every = sorted(shares(train, 0, train.torque, ratios, limits), reverse=True)
    least = {(z1, z2): value for value, _, z1, z2 in every}
    (own,) = stage_tables(train, train.highest_ratio)
    pairs = [*zip(own.z1, own.z2, strict=True)]
    assert len(every) > len(least) and set(pairs) == set(least)
    torque, index = np.full(len(pairs), train.torque), np.arange(len(pairs))
    expected = pytest.approx([least[pair] for pair in pairs], rel=1e-9)
    assert own.cost(torque, index) == expected
    result, best = gearopt.solve(path), every[-1]
    stage = result.design["stages"][0]
    assert result.status == "optimal"
    assert result.value == pytest.approx(best[0], rel=1e-9)
    found = stage["normal_module_mm"], stage["pinion_teeth"], stage["wheel_teeth"]
    assert found == best[1:]
    assert stage["centre_distance_mm"] == 125.0
    assert result.design["gear_volume_mm3"] == pytest.approx(result.value, rel=1e-12)
    monkeypatch.setattr(rated, "AT_ONCE", 1)
    light = own.of(replace(train, objective="mass", density=1e-9))
    assert 1e6 * light.cost(torque, index) == expected  # kg
    small, large = (own.made(own.modules[end], index) for end in (own.first, own.last))
    width = np.full(len(pairs), 20.0)
    assert (light._floor(small, width) <= light._worth(large, width, 0)).all()


@pytest.mark.slow
def test_the_best_train_of_two_distances_is_that_of_all_pairs(tmp_path):
    path = written(tmp_path, TWO.replace("[14, 40]", "[18, 20]"))
    train = load(path).scene.train()
    low, high = float(train.lowest_ratio), float(train.highest_ratio)
    best = np.inf
    firsts = {}
    for value, module, z1, z2 in shares(train, 0, train.torque, (1.0, 9.0)):
        u = Fraction(z2, z1)
        if np.isfinite(value) and value < firsts.get(u, (np.inf,))[0]:
            firsts[u] = value, module, z1, z2
    for u, (value, *_) in sorted(firsts.items(), key=lambda row: row[1][0]):
        if value < best:
            rest = shares(train, 1, train.torque * float(u), (low / float(u), high / float(u)))
            best = min(best, value + min((row[0] for row in rest), default=np.inf))
    result = gearopt.solve(path)
    assert result.status == "optimal" and result.value == pytest.approx(best, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (PAIR.replace("[teeth]\n", ""), "stage[1].centre_distance.*a table [teeth]"),
        (PAIR.replace("[limits]", '[limits]\nk_factor = "2 MPa"\nunit_load = "48 MPa"'), "alone"),
        (PAIR + "[shift]\nrule = 'best'\n", "shift.rule"),
        (PAIR + "[shift]\nx1 = 0.3\n", "Write pinion_shift, in [shift]"),
        (PAIR.replace("125 mm", "R 20"), 'none of the series R10.*Write centre_distance = "R20"'),
        (PAIR.replace("125 mm", "R5"), 'Write, for example, centre_distance = "R20"'),
        (PAIR.replace("[limits]", "[stage.wheel]\nprofile_shift = 0.1\n[limits]"), "follows from"),
        (PAIR.replace('centre_distance = "125 mm"', "") + "[shift]\n", "shift.*changes nothing"),
    ],
)
def test_what_does_not_go_with_a_given_distance_is_refused(tmp_path, text, words):
    with pytest.raises(SceneError) as refusal:
        load(written(tmp_path, text))
    parts = words.split(".*")
    assert all(part in str(refusal.value) for part in parts)


@pytest.mark.slow
def test_a_distance_at_which_nothing_carries_is_proven_impossible(tmp_path):
    file = written(tmp_path, PAIR.replace("125 mm", "60 mm"))
    explained = gearopt.explain(file)
    assert explained.result.status == "infeasible" and not explained.result.message
    assert "centre_distance[1]" in explained.conflict
    nearest = next(r for r in explained.remedies if r.what == "stage[1].centre_distance")
    assert gearopt.solve(file, nearest.edits, remedies=False).status == "optimal"


def test_a_distance_that_no_teeth_fit_is_named(tmp_path):
    result = gearopt.solve(written(tmp_path, PAIR.replace("125 mm", "20 mm")), remedies=False)
    assert result.status == "infeasible"
    assert "No teeth fit the centre distance of 20 mm of stage 1" in result.message


@pytest.mark.slow
@pytest.mark.parametrize(
    ("table", "key"),
    [
        ("[shift]\nspecific_sliding = 0.2\n", "shift.specific_sliding"),
        ("[shift]\ncontact_ratio = 2.2\n", "shift.contact_ratio"),
        ("[limits]\nwheel_teeth = [20, 40]\n", "limits.wheel_teeth[2]"),
    ],
)
def test_what_teeth_at_a_distance_may_be_is_explained(tmp_path, table, key):
    text = PAIR.replace("[limits]\n", table) if table[1] == "l" else PAIR + table
    explained = gearopt.explain(file := written(tmp_path, text))
    named = {name.split("[")[0].removesuffix("_high") for name in explained.conflict}
    of_numbers = key == "limits.wheel_teeth[2]"  # 40 teeth are too few for 14, at any distance
    needed = set() if of_numbers else {"centre_distance"}
    assert named == needed | {key.split(".")[1].split("[")[0]}
    nearest = explained.remedies[0]
    assert nearest.what == key and nearest.kind == "least"
    assert gearopt.solve(file, nearest.edits, remedies=False).status == "optimal"


def test_a_contact_ratio_below_1_is_not_asked_for(tmp_path):
    text = PAIR + "[shift]\ncontact_ratio = 0.5\n"
    with pytest.raises(SceneError, match=r"shift\.contact_ratio = 0\.5: is not between 1 and 3"):
        gearopt.solve(written(tmp_path, text))


ROOTS = "[shift]\nrule = 'equal root safety'\n"


@pytest.mark.slow
@pytest.mark.parametrize("standard", ["both", "agma"])
def test_roots_are_equally_safe_of_gears_that_are_chosen(tmp_path, standard):
    text = PAIR.replace("[14, 40]", "[25, 25]").replace('"both"', f'"{standard}"')
    if standard == "agma":
        text = text.replace("12 deg", "0 deg").split("[rating.iso6336]")[0]
        text = text.replace('iso_material = "Eh"\niso_quality = "MQ"\n', "")
        text = text.replace('flank_rz = "4.8 um"\nroot_rz = "20 um"\n', "")
    result = gearopt.solve(written(tmp_path, text + ROOTS))
    rating = result.design["rating"]
    first, second = (g["bending_safety"] for g in rating.get("beside", rating)["gears"])
    assert result.status == "optimal" and first == pytest.approx(second, rel=1e-9)
    words = "AGMA 2001" if standard == "agma" else "ISO 6336"
    assert any(f"(S_F1 = S_F2 by {words}" in line for line in result.report["assumptions"])


def test_equal_root_safety_takes_one_load(tmp_path):
    loads = '[[load]]\nshare = "40 %"\npower = "15 kW"\n[[load]]\nshare = "60 %"\npower = "7 kW"\n'
    with pytest.raises(SceneError, match="needs one load and one material of each gear"):
        load(written(tmp_path, PAIR + ROOTS + loads))
