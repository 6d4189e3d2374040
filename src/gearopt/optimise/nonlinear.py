"""Ipopt's side of casadi: a form in units of its own scale, wide logarithms split up, its monitor.

The logarithm of a sum over n variables has a dense Hessian: n^2 numbers at every iteration, and
casadi takes n^3 steps to write them down. Here a sum of more than DENSE_VARIABLES variables becomes

    log(sum_k t_k) = log(sum_j exp(u_j)),   log(sum of GROUP terms t_k) <= u_j

level by level, and a product of many factors becomes the sum of their logarithms. The rows stay
log-convex, each u_j lies on its row wherever that counts, and the multiplier of the last sum is
that of the row. Only Ipopt sees this: certificates judge the form itself.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.form import Form
from gearopt.optimise.problem import Problem
from gearopt.optimise.scale import objective_scale, sizes
from gearopt.optimise.tape import MONOMIAL, POSYNOMIAL, Kinds
from gearopt.optimise.terms import Array

# variables; up to there casadi takes milliseconds for the dense Hessian of a row
DENSE_VARIABLES = 50
GROUP = 16  # terms of one epigraph
DEEP = 30  # sums in products in sums; what is nested deeper stays as it is


@dataclass(frozen=True)
class Split:
    """A problem as Ipopt takes it: casadi expressions of z = (y, u) and p; start(y, p) -> u.

    The objective, inequalities (<= 0) and equalities (= 0) of a form; levels (<= 0) hold each u.
    """

    z: Any
    p: Any
    objective: Any
    inequalities: Any
    equalities: Any
    levels: Any
    start: Any


class _Pair(NamedTuple):
    """An expression of y and u, and the same by y alone, with every u on its row."""

    split: Any
    exact: Any


def split(shape: Form, kinds: Kinds) -> Split:
    """Return the program of a form; without u where no logarithm is wide."""
    import casadi as ca

    y, p, f, g, h = shape.expressions
    read = ca.Function("read", [y, p], [f, g, h])
    widths = [_widths(read.jac_sparsity(k, 0)) for k in range(3)]
    if not any((found > DENSE_VARIABLES).any() for found in widths):
        no = type(y)(0, 1)
        return Split(y, p, f, g, h, no, ca.Function("start", [y, p], [no]))
    y, p = ca.SX.sym("y", y.numel()), ca.SX.sym("p", p.numel())
    parts = read.expand().call([y, p])
    levels = _Levels(y)
    logs = (
        [kinds.objective <= POSYNOMIAL],
        [k <= POSYNOMIAL for k in kinds.inequalities],
        [k <= MONOMIAL for k in kinds.equalities],
    )
    objective, inequalities, equalities = (
        levels.rows_of(
            part, [log and n > DENSE_VARIABLES for log, n in zip(which, wide, strict=True)]
        )
        for part, which, wide in zip(parts, logs, widths, strict=True)
    )
    return Split(
        ca.vertcat(y, *levels.symbols),
        p,
        objective,
        inequalities,
        equalities,
        ca.vertcat(ca.SX(0, 1), *levels.rows),
        ca.Function("start", [y, p], [ca.vertcat(ca.SX(0, 1), *levels.exact)]),
    )


def _widths(sparsity: Any) -> Any:
    """Return number of variables of every row."""
    return np.bincount(np.array(sparsity.row(), int), minlength=sparsity.size1())


class _Levels:
    """The u of a form so far; it has state because sums are split one inside the other.

    symbols: the u; rows: what holds each; exact: its value on that row, by y alone.
    """

    def __init__(self, y: Any) -> None:
        import casadi as ca

        self.symbols: list[Any] = []
        self.rows: list[Any] = []
        self.exact: list[Any] = []
        self._own = {s.element_hash() for s in ca.vertsplit(y)}
        self._sums: dict[int, list[_Pair]] = {}  # split already, by node: other rows may share them

    def rows_of(self, part: Any, wide: list[bool]) -> Any:
        """Return rows of the form, those that are wide logarithms split."""
        import casadi as ca

        rows = ca.vertsplit(part) if part.numel() else []
        split_rows = [
            self._log(row.dep(0), 0).split if one and row.is_op(ca.OP_LOG) else row
            for row, one in zip(rows, wide, strict=True)
        ]
        return ca.vertcat(ca.SX(0, 1), *split_rows)

    def _width(self, expression: Any) -> int:
        """Return number of variables of an expression."""
        import casadi as ca

        return len(self._own & {s.element_hash() for s in ca.symvar(expression)})

    def _above(self, logarithm: _Pair) -> _Pair:
        """Return a new u that is at least a logarithm, as a term exp(u) of a sum."""
        import casadi as ca

        u = ca.SX.sym("u")
        self.symbols.append(u)
        self.rows.append(logarithm.split - u)
        self.exact.append(logarithm.exact)
        return _Pair(ca.exp(u), ca.exp(logarithm.exact))

    def _log(self, expression: Any, depth: int) -> _Pair:
        """Return the logarithm of a positive expression, as a sum over its factors."""
        import casadi as ca

        total = _Pair(ca.SX(0), ca.SX(0))
        for factor, power in _factors(expression):
            if factor.is_op(ca.OP_ADD) and depth < DEEP and self._width(factor) > DENSE_VARIABLES:
                logarithm = self._log_of_sum(factor, depth)
            elif factor.is_op(ca.OP_EXP):
                logarithm = _Pair(factor.dep(0), factor.dep(0))
            else:
                logarithm = _Pair(ca.log(factor), ca.log(factor))
            total = _Pair(
                total.split + power * logarithm.split, total.exact + power * logarithm.exact
            )
        return total

    def _log_of_sum(self, expression: Any, depth: int) -> _Pair:
        import casadi as ca

        terms, constant = [], ca.SX(0)
        for term in self._summands(expression):
            if isinstance(term, _Pair):
                terms.append(term)
                continue
            width = self._width(term)
            if width > DENSE_VARIABLES:
                terms.append(self._above(self._log(term, depth + 1)))
            elif width == 0:
                constant = constant + term  # it may be zero, and has no logarithm of its own
            else:
                terms.append(_Pair(term, term))
        terms[0] = _Pair(terms[0].split + constant, terms[0].exact + constant)
        while len(terms) > GROUP:
            groups = (terms[k : k + GROUP] for k in range(0, len(terms), GROUP))
            terms = [self._above(_log_of(group)) for group in groups]
        self._sums[expression.element_hash()] = terms
        return _log_of(terms)

    def _summands(self, expression: Any) -> list[Any]:
        """Return the terms of a sum; of a sum inside it that is split already, its exp(u)."""
        import casadi as ca

        terms, waiting = [], [expression]
        while waiting:
            summand = waiting.pop()
            if (node := summand.element_hash()) in self._sums:
                if len(self._sums[node]) > 1:
                    self._sums[node] = [self._above(_log_of(self._sums[node]))]
                terms += self._sums[node]
            elif summand.is_op(ca.OP_ADD):
                waiting += [summand.dep(1), summand.dep(0)]
            else:
                terms.append(summand)
        return terms


def _log_of(terms: list[_Pair]) -> _Pair:
    import casadi as ca

    return _Pair(*(ca.log(ca.sum1(ca.vertcat(*column))) for column in zip(*terms, strict=True)))


def _factors(expression: Any) -> list[tuple[Any, float]]:
    """Return [(factor, power)] of a product, all proven to be positive."""
    import casadi as ca

    factors: list[tuple[Any, float]] = []
    waiting = [(expression, 1.0)]
    while waiting:
        factor, power = waiting.pop()
        if factor.is_op(ca.OP_MUL):
            waiting += [(factor.dep(1), power), (factor.dep(0), power)]
        elif factor.is_op(ca.OP_DIV):
            waiting += [(factor.dep(1), -power), (factor.dep(0), power)]
        elif factor.is_op(ca.OP_TWICE):
            waiting += [(ca.SX(2.0), power), (factor.dep(0), power)]
        elif factor.is_op(ca.OP_SQ):
            waiting.append((factor.dep(0), 2.0 * power))
        elif factor.is_op(ca.OP_SQRT):
            waiting.append((factor.dep(0), 0.5 * power))
        elif factor.is_op(ca.OP_INV):
            waiting.append((factor.dep(0), -power))
        elif factor.is_op(ca.OP_POW) or factor.is_op(ca.OP_CONSTPOW):
            waiting.append((factor.dep(0), power * factor.dep(1)))
        else:
            factors.append((factor, power))
    return factors


SWING = 0.1  # of the variables' scale, over which the objective's is measured
SHARE = 1e-2  # of that is 1 in these units: complementarity of 1e-12 is then 1e-14 of it


@dataclass(frozen=True)
class Unit:
    """Units in which a solver sees a problem, powers of two: of y (n,), and of F."""

    variables: Array
    objective: float


def scaled(shape: Form, parts: Split, units: Any) -> tuple[Any, Any, Any, Any, Any]:
    """Return the variables that a solver sees, and F, G, H and levels of them."""
    import casadi as ca

    terms = [parts.objective, parts.inequalities, parts.equalities, parts.levels]
    if shape.logarithmic.all():
        return parts.z, *terms
    z, size = type(parts.z).sym("z", parts.z.numel()), len(shape.logarithmic)
    units = ca.vertcat(units, type(z).ones(z.numel() - size))
    return z, *ca.Function("terms", [parts.z, parts.p], terms)(z * units, parts.p)


def unit_at(problem: Problem, shape: Form, y: Array) -> Unit:
    """Return units in which natural variables have a scale of about 1 at y, objectives of 100."""
    x = shape.to_x(y)
    scales = np.where(shape.logarithmic, 1.0, sizes(problem, x))
    objective = 1.0 if shape.log_objective else SHARE * objective_scale(problem, x, SWING)
    return Unit(_power(scales), float(_power(np.array(objective))))


def _power(size: Array) -> Array:
    """Return the power of two next to each size, exact to multiply by; 1 where it is none."""
    known = np.isfinite(size) & (size > 0.0)
    power: Array = np.exp2(np.clip(np.round(np.log2(np.where(known, size, 1.0))), -900, 900))
    return power


OPTIONS = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-12,  # the dual bound is as tight as the multipliers
    "constr_viol_tol": 1e-12,
    "compl_inf_tol": 1e-12,
    "dual_inf_tol": 1e-9,
    "acceptable_tol": 1e-10,
    "acceptable_iter": 8,
    "bound_relax_factor": 0.0,  # the default buys 1e-8 of every bound
    "max_iter": 3000,
}


def program(z: Any, p: Any, f: Any, g: Any, size: int) -> tuple[Any, Any]:
    """Return Ipopt for a program in z, and its monitor, which sees the first `size` of z."""
    import casadi as ca

    monitor = _monitor_class()(z.numel(), g.numel(), size)
    options = {f"ipopt.{k}": v for k, v in OPTIONS.items()}
    options |= {
        "print_time": False,
        "iteration_callback": monitor,
        "error_on_fail": False,
        "show_eval_warnings": False,
        "calc_lam_p": False,  # nobody asks for them, and casadi warns where they are no numbers
    }
    if size > DENSE_VARIABLES:
        options |= dense_hessian(z, p, f, g)
    dense = ca.densify(f)  # of an objective that is constant, too
    return ca.nlpsol("ipopt", "ipopt", {"x": z, "p": p, "f": dense, "g": g}, options), monitor


def dense_hessian(z: Any, p: Any, f: Any, g: Any) -> dict[str, Any]:
    """Return the option that spares casadi the colouring of a dense Hessian (n^3 steps)."""
    import casadi as ca

    given = [z, p, type(z).sym("lam_f"), type(z).sym("lam_g", g.numel())]
    slope = ca.gradient(given[2] * f + ca.dot(given[3], g), z)
    if ca.Function("slope", given, [slope]).jac_sparsity(0, 0).nnz() <= DENSE_VARIABLES * z.numel():
        return {}
    names = ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]
    return {"hess_lag": ca.Function("hessian", given, [ca.triu(ca.jacobian(slope, z))], *names)}


@cache
def _monitor_class() -> Any:
    """Return the class of casadi's iteration callback (casadi is imported late)."""
    import casadi as ca

    class Monitor(ca.Callback):  # type: ignore[misc]
        """It has state because casadi calls it: follow(y) returns whether the run continues."""

        def __init__(self, n: int, m: int, size: int) -> None:
            super().__init__()
            self.sizes = {"f": 1, "x": n, "lam_x": n, "g": m, "lam_g": m}
            self.size = size
            self.follow: Callable[[Array], bool] = lambda y: True
            self.construct("monitor", {})

        def get_n_in(self) -> int:
            return int(ca.nlpsol_n_out())

        def get_n_out(self) -> int:
            return 1

        def get_name_in(self, i: int) -> Any:
            return ca.nlpsol_out(i)

        def get_sparsity_in(self, i: int) -> Any:
            return ca.Sparsity.dense(self.sizes.get(ca.nlpsol_out(i), 0), 1)

        def eval(self, arguments: Any) -> list[int]:
            point = np.array(arguments[ca.nlpsol_out().index("x")]).ravel()
            return [int(not self.follow(point[: self.size]))]

    return Monitor
