"""The exact search of `teeth` against an unpruned brute force, written from the formulas."""

import math
from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from brute_force import ONE, SAME, every_train, log_uniform, own_teeth, some_drive
from campaigns import few

from gearopt.formulations.drive.teeth import pairs, problem
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.solve import run


def teeth_of(train, point):
    """((z1, z2), ...), modules and widths of a point."""
    made = pairs(train, point)
    teeth = [[p.pinion_teeth, p.wheel_teeth] for p in made]
    return teeth, tuple(p.normal_module for p in made), tuple(p.face_width for p in made)


def agrees(train):
    """Assert that search and brute force agree; the search's result."""
    result, outcome = run(problem(train))
    trains = every_train(train)
    if not len(trains.values):
        assert result.status == "infeasible"
        assert result.value is None and outcome.x is None
        return result
    assert result.status == "optimal"
    best = trains.best()
    assert result.value == pytest.approx(trains.values.min(), rel=SAME)
    assert result.bound == pytest.approx(trains.values.min(), rel=SAME)
    teeth, module, b = teeth_of(train, outcome.x)
    assert teeth == trains.teeth[best].tolist()
    assert module == tuple(trains.modules[best])
    assert b == pytest.approx(trains.widths[best], rel=1e-9)
    return result


@cache
def agreed_status(number, stages):
    return agrees(some_drive(number, stages)).status


@pytest.mark.slow
@pytest.mark.parametrize("block", range(8))
def test_random_two_stage_drives(block):
    for number in range(25 * block, 25 * block + 25):
        assert agreed_status(number, 2) in ("optimal", "infeasible")  # after `agrees`


@pytest.mark.slow
def test_random_drives_with_other_teeth_in_every_stage():
    """One helix angle, shifts that cancel and shortened tips a stage."""
    found = [
        agrees(own_teeth(some_drive(n, stages))).status for n in range(20) for stages in (2, 3)
    ]
    assert found.count("infeasible") >= 5
    assert found.count("optimal") >= 20


def test_a_random_drive_with_other_teeth_in_every_stage():
    assert agrees(own_teeth(some_drive(3, 2))).status == "optimal"


@pytest.mark.slow
def test_random_two_stage_drives_are_possible_and_impossible():
    found = [agreed_status(number, 2) for number in range(200)]
    assert found.count("infeasible") >= 40
    assert found.count("optimal") >= 120


@pytest.mark.slow
def test_random_three_stage_drives():
    found = [agreed_status(number, 3) for number in range(20)]
    assert found.count("infeasible") >= 3
    assert found.count("optimal") >= 12


def lopsided(number):
    """Three stages of one pinion each whose loads and ratios are far from even."""
    rng, train = np.random.default_rng(number), some_drive(number, 3)
    stages = []
    for stage in train.stages:
        k, u, z = log_uniform(rng, 0.02, 50), log_uniform(rng, 5, 50), int(rng.integers(12, 26))
        own = {"allowable": (k, u * k), "pinion_teeth": (z, z), "wheel_teeth": (1, None)}
        stages.append(replace(stage, **own))
    stages[1] = replace(stages[1], face_width=FaceWidth(ONE * 0, ONE))
    return replace(train, tolerance=Fraction(1, 100), coprime=False, stages=tuple(stages))


@pytest.mark.slow
def test_lopsided_drives():
    """Some need a stage ratio three times the even one, beyond the search's first look."""
    found = [agrees(lopsided(number)) for number in range(60)]
    pairs = [(r.design["pinion_teeth"], r.design["wheel_teeth"]) for r in found if r.design]
    ratios = np.array([np.divide(z2, z1) for z1, z2 in pairs])
    assert (ratios.max(axis=1) > 3 * ratios.prod(axis=1) ** (1 / 3)).sum() >= 3


def spur(torque=1e5, ratio=Fraction(1), tolerance=Fraction(0), objective="gear_volume", **stages):
    """A spur drive whose stages differ only in pairs (z1, z2), ranges of teeth, or not at all."""
    teeth = stages.pop("teeth")
    given = {"allowable": (1e9, 1e9), "face_width": FaceWidth(ONE, ONE)} | stages
    made = tuple(Stage(**given, pinion_teeth=z1, wheel_teeth=z2) for z1, z2 in teeth)
    return Train(
        torque, Fraction(ratio), Fraction(tolerance), made, objective=objective, law=K_FACTOR
    )


def only(*pairs):
    """Teeth of stages without a choice."""
    return [((z1, z1), (z2, z2)) for z1, z2 in pairs]


@pytest.mark.parametrize("stage", [0, 1])
@pytest.mark.parametrize("objective", ["gear_volume", "total_length"])
def test_wheel_diameter_equal_to_the_limit_is_allowed(stage, objective):
    modules = tuple(Fraction(m, 101) for m in range(111, 606, 40))  # diameters no double can hold
    given = {"modules": modules, "teeth": [((17, 26), (1, None))] * 2, "objective": objective}
    train = spur(3e4, Fraction(147, 10), Fraction(1, 100), allowable=(2.0, 60.0), **given)
    loose = agrees(train).design
    module = next(m for m in modules if float(m) == loose["module_mm"][stage])
    limit = module * loose["wheel_teeth"][stage]
    assert limit.denominator > 1

    def limited(most):
        changed = list(train.stages)
        changed[stage] = replace(changed[stage], wheel_diameter=most)
        return agrees(replace(train, stages=tuple(changed)))

    assert limited(limit).design == loose
    for less in (Fraction(1, 10**9), Fraction(1, 10**25)):
        assert limited(limit - less).design != loose


EDGES = [  # ratio, tolerance, teeth whose ratio is exactly at an edge
    (5, Fraction(1, 100), [(20, 101)]),
    (5, Fraction(1, 100), [(20, 99)]),
    (12, Fraction(1, 1000), [(10, 33), (25, 91)]),
    (12, Fraction(1, 400), [(20, 54), (30, 133), (17, 17)]),
]


@pytest.mark.parametrize(("ratio", "tolerance", "teeth"), EDGES)
def test_ratio_at_the_edge_of_its_tolerance_is_allowed(ratio, tolerance, teeth):
    assert abs(math.prod(Fraction(z2, z1) for z1, z2 in teeth) / ratio - 1) == tolerance
    train = spur(ratio=ratio, tolerance=tolerance, teeth=only(*teeth), modules=(Fraction(2),))
    assert agrees(train).status == "optimal"
    for less in (Fraction(1, 10**9), Fraction(1, 10**16), Fraction(1, 10**30)):
        assert agrees(replace(train, tolerance=tolerance - less)).status == "infeasible"


def test_no_tolerance_means_the_ratio_itself():
    teeth = [((10, 25), (1, None))] * 2
    train = spur(ratio=Fraction(3003, 250), teeth=teeth, modules=(Fraction(2),))
    assert agrees(train).status == "optimal"
    other = replace(train, ratio=train.ratio + Fraction(1, 10**12))
    assert agrees(other).status == "infeasible"


LOW, HIGH = Fraction(7, 100), Fraction(29, 100)  # in doubles 7 < 0.07 * 100 and 0.29 * 100 < 29
BIT = Fraction(1, 10**15)


@pytest.mark.parametrize(
    ("face", "tighter", "load", "b"),
    [
        ({"step": Fraction(29)}, {"high": HIGH - BIT}, 28.5, 29),
        ({"step": ONE}, {"high": HIGH - BIT}, 28.5, 29),
        ({"low": HIGH, "step": ONE}, {"low": HIGH - BIT, "high": HIGH - BIT}, 5.0, 29),
        ({"low": LOW, "high": LOW + BIT, "step": ONE}, {"low": LOW + BIT}, 1.0, 7),
        ({"fixed": Fraction(29)}, {"high": HIGH - BIT}, 28.5, 29),
        ({"low": LOW, "high": None, "fixed": Fraction(7)}, {"low": LOW + BIT}, 6.0, 7),
    ],
)
def test_width_exactly_at_a_limit_is_allowed(face, tighter, load, b):
    """One pair with d1 = 100 mm that needs `load` mm of width at K = 1 MPa."""
    given = {"low": Fraction(0), "high": HIGH} | face
    chosen = {"torque": load * 4000, "ratio": 4, "teeth": only((25, 100)), "allowable": (1.0, 1e9)}
    train = spur(**chosen, modules=(Fraction(4),), face_width=FaceWidth(**given))
    assert agrees(train).status == "optimal"
    assert every_train(train).widths.tolist() == [[b]]
    train = spur(**chosen, modules=(Fraction(4),), face_width=FaceWidth(**given | tighter))
    assert agrees(train).status == "infeasible"


@pytest.mark.parametrize("law", [0, 1], ids=K_FACTOR.names)
@pytest.mark.parametrize(
    "face",
    [
        FaceWidth(ONE / 5, ONE / 5),
        FaceWidth(ONE * 0, ONE / 5),
        FaceWidth(ONE * 0, ONE / 5, step=Fraction(20)),
        FaceWidth(ONE * 0, None, fixed=Fraction(20)),
    ],
)
def test_load_equal_to_its_limit_is_allowed(law, face):
    """d1 = 100 mm, b = 20 mm, m = 4 mm, u = 3; no double is exactly the torque."""
    torque = 1e5 / 3
    limit = 2 * torque / (100**2 * 20 * 0.75, 100 * 20 * 4)[law]
    chosen = {"ratio": 3, "teeth": only((25, 75)), "modules": (Fraction(4),), "face_width": face}
    for factor, status in ((1.0, "optimal"), (1 - 1e-9, "infeasible")):
        allowable = tuple(limit * factor if k == law else 1e9 for k in (0, 1))
        assert agrees(spur(torque=torque, **chosen, allowable=allowable)).status == status


def ties(train):
    values = every_train(train).values
    return int((values <= values.min() * (1 + SAME)).sum())


def test_of_equal_diameters_the_fewest_teeth_win():
    """The load needs d1 >= 59 mm: 60 = 3 * 20 = 4 * 15, while 3 * 19 is too small."""
    teeth = [((15, 20), (1, None))]
    modules = (Fraction(3), Fraction(4))
    train = spur(torque=59**3 / 2.5, ratio=4, teeth=teeth, modules=modules, allowable=(1.0, 1e9))
    assert ties(train) == 2
    assert agrees(train).design == {"module_mm": 4.0, "pinion_teeth": 15, "wheel_teeth": 60}


@pytest.mark.parametrize("stages", [1, 2])
def test_rounding_does_not_decide_ties(stages):
    """A free width that just carries the load makes the volume depend on the ratios alone."""
    teeth = [((z, z + 10), (5 * z, 5 * z + 50)) for z in (17, 23)[:stages]]
    free = {"modules": (Fraction(3), Fraction(4)), "face_width": FaceWidth(ONE * 0, ONE * 10)}
    train = spur(1e4 / 3, 5**stages, teeth=teeth, allowable=(1.0, 1e9), **free)
    fives = tuple(
        replace(stage, ratio=(Fraction(5), Fraction(5)), toothings=(Toothing(0.3),))
        for stage in train.stages
    )
    train = replace(train, stages=fives)
    assert ties(train) == 11**stages
    assert len(set(every_train(train).values.tolist())) > 1
    assert agrees(train).design["module_mm"] in (3.0, [3.0] * stages)


@pytest.mark.parametrize(("stages", "most"), [(2, 19), (3, 14)])
@pytest.mark.parametrize("modules", [(2,), (2, 4)])
@pytest.mark.parametrize("objective", ["sum_of_centre_distances", "gear_volume"])
def test_idle_drives_are_full_of_ties(stages, most, modules, objective):
    """Without load the sizes depend on the teeth alone, and stages can be exchanged."""
    modules, teeth = tuple(map(Fraction, modules)), [((12, most), (1, 60))] * stages
    train = spur(1e-3, 5 * stages, objective=objective, modules=modules, teeth=teeth)
    assert ties(train) > 1
    agrees(train)


def best_list(train, count):
    """Assert that the list of best trains is the brute force's; its length."""
    _, outcome = run(problem(train, count))
    trains = every_train(train)
    listed = [teeth_of(train, x)[0] for x in (outcome.x, *outcome.others)]
    assert listed[0] == trains.teeth[trains.best()].tolist()
    assert len({str(t) for t in listed}) == len(listed) == min(count, len(trains.values))
    found = [trains.values[(trains.teeth == t).all(axis=(1, 2))][0] for t in listed]
    assert found == pytest.approx(np.sort(trains.values)[:count].tolist(), rel=SAME)
    return len(listed)


@pytest.mark.parametrize(
    ("stages", "number"),
    few(
        [(2, n) for n in (0, 3, 10, 11, 12, 15)] + [(3, n) for n in (0, 5, 7, 14)],
        [(2, 0), (2, 3), (3, 0)],
    ),
)
def test_list_of_the_best_twenty(stages, number):
    assert best_list(some_drive(number, stages), 20) == 20


@pytest.mark.slow
def test_lists_of_lopsided_drives():
    drives = [lopsided(number) for number in range(40, 70)]
    lengths = [best_list(d, 20) for d in drives if len(every_train(d).values)]
    assert lengths.count(20) >= 15


def test_list_of_fewer_than_wanted():
    train = spur(ratio=4, teeth=[((15, 20), (1, None))], modules=(Fraction(3), Fraction(4)))
    assert best_list(train, 20) == 6


def test_list_of_an_idle_drive():
    """Many more than 20 trains of few values."""
    train = spur(
        torque=1e-3,
        ratio=10,
        tolerance=Fraction(1, 20),
        modules=(Fraction(2),),
        teeth=[((12, 17), (1, 60))] * 2,
        objective="sum_of_centre_distances",
    )
    assert best_list(train, 20) == 20
