"""[process_one] and [process_two]: what the two design processes of Chong and Lee are told."""

from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from gearopt.formulations.process import ProcessOne, ProcessTwo
from gearopt.scenes.drive.tables.stages import MODULE, TOOTH_COUNT
from gearopt.scenes.reading.fields import Table, number, quantity, refuse
from gearopt.scenes.reading.lists import several
from gearopt.units import Quantity

RATIOS = several(number(5, 1, 10**6), [4.96, 4.36])
PINIONS = several(TOOTH_COUNT, [23, 25])
MODULES = several(MODULE, ["2 mm", "3 mm"])

Pinions = Annotated[tuple[int, ...] | None, PINIONS]
Modules = Annotated[tuple[Quantity, ...] | None, MODULES]


class ProcessOneTable(Table):
    """Design by K-factor and unit load (Chong and Lee, process one), shown beside the best.

    Lists have one entry a stage.
    """

    stage_ratios: Annotated[tuple[Fraction, ...], RATIOS] = Field(
        description="Ratios of the stages; wheel teeth are u z1, cut. The paper's rule for them is "
        "not known"
    )
    pinion_teeth: Pinions = Field(
        None, description="Pinion teeth, instead of those balanced between K-factor and unit load"
    )
    modules: Modules = Field(
        None, description="Normal modules, instead of the least that carry the load"
    )

    def check(self, stages: int, name: str) -> None:
        """Whether every list fits a drive of so many stages; refusals are placed below the file."""
        _check_lists(self, stages, name)

    def inputs(self) -> ProcessOne:
        """The table as plain numbers."""
        return ProcessOne(self.stage_ratios, self.pinion_teeth, _plain(self.modules))


class ProcessTwoTable(Table):
    """Design from the first centre distance (Chong and Lee, process two, after Niemann).

    It is shown beside the best. Lists have one entry a stage; modules or pinion_teeth, or both, are
    needed, and what is not given is rounded up from the centre distance.
    """

    first_centre_distance: Annotated[Quantity, quantity("length", "150 mm")] = Field(
        description="Centre distance of the first stage, before teeth or modules are rounded up"
    )
    stage_ratios: Annotated[tuple[Fraction, ...] | None, RATIOS] = Field(
        None, description="Ratios of the stages, instead of Niemann's for two and three stages"
    )
    pinion_teeth: Pinions = Field(
        None, description="Pinion teeth (or give modules); wheel teeth are u z1, cut"
    )
    modules: Modules = Field(None, description="Normal modules (or give pinion_teeth)")

    @model_validator(mode="after")
    def _complete(self) -> "ProcessTwoTable":
        if self.modules is None and self.pinion_teeth is None:
            raise refuse("is missing (or give pinion_teeth)", at=("modules",))
        return self

    def check(self, stages: int, name: str) -> None:
        """Whether every list fits a drive of so many stages; refusals are placed below the file."""
        _check_lists(self, stages, name)
        if self.stage_ratios is None and stages not in (2, 3):
            rule = f"is missing: Niemann's ratios are for two and three stages, not for {stages}"
            raise refuse(rule, [5] * stages, (name, "stage_ratios"), "sample")

    def inputs(self) -> ProcessTwo:
        """The table as plain numbers."""
        return ProcessTwo(
            self.first_centre_distance.value,
            self.stage_ratios,
            self.pinion_teeth,
            _plain(self.modules),
        )


def _check_lists(table: Table, stages: int, name: str) -> None:
    for key in ("stage_ratios", "pinion_teeth", "modules"):
        found = getattr(table, key)
        if found is not None and len(found) != stages:
            fit = [_written(v) for v in (*found, *found[-1:] * stages)[:stages]]
            rule = f"does not have one entry for each of the {stages} stages"
            raise refuse(rule, fit, (name, key), "sample")


def _written(value: Quantity | Fraction | int) -> str | float | int:
    if isinstance(value, Fraction):
        return float(value)
    return value if isinstance(value, int) else str(value)


def _plain(modules: tuple[Quantity, ...] | None) -> tuple[Fraction, ...] | None:
    return tuple(m.exact[0] for m in modules) if modules else None
