"""The last wheel of a servo train as a drawing: its sector, and the area that it sweeps."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.report.measures import Measures
from gearopt.report.pages.labels import Place
from gearopt.report.pages.sheet import Point, Sheet
from gearopt.report.words import number

FULL = 180.0  # deg to either side of the mesh line


def sector(
    sheet: Sheet, box: Mapping[str, Any], train: Any, colour: str, measures: Measures
) -> None:
    """The swept area, and the sector in the middle of its travel where its size is known."""
    radius, half = box["radii_mm"][2], box["half_sweep_deg"]
    size = f"radius {measures.length(radius)} {measures.unit('mm')}"
    told = f"swept area of the last wheel: {size}, ±{number(float(half))}°"
    style = "swept" if half < FULL else "tip"
    sheet.slice((0.0, 0.0), radius, _ends(box, half), style, colour, told)
    if not train:
        return
    own = min(FULL * train.get("sector", 1.0), half)
    stage = train["stages"][-1]
    told = f"wheel 2, z {stage['wheel_teeth']}: {size}, sector of {number(2.0 * own)}°"
    if own < FULL:
        sheet.slice((0.0, 0.0), radius, _ends(box, own), "tip", colour, told)
    reference = 0.5 * stage["wheel_diameter_mm"]
    sheet.slice((0.0, 0.0), reference, _ends(box, own), "reference", colour, rim=True)


Disc = tuple[Point, float]


def label_sector(sheet: Sheet, box: Mapping[str, Any], colour: str, discs: Sequence[Disc]) -> None:
    """Names of the last wheel and of its sweep, where no disc (centre, radius) is."""
    half = float(box["half_sweep_deg"])
    sheet.label("wheel 2", _on_rays(sheet, box, 0.5 * min(half, 60.0), discs), "name", colour)
    if half < FULL:
        text = f"sweep ±{number(half)}°"
        sheet.label(text, _on_rays(sheet, box, 0.85 * half, discs), "name", colour)


def _on_rays(
    sheet: Sheet, box: Mapping[str, Any], off: float, discs: Sequence[Disc]
) -> list[Place]:
    """Places some degrees to either side of the mesh line, from the rim inwards."""
    found = []
    for k, share in enumerate((0.8, 0.7, 0.6, 0.5, 0.42)):
        for side in (-1.0, 1.0):
            for more in (1.0, 0.8, 0.6):
                turn = math.radians(box["output_angle_deg"] + side * more * off)
                r = share * box["radii_mm"][2]
                spot = r * math.cos(turn), r * math.sin(turn)
                inside = sum(math.dist(spot, centre) < size for centre, size in discs)
                found.append(Place(*sheet.at(*spot), 0.0, 0.5 * k + 20.0 * inside))
    return found


def _ends(box: Mapping[str, Any], half: float) -> tuple[float, float]:
    """Angles [rad] so many degrees to either side of the mesh line."""
    middle = box["output_angle_deg"]
    return math.radians(middle - half), math.radians(middle + half)
