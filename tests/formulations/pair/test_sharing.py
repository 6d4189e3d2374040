"""Load sharing by other ways than its closed form: compiled, as QP, as conic problem."""

import numpy as np
import pytest
from dense_sharing import share_dense

from gearopt.formulations.pair.sharing import KERNEL, conic, problem, share_rows
from gearopt.optimise import kernels
from gearopt.optimise.kernels import kernel
from gearopt.optimise.solve import solve
from gearopt.physics.load_sharing import share

C, E, W, C12 = (3e-6, 4e-6, 5e-6), (0.0, 0.005, 0.05), 5000.0, 1e-6
# by hand: pairs 1 and 2 carry, 2e-6 F1 = 3e-6 F2 + 0.005, F1 + F2 = 5000
FORCES, APPROACH, GAP = (4000.0, 1000.0, 0.0), 2e-6 * 4000.0 + 1e-6 * 5000.0, 0.042


@pytest.mark.parametrize("method, pose", [("qp", problem), ("conic", conic)])
def test_prices_are_approach_and_gaps(method, pose):
    """The approach is the price of the equilibrium, minus a gap that of a pair without load."""
    found = solve(pose(C, E, W, C12), method)
    assert found.status == "optimal"
    assert np.array(found.design["f"]) * W == pytest.approx(FORCES, abs=1e-6)
    prices = found.multipliers
    assert prices["equilibrium"] == pytest.approx(APPROACH, rel=1e-9)
    assert prices["pull[3]"] == pytest.approx(-GAP, rel=1e-9)
    assert prices["pull[1]"] == prices["pull[2]"] == 0.0
    energy = 2e-6 * 4000.0**2 / 2 + 3e-6 * 1000.0**2 / 2 + 1e-6 * W**2 / 2 + 0.005 * 1000.0
    assert found.value * W == pytest.approx(energy, rel=1e-9)


@pytest.mark.parametrize("method, pose", [("qp", problem), ("conic", conic)])
def test_no_load_is_the_least_separation(method, pose):
    """At W = 0 a linear problem is left, whose price is the kinematic error."""
    prices = solve(pose(C, [0.007, 0.005, 0.05], 0.0, C12), method).multipliers
    assert prices["equilibrium"] == pytest.approx(0.005, rel=1e-9)
    assert prices["pull[3]"] == pytest.approx(-0.045, rel=1e-9)


def rows_of(seed, rows, pairs):
    """Random rows; some pairs are far apart, and loads span eight decades."""
    rng = np.random.default_rng(seed)
    compliances, separations = (
        rng.uniform(2e-6, 5e-6, (rows, pairs)),
        rng.uniform(0, 2e-2, (rows, pairs)),
    )
    return (
        compliances,
        separations * rng.integers(0, 2, (rows, pairs)),
        10.0 ** rng.uniform(0, 5, rows),
    )


@pytest.mark.parametrize("count", [4, pytest.param(40, marks=pytest.mark.slow)])
@pytest.mark.parametrize("pairs", [2, 3])
def test_random_programs(pairs, count):
    """Closed form, DAQP and Clarabel agree on forces and approach to the solvers' accuracy."""
    c, e, load = rows_of(pairs, count, pairs)
    closed = share(c, e, load, C12)
    posed = problem(c[0], e[0], load[0], C12)
    for k in range(count):
        quadratic = solve(posed.at(c=tuple(c[k]), e=tuple(e[k]), W=load[k]), "qp")
        cones = solve(conic(c[k], e[k], load[k], C12), "conic")
        for found in (quadratic, cones):
            forces = np.array(found.design["f"]) * load[k]
            assert forces == pytest.approx(closed.forces[k], abs=2e-6 * load[k])
            assert found.multipliers["equilibrium"] == pytest.approx(closed.approach[k], rel=2e-6)


@pytest.mark.parametrize("pairs", [2, 3])
def test_dense_programs_against_cvxpy(pairs):
    """Any symmetric C: active sets against an interior-point method, forces and dual."""
    import cvxpy as cp

    rng = np.random.default_rng(pairs)
    root = 1e-3 * rng.normal(size=(pairs, pairs))
    matrix = np.diag(rng.uniform(2e-6, 5e-6, pairs)) + 0.3 * root @ root.T
    separations, load = rng.uniform(0.0, 1e-2, pairs), 5000.0
    f, whole = cp.Variable(pairs), np.ones(pairs)
    rows = [whole @ f == 1.0, f >= 0.0]
    scaled = 1e3 * load * matrix
    energy = 0.5 * cp.quad_form(f, cp.psd_wrap(scaled)) + 1e3 * separations @ f
    cp.Problem(cp.Minimize(energy), rows).solve(solver=cp.CLARABEL)
    found = share_dense(matrix, separations, load)
    assert found.forces / load == pytest.approx(f.value, abs=1e-6)
    assert 1e3 * found.approach == pytest.approx(-rows[0].dual_value, abs=1e-6)


@pytest.mark.parametrize("rows", [700, pytest.param(100_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("pairs", [1, 2, 4, 7])
def test_campaign(pairs, rows):
    """Shares of random pairs sum to the load, none is negative, compiled as in numpy."""
    c, e, load = rows_of(20 + pairs, rows, pairs)
    e[np.random.default_rng(0).random(e.shape) < 0.1] = np.inf
    load[:2] = 0.0
    forces, approach = share_rows(c, e, load, C12)
    found = share(c, e, load, C12)
    there = np.isfinite(e).any(axis=1)
    assert (np.isfinite(approach) == there).all()
    assert np.abs(forces.sum(axis=1) - load)[there] == pytest.approx(0.0, abs=1e-12 * load.max())
    assert np.abs(forces.sum(axis=1) / np.where(load > 0, load, 1.0))[there & (load > 0)] == (
        pytest.approx(1.0, rel=1e-12)
    )
    assert forces.min() >= 0.0
    scale = np.maximum(load, 1.0)[:, None]
    assert np.abs((forces - found.forces) / scale).max() < 1e-12
    assert approach[there] == pytest.approx(found.approach[there], rel=1e-12)


def test_the_kernel_is_the_python_it_was_written_in():
    """Uncompiled, on rows with absent pairs, none at all, and no load."""
    c = np.full((3, 2), 3e-6)
    e = np.array([[0.0, 0.002], [np.inf, 0.001], [np.inf, np.inf]])
    load, forces, approach = np.array([0.0, 100.0, 100.0]), np.empty((3, 2)), np.empty(3)
    kernels.plain(kernel(KERNEL).share_rows)(c, e, load, 0.0, forces, approach)
    assert approach == pytest.approx([0.0, 0.001 + 3e-4, np.inf])
    assert forces.tolist() == [[0.0, 0.0], [0.0, 100.0], [0.0, 0.0]]


@pytest.mark.parametrize("method, pose", [("qp", problem), ("conic", conic)])
def test_one_pair_carries_everything(method, pose):
    """Alone on the path: the approach is separation and deflection."""
    found = solve(pose([3e-6], [0.002], 1000.0, 1e-6), method)
    assert found.design["f"] == pytest.approx(1.0, rel=1e-12)
    assert found.multipliers["equilibrium"] == pytest.approx(0.002 + 3e-6 * 1000.0, rel=1e-12)
