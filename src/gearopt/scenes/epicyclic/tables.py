"""The tables of a file of kind epicyclic, and what they ask in plain numbers."""

from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field, model_validator

from gearopt.formulations.epicyclic.request import (
    COUPLED,
    ERROR,
    GEARS,
    LOSS,
    RING,
    SIMPLE,
    STEPPED,
    WOLFROM,
    Request,
)
from gearopt.physics.planetary.willis import Use, ratio_parts
from gearopt.scenes.reading.fields import (
    ProblemFile,
    Reads,
    Table,
    choice,
    number,
    refuse,
    speed_ratio,
    whole,
)
from gearopt.scenes.reading.lists import pair, several, span

MIN_TEETH, MAX_TEETH, MAX_PLANETS, MAX_SHIFTED = 4, 600, 12, 6
SETS = {  # of every arrangement: sun, ring, carrier
    SIMPLE: (("sun", "ring", "carrier"),),
    STEPPED: (("sun", "ring", "carrier"),),
    WOLFROM: (("sun", "ring1", "carrier"), ("sun", "ring2", "carrier")),
    COUPLED: (("sun1", "ring1", "carrier1"), ("sun2", "ring2", "carrier2")),
}
MEMBER = choice(*dict.fromkeys(n for sets in SETS.values() for names in sets for n in names))
Range = Annotated[
    tuple[int, int] | None, span(whole(20, MIN_TEETH, MAX_TEETH), [17, 60], single=True)
]
JOINED = pair(MEMBER, "two members that turn together", ["ring1", "carrier2"])
ETA = number(0.99, Fraction(1, 2), 1)
SAMPLES = ([(17, 60), (23, 71)], [(31, 79), (19, 97)])  # teeth by which a coupling is tried


def _signed_ratio() -> Reads:
    """Read a ratio of speeds of either sign, exactly."""
    item = speed_ratio(5, 0)

    def read(value: Any, example: Any) -> Fraction:
        if isinstance(value, Fraction):
            return value
        if isinstance(value, str | int | Decimal) and (text := str(value).strip())[:1] == "-":
            return -Fraction(item.reader(text[1:] if isinstance(value, str) else -value, example))
        if value == 0 and not isinstance(value, bool):
            raise refuse("is 0: the input would stand still")
        return Fraction(item.reader(value, example))

    text = {"type": "string", "pattern": r"^\s*-?\s*[0-9]+\s*/\s*[0-9]+\s*$"}
    return Reads(read, 5, {"anyOf": [{"type": "number"}, text]})


class Train(Table):
    """The train: which members there are, which are used, and how many planets."""

    arrangement: Annotated[str, choice(SIMPLE, STEPPED, WOLFROM, COUPLED)] = Field(
        description="simple: sun, planets, ring, carrier; stepped: planets of two steps, the sun "
        "on planet1, the ring on planet2; wolfrom: two rings, ring1 and the sun on planet1, ring2 "
        "on planet2 (3K); coupled: two simple sets with members joined"
    )
    planets: Annotated[int, whole(3, 2, MAX_PLANETS)] = Field(
        3, description="Number of planets, of coupled sets those of the first"
    )
    planets2: Annotated[int | None, whole(3, 2, MAX_PLANETS)] = Field(
        None, description="Planets of the second of two coupled sets; planets without it"
    )
    ratio: Annotated[Fraction | None, _signed_ratio()] = Field(
        None,
        description="Ratio to come near to, input over output speed, exactly as written, also as a "
        'fraction "-80/21"; below 0 where they turn against each other. Without it teeth are '
        "given, or chosen by the objective alone",
    )
    joined: Annotated[tuple[tuple[str, str], ...], several(JOINED, [["ring1", "carrier2"]])] = (
        Field((), description="Members of coupled sets that turn together, in pairs")
    )
    fixed: Annotated[tuple[str, ...], several(MEMBER, "ring", single=True)] = Field(
        description="Member, or members, that stand still"
    )
    input: Annotated[str, MEMBER] = Field(description="Member that is driven")
    output: Annotated[str, MEMBER] = Field(description="Member that drives the load")
    spacing: Annotated[str, choice("equal", "nearest")] = Field(
        "equal",
        description="equal: planets are spaced equally, which few numbers of teeth allow; nearest: "
        "at the nearest places that teeth have",
    )
    module_ratio: Annotated[Fraction | None, number(0.8, Fraction(1, 10), 10, fraction=True)] = (
        Field(
            None,
            description="Module of the second step (planet2 and its ring) over that of the first; "
            "1 without it",
        )
    )


class Teeth(Table):
    """Numbers of teeth: of every gear of the arrangement a range, or one number."""

    sun: Range = Field(None, description="Teeth of the sun")
    planet: Range = Field(None, description="Teeth of the planets of a simple set")
    ring: Range = Field(None, description="Teeth of the ring")
    sun1: Range = Field(None, description="Teeth of the first sun of coupled sets")
    planet1: Range = Field(None, description="Teeth of the first step, or planets of the first set")
    ring1: Range = Field(None, description="Teeth of the first ring")
    sun2: Range = Field(None, description="Teeth of the second sun of coupled sets")
    planet2: Range = Field(None, description="Teeth of the second step, or of the second planets")
    ring2: Range = Field(None, description="Teeth of the second ring")


class Efficiency(Table):
    """Efficiency of one mesh in the frame of its carrier, whichever gear drives."""

    sun: Annotated[Fraction, ETA] = Field(
        Fraction(99, 100), description="Sun and planet", json_schema_extra={"default": 0.99}
    )
    ring: Annotated[Fraction, ETA] = Field(
        Fraction(995, 1000), description="Planet and ring", json_schema_extra={"default": 0.995}
    )


class Limits(Table):
    """What every train must meet, beside the assembly of its planets."""

    ratio_tolerance: Annotated[Fraction | None, number("1 %", 0, Fraction(1, 2), percent=True)] = (
        Field(None, description="Largest relative error of the ratio")
    )
    minimum_efficiency: Annotated[Fraction | None, number(0.9, 0, 1)] = Field(
        None, description="Least efficiency of the train"
    )
    ring_minus_planet: Annotated[int, whole(10, 1, 100)] = Field(
        10,
        description="Least difference of teeth of a ring and its planets; 10 is a rule of thumb "
        "against interference of tips for 20 deg and full teeth (unverified)",
    )
    neighbour_clearance: Annotated[Fraction, number(0.5, 0, 50, zero=True)] = Field(
        Fraction(1, 2),
        description="Least gap between tip circles of neighbouring planets, in modules, of an "
        "addendum of one module",
        json_schema_extra={"default": 0.5},
    )
    coaxial_difference: Annotated[int, whole(0, 0, MAX_SHIFTED)] = Field(
        0,
        description="Teeth by which sun + planet and ring - planet may differ, for profile shifts "
        "to make up; 0: centre distances are equal without shifts",
    )


class Aim(Table):
    """What to minimise."""

    minimise: Annotated[str, choice(ERROR, LOSS, RING)] = Field(
        ERROR,
        description="ratio_error: |achieved/asked - 1|; loss: 1 - efficiency; ring_teeth: those of "
        "the larger ring. By default ratio_error, without a ratio ring_teeth",
    )


class Scene(ProblemFile):
    """A planetary train."""

    train: Train
    teeth: Teeth
    efficiency: Efficiency = Field(default_factory=Efficiency)
    limits: Limits = Field(default_factory=Limits)
    objective: Aim | None = None

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        gears, kind = GEARS[self.train.arrangement], self.train.arrangement
        for name in Teeth.model_fields:
            given = getattr(self.teeth, name) is not None
            if given and name not in gears:
                rule = f"is no gear of a {kind} train, which has {', '.join(gears)}"
                raise refuse(rule, at=("teeth", name), action="remove")
            if not given and name in gears:
                raise refuse("is missing", at=("teeth", name))
        for place, rule in self._idle():
            raise refuse(rule, at=place, action="remove")
        if self.goal == ERROR and self.train.ratio is None:
            raise refuse("is missing: ratio_error is its error", at=("train", "ratio"))
        if self.goal != ERROR and self.train.ratio and self.limits.ratio_tolerance is None:
            rule = f"is missing: {self.goal} is minimised within it"
            raise refuse(rule, at=("limits", "ratio_tolerance"))
        self._check_use()
        return self

    def _idle(self) -> Iterator[tuple[tuple[str, str], str]]:
        """Keys that change nothing, with the reason."""
        train = self.train
        for key in ("planets2", "joined"):
            if getattr(train, key) and train.arrangement != COUPLED:
                yield ("train", key), "is of coupled sets"
        if train.arrangement in (SIMPLE, COUPLED) and train.module_ratio is not None:
            yield ("train", "module_ratio"), "is of planets with two steps"
        if train.ratio is None and self.limits.ratio_tolerance is not None:
            yield ("limits", "ratio_tolerance"), "is that of a ratio, and none is asked"

    def _check_use(self) -> None:
        """Check that the members named are there, each used once, and that power can flow."""
        train, use = self.train, self.use
        members = {n for names in SETS[train.arrangement] for n in names}
        usable = members - {"carrier"} if train.arrangement == WOLFROM else members
        listed = [("fixed", n) for n in train.fixed]
        for key, name in (*listed, ("input", train.input), ("output", train.output)):
            if name not in usable:
                rule = f"names {name}; members are {', '.join(sorted(usable))}"
                raise refuse(rule, at=("train", key))
        for two in train.joined:
            if not members.issuperset(two) or two[0][-1] == two[1][-1]:
                rule = f"joins {' and '.join(two)}, which are not of two sets"
                raise refuse(rule, at=("train", "joined"))
        taken = [use.source, use.sink, *use.held]
        if len({*taken}) < len(taken):
            raise refuse("is used twice: input, output and fixed differ", at=("train", "fixed"))
        if len(use.names) != len(taken) + len(use.sets) - 1:
            rule = "is not as many as there must be"
            way = "Fix one member; of coupled sets joined pairs and fixed members are three in all"
            raise refuse(rule, way, ("train", "fixed"), "tell")
        if all(0 in ratio_parts(use, teeth[: len(use.sets)]) for teeth in SAMPLES):
            raise refuse("does not turn with the input, or locks it", at=("train", "output"))

    @property
    def goal(self) -> str:
        """What is minimised."""
        if self.objective is not None:
            return self.objective.minimise
        return RING if self.train.ratio is None else ERROR

    @property
    def use(self) -> Use:
        """Sets with their joined members, and who does what."""
        train, sets = self.train, SETS[self.train.arrangement]
        same: dict[str, str] = {}
        for two in train.joined:
            first, second = (same.get(name, name) for name in two)
            same |= {name: first for name in (second, *(n for n in same if same[n] == second))}
        held = tuple(same.get(name, name) for name in train.fixed)
        source, sink = (same.get(name, name) for name in (train.input, train.output))
        renamed = tuple((same.get(a, a), same.get(b, b), same.get(c, c)) for a, b, c in sets)
        return Use(renamed, source, sink, held, train.arrangement == WOLFROM)

    def request(self) -> Request:
        """The file in plain numbers."""
        train, eta, limits = self.train, self.efficiency, self.limits
        second = (train.planets2 or train.planets,) if train.arrangement == COUPLED else ()
        return Request(
            train.arrangement,
            self.use,
            tuple(getattr(self.teeth, name) for name in GEARS[train.arrangement]),
            (train.planets, *second),
            ((eta.sun, eta.ring),) * len(SETS[train.arrangement]),
            self.goal,
            train.ratio,
            limits.ratio_tolerance,
            limits.minimum_efficiency,
            limits.ring_minus_planet,
            limits.neighbour_clearance,
            limits.coaxial_difference,
            train.spacing == "equal",
            train.module_ratio or Fraction(1),
        )
