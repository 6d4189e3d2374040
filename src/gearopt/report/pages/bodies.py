"""Where the named bodies of a layout are, and where two of them come closest, seen along x."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

Point = tuple[float, float]
Corner = tuple[float, float, float]  # x, y, z
Layout = Mapping[str, Any]

ENDS = (("from_mm", "to_mm"), ("left_mm", "right_mm"), ("bottom_mm", "top_mm"))  # of a keep-out
AROUND = 0.12  # of the box's larger side: keep-outs are drawn so far beyond box and motor


def box_corners(found: Layout) -> tuple[Corner, Corner]:
    """Two corners of the box."""
    box = found["box"]
    y, z = box["left_mm"], box["bottom_mm"]
    return (0.0, y, z), (box["length_mm"], y + box["width_mm"], z + box["height_mm"])


def along(ends: tuple[Corner, Corner], axis: str) -> tuple[float, float]:
    """Of two corners, the ends along x, y or z."""
    k = "xyz".index(axis)
    return ends[0][k], ends[1][k]


def motor(found: Layout) -> tuple[float, float, float] | None:
    """Radius, start and end of the motor; one of unknown length is drawn as long as it is wide."""
    told = found["motor"]
    if not told:
        return None
    length = told.get("length_mm", told["diameter_mm"])
    start = -length if told.get("at", "start") == "start" else found["box"]["length_mm"]
    return 0.5 * told["diameter_mm"], start, start + length


def keep_outs(found: Layout) -> list[dict[str, Any]]:
    """The keep-outs near the box, cut off where they reach far beyond it."""
    low, high = _with_motor(found)
    room = AROUND * max(b - a for a, b in zip(low[1:], high[1:], strict=True))
    near = []
    for it in found["obstacles"]:
        cut = dict(it)
        for (start, end), a, b in zip(ENDS, low, high, strict=True):
            cut[start], cut[end] = max(it[start], a - room), min(it[end], b + room)
        if all(cut[start] < cut[end] for start, end in ENDS):
            near.append(cut)
    return near


def drawn_corners(found: Layout) -> tuple[Corner, Corner]:
    """Two corners of all that is drawn."""
    low, high = (list(corner) for corner in _with_motor(found))
    for it in keep_outs(found):
        for k, (start, end) in enumerate(ENDS):
            low[k], high[k] = min(low[k], it[start]), max(high[k], it[end])
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _with_motor(found: Layout) -> tuple[Corner, Corner]:
    low, high = box_corners(found)
    if (told := motor(found)) is None:
        return low, high
    r, start, end = told
    low = (min(low[0], start), min(low[1], -r), min(low[2], -r))
    return low, (max(high[0], end), max(high[1], r), max(high[2], r))


@dataclass(frozen=True)
class Disc:
    """A round body: centre (y, z), radius, ends along x [mm]."""

    centre: Point
    radius: float
    start: float
    end: float


def disc(found: Layout, name: str, beside: Mapping[str, Any] | None = None) -> Disc | None:
    """A gear (its tip circle), shaft, bearing or the motor by name; None for anything else.

    "shaft 2 with its gears" is the largest body there of those that a keep-out stands beside.
    """
    if name == "motor" and (told := motor(found)) is not None:
        return Disc((0.0, 0.0), *told)
    match = re.fullmatch(r"(?:bearing of )?shaft (\d+)( with its gears)?", name)
    number = int(match[1]) if match else None
    for gear in found["gears"]:
        number = gear["shaft"] if gear["name"] == name else number
    shaft = next((s for s in found["shafts"] if s["shaft"] == number), None)
    if shaft is None:
        return None
    bodies = [(f"shaft {number}", shaft["diameter_mm"], shaft)]
    for gear in found["gears"]:
        if gear["shaft"] == number:
            bodies.append((gear["name"], gear["tip_diameter_mm"], gear))
    for bearing in found["bearings"]:
        if bearing["shaft"] == number:
            bodies.append((f"bearing of shaft {number}", bearing["diameter_mm"], bearing))
    if match and match[2]:
        meant = [body for body in bodies if beside is None or _overlap(body[2], beside)]
    else:
        meant = [body for body in bodies if body[0] == name]
    if not meant:
        return None
    _, diameter, at = max(meant, key=lambda body: float(body[1]))
    return Disc((shaft["y_mm"], shaft["z_mm"]), 0.5 * diameter, at["from_mm"], at["to_mm"])


def _overlap(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    return bool(min(a["to_mm"], b["to_mm"]) > max(a["from_mm"], b["from_mm"]))


def nearest(found: Layout, one: str, other: str) -> tuple[Corner, Corner] | None:
    """The ends of the gap between two bodies, of one x; None where one is not found."""
    boxes = {it["name"]: it for it in found["obstacles"]}
    if one in boxes:
        swapped = nearest(found, other, one) if other not in boxes else None
        return None if swapped is None else (swapped[1], swapped[0])
    box = boxes.get(other)
    a = disc(found, one, box)
    if a is None:
        return None
    if box is not None:
        y = min(max(a.centre[0], box["left_mm"]), box["right_mm"])
        z = min(max(a.centre[1], box["bottom_mm"]), box["top_mm"])
        b: Disc | None = Disc((y, z), 0.0, box["from_mm"], box["to_mm"])
    else:
        b = disc(found, other)
    if b is None or (apart := math.dist(a.centre, b.centre)) < 1e-9:
        return None
    uy, uz = ((v - u) / apart for u, v in zip(a.centre, b.centre, strict=True))
    x = 0.5 * (max(a.start, b.start) + min(a.end, b.end))
    start = (x, a.centre[0] + a.radius * uy, a.centre[1] + a.radius * uz)
    return start, (x, b.centre[0] - b.radius * uy, b.centre[1] - b.radius * uz)
