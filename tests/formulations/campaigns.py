"""Which cases of a campaign the default suite runs: a few of them; the others are slow."""

import pytest


def few(cases, quick):
    """Return parameters: cases in `quick`, or so many of the first ones, and the others slow."""
    cases = list(cases)
    some = cases[:quick] if isinstance(quick, int) else quick
    return [case if case in some else _slow(case) for case in cases]


def _slow(case):
    if hasattr(case, "marks"):  # made by pytest.param, with an id of its own
        return pytest.param(*case.values, id=case.id, marks=(*case.marks, pytest.mark.slow))
    values = case if isinstance(case, tuple) else (case,)
    return pytest.param(*values, marks=pytest.mark.slow)
