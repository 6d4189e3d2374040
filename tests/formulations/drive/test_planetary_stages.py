"""Planetary stages of whole teeth: the search against every candidate, built and rated alone."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import planetary_drives as own
import pytest
import rated_brute_force as brute
from campaigns import few

from gearopt.formulations.drive.planetary import HELD, Cutting
from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.teeth import gears, problem
from gearopt.formulations.drive.toothing import Toothing
from gearopt.optimise.solve import run
from gearopt.physics.gears import Cutter
from gearopt.physics.geometry.contact import active_root_diameters
from gearopt.physics.geometry.fillet import form_diameter, is_undercut
from gearopt.physics.iso6336.case import Practice
from gearopt.physics.iso6336.stiffness import reduced_mass

PLAIN = brute.least_share


@pytest.fixture(autouse=True)
def _of_both_kinds(monkeypatch):
    """Candidates of planetary stages beside those of pairs."""

    def least(train, k, *rest):
        return (own.least_share if train.stages[k].planetary else PLAIN)(train, k, *rest)

    monkeypatch.setattr(brute, "least_share", least)
    monkeypatch.setattr(brute, "worth", objective_share)


def agree(train, posed=None):
    """Whether the search of a drive, or of how it is posed, proves what every candidate says."""
    result, _ = run(problem(posed or train))
    best = brute.cheapest(train)
    if result.status == "infeasible":
        assert math.isinf(best)
    else:
        assert result.status == "optimal"
        assert result.value == pytest.approx(best, rel=1e-9)
    return best


@pytest.mark.parametrize("seed", few(range(100), (2, 9)))
def test_stages_are_those_of_every_candidate(seed):
    agree(own.some_planetary_drive(seed))


@pytest.mark.parametrize("seed", few(range(40), 0))
def test_drives_with_a_planetary_stage_are_those_of_every_candidate(seed):
    agree(own.some_planetary_drive(seed, 2))


@pytest.mark.parametrize("seed", few(range(30), (0, 4)))
def test_pinions_in_rings_are_those_of_every_candidate(seed):
    agree(own.some_internal_drive(seed))


@pytest.mark.parametrize("seed", few(range(20), (5,)))
def test_carriers_are_those_of_every_candidate(seed):
    """Cheeks are heavier than the gears are, and the heavier the fewer planets there are."""
    train = own.some_planetary_drive(seed, 1 + seed % 5 // 4)
    agree(own.with_carrier(train, {3: 2.0, 4: 1.0, 5: 0.3}))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_a_given_ratio_is_raised_by_the_mirrored_drive(seed):
    """Lemma 87: the same pairs, driven from the other end at the same power."""
    train = replace(own.some_planetary_drive(seed, 1 + seed % 2), tolerance=Fraction(0))
    ratio = brute_ratio(train)
    if ratio is None:
        return
    train = replace(train, ratio=ratio)
    up = replace(
        train,
        driver="wheel",
        torque=train.torque * float(ratio),
        speed=train.speed / float(ratio),
        stages=train.stages[::-1],
    )
    one, other = (run(problem(each))[0].value for each in (train, up))
    assert one == other if None in (one, other) else one == pytest.approx(other, rel=1e-9)


def brute_ratio(train):
    """A total ratio that numbers of teeth have, near the one asked for."""
    result, outcome = run(problem(replace(train, tolerance=Fraction(1, 50))))
    if result.value is None:
        return None
    pairs = gears(train, outcome.x)[0]
    return math.prod((Fraction(int(p.wheel_teeth), int(p.pinion_teeth)) for p in pairs), start=1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_twice_the_power_is_never_lighter(seed):
    train = own.some_planetary_drive(seed)
    values = [run(problem(replace(train, torque=f * train.torque)))[0].value for f in (1.0, 2.0)]
    one, two = (math.inf if value is None else value for value in values)
    assert two >= one * (1.0 - 1e-9)


def some_pairs(held, count, rng, helix):
    """Random pairs of stages, with what their options take of them."""
    sun, ring = rng.integers(12, 45, count), rng.integers(50, 150, count)
    ends = {"ring": (sun, sun + ring), "sun": (ring, sun + ring), "carrier": (sun, ring)}[held]
    module, width = rng.choice([1.5, 3.0, 8.0], count), rng.uniform(15.0, 80.0, count)
    return Toothing(helix).pair(module, *ends, width)


def used(safeties):
    """What is used of S_F 1.4 and S_H 1.1."""
    b1, b2, c1, c2 = safeties
    return np.maximum.reduce([1.4 / b1, 1.4 / b2, (1.1 / c1) ** 2, (1.1 / c2) ** 2])


@pytest.mark.parametrize(
    ("held", "helix"), few([(held, helix) for held in HELD for helix in (0.0, 0.2)], 1)
)
def test_no_width_and_torque_of_a_box_use_less(held, helix):
    """Rows of both meshes are bounds between two ends, and exact where these meet."""
    rng = np.random.default_rng(len(held))
    count, looked = 300, 0
    pair = some_pairs(held, count, rng, helix)
    cut = Cutting(helix, cutter=None if helix else Cutter(25, 0.0, 1.25, 0.2))
    torque, speed = 10.0 ** rng.uniform(4.0, 7.0, count), 10.0 ** rng.uniform(0.0, 2.3, count)
    low, high = pair.face_width * rng.uniform(0.5, 1.0, count), pair.face_width * 1.7
    strong = torque * rng.uniform(1.0, 3.0, count)
    for option in own.ways(cut, (3,), (0, 1, 2), held):
        for standard in option.standards:
            ready = standard.prepared(pair)
            point = standard.rows(ready, pair, (torque,) * 2, (speed,) * 2, (1.4, 1.1))
            at = point.used(pair.face_width, pair.face_width)
            exact = used(standard.safeties(pair, torque, speed))
            rated = np.isfinite(exact)
            assert (rated == np.isfinite(at)).all()
            np.testing.assert_allclose(at[rated], exact[rated], rtol=1e-9)
            ends = (torque, strong), (speed, torque * speed / strong)
            bound = standard.rows(ready, pair, *ends, (1.4, 1.1)).used(low, high)
            for _ in range(3):
                width = low * (high / low) ** rng.random(count)
                there = torque * (strong / torque) ** rng.random(count)
                inside = used(
                    standard.safeties(pair.of_width(width), there, torque * speed / there)
                )
                assert (bound <= inside * (1.0 + 1e-9))[np.isfinite(inside)].all()
            looked += int(rated.sum())
    assert looked > 100


@pytest.mark.parametrize("held", HELD)
def test_a_larger_module_is_never_lighter(held):
    """And a virtual way is no heavier than any: what the search leaves modules out by."""
    rng = np.random.default_rng(1)
    pair = some_pairs(held, 200, rng, 0.1)
    options = own.ways(Cutting(0.1), (3, 4), (0, 1, 2), held)
    virtual = options[0].cheapest_with(options[1:], None).planets
    larger = Toothing(0.1).pair(
        1.25 * pair.normal_module, pair.pinion_teeth, pair.wheel_teeth, 1.25 * pair.face_width
    )
    least = sum(virtual.volumes(pair))
    for option in options:
        now, then = (sum(option.planets.volumes(each)) for each in (pair, larger))
        fits = np.isfinite(now)
        assert fits.any() == (option.planets.count % 2 == 1 or option.planets.fewer % 2 == 0)
        np.testing.assert_allclose(then[fits], 1.25**3 * now[fits])
        assert (least <= now * (1.0 + 1e-12)).all()


def test_tips_of_a_ring_end_at_the_form_circles_of_planets():
    rng = np.random.default_rng(3)
    for option in own.ways(Cutting(0.15), (3,), (0, 1, 2)):
        pair = some_pairs("ring", 200, rng, 0.15)
        fits = option.planets.possible(pair.pinion_teeth, pair.wheel_teeth)
        mesh = option.planets.mesh(pair, with_ring=True)
        fits &= ~is_undercut(mesh.pinion) & (mesh.wheel.tip_alteration < 0.0)
        active, form = active_root_diameters(mesh)[0], form_diameter(mesh.pinion)
        assert fits.sum() > 10
        np.testing.assert_allclose(active[fits], form[fits], rtol=1e-12)


def test_planets_that_do_not_fit_are_named():
    train = own.some_planetary_drive(0)
    stage = train.stages[0]
    way = stage.options[0].planets
    alone = replace(stage, options=own.ways(way.cutting, (5,), (0,), way.held))
    odd = replace(alone, pinion_teeth=(20, 20), wheel_teeth=(101, 101))
    if way.held == "sun":
        odd = replace(odd, pinion_teeth=(81, 81))
    result, _ = run(problem(replace(train, stages=(odd,), ratio=train.ratio, tolerance=0.9)))
    assert result.status == "infeasible"
    assert "5 planets" in result.message


def test_the_speed_of_the_sun_is_against_the_carrier():
    """Willis: of 18/36/90 and a held ring the carrier turns at a sixth of the sun."""
    option = own.ways(Cutting(), (3,), (0,))[0]
    pair = option.planets.pair(2.0, 18.0, 90.0, 20.0)
    assert pair.ratio == pytest.approx(6.0)
    torque, speed = option.planets.slower(pair, False)
    assert (torque, speed) == pytest.approx((1 / 3, 5 / 6))
    torque, speed = option.planets.slower(pair, True)
    assert (torque, speed) == pytest.approx((2 / 3, 5 / 12))
    assert option.planets.loss(pair) == pytest.approx(5 / 6 * (1 / 18 + 2 / 36 - 1 / 90))


def test_gears_that_a_rule_of_shifts_saves_from_undercut_are_candidates():
    """20/14/49 and 17/17/51, which industry uses: a rack cuts 17.1 teeth at x = 0 (ISO 53 A)."""
    for sun, planet, ring, count in ((20, 14, 49, 3), (16, 17, 50, 3), (17, 17, 51, 4)):
        way = own.ways(Cutting(), (count,), (ring - sun - 2 * planet,))[0].planets
        pair = way.pair(2.0, float(sun), float(ring), 20.0)
        assert way.possible(sun, sun + ring) and way.room(pair)
        assert not any(is_undercut(gear) for gear in way.gears(pair)[:2])
    inner = own.rings(Cutting())[0].planets
    assert inner.room(inner.pair(2.0, 15.0, 60.0, 20.0))


def test_a_ring_too_thin_for_a_factor_is_no_design():
    """ISO 6336-3 has no Y_B up to 1.75 m_n: bounds refuse such a ring, as its rating does."""
    rng, helix = np.random.default_rng(5), 0.0
    for cut in (Cutting(rim=1.5), Cutting(outside=190.0)):
        (option,) = own.ways(cut, (3,), (0,))
        pair = some_pairs("ring", 100, rng, helix)
        standard = option.standards[1]
        ready = standard.prepared(pair)
        rows = standard.rows(ready, pair, (1e4,) * 2, (100.0,) * 2, (1.4, 1.1))
        used_there = rows.used(pair.face_width, pair.face_width)
        rim = (pair.normal_module, option.planets.gears(pair)[2])
        thin = (rim[1].root_diameter - rim[1].outside_diameter) / 2 / rim[0] <= 1.75
        assert thin.any() and not np.isfinite(used_there[thin]).any()


def test_a_sun_that_the_casing_holds_is_as_heavy_as_a_ring_that_it_holds():
    """m_red of planet and held gear is m_pla: K_v then has no mass of the sun."""
    option = own.ways(Cutting(), (3,), (0,), "sun")[0]
    pair = option.planets.mesh(option.planets.pair(2.0, 20.0, 80.0, 20.0), False)
    densities, bores = (7.83e-9,) * 2, (0.0, 0.0)
    mean = [(g.tip_diameter + g.root_diameter) / 2 for g in pair.gears]
    planet = math.pi / 8 * densities[1] * mean[1] ** 4 / pair.wheel.base_diameter**2
    meshes = option.standards[0].standard.practice.meshes
    assert reduced_mass(pair, densities, bores, meshes) == pytest.approx(planet)
    assert Practice(meshes=meshes).bending(1.0) == Practice(meshes=(3.0, 1.0)).bending(1.0)


@pytest.mark.parametrize("helix", [0.0, 0.2])
@pytest.mark.parametrize("module", [0.3, 2.75, 32.0])
def test_gears_at_their_reference_distances_have_no_shift_at_all(module, helix):
    """z_s + z_p = z_r - z_p: both reference distances are one, x = 0 and k = 0 without rounding."""
    for teeth in ((30, 30, 90), (27, 33, 93), (31, 53, 137)):
        sun, planet, ring, _ = Cutting(helix_angle=helix).gears(module, teeth, 10.0)
        assert [float(gear.profile_shift) for gear in (sun, planet, ring)] == [0.0] * 3
        assert [float(gear.tip_alteration) for gear in (sun, planet)] == [0.0] * 2
