"""Load sharing: closed form, compiled and by solvers of quadratic programs, time beside error.

Random positions of 2, 4 and 6 tooth pairs of which some do not carry. The error is that of the
shares F/W against the closed form in rational arithmetic, the largest of CHECKED positions; solvers
are built once and solve these one after the other.
"""

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import Any

from gearopt.bench import timed
from gearopt.formulations.pair.sharing import share_rows
from gearopt.physics.load_sharing import share

POSITIONS, CHECKED = 1_000_000, 200
PAIRS = (2, 4, 6)
COUPLING = 0.8e-6  # mm/N
Rows = tuple[Any, Any, Any]  # compliances (rows, n), separations (rows, n), loads (rows,)
Solve = Callable[[Any, Any], Any]  # diagonal W (c - c12) and separations [um] of one row -> shares


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, ms, positions, us of one, largest error of a share F/W."""
    import numpy as np

    timings = []
    for pairs in PAIRS:
        rows = _random(pairs)
        few = tuple(a[:CHECKED] for a in rows)
        exact = np.array([_exact(*row) for row in zip(*few, strict=True)])
        for method, call in _closed(rows).items():
            forces, times = timed(call, repeat)
            shares = forces[:CHECKED] / few[2][:, None]
            timings.append(_row(pairs, method, times, POSITIONS, np.abs(shares - exact).max()))
        for method, build in SOLVERS.items():
            uncoupled, separations = _scaled(few)
            shares, times = timed(partial(_each, build(pairs), uncoupled, separations), repeat)
            timings.append(_row(pairs, method, times, CHECKED, np.abs(shares - exact).max()))
    return timings


def _random(pairs: int) -> Rows:
    """Return positions with compliances, relief and loads of gears of module 3 mm."""
    import numpy as np

    rng = np.random.default_rng(pairs)
    shape = (POSITIONS, pairs)
    separations = rng.uniform(0.0, 20e-3, shape) * rng.integers(0, 2, shape)
    return rng.uniform(2e-6, 5e-6, shape), separations, rng.uniform(100.0, 8000.0, POSITIONS)


def _closed(rows: Rows) -> dict[str, Callable[[], Any]]:
    """Return the closed form of all positions, in numpy and compiled."""
    return {
        "numpy": lambda: share(*rows, COUPLING).forces,
        "kernel": lambda: share_rows(*rows, COUPLING)[0],
    }


def _exact(compliances: Any, separations: Any, load: float) -> list[float]:
    """Return shares of one position in rational arithmetic: the least depth of all sets."""
    stiffnesses = [1 / (Fraction(float(c)) - Fraction(COUPLING)) for c in compliances]
    apart, w = [Fraction(float(e)) for e in separations], Fraction(float(load))
    order = sorted(range(len(stiffnesses)), key=apart.__getitem__)
    sets = [order[: k + 1] for k in range(len(stiffnesses))]
    depth: Any = min(
        (w + sum(stiffnesses[i] * apart[i] for i in s)) / sum(stiffnesses[i] for i in s)
        for s in sets
    )
    return [float(max(depth - e, 0) * k / w) for e, k in zip(apart, stiffnesses, strict=True)]


def _scaled(rows: Rows) -> tuple[Any, Any]:
    """Return W (c - c12) and separations [um]: numbers of size 1, as solvers like them."""
    compliances, separations, load = rows
    return 1e3 * load[:, None] * (compliances - COUPLING), 1e3 * separations


def _each(solve: Solve, own: Any, separations: Any) -> Any:
    import numpy as np

    return np.array([solve(d, e) for d, e in zip(own, separations, strict=True)])


def _daqp(pairs: int) -> Solve:
    """CasADi's DAQP, an active-set method."""
    import casadi as ca
    import numpy as np

    shapes = {"h": ca.Sparsity.diag(pairs), "a": ca.Sparsity.dense(1, pairs)}
    solver = ca.conic("sharing", "daqp", shapes)
    ones = np.ones((1, pairs))

    def solve(own: Any, separations: Any) -> Any:
        solution = solver(h=ca.diag(own), g=separations, a=ones, lba=1.0, uba=1.0, lbx=0.0)
        return np.array(solution["x"]).ravel()

    return solve


def _osqp(pairs: int) -> Solve:
    """OSQP, operator splitting, to 1e-9 and polished."""
    import numpy as np
    import osqp
    from scipy import sparse

    rows = sparse.csc_matrix(np.vstack([np.ones(pairs), np.eye(pairs)]))
    low, high = np.r_[1.0, np.zeros(pairs)], np.r_[1.0, np.full(pairs, np.inf)]
    solver, identity = osqp.OSQP(), sparse.csc_matrix(np.eye(pairs))
    settings = {"eps_abs": 1e-9, "eps_rel": 1e-9, "polishing": True, "verbose": False}
    solver.setup(identity, np.zeros(pairs), rows, low, high, max_iter=20_000, **settings)

    def solve(own: Any, separations: Any) -> Any:
        solver.update(Px=own, q=separations)
        return solver.solve(raise_error=True).x

    return solve


def _clarabel(pairs: int) -> Solve:
    """Clarabel, an interior-point method."""
    import clarabel
    import numpy as np
    from scipy import sparse

    rows = sparse.csc_matrix(np.vstack([np.ones(pairs), -np.eye(pairs)]))
    right = np.r_[1.0, np.zeros(pairs)]
    cones = [clarabel.ZeroConeT(1), clarabel.NonnegativeConeT(pairs)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False

    def solve(own: Any, separations: Any) -> Any:
        hessian = sparse.csc_matrix(np.diag(own))
        solver = clarabel.DefaultSolver(hessian, separations, rows, right, cones, settings)
        return np.array(solver.solve().x)

    return solve


def _cvxpy(pairs: int) -> Solve:
    """Cvxpy's parametrised problem (DPP), by Clarabel."""
    import cvxpy as cp
    import numpy as np

    f = cp.Variable(pairs)
    root, separation = cp.Parameter(pairs, nonneg=True), cp.Parameter(pairs)
    energy = 0.5 * cp.sum_squares(cp.multiply(root, f)) + separation @ f
    posed = cp.Problem(cp.Minimize(energy), [cp.sum(f) == 1.0, f >= 0.0])

    def solve(own: Any, separations: Any) -> Any:
        root.value, separation.value = np.sqrt(own), separations
        posed.solve(solver=cp.CLARABEL)
        return f.value

    return solve


SOLVERS: dict[str, Callable[[int], Solve]] = {
    "DAQP": _daqp,
    "OSQP": _osqp,
    "Clarabel": _clarabel,
    "cvxpy, DPP": _cvxpy,
}


def _row(
    pairs: int, method: str, times: dict[str, float], positions: int, error: float
) -> dict[str, Any]:
    each = 1e3 * times["median_ms"] / positions
    row = {"case": f"{pairs} pairs", "method": method, **times, "positions": positions}
    return row | {"us_each": float(f"{each:.3g}"), "error": float(error)}
