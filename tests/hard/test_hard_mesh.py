"""Transmission error and relief across a contact ratio of 2; contact compliances of any load."""

import numpy as np
import pytest

from gearopt.formulations.pair.relief.meshing import Mesh
from gearopt.formulations.pair.relief.parametric import Ranges, at_point, problem
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.load_sharing import share
from gearopt.physics.mesh_cycle import cycle
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.ladder import LEVELS

LEVEL = LEVELS["profile + Sainsot"]
# contact ratio, addendum in modules, published peak-to-peak [um] and greatest share of the load
HIGH = [
    (1.98, 1.1609313779295845, 7.564, 1.0),
    (1.999, 1.1735532839128897, 7.605, 1.0),
    (2.001, 1.1748834543227547, 2.890, 0.599),
    (2.02, 1.187534769194834, 2.869, 0.596),
    (2.15, 1.2748067330268988, 2.769, 0.582),
]


def gears(addendum):
    """Elastic gears z 40/50, m 3 mm, b 30 mm, and their load [N] at 320 Nm."""
    rack = Rack(addendum=addendum, dedendum=addendum + 0.25, tip_radius=0.2)
    pair = GearPair.of_teeth(3.0, 40, 50, 30.0, 0.0, rack)
    return ElasticPair(pair, (50.0, 50.0)), 320e3 / (0.5 * pair.pinion.base_diameter)


def peak_to_peak(addendum, steps, exact):
    """Contact ratio, peak-to-peak [um] and greatest share of the load."""
    elastic, load = gears(addendum)
    made = cycle(elastic.path, steps, exact)
    compliances = made.compliances(lambda s: LEVEL.compliance(elastic, s, load))
    found = share(compliances, made.separations(np.zeros_like), load)
    ratio = elastic.path.transverse_ratio
    return ratio, 1e3 * np.ptp(found.approach), found.forces.max() / load


@pytest.mark.parametrize("ratio, addendum, peak, share_", HIGH)
def test_both_sides_of_break_points_are_seen(ratio, addendum, peak, share_):
    """48 positions with break points do what 400 without do, and see what they miss."""
    found = peak_to_peak(addendum, 48, True)
    assert found[0] == pytest.approx(ratio, abs=1e-9)
    assert found[1] == pytest.approx(peak, rel=4e-3) and found[2] == pytest.approx(share_, abs=1e-3)


def test_a_uniform_grid_misses_a_zone_of_a_thousandth():
    """Nine times too little, as published."""
    assert peak_to_peak(HIGH[1][1], 400, False)[1] == pytest.approx(0.843, abs=1e-3)
    assert peak_to_peak(HIGH[1][1], 48, True)[1] == pytest.approx(7.605, abs=1e-3)


def best_relief(addendum, exact):
    """The mesh, the ranges, and the proven best linear relief on 48 positions."""
    elastic, load = gears(addendum)

    def compliance(positions):
        return LEVEL.compliance(elastic, positions, load)

    made = Mesh.of(cycle(elastic.path, 48, exact), compliance, 0.0, (load,))
    found = solve(problem(made, Ranges.of(made)), "exact", Budget(gap=1e-3), gap=1e-3)
    assert found.status == "optimal"
    return made, Ranges.of(made), found


@pytest.mark.parametrize(
    "ratio, addendum", [(1.999, HIGH[1][1]), pytest.param(1.98, HIGH[0][1], marks=pytest.mark.slow)]
)
def test_a_relief_made_on_a_grid_that_misses_the_single_zone(ratio, addendum):
    """It seems to leave nothing and leaves micrometres; with break points it does not happen."""
    _, ranges, blind = best_relief(addendum, False)
    made, _, found = best_relief(addendum, True)
    x = np.array([*blind.design["amount_mm"], *blind.design["length_mm"]])
    really = made.criteria(made.separations(*at_point(x, ranges))).peak_to_peak[0]
    assert blind.value < 2e-5 and really > 3e-3  # mm
    assert 4e-4 < found.bound <= found.value < 4.3e-4
    above = best_relief(HIGH[2][1], True)[2]  # contact ratio 2.001: the optimum does not jump
    assert above.value == pytest.approx(found.value, rel=0.03)


@pytest.mark.parametrize("part, peak, linear", [(0.1, 0.76, 0.72), (1.0, 7.02, 7.21)])
def test_compliances_at_the_design_load_will_do(part, peak, linear):
    """With the contact compliance of each pair's own force: 3 % off at full load, 6 % at a tenth.

    Fixed point of the sharing, z 25/50, m 3 mm, 200 Nm; peak-to-peak [um] as published.
    """
    pair = GearPair.of_teeth(3.0, 25, 50, 30.0, 0.0, Rack(tip_radius=0.38))
    elastic, load = ElasticPair(pair, (30.0, 50.0)), 200e3 / (0.5 * pair.pinion.base_diameter)
    made = cycle(elastic.path, 64, exact=False)
    apart = made.separations(np.zeros_like)
    forces = np.where(made.present, load, 0.0)
    for _ in range(30):
        own = np.maximum(forces, 1e-3 * part * load)
        compliances = made.compliances(lambda s, own=own: LEVEL.compliance(elastic, s, own.ravel()))
        found = share(compliances, apart, part * load)
        change, forces = np.abs(found.forces - forces).max(), found.forces
    assert change < 1e-9 * load
    assert 1e3 * np.ptp(found.approach) == pytest.approx(peak, abs=6e-3)
    fixed = made.compliances(lambda s: LEVEL.compliance(elastic, s, load))
    known = share(fixed, apart, part * load)
    assert 1e3 * np.ptp(known.approach) == pytest.approx(linear, abs=6e-3)
