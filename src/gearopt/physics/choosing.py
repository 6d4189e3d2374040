"""Branches of laws whose arguments are floats, arrays or casadi scalars."""

from typing import Any

import numpy as np


def choose(condition: Any, yes: Any, no: Any) -> Any:
    """Return numpy.where, as a number of numbers; casadi scalars stay casadi scalars."""
    chosen = np.where(condition, yes, no)
    return chosen[()] if isinstance(chosen, np.ndarray) else chosen


def some(condition: Any) -> bool:
    """Whether a condition holds anywhere."""
    return bool(np.any(condition))
