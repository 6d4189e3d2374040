"""The result of a servo axis, as its JSON names it: every quantity with its unit in the key.

A field that has a default is left out of the JSON where it holds that.
"""

import math
from collections.abc import Mapping
from dataclasses import field, fields, replace
from typing import Annotated, Any

from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown, typed, untyped

KG_M2 = 1e-3  # of a t mm2


@dataclass(frozen=True)
class Goal:
    """Measure by which trains are compared: of the train or of the motion that it is for.

    unit: of the objective. factor: from it to `shown`, the unit that is shown. key: of a
    `ListedTrain`, whose value has a title. motion: that of [duty]; empty for any train's objective.
    """

    name: str
    unit: str
    factor: float
    shown: str
    key: str
    title: str
    motion: str = ""

    @property
    def label(self) -> str:
        """Label of the objective in lists of trains."""
        return self.name.removeprefix("inverse_").replace("_", " ")

    @property
    def value_unit(self) -> str:
        """Return the unit of its `value`."""
        return "rad/s²" if self.motion == "acceleration" else self.shown

    def value(self, objective: Any) -> Any:
        """Return the value that is shown: of an inverse acceleration, the acceleration."""
        shown = self.factor * objective
        return 1.0 / shown if self.motion == "acceleration" else shown


_ACCELERATION = "load_acceleration_rad_per_s2", "load acceleration", "acceleration"
GOALS = {  # by name; kernels number goals and motions in this order
    goal.name: goal
    for goal in (
        Goal("inertia", "t mm2", KG_M2, "kg_m2", "inertia_kg_m2", "inertia at the motor"),
        Goal("mass", "kg", 1.0, "kg", "mass_kg", "mass of the gears"),
        Goal("error", "rad", math.degrees(1.0), "deg", "error_deg", "error at the output"),
        Goal("inverse_acceleration", "s2/rad", 1.0, "s2/rad", *_ACCELERATION),
        Goal("move_time", "s", 1.0, "s", "move_time_s", "move time", "move"),
        Goal("rms_torque", "N mm", 1e-3, "Nm", "rms_torque_Nm", "rms torque", "swing"),
    )
}
MOTIONS = {goal.motion: goal for goal in GOALS.values() if goal.motion}
OBJECTIVES = tuple(goal.name for goal in GOALS.values() if not goal.motion)  # of any train


@dataclass(frozen=True)
class Teeth:
    """One stage of a train, as a list of trains names it."""

    normal_module_mm: float
    pinion_teeth: int
    wheel_teeth: int


@dataclass(frozen=True)
class Stage(Teeth):
    """One stage of a train; face width, torque and Lewis stress where a file chooses the train."""

    ratio: float
    pinion_diameter_mm: float
    wheel_diameter_mm: float
    pinion_tip_diameter_mm: float
    wheel_tip_diameter_mm: float
    centre_distance_mm: float
    face_width_mm: float | None = None
    pinion_torque_Nm: float | None = None
    bending_stress_MPa: float | None = None


@dataclass(frozen=True)
class TrainDesign:
    """A train; ratio_error_percent: off a single ratio that is asked for. error: at the output.

    inertia: at the motor, and mass where a file chooses the train. sector: part of a disc that the
    last wheel is. motion_torque: peak torque at the last wheel in the motion of a duty;
    output_torque: that of the file.
    """

    stages: tuple[Stage, ...]
    ratio: float
    ratio_error_percent: float | None = None
    inertia_kg_m2: float | None = None
    mass_kg: float | None = None
    error_deg: float | None = None
    motion_torque_Nm: float | None = None
    output_torque_Nm: float | None = None
    sector: float = 1.0


@dataclass(frozen=True)
class ListedTrain:
    """A train of the list beside the chosen one, with the figures by which trains are compared.

    best_of: by what it is the best of all, empty for none.
    """

    stages: tuple[Teeth, ...]
    ratio: float
    best_of: str
    inertia_kg_m2: float
    mass_kg: float
    error_deg: float | None = None
    load_acceleration_rad_per_s2: float | None = None
    move_time_s: float | None = None
    rms_torque_Nm: float | None = None


@dataclass(frozen=True)
class StageCount:
    """A bare train of a number of stages, inertia and mass in those of a pinion."""

    stages: int
    inertia_in_pinions: float
    mass_in_pinions: float
    ratios_of_least_inertia: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Achieved:
    """Achievement of an axis at a ratio; loss_percent: worse than the best; without gears or with.

    Speed, torques and their shares where the motion knows them.
    """

    total_ratio: float
    value: float
    loss_percent: Annotated[float, Shown("worse than the best")]
    gear_inertia_kg_m2: Annotated[float | None, Shown("inertia of the train")] = None
    inertia_ratio: Annotated[float, Shown("inertia ratio, load to motor")]
    motor_speed_rpm: Annotated[float | None, Shown("maximum motor speed")] = None
    motor_speed_used_percent: Annotated[float | None, Shown("motor speed used")] = None
    motor_torque_used_percent: Annotated[float | None, Shown("motor torque used")] = None
    peak_load_torque_Nm: Annotated[float | None, Shown("peak torque at the load")] = None
    peak_motor_torque_Nm: Annotated[float | None, Shown("peak motor torque")] = None
    torque_to_load_percent: Annotated[float | None, Shown("torque to the load")] = None
    torque_to_rotor_percent: Annotated[float | None, Shown("torque to the motor's rotor")] = None
    torque_to_gears_percent: Annotated[float | None, Shown("torque to the train")] = None
    torque_to_friction_percent: Annotated[float | None, Shown("torque to friction")] = None


@dataclass(frozen=True)
class RatioCurve:
    """The value over the total ratio; with the chosen train, None where the load does not move."""

    total_ratio: tuple[float, ...]
    value: tuple[float, ...]
    value_with_train: tuple[float | None, ...] = ()


@dataclass(frozen=True)
class RatioDesign:
    """The best total ratio of a motion, its value by name and unit, and that of other ratios.

    given: a ratio without gears. best_with_train: the best ratio with the chosen train's inertia.
    None where nothing of the kind is there, or the motor fails.
    """

    duty: str
    total_ratio: float
    value: float
    name: str
    unit: str
    given: Achieved | None
    best: Achieved | None
    curve: RatioCurve
    chosen: Achieved | None = None
    given_train: Achieved | None = None
    best_with_train: Achieved | None = None


@dataclass(frozen=True)
class ErrorSource:
    """One deviation at its worst, and its error at the output; kind: backlash, pitch or elastic.

    tolerance: None of an elastic one, which is of the stiffness of a mesh.
    """

    source: str
    kind: str
    stage: int
    tolerance_mm: float | None
    error_deg: float


@dataclass(frozen=True)
class MeshBacklash:
    """Circumferential backlash of a stage with all deviations at their worst; None: none asked."""

    stage: Annotated[int, Shown("stage")]
    minimum_mm: Annotated[float, Shown("minimum backlash", unit="um", form=".2f")]
    maximum_mm: Annotated[float, Shown("maximum", unit="um", form=".2f")]
    asked_mm: Annotated[float | None, Shown("required", unit="um", form=".2f")]


@dataclass(frozen=True)
class Spring:
    """A mesh or shaft of the train, its share of the compliance, its stiffness at the output."""

    name: Annotated[str, Shown("spring")]
    compliance_share: Annotated[float, Shown("share, %", form="share")]
    referred_Nm_per_rad: Annotated[float, Shown("alone at the output")]


@dataclass(frozen=True)
class StiffnessDesign:
    """Stiffness at the output; frequency and windup where load and torque are given.

    All where meshes are softest; windup_variation: over a mesh, where their stiffness varies.
    """

    output_Nm_per_rad: float
    springs: tuple[Spring, ...]
    frequency_Hz: float | None = None
    windup_deg: float | None = None
    windup_variation_deg: float | None = None


@dataclass(frozen=True)
class BoxDesign:
    """A train in its box, as `servo_box` has it: inner and needed sides, angles of both links."""

    inner_width_mm: float
    inner_height_mm: float
    needed_width_mm: float
    needed_height_mm: float
    fits: bool
    motor_angle_deg: float
    output_angle_deg: float
    radii_mm: tuple[float, float, float]
    motor_mm: float
    shaft_mm: float
    links_mm: tuple[float, float]
    hub_mm: float
    half_sweep_deg: float


@dataclass(frozen=True)
class ToleranceRow:
    """A tolerance before and after; upper_mm: None for none."""

    name: str
    stage: int
    kind: str
    old_mm: float
    new_mm: float
    lower_mm: float
    upper_mm: float | None
    sensitivity_deg_per_mm: float
    old_cost: float
    new_cost: float


@dataclass(frozen=True)
class BudgetUse:
    """A budget of errors and its use by the new tolerances."""

    rule: str
    limit_deg: float
    used_deg: float
    kappa: float | None = None


@dataclass(frozen=True)
class Allocation:
    """Cost of the new tolerances and their use of the budgets."""

    budgets: tuple[BudgetUse, ...]
    cost: float
    old_cost: float
    method: str


@dataclass(frozen=True)
class Histogram:
    """How many drawn errors lie between two edges."""

    edges_deg: tuple[float, ...]
    counts: tuple[int, ...]


@dataclass(frozen=True)
class DrawnErrors:
    """Statistics of the error of `count` drawn axes, beside its limit.

    quantile: that of `probability`, within quantile_low .. quantile_high (None where the draws are
    too few for it); yield_share: of errors up to the limit, within yield_low .. yield_high; both
    intervals hold with at least `confidence`. worst_case: sum s t, which no draw of a distribution
    on [-t, t] exceeds. largest: of the draws.
    """

    count: int
    seed: int
    probability: float
    confidence: float
    yield_share: float
    yield_low: float
    yield_high: float
    mean_deg: float
    sd_deg: float
    quantile_deg: float
    quantile_low_deg: float | None
    quantile_high_deg: float | None
    limit_deg: float
    largest_deg: float
    worst_case_deg: float
    histogram: Histogram


def train_figures(train: TrainDesign, springs: StiffnessDesign | None) -> dict[str, float]:
    """Figures by which trains are compared: ratio, inertia, mass, error, stiffness, where known."""
    keys = ("ratio", "inertia_kg_m2", "mass_kg", "error_deg")
    figures = {key: getattr(train, key) for key in keys}
    if springs is not None:
        figures["output_stiffness_Nm_per_rad"] = springs.output_Nm_per_rad
        figures |= {key: getattr(springs, key) for key in ("frequency_Hz", "windup_deg")}
    return {key: value for key, value in figures.items() if value is not None}


@dataclass(frozen=True)
class GearheadDesign:
    """A planetary stage that is given; its inertia is at the motor, its lost motion at the output.

    Lost motion below 0: planets may bind. rolling_power: of a mesh, the largest, over the motor's.
    """

    planets: Annotated[int, Shown("planets")]
    teeth: Annotated[str, Shown("teeth of sun, planet, ring")]
    ratio: Annotated[float, Shown("ratio")]
    centre_distance_mm: Annotated[float, Shown("centre distance")]
    ring_outside_diameter_mm: Annotated[float, Shown("outside diameter of the ring")]
    mass_kg: Annotated[float, Shown("mass of the gears")]
    inertia_kg_m2: Annotated[float, Shown("inertia at the motor")]
    planets_inertia_kg_m2: Annotated[float, Shown("of it that of the planets")]
    efficiency: Annotated[float | None, Shown("efficiency of the meshes")] = None
    rolling_power: Annotated[float | None, Shown("rolling power over input power")] = None
    least_lost_motion_deg: Annotated[float | None, Shown("least lost motion")] = None
    lost_motion_deg: Annotated[float | None, Shown("largest lost motion")] = None


@dataclass(frozen=True)
class ServoDesign:
    """The design of a servo axis: the parts that its file asks for."""

    ratio: RatioDesign | None = None
    train: TrainDesign | None = None
    errors: tuple[ErrorSource, ...] = ()
    stiffness: StiffnessDesign | None = None
    box: BoxDesign | None = None
    tolerances: tuple[ToleranceRow, ...] = ()
    allocation: Allocation | None = None
    drawn: DrawnErrors | None = None
    backlash: tuple[MeshBacklash, ...] = ()
    gearhead: GearheadDesign | None = None

    def __or__(self, other: "ServoDesign") -> "ServoDesign":
        """Both together; where both have a value, that of the other counts."""
        return replace(self, **_given(other))


@dataclass(frozen=True)
class ServoReport:
    """Report beside the design. figures: by the names that docs/servo.md lists.

    trains: none of them where time was up, None where no train was chosen.
    """

    trains: tuple[ListedTrain, ...] | None = None
    stage_counts: tuple[StageCount, ...] | None = None
    given_train: TrainDesign | None = None
    given_stiffness: StiffnessDesign | None = None
    lightest_train: Mapping[str, Any] | None = None
    figures: Mapping[str, float] = field(default_factory=dict)

    def __or__(self, other: "ServoReport") -> "ServoReport":
        """Both together; where both have a value, that of the other counts."""
        return replace(self, **_given(other) | {"figures": {**self.figures, **other.figures}})

    def to_dict(self) -> dict[str, Any]:
        """Return plain data, the figures at its top."""
        data: dict[str, Any] = untyped(self)
        figures: dict[str, Any] = data.pop("figures", {})
        return data | figures

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "ServoReport":
        """The known part in the report of a result."""
        names = {f.name for f in fields(cls)}
        figures = {k: v for k, v in data.items() if isinstance(v, float)}
        report: ServoReport = typed(cls, {k: v for k, v in data.items() if k in names})
        return replace(report, figures=figures)


def _given(found: Any) -> dict[str, Any]:
    """Return the fields of a dataclass that do not hold their default."""
    return {f.name: v for f in fields(found) if (v := getattr(found, f.name)) != f.default}
