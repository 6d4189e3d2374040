"""The second kind of problem: linear, convex quadratic and second-order cone text in cvxpy.

The text is run once on cvxpy variables and canonicalised once (DPP). New parameter values are
re-solved without building anything again, and points are judged on the user's own expressions.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.evaluation import blaming
from gearopt.optimise.problem import Batch, Problem, Row, Rows, declared, one_objective
from gearopt.optimise.terms import (
    Array,
    Named,
    Number,
    Param,
    Terms,
    Var,
    checked,
    flat,
    minimised,
    spread,
)


@dataclass(frozen=True)
class Model:
    """A text as cvxpy holds it: parameters to set, values to read.

    inverses: 1/p of every parameter, for the text to multiply by; divided: ids of those it uses.
    blocks: (kind, expression (k,)) of limits, defines and equal rows, in the order of `names`.
    shifts: a cvxpy parameter (rows,); row k is held to 1 - shifts[k].
    """

    problem: Any
    variables: tuple[Any, ...]
    parameters: tuple[Any, ...]
    inverses: tuple[Any, ...]
    divided: frozenset[int]
    objective: Any
    blocks: tuple[tuple[str, Any], ...]
    report: Mapping[str, Any]
    rows: Rows
    shifts: Any


@dataclass(frozen=True)
class Conic:
    """A convex problem in cvxpy text: one objective, limits <= 1, equal rows = 1, or comparisons.

    evaluate(x, p) -> Terms: x.name are cvxpy variables made from `Var` (vectors for size > 1),
    p.name cvxpy parameters, p.per.name their inverses (a cvxpy text that divides by a parameter
    cannot keep its canonical form). What is minimised, limits and defines are convex by cvxpy's
    rules, equal rows affine; a vector expression is a block name[1], name[2], ... Variables with
    `integer` or `values` are branched on. ValueError for names declared twice.
    """

    name: str
    variables: tuple[Var, ...]
    parameters: tuple[Param, ...]
    evaluate: Callable[[Any, Any], Terms]
    memo: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)
    start: Array | None = field(default=None, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        _ = self._declared

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Fields that copies and other processes build it from: all but the canonical data."""
        return declared(self)

    @cached_property
    def _declared(self) -> Problem:
        """Return the same declarations; its text is never run."""
        return Problem(self.name, self.variables, self.parameters, self.evaluate)

    @property
    def methods(self) -> Mapping[str, Callable[..., Any]]:
        """Return algorithms of its own: none."""
        return {}

    def at(self, **values: Number) -> "Conic":
        """The same problem with other parameter values; its canonical data are kept."""
        other = replace(self, parameters=self._declared.at(**values).parameters)
        object.__setattr__(other, "memo", self.memo)
        return other

    def starting(self, point: Array) -> "Conic":
        """Return the same problem with a first design (n,) for branch and bound, `start`."""
        other = replace(self)
        object.__setattr__(other, "memo", self.memo)
        object.__setattr__(other, "start", point)
        return other

    @property
    def columns(self) -> tuple[tuple[Var, str], ...]:
        """Return variable and printed name of every component of a point, in order."""
        return self._declared.columns

    @property
    def rows(self) -> Rows:
        """Return names of objectives, inequalities and equalities, in the order of `batch`."""
        return self.model().rows

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives of the text, which may be several."""
        signs = tuple(_sign(spread(q.value, q.size)) for q in self.parameters)
        return tuple(_symbols(self, signs)[-1].minimise)

    def bounds(self) -> tuple[Array, Array, Array]:
        """Return lower bounds, upper bounds and guess of a point (n,); not to be written to."""
        return self._declared.bounds()

    def parameter_values(self) -> Array:
        """Return all parameter values in order, (np,)."""
        return self._declared.parameter_values()

    def model(self) -> Model:
        """Return the text on cvxpy variables, with the parameter values set.

        cvxpy's rules rest on signs, so values of another sign are another model.
        """
        values = [spread(q.value, q.size) for q in self.parameters]
        signs = tuple(_sign(v) for v in values)
        if ("model", signs) not in self.memo:
            self.memo["model", signs] = _build(self, signs)
        model: Model = self.memo["model", signs]
        for parameter, inverse, value in zip(model.parameters, model.inverses, values, strict=True):
            parameter.value = value if parameter.ndim else float(value[0])
            if (value != 0).all():
                inverse.value = 1.0 / parameter.value
            elif inverse.id in model.divided:
                raise SolveError(f"{self.name} divides by a parameter that is zero")
        return model

    def text(self, x: Any, p: Any) -> Terms:
        """Terms of the text on cvxpy's expressions, all objectives minimised."""
        terms: Terms = minimised(self.evaluate(x, p))
        return terms

    def batch(self, points: Array) -> Batch:
        """Evaluate the user's own expressions at points (N, n) by cvxpy, one after the other."""
        model = self.model()
        evaluated = [self._at(model, x) for x in np.asarray(points, float)]
        f, g, h, reports = zip(*evaluated, strict=True)
        report = {name: np.array([r[name] for r in reports]) for name in reports[0]}
        return Batch(np.array(f)[:, None], np.array(g), np.array(h), report)

    @np.errstate(all="ignore")  # 1/0 is infinite, and infinite is not feasible
    def _at(self, model: Model, x: Array) -> tuple[float, Array, Array, dict[str, Any]]:
        start = 0
        for variable in model.variables:
            part = x[start : start + variable.size]
            variable.save_value(part if variable.ndim else part[0])
            start += variable.size
        kinds: dict[bool, list[Array]] = {True: [np.empty(0)], False: [np.empty(0)]}
        for kind, expression in model.blocks:
            kinds[kind == "equal"].append(np.ravel(expression.value))
        report = {name: np.squeeze(e.value) for name, e in model.report.items()}
        value = float(np.ravel(model.objective.value)[0])
        return value, np.concatenate(kinds[False]), np.concatenate(kinds[True]), report


def _sign(values: Array) -> str:
    return "nonneg" if (values >= 0).all() else "nonpos" if (values <= 0).all() else ""


def _symbols(problem: Conic, signs: tuple[str, ...]) -> tuple[Any, Any, Any, Terms]:
    """Return variables, parameters and their inverses of cvxpy, and the text on them."""
    import cvxpy as cp

    variables = tuple(
        cp.Variable(() if v.size == 1 else v.size, name=f"x.{v.name}", **_known_sign(v))
        for v in problem.variables
    )
    parameters, inverses = (
        tuple(
            cp.Parameter(() if q.size == 1 else q.size, **({sign: True} if sign else {}))
            for q, sign in zip(problem.parameters, signs, strict=True)
        )
        for _ in range(2)
    )
    x = Named(**{v.name: made for v, made in zip(problem.variables, variables, strict=True)})
    names = [q.name for q in problem.parameters]
    per = Named(**dict(zip(names, inverses, strict=True)))
    p = Named(**{"per": per, **dict(zip(names, parameters, strict=True))})
    with blaming(problem.evaluate, problem.name, "run on cvxpy variables"):
        terms = problem.text(x, p)
    numbers = [spread(v.guess, v.size) for v in problem.variables]
    numbers += [spread(q.value, q.size) for q in problem.parameters]
    for symbol, value in zip((*variables, *parameters), numbers, strict=True):
        symbol.value = value if symbol.ndim else float(value[0])
    terms = _as_rows(checked(terms, problem.name), problem.memo.setdefault("scales", {}))
    return variables, parameters, inverses, terms


def _as_rows(terms: Terms, scales: dict[str, Any]) -> Terms:
    """Terms with cvxpy's comparisons made rows, 1 + (lesser - greater)/scale.

    scales: by name, the larger of both sides at the guess, as the first model finds it.
    """
    import cvxpy as cp

    parts: dict[str, dict[str, Any]] = {part: {} for part in ("limits", "defines", "equal")}
    for part, section in parts.items():
        for name, value in flat(getattr(terms, part)):
            balance = isinstance(value, cp.constraints.Equality)
            if balance or isinstance(value, cp.constraints.Inequality):
                lesser, greater = value.args
                if name not in scales:
                    sides = [np.abs(e.value) for e in value.args if e.value is not None]
                    larger = np.max(np.broadcast_arrays(*sides, 0.0), axis=0)
                    scales[name] = np.where((larger > 0.0) & np.isfinite(larger), larger, 1.0)
                value = 1.0 + cp.multiply(1.0 / scales[name], lesser - greater)
            (parts["equal"] if balance else section)[name] = value
    return replace(terms, **parts)


def _build(problem: Conic, signs: tuple[str, ...]) -> Model:
    import cvxpy as cp

    variables, parameters, inverses, terms = _symbols(problem, signs)
    if not terms.minimise:
        raise SolveError(f"problem {problem.name} minimises nothing: Terms({{}}) is empty")
    one_objective(problem.name, tuple(terms.minimise))
    name, objective = next(iter(terms.minimise.items()))
    objective = _expression(objective, problem.name, name)
    if objective.size != 1:
        raise SolveError(f"{problem.name}: the objective {name} is not a scalar")
    rows_of_text = [
        (kind, label, _expression(value, problem.name, label))
        for kind in ("limits", "defines", "equal")
        for label, value in flat(getattr(terms, kind))
    ]
    for kind, label, expression in (("minimise", name, objective), *rows_of_text):
        _refuse(problem.name, kind, label, expression)
    named = [(kind, n) for kind, label, e in rows_of_text for n in _names(label, e)]
    if twice := next((n for n, k in Counter(n for _, n in named).items() if k > 1), None):
        raise SolveError(f"problem {problem.name}: two rows are named {twice!r}")
    rows = Rows(
        (name,),
        tuple(Row(n, kind) for kind, n in named if kind != "equal"),
        tuple(n for kind, n in named if kind == "equal"),
    )
    shifts = cp.Parameter(max(1, len(named)), value=np.zeros(max(1, len(named))))
    constraints, start = [], 0
    for kind, _, expression in rows_of_text:
        held = 1.0 - shifts[start : start + expression.size]
        constraints.append(expression == held if kind == "equal" else expression <= held)
        start += expression.size
    report = {n: _expression(v, problem.name, n) for n, v in flat(terms.report)}
    blocks = tuple((kind, e) for kind, _, e in rows_of_text)
    whole = cp.Problem(cp.Minimize(cp.sum(objective)), constraints)
    used = frozenset(one.id for one in whole.parameters())
    return Model(
        whole, variables, parameters, inverses, used, objective, blocks, report, rows, shifts
    )


def _known_sign(variable: Var) -> dict[str, bool]:
    """Sign from which cvxpy may conclude curvature."""
    lower, upper = spread(variable.lower, variable.size), spread(variable.upper, variable.size)
    if (lower >= 0).all():
        return {"nonneg": True}
    return {"nonpos": True} if (upper <= 0).all() else {}


def _expression(value: Any, where: str, label: str) -> Any:
    """Return A term as a cvxpy expression (k,)."""
    import cvxpy as cp

    if isinstance(value, cp.constraints.constraint.Constraint):
        raise SolveError(
            f"{where}: {label} is a constraint of its own; write <=, >= or == between expressions"
        )
    expression = value if isinstance(value, cp.Expression) else cp.Constant(value)
    return cp.reshape(expression, (expression.size,), order="C")


def _refuse(where: str, kind: str, label: str, expression: Any) -> None:
    """Raise SolveError unless cvxpy proves the curvature, for any values of the parameters."""
    wanted = "affine" if kind == "equal" else "convex"
    if not getattr(expression, f"is_{wanted}")():
        raise SolveError(f"{where}: {kind} {label} is not {wanted} by cvxpy's rules")
    if not expression.is_dpp():
        raise SolveError(
            f"{where}: {kind} {label} is not affine in the parameters (cvxpy's DPP rules); "
            "multiply by p.per.NAME to divide by a parameter, or declare a combination as one"
        )


def _names(label: str, expression: Any) -> list[str]:
    if expression.size == 1:
        return [label]
    return [f"{label}[{k + 1}]" for k in range(expression.size)]
