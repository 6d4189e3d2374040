"""A pair's file as a whole: the tables of a drive of one stage, and those of its contact."""

from fractions import Fraction
from typing import Any, ClassVar

from pydantic import Field, ValidationError, model_validator

from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.handed_on import TAKES_STAGE
from gearopt.scenes.drive.rating.checks import check_pinion, not_given
from gearopt.scenes.drive.rating.gears import given_pairs
from gearopt.scenes.drive.rating.materials import MaterialTable
from gearopt.scenes.drive.scene import DriveDuty
from gearopt.scenes.drive.scene import Scene as Drive
from gearopt.scenes.drive.tables.drawing import DrawingTable
from gearopt.scenes.drive.tables.drive import Gears, Limits, Objective, StageTable, Teeth
from gearopt.scenes.drive.tables.rating import LoadTable, RatingTable
from gearopt.scenes.pair.flank_tables import FEWEST, SLICES, FlankTable
from gearopt.scenes.pair.pair_flaws import check_level, check_pair
from gearopt.scenes.pair.relief_tables import ReliefTable
from gearopt.scenes.pair.sharing_tables import SharingTable
from gearopt.scenes.reading.choices import values_of
from gearopt.scenes.reading.fields import ProblemFile, refuse
from gearopt.scenes.reading.toml_writing import dotted

# Where a file that asks for a size says nothing: ranges that suit most spur pairs, as the example
# of a least pair by AGMA has them, whose answer lies inside.
PINION_TEETH = (18, 60)
OVER_DIAMETER = (Fraction(3, 10), Fraction(1))
OVER_MODULE = (Fraction(8), Fraction(14))
ONLY_SIZED = ("limits", "teeth", "objective")  # tables


class OneStage(Drive):
    """The drive that a pair is, for what drives are asked: sizes, ratings, checks."""

    UNRATED: ClassVar[tuple[str, ...]] = ("elastic_modulus", "poisson_ratio")


class Scene(ProblemFile):
    """A pair of gears."""

    duty: DriveDuty
    gears: Gears = Field(default_factory=Gears)
    stage: tuple[StageTable, ...] = Field(
        (), description="One table: the pair. What it leaves open is sized by [rating]"
    )
    rating: RatingTable | None = None
    material: tuple[MaterialTable, ...] = Field(
        (), description="One table per material of which gears may choose"
    )
    load: tuple[LoadTable, ...] = Field((), description="One table per level of a load spectrum")
    limits: Limits | None = Field(
        None, description="Of a pair that is sized; by default 18 to 60 pinion teeth"
    )
    teeth: Teeth | None = Field(
        None, description="Of a pair that is sized; by default with modules of ISO 54, series I"
    )
    objective: Objective = Field(default_factory=Objective)
    sharing: SharingTable = Field(default_factory=SharingTable)
    flank: FlankTable | None = None
    relief: ReliefTable | None = None
    drawing: DrawingTable | None = None

    @property
    def drive(self) -> Drive:
        """Return the pair as a drive of one stage, with the ranges that the file leaves out."""
        tables = self._tables()
        limits = tables.pop("limits", None) or Limits.unlimited()
        names = tables.keys() | ({"limits"} if limits.model_fields_set else set())
        drive: Drive = OneStage.model_construct(names, limits=limits, **tables)
        return drive

    @property
    def given(self) -> bool:
        """Return whether teeth, module and face width are all given: nothing is sized."""
        return not any(not_given(self.gears, self.stage))

    @property
    def given_pair(self) -> GearPair:
        """Gears of a pair that is given."""
        return given_pairs(self.stage, self.gears)[0]

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        if len(self.stage) > 1:
            rule = 'is a second pair: kind = "drive" has several stages'
            raise refuse(rule, at=("stage", 1), action="remove")
        self._check_slices()
        if self.given:
            self._check_only_given()
        elif self.rating is None and (self.limits is None or not self.limits.loaded):
            place = next(not_given(self.gears, self.stage))
            what = (
                "no table [[stage]] gives gears" if not self.stage else f"{dotted(place)} is open"
            )
            rule = f"is missing: {what}, and gears that are not given are sized by a rating"
            raise refuse(rule, at=("rating",))
        try:
            OneStage.model_validate(self._tables())
        except ValidationError as wrong:
            raise _first(wrong) from None
        if self.given:
            check_pinion(self.stage[0], 0)
            check_pair(self.given_pair, self.stage[0], self.gears)
            check_level(self.given_pair, self.sharing.level)
        return self

    _taken = TAKES_STAGE

    def _check_only_given(self) -> None:
        """Refuse tables of gears that are sized."""
        for name in self.model_fields_set & set(ONLY_SIZED):
            if name != "objective" or "minimise" in self.objective.model_fields_set:
                raise refuse("changes nothing: the gears are given", at=(name,), action="remove")

    @property
    def helical(self) -> bool:
        """Return whether gears are helical, or may be chosen so."""
        tables: tuple[Any, ...] = (self.gears, *self.stage)
        angles = [table.helix_angle for table in tables if table.helix_angle is not None]
        return any(angle.number for each in angles for angle in values_of(each))

    def _check_slices(self) -> None:
        """Refuse what contact by slices, of helical gears or a table [flank], does not do."""
        flank = self.flank
        if flank and flank.slices < FEWEST and (self.helical or flank.modified):
            what = "helical gears" if self.helical else "flanks that are modified along the face"
            rule = f"is too few slices for {what}, which need {FEWEST}"
            raise refuse(rule, SLICES, ("flank", "slices"))
        if self.relief is None or not (self.helical or self.flank):
            return
        of = "helical gears" if self.helical else "[flank]"
        rule = f"does not go with {of}, whose relief is that of an amount and a length"
        if self.relief.free:
            raise refuse(rule, "linear", ("relief", "shape"))
        for name in ("tolerance", "length_tolerance", "robust"):
            if getattr(self.relief, name):
                raise refuse(rule, at=("relief", name), action="remove")
        if self.relief.minimise != "peak_to_peak":
            rule = f"does not go with {of}: of these the peak_to_peak alone is minimised"
            raise refuse(rule, "peak_to_peak", ("relief", "minimise"))

    def _tables(self) -> dict[str, Any]:
        """Return the tables that a drive has, of a pair to be sized with usual ranges."""
        names = self.model_fields_set & OneStage.model_fields.keys()
        tables = {name: getattr(self, name) for name in names}
        return tables if self.given else tables | self._ranges()

    def _ranges(self) -> dict[str, Any]:
        """Return the tables of a pair that is sized, completed by usual ranges."""
        stage = self.stage[0] if self.stage else StageTable()
        open_: dict[str, Any] = {}
        gears = self.gears
        if not (
            stage.face_width or stage.face_width_over_diameter or gears.face_width_over_diameter
        ):
            open_["face_width_over_diameter"] = OVER_DIAMETER
            if not (stage.face_width_over_module or gears.face_width_over_module):
                open_["face_width_over_module"] = OVER_MODULE
        return {
            "stage": (stage.model_copy(update=open_),),
            "limits": self.limits or Limits(pinion_teeth=PINION_TEETH),
            "teeth": self.teeth or Teeth(),
        }


def _first(wrong: ValidationError) -> Exception:
    """Return the first mistake that a drive finds, as one of the pair's file."""
    error = wrong.errors(include_url=False, include_input=False)[0]
    context = error.get("ctx", {})
    place = (*error["loc"], *context.get("at", ()))
    return refuse(
        context["rule"], context["write"], place, context["action"], context.get("instead", "")
    )
