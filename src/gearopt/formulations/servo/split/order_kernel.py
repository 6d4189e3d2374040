"""A kernel that lists the trains whose objective lies between two values."""

from gearopt.formulations.servo.split import duty_kernel
from gearopt.formulations.servo.split.teeth_kernel import (
    ALLOWANCE,
    first_stage,
    first_stages,
    first_wheel,
    possible,
    promise,
    row,
    sound,
    worth,
)
from gearopt.optimise.jit_kernel import entry

SECTION_STEPS = duty_kernel.SECTION_STEPS
promise_of_duty = duty_kernel.promise


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
            least, steps = promise_of_duty(s, m1, z1, z2, most), steps + SECTION_STEPS
        else:
            least = promise(s, goal, m1, z1, z2)
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
