"""A kernel that finds the best train for a duty, whose total ratio is free within its range.

What a duty makes least is convex in logarithms: the acceleration, the speed and the train's inertia
are held by posynomials. So it falls and then rises with the teeth of wheel 4, and so it does with
the total ratio where the inertia is replaced by a + b N^2. `between` lists the trains whose
objective lies between two values.
"""

import math

from gearopt.formulations.servo.split import teeth_kernel
from gearopt.formulations.servo.split.teeth_kernel import (
    ALLOWANCE,
    carried,
    first_stage,
    first_stages,
    first_wheel,
    holds,
    moved,
    possible,
    row,
    smallest,
    sound,
    worth,
)
from gearopt.optimise.jit_kernel import entry, inner

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
SECTION_STEPS = 70  # of a golden section: a range of 1e6 shrinks to 3e-14 of its logarithm
MARGIN = 1.0 - 1e-9  # far more than rounding and the last interval leave


@inner
def centre(duty):
    """A ratio at which the load moves if it moves at any: there the motor gives most power."""
    return duty[3] / (2.0 * duty[6]) if duty[6] > 0.0 else math.inf


@inner
def falls(here, beyond, ratio, middle):
    """Whether to go on to larger ratios; where nothing moves, towards those at which it may."""
    if math.isinf(here) and math.isinf(beyond):
        return ratio < middle
    return beyond < here


@inner
def held(duty, low, high, fixed, grown, best):
    """A lower bound of what a duty makes least, for ratios from low to high and fixed + grown N^2.

    Once a value below `best` is seen it is returned.
    """
    a, b, middle = math.log(low), math.log(high), centre(duty)
    for end in (a, b):
        ratio = math.exp(end)
        if moved(duty, ratio, fixed + grown * ratio**2) < best:
            return -math.inf
    least = math.inf
    for _ in range(SECTION_STEPS):
        p, q = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
        n1, n2 = math.exp(p), math.exp(q)
        here = moved(duty, n1, fixed + grown * n1**2)
        beyond = moved(duty, n2, fixed + grown * n2**2)
        least = min(least, here, beyond)
        if least < best:
            return -math.inf
        if falls(here, beyond, n1, middle):
            a = p
        else:
            b = q
    for end in (a, b):
        ratio = math.exp(end)
        least = min(least, moved(duty, ratio, fixed + grown * ratio**2))
    return least * MARGIN


@inner
def promise(s, m1, z1, z2, best):
    """A lower bound for all trains with this first stage; inf where there is none.

    d3 is at least the bore and the smallest pinion, so d4^4/N^2 at least d3^4 N^2/n1^4.
    """
    n1, d1, d2 = z2 / z1, m1 * z1, m1 * z2
    d3 = max(s.bore, s.pinion[0] * smallest(s.module))
    low, high = max(s.low, n1), min(s.high, n1 * s.tip / d3)
    if low > high:
        return math.inf
    fixed = s.disc_inertia * (d1**4 + (d2**4 + d3**4) / n1**2) + s.shaft_inertia / n1**2
    grown = s.sector * s.disc_inertia * (d3 / n1) ** 4
    return held(s.duty, low, high, fixed, grown, best)


@inner
def best_of_row(s, goal, m1, z1, z2, m2, z3, low, high, middle):
    """Teeth of wheel 4 from low to high that are best; z4 and how many were looked at."""
    looked = 0
    while low < high:
        z4 = (low + high) // 2
        here = worth(s, goal, m1, z1, z2, m2, z3, z4)
        beyond = worth(s, goal, m1, z1, z2, m2, z3, z4 + 1)
        looked += 2
        if falls(here, beyond, z2 * z4 / (z1 * z3), middle):
            low = z4 + 1
        else:
            high = z4
    return low, looked + 1


@entry
def useful(s, goal, first, most, best, found):
    """Like `useful` of the teeth, for what a duty makes least; a promise is SECTION_STEPS steps.

    Error and stress fall with the teeth of wheel 4 and gears keep clear above some number of them,
    so that those allowed are the largest ones; those that carry the motion are an interval.
    """
    looked, steps, middle = 0, 0, centre(s.duty)
    n, (end, pinions, wheels) = first, first_stages(s)
    while n < end and steps < most:
        i, z1, z2 = first_stage(n, s.pinion[0], pinions, wheels)
        n, steps = n + 1, steps + 1
        if not first_wheel(s, i, z1) <= z2 <= s.wheel_1[i]:
            continue
        m1 = s.module[i]
        looked, steps = looked + 1, steps + SECTION_STEPS
        if promise(s, m1, z1, z2, best) >= best:
            continue
        for j in range(s.module.size):
            m2 = s.module[j]
            for z3 in range(s.bored[j], s.pinion[1] + 1):
                steps += 1
                low, high = row(s, i, z1, z2, j, z3)
                if low > high or not holds(s, m1, z1, z2, m2, z3, high):
                    continue
                top = high
                while low < top:
                    z4 = (low + top) // 2
                    if holds(s, m1, z1, z2, m2, z3, z4):
                        top = z4
                    else:
                        low = z4 + 1
                low, high = carried(s, m1, z1, z2, m2, z3, low, high)
                if low > high:
                    continue
                z4, more = best_of_row(s, goal, m1, z1, z2, m2, z3, low, high, middle)
                looked, steps = looked + more, steps + more
                value = worth(s, goal, m1, z1, z2, m2, z3, z4)
                if value < best:
                    best = value
                    found[0], found[1], found[2], found[3] = z1, z2, z3, z4
                    found[4], found[5] = i, j
    return best, looked, 0, n


promise_alone = teeth_kernel.promise


@entry
def between(s, goal, first, most_steps, above, most, rows):
    """Feasible trains with above < objective <= most, of the first stages from `first` on.

    rows (capacity, 6): z1, z2, z3, z4 and the modules' indices. Returns how many there are, also
    where they are more than the capacity, and the first stage to go on from.
    """
    count = steps = 0
    n, (end, pinions, wheels) = first, first_stages(s)
    while n < end and steps < most_steps:
        i, z1, z2 = first_stage(n, s.pinion[0], pinions, wheels)
        n, steps = n + 1, steps + 1
        if not first_wheel(s, i, z1) <= z2 <= s.wheel_1[i]:
            continue
        m1 = s.module[i]
        if goal > 2:
            least, steps = promise(s, m1, z1, z2, most), steps + SECTION_STEPS
        else:
            least = promise_alone(s, goal, m1, z1, z2)
        if least > most * ALLOWANCE:
            continue
        for j in range(s.module.size):
            m2 = s.module[j]
            for z3 in range(s.bored[j], s.pinion[1] + 1):
                low, high = row(s, i, z1, z2, j, z3)
                steps += 1 + max(0, high + 1 - low)
                for z4 in range(low, high + 1):
                    value = worth(s, goal, m1, z1, z2, m2, z3, z4)
                    if not above < value <= most:
                        continue
                    if goal > 2 and not possible(s.duty, value):
                        continue
                    if not sound(s, m1, z1, z2, m2, z3, z4):
                        continue
                    if count < len(rows):
                        rows[count, 0], rows[count, 1] = z1, z2
                        rows[count, 2], rows[count, 3] = z3, z4
                        rows[count, 4], rows[count, 5] = i, j
                    count += 1
    return count, n
