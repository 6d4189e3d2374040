"""Kernels that look at every choice of teeth and modules of a two-stage servo train.

Ratios, tip diameters, the bore and what gears keep clear of are decided in whole numbers
(`numbers`); error and stress, which no tie can meet as they hold irrational numbers, in double with
ALLOWANCE. In goal: 0 inertia, 1 mass, 2 error, above that what a duty makes least.
"""

import math

import numpy as np
from numba import njit

ALLOWANCE = 1.0 + 1e-12  # of error and stress: many times their rounding


@njit(cache=True)
def worth(s, goal, m1, z1, z2, m2, z3, z4):
    """The objective of one train."""
    d1, d2, d3, d4 = m1 * z1, m1 * z2, m2 * z3, m2 * z4
    if goal == 2:
        return s.lost[0] * z3 / (d2 * z4) + s.lost[1] / d4
    if goal == 1:
        return s.disc_mass * (d1**2 + d2**2 + d3**2 + s.sector * d4**2)
    middle = s.disc_inertia * (d2**4 + d3**4) + s.shaft_inertia
    n1 = z2 / z1
    n = n1 * z4 / z3
    gears = s.disc_inertia * d1**4 + middle / n1**2 + s.sector * s.disc_inertia * d4**4 / n**2
    return moved(s.duty, n, gears) if goal > 2 else gears


@njit(cache=True)
def moved(duty, ratio, gears):
    """What a duty (`duty_numbers`) makes least, with gears [t mm2]; inf where nothing moves."""
    load, motor, torque, friction, efficiency, slope = duty[1:7]
    angle, limit, own, peak, _ = duty[7:12]
    inertia = motor + gears
    if duty[0] == 2:
        swung = peak * (load / ratio + ratio * inertia)
        return math.sqrt(0.5 * swung**2 + (friction / ratio + own) ** 2)
    left = efficiency * ratio * (torque - slope * ratio) - friction
    if left <= 0.0:
        return math.inf
    inverse = (load + efficiency * ratio**2 * inertia) / left
    if duty[0] == 0:
        return inverse
    top = min(math.sqrt(angle / inverse), limit / ratio)
    return angle / top + top * inverse


@njit(cache=True)
def possible(duty, value):
    """Whether the load moves at all, and within the rms torque of the motor."""
    return math.isfinite(value) and value <= duty[11] * ALLOWANCE


@njit(cache=True)
def sound(s, m1, z1, z2, m2, z3, z4):
    """Whether a train keeps the limits of error and of both pinions' stress."""
    d2, d4 = m1 * z2, m2 * z4
    if s.lost[0] * z3 / (d2 * z4) + s.lost[1] / d4 > s.error * ALLOWANCE:
        return False
    if s.load > d4 * m2 * s.lewis[z3] * ALLOWANCE:
        return False
    return s.load * z3 <= z4 * d2 * m1 * s.lewis[z1] * ALLOWANCE


@njit(cache=True)
def first_wheel(s, i, z1):
    """Least teeth of gear 2 behind a pinion: around its shaft, and with the motor beside it."""
    return max(z1, s.clear_1[i], s.stage_1[i] - z1)


@njit(cache=True)
def last_wheel(s, i, z2, j, z3):
    """Least teeth of gear 4: around its hub, and gear 2 clear of the output shaft."""
    if s.unit[j] == 0:
        return z3
    beside = -(-(s.unit[i] * (z2 + 2) + s.output) // s.unit[j])
    return max(z3, s.clear_2[j], beside - z3)


@njit(cache=True)
def every(s, goal, first, last, best, found):
    """Look at all trains of the first stages `first` to `last`, counted over modules and teeth.

    best: the least objective so far; found (6,): its z1, z2, z3, z4 and module indices. Of equal
    trains the first one counts. Returns best, the trains of a right ratio, and the feasible ones.
    """
    pinions = s.pinion[1] - s.pinion[0] + 1
    looked = feasible = 0
    for k in range(first, last):
        i, z1 = k // pinions, s.pinion[0] + k % pinions
        clear = first_wheel(s, i, z1)
        for z2 in range(z1, s.wheel_1[i] + 1):
            for j in range(s.module.size):
                for z3 in range(s.pinion[0], s.pinion[1] + 1):
                    low = -(-s.least[z1 * z3] // z2)
                    high = min(s.most[z1 * z3] // z2, s.wheel)
                    for z4 in range(max(low, z3), high + 1):
                        looked += 1
                        if z4 > s.wheel_2[j] or z3 < s.bored[j] or z2 < clear:
                            continue
                        if z4 < last_wheel(s, i, z2, j, z3):
                            continue
                        if not sound(s, s.module[i], z1, z2, s.module[j], z3, z4):
                            continue
                        value = worth(s, goal, s.module[i], z1, z2, s.module[j], z3, z4)
                        if goal > 2 and not possible(s.duty, value):
                            continue
                        feasible += 1
                        if value < best:
                            best = value
                            found[0], found[1], found[2], found[3] = z1, z2, z3, z4
                            found[4], found[5] = i, j
    return best, looked, feasible


@njit(cache=True)
def promise(s, goal, m1, z1, z2):
    """A lower bound on the objective of all trains with this first stage; inf where none is.

    d4 is at least what error and ratio ask for, d3 at least the bore.
    """
    d1, d2 = m1 * z1, m1 * z2
    most = s.high
    left = s.error * ALLOWANCE - s.lost[0] / (d1 * most)
    if left <= 0.0:
        return math.inf
    d3 = s.bore
    d4 = max(s.lost[1] / left, d3 * s.low * z1 / z2, d3)
    if goal == 2:
        return s.lost[0] / (d1 * most) + s.lost[1] / s.tip
    if goal == 1:
        return s.disc_mass * (d1**2 + d2**2 + d3**2 + s.sector * d4**2)
    middle = s.disc_inertia * (d2**4 + d3**4) + s.shaft_inertia
    n1 = z2 / z1
    return s.disc_inertia * d1**4 + middle / n1**2 + s.sector * s.disc_inertia * d4**4 / most**2


@njit(cache=True)
def useful(s, goal, first, last, best, found):
    """Like `every`, for the best train alone: what cannot be better is not looked at.

    First stages whose promise is no better are dropped. With the other numbers fixed, inertia and
    mass grow with z4, error and stress fall with it: of every row of z4 only one end can be best.
    Returns best, first stages and trains looked at.
    """
    pinions = s.pinion[1] - s.pinion[0] + 1
    looked = 0
    for k in range(first, last):
        i, z1 = k // pinions, s.pinion[0] + k % pinions
        m1 = s.module[i]
        for z2 in range(first_wheel(s, i, z1), s.wheel_1[i] + 1):
            looked += 1
            if promise(s, goal, m1, z1, z2) >= best * ALLOWANCE:
                continue
            for j in range(s.module.size):
                m2 = s.module[j]
                for z3 in range(s.bored[j], s.pinion[1] + 1):
                    low = max(-(-s.least[z1 * z3] // z2), last_wheel(s, i, z2, j, z3))
                    high = min(s.most[z1 * z3] // z2, s.wheel_2[j])
                    if low > high:
                        continue
                    if goal != 2:
                        least = max(
                            (s.lost[0] * z3 / (m1 * z2) + s.lost[1] / m2) / s.error,
                            s.load / (m2 * m2 * s.lewis[z3]),
                            s.load * z3 / (m1 * m1 * z2 * s.lewis[z1]),
                        )
                        if least > high + 1:
                            continue
                        low = max(low, int(least * (1.0 - 1e-9)))
                    while low <= high:
                        looked += 1
                        z4 = high if goal == 2 else low
                        if sound(s, m1, z1, z2, m2, z3, z4):
                            value = worth(s, goal, m1, z1, z2, m2, z3, z4)
                            if value < best:
                                best = value
                                found[0], found[1], found[2], found[3] = z1, z2, z3, z4
                                found[4], found[5] = i, j
                            break
                        if goal == 2:
                            break
                        low += 1
    return best, looked, 0


@njit(cache=True)
def listed(s, best, most):
    """All feasible trains with an error of at most `best` [rad]: rows z1, z2, z3, z4, i, j."""
    rows = np.empty((most, 6), np.int64)
    count = 0
    for i in range(s.module.size):
        for z1 in range(s.pinion[0], s.pinion[1] + 1):
            for z2 in range(first_wheel(s, i, z1), s.wheel_1[i] + 1):
                for j in range(s.module.size):
                    for z3 in range(s.bored[j], s.pinion[1] + 1):
                        low = max(-(-s.least[z1 * z3] // z2), last_wheel(s, i, z2, j, z3))
                        high = min(s.most[z1 * z3] // z2, s.wheel_2[j])
                        for z4 in range(low, high + 1):
                            m1, m2 = s.module[i], s.module[j]
                            if not sound(s, m1, z1, z2, m2, z3, z4):
                                continue
                            if worth(s, 2, m1, z1, z2, m2, z3, z4) > best:
                                continue
                            if count < most:
                                rows[count, 0], rows[count, 1] = z1, z2
                                rows[count, 2], rows[count, 3] = z3, z4
                                rows[count, 4], rows[count, 5] = i, j
                            count += 1
    return count, rows
