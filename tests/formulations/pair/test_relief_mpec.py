"""The local method for relief: conditions of the sharing as constraints, against the search."""

from types import SimpleNamespace

import numpy as np
import pytest
from relief_pairs import COUPLING, mesh

from gearopt.formulations.pair.relief import relief_mpec
from gearopt.formulations.pair.relief.parametric import Ranges, at_point, problem
from gearopt.formulations.pair.relief.relief_mpec import (
    HOMOTOPY,
    MICRO,
    STARTS,
    _point,
    _removed,
    complementarity,
)
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve


@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_the_exact_sharing_meets_the_constraints(exponent):
    """At random reliefs; its peak is the exact one but for the rounding of where they begin."""
    made = mesh((0.6, 1.0), COUPLING, 12)
    ranges, rng = Ranges.of(made, exponent), np.random.default_rng(0)
    low, high, _ = problem(made, ranges).bounds()
    posed = complementarity(made, low, high, ranges.exponents).at(smoothing=0.0, tau=1e-9)
    for _ in range(4):
        x = rng.uniform(low, high)
        whole = _point(made, posed, x, ranges.exponents)
        rows = posed.batch(whole[None])
        assert rows.G.max() <= 1.0 + 1e-9 and rows.H[0] == pytest.approx(1.0, abs=1e-12)
        exact = made.criteria(made.separations(*at_point(x, ranges))).peak_to_peak.max()
        assert rows.F[0, 0] == pytest.approx(MICRO * exact, rel=1e-9)
        lower = whole.copy()
        lower[6] -= 1e-3  # a smaller peak breaks a row
        assert posed.batch(lower[None]).G.max() > 1.0 + 5e-4


def test_the_rounded_beginning_of_a_relief():
    """Where it begins half the rounding to the exponent is removed; far from there it is exact."""
    x = SimpleNamespace(amount=(8.0, 3.0), length=(2.0, 5.0))
    p = SimpleNamespace(smoothing=1e-3)
    row = SimpleNamespace(tip00=2.0, tip10=0.0, tip01=0.0, tip11=5.0)
    assert _removed(x, p, row, 0, (1.0, 2.0)) == pytest.approx(8.0 * 5e-4 + 3.0, abs=2e-6)
    assert _removed(x, p, row, 1, (1.0, 2.0)) == pytest.approx(8.0 + 3.0 * 2.5e-7, abs=3e-6)


def test_the_best_of_several_starts_is_kept(monkeypatch):
    made = mesh((1.0,), COUPLING, 12)
    ranges = Ranges.of(made, 1.0)
    posed = problem(made, ranges)
    low, high, _ = posed.bounds()
    starts = low + (high - low) * np.random.default_rng(0).uniform(0.1, 0.9, (STARTS, 4))
    values = posed.batch(starts).F[:, 0]
    starts = starts[values.argsort()[[2, 0, 3, 1]]]
    monkeypatch.setattr(relief_mpec, "_followed", lambda posed, x, clock: x)
    monkeypatch.setattr(relief_mpec, "_starts", lambda *_: iter([*starts, None]))
    found = relief_mpec.local(made, ranges.exponents)(posed, Budget(), 0, None)
    assert found.x == pytest.approx(starts[1], rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "loads, exponent, most",
    [((1.0,), 2.0, 1.05), ((0.6, 1.0), 1.0, 1.26)],
)
def test_local_optima(loads, exponent, most):
    """Near what a published program of this sort finds [um], and never below the proven bound."""
    made = mesh(loads)
    posed = problem(made, Ranges.of(made, exponent))
    exact, found = solve(posed, "exact"), solve(posed, "mpec", Budget(evaluations=1200))
    assert exact.bound <= found.value < 1e-3 * most
    assert found.status in ("feasible", "limit") and HOMOTOPY[-1][0] < 1e-4
