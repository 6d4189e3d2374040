"""Animations: bodies that move in drawings, on one clock; the still of one moment.

A page shows the moments with the player of player.js: play, pause, slider, step, speed. Paper, a
page without scripts and readers who want no motion get the still. Between two moments all moves
linearly, so that few moments suffice; a jump is one time twice.
"""

import math
from collections.abc import Iterator, Sequence
from html import escape
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.report.drawing.sheet import Drawing, Row, Sheet, packed

ABOVE = 12.0  # px from the origin of a body up to its label


@dataclass(frozen=True)
class Body:
    """A body that moves: its outline about its own origin, and where that is at each moment.

    outline [mm]: (P, 2), or (N, P, 2) for N moments, of a body that deforms; closed unless it is
    a line. places: (N, 3) of x, y [mm] and angle [rad], counter-clockwise, continuous over turns;
    or (3,): it rests. values (N,): what a body of style `heat` shows on the animation's scale.
    Where a number of a place or a value is NaN the body is not seen. style, colour, title: as
    marks of a `Sheet` have them. label: a short text above its origin, upright.
    """

    outline: Any
    places: Any = (0.0, 0.0, 0.0)
    style: str = "tip"
    colour: str = ""
    title: str = ""
    values: Any = None
    line: bool = False
    label: str = ""


@dataclass(frozen=True)
class View:
    """A drawing in which bodies move: behind the marks of its sheet, and in front of them."""

    sheet: Sheet
    name: str
    behind: Sequence[Body] = ()
    front: Sequence[Body] = ()
    caption: str = ""

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies in the order in which they are drawn."""
        return (*self.behind, *self.front)


@dataclass(frozen=True)
class Reading:
    """A number that is read while bodies move: values (N,), its unit and decimals; NaN: none."""

    name: str
    values: Any
    unit: str = ""
    decimals: int = 2

    def text(self, moment: int) -> str:
        """The number at a moment with its unit, as player.js writes it."""
        value = float(np.asarray(self.values)[moment])
        return "–" if math.isnan(value) else f"{value:.{self.decimals}f} {self.unit}".rstrip()


@dataclass(frozen=True)
class Scale:
    """Meaning of the colours of bodies of style `heat`, from low to high."""

    name: str
    low: float
    high: float
    unit: str = ""

    def shares(self, values: Any) -> Any:
        """Values as shares of the scale, from 0 to 1; NaN stays."""
        return np.clip((np.asarray(values, float) - self.low) / (self.high - self.low), 0.0, 1.0)


@dataclass(frozen=True)
class Animation:
    """Bodies that move over one period, again and again, in views on one clock.

    name: unique on its page; a `Figure` that follows it has it. times (N,) [s] at normal speed,
    from 0, never falling, N >= 2. readings: the first one names the place of the slider. marks
    (N,) or (N, K): places on the x axis of the figures that follow. still: the number of the moment
    on paper, from 0. ValueError where a body or a reading has not N moments.
    """

    name: str
    views: Sequence[View]
    times: Any
    caption: str = ""
    readings: Sequence[Reading] = ()
    marks: Any = ()
    scale: Scale | None = None
    still: int = 0

    def __post_init__(self) -> None:
        """Refuse times that fall, and what has another number of moments."""
        times = np.asarray(self.times, float)
        if times.ndim != 1 or times.size < 2 or times[0] != 0.0 or np.any(np.diff(times) < 0.0):
            raise ValueError(f"the times of {self.name} do not rise from 0")
        named = [(reading.name, reading.values, 1) for reading in self.readings]
        for body in (body for view in self.views for body in view.bodies):
            name = body.title or body.style
            named += [(name, body.places, 2), (name, body.outline, 3)]
            named += [(name, body.values, 1)] if body.values is not None else []
        for name, values, axes in named:
            shape = np.shape(values)
            if len(shape) == axes and shape[0] != times.size:
                raise ValueError(
                    f"{name} has {shape[0]} moments, not the {times.size} of the times"
                )

    @property
    def row(self) -> Row:
        """The views at the moment of the still, side by side."""
        return Row([self.drawing(view, self.still) for view in self.views])

    @property
    def read_out(self) -> list[tuple[str, str]]:
        """Names and texts of the readings at the moment of the still."""
        return [(reading.name, reading.text(self.still)) for reading in self.readings]

    def drawing(self, view: View, moment: int) -> Drawing:
        """A view at a moment."""
        behind, front = (
            "\n".join(_svg(body, view.sheet, self.scale, moment) for body in bodies)
            for bodies in (view.behind, view.front)
        )
        return view.sheet.drawing(view.name, view.caption, True, behind, front)

    @property
    def data(self) -> dict[str, Any]:
        """Data of player.js: numbers once each as 32-bit floats, and who uses them."""
        tracks: dict[str, int] = {}

        def track(values: Any) -> int:
            text = packed("f", np.asarray(values, float).ravel().tolist())["bdata"]
            return tracks.setdefault(text, len(tracks))

        marks = np.asarray(self.marks, float)
        marks = marks[:, None] if marks.ndim == 1 and marks.size else marks
        return {
            "name": self.name,
            "times": track(self.times),
            "still": self.still,
            "bodies": [
                {key: track(values) for key, values in _moved(body, view.sheet, self.scale)}
                for view in self.views
                for body in view.bodies
            ],
            "readings": [
                {"track": track(r.values), "unit": r.unit, "decimals": r.decimals}
                for r in self.readings
            ],
            "marks": [track(marks[:, k]) for k in range(marks.shape[1])] if marks.size else [],
            "tracks": list(tracks),
        }


def _places(body: Body, sheet: Sheet) -> Any:
    """X, y [px] and angle [deg, clockwise] of a body, (3,) or (N, 3)."""
    places = np.asarray(body.places, float)
    at = np.array(sheet.at(0.0, 0.0)) + sheet.scale * places[..., :2] * (1.0, -1.0)
    return np.concatenate((at, -np.degrees(places[..., 2:])), axis=-1)


def _outline(body: Body, sheet: Sheet) -> Any:
    """The outline [px] about the body's origin, y downwards."""
    return sheet.scale * np.asarray(body.outline, float) * (1.0, -1.0)


def _moved(body: Body, sheet: Sheet, scale: Scale | None) -> Iterator[tuple[str, Any]]:
    """Yield what of a body changes from moment to moment."""
    if np.ndim(body.places) == 2:
        yield "places", _places(body, sheet)
    if np.ndim(body.outline) == 3:
        yield "outline", _outline(body, sheet)
    if body.values is not None and scale is not None:
        yield "values", scale.shares(body.values)


def _svg(body: Body, sheet: Sheet, scale: Scale | None, moment: int) -> str:
    """The SVG of a body at a moment; player.js changes what moves of it."""
    places, outline = _places(body, sheet), _outline(body, sheet)
    x, y, turn = places[moment] if places.ndim == 2 else places
    points = outline[moment] if outline.ndim == 3 else outline
    path = "M" + "L".join(f"{u:.2f} {v:.2f}" for u, v in points) + ("" if body.line else "Z")
    value = 0.0
    if body.values is not None and scale is not None:
        value = float(scale.shares(body.values)[moment])
    seen = bool(np.isfinite((x, y, turn, value)).all())
    inner = f"<title>{escape(body.title)}</title>" if body.title else ""
    look = [f"--c: var({body.colour})"] if body.colour else []
    look += [f"--v: {value:.4f}"] if body.values is not None and seen else []
    style = f' style="{"; ".join(look)}"' if look else ""
    place = f' transform="translate({x:.2f} {y:.2f})"' if seen else ' style="display: none"'
    turned = f' transform="rotate({turn:.4f})"' if seen else ""
    inner += f'<path class="{body.style}"{style}{turned} d="{path}"></path>'
    if body.label:
        inner += f'<text class="name" y="{-ABOVE:g}"{style}>{escape(body.label)}</text>'
    return f'<g class="moves"{place}>{inner}</g>'
