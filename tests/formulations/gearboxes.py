"""Gearboxes for the layout tests: published trains, random ones, and the plain law of a layout."""

import math
from fractions import Fraction as F
from functools import cache
from itertools import product

import numpy as np
from brute_force import k_factor_width, width

from gearopt.formulations.drive.gearbox import Clearances, Gearbox, Shaft
from gearopt.formulations.drive.layout.chain import chain, turns
from gearopt.formulations.drive.layout.slabs import arrangements, clashes
from gearopt.formulations.drive.teeth.search import within
from gearopt.formulations.drive.teeth.tables import table
from gearopt.optimise.kernels import kernel
from gearopt.physics.gears import GearPair

HELIX = math.radians(25.0)
MODULES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0)
THREE, TWO = (8.0, 15.0, 22.5, 35.0), (10.0, 17.5, 30.0)  # shaft radii
TRAINS = {  # module, teeth, face width; shaft radii
    "table4_p1": (((1.5, 27, 229, 26.8), (3, 26, 105, 47.8), (4, 27, 87, 95.3)), THREE),
    "table4_p2": (((1.25, 27, 237, 22.34), (3, 26, 109, 51.6), (4, 27, 80, 95.3)), THREE),
    "discrete": (((1.5, 21, 162, 20.854), (3, 21, 89, 41.708), (4, 24, 80, 79.443)), THREE),
    "elevator_p1": (((2, 25, 124, 33.1), (3, 25, 109, 62.1)), TWO),
    "elevator": (((2, 21, 115, 27.805), (3, 23, 91, 57.1)), TWO),
}


def gearbox(name, clearances=Clearances(), **given):  # noqa: B008 -- frozen
    rows, radii = TRAINS[name]
    return Gearbox(
        tuple(GearPair.of_teeth(*row, HELIX) for row in rows),
        tuple(Shaft(r) for r in radii),
        clearances,
        **given,
    )


def some_box(seed, stages=None, **given):
    """A random train as one would build it, its stages in order; every other one partial."""
    rng = np.random.default_rng(seed)
    stages = int(rng.integers(2, 6)) if stages is None else stages
    given = {"partial": bool(rng.integers(2)), "slabs": tuple((k,) for k in range(stages))} | given
    while True:
        size, torque = int(rng.integers(0, 4)), rng.uniform(5.0, 50.0)
        pairs, shafts = [], [Shaft(2.0 * torque ** (1 / 3))]
        for _ in range(stages):
            module, z1 = MODULES[min(size, len(MODULES) - 1)], int(rng.integers(18, 41))
            u = rng.uniform(2.0, 8.0 if stages < 4 else 5.0)
            helix = math.radians(rng.choice([0.0, 15.0, 25.0]))
            width = rng.uniform(0.5, 1.0) * module * z1 / math.cos(helix)
            pairs.append(GearPair.of_teeth(module, z1, round(u * z1), width, helix))
            torque *= u
            shafts.append(Shaft(2.0 * torque ** (1 / 3)))
            size += int(rng.integers(1, 4))
        free = Clearances(*(rng.uniform(0.0, most) for most in (10.0, 5.0, 20.0, 15.0)))
        box = Gearbox(tuple(pairs), tuple(shafts), free, **given)
        if not clashes(box, arrangements(box)[0]):
            return box


def places(chain, theta):
    """Y and z (P, N + 1) of the shafts for angles (P, N)."""
    steps = np.stack([chain.link * np.cos(theta), chain.link * np.sin(theta)])
    at = np.concatenate([np.zeros((2, len(theta), 1)), np.cumsum(steps, axis=2)], axis=2)
    return at[0], at[1]


def law(chain, m, y, z):
    """Objective and what is missing (P,) of shafts at y, z (P, N + 1), from the definitions."""
    width = (y + chain.reach).max(1) - (y - chain.reach).min(1)
    height = (z + chain.reach).max(1) - (z - chain.reach).min(1)
    short = np.zeros(len(y)) + max(0.0, chain.length[m] - chain.most[2])
    count = y.shape[1]
    for i in range(count):
        for j in range(i + 1, count):
            there = np.hypot(y[:, i] - y[:, j], z[:, i] - z[:, j])
            short += np.maximum(chain.apart[m, i, j] - there, 0.0)
        for c, ends in ((y[:, i], chain.place[i, :2]), (z[:, i], chain.place[i, 2:])):
            short += np.maximum(ends[0] - c, 0.0) + np.maximum(c - ends[1], 0.0)
        for k, (left, right, bottom, top) in enumerate(chain.keep):
            past = np.hypot(
                y[:, i] - y[:, i].clip(left, right), z[:, i] - z[:, i].clip(bottom, top)
            )
            short += np.maximum(chain.keep_apart[m, k, i] - past, 0.0)
    for k in chain.level[1:]:
        short += np.abs(z[:, k] - z[:, chain.level[0]])
    short += np.maximum(width - chain.most[0], 0.0) + np.maximum(height - chain.most[1], 0.0)
    if chain.longest:
        return np.maximum(np.maximum(width, height), chain.factor[m]), short
    return chain.factor[m] * width ** chain.power[0] * height ** chain.power[1], short


def face_width(stage, torque, module, teeth, needed=k_factor_width):
    """Minimum face width [mm] of one choice; None where a limit forbids it."""
    d, u = float(module) * teeth[0] / math.cos(stage.toothing.helix_angle), teeth[1] / teeth[0]
    if stage.wheel_diameter is not None and d * u > float(stage.wheel_diameter):
        return None
    load = needed(stage, torque, d, float(module), u)
    b = width(stage, F(module), np.array([teeth[0]]), load).item()
    return b if b < math.inf else None


def every(train, needed=k_factor_width, narrowest=None):
    """Gear pairs of all trains with every module that carries the load.

    needed(stage, torque, d, m, u): the face width that the load needs. narrowest(k, torque, module,
    teeth): in its place the minimum face width of a choice for stage k, or None.
    """
    found = []

    def of(k, torque, module, teeth):
        return face_width(train.stages[k], torque, module, teeth, needed)

    def go(k, torque, ratio, rows):
        if k == len(train.stages):
            found.append(tuple(rows))
            return
        stage, last = train.stages[k], k == len(train.stages) - 1
        for z1 in range(stage.pinion_teeth[0], stage.pinion_teeth[1] + 1):
            most = min(train.highest_ratio / ratio, stage.ratio[1] or math.inf)
            least = max(z1, math.ceil(train.lowest_ratio / ratio * z1) if last else z1)
            for z2 in range(least, min(math.floor(most * z1), stage.wheel_teeth[1]) + 1):
                u = F(z2, z1)
                if train.coprime and math.gcd(z1, z2) > 1:
                    continue
                for module in stage.modules:
                    b = (narrowest or of)(k, torque, module, (z1, z2))
                    if b is not None:
                        row = train.pair(k, float(module), float(z1), float(z2), b)
                        go(k + 1, torque * z2 / z1, ratio * u, [*rows, row])

    go(0, train.torque, F(1), [])
    return found


def every_row(train):
    """Gear pairs of all trains of rows of the tables of teeth, as narrow as their rating allows."""
    tables = [table(train, k, train.highest_ratio) for k in range(len(train.stages))]
    rows = [
        [(p, m) for p in range(len(t.z1)) for m in range(t.first[p], t.last[p] + 1)] for t in tables
    ]

    @cache
    def width(k, p, m, torque):
        return tables[k].width(np.array([torque]), np.array([p]), m).item()

    for chosen in product(*rows):
        teeth = [(int(t.z1[p]), int(t.z2[p])) for t, (p, _) in zip(tables, chosen, strict=True)]
        cuts = [t.toothing[p] for t, (p, _) in zip(tables, chosen, strict=True)]
        stages = zip(train.stages, cuts, strict=True)
        distances = tuple(stage.toothings[cut].working_distance for stage, cut in stages)
        if not within(train, teeth) or train.distances and distances not in train.distances:
            continue
        torque, pairs = train.torque, []
        for k, (t, (p, m)) in enumerate(zip(tables, chosen, strict=True)):
            b = width(k, p, m, torque)
            pairs.append(train.pair(k, float(t.modules[m]), *map(float, teeth[k]), b, cuts[k]))
            torque *= teeth[k][1] / teeth[k][0]
        if all(math.isfinite(pair.face_width) for pair in pairs):
            yield tuple(pairs)


def smallest_box(train, make, rel, needed=k_factor_width, narrowest=None):
    """The minimum objective of all trains in all arrangements, within rel; inf if none fits."""
    return smallest_around(every(train, needed, narrowest), make, rel)


def smallest_around(trains, make, rel):
    """The same of trains of gear pairs that are known."""
    branch = kernel("gearopt.formulations.drive.layout.branch_kernel").branch
    best = math.inf
    for pairs in trains:
        links = len(pairs)
        theta, cells, bounds = np.zeros(links), np.zeros((4000, 2, links)), np.zeros(4000)
        box = make(pairs)
        for order in arrangements(box):
            if clashes(box, order):
                continue
            shape, count, bounds[0] = chain(box, (order,)), 1, 0.0
            cells[0, 0], cells[0, 1], cells[0, :, 0] = -math.pi, math.pi, turns(box)
            while count:
                count, best, _, _, nodes = branch(
                    shape, 0, cells, bounds, count, best, 0.0, math.inf, rel, 100_000, theta
                )
                assert nodes
    return best
