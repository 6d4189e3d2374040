"""A problem: parameters, variables, and one plain text that computes its terms.

The same text is run by numpy on whole populations (`Problem.batch`), traced once by casadi
(`Problem.traced`, for derivatives and certificates) and called compiled (`Problem.compiled`).
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.evaluation import at, evaluated, first_terms, terms_of
from gearopt.optimise.methods import check_methods
from gearopt.optimise.terms import (
    FALLING,
    SECTIONS,
    Array,
    Number,
    Param,
    Repeat,
    Terms,
    Var,
    check_text,
    flat,
    flatten,
    spread,
)

if TYPE_CHECKING:
    from pathlib import Path

    from gearopt.optimise.tape import Compiled, Traced


class Row(NamedTuple):
    """Name and kind (limits or defines) of one inequality."""

    name: str
    kind: str


class Rows(NamedTuple):
    """Names of everything a problem computes, in the order of its arrays."""

    objectives: tuple[str, ...]
    inequalities: tuple[Row, ...]
    equalities: tuple[str, ...]


class Batch(NamedTuple):
    """Terms of N points.

    F (N, nf): objectives. G (N, ng): limits and defines, <= 1. H (N, nh): equal rows, = 1.
    report: {name: array (N,) or (N, rows)}.
    """

    F: Array
    G: Array
    H: Array
    report: dict[str, Array]


def declared(problem: Any) -> tuple[type, tuple[Any, ...]]:
    """Return the class of a problem and the arguments it was made from."""
    return type(problem), tuple(getattr(problem, f.name) for f in fields(problem) if f.init)


@dataclass(frozen=True)
class Problem:
    """An optimisation problem: minimise one term under limits <= 1 and equal rows = 1.

    evaluate(x, p) -> Terms, in plain numpy text on scalars: x.name and p.name are scalars, or
    blocks of scalars for size > 1, to be indexed, unpacked and summed; arithmetic is with
    np.array(x.name). methods: {name: run(problem, budget, seed, watch) -> Outcome}, exact
    algorithms of its own, none named as one of gearopt's; watch(event) may always be called.
    vectorised: the text also takes arrays (N,) of N points for its scalars; where it does not say
    so, gearopt finds out whether it may (`evaluation`). relaxed: a continuous problem whose limits
    every point of this one meets, with the keys of a file at its parameters: what `explain` takes
    for the limits and their conflict. exact_limits(x) -> {name: utilisation}, of limits that a
    search sees only roughly: an answer is judged by them, too, and reported with them. It goes to
    other processes as it was declared, if its text is a function that they can import.
    """

    name: str
    variables: tuple[Var, ...]
    parameters: tuple[Param, ...]
    evaluate: Callable[[Any, Any], Terms]
    repeats: tuple[Repeat, ...] = ()
    methods: Mapping[str, Callable[..., Any]] = field(default_factory=dict)
    vectorised: bool = False
    relaxed: "Problem | None" = None
    exact_limits: Callable[[Array], Mapping[str, float]] | None = None
    memo: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_text(f"problem {self.name}", self.variables, self.evaluate)
        for word, items, kind in (
            ("parameters", self.parameters, Param),
            ("repeats", self.repeats, Repeat),
        ):
            if not isinstance(items, tuple) or not all(isinstance(q, kind) for q in items):
                raise ValueError(
                    f"problem {self.name}: {word} are a tuple of {kind.__name__}(...), such as "
                    f"({kind.__name__}(...),)"
                )
        if twice := _twice([r.name for r in self.repeats]):
            raise ValueError(f"problem {self.name}: repeat {twice!r} is declared twice")
        check_methods(self.name, self.methods)
        names = [v.name for v in self.variables]
        names += [v.name for r in self.repeats for v in r.variables]
        if twice := _twice(names):
            raise ValueError(f"problem {self.name}: variable {twice!r} is declared twice")
        if twice := _twice([q.name for q in self.parameters]):
            raise ValueError(f"problem {self.name}: parameter {twice!r} is declared twice")
        if not names:
            raise ValueError(f"problem {self.name} has no variables")

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Fields that copies and other processes build it from: all but traces and tables."""
        return declared(self)

    def _sharing(self, **changes: Any) -> "Problem":
        """The problem with other fields; traces and tables are kept."""
        other = replace(self, **changes)
        object.__setattr__(other, "memo", self.memo)
        return other

    def at(self, **values: Number) -> "Problem":
        """The problem with other parameter values; traces and tables are kept."""
        known = {q.name for q in self.parameters}
        if unknown := set(values) - known:
            raise ValueError(f"problem {self.name} has no parameter {unknown.pop()!r}")
        parameters = tuple(replace(q, value=values.get(q.name, q.value)) for q in self.parameters)
        return self._sharing(parameters=parameters)

    @cached_property
    def columns(self) -> tuple[tuple[Var, str], ...]:
        """Return variable and printed name of every component of a point, in order."""
        columns = [(v, _name(v.name, v.size, k)) for v in self.variables for k in range(v.size)]
        for r in self.repeats:
            columns += [
                (v, f"{r.name}[{row + 1}].{_name(v.name, v.size, k)}")
                for row in range(r.count)
                for v in r.variables
                for k in range(v.size)
            ]
        return tuple(columns)

    def within(self, name: str, lower: Number, upper: Number) -> "Problem":
        """The problem with other bounds of one shared variable; traces and tables are kept."""
        if name not in {v.name for v in self.variables}:
            raise ValueError(f"problem {self.name} has no variable {name!r}")
        variables = tuple(
            replace(v, lower=lower, upper=upper, guess=_between(v, lower, upper))
            if v.name == name
            else v
            for v in self.variables
        )
        return self._sharing(variables=variables)

    def starting(self, point: Array) -> "Problem":
        """Return the same problem, of shared variables alone, with another guess."""
        other = self._sharing()
        lower, upper, _ = self.bounds()
        other.__dict__["_bounds"] = lower, upper, np.clip(point, lower, upper)
        return other

    def bounded(self, lower: Array, upper: Array) -> "Problem":
        """Return the same problem with other bounds (n,) of all variables."""
        other = self._sharing()
        other.__dict__["_bounds"] = lower, upper, np.clip(self.bounds()[2], lower, upper)
        return other

    def holding(self, point: Array) -> "Problem":
        """Return the same problem with its discrete variables fixed at a point's."""
        discrete = np.array([v.discrete for v, _ in self.columns])
        repeats = tuple(replace(r, variables=_continuous(r.variables)) for r in self.repeats)
        other = self._sharing(variables=_continuous(self.variables), repeats=repeats)
        lower, upper, guess = (np.where(discrete, point, b) for b in self.bounds())
        other.__dict__["_bounds"] = lower, upper, guess
        return other

    def bounds(self) -> tuple[Array, Array, Array]:
        """Return lower bounds, upper bounds and guess of a point (n,); not to be written to."""
        return self._bounds

    @cached_property
    def _bounds(self) -> tuple[Array, Array, Array]:
        parts = [_bounds(self.variables)]
        for r in self.repeats:
            lower, upper, guess = (np.tile(a, r.count) for a in _bounds(r.variables))
            parts.append((lower, upper, guess))
        lower, upper, guess = (np.concatenate(c) for c in zip(*parts, strict=True))
        return lower, upper, guess

    def parameter_values(self) -> Array:
        """Return all parameter values in order, (np,)."""
        return self._parameter_values.copy()

    @cached_property
    def _parameter_values(self) -> Array:
        return np.concatenate([spread(q.value, q.size) for q in self.parameters] or [np.empty(0)])

    def text(self, x: Any, p: Any) -> Terms:
        """Terms of the text for scalars by name: comparisons as rows, all objectives minimised."""
        terms: Terms = evaluated(self, None, x, p, {})
        return terms

    def batch(self, points: Array) -> Batch:
        """Evaluate the text on points (N, n) with numpy."""
        points = np.asarray(points, float) + 0.0  # so that no zero is -0.0
        if points.ndim != 2 or points.shape[1] != len(self.columns):
            raise ValueError(
                f"{self.name}: points are (N, {len(self.columns)}), not {points.shape}"
            )
        count, start = len(points), sum(v.size for v in self.variables)
        shared, rows = points[:, :start], self.rows
        objectives: dict[str, Array] = dict.fromkeys(rows.objectives, np.zeros(count))
        blocks: list[Any] = []
        report: dict[str, Array] = {}
        for r in (None, *self.repeats):
            width = r.count * r.width if r else 0
            repeated = points[:, start : start + width].reshape(count, r.count if r else 1, -1)
            terms = terms_of(self, r, shared, repeated)
            for name, value in terms.minimise.items():
                each = np.broadcast_to(value, (count, r.count) if r else (count,))
                objectives[name] = objectives[name] + (each.sum(axis=1) if r else each)
            blocks.append((flatten(terms), count, r.count if r else 1))
            prefix = f"{r.name}." if r else ""
            report |= {f"{prefix}{name}": np.asarray(v) for name, v in flat(terms.report)}
            start += width
        g, h = (
            np.concatenate([_matrix(b[k], n, m) for b, n, m in blocks], axis=1) for k in range(2)
        )
        if g.shape[1] != len(rows.inequalities) or h.shape[1] != len(rows.equalities):
            raise SolveError(f"the text of {self.name} returns other rows at other parameters")
        return Batch(np.column_stack(list(objectives.values())), g, h, report)

    @property
    def rows(self) -> Rows:
        """Return names of objectives, inequalities and equalities, in the order of `batch`."""
        if "rows" not in self.memo:
            self.memo["rows"] = self._read_rows()
        rows: Rows = self.memo["rows"]
        return rows

    def names(self, repeat: Repeat | None) -> dict[str, list[str]]:
        """Return names of all terms of a text, as it gives them at the guess, or near it."""
        key = ("names", repeat and repeat.name)
        if key not in self.memo:
            if repeat is None:
                terms = first_terms(self)
            else:
                guess, repeated = (_bounds(v)[2] for v in (self.variables, repeat.variables))
                terms = at(self, repeat, guess, repeated, 0)
            self.memo[key] = {part: [n for n, _ in flat(getattr(terms, part))] for part in SECTIONS}
        names: dict[str, list[str]] = self.memo[key]
        return names

    def _read_rows(self) -> Rows:
        names = self.names(None)
        objectives = list(names["minimise"])
        limits = [Row(name, kind) for kind in ("limits", "defines") for name in names[kind]]
        equal = list(names["equal"])
        for r in self.repeats:
            names = self.names(r)
            objectives += [name for name in names["minimise"] if name not in objectives]
            for k in range(1, r.count + 1):
                limits += [
                    Row(f"{r.name}.{n}[{k}]", kind)
                    for kind in ("limits", "defines")
                    for n in names[kind]
                ]
                equal += [f"{r.name}.{n}[{k}]" for n in names["equal"]]
        if not objectives:
            raise SolveError(
                f"problem {self.name} minimises nothing: Terms(minimise={{...}}) is empty"
            )
        if twice := _twice([row.name for row in limits] + equal):
            raise SolveError(f"problem {self.name}: two rows are named {twice!r}")
        return Rows(tuple(objectives), tuple(limits), tuple(equal))

    def traced(self) -> "Traced":
        """Return the text as casadi functions, traced once; SolveError where it cannot be."""
        from gearopt.optimise.tape import trace

        key = "not traced", self.parameter_values().tobytes()
        if (refused := self.memo.get(key)) is not None:
            raise SolveError(str(refused)) from refused.__cause__
        if "traced" not in self.memo:
            try:
                self.memo["traced"] = trace(self)
            except SolveError as reason:
                self.memo[key] = reason  # not to wait once more
                raise
        traced: Traced = self.memo["traced"]
        return traced

    def compiled(self) -> "Compiled":
        """Return A fast callable for one point at a time, on the traced text."""
        from gearopt.optimise.tape import Compiled

        return Compiled(self)

    def check_units(self) -> dict[str, str]:
        """Return the units of objectives and reports; SolveError names what has the wrong one.

        The text is run once by pint (`exchange.units`).
        """
        from gearopt.optimise.exchange.units import check

        return check(self)

    def to_nl(self, file: "str | Path") -> None:
        """Write AMPL's .nl file, with FILE.col and FILE.row beside it (`exchange.nl`)."""
        from gearopt.optimise.exchange.nl import write

        write(self, file)

    def to_pymoo(self) -> Any:
        """Return the problem as a `pymoo.core.problem.Problem` (`exchange.pymoo`)."""
        from gearopt.optimise.exchange.pymoo import exported

        return exported(self)

    @staticmethod
    def from_pymoo(problem: Any, name: str = "") -> "Problem":
        """Return a pymoo problem as a `Problem` without derivatives (`exchange.pymoo`)."""
        from gearopt.optimise.exchange.pymoo import imported

        return imported(problem, name)


def one_objective(name: str, objectives: tuple[str, ...]) -> None:
    """Raise SolveError where a problem has several objectives."""
    if len(objectives) != 1:
        first, second = sorted(objectives[:2], key=lambda n: not n.startswith(FALLING))
        names = [n.removeprefix(FALLING) for n in (*objectives, first, second)]
        way = "maximise" if first.startswith(FALLING) else "minimise"
        limit = " >= p.least" if second.startswith(FALLING) else " / p.most"
        raise SolveError(
            f"{name} has {len(objectives)} objectives ({', '.join(names[:-2])}), and solve takes "
            "one: ask gearopt.pareto for their front, weigh them in one term, or make one a limit, "
            f"such as limits={{'{names[-1]}': {names[-1]}{limit}}} beside "
            f"{way}={{'{names[-2]}': {names[-2]}}}"
        )


def _twice(names: list[str]) -> str | None:
    """Return A name that stands twice in a list."""
    return next((name for name, times in Counter(names).items() if times > 1), None)


def _matrix(values: list[Any], count: int, rows: int) -> Array:
    """Return a block of values ((count,) or (count, rows)) as (count, rows*len(values))."""
    if not values:
        return np.empty((count, 0))
    shape = (count,) if rows == 1 else (count, rows)
    stacked = [np.broadcast_to(v if np.ndim(v) < 2 or rows > 1 else v[:, 0], shape) for v in values]
    return np.stack(stacked, axis=-1).astype(float).reshape(count, -1)


def _bounds(variables: tuple[Var, ...]) -> tuple[Array, Array, Array]:
    def column(name: str) -> Array:
        return np.concatenate(
            [spread(getattr(v, name), v.size) for v in variables] or [np.empty(0)]
        )

    return column("lower"), column("upper"), column("guess")


def _continuous(variables: tuple[Var, ...]) -> tuple[Var, ...]:
    return tuple(replace(v, integer=False, values=None) for v in variables)


def _between(variable: Var, lower: Number, upper: Number) -> Number:
    """Return the guess of a variable, moved into other bounds."""
    ends = (spread(v, variable.size) for v in (variable.guess, lower, upper))
    return tuple(float(v) for v in np.clip(*ends))


def _name(name: str, size: int, k: int) -> str:
    return name if size == 1 else f"{name}[{k + 1}]"
