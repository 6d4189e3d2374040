"""Kernel of the worst case of a relief over its tolerances: bounds of boxes from above."""

import math

import numpy as np

from gearopt.formulations.pair.relief.relief_box_kernel import CORNERS, mixed, peaks
from gearopt.formulations.pair.relief.relief_planes_kernel import (
    above,
    at,
    below,
    corners,
    ranges,
    under,
)
from gearopt.optimise.jit_kernel import entry


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
    delta = np.empty((loads.size, positions))
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
            above(stiffness[k], tips, loads[q], v, k, secants, room, upper[k])
        for r in range(CORNERS):
            for j in range(CORNERS):
                mixture[j] = 1.0 if j == r else 0.0
            mixed(places, mixture, v)
            most, least = -math.inf, math.inf
            for k in range(positions):
                most, least = max(most, at(upper[k], v)), min(least, at(lower[k], v))
            bound = max(bound, most - least)
            if q == 0:
                peaks(stiffness, tips, exponents, loads, v, found, delta, room[0], room[1])
                here = 0.0
                for s in range(loads.size):
                    here = max(here, found[s])
                if here > value:
                    value = here
                    for j in range(4):
                        point[j] = v[j]
    return bound, value
