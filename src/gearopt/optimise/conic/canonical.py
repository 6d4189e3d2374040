"""The canonical data of a conic problem, which solvers see and certificates are computed from.

Minimise c.x + x.P x/2 + d over A x + s = b, s in K. K holds zero rows, then nonnegative rows, then
second-order blocks. A block |(s_1, w)| <= s_0 that comes from a product (1/t, x^2/t, powers) is
kept as p q >= |w|^2 with p = s_0 + s_1, q = s_0 - s_1: then p and q can be scaled apart, and a
t of 1e-6 beside a 1/t of 1e6 loses no digits.
"""

from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.terms import Array


@dataclass(frozen=True)
class Block:
    """One second-order block of `size` rows from `start`; rotated: p, q, w in place of s_0, s_1."""

    start: int
    size: int
    rotated: bool

    @property
    def rows(self) -> slice:
        """Return its rows."""
        return slice(self.start, self.start + self.size)


@dataclass(frozen=True)
class Canonical:
    """P (n, n), A (m, n): scipy sparse; the first `zero` rows are equalities, then `nonneg`.

    user (k,): columns of the user's components. lower, upper (n,): bounds, infinite for columns
    that canonicalisation added. label (m,): number of the user's row that a row states, or -1.
    turn (m, m): cvxpy's slacks to ours. allowed: {column: sorted values} of discrete columns.
    """

    P: Any
    c: Array
    d: float
    A: Any
    b: Array
    zero: int
    nonneg: int
    blocks: tuple[Block, ...]
    user: Any
    lower: Array
    upper: Array
    label: Any
    turn: Any
    allowed: dict[int, Array]

    @cached_property
    def entries(self) -> tuple[Any, Any, Array]:
        """Return row, column and value of every entry of A that is not zero."""
        table = self.A.tocoo()
        there = table.data != 0.0  # a parameter that is zero leaves an entry
        return table.row[there], table.col[there], table.data[there]

    @cached_property
    def convexity(self) -> tuple[float, Array]:
        """Return (shortfall, unit (n,)): x.P x + shortfall sum (x/unit)^2 >= 0, with rounding."""
        size = len(self.c)
        diagonal = self.P.diagonal()
        support = np.flatnonzero(abs(self.P).sum(axis=0))
        unit = np.ones(size)
        if not len(support):
            return 0.0, unit
        if (diagonal[support] <= 0).any():
            return np.inf, unit
        unit[support] = 1.0 / np.sqrt(diagonal[support])
        scaled = (self.P.multiply(unit[:, None]).multiply(unit[None, :])).tocsr()[support][
            :, support
        ]
        if (abs(scaled).sum(axis=0) <= 2.0 - 1e-12 * (scaled.nnz > len(support))).all():
            least = 0.0  # diagonally dominant
        elif len(support) <= 3000:
            least = float(np.linalg.eigvalsh(scaled.toarray())[0]) - len(support) ** 2 * 4e-16
        else:
            return np.inf, unit
        return max(0.0, -least), unit

    def turned(self, y: Array) -> Array:
        """Return multipliers of cvxpy's rows (y_0, y_1, ...) as multipliers of ours."""
        y = np.array(y, float)
        for block in self.blocks:
            if block.rotated:
                first, second = y[block.start], y[block.start + 1]
                y[block.start], y[block.start + 1] = (first + second) / 2, (first - second) / 2
        return y


def canonical(problem: Conic) -> Canonical:
    """Return the data at the problem's parameter values, remembered for the last values.

    SolveError for cones other than zero, nonnegative and second order.
    """
    key = problem.parameter_values().tobytes()
    kept = problem.memo.get("canonical")
    if kept is None or kept[0] != key:
        kept = problem.memo["canonical"] = (key, _canonical(problem))
    data: Canonical = kept[1]
    return data


def shifted(problem: Conic, data: Canonical, margin: float) -> Canonical:
    """Return the same data with every limit and define held to 1 - margin."""
    model = problem.model()
    count = len(model.rows.inequalities)
    model.shifts.value = np.where(np.arange(model.shifts.size) < count, margin, 0.0)
    b = data.turn @ _data(problem.name, model.problem)[0]["b"]
    model.shifts.value = np.zeros(model.shifts.size)
    return replace(data, b=b)


def _canonical(problem: Conic) -> Canonical:
    import scipy.sparse as sp

    model = problem.model()
    data, d = _data(problem.name, model.problem)
    count = len(model.rows.inequalities) + len(model.rows.equalities)
    label = np.full(len(data["b"]), -1)
    if count:  # the right-hand side moves where a row is stated, by its number
        model.shifts.value = np.arange(1.0, count + 1.0)
        moved = _data(problem.name, model.problem)[0]["b"] - data["b"]
        model.shifts.value = np.zeros(count)
        label = np.rint(np.abs(moved)).astype(int) - 1
    dims, start = data["dims"], data["dims"].zero + data["dims"].nonneg
    A, b = sp.csr_array(data["A"]), np.asarray(data["b"], float)
    blocks = []
    for size in dims.soc:
        blocks.append(Block(start, size, bool(size > 2 and _product(A, b, start))))
        start += size
    turn = _turn(len(b), blocks)
    P = data.get("P")
    size = len(data["c"])
    program = data["param_prob"]  # cvxpy replaces variables of known sign, but keeps their names
    where = {v.name(): program.var_id_to_col[v.id] for v in program.variables}
    user: list[int] = []
    for variable in model.variables:  # one that no term uses gets a column of its own
        first = where.get(variable.name(), size)
        size += variable.size if variable.name() not in where else 0
        user += range(first, first + variable.size)
    lower, upper = np.full(size, -np.inf), np.full(size, np.inf)
    lower[user], upper[user] = problem.bounds()[:2]
    more = size - len(data["c"])
    P = sp.csr_array((size, size)) if P is None else sp.block_diag((P, sp.csr_array((more, more))))
    return Canonical(
        sp.csr_array(P),
        np.concatenate([data["c"], np.zeros(more)]),
        d,
        sp.csr_array(sp.hstack([turn @ A, sp.csr_array((len(b), more))])),
        turn @ b,
        dims.zero,
        dims.nonneg,
        tuple(blocks),
        np.array(user),
        lower,
        upper,
        label,
        turn,
        _allowed(problem, user),
    )


def _data(name: str, problem: Any) -> tuple[dict[str, Any], float]:
    """Return Cvxpy's data for Clarabel, and the constant of the objective."""
    import cvxpy as cp

    try:
        data, _, inverse = problem.get_problem_data(cp.CLARABEL)
    except (cp.error.SolverError, cp.error.ParameterError) as broken:
        raise SolveError(f"conic on {name}: {broken}") from broken
    dims = data["dims"]
    if dims.exp or dims.psd or dims.p3d or dims.pnd:
        raise SolveError(
            f"{name} needs an exponential, semidefinite or power cone; conic takes linear, convex "
            "quadratic and second-order cone problems"
        )
    return data, float(inverse[-1].get("offset", 0.0))


def _product(A: Any, b: Array, start: int) -> bool:
    """Return whether s_0 + s_1 and s_0 - s_1 are sparser than s_0 and s_1, and exact."""
    first, second = (
        dict(zip(A.indices[lo:hi], A.data[lo:hi], strict=True))
        for lo, hi in (A.indptr[start : start + 2], A.indptr[start + 1 : start + 3])
    )
    first[-1], second[-1] = b[start], b[start + 1]
    kept, before = 0, 0
    for key in first.keys() | second.keys():
        u, v = float(first.get(key, 0.0)), float(second.get(key, 0.0))
        for augend, addend in ((u, v), (u, -v)):
            total = augend + addend
            if total - augend != addend or total - addend != augend:
                return False
            kept += total != 0.0
        before += (u != 0.0) + (v != 0.0)
    return kept < before


def _turn(count: int, blocks: list[Block]) -> Any:
    import scipy.sparse as sp

    turn = sp.eye_array(count, format="lil")
    for block in blocks:
        if block.rotated:
            k = block.start
            turn[k, k + 1], turn[k + 1, k], turn[k + 1, k + 1] = 1.0, 1.0, -1.0
    return turn.tocsr()


def _allowed(problem: Conic, user: list[int]) -> dict[int, Array]:
    """Return values of the discrete columns within their bounds; SolveError: too many."""
    allowed = {}
    lower, upper, _ = problem.bounds()
    for (variable, name), column, low, high in zip(
        problem.columns, user, lower, upper, strict=True
    ):
        if variable.values is not None:
            values = np.unique([v for v in variable.values if low <= v <= high])
        elif variable.integer:
            if not high - low <= 1e6:
                raise SolveError(f"{problem.name}: integer {name} needs bounds within 1e6")
            values = np.arange(np.ceil(low), np.floor(high) + 1.0)
        else:
            continue
        if not len(values):
            raise SolveError(f"{problem.name}: no allowed value of {name} lies in its bounds")
        allowed[column] = values
    return allowed
