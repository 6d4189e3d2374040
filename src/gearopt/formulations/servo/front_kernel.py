"""A kernel that lists trains for a Pareto front: those that no train of a sample beats."""

import math

import numpy as np

from gearopt.formulations.servo.choice_kernel import first_stiff, least_d3, least_d4, promised
from gearopt.formulations.servo.split import duty_kernel
from gearopt.formulations.servo.split.teeth_kernel import (
    carried,
    first_stage,
    first_stages,
    possible,
    row,
    worth,
)
from gearopt.optimise.jit_kernel import entry, inner

best_of_row = duty_kernel.best_of_row
centre = duty_kernel.centre
PIECES = 16  # of the diameters of gear 4 that are bounded alone
LESS = 1.0 - 1e-13  # of an objective: more than its rounding
MARGIN = duty_kernel.MARGIN
PROMISE = 2 * duty_kernel.SECTION_STEPS  # steps of a promise of a duty


@inner
def beaten(sample, values):
    """Whether a train of the sample (trains, objectives) is below all values; it moves forward."""
    for k in range(sample.shape[0]):
        below = True
        for c in range(values.size):
            if not sample[k, c] < values[c] * LESS:
                below = False
                break
        if below:
            for c in range(values.size):
                kept = sample[k // 2, c]
                sample[k // 2, c] = sample[k, c]
                sample[k, c] = kept
            return True
    return False


@inner
def all_beaten(s, aims, sample, m1, z1, z2, d3, largest, duty, values):
    """Whether the sample beats all trains with a first stage and so large a gear 3 or larger.

    Between the least d4 and the largest there are PIECES; each is bounded by its own ends. duty:
    bound of the goal of a duty.
    """
    d1, d2, n1 = m1 * z1, m1 * z2, z2 / z1
    low = least_d4(s, m1, z1, z2, d3)
    if not low <= largest:
        return True
    step = (largest / low) ** (1.0 / PIECES)
    for k in range(PIECES):
        d4, beyond = low * step**k * LESS, low * step ** (k + 1)
        n = min(s.high, n1 * beyond / d3)
        for c in range(aims.size):
            if aims[c] > 2:
                values[c] = duty
            elif aims[c] == 2:
                values[c] = s.lost[0] / (d1 * n) + s.lost[1] / beyond
            elif aims[c] == 1:
                values[c] = s.disc_mass * (d1**2 + d2**2 + d3**2 + s.sector * d4**2)
            else:
                middle = s.disc_inertia * (d2**4 + d3**4) + s.shaft_inertia
                last = s.sector * s.disc_inertia * d4**4 / n**2
                values[c] = s.disc_inertia * d1**4 + middle / n1**2 + last
        if not beaten(sample, values):
            return False
    return True


@inner
def row_bounds(s, aims, m1, z1, z2, m2, z3, low, high, values):
    """Write lower bounds of the objectives along a row, each of a train of its own."""
    for c in range(aims.size):
        z4, margin = high if aims[c] == 2 else low, 1.0
        if aims[c] > 2:
            middle = centre(s.duty)
            z4 = best_of_row(s, aims[c], m1, z1, z2, m2, z3, low, high, middle)[0]
            margin = MARGIN
        values[c] = margin * worth(s, aims[c], m1, z1, z2, m2, z3, z4)


@entry
def unbeaten(s, aims, spring, sample, at, duty, rows, most):
    """List the feasible trains that no train of a sample beats, for a slice of `most` steps.

    aims: objectives, as `worth` counts them. at (3,): first stage, module and pinion teeth of the
    second one to go on from, -1 where it is not entered; duty (1,): promise of that stage. rows
    (capacity, 6): z1, z2, z3, z4 and module indices; a row of wheel teeth must find room. Returns
    how many there are.
    """
    count, steps = rows.shape[0] * 0, 0  # no literal, which would compile `listed` once more
    end, pinions, wheels = first_stages(s)
    values = np.empty(aims.size)
    while at[0] < end and steps < most:
        i, z1, z2 = first_stage(at[0], s.pinion[0], pinions, wheels)
        if at[1] < 0:
            steps += PROMISE if aims[0] > 2 else 5
            m1 = s.module[i]
            duty[0] = promised(s, aims[0], spring, i, z1, z2)
            if math.isinf(duty[0]) or all_beaten(
                s, aims, sample, m1, z1, z2, least_d3(s), s.tip, duty[0], values
            ):
                at[0] += 1
                continue
            at[1], at[2] = 0, -1
        j = at[1]
        if j == s.module.size:
            at[0], at[1] = at[0] + 1, -1
            continue
        at[2] = s.bored[j] if at[2] < 0 else at[2]
        z3 = at[2]
        if z3 > s.pinion[1] or -(-s.least[z1 * z3] // z2) > s.wheel_2[j]:
            at[1], at[2] = j + 1, -1
            continue
        m1, m2, steps = s.module[i], s.module[j], steps + 5
        if z3 == s.bored[j] and all_beaten(
            s, aims, sample, m1, z1, z2, m2 * z3, m2 * s.wheel_2[j], duty[0], values
        ):
            at[1], at[2] = j + 1, -1
            continue
        low, high = row(s, i, z1, z2, j, z3)
        low = first_stiff(s, spring, m1, z1, z2, m2, z3, low, high)
        low, high = carried(s, m1, z1, z2, m2, z3, low, high)
        steps, at[2] = steps + 5, z3 + 1
        if low <= high:
            if count + high + 1 - low > len(rows):
                at[2] = z3
                return count
            row_bounds(s, aims, m1, z1, z2, m2, z3, low, high, values)
            steps += PROMISE if aims[0] > 2 else 5
            if not beaten(sample, values):
                count = listed(s, aims, sample, i, z1, z2, j, z3, low, high, values, rows, count)
                steps += len(sample) * (high + 2 - low)
                continue
        largest = m2 * s.wheel_2[j]
        if all_beaten(s, aims, sample, m1, z1, z2, m2 * (z3 + 1), largest, duty[0], values):
            at[1], at[2] = j + 1, -1
    return count


@inner
def listed(s, aims, sample, i, z1, z2, j, z3, low, high, values, rows, count):
    """Append the trains of a row that are not beaten; returns how many there are then."""
    for z4 in range(low, high + 1):
        for c in range(aims.size):
            values[c] = worth(s, aims[c], s.module[i], z1, z2, s.module[j], z3, z4)
        if aims[0] > 2 and not possible(s.duty, values[0]):
            continue
        if beaten(sample, values):
            continue
        rows[count, 0], rows[count, 1], rows[count, 2], rows[count, 3] = z1, z2, z3, z4
        rows[count, 4], rows[count, 5] = i, j
        count += 1
    return count
