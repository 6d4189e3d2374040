"""Tables of a drive: stages, limits, objective, and design processes."""

from collections.abc import Callable
from fractions import Fraction
from typing import Annotated, Any, ClassVar, TypeVar, cast

from pydantic import Field, create_model, model_validator

from gearopt import units
from gearopt.formulations.drive.processes import ProcessOne, ProcessTwo
from gearopt.formulations.drive.train import EXTREMES, OBJECTIVES
from gearopt.formulations.strength import Law
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.physics.geometry.profile_shift import ROOT_SAFETY, RULES, Shifting
from gearopt.scenes.drive.tables.iso6336 import IsoGiven
from gearopt.scenes.drive.tables.planetary import PlanetaryKeys
from gearopt.scenes.drive.tables.rating import GearKeys, GearTable, GivenTable, ShaftTable
from gearopt.scenes.reading.choices import Between, Choice, Preferred, Steps, to_choose, values_of
from gearopt.scenes.reading.fields import (
    Table,
    advised,
    choice,
    number,
    quantity,
    refuse,
    speed_ratio,
    truth,
    whole,
)
from gearopt.scenes.reading.linked_files import takes_gears
from gearopt.scenes.reading.lists import several, span
from gearopt.scenes.reading.module_series import MODULE, SERIES, series
from gearopt.units import Quantity

LAW = K_FACTOR  # that limits a drive
LENGTH = quantity("length", "400 mm")
STEP = quantity("length", "1 mm")
DISTANCES = to_choose(
    LENGTH, Preferred("R20", units.parse("100 mm", "length"), units.parse("200 mm", "length"))
)
ONE_HELIX = quantity("angle", "25 deg", "45 deg", zero=True)
HELIX = to_choose(
    ONE_HELIX, Steps(*(units.parse(f"{n} deg", "angle") for n in (8, 20, 1))), between=True
)
PRESSURE = quantity("angle", "20 deg", "45 deg")
TOOTH_COUNT = whole(21, 5, 1000)
WHEEL_TEETH = advised(
    whole(100, 5, 100_000),
    {r"-\d+": 'A ring has ring_teeth, above zero, in a [[stage]] of type = "internal"'},
)
PITCH = advised(
    number(10, 0, 2000),
    {r"([\d.]+) *(?:1?/in|1/inch|dp|in\^-1)": r"Write diametral_pitch = \1, without a unit"},
)
PROPORTION = span(number(0.6, 0, 10), [0.3, 0.6], single=True)
AIM = choice(
    *OBJECTIVES,
    *EXTREMES,
    means={"weight": "mass"},
    other={
        "volume": 'Write "gear_volume" for that of the gears; for that of the box minimise = '
        '"box_volume" in a table [layout]',
        "size": 'Write "gear_volume" or "total_length" for that of the gears; for that of the box '
        'minimise = "box_volume" in a table [layout]',
        "efficiency": 'Write "mesh_loss"',
        "losses": 'Write "mesh_loss"',
        "contact_ratio": 'Write "inverse_contact_ratio": its least is the largest contact ratio',
        "sliding": 'Write "specific_sliding"',
        "centre_distance": 'Write "sum_of_centre_distances", of all stages',
    },
)
OVER_MODULE = span(number(10, 0, 1000), [8, 14])
RATIOS = span(speed_ratio(5, 1), [1, 10])

Proportion = Annotated[tuple[Fraction, Fraction] | None, PROPORTION]
Ratios = Annotated[tuple[Fraction, Fraction] | None, RATIOS]
OverModule = Annotated[tuple[Fraction, Fraction] | None, OVER_MODULE]
Length = Annotated[Quantity | None, LENGTH]
Step = Annotated[Quantity | None, STEP]
Excess = Annotated[Quantity | None, quantity("length", "5 mm", "1 m", zero=True)]
Lengths = tuple[Quantity, Quantity]
Overlap = Annotated[Fraction | None, number(1, 0, 100)]
Force = Annotated[Quantity | None, quantity("force", "2 kN")]

PROPORTION_IS = (
    "Face width over pinion diameter b/d1: a number ties b to d1, a range leaves it free within it"
)
OVER_MODULE_IS = "Range of face width over normal module b/m_n"
LEAST_IS = "Smallest face width that a stage may have"
EXCESS_IS = (
    "By how much the pinion is wider than the wheel, which has the face width; with [rating]"
)
STEP_IS = "Face widths are whole multiples of this"
WHEEL_IS = "Largest reference diameter of a wheel"
OVERLAP_IS = "Smallest overlap ratio b sin(beta)/(pi m_n); for whole teeth that ratings limit"
AXIAL_IS = (
    "Largest axial force 2 T tan(beta)/d1 of a gear, at the torque of the duty; for whole teeth "
    "that ratings limit"
)


class Loaded(Table):
    """A table that has the limits of a strength law as its first keys."""

    LAW: ClassVar[Law]


T = TypeVar("T", bound=Loaded)


def limited_by(law: Law) -> Callable[[type[T]], type[T]]:
    """Return the decorator that gives a table the limits of a law as keys."""
    keys: dict[str, Any] = {}
    for limit in law.limits:
        dimension = next(name for name, known in units.UNITS.items() if limit.unit in known)
        value = Annotated[Quantity | None, quantity(dimension, limit.example)]
        keys[limit.name] = (value, Field(None, description=limit.meaning))
    loads = create_model("Loads", __base__=Loaded, **keys)

    def limited(table: type[T]) -> type[T]:
        inside = {"LAW": law, "__module__": table.__module__, "__doc__": table.__doc__}
        metaclass: Any = type(table)
        return cast(type[T], metaclass(table.__name__, (table, loads), inside))

    return limited


@takes_gears
class Gears(GearKeys):
    """What all stages share, and all gears that have nothing else of their own."""

    helix_angle: Annotated[Choice, HELIX] = Field(
        default_factory=lambda: units.parse("0 deg", "angle"),
        description="Helix angle at the reference cylinder; where ratings limit whole teeth also "
        'several to choose from: a list, or a range { from = "8 deg", to = "20 deg", step = '
        '"1 deg" }; of real-valued sizes all angles of a range without a step',
        json_schema_extra={"default": "0 deg"},
    )
    pressure_angle: Annotated[Quantity, PRESSURE] = Field(
        default_factory=lambda: units.parse("20 deg", "angle"),
        description="Normal pressure angle: it gives the contact ratio"
        + ("" if LAW.pressure_angle else f"; {LAW.title} do not depend on it"),
        json_schema_extra={"default": "20 deg"},
    )
    face_width_over_diameter: Proportion = Field(
        None,
        description=f"{PROPORTION_IS}; needed, here or in every [[stage]] without face_width",
    )
    face_width_step: Step = Field(None, description=STEP_IS)
    face_width_over_module: OverModule = Field(None, description=OVER_MODULE_IS)
    minimum_face_width: Length = Field(None, description=LEAST_IS)
    pinion_face_width_excess: Excess = Field(None, description=EXCESS_IS)
    same_materials: Annotated[bool, truth()] = Field(
        False,
        description="One material for the pinions of all stages and one for all wheels, of those "
        "in their materials",
    )


@limited_by(LAW)
class StageTable(Loaded, PlanetaryKeys):
    """One stage: what differs from the other tables, and what is fixed."""

    idler: Annotated[bool, truth()] = Field(
        False,
        description="The pinion is the wheel of the stage before, an idler: one gear in two meshes,"
        " whose keys are those of that wheel",
    )
    module: Annotated[Lengths | None, span(MODULE, "2 mm", single=True)] = Field(
        None, description="Normal module: fixed, or a range; or a diametral pitch in 1/in"
    )
    diametral_pitch: Annotated[Fraction | None, PITCH] = Field(
        None, description="Normal diametral pitch in 1/in, fixed, instead of module"
    )
    pinion_teeth: Annotated[tuple[int, int] | None, span(TOOTH_COUNT, 21, single=True)] = Field(
        None, description="Number of pinion teeth: fixed, or a range"
    )
    wheel_teeth: Annotated[tuple[int, int] | None, span(WHEEL_TEETH, 100, single=True)] = Field(
        None, description="Number of wheel teeth: fixed, or a range"
    )
    face_width: Annotated[Quantity | None, quantity("length", "40 mm")] = Field(
        None, description="Face width, fixed"
    )
    face_width_over_diameter: Proportion = Field(
        None,
        description=f"{PROPORTION_IS}; without face_width needed, here or in [gears]; with fixed = "
        '"sun" over the ring\'s diameter, and needed here',
    )
    face_width_step: Step = Field(None, description=STEP_IS)
    face_width_over_module: OverModule = Field(None, description=OVER_MODULE_IS)
    minimum_face_width: Length = Field(None, description=LEAST_IS)
    pinion_face_width_excess: Excess = Field(None, description=EXCESS_IS)
    stage_ratio: Ratios = Field(None, description="Range of the stage's ratio")
    wheel_diameter: Length = Field(None, description=WHEEL_IS)
    overlap_ratio: Overlap = Field(None, description=OVERLAP_IS)
    axial_force: Force = Field(None, description=AXIAL_IS)
    helix_angle: Annotated[Choice | None, HELIX] = Field(
        None, description="Helix angle of this stage, or several, instead of that of [gears]"
    )
    pressure_angle: Annotated[Quantity | None, PRESSURE] = Field(
        None, description="Normal pressure angle of this stage, instead of that of [gears]"
    )
    driver: Annotated[str | None, choice("wheel", "pinion")] = Field(
        None,
        description="Gear that drives, of a stage whose gears are given; by default the pinion, "
        "the gear with fewer teeth, or the wheel where [duty] asks for a ratio below 1",
    )
    pinion_hand: Annotated[str | None, choice("right", "left")] = Field(
        None,
        description="Hand of the pinion's helix; by default right, and of later stages the one "
        "whose thrust opposes that of the other gear on the same shaft",
    )
    centre_distance: Annotated[Choice | None, DISTANCES] = Field(
        None,
        description="Working centre distance; by default without backlash. Of gears that are "
        "chosen by ratings profile shifts follow from it, see [shift]; then also several to choose "
        'from: a list, "R10", "R20" or "R40" of ISO 3, or a range { from = "100 mm", to = '
        '"200 mm", series = "R20" } or with a step',
    )
    overload_factor: Annotated[Fraction | None, number(1.25, 1, 10)] = Field(
        None, description="K_A (K_o) of this stage; by default that of [rating]"
    )
    minimum_bending_safety: Annotated[Fraction | None, number(1.2, 0, 100)] = Field(
        None, description="Required S_F of this stage; by default that of [rating]"
    )
    minimum_contact_safety: Annotated[Fraction | None, number(1.1, 0, 100)] = Field(
        None, description="Required S_H of this stage; by default that of [rating]"
    )
    shaft: ShaftTable | None = Field(None, description="Where the pinion is on its shaft")
    pinion: GearTable = Field(default_factory=GearTable, description="Data of the pinion alone")
    wheel: GearTable = Field(default_factory=GearTable, description="Data of the wheel alone")
    given: GivenTable = Field(
        default_factory=GivenTable, description="Factors of a rating, instead of computed ones"
    )
    given_iso6336: IsoGiven = Field(
        default_factory=IsoGiven,
        description="Factors of a rating by ISO 6336, instead of computed ones",
    )

    @model_validator(mode="after")
    def _one_size(self) -> "StageTable":
        if self.diametral_pitch is not None and self.module is not None:
            rule = "conflicts with module; one is enough"
            raise refuse(rule, at=("diametral_pitch",), action="remove")
        return self

    @model_validator(mode="after")
    def _bores(self) -> "StageTable":
        """Bores of gears that are given are kept, where no hub is given."""
        sizes = (self.size, self.pinion_teeth, self.wheel_teeth)
        if all(ends and ends[0] == ends[1] for ends in sizes):
            for member in ("pinion", "wheel", "sun", "planet"):
                table = getattr(self, member)
                table._kept = table.bore is not None
        return self

    @property
    def size(self) -> Lengths | None:
        """Return the ends of the range of the normal module, by whichever key."""
        if self.diametral_pitch is None:
            return self.module
        return (Quantity(self.diametral_pitch, "1/in", "module"),) * 2


# Load limits a source states for its own drive (Chong and Lee print 2.07 MPa and 48 MPa).
PRESETS = {"chong-lee-elevator": {"k_factor": "300 psi", "unit_load": "7000 psi"}}
ORIGINS = {
    "chong-lee-elevator": "300 psi (2.07 MPa) and 7000 psi (48 MPa), as Chong and Lee state them "
    "for their elevator drive"
}


@limited_by(LAW)
class Limits(Loaded):
    """Limits of every stage, unless its own table says otherwise."""

    preset: Annotated[str | None, choice(*PRESETS)] = Field(
        None,
        description="K-factor and unit load that a source states: chong-lee-elevator is 300 psi "
        "and 7000 psi. This key or the two limits are needed, unless [rating] limits the gears",
    )
    pinion_teeth: Annotated[tuple[int, int], span(TOOTH_COUNT, [20, 40])] = Field(
        description="Range of the number of pinion teeth"
    )
    wheel_teeth: Annotated[tuple[int, int] | None, span(WHEEL_TEETH, [20, 400])] = Field(
        None, description="Range of the number of wheel teeth"
    )
    module: Annotated[Lengths | None, span(MODULE, ["1 mm", "10 mm"])] = Field(
        None, description="Range of the normal module, or of diametral pitches in 1/in"
    )
    stage_ratio: Ratios = Field(
        None, description="Range of every stage's ratio (without it: 1 and up)"
    )
    wheel_diameter: Length = Field(None, description=WHEEL_IS)
    overlap_ratio: Overlap = Field(None, description=OVERLAP_IS)
    axial_force: Force = Field(None, description=AXIAL_IS)
    sum_of_centre_distances: Annotated[Lengths | None, span(LENGTH, "300 mm", single=True)] = Field(
        None,
        description="Sum of the centre distances that the stages choose from, or a range of it",
    )
    coaxial: Annotated[bool, truth()] = Field(
        False,
        description="Two stages choose one centre distance: the output in line with the input",
    )

    @classmethod
    def unlimited(cls) -> "Limits":
        """Return the limits of gears that are all given: pinion_teeth from 5 to 1000, no other."""
        return cls.model_construct(pinion_teeth=(5, 1000))

    @model_validator(mode="after")
    def _loads(self) -> "Limits":
        names = self.LAW.names
        given = [name for name in names if getattr(self, name) is not None]
        if given and self.preset is not None:
            if len(given) == len(names):
                rule = f"conflicts with {' and '.join(names)}, which are given"
                raise refuse(rule, at=("preset",), action="remove")
            rule = f"conflicts with preset, which sets {' and '.join(names)}"
            raise refuse(rule, at=(given[0],), action="remove")
        for name in names:
            if given and name not in given:
                raise refuse("is missing (or give preset)", at=(name,))
        return self

    @property
    def loaded(self) -> bool:
        """Return whether they limit the loads by the strength law: else a rating does."""
        names = ("preset", *self.LAW.names)
        return any(getattr(self, name) is not None for name in names)

    def load(self, name: str) -> Quantity:
        """Return a limit of the strength law, from the file or the preset."""
        limit: Quantity | None = getattr(self, name)
        return limit or units.parse(PRESETS[str(self.preset)][name], "stress")


PINION_SHIFT = to_choose(
    number(0.3, -1, 2, zero=True), Steps(*(Fraction(n, 10) for n in (0, 6, 1))), between=True
)


SHIFT_SUM = to_choose(
    number(0.5, Fraction(-1, 2), Fraction(3, 2), zero=True),
    Steps(*(Fraction(n, 10) for n in (0, 10, 2))),
    between=True,
)


class ShiftTable(Table):
    """How profile shifts follow from a centre distance, and what teeth may become by them."""

    rule: Annotated[str, choice(*RULES, ROOT_SAFETY)] = Field(
        Shifting.rule,
        description="Distribution of the sum: equal sliding (specific sliding at both root ends "
        "alike), equal root safety (S_F1 = S_F2 by the rating, the root nearest to equal sliding), "
        "after Roloff, after Henriot (both from memory: unverified)",
    )
    pinion_shift: Annotated[Choice | None, PINION_SHIFT] = Field(
        None,
        description="Profile shift of the pinions instead of a rule, the wheels' follow from the "
        "distance: a number, or several to choose from, a list or a range { from = 0, to = 0.6, "
        "step = 0.1 }; of real-valued sizes, without [teeth], a range without a step",
    )
    sum: Annotated[Choice | None, SHIFT_SUM] = Field(
        None,
        description="Sum x1 + x2 of stages without a given centre distance, which follows from it: "
        "a number, or several to choose from, as of pinion_shift",
    )
    tip_thickness: Annotated[Fraction, number(0.4, 0, 1)] = Field(
        Fraction(1, 5),
        description="Smallest tooth thickness at the tip, in normal modules; 0.2 is usual, 0.4 of "
        "case-hardened gears (books)",
        json_schema_extra={"default": 0.2},
    )
    contact_ratio: Annotated[Fraction, number(1.2, 1, 3)] = Field(
        Fraction(11, 10),
        description="Smallest transverse contact ratio; 1.1 to 1.2 is usual (books)",
        json_schema_extra={"default": 1.1},
    )
    specific_sliding: Annotated[Fraction, number(3, 0, 100)] = Field(
        Fraction(3),
        description="Largest specific sliding at the roots, without its sign; 3 to 4 is usual "
        "(books): ratings do not limit it",
        json_schema_extra={"default": 3},
    )

    @property
    def shifting(self) -> Shifting:
        """The rule and its limits in plain numbers."""
        thin, contact = float(self.tip_thickness), float(self.contact_ratio)
        return Shifting(self.rule, thin, contact, float(self.specific_sliding))

    @property
    def ranges(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """Ends of x1 and of x1 + x2 of real-valued sizes; None: neither a number nor a range."""
        held = self.pinion_shift, self.sum
        if not all(isinstance(value, Fraction | Between) for value in held):
            return None
        first, second = (values_of(value) for value in held if value is not None)
        return (float(first[0]), float(first[-1])), (float(second[0]), float(second[-1]))


class Teeth(Table):
    """Whole teeth and standard modules; without this table sizes are continuous."""

    modules: Annotated[tuple[Quantity, ...], series()] = Field(
        default_factory=lambda: SERIES["ISO 54 I"],
        description='"ISO 54 I", "ISO 54 I+II", or a list of modules; diametral pitches: '
        '"DP coarse", "DP fine", "DP coarse+fine", or a list in 1/in',
        json_schema_extra={"default": "ISO 54 I"},
    )
    coprime: Annotated[bool, truth()] = Field(
        False, description="Hunting teeth: z1 and z2 without a common divisor"
    )

    @property
    def sizes(self) -> tuple[Fraction, ...]:
        """Return the normal modules [mm], ascending."""
        return tuple(sorted(m.exact[0] for m in self.modules))


class Objective(Table):
    """What to minimise."""

    minimise: Annotated[str, AIM] = Field(
        "gear_volume",
        description="gear_volume (solid reference cylinders), mass (or weight), cost (of material, "
        "heat treatment and cutting, by the prices of [[material]]), "
        "sum_of_centre_distances, total_length (shafts in one line, over reference circles), "
        "mesh_loss (0.06 π (1/z1 + 1/z2) of the input power a stage, not checked against a "
        "source); of whole teeth that [rating] alone limits the largest of all stages: "
        "axial_force, specific_sliding, inverse_contact_ratio (one over the total contact ratio)",
    )
    density: Annotated[Quantity | None, quantity("density", "7.85 kg/dm^3")] = Field(
        None, description="Density of the gears; mass and cost need it, or that of every material"
    )

    @property
    def extreme(self) -> str:
        """The largest value over the stages that is minimised; "" where shares add up."""
        return self.minimise if self.minimise in EXTREMES else ""


EACH_RATIO = several(speed_ratio(5, 1), [4.96, 4.36], in_order=True)
EACH_PINION = several(TOOTH_COUNT, [23, 25], in_order=True)
EACH_MODULE = several(MODULE, ["2 mm", "3 mm"], in_order=True)

Pinions = Annotated[tuple[int, ...] | None, EACH_PINION]
Modules = Annotated[tuple[Quantity, ...] | None, EACH_MODULE]


class ProcessOneTable(Table):
    """Design by K-factor and unit load (Chong and Lee, process one), shown beside the best.

    Lists have one entry per stage.
    """

    stage_ratios: Annotated[tuple[Fraction, ...], EACH_RATIO] = Field(
        description="Ratios of the stages; wheel teeth are u z1, cut. The paper's rule for them is "
        "not known"
    )
    pinion_teeth: Pinions = Field(
        None, description="Pinion teeth, instead of those balanced between K-factor and unit load"
    )
    modules: Modules = Field(
        None, description="Normal modules, instead of the smallest that carry the load"
    )

    def check(self, stages: int, name: str) -> None:
        """Check that every list fits a drive of so many stages; places count from the file."""
        _check_lists(self, stages, name)

    def inputs(self) -> ProcessOne:
        """Return the table as plain numbers."""
        return ProcessOne(self.stage_ratios, self.pinion_teeth, _plain(self.modules))


class ProcessTwoTable(Table):
    """Design from the first centre distance (Chong and Lee, process two, after Niemann).

    It is shown beside the best. Lists have one entry per stage. Modules or pinion_teeth, or both,
    are needed; what is not given is rounded up from the centre distance.
    """

    first_centre_distance: Annotated[Quantity, quantity("length", "150 mm")] = Field(
        description="Centre distance of the first stage, before teeth or modules are rounded up"
    )
    stage_ratios: Annotated[tuple[Fraction, ...] | None, EACH_RATIO] = Field(
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
        """Check that every list fits a drive of so many stages; places count from the file."""
        _check_lists(self, stages, name)
        if self.stage_ratios is None and stages not in (2, 3):
            rule = f"is missing: Niemann's ratios are for two and three stages, not for {stages}"
            raise refuse(rule, [5] * stages, (name, "stage_ratios"), "sample")

    def inputs(self) -> ProcessTwo:
        """Return the table as plain numbers."""
        return ProcessTwo(
            self.first_centre_distance.value,
            self.stage_ratios,
            self.pinion_teeth,
            _plain(self.modules),
        )


def _check_lists(table: Table, stages: int, name: str) -> None:
    for key in ("stage_ratios", "pinion_teeth", "modules"):
        values = getattr(table, key)
        if values is not None and len(values) != stages:
            fit = [_written(v) for v in (*values, *values[-1:] * stages)[:stages]]
            rule = f"does not have one entry for each of the {stages} stages"
            raise refuse(rule, fit, (name, key), "sample")


def _written(value: Quantity | Fraction | int) -> str | float | int:
    if isinstance(value, Fraction):
        return float(value)
    return value if isinstance(value, int) else str(value)


def _plain(modules: tuple[Quantity, ...] | None) -> tuple[Fraction, ...] | None:
    return tuple(m.exact[0] for m in modules) if modules else None
