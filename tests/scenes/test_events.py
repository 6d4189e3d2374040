"""What `watch` is told of a run: part, objective and unit, one clock, values that never worsen."""

from itertools import pairwise
from pathlib import Path

import pytest
from campaigns import few

import gearopt
from gearopt.optimise.clock import OTHERS
from gearopt.optimise.kernels import COMPILING
from gearopt.scenes.reading.load import read

PROBLEMS = Path(__file__).parents[2] / "problems"
MASS = (
    "[layout]",
    '[objective]\nminimise = "mass"\ndensity = "7.85 kg/dm^3"\n\n[layout]',
)  # sized by another objective
ROUNDED = 1.0 + 1e-12
CASES = {  # file, edit, method, evaluations, {part: (objective, unit, name of its result)}
    "drive": (
        "three_stage",
        None,
        None,
        None,
        {"sizing": ("gear_volume", "mm3", "sizing"), "teeth": ("gear_volume", "mm3", "drive")},
    ),
    "real-valued drive": (
        "elevator",
        None,
        "multistart",
        300,
        {"sizing": ("gear_volume", "mm3", "drive")},
    ),
    "process": (
        "three_stage_processes",
        None,
        None,
        None,
        {"sizing": ("gear_volume", "mm3", "sizing"), "teeth": ("gear_volume", "mm3", "drive")},
    ),
    "layout": (
        "elevator_box",
        MASS,
        None,
        None,
        {
            "sizing": ("mass", "kg", "sizing"),
            "teeth": ("mass", "kg", "gears"),
            "layout": ("box_volume", "mm3", "drive"),
        },
    ),
    "layout by nsga2": (
        "elevator_box",
        None,
        "nsga2",
        2_000,
        {
            "sizing": ("gear_volume", "mm3", "sizing"),
            "teeth": ("gear_volume", "mm3", "gears"),
            "layout": ("box_volume", "mm3", "drive"),
        },
    ),
    "together": (
        "three_stage_together",
        MASS,
        "ipopt",
        None,
        {
            "sizing": ("mass", "kg", "sizing"),
            "teeth": ("mass", "kg", "gears"),
            "layout": ("box_volume", "mm3", "apart"),
            "together": ("box_volume", "mm3", "drive"),
        },
    ),
    "packing": (
        "six_cylinders",
        None,
        None,
        5_000,
        {"packing": ("volume", "mm3", "packing")},
    ),
    "servo": (
        "servo_axis",
        None,
        None,
        None,
        {"train": ("inertia", "kg_m2", "train"), "tolerances": ("cost", "", "tolerances")},
    ),
    "stiff servo": (
        "servo_gimbal_stiff",
        None,
        None,
        None,
        {"train": ("mass", "kg", "train"), "stiff": ("mass", "kg", "stiff")},
    ),
    "ratio": ("servo_gimbal_swing", None, "ipopt", None, {"ratio": ("rms_torque", "Nm", "ratio")}),
    "compound": (
        "sandgren_train",
        None,
        None,
        None,
        {"compound": ("squared_error", "", "compound")},
    ),
}
LONG = "layout by nsga2", "real-valued drive", "stiff servo", "together", "servo", "packing"


def told(scene, call=gearopt.solve, **kind):
    """The result, and all events of its run."""
    events = []
    result = call(scene, watch=lambda event: events.append(event) or True, **kind)
    return result, events


def in_tree(result, name):
    """The result of a name, of an answer and its parts."""
    found = [result] if result.name == name else []
    return next(
        iter(found + [r for p in result.parts if (r := in_tree(p, name)) is not None]), None
    )


def check_order(events):
    """One clock, counts that go on; within a part best and bound only improve, and never cross."""
    for a, b in pairwise(events):
        assert a.seconds <= b.seconds and a.evaluations <= b.evaluations
    for part in {e.part for e in events}:
        own = [e for e in events if e.part == part]
        assert len({(e.objective, e.unit) for e in own}) == 1
        best = [e.best for e in own if e.best is not None]
        bound = [e.bound for e in own if e.bound is not None]
        assert best == sorted(best, reverse=True) and bound == sorted(bound)
        assert all(e.bound <= e.best for e in own if None not in (e.best, e.bound))


@pytest.mark.parametrize("case", few(CASES, [case for case in CASES if case not in LONG]))
def test_every_scene_says_what_its_events_are_of(case):
    file, edit, method, evaluations, expected = CASES[case]
    text = (PROBLEMS / f"{file}.toml").read_text(encoding="utf-8")
    assert edit is None or edit[0] in text
    scene = read((text if edit is None else text.replace(*edit)).encode())[1]
    result, events = told(scene, method=method, budget=gearopt.Budget(evaluations=evaluations))
    check_order(events)
    apart = (OTHERS, COMPILING)
    parts = dict.fromkeys(e.part for e in events if not e.part.startswith(apart))
    assert list(parts) == list(expected)
    assert all(e.best is e.bound is None for e in events if e.part == OTHERS)
    for part, (objective, unit, name) in expected.items():
        own, answer = [e for e in events if e.part == part], in_tree(result, name)
        assert {(e.objective, e.unit) for e in own} == {(objective, unit)}
        assert answer.objective["unit"] == unit
        assert all(e.best * ROUNDED >= answer.value for e in own if e.best is not None)
        assert all(e.bound <= answer.value * ROUNDED for e in own if e.bound is not None)


@pytest.mark.slow
def test_trains_that_do_not_fit_their_box_are_no_best():
    """Those before the answer are better, but limits beside the search refuse them."""
    text = (PROBLEMS / "servo_gimbal_fine.toml").read_text(encoding="utf-8")
    modules = 'modules = ["0.3 mm", "0.4 mm", "0.5 mm", "0.6 mm", "0.8 mm", "1 mm"]'
    for edit in (
        ('"0.12 deg"', '"0.15 deg"'),
        ('width = "80 mm"', 'width = "74 mm"'),
        (modules, 'modules = ["0.5 mm"]'),
    ):
        assert edit[0] in text
        text = text.replace(*edit)
    result, events = told(read(text.encode())[1])
    check_order(events)
    assert result.status == "optimal" and {e.part for e in events} >= {"train"}
    own = [e.best for e in events if e.part == "train"]
    assert own and all(best is None or best >= result.value for best in own)


@pytest.mark.slow
def test_gears_and_box_at_once_go_on_to_real_valued_sizes():
    """Stopped early: the box of the gears chosen first, the search, and the sizes around it."""
    scene = PROBLEMS / "three_stage_together.toml"
    result, events = told(scene, budget=gearopt.Budget(evaluations=300_000))
    check_order(events)
    parts = ("sizing", "teeth", "layout", "together", "real-valued")
    assert tuple(dict.fromkeys(e.part for e in events)) == parts
    assert {e.unit for e in events} == {"mm3"}
    for part in ("together", "real-valued"):
        answer = in_tree(result, "drive" if part == "together" else part)
        best = [e.best for e in events if e.part == part and e.best is not None]
        assert best[-1] == pytest.approx(answer.value, rel=1e-9)


def test_further_trains_are_no_bound_of_the_best():
    """The search for the next best trains raises its own bound above the best train."""
    result, events = told(PROBLEMS / "three_stage.toml", top=5)
    check_order(events)
    bounds = [e.bound for e in events if e.part == "teeth" and e.bound is not None]
    assert bounds[-1] <= result.value * ROUNDED


@pytest.mark.slow
@pytest.mark.parametrize(
    "file", ["elevator", pytest.param("elevator_small_wheels", marks=pytest.mark.slow)]
)
def test_changed_problems_tell_no_values(file):
    scene = PROBLEMS / f"{file}.toml"
    _, events = told(scene, gearopt.explain, budget=gearopt.Budget(seconds=1.0))
    check_order(events)
    others = [e for e in events if e.part == OTHERS]
    assert others and all(e.best is e.bound is None for e in others)
    assert events[-1] is others[-1]


def test_the_progress_of_a_layout_is_on_one_clock(solved):
    result = solved("elevator_box")
    steps = result.report["progress"]
    assert all(set(s) == {"seconds", "evaluations", "best", "bound"} for s in steps)
    for a, b in pairwise(steps):
        assert a["seconds"] <= b["seconds"] and a["evaluations"] <= b["evaluations"]
    assert steps[0]["seconds"] >= result.parts[0].seconds
    assert steps[0]["evaluations"] >= result.parts[0].evaluations
    assert steps[-1]["seconds"] <= result.seconds and steps[-1]["best"] == result.value
