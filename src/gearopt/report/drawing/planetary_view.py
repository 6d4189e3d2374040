"""Planetary trains seen along their axis, turning: teeth as trapezia, in modules, without shifts.

Planets turn about their own axes until they fit the sun, and the first of them the ring.
"""

import math
from collections.abc import Sequence

import numpy as np

from gearopt.formulations.epicyclic.design import EpicyclicDesign
from gearopt.formulations.epicyclic.request import SETS
from gearopt.report.drawing.player import Animation, Body, Reading, View
from gearopt.report.drawing.sheet import Sheet, Window, series
from gearopt.report.section import Section

SIZE = 420.0  # px of a view
MOMENTS, SECONDS = 181, 12.0  # of the motion that is shown, at normal speed
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
    """The train as it turns: one turn of a carrier, or of the input where carriers rest."""
    speeds = {member.name: member.speed for member in design.members}
    source = next(m.name for m in design.members if m.use == "input")
    slow = min((abs(v) for *_, c in design.sets if (v := speeds[c])), default=1.0)
    turns = np.linspace(0.0, 1.0 / slow, MOMENTS)
    views = [_view(design, k, speeds, turns) for k in range(_views(design))]
    readings = [Reading(f"turns of the {source} (input)", turns, "", 2)]
    sink = next(m.name for m in design.members if m.use == "output")
    readings.append(Reading(f"turns of the {sink} (output)", speeds[sink] * turns, "", 3))
    times = np.linspace(0.0, SECONDS, MOMENTS)
    caption = "The input turns counter-clockwise; lengths are in modules, teeth are not involutes."
    animation = Animation("the train as it turns", views, times, caption, readings)
    return Section("The train along its axis", animations=[animation])


def _views(design: EpicyclicDesign) -> int:
    """Sets of two carriers, steps of planets, or one view of a simple set."""
    return 1 if design.arrangement == "simple" else 2


def _view(design: EpicyclicDesign, k: int, speeds: dict[str, float], turns: np.ndarray) -> View:
    """A set, or a step of the planets, with what is in mesh with it there."""
    sets = SETS[design.arrangement]
    (s, p, q, r), (sun, ring, carrier) = sets[min(k, len(sets) - 1)], design.sets[-1 if k else 0]
    stepped = p != q
    moon, planet = "planets2" if k and len(design.gears) == 6 else "planets", q if k else p
    places = [place for place in design.places if place.carrier == carrier]
    angles = [math.radians(place.angle_deg) for place in places]
    teeth = [gear.teeth for gear in design.gears]
    turned, ring_angle = _fitted(angles, teeth[s], teeth[p], teeth[q], teeth[r])
    module = design.gears[planet].module
    distance = 0.5 * (teeth[s] + teeth[p]) * design.gears[s].module
    orbit = PITCH * speeds[carrier] * turns
    bodies = []
    if not (stepped and k):
        spin = np.stack((0.0 * turns, 0.0 * turns, PITCH * speeds[sun] * turns), axis=1)
        shape = outline(teeth[s], design.gears[s].module)
        bodies.append(Body(shape, spin, "tip", series(1), f"{sun}: z {teeth[s]}"))
    for angle, turn in zip(angles, turned, strict=True):
        x, y = distance * np.cos(angle + orbit), distance * np.sin(angle + orbit)
        spin = np.stack((x, y, turn + PITCH * speeds[moon] * turns), axis=1)
        shape = outline(teeth[planet], module)
        bodies.append(
            Body(shape, spin, "tip", series(2), f"{design.gears[planet].name}: z {teeth[planet]}")
        )
    reach = distance + 0.5 * module * (teeth[planet] + 2.0)
    if not stepped or k or design.arrangement == "wolfrom":
        spin = np.stack((0.0 * turns, 0.0 * turns, ring_angle + PITCH * speeds[ring] * turns), 1)
        shape = outline(teeth[r], design.gears[r].module, inside=True)
        bodies.append(Body(shape, spin, "body", series(3), f"{ring}: z {teeth[r]}"))
        reach = max(reach, 0.5 * design.gears[r].module * (teeth[r] + 3.0))
    window = Window(-reach, reach, -reach, reach, (8.0, 8.0, 8.0, 8.0))
    sheet = Sheet(window, window.scale(SIZE, SIZE))
    sheet.cross(0.0, 0.0, 2.0)
    names = ", ".join(dict.fromkeys(body.title for body in bodies))
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
