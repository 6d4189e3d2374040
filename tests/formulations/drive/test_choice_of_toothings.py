"""Stages whose teeth may be cut in several ways: against every way alone."""

import math
from dataclasses import replace
from fractions import Fraction as F
from itertools import product

import numpy as np
import pytest
from rated_drives import agma, by, iso, rated_drive

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth
from gearopt.optimise.pareto.measures import unbeaten
from gearopt.optimise.result import Budget
from gearopt.physics.gears import GearPair

FREE = FaceWidth(F(3, 10), F(1))
SPUR_TOO = (0.0, 8.0, 25.0)  # degrees


def cut(train, *angles):
    """The drive with helix angles [degrees] to choose from, those of each stage."""
    rows = zip(train.stages, angles, strict=True)
    made = [
        replace(s, toothings=tuple(replace(s.toothing, helix_angle=math.radians(h)) for h in each))
        for s, each in rows
    ]
    return replace(train, stages=tuple(made))


def every_way(train, *angles):
    """The drive with each combination of helix angles alone."""
    return [cut(train, *([h] for h in one)) for one in product(*angles)]


def exact(train, count=1):
    problem = teeth.problem(train, count)
    return problem, problem.methods["exact"](problem, Budget(), 0, None)


def values(train, count=1):
    """Teeth and objective of the best trains."""
    problem, outcome = exact(train, count)
    points = [] if outcome.x is None else [outcome.x, *outcome.others]
    names = [tuple((g.pinion_teeth, g.wheel_teeth) for g in teeth.pairs(train, x)) for x in points]
    rows = problem.batch(np.array(points)) if points else None
    return {} if rows is None else dict(zip(names, rows.F[:, 0].tolist(), strict=True))


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("options", "angles", "face"),
    [
        pytest.param(by("agma"), ((0.0, 25.0), (8.0,)), FREE, marks=SLOW),
        (by("iso", "agma"), ((0.0, 12.0),), FaceWidth(F(1, 2), F(1, 2))),
        pytest.param(by("iso"), ((8.0, 15.0),), FaceWidth(F(3, 10), F(1), F(2)), marks=SLOW),
    ],
)
def test_the_best_toothing_is_that_of_all_of_them(options, angles, face):
    stages = len(angles)
    made = rated_drive(F(3) ** stages, [face] * stages, options=options, pinion_teeth=(17, 18))
    problem, outcome = exact(cut(made, *angles))
    value = problem.batch(outcome.x[None])
    each = [min(values(one).values(), default=np.inf) for one in every_way(made, *angles)]
    assert value.F[0, 0] == pytest.approx(min(each), rel=1e-12)
    assert value.G.max() <= 1.0 + 1e-9
    found = [math.degrees(p.pinion.helix_angle) for p in teeth.pairs(cut(made, *angles), outcome.x)]
    assert found == pytest.approx(list(product(*angles))[int(np.argmin(each))])


@pytest.mark.slow
def test_a_list_of_trains_has_every_train_with_its_best_toothing():
    made = rated_drive(3, [FREE], options=by("agma"), pinion_teeth=(17, 19))
    found = values(cut(made, SPUR_TOO), 5)
    known: dict[tuple, float] = {}
    for one in every_way(made, SPUR_TOO):
        for name, value in values(one, 5).items():
            known[name] = min(value, known.get(name, math.inf))
    best = sorted(known.items(), key=lambda row: row[1])[:5]
    assert list(found) == [name for name, _ in best]
    assert list(found.values()) == pytest.approx([value for _, value in best], rel=1e-12)


@SLOW
def test_a_front_is_that_of_all_toothings():
    made = rated_drive(3, [FREE], options=by("agma"), pinion_teeth=(17, 18))
    made = replace(made, objective="gear_volume", others=("mesh_loss",))

    def front(train):
        problem, outcome = exact(train)
        return problem.batch(np.array([outcome.x, *outcome.others])).F

    every = np.vstack([front(one) for one in every_way(made, SPUR_TOO)])
    expected = every[unbeaten(every)]
    found = front(cut(made, SPUR_TOO))
    assert np.sort(found, axis=0) == pytest.approx(np.sort(expected, axis=0), rel=1e-12)


def test_toothings_of_a_stage_are_alike_but_for_helix_and_distance():
    made = rated_drive(3, [FREE])
    stage = made.stages[0]
    with pytest.raises(ValueError, match="alone"):
        replace(stage, toothings=(Toothing(0.1), Toothing(0.2, profile_shifts=(0.1, 0.0))))
    several = replace(stage, toothings=(Toothing(0.1), Toothing(0.2)), options=())
    with pytest.raises(ValueError, match="ratings alone"):
        replace(made, stages=(several,))


@pytest.mark.parametrize("standard", [agma(), iso()])
def test_tables_of_several_helix_angles_are_those_of_each(standard):
    angles = np.radians([0.0, 20.0, 8.0, 0.0, 20.0])
    z1, z2 = np.array([17.0, 18.0, 23.0, 30.0, 21.0]), np.array([50.0, 80.0, 24.0, 45.0, 90.0])
    table = standard.prepared(GearPair.of_teeth(np.full(5, 2.0), z1, z2, 1.0, angles))

    def used(prepared, helix, rows):
        pair = GearPair.of_teeth(np.full(len(rows), 2.0), z1[rows], z2[rows], 1.0, helix)
        torque = np.full(len(rows), 2e4)
        made = standard.rows(prepared, pair, (torque,) * 2, (150.0 + 0 * torque,) * 2, (1.4, 1.1))
        return [made.used(w, w) for w in (np.full(len(rows), 10.0), np.full(len(rows), 60.0))]

    together = np.array(used(table, angles, np.arange(5)))
    for helix in np.unique(angles):
        rows = np.flatnonzero(angles == helix)
        pair = GearPair.of_teeth(np.full(len(rows), 2.0), z1[rows], z2[rows], 1.0, float(helix))
        alone = used(standard.prepared(pair), float(helix), rows)
        assert together[:, rows] == pytest.approx(np.array(alone), rel=1e-12)
