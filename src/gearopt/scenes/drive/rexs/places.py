"""Where the shafts of a REXS model lie, as a table [layout] would have them."""

from collections.abc import Mapping, Sequence
from decimal import Decimal

from gearopt.scenes.drive.rexs.model import Component, Model, as_number, in_unit, wrong

PARALLEL = Decimal("0.999999")  # cosine
AXES = ("u_axis_vector", "w_axis_vector", "support_vector")


def places(model: Model, bodies: Mapping[int, int], path: Sequence[int]) -> list[str]:
    """A line for every shaft after the first: its place from there, y along v, z along w.

    path: bodies of the shafts from the input on. None where a shaft does not say where it is, or
    is not parallel to the first.
    """
    shafts = [
        next((c for c in model.of_type("shaft") if bodies[c.id] == body and _says(c)), None)
        for body in path
    ]
    placed = [(c, [_vector(c, name) for name in AXES]) for c in shafts if c is not None]
    if not placed or len(placed) < len(shafts):
        return []
    _, (u, w, origin) = placed[0]
    v = [w[i - 2] * u[i - 1] - w[i - 1] * u[i - 2] for i in range(3)]
    lines: list[str] = []
    for k, (shaft, (axis, _, here)) in enumerate(placed[1:], 2):
        if abs(_dot(axis, u)) < PARALLEL:
            return []
        away = [a - b for a, b in zip(here, origin, strict=True)]
        y, z = (in_unit(_dot(away, along), "mm") for along in (v, w))
        lines.append(
            f"shaft {k} is {shaft}; with a table [layout] its place is a table [[place]] of "
            f'shaft = {k}, y = "{y}", z = "{z}"'
        )
    return lines


def _says(shaft: Component) -> bool:
    return all(map(shaft.has, AXES))


def _dot(a: Sequence[Decimal], b: Sequence[Decimal]) -> Decimal:
    return sum((x * y for x, y in zip(a, b, strict=True)), Decimal(0))


def _vector(component: Component, name: str) -> list[Decimal]:
    """A vector of three numbers."""
    value, _ = component.get(name)
    numbers = [as_number(x) for x in value] if isinstance(value, list) else []
    vector = [x for x in numbers if x is not None]
    if len(vector) != 3 or len(numbers) != 3:
        rule = "is no vector of three numbers"
        raise wrong(component.at(name), value, rule, "Write an array of three")
    return vector
