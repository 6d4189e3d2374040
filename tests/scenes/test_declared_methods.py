"""What a comparison must know of every method of every kind of file, and the curves they tell."""

import sys
from functools import cache
from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SolveError
from gearopt.formulations.drive.layout import annealing
from gearopt.optimise.comparing.compare import attempt, enter
from gearopt.optimise.comparing.runs import Entry
from gearopt.optimise.kernels import kernel
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import method_of
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import kind_named

PROBLEMS = Path(__file__).parents[2] / "problems"
ROOMS = {kind_named(name).scene: kind_named(name) for name in kinds()}
FILES = (
    *("elevator", "elevator_box", "sandgren_train", "seven_points"),
    pytest.param("three_stage_together", marks=pytest.mark.slow),
    *("servo_axis", "servo_gimbal_ratio", "servo_gimbal_move", "servo_gimbal_swing"),
    *("servo_gimbal_costs", "servo_gimbal_grades", "elevator_processes"),
    pytest.param("relief_two_loads", marks=pytest.mark.slow),
)


QUICKER = {"relief_two_loads": {"sharing.positions": 24, "relief.loads": [1]}}


@cache
def scene_of(name):
    scene = gearopt.load(PROBLEMS / f"{name}.toml", QUICKER.get(name))
    return getattr(scene, "scene", scene)


@cache
def posed(name, method):
    scene = scene_of(name)
    return ROOMS[type(scene)].posed(scene, method)


@cache
def own_methods(name):
    """The exact and other methods that the models of a file bring, by name."""
    scene, found = scene_of(name), {}
    for method in ROOMS[type(scene)].methods_to_compare(scene):
        try:
            problem = posed(name, method).problem
        except SolveError:
            continue
        found |= {own: method_of(problem, own) for own in problem.methods}
    return found


@pytest.mark.parametrize("name", FILES)
def test_every_method_says_whether_it_is_random_and_what_it_counts(name):
    methods = own_methods(name)
    room = ROOMS[type(scene_of(name))]
    assert methods and methods.keys() <= set(room.methods)
    for method, run in methods.items():
        module = sys.modules[run.__module__]
        assert isinstance(module.RANDOM, bool), method
        assert module.COUNTS, method
        for declared in (module.COUNTS, getattr(module, "SETTINGS", {})):
            by_name = isinstance(declared, dict) and set(declared) & set(methods)
            assert not by_name or method in declared, method


SLICES = {  # evaluations of one step, at which budgets are looked at; else a step is one of them
    "elevator": 60_000,  # whole expansions of a node
    "elevator_processes": 60_000,
    "seven_points": 1,
    "three_stage_together": 60_000,
    "servo_axis": 5_000,  # of the kernel
    "servo_gimbal_grades": 1_000,  # pairs of one component
    "relief_two_loads": 256,  # boxes between two words to the watcher
}


@pytest.mark.parametrize("name", FILES)
def test_every_method_honours_watcher_and_budget(name):
    for method, run in own_methods(name).items():
        try:
            problem = posed(name, method).problem
            run(problem, Budget(evaluations=1), 0, None)
        except SolveError:
            continue  # it needs a table that the file has not
        for stop in (1, 2):
            seen = []

            def watch(event, seen=seen, stop=stop):
                seen.append(event)
                return len(seen) < stop

            outcome = run(problem, Budget(), 0, watch)
            assert len(seen) <= stop and outcome.finished == (len(seen) < stop), method
            assert seen or outcome.evaluations <= 6, method  # a closed form
            best = seen[-1].best if seen and not outcome.finished else None
            assert best is None or outcome.x is not None, method
        for most in (40, 3_000):
            outcome = run(problem, Budget(evaluations=most), 0, None)
            assert outcome.evaluations <= most + SLICES.get(name, 0), method


def test_a_servo_train_is_compared_once_not_for_every_seed():
    found = gearopt.compare(
        PROBLEMS / "servo_gimbal.toml", methods=("exact",), seeds=3, evaluations=100, seconds=0.02
    )
    (row,) = found.groups[0].rows
    assert not row.random and len(row.equal_evaluations.runs) == 1


def test_settings_of_a_layout_are_those_of_each_method():
    law = kernel("gearopt.formulations.drive.layout.anneal_kernel")
    angles, positions = annealing.SETTINGS["sa"], annealing.SETTINGS["sa-paper"]
    assert angles["temperatures"] == (law.HOT, law.COLD) and angles["penalty"] == law.PENALTY
    free = (law.FREE * law.HOT, law.FREE * law.COLD)
    assert positions["temperatures"] == pytest.approx(free) and positions["penalty"] == law.PENALTY
    assert positions["penalty of a centre distance"] == law.MESH
    assert str(law.MESHING) in positions["repaired"]
    entries = {m: enter(m, lambda m: posed("elevator_box", m)) for m in annealing.SETTINGS}
    assert entries["sa"].settings == angles and entries["sa-paper"].settings == positions
    assert "ipopt" in entries["sa-polish"].settings["polished by"]
    assert entries["sa"].counts == "layout measured"
    assert entries["sa-polish"].counts == "layout measured or Ipopt iteration"


def curve(name, method, evaluations, seed=1):
    """The run of a method by evaluations; what went before a step is never better than it."""
    model = posed(name, method)
    run = attempt(
        Entry(method, model, model.problem), seed, Budget(60.0, evaluations), lambda event: True
    )
    values = [best for _, _, best in run.steps]
    counts = [n for _, n, _ in run.steps]
    assert values == sorted(values, reverse=True) and counts == sorted(counts)
    assert values[-1] == run.objective and counts[-1] <= run.evaluations and not run.clipped
    return run


CURVES = [  # file, method, evaluations, points of the curve at the least
    ("seven_points", "sa", 20_000, 20),
    ("seven_points", "hop", 60_000, 4),
    ("seven_points", "annealing", 5_000, 20),
    ("seven_points", "nsga2", 5_000, 20),
    ("seven_points", "multistart", 300, 10),
    ("elevator_box", "sa", 20_000, 5),
    ("elevator_box", "sa-polish", 20_000, 5),
    ("elevator_box", "sa-paper", 128_701, 3),
    ("elevator_box", "multistart", 300, 10),
    ("elevator", "annealing", 5_000, 3),
    ("elevator", "nsga2", 5_000, 4),
    ("elevator", "multistart", 300, 4),
    ("servo_gimbal_ratio", "ipopt", 100, 3),
    ("sandgren_train", "annealing", 5_000, 4),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "method", "evaluations", "least"), CURVES)
def test_a_curve_tells_of_the_way_to_the_best(name, method, evaluations, least):
    assert len(curve(name, method, evaluations).steps) >= least


def test_a_polish_counts():
    """Ipopt's iterations are evaluations of sa-polish, within its budget."""
    plain, polished = (curve("elevator_box", m, 5_000) for m in ("sa", "sa-polish"))
    assert plain.evaluations == 5_000 and 4_500 < polished.evaluations <= 5_000
    assert polished.steps[-1][1] > 4_500 and polished.objective < plain.objective


def test_half_of_a_budget_is_half_of_its_seconds():
    assert Ask(budget=Budget(seconds=4.0, evaluations=7)).half.budget == Budget(2.0, 7)
    assert Ask().half.budget.seconds is None
