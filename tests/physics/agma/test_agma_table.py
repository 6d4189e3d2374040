"""Smooth forms, tables, refusals: against the exact factors one by one, and at random points."""

import math
from collections import Counter
from dataclasses import fields, replace

import casadi as ca
import numpy as np
import pytest
from campaigns import few

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.agma.batch import rate_rows
from gearopt.physics.agma.bending import critical_theta, loaded_tooth, seen_from_wheel, tangency
from gearopt.physics.agma.mesh import REGIMES, mesh_of
from gearopt.physics.agma.rating import rate
from gearopt.physics.agma.rating_factors import Practice, Steel
from gearopt.physics.agma.refusals import (
    REFUSALS,
    SENTENCES,
    geometry_factors,
    single_factors,
)
from gearopt.physics.agma.smooth import smooth_error, smooth_factors
from gearopt.physics.agma.table import factor_table
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.fillet import fillet_point
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.rating import Operation

OVERLAPS = {"spur": 0.0, "low": 0.7, "conventional": 1.4}


def of_regime(regime, helix=0.25):
    if regime == "spur":
        return GearPair.of_teeth(3.0, 25, 50, 30.0, 0.0, Rack(), (0.2, -0.1))
    width = OVERLAPS[regime] * 3.0 * math.pi / math.sin(helix)
    return GearPair.of_teeth(3.0, 25, 50, width, helix, Rack(), (0.2, -0.1))


def thetas(pair):
    mesh = mesh_of(pair)
    return tuple(critical_theta(loaded_tooth(m)) for m in (mesh, seen_from_wheel(mesh)))


@pytest.mark.parametrize("regime", REGIMES)
def test_tangency_is_stationarity_of_height_over_thickness_squared(regime):
    """d/dtheta of h_F/s_F^2 is 0 there, by differences; and it is its maximum on the fillet."""
    tooth = loaded_tooth(mesh_of(of_regime(regime)))
    theta = critical_theta(tooth)

    def slender(at):
        point = fillet_point(tooth.gear, at)
        return (tooth.apex - point.y) / point.x**2

    assert tangency(tooth, theta) == pytest.approx(0.0, abs=1e-13)
    slope = (slender(theta + 1e-5) - slender(theta - 1e-5)) / 2e-5
    assert slope == pytest.approx(0.0, abs=1e-8)
    grid = np.linspace(tooth.gear.rack.pressure_angle, math.pi / 2, 2001)
    assert slender(theta) >= slender(grid).max() - 1e-12


@pytest.mark.parametrize("regime", REGIMES)
def test_the_smooth_form_is_the_exact_one_without_branches(regime):
    """To rounding for spur gears and m_F <= 1; above by the load sharing ratio alone."""
    pair = of_regime(regime)
    errors = smooth_error(pair, regime)
    if regime == "conventional":
        assert errors == pytest.approx((errors[0],) * 3, abs=1e-12)
        assert 1e-4 < abs(errors[0]) < 0.07
    else:
        assert errors == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


def test_the_error_of_the_smooth_form_lies_between_minus_5_and_7_per_cent():
    found = []
    for z in (17, 60):
        for ratio, helix in ((1.0, 0.15), (3.0, 0.3), (8.0, 0.5)):
            for overlap in np.linspace(1.001, 3.0, 8):
                width = overlap * math.pi / math.sin(helix)
                pair = GearPair.of_teeth(1.0, z, z * ratio, width, helix)
                found.append(smooth_error(pair, "conventional")[0])
    assert -0.0501 < min(found) and max(found) < 0.07


@pytest.mark.parametrize("regime", REGIMES)
def test_traced_factors_and_their_derivatives(regime):
    """Traced = text on floats = arrays; gradients by all inputs against central differences."""
    pair = of_regime(regime)
    start = np.array([3.0, 25.0, 50.0, pair.face_width, 0.25, 0.2, -0.1, *thetas(pair)])

    def text(v):
        helix = 0.0 if regime == "spur" else v[4]
        made = GearPair.of_teeth(v[0], v[1], v[2], v[3], helix, Rack(), (v[5], v[6]))
        found = smooth_factors(made, regime, (v[7], v[8]))
        return found.pitting, *found.bending, *found.tangencies

    x = ca.SX.sym("x", 9)
    with legacy_numpy():
        value = ca.vertcat(*text(ca.vertsplit(x)))
    function = ca.Function("text", [x], [value, ca.jacobian(value, x)])
    traced, jacobian = (np.array(v) for v in function(start))
    assert np.allclose(traced.ravel(), text(start), rtol=1e-12, atol=1e-13)
    many = text(np.tile(start, (3, 1)).T)
    assert np.allclose(np.array(many)[:, 0], traced.ravel(), rtol=1e-12, atol=1e-13)
    for k in range(9):
        step = 1e-5 * np.eye(9)[k] * max(1.0, start[k])
        ends = [np.array(text(start + s * step)) for s in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * step[k])
        assert np.allclose(jacobian[:, k], slope, rtol=1e-5, atol=1e-8)


def test_a_solver_finds_the_critical_sections_from_the_same_start():
    """Newton's method of casadi on both tangencies, from theta = 1."""
    pair = of_regime("spur")
    x = ca.SX.sym("x", 2)
    with legacy_numpy():
        found = smooth_factors(pair, "spur", tuple(ca.vertsplit(x)))
    root = ca.rootfinder("root", "newton", ca.Function("g", [x], [ca.vertcat(*found.tangencies)]))
    solved = np.array(root([1.0, 1.0])).ravel()
    assert solved == pytest.approx(thetas(pair), abs=1e-9)


def test_a_regime_or_load_that_is_not_known():
    with pytest.raises(ValueError, match="conventional"):
        mesh_of(of_regime("spur"), "helical")
    with pytest.raises(ValueError, match="tip"):
        loaded_tooth(mesh_of(of_regime("spur")), "root")


@pytest.mark.parametrize("helix", [0.0, 0.3])
def test_tables_hold_what_pairs_have(helix):
    """Every pair of a table at random widths, both sides of m_F = 1, refusals included."""
    rng = np.random.default_rng(3)
    teeth = rng.integers(12, 40, 500), rng.integers(33, 96, 500)
    width, module = rng.uniform(2.0, 40.0, 500), rng.uniform(0.5, 2.0, 500)

    def pair(width):
        return GearPair.of_teeth(module, *teeth, width, helix, profile_shifts=(0.3, 0.1))

    exact = geometry_factors(pair(width))
    some = rng.permutation(500)[:300]
    found = factor_table(pair(1.0)).take(some).factors(width[some])
    for one, other in zip(found, (exact.pitting, *exact.bending), strict=True):
        assert np.array_equal(np.isnan(one), np.isnan(other[some]))
        assert np.allclose(one, other[some], rtol=1e-12, atol=0, equal_nan=True)


STEELS = {
    "carburised": (Steel("carburised", 2),) * 2,
    "through-hardened": (Steel(hardness=300.0), Steel(hardness=240.0)),
    "carburised pinion": (Steel("carburised", 2), Steel(hardness=240.0)),
}
PRACTICES = (
    Practice(quality=8, curve="precision"),
    Practice(quality=6, crowned=True, size=True, backup=(None, 0.9), edition="B88"),
)


@pytest.mark.parametrize("practice", PRACTICES)
@pytest.mark.parametrize("steels", STEELS.values(), ids=STEELS)
@pytest.mark.parametrize("helix", few([0.25, 0.0], 1))
def test_rows_are_ratings(helix, steels, practice):
    """Safety factors of `rate`, row by row; of refused pairs, none."""
    rng = np.random.default_rng(5)
    teeth = rng.integers(14, 40, 30), rng.integers(33, 96, 30)
    module, width = rng.uniform(1.0, 5.0, 30), rng.uniform(8.0, 90.0, 30)
    operation = Operation(2e7, rng.uniform(5.0, 300.0, 30), 5000.0, overload=1.25)
    found = rate_rows(GearPair.of_teeth(module, *teeth, width, helix), operation, steels, practice)
    for k in range(30):
        numbers = [float(v[k]) for v in (module, *teeth, width)]
        one = replace(operation, pinion_speed=float(operation.pinion_speed[k]))
        if teeth[0][k] > teeth[1][k]:
            assert found.refusal[k]
            assert np.isnan(found.contact[0][k])
            continue
        single = rate(GearPair.of_teeth(*numbers, helix), one, steels, practice)
        assert [s[k] for s in found.bending] == pytest.approx(single.bending_safety, rel=1e-12)
        assert [s[k] for s in found.contact] == pytest.approx(single.contact_safety, rel=1e-12)


def test_given_factors_stand_in_the_place_of_computed_ones():
    given = {
        "I": 0.1,
        "J": (0.3, 0.35),
        "K_v": 1.2,
        "K_m": 1.5,
        "K_s": (1.1, 1.2),
        "K_B": (1.0, 2.0),
    }
    given |= {"Y_N": (0.9, 0.95), "Z_N": (0.8, 0.85), "C_H": (1.0, 1.01), "s_at": (200.0, 210.0)}
    pair, operation = GearPair.of_teeth(2.0, 20.0, 60.0, 25.0), Operation(2e7, 100.0, 5000.0)
    steels = (Steel(hardness=300.0), Steel(hardness=240.0))
    rows, single = (
        rate_rows(pair, operation, steels, given=given),
        rate(pair, operation, steels, given=given),
    )
    assert rows.bending == pytest.approx(single.bending_safety, rel=1e-13)
    assert rows.contact == pytest.approx(single.contact_safety, rel=1e-13)


def random_pairs(count, seed):
    """Return pairs of z 5 to 1000, m 0.1 to 50, any tool, shift, thickness and centre distance."""
    rng = np.random.default_rng(seed)
    z1, z2 = (np.round(5.0 * 200.0 ** rng.random(count)) for _ in range(2))
    module = 0.1 * 500.0 ** rng.random(count)
    helix = np.where(rng.random(count) < 0.3, 0.0, rng.uniform(-0.7, 0.7, count))
    rack = Rack(
        rng.uniform(0.2, 0.5, count),
        rng.uniform(0.7, 1.3, count),
        rng.uniform(1.0, 1.6, count),
        rng.uniform(0.0, 0.5, count),
        rng.uniform(0.0, 0.05, count),
    )
    shifts = rng.uniform(-1.0, 1.5, count), rng.uniform(-1.0, 1.5, count)
    pair = GearPair.of_teeth(
        module, z1, z2, module * rng.uniform(1.0, 60.0, count), helix, rack, shifts
    )
    pinion, wheel = (
        replace(
            gear,
            thickness_allowance=-module * rng.uniform(0.0, 0.1, count),
            tip_alteration=rng.uniform(-0.3, 0.1, count),
        )
        for gear in pair.gears
    )
    return GearPair(pinion, wheel, pair.centre_distance * rng.uniform(0.98, 1.02, count))


def check(pair):
    found = geometry_factors(pair)
    fine = found.refusal == 0
    for value in (found.pitting, *found.bending):
        assert np.array_equal(np.isfinite(value), fine)
        assert (value[fine] > 0.0).all()
    return Counter(found.refusal.tolist())


def test_random_points_have_an_answer_or_a_name():
    assert len(check(random_pairs(4_000, 1))) > 6  # of the names of REFUSALS


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_many_random_points_have_an_answer_or_a_name(seed):
    """Of each of the rarest names there is a point among them."""
    found = check(random_pairs(40_000, seed))
    assert sum(found.values()) == 40_000 and found[0] > 4_000


# Teeth that are known to be refused: digest, section 10, and closed forms
@pytest.mark.parametrize(
    ("pair", "name"),
    [
        (GearPair.of_teeth(1.0, 10, 40, 8.0, profile_shifts=(0.8, 0.0)), "pointed tooth"),
        (GearPair.of_teeth(1.0, 60, 90, 8.0, working_distance=77.5), "contact ratio below 1"),
        (GearPair.of_teeth(1.0, 60, 90, 8.0, working_distance=70.0), "no centre distance"),
        (GearPair.of_teeth(1.0, 90, 90, 8.0, rack=Rack(0.3, 1.35, 1.6, 0.2)), "contact ratio of 2"),
        (GearPair.of_teeth(1.0, 8, 50, 8.0), "usable contact ratio below 1"),
        (GearPair.of_teeth(1.0, 60, 20, 8.0), "larger pinion"),
        (GearPair.of_teeth(1.0, 30, 60, 8.0, rack=Rack(0.5, 1.0, 1.8)), "pointed tool"),
    ],
)
def test_refusals_by_name(pair, name):
    with pytest.raises(ValueError, match=f"^{name}"):
        single_factors(pair)


def one_of(value, k):
    return float(value[k]) if isinstance(value, np.ndarray) else value


def single(gear, k):
    rack = Rack(*(one_of(getattr(gear.rack, f.name), k) for f in fields(Rack)))
    rest = {f.name: one_of(getattr(gear, f.name), k) for f in fields(gear) if f.name != "rack"}
    return replace(gear, rack=rack, **rest)


def test_fatal_flaws_are_refusals():
    """Of pairs of floats taken out of random arrays; 908's own refusals are no flaws."""
    many = random_pairs(16, 7)
    codes = geometry_factors(many).refusal
    own = REFUSALS.index("usable contact ratio below 1")
    for k, code in enumerate(codes):
        gears = [single(gear, k) for gear in many.gears]
        found = flaws(GearPair(*gears, float(many.working_distance[k])))
        names = {flaw.name for flaw in found if flaw.fatal}
        assert bool(names) == (0 < code <= own)
        assert code == 0 or code > own or REFUSALS[code] in names


@pytest.mark.parametrize("module", [0.1, 50.0])
@pytest.mark.parametrize(("z1", "z2", "shifts"), [(1000, 1000, (0, 0)), (5, 12, (0.55, 0.3))])
def test_extreme_teeth_scale(module, z1, z2, shifts):
    """I and J have no unit: the same at module 0.1, 50 and 1; a rack-like J near 0.5 to 0.6."""
    found, unit = (
        geometry_factors(GearPair.of_teeth(m, z1, z2, 8 * m, profile_shifts=shifts))
        for m in (module, 1.0)
    )
    assert found.refusal == unit.refusal
    if unit.refusal:
        assert REFUSALS[unit.refusal] in SENTENCES
    else:
        assert found.pitting == pytest.approx(unit.pitting, rel=1e-11)
        assert found.bending == pytest.approx(unit.bending, rel=1e-11)
        assert 0.4 < min(found.bending) < 0.65
