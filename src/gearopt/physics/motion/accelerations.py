"""Equations of motion of a pair at several levels, in coordinates that keep their digits.

| level | coordinates |
|---|---|
| `fixed` | delta: axes that do not move |
| `line` | r_1, delta, r_2: axes that move along the line of action at rest |
| `plane` | x_1, y_1, delta, x_2, y_2 |
| `way` | x_1, y_1, s, x_2, y_2, s = r_b1 theta_1 + r_b2 theta_2: forces of positions alone |
| `angles` | x_1, y_1, theta_1, x_2, y_2, theta_2: the paper's; delta is a small difference |

Lengths in mm, angles in rad, times in s.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from gearopt.physics.motion.kinematics import growth
from gearopt.physics.motion.moving_pair import MovingPair, Rotor, mesh_force

Vector = Any


def of_fixed_axes(pair: MovingPair, k: float, position: Vector, velocity: Vector) -> list[Any]:
    """Return [delta''] = [-(F + N)/m_e] [mm/s2]; the coast flank's force counts against N."""
    (delta,), (rate,) = position, velocity
    return [-_closing(pair, _force_at_constant_backlash(pair, k, delta, rate))]


def along_line(pair: MovingPair, k: float, position: Vector, velocity: Vector) -> list[Any]:
    """Return second derivatives of r_1, delta, r_2 [mm/s2], r_i along the line of action at rest.

    delta'' = r_2'' - r_1'' - (F + N)/m_e. Equal to `exact` in the plane on isotropic bearings from
    rest. Bearings: k_x sin2(alpha) + k_y cos2(alpha). Both flanks press along one line.
    """
    (r1, delta, r2), (v1, rate, v2) = position, velocity
    force = _force_at_constant_backlash(pair, k, delta, rate)
    a1 = (force - _held(pair, pair.pinion, r1, v1)) / pair.pinion.mass
    a2 = (-force - _held(pair, pair.wheel, r2, v2)) / pair.wheel.mass
    return [a1, a2 - a1 - _closing(pair, force), a2]


def in_plane(pair: MovingPair, k: float, position: Vector, velocity: Vector) -> list[Any]:
    """Return second derivatives of x_1, y_1, delta, x_2, y_2 [mm/s2].

    delta'' = grad g . (a_2 - a_1) + w' S w - (F + N)/m_e, S the second derivatives of g, w the
    velocity of axis 2 against axis 1. Source: Yoon, Kim and Chung, eqs. (1) to (6), corrected:
    signs written out; theta_1 and theta_2 replaced by delta and `turns`.
    """
    x1, y1, delta, x2, y2 = position
    vx1, vy1, rate, vx2, vy2 = velocity
    u, v, wu, wv = x2 - x1, y2 - y1, vx2 - vx1, vy2 - vy1
    contact = pair.contact(u, v)
    (gu, gv), (suu, suv, svv) = contact.gradient, contact.curvature
    pushed, along = _pushed(pair, k, (u, v, wu, wv), delta, rate)
    a1 = _axis(pair.pinion, pushed, (x1, y1), (vx1, vy1))
    a2 = _axis(pair.wheel, (-pushed[0], -pushed[1]), (x2, y2), (vx2, vy2))
    turned = gu * (a2[0] - a1[0]) + gv * (a2[1] - a1[1])
    curved = suu * wu * wu + 2.0 * suv * wu * wv + svv * wv * wv
    return [*a1, turned + curved - _closing(pair, along), *a2]


def with_way(pair: MovingPair, k: float, position: Vector, velocity: Vector) -> list[Any]:
    """Return second derivatives of x_1, y_1, s, x_2, y_2 [mm/s2]: s'' = (F + N)/m_e.

    delta = g - s loses some three digits; the forces depend on positions alone where nothing damps,
    as symplectic methods ask.
    """
    x1, y1, way, x2, y2 = position
    vx1, vy1, speed, vx2, vy2 = velocity
    u, v, wu, wv = x2 - x1, y2 - y1, vx2 - vx1, vy2 - vy1
    contact = pair.contact(u, v)
    (gu, gv), delta = contact.gradient, contact.approach - way
    rate = gu * wu + gv * wv - speed
    pushed, along = _pushed(pair, k, (u, v, wu, wv), delta, rate)
    a1 = _axis(pair.pinion, pushed, (x1, y1), (vx1, vy1))
    a2 = _axis(pair.wheel, (-pushed[0], -pushed[1]), (x2, y2), (vx2, vy2))
    return [*a1, _closing(pair, along), *a2]


def with_angles(pair: MovingPair, k: float, position: Vector, velocity: Vector) -> list[Any]:
    """Return second derivatives of x_1, y_1, theta_1, x_2, y_2, theta_2 [mm/s2, rad/s2].

    The paper's coordinates: delta = g - r_b1 theta_1 - r_b2 theta_2 loses a digit for every factor
    of 10 by which the gears turn further than they deform. To compare with.
    """
    x1, y1, t1, x2, y2, t2 = position
    vx1, vy1, w1, vx2, vy2, w2 = velocity
    u, v, wu, wv = x2 - x1, y2 - y1, vx2 - vx1, vy2 - vy1
    contact, (p, w) = pair.contact(u, v), pair.rotors
    delta = contact.approach - p.base_radius * t1 - w.base_radius * t2
    gu, gv = contact.gradient
    rate = gu * wu + gv * wv - p.base_radius * w1 - w.base_radius * w2
    pushed, along = _pushed(pair, k, (u, v, wu, wv), delta, rate)
    a1 = _axis(p, pushed, (x1, y1), (vx1, vy1))
    a2 = _axis(w, (-pushed[0], -pushed[1]), (x2, y2), (vx2, vy2))
    spins = [(r.torque + r.base_radius * along) / r.inertia for r in pair.rotors]
    return [*a1, spins[0], *a2, spins[1]]


Law = Callable[[MovingPair, float, Vector, Vector], list[Any]]
LEVELS: Mapping[str, tuple[int, Law]] = MappingProxyType(
    {
        "fixed": (1, of_fixed_axes),
        "line": (3, along_line),
        "plane": (5, in_plane),
        "way": (5, with_way),
        "angles": (6, with_angles),
    }
)


def stiffness_along(pair: MovingPair, rotor: Rotor) -> tuple[float, float]:
    """Return stiffness [N/mm] and damping [N s/mm] of bearings along the line of action at rest."""
    s, c = math.sin(pair.pressure_angle) ** 2, math.cos(pair.pressure_angle) ** 2
    (kx, ky), (cx, cy) = rotor.stiffness, rotor.damping
    return s * kx + c * ky, s * cx + c * cy


def _force_at_constant_backlash(pair: MovingPair, k: Any, delta: Any, rate: Any) -> Any:
    """Return the mesh force along the line of action, drive less coast flank [N].

    Of axes that leave that line nowhere, so that the backlash is constant.
    """
    room = math.inf if pair.backlash is None else pair.backlash
    force = mesh_force(pair, k, delta, rate, room)
    return force.drive - force.coast


def _closing(pair: MovingPair, along: Any) -> Any:
    return (pair.load + along) / pair.mesh_mass


def _held(pair: MovingPair, rotor: Rotor, place: Any, speed: Any) -> Any:
    stiffness, damping = stiffness_along(pair, rotor)
    return stiffness * place + damping * speed


def _axis(rotor: Rotor, push: tuple[Any, Any], place: Any, speed: Any) -> list[Any]:
    """Return the acceleration of an axis under a push and its bearings [mm/s2]."""
    return [
        (push[i] - rotor.stiffness[i] * place[i] - rotor.damping[i] * speed[i]) / rotor.mass
        for i in range(2)
    ]


def _pushed(
    pair: MovingPair, k: Any, moved: tuple[Any, Any, Any, Any], delta: Any, rate: Any
) -> tuple[tuple[Any, Any], Any]:
    """Return the force on axis 1 (x, y) and that against the turning of both gears [N]."""
    u, v, wu, wv = moved
    gu, gv = pair.contact(u, v).gradient
    if pair.backlash is None:
        drive = mesh_force(pair, k, delta, rate, math.inf).drive
        return (drive * gu, drive * gv), drive
    grown = growth(pair.kinematics, pair.rest, u, v)
    (ru, rv), room = grown.gradient, pair.backlash + grown.length
    faster = rate - (ru * wu + rv * wv)  # of delta against the coast flank
    force = mesh_force(pair, k, delta, rate, room, faster)
    push = tuple(
        force.drive * g + force.coast * (r - g) for g, r in zip((gu, gv), (ru, rv), strict=True)
    )
    return (push[0], push[1]), force.drive - force.coast
