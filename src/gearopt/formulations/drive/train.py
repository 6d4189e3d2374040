"""The input of `continuous_sizing` and `teeth`: a multi-stage drive with its duty and limits.

Numbers at which a tie may occur (ratios, modules, face-width proportions, diameters) are exact
fractions; the rest are floats in mm, N, rad, MPa.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.formulations.drive.toothing import Toothing, in_columns, taken
from gearopt.formulations.strength import ALLOWANCE, Law
from gearopt.formulations.strength.standard import Option
from gearopt.frozen import dataclass
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import largest_sliding

OBJECTIVES = {  # name -> unit
    "gear_volume": "mm3",
    "mass": "kg",
    "sum_of_centre_distances": "mm",
    "total_length": "mm",
    "cost": "",
    "mesh_loss": "percent",
}
EXTREMES = {  # largest values over the stages, which do not add up, and their units
    "axial_force": "N",
    "specific_sliding": "",
    "inverse_contact_ratio": "",
}
WEIGHTED = "weighted sum"  # of objectives, by the train's weights
LENGTHS = ("sum_of_centre_distances", "total_length")  # objectives along the line of centres
MASSES = ("mass", "cost")  # objectives of gears as heavy as their blanks
STEEL_DENSITY = 7.85e-9  # t/mm3: EN 1991-1-1 table A.4 (to 78.5 kN/m3), Steel for Life Blue Book
BY_WIDTH = ("gear_volume", *MASSES)  # objectives whose shares are proportional to b
CHOICES = (  # of `Train.numbers`, those that limit what a stage may choose
    "width_low",
    "width_high",
    "module_low",
    "module_high",
    "pinion_low",
    "pinion_high",
    "wheel_low",
    "wheel_high",
    "ratio_low",
    "ratio_high",
    "wheel_diameter",
)
WIDTHS = ("over_module_low", "over_module_high", "least_width")  # where a stage has these limits


@dataclass(frozen=True)
class FaceWidth:
    """How the face width b of a stage is chosen, from the pinion reference diameter d1.

    low, high: limits of b/d1 (high may be None with `fixed`); equal ones tie b to d1. step: b is
    a whole multiple of it [mm]. fixed: b itself is given [mm] (the limits still hold).
    over_module: limits of b/m_n, None: no limit; least: minimum b [mm], 0: no limit.
    """

    low: Fraction
    high: Fraction | None
    step: Fraction | None = None
    fixed: Fraction | None = None
    over_module: tuple[Fraction | None, Fraction | None] = (None, None)
    least: Fraction = Fraction(0)

    @property
    def tied(self) -> bool:
        """Whether b = high d1."""
        return self.low == self.high and self.step is None and self.fixed is None

    @property
    def widest(self) -> float:
        """Largest b/d1; inf where there is no limit."""
        return _or_inf(self.high)

    @property
    def plain(self) -> bool:
        """Whether b has no limits but those of b/d1."""
        return self.over_module == (None, None) and not self.least

    def proportions(self, diameter_over_module: Fraction) -> tuple[Fraction, Fraction | None]:
        """Return the limits of b/m_n of a pinion of this d1/m_n; least is left aside."""
        low, high = self.over_module
        most = [x for x in (high, self.high and self.high * diameter_over_module) if x is not None]
        return max(self.low * diameter_over_module, low or Fraction(0)), min(most, default=None)


@dataclass(frozen=True)
class Stage:
    """One stage: its load limits and its choices of teeth, modules and face width.

    allowable: the limits of the train's strength law, in its order. modules: allowed normal modules
    [mm], increasing (for the continuous form its first and last are limits; empty: any).
    pinion_teeth, wheel_teeth, ratio u = z2/z1 >= 1: minimum and maximum (None: no
    limit). wheel_diameter: maximum [mm] of the wheel's reference diameter. toothings: ways of
    cutting its gears, of which one is chosen; they differ in helix angle, given distance
    and pinion_shift alone.
    helix: least and greatest helix angle [rad], above 0, of real-valued sizes, else None; shifts:
    least and greatest x1, and so of x1 + x2, of real-valued sizes, else None.
    safety: S_F and S_H asked of it over those of the train.
    overlap: minimum overlap ratio, 0: no limit; axial_force: maximum [N] at the train's torque.
    specific_sliding: maximum, without its sign; inverse_contact_ratio: maximum of one over the
    total contact ratio; both, and axial_force, of stages that ratings limit.
    options: ways of making them that are rated, of which one is chosen; none: the law limits alone.
    blanks: of pinion and wheel.
    """

    allowable: tuple[float, ...]
    face_width: FaceWidth
    modules: tuple[Fraction, ...]
    pinion_teeth: tuple[int, int | None]
    wheel_teeth: tuple[int, int | None] = (1, None)
    ratio: tuple[Fraction, Fraction | None] = (Fraction(1), None)
    wheel_diameter: Fraction | None = None
    toothings: tuple[Toothing, ...] = (Toothing(),)
    helix: tuple[float, float] | None = None
    shifts: tuple[tuple[float, float], tuple[float, float]] | None = None
    options: tuple[Option, ...] = ()
    blanks: tuple[Blank, Blank] = (SOLID, SOLID)
    overlap: float = 0.0
    axial_force: float = math.inf
    specific_sliding: float = math.inf
    inverse_contact_ratio: float = math.inf
    safety: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        if not all(self.toothings[0].alike(other) for other in self.toothings[1:]):
            raise ValueError("toothings of a stage differ in helix angle, distance and x1 alone")

    @property
    def toothing(self) -> Toothing:
        """The toothing of a stage that has one; of several the first, for what is alike."""
        return self.toothings[0]

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Ends of what real-valued sizes choose of the toothing, by its field."""
        ends = {} if self.helix is None else {"helix_angle": self.helix}
        if self.shifts is not None:
            ends |= dict(zip(("pinion_shift", "shift_sum"), self.shifts, strict=True))
        return ends

    def cut(self, **values: Any) -> Toothing:
        """The toothing of a stage that has one, with values of its ranges."""
        return self.toothing.at(values)

    def toothing_of(self, row: Any) -> Toothing:
        """Toothing of pairs (n,) or of one; row: which of its toothings, from 0."""
        if len(self.toothings) == 1:
            return self.toothings[0]
        return taken(self._columns, row) if np.ndim(row) else self.toothings[int(row)]

    @cached_property
    def _columns(self) -> Toothing:
        """All toothings as one of arrays."""
        return in_columns(self.toothings)

    def toothing_row(self, pair: GearPair) -> int:
        """Which of its toothings made a pair of floats, from 0."""
        if len(self.toothings) == 1:
            return 0
        return next(k for k, toothing in enumerate(self.toothings) if toothing.made(pair))

    def width_of_overlap(self, pair: GearPair) -> Any:
        """Face width [mm] of the minimum overlap ratio; inf where spur gears have none."""
        sine = np.sin(np.abs(pair.pinion.helix_angle))
        with np.errstate(divide="ignore"):
            return np.divide(self.overlap * math.pi, sine) * pair.normal_module

    def axial_use(self, pair: GearPair, torque: Any) -> Any:
        """Part of the maximum axial force in use at a torque [N mm]."""
        return axial_force(pair, torque) / self.axial_force

    def least_width(self, pair: GearPair, torque: Any, width: Any) -> Any:
        """Face widths [mm] from some on that the contact ratio allows; inf: other limits do not.

        Limits on axial force and specific sliding leave a pair out, whatever its width.
        """
        if math.isfinite(self.axial_force):
            allowed = axial_force(pair, torque) <= self.axial_force * (1.0 + ALLOWANCE)
            width = np.where(allowed, width, np.inf)
        if math.isfinite(self.specific_sliding):
            allowed = largest_sliding(pair) <= self.specific_sliding * (1.0 + ALLOWANCE)
            width = np.where(allowed, width, np.inf)
        if math.isfinite(self.inverse_contact_ratio):
            asked = (1.0 - ALLOWANCE) / self.inverse_contact_ratio
            lacking = asked - pair.transverse_contact_ratio
            overlap = pair.of_width(1.0).overlap_ratio  # of a millimetre
            with np.errstate(divide="ignore", invalid="ignore"):
                width = np.maximum(width, np.where(lacking > 0.0, lacking / overlap, 0.0))
        return width

    @property
    def bodies(self) -> tuple[Blank, ...]:
        """Blanks of all its gears."""
        ways = [option.planets for option in self.options if option.planets is not None]
        return (*self.blanks, *(blank for way in ways for blank in way.cutting.blanks))

    @property
    def planetary(self) -> bool:
        """Whether it has planets or a ring."""
        return any(option.planets is not None for option in self.options)

    @property
    def one_shape(self) -> bool:
        """Whether bodies of planetary stages grow as modules do; those of pairs do."""
        ways = (option.planets for option in self.options if option.planets is not None)
        return all(way.cutting.solid and way.cutting.distance is None for way in ways)

    def possible(self, z1: Any, z2: Any) -> Any:
        """Whether some way of making the stage takes numbers of teeth; all do of pairs."""
        if not self.planetary:
            return np.ones(np.shape(z1), bool)
        ways = {option.planets for option in self.options}
        return np.logical_or.reduce([way.possible(z1, z2) for way in ways])

    @property
    def options_of_one_material(self) -> dict[str, tuple[Option, ...]]:
        """Options whose gears are all of one material, by its name."""
        named: dict[str, tuple[Option, ...]] = {}
        for option in self.options:
            if len(names := set(option.materials)) == 1:
                name = names.pop()
                named[name] = (*named.get(name, ()), option)
        return named

    @property
    def pinion_fixed(self) -> bool:
        """Whether z1 is given."""
        return self.pinion_teeth[0] == self.pinion_teeth[1]

    @property
    def wheel_fixed(self) -> bool:
        """Whether z2 is given."""
        return self.wheel_teeth[0] == self.wheel_teeth[1]


@dataclass(frozen=True)
class Train:
    """A drive: input torque [N mm], total ratio and its relative tolerance, and its stages.

    driver: the member that drives every stage; where it is the wheel, total ratios are those of
    output over input speed.
    coprime: z1 and z2 without common divisor (hunting teeth). objective: a key of OBJECTIVES; mass
    needs density [t/mm3]; LENGTHS are those of reference circles, for which profile shifts must
    cancel, or of given centre distances that shifts follow from.
    others: further objectives, of a Pareto front; weights: what the objective WEIGHTED adds. law:
    what limits the stages. speed: that of the input [rad/s], for laws that depend on it. safety:
    S_F and S_H asked for of stages with options. same_option: all stages take their options of
    one and the same number, which have the same materials. distances: rows of given centre
    distances [mm] of all stages that go together; (): all do. any_will_do: whether it is asked
    alone if there is a train, whatever it costs. keys: places of `numbers` in a
    problem file, one per stage for what a stage has of its own.
    """

    torque: float
    ratio: Fraction
    tolerance: Fraction
    stages: tuple[Stage, ...]
    driver: str = field(default="pinion", kw_only=True)
    coprime: bool = False
    objective: str = "gear_volume"
    others: tuple[str, ...] = ()
    weights: tuple[tuple[str, float], ...] = ()
    density: float | None = None
    law: Law = field(kw_only=True)
    speed: float = 0.0
    safety: tuple[float, float] = (1.0, 1.0)
    same_option: bool = False
    distances: tuple[tuple[float, ...], ...] = ()
    any_will_do: bool = False
    keys: Mapping[str, str | tuple[str, ...]] = field(default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        numbers = [self.torque, *(x for s in self.stages for x in s.allowable)]
        if not all(math.isfinite(x) and x > 0 for x in numbers):
            raise ValueError(f"torque and load limits must be positive numbers: {numbers}")
        if self.several_toothings and (self.law.limits or not all(s.options for s in self.stages)):
            raise ValueError("stages with a choice of toothings are limited by ratings alone")
        if any(len(s.allowable) != len(self.law.limits) for s in self.stages):
            raise ValueError(f"every stage needs limits for {', '.join(self.law.names)}")
        if any(s.pinion_teeth[0] < self.law.minimum_teeth for s in self.stages):
            raise ValueError(f"{self.law.title} needs pinions of {self.law.minimum_teeth} teeth")
        if self.highest_ratio < 1 or not 0 <= self.tolerance < 1 or not self.stages:
            raise ValueError("a drive needs stages, ratio >= 1 and a tolerance from 0 to below 1")
        for objective in (*self.objectives, *(name for name, _ in self.weights)):
            self._check(objective)

    def _check(self, objective: str) -> None:
        """Raise ValueError where an objective needs a number that the drive lacks."""
        cuts = [cut for stage in self.stages for cut in stage.toothings]
        if objective in LENGTHS and not all(c.on_reference or c.given for c in cuts):
            raise ValueError(f"the objective {objective} needs profile shifts that cancel")
        solid = self.density is not None or all(
            stage.options and all(all(option.densities) for option in stage.options)
            for stage in self.stages
        )
        idle = any(option.idler for stage in self.stages for option in stage.options)
        if idle and objective not in ("gear_volume", "mass", WEIGHTED):
            raise ValueError(f"the objective {objective} is not for stages with an idler")
        epicyclic = any(stage.planetary for stage in self.stages)
        if epicyclic and objective in (*LENGTHS, "cost"):
            raise ValueError(f"the objective {objective} is not for stages with planets or a ring")
        if objective == "cost" and not all(stage.options for stage in self.stages):
            raise ValueError("the objective cost needs the price of every stage's materials")
        if objective in MASSES and not solid:
            raise ValueError(f"the objective {objective} needs a density")
        materials = {tuple(option.materials for option in stage.options) for stage in self.stages}
        if self.same_option and len(materials) > 1:
            raise ValueError("stages that take the same option need options of the same materials")

    @property
    def objectives(self) -> tuple[str, ...]:
        """Return all objectives, the first one first."""
        return (self.objective, *self.others)

    def minimising(self, objective: str) -> "Train":
        """Return the drive with one objective alone."""
        return replace(self, objective=objective, others=(), weights=())

    def weighing(self, weights: Sequence[float]) -> "Train":
        """Return the drive that minimises a weighted sum of its objectives."""
        named = tuple(zip(self.objectives, map(float, weights), strict=True))
        return replace(self, objective=WEIGHTED, others=(), weights=named)

    @property
    def rated(self) -> bool:
        """Whether ratings limit the stages."""
        return any(stage.options for stage in self.stages)

    @property
    def several_options(self) -> bool:
        """Whether a stage has a choice of options."""
        return any(len(stage.options) > 1 for stage in self.stages)

    @property
    def several_toothings(self) -> bool:
        """Whether a stage has a choice of toothings."""
        return any(len(stage.toothings) > 1 or stage.ranges for stage in self.stages)

    @property
    def ranging(self) -> bool:
        """Whether a stage has a range of helix angles or of profile shifts."""
        return any(stage.ranges for stage in self.stages)

    @property
    def of_one_option(self) -> tuple["Train", ...]:
        """The drives of which this one is the best: one for each option that all stages take."""
        if not (self.same_option and self.several_options):
            return (self,)
        count = len(self.stages[0].options)
        by_option = [
            [replace(s, options=(s.options[k],)) for s in self.stages] for k in range(count)
        ]
        return tuple(replace(self, stages=tuple(stages)) for stages in by_option)

    @property
    def of_one_row(self) -> tuple["Train", ...]:
        """The drives of which this one is the best: one for each row of its distances."""
        return tuple(map(self._at, self.distances)) or (self,)

    def _at(self, row: tuple[float, ...]) -> "Train":
        """The drive at given centre distances [mm]."""
        stages = tuple(
            replace(stage, toothings=tuple(t for t in stage.toothings if t.working_distance == a))
            for stage, a in zip(self.stages, row, strict=True)
        )
        return replace(self, stages=stages, distances=())

    def of_few_toothings(self, count: int) -> "Train":
        """The drive whose stages have so many of their toothings at most, evenly spread."""

        def few(stage: Stage) -> Stage:
            places = np.linspace(0, len(stage.toothings) - 1, count).round().astype(int)
            return replace(stage, toothings=tuple(stage.toothings[k] for k in places))

        stages = tuple(few(s) if len(s.toothings) > count else s for s in self.stages)
        return self if stages == self.stages else replace(self, stages=stages)

    @property
    def of_one_material(self) -> tuple["Train", ...]:
        """The drives of this one whose gears are all of one material; itself without a choice."""
        if not self.several_options:
            return (self,)
        rows = [s.options_of_one_material for s in self.stages]
        alike = [name for name in rows[0] if all(name in row for row in rows)]
        by_material = [
            [replace(s, options=row[n]) for s, row in zip(self.stages, rows, strict=True)]
            for n in alike
        ]
        return tuple(replace(self, stages=tuple(own), same_option=False) for own in by_material)

    @property
    def hollow(self) -> bool:
        """Whether an objective counts gears that are no solid discs."""
        blanks = [blank for stage in self.stages for blank in stage.bodies]
        names = (*self.objectives, *(name for name, _ in self.weights))
        counted = any(name in MASSES for name in names)
        return counted and not all(blank.solid for blank in blanks)

    @property
    def by_width(self) -> bool:
        """Whether the share of a stage is proportional to its face width."""
        named = [name for name, _ in self.weights] or [self.objective]
        wider = any(any(cut.width_excesses) for stage in self.stages for cut in stage.toothings)
        return not wider and all(name in BY_WIDTH for name in named)

    @property
    def on_reference(self) -> bool:
        """Whether every stage has the centre distance of its reference circles."""
        return all(t.on_reference for stage in self.stages for t in stage.toothings)

    @cached_property
    def lowest_ratio(self) -> Fraction:
        """Minimum total ratio."""
        return self.ratio * (1 - self.tolerance)

    @cached_property
    def highest_ratio(self) -> Fraction:
        """Maximum total ratio."""
        return self.ratio * (1 + self.tolerance)

    @property
    def drivers(self) -> tuple[str, ...]:
        """The member that drives each stage."""
        return (self.driver,) * len(self.stages)

    @property
    def torques(self) -> tuple[float, float]:
        """Ends of the torques [N mm] that pinions have."""
        far = float(self.highest_ratio)
        low = self.torque if self.driver == "pinion" else self.torque / far
        return low, low * far

    def pinion_torques(self, low: Any, high: Any, own: Any) -> tuple[Any, Any]:
        """Ends of the torques [N mm] of pinions, whose stages have a ratio of the logarithm `own`.

        low, high: ends of the logarithm of the ratio that the stages before them have.
        """
        if self.driver == "wheel":
            low, high = -(high + own), -(low + own)
        return self.torque * np.exp(low), self.torque * np.exp(high)

    def fixed_teeth(
        self, stage: int, pinion: int, wheel: int, toothing: int | None = None
    ) -> "Train":
        """Return the drive with the teeth of one stage (counted from 0) given.

        toothing: which of its toothings cuts them, from 0; None: any of them.
        """
        asked = self.stages[stage]
        cuts = asked.toothings if toothing is None else (asked.toothings[toothing],)
        changed = replace(
            asked, pinion_teeth=(pinion, pinion), wheel_teeth=(wheel, wheel), toothings=cuts
        )
        return replace(self, stages=self.stages[:stage] + (changed,) + self.stages[stage + 1 :])

    def pair(
        self,
        stage: int,
        module: Any,
        pinion_teeth: Any,
        wheel_teeth: Any,
        face_width: Any,
        toothing: Any = 0,
    ) -> GearPair:
        """Return the gear pair of a stage (counted from 0); module, face_width [mm].

        toothing: which of the stage's, from 0.
        """
        cut = self.stages[stage].toothing_of(toothing)
        return cut.pair(module, pinion_teeth, wheel_teeth, face_width)

    def safety_of(self, stage: Stage) -> tuple[float, float]:
        """S_F and S_H asked for of a stage."""
        return self.safety[0] * stage.safety[0], self.safety[1] * stage.safety[1]

    def speed_at(self, torque: Any) -> Any:
        """Return the speed [rad/s] of a shaft that carries a torque [N mm], without losses."""
        return self.speed * (self.torque / torque)

    @property
    def by_stage(self) -> tuple[str, ...]:
        """The names in `numbers` with a value for every stage."""
        return (*self.law.names, *CHOICES, *self._widths())

    @property
    def unit(self) -> str:
        """Unit of the objective."""
        return OBJECTIVES.get(self.objective, "")

    def numbers(self) -> dict[str, float | tuple[float, ...]]:
        """Every number of the drive by name, a float; one per stage for numbers of stages."""
        stages = self.stages
        return {
            "torque": self.torque,
            "helix_cosine": tuple(s.toothing.cosine for s in stages),
            "density": 1.0 if self.density is None else self.density,
            "lowest_ratio": float(self.lowest_ratio),
            "highest_ratio": float(self.highest_ratio),
            "speed": self.speed,
            "bending_safety": self.safety[0],
            "contact_safety": self.safety[1],
            **{n: tuple(s.allowable[i] for s in stages) for i, n in enumerate(self.law.names)},
            "width_low": tuple(float(s.face_width.low) for s in stages),
            "width_high": tuple(s.face_width.widest for s in stages),
            "module_low": tuple(float(min(s.modules, default=0)) for s in stages),
            "module_high": tuple(_or_inf(max(s.modules, default=None)) for s in stages),
            "pinion_low": tuple(float(s.pinion_teeth[0]) for s in stages),
            "pinion_high": tuple(_or_inf(s.pinion_teeth[1]) for s in stages),
            "wheel_low": tuple(float(s.wheel_teeth[0]) for s in stages),
            "wheel_high": tuple(_or_inf(s.wheel_teeth[1]) for s in stages),
            "ratio_low": tuple(float(s.ratio[0]) for s in stages),
            "ratio_high": tuple(_or_inf(s.ratio[1]) for s in stages),
            "wheel_diameter": tuple(_or_inf(s.wheel_diameter) for s in stages),
            **self._widths(),
        }

    def _widths(self) -> dict[str, tuple[float, ...]]:
        """Return the numbers of WIDTHS; none where no stage has such a limit."""
        faces = [stage.face_width for stage in self.stages]
        if all(face.plain for face in faces):
            return {}
        low = tuple(float(face.over_module[0] or 0) for face in faces)
        high = tuple(_or_inf(face.over_module[1]) for face in faces)
        return dict(zip(WIDTHS, (low, high, tuple(float(f.least) for f in faces)), strict=True))


def axial_force(pair: GearPair, torque: Any) -> Any:
    """F_a = 2 T tan(beta)/d1 [N] at a torque of the pinion [N mm]."""
    first = pair.pinion
    return 2.0 * torque * np.tan(np.abs(first.helix_angle)) / first.reference_diameter


def _or_inf(number: Fraction | int | None) -> float:
    return math.inf if number is None else float(number)
