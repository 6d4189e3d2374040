"""Rings and their limits against cutters and pinions that are rolled point by point."""

import math

import numpy as np
import pytest
from campaigns import few
from rolled_rings import cut_space, entering_overlap, running_overlap

from gearopt.physics.gears import Cutter, Gear, GearPair, Rack, reference_diameter, replace
from gearopt.physics.geometry.fillet import (
    fillet_end,
    fillet_point,
    form_diameter,
    half_angle,
    is_undercut,
    profile,
)
from gearopt.physics.geometry.flaws import flaws, tip_intrusion
from gearopt.physics.geometry.internal import margins

ROLLED = 4e-4  # modules that steps of rolling leave, both flanks touching
LIMITS = (
    "involute_interference",
    "trochoidal_interference",
    "fillet_interference0",
    "fillet_interference1",
    "tip_clearance0",
    "tip_clearance1",
)


def ring(teeth, shift=0.0, helix=0.0, cutter=None, allowance=0.0, module=1.0):
    d = reference_diameter(module, -teeth, helix)
    rack = Rack(tip_radius=0.3)
    return Gear(
        module, -teeth, d, 10.0, helix, rack, shift, thickness_allowance=allowance, cutter=cutter
    )


def drawn(rng, more_teeth, tips):
    """A pair of random teeth, shifts, tips and cutter whose members have teeth and contact."""
    while True:
        z1 = int(rng.integers(14, 45))
        z2 = z1 + int(rng.choice(more_teeth))
        if z2 < 28:
            continue
        z0 = int(rng.integers(12, max(13, z2 - 8)))
        cutter = Cutter(z0, rng.uniform(-0.2, 0.2), 1.25, rng.choice([0.02, 0.2, 0.3]))
        racks = Rack(addendum=rng.choice(tips)), Rack(addendum=rng.choice(tips))
        shifts = rng.uniform(-0.2, 0.6), rng.uniform(-1.2, 0.3)
        pair = GearPair.internal(1.0, z1, -z2, 1.0, 0.0, racks, shifts, cutter=cutter)
        left = margins(pair)
        needed = "cutter_tip", "tip_thickness0", "tip_thickness1", "contact_ratio"
        if min(left[name] for name in (*needed, "cutter_involute")) > 0.0:
            return pair, left


@pytest.mark.parametrize(
    ("made", "poses"),
    few(
        [
            (ring(60, 0.2, 0.0, Cutter(25, 0.1, 1.25, 0.2), 0.0), 600),
            (ring(93, -0.3, 0.0, Cutter(40, -0.2, 1.3, 0.3), -0.05), 600),
            (ring(40, -0.2, 0.0, Cutter(17, 0.3, 1.2, 0.1), 0.02), 2400),
        ],
        2,
    ),
)
def test_the_space_of_a_ring_is_the_envelope_of_its_rolled_cutter(made, poses):
    space = cut_space(made, poses, 160)
    x, y = profile(made, 400, 400)
    radius, gap = np.hypot(x, y)[::-1], (math.pi / space.teeth - np.arctan(x / -y))[::-1]
    assert radius[-1] == pytest.approx(space.radius[-1], rel=1e-12)
    at = np.searchsorted(space.radius, radius[-1] - 0.01)  # at the root radii say little
    off = (space.half - np.interp(space.radius, radius, gap)) * space.radius
    assert np.max(np.abs(off[:at])) < 1e-4


@pytest.mark.parametrize("helix", [0.0, 0.35])
def test_cutters_of_many_teeth_are_the_counterpart_of_the_rack(helix):
    rack = ring(60, 0.2, helix)
    cutter = ring(60, 0.2, helix, Cutter(1e7, 0.0, 1.25, 0.3))
    for theta in (fillet_end(rack), 0.9, 1.4):
        first, second = fillet_point(rack, theta), fillet_point(cutter, theta)
        assert (first.x, first.y) == pytest.approx((second.x, second.y), abs=3e-6)


@pytest.mark.parametrize("helix", [0.0, 0.35])
@pytest.mark.parametrize("cutter", [None, Cutter(25, 0.1, 1.25, 0.2)])
def test_fillet_and_involute_of_a_ring_meet_with_one_tangent(helix, cutter):
    made = ring(60, 0.2, helix, cutter, -0.03, 2.0)
    end = fillet_point(made, fillet_end(made))
    assert end.half_angle == pytest.approx(half_angle(made, end.radius), abs=1e-13)
    at = [end.radius * (1 - s * 1e-6) for s in (0.0, 1.0)]
    x, y = ([r * f(half_angle(made, r)) for r in at] for f in (math.sin, math.cos))
    assert math.atan2(x[0] - x[1], y[1] - y[0]) == pytest.approx(end.slope, abs=1e-5)
    for theta in (1.0, 1.3):
        before, after = (fillet_point(made, theta + s * 1e-6) for s in (1, -1))
        slope = math.atan2(after.x - before.x, before.y - after.y) % math.pi
        assert slope == pytest.approx(fillet_point(made, theta).slope, abs=1e-7)


def test_form_diameters_of_rings():
    """By the rack as ISO 21771 has it; by a cutter the end of its flank on the line of action."""
    made = ring(60, 0.2)
    assert not is_undercut(made)
    alpha, d = made.rack.pressure_angle, -60.0
    flank = 1.25 - 0.3 * (1.0 - math.sin(alpha)) - 0.2
    tangent = d * math.sin(alpha) - 2.0 * flank / math.sin(alpha)
    assert form_diameter(made) == pytest.approx(-math.hypot(d * math.cos(alpha), tangent))
    cut = replace(made, cutter=Cutter(25, 0.1, 1.25, 0.2))
    angle, distance = cut.cutting(0.2)
    base = 0.5 * 25.0 * math.cos(alpha)
    end = math.sqrt((12.5 + 1.35 - 0.2) ** 2 - base**2) + 0.2  # of the cutter, from its base circle
    tangent = -distance * math.sin(angle) + end
    assert form_diameter(cut) == pytest.approx(
        -2.0 * math.hypot(0.5 * d * math.cos(alpha), tangent)
    )


# steps of the cutter and points of its outline, radii, the same of the pinion; what they leave
COARSE, FINE = (400, 40, 60, 300, 40, 8e-3), (1200, 120, 150, 2500, 120, 1e-3)


@pytest.mark.parametrize(
    ("seed", "pairs", "steps"), few([(0, 30, COARSE), *((k, 100, FINE) for k in range(1, 11))], 1)
)
def test_margins_tell_what_rolled_pairs_cut_into(seed, pairs, steps):
    """Sound: no overlap where no limit is broken. Sharp: trochoidal margins are the overlap."""
    rng, left_by_steps = np.random.default_rng(seed), steps[-1]
    for k in range(pairs):
        wide = k % 2 == 0
        more = [8, 12, 20, 35, 59] if wide else [3, 4, 5, 6, 8, 10]
        pair, left = drawn(rng, more, [0.8, 0.9, 1.0] if wide else [0.5, 0.6, 0.7, 0.8])
        space = cut_space(pair.wheel)
        tip = 0.5 * pair.wheel.tip_diameter
        overcut = (space.half[0] - math.pi / space.teeth - half_angle(pair.wheel, tip)) * -tip
        if left["cutter_overcut"] < 0.0:  # a round cuts less than the corner that is assumed
            assert overcut < -left["cutter_overcut"] + ROLLED
            assert overcut > ROLLED or left["cutter_overcut"] > -0.02
            continue
        assert overcut < ROLLED
        if min(left[name] for name in LIMITS) >= 0.0:
            overlap = running_overlap(pair, space)
            if overlap > ROLLED:  # rarely: what coarse steps leave
                overlap = running_overlap(pair, cut_space(pair.wheel, *FINE[:3]), *FINE[3:5])
            near = min(left["tip_clearance0"], left["tip_clearance1"]) < 0.1
            assert overlap < (5.0 * ROLLED if near else ROLLED)
        elif min(left["tip_clearance0"], left["tip_clearance1"]) >= 0.0:
            fine = cut_space(pair.wheel, *steps[:3])
            overlap = running_overlap(pair, fine, *steps[3:5])
            deep = max(tip_intrusion(pair, 0), tip_intrusion(pair, 1))
            assert deep == pytest.approx(overlap, rel=0.3, abs=left_by_steps)
            fouled = left["trochoidal_interference"]
            if fouled < min(left[n] for n in LIMITS if n != "trochoidal_interference"):
                assert overlap == pytest.approx(-fouled, rel=0.1, abs=left_by_steps)


@pytest.mark.parametrize(("seed", "pairs"), few([(0, 5), *((k, 20) for k in range(1, 6))], 1))
def test_radial_assembly_is_what_pinions_meet_on_their_way(seed, pairs):
    rng = np.random.default_rng(seed + 100)
    for _ in range(pairs):
        pair, left = drawn(rng, [8, 10, 11, 12, 14, 16, 20], [0.5, 0.6, 0.7, 0.8])
        if min(left[name] for name in (*LIMITS, "cutter_overcut")) >= 0.0:
            overlap = entering_overlap(pair, cut_space(pair.wheel))
            assert overlap == pytest.approx(max(0.0, -left["radial_assembly"]), abs=5e-3)


def anything(rng, count, given):
    """Pairs of arrays, most of which no one would make."""

    def among(low, high):
        return rng.uniform(low, high, count)

    z1 = rng.integers(4, 80, count).astype(float)
    z2 = z1 + rng.integers(1, 120, count)
    module, helix = among(0.2, 30.0), rng.choice([0.0, 0.1, 0.3, 0.6], count)
    angle = np.full(count, math.radians(20.0))
    racks = tuple(
        Rack(angle, among(0.3, 1.4), among(0.8, 1.6), among(0.0, 0.5), 0.0, among(0.0, 0.2))
        for _ in range(2)
    )
    shifts = among(-1.5, 2.0), among(-2.0, 2.0)
    distance = -0.5 * module * (z2 - z1) / np.cos(helix) * among(0.8, 1.3) if given else None
    z0 = np.minimum(rng.integers(3, 60, count), z2 - 1.0)
    cutter = Cutter(z0, among(-1.0, 1.0), among(0.5, 1.8), among(0.0, 0.6))
    width = among(1.0, 100.0)
    return GearPair.internal(module, z1, -z2, width, helix, racks, shifts, distance, cutter)


@pytest.mark.parametrize("count", few([2000, 500_000], 1))
@pytest.mark.parametrize("given", [False, True])
def test_arrays_of_any_numbers_have_margins(count, given):
    """No exception and no NaN; what is infinite has a margin below 0 that tells why."""
    pairs = anything(np.random.default_rng(count), count, given)
    left = margins(pairs)
    assert all(each.shape == (count,) and not np.isnan(each).any() for each in left.values())
    reasons = "centre_distance", "involute0", "involute1", "cutter_distance", "cutter_tip"
    told = np.min([left[name] for name in reasons], axis=0) < 0.0
    assert all(np.isfinite(each[~told]).all() for each in left.values())
    assert np.isfinite(pairs.working_angle[left["centre_distance"] > 0.0]).all()


def test_one_pair_of_an_array_is_that_pair():
    pairs = anything(np.random.default_rng(7), 20, False)
    left = margins(pairs)
    for k in range(20):

        def part(value, k=k):
            return float(value[k]) if isinstance(value, np.ndarray) else value

        racks = tuple(
            Rack(*(part(getattr(g.rack, n)) for n in Rack.__dataclass_fields__))
            for g in pairs.gears
        )
        cutter = pairs.wheel.cutter
        alone = GearPair.internal(
            *(part(v) for v in (pairs.normal_module, pairs.pinion_teeth, pairs.wheel_teeth)),
            part(pairs.face_width),
            part(pairs.pinion.helix_angle),
            racks,
            tuple(part(g.profile_shift) for g in pairs.gears),
            None,
            Cutter(*(part(getattr(cutter, n)) for n in Cutter.__dataclass_fields__)),
        )
        for name, each in margins(alone).items():
            assert each == pytest.approx(left[name][k], rel=1e-9, abs=1e-9)


# SDP/SI, Elements of Metric Gear Technology (D785), page T-45, table 5-3a: teeth of a cutter
# without shift, and of the smallest standard ring that it does not trim as it is fed in radially.
# To 15 teeth, which make no involute at the tips, belong 34; here 33 are free by 0.001 modules.
UNTRIMMED = """16 34 17 35 18 36 19 37 20 38 21 39 22 40 24 42 25 43 27 45 28 46 30 48 31 49 32 50
33 51 34 52 35 53 38 56 40 58 42 60 44 62 48 66 50 68 56 74 60 78 64 82 66 84 80 98
96 114 100 118"""
# Table 5-4, page T-46: z1, x of the ring away from its centre, alpha_w, a, eps of rings of 50
# teeth; "no involute or trochoid interference, but trimming interference is still there".
NARROW = [
    (49, 1.00, 61.0605, 0.971, 1.105),
    (48, 0.60, 46.0324, 1.354, 1.512),
    (47, 0.40, 37.4155, 1.775, 1.726),
    (46, 0.30, 32.4521, 2.227, 1.835),
    (45, 0.20, 28.2019, 2.666, 1.933),
    (44, 0.11, 24.5356, 3.099, 2.014),
    (43, 0.06, 22.3755, 3.557, 2.053),
    (42, 0.01, 20.3854, 4.010, 2.088),
]


def test_printed_limits_of_cutters():
    """They trim rings of one tooth less; 15 to 22 teeth end below the involute of the ring."""
    cutters, rings = np.array(UNTRIMMED.split(), float).reshape(-1, 2).T
    cutter = Cutter(cutters, 0.0, 1.25, 0.1)
    at, below = (
        margins(GearPair.internal(1.0, np.full(len(rings), 12.0), -z, 1.0, cutter=cutter))
        for z in (rings, rings - 1.0)
    )
    assert np.all(at["cutter_infeed"] > 0.0) and np.all(below["cutter_infeed"] < 0.0)
    assert np.all((at["cutter_involute"] < 0.0) == (cutters <= 22.0))


@pytest.mark.parametrize(("teeth", "shift", "angle", "distance", "ratio"), NARROW)
def test_printed_pairs_of_few_teeth_between_them(teeth, shift, angle, distance, ratio):
    pair = GearPair.internal(1.0, teeth, -50, 1.0, profile_shifts=(0.0, -shift))
    assert math.degrees(pair.working_angle) == pytest.approx(angle, abs=6e-5)
    assert -pair.centre_distance == pytest.approx(distance, abs=6e-4)
    assert pair.transverse_contact_ratio == pytest.approx(ratio, abs=6e-4)
    left = margins(pair)
    assert min(left["involute_interference"], left["trochoidal_interference"]) > 0.0
    assert left["radial_assembly"] < 0.0


def names(pair):
    return [flaw.name for flaw in flaws(pair)]


def test_a_printed_planet_and_ring_have_no_flaw():
    """KISSsoft 03/2017, 5 MW wind gearbox, stage 2: github.com/gfsReboucas/Drivetrain."""
    racks = Rack(), Rack(tip_radius=0.3)
    cutter = Cutter(30, 0.0, 1.25, 0.3)
    pair = GearPair.internal(
        21.0, 36, -93, 550.0, 0.0, racks, (0.5039, 0.1171), -584.0, cutter=cutter
    )
    shorter = replace(pair.pinion, tip_alteration=(815.663 - pair.pinion.tip_diameter) / 42.0)
    assert names(replace(pair, pinion=shorter)) == []


@pytest.mark.parametrize(
    ("pair", "expected"),
    [
        (GearPair.internal(4.0, 22, -28, 50.0), "no involute"),
        (GearPair.internal(4.0, 22, -61, 50.0), "fillet interference"),
        (GearPair.internal(4.0, 14, -61, 50.0), "involute interference"),
        (
            GearPair.internal(1.0, 40, -44, 9.0, 0.0, (Rack(addendum=0.7),) * 2),
            "trochoidal interference",
        ),
        (
            GearPair.internal(1.0, 40, -48, 9.0, 0.0, (Rack(addendum=0.7),) * 2),
            "axial assembly",
        ),
        (GearPair.internal(4.0, 22, -61, 50.0, profile_shifts=(1.2, -0.2)), "no centre distance"),
        (GearPair.internal(4.0, 22, -61, 50.0, working_distance=-70.0), "no centre distance"),
        (GearPair.internal(4.0, 22, -61, 50.0, working_distance=-79.0), "no backlash"),
        (GearPair.internal(4.0, 22, -61, 50.0, working_distance=-79.5), "no tip clearance"),
        (GearPair.internal(4.0, 22, -61, 50.0, cutter=Cutter(23, 0.0, 1.25, 0.5)), "pointed tool"),
        (GearPair.internal(4.0, 22, -61, 50.0, cutter=Cutter(23, 1.0)), "no cut"),
        (GearPair.internal(3.0, 16, -24, 9.0, profile_shifts=(0.0, -0.5)), "undercut"),
        (
            GearPair.internal(
                3.0, 16, -24, 9.0, profile_shifts=(0.0, -0.5), cutter=Cutter(15, 0.0, 1.25, 0.2)
            ),
            "overcut",
        ),
        (GearPair.internal(2.0, 20, -60, 9.0, cutter=Cutter(50)), "radial infeed"),
    ],
)
def test_flaws_by_name(pair, expected):
    assert expected in names(pair)
