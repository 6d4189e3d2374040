"""Shifts for a centre distance: published pairs, sliding by the path of contact."""

import math

import numpy as np
import pytest

from gearopt.physics.gears import ISO_53_A, GearPair
from gearopt.physics.geometry.contact import contact_path, specific_sliding
from gearopt.physics.geometry.fillet import NEGLIGIBLE
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.geometry.profile_shift import (
    RULES,
    Meshing,
    Shifting,
    equal_root_safety,
    equal_sliding,
)
from gearopt.physics.geometry.tooth import tip_thickness

# m_n, z1, z2, beta [deg], a [mm]; x1 + x2 and alpha_wt [deg] as printed (None: computed, by another
# program); x1 of equal sliding, after Roloff and after Henriot by another program; printed x1
CASES = {
    "KHK 56.4999": (3, 12, 24, 0, 56.4999, "0.9600", 26.0886, 0.5481, 0.4931, 0.5533, None),
    "public calculator": (3, 12, 24, 0, 56.5, "0.960", 26.0888, 0.5481, 0.4931, 0.5534, None),
    "KHK helical": (3, 12, 60, 30, 125.0, "0.09809", 23.1126, 0.4073, 0.3049, 0.4830, None),
    "KHK transverse": (3, 12, 60, 0, 109.0, "0.34462", 21.3975, None, None, None, None),
    "sheet": (3.5, 31, 30, 21, 116.5, "0.6518771", 23.8707610, 0.3236, 0.3238, 0.3198, None),
    "TR 6336-30": (8, 17, 103, 15.8, 500.0, "0.14522", 21.0661, 0.4102, 0.3215, 0.5222, None),
    "5 MW, fast": (14, 24, 95, 10, 861.0, "1.149", None, 0.4801, 0.5427, 0.6494, 0.480),
    "5 MW, 1": (45, 17, 19, 0, 863.0, "1.419", None, 0.7018, 0.6897, 0.7090, None),
    "5 MW, 2": (21, 18, 36, 0, 584.0, "0.893", None, 0.4892, 0.4663, 0.5310, None),
    "10 MW, 1": (30, 26, 31, 8, 877.033, "0.4795", None, 0.2702, 0.2611, 0.2802, 0.2702),
    "10 MW, 2": (20, 26, 41, 8, 684.273, "0.4000", None, 0.2787, 0.2563, 0.3119, 0.2787),
    "10 MW, 3": (18, 28, 61, 12, 825.885, "0.4000", None, 0.2977, 0.2786, 0.3854, 0.2976),
    "FZG": (4.5, 16, 24, 0, 91.5, "0.3532", None, 0.3035, 0.2741, 0.2813, None),
    "STplus": (1, 51, 52, 0, 52.0, "0.5177", None, 0.2600, 0.2603, 0.2631, None),
    "spur 125": (2.5, 24, 74, 0, 125.0, "1.072077", 22.9422, 0.4884, 0.5219, 0.6197, None),
    "negative sum": (2.5, 11, 41, 14, 65.0, "-0.701684", 15.21281, 0.4781, None, None, None),
}


def meshing(module, z1, z2, helix, distance):
    return Meshing(module, (z1, z2), np.radians(helix), (ISO_53_A, ISO_53_A), distance)


def paired(made, x1):
    """The pair of a rule's shifts, with both tips shortened."""
    total, shorter = made.shift_sum, made.tip_alteration
    pair = GearPair.of_teeth(
        made.module, *made.teeth, 1.0, made.helix_angle, made.racks[0], (x1, total - x1)
    )
    cut = [g.__class__(**{**vars(g), "tip_alteration": shorter}) for g in pair.gears]
    return GearPair(*cut, made.distance)


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_published_pairs(case):
    made, (total, angle, *by_rule, printed) = meshing(*case[:5]), case[5:]
    last = 10.0 ** -len(total.partition(".")[2])
    assert made.shift_sum == pytest.approx(float(total), abs=last)
    if angle is not None:
        assert math.degrees(made.working_angle) == pytest.approx(angle, abs=1e-4)
    for rule, value in zip(RULES.values(), by_rule, strict=True):
        if value is not None:
            assert rule(made) == pytest.approx(value, abs=6e-5)
    if printed is not None:
        assert equal_sliding(made) == pytest.approx(printed, abs=2e-4)


def test_equal_sliding_is_equal_along_the_path_of_contact():
    """By the tip circles of the gears that are made, and their distance without backlash."""
    rng = np.random.default_rng(5)
    z1 = rng.integers(8, 60, 3000)
    z2 = (z1 * rng.uniform(1.0, 8.0, 3000)).astype(int)
    helix = rng.uniform(0.0, 30.0, 3000)
    distance = 0.5 * (z1 + z2) / np.cos(np.radians(helix)) + rng.uniform(-0.5, 1.5, 3000)
    made = meshing(1.0, z1, z2, helix, distance)
    shift = equal_sliding(made)
    pair = paired(made, shift)
    path = contact_path(pair)
    first = specific_sliding(path, pair.ratio, path.start)[0]
    second = specific_sliding(path, pair.ratio, path.end)[1]
    assert np.isfinite(shift).mean() > 0.98
    there = np.isfinite(shift)
    assert first[there] == pytest.approx(second[there], rel=1e-8)
    assert pair.working_angle == pytest.approx(made.working_angle, rel=1e-12)


def test_no_shifts_where_base_circles_overlap_or_tips_pass_the_tangent_points():
    assert np.isnan(equal_sliding(meshing(2.0, 20, 30, 0.0, 45.0)))
    assert np.isnan(equal_sliding(meshing(1.0, 4, 4, 0.0, 3.9)))


def test_no_shifts_beyond_usual_sums():
    """A hundred teeth at 100 mm: of modules of 2 and 2.02 mm, too small and too large ones."""
    made = meshing(np.array([2.0, 2.02, 1.9, 2.06]), np.full(4, 40.0), np.full(4, 60.0), 0.0, 100.0)
    x1, x2, _ = Shifting().shifts(made)
    assert np.isfinite(x1).tolist() == [True, True, False, False]
    assert (x1 + x2)[:2] == pytest.approx([0.0, made.shift_sum[1]]) and -1.0 < made.shift_sum[1] < 0


@pytest.mark.parametrize("worse", [0, 1])
def test_the_worse_gear_counts_in_every_limit(worse):
    """Equal numbers of teeth: one gear is undercut, the tips of the other one are thin."""
    made = meshing(2.0, 14, 14, 0.0, 29.2)
    pair = paired(made, (0.05, made.shift_sum - 0.05)[worse])
    used, path = Shifting().used(pair), contact_path(pair)
    slides = [specific_sliding(path, 1.0, s)[k] for k, s in enumerate((path.start, path.end))]
    assert used["specific_sliding"] == pytest.approx(-slides[worse] / 3.0)
    assert used["tip_thickness"] == pytest.approx(0.4 / tip_thickness(pair.gears[1 - worse]))
    sine = math.sin(math.radians(20.0))
    deep = 1.25 - 0.38 * (1.0 - sine) - 0.05 - 7.0 * sine**2  # of the straight flank of the rack
    assert used["undercut"] == pytest.approx(1.0 + deep - NEGLIGIBLE)


@pytest.mark.parametrize("x1", [-0.3, 0.0, 0.3, None])
def test_gears_within_the_limits_do_not_interfere(x1):
    """By the teeth that are made, one by one; sums below 0 bring tips below the form circles."""
    rng, excluded = np.random.default_rng(7), 0
    for _ in range(60):
        z1 = int(rng.integers(16, 40))
        z2, distance = int(z1 * rng.uniform(1.0, 6.0)), rng.uniform(-1.0, 1.5)
        made = meshing(1.0, z1, z2, 0.0, 0.5 * (z1 + z2) + distance)
        pair = paired(made, equal_sliding(made) if x1 is None else x1)
        used = Shifting(sliding=9.0).used(pair)
        interferes = any(flaw.name == "interference" for flaw in flaws(pair))
        good = all(value <= 1.0 for name, value in used.items() if name != "interference")
        assert not good or (used["interference"] > 1.0) == interferes
        excluded += good and interferes
    assert excluded


ROOTS = {  # x1 of equal sliding is 0.4884; sides of a made-up ln(S_F1/S_F2), and the root
    "rising": (lambda x: x - 0.3, 0.3),
    "falling": (lambda x: 0.3 - x, 0.3),
    "nearest of two below": (lambda x: (x - 0.1) * (x - 0.35), 0.35),
    "nearest of two on either side": (lambda x: (x - 0.2) * (x - 0.9), 0.2),
    "and above": (lambda x: (x - 0.05) * (x - 0.8), 0.8),
    "none": (lambda x: 0.1 + 0.0 * x, np.nan),
    "of a gear that is undercut": (lambda x: x + 0.6, np.nan),
    "a jump is none": (lambda x: np.where(x > 0.3, 0.2, -0.2), np.nan),
    "where it is not known": (lambda x: np.where(x > 0.4, x - 0.3, np.nan), np.nan),
}


@pytest.mark.parametrize(("sides", "expected"), ROOTS.values(), ids=ROOTS)
def test_equal_root_safety_takes_the_root_nearest_to_equal_sliding(sides, expected):
    columns = (np.full(3, v) for v in (2.5, 24.0, 74.0, 0.0, 125.0))
    found = equal_root_safety(meshing(*columns), lambda made, x: np.exp(sides(x)))
    assert found == pytest.approx([expected] * 3, abs=1e-12, nan_ok=True)
