"""A kernel that finds the best train that is stiff enough and fits its box, without a list.

It goes through first stages like the kernels of `split`, and through the trains with an objective
between two values. A first stage is dropped by the promise of its objective, by the stiffness and
by the box that its best second stage would have; what that takes is computed once, on first sight.
Angles of the output link are those of a quarter: box and train have the same mirror images.
"""

import math

import numpy as np

from gearopt.formulations.servo.servo_box_kernel import SLACK, ZERO, decided, room
from gearopt.formulations.servo.split import duty_kernel
from gearopt.formulations.servo.split.teeth_kernel import (
    ALLOWANCE,
    carried,
    first_stage,
    first_stages,
    first_wheel,
    holds,
    possible,
    promise,
    row,
    smallest,
    worth,
)
from gearopt.optimise.jit_kernel import entry, inner

promise_of_duty = duty_kernel.promise
PARTS = 16  # of a quarter, as bits
EVERY = np.int64((1 << PARTS) - 1)
WIDTH = 0.5 * math.pi / PARTS
LOOK_STEPS = 40  # steps of one look at a box
PROMISE = 2 * duty_kernel.SECTION_STEPS  # steps of a promise of a duty
UNKNOWN = -1  # of the parts that are open
INTERVALS = np.int64(10_000)  # that may decide whether one train fits
UNDECIDED = -1


@inner
def soft(teeth):
    """1/Z of Buckingham's factor of a tooth, after Lewis."""
    return 0.242 / (0.154 - 0.912 / teeth) + 7.25


@inner
def mesh(spring, m, pinion, wheel):
    """Compliance of a mesh at its wheel [rad/(N mm)]."""
    line = spring[0]
    if line == 0.0:
        line = spring[1] / (soft(pinion) + soft(wheel))
    return 4.0 / (line * spring[2] * (m * wheel) ** 2)


@inner
def compliance(spring, m1, z1, z2, m2, z3, z4):
    """Compliance of a train at the output [rad/(N mm)]; it falls with z4."""
    behind = mesh(spring, m1, z1, z2) + spring[3]
    return mesh(spring, m2, z3, z4) + behind * (z3 / z4) ** 2


@inner
def stiff(s, spring, m1, z1, z2, m2, z3, z4):
    """Whether a train keeps all limits that fall with z4: error, stress and stiffness."""
    if not holds(s, m1, z1, z2, m2, z3, z4):
        return False
    if spring[4] == 0.0:
        return True
    return compliance(spring, m1, z1, z2, m2, z3, z4) * spring[4] <= ALLOWANCE


@inner
def least_compliance(s, spring, m1, z1, z2):
    """A lower bound of the compliance of all trains with a first stage."""
    n1 = z2 / z1
    line = spring[0]
    if line == 0.0:
        line = 0.5 * spring[1] / soft(math.inf)
    last = 4.0 / (line * spring[2] * s.tip**2)
    return last + (mesh(spring, m1, z1, z2) + spring[3]) * (n1 / s.high) ** 2


@inner
def least_d4(s, m1, z1, z2, d3):
    """Least reference diameter of gear 4 by error and ratio [mm]; d3: least of gear 3."""
    left = s.error * ALLOWANCE - s.lost[0] / (m1 * z1 * s.high)
    asked = s.lost[1] / left if left > 0.0 else math.inf
    return max(asked, d3 * max(1.0, s.low * z1 / z2)) * (1.0 - SLACK)


@inner
def least_d3(s):
    """Least reference diameter of gear 3 [mm]."""
    return max(s.bore, s.pinion[0] * smallest(s.module))


@inner
def promised(s, goal, spring, i, z1, z2):
    """A lower bound on the objective of all trains with a first stage; inf where there is none."""
    if not first_wheel(s, i, z1) <= z2 <= s.wheel_1[i]:
        return math.inf
    m1 = s.module[i]
    if least_d4(s, m1, z1, z2, least_d3(s)) > s.tip:
        return math.inf
    if s.load[z1] > s.high * z1 * m1**2 * ALLOWANCE:
        return math.inf
    if spring[4] > 0.0 and least_compliance(s, spring, m1, z1, z2) * spring[4] > ALLOWANCE:
        return math.inf
    if goal > 2:
        return promise_of_duty(s, m1, z1, z2, -math.inf)
    return promise(s, goal, m1, z1, z2)


@inner
def first_sizes(kept, m1, z1, z2):
    """Write what a first stage has of the box: of motor or gear 1, gear 2 and their link."""
    kept.box.radius[0] = max(kept.motor, 0.5 * m1 * (z1 + 2))
    kept.box.radius[1] = 0.5 * m1 * (z2 + 2)
    kept.box.link[0] = 0.5 * m1 * (z1 + z2)


@inner
def open_parts(s, box, m1, z1, z2, parts, bore, added, largest):
    """Which parts of the quarter a first stage leaves to all second stages, as bits.

    bore: least d3; added: least addition of the tip to d4; largest: d4 at most [mm]. d3, and with
    it b, is held by d4 and the ratio.
    """
    d4, n1 = least_d4(s, m1, z1, z2, bore), z2 / z1
    if d4 > largest:
        return 0
    box.radius[2] = 0.5 * (d4 + added)
    box.link[1] = 0.5 * (d4 + max(bore, d4 * n1 / s.high)) * (1.0 - SLACK)
    box.link[2] = 0.5 * largest * (1.0 + min(1.0, n1 / s.low)) * (1.0 + SLACK)
    found = 0
    for k in range(PARTS):
        if parts >> k & 1 and not math.isnan(room(box, 1.0, k * WIDTH, (k + 1) * WIDTH, SLACK)):
            found |= 1 << k
    return found


@inner
def fitting(kept, work, m1, z1, z2, m2, z3, z4):
    """Whether a train fits in the open parts: 1, 0 or UNDECIDED; and the steps that took."""
    box = kept.box
    first_sizes(kept, m1, z1, z2)
    box.radius[1] = max(box.radius[1], 0.5 * m2 * (z3 + 2))
    box.radius[2] = 0.5 * m2 * (z4 + 2)
    box.link[1] = box.link[2] = 0.5 * m2 * (z3 + z4)
    count = ZERO
    for k in range(PARTS):
        if work.at[3] >> k & 1:
            work.cells[count, 0], work.cells[count, 1] = k * WIDTH, (k + 1) * WIDTH
            count += 1
    answer, looked = decided(box, work.cells, count, work.angles, INTERVALS)
    return answer, LOOK_STEPS * looked


@inner
def first_stiff(s, spring, m1, z1, z2, m2, z3, low, high):
    """Least z4 from low on that keeps error, stress and stiffness; high + 1 for none."""
    if low > high or not stiff(s, spring, m1, z1, z2, m2, z3, high):
        return high + 1
    while low < high:
        middle = (low + high) // 2
        if stiff(s, spring, m1, z1, z2, m2, z3, middle):
            high = middle
        else:
            low = middle + 1
    return low


@inner
def enter(s, goal, kept, work, limit):
    """Whether the first stage at hand has trains up to a limit, and the steps to know it."""
    n, steps = work.at[0], 1
    i, z1, z2 = first_stage(n, s.pinion[0], *first_stages(s)[1:])
    m1 = s.module[i]
    if math.isnan(work.known[n]):
        work.known[n] = promised(s, goal, kept.spring, i, z1, z2)
        steps += PROMISE if goal > 2 else 1
    if math.isinf(work.known[n]) or work.known[n] > limit * ALLOWANCE:
        return False, steps
    if kept.boxed:
        first_sizes(kept, m1, z1, z2)
        if work.parts[n] == UNKNOWN:
            d3, added = least_d3(s), 2.0 * smallest(s.module)
            work.parts[n] = open_parts(s, kept.box, m1, z1, z2, EVERY, d3, added, s.tip)
            steps += LOOK_STEPS * PARTS
        if work.parts[n] == 0:
            work.known[n] = math.inf
            return False, steps
    return True, steps


@inner
def module_parts(s, kept, work, i, z1, z2, j):
    """Which parts are open with a module of the second stage, and the steps to know it."""
    m1, m2 = s.module[i], s.module[j]
    if s.bored[j] > s.pinion[1]:
        return 0, 1
    d3, largest = m2 * s.bored[j], m2 * s.wheel_2[j]
    if smallest(s.load[s.bored[j] : s.pinion[1] + 1]) > largest * m2 * ALLOWANCE:
        return 0, 1
    if not kept.boxed:
        return EVERY if least_d4(s, m1, z1, z2, d3) <= largest else 0, 1
    first_sizes(kept, m1, z1, z2)
    own = work.parts[work.at[0]]
    found = open_parts(s, kept.box, m1, z1, z2, own, d3, 2.0 * m2, largest)
    return found, LOOK_STEPS * PARTS


@inner
def none_left(s, goal, i, z1, z2, j, z3, limit):
    """Whether no train with this pinion 3 or a larger one of its module is within a limit."""
    if z3 > s.pinion[1]:
        return True
    z4 = max(-(-s.least[z1 * z3] // z2), z3)
    if z4 > s.wheel_2[j]:
        return True
    return goal < 2 and worth(s, goal, s.module[i], z1, z2, s.module[j], z3, z4) > limit * ALLOWANCE


@inner
def best_of_row(s, goal, kept, work, i, z1, z2, j, z3):
    """Look at the trains of one row; returns how many, the steps, and whether a box is undecided.

    Values rise along the row, except for a duty.
    """
    m1, m2, ends, looked = s.module[i], s.module[j], work.ends, 0
    low, high = row(s, i, z1, z2, j, z3)
    low = first_stiff(s, kept.spring, m1, z1, z2, m2, z3, low, high)
    low, high = carried(s, m1, z1, z2, m2, z3, low, high)
    steps = 2
    for step in range(high + 1 - low):
        z4 = high - step if goal == 2 else low + step
        value, steps = worth(s, goal, m1, z1, z2, m2, z3, z4), steps + 1
        if value <= ends[0]:
            continue
        if value > ends[1] or value >= ends[2]:
            if goal <= 2:
                break
            continue
        if goal > 2 and not possible(s.duty, value):
            continue
        looked += 1
        if kept.boxed:
            fits, more = fitting(kept, work, m1, z1, z2, m2, z3, z4)
            steps += more
            if fits == UNDECIDED:
                return looked, steps, True
            if fits == 0:
                continue
        ends[2] = value
        work.found[0], work.found[1], work.found[2], work.found[3] = z1, z2, z3, z4
        work.found[4], work.found[5] = i, j
    return looked, steps, False


@entry
def best_kept(s, goal, kept, work, most):
    """Find the best train between ends, for a slice of `most` steps; see `choice`.

    Returns the first stages and trains looked at, and whether a box is undecided.
    """
    looked = steps = 0
    end, pinions, wheels = first_stages(s)
    at, ends = work.at, work.ends
    while at[0] < end and steps < most:
        limit = min(ends[1], ends[2])
        if at[1] < 0:
            looked += math.isnan(work.known[at[0]])
            there, more = enter(s, goal, kept, work, limit)
            steps += more
            if not there:
                at[0] += 1
                continue
            at[1], at[2] = 0, -1
        i, z1, z2 = first_stage(at[0], s.pinion[0], pinions, wheels)
        j = at[1]
        if j == s.module.size or work.known[at[0]] > limit * ALLOWANCE:
            at[0], at[1] = at[0] + 1, -1
            continue
        if at[2] < 0:
            at[2] = s.bored[j]
            at[3], more = module_parts(s, kept, work, i, z1, z2, j)
            steps += more
        if at[3] == 0 or none_left(s, goal, i, z1, z2, j, at[2], limit):
            at[1], at[2] = j + 1, -1
            continue
        more, spent, undecided = best_of_row(s, goal, kept, work, i, z1, z2, j, at[2])
        looked, steps, at[2] = looked + more, steps + spent, at[2] + 1
        if undecided:
            return looked, True
    return looked, False
