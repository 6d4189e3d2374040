"""The table [drawing]: by what the data of gear drawings follow."""

import re
from typing import Annotated, Any, ClassVar

from pydantic import Field

from gearopt.physics.fits import (
    GRADES,
    SERIES,
    TOLERANCES,
    distance_allowance,
    thickness_allowances,
)
from gearopt.physics.gears import Gear
from gearopt.physics.iso6336.accuracy import TOLERANCES as EDITIONS
from gearopt.scenes.reading.allowances import allowances, texts_of
from gearopt.scenes.reading.fields import Reads, Table, choice, quantity, refuse, whole
from gearopt.scenes.reading.lists import several
from gearopt.units import Quantity

_LONGEST_FIRST = "|".join(sorted(SERIES, key=len, reverse=True))
FIT = re.compile(rf"({_LONGEST_FIRST})({'|'.join(map(str, TOLERANCES))})")
NO_FIT = (
    "is neither a fit of DIN 3967, of a series a to h and a tolerance 21 to 30, nor two allowances"
)
LIMITS = allowances("0.05 mm")
FIELDS = {f"js{grade}": grade for grade in GRADES}  # of ISO 286
Allowances = tuple[Quantity, Quantity]  # lower, upper


def _fit() -> Reads:
    """Read a fit of DIN 3967 by its short name, or two allowances, none above zero."""

    def read(value: Any, example: Any) -> str | Allowances:
        if isinstance(value, tuple):
            return value  # read before
        text = re.sub(r"^(?:DIN 3967 *)?(\d\d)?([a-z]*)(\d\d)?$", r"\2\1\3", str(value).strip())
        if isinstance(value, str) and (fit := FIT.fullmatch(text)):
            return fit[0]
        if texts_of(value) is None:
            raise refuse(NO_FIT)
        low, high = LIMITS.reader(value, LIMITS.example)
        if high.number > 0:
            rule = "has an allowance above zero: teeth are thinned, not thickened"
            signs = low.number > 0 and low.unit == high.unit  # as columns of drawings have them
            if signs:
                raise refuse(rule, f"-{str(low).split()[0]}/-{high}")
            raise refuse(rule, [f"-{high}", "0 mm"] if low.number >= 0 else [str(low), "0 mm"])
        return low, high

    schema = {"anyOf": [{"type": "string"}, LIMITS.schema]}
    return Reads(read, "cd25", schema)


def _field() -> Reads:
    """Read js of a grade as it is, or two allowances of a centre distance."""

    def read(value: Any, example: Any) -> str | Allowances:
        if isinstance(value, tuple):
            return value  # read before
        if isinstance(value, str) and value.lower() in FIELDS:
            return value.lower()
        if texts_of(value) is None:
            raise refuse(f"is neither one of {', '.join(FIELDS)} nor two allowances")
        low, high = LIMITS.reader(value, LIMITS.example)
        return low, high

    return Reads(read, "js7", {"anyOf": [{"enum": list(FIELDS)}, LIMITS.schema]})


class DrawingTable(Table):
    """Data of a drawing of each gear: measures with allowances, tolerances, backlash.

    An empty table asks for them by what is usual.
    """

    ANSWERS: ClassVar[bool] = False

    allowance: Annotated[Any, _fit()] = Field(
        "cd25",
        description='Allowances of the tooth thickness: a fit of DIN 3967, or two as "-0.05/-0.09 '
        'mm"; a thickness_allowance of a gear is its upper one, with the tolerance of these',
    )
    centre_distance: Annotated[Any, _field()] = Field(
        "js7",
        description='Allowances of the centre distance: js5 to js11 of ISO 286, or two as "±0.02 '
        'mm"',
    )
    accuracy_grade: Annotated[int | None, whole(6, 0, 12, scale=True)] = Field(
        None,
        description="Accuracy grade of ISO 1328-1 of all gears; by default that of a rating by "
        "ISO 6336, else 6",
    )
    tolerances: Annotated[str | None, choice(*EDITIONS)] = Field(
        None,
        description="Edition of ISO 1328-1; by default that of a rating by ISO 6336, else 1995. "
        "No printed example of 2013 was met: unverified",
    )
    balls: Annotated[
        tuple[Quantity, ...] | None, several(quantity("length", "3 mm"), ["3 mm", "3.5 mm"])
    ] = Field(
        None,
        description="Diameters of measuring balls at hand, of which the smallest is taken that "
        "touches the flanks at d + 2 x m_n or nearer the tip; by default one of 1.728 m_n",
    )

    @property
    def fit(self) -> str:
        """By what the allowances of the tooth thickness are."""
        fit = self.allowance
        return f"DIN 3967 {fit}" if isinstance(fit, str) else f"{fit[0]} and {fit[1]}"

    @property
    def field(self) -> str:
        """By what the allowances of the centre distance are."""
        field = self.centre_distance
        return field if isinstance(field, str) else f"{field[0]} and {field[1]}"

    def thickness(self, gear: Gear) -> tuple[float, float]:
        """Upper and lower allowance [mm] of a gear; its own upper one takes the fit's place."""
        if fit := FIT.fullmatch(str(self.allowance)):
            size = abs(float(gear.reference_diameter))
            upper, lower = thickness_allowances(size, fit[1], int(fit[2]))
        else:
            lower, upper = (end.value for end in self.allowance)
        given = float(gear.thickness_allowance)
        return (given, given + lower - upper) if given else (upper, lower)

    def distance(self, distance: float) -> tuple[float, float]:
        """Lower and upper allowance [mm] of a centre distance [mm]."""
        if isinstance(self.centre_distance, str):
            above = distance_allowance(distance, FIELDS[self.centre_distance])
            return -above, above
        return self.centre_distance[0].value, self.centre_distance[1].value
