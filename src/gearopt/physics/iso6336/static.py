"""The rating of a pair under a static load: the peak torque, which acts seldom, by ISO 6336.

It is the rating at N_L = 0, where parts 2 and 3 have static strength: Z_NT and Y_NT at the static
ends of their curves, Z_L = Z_v = Z_R = 1, Z_W and Y_deltarelT of static stress, Y_RrelT = Y_X = 1.
The peak torque takes the place of K_A; the other factors of load are those at the peak torque.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from gearopt.physics.rating import Operation

# factors that differ between reference and static strength
BY_CYCLES = ("Z_NT", "Z_L", "Z_v", "Z_R", "Z_W", "Y_NT", "Y_deltarelT", "Y_RrelT", "Y_X")


def static_operation(operation: Operation, factor: float) -> Operation:
    """Return the operation at a factor of the nominal torque, which acts seldom."""
    return replace(operation, power=factor * operation.power, hours=0.0, overload=1.0)


def static_given(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the given factors that hold for static strength, too."""
    return {name: value for name, value in given.items() if name not in BY_CYCLES}
