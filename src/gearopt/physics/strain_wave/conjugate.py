"""The flank of the flexspline that is conjugate to the circular spline's involute, in closed form.

No equation is solved for a point of the flank: at every pose of the tooth the normal of the
involute through the instant centre is known.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import NeutralCurve, neutral_curve
from gearopt.physics.strain_wave.tooth_motion import Motion, motion
from gearopt.physics.strain_wave.vectors import Vector, polar

SEARCH = np.radians(np.linspace(-12.0, 25.0, 112))  # polar angles at which arcs of contact lie
NEWTON = 7  # steps from the nearest of them to a radius


@dataclass(frozen=True)
class Contact:
    """Contact of tooth and involute at a pose; NaN where no normal passes the instant centre.

    tangent t = tan(pressure angle at the point); place [mm] in the space, point [mm] and direction
    (unit tangent) in the tooth's frame. speeds v_c, v_f [mm/rad] of the point of contact along both
    flanks. Curvatures [1/mm] are along the direction, negative where centres lie on the side of
    the space's axis; gap_curvature kappa_c - kappa_f is 1/R of Hertz's contact, admissible above 0.
    """

    motion: Motion
    tangent: Any
    tangent_rate: Any
    place: Vector
    point: Vector
    direction: Vector
    speeds: tuple[Any, Any]
    curvatures: tuple[Any, Any]
    gap_curvature: Any

    @property
    def radius(self) -> Any:
        """Radius [mm] of the point of contact on the circular spline."""
        return self.place.length


@np.errstate(invalid="ignore", divide="ignore")
def contact(gearing: StrainWave, at: Motion) -> Contact:
    """Return where a tooth touches the involute of its space at a pose, in closed form.

    Involute z_c = r_b e^(i(eta - t)) (1 + i t) with the unit tangent e^(i(eta - t)); its normal
    passes the instant centre C where t = eta - arg C + arccos(r_b/|C|). With V the velocity of the
    tooth at the point, v_c = r_b t t', v_f = v_c - V.T; kappa_c = -1/(r_b t),
    kappa_f = -(t' + Phi')/v_f and kappa_c - kappa_f = (Phi' - kappa_c V.T)/v_f, without a
    difference of nearly equal curvatures. Derivatives t', Phi' by the polar angle.
    """
    base, centre, rate = gearing.base_radius, at.centre, at.centre_rate
    far = centre.length
    cosine = base / far
    tangent = gearing.half_angle - centre.angle + np.arccos(cosine)
    turned, grown = centre.cross(rate) / far**2, centre.dot(rate) / far**2
    tangent_rate = cosine * grown / np.sqrt(1.0 - cosine * cosine) - turned
    along = polar(1.0, gearing.half_angle - tangent)
    place = along * base + along.left * (base * tangent)
    slide = along.dot((place - centre).left) * at.turn_rate
    fast = base * tangent * tangent_rate
    slow = fast - slide
    spline = -1.0 / (base * tangent)
    return Contact(
        at,
        tangent,
        tangent_rate,
        place,
        at.of_tooth(place),
        along.turned(-at.turn),
        (fast, slow),
        (spline, -(tangent_rate + at.turn_rate) / slow),
        (at.turn_rate - spline * slide) / slow,
    )


@dataclass(frozen=True, eq=False)  # a flank is itself alone, and a key of caches
class Flank:
    """The conjugate flank from root to tip: gearing, neutral curve, contacts (..., n).

    complete: whether every radius between r_a and r_w has a contact with t > 0.
    """

    gearing: StrainWave
    curve: NeutralCurve
    contacts: Contact
    complete: Any

    @property
    def pairs_in_contact(self) -> Any:
        """Mean pairs of conjugate teeth in contact per lobe and flank, (phi_w - phi_a) z_f/2 pi."""
        arc = self.contacts.motion.arc
        return (arc[..., -1] - arc[..., 0]) * np.squeeze(self.gearing.teeth) / (2.0 * math.pi)


@np.errstate(invalid="ignore")
def tangents(gearing: StrainWave) -> tuple[Any, Any]:
    """Return t = sqrt((r/r_b)^2 - 1) at the circular spline's tip and at its last active radius."""
    base = gearing.base_radius
    ends = gearing.tip_radius, gearing.active_radius
    first, last = (np.sqrt((r / base) ** 2 - 1.0) for r in ends)
    return first, last


@np.errstate(invalid="ignore")
def angle_at(gearing: StrainWave, curve: NeutralCurve, tangent: Any) -> Any:
    """Return polar angles p [rad] (..., n) at which the contact has these t, on the main branch.

    The main branch is where t rises with p, beyond its minimum in SEARCH. tangent (..., n); numbers
    of the gearing are floats or arrays (..., 1). NaN where there is none.
    """
    tangents = contact(gearing, motion(gearing, curve, SEARCH)).tangent
    known = np.where(np.isfinite(tangents), tangents, np.inf)
    lowest = known.argmin(axis=-1)[..., None]
    rising = np.arange(len(SEARCH)) >= lowest
    off = np.abs(
        np.where(rising & np.isfinite(tangents), tangents, np.inf)[..., None, :]
        - np.asarray(tangent)[..., :, None]
    )
    angle = SEARCH[off.argmin(axis=-1)]
    for _ in range(NEWTON):
        at = contact(gearing, motion(gearing, curve, angle))
        step = (at.tangent - tangent) / at.tangent_rate
        angle = angle - np.clip(step, -0.02, 0.02)
    slope_error = contact(gearing, motion(gearing, curve, angle)).tangent - tangent
    return np.where(np.abs(slope_error) < 1e-9, angle, np.nan)


def flank(gearing: StrainWave, count: int = 201) -> Flank:
    """Return the conjugate flank by contacts at polar angles evenly between its two ends.

    Numbers of the gearing are floats, or arrays (N, 1) for N gearings at once.
    """
    curve = neutral_curve(gearing)
    first, last = tangents(gearing)
    ends = np.concatenate(np.broadcast_arrays(np.atleast_1d(first), np.atleast_1d(last)), axis=-1)
    arc = angle_at(gearing, curve, ends)
    share = np.linspace(0.0, 1.0, count)
    angle = arc[..., :1] + (arc[..., 1:] - arc[..., :1]) * share
    touching = contact(gearing, motion(gearing, curve, angle))
    complete = (np.isfinite(touching.gap_curvature) & (touching.tangent > 0.0)).all(axis=-1)
    return Flank(gearing, curve, touching, complete)


def existence(gearing: StrainWave, count: int = 7201) -> list[tuple[float, float]]:
    """Return the intervals of phi [rad] from -pi/2 to pi/2 in which |C| >= r_b: contact exists.

    Their ends are found between `count` poses by bisection to 1e-12 rad of the polar angle.
    """
    curve = neutral_curve(gearing)
    grid = np.linspace(-0.5 * math.pi, 0.5 * math.pi, count)

    def inside(angle: Any) -> Any:
        return motion(gearing, curve, angle).centre.length >= gearing.base_radius

    known = inside(grid)
    edges = np.flatnonzero(known[1:] != known[:-1])
    low, high = grid[edges], grid[edges + 1]
    for _ in range(40):
        middle = 0.5 * (low + high)
        after = inside(middle) == known[edges + 1]
        low, high = np.where(after, low, middle), np.where(after, middle, high)
    ends = np.concatenate((grid[:1][known[:1]], high, grid[-1:][known[-1:]]))
    arcs = motion(gearing, curve, ends).arc.tolist()
    return list(zip(arcs[::2], arcs[1::2], strict=True))


def least_deflection(gearing: StrainWave) -> float:
    """Return the deflection w below which no contact exists at the major axis: |C_0| = r_b.

    The neutral radius follows w as the gearing says. By bisection between 0.2 and 2 modules;
    infinite where 2 is not enough.
    """

    def reaches(deflection: float) -> bool:
        deflected = replace(gearing, deflection=deflection)
        centre = motion(deflected, neutral_curve(deflected), 0.0).centre
        return bool(centre.length >= deflected.base_radius)

    low, high = 0.2, 2.0
    if not reaches(high):
        return math.inf
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reaches(middle) else (middle, high)
    return high
