"""Sets of sun, planets and ring seen along their axis, turning.

Planets turn about their own axes until they fit the sun, and the first of them the ring.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.report.drawing.player import Animation, Body, Reading, View
from gearopt.report.drawing.sheet import Sheet, Window, series

SIZE = 420.0  # px of a view
MOMENTS, SECONDS = 181, 12.0  # of the motion that is shown, at normal speed
MOST_TURNS = 10.0
ROOT, TIP = 0.34, 0.16  # of a pitch: half thickness of a tooth there
PITCH = 2.0 * math.pi
ARM = 0.02  # of the distance of the axes: half the width of an arm of the carrier


def outline(teeth: int, module: float, inside: bool = False) -> np.ndarray:
    """Outline (4 z, 2) of a gear with teeth as trapezia, the first along x; inside: of a ring."""
    radius, way = 0.5 * module * teeth, -1.0 if inside else 1.0
    root, tip = radius - way * 1.25 * module, radius + way * module
    at = np.array([-ROOT, -TIP, TIP, ROOT]) + np.arange(teeth)[:, None]
    r = np.broadcast_to([root, tip, tip, root], at.shape).ravel()
    angle = at.ravel() * PITCH / teeth
    return np.stack((r * np.cos(angle), r * np.sin(angle)), axis=1)


@dataclass(frozen=True)
class Wheel:
    """A gear that is seen: its name, teeth and outline (P, 2), a tooth along x; rim: its radius.

    speed: turns over those of the input.
    """

    name: str
    teeth: int
    speed: float
    outline: Any
    rim: float = 0.0

    @property
    def title(self) -> str:
        """Name and teeth."""
        return f"{self.name}: z {self.teeth}"


@dataclass(frozen=True)
class GearSet:
    """Planets at angles [rad] about the axis of their carrier, at a distance, of any unit.

    at_sun, at_ring: teeth of the planets' step in mesh with either. shown: which of sun and ring
    are in the plane of the view; carrier: its speed over that of the input.
    """

    sun: Wheel
    planet: Wheel
    ring: Wheel
    at_sun: int
    at_ring: int
    carrier: float
    angles: Sequence[float]
    distance: float
    shown: tuple[bool, bool] = (True, True)

    def fitted(self) -> tuple[list[float], float]:
        """Angles of the planets, and of the ring, at which their teeth are in mesh.

        At the line of centres a tooth of one gear meets a space of the other; of the positions of
        a planet that fit the sun the one is taken that fits the ring best, as the first sets it.
        """
        turned: list[float] = []
        ring_angle = 0.0
        for angle in self.angles:
            ahead = self.sun.teeth * angle / PITCH
            first = angle + math.pi - PITCH / self.at_sun * (0.5 - ahead)
            options = first + PITCH / self.at_sun * np.arange(self.at_sun)
            at_ring = self.at_ring * (angle - options) / PITCH - 0.5
            if not turned:
                ring_angle = angle - PITCH / self.ring.teeth * float(at_ring[0])
                turned.append(float(options[0]))
                continue
            off = at_ring - self.ring.teeth * (angle - ring_angle) / PITCH
            best = int(np.argmin(np.abs(off - np.rint(off))))
            turned.append(float(options[best]))
        return turned, ring_angle

    def bodies(self, turns: np.ndarray) -> list[Body]:
        """The gears at each number of turns of the input."""

        def body(it: Wheel, angle: float, k: int, x: Any = 0.0, y: Any = 0.0) -> Body:
            moving = np.broadcast_arrays(x, y, angle + PITCH * it.speed * turns)
            style = "body" if it is self.ring else "tip"
            return Body(it.outline, np.stack(moving, axis=1), style, series(k), it.title)

        turned, ring_angle = self.fitted()
        rows = [body(self.sun, 0.0, 1)] if self.shown[0] else []
        for angle, turn in zip(self.angles, turned, strict=True):
            orbit = angle + PITCH * self.carrier * turns
            place = self.distance * np.cos(orbit), self.distance * np.sin(orbit)
            rows.append(body(self.planet, turn, 2, *place))
        if self.shown[1]:
            ring = body(self.ring, ring_angle, 3)
            if self.ring.rim:
                t, shape = PITCH * np.arange(180) / 180, self.ring.outline
                around = self.ring.rim * np.stack((np.cos(t), np.sin(t)), axis=1)
                rows.append(Body(around, style="body", colour=series(3)))
                whole = np.concatenate((around, around[:1], shape[::-1], shape[-1:]))
                rows.append(Body(whole, ring.places, "rim", series(3)))
            rows.append(ring)
        return rows

    def arms(self, turns: np.ndarray) -> Body:
        """The carrier: an arm from the axis to each planet."""
        points = [(0.0, 0.0)]
        for angle in self.angles:
            end = self.distance * np.exp(1j * angle)
            aside = 1j * ARM * end
            points += [(z.real, z.imag) for z in (aside, end + aside, end - aside, -aside)]
        places = np.zeros((len(turns), 3))
        places[:, 2] = PITCH * self.carrier * turns
        return Body(points, places, "shaft", title="carrier")


def animation(
    sets: Sequence[GearSet],
    name: str,
    ends: Sequence[tuple[str, float]],
    caption: str,
) -> Animation:
    """Sets as they turn: one turn of the slower carrier, at most MOST_TURNS of the input.

    Where no carrier turns, one of the ring. ends: what is read, and its turns over the input's.
    """
    slow = min((abs(v) for it in sets if (v := it.carrier)), default=0.0)
    slow = slow or min((abs(v) for it in sets if (v := it.ring.speed)), default=1.0)
    turns = np.linspace(0.0, min(1.0 / slow, MOST_TURNS), MOMENTS)
    return Animation(
        name,
        [_view(it, f"{name}, view {k}", turns) for k, it in enumerate(sets, 1)],
        np.linspace(0.0, SECONDS, MOMENTS),
        f"The input turns counter-clockwise; {caption}",
        [Reading(f"turns of the {of}", speed * turns, "", 3) for of, speed in ends],
    )


def _view(it: GearSet, name: str, turns: np.ndarray) -> View:
    bodies = it.bodies(turns)
    reach = 0.5 * max(
        np.ptp(np.asarray(b.outline)[:, 0]) + 2.0 * np.abs(np.asarray(b.places)[..., 0]).max()
        for b in bodies
    )
    window = Window(-reach, reach, -reach, reach, (8.0, 8.0, 8.0, 8.0))
    sheet = Sheet(window, window.scale(SIZE, SIZE))
    sheet.cross(0.0, 0.0, 2.0 / sheet.scale)
    names = ", ".join(dict.fromkeys(b.title for b in bodies if b.title))
    return View(sheet, name, behind=bodies, front=[it.arms(turns)], caption=f"{names}.")
