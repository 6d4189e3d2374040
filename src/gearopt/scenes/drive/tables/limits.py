"""[limits], [teeth] and [objective]: what stages must keep to, and what is best."""

from fractions import Fraction
from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from gearopt import units
from gearopt.formulations.gear_train import OBJECTIVES
from gearopt.formulations.strength import Law
from gearopt.formulations.strength.k_factor import K_FACTOR
from gearopt.physics.gears import MODULES
from gearopt.scenes.drive.tables.stages import (
    K_IS,
    MODULE,
    TOOTH_COUNT,
    U_IS,
    WHEEL_IS,
    WHEEL_TEETH,
    Contact,
    Length,
    Lengths,
    Ratios,
    Root,
)
from gearopt.scenes.reading.fields import Table, choice, quantity, refuse, truth
from gearopt.scenes.reading.lists import either, span
from gearopt.units import Quantity

# Load limits a source states for its own drive (Chong and Lee print 2.07 MPa and 48 MPa).
PRESETS = {"chong-lee-elevator": {"k_factor": "300 psi", "unit_load": "7000 psi"}}
ORIGINS = {
    "chong-lee-elevator": "300 psi (2.07 MPa) and 7000 psi (48 MPa), as Chong and Lee state them "
    "for their elevator drive"
}


class Limits(Table):
    """Limits of every stage, unless its own table says otherwise."""

    LAW: ClassVar[Law] = K_FACTOR  # each of its limits is a key, here and of a stage

    preset: Annotated[str | None, choice(*PRESETS)] = Field(
        None,
        description="K-factor and unit load that a source states: chong-lee-elevator is 300 psi "
        "and 7000 psi",
    )
    k_factor: Contact = Field(None, description=K_IS)
    unit_load: Root = Field(None, description=U_IS)
    pinion_teeth: Annotated[tuple[int, int], span(TOOTH_COUNT, [20, 40])] = Field(
        description="Range of pinion teeth"
    )
    wheel_teeth: Annotated[tuple[int, int] | None, span(WHEEL_TEETH, [20, 400])] = Field(
        None, description="Range of wheel teeth"
    )
    module: Annotated[Lengths | None, span(MODULE, ["1 mm", "10 mm"])] = Field(
        None, description="Range of the normal module"
    )
    stage_ratio: Ratios = Field(
        None, description="Range of every stage's ratio (without it: 1 and up)"
    )
    wheel_diameter: Length = Field(None, description=WHEEL_IS)

    @model_validator(mode="after")
    def _loads(self) -> "Limits":
        given = [name for name in self.LAW.names if getattr(self, name) is not None]
        if self.preset is None and not given:
            raise refuse(f"is missing (or give {' and '.join(self.LAW.names)})", at=("preset",))
        for name in self.LAW.names:
            if name in given and self.preset is not None:
                raise refuse("stands beside preset, which sets it", at=(name,), action="remove")
            if name not in given and self.preset is None:
                raise refuse("is missing (or give preset)", at=(name,))
        return self

    def load(self, name: str) -> Quantity:
        """A limit of the strength law, from the file or the preset."""
        own: Quantity | None = getattr(self, name)
        return own or units.parse(PRESETS[str(self.preset)][name], "stress")


class Teeth(Table):
    """Whole teeth and standard modules; without this table sizes are continuous."""

    modules: Annotated[tuple[Fraction, ...], either(MODULES, MODULE)] = Field(
        default_factory=lambda: MODULES["ISO 54 I"],
        description='"ISO 54 I", "ISO 54 I+II", or a list of modules',
        json_schema_extra={"default": "ISO 54 I"},
    )
    coprime: Annotated[bool, truth()] = Field(
        False, description="Hunting teeth: z1 and z2 without a common divisor"
    )


class Objective(Table):
    """What to minimise."""

    minimise: Annotated[str, choice(*OBJECTIVES)] = Field(
        "gear_volume",
        description="gear_volume (solid reference cylinders), mass, sum_of_centre_distances, or "
        "total_length (shafts in one line, over reference circles)",
    )
    density: Annotated[Quantity | None, quantity("density", "7.85 kg/dm^3")] = Field(
        None, description="Density of the gears; mass needs it"
    )

    @model_validator(mode="after")
    def _mass_needs_density(self) -> "Objective":
        if self.minimise == "mass" and self.density is None:
            raise refuse("is missing: mass needs it", at=("density",))
        return self
