"""The meaning of a text: its numbers on floats, one point at a time; and where it is wrong.

Everything else must agree with that. A population is run through a text at once only where the text
is proven elementwise: a `Scalar` passes through it, which knows operators and numpy's elementwise
functions and refuses to be summed, sorted, asked by an `if` or made a number. Any other text is run
point by point, which is as right and slower. `blaming` says where in a user's text something went
wrong, and what to write instead.
"""

import functools
import logging
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from gearopt.errors import GearoptError, SolveError
from gearopt.optimise import comparisons
from gearopt.optimise.failures import Points, current
from gearopt.optimise.terms import (
    SECTIONS,
    Array,
    Named,
    Repeat,
    Terms,
    checked,
    flat,
    minimised,
    namespace,
    spread,
)
from gearopt.optimise.workers import shared_out

SYMBOLS = (  # what exceptions of texts run on symbols say, and the remedy
    (
        "truth value",
        "It asks which of two quantities is greater (if, max, np.max, sorted): write np.maximum "
        "or np.where, or a further variable t with defines={'over': (a / t, b / t)}",
    ),
    (
        "has not ended",
        "A simulation that waits for numbers runs on no symbols: the methods annealing and nsga2 "
        "take the text as it is",
    ),
    (
        "",
        "Use operators, numpy's functions of scalars (np.sqrt, not math.sqrt) and sums over the "
        "components of a block; no `if` on a quantity",
    ),
)


@contextmanager
def blaming(text: Callable[..., Any], where: str, doing: str) -> Iterator[None]:
    """Make an error that a text raises a SolveError that names its line; numpy warns of nothing.

    where: the name of the text; doing: what cannot be done with it.
    """
    try:
        with np.errstate(all="ignore"):
            yield
    except GearoptError:
        raise
    except Exception as broken:
        line = _line(broken, text)
        raise SolveError(
            f"the text of {where} cannot be {doing}{line}: {_in_words(broken)}"
        ) from broken


@contextmanager
def quiet() -> Iterator[None]:
    """Keep warnings of back ends from the standard error; their errors are SolveErrors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def remedy(broken: BaseException | None) -> str:
    """Text to write instead of an operation that a symbol does not know."""
    return next(words for part, words in SYMBOLS if part in str(broken))


def _line(broken: BaseException, text: Callable[..., Any]) -> str:
    """Return the last line of the text's own file that the exception passed."""
    while isinstance(text, functools.partial):
        text = text.func
    code = getattr(text, "__code__", None) or getattr(type(text).__call__, "__code__", None)
    file = code.co_filename if code else None
    frames = [f for f in traceback.extract_tb(broken.__traceback__) if f.filename == file]
    if not frames:
        return ""
    line = f" (`{frames[-1].line}`)" if frames[-1].line else ""
    return f" in line {frames[-1].lineno}{line}"


def _in_words(broken: BaseException) -> str:
    """Return an exception in one line, without the places of compiled code."""
    lines = [line.strip() for line in str(broken).splitlines() if line.strip()]
    words = lines[-1] if lines and lines[0].startswith("Error in") else " ".join(lines)
    if ".cpp:" in words:
        words = words.split(": ", 1)[-1]
    return f"{type(broken).__name__}: {words}"[:300].rstrip(".")


if TYPE_CHECKING:
    from gearopt.optimise.problem import Problem

logger = logging.getLogger("gearopt")
SLOW = 0.01  # s, of a point whose terms are kept: judging and describing it ask for them again
KEPT_POINTS = 1000  # at most
TRIED = 20  # points at which a text may raise before it has none
ELEMENTWISE = (np.where, np.clip, np.round, np.select, np.zeros_like, np.ones_like, np.full_like)


class Scalar(NDArrayOperatorsMixin):
    """Stands for a scalar of a text; TypeError where it is used as anything but an element."""

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any, **more: Any) -> Any:
        if method != "__call__" or more or function.signature is not None:
            raise TypeError(f"{function.__name__}.{method} is not elementwise")
        _need_scalars(inputs)
        return Scalar() if function.nout == 1 else tuple(Scalar() for _ in range(function.nout))

    def __array_function__(self, function: Any, types: Any, inputs: Any, more: Any) -> Any:
        if function not in ELEMENTWISE:
            raise TypeError(f"{function.__name__} is not known to be elementwise")
        _need_scalars((*inputs, *more.values()))
        return Scalar()

    def __array__(self, *args: Any, **more: Any) -> Any:
        raise TypeError("a scalar of the text in an array")

    def __bool__(self) -> bool:
        raise TypeError("an `if` on a scalar of the text")


def _need_scalars(values: Any) -> None:
    for value in values:
        if isinstance(value, list):  # of np.select
            _need_scalars(value)
        elif not _is_scalar(value):
            raise TypeError(f"a {type(value).__name__} among scalars of the text")


def _is_scalar(value: Any) -> bool:
    number = isinstance(value, Scalar | float | int | np.number | np.bool_)
    return number or (isinstance(value, np.ndarray) and value.ndim == 0)


def text_of(problem: "Problem", repeat: Repeat | None) -> tuple[Any, str]:
    """Text of a problem or of one of its repeats, and its name in messages."""
    if repeat is None:
        return problem.evaluate, problem.name
    return repeat.evaluate, f"{problem.name}.{repeat.name}"


def called(
    problem: "Problem",
    repeat: Repeat | None,
    shared: Any,
    own: Any,
    row: dict[str, Any],
    parameters: Any = None,
) -> Any:
    """Return the terms of a text for scalars of any kind: variables, data, parameters."""
    x = namespace(problem.variables, list(shared))
    given = problem.parameter_values() if parameters is None else parameters
    p = namespace(problem.parameters, list(given))
    if repeat is not None:
        x.__dict__.update(vars(namespace(repeat.variables, list(own))))
    return evaluated(problem, repeat, x, p, row)


def evaluated(
    problem: "Problem", repeat: Repeat | None, x: Any, p: Any, row: Mapping[str, Any]
) -> Any:
    """Return the terms of a text for scalars by name, all objectives minimised.

    Of a text with limits written as comparisons they are rows (`comparisons`).
    """
    scales = problem.memo.get(("compares", repeat and repeat.name))
    if scales is not None:
        logs = {v.name: v.log for v in (*problem.variables, *(repeat.variables if repeat else ()))}
        x, p = comparisons.quantities(x, logs), comparisons.quantities(p, _above(problem))
        row = {name: comparisons.Quantity(value) for name, value in row.items()}
    stated = problem.evaluate(x, p) if repeat is None else repeat.evaluate(x, p, Named(**row))
    terms = minimised(stated)
    if scales is None or not isinstance(terms, Terms):
        return terms
    numbers = problem.memo.setdefault(("numbers", repeat and repeat.name), {})
    return comparisons.rows(terms, scales, numbers, p)


def _above(problem: "Problem") -> dict[str, bool]:
    """Whether a parameter was above 0 at first, when rows that divide by it were made."""
    now = {q.name: bool((spread(q.value, q.size) > 0.0).all()) for q in problem.parameters}
    first: dict[str, bool] = problem.memo.setdefault("above", now)
    if fallen := [name for name, above in first.items() if above and not now[name]]:
        raise SolveError(
            f"{problem.name}: limits are divided by the parameter {fallen[0]}, which was above 0 "
            "and is not any more; pose the problem with its new value"
        )
    return first


def at(problem: "Problem", repeat: Repeat | None, shared: Any, own: Any, row: int) -> Terms:
    """Terms of a text on floats; SolveError names its fault. Those of a slow text are kept."""
    known: dict[Any, Terms] = problem.memo.get("slow points", {})
    key: Any = None
    if known:
        numbers = np.hstack([shared, own, problem.parameter_values()]).astype(float)
        key = repeat and repeat.name, row, numbers.tobytes()
        if key in known:
            return known[key]
    began = time.perf_counter()
    terms = _at(problem, repeat, shared, own, row)
    if time.perf_counter() - began > SLOW:
        if len(known) >= KEPT_POINTS:
            known.clear()
        known[key] = terms  # the first of all under no key: it makes the others be kept
        problem.memo["slow points"] = known
    return terms


def _at(problem: "Problem", repeat: Repeat | None, shared: Any, own: Any, row: int) -> Terms:
    """Terms of a text on floats, computed anew."""
    data = {k: np.float64(v[row]) for k, v in repeat.data.items()} if repeat else {}
    key = "compares", repeat and repeat.name
    with blaming(*text_of(problem, repeat), "evaluated"):
        terms = called(problem, repeat, shared, own, data)
        if key not in problem.memo and comparisons.compares(terms):
            problem.memo[key] = {}
            terms = called(problem, repeat, shared, own, data)
    return checked(terms, text_of(problem, repeat)[1], numbers=True)


def first_terms(problem: "Problem") -> Terms:
    """Terms of a problem's text at the guess; where it raises there, at a random point."""
    count, first = sum(v.size for v in problem.variables), None
    for x in sample(problem, TRIED):
        try:
            return at(problem, None, x[:count], (), 0)
        except SolveError as refused:
            if refused.__cause__ is None:
                raise
            first = first or refused
    assert first is not None
    raise first


def terms_of(problem: "Problem", repeat: Repeat | None, shared: Array, own: Array) -> Terms:
    """Return the terms of N points: arrays (N,), those of a repeat (N, rows).

    shared: (N, n); own: (N, rows, width), without entries where there is no repeat.
    """
    if not (problem.vectorised or elementwise(problem, repeat)):
        return _one_by_one(problem, repeat, shared, own)
    return _at_once(problem, repeat, shared, own)


def _at_once(problem: "Problem", repeat: Repeat | None, shared: Array, own: Array) -> Terms:
    with blaming(*text_of(problem, repeat), "evaluated"):
        if repeat is None:
            terms: Terms = called(problem, None, shared.T, (), {})
        else:
            data = {k: np.asarray(v)[None, :] for k, v in repeat.data.items()}
            terms = called(problem, repeat, shared.T[:, :, None], np.moveaxis(own, 2, 0), data)
    return terms


def elementwise(problem: "Problem", repeat: Repeat | None) -> bool:
    """Return whether a text is proven to compute every point by itself, at these parameters."""
    key = _key(problem, repeat)
    if key not in problem.memo:
        problem.memo[key] = reason = _obstacle(problem, repeat) or _surprise(problem, repeat)
        if reason and ("reported", repeat and repeat.name) not in problem.memo:
            problem.memo["reported", repeat and repeat.name] = True
            where = text_of(problem, repeat)[1]
            logger.info("the text of %s is run point by point, which is slower: %s", where, reason)
    return not problem.memo[key]


def _key(problem: "Problem", repeat: Repeat | None) -> Any:
    return "elementwise", repeat and repeat.name, problem.parameter_values().tobytes()


def same_way(problem: "Problem", other: "Problem") -> None:
    """Let a problem that differs in factors of its rows alone be run at once where another is.

    Both share what was built (`Problem.at`).
    """
    for repeat in (None, *problem.repeats):
        if (known := problem.memo.get(_key(other, repeat))) is not None:
            problem.memo[_key(problem, repeat)] = known


def functions_of(problem: "Problem") -> set[str] | None:
    """Names of numpy's functions that the texts call on scalars; None where they do not pass."""
    names = set[str]()

    class Heard(Scalar):
        """Keeps the name of a function that it passes through."""

        def __array_ufunc__(self, function: Any, method: str, *inputs: Any, **more: Any) -> Any:
            names.add(function.__name__)
            result = super().__array_ufunc__(function, method, *inputs, **more)
            return tuple(Heard() for _ in result) if isinstance(result, tuple) else Heard()

        def __array_function__(self, function: Any, types: Any, inputs: Any, more: Any) -> Any:
            super().__array_function__(function, types, inputs, more)
            return Heard()

    passed = [not _obstacle(problem, r, Heard) for r in (None, *problem.repeats)]
    return names if all(passed) else None


def _obstacle(
    problem: "Problem", repeat: Repeat | None, scalar: Callable[[], Scalar] = Scalar
) -> str:
    """First operation of a text that is not elementwise; "" for none."""
    shared, repeated = (
        [scalar() for v in variables for _ in range(v.size)]
        for variables in (problem.variables, repeat.variables if repeat else ())
    )
    row = {k: scalar() for k in repeat.data} if repeat else {}
    try:
        with np.errstate(all="ignore"):
            terms = called(problem, repeat, shared, repeated, row)
        values = [v for part in SECTIONS for _, v in flat(getattr(terms, part))]
        return "" if all(map(_is_scalar, values)) else "it returns arrays"
    except Exception as refused:
        return str(refused) or type(refused).__name__


def _surprise(problem: "Problem", repeat: Repeat | None) -> str:
    """Return how a text that asks for types of its scalars betrays itself; "": it does not."""
    start = sum(v.size for v in problem.variables)
    shared, repeated = sample(problem, 2)[:, :start], np.empty((2, 1, 0))
    if repeat is not None:
        repeated = np.tile(
            [one for v in repeat.variables for one in spread(v.guess, v.size)], (2, 1, 1)
        )
        repeat = replace(repeat, data={k: v[:1] for k, v in repeat.data.items()})
    many = _at_once(problem, repeat, shared, repeated)
    for k in range(2):
        single = at(problem, repeat, shared[k], repeated[k].ravel(), 0)
        for part in SECTIONS:
            values = zip(flat(getattr(single, part)), flat(getattr(many, part)), strict=True)
            for (name, alone), (_, column) in values:
                among = np.broadcast_to(column, (2, 1) if repeat else (2,)).reshape(2)[k]
                if not np.isclose(among, alone, 1e-9, 0.0, equal_nan=True):
                    return f"{name} is {alone:g} on floats, but {among:g} on arrays"
    return ""


def sample(problem: "Problem", count: int) -> Array:
    """Return the guess and random points between the bounds, (count, n), always the same."""
    lower, upper, guess = problem.bounds()
    reach = np.maximum(1.0, np.abs(guess))
    low, high = (
        np.where(np.isfinite(end), end, guess + sign * reach)
        for end, sign in ((lower, -0.5), (upper, 0.5))
    )
    low = np.where(guess > 0.0, np.maximum(low, guess / 2.0), low)  # a wide box is mostly its
    high = np.where(guess > 0.0, np.minimum(high, guess * 2.0), high)  # far end, where all is 0
    draw = Random(0)  # what numpy draws with takes longer to load than most texts take to check
    shares = [[draw.random() for _ in guess] for _ in range(count - 1)]
    points = np.vstack([guess, *(low + (high - low) * np.array(row) for row in shares)])
    for k, (variable, _) in enumerate(problem.columns):
        if variable.values is not None:
            allowed = np.array(variable.values)
            points[:, k] = allowed[np.abs(allowed - points[:, k, None]).argmin(axis=1)]
        elif variable.integer:
            points[:, k] = np.rint(points[:, k])
    return points + 0.0  # no zero is -0.0


def seconds(problem: "Problem", repeat: Repeat | None) -> float:
    """Return the seconds that a text takes on floats, at the guess."""
    start = sum(v.size for v in problem.variables)
    guess = sample(problem, 1)[0]
    width = repeat.width if repeat else 0
    began = time.perf_counter()
    _at(problem, repeat, guess[:start], guess[start : start + width], 0)
    return time.perf_counter() - began


def _one_by_one(problem: "Problem", repeat: Repeat | None, shared: Array, own: Array) -> Terms:
    """Return the terms of N points, each computed alone; NaN where the text raises.

    Of several points those are NaN, too, for which the run has no time left.
    """
    rows, running = range(repeat.count if repeat else 1), current()
    names = problem.names(repeat)
    values = np.full((len(shared), len(rows), sum(map(len, names.values()))), np.nan)
    tasks = [
        (repeat and repeat.name, x, y[row : row + 1], row, names)
        for x, y in zip(shared, own, strict=True)
        for row in rows
    ]
    for k, (numbers, failure) in enumerate(_each(problem, tasks, len(rows), running)):
        values[divmod(k, len(rows))] = numbers
        running.note(failure)
    columns = iter(np.moveaxis(values if repeat else values[:, 0], -1, 0))
    return Terms(**{part: {name: next(columns) for name in names[part]} for part in SECTIONS})


def _each(
    problem: "Problem", tasks: list[tuple[Any, ...]], rows: int, run: Points
) -> Iterator[tuple[list[float], str]]:
    """Values and failures of a text, point by point, while the run has time; by its processes."""
    together = shared_out(problem, _numbers, tasks, lambda: run.late)
    left = len(tasks)
    for values in together or _alone(problem, tasks, rows, run):
        left -= 1
        yield values
    run.skipped += left // rows


def _alone(
    problem: "Problem", tasks: list[tuple[Any, ...]], rows: int, run: Points
) -> Iterator[tuple[list[float], str]]:
    for k, task in enumerate(tasks):
        if k and k % rows == 0 and run.late:
            return
        yield _numbers(problem, *task)


def _numbers(
    problem: "Problem",
    name: str | None,
    shared: Array,
    own: Array,
    row: int,
    names: dict[str, list[str]],
) -> tuple[list[float], str]:
    """Return all values of a text at one point; NaN and what it raised there in words.

    name: of the repeat whose text it is.
    """
    repeat = next((r for r in problem.repeats if r.name == name), None)
    try:
        terms = at(problem, repeat, shared, own.ravel(), row)
    except SolveError as refused:
        if refused.__cause__ is None:  # the text poses no problem
            raise
        inner = [own[0, k] for k in range(own.shape[1])]
        where = zip(problem.columns, [*shared, *inner], strict=False)
        named = ", ".join(f"{name} = {v:.6g}" for (_, name), v in where)
        broken = _in_words(refused.__cause__)[:150]
        return [np.nan] * sum(map(len, names.values())), f"{broken} at {named}"[:300]
    values = {part: flat(getattr(terms, part)) for part in SECTIONS}
    if {part: [n for n, _ in values[part]] for part in SECTIONS} != names:
        raise SolveError(
            f"the text of {text_of(problem, repeat)[1]} returns other names at other points; "
            "every point needs the same terms"
        )
    return [float(v) for part in SECTIONS for _, v in values[part]], ""
