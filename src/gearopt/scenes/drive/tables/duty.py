"""[duty]: what a drive must do."""

from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from gearopt import units
from gearopt.scenes.reading.fields import Table, number, quantity, refuse
from gearopt.units import Quantity


class Duty(Table):
    """What the drive must do."""

    power: Annotated[Quantity, quantity("power", "7.5 kW")] = Field(
        description="Power at the input shaft; gears are taken as loss-free"
    )
    input_speed: Annotated[Quantity, quantity("speed", "1450 rpm")] = Field(
        description="Speed of the input shaft"
    )
    output_speed: Annotated[Quantity | None, quantity("speed", "66.5 rpm")] = Field(
        None, description="Speed of the output shaft (or give ratio)"
    )
    ratio: Annotated[Fraction | None, number(20, 1, 10**6)] = Field(
        None, description="Total ratio, input over output speed"
    )
    ratio_tolerance: Annotated[Fraction, number("1 %", 0, Fraction(1, 2), True, True)] = Field(
        default_factory=lambda: Fraction(1, 100),
        description="Allowed relative deviation of the total ratio",
        json_schema_extra={"default": "1 %"},
    )

    @model_validator(mode="after")
    def _one_ratio(self) -> "Duty":
        if self.output_speed is not None and self.ratio is not None:
            raise refuse(
                "stands beside output_speed; one is enough", at=("ratio",), action="remove"
            )
        if self.output_speed is None and self.ratio is None:
            raise refuse("is missing (or give ratio)", self._slow(), ("output_speed",), "sample")
        if self.total_ratio < 1:
            raise refuse(
                "is above the input speed: gearopt sizes reducers, and a loss-free speed increaser "
                "has the same gears with input and output exchanged",
                "input_speed",
                ("output_speed",),
                "swap",
            )
        if self.total_ratio > 10**6:
            raise refuse(
                "asks for a ratio above 1000000", self._slow(), ("output_speed",), "sample"
            )
        return self

    def _slow(self) -> str:
        """An output speed that suits the input speed: a ratio of 20."""
        return f"{float(self.input_speed.number / 20):.4g} {self.input_speed.unit}"

    @property
    def total_ratio(self) -> Fraction:
        """Input over output speed, exactly."""
        if self.ratio is not None:
            return self.ratio
        assert self.output_speed is not None
        return units.quotient(self.input_speed, self.output_speed)
