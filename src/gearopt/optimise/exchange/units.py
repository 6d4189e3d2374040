"""The units of a problem, checked by pint: its text is run once on quantities, at the guess."""

import math
import re
from functools import cache
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.comparisons import Comparison, plain, quantities
from gearopt.optimise.evaluation import blaming, text_of
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Named, Repeat, flat, minimised, namespace, spread

POWER = re.compile(r"(?<=[a-zA-Z])(\d+)")  # mm3: pint writes mm^3
ROUNDING = 1e-9  # relative: two values that are further apart are not the same
ROWS = ("limits", "defines", "equal")


def check(problem: Problem) -> dict[str, str]:
    """Units of objectives and reported values by name; SolveError names a wrong line or row.

    Numbers of the text are without unit. Sums and comparisons need equal dimensions, functions such
    as np.exp and rows (utilisations) none; units of one dimension that are mixed without being
    converted, as mm and cm in a sum, are found by what numbers alone give. The extra gearopt[units]
    installs pint.
    """
    registry = _registry()
    units: dict[str, str] = {}
    for repeat in (None, *problem.repeats):
        where = text_of(problem, repeat)[1]
        measured, bare = (_terms(problem, repeat, with_units) for with_units in (registry, None))
        for part in (*ROWS, "minimise", "report"):
            pairs = zip(flat(getattr(measured, part)), flat(getattr(bare, part)), strict=True)
            for (name, value), (_, number) in pairs:
                place = f"{where}: {part} {name}"
                unit = _unit_of(place, registry, value, number, part in ROWS)
                units |= {} if part in ROWS else {name: unit}
    return units


@cache
def _registry() -> Any:
    """The units of pint, which it takes longer to read than to check most problems."""
    try:
        import pint
    except ImportError as missing:
        raise SolveError('units are checked by pint: pip install "gearopt[units]"') from missing
    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def _terms(problem: Problem, repeat: Repeat | None, registry: Any) -> Any:
    """The terms of a text at the guess, comparisons as such; registry: None without units."""
    declared = problem.variables + (repeat.variables if repeat else ())
    guesses = [(v, spread(v.guess, v.size)) for v in declared]
    values = [(q, spread(q.value, q.size)) for q in problem.parameters]
    x, p = (
        namespace(
            tuple(item for item, _ in some),
            [n * _unit(registry, item) for item, numbers in some for n in numbers.tolist()],
        )
        for some in (guesses, values)
    )
    text, where = text_of(problem, repeat)
    row = {n: float(np.asarray(v)[0]) for n, v in repeat.data.items()} if repeat else {}
    with blaming(text, where, "checked for its units"):
        x, p = quantities(x, {}), quantities(p, {})
        return minimised(text(x, p, Named(**row)) if repeat else text(x, p))


def _unit_of(place: str, registry: Any, value: Any, number: Any, row: bool) -> str:
    """Return the unit of a term, as pint writes it; SolveError where units clash.

    value, number: the term with and without units. row: it must be dimensionless.
    """
    if isinstance(value, Comparison):
        (lesser, greater), (less, great) = (
            (plain(one.lesser), plain(one.greater)) for one in (value, number)
        )
        sides = [registry.Quantity(side) for side in (lesser, greater)]
        if not sides[0].is_compatible_with(sides[1]):
            words = " with ".join(f"{side.units:~}" or "a number" for side in sides)
            raise SolveError(f"{place} compares {words}")
        value, number = sides[0] + sides[1].to(sides[0].units), less + great
        row = False
    quantity = registry.Quantity(plain(value))
    if row and not quantity.check("[]"):
        raise SolveError(
            f"{place} has the unit {quantity.units:~}; a row has none: compare two values, or "
            "divide by one"
        )
    magnitude = float(quantity.m_as("") if row else quantity.magnitude)
    if not math.isclose(magnitude, float(plain(number)), rel_tol=ROUNDING):
        raise SolveError(
            f"{place} mixes units of one dimension: it is {magnitude:.6g} with them, but "
            f"{float(plain(number)):.6g} by numbers alone; declare all in one unit, or convert"
        )
    return f"{quantity.units:~}"


def _unit(registry: Any, item: Any) -> Any:
    """The unit of a variable or parameter, 1.0 without units; SolveError for an unknown one."""
    if registry is None or not item.unit:
        return 1.0
    try:
        return registry.Quantity(1.0, registry.Unit(POWER.sub(r"^\1", item.unit)))
    except Exception as unknown:
        raise SolveError(f"{item.name}: pint does not know the unit {item.unit!r}") from unknown
