"""Relief of any shape: published linear programs, enumeration of patterns, bounds of ramps."""

import itertools

import numpy as np
import pytest
from campaigns import few
from relief_pairs import COUPLING, mesh
from scipy.optimize import linprog

from gearopt.formulations.pair.relief.free_form import Profile, Program, Shape, free_problem
from gearopt.formulations.pair.relief.parametric import Ranges, problem
from gearopt.optimise.solve import solve
from gearopt.physics.load_sharing import share

TWO, THREE = (0.6, 1.0), (0.5, 1.0, 1.25)
# um: coupling, loads, complete contact from any place and within the double zone, any symmetric
# pattern on a grid of patterns (where published)
PUBLISHED = [
    (0.0, (1.0,), 0.2177, 0.2341, None),
    (0.0, TWO, 2.4196, 2.8117, 1.5064),
    (0.0, THREE, 4.8779, 5.1738, 2.7564),
    (COUPLING, (1.0,), 0.2177, 0.2341, None),
    (COUPLING, TWO, 1.6317, 1.9485, 1.0615),
    (COUPLING, THREE, 3.3137, 3.5552, 1.9223),
]


@pytest.mark.parametrize("coupling, loads, long, short, patterns", PUBLISHED)
def test_published_profiles(coupling, loads, long, short, patterns, request):
    """Complete contact as published; over all patterns, asymmetric ones too, never more."""
    made = mesh(loads, coupling)
    for known, shape in ((long, Shape(complete=True)), (short, Shape(complete=True, short=True))):
        found = solve(free_problem(made, shape), "exact")
        assert found.status == "optimal" and 1e3 * found.value == pytest.approx(known, abs=6e-5)
    if patterns is None:
        free = solve(free_problem(made), "exact")
        assert free.status == "optimal" and 1e3 * free.value == pytest.approx(long, abs=6e-5)


@pytest.mark.slow
@pytest.mark.parametrize(
    "coupling, loads, patterns", [(r[0], r[1], r[4]) for r in PUBLISHED if r[4]]
)
def test_all_patterns(coupling, loads, patterns):
    """Proven to 1e-6, at most the published value, and below every linear or parabolic relief."""
    made = mesh(loads, coupling)
    found = solve(free_problem(made), "exact")
    assert found.status == "optimal" and 1e3 * found.value < patterns + 6e-5
    removed = 1e-3 * np.round(1e3 * np.array(found.design["removed_mm"]), 12)
    profile = Profile(made, Shape())
    again = made.criteria(profile.separations(removed)).peak_to_peak.max()
    assert again == pytest.approx(found.value, rel=1e-9)
    for exponent in (1.0, 2.0):
        ramp = solve(problem(made, Ranges.of(made, exponent)), "exact")
        assert found.value < ramp.bound


@pytest.mark.parametrize("convex", few([False, True], 1))
def test_every_pattern_by_enumeration(convex):
    """On five positions every combination of ranges between kinks is a linear program."""
    made = mesh(TWO, COUPLING, 5)
    shape = Shape(convex=convex)
    program = Program(Profile(made, shape))
    ahead = np.random.default_rng(0).uniform(-30.0, 30.0, len(program.double))
    apart = np.clip(np.stack([ahead, -ahead], axis=1), 0.0, None)
    for q, load in enumerate(program.loads):  # lost contact on either side, too
        known = share(program.own[program.double], apart, load).approach - apart[:, 1]
        assert program.approach_above_second(q, ahead) == pytest.approx(known, rel=1e-12)
    kinks = np.sort(program.kinks.reshape(-1, len(program.double)), axis=0)
    ends = np.vstack([kinks[:1] * 0.0 - 30.0, kinks, kinks[:1] * 0.0 + 30.0])
    least = np.inf
    for pattern in itertools.product(range(5), repeat=len(program.double)):
        if list(pattern) == sorted(pattern, reverse=True):  # e_1 - e_2 falls along the travel
            k = np.array(pattern), np.arange(len(pattern))
            least = min(least, program.solved(ends[k], ends[k[0] + 1, k[1]])[0])
    found = solve(free_problem(made, shape), "exact")
    assert found.status == "optimal" and 1e3 * found.value == pytest.approx(least, rel=1e-6)


def test_bound_of_complete_contact_without_a_shape():
    """(F_b - F_a)(1/K_1 - 1/K_2)/2 bounds the larger of two loads' peak-to-peak: it is kept."""
    made = mesh(TWO, COUPLING)
    own = 1e3 * (made.compliances - COUPLING)
    there = made.cycle.present
    slopes = 1.0 / np.where(there, 1.0 / own, 0.0).sum(axis=1)  # um/N of the approach
    most = (made.loads[1] - made.loads[0]) * np.ptp(slopes) / 2.0
    assert most == pytest.approx(0.9962, abs=6e-5)  # as published
    found = solve(free_problem(made, Shape(convex=False, complete=True)), "exact")
    assert 1e3 * found.value >= most - 1e-9


def test_no_convex_relief_that_ends_at_the_middle_is_below_the_bound():
    """The middle lies between positions: hinges there, by another program, reach the same value."""
    made = mesh(steps=9, exact=True)
    path, present = made.cycle.path, made.cycle.present
    middle = 0.5 * (path.start + path.end)
    s = np.where(present, made.cycle.positions, middle)
    ends = np.append(middle, made.cycle.positions[present])
    ramps = [np.copysign(1.0, e - middle) * (s - e) for e in ends]
    ramps = np.clip([*ramps, middle - s], 0.0, None)  # from the middle both ways
    stiffness = np.where(present, 1.0 / (made.compliances - COUPLING), 0.0)
    share = stiffness / stiffness.sum(axis=1, keepdims=True)
    slopes, stays = (ramps * share).sum(axis=-1).T, made.loads[0] / stiffness.sum(axis=1)
    one, none = np.ones((len(s), 1)), np.zeros((len(s), 1))
    rows = np.block([[slopes, -one, none], [-slopes, none, one]])  # between highest and lowest
    cost = np.append(np.zeros(len(ramps)), [1.0, -1.0])
    bounds = [(0.0, None)] * len(ramps) + [(None, None)] * 2
    found = linprog(cost, rows, np.concatenate([-stays, stays]), bounds=bounds)
    weights = found.x[: len(ramps)]
    removed = np.where(present, np.tensordot(weights, ramps, 1), np.inf)
    reached = made.criteria(removed).peak_to_peak.max()
    found = solve(free_problem(made), "exact")
    assert found.bound <= reached == pytest.approx(found.value, rel=1e-6)


def test_a_shape_that_rises_along_the_path_breaks_the_rows_before_its_middle():
    """By 1 um from point to point, which is the unit of the rows: 2 there, 0 behind; all <= 30."""
    made = mesh((1.0,), COUPLING, 12)
    shape = Shape(convex=False)
    posed, profile = free_problem(made, shape), Profile(made, shape)
    rises = 1e-3 * np.arange(len(profile.points))
    expected = np.where(np.arange(len(rises) - 1) < profile.middle, 2.0, 0.0)
    assert posed.batch(rises[None]).G[0] == pytest.approx(expected, abs=1e-9)
    assert posed.bounds()[1] == pytest.approx(30e-3)


def test_more_than_two_pairs_are_refused():
    from test_relief_search import wide

    with pytest.raises(ValueError, match="below 2"):
        free_problem(wide(2.3))
