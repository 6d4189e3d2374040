"""A spur pair turning through one base pitch: its teeth in contact, coloured by their load."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.contact import usable_path
from gearopt.report.drawing.mesh_view import (
    action,
    axes,
    on_action,
    pitch_circle,
    sector,
    sheet_of,
    tooth,
)
from gearopt.report.drawing.player import Animation, Body, Reading, Scale, View
from gearopt.report.drawing.sheet import SERIES_OF_MEMBERS, series
from gearopt.report.measures import Measures

STILL_AT = 0.15  # of the time in which most pairs touch: the moment of the still
SECONDS = 6.0  # of one base pitch at normal speed
MARGINS = (8.0, 8.0, 8.0, 8.0)  # px around a view
DOT = 4.0  # px: radius of a point of contact
CORNERS = 16  # of its outline
ALONE, BESIDE = 1.25, 0.98  # times as large: one view alone; one of two that fit on a sheet
CAPTION = (
    "The pinion, below, turns clockwise and drives; its pairs of teeth, numbered from the one that "
    "came into contact last, touch on the line of action. Colour: their share of the normal force. "
    "After one base pitch the motion repeats, each pair in the place of the next."
)


@dataclass(frozen=True)
class Carried:
    """Loads of the pairs of teeth over one base pitch; N moments, K pairs.

    travels (N,): of the pairs, in base pitches, from 0 to 1, a jump being one travel twice.
    positions (N, K) [mm] on the line of action, 0 at the pitch point, NaN where a pair is not in
    its path; pair k + 1 is one base pitch ahead of pair k. shares (N, K) of the normal force; error
    (N,): transmission error [mm].
    """

    travels: Any
    positions: Any
    shares: Any
    error: Any

    @classmethod
    def of_columns(cls, travels: Any, positions: Any, shares: Any, error: Any) -> "Carried":
        """Shares and errors from columns in the order in which one pair meets them on its path.

        positions and shares (M,): those of pair 1 at all moments, then of pair 2, and so on; the
        last pair may leave the path before the last moment.
        """
        count = len(travels)
        pairs = -(-len(positions) // count)
        places, parts = (
            np.append(values, np.full(pairs * count - len(values), np.nan)).reshape(pairs, count).T
            for values in (positions, shares)
        )
        return cls(np.asarray(travels), places, parts, np.asarray(error))

    @property
    def percent(self) -> Any:
        """Shares in per cent (N, K), NaN where a pair is not on its path."""
        return np.where(np.isfinite(self.positions), 100.0 * np.asarray(self.shares), np.nan)

    @property
    def touching(self) -> Any:
        """Positions (N, K) [mm] of pairs that carry, NaN of others."""
        return np.where(np.asarray(self.shares) > 0.0, self.positions, np.nan)

    def along(self, values: Any) -> Any:
        """Values (N, K) of pairs as columns (M,) that one pair meets on its path."""
        return np.asarray(values).T[np.isfinite(self.positions.T)]


def in_mesh(
    pair: GearPair,
    name: str,
    shown: Mapping[str, Carried],
    measures: Measures,
    caption: str = CAPTION,
) -> Animation:
    """The animation of a pair of whole teeth, of equal cycles side by side.

    shown: what the teeth carry, by what is different, such as "before" and "after".
    """
    first = next(iter(shown.values()))
    larger = ALONE if len(shown) == 1 else BESIDE
    views = [_view(pair, carried, words, larger) for words, carried in shown.items()]
    readings = [_place(first, measures)]
    for words, carried in shown.items():
        of = f"{words}: " if len(shown) > 1 else ""
        for k, share in enumerate(carried.percent.T, 1):
            readings.append(Reading(f"{of}share of pair {k}", share, "%", 1))
        error = np.array([measures.of(e, "um") for e in carried.error])
        unit, decimals = measures.unit("um"), 2 + 2 * measures.digits
        readings.append(Reading(f"{of}transmission error", error, unit, decimals))
    return Animation(
        name,
        views,
        SECONDS * first.travels,
        caption,
        readings,
        marks=measures.of(1.0, "mm") * first.positions,
        scale=Scale("share of the normal force", 0.0, 100.0, "%"),
        still=_still(first),
    )


def _place(carried: Carried, measures: Measures) -> Reading:
    """Position of pair 1 on the line of action."""
    values = measures.of(1.0, "mm") * carried.positions[:, 0]
    return Reading("pair 1 at s", values, measures.unit("mm"), 2 + measures.digits)


def _still(carried: Carried) -> int:
    """A moment soon after a pair came into contact, when shares differ most."""
    most = carried.travels[np.isfinite(carried.positions).all(axis=1)]
    soon = most.min() + STILL_AT * np.ptp(most)
    return int(np.argmin(np.abs(carried.travels - soon)))


def _view(pair: GearPair, carried: Carried, words: str, larger: float) -> View:
    """Draw gears and teeth behind the line of action, and points of contact in front of it."""
    sheet = sheet_of(pair, MARGINS, larger)
    behind = [body for k in range(2) for body in _gear(pair, k, carried)]
    for k, at in enumerate(axes(pair)):
        pitch_circle(sheet, at, pair.normal_module, series(SERIES_OF_MEMBERS[k]))
    action(sheet, pair, usable_path(pair))
    dots = [
        Body(
            _dot(DOT / sheet.scale),
            np.array([(*on_action(pair, s), 0.0) for s in places]),
            "picked",
            "--ink",
            f"point of contact of pair {k}",
            label=str(k),
        )
        for k, places in enumerate(carried.touching.T, 1)
    ]
    return View(sheet, f"teeth in mesh {words}".rstrip(), behind, dots, words.capitalize())


def _gear(pair: GearPair, k: int, carried: Carried) -> list[Body]:
    """Pinion (k = 0) or wheel, then its teeth that carry, which turn with it.

    It turns by s/r_b from where its pair 1 touches at the pitch point; s moves by p_b a cycle.
    """
    gear, at, member = pair.gears[k], axes(pair)[k], MEMBERS[k]
    travelled = carried.positions[0, 0] + float(pair.base_pitch) * carried.travels
    turn = math.copysign(2.0, at) * travelled / float(gear.base_diameter)
    places = np.stack((np.zeros_like(turn), np.full_like(turn, at), turn), axis=1)
    bodies = [Body(sector(gear, at, 1), places, "tip", series(SERIES_OF_MEMBERS[k]), member)]
    for n, share in enumerate(carried.percent.T):
        title = f"{member}, pair {n + 1}"
        bodies.append(Body(tooth(gear, at, n), places, "heat", title=title, values=share))
    return bodies


def _dot(radius: float) -> list[tuple[float, float]]:
    """A circle about the origin."""
    turns = (2.0 * math.pi * k / CORNERS for k in range(CORNERS))
    return [(radius * math.cos(t), radius * math.sin(t)) for t in turns]
