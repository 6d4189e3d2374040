"""Wide logarithms split up for Ipopt: sums of many terms by epigraphs, products by their factors.

The logarithm of a sum over n variables has a dense Hessian: n^2 numbers at every iteration, and
casadi takes n^3 steps to write them down. Here a sum of more than WIDE variables becomes

    log(sum_k t_k) = log(sum_j exp(u_j)),   log(sum of GROUP terms t_k) <= u_j

level by level, and a product of many factors becomes the sum of their logarithms. The rows stay
log-convex, each u_j lies on its row wherever that counts, and the multiplier of the last sum is
that of the row. Only Ipopt sees this: certificates judge the form itself.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from gearopt.optimise.form import Form
from gearopt.optimise.tape import MONOMIAL, POSYNOMIAL, Kinds

WIDE = 50  # variables; up to there casadi takes milliseconds for the dense Hessian of a row
GROUP = 16  # terms of one epigraph
DEEP = 30  # sums in products in sums; what is nested deeper stays as it is


@dataclass(frozen=True)
class Split:
    """What Ipopt solves: casadi expressions of z = (y, u) and p; start(y, p) -> u.

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
    """The program of a form; without u where no logarithm is wide."""
    import casadi as ca

    y, p, f, g, h = shape.expressions
    read = ca.Function("read", [y, p], [f, g, h])
    widths = [_widths(read.jac_sparsity(k, 0)) for k in range(3)]
    if not any((found > WIDE).any() for found in widths):
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
        levels.rows_of(part, [log and n > WIDE for log, n in zip(which, wide, strict=True)])
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
    """Number of variables of every row."""
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
        """Rows of the form, those that are wide logarithms split."""
        import casadi as ca

        rows = ca.vertsplit(part) if part.numel() else []
        found = [
            self._log(row.dep(0), 0).split if one and row.is_op(ca.OP_LOG) else row
            for row, one in zip(rows, wide, strict=True)
        ]
        return ca.vertcat(ca.SX(0, 1), *found)

    def _width(self, expression: Any) -> int:
        """Number of variables of an expression."""
        import casadi as ca

        return len(self._own & {s.element_hash() for s in ca.symvar(expression)})

    def _above(self, logarithm: _Pair) -> _Pair:
        """A new u that is at least a logarithm, as a term exp(u) of a sum."""
        import casadi as ca

        u = ca.SX.sym("u")
        self.symbols.append(u)
        self.rows.append(logarithm.split - u)
        self.exact.append(logarithm.exact)
        return _Pair(ca.exp(u), ca.exp(logarithm.exact))

    def _log(self, expression: Any, depth: int) -> _Pair:
        """The logarithm of a positive expression, as a sum over its factors."""
        import casadi as ca

        total = _Pair(ca.SX(0), ca.SX(0))
        for factor, power in _factors(expression):
            if factor.is_op(ca.OP_ADD) and depth < DEEP and self._width(factor) > WIDE:
                one = self._log_of_sum(factor, depth)
            elif factor.is_op(ca.OP_EXP):
                one = _Pair(factor.dep(0), factor.dep(0))
            else:
                one = _Pair(ca.log(factor), ca.log(factor))
            total = _Pair(total.split + power * one.split, total.exact + power * one.exact)
        return total

    def _log_of_sum(self, expression: Any, depth: int) -> _Pair:
        import casadi as ca

        terms, constant = [], ca.SX(0)
        for term in self._summands(expression):
            if isinstance(term, _Pair):
                terms.append(term)
                continue
            width = self._width(term)
            if width > WIDE:
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
        """The terms of a sum; of a sum inside it that is split already, its exp(u)."""
        import casadi as ca

        found, waiting = [], [expression]
        while waiting:
            one = waiting.pop()
            if (node := one.element_hash()) in self._sums:
                if len(self._sums[node]) > 1:
                    self._sums[node] = [self._above(_log_of(self._sums[node]))]
                found += self._sums[node]
            elif one.is_op(ca.OP_ADD):
                waiting += [one.dep(1), one.dep(0)]
            else:
                found.append(one)
        return found


def _log_of(terms: list[_Pair]) -> _Pair:
    import casadi as ca

    return _Pair(*(ca.log(ca.sum1(ca.vertcat(*column))) for column in zip(*terms, strict=True)))


def _factors(expression: Any) -> list[tuple[Any, float]]:
    """[(factor, power)] of a product, of which the form has proven that all are positive."""
    import casadi as ca

    found: list[tuple[Any, float]] = []
    waiting = [(expression, 1.0)]
    while waiting:
        one, power = waiting.pop()
        if one.is_op(ca.OP_MUL):
            waiting += [(one.dep(1), power), (one.dep(0), power)]
        elif one.is_op(ca.OP_DIV):
            waiting += [(one.dep(1), -power), (one.dep(0), power)]
        elif one.is_op(ca.OP_TWICE):
            waiting += [(ca.SX(2.0), power), (one.dep(0), power)]
        elif one.is_op(ca.OP_SQ):
            waiting.append((one.dep(0), 2.0 * power))
        elif one.is_op(ca.OP_SQRT):
            waiting.append((one.dep(0), 0.5 * power))
        elif one.is_op(ca.OP_INV):
            waiting.append((one.dep(0), -power))
        elif one.is_op(ca.OP_POW) or one.is_op(ca.OP_CONSTPOW):
            waiting.append((one.dep(0), power * one.dep(1)))
        else:
            found.append((one, power))
    return found
