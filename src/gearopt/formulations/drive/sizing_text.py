"""Text of the continuous sizing of a drive: teeth and modules as real numbers.

Minimise the drive's objective under the limits of its strength law (Chong and Lee, eqs. 10-12) with
ratios, modules, teeth and face widths free within their limits. Where the law is a posynomial, as
every other row is, the log form is convex: Ipopt finds the global optimum and the dual bound proves
it. With the total ratio free within its tolerance this is a relaxation of `teeth`, so its bound
holds there too. `terms` are the objective and the limits of both.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np

from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.train import WIDTHS, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Param, Terms, Var, each, namespace
from gearopt.physics.gears import GearPair, reference_diameter
from gearopt.physics.loads import torque_ratios

# factor between any length of a drive and the ends of the search: they never bind
SEARCH_SPAN = 1e6
BAND = Fraction(1, 10**10)  # half width of the band of a ratio that is given: far below 1e-8
TEETH = (1.0, 1e6)
RATIO = (1.0, 1e7)
TYPICAL = 1.0  # MPa, K-factor of rated gears from which a search starts
VARIABLES = {"module": "mm", "pinion_teeth": "", "ratio": "", "face_width": "mm"}
RANGED = {"helix_angle": "rad", "pinion_shift": "", "shift_sum": ""}  # where stages have ranges

_PARAMETER_UNITS = {
    "torque": "N mm",
    "density": "t/mm3",
    "speed": "rad/s",
    "wheel_diameter": "mm",
    "module_low": "mm",
    "module_high": "mm",
    "least_width": "mm",
}


def exact_text(train: Train) -> Problem:
    """Continuous problem of a drive without methods of its own.

    Variables, one component per stage: module [mm], pinion_teeth, ratio and, where it is not tied
    to d1, face_width [mm]. Of a rated drive the text is for numbers and arrays of them only, and of
    gears with webs the objective is not a posynomial.
    """

    def evaluate(x: Any, p: Any) -> Terms:
        return terms(train, p, text_pairs(train, x, p))

    columns, numbers = variables(train), parameters(train)
    return Problem("sizing", columns, numbers, evaluate, vectorised=train.rated)


def parameters(train: Train) -> tuple[Param, ...]:
    """Return the numbers of a drive as parameters of its continuous problem."""
    count = len(train.stages)
    numbers = train.numbers()
    units = _PARAMETER_UNITS | {limit.name: limit.unit for limit in train.law.limits}
    return tuple(
        Param(
            name,
            units.get(name, ""),
            value,
            count if isinstance(value, tuple) else 1,
            train.keys.get(name, ""),
            role=_role(train, name, "data"),
        )
        for name, value in numbers.items()
    )


def movable(train: Train) -> Problem:
    """Return the limits of `exact_text` with every given number as one that may be moved.

    Wheel teeth that are given are variables, one component per stage that gives them; the
    proportion b/d1 of tied widths is a given parameter. The objective means nothing.
    """
    text = exact_text(train)
    wheels = given_wheels(train)
    numbers = tuple(replace(q, role=_role(train, q.name, "given")) for q in text.parameters)

    def evaluate(x: Any, p: Any) -> Terms:
        terms = text.evaluate(x, p)
        teeth = zip(wheels, each(x.wheel_teeth) if wheels else (), strict=True)
        rows = {
            f"wheel_teeth[{k + 1}]": each(x.pinion_teeth)[k] * each(x.ratio)[k] / z
            for k, z in teeth
        }
        return Terms({"module": each(x.module)[0]}, terms.limits, equal={**terms.equal, **rows})

    columns = _with_wheels(train) if wheels else text.variables
    return Problem("sizing", columns, numbers, evaluate)


def relaxed(train: Train) -> Problem:
    """Return `movable` of a drive that is at least as easy and convex in logarithms.

    A law that is no posynomial gives way to its lower bound, a ratio without tolerance to a band.
    """
    law = train.law.relaxed or train.law
    return movable(replace(train, law=law, tolerance=train.tolerance or BAND))


def given_wheels(train: Train) -> tuple[int, ...]:
    """Return the stages (from 0) whose wheel teeth are given."""
    return tuple(k for k, stage in enumerate(train.stages) if stage.wheel_fixed)


def _with_wheels(train: Train) -> tuple[Var, ...]:
    """Return the variables with ratios free and given wheel teeth as a block of their own."""
    count = len(train.stages)
    teeth = tuple(float(train.stages[k].wheel_teeth[0]) for k in given_wheels(train))
    low, high = ((end,) * count for end in RATIO)

    def free(v: Var) -> Var:
        guess = tuple(max(u, RATIO[0]) for u in each(v.guess))
        return replace(v, lower=low, upper=high, guess=guess)

    freed = (free(v) if v.name == "ratio" else v for v in variables(train))
    return (*freed, Var("wheel_teeth", "", teeth, teeth, teeth, len(teeth), log=True, search=True))


def _role(train: Train, name: str, tied: str) -> str | tuple[str, ...]:
    """Return the role of a parameter: the ratio is a duty; `tied`: that of a width tied to d1."""
    if name in ("width_low", "width_high"):
        return tuple(tied if s.face_width.tied else "limit" for s in train.stages)
    if name in ("lowest_ratio", "highest_ratio", "torque"):
        return "given"
    return "limit" if name in train.by_stage else "data"


def pairs(train: Train, point: Array) -> tuple[GearPair, ...]:
    """Return the gear pairs of a point of `exact_text`."""
    x = namespace(variables(train), [float(v) for v in point])
    return text_pairs(train, x, SimpleNamespace(**train.numbers()))


def text_pairs(train: Train, x: Any, numbers: Any) -> tuple[GearPair, ...]:
    """Return the gear pairs of the variables x of the text.

    numbers: `train.numbers()` as attributes, floats or parameters.
    """
    gear_pairs = []
    for k, stage in enumerate(train.stages):
        m, z, u = each(x.module)[k], each(x.pinion_teeth)[k], each(x.ratio)[k]
        cut, cosine = stage.toothing, each(numbers.helix_cosine)[k]
        if stage.ranges:
            cut = stage.cut(**{name: each(getattr(x, name))[k] for name in stage.ranges})
            cosine = np.cos(cut.helix_angle)
        d = reference_diameter(m / cosine, z)
        if stage.face_width.tied:
            width = each(numbers.width_high)[k] * reference_diameter(m / cosine, z)
        else:
            width = each(x.face_width)[k]
        gear_pairs.append(cut.of_diameter(m, z, d, u, width))
    return tuple(gear_pairs)


def variables(train: Train) -> tuple[Var, ...]:
    """Return the variables of the continuous problem of a drive."""
    columns: dict[str, list[tuple[float, float, float]]] = {name: [] for name in VARIABLES}
    lengths = _lengths(train)
    numbers = SimpleNamespace(**train.numbers())
    ratios = [float(train.ratio) ** (1.0 / len(train.stages))] * len(train.stages)
    for k, stage in enumerate(train.stages):
        if stage.pinion_fixed and stage.wheel_fixed:
            ratios[k] = numbers.wheel_low[k] / max(1.0, numbers.pinion_low[k])
    over_input = torque_ratios(ratios, train.drivers)
    for k, stage in enumerate(train.stages):
        given = stage.pinion_fixed and stage.wheel_fixed
        z = max(1.0, numbers.pinion_low[k])
        u, torque = ratios[k], train.torque * over_input[k][0]
        proportion = min(numbers.width_high[k], 1.0)
        cosine = numbers.helix_cosine[k]
        unit = stage.toothing.by_reference.of_diameter(cosine / z, z, 1.0, u, proportion)
        law = train.law if stage.allowable else K_FACTOR
        allowable = (stage.allowable or (TYPICAL,))[0]
        load = law.indices(unit, torque, train.speed_at(torque))[0] / allowable
        d = load ** (1.0 / 3.0)
        m_fixed = len(stage.modules) == 1
        m = numbers.module_low[k] if m_fixed else d * cosine / z
        b_fixed = stage.face_width.fixed
        columns["module"].append(_column(lengths, m, m_fixed))
        columns["pinion_teeth"].append(_column(TEETH, z, stage.pinion_fixed))
        columns["ratio"].append(_column(RATIO, u, given))
        width = proportion * d if b_fixed is None else float(b_fixed)
        columns["face_width"].append(
            _column(lengths, width, b_fixed is not None or stage.face_width.tied)
        )
    if all(s.face_width.tied for s in train.stages):
        del columns["face_width"]
    posed = []
    for name, rows in columns.items():
        low, high, guess = zip(*rows, strict=True)
        posed.append(Var(name, VARIABLES[name], low, high, guess, len(rows), log=True, search=True))
    return (*posed, *_ranged(train))


def _ranged(train: Train) -> list[Var]:
    """Return the variables of toothings, one component a stage, where a stage has a range."""
    chosen = []
    for name, unit in RANGED.items():
        given = [getattr(stage.toothing, name) or 0.0 for stage in train.stages]
        ends = [s.ranges.get(name, (n, n)) for s, n in zip(train.stages, given, strict=True)]
        if any(name in stage.ranges for stage in train.stages):
            low, high = zip(*ends, strict=True)
            guess = tuple(0.5 * (a + b) for a, b in ends)
            chosen.append(Var(name, unit, low, high, guess, len(ends)))
    return chosen


def _lengths(train: Train) -> tuple[float, float]:
    """Ends [mm] of searched modules and widths, far beyond the file's own limits.

    Finite, for the dual bound. A stage's size follows (T/s)^(1/3) at its torque, for a limit s.
    """
    sizes = [
        (torque / limit) ** (1.0 / 3.0)
        for stage in train.stages
        for torque in train.torques
        for limit in stage.allowable or (TYPICAL,)
    ]
    for stage in train.stages:
        face = stage.face_width
        given = (*stage.modules, face.fixed, face.least, stage.wheel_diameter)
        sizes += [float(length) for length in given if length]
    return min(sizes) / SEARCH_SPAN, max(sizes) * SEARCH_SPAN


def _column(bounds: tuple[float, float], guess: float, fixed: bool) -> tuple[float, float, float]:
    if fixed:
        return guess, guess, guess
    return bounds[0], bounds[1], min(max(guess, bounds[0]), bounds[1])


def terms(
    train: Train,
    numbers: Any,
    pairs: tuple[GearPair, ...],
    options: Sequence[Any] = (),
    rated: Callable[..., Mapping[str, Any]] | None = None,
    shares: Callable[..., Any] = objective_share,
) -> Terms:
    """Return objective and limits of a drive made of these pairs, as terms of a geometric program.

    numbers: `train.numbers()` as attributes, floats or parameters; options: of every stage, counted
    from 0, floats or arrays; none: the first. rated(stage, pair, torque, speed, safety): limits in
    the place of those of the ratings. shares: what stages add to the objective. A limit is left out
    where the drive leaves it open or fixes the quantity.
    """
    totals: dict[str, Any] = dict.fromkeys(train.objectives, 0.0)
    over_input = torque_ratios([pair.ratio for pair in pairs], train.drivers)
    limits: dict[str, Any] = {}
    equal: dict[str, Any] = {}
    for k, pair in enumerate(pairs):
        of_stage = {name: each(getattr(numbers, name))[k] for name in train.by_stage}
        stage, option = train.stages[k], options[k] if options else 0
        chosen = np.rint(option).astype(int)
        asked = np.flatnonzero(np.bincount(chosen.ravel()))  # np.unique would load numpy.ma
        option = np.searchsorted(asked, chosen)
        for name in totals:
            worth = [shares(train, k, pair, numbers.density, one, name) for one in asked]
            totals[name] = totals[name] + _chosen(worth, option)
        allowable = [of_stage[name] for name in train.law.names]
        torque, speed = numbers.torque * over_input[k][0], numbers.speed / over_input[k][0]
        rows = train.law.utilisations(pair, torque, speed, allowable)
        if stage.options:
            times = stage.safety
            safety = numbers.bending_safety * times[0], numbers.contact_safety * times[1]
            load = torque, speed
            if rated is not None:
                rows |= rated(k, pair, *load, safety)
            else:
                by_option = [stage.options[o].utilisations(pair, *load, safety) for o in asked]
                rows |= {
                    name: _chosen([r[name] for r in by_option], option) for name in by_option[0]
                }
        rows |= _choices(stage, of_stage, pair)
        if stage.overlap:
            rows["overlap_ratio"] = stage.width_of_overlap(pair) / pair.face_width
        if math.isfinite(stage.axial_force):
            rows["axial_force"] = stage.axial_use(pair, torque)
        if stage.toothing.shifting is not None:
            rows |= stage.toothing.shifting.used(pair)
        if stage.wheel_fixed and not stage.pinion_fixed:
            equal[f"wheel_teeth[{k + 1}]"] = pair.wheel_teeth / of_stage["wheel_low"]
        limits |= {f"{name}[{k + 1}]": value for name, value in rows.items()}
    product = math.prod(pair.ratio for pair in pairs)
    ends = ("ratio_low", "ratio_high") if train.driver == "pinion" else ("ratio_high", "ratio_low")
    if train.tolerance > 0:
        limits[ends[0]] = numbers.lowest_ratio / product
        limits[ends[1]] = product / numbers.highest_ratio
    else:
        equal["ratio"] = product / numbers.highest_ratio
    return Terms(totals, limits, equal=equal)


def _chosen(values: Sequence[Any], option: Any) -> Any:
    """Return the value of an option, by its place among the values."""
    return values[0] if len(values) == 1 else np.choose(option, values)


def _choices(stage: Stage, own: dict[str, Any], pair: GearPair) -> dict[str, Any]:
    """Return the limits of a stage on its module, teeth, ratio, face width and wheel."""
    limits: dict[str, Any] = {}

    def between(name: str, value: Any, low: Any, high: Any) -> None:
        """Add the ends of a range; None where there is none."""
        limits.update({} if low is None else {f"{name}_low": low / value})
        limits.update({} if high is None else {f"{name}_high": value / high})

    face, d = stage.face_width, pair.pinion.reference_diameter
    if not face.tied:
        low = own["width_low"] * d if face.low > 0 else None
        high = None if face.high is None else own["width_high"] * d
        between("face_width_over_diameter", pair.face_width, low, high)
    ends = (own[n] if end else None for n, end in zip(WIDTHS[:2], face.over_module, strict=True))
    between("face_width_over_module", pair.face_width / pair.normal_module, *ends)
    if face.least:
        limits["minimum_face_width"] = own["least_width"] / pair.face_width
    if len(stage.modules) > 1:
        between("module", pair.normal_module, own["module_low"], own["module_high"])
    if not stage.pinion_fixed:
        high = None if stage.pinion_teeth[1] is None else own["pinion_high"]
        between("pinion_teeth", pair.pinion_teeth, own["pinion_low"], high)
    if not stage.wheel_fixed:
        low = own["wheel_low"] if stage.wheel_teeth[0] > 1 else None
        high = None if stage.wheel_teeth[1] is None else own["wheel_high"]
        between("wheel_teeth", pair.wheel_teeth, low, high)
    given = stage.pinion_fixed and stage.wheel_fixed  # then no bound of a variable keeps u >= 1
    low = own["ratio_low"] if stage.ratio[0] > 1 or given else None
    between("stage_ratio", pair.ratio, low, None if stage.ratio[1] is None else own["ratio_high"])
    if stage.wheel_diameter is not None:
        limits["wheel_diameter"] = pair.wheel.reference_diameter / own["wheel_diameter"]
    return limits
