"""Says where in a user's text something went wrong, and what to write instead."""

import functools
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from gearopt.errors import GearoptError, SolveError

SYMBOLS = (  # what exceptions of texts run on symbols say, and the remedy
    (
        "truth value",
        "It asks which of two quantities is greater (if, max, np.max, sorted): write np.maximum "
        "or np.where, or a further variable t with defines={'over': (a / t, b / t)}",
    ),
    (
        "",
        "Use operators, numpy's functions of scalars (np.sqrt, not math.sqrt) and sums over the "
        "components of a block; no `if` on a quantity",
    ),
)


@contextmanager
def blaming(text: Callable[..., Any], where: str, doing: str) -> Iterator[None]:
    """Make what a text raises a SolveError that names its line; numpy warns of nothing.

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
            f"the text of {where} cannot be {doing}{line}: {_told(broken)}"
        ) from broken


@contextmanager
def quiet() -> Iterator[None]:
    """Keep what back ends warn of from the standard error: their errors are told as SolveError."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def remedy(broken: BaseException | None) -> str:
    """What to write instead of what a symbol does not know."""
    return next(words for part, words in SYMBOLS if part in str(broken))


def _line(broken: BaseException, text: Callable[..., Any]) -> str:
    """The last line of the text's own file that the exception passed."""
    while isinstance(text, functools.partial):
        text = text.func
    code = getattr(text, "__code__", None) or getattr(type(text).__call__, "__code__", None)
    file = code.co_filename if code else None
    frames = [f for f in traceback.extract_tb(broken.__traceback__) if f.filename == file]
    if not frames:
        return ""
    line = f" (`{frames[-1].line}`)" if frames[-1].line else ""
    return f" in line {frames[-1].lineno}{line}"


def _told(broken: BaseException) -> str:
    """An exception in one line, without the places of compiled code."""
    lines = [line.strip() for line in str(broken).splitlines() if line.strip()]
    words = lines[-1] if lines and lines[0].startswith("Error in") else " ".join(lines)
    if ".cpp:" in words:
        words = words.split(": ", 1)[-1]
    return f"{type(broken).__name__}: {words}"[:300].rstrip(".")
