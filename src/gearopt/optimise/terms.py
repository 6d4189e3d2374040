"""The words a problem is written in: parameters, variables, terms and repeats."""

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearopt.errors import SolveError
from gearopt.frozen import dataclass

Array = NDArray[np.float64]
Number = float | tuple[float, ...]
SECTIONS = ("minimise", "limits", "defines", "equal", "report")
FALLING = "negative_of_"  # before the name of an objective that is maximised


@dataclass(frozen=True)
class Param:
    """A number that a sweep, a homotopy, a sensitivity or a repair may change.

    name: an identifier; unit: text for reports ("" for a pure number); value: a float, or `size`
    floats; key: its place in the problem file, if it has one. role: "data" stays as it is, a
    "limit" may be relaxed by `explain`, what is "given" (a duty, a fixed size) only where relaxing
    limits does not help; by default it is data, or a limit where it stands only as the number that
    limits are divided by. Of key and role one word, or one a component.
    """

    name: str
    unit: str
    value: Number
    size: int = 1
    key: str | tuple[str, ...] = ""
    role: str | tuple[str, ...] = ""

    def __post_init__(self) -> None:
        _check_numbers("parameter", self, ("value",))
        words = (self.role,) if isinstance(self.role, str) else self.role
        if unknown := set(words) - {"", "data", "limit", "given"}:
            raise ValueError(
                f"parameter {self.name}: no role {unknown.pop()!r}; data, limit, given"
            )


@dataclass(frozen=True)
class Var:
    """A variable of `size` components; lower, upper and guess are one float or one a component.

    log: positive and searched as its logarithm. integer: whole numbers only, and its values too.
    values: the finite set a component may take (module series, grades). Infinite bounds are
    allowed, but without finite ones no dual bound can be computed. search: the bounds are only the
    ends of a search, no limits of the user (a component whose bounds are equal is given by the
    user all the same). key: the place of its range [lower, upper] in the problem
    file, or the places of both.
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
    search: bool = False
    key: str | tuple[str, str] = ""

    def __post_init__(self) -> None:
        _check_numbers("variable", self, ("lower", "upper", "guess"))
        lower, upper, guess = (spread(v, self.size) for v in (self.lower, self.upper, self.guess))
        if not np.all((lower <= guess) & (guess <= upper)):
            raise ValueError(f"variable {self.name}: needs lower <= guess <= upper")
        if not np.isfinite(guess).all():
            raise ValueError(f"variable {self.name}: the guess is infinite; write a finite one")
        if self.log and not np.all(lower > 0):
            raise ValueError(f"variable {self.name}: a log variable needs lower > 0")
        if self.values is not None:
            values = _numbers(self.values)
            if (
                values is None
                or values.ndim != 1
                or not len(values)
                or not np.isfinite(values).all()
            ):
                raise ValueError(
                    f"variable {self.name}: values are finite numbers, such as values=(1.0, 1.25), "
                    f"not {self.values!r}"
                )
            if self.integer and (broken := values[values != np.round(values)]).size:
                raise ValueError(
                    f"variable {self.name}: {broken[0]:g} among its values is not whole; write "
                    "whole values, or integer=False"
                )

    @property
    def discrete(self) -> bool:
        """Return whether only some values are allowed."""
        return self.integer or self.values is not None


@dataclass(frozen=True)
class Terms:
    """Terms of an evaluation: {name: scalar, or a tuple = a block name[1], name[2], ...}.

    minimise, maximise: objectives. limits: the user's utilisations, <= 1, or comparisons, such as
    x.a <= x.b, x.a >= 2.0, x.a == x.b (`comparisons`). defines: model rows <= 1 (epigraphs,
    couplings), never relaxed nor shown. equal: quotients that must be 1, or comparisons by ==.
    report: values to show, of no effect.
    """

    minimise: Mapping[str, Any] = field(default_factory=dict)
    limits: Mapping[str, Any] = field(default_factory=dict)
    defines: Mapping[str, Any] = field(default_factory=dict)
    equal: Mapping[str, Any] = field(default_factory=dict)
    report: Mapping[str, Any] = field(default_factory=dict)
    maximise: Mapping[str, Any] = field(default_factory=dict)


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

    def __post_init__(self) -> None:
        _check_name("repeat", self.name)
        check_text(f"repeat {self.name}", self.variables, self.evaluate)
        if not isinstance(self.data, Mapping) or not self.data:
            raise ValueError(f"repeat {self.name}: data are columns of numbers, {{name: array}}")
        sizes = set()
        for name, column in self.data.items():
            _check_name(f"repeat {self.name}: data", name)
            values = _numbers(column)
            if values is None or values.ndim != 1 or not len(values) or np.isnan(values).any():
                raise ValueError(f"repeat {self.name}: data {name} are not a row of numbers")
            sizes.add(len(values))
        if len(sizes) > 1:
            raise ValueError(f"repeat {self.name}: its data differ in length: {sorted(sizes)}")

    @property
    def count(self) -> int:
        """Return number of rows."""
        return len(next(iter(self.data.values())))

    @property
    def width(self) -> int:
        """Return number of scalar variables of one row."""
        return sum(v.size for v in self.variables)


def _numbers(value: Any) -> Array | None:
    """Return a value as an array of floats; None where it is no real number or block."""
    try:
        array = np.asarray(value)
    except ValueError:  # of unequal lengths
        return None
    return array.astype(float) if array.dtype.kind in "iuf" else None


def _check_name(what: str, name: Any) -> None:
    if not isinstance(name, str) or not name.isidentifier():
        raise ValueError(f"{what} name {name!r} is not an identifier, such as face_width")


def _check_numbers(what: str, item: Any, keys: tuple[str, ...]) -> None:
    """Raise ValueError where a declared name, size or number is none."""
    _check_name(what, item.name)
    size = item.size
    if not isinstance(size, int | np.integer) or isinstance(size, bool) or size < 1:
        raise ValueError(f"{what} {item.name}: size is a whole number of at least 1, not {size!r}")
    for key in keys:
        value = _numbers(getattr(item, key))
        if value is None or np.isnan(value).any():
            given = getattr(item, key)
            raise ValueError(f"{what} {item.name}: {key} is {given!r}, no number or block of them")
        if value.ndim > 1 or value.size not in (1, size):
            raise ValueError(
                f"{what} {item.name}: {key} has the shape {value.shape}; write one number or {size}"
            )


def check_text(what: str, variables: Any, evaluate: Any) -> None:
    """Raise ValueError where variables or text of a problem or repeat are none."""
    if not isinstance(variables, tuple) or not all(isinstance(v, Var) for v in variables):
        raise ValueError(f"{what}: variables are a tuple of Var(...), such as (Var(...),)")
    if not callable(evaluate):
        raise ValueError(f"{what}: evaluate is {type(evaluate).__name__}, not a function")


def spread(value: Number, size: int) -> Array:
    """Return one float, or `size` floats, as an array (size,)."""
    return np.full(size, value, float)


def each(value: Any) -> tuple[Any, ...]:
    """Return a block of scalars as a tuple, whatever its size."""
    return value if isinstance(value, tuple) else (value,)


def _refused(sign: str) -> Callable[[Any, Any], Any]:
    def refuse(block: Any, other: Any) -> Any:
        raise TypeError(
            f"a block of several components has no {sign}: write np.array(x.w), which computes "
            "component by component"
        )

    return refuse


class Block(tuple[Any, ...]):
    """The components of a variable or parameter; a tuple whose signs do not replicate or join.

    numpy on the left of a sign computes component by component, as with any tuple.
    """

    __slots__ = ()
    __add__ = __radd__ = _refused("+")
    __sub__ = __rsub__ = _refused("-")
    __mul__ = __rmul__ = _refused("*")
    __truediv__ = __rtruediv__ = _refused("/")
    __pow__ = __rpow__ = _refused("**")
    __lt__ = __le__ = __gt__ = __ge__ = _refused("order (<, <=, >, >=)")

    def __getitem__(self, at: Any) -> Any:
        part = tuple.__getitem__(self, at)
        return Block(part) if type(at) is slice else part

    def __neg__(self) -> Any:
        """Refuse the sign of a block: TypeError."""
        return self - 0.0


class Named(SimpleNamespace):
    """Scalars by name; a name that is not declared is answered with those that are."""

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"nothing is named {name!r} here; declared: {', '.join(vars(self))}")

    def __getitem__(self, name: Any) -> Any:
        raise TypeError(f"scalars are attributes: write .{name} instead of [{name!r}]")


def namespace(declared: tuple[Any, ...], scalars: list[Any]) -> Named:
    """Return scalars by name: one for size 1, a `Block` for more."""
    named: dict[str, Any] = {}
    start = 0
    for item in declared:
        part = scalars[start : start + item.size]
        named[item.name] = part[0] if item.size == 1 else Block(part)
        start += item.size
    return Named(**named)


def minimised(terms: Any) -> Any:
    """Terms whose objectives are all minimised: of those maximised the negatives."""
    if not isinstance(terms, Terms) or not terms.maximise:
        return terms
    negative = {f"{FALLING}{name}": -value for name, value in terms.maximise.items()}
    return replace(terms, minimise={**terms.minimise, **negative}, maximise={})


def flat(block: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Return [(name or name[k], scalar)] of a block of terms; k counts from 1, as stages do."""
    scalars: list[tuple[str, Any]] = []
    for name, value in block.items():
        if isinstance(value, tuple | list):
            scalars += [(f"{name}[{k}]", v) for k, v in enumerate(value, 1)]
        else:
            scalars.append((name, value))
    return scalars


def inequalities(terms: Terms) -> list[tuple[str, Any, str]]:
    """Return name, value and kind of every inequality: limits first, then defines."""
    return [(n, v, "limits") for n, v in flat(terms.limits)] + [
        (n, v, "defines") for n, v in flat(terms.defines)
    ]


def checked(terms: Any, where: str, numbers: bool = False) -> Terms:
    """Terms of a text with arrays as blocks; SolveError for a value that is no term.

    numbers: the text was run on floats, so every term is a real number.
    """
    if not isinstance(terms, Terms):
        hint = "; is a `return` missing?" if terms is None else ""
        raise SolveError(
            f"the text of {where} returns {type(terms).__name__}, not Terms(...){hint}"
        )
    parts: dict[str, dict[str, Any]] = {}
    for part in SECTIONS:
        block = getattr(terms, part)
        if not isinstance(block, Mapping):
            raise SolveError(f"{where}: {part} is not a dict of names and terms")
        parts[part] = {name: _block(value) for name, value in block.items()}
        for name, value in flat(parts[part]):
            if not isinstance(name, str):
                raise SolveError(f"{where}: {part} has the key {name!r}; write a name in quotes")
            if wrong := _wrong(value, numbers):
                raise SolveError(f"{where}: {part} {name} is {wrong}")
    if blocks := [name for name, value in parts["minimise"].items() if isinstance(value, tuple)]:
        raise SolveError(f"{where}: the objective {blocks[0]} is a block; write one scalar")
    return Terms(**parts)


def _block(value: Any) -> Any:
    """Return a list or array of one dimension as a tuple; arrays of none as scalars."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return value[()]
    if isinstance(value, tuple | list) or (isinstance(value, np.ndarray) and value.ndim == 1):
        return tuple(v[()] if isinstance(v, np.ndarray) and v.ndim == 0 else v for v in value)
    return value


def _wrong(value: Any, numbers: bool) -> str:
    """Sort of a term that it must not be; "" for a scalar."""
    if isinstance(value, bool | np.bool_):
        return "no comparison of variables by <=, >= or ==, nor a quotient that must not exceed 1"
    if isinstance(value, tuple | list | np.ndarray | Mapping | set):
        return f"a {type(value).__name__} in a block or of several dimensions; write scalars"
    if value is None or isinstance(value, str | complex | np.complexfloating):
        return f"{value!r}, no real number"
    if numbers and not isinstance(value, float | int | np.number):
        return f"of type {type(value).__name__}; write a real number"
    return ""


def flatten(terms: Terms) -> tuple[list[Any], list[Any]]:
    """Return values of the inequalities and of the equalities, in order."""
    return [v for _, v, _ in inequalities(terms)], [v for _, v in flat(terms.equal)]
