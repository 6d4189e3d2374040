"""Lewis stress: bending at the root of the pinion's teeth, without dynamic factors."""

import math
from typing import Any

from gearopt.formulations.strength import Law, LimitedIndex
from gearopt.physics.gears import GearPair
from gearopt.physics.loads import lewis_stress
from gearopt.physics.stiffness import lewis_form_factor

MINIMUM_TEETH = 12  # of `lewis_form_factor`


def lewis(teeth: float | None = None) -> Law:
    """Return the law; teeth: their form factor is taken for all numbers of teeth of a pinion.

    With the largest number of teeth of a range it is a lower bound and a monomial. The form factor
    is a fit from 12 teeth up; below, z/Y falls with z, and at 5 Y is no longer positive.
    """

    def indices(pair: GearPair, torque: Any, speed: Any) -> tuple[Any, ...]:
        form = lewis_form_factor(pair.pinion_teeth if teeth is None else teeth)
        d = pair.pinion.reference_diameter
        return (lewis_stress(torque, d, pair.face_width, pair.normal_module, form),)

    bound = lewis(math.inf) if teeth is None else None
    return Law(
        "Lewis stress",
        (LimitedIndex("bending_stress"),),
        indices,
        proportional=True,
        relaxed=bound,
        minimum_teeth=MINIMUM_TEETH,
    )


LEWIS = lewis()
