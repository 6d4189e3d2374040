"""The box of a servo train: against grids of angles, known sides, and its own proof."""

import math
from dataclasses import replace

import numpy as np
import pytest
from servo_trains import PAPER
from uncompiled import uncompiled

from gearopt.formulations.servo import servo_box, split
from gearopt.formulations.servo.servo_box import Room, ServoBox, extents, first_that_fits, of_train
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve

GEOMETRY = ServoBox((12.0, 24.5, 52.5), (28.0, 58.5), 8.0, math.pi / 2, (80.0, 130.0))
WIDER = replace(PAPER, error=math.radians(0.12))


def in_box(z1, z2, z3, z4, m1, m2):
    """A train of half a turn's sweep, motor radius 12 and hub 8 mm, in the box of the paper."""
    return of_train(pairs((z1, z3, z2, z4, m1, m2)), Room(12.0, 8.0, math.pi / 2, (80.0, 130.0)))


def on_a_grid(box, degrees):
    """Least scale, short and long side over all pairs of angles on a grid."""
    step = np.radians(np.arange(0.0, 360.0, degrees))
    output, motor = (a.ravel() for a in np.meshgrid(step, step, indexing="ij"))
    batch = servo_box.problem(box).batch(np.column_stack([motor, output]))
    width, height = batch.report["width"], batch.report["height"]
    scale = np.where(batch.G[:, 0] <= 1.0, batch.F[:, 0], np.inf)
    best = int(scale.argmin())
    return scale[best], *sorted((width[best], height[best]))


@pytest.mark.parametrize(
    ("half_sweep", "short", "proven"),
    [(45, 67.1, 67.08), (60, 78.4, 78.11), (65, 81.2, 81.13), (90, 90.4, 90.32)],
)
def test_short_sides_known_independently(half_sweep, short, proven):
    """The print is the best of a grid of 2 degrees; between its angles there is a little less."""
    box = replace(GEOMETRY, half_sweep=math.radians(half_sweep))
    assert on_a_grid(box, 2.0)[1] == pytest.approx(short, abs=0.06)
    result = solve(servo_box.problem(box))
    assert result.status == "optimal" and result.gap < 1e-6
    assert 80.0 * result.value == pytest.approx(proven, abs=6e-3)
    assert on_a_grid(box, 2.0)[0] * (1.0 - 0.006) < result.value < on_a_grid(box, 2.0)[0]


def test_a_full_wheel_fits_no_face_of_the_box():
    full = replace(GEOMETRY, radii=(4.5, 24.5, 52.5), half_sweep=math.pi)
    result = solve(servo_box.problem(full))
    assert result.status == "optimal" and result.value == pytest.approx(105.0 / 80.0, rel=1e-6)
    assert first_that_fits([full]) is None
    # in 105 mm the axis of gear 2 may be 28 mm off, and the motor goes over the wheel
    height = 52.5 + math.sqrt(58.5**2 - 28.0**2) + 24.5
    sizes = [(105.0 + 1e-6, height + side) for side in (-1e-3, 1e-3)]
    below, above = ([replace(full, box=size)] for size in sizes)
    assert first_that_fits(below) is None and first_that_fits(above) is not None


@pytest.mark.parametrize("seed", range(10))
def test_it_is_below_any_grid_and_within_its_step(seed):
    rng = np.random.default_rng(seed)
    box = ServoBox(
        tuple(rng.uniform(3.0, 50.0, 3)),
        tuple(rng.uniform(10.0, 60.0, 2)),
        float(rng.uniform(0.0, 10.0)),
        float(rng.uniform(0.1, math.pi)),
        tuple(rng.uniform(50.0, 120.0, 2)),
    )
    result, grid = solve(servo_box.problem(box)), on_a_grid(box, 2.0)
    if sum(box.links) < box.radii[0] + box.hub:
        assert result.status == "infeasible" and math.isinf(grid[0])
        return
    assert result.status == "optimal" and result.gap < 1e-6
    assert result.bound <= grid[0] * (1.0 + 1e-9)
    reach = sum(box.links) + max(box.radii)  # no side grows faster with an angle, twice over
    assert result.value >= grid[0] - 2.0 * reach * math.radians(2.0) / min(box.box)


def test_the_reach_of_a_sector_is_that_of_its_points():
    """Width and height of the swept sector alone, by points on its edge."""
    box = replace(GEOMETRY, radii=(1e-3, 1e-3, 52.5), links=(1e-3, 1e-3), hub=0.0, half_sweep=0.7)
    for turn in np.linspace(-3.0, 3.0, 13):
        edge = 52.5 * np.exp(1j * (turn + np.linspace(-0.7, 0.7, 100_001)))
        points = np.append(edge, 0.0)
        width, height = extents(box, 0.0, turn)
        assert width == pytest.approx(np.ptp(points.real), abs=4e-3)
        assert height == pytest.approx(np.ptp(points.imag), abs=4e-3)


def test_the_design_known_independently_fits():
    """79.1 x 104.2 mm there on a grid; 78.8 x 103.9 mm is the best."""
    result = solve(servo_box.problem(in_box(17, 91, 23, 207, 0.3, 0.5)))
    assert result.value == pytest.approx(78.77 / 80.0, abs=1e-4)
    assert result.report["width"] < 79.1 and result.report["height"] < 104.2


def test_between_the_degrees_of_a_grid_there_is_room_for_less_error():
    """On 1 degree 0.11732 deg is the least error that fits; 0.11707 deg fits between."""
    printed, better = in_box(18, 95, 23, 209, 0.3, 0.5), in_box(18, 94, 23, 210, 0.3, 0.5)
    assert on_a_grid(printed, 1.0)[0] <= 1.0 < on_a_grid(better, 1.0)[0]
    text = split.problem(WIDER, "error")
    errors = text.batch(np.array([[18, 23, 95, 209, 0.3, 0.5], [18, 23, 94, 210, 0.3, 0.5]]))
    assert np.degrees(errors.F[:, 0]) == pytest.approx([0.11732, 0.11707], abs=6e-6)
    assert (errors.G <= 1.0).all()
    assert solve(servo_box.problem(better)).value < 1.0


@pytest.mark.slow
def test_annealing_finds_the_same_box():
    text = servo_box.problem(GEOMETRY)
    found = solve(text, "annealing", Budget(evaluations=10_000), seed=2)
    best = solve(text)
    assert found.status == "feasible"
    assert best.bound <= found.value < 1.02 * best.value


def test_a_stopped_search_says_so():
    result = solve(servo_box.problem(GEOMETRY), budget=Budget(evaluations=5))
    assert result.status in ("limit", "stationary") and result.bound is None


@pytest.mark.parametrize("wrong", [{"half_sweep": 0.0}, {"half_sweep": 4.0}, {"hub": -1.0}])
def test_what_is_no_box_is_refused(wrong):
    with pytest.raises(ValueError):
        replace(GEOMETRY, **wrong)


def test_the_kernel_and_the_text_are_one_law():
    """At an angle of the output link: its motor angle gives the scale, none is less."""
    code = uncompiled(servo_box.KERNEL)
    rng = np.random.default_rng(11)
    fine = np.linspace(-math.pi, math.pi, 20_001)
    for half_sweep in (0.3, math.pi / 2, 2.5):
        box = replace(GEOMETRY, half_sweep=half_sweep)
        given, text = servo_box.numbers(box), servo_box.problem(box)
        for output in rng.uniform(-math.pi, math.pi, 8):
            scale, motor = code.smallest(given, output, 10.0)
            here = text.batch(np.array([[motor, output]]))
            assert here.G[0, 0] <= 1.0 + 1e-12
            assert here.F[0, 0] == pytest.approx(scale, rel=1e-12)
            batch = text.batch(np.column_stack([fine, np.full(fine.size, output)]))
            allowed = batch.F[batch.G[:, 0] <= 1.0, 0]
            assert scale <= allowed.min() * (1.0 + 1e-12)
            assert scale >= allowed.min() - 60.0 * (fine[1] - fine[0]) / 80.0


def test_a_layout_that_meets_the_box_exactly_fits():
    """A full wheel as wide as the box: intervals alone decide no layout of equal width."""
    wheel = ServoBox((6.0, 9.0, 30.0), (12.0, 34.0), 4.0, math.pi, (60.0, 130.0))
    found = first_that_fits([wheel])
    assert found is not None and found[0] == 0
    motor, output = found[1]
    assert extents(wheel, motor, output)[0] == pytest.approx(60.0, rel=1e-9)
    narrow = replace(wheel, box=(60.0 * (1.0 - 1e-7), 130.0))
    assert first_that_fits([narrow]) is None


def test_a_box_that_is_met_but_for_rounding_is_decided():
    """A full wheel of 120 mm in sides that are 120 mm with the tie, give or take some ulp."""
    wheel = ServoBox((30.0, 40.0, 60.0), (46.0, 70.0), 12.5, math.pi, (120.0, 200.0))
    side = 120.0 / (1.0 + servo_box.TIE)
    for ulps in range(-4, 5):
        box = replace(wheel, box=(side + ulps * math.ulp(side), 200.0))
        assert first_that_fits([box]) is not None
    assert first_that_fits([replace(wheel, box=(side * (1.0 - 1e-10), 200.0))]) is None


def test_the_second_pinion_is_in_the_box():
    """Gear 3 is larger than gear 2, and as large as gear 4: two discs of 10.5 mm, 20 mm apart."""
    point = np.array([16, 40, 20, 40, 0.3, 0.5])
    box = of_train(pairs(point), Room(3.0, 2.0, math.pi, (50.0, 50.0)))
    assert box.radii == pytest.approx((3.0, 10.5, 10.5))
    result = solve(servo_box.problem(box))
    side = 21.0 + 20.0 / math.sqrt(2.0)
    assert result.status == "optimal" and 50.0 * result.value == pytest.approx(side, rel=1e-6)
    sizes = [replace(box, box=(side + off, side + off)) for off in (-1e-4, 1e-4)]
    assert [first_that_fits([b]) is not None for b in sizes] == [False, True]
