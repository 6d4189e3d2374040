"""The two design processes of Chong and Lee as methods of the problem `teeth`.

Each makes one train by rules, without a search; what their rules leave open is an input here. Face
widths are b = m_a d1; the strength law is a proportional one, its first limit of contact, its
second of the tooth root. The train is judged as any other: a limit it misses is named, never
repaired.

Where the print is wrong the rule here is the corrected one; docs/multi_stage.md shows the evidence.
s_ij^2 = K_i/K_j, as sigma_H ~ sqrt(K), eq. (1).
"""

import math
from collections.abc import Callable, Sequence
from fractions import Fraction

from gearopt.errors import SolveError
from gearopt.formulations.drive.teeth import point
from gearopt.formulations.drive.train import Stage, Train
from gearopt.formulations.strength import Law
from gearopt.frozen import dataclass
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Outcome, Watch
from gearopt.physics.gears import GearPair

ROUNDING = 1e-12  # relative; a whole number or module missed by so little is met
RANDOM = False
COUNTS = "train made by the rules"

Ratios = tuple[Fraction, ...]
Pairs = tuple[GearPair, ...]


@dataclass(frozen=True)
class ProcessOne:
    """Inputs of process one: one entry per stage.

    ratios: the rule behind them is not known (docs/multi_stage.md). pinion_teeth: None for those
    balanced between both load limits. modules [mm]: None for the smallest that carry the load.
    """

    ratios: Ratios
    pinion_teeth: tuple[int, ...] | None = None
    modules: tuple[Fraction, ...] | None = None


@dataclass(frozen=True)
class ProcessTwo:
    """Inputs of process two (after Niemann): one entry per stage, and the first centre distance.

    first_centre_distance [mm]. ratios: None for Niemann's. pinion_teeth or modules [mm], or both:
    the designer's last step; what is not given is rounded up from the centre distance.
    """

    first_centre_distance: float
    ratios: Ratios | None = None
    pinion_teeth: tuple[int, ...] | None = None
    modules: tuple[Fraction, ...] | None = None

    def __post_init__(self) -> None:
        if self.pinion_teeth is None and self.modules is None:
            raise ValueError("process two needs pinion teeth or modules")


def methods(
    train: Train, one: ProcessOne | None = None, two: ProcessTwo | None = None
) -> dict[str, Callable[..., Outcome]]:
    """Return the methods process-one and process-two for the problem `teeth` of a drive.

    SolveError when run: without inputs, with other numbers of entries than stages, or where a face
    width is not tied to d1; process two
    also where profile shifts or given distances leave the reference circles.
    """

    def process_one(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Ratios given; teeth balanced between contact and root; modules from the loads."""
        if one is None:
            raise _missing("one", "stage_ratios")
        _check("one", train, one)
        return _as_outcome(train, *_first(train, one))

    def process_two(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
        """Ratios after Niemann; sizes from the first centre distance."""
        if two is None:
            raise _missing("two", "first_centre_distance, and modules or pinion_teeth")
        _check("two", train, two)
        return _as_outcome(train, *_second(train, two))

    return {"process-one": process_one, "process-two": process_two}


def _missing(which: str, keys: str) -> SolveError:
    return SolveError(
        f"the method process-{which} needs a table [process_{which}] in the file, with {keys}"
    )


def _check(which: str, train: Train, inputs: ProcessOne | ProcessTwo) -> None:
    """Raise SolveError where the inputs do not fit the drive."""
    if not train.law.proportional or len(train.law.limits) != 2:
        raise SolveError(
            f"the method process-{which} needs two limits in proportion to the load, of contact "
            f"and of the tooth root, not {train.law.title}"
        )
    if not all(stage.face_width.tied for stage in train.stages):
        raise SolveError(
            f"the method process-{which} needs face widths b = m_a d1: write "
            "face_width_over_diameter as one number for every stage"
        )
    if which == "two" and not train.on_reference:
        raise SolveError(
            "the method process-two starts from the centre distance of reference circles: it needs "
            "profile shifts that cancel in every stage, and no given centre distance"
        )
    for given in (inputs.ratios, inputs.pinion_teeth, inputs.modules):
        if given is not None and len(given) != len(train.stages):
            raise SolveError(f"process {which} has {len(given)} entries, not one for each stage")


def _pair(stage: Stage, module: Fraction, z1: int, z2: int) -> GearPair:
    """Return the pair of a stage whose face width is tied to d1."""
    narrow = stage.toothing.pair(float(module), z1, z2, 1.0)
    return narrow.of_width(float(stage.face_width.high or 0) * narrow.pinion.reference_diameter)


def _first(train: Train, inputs: ProcessOne) -> tuple[Pairs, str]:
    """Return the gears of process one; none, and why, where no module carries the load."""
    pairs: list[GearPair] = []
    torque = train.torque
    for k, (stage, u) in enumerate(zip(train.stages, inputs.ratios, strict=True)):
        if inputs.pinion_teeth is not None:
            z1 = inputs.pinion_teeth[k]
        else:
            z1 = balanced_pinion(train.law, stage, float(u))
        z2 = wheel_teeth(z1, u)
        if inputs.modules is not None:
            module: Fraction | None = inputs.modules[k]
        else:
            minimum = needed_module(train.law, stage, torque, (z1, z2))
            module = next_module(stage, minimum)
            if module is None:
                return (), _no_module(k, minimum, stage)
        assert module is not None
        pairs.append(_pair(stage, module, z1, z2))
        torque *= z2 / z1
    return tuple(pairs), ""


def _second(train: Train, inputs: ProcessTwo) -> tuple[Pairs, str]:
    """Return the gears of process two; none, and why, where no module is large enough.

    The message names a given pinion that is smaller than its centre distance requires.
    """
    limits = [stage.allowable[0] for stage in train.stages]
    ratios = inputs.ratios or niemann_ratios(float(train.ratio), limits)
    pairs: list[GearPair] = []
    small = []
    diameters = _diameters(train, inputs.first_centre_distance, [float(u) for u in ratios])
    for k, (stage, d1) in enumerate(zip(train.stages, diameters, strict=True)):
        across = d1 * stage.toothing.cosine  # m z1
        z1 = None if inputs.pinion_teeth is None else inputs.pinion_teeth[k]
        if inputs.modules is not None:
            module: Fraction | None = inputs.modules[k]
        else:
            assert z1 is not None
            module = next_module(stage, across / z1)
            if module is None:
                return (), _no_module(k, across / z1, stage)
        assert module is not None
        z1 = z1 or math.ceil(across / float(module) * (1.0 - ROUNDING))
        pairs.append(_pair(stage, module, z1, wheel_teeth(z1, ratios[k])))
        diameter = pairs[-1].pinion.reference_diameter
        if diameter < d1 * (1.0 - ROUNDING):
            small.append(
                f"pinion {k + 1} has {diameter:.2f} mm, its centre distance requires {d1:.2f} mm"
            )
    return tuple(pairs), "; ".join(small)


def _diameters(train: Train, centre_distance: float, u: list[float]) -> list[float]:
    """Return the pinion diameters [mm] of all stages, before any rounding of teeth or modules.

    Of the chains that Table 4 could come from, only this one rounds up to it in every stage.
    """
    diameters = [pinion_diameter(centre_distance, u[0])]
    for k in range(1, len(u)):
        before, stage = train.stages[k - 1 : k + 1]
        centre_distance = next_centre_distance(
            centre_distance,
            (u[k - 1], u[k]),
            (float(before.face_width.high or 0), float(stage.face_width.high or 0)),
            (before.allowable[0], stage.allowable[0]),
        )
        diameters.append(pinion_diameter(centre_distance, u[k]))
    return diameters


def _no_module(position: int, minimum: float, stage: Stage) -> str:
    return (
        f"stage {position + 1} needs a module of {minimum:.4g} mm or more; the largest allowed is "
        f"{float(stage.modules[-1]):g} mm"
    )


def _as_outcome(train: Train, pairs: Pairs, message: str) -> Outcome:
    """Return the point of the problem `teeth` that has these gears."""
    x = point(train, pairs) if pairs else None
    return Outcome(x, evaluations=1, message=message)


def niemann_ratios(total: float, contact: Sequence[float]) -> tuple[float, ...]:
    """Return the ratios of two or three stages after Niemann, as printed.

    Two: u1 = 0.8 (u s_12)^(2/3). Three: u1 = 0.6 u^(4/7) s_12^(2/7) s_13^(4/7),
    u2 = 1.1 u^(2/7) s_21^(4/7) s_23^(2/7). total: u >= 1; contact: K of every stage [MPa].
    These are the leading terms, for u_i >> 1, of the split of minimum gear volume. SolveError for
    other numbers of stages. Source: Chong and Lee, eqs. (7) and (8).
    """
    k = tuple(contact)
    if len(k) == 2:
        first = 0.8 * (total * (k[0] / k[1]) ** 0.5) ** (2 / 3)
        return first, total / first
    if len(k) == 3:
        first = 0.6 * total ** (4 / 7) * (k[0] / k[1]) ** (1 / 7) * (k[0] / k[2]) ** (2 / 7)
        second = 1.1 * total ** (2 / 7) * (k[1] / k[0]) ** (2 / 7) * (k[1] / k[2]) ** (1 / 7)
        return first, second, total / first / second
    raise SolveError(
        f"process-two has a rule for the ratios of two and three stages, not of {len(k)}: "
        "write stage_ratios in the table [process_two]"
    )


def load_share(ratio: float, following: float) -> float:
    """f_12 = u1 (u2 + 1)^3/(u2 (u1 + 1)^3) n1/n2, which is s_21^2 (b2/b1) (a2/a1)^2.

    ratio u1, following u2 >= 1; n1/n2 = u1. Source: Chong and Lee, eq. (3), corrected: the print
    has (a2/a1)^3, which contradicts eqs. (2) and (6).
    """
    return ratio**2 * (following + 1.0) ** 3 / (following * (ratio + 1.0) ** 3)


def next_centre_distance(
    centre_distance: float,
    ratios: tuple[float, float],
    proportions: tuple[float, float],
    contact: tuple[float, float],
) -> float:
    """a2 = a1 [f_12 s_12^2 (u2 + 1)/(u1 + 1) m_a1/m_a2]^(1/3) [mm]: the next stage's centres.

    centre_distance a1 [mm]; then of both stages: ratios u, proportions m_a = b/d1, limits K [MPa].
    Both stages are then loaded alike. Source: Chong and Lee, eq. (14), corrected: the print has
    s_12, but eq. (3) with b = 2 a m_a/(u + 1), eq. (13), gives its square.
    """
    (u1, u2), (m1, m2), (k1, k2) = ratios, proportions, contact
    cube = load_share(u1, u2) * (k1 / k2) * (u2 + 1.0) / (u1 + 1.0) * m1 / m2
    return centre_distance * math.cbrt(cube)


def pinion_diameter(centre_distance: float, ratio: float) -> float:
    """d1 = 2 a/(u + 1) [mm]. Source: Chong and Lee, eq. (13) with b = m_a d1."""
    return 2.0 * centre_distance / (ratio + 1.0)


def balanced_pinion(law: Law, stage: Stage, ratio: float) -> int:
    """Teeth z1 = (U/K) (u + 1)/u cos(beta), cut, with which contact and root limit alike.

    Source: Chong and Lee, eq. (11) over eq. (10). Cut, not rounded: 25.84 is 25 in their Table 2.
    """
    unit = stage.toothing.of_diameter(stage.toothing.cosine, 1.0, 1.0, ratio, 1.0)
    contact, root = law.utilisations(unit, 1.0, 0.0, stage.allowable).values()
    balanced = float(contact / root)
    return max(1, math.floor(balanced * (1.0 + ROUNDING)))


def wheel_teeth(pinion_teeth: int, ratio: Fraction | float) -> int:
    """Teeth z2 = u z1, cut.

    Cut, not rounded: process two of Table 4 has 237, 109, 80 where u z1 is 237.70, 109.55, 80.07.
    A fraction is exact; for others ROUNDING decides.
    """
    exact = isinstance(ratio, Fraction)
    return math.floor(ratio * pinion_teeth * (1 if exact else 1.0 + ROUNDING))


def needed_module(law: Law, stage: Stage, torque: float, teeth: tuple[int, int]) -> float:
    """Return the minimum normal module [mm] for both load limits with b = m_a d1.

    From U: m^3 = 2 T cos^2(beta)/(m_a z1^2 U). From K: m = d1 cos(beta)/z1 with
    d1^3 = 2 T (u + 1)/(u K m_a). torque [N mm] of the pinion; teeth of pinion and wheel, so that
    the loads hold with those that are made. Source: Chong and Lee, eqs. (10) to (13).
    """
    unit = stage.toothing.pair(1.0, *teeth, 1.0)
    tied = unit.of_width(float(stage.face_width.high or 0) * unit.pinion.reference_diameter)
    return math.cbrt(law.largest_utilisation(tied, torque, 0.0, stage.allowable))


def next_module(stage: Stage, minimum: float) -> Fraction | None:
    """Return the first allowed module not below `minimum` [mm]; None where there is none."""
    return next((m for m in stage.modules if m >= minimum * (1.0 - ROUNDING)), None)
