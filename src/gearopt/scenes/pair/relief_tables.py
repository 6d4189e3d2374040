"""The table [relief]: what may be removed from the flanks, and what for."""

from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from gearopt import units
from gearopt.formulations.pair.relief.parametric import OBJECTIVES
from gearopt.scenes.pair.sharing_tables import LOADS
from gearopt.scenes.reading.fields import Table, choice, number, quantity, refuse, truth
from gearopt.scenes.reading.lists import span, word_or
from gearopt.units import Quantity

SHAPES = {"linear": 1.0, "parabolic": 2.0}  # exponents
FREE = "free"
SHAPE = word_or((*SHAPES, FREE), number(1.5, 1, 10))
AMOUNT = span(quantity("length", "30 um", "1 mm", zero=True), ["0 um", "30 um"], single=True)
LENGTH = span(number(0.6, 0, 10), [0.1, 0.8], single=True)
AIM = choice(*OBJECTIVES, means={"transmission_error": "peak_to_peak"})


def _amounts() -> tuple[Quantity, Quantity]:
    return units.parse("0 um", "length"), units.parse("30 um", "length")


class ReliefTable(Table):
    """Tip relief of both gears: its bounds, loads and objective."""

    minimise: Annotated[str, AIM] = Field(
        "peak_to_peak",
        description="peak_to_peak (of the transmission error), harmonics (root of the sum of "
        "squares of its first three), load_jump (share with which a pair of teeth comes or goes), "
        "peak_load (largest share of a pair): the worst over all loads",
    )
    loads: Annotated[tuple[Fraction, ...] | None, LOADS] = Field(
        None, description="Loads to design for, relative to [duty]; by default those of [sharing]"
    )
    shape: Annotated[str | Fraction, SHAPE] = Field(
        "linear",
        description="Shape of the relief towards the tip: linear, parabolic, an exponent of at "
        "least 1, or free: any convex shape, point by point (for peak_to_peak)",
    )
    amount: Annotated[tuple[Quantity, Quantity], AMOUNT] = Field(
        default_factory=_amounts,
        description="Amount removed at the tip of each gear, normal to the flank: a range, or one "
        "given amount",
        json_schema_extra={"default": ["0 um", "30 um"]},
    )
    length: Annotated[tuple[Fraction, Fraction] | None, LENGTH] = Field(
        None,
        description="Length of the relief along the line of action in base pitches: a range, or "
        "one; by default from 0.1 to the middle of the path",
    )

    tolerance: Annotated[Quantity | None, quantity("length", "2 um", "0.1 mm")] = Field(
        None,
        description="Tolerance of the ground amounts, up and down: the worst case is reported, "
        "proven, beside the values of gears drawn at random",
    )
    length_tolerance: Annotated[Fraction | None, number(0.02, 0, 1)] = Field(
        None, description="Tolerance of the lengths, in base pitches; by default 0"
    )
    robust: Annotated[bool, truth()] = Field(
        False, description="Minimise the worst case within the tolerance, instead of the nominal"
    )

    @property
    def free(self) -> bool:
        """Return whether the shape is chosen, too."""
        return self.shape == FREE

    @property
    def exponent(self) -> float:
        """Return the exponent of the shape."""
        return SHAPES[self.shape] if isinstance(self.shape, str) else float(self.shape)

    @property
    def given(self) -> bool:
        """Return whether amount and length are given: nothing is chosen."""
        return self.amount[0] == self.amount[1] and bool(
            self.length and self.length[0] == self.length[1]
        )

    @model_validator(mode="after")
    def _fits(self) -> "ReliefTable":
        if self.loads is not None and not any(self.loads):
            raise refuse("is no load at all", [1], ("loads",), "sample")
        self._check_tolerance()
        if self.free and self.minimise != "peak_to_peak":
            rule = "is no criterion of a free shape, which peak_to_peak alone has a search for"
            raise refuse(rule, "peak_to_peak", ("minimise",))
        if self.free and self.length is not None:
            rule = "changes nothing: a free shape has no length"
            raise refuse(rule, at=("length",), action="remove")
        if self.free and self.amount[0].number != 0:
            rule = "has an end above zero: a free shape takes off anything from nothing on"
            raise refuse(rule, ["0 um", str(self.amount[1])], ("amount",))
        return self

    def _check_tolerance(self) -> None:
        """Refuse tolerances of what has no worst case here, and what changes nothing without."""
        for name in ("length_tolerance", "robust"):
            if getattr(self, name) and self.tolerance is None:
                raise refuse("needs tolerance, that of the amounts", at=(name,), action="remove")
        if self.tolerance is not None and (self.free or self.minimise != "peak_to_peak"):
            rule = "is for the peak_to_peak of a relief by amount, length and exponent"
            raise refuse(rule, at=("tolerance",), action="remove")
        if self.robust and self.given:
            rule = "changes nothing: amount and length are given"
            raise refuse(rule, at=("robust",), action="remove")
