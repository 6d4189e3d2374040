"""What a problem is: parameters, variables, and one plain text that computes its terms.

The same text is run by numpy on whole populations (`Problem.batch`), traced once by casadi
(`Problem.traced`, for derivatives and certificates) and called compiled (`Problem.compiled`).
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.terms import (
    Array,
    Named,
    Number,
    Param,
    Repeat,
    Terms,
    Var,
    checked,
    flat,
    flatten,
    inequalities,
    namespace,
    spread,
)

if TYPE_CHECKING:
    from gearopt.optimise.trace import Compiled, Traced


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


@dataclass(frozen=True)
class Problem:
    """An optimisation problem: minimise one term under limits <= 1 and equal rows = 1.

    evaluate(x, p) -> Terms, in plain numpy text on scalars: x.name and p.name are scalars, or
    tuples of scalars for size > 1. methods: {name: run(problem, budget, seed, watch) -> Outcome},
    the formulation's own exact algorithms.
    """

    name: str
    variables: tuple[Var, ...]
    parameters: tuple[Param, ...]
    evaluate: Callable[[Any, Any], Terms]
    repeats: tuple[Repeat, ...] = ()
    methods: Mapping[str, Callable[..., Any]] = field(default_factory=dict)
    memo: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        names = [v.name for v in self.variables]
        names += [v.name for r in self.repeats for v in r.variables]
        if twice := _twice(names):
            raise ValueError(f"problem {self.name}: variable {twice!r} is declared twice")
        if twice := _twice([q.name for q in self.parameters]):
            raise ValueError(f"problem {self.name}: parameter {twice!r} is declared twice")
        if not names:
            raise ValueError(f"problem {self.name} has no variables")

    def at(self, **values: Number) -> "Problem":
        """The same problem with other parameter values; what was traced and built is kept."""
        known = {q.name for q in self.parameters}
        if unknown := set(values) - known:
            raise ValueError(f"problem {self.name} has no parameter {unknown.pop()!r}")
        parameters = tuple(replace(q, value=values.get(q.name, q.value)) for q in self.parameters)
        other = replace(self, parameters=parameters)
        object.__setattr__(other, "memo", self.memo)
        return other

    @cached_property
    def columns(self) -> tuple[tuple[Var, str], ...]:
        """Variable and printed name of every component of a point, in order."""
        found = [(v, _name(v.name, v.size, k)) for v in self.variables for k in range(v.size)]
        for r in self.repeats:
            found += [
                (v, f"{r.name}[{row + 1}].{_name(v.name, v.size, k)}")
                for row in range(r.count)
                for v in r.variables
                for k in range(v.size)
            ]
        return tuple(found)

    def within(self, name: str, lower: Number, upper: Number) -> "Problem":
        """The same problem with other bounds of one shared variable; what was built is kept."""
        if name not in {v.name for v in self.variables}:
            raise ValueError(f"problem {self.name} has no variable {name!r}")
        variables = tuple(
            replace(v, lower=lower, upper=upper, guess=_between(v, lower, upper))
            if v.name == name
            else v
            for v in self.variables
        )
        other = replace(self, variables=variables)
        object.__setattr__(other, "memo", self.memo)
        return other

    def bounds(self) -> tuple[Array, Array, Array]:
        """Lower bounds, upper bounds and guess of a point, each (n,); not to be written to."""
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
        """All parameter values in order, (np,)."""
        return np.concatenate([spread(q.value, q.size) for q in self.parameters] or [np.empty(0)])

    def batch(self, points: Array) -> Batch:
        """Evaluate the text on points (N, n) with numpy."""
        points = np.asarray(points, float)
        count = len(points)
        p = namespace(self.parameters, list(self.parameter_values()))
        shared = sum(v.size for v in self.variables)
        x = namespace(self.variables, list(points[:, :shared].T))
        terms = self.evaluate(x, p)
        objectives = {name: np.broadcast_to(v, (count,)) for name, v in terms.minimise.items()}
        blocks = [(flatten(terms), count, 1)]
        report = {name: np.asarray(v) for name, v in flat(terms.report)}
        start = shared
        for r in self.repeats:
            stop = start + r.count * r.width
            own = points[:, start:stop].reshape(count, r.count, r.width)
            both = namespace(self.variables, list(points[:, :shared].T[:, :, None]))
            both.__dict__.update(vars(namespace(r.variables, list(np.moveaxis(own, 2, 0)))))
            row = SimpleNamespace(**{k: np.asarray(v)[None, :] for k, v in r.data.items()})
            found = r.evaluate(both, p, row)
            for name, value in found.minimise.items():
                total = np.broadcast_to(value, (count, r.count)).sum(axis=1)
                objectives[name] = objectives.get(name, 0.0) + total
            blocks.append((flatten(found), count, r.count))
            report |= {f"{r.name}.{name}": np.asarray(v) for name, v in flat(found.report)}
            start = stop
        return Batch(
            np.column_stack(list(objectives.values())),
            np.concatenate([_matrix(b[0], n, m) for b, n, m in blocks], axis=1),
            np.concatenate([_matrix(b[1], n, m) for b, n, m in blocks], axis=1),
            report,
        )

    @property
    def rows(self) -> Rows:
        """Names of objectives, inequalities and equalities, in the order of `batch`."""
        if "rows" not in self.memo:
            self.memo["rows"] = self._read_rows()
        found: Rows = self.memo["rows"]
        return found

    def _read_rows(self) -> Rows:
        p = namespace(self.parameters, list(self.parameter_values()))
        x = namespace(self.variables, list(_bounds(self.variables)[2]))
        terms = checked(self.evaluate(x, p), self.name)
        objectives = dict(terms.minimise)
        limits = [Row(name, kind) for name, _, kind in inequalities(terms)]
        equal = [name for name, _ in flat(terms.equal)]
        for r in self.repeats:
            both = Named(**vars(x))
            both.__dict__.update(vars(namespace(r.variables, list(_bounds(r.variables)[2]))))
            row = SimpleNamespace(**{k: float(v[0]) for k, v in r.data.items()})
            found = checked(r.evaluate(both, p, row), f"{self.name}.{r.name}")
            objectives |= found.minimise
            for k in range(1, r.count + 1):
                limits += [Row(f"{r.name}.{n}[{k}]", kind) for n, _, kind in inequalities(found)]
                equal += [f"{r.name}.{n}[{k}]" for n, _ in flat(found.equal)]
        if twice := _twice([row.name for row in limits] + equal):
            raise SolveError(f"problem {self.name}: two rows are named {twice!r}")
        return Rows(tuple(objectives), tuple(limits), tuple(equal))

    def traced(self) -> "Traced":
        """The text as casadi functions, traced once."""
        from gearopt.optimise.trace import trace

        if "traced" not in self.memo:
            self.memo["traced"] = trace(self)
        found: Traced = self.memo["traced"]
        return found

    def compiled(self) -> "Compiled":
        """A fast callable for one point at a time, on the traced text."""
        from gearopt.optimise.trace import Compiled

        return Compiled(self)


def _twice(names: list[str]) -> str | None:
    """A name that stands twice in a list."""
    return next((name for name, times in Counter(names).items() if times > 1), None)


def _matrix(values: list[Any], count: int, rows: int) -> Array:
    """Values of a block (each (count,) or (count, rows)) as (count, rows*len(values))."""
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


def _between(variable: Var, lower: Number, upper: Number) -> Number:
    """The guess of a variable, moved into other bounds."""
    ends = (spread(v, variable.size) for v in (variable.guess, lower, upper))
    return tuple(float(v) for v in np.clip(*ends))


def _name(name: str, size: int, k: int) -> str:
    return name if size == 1 else f"{name}[{k + 1}]"
