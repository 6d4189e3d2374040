"""Relief of a spur pair: rules, criteria, best amounts, against a published study of the pair."""

from dataclasses import replace

import numpy as np
import pytest
from campaigns import few
from relief_pairs import COUPLING, LOAD, PATH, compliance, mesh

from gearopt.formulations.pair.relief.meshing import NO_RELIEF, Relief
from gearopt.formulations.pair.relief.parametric import Ranges, at_point, objective, problem
from gearopt.formulations.pair.relief.rules import (
    short_relief,
    smooth_shares,
    tip_amounts,
    without_error,
)
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve


def peaks(made, pinion=NO_RELIEF, wheel=NO_RELIEF):
    """Peak-to-peak transmission errors [um] at all loads."""
    return 1e3 * made.criteria(made.separations(pinion, wheel)).peak_to_peak


@pytest.mark.parametrize(
    "coupling, amounts", [(0.0, (15.790, 15.622)), (COUPLING, (11.341, 11.173))]
)
def test_amounts_by_rule(coupling, amounts):
    """The paper's rule takes the whole deflection, 39 % more than unloads the pair."""
    found = tip_amounts(PATH, compliance, coupling, LOAD)
    assert 1e3 * np.array(found) == pytest.approx(amounts, abs=6e-4)
    pinion, wheel = short_relief(PATH, found, 1.0)
    enters = mesh((1.0,), coupling, exact=True)
    assert enters.criteria(enters.separations(pinion, wheel)).load_jump < 1e-12
    less = short_relief(PATH, (0.99 * found[0], 0.99 * found[1]), 1.0)
    assert enters.criteria(enters.separations(*less)).load_jump > 1e-3


@pytest.mark.parametrize(
    "coupling, none, short",
    [
        (0.0, 7.205, {1.0: 0.888, 1.5: 1.654, 2.0: 3.278, 3.0: 5.241}),
        (COUPLING, 4.981, {1.0: 0.888, 1.5: 1.007, 2.0: 2.168, 3.0: 3.573}),
    ],
)
def test_short_relief_of_the_right_amount(coupling, none, short):
    """Published on the grid of 48 positions; no exponent brings a jump of the load."""
    made = mesh((1.0,), coupling)
    assert peaks(made) == pytest.approx(none, abs=6e-4)
    amounts = tip_amounts(PATH, compliance, coupling, LOAD)
    found = [float(peaks(made, *short_relief(PATH, amounts, p))[0]) for p in short]
    assert found == pytest.approx(list(short.values()), abs=2e-3)


@pytest.mark.parametrize("coupling", [0.0, COUPLING])
def test_without_transmission_error(coupling):
    """Zero at the load it is made for; |F/F_n - 1| of the unmodified gears' at any other."""
    parts = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5)
    made = mesh(parts, coupling, exact=True)
    separations = without_error(made, smooth_shares(made), LOAD)
    there = made.cycle.present
    assert separations[there].min() >= 0.0 and np.isinf(separations[~there]).all()
    found = made.criteria(separations)
    assert found.peak_to_peak[3] < 1e-14 and found.load_jump[3] < 1e-12
    before = made.criteria(made.separations(NO_RELIEF, NO_RELIEF)).peak_to_peak
    scaled = np.abs(np.array(parts) - 1.0) * before[3]
    assert found.peak_to_peak == pytest.approx(scaled, abs=1e-12)
    assert found.peak_to_peak[1] == pytest.approx(before[1], rel=1e-9)  # break-even at half load
    tips = 1e3 * made.cycle.along(separations)[[0, -1]]
    published = (15.78, 15.78) if coupling == 0.0 else (11.33, 11.33)
    assert tips == pytest.approx(published, abs=0.02)


def test_hardly_any_load_leaves_the_kinematic_error_of_the_relief():
    """Down to no load at all; at a tenth and at the full load as published."""
    made = mesh((0.0, 1e-6, 1e-3, 1e-2, 0.1, 1.0), 0.0, 64)
    length = 0.6832 * PATH.base_pitch
    reliefs = Relief(15.8e-3, length), Relief(15.6e-3, length)
    found = peaks(made, *reliefs)
    assert found[1:] == pytest.approx([7.7509, 7.7527, 7.7692, 7.1591, 0.8863], abs=2e-3)
    assert found[0] == pytest.approx(found[1], abs=1e-4)
    shared = made.sharing(made.separations(*reliefs))
    assert shared.forces[0].max() == 0.0
    assert shared.forces[1:].sum(axis=2) == pytest.approx(
        np.broadcast_to(np.array(made.loads)[1:, None], (5, 64)), rel=1e-12
    )


@pytest.mark.parametrize(
    "amount, peak, ratio", [(20, 3.03, 1.547), (50, 18.04, 1.234), (200, 93.07, 1.047)]
)
def test_huge_relief_is_shared_while_one_pair_is_there(amount, peak, ratio):
    """Published on 64 positions: the effective contact ratio falls towards 1."""
    made, length = mesh((1.0,), 0.0, 64), 0.6832 * PATH.base_pitch
    relief = Relief(1e-3 * amount, length)
    found = made.criteria(made.separations(relief, relief))
    assert 1e3 * found.peak_to_peak[0] == pytest.approx(peak, rel=2e-3)
    assert found.contact_ratio[0] == pytest.approx(ratio, abs=1e-3)


def test_harmonics_are_those_of_a_fine_sample():
    """The trapezoidal rule over break points against a discrete Fourier transform."""
    relief = Relief(11e-3, 0.6 * PATH.base_pitch)
    coarse, fine = mesh((1.0,), steps=192, exact=True), mesh((1.0,), steps=4096)
    found = coarse.criteria(coarse.separations(relief, relief)).harmonics()
    error = fine.criteria(fine.separations(relief, relief)).sharing.approach[0]
    transform = 2.0 * np.abs(np.fft.rfft(error))[1:4] / 4096
    assert 1e3 * found[0] == pytest.approx(1e3 * transform, abs=1e-3)


def test_a_population_is_its_designs():
    """Amounts and lengths as arrays (N,) give what each design gives alone."""
    made, rng = mesh((0.6, 1.0)), np.random.default_rng(0)
    ranges = Ranges.of(made, 1.5)
    posed = problem(made, ranges, ("peak_to_peak", "harmonics_at_1", "load_jump", "peak_load_at_2"))
    low, high, _ = posed.bounds()
    points = rng.uniform(low, high, (5, 4))
    together = posed.batch(points).F
    for x, row in zip(points, together, strict=True):
        alone = made.criteria(made.separations(*at_point(x, ranges)))
        values = [objective(alone, name) for name in posed.rows.objectives]
        assert row == pytest.approx(values, rel=1e-12)
    only = replace(made, loads=made.loads[:1])
    first = only.criteria(only.separations(*at_point(points[0], ranges)))
    assert together[0, 1] == pytest.approx(objective(first, "harmonics"), rel=1e-12)


@pytest.mark.parametrize(
    "coupling, exponent, published",
    few(
        [(0.0, 1.0, 1.680), (0.0, 2.0, 2.101), (COUPLING, 1.0, 1.2373), (COUPLING, 2.0, 1.3494)],
        [(COUPLING, 1.0, 1.2373)],
    ),
)
def test_annealing_at_two_loads(coupling, exponent, published):
    """No worse than the best of two published methods at 60 and 100 % of the load [um]."""
    made = mesh((0.6, 1.0), coupling)
    posed = problem(made, Ranges.of(made, exponent))
    found = solve(posed, "annealing", Budget(evaluations=12000), seed=1)
    assert found.status == "feasible" and 1e3 * found.value < 1.003 * published
