"""[tolerances] and [[budget]]: deviations of the meshes made anew, at least cost."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, get_args

from pydantic import Field, model_validator

from gearopt.formulations.servo.tolerance.stack import Rule
from gearopt.scenes.reading.fields import Table, choice, number, quantity, refuse, whole
from gearopt.scenes.servo.tables.mesh import WORDS, Source
from gearopt.units import Quantity

MOST = Fraction(1000)


class Tolerances(Table):
    """Every deviation of [[mesh]] as a tolerance, at least total cost."""

    exponent: Annotated[Fraction, number(1, 0, 4)] = Field(
        default_factory=lambda: Fraction(1),
        description="Cost (old/new)^exponent of a tolerance",
        json_schema_extra={"default": 1},
    )
    pitch_cost: Annotated[Fraction, number(2, 0, MOST)] = Field(
        default_factory=lambda: Fraction(1),
        description="Cost of a pitch deviation as it is, where every other deviation costs 1",
        json_schema_extra={"default": 1},
    )
    least_factor: Annotated[Fraction | None, number(0.25, 0, 1)] = Field(
        None, description="No tolerance below so many times its old value"
    )
    largest_factor: Annotated[Fraction | None, number(4, 1, MOST)] = Field(
        None, description="No tolerance above so many times its old value"
    )
    grades: Annotated[int | None, whole(4, 1, 8)] = Field(
        None,
        description="Choose among grades, each sqrt(2) times the finer one: so many to either side "
        "of the old value",
    )
    seed: Annotated[int, whole(0, 0, 10**9)] = Field(
        0, description="Seed of the drawn errors that show what the tolerances give"
    )

    @model_validator(mode="after")
    def _one(self) -> "Tolerances":
        for name in ("least_factor", "largest_factor"):
            if self.grades is not None and getattr(self, name) is not None:
                raise refuse("stands beside grades, which sets it", at=(name,), action="remove")
        return self


class CostTable(Table):
    """What one deviation costs, where it is not what [tolerances] says; one table a deviation."""

    deviation: Annotated[str, choice(*WORDS)] = Field(
        description="The deviation, as [[mesh]] calls it"
    )
    stage: Annotated[int | None, whole(1, 1, 2)] = Field(
        None, description="Its stage, from the motor on; without it that of both"
    )
    cost: Annotated[Fraction | None, number(2, 0, MOST)] = Field(
        None, description="Its cost as it is, instead of 1 or pitch_cost"
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
    """Return what a deviation costs, by its own table where it has one."""
    cost, k = (table.pitch_cost if source.kind == "pitch" else Fraction(1)), table.exponent
    for own in costs:
        if own.meets(source):
            cost = cost if own.cost is None else own.cost
            k = k if own.exponent is None else own.exponent
    return Price(float(cost), float(k))


class BudgetTable(Table):
    """The error that the tolerances may make together; all budgets hold at once."""

    rule: Annotated[str, choice(*get_args(Rule))] = Field(
        "worst_case",
        description="worst_case: all at their limits; rss: root of the sum of squares; "
        "mean_plus_sd: mean and kappa standard deviations",
    )
    limit: Annotated[Quantity | None, quantity("angle", "0.1082 deg", most="90 deg")] = Field(
        None,
        description="Largest error by this rule; by default that of [accuracy], without it what "
        "the old tolerances use",
    )
    kappa: Annotated[Fraction, number(3, 0, 10, zero=True)] = Field(
        default_factory=lambda: Fraction(3),
        description="Standard deviations counted by mean_plus_sd",
        json_schema_extra={"default": 3},
    )
