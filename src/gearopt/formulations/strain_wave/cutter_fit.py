"""Straight and circular edges nearest to a cutter's exact one: least largest deviation.

The straight edge is a linear program. The arc is fitted by linear programs that are solved again
with new weights, and by second-order cones; both give the deviation that a toolmaker may use up.
"""

import math
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.result import Result
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Terms, Var
from gearopt.physics.strain_wave.vectors import Vector

UM = 1e3  # 1 mm in um: deviations are posed in um
ROUNDS = 30  # of weights or linearisations, at most
SETTLED = 1e-9  # relative change of weights that ends them
MILLIONTH = 1e-6  # of half a chord: unit of the deviation of arcs by linear programs
STILL = 1e-5  # of the deviation, by which a move of the centre may still change it
LEAST_UNIT = 1e-9  # of half a chord: least unit of that of arcs by cones


@dataclass(frozen=True)
class StraightEdge:
    """Angle [rad] of the edge to the tooth's axis, offset [mm] at height 0, deviation [mm]."""

    angle: float
    offset: float
    deviation: float
    least_squares: float
    result: Result


@dataclass(frozen=True)
class ArcEdge:
    """Radius and centre [mm] of an arc, its deviation [mm], and how often it was solved."""

    radius: float
    centre: Vector
    deviation: float
    rounds: int
    result: Result


def straight_problem(points: Vector, angle: float | None = None) -> Conic:
    """Pose the straight edge of least largest deviation across the axis, e [um]: a linear program.

    |y_i - c_0 - c_1 u_i| <= e, u the height over the middle in half lengths. angle [rad]: of an
    edge that is given, falling towards the tip.
    """
    middle, half = _span(points.x)
    u, y = (points.x - middle) / half, points.y - points.y.mean()
    slope = None if angle is None else -math.tan(angle) * half

    def evaluate(x: Any, p: Any) -> Terms:
        off = UM * (y - x.offset / UM - u * (x.slope / UM))
        return Terms(
            {"deviation": x.e}, defines={"above": 1.0 + off - x.e, "below": 1.0 - off - x.e}
        )

    most = UM * 4.0 * float(np.abs(y).max() + half)
    given = (-most, most) if slope is None else (UM * slope, UM * slope)
    variables = (
        Var("offset", "um", -most, most, 0.0),
        Var("slope", "um", *given, given[0] if slope is not None else 0.0),
        Var("e", "um", 0.0, most, most),
    )
    return Conic("straight cutting edge", variables, (), evaluate)


def straight_edge(points: Vector, angle: float | None = None) -> StraightEdge:
    """Return the straight edge nearest to points (n,) of a cutter [mm], certified.

    angle [rad]: of a tool that is given, to be shifted alone. The deviation is normal to the edge.
    """
    result = solve(straight_problem(points, angle))
    middle, half = _span(points.x)
    slope = float(result.design["slope_um"]) / UM / half
    offset = points.y.mean() + float(result.design["offset_um"]) / UM - slope * middle
    normal = math.cos(math.atan(slope))
    fit = np.polyfit(points.x, points.y, 1)
    squares = np.abs(np.polyval(fit, points.x) - points.y).max() * math.cos(math.atan(fit[0]))
    deviation = float(result.design["e_um"]) / UM * normal
    return StraightEdge(-math.atan(slope), float(offset), deviation, float(squares), result)


def arc_problem(points: Vector, weights: Any) -> Conic:
    """Pose max |w_i (|p_i|^2 - 2 c.p_i - s)| -> min, s = R^2 - |c|^2: linear for given weights.

    points in half lengths of the edge from its middle; e in millionths of that.
    """
    square = points.dot(points)

    def evaluate(x: Any, p: Any) -> Terms:
        import cvxpy as cp

        whole = square - 2.0 * (points.x * x.cx + points.y * x.cy) - x.s
        off = cp.multiply(weights, whole) / MILLIONTH
        return Terms(
            {"deviation": x.e}, defines={"above": 1.0 + off - x.e, "below": 1.0 - off - x.e}
        )

    variables = (
        Var("cx", "", -1e6, 1e6, 0.0),
        Var("cy", "", -1e6, 1e6, 0.0),
        Var("s", "", -1e9, 1e9, 1.0),
        Var("e", "", 0.0, 1e9, 1e6),
    )
    return Conic("arc by weighted squares", variables, (), evaluate)


def arc_edge(points: Vector) -> ArcEdge:
    """Return the arc nearest to points (n,) of a cutter [mm], by linear programs.

    With w_i = 1/(|p_i - c| + R) the weighted rows are the deviations |p_i - c| - R themselves. The
    last program is certified; over all arcs there is no bound, as the fit is not convex.
    """
    turned, half, (origin, lean) = _normal_form(points)
    weights = np.ones(len(turned.x))
    rounds, change = 0, math.inf
    while change >= SETTLED and rounds < ROUNDS:
        rounds += 1
        result = solve(arc_problem(turned, weights))
        cx, cy, s = (float(result.design[k]) for k in ("cx", "cy", "s"))
        radius = math.sqrt(s + cx * cx + cy * cy)
        far = np.hypot(turned.x - cx, turned.y - cy)
        after = 1.0 / (far + radius)
        change = float(np.abs(after / weights - 1.0).max())
        weights = after
    deviation = float(np.abs(far - radius).max()) * half
    centre = origin + Vector(cx, cy).turned(lean) * half
    return ArcEdge(radius * half, centre, deviation, rounds, result)


def arc_cones(points: Vector, centre: Vector, least: float = 0.0) -> Conic:
    """Pose |p_i - c| <= R + e, R - e <= the linearised |p_i - c| and R >= R_min: cones.

    centre: where c is linearised. points, centre and least R_min in half lengths; e in `_unit_of`.
    With u_i from the centre to the points at distances l_i, c moved by d and R - R_0 = a - u_0.d,
    R_0 and u_0 of the middle point, the rows are (u_i x d)^2/(l_i + R + e - u_i.d) <= R_0 - l_i + a
    + e + (u_i - u_0).d: without a difference of lengths that are nearly equal, as those of a flat
    arc are. What the linearised rows allow is allowed: |p_i - c| is convex in c.
    """
    away = points - centre
    far = away.length
    unit = away * (1.0 / far)
    middle = len(far) // 2
    r0, u0 = float(far[middle]), unit[middle]
    lean, small = unit - u0, _unit_of(far)
    units = small * r0, small * r0**2  # of d across and along u_0

    def evaluate(x: Any, p: Any) -> Terms:
        import cvxpy as cp

        across, along = x.across * units[0], x.along * units[1]
        dx, dy = along * u0.x - across * u0.y, along * u0.y + across * u0.x
        off = (r0 - far) + lean.x * dx + lean.y * dy
        a, e = small * x.a, small * x.e
        aside = (unit.x * dy - unit.y * dx) / math.sqrt(2.0 * small * r0)
        radius = r0 + a - along
        sums = (far + radius + e - unit.x * dx - unit.y * dy) / (2.0 * r0)
        room = (off + a + e) / small
        outside = [1.0 + cp.quad_over_lin(aside[i], sums[i]) - room[i] for i in range(len(far))]
        inside = 1.0 + (off + a - e) / small
        rows = {"outside": cp.hstack(outside), "inside": inside}
        if least:
            rows["least_radius"] = 1.0 + (least - radius) / r0
        return Terms({"deviation": x.e}, defines=rows)

    variables = tuple(Var(name, "", -1e6, 1e6, 0.0) for name in ("across", "along", "a"))
    return Conic("arc by cones", (*variables, Var("e", "", 0.0, 1e6, 1e6)), (), evaluate)


def arc_of_cones(points: Vector, start: ArcEdge, least_radius: float = 0.0) -> ArcEdge:
    """Arc nearest to points [mm] by cones, linearised again about each answer.

    start: as of `arc_edge`, about which they are linearised first. least_radius R_min [mm] that the
    arc has at least, on the side of the start. SolveError where none is found.
    """
    turned, half, (origin, lean) = _normal_form(points)
    least, middle = least_radius / half, turned[len(turned.x) // 2]
    centre = (start.centre - origin).turned(-lean) * (1.0 / half)
    if least_radius > start.radius:
        centre = _centre_of(turned, math.copysign(least, centre.y))
    rounds, settled = 0, False
    while not settled and rounds < ROUNDS:
        rounds += 1
        result = solve(arc_cones(turned, centre, least))
        if not result.design:
            raise SolveError(f"no arc by cones: {result.message}")
        away, small = middle - centre, _unit_of((turned - centre).length)
        r0 = away.length
        across, along = (float(result.design[k]) * small * r0 for k in ("across", "along"))
        moved = Vector(along * r0, across).turned(away.angle)
        centre = centre + moved
        settled = math.hypot(across, along) < STILL * small * r0
    radius = float(r0 - along * r0 + float(result.design["a"]) * small)
    deviation = float(np.abs((turned - centre).length - radius).max()) * half
    return ArcEdge(radius * half, origin + centre.turned(lean) * half, deviation, rounds, result)


def _centre_of(points: Vector, radius: float) -> Vector:
    """Return the centre of an arc of a radius near points in normal form, by a linear program.

    The straight edge nearest to what the arc's bulge leaves. radius < 0: below the chord.
    """
    bulge = points.x**2 / (radius + math.copysign(1.0, radius) * np.sqrt(radius**2 - points.x**2))
    line = straight_edge(Vector(points.x, points.y - bulge))
    normal = Vector(math.sin(line.angle), math.cos(line.angle))
    return normal * radius + Vector(0.0, line.offset)


def _unit_of(far: Any) -> float:
    """Return the unit of an arc's deviation: how far distances from its centre differ."""
    return max(float(np.abs(far - far[len(far) // 2]).max()), LEAST_UNIT)


def _span(x: Any) -> tuple[float, float]:
    return 0.5 * float(x.max() + x.min()), 0.5 * float(np.ptp(x))


def _normal_form(points: Vector) -> tuple[Vector, float, tuple[Vector, float]]:
    """Return points from the middle of their chord, along it, in half chords; half; the frame."""
    first, last = points[0], points[len(points.x) - 1]
    chord = last - first
    origin, half, lean = (first + last) * 0.5, 0.5 * chord.length, chord.angle
    return (points - origin).turned(-lean) * (1.0 / half), float(half), (origin, float(lean))
