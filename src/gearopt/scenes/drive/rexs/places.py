"""Where the shafts of a REXS model lie, as a table [layout] would have them."""

from collections.abc import Mapping, Sequence
from decimal import Decimal, InvalidOperation
from typing import Any

from gearopt.scenes.drive.rexs.model import Component, Model, in_unit, wrong

PARALLEL = Decimal("0.999999")  # cosine
AXES = ("u_axis_vector", "w_axis_vector", "support_vector")
Vector = tuple[Decimal, ...]


def places(model: Model, bodies: Mapping[int, int], path: Sequence[int]) -> list[str]:
    """A line for every shaft after the first: its place from there, y along v, z along w.

    path: bodies of the shafts from the input on. None where a shaft does not say where it is, or
    is not parallel to the first.
    """
    lines: list[str] = []
    first: list[Vector] | None = None
    for k, body in enumerate(path, 1):
        shafts = [c for c in model.of_type("shaft") if bodies[c.id] == body]
        known = next((c for c in shafts if all(map(c.has, AXES))), None)
        if known is None:
            return []
        here = [_vector(known, name) for name in AXES]
        first = first or here
        u, w, origin = first
        v = (w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0])
        if abs(_dot(here[0], u)) < PARALLEL:
            return []
        away = [a - b for a, b in zip(here[2], origin, strict=True)]
        y, z = (in_unit(_dot(away, axis), "mm") for axis in (v, w))
        if k > 1:
            lines.append(
                f"shaft {k} is {known}; with a table [layout] its place is a table [[place]] of "
                f'shaft = {k}, y = "{y}", z = "{z}"'
            )
    return lines


def _dot(a: Sequence[Decimal], b: Sequence[Decimal]) -> Decimal:
    return sum((x * y for x, y in zip(a, b, strict=True)), Decimal(0))


def _vector(component: Component, name: str) -> Vector:
    """A vector of three numbers."""
    attribute: Any = component.get(name)
    try:
        values = tuple(Decimal(str(x)) for x in attribute.value)
    except (InvalidOperation, TypeError):
        values = ()
    if len(values) != 3 or not all(x.is_finite() and abs(x) < 10**9 for x in values):
        rule = "is no vector of three numbers"
        raise wrong(component.at(name), attribute.value, rule, "Write an array of three")
    return values
