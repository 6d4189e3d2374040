"""What a problem is: parameters, variables, and one plain text that computes its terms.

The same text is run by numpy on whole populations (`Problem.batch`), traced once by casadi
(`Problem.traced`, for derivatives and certificates) and called compiled (`Problem.compiled`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gearopt.optimise.trace import Compiled, Traced

Array = NDArray[np.float64]
Number = float | tuple[float, ...]


@dataclass(frozen=True)
class Param:
    """A number that a sweep, a homotopy, a sensitivity or a repair may change.

    name: an identifier; unit: text for reports ("" for a pure number); value: a float, or `size`
    floats; key: its place in the problem file, if it has one.
    """

    name: str
    unit: str
    value: Number
    size: int = 1
    key: str = ""


@dataclass(frozen=True)
class Var:
    """A variable of `size` components; lower, upper and guess are one float or one a component.

    log: positive and searched as its logarithm. integer: whole numbers only. values: the finite
    set a component may take (module series, grades). Infinite bounds are allowed, but without
    finite ones no dual bound can be computed.
    """

    name: str
    unit: str
    lower: Number
    upper: Number
    guess: Number
    size: int = 1
    integer: bool = False
    log: bool = False
    values: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        lower, upper, guess = (spread(v, self.size) for v in (self.lower, self.upper, self.guess))
        if not self.name.isidentifier():
            raise ValueError(f"variable name {self.name!r} is not an identifier")
        if not np.all((lower <= guess) & (guess <= upper)):
            raise ValueError(f"variable {self.name}: needs lower <= guess <= upper")
        if self.log and not np.all(lower > 0):
            raise ValueError(f"variable {self.name}: a log variable needs lower > 0")

    @property
    def discrete(self) -> bool:
        """Whether only some values are allowed."""
        return self.integer or self.values is not None


@dataclass(frozen=True)
class Terms:
    """What an evaluation returns: {name: scalar, or a tuple = a block name[1], name[2], ...}.

    minimise: objectives. limits: the user's utilisations, <= 1. defines: model rows <= 1
    (epigraphs, couplings), never relaxed nor shown. equal: quotients that must be 1.
    report: values to show, of no effect.
    """

    minimise: Mapping[str, Any]
    limits: Mapping[str, Any] = field(default_factory=dict)
    defines: Mapping[str, Any] = field(default_factory=dict)
    equal: Mapping[str, Any] = field(default_factory=dict)
    report: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Repeat:
    """One block of text for every row of data (a speed, a pose, a grid point).

    variables: each row has its own copy. data: {name: array (rows,)}. evaluate(x, p, row) -> Terms
    sees the shared and its own variables in x; its `minimise` terms are added, over the rows, to
    the problem's terms of the same name; rows are named `repeat.limit[row]`.
    """

    name: str
    variables: tuple[Var, ...]
    data: Mapping[str, Array]
    evaluate: Callable[[Any, Any, Any], Terms]

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(next(iter(self.data.values())))

    @property
    def width(self) -> int:
        """Number of scalar variables of one row."""
        return sum(v.size for v in self.variables)


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
    """Terms of N points: objectives F (N, nf), limits and defines G (N, ng) <= 1, equal rows
    H (N, nh) = 1; report {name: array (N,) or (N, rows)}.
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
        twice = {name for name in names if names.count(name) > 1}
        if twice:
            raise ValueError(f"problem {self.name}: variable {twice.pop()!r} is declared twice")

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

    def bounds(self) -> tuple[Array, Array, Array]:
        """Lower bounds, upper bounds and guess of a point, each (n,)."""
        shared, own = _bounds(self.variables), [_bounds(r.variables) for r in self.repeats]
        parts = [shared] + [tuple(np.tile(a, r.count) for a in b) for r, b in zip(
            self.repeats, own, strict=True)]
        lower, upper, guess = (np.concatenate(column) for column in zip(*parts, strict=True))
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
        terms = self.evaluate(x, p)
        objectives = dict(terms.minimise)
        limits = [Row(name, kind) for name, _, kind in inequalities(terms)]
        equal = [name for name, _ in flat(terms.equal)]
        for r in self.repeats:
            both = SimpleNamespace(**vars(x))
            both.__dict__.update(vars(namespace(r.variables, list(_bounds(r.variables)[2]))))
            row = SimpleNamespace(**{k: float(v[0]) for k, v in r.data.items()})
            found = r.evaluate(both, p, row)
            objectives |= found.minimise
            for k in range(1, r.count + 1):
                limits += [Row(f"{r.name}.{n}[{k}]", kind) for n, _, kind in inequalities(found)]
                equal += [f"{r.name}.{n}[{k}]" for n, _ in flat(found.equal)]
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


def spread(value: Number, size: int) -> Array:
    """One float, or `size` floats, as an array (size,)."""
    return np.broadcast_to(np.asarray(value, float), (size,)).copy()


def namespace(declared: tuple[Any, ...], scalars: list[Any]) -> SimpleNamespace:
    """Scalars by name: one for size 1, a tuple for more."""
    found: dict[str, Any] = {}
    start = 0
    for item in declared:
        part = tuple(scalars[start : start + item.size])
        found[item.name] = part[0] if item.size == 1 else part
        start += item.size
    return SimpleNamespace(**found)


def flat(block: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """[(name or name[k], scalar)] of a block of terms; k counts from 1, as stages do."""
    found: list[tuple[str, Any]] = []
    for name, value in block.items():
        if isinstance(value, tuple | list):
            found += [(f"{name}[{k}]", v) for k, v in enumerate(value, 1)]
        else:
            found.append((name, value))
    return found


def inequalities(terms: Terms) -> list[tuple[str, Any, str]]:
    """Name, value and kind of every inequality: limits first, then defines."""
    return [(n, v, "limits") for n, v in flat(terms.limits)] + [
        (n, v, "defines") for n, v in flat(terms.defines)
    ]


def flatten(terms: Terms) -> tuple[list[Any], list[Any]]:
    """Values of the inequalities and of the equalities, in order."""
    return [v for _, v, _ in inequalities(terms)], [v for _, v in flat(terms.equal)]


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


def _name(name: str, size: int, k: int) -> str:
    return name if size == 1 else f"{name}[{k + 1}]"
