"""[gears] and [[stage]]: what all stages share, and what one stage fixes or has of its own."""

from fractions import Fraction
from typing import Annotated

from pydantic import Field

from gearopt import units
from gearopt.scenes.reading.fields import Table, number, quantity, whole
from gearopt.scenes.reading.lists import span
from gearopt.units import Quantity

LENGTH = quantity("length", "400 mm")
CONTACT = quantity("stress", "2.07 MPa")
ROOT = quantity("stress", "48 MPa")
STEP = quantity("length", "1 mm")
TOOTH_COUNT = whole(21, 5, 1000)
WHEEL_TEETH = whole(100, 5, 100_000)
MODULE = quantity("length", "2 mm")
PROPORTION = span(number(0.6, 0, 10), [0.3, 0.6], single=True)
RATIOS = span(number(5, 1, 10**6), [1, 10])

Proportion = Annotated[tuple[Fraction, Fraction] | None, PROPORTION]
Ratios = Annotated[tuple[Fraction, Fraction] | None, RATIOS]
Length = Annotated[Quantity | None, LENGTH]
Contact = Annotated[Quantity | None, CONTACT]
Root = Annotated[Quantity | None, ROOT]
Step = Annotated[Quantity | None, STEP]
Lengths = tuple[Quantity, Quantity]

PROPORTION_IS = (
    "Face width over pinion diameter b/d1: a number ties b to d1, a range leaves it free within it"
)
STEP_IS = "Face widths are whole multiples of this"
K_IS = "Largest K-factor W_t/(d1 b) (u + 1)/u, the index of contact stress"
U_IS = "Largest unit load W_t/(b m_n), the index of tooth-root stress"
WHEEL_IS = "Largest reference diameter of a wheel"


class Gears(Table):
    """What all stages share."""

    helix_angle: Annotated[Quantity, quantity("angle", "25 deg", "45 deg", zero=True)] = Field(
        default_factory=lambda: units.parse("0 deg", "angle"),
        description="Helix angle at the reference cylinder",
        json_schema_extra={"default": "0 deg"},
    )
    pressure_angle: Annotated[Quantity, quantity("angle", "20 deg", "45 deg")] = Field(
        default_factory=lambda: units.parse("20 deg", "angle"),
        description="Normal pressure angle: it gives the contact ratio; "
        "K-factor and unit load do not depend on it",
        json_schema_extra={"default": "20 deg"},
    )
    face_width_over_diameter: Proportion = Field(None, description=PROPORTION_IS)
    face_width_step: Step = Field(None, description=STEP_IS)


class StageTable(Table):
    """One stage: what differs from the other tables, and what is fixed."""

    module: Annotated[Lengths | None, span(MODULE, "2 mm", single=True)] = Field(
        None, description="Normal module: fixed, or a range"
    )
    pinion_teeth: Annotated[tuple[int, int] | None, span(TOOTH_COUNT, 21, single=True)] = Field(
        None, description="Pinion teeth: fixed, or a range"
    )
    wheel_teeth: Annotated[tuple[int, int] | None, span(WHEEL_TEETH, 100, single=True)] = Field(
        None, description="Wheel teeth: fixed, or a range"
    )
    face_width: Annotated[Quantity | None, quantity("length", "40 mm")] = Field(
        None, description="Face width, fixed"
    )
    face_width_over_diameter: Proportion = Field(None, description=PROPORTION_IS)
    face_width_step: Step = Field(None, description=STEP_IS)
    stage_ratio: Ratios = Field(None, description="Range of the stage's ratio")
    k_factor: Contact = Field(None, description=K_IS)
    unit_load: Root = Field(None, description=U_IS)
    wheel_diameter: Length = Field(None, description=WHEEL_IS)
