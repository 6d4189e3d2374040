"""Load of the teeth: closed forms, gear pairs, conditions of the minimum, other solvers."""

from functools import cache

import numpy as np
import pytest

from gearopt.formulations.strain_wave.demand import (
    Duty,
    equal_pressure,
    loads_at,
    pressures,
    shared_pressure,
)
from gearopt.formulations.strain_wave.sharing import conic, problem, shared, teeth_of
from gearopt.optimise.solve import solve
from gearopt.physics.load_sharing import share
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.rim import Cup, chain_stiffnesses, rim_compliance

BASE = StrainWave(0.5, 160, profile_shift=0.9)
K = 1e5
DUTY = Duty(1e5, 10.0, (206e3, 206e3), (0.3, 0.3), K, Cup(), elastic=False)
# T [N m]: loaded teeth and largest load [N] of a rigid and an elastic rim, sum [N], windups [mrad],
# of another program
TABLE = {
    1: (3, 11.2, 3, 10.9, 13.1, 0.0029, 0.006),
    5: (3, 28.7, 3, 27.9, 65.7, None, None),
    20: (3, 94.4, 4, 90.7, 262.8, 0.025, 0.093),
    50: (5, 177.4, 5, 165.0, 656.9, None, None),
    100: (6, 302.8, 7, 268.8, 1313.8, 0.080, 0.408),
    200: (7, 493.6, 8, 427.5, 2627.6, 0.130, 0.776),
}


@cache
def base():
    return flank(BASE)


@cache
def teeth(elastic):
    return teeth_of(base(), K, (Cup(), 10.0) if elastic else None)


def given(elastic, torque):
    own = teeth(elastic)
    return own.compliance, own.gaps, np.full(len(own.gaps), own.arm), 500.0 * torque


def test_without_clearance_it_is_the_papers_equal_sharing():
    """P = M/(L N), and of unequal arms P_i = M L_i/sum L^2: (6) and (5)."""
    arm, moment = BASE.base_radius, 5e4
    found = shared(np.eye(8) / K, np.zeros(8), np.full(8, arm), moment)
    assert found.forces == pytest.approx(np.full(8, moment / (8 * arm)), rel=1e-12)
    assert found.windup == pytest.approx(moment / (K * 8 * arm**2), rel=1e-12)
    arms = np.linspace(37.0, 39.0, 8)
    found = shared(np.eye(8) / K, np.zeros(8), arms, moment)
    assert found.forces == pytest.approx(moment * arms / (arms @ arms), rel=1e-12)


@pytest.mark.parametrize("torque", TABLE)
def test_loads_agree_with_a_table_made_elsewhere(torque):
    loaded, most, loaded_elastic, most_elastic, whole, *windups = TABLE[torque]
    rigid, elastic = shared(*given(False, torque)), shared(*given(True, torque))
    assert (rigid.carrying, elastic.carrying) == (loaded, loaded_elastic)
    assert (rigid.forces.max(), elastic.forces.max()) == pytest.approx(
        (most, most_elastic), abs=0.05
    )
    assert rigid.forces.sum() == pytest.approx(500.0 * torque / BASE.base_radius, rel=1e-12)
    assert elastic.forces.sum() == pytest.approx(whole, abs=0.06)
    if windups[0]:
        found = 1e3 * rigid.windup, 1e3 * elastic.windup
        assert found == pytest.approx(windups, abs=5.1e-4)


def test_a_rigid_rim_is_the_load_sharing_of_gear_pairs():
    own = teeth(False)
    found = shared(*given(False, 100))
    other = share(np.full(len(own.gaps), 1.0 / K), own.gaps, 5e4 / own.arm)
    assert found.forces == pytest.approx(other.forces, abs=1e-9)
    assert found.windup * own.arm == pytest.approx(float(other.approach), rel=1e-12)
    loads = dict(zip(own.numbers.tolist(), found.forces.round().tolist(), strict=True))
    assert [loads[k] for k in range(-2, 4)] == [193, 293, 303, 293, 203, 30]


def test_conditions_of_the_minimum_hold_over_many_orders_of_load():
    """No tooth is pressed in further than it yields; none that is open carries."""
    gaps = np.array([0.0, 1e-9, 1e-9, 5e-3, 1e-2])
    counts = []
    for moment in (1e-6, 1e-3, 1.0, 1e3, 1e5):
        found = shared(np.eye(5) / K, gaps, np.full(5, 38.0), moment)
        assert found.forces.sum() * 38.0 == pytest.approx(moment, rel=1e-12)
        left = found.forces / K + gaps - found.windup * 38.0
        assert (left > -1e-15).all() and np.abs(left[found.forces > 0.0]).max() < 1e-15
        counts.append(int((found.forces > 0.0).sum()))
    assert counts == [1, 1, 3, 3, 4]


def test_random_matrices_against_conditions():
    rng = np.random.default_rng(5)
    for _ in range(40):
        n = int(rng.integers(2, 15))
        root = rng.normal(size=(n, n))
        matrix = 1e-5 * (root @ root.T / n + 0.1 * np.eye(n))
        gaps, arms = rng.uniform(0.0, 0.01, n), rng.uniform(30.0, 40.0, n)
        moment = float(10.0 ** rng.uniform(0.0, 5.0))
        found = shared(matrix, gaps, arms, moment)
        left = matrix @ found.forces + gaps - found.windup * arms
        assert (found.forces >= 0.0).all() and left.min() > -1e-11
        assert np.abs(found.forces * left).max() < 1e-8 * max(1.0, moment / 30.0)
        assert arms @ found.forces == pytest.approx(moment, rel=1e-10)


def test_the_posed_energy_is_that_of_loads_and_clearances():
    """Over M/L: 1/2 P'CP + g'P of any loads, and M = L'P."""
    matrix, gaps, arms, moment = given(True, 100)
    shares = np.random.default_rng(0).random(len(gaps))
    forces = shares * moment / arms[0]
    found = problem(matrix, gaps, arms, moment).batch(shares[None])
    energy = 0.5 * forces @ matrix @ forces + gaps @ forces
    assert found.F[0, 0] == pytest.approx(energy * arms[0] / moment, rel=1e-12)
    assert found.H[0, 0] == pytest.approx(arms @ forces / moment, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("torque", [20, 100])
def test_other_solvers_give_the_same_and_all_are_proven(torque):
    exact = shared(*given(True, torque))
    unit = 500.0 * torque / BASE.base_radius
    posed = problem(*given(True, torque))
    for one, method in ((posed, None), (posed, "qp"), (conic(*given(True, torque)), None)):
        result = solve(one, method)
        assert result.status == "optimal" and result.gap < 1e-9
        shares = np.array(list(result.design.values())).ravel()
        assert shares * unit == pytest.approx(exact.forces, abs=3e-6)
        price = result.multipliers["equilibrium"]
        assert abs(price) == pytest.approx(exact.windup * BASE.base_radius, rel=1e-6)


def test_the_rim_by_its_own_equations():
    """Forces on all teeth of a lobe: k_r times second differences + k_s times displacements."""
    along, behind = chain_stiffnesses(BASE, Cup(), 10.0)
    assert (along, behind) == pytest.approx((1.06e6, 1973.0), rel=2e-3)
    matrix = rim_compliance(BASE, Cup(), 10.0, np.arange(80)) / np.cos(BASE.pressure_angle) ** 2
    force = np.random.default_rng(1).normal(size=80)
    moved = matrix @ force
    second = 2.0 * moved - np.roll(moved, 1) - np.roll(moved, -1)
    assert along * second + behind * moved == pytest.approx(force, abs=1e-9)


def test_shared_loads_halve_the_papers_pressure():
    assert equal_pressure(DUTY, base()) == pytest.approx(117.38, abs=5e-3)
    assert shared_pressure(DUTY, base()) == pytest.approx(58.68, abs=5e-3)
    found = shared(*given(False, 100))
    assert found.effective == pytest.approx(4.34, abs=5e-3)
    assert shared(*given(True, 100)).effective == pytest.approx(4.89, abs=5e-3)


def test_pressures_of_single_teeth():
    own, loads = loads_at(DUTY, base())
    found = pressures(DUTY, base(), own, loads)
    middle = int(np.flatnonzero(own.numbers == 0)[0])
    gap = base().contacts.gap_curvature[100]
    expected = np.sqrt(loads.forces[middle] / 10.0 * DUTY.contact_modulus * gap / np.pi)
    assert found[middle] == pytest.approx(expected, rel=1e-4)
    assert (found[loads.forces == 0.0] == 0.0).all()


@pytest.mark.parametrize("width", [10.0, 1e6, 1e13])
def test_teeth_of_any_width_share_the_load(width):
    """Of a cup beside whose softness pairs of teeth are rigid, loads balance and push."""
    made = teeth_of(base(), 1e4 * width, (Cup(1.0, 3.0 * width), width))
    found = shared(made.compliance, made.gaps, np.full(len(made.gaps), made.arm), 5e4)
    assert np.linalg.eigvalsh(made.compliance)[0] > 0.0
    assert found.forces.min() >= 0.0 and found.forces.sum() * made.arm == pytest.approx(5e4)
    left = made.compliance @ found.forces + made.gaps - found.windup * made.arm
    assert np.abs(left[found.forces > 0.0]).max() < 1e-9 * max(1.0, found.windup * made.arm)
