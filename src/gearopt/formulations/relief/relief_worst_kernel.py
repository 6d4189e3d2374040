"""Kernel of the worst case of a relief over its tolerances: bounds of boxes from above."""

import math

import numpy as np

from gearopt.formulations.relief.relief_box_kernel import (
    CORNERS,
    below,
    corners,
    depth,
    mixed,
    peaks,
    power,
    raised,
    ranges,
    slope,
)
from gearopt.optimise.jit_kernel import entry, inner


@entry
def ceiling(stiffness, tips, exponents, loads, low, high, point):
    """Bound the largest peak-to-peak of all reliefs in a box from above; return it and a value.

    Arguments as of `relief_box_kernel.bound`. At every position planes above and below the approach
    are taken, which touch them about the middle of the box; the largest difference of any two is at
    a corner. point (4,) becomes the corner with the largest exact value, which is returned.
    """
    positions, pairs = stiffness.shape
    places, ends = np.empty((2, 4, 2)), np.empty((2, positions, pairs))
    secants, room = np.empty((2, positions, pairs, 2)), np.empty((2, pairs))
    slopes, upper, lower = np.empty(pairs), np.empty((positions, 5)), np.empty((positions, 5))
    mixture, v, found = np.empty(CORNERS), np.empty(4), np.empty(loads.size)
    corners(low, high, places)
    ranges(tips, exponents, places, secants, ends)
    bound, value = 0.0, -math.inf
    for q in range(loads.size):
        for r in range(CORNERS):
            mixture[r] = 1.0 / CORNERS
        mixed(places, mixture, v)
        for k in range(positions):
            offset = below(stiffness[k], loads[q], ends[:, k], slopes, room[0], room[1])
            under(tips, exponents, v, k, offset, slopes, lower[k])
            over_plane(stiffness[k], tips, loads[q], v, k, secants, room, upper[k])
        for r in range(CORNERS):
            for j in range(CORNERS):
                mixture[j] = 1.0 if j == r else 0.0
            mixed(places, mixture, v)
            most, least = -math.inf, math.inf
            for k in range(positions):
                most, least = max(most, at(upper[k], v)), min(least, at(lower[k], v))
            bound = max(bound, most - least)
            if q == 0:
                peaks(stiffness, tips, exponents, loads, v, found, room[0], room[1])
                here = 0.0
                for s in range(loads.size):
                    here = max(here, found[s])
                if here > value:
                    value = here
                    for j in range(4):
                        point[j] = v[j]
    return bound, value


@inner
def at(plane, v):
    """Value of a plane, constant and gradient (5,), at v."""
    return plane[0] + plane[1] * v[0] + plane[2] * v[1] + plane[3] * v[2] + plane[4] * v[3]


@inner
def under(tips, exponents, v, k, offset, slopes, plane):
    """Set the plane below the approach at position k that touches the convex power at v."""
    plane[0] = offset
    for j in range(1, 5):
        plane[j] = 0.0
    for i in range(slopes.size):
        for gear in range(2):
            x = tips[gear, k, i]
            u = v[2 * gear] - v[2 * gear + 1] * x
            rise = slope(u, exponents[gear])
            plane[0] += slopes[i] * (power(u, exponents[gear]) - rise * u)
            plane[1 + 2 * gear] += slopes[i] * rise
            plane[2 + 2 * gear] -= slopes[i] * rise * x


@inner
def over_plane(stiffness, tips, load, v, k, secants, room, plane):
    """Set the plane above the approach at position k of the pairs that act at v."""
    total, moved = 0.0, load
    raised(tips, secants, v, k, room[0])
    depth(stiffness, room[0], load, room[1])
    for i in range(stiffness.size):
        total += room[1, i]
    for j in range(1, 5):
        plane[j] = 0.0
    for i in range(stiffness.size):
        for gear in range(2):
            part = room[1, i] * secants[gear, k, i, 1]
            moved += room[1, i] * secants[gear, k, i, 0]
            plane[1 + 2 * gear] += part / total
            plane[2 + 2 * gear] -= part / total * tips[gear, k, i]
    plane[0] = moved / total
