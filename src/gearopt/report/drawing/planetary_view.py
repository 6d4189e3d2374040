"""Planetary trains seen along their axis, turning: teeth as trapezia, in modules, without shifts.

Planets turn about their own axes until they fit the sun, and the first of them the ring.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.formulations.epicyclic.design import EpicyclicDesign
from gearopt.formulations.epicyclic.request import COUPLED, SETS, SIMPLE
from gearopt.report.drawing.player import Animation, Body, Reading, View
from gearopt.report.drawing.sheet import Sheet, Window, series
from gearopt.report.section import Section

SIZE = 420.0  # px of a view
MOMENTS, SECONDS = 181, 12.0  # of the motion that is shown, at normal speed
MOST_TURNS = 10.0
ROOT, TIP = 0.34, 0.16  # of a pitch: half thickness of a tooth there
PITCH = 2.0 * math.pi


def outline(teeth: int, module: float, inside: bool = False) -> np.ndarray:
    """Outline (4 z, 2) of a gear whose first tooth points along x; inside: of a ring."""
    radius, way = 0.5 * module * teeth, -1.0 if inside else 1.0
    root, tip = radius - way * 1.25 * module, radius + way * module
    at = np.array([-ROOT, -TIP, TIP, ROOT]) + np.arange(teeth)[:, None]
    r = np.broadcast_to([root, tip, tip, root], at.shape).ravel()
    angle = at.ravel() * PITCH / teeth
    return np.stack((r * np.cos(angle), r * np.sin(angle)), axis=1)


def section(design: EpicyclicDesign) -> Section:
    """The train as it turns: one turn of the slower carrier, at most MOST_TURNS of the input."""
    speeds = {member.name: member.speed for member in design.members}
    slow = min((abs(v) for *_, carrier in design.sets if (v := speeds[carrier])), default=1.0)
    turns = np.linspace(0.0, min(1.0 / slow, MOST_TURNS), MOMENTS)
    count = 1 if design.arrangement == SIMPLE else 2  # sets, or steps of the planets
    readings = [
        Reading(f"turns of the {member.name} ({member.use})", member.speed * turns, "", 3)
        for use in ("input", "output")
        for member in design.members
        if member.use == use
    ]
    animation = Animation(
        "the train as it turns",
        [_view(design, k, speeds, turns) for k in range(count)],
        np.linspace(0.0, SECONDS, MOMENTS),
        "The input turns counter-clockwise; lengths are in modules, teeth are not involutes.",
        readings,
    )
    return Section("The train along its axis", animations=[animation])


def _view(design: EpicyclicDesign, k: int, speeds: dict[str, float], turns: np.ndarray) -> View:
    """A set, or a step of the planets, with what is in mesh with it there."""
    (s, p, q, r), (sun, ring, carrier) = SETS[design.arrangement][-k], design.sets[-k]
    moon = "planets2" if k and design.arrangement == COUPLED else "planets"
    planet, teeth = q if k else p, [gear.teeth for gear in design.gears]
    angles = [math.radians(at.angle_deg) for at in design.places if at.planets == moon]
    turned, ring_angle = _fitted(angles, teeth[s], teeth[p], teeth[q], teeth[r])
    distance = 0.5 * (teeth[s] + teeth[p])

    def body(
        gear: int, angle: float, speed: float, colour: int, x: Any = 0.0, y: Any = 0.0
    ) -> Body:
        """A gear that turns about a place that may move."""
        it, inside = design.gears[gear], gear == r
        moving = np.broadcast_arrays(x, y, angle + PITCH * speed * turns)
        shape, style = outline(it.teeth, it.module, inside), "body" if inside else "tip"
        title = f"{it.name}: z {it.teeth}"
        return Body(shape, np.stack(moving, axis=1), style, series(colour), title)

    bodies = [] if k and p != q else [body(s, 0.0, speeds[sun], 1)]
    for angle, turn in zip(angles, turned, strict=True):
        orbit = angle + PITCH * speeds[carrier] * turns
        place = distance * np.cos(orbit), distance * np.sin(orbit)
        bodies.append(body(planet, turn, speeds[moon], 2, *place))
    if k or p == q:
        bodies.append(body(r, ring_angle, speeds[ring], 3))
    reach = 0.5 * max(
        np.ptp(it.outline[:, 0]) + 2.0 * np.abs(it.places[:, 0]).max() for it in bodies
    )
    window = Window(-reach, reach, -reach, reach, (8.0, 8.0, 8.0, 8.0))
    sheet = Sheet(window, window.scale(SIZE, SIZE))
    sheet.cross(0.0, 0.0, 2.0)
    names = ", ".join(dict.fromkeys(it.title for it in bodies))
    return View(sheet, f"planetary train, view {k + 1}", behind=bodies, caption=f"{names}.")


def _fitted(
    angles: Sequence[float], sun: int, planet: int, ring_planet: int, ring: int
) -> tuple[list[float], float]:
    """Angles of the planets, and of the ring, at which their teeth are in mesh.

    At the line of centres a tooth of one gear meets a space of the other; of the positions of a
    planet that fit the sun the one is taken that fits the ring best, as the first planet sets it.
    """
    turned: list[float] = []
    ring_angle = 0.0
    for angle in angles:
        ahead = sun * angle / PITCH
        first = angle + math.pi - PITCH / planet * (0.5 - ahead)
        options = first + PITCH / planet * np.arange(planet)
        at_ring = ring_planet * (angle - options) / PITCH - 0.5
        if not turned:
            ring_angle = angle - PITCH / ring * float(at_ring[0])
            turned.append(float(options[0]))
            continue
        off = at_ring - ring * (angle - ring_angle) / PITCH
        best = int(np.argmin(np.abs(off - np.rint(off))))
        turned.append(float(options[best]))
    return turned, ring_angle
