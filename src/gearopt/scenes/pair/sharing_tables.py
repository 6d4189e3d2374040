"""The table [sharing]: how elastic the teeth are taken to be, and at which loads they are asked."""

from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from gearopt.physics.tooth.elastic import PLANES
from gearopt.physics.tooth.ladder import COUPLINGS, LEVELS, USUAL
from gearopt.scenes.reading.fields import Table, choice, number, quantity, refuse, whole
from gearopt.scenes.reading.lists import several, word_or
from gearopt.units import Quantity

LOADS = several(number(0.5, 0, 100, zero=True), [0.5, 1])
COUPLING = word_or(tuple(COUPLINGS), quantity("compliance", "0.8 um/kN", zero=True))


class SharingTable(Table):
    """How the load is shared between tooth pairs."""

    level: Annotated[str | None, choice(*LEVELS)] = Field(
        None,
        description=f"Model of the compliance of a pair of teeth; by default {USUAL}, for a relief "
        "finite elements where they are installed",
    )
    error: Annotated[Fraction | None, number("5 %", 0, 1, percent=True)] = Field(
        None,
        description="Instead of level: permissible error of the stiffness and of the peak-to-peak "
        "transmission error, as measured against finite elements; the cheapest level and coupling "
        "within it are taken",
    )
    plane: Annotated[str | None, choice(*PLANES)] = Field(
        None,
        description="Plane state of the gears: by default strain from a face width of 6 modules "
        "on, else stress",
    )
    coupling: Annotated[str | Quantity | None, COUPLING] = Field(
        None,
        description="Coupling of neighbouring tooth pairs, whose load deflects each other: a "
        "model, or a number such as one from finite elements; by default ring torsion, of "
        "helical gears finite elements where they are installed, with level "
        "finite elements theirs",
    )
    loads: Annotated[tuple[Fraction, ...], LOADS] = Field(
        (Fraction(1),),
        description="Loads at which contact is computed, relative to the torque of [duty]",
        json_schema_extra={"default": [1]},
    )
    positions: Annotated[int, whole(96, 12, 5000)] = Field(
        96,
        description="Positions of the gears over one base pitch; both sides of every point where a "
        "tooth pair comes or goes are added",
    )

    @model_validator(mode="after")
    def _one_way(self) -> "SharingTable":
        if self.level is not None and self.error is not None:
            rule = "conflicts with level; one is enough"
            raise refuse(rule, at=("error",), action="remove")
        if len(set(self.loads)) < len(self.loads):
            once = [float(load) for load in dict.fromkeys(self.loads)]
            raise refuse("names a load twice", once, ("loads",))
        return self
