"""The discrete problem of a drive as methods see it, and what `exact` says of its search."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from brute_force import every_train
from campaigns import few
from small_drives import FACES, OBJECTIVES, drive

from gearopt.errors import SolveError
from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.teeth import (
    UNLIMITED,
    _in_order,
    _why,
    pairs,
    point,
    problem,
)
from gearopt.formulations.drive.teeth.choices import best_pairs
from gearopt.formulations.drive.teeth.progress import MARGIN, TIE, Progress
from gearopt.formulations.drive.teeth.search import search
from gearopt.formulations.drive.train import FaceWidth
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import method_of, run

F = Fraction
WIDTH = {  # of the variables of a face width: name, ends of both stages
    "tied": None,
    "fixed alone": ("face_width", (24.0, 24.0), (24.0, 24.0)),
    "stepped": ("width_steps", (1.0, 1.0), (UNLIMITED, UNLIMITED)),
}


def point_of(train, teeth):
    """The point of the best pairs of these teeth."""
    return point(train, best_pairs(train, teeth))


def bounds_of(train):
    return {v.name: (np.ravel(v.lower).tolist(), np.ravel(v.upper).tolist()) for v in _vars(train)}


def _vars(train):
    return problem(train).variables


@pytest.mark.parametrize("face", WIDTH)
def test_variables_and_their_ends(face):
    train = drive(2, face, total=12, tolerance=F(1, 100), wheel_teeth=(30, 200))
    found = bounds_of(train)
    expected = {
        "module": ([1.0, 1.0], [3.0, 3.0]),
        "pinion_teeth": ([15.0, 15.0], [20.0, 20.0]),
        "wheel_teeth": ([30.0, 30.0], [200.0, 200.0]),
    }
    if WIDTH[face] is not None:
        name, low, high = WIDTH[face]
        expected[name] = (list(low), list(high))
    assert found == expected
    kinds = {v.name: (v.unit, v.integer, v.values, v.size) for v in _vars(train)}
    assert kinds["module"] == ("mm", False, (1.0, 1.5, 2.0, 3.0), 2)
    assert kinds["pinion_teeth"] == kinds["wheel_teeth"] == ("", True, None, 2)
    assert all(np.array_equal(v.guess, v.lower) for v in _vars(train))


def test_wheels_reach_as_far_as_the_ratio_and_a_limit_let_them():
    reach = {}
    for most in (None, 100, 10_000):
        for least in (1, 500):
            train = drive(1, total=12, tolerance=F(1, 100), wheel_teeth=(least, most))
            reach[least, most] = bounds_of(train)["wheel_teeth"][1][0]
    exact = math.floor(F(1212, 100) * 20)
    assert exact == 242
    assert reach == {
        (1, None): 242.0,
        (1, 100): 100.0,
        (1, 10_000): 242.0,
        (500, None): 500.0,
        (500, 100): 500.0,
        (500, 10_000): 500.0,
    }


def test_wheels_reach_as_far_as_their_own_pinions():
    train = drive(2, total=12, tolerance=F(1, 100))
    larger = replace(train.stages[1], pinion_teeth=(15, 30))
    ends = bounds_of(replace(train, stages=(train.stages[0], larger)))
    assert ends["wheel_teeth"][1] == [242.0, 363.0]  # floor(12.12 z1)


@pytest.mark.parametrize(("face", "low"), [("free", 0.2), ("open", 6e-7)])
def test_free_widths_lie_between_ends_a_little_apart(face, low):
    train = drive(2, face, helix_angle=0.3)
    least, most = 15 / math.cos(0.3), 20 * 3 / math.cos(0.3)
    ends = bounds_of(train)["face_width"]
    assert ends[0] == pytest.approx([0.999 * low * least] * 2, rel=1e-12)
    assert ends[1] == pytest.approx([1.001 * 0.6 * most] * 2, rel=1e-12)


def test_stages_of_unlike_widths_share_the_variables():
    """Where one is free the others are given, and where one has steps the others have one."""
    own = drive(3).stages
    fixed = FaceWidth(F(0), None, fixed=F(24))
    faces = (FACES["stepped"], FACES["tied"], fixed)
    train = replace(
        drive(3, total=20),
        stages=tuple(replace(s, face_width=f) for s, f in zip(own, faces, strict=True)),
    )
    found = bounds_of(train)
    assert found["width_steps"] == ([1.0] * 3, [UNLIMITED, 1.0, 1.0])
    assert found["face_width"] == ([1.0, 1.0, 24.0], [1.0, 1.0, 24.0])
    x = point_of(train, ((16, 40), (17, 48), (18, 52)))
    low, high, _ = problem(train).bounds()
    assert (low <= x).all() and (x <= high).all()
    first, second, third = pairs(train, x)
    assert [(p.pinion_teeth, p.wheel_teeth) for p in (first, second, third)] == [
        (16, 40),
        (17, 48),
        (18, 52),
    ]
    assert second.face_width == pytest.approx(0.6 * second.normal_module * 17)
    assert third.face_width == 24.0 and first.face_width % 2 == 0.0


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("objective", few(OBJECTIVES, 1))
def test_the_point_of_teeth_is_the_brute_forces_and_keeps_every_row(face, objective):
    train = drive(2, face, total=6, tolerance=F(1, 200), objective=objective)
    trains, posed = every_train(train), problem(train)
    assert len(trains.values) > 10
    for k in range(0, len(trains.values), max(1, len(trains.values) // 8)):
        x = point_of(train, tuple(map(tuple, trains.teeth[k].tolist())))
        batch = posed.batch(x[None])
        assert batch.F[0, 0] == pytest.approx(trains.values[k], rel=1e-12)
        assert (batch.G <= 1.0 + 1e-11).all()
        made = pairs(train, x)
        assert [p.normal_module for p in made] == list(trains.modules[k])
        assert [p.face_width for p in made] == pytest.approx(trains.widths[k], rel=1e-12)


def test_widths_are_whole_steps_whatever_rounding_makes_of_them():
    """24 x 0.7 / 0.7 is below 24 in double precision."""
    face = FaceWidth(F(1, 5), F(3, 5), step=F(7, 10))
    train = drive(2, total=6)
    train = replace(train, stages=tuple(replace(s, face_width=face) for s in train.stages))
    trains, below = every_train(train), 0
    for k in range(0, len(trains.values), 45):
        x = point_of(train, tuple(map(tuple, trains.teeth[k].tolist())))
        widths = [p.face_width for p in pairs(train, x)]
        assert widths == pytest.approx(trains.widths[k], rel=1e-12)
        below += (trains.widths[k] / 0.7 < np.rint(trains.widths[k] / 0.7)).any()
    assert below > 3


def test_ends_of_the_set_of_modules_are_no_limits_and_hunting_teeth_are():
    train = drive(2)
    names = [row.name for row in problem(train).rows.inequalities]
    assert names and not any(n.startswith(("module_", "common")) for n in names)
    hunting = problem(replace(train, coprime=True))
    names = [row.name for row in hunting.rows.inequalities]
    assert names[-2:] == ["common_divisor[1]", "common_divisor[2]"]
    x = point_of(train, ((16, 52), (18, 63)))
    assert hunting.batch(x[None]).G[0, -2:].tolist() == [4.0, 9.0]
    for near in (-1e-7, 1e-7):  # whole teeth, as a solver of real numbers returns them
        assert hunting.batch(x[None] + near).G[0, -2:].tolist() == [4.0, 9.0]
    one = problem(replace(drive(1, total=3), coprime=True))
    assert one.batch(point_of(drive(1, total=3), ((15, 45),))[None]).G[0, -1] == 15.0
    with pytest.raises(SolveError, match="hunting teeth"):
        hunting.traced()


def teeth_of(*numbers):
    return tuple((n, 2 * n) for n in numbers)


def test_ties_go_to_fewest_teeth_then_to_the_smaller_first():
    progress = Progress(5, Clock())
    near = 1.0 + 0.9 * TIE
    rows = [(1.0, (18, 20)), (near, (20, 17)), (near, (17, 20)), (1.0 + 3 * TIE, (12, 12))]
    rows += [(2.0, (12, 14)), (2.0, (13, 12))]
    progress.found = [(value, teeth_of(*n)) for value, n in rows]
    order = [(17, 20), (20, 17), (18, 20), (12, 12), (13, 12), (12, 14)]
    assert _in_order(progress) == [teeth_of(*n) for n in order]
    assert _in_order(Progress(1, Clock())) == []


def test_why_a_search_ended_is_told():
    progress = Progress(1, Clock())
    assert _why(progress, 1) == "the search stopped before a train was found: allow more time"
    progress.found = [(1.0, teeth_of(17))]
    assert _why(progress, 1).endswith("before it was complete; no lower bound is known yet")
    progress.lower = 0.5
    assert _why(progress, 1) == "the search stopped before it was complete"
    assert _why(progress, 5).endswith("so only the best train so far is listed, not 5")
    progress.enough = True
    assert _why(progress, 1) == "the requested gap is reached"


def outcome(train, count=1, floor=-math.inf, watch=None, **budget):
    posed = problem(train, count, floor)
    return method_of(posed, "exact")(posed, Budget(**budget), 0, watch)


def test_what_exact_claims():
    train = drive(2, total=6, tolerance=F(1, 200))
    trains = every_train(train)
    best = outcome(train)
    assert best.finished and not best.infeasible and best.others == () and best.message == ""
    assert best.bound == pytest.approx(trains.values.min(), rel=1e-12)
    assert best.proof["method"] == "exhausted" and best.proof["pruning_margin"] == MARGIN
    assert f"(partial designs examined: {best.proof['nodes']:,})." in best.proof["sentence"]
    assert 0 < best.proof["trains_compared"] <= best.evaluations and best.proof["nodes"] > 0
    assert len(outcome(train, 2).others) == 1
    listed = outcome(train, 5)
    assert len(listed.others) == 4 and (listed.x == best.x).all()
    values = problem(train).batch(np.array([listed.x, *listed.others])).F[:, 0]
    assert values == pytest.approx(np.sort(trains.values)[:5], rel=1e-12)
    for key in ("trains_compared", "nodes"):
        assert listed.proof[key] > best.proof[key]
    assert listed.evaluations > best.evaluations
    timed = outcome(train, 5, seconds=1e3)
    assert all((a == b).all() for a, b in zip(timed.others, listed.others, strict=True))
    none = outcome(drive(2, total=6, modules=(F(1, 10),)))
    assert none.infeasible and none.x is None and none.bound is None
    assert none.proof["method"] == "exhausted"
    looks = []
    for count in (1, 5):  # where there is no train, no second search lists more
        looks.append([])
        outcome(drive(2, total=6, modules=(F(1, 10),)), count, watch=looks[-1].append)
    assert len(looks[0]) == len(looks[1]) > 0


def test_the_bound_is_the_least_of_ties_whatever_their_rounding():
    """A free width makes the volume the same for 21 pairs, but for the last digits."""
    train = drive(1, "open", total=4, tolerance=F(0), pinion_teeth=(12, 40))
    values = [value for value, _ in search(train, 1, Budget()).found]
    assert min(values) < max(values) <= min(values) * (1.0 + TIE)
    assert outcome(train).bound == min(values)


def test_what_exact_says_when_it_is_stopped():
    train = drive(3, total=40)
    whole, floor = outcome(train), 1.0
    nothing = outcome(train, watch=lambda event: False)
    assert not nothing.finished and nothing.x is None and nothing.bound is None
    assert outcome(train, floor=floor, watch=lambda event: False).bound == floor
    seen = []
    some = outcome(train, 5, watch=lambda e: seen.append(e) is None and e.best is None)
    assert not some.finished and some.others == () and "not 5" in some.message
    assert [event.best is None for event in seen] == [True] * (len(seen) - 1) + [False]
    assert problem(train).batch(some.x[None]).F[0, 0] == pytest.approx(seen[-1].best, rel=1e-12)
    assert some.proof["method"] == "branch and bound, stopped early"
    enough = outcome(train, floor=0.5 * whole.bound, gap=0.6)
    assert enough.finished and enough.bound < whole.bound and "gap" in enough.message
    assert problem(train).batch(enough.x[None]).F[0, 0] >= whole.bound
    again = outcome(train, 3, floor=0.5 * whole.bound, gap=0.6)
    assert again.finished and again.others == () and again.evaluations == enough.evaluations


def test_a_list_that_is_stopped_gives_the_best_alone():
    """The second search has what the first one left."""
    train = drive(3, total=40)
    alone = outcome(train)
    short = outcome(train, 50, evaluations=alone.evaluations + 1)
    assert short.finished and short.others == () and (short.x == alone.x).all()
    assert short.bound == alone.bound and short.proof["method"] == "exhausted"
    assert short.evaluations >= alone.evaluations
    assert len(outcome(train, 50, evaluations=100 * alone.evaluations).others) == 49


def test_the_default_method_is_exact():
    result, found = run(problem(drive(2, total=6)))
    assert result.method == "exact" and result.status == "optimal" and found.others == ()
    assert not teeth.RANDOM
