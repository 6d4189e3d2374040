"""Unpruned brute force over the trains of a drive, from the formulas, and random drives for it.

It lists every train whose ratio is allowed (in integers), sizes each with every module, and never
drops one for its objective.
"""

import math
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from blank_rings import volume

from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.physics.gears import MODULES

SAME = 1e-12  # objectives closer than this are ties; loads may exceed a limit by this much
ONE = Fraction(1)


@dataclass(frozen=True)
class Trains:
    """Complete trains: teeth (n, stages, 2), modules and widths (n, stages), objective (n,)."""

    teeth: np.ndarray
    modules: np.ndarray
    widths: np.ndarray
    values: np.ndarray

    def best(self) -> int:
        ties = np.flatnonzero(self.values <= self.values.min() * (1 + SAME))
        return min(ties, key=lambda i: (self.teeth[i].sum(), self.teeth[i].ravel().tolist()))


def floor_of(factor, above, below=1):
    """floor(factor * above / below) in integers, of any length where int64 could overflow."""
    big = max(abs(factor.numerator), factor.denominator) > 10**9
    above, below = (np.asarray(a).astype(object if big else np.int64) for a in (above, below))
    return (factor.numerator * above // (factor.denominator * below)).astype(np.int64)


def ceil_of(factor, above, below=1):
    return -floor_of(-factor, above, below)


def pairs(train, k, pinions, wheels):
    """Owner, z1, z2 of all pairs behind partial trains with these products of their teeth."""
    stage = train.stages[k]
    found = [np.empty((3, 0), np.int64)]
    for z in range(stage.pinion_teeth[0], stage.pinion_teeth[1] + 1):
        start = np.full(len(pinions), max(stage.wheel_teeth[0], math.ceil(stage.ratio[0] * z)))
        stop = floor_of(train.highest_ratio, pinions * z, wheels)
        if k == len(train.stages) - 1:
            start = np.maximum(start, ceil_of(train.lowest_ratio, pinions * z, wheels))
        if stage.wheel_teeth[1] is not None:
            stop = np.minimum(stop, stage.wheel_teeth[1])
        if stage.ratio[1] is not None:
            stop = np.minimum(stop, math.floor(stage.ratio[1] * z))
        length = np.maximum(stop - start + 1, 0)
        owner = np.repeat(np.arange(len(pinions)), length)
        first = np.repeat(np.cumsum(length) - length, length)
        wheel = start[owner] + np.arange(len(owner)) - first
        found.append(np.stack([owner, np.full(len(owner), z), wheel]))
    owner, z1, z2 = np.concatenate(found, axis=1)
    keep = np.gcd(z1, z2) == 1 if train.coprime else np.full(len(z1), True)
    return owner[keep], z1[keep], z2[keep]


def side(toothing, module, teeth, length):
    """Sign of diameter - length; exact for spur gears."""
    if toothing.helix_angle:
        return np.sign(float(module) * teeth / math.cos(toothing.helix_angle) - float(length))
    limit = length / module
    return (teeth > math.floor(limit)) * 1 - (teeth < math.ceil(limit)) * 1


def width(stage, module, z1, needed):
    """Least face width that carries the load, inf where the limits allow none."""
    face, toothing = stage.face_width, stage.toothing
    if not face.plain:
        return limited_width(stage, module, z1, needed)
    d = float(module) * z1 / math.cos(toothing.helix_angle)
    if face.fixed is not None:
        b = np.full(len(z1), float(face.fixed))
        allowed = needed <= b * (1 + SAME)
        if face.low > 0:
            allowed &= side(toothing, module, z1, face.fixed / face.low) <= 0
        if face.high is not None:
            allowed &= side(toothing, module, z1, face.fixed / face.high) >= 0
    elif face.step is None:
        b = np.clip(needed, float(face.low) * d, float(face.high) * d)
        allowed = needed <= float(face.high) * d * (1 + SAME)
    else:
        step = float(face.step)
        if toothing.helix_angle:
            low, high = np.ceil(float(face.low) * d / step), np.floor(float(face.high) * d / step)
        else:
            low = ceil_of(face.low * module / face.step, z1)
            high = floor_of(face.high * module / face.step, z1)
        steps = np.maximum(np.maximum(low, 1), np.ceil(needed / step * (1 - SAME)))
        b, allowed = steps * step, steps <= high
    return np.where(allowed, b, np.inf)


def limited_width(stage, module, z1, needed):
    """`width` where b/m and b are limited too: row by row, in fractions of the diameter."""
    face, found = stage.face_width, []
    for z, load in zip(z1.tolist(), np.broadcast_to(needed, len(z1)).tolist(), strict=True):
        d = module * z / Fraction(math.cos(stage.toothing.helix_angle))
        ends = [e * module for e in face.over_module]
        low, high = max(face.low * d, ends[0], face.least), min(face.high * d, ends[1])
        step = face.step
        if face.fixed is not None:
            allowed = low <= face.fixed <= high and load <= face.fixed * (1 + SAME)
            found.append(float(face.fixed) if allowed else math.inf)
        elif step is not None:
            loaded = min(load, 1e9) / float(step) * (1 - SAME)
            steps = max(1, math.ceil(low / step), math.ceil(loaded))
            found.append(steps * float(step) if steps <= math.floor(high / step) else math.inf)
        else:
            allowed = low <= high and load <= float(high) * (1 + SAME)
            found.append(min(max(load, float(low)), float(high)) if allowed else math.inf)
    return np.array(found)


def weight(train, k, d, b, u, module):
    """Mass of a stage whose gears have webs or bores, one by one."""
    each = zip(d, b, d * u, strict=True)
    blanks = train.stages[k].blanks
    pairs = [
        sum(volume(o, module, e, b) for o, e in zip(blanks, (d, f), strict=True))
        for d, b, f in each
    ]
    return 1000 * train.density * np.array(pairs)


def cost(train, k, d, b, u, module=None):
    """Share of a stage in the objective; module: of gears with webs."""
    if train.hollow:
        return weight(train, k, d, b, u, module)
    if train.objective in ("gear_volume", "mass"):
        density = 1.0 if train.objective == "gear_volume" else 1000 * train.density
        return density * math.pi / 4 * b * d**2 * (1 + u**2)
    length = d * (1 + u) / 2
    if train.objective == "total_length":
        length = length + (d / 2 if k == 0 else 0.0)
        length = length + (d * u / 2 if k == len(train.stages) - 1 else 0.0)
    return length


def k_factor_width(stage, torque, d, m, u):
    """Face width that K-factor and unit load need."""
    contact = 2 * torque / (d**2 * stage.allowable[0]) * (1 + 1 / u)
    return np.maximum(contact, 2 * torque / (d * m * stage.allowable[1]))


def best_choice(train, k, torque, z1, z2, needed=k_factor_width):
    """Least cost (inf: impossible) with its module and width, the smallest module of equal ones.

    needed(stage, torque, d, m, u): the face width that the load needs.
    """
    stage, u = train.stages[k], z2 / z1
    best, with_module, with_width = np.full(len(z1), np.inf), np.zeros(len(z1)), np.zeros(len(z1))
    for module in stage.modules:
        d = float(module) * z1 / math.cos(stage.toothing.helix_angle)
        load = needed(stage, torque, d, float(module), u)
        b = width(stage, module, z1, load)
        if stage.wheel_diameter is not None:
            b[side(stage.toothing, module, z2, stage.wheel_diameter) > 0] = np.inf
        value = np.where(np.isfinite(b), cost(train, k, d, b, u, float(module)), np.inf)
        better = value < best * (1 - SAME)
        best[better], with_width[better] = value[better], b[better]
        with_module[better] = float(module)
    return best, with_module, with_width


def every_train(train, needed=k_factor_width):
    """All trains that meet every limit."""
    teeth = np.empty((1, 0, 2), np.int64)
    modules = widths = np.empty((1, 0))
    values, torque = np.zeros(1), np.array([train.torque])
    for k in range(len(train.stages)):
        owner, z1, z2 = pairs(train, k, teeth[:, :, 0].prod(axis=1), teeth[:, :, 1].prod(axis=1))
        value, module, b = best_choice(train, k, torque[owner], z1, z2, needed)
        good = np.isfinite(value)
        owner, z1, z2 = owner[good], z1[good], z2[good]
        teeth = np.concatenate([teeth[owner], np.stack([z1, z2], axis=1)[:, None]], axis=1)
        modules = np.column_stack([modules[owner], module[good]])
        widths = np.column_stack([widths[owner], b[good]])
        values, torque = values[owner] + value[good], torque[owner] * z2 / z1
    return Trains(teeth, modules, widths, values)


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def some_width(rng, torque, k_limit):
    """A random way to choose b, for a stage that carries roughly this torque."""
    high = Fraction(int(rng.integers(30, 121)), 100)
    low = high * Fraction(int(rng.integers(0, 10)), 10)
    kind = rng.choice(["tied", "free", "stepped", "fixed"], p=[0.55, 0.15, 0.15, 0.15])
    if kind == "tied":
        return FaceWidth(high, high)
    if kind == "free":
        return FaceWidth(low, high)
    if kind == "stepped":
        return FaceWidth(low, high, step=Fraction(int(rng.choice([1, 2, 5]))))
    about = float(high) * (2.5 * torque / (k_limit * float(high))) ** (1 / 3)
    limits = [(low, high), (Fraction(0), None)][rng.integers(2)]
    return FaceWidth(*limits, fixed=Fraction(math.ceil(about * rng.uniform(0.8, 1.5))))


def some_stage(rng, torque, even, stages):
    """A random stage for roughly this torque and ratio; three-stage ones have few teeth."""
    series = MODULES[rng.choice(["ISO 54 I", "ISO 54 I+II"])]
    if rng.random() < 0.5:
        series = series[int(rng.integers(0, 6)) : len(series) - int(rng.integers(0, 4))]
    k_limit, u_limit = float(rng.uniform(0.5, 8)), float(rng.uniform(20, 150))
    face = some_width(rng, torque, k_limit)
    least = int(rng.integers(14, 26))
    most = least + int(rng.integers(4, 15) if stages == 2 else rng.integers(2, 5))
    wheels = (1, None) if stages == 2 else (30, int(least * even * rng.uniform(1.2, 1.6)) + 20)
    return Stage((k_limit, u_limit), face, series, (least, most), wheels)


def squeezed(rng, train, even):
    """The same drive with one limit so tight that it may be impossible."""
    kind = rng.choice(["wheel_diameter", "modules", "tolerance", "ratio"])
    if kind == "tolerance":
        return replace(train, tolerance=Fraction(int(rng.integers(0, 3)), 100_000), coprime=True)
    if kind == "ratio":
        cap = max(ONE, Fraction(round(100 * even * rng.uniform(0.9, 1.05)), 100))
        return replace(train, stages=tuple(replace(s, ratio=(ONE, cap)) for s in train.stages))
    last = train.stages[-1]
    torque = train.torque * float(train.ratio) / even
    d = (2.5 * torque / (last.allowable[0] * float(last.face_width.high or 1))) ** (1 / 3)
    if kind == "modules":
        largest = d / last.pinion_teeth[1] * rng.uniform(0.3, 1.5)
        few = [m for m in last.modules if m <= largest] or last.modules[:1]
        last = replace(last, modules=tuple(few[-2:]))
    else:
        last = replace(last, wheel_diameter=Fraction(round(d * even * rng.uniform(0.3, 1.5)) + 1))
    return replace(train, stages=(*train.stages[:-1], last))


def some_drive(number, stages):
    """A random drive: `number` is the seed."""
    rng = np.random.default_rng([stages, number])
    torque = 30e6 / math.pi * log_uniform(rng, 0.1, 500) / log_uniform(rng, 150, 3000)
    ratio = log_uniform(rng, 4, 60)
    ratio = Fraction(round(ratio)) if rng.random() < 0.3 else Fraction(round(100 * ratio), 100)
    even = float(ratio) ** (1 / stages)
    names = ["gear_volume", "sum_of_centre_distances", "total_length", "mass"]
    tolerance = Fraction(round(log_uniform(rng, 5, 300)), 10_000)
    made = tuple(some_stage(rng, torque * even**k, even, stages) for k in range(stages))
    helix = float(rng.choice([0.0, math.radians(rng.uniform(0, 30))]))
    train = Train(
        torque,
        ratio,
        tolerance,
        stages=tuple(replace(stage, toothings=(Toothing(helix),)) for stage in made),
        coprime=bool(rng.random() < 0.2),
        objective=str(rng.choice(names, p=[0.55, 0.2, 0.2, 0.05])),
        density=7.85e-9,
        law=K_FACTOR,
    )
    return squeezed(rng, train, even) if rng.random() < 0.7 else train


def own_teeth(train):
    """The drive with other teeth in every stage: the lengths are those of reference circles."""
    made = []
    for k, stage in enumerate(train.stages):
        helix, shift = stage.toothing.helix_angle, (0.0, 0.4, -0.2, 0.1)[k]
        shifts, tips = (shift, -shift), (0.0, -0.1 * (k % 2))
        own = Toothing((1.0, 0.6, -1.0, 0.3)[k] * helix + 0.1 * k, profile_shifts=shifts)
        made.append(replace(stage, toothings=(replace(own, tip_alterations=tips),)))
    return replace(train, stages=tuple(made))
