"""[[mesh]] and [accuracy], [tolerances], [[cost]] and [[budget]]: the error of a servo train.

Where it comes from, how large it may be, and the same deviations reallocated at minimum cost.
"""

from fractions import Fraction
from functools import cache
from typing import Annotated, Any, get_args

from pydantic import Field, model_validator

from gearopt import units
from gearopt.formulations.servo.tolerance.stack import RUN_OUT, UNIFORM, Distribution, Rule
from gearopt.frozen import dataclass
from gearopt.physics.backlash import (
    backlash_angle,
    pitch_error_angle,
    play_backlash,
    radial_backlash,
    thickness_backlash,
)
from gearopt.physics.gears import GearPair
from gearopt.physics.tolerances import SCOPE, total_pitch_tolerance
from gearopt.scenes.reading.allowances import allowances
from gearopt.scenes.reading.fields import Table, choice, number, quantity, refuse, whole
from gearopt.units import Quantity

RADIAL = {  # key -> words; one-sided radial displacements
    "pinion_reading": "test radius of pinion",
    "wheel_reading": "test radius of wheel",
    "centre_distance": "centre distance of stage",
    "pinion_bearing_clearance": "bearing clearance of pinion",
    "wheel_bearing_clearance": "bearing clearance of wheel",
    "pinion_bearing_run_out": "bearing run-out of pinion",
    "wheel_bearing_run_out": "bearing run-out of wheel",
}
PLAY = {  # in which an axis follows the force of the teeth
    "pinion_bearing_fit": "bearing fit of pinion",
    "wheel_bearing_fit": "bearing fit of wheel",
}
THICKNESS = {
    "pinion_thickness": "tooth thickness of pinion",
    "wheel_thickness": "tooth thickness of wheel",
}
PITCH = {
    "pitch": "pitch of stage",
    "pinion_pitch": "pitch of pinion",
    "wheel_pitch": "pitch of wheel",
}
WORDS = RADIAL | PLAY | THICKNESS | PITCH
LARGEST_FACTOR = Fraction(1000)  # of a cost and of a factor
GEARS = ("module", "pinion_teeth", "wheel_teeth")

TWO_SIDED = ("centre_distance", *THICKNESS)  # keys that may be two allowances

Deviation = Annotated[Quantity | None, quantity("length", "0.018 mm", zero=True)]
Allowance = Annotated[Quantity | tuple[Quantity, Quantity] | None, allowances("0.018 mm")]


def _deviation(description: str) -> Quantity | None:
    field: Quantity | None = Field(None, description=description)
    return field


@dataclass(frozen=True)
class Source:
    """One deviation of a mesh, which opens it by start to start + tolerance [mm].

    key: of its [[mesh]]. per_mm: angle [rad] at a wheel of diameter 1 mm and 1 mm of deviation.
    kind: backlash or pitch. start: of a two-sided deviation, 0 for others; below 0 it closes.
    """

    name: str
    key: str
    kind: str
    stage: int
    tolerance: float
    per_mm: float
    law: Distribution
    start: float = 0.0

    @property
    def most(self) -> float:
        """Return by how much it opens the mesh at most [mm]."""
        return self.start + self.tolerance


class Mesh(Table):
    """The deviations of a gear pair, one table per stage, from the motor on; all count at once.

    Radial deviations open the backlash 2 tan(alpha) times, thinner teeth once, loose fits are lost
    motion 2/cos(alpha) times. With module, pinion_teeth and wheel_teeth the gears are given: beside
    [train] they are compared with the best ones, without it tolerances are for them.
    """

    module: Annotated[Quantity | None, quantity("module", "0.5 mm")] = Field(
        None, description="Module of given gears"
    )
    pinion_teeth: Annotated[int | None, whole(20, 12, 1000)] = Field(
        None, description="Teeth of a given pinion"
    )
    wheel_teeth: Annotated[int | None, whole(120, 12, 1000)] = Field(
        None, description="Teeth of a given wheel"
    )
    pinion_reading: Deviation = _deviation(
        "Maximum deviation of the pinion's test radius below nominal"
    )
    wheel_reading: Deviation = _deviation(
        "Maximum deviation of the wheel's test radius below nominal"
    )
    centre_distance: Allowance = _deviation(
        "Maximum deviation of the centre distance above nominal; or both allowances, as "
        '"+0.02/-0.01 mm" or ["-0.01 mm", "0.02 mm"]'
    )
    pinion_bearing_clearance: Deviation = _deviation(
        "Half the radial clearance of the pinion's bearings"
    )
    wheel_bearing_clearance: Deviation = _deviation(
        "Half the radial clearance of the wheel's bearings"
    )
    pinion_bearing_run_out: Deviation = _deviation("Half the run-out of the pinion's bearings")
    wheel_bearing_run_out: Deviation = _deviation("Half the run-out of the wheel's bearings")
    pinion_bearing_fit: Deviation = _deviation(
        "Half the largest clearance of the fits of the pinion's bearings, of shaft and housing "
        "together, in which its axis follows the force of the teeth"
    )
    wheel_bearing_fit: Deviation = _deviation(
        "Half the largest clearance of the fits of the wheel's bearings, likewise"
    )
    pinion_thickness: Allowance = _deviation(
        "Maximum deviation of the pinion's tooth thickness below nominal (lower allowance); "
        'or both, as "-0.02/-0.05 mm"'
    )
    wheel_thickness: Allowance = _deviation(
        "Maximum deviation of the wheel's tooth thickness below nominal (lower allowance); "
        'or both, as "-0.02/-0.05 mm"'
    )
    pitch: Deviation = _deviation("Cumulative pitch deviation of the pair (or one per gear)")
    pinion_pitch: Deviation = _deviation("Cumulative pitch deviation of the pinion")
    wheel_pitch: Deviation = _deviation("Cumulative pitch deviation of the wheel")
    grade: Annotated[Fraction | None, number(7, 1, 11, scale=True)] = Field(
        None,
        description="Grade of ISO 1328-1 of both given gears, instead of pitch deviations; not "
        "beside [train]",
    )

    minimum_backlash: Annotated[Quantity | None, quantity("length", "0.005 mm")] = Field(
        None,
        description="Minimum circumferential backlash, whatever deviations within tolerance come "
        "together, so that the gears never bind",
    )

    @model_validator(mode="after")
    def _complete(self) -> "Mesh":
        for name in GEARS:
            if self.given and getattr(self, name) is None:
                raise refuse("is missing: gears are given by module and teeth", at=(name,))
        if self.given and int(self.wheel_teeth or 0) < int(self.pinion_teeth or 0):
            rule = "is below pinion_teeth: a train from motor to load reduces the speed"
            raise refuse(rule, "pinion_teeth", ("wheel_teeth",), "swap")
        for name in PITCH:
            if self.grade is not None and getattr(self, name) is not None:
                raise refuse("conflicts with grade, which sets it", at=(name,), action="remove")
        if self.grade is not None:
            self._check_scope()
        for name in ("pinion_pitch", "wheel_pitch"):
            if self.pitch is not None and getattr(self, name) is not None:
                raise refuse("conflicts with pitch", at=(name,), action="remove")
        if not (self.given or self.deviates):
            raise refuse("is missing, as is any deviation", at=("pitch",))
        return self

    def _check_scope(self) -> None:
        """Check that the gears are in the scope of ISO 1328-1, which forbids extrapolation."""
        if not self.given:
            rule = "needs given gears: it depends on their diameters"
            raise refuse(rule, at=("grade",), action="remove")
        low, high = SCOPE["module"]
        assert self.module is not None
        if not low <= self.module.value <= high:
            rule = f"is outside the scope of ISO 1328-1 ({low:g} to {high:g} mm), which grade needs"
            raise refuse(rule, at=("module",))
        if self.pair().pinion.reference_diameter < SCOPE["diameter"][0]:
            rule = "makes a diameter below 5 mm, outside the scope of ISO 1328-1"
            raise refuse(rule, f"{5.0 / int(self.pinion_teeth or 1) + 0.05:.1f} mm", ("module",))

    def _length(self, name: str) -> float:
        low, high = self.opening(name)
        return high - low

    def opening(self, name: str) -> tuple[float, float]:
        """Return the ends of a deviation [mm], in the direction that opens the mesh."""
        return opening(getattr(self, name), name in THICKNESS)

    @property
    def deviates(self) -> bool:
        """Return whether any deviation is given."""
        return self.grade is not None or any(self._length(name) for name in WORDS)

    @property
    def two_sided(self) -> bool:
        """Return whether a deviation has a lower and an upper allowance."""
        return any(isinstance(getattr(self, name), tuple) for name in TWO_SIDED)

    @property
    def given(self) -> bool:
        """Return whether the gears are given."""
        return any(getattr(self, name) is not None for name in GEARS)

    def pair(self, face_width: float = 1.0) -> GearPair:
        """Return the gear pair that is given; face_width [mm]."""
        assert self.module is not None
        teeth = int(self.pinion_teeth or 0), int(self.wheel_teeth or 0)
        return GearPair.of_teeth(self.module.value, *teeth, face_width)

    def sources(self, stage: int, pressure_angle: float) -> tuple[Source, ...]:
        """Return the deviations above zero of a stage (from 1); pressure_angle [rad]."""
        laws, sources = angles_per_mm(pressure_angle), []
        for name, words in WORDS.items():
            tolerance = self._tolerance(name)
            if tolerance <= 0.0:
                continue
            kind = "pitch" if name in PITCH else "backlash"
            law = RUN_OUT if name.endswith("run_out") else UNIFORM
            deviation = f"{words} {stage}", name, kind, stage, tolerance, laws[name], law
            sources.append(Source(*deviation, start=self.opening(name)[0]))
        return tuple(sources)

    def _tolerance(self, name: str) -> float:
        if self.grade is None or name not in ("pinion_pitch", "wheel_pitch"):
            return self._length(name)
        gear = self.pair().gears[("pinion_pitch", "wheel_pitch").index(name)]
        diameter, module = gear.reference_diameter, gear.normal_module
        return float(total_pitch_tolerance(diameter, module, float(self.grade)))


def opening(deviation: Any, thinner: bool = True) -> tuple[float, float]:
    """Return the ends of a deviation [mm], in the direction that opens the mesh; 0 without one.

    thinner: whether the allowances of two are of a tooth thickness, which opens it below 0.
    """
    if not isinstance(deviation, tuple):
        return 0.0, 0.0 if deviation is None else float(deviation.value)
    low, high = (float(end.value) for end in deviation)
    return (-high, -low) if thinner else (low, high)


@cache
def angles_per_mm(pressure_angle: float) -> dict[str, float]:
    """Angles [rad] of a gear of 1 mm by 1 mm of every deviation; pressure_angle [rad]."""
    radial = backlash_angle(radial_backlash(1.0, pressure_angle), 1.0)
    thickness = backlash_angle(thickness_backlash(-1.0, 0.0, 0.0, pressure_angle), 1.0)
    play = backlash_angle(play_backlash(1.0, pressure_angle), 1.0)
    pitch = pitch_error_angle(1.0, 1.0)
    each = ((RADIAL, radial), (PLAY, play), (THICKNESS, thickness), (PITCH, pitch))
    return {name: float(angle) for names, angle in each for name in names}


class Accuracy(Table):
    """How far the output may be off, whatever deviations within tolerance come together."""

    error: Annotated[Quantity | None, quantity("angle", "0.1082 deg", limit="90 deg")] = Field(
        None,
        description="Maximum error of the output, both flanks; without it the error is shown, not "
        "limited",
    )
    pressure_angle: Annotated[Quantity, quantity("angle", "20 deg", limit="45 deg")] = Field(
        default_factory=lambda: units.parse("20 deg", "angle"),
        description="Pressure angle",
        json_schema_extra={"default": "20 deg"},
    )


class Tolerances(Table):
    """Every deviation of [[mesh]] as a tolerance, at minimum total cost."""

    exponent: Annotated[Fraction, number(1, 0, 4)] = Field(
        default_factory=lambda: Fraction(1),
        description="Cost (old/new)^exponent of a tolerance",
        json_schema_extra={"default": 1},
    )
    pitch_cost: Annotated[Fraction, number(2, 0, LARGEST_FACTOR)] = Field(
        default_factory=lambda: Fraction(1),
        description="Cost of a pitch deviation at its old value; every other deviation costs 1",
        json_schema_extra={"default": 1},
    )
    least_factor: Annotated[Fraction | None, number(0.25, 0, 1)] = Field(
        None, description="Minimum of every tolerance, as a factor of its old value"
    )
    largest_factor: Annotated[Fraction | None, number(4, 1, LARGEST_FACTOR)] = Field(
        None, description="Maximum of every tolerance, as a factor of its old value"
    )
    grades: Annotated[int | None, whole(4, 1, 8)] = Field(
        None,
        description="Choose among grades that differ by a factor of sqrt(2): this many finer and "
        "coarser ones than the old value",
    )
    seed: Annotated[int, whole(0, 0, 10**9)] = Field(
        0, description="Seed of the Monte Carlo errors that show what the tolerances give"
    )

    @model_validator(mode="after")
    def _one(self) -> "Tolerances":
        for name in ("least_factor", "largest_factor"):
            if self.grades is not None and getattr(self, name) is not None:
                raise refuse("conflicts with grades, which sets it", at=(name,), action="remove")
        return self


class CostTable(Table):
    """The cost of one deviation, where it differs from [tolerances]; one table per deviation."""

    deviation: Annotated[str, choice(*WORDS)] = Field(
        description="The deviation, as [[mesh]] calls it"
    )
    stage: Annotated[int | None, whole(1, 1, 2)] = Field(
        None, description="Its stage, from the motor on; without it that of both"
    )
    cost: Annotated[Fraction | None, number(2, 0, LARGEST_FACTOR)] = Field(
        None, description="Its cost at the old value, instead of 1 or pitch_cost"
    )
    exponent: Annotated[Fraction | None, number(0.5, 0, 4)] = Field(
        None, description="Its exponent, instead of that of [tolerances]"
    )

    @model_validator(mode="after")
    def _says_something(self) -> "CostTable":
        if self.cost is None and self.exponent is None:
            raise refuse("is missing, as is exponent: the table says nothing", at=("cost",))
        return self

    def meets(self, source: Source) -> bool:
        """Return whether this table is about a deviation."""
        return source.key == self.deviation and self.stage in (None, source.stage)


def check_costs(costs: tuple[CostTable, ...], sources: tuple[Source, ...]) -> None:
    """Check that each [[cost]] is about deviations of the file that no other one is about."""
    seen: set[str] = set()
    for k, table in enumerate(costs):
        names = {s.name for s in sources if table.meets(s)}
        if not names:
            rule = "is about a deviation that no [[mesh]] has"
            raise refuse(rule, at=("cost", k), action="remove")
        if names & seen:
            raise refuse("repeats a deviation", at=("cost", k), action="remove")
        seen |= names


@dataclass(frozen=True)
class Price:
    """Cost of a deviation as it is, and its exponent: t costs `cost (old/t)^exponent`."""

    cost: float
    exponent: float


def price(source: Source, table: Tolerances, costs: tuple[CostTable, ...]) -> Price:
    """Cost of a deviation, by its own table where it has one."""
    cost, k = (table.pitch_cost if source.kind == "pitch" else Fraction(1)), table.exponent
    for row in costs:
        if row.meets(source):
            cost = cost if row.cost is None else row.cost
            k = k if row.exponent is None else row.exponent
    return Price(float(cost), float(k))


class BudgetTable(Table):
    """The error that the tolerances may make together; all budgets hold at once."""

    rule: Annotated[str, choice(*get_args(Rule))] = Field(
        "worst_case",
        description="worst_case: all at their limits; rss: root of the sum of squares; "
        "mean_plus_sd: mean and kappa standard deviations",
    )
    limit: Annotated[Quantity | None, quantity("angle", "0.1082 deg", limit="90 deg")] = Field(
        None,
        description="Maximum error by this rule; by default that of [accuracy], without it what "
        "the old tolerances use",
    )
    kappa: Annotated[Fraction, number(3, 0, 10, zero=True)] = Field(
        default_factory=lambda: Fraction(3),
        description="Standard deviations counted by mean_plus_sd",
        json_schema_extra={"default": 3},
    )

    @model_validator(mode="after")
    def _counted(self) -> "BudgetTable":
        if "kappa" in self.model_fields_set and self.rule != "mean_plus_sd":
            rule = f'is for rule = "mean_plus_sd", not for "{self.rule}"'
            raise refuse(rule, at=("kappa",), action="remove")
        return self
