"""A kernel that lists the trains of a first stage whose objective lies between two values."""

from numba import njit

from gearopt.formulations.split import duty_kernel
from gearopt.formulations.split.teeth_kernel import (
    ALLOWANCE,
    first_wheel,
    last_wheel,
    possible,
    promise,
    sound,
    worth,
)

promise_of_duty = duty_kernel.promise


@njit(cache=True)
def between(s, goal, k, above, most, rows):
    """Feasible trains with above < objective <= most, of first stages k (module and pinion teeth).

    rows (capacity, 6): z1, z2, z3, z4 and the modules' indices; how many there are, also where they
    are more than the capacity.
    """
    pinions = s.pinion[1] - s.pinion[0] + 1
    i, z1 = k // pinions, s.pinion[0] + k % pinions
    m1, count = s.module[i], 0
    for z2 in range(first_wheel(s, i, z1), s.wheel_1[i] + 1):
        if goal > 2:
            least = promise_of_duty(s, m1, z1, z2, most)
        else:
            least = promise(s, goal, m1, z1, z2)
        if least > most * ALLOWANCE:
            continue
        for j in range(s.module.size):
            m2 = s.module[j]
            for z3 in range(s.bored[j], s.pinion[1] + 1):
                low = max(-(-s.least[z1 * z3] // z2), last_wheel(s, i, z2, j, z3))
                high = min(s.most[z1 * z3] // z2, s.wheel_2[j])
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
    return count
