"""Rings as a cutter leaves them, and what a pinion of a ring cuts into, by brute force.

A tooth of the tool is turned through mesh in small steps with the gear; its outline is followed in
the gear's frame. Spur gears; lengths in modules where the module is 1. Nothing here is asked of
`geometry.cutter` or `geometry.internal`; outlines of pinions come from `fillet.profile`, which is
tested against a rolled rack of its own.
"""

import math
from dataclasses import dataclass

import numpy as np

from gearopt.physics.geometry.fillet import profile


def inv(angle):
    return np.tan(angle) - angle


def cutter_outline(ring, points):
    """Polar coordinates of one side of a tooth of the cutter, from the middle of its tip inwards.

    The centre of the round lies on the parallel curve of the involute, an involute of the same base
    circle that is turned by rho/r_b.
    """
    cutter, alpha, m = ring.cutter, ring.rack.pressure_angle, ring.normal_module
    reference = 0.5 * m * cutter.teeth
    base, tip = reference * math.cos(alpha), 0.5 * ring.cutter_tip_diameter
    rho = cutter.tip_radius * m
    thick = (0.5 * math.pi + 2.0 * cutter.profile_shift * math.tan(alpha)) / cutter.teeth
    at_base = thick + inv(alpha)
    centre = tip - rho
    middle = at_base - rho / base - inv(math.acos(base / centre))
    turn = np.linspace(0.0, math.asin(base / centre), points)  # from the tip circle to the flank
    x, y = rho * np.sin(turn), centre + rho * np.cos(turn)
    rolls = np.linspace(math.sqrt(x[-1] ** 2 + y[-1] ** 2 - base**2), 0.0, points)[1:]
    flank = np.hypot(base, rolls)  # by equal angles of rolling
    land = np.linspace(0.0, max(middle, 0.0), 5)[:-1]
    radius = np.r_[np.full(4, tip), np.hypot(x, y), flank]
    angle = np.r_[land, middle + np.arctan2(x, y), at_base - inv(np.arctan(rolls / base))]
    return radius, angle


@dataclass(frozen=True)
class Space:
    """A tooth space of a ring: radii, rising, and half its angle there."""

    teeth: int
    radius: np.ndarray
    half: np.ndarray


def rolled(radius, angle, teeth, ring_teeth, distance, reach, poses):
    """Polar coordinates in the frame of a ring of what turns through mesh, (poses, points).

    radius, angle: an outline about the axis of the tool, angles from the middle of its tooth; reach
    [rad]: of that middle from the line of centres.
    """
    turn = np.linspace(-reach, reach, poses)[:, None]
    x, y = radius * np.sin(turn + angle), distance + radius * np.cos(turn + angle)
    return np.hypot(x, y), np.arctan2(x, y) - turn * teeth / ring_teeth


def crossing(tip, ring_tip, distance):
    """Angle at the tool's axis of the point where the tip circles cross."""
    cosine = (ring_tip**2 - distance**2 - tip**2) / (2.0 * distance * tip)
    return math.acos(min(1.0, max(-1.0, cosine)))


def cut_space(ring, poses=400, points=40, rows=60):
    """Return the space that the cutter of a ring leaves, from the ring's tip circle on."""
    radius, angle = cutter_outline(ring, points)
    distance = -ring.cutting(ring.generating_shift)[1]
    teeth, count = ring.cutter.teeth, -ring.teeth
    tip = -0.5 * ring.tip_diameter
    reach = crossing(radius[0], tip, distance) + 2.0 * math.pi / teeth
    r, a = rolled(radius, angle, teeth, count, distance, min(reach, math.pi), poses)
    at = np.linspace(tip, distance + radius[0], rows)
    half = np.zeros(rows)
    for k, row in enumerate(at[:-1]):
        low, high = r[:, :-1] - row, r[:, 1:] - row
        p, q = np.nonzero(low * high <= 0.0)
        share = low[p, q] / np.where(low[p, q] == high[p, q], 1.0, low[p, q] - high[p, q])
        half[k] = np.max(a[p, q] + share * (a[p, q + 1] - a[p, q]))
    return Space(count, at, half)


def pinion_outline(gear, points):
    """Polar coordinates of a whole tooth of an external gear."""
    x, y = profile(gear, points, points)
    radius, angle = np.hypot(x, y), np.arctan2(x, y)
    land = np.linspace(-angle[-1], angle[-1], 7)[1:-1]
    top = np.full(len(land), radius[-1])
    return np.r_[radius, top, radius[::-1]], np.r_[-angle, land, angle[::-1]]


def overlap(space, r, a):
    """How deep points in the frame of a ring lie in its teeth, as arcs; 0: none does."""
    pitch = 2.0 * math.pi / space.teeth
    off = np.abs(a - pitch * np.round(a / pitch))
    deep = (off - np.interp(r, space.radius, space.half)) * r
    deep = np.where(r > space.radius[-1], np.maximum(deep, r - space.radius[-1]), deep)
    return max(0.0, float(np.max(np.where(r >= space.radius[0], deep, 0.0))))


def running_overlap(pair, space, poses=300, points=40):
    """How deep a pinion's teeth come into those of the ring while they turn, flanks in contact."""
    radius, angle = pinion_outline(pair.pinion, points)
    tip, distance = -0.5 * pair.wheel.tip_diameter, -pair.centre_distance
    reach = crossing(radius.max(), tip, distance) + 2.0 * math.pi / pair.pinion_teeth
    teeth = pair.pinion_teeth, -pair.wheel_teeth
    return overlap(space, *rolled(radius, angle, *teeth, distance, min(reach, math.pi), poses))


def entering_overlap(pair, space, poses=40, points=10):
    """How deep a pinion's teeth come into those of the ring as it is put in along the centres.

    Of all places of its teeth about the line of centres.
    """
    radius, angle = pinion_outline(pair.pinion, points)
    outer = radius > pair.pinion.base_diameter / 2
    radius, angle = radius[outer], angle[outer]
    final, tip = -pair.centre_distance, -0.5 * pair.wheel.tip_diameter
    deepest = 0.0
    for turn in np.linspace(0.0, 2.0 * math.pi / pair.pinion_teeth, poses, endpoint=False):
        teeth = turn + 2.0 * math.pi * np.arange(pair.pinion_teeth) / pair.pinion_teeth
        at = (teeth[:, None] + angle).ravel()
        x, y = (np.tile(radius, len(teeth)) * f(at) for f in (np.sin, np.cos))
        for distance in np.linspace(final - 3.0 * pair.normal_module, final, 30):
            r = np.hypot(x, y + distance)
            a = np.arctan2(x, y + distance) - turn * pair.pinion_teeth / -pair.wheel_teeth
            near = r >= tip
            deepest = max(deepest, overlap(space, r[near], a[near])) if near.any() else deepest
    return deepest
