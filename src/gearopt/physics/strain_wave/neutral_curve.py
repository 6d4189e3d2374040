"""The neutral curve of a flexspline on its wave generator, which keeps its length.

In polar form rho(p), rho(0) = R_m + w_0 on the major axis, perimeter 2 pi R_m.
"""

import math
from functools import cache
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.choosing import choose
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.vectors import Vector, polar

NODES, WEIGHTS = np.polynomial.legendre.leggauss(14)  # perimeters to 1e-14 for w_0/R_m up to 0.05
CHORDS = 8  # steps of one slope: each divides the error by 100 or more
AT_ONCE = 2000  # places of which all nodes are computed at once: more do not fit into fast memory
TABLE = 721  # places of half a curve: every quarter of a degree
INVERSIONS = 7  # Newton steps from an arc to its polar angle, at most
INVERTED = 1e-9  # rad of a step that leaves rounding alone, as each squares the error


@dataclass(frozen=True)
class NeutralCurve:
    """A curve of radius R_m [mm] before it is deformed; the text of its shape has two numbers.

    cosine, discs: rho = first + second f(p), f(0) = 1; ellipse: half axes first and second [mm].
    wrap [rad]: as in `StrainWave`.
    """

    radius: Any
    wave: str
    first: Any
    second: Any
    wrap: float


def curve_of(gearing: StrainWave, change: Any) -> NeutralCurve:
    """Return the curve whose second number is changed by `change` [mm] from the first order.

    The first order keeps the length for small w_0; `perimeter_error` tells what is left.
    """
    radius, lift = gearing.neutral_radius, gearing.radial_deflection
    if gearing.wave == "ellipse":
        return NeutralCurve(radius, "ellipse", radius + lift, radius - lift + change, 0.0)
    return NeutralCurve(radius, gearing.wave, radius + change, lift - change, gearing.wrap)


def neutral_curve(gearing: StrainWave) -> NeutralCurve:
    """Return the curve of a gearing, of floats or arrays, by chord steps on its perimeter.

    Relative error of the perimeter below 1e-14. ValueError for an unknown wave.
    """
    if gearing.wave not in ("cosine", "ellipse", "discs"):
        raise ValueError(f"no wave {gearing.wave!r}: cosine, ellipse or discs")
    at = 0.0 * gearing.neutral_radius
    step = 1e-3 * gearing.radial_deflection
    start = perimeter_error(curve_of(gearing, at))
    slope = (perimeter_error(curve_of(gearing, at + step)) - start) / step
    for _ in range(CHORDS):
        at = at - perimeter_error(curve_of(gearing, at)) / slope
    return curve_of(gearing, at)


def perimeter_error(curve: NeutralCurve) -> Any:
    """Return the perimeter relative to 2 pi R_m, less 1."""
    return arc_angle(curve, 0.5 * math.pi) / (0.5 * math.pi) - 1.0


def radii(curve: NeutralCurve, angle: Any) -> tuple[Any, Any, Any, Any]:
    """Return rho [mm] and its first three derivatives by the polar angle p [rad].

    Discs: |p| <= pi/2; the third derivative jumps at the wrap angle.
    """
    if curve.wave == "ellipse":
        return _of_ellipse(curve, angle)
    if curve.wave == "cosine":
        cosine, sine = np.cos(2.0 * angle), np.sin(2.0 * angle)
        shape = (cosine, -2.0 * sine, -4.0 * cosine, 8.0 * sine)
    else:
        shape = _of_discs(curve.wrap, angle)
    a = curve.second
    return curve.first + a * shape[0], a * shape[1], a * shape[2], a * shape[3]


def _of_ellipse(curve: NeutralCurve, angle: Any) -> tuple[Any, Any, Any, Any]:
    """rho^-2 = u = cos^2(p)/a^2 + sin^2(p)/b^2."""
    a, b = 1.0 / curve.first**2, 1.0 / curve.second**2
    mean, half = 0.5 * (a + b), 0.5 * (a - b)
    cosine, sine = np.cos(2.0 * angle), np.sin(2.0 * angle)
    u, u1, u2, u3 = mean + half * cosine, -2 * half * sine, -4 * half * cosine, 8 * half * sine
    rho = 1.0 / np.sqrt(u)
    first = -0.5 * rho * u1 / u
    second = rho * (0.75 * (u1 / u) ** 2 - 0.5 * u2 / u)
    third = rho * (-1.875 * (u1 / u) ** 3 + 2.25 * u1 * u2 / u**2 - 0.5 * u3 / u)
    return rho, first, second, third


@cache
def disc_constants(wrap: float) -> Any:
    """Return C1, e, A, E, B of the ring on two discs, for w(0) = 1.

    w = C1 + e cos(p) for p <= wrap, where w'' + w is constant; beyond it, with s = p - pi/2,
    w = A + E cos(s) + (B/2) s sin(s). w, w', w'' are continuous and w has the mean 0 (small
    deflections, inextensible ring). wrap [rad] between 0 and pi/2.
    """
    s = wrap - 0.5 * math.pi
    cosine, sine = math.cos(s), math.sin(s)
    rows = [
        [1.0, math.cos(wrap), -1.0, -cosine, -0.5 * s * sine],
        [0.0, -math.sin(wrap), 0.0, sine, -0.5 * (sine + s * cosine)],
        [0.0, -math.cos(wrap), 0.0, cosine, -0.5 * (2.0 * cosine - s * sine)],
        [wrap, math.sin(wrap), -s, -sine, 0.5 * (s * cosine - sine)],
        [1.0, 1.0, 0.0, 0.0, 0.0],
    ]
    return np.linalg.solve(np.array(rows), np.array([0.0, 0.0, 0.0, 0.0, 1.0]))


def _of_discs(wrap: float, angle: Any) -> tuple[Any, Any, Any, Any]:
    """Shape and derivatives of `disc_constants`, even in p."""
    c1, e, a, big, b = disc_constants(wrap)
    sign, q = choose(angle < 0.0, -1.0, 1.0), np.abs(angle)
    s, inside = q - 0.5 * math.pi, q <= wrap
    cosine, sine = np.cos(s), np.sin(s)
    shape = (
        choose(inside, c1 + e * np.cos(q), a + big * cosine + 0.5 * b * s * sine),
        choose(inside, -e * np.sin(q), -big * sine + 0.5 * b * (sine + s * cosine)),
        choose(inside, -e * np.cos(q), -big * cosine + 0.5 * b * (2.0 * cosine - s * sine)),
        choose(inside, e * np.sin(q), big * sine - 0.5 * b * (3.0 * sine + s * cosine)),
    )
    return shape[0], sign * shape[1], shape[2], sign * shape[3]


def arc_angle(curve: NeutralCurve, angle: Any) -> Any:
    """Return phi = (1/R_m) int_0^p sqrt(rho^2 + rho'^2) dp [rad]: the tooth's angle undeformed.

    angle p [rad], |p| <= pi/2. Gauss's rule of 14 nodes between places where the curve is smooth.
    """
    if curve.wave != "discs":
        return _arc(curve, 0.0, angle)
    reach, wrap = np.abs(angle), curve.wrap
    on_disc = _arc(curve, 0.0, np.minimum(reach, wrap))
    return np.sign(angle) * (on_disc + _arc(curve, wrap, np.maximum(reach, wrap), free=True))


def _arc(curve: NeutralCurve, low: Any, high: Any, free: bool = False) -> Any:
    """Return the integral of `arc_angle` on one side of a disc's end; free: beyond it."""
    half = 0.5 * (high - low)
    numbers = half, curve.first, curve.second
    if all(isinstance(v, int | float | np.ndarray) and np.size(v) <= AT_ONCE for v in numbers):
        nodes = NODES.reshape(-1, *([1] * max(map(np.ndim, numbers))))
        each = iter(_speed(curve, low + half * (1.0 + nodes), free))
    else:
        each = (_speed(curve, low + half * (1.0 + float(node)), free) for node in NODES)
    total: Any = 0.0
    for weight, speed in zip(WEIGHTS, each, strict=True):
        total = total + float(weight) * speed
    return half * total / curve.radius


def _speed(curve: NeutralCurve, angle: Any, free: bool) -> Any:
    rho, slope = _radius(curve, angle, free)
    return np.sqrt(rho * rho + slope * slope)


def _radius(curve: NeutralCurve, angle: Any, free: bool) -> tuple[Any, Any]:
    """Return rho [mm] and its derivative; free: of discs, where none carries, else where one does.

    What most of the time goes into: without the derivatives and the side that are not asked for.
    """
    a = curve.second
    if curve.wave == "ellipse":
        mean, half = (0.5 * (curve.first**-2.0 + sign * a**-2.0) for sign in (1.0, -1.0))
        double = 2.0 * angle
        rho = 1.0 / np.sqrt(mean + half * np.cos(double))
        return rho, rho**3 * half * np.sin(double)
    if curve.wave == "cosine":
        double = 2.0 * angle
        return curve.first + a * np.cos(double), -2.0 * a * np.sin(double)
    c1, e, middle, big, b = disc_constants(curve.wrap)
    if not free:
        return curve.first + a * (c1 + e * np.cos(angle)), -a * e * np.sin(angle)
    s = angle - 0.5 * math.pi
    cosine, sine = np.cos(s), np.sin(s)
    shape = middle + big * cosine + 0.5 * b * s * sine
    return curve.first + a * shape, a * (0.5 * b * (sine + s * cosine) - big * sine)


def angle_of_arc(curve: NeutralCurve, arc: Any) -> Any:
    """Return the polar angle p [rad] of phi [rad], |phi| <= pi/2: the inverse of `arc_angle`."""
    angle = arc + 0.0 * curve.radius
    for _ in range(INVERSIONS):
        rho, slope, _, _ = radii(curve, angle)
        speed = np.sqrt(rho * rho + slope * slope) / curve.radius
        change = (arc_angle(curve, angle) - arc) / speed
        angle = angle - change
        if isinstance(change, float | np.ndarray) and np.all(np.abs(change) < INVERTED):
            break
    return angle


def curvature(curve: NeutralCurve, angle: Any) -> tuple[Any, Any]:
    """Return the curvature kappa [1/mm] of the curve and its derivative by p [1/(mm rad)]."""
    r, r1, r2, r3 = radii(curve, angle)
    square = r * r + r1 * r1
    top = r * r + 2.0 * r1 * r1 - r * r2
    kappa = top / square**1.5
    slope = (2.0 * r * r1 + 3.0 * r1 * r2 - r * r3) / square**1.5
    return kappa, slope - 3.0 * top * r1 * (r + r2) / square**2.5


def whole_curve(curve: NeutralCurve, arc: Any) -> tuple[Vector, Any]:
    """Return place [mm] and normal angle [rad] at phi [rad] anywhere round the curve (arrays).

    Of more than TABLE places polar angles are interpolated between as many: within 1e-9 rad.
    """
    turns = np.rint(np.asarray(arc) / math.pi) * math.pi
    rest = arc - turns
    angle = angle_of_arc(curve, rest) if np.size(rest) <= TABLE else _between(curve, rest)
    rho, slope, _, _ = radii(curve, angle)
    normal = angle - np.arctan2(slope, rho)
    return polar(rho, angle + turns), normal + turns


def _between(curve: NeutralCurve, arc: Any) -> Any:
    """Polar angles by Hermite's cubic through those of a table and their slopes."""
    from scipy.interpolate import CubicHermiteSpline  # for a page alone

    known = np.linspace(-0.5 * math.pi, 0.5 * math.pi, TABLE)
    angle = angle_of_arc(curve, known)
    rho, slope, _, _ = radii(curve, angle)
    return CubicHermiteSpline(known, angle, curve.radius / np.hypot(rho, slope))(arc)
