"""Where the named bodies of a layout are, and where two of them come closest, seen along x."""

import math
from collections.abc import Mapping
from typing import Any

Point = tuple[float, float]


def circle(found: Mapping[str, Any], name: str) -> tuple[Point, float] | None:
    """Centre (y, z) and radius [mm] of a gear (its tip) or a shaft; None for another body."""
    shafts = {s["shaft"]: s for s in found["shafts"]}
    for gear in found["gears"]:
        if gear["name"] == name:
            on = shafts[gear["shaft"]]
            return (on["y_mm"], on["z_mm"]), 0.5 * gear["tip_diameter_mm"]
    for number, shaft in shafts.items():
        if name == f"shaft {number}":
            return (shaft["y_mm"], shaft["z_mm"]), 0.5 * shaft["diameter_mm"]
    return None


def nearest(found: Mapping[str, Any], one: str, other: str) -> tuple[Point, Point] | None:
    """The ends (y, z) of the gap between two bodies; None where one has no place of its own."""
    a, b = circle(found, one), circle(found, other)
    if a is None and b is not None:
        swapped = nearest(found, other, one)
        return None if swapped is None else (swapped[1], swapped[0])
    if a is None:
        return None
    (centre, r) = a
    if b is not None:
        towards, reach = b
    else:
        box = next((it for it in found["obstacles"] if it["name"] == other), None)
        if box is None:
            return None
        y = min(max(centre[0], box["left_mm"]), box["right_mm"])
        z = min(max(centre[1], box["bottom_mm"]), box["top_mm"])
        towards, reach = (y, z), 0.0
    apart = math.dist(centre, towards)
    if apart < 1e-9:
        return None
    uy, uz = (towards[0] - centre[0]) / apart, (towards[1] - centre[1]) / apart
    start = (centre[0] + r * uy, centre[1] + r * uz)
    return start, (towards[0] - reach * uy, towards[1] - reach * uz)
