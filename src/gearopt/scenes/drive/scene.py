"""A drive's file as a whole: its tables, how they fit together, and the drive they describe."""

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import ConfigDict, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from gearopt.formulations.drive.gearbox import Gearbox
from gearopt.formulations.drive.idler import with_idler
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import Stage, Train
from gearopt.formulations.strength import RATED, Law
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.scenes.drive.described_layout import disc
from gearopt.scenes.drive.distances import joint_limits, reach, rows_together
from gearopt.scenes.drive.driving import check_driving, may_drive, ratio_of
from gearopt.scenes.drive.face_widths import check_excess, check_width, excesses, face_width
from gearopt.scenes.drive.handed_on import TAKES_DRIVE
from gearopt.scenes.drive.idlers import check_idlers, with_idlers
from gearopt.scenes.drive.places import ENDS, KEYS
from gearopt.scenes.drive.planetary import (
    check_planetary,
    check_rings,
    options,
    renamed,
    stage_with_planets,
    with_gears_named,
)
from gearopt.scenes.drive.rating.checks import (
    check_given,
    check_objective,
    check_rated,
    check_sized,
    check_unrated,
    check_unsized,
    not_given,
)
from gearopt.scenes.drive.rating.materials import MaterialTable, check_materials, check_same
from gearopt.scenes.drive.rating.options import of_stage, of_stages, required
from gearopt.scenes.drive.shifts import balanced, check_range, check_shift
from gearopt.scenes.drive.stage_types import by_type, check_types
from gearopt.scenes.drive.tables.blanks import blank, check_blanks
from gearopt.scenes.drive.tables.drawing import DrawingTable
from gearopt.scenes.drive.tables.drive import (
    Gears,
    Limits,
    Objective,
    ProcessOneTable,
    ProcessTwoTable,
    ShiftTable,
    StageTable,
    Teeth,
)
from gearopt.scenes.drive.tables.layout import (
    KeepOutTable,
    Layout,
    PlaceTable,
    check_layout,
    gearbox,
)
from gearopt.scenes.drive.tables.rating import LoadTable, RatingTable, with_shared
from gearopt.scenes.drive.toothings import (
    check_centre_distances,
    check_follows,
    check_mesh,
    check_tools,
    inclination,
    toothings,
)
from gearopt.scenes.drive.without_planets import no_limits
from gearopt.scenes.explaining.numbers import around, in_reverse
from gearopt.scenes.parts import Duty
from gearopt.scenes.reading.choices import Between, Choice, Preferred, values_of
from gearopt.scenes.reading.fields import ProblemFile, refuse, whole
from gearopt.scenes.reading.lists import span
from gearopt.units import Quantity

if TYPE_CHECKING:
    from gearopt.formulations.drive.design import DriveDesign, StageDesign

RANGE = (
    "is a range, which [[stage]] tables do not fit: write what all stages share in [gears] and "
    "[limits] instead, or one number"
)
MOST_STAGES = 6
IN_LINE = PlaceTable.model_validate({"shaft": 3, "y": "0 mm", "z": "0 mm"})  # coaxial drives
HELIX_LIMITS = ("overlap_ratio", "axial_force")
PROCESSES = ("process_one", "process_two")  # tables; as methods with a hyphen
STAGES = span(whole(2, 1, MOST_STAGES), 2, single=True)


class DriveDuty(Duty):
    """What the drive must do; gears that are all given and rated need no ratio."""

    RATIO_NEEDED = False


class Scene(ProblemFile):
    """The tables of a file of kind "drive", which are checked against each other."""

    UNRATED: ClassVar[tuple[str, ...]] = ()  # keys of gears that another kind uses without rating
    model_config = ConfigDict(
        json_schema_extra={"anyOf": [{"required": ["limits"]}, {"required": ["rating"]}]}
    )
    duty: DriveDuty
    stages: Annotated[tuple[int, int] | None, STAGES] = Field(
        None,
        description="Number of stages, or a range of which the best is found; without [[stage]] "
        "(or write one [[stage]] table per stage)",
    )
    gears: Gears = Field(default_factory=Gears)
    stage: tuple[StageTable, ...] = Field((), description="One table per stage, from the input on")
    rating: RatingTable | None = None
    material: tuple[MaterialTable, ...] = Field(
        (), description="One table per material of which gears may choose"
    )
    load: tuple[LoadTable, ...] = Field((), description="One table per level of a load spectrum")
    limits: Limits = Field(
        None,
        validate_default=True,
        description="Needed unless all gears are given and [rating] rates them",
    )
    teeth: Teeth | None = None
    shift: ShiftTable | None = None
    objective: Objective = Field(default_factory=Objective)
    drawing: DrawingTable | None = None
    layout: Layout | None = None
    place: tuple[PlaceTable, ...] = Field((), description="One table per place")
    keep_out: tuple[KeepOutTable, ...] = Field((), description="One table per keep-out")
    process_one: ProcessOneTable | None = None
    process_two: ProcessTwoTable | None = None

    @field_validator("stage")
    @classmethod
    def _idlers(cls, stages: tuple[StageTable, ...]) -> tuple[StageTable, ...]:
        """Stages whose idlers have the keys of the wheels that they are."""
        return with_gears_named(with_idlers(stages))

    @field_validator("limits", mode="wrap")
    @classmethod
    def _needed(cls, value: Any, handler: Callable[[Any], Limits], info: ValidationInfo) -> Limits:
        """Refuse a file without limits, unless it has a rating, or given gears are enough."""
        if value is None and info.data.get("rating", "wrong") is None and not cls.UNRATED:
            rule = "is missing (or, to rate given gears, write a table [rating])"
            raise refuse(rule, instead="rating")
        return Limits.unlimited() if value is None else handler(value)

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        """Refuse what tables ask against each other, with its key and what to write instead."""
        check_types(self)
        for each in by_type(self):
            try:
                each._check()
            except PydanticCustomError as wrong:
                raise renamed(each, wrong) from None
        return self

    _taken = TAKES_DRIVE

    def _check(self) -> None:
        number = len(self.stage)
        if self.stages is None and not self.stage:
            if self.gears.face_width_over_diameter is None:
                raise refuse("is missing: one table [[stage]] per stage", at=("stage",))
            raise refuse("is missing (or write one [[stage]] table per stage)", at=("stages",))
        if number > MOST_STAGES:
            rule = "is one more than the six stages allowed"
            raise refuse(rule, at=("stage", MOST_STAGES), action="remove")
        if self.stages is not None and self.stage and self.stages != (number, number):
            rule = f"differs from the {number} [[stage]] tables"
            raise refuse(RANGE if self.several else rule, number, ("stages",))
        for k, stage in enumerate(self.stage or (StageTable(),)):
            check_width(stage, self.gears, ("stage", k) if self.stage else ("gears",))
            if self.teeth is not None and not self.modules(stage):
                place = ("stage", k, "module") if stage.size else ("limits", "module")
                instead = around(stage.size or self.limits.module, self.teeth.sizes)
                raise refuse("holds no module that [teeth] allows", instead, place)
        check_driving(self)
        check_idlers(self, self._lacks("beside an idler"))
        check_planetary(self)
        check_layout(self)
        self._check_loads()
        self._check_teeth()
        self._check_blanks()
        self._check_rating()
        self._check_processes()

    @property
    def counts(self) -> tuple[int, ...]:
        """Return the numbers of stages that the drive may have, ascending."""
        number = len(self.stage)
        low, high = self.stages or (number, number)
        return tuple(range(low, high + 1))

    @property
    def stage_tables(self) -> tuple[StageTable, ...]:
        """Tables of the stages of the least number; empty ones where the file has none."""
        return self.stage or (StageTable(),) * self.counts[0]

    @property
    def several(self) -> bool:
        """Return whether the number of stages is to be chosen."""
        return len(self.counts) > 1

    @property
    def each(self) -> tuple["Scene", ...]:
        """The drives of all numbers of stages, or of all choices of their types."""
        return tuple(self.held(n) for n in self.counts) if self.several else by_type(self)

    def held(self, count: int) -> "Scene":
        """Return the drive with one number of stages."""
        return self.model_copy(update={"stages": (count, count)}) if self.several else self

    @property
    def to_size(self) -> bool:
        """Whether there is anything to size: limits, and a ratio to be met."""
        return "limits" in self.model_fields_set and self.duty.asks_ratio

    @property
    def by_ratings(self) -> bool:
        """Return whether the safety factors of [rating] limit the gears that are to be sized.

        Load limits beside them size alone what ratings cannot.
        """
        alone = self.limits.loaded and self.teeth is None and not self.rated_real
        return self.rating is not None and self.to_size and not alone

    @property
    def rated_real(self) -> bool:
        """Whether ratings can limit real-valued teeth: of one load and choice, pinions drive."""
        chosen = self.load or self.material or any(map(self.choosing, self.stage_tables))
        chosen = chosen or any(any(excesses(own, self.gears)) for own in self.stage_tables)
        return self.rating is not None and not chosen and may_drive(self) == ("pinion",)

    @property
    def law(self) -> Law:
        """Strength law that limits the loads of the gears beside ratings."""
        return RATED if self.rating is not None and not self.limits.loaded else self.limits.LAW

    def _check_processes(self) -> None:
        """Check that processes have teeth, and the lists of one number of stages."""
        for name in (name for name in PROCESSES if getattr(self, name) is not None):
            if self.teeth is None:
                raise refuse("needs a table [teeth]", at=(name,), action="remove")
            if self.several:
                rule = "is for one number of stages, and stages is a range"
                raise refuse(rule, at=(name,), action="remove")
            getattr(self, name).check(self.counts[0], name)

    def _check_loads(self) -> None:
        """Check that something limits the loads: the strength law, or a rating."""
        if self.rating is None and not self.limits.loaded and not self._enough:
            names = " and ".join(self.limits.LAW.names)
            rule = f"is missing (or give {names}, or write a table [rating], which limits gears)"
            raise refuse(rule, at=("limits", "preset"))

    @property
    def _enough(self) -> bool:
        """Return whether gears are all given, and need neither limits nor a rating."""
        return bool(self.UNRATED) and self.given

    def _check_blanks(self) -> None:
        """Check that rims, webs, bores and hubs of every gear belong together."""
        rows = []
        for k, stage in enumerate(self.stage or (StageTable(),)):
            for wider, member in zip(excesses(stage, self.gears), MEMBERS, strict=True):
                open_width = not self.given and (stage.face_width is None or wider > 0.0)
                gear = getattr(stage, member)
                table = with_shared(gear, self.gears)
                rows.append((("stage", k, member), gear, table, open_width))
        check_blanks(rows)

    def _check_rating(self) -> None:
        """Check that what is not to be sized is to be rated, and what only a rating needs."""
        sized = "limits" in self.model_fields_set or self.duty.asks_ratio
        if self.rating is not None and not sized:
            check_given(self.gears, self.stage)
        if not (self._enough or (self.given and self.rating is not None)):
            if not self.duty.asks_ratio:
                raise refuse(
                    *self.duty.missing_ratio(), at=("duty", "output_speed"), action="sample"
                )
            if "limits" not in self.model_fields_set:
                raise no_limits(self)
        if self.rating is None:
            check_unrated(self.gears, self.stage, self.load, self.material, self.UNRATED)
        else:
            places = [(("stage", k), stage) for k, stage in enumerate(self.stage)]
            check_materials(places, self.gears, self.material)
            check_same(self.gears, self.stage)
            check_rated(self.rating, self.gears, self.stage, self.load, self.material)
            check_rings(self, self.rating)
        check_objective(self.objective, self.gears, self.stage, self.material)
        if self.given and not self.to_size:
            check_unsized(self.limits.LAW, self.stage)
        if self.by_ratings:
            ruled = [n for n in PROCESSES if getattr(self, n) is not None]
            check_sized(self.law, self.limits.LAW, self.stage, ruled)

    def _check_teeth(self) -> None:
        """Check that gears have a centre distance, and that what is sought can take it."""
        aim = self.objective.minimise if "limits" in self.model_fields_set else ""
        asked = "together" if self.layout is not None and self.layout.together else ""
        asked = asked or ("process_two" if self.process_two is not None else "")
        self._check_choices()
        self._check_helix_limits()
        check_excess(self, self._lacks("with a wider pinion"))
        if not self.several:
            self._distances(self.stage_tables)
        lacks = "" if self.given else self._lacks("at a given centre distance")
        follows = asked == "together" and not self.given
        check_centre_distances(self.stage, self.gears, lacks, aim, asked, follows)
        tables = self.stage_tables
        shifted = [k for k, own in enumerate(tables) if self.shifted(own)]
        for k in shifted:
            check_follows(k, tables[k])
        lacks = "" if self.given else self._lacks("by sums of their profile shifts")
        check_shift(self, shifted, lacks, "" if follows else asked)
        check_tools(self.stage_tables, self.gears)
        for k, table in enumerate(self.stage if self.to_size else ()):  # else a rating refuses it
            if k not in shifted and not table.epicyclic:
                check_mesh(self._stage(table), k, table, self.gears)

    def _lacks(self, what: str) -> str:
        """The table that the file lacks to choose gears with such numbers; "" for none."""
        if self.teeth is None:
            return f"a table [teeth]: whole teeth are chosen {what}"
        if self.rating is None or self.limits.loaded:
            return f"limits by [rating] alone: gears are chosen by them {what}"
        return ""

    def _check_helix_limits(self) -> None:
        """Refuse limits of overlap ratio and axial force where no search keeps to them.

        Such an objective, too, which takes one number of stages.
        """
        if self.objective.extreme and self.to_size:
            several = "one number of stages" if self.several else ""
            at_once = self.layout is not None and self.layout.together
            sized = "gears that are sized before their layout (without together)" if at_once else ""
            if lacks := several or sized or self._lacks("for such an objective"):
                raise refuse(f"needs {lacks}", "gear_volume", ("objective", "minimise"))
        tables: list[tuple[Any, Limits | StageTable]] = [(("limits",), self.limits)]
        tables += [(("stage", k), own) for k, own in enumerate(self.stage)]
        for place, table in tables:
            for name in (n for n in HELIX_LIMITS if getattr(table, n) is not None):
                lacks = "gears that are to be chosen: these are all given" if self.given else ""
                lacks = lacks or self._lacks("within such a limit")
                if lacks:
                    raise refuse(f"needs {lacks}", at=(*place, name), action="remove")
        for stage in self.stage_tables if not self.several else ():
            asked = stage.overlap_ratio or self.limits.overlap_ratio
            if asked and not any(cut.helix_angle for cut in self.toothings(stage)):
                rule = "has no overlap ratio, which is asked for"
                raise refuse(rule, "15 deg", ("gears", "helix_angle"), "sample")

    def shifted(self, own: StageTable) -> bool:
        """Whether profile shifts of a pair follow from its centre distance or a sum of them."""
        if own.epicyclic:
            return False
        summed = self.shift is not None and self.shift.sum is not None
        return (own.centre_distance is not None or summed) and not self.given

    def toothings(self, own: StageTable) -> tuple[Toothing, ...]:
        """Ways in which the teeth of a stage may be cut."""
        if not self.shifted(own):
            return toothings(own, self.gears)
        ends = (0.0, 0.0) if own.centre_distance is None else reach(self, own)
        return toothings(own, self.gears, ends, self.shift or ShiftTable())

    def choosing(self, own: StageTable) -> bool:
        """Whether the teeth of a stage may be cut in several ways, or shifts are chosen."""
        several = len(self.helix_angles(own)) > 1 and not inclination(own, self.gears)
        return (
            self.shifted(own)
            and not self.shift_ranges(own)
            or several
            or own.idler
            or own.epicyclic
        )

    def shift_ranges(
        self, own: StageTable
    ) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """Ends of x1 and of x1 + x2 of a stage of real-valued sizes; None: it has no ranges."""
        if self.teeth is not None or self.shift is None or not self.shifted(own):
            return None
        return self.shift.ranges

    def helix_angles(self, own: StageTable) -> tuple[Quantity, ...]:
        """Helix angles that a stage may have."""
        return values_of(self.gears.helix_angle if own.helix_angle is None else own.helix_angle)

    def _check_choices(self) -> None:
        """Refuse several helix angles or distances where no search of whole teeth chooses them."""
        held: list[tuple[tuple[str | int, ...], Choice | None]]
        held = [(("gears", "helix_angle"), self.gears.helix_angle)]
        for k, table in enumerate(self.stage):
            held.append((("stage", k, "helix_angle"), table.helix_angle))
            held.append((("stage", k, "centre_distance"), table.centre_distance))
        for place, value in held:
            if value is None or isinstance(value, Quantity):
                continue
            if isinstance(value, Between):
                check_range(self, value, place)
                continue
            lacks = "gears that are to be chosen: these are all given" if self.given else ""
            lacks = lacks or self._lacks("with one of several values")
            if lacks:
                rule = f"has several values to choose from, which need {lacks}"
                one_fits = place[-1] != "centre_distance" or self.given
                if not one_fits or (isinstance(value, Preferred) and value.low is None):
                    raise refuse(rule, at=place, action="remove")
                raise refuse(rule, str(values_of(value)[0]), place, "sample")

    def modules(self, own: StageTable) -> tuple[Fraction, ...]:
        """Modules [mm] that a stage may have."""
        span = own.size or self.limits.module
        ends = () if span is None else tuple(end.exact[0] for end in span)
        if self.teeth is None:
            return tuple(sorted(set(ends)))
        if own.size and ends[0] == ends[1]:
            return ends[:1]
        series = self.teeth.sizes
        return tuple(m for m in series if not ends or ends[0] <= m <= ends[1])

    @property
    def given(self) -> bool:
        """Return whether teeth, modules and face widths are all given: nothing is to be sized."""
        return not any(not_given(self.gears, self.stage))

    @property
    def torque(self) -> float:
        """Torque at the input shaft [N mm]."""
        return self.duty.input_torque

    def train(self, driver: str = "") -> Train:
        """Drive in plain numbers; it has one number of stages. driver: by default the first."""
        assert not self.several
        tables, density = self.stage_tables, self.objective.density
        stages = tuple(self._stage(s) for s in tables)
        safety = (1.0, 1.0)
        if self.by_ratings:
            assert self.rating
            rated = of_stages(self.rating, tables, self.gears, self.material, self.duty, self.load)
            safety = required(self.rating)
            asked = (required(of_stage(self.rating, own)) for own in tables)
            times = ((b / safety[0], c / safety[1]) for b, c in asked)
            made = (
                options(self, own) if own.epicyclic else ways
                for own, ways in zip(tables, rated, strict=True)
            )
            rows = zip(stages, made, times, strict=True)
            stages = tuple(replace(s, options=ways, safety=more) for s, ways, more in rows)
        if tables[-1].idler:
            stages = (*stages[:-2], with_idler(*stages[-2:]))
        driver = driver or may_drive(self)[0]
        return Train(
            torque=self.torque,
            ratio=ratio_of(self.duty, driver),
            driver=driver,
            tolerance=self.duty.ratio_tolerance,
            stages=stages,
            coprime=bool(self.teeth and self.teeth.coprime),
            objective="gear_volume" if self.objective.extreme else self.objective.minimise,
            density=density.value if density else None,
            law=self.law,
            speed=self.duty.input_speed.value,
            safety=safety,
            same_option=self.gears.same_materials and self.by_ratings,
            distances=self._distances(tables),
            keys=KEYS | {"torque": f"duty.{self.duty.load_key}"} | self._keys(tables),
        )

    def _distances(self, tables: tuple[StageTable, ...]) -> tuple[tuple[float, ...], ...]:
        """Rows of centre distances [mm] that go together, of those that stages choose from."""
        if not joint_limits(self.limits):
            return ()
        lists = [
            sorted({one.exact[0] for one in values_of(own.centre_distance, reach(self, own))})
            if own.centre_distance is not None
            else []
            for own in tables
        ]
        lacks = "gears that are to be chosen: these are all given" if self.given else ""
        lacks = lacks or self._lacks("at a given centre distance")
        return rows_together(self.limits, lists, lacks)

    def _keys(self, stages: tuple[StageTable, ...]) -> dict[str, str | tuple[str, ...]]:
        """Return the places of what a stage has of its own; "" where the file has none."""

        def place(k: int, field: str, end: int | None) -> str:
            if stages[k].epicyclic and field in ("pinion_teeth", "wheel_teeth"):
                return ""  # numbers of teeth that stand for others
            if field == "module" and stages[k].diametral_pitch is not None:
                return f"stage[{k + 1}].diametral_pitch"
            tables = ("limits", self.limits), ("gears", self.gears)
            for name, table in ((f"stage[{k + 1}]", stages[k]), *tables):
                if (value := getattr(table, field, None)) is not None:
                    if end is None or value[0] == value[1]:
                        return f"{name}.{field}"
                    end = 3 - end if in_reverse(value, (field,)) else end
                    return f"{name}.{field}[{end}]"
            return f"limits.{field}" if field in self.law.names else ""  # of a preset

        ends = {name: (name, None) for name in self.law.names} | ENDS
        return {n: tuple(place(k, *ends[n]) for k in range(len(stages))) for n in ends}

    def pairs(self, design: "DriveDesign") -> tuple[Any, ...]:
        """Gear pairs of a design, with shifts, tools and centre distances of the file.

        Of planetary stages discs of their rings.
        """
        tables = self.held(len(design.stages)).stage_tables
        rows = zip(tables, design.stages, strict=True)
        return tuple(disc(stage) or self.pair(own, stage) for own, stage in rows)

    def pair(self, own: StageTable, stage: "StageDesign") -> GearPair:
        """Gear pair of a stage of a design."""
        teeth = stage.pinion_teeth, stage.wheel_teeth
        cut = self._chosen(own, stage)
        return cut.pair(stage.normal_module_mm, *teeth, stage.face_width_mm)

    def _chosen(self, own: StageTable, stage: "StageDesign") -> Toothing:
        """The toothing of a stage of a design."""

        def away(teeth: Toothing) -> float:
            distance = teeth.working_distance
            off = 0.0 if distance is None else abs(distance - stage.centre_distance_mm)
            if teeth.pinion_shift is not None:
                off += abs(teeth.pinion_shift - stage.pinion_profile_shift)
            if teeth.shift_sum is not None:
                total = stage.pinion_profile_shift + stage.wheel_profile_shift
                off += abs(teeth.shift_sum - total)
            return abs(math.degrees(teeth.helix_angle) - stage.helix_angle_deg) + off

        cut, fields = min(balanced(self, own, self.toothings(own)), key=away), {}
        if inclination(own, self.gears):
            fields["helix_angle"] = math.radians(stage.helix_angle_deg)
        if self.shift_ranges(own):
            first, second = stage.pinion_profile_shift, stage.wheel_profile_shift
            fields |= {"pinion_shift": first, "shift_sum": first + second}
        return cut.at(fields)

    @property
    def blanks(self) -> tuple[tuple[Blank, Blank], ...]:
        """Blanks of pinion and wheel of every stage."""
        return tuple(self._blanks(own) for own in self.stage_tables)

    def gearbox(self, pairs: tuple[Any, ...]) -> Gearbox:
        """Drive of gear pairs with its [layout], to be laid out."""
        assert self.layout is not None
        places = (*self.place, IN_LINE) if self.limits.coaxial else self.place
        return gearbox(self.layout, places, self.keep_out, self.torque, pairs)

    def _stage(self, own: StageTable) -> Stage:
        limits = self.limits
        diameter = own.wheel_diameter or limits.wheel_diameter
        force = own.axial_force or limits.axial_force
        made = Stage(
            allowable=tuple(
                (getattr(own, name) or limits.load(name)).value for name in self.law.names
            ),
            face_width=face_width(own, self.gears),
            modules=self.modules(own),
            pinion_teeth=own.pinion_teeth or limits.pinion_teeth,
            wheel_teeth=own.wheel_teeth or limits.wheel_teeth or (1, None),
            ratio=own.stage_ratio or limits.stage_ratio or (Fraction(1), None),
            wheel_diameter=diameter.exact[0] if diameter else None,
            toothings=balanced(self, own, self.toothings(own)),
            helix=inclination(own, self.gears),
            shifts=self.shift_ranges(own),
            blanks=self._blanks(own),
            overlap=float(own.overlap_ratio or limits.overlap_ratio or 0),
            axial_force=force.value if force else math.inf,
        )
        return stage_with_planets(self, own, made) if own.epicyclic else made

    def _blanks(self, own: StageTable) -> tuple[Blank, Blank]:
        """Return the blanks of a stage; those of planets and rings are of the ways to make it."""
        if own.epicyclic:
            return SOLID, SOLID
        pinion, wheel = (with_shared(getattr(own, m), self.gears) for m in MEMBERS)
        width = own.face_width.value if own.face_width else None
        return blank(pinion, width), blank(wheel, width)
