"""A strain wave gearing that runs: wave generator, flexspline and circular spline, and a close-up.

The wave generator turns through half a turn; the flexspline falls back by one pitch of its teeth,
and all repeats.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.strain_wave.design import INVOLUTE, WaveDesign
from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, neutral_curve, whole_curve
from gearopt.report.drawing.player import Animation, Body, Reading, Scale, View
from gearopt.report.drawing.sheet import Sheet, Window, series
from gearopt.report.measures import Measures

SECONDS = 12.0  # of half a turn at normal speed
MOMENTS = 145  # of it: every 1.25 degrees
WIDE, CLOSE = 420.0, 640.0  # px of the whole and of the close-up
CLOSE_UP_TEETH = 3  # teeth on either side of the close-up's middle
HIGH = 5.2  # modules that the close-up is high
MARGINS = (8.0, 8.0, 8.0, 8.0)  # px around a view
SERIES_OF_BODIES = (1, 4, 6)  # of flexspline, circular spline and wave generator, in the series
UPRIGHT = 0.5 * math.pi  # the axis of the gearing's frame is drawn upwards
TOOTH = "tooth of the flexspline"
RING = 181, 721  # points of the ring, of the whole and of the close-up
CAPTION = (
    "The wave generator turns counter-clockwise, the circular spline rests; to scale. Colour: load "
    "of a tooth at the duty's torque. After half a turn the flexspline has fallen back by one "
    "pitch of its teeth, and the motion repeats."
)


def running(gearing: WaveDesign, name: str, measures: Measures) -> Animation:
    """The animation of a gearing: the whole, and the teeth at the top."""
    shape = drawn(gearing)
    turns = np.linspace(-0.5 * math.pi, 0.5 * math.pi, MOMENTS)
    most = _round_up(measures.of(max(gearing.load_N), "N"))
    views = [_whole(shape, gearing, turns, measures), _close(shape, gearing, turns, measures)]
    first = np.degrees(_arcs(shape.gearing, 0, turns))
    low, high = max(gearing.touching_deg, key=np.ptp)
    seen = np.where(np.abs(first) < max(gearing.wave_angle_deg), first, np.nan)
    readings = [
        Reading("wave generator", np.degrees(turns), "°", 1),
        Reading("output", -np.degrees(turns) / gearing.ratio, "°", 3),
        Reading("tooth at the top: angle on the wave", seen, "°", 2),
        Reading(
            "tooth at the top: load",
            measures.of(1.0, "N") * _load(gearing, first),
            measures.unit("N"),
            0,
        ),
    ]
    return Animation(
        name,
        views,
        np.linspace(0.0, SECONDS, MOMENTS),
        CAPTION,
        readings,
        marks=seen,
        scale=Scale("load of a tooth", 0.0, most, measures.unit("N")),
        still=int(np.argmin(np.abs(first - 0.5 * (low + high)))),
    )


def _round_up(value: float) -> float:
    """A number of two digits that is not smaller."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit) * unit


@dataclass(frozen=True)
class Drawn:
    """A gearing as it is drawn: neutral curve, and flanks (n, 2) [mm] of both gears.

    tooth: height and half thickness from root to tip; space: across and out, from the tip inwards.
    """

    gearing: StrainWave
    curve: NeutralCurve
    tooth: Any
    space: Any


def drawn(design: WaveDesign) -> Drawn:
    """The gearing of a report, of teeth of any law."""
    gearing = StrainWave(
        design.module_mm,
        design.flexspline_teeth,
        math.radians(design.pressure_angle_deg),
        design.profile_shift,
        design.addendum,
        design.deflection,
        design.rim_mm,
        design.clearance,
        design.wave_generator,
        math.radians(design.wrap_angle_deg),
    )
    tooth = np.c_[design.tooth_height_mm, design.tooth_half_mm]
    space = np.c_[design.space_across_mm, design.space_out_mm]
    return Drawn(gearing, neutral_curve(gearing), tooth, space)


def _arcs(gearing: StrainWave, space: int, turns: Any) -> Any:
    """The angle phi [rad] of the tooth in a space as the wave turns."""
    behind = 2.0 * math.pi * space / gearing.circular_teeth - turns
    return behind / gearing.teeth_ratio


def _load(gearing: WaveDesign, degrees: Any) -> Any:
    """The load [N] of a tooth at angles on the wave [degrees], of both lobes."""
    angles = (np.asarray(degrees) + 90.0) % 180.0 - 90.0
    return np.interp(angles, gearing.load_angle_deg, gearing.load_N, left=0.0, right=0.0)


def _places(curve: NeutralCurve, arcs: Any, turns: Any) -> Any:
    """Places (n, N, 3) of teeth, upright: x, y of the foot and the angle of the axis."""
    place, normal = whole_curve(curve, arcs)
    at = place.turned(turns + UPRIGHT)
    return np.stack((at.x, at.y, turns + normal), axis=-1)


def _tooth(shape: Drawn, points: int) -> Any:
    """The outline of a tooth of the flexspline about its foot, its axis upwards."""
    rim = 0.5 * float(shape.gearing.rim)
    height, half = shape.tooth[_evenly(len(shape.tooth), points)].T
    side = np.c_[np.r_[rim, height], np.r_[half[0], half]]
    left = np.c_[-side[:, 1], side[:, 0]]
    return np.vstack([left, left[::-1] * (-1.0, 1.0)])


def _evenly(count: int, points: int) -> Any:
    """The numbers of some points of a column, both ends among them."""
    return np.rint(np.linspace(0, count - 1, points)).astype(int)


def _spaces(shape: Drawn, numbers: Any, points: int) -> Any:
    """The outline of the circular spline's teeth along some spaces, upright."""
    gearing = shape.gearing
    across, out = shape.space[_evenly(len(shape.space), points)].T
    radius, half = np.hypot(across, out), np.arctan2(across, out)
    deep = np.r_[radius, float(gearing.root_radius)]
    wide = np.r_[half, half[-1]]
    rows = []
    for k in numbers:
        middle = UPRIGHT + 2.0 * math.pi * k / gearing.circular_teeth
        for r, angle in zip((*deep, *deep[::-1]), (*-wide, *wide[::-1]), strict=True):
            rows.append((r * math.cos(middle + angle), r * math.sin(middle + angle)))
    return np.array(rows)


def _ring(shape: Drawn, offset: float, count: int) -> Any:
    """The neutral curve, moved outwards along its normal [mm], upright at turn 0."""
    place, normal = whole_curve(shape.curve, np.linspace(-math.pi, math.pi, count)[:-1])
    x, y = place.x + offset * np.cos(normal), place.y + offset * np.sin(normal)
    return np.c_[-y, x]


def _turning(turns: Any) -> Any:
    return np.stack((0.0 * turns, 0.0 * turns, turns), axis=1)


def _bodies(shape: Drawn, gearing: WaveDesign, turns: Any, numbers: Any, points: int) -> list[Body]:
    """Teeth of the flexspline, coloured by what they carry."""
    outline = _tooth(shape, points)
    arcs = np.array([_arcs(shape.gearing, k, turns) for k in numbers])
    places, forces = _places(shape.curve, arcs, turns), _load(gearing, np.degrees(arcs))
    return [
        Body(outline, place, "heat", title=TOOTH, values=force)
        for place, force in zip(places, forces, strict=True)
    ]


def _rings(shape: Drawn, turns: Any, count: int) -> list[Body]:
    """The rim of the flexspline and the wave generator in it, which turn as one shape."""
    rim = 0.5 * float(shape.gearing.rim)
    outer, inner = _ring(shape, rim, count), _ring(shape, -rim, count)
    bar = np.array([(0.0, inner[:, 1].min()), (0.0, inner[:, 1].max())])
    places = _turning(turns)
    return [
        Body(outer, places, "tip", series(SERIES_OF_BODIES[0]), "rim of the flexspline"),
        Body(inner, places, "tip", series(SERIES_OF_BODIES[2]), "wave generator"),
        Body(bar, places, "near", title="major axis of the wave generator", line=True),
    ]


def _whole(shape: Drawn, design: WaveDesign, turns: Any, measures: Measures) -> View:
    gearing = shape.gearing
    reach = 0.5 * design.outer_diameter_mm
    sheet = Sheet(Window(-reach, reach, -reach, reach, MARGINS), WIDE / (2.0 * reach))
    _circular_spline(
        sheet, shape, range(int(gearing.circular_teeth)), 2 if design.law == INVOLUTE else 5, reach
    )
    loaded = _shown(design, measures)
    teeth = _bodies(
        shape, loaded, turns, range(int(gearing.teeth)), 2 if design.law == INVOLUTE else 4
    )
    words = f"The whole gearing, outer diameter {measures.length(2.0 * reach)} {measures.lengths}."
    return View(sheet, "strain wave gearing", [*_rings(shape, turns, RING[0]), *teeth], (), words)


def _close(shape: Drawn, design: WaveDesign, turns: Any, measures: Measures) -> View:
    gearing, m = shape.gearing, design.module_mm
    top = float(gearing.root_radius) + 0.4 * m
    half = (CLOSE_UP_TEETH - 0.3) * math.pi * m
    window = Window(-half, half, top - HIGH * m, top, MARGINS)
    sheet = Sheet(window, CLOSE / (2.0 * half))
    points = 11 if design.law == INVOLUTE else 21
    _circular_spline(sheet, shape, range(-CLOSE_UP_TEETH - 2, CLOSE_UP_TEETH + 3), points, 0.0)
    teeth = _bodies(
        shape,
        _shown(design, measures),
        turns,
        range(-CLOSE_UP_TEETH - 2, CLOSE_UP_TEETH + 3),
        points,
    )
    words = (
        f"The teeth at the top: {measures.length(2.0 * half)} {measures.lengths} from side to side."
    )
    bodies = [*_rings(shape, turns, RING[1])[:2], *teeth]
    return View(sheet, "teeth at the top", bodies, (), words)


def _shown(gearing: WaveDesign, measures: Measures) -> WaveDesign:
    """The report with loads in the unit that is shown."""
    factor = measures.of(1.0, "N")
    return replace(gearing, load_N=tuple(factor * v for v in gearing.load_N))


def _circular_spline(sheet: Sheet, shape: Drawn, numbers: Any, points: int, reach: float) -> None:
    """Draw the circular spline at rest; reach [mm]: its outer radius, 0: beyond the view."""
    inner = _spaces(shape, numbers, points)
    path = " L ".join(f"{x:.2f} {y:.2f}" for x, y in (sheet.at(*p) for p in inner))
    title, colour = "circular spline", series(SERIES_OF_BODIES[1])
    if reach:
        size, (cx, cy) = sheet.scale * reach, sheet.at(0.0, 0.0)
        ring = f"M {cx - size:.2f} {cy:.2f} a {size:.2f} {size:.2f} 0 1 1 {2 * size:.2f} 0"
        back = f"a {size:.2f} {size:.2f} 0 1 1 {-2 * size:.2f} 0 Z"
        sheet.shape(f"{ring} {back} M {path} Z", "tip", colour, title)
        return
    far = 2.0 * float(shape.gearing.root_radius)
    ends = [(inner[-1][0] * 1.2, far), (inner[0][0] * 1.2, far)]
    rest = " L ".join(f"{x:.2f} {y:.2f}" for x, y in (sheet.at(*p) for p in ends))
    sheet.shape(f"M {path} L {rest} Z", "tip", colour, title)
