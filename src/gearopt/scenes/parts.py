"""Parts that kinds of gear drives share: the table [duty], and warnings of teeth."""

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import Annotated, Any, ClassVar

from pydantic import ConfigDict, Field, model_validator

from gearopt import units
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.flaws import Flaw, flaws
from gearopt.physics.loads import torque
from gearopt.scenes.reading.fields import FOLLOWS, Table, number, quantity, refuse, speed_ratio
from gearopt.units import Quantity


class Duty(Table):
    """What the drive must do."""

    RATIO_NEEDED: ClassVar[bool] = True  # a kind that does without checks it itself

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["power"]}, {"required": ["torque"]}]}
    )
    power: Annotated[Quantity | None, quantity("power", "7.5 kW")] = Field(
        None,
        description="Power at the input shaft; gears are taken as loss-free. Needed, unless torque "
        "is given",
    )
    torque: Annotated[Quantity | None, quantity("torque", "49.4 N m")] = Field(
        None, description="Torque at the input shaft, in place of power"
    )
    input_speed: Annotated[Quantity, quantity("speed", "1450 rpm"), FOLLOWS] = Field(
        description="Speed of the input shaft"
    )
    output_speed: Annotated[Quantity | None, quantity("speed", "66.5 rpm")] = Field(
        None, description="Speed of the output shaft (or give ratio)"
    )
    ratio: Annotated[Fraction | None, speed_ratio(20, Fraction(1, 10**6))] = Field(
        None,
        description="Total ratio, input over output speed, below 1 of a drive that increases the "
        'speed; also as a fraction, "127/120"',
    )
    ratio_tolerance: Annotated[Fraction, number("1 %", 0, Fraction(1, 2), True, True)] = Field(
        default_factory=lambda: Fraction(1, 100),
        description="Allowed relative deviation of the total ratio",
        json_schema_extra={"default": "1 %"},
    )

    @model_validator(mode="after")
    def _one_load(self) -> "Duty":
        if self.power is None and self.torque is None:
            raise refuse("is missing (or give torque)", at=("power",), action="sample")
        if self.power is not None and self.torque is not None:
            raise refuse("conflicts with power; one is enough", at=("torque",), action="remove")
        return self

    @model_validator(mode="after")
    def _one_ratio(self) -> "Duty":
        if self.output_speed is not None and self.ratio is not None:
            raise refuse(
                "conflicts with output_speed; one is enough", at=("ratio",), action="remove"
            )
        if not self.asks_ratio:
            if self.RATIO_NEEDED:
                raise refuse(*self.missing_ratio(), at=("output_speed",), action="sample")
            return self
        if not 1 <= 10**6 * self.total_ratio <= 10**12:
            rule = f"asks for a ratio {'above' if self.total_ratio > 1 else 'below 1 over'} 1000000"
            raise refuse(rule, self._slow(), ("output_speed",), "sample")
        return self

    def _slow(self) -> str:
        """Return an output speed that suits the input speed: a ratio of 20."""
        return f"{float(self.input_speed.number / 20):.4g} {self.input_speed.unit}"

    @property
    def load_key(self) -> str:
        """Name of the number that says what is transmitted: "power" or "torque"."""
        return "power" if self.torque is None else "torque"

    @property
    def input_torque(self) -> float:
        """Torque at the input shaft [N mm]."""
        if self.torque is not None:
            return self.torque.value
        assert self.power is not None
        return float(torque(self.power.value, self.input_speed.value))

    @property
    def input_power(self) -> float:
        """Power at the input shaft [N mm/s]."""
        if self.power is not None:
            return self.power.value
        assert self.torque is not None
        return self.torque.value * self.input_speed.value

    @property
    def asks_ratio(self) -> bool:
        """Return whether a total ratio is asked for."""
        return self.output_speed is not None or self.ratio is not None

    def missing_ratio(self) -> tuple[str, str]:
        """Return the rule for a missing ratio, and an output speed to write."""
        return "is missing (or give ratio)", self._slow()

    @property
    def total_ratio(self) -> Fraction:
        """Return input over output speed, exactly."""
        if self.ratio is not None:
            return self.ratio
        assert self.output_speed is not None
        return units.quotient(self.input_speed, self.output_speed)


def tooth_flaws(pairs: Iterable[GearPair], named: Sequence[Any] = ()) -> Iterator[Flaw]:
    """Yield the flaws of the teeth of every stage, or of its meshes; named: `MeshName` of each."""
    known = set[str]()
    for k, pair in enumerate(pairs):
        mesh = named[k] if named else None
        gears = mesh.gears if mesh and mesh.suffix else None
        for flaw in flaws(pair, f" of stage {mesh.stage if mesh else k + 1}", gears):
            if flaw.sentence not in known:  # a planet is in two meshes
                known.add(flaw.sentence)
                yield flaw


def tooth_warnings(
    pairs: Iterable[GearPair], weaker: str = "", named: Sequence[Any] = ()
) -> Iterator[str]:
    """Yield a sentence for every flaw of the teeth; weaker: follows one of undercut."""
    for flaw in tooth_flaws(pairs, named):
        yield flaw.sentence + (weaker if flaw.name == "undercut" else "")
