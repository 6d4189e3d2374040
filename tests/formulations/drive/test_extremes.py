"""Least axial force, specific sliding and inverse contact ratio, against every design by hand."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from campaigns import few
from rated_brute_force import safe, widths
from rated_drives import agma, some_iso, some_rated_drive

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.teeth import load_front
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.search import within
from gearopt.formulations.drive.train import EXTREMES
from gearopt.optimise.pareto.objectives import Limiting
from gearopt.optimise.pareto.tradeoff import found
from gearopt.optimise.solve import run

PLAIN = ("tied", "stepped", "fixed")  # widths that can be listed
TWO_STAGES = (40, 43, 44, 47, 49, 63)  # seeds of few candidates


def tip(z, module, beta):
    """Base and tip radius [mm] of a gear without shift, and its transverse pressure angle."""
    angle = math.atan(math.tan(math.radians(20.0)) / math.cos(beta))
    r = 0.5 * module * z / math.cos(beta)
    return r * math.cos(angle), r + module, angle


def by_hand(name, torque, beta, module, z1, z2, b):
    """An extreme of a pair of ISO 53 teeth: on radii of curvature along the line of action."""
    if name == "axial_force":
        return 2.0 * torque * math.sin(beta) / (module * z1)
    (base1, tip1, angle), (base2, tip2, _) = tip(z1, module, beta), tip(z2, module, beta)
    line = (base1 + base2) * math.tan(angle)
    outer = math.sqrt(tip1**2 - base1**2), math.sqrt(tip2**2 - base2**2)
    if name == "specific_sliding":
        inner = line - outer[1], line - outer[0]  # radii of curvature at both roots
        if min(inner) <= 0.0:
            return math.inf
        u = z2 / z1
        return max(outer[1] / (u * inner[0]) - 1.0, outer[0] * u / inner[1] - 1.0)
    pitch = 2.0 * math.pi * base1 / z1
    return 1.0 / ((sum(outer) - line) / pitch + b * math.sin(beta) / (math.pi * module))


def every_pair(train, k, name, torque):
    """Extreme, volume and pair of all pairs, modules and widths of a stage, rated or not."""
    stage, beta = train.stages[k], abs(train.stages[k].toothing.helix_angle)
    for z1, start, stop in spans(train, k, train.highest_ratio):
        for z2, m in product(range(start, stop + 1), map(float, stage.modules)):
            for b in map(float, widths(train, k, m, z1)):
                d = m * z1 / math.cos(beta)
                volume = 0.25 * math.pi * b * d**2 * (1.0 + (z2 / z1) ** 2)
                yield by_hand(name, torque, beta, m, z1, z2, b), volume, (m, z1, z2, b)


def least(train, name):
    """The least extreme of all drives that are safe; inf: there is none."""

    def onward(k, torque, chosen, before, most):
        if k == len(train.stages):
            return before if within(train, chosen) else math.inf
        best, last = most, k == len(train.stages) - 1
        for own, _, (m, z1, z2, b) in sorted(every_pair(train, k, name, torque)):
            if max(own, before) >= best:
                break
            if last and not within(train, (*chosen, (z1, z2))):
                continue
            if safe(train, k, train.pair(k, m, z1, z2, b), torque):
                teeth_ = (*chosen, (z1, z2))
                value = onward(k + 1, torque * (z2 / z1), teeth_, max(own, before), best)
                best = min(best, value)
        return best

    return onward(0, train.torque, (), 0.0, math.inf)


SMALL = [(1, seed) for seed in range(14)] + [(2, seed) for seed in TWO_STAGES]


@pytest.mark.parametrize(
    ("size", "name"), few(product(SMALL, EXTREMES), [((1, 4), "inverse_contact_ratio")])
)
def test_the_least_extreme_is_that_of_every_design(size, name):
    stages, seed = size
    train = some_rated_drive(seed, stages, PLAIN, (agma, some_iso)[seed % 2])
    train = replace(train, objective="gear_volume")
    result, outcome = run(load_front.limited(train, name, {}, name))
    best = least(train, name)
    assert result.status == ("optimal" if math.isfinite(best) else "infeasible")
    if math.isfinite(best):
        assert result.value == pytest.approx(best, rel=1e-6, abs=1e-9)
        assert result.bound <= best * (1.0 + 1e-11) and outcome.proof["method"] == "exhausted"


@pytest.mark.parametrize(("seed", "name"), few(product(range(8), EXTREMES), [(2, "axial_force")]))
def test_fronts_against_an_extreme_hold_every_design(seed, name):
    """Of one stage: no design is left out, and the least volume of the least extreme is shown."""
    train = some_rated_drive(seed, 1, PLAIN, (agma, some_iso)[seed % 2])
    train, names = replace(train, objective="gear_volume"), ("gear_volume", name)
    limiting = Limiting(
        lambda aim, most: load_front.limited(train, aim, most, name),
        names,
        load_front.discrete(train),
    )
    made = found(load_front.problem(train, names), names, {}, None, limiting=limiting)
    rows, best = [], math.inf
    for own, volume, (m, z1, z2, b) in sorted(
        every_pair(train, 0, name, train.torque), key=lambda row: row[1]
    ):
        fit = within(train, ((z1, z2),)) and own < best * (1.0 - 1e-9)
        if fit and safe(train, 0, train.pair(0, m, z1, z2, b), train.torque):
            rows, best = [*rows, (volume, own)], own
    assert made.complete and len(made.points) == len(rows) > 0
    assert made.values == pytest.approx(np.array(rows), rel=1e-9, abs=1e-9)
    (value, outcome) = run(load_front.limited(train, name, {}, name))
    volume = teeth.problem(train).batch(outcome.x[None]).F[0, 0]
    assert (volume, value.value) == pytest.approx(rows[-1], rel=1e-6, abs=1e-9)
