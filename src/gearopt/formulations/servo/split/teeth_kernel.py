"""Kernels that look at every choice of teeth and modules of a two-stage servo train.

Ratios, tip diameters, the bore and what gears keep clear of are decided in whole numbers
(`numbers`); error and stress, which no tie can meet as they hold irrational numbers, in double with
ALLOWANCE. In goal: 0 inertia, 1 mass, 2 error, above that what a duty makes least.

First stages are numbered, so that a search may pause at any of them: it goes on from number `first`
until it has taken `most` steps (a row or a choice of teeth is one) and returns the number to go on
from.
"""

import math

from gearopt.optimise.jit_kernel import entry, inlined, inner

ALLOWANCE = 1.0 + 1e-12  # of error and stress: many times their rounding
CARRIED = 1.0 + 1e-11  # of the stress by a motion: what rounding hides along a row, too


@inlined
def off(s, d2, z1, z2, z3, d4, z4):
    """Error of a train [rad]: lost motion, and meshes whose stiffness varies; it falls with z4."""
    first, last = z3 / (d2 * z4), 1.0 / d4
    loaded = (s.swing[z1] + s.swing[z2]) * first**2 + (s.swing[z3] + s.swing[z4]) * last**2
    return s.lost[0] * first + s.lost[1] * last + loaded


@inlined
def worth(s, goal, m1, z1, z2, m2, z3, z4):
    """Objective of one train by `goal`: 1 mass of gears [kg], 2 error [rad], else at the motor.

    Else: 0 inertia of gears [t mm2], above 2 what a motion makes least with it (`moved`). Modules m
    [mm]; s: `Numbers`.
    """
    d1, d2, d3, d4 = m1 * z1, m1 * z2, m2 * z3, m2 * z4
    if goal == 2:
        return off(s, d2, z1, z2, z3, d4, z4)
    if goal == 1:
        return s.disc_mass * (d1**2 + d2**2 + d3**2 + s.sector * d4**2)
    middle = s.disc_inertia * (d2**4 + d3**4) + s.shaft_inertia
    n1 = z2 / z1
    n = n1 * z4 / z3
    gears = s.disc_inertia * d1**4 + middle / n1**2 + s.sector * s.disc_inertia * d4**4 / n**2
    return moved(s.duty, n, gears) if goal > 2 else gears


@inner
def moved(duty, ratio, gears):
    """What a duty (`duty_numbers`) makes least, with gears [t mm2]; inf where nothing moves.

    Inverse acceleration [s2/rad], time of a move [s] or rms torque of a swing [N mm].
    """
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
    braking = ratio * (torque + 2.0 * own) + friction
    inverse = 0.5 * (inverse + (load + ratio**2 * inertia) / braking)
    top = min(math.sqrt(angle / inverse), limit / ratio)
    return angle / top + top * inverse


@inner
def carried_torque(duty, ratio, gears, beyond):
    """Peak torque through a mesh in a motion, seen at the motor; beyond: inertia after the mesh."""
    load, motor, torque, friction, efficiency = duty[1:6]
    if duty[0] == 2:
        return (load * duty[10] + friction) / ratio + beyond * ratio * duty[10]
    inertia = motor + gears
    left = efficiency * ratio * torque - friction
    starting = torque
    if left > 0.0:
        ramp = left / (load + efficiency * ratio**2 * inertia)
        starting = (load * ramp + friction) / (efficiency * ratio) + beyond * ratio * ramp
    if duty[0] != 1:
        return starting
    ramp = (ratio * (torque + 2.0 * duty[9]) + friction) / (load + ratio**2 * inertia)
    return max(starting, (load * ramp - friction) / ratio + beyond * ratio * ramp)


@inner
def used(s, m1, z1, z2, m2, z3, z4):
    """The larger part of its allowed stress that either pinion has in the motion; 0 without one."""
    if s.duty[0] < 0:
        return 0.0
    n1, n = z2 / z1, z2 * z4 / (z1 * z3)
    middle = (s.disc_inertia * ((m1 * z2) ** 4 + (m2 * z3) ** 4) + s.shaft_inertia) / n1**2
    last = s.sector * s.disc_inertia * (m2 * z4) ** 4 / n**2
    gears = s.disc_inertia * (m1 * z1) ** 4 + middle + last
    first = carried_torque(s.duty, n, gears, middle + last) * s.tooth[z1] / (z1 * m1**2)
    second = carried_torque(s.duty, n, gears, last) * n1 * s.tooth[z3] / (z3 * m2**2)
    return max(first, second)


@inner
def carried(s, m1, z1, z2, m2, z3, low, high):
    """The teeth of wheel 4 from low to high with which both pinions carry the motion: an interval.

    The stress falls and then rises with the total ratio; it is level where nothing moves. Least and
    most, the least one larger where there are none.
    """
    if s.duty[0] < 0 or low > high:
        return low, high
    if max(used(s, m1, z1, z2, m2, z3, low), used(s, m1, z1, z2, m2, z3, high)) <= CARRIED:
        return low, high
    start, end = low, high
    while start < end:
        z4 = (start + end) // 2
        here = used(s, m1, z1, z2, m2, z3, z4)
        beyond = used(s, m1, z1, z2, m2, z3, z4 + 1)
        rests = s.duty[5] * z2 * z4 / (z1 * z3) * s.duty[3] <= s.duty[4]
        if beyond < here or (beyond == here and rests):
            start = z4 + 1
        else:
            end = z4
    if used(s, m1, z1, z2, m2, z3, start) > CARRIED:
        return start + 1, start
    bottom = start
    while low < bottom:
        z4 = (low + bottom) // 2
        if used(s, m1, z1, z2, m2, z3, z4) <= CARRIED:
            bottom = z4
        else:
            low = z4 + 1
    while start < high:
        z4 = (start + high + 1) // 2
        if used(s, m1, z1, z2, m2, z3, z4) <= CARRIED:
            start = z4
        else:
            high = z4 - 1
    return low, high


@inner
def possible(duty, value):
    """Whether the load moves at all, and within the rms torque of the motor."""
    return math.isfinite(value) and value <= duty[11] * ALLOWANCE


@inner
def sound(s, m1, z1, z2, m2, z3, z4):
    """Whether a train keeps the limits of error and of both pinions' stress."""
    if used(s, m1, z1, z2, m2, z3, z4) > CARRIED:
        return False
    return holds(s, m1, z1, z2, m2, z3, z4)


@inlined
def holds(s, m1, z1, z2, m2, z3, z4):
    """Whether a train keeps what falls with z4: error, and stress under the output torque."""
    d2, d4 = m1 * z2, m2 * z4
    if off(s, d2, z1, z2, z3, d4, z4) > s.error * ALLOWANCE:
        return False
    if s.load[z3] > d4 * m2 * ALLOWANCE:
        return False
    return s.load[z1] * z3 <= z4 * d2 * m1 * ALLOWANCE


@inner
def first_wheel(s, i, z1):
    """Least teeth of gear 2 behind a pinion: around its shaft, and with the motor beside it."""
    return max(z1, s.clear_1[i], s.stage_1[i] - z1)


@inner
def last_wheel(s, i, z2, j, z3):
    """Least teeth of gear 4: around its hub, and gear 2 clear of the output shaft."""
    if s.unit[j] == 0:
        return z3
    beside = -(-(s.unit[i] * (z2 + 2) + s.output) // s.unit[j])
    return max(z3, s.clear_2[j], beside - z3)


@inner
def row(s, i, z1, z2, j, z3):
    """Least and most teeth of gear 4 by the ratio, its tip and what gears keep clear of."""
    low = max(-(-s.least[z1 * z3] // z2), last_wheel(s, i, z2, j, z3))
    return low, min(s.most[z1 * z3] // z2, s.wheel_2[j])


@inner
def largest(numbers):
    """The largest of some numbers; their method `max` takes as long to compile as a search."""
    found = numbers[0]
    for number in numbers:
        found = max(found, number)
    return found


@inner
def smallest(numbers):
    """The smallest of some numbers."""
    found = numbers[0]
    for number in numbers:
        found = min(found, number)
    return found


@entry
def first_stages(s):
    """How many first stages are numbered, and the numbers of pinions and wheels of each module.

    Wheels beyond their limits are among them.
    """
    pinions = s.pinion[1] - s.pinion[0] + 1
    wheels = max(0, largest(s.wheel_1) - s.pinion[0] + 1)
    return s.module.size * pinions * wheels, pinions, wheels


@inner
def first_stage(n, least, pinions, wheels):
    """Module index, pinion and wheel teeth of first stage n; least: fewest teeth of either."""
    k = n // wheels
    return k // pinions, least + k % pinions, least + n % wheels


@entry
def every(s, goal, first, most, best, found):
    """Look at all trains of the first stages from `first` on.

    best: the least objective so far; found (6,): its z1, z2, z3, z4 and module indices. Of equal
    trains the first one counts. Returns best, the trains of a right ratio, the feasible ones, and
    the first stage to go on from.
    """
    looked = feasible = steps = 0
    n, (end, pinions, wheels) = first, first_stages(s)
    while n < end and steps < most:
        i, z1, z2 = first_stage(n, s.pinion[0], pinions, wheels)
        n, steps = n + 1, steps + 1
        if not z1 <= z2 <= s.wheel_1[i]:
            continue
        clear = first_wheel(s, i, z1)
        for j in range(s.module.size):
            for z3 in range(s.pinion[0], s.pinion[1] + 1):
                low = max(-(-s.least[z1 * z3] // z2), z3)
                high = min(s.most[z1 * z3] // z2, s.wheel)
                steps += 1 + max(0, high + 1 - low)
                for z4 in range(low, high + 1):
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
    return best, looked, feasible, n


@inner
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


@entry
def useful(s, goal, first, most, best, found):
    """Like `every`, for the best train alone: what cannot be better is not looked at.

    First stages whose promise is no better are dropped. With the other numbers fixed, inertia and
    mass grow with z4, error and stress fall with it, and what carries the motion is an interval: of
    every row of z4 only one end can be best.
    Returns best, first stages and trains looked at, 0, and the first stage to go on from.
    """
    looked = steps = 0
    n, (end, pinions, wheels) = first, first_stages(s)
    while n < end and steps < most:
        i, z1, z2 = first_stage(n, s.pinion[0], pinions, wheels)
        n, steps = n + 1, steps + 1
        if not first_wheel(s, i, z1) <= z2 <= s.wheel_1[i]:
            continue
        m1 = s.module[i]
        looked += 1
        if promise(s, goal, m1, z1, z2) >= best * ALLOWANCE:
            continue
        for j in range(s.module.size):
            m2 = s.module[j]
            for z3 in range(s.bored[j], s.pinion[1] + 1):
                steps += 1
                low, high = row(s, i, z1, z2, j, z3)
                if low > high:
                    continue
                if goal != 2:
                    least = max(
                        (s.lost[0] * z3 / (m1 * z2) + s.lost[1] / m2) / s.error,
                        s.load[z3] / (m2 * m2),
                        s.load[z1] * z3 / (m1 * m1 * z2),
                    )
                    if least > high + 1:
                        continue
                    low = max(low, int(least * (1.0 - 1e-9)))
                while goal != 2 and low <= high and not holds(s, m1, z1, z2, m2, z3, low):
                    low, looked, steps = low + 1, looked + 1, steps + 1
                low, high = carried(s, m1, z1, z2, m2, z3, low, high)
                if low > high:
                    continue
                looked, steps = looked + 1, steps + 1
                z4 = high if goal == 2 else low
                if goal == 2 and not holds(s, m1, z1, z2, m2, z3, z4):
                    continue
                value = worth(s, goal, m1, z1, z2, m2, z3, z4)
                if value < best:
                    best = value
                    found[0], found[1], found[2], found[3] = z1, z2, z3, z4
                    found[4], found[5] = i, j
    return best, looked, 0, n
