"""Planetary stages in a layout: discs whose shafts are in one line, against a scan of all places.

The scan knows no chain: it stands cylinders side by side, stage by stage, and looks at all of them.
"""

import itertools

import numpy as np
import pytest

from gearopt.formulations.drive import layout
from gearopt.formulations.drive.gearbox import Clearances, Gearbox, KeepOut, Place, Planetary, Shaft
from gearopt.formulations.drive.layout.faults import faults, possible
from gearopt.formulations.drive.layout.layout_text import placed, read
from gearopt.formulations.drive.layout.slabs import arrange, arrangements
from gearopt.optimise.certified import run
from gearopt.physics.gears import GearPair

GAPS = Clearances(4.0, 2.0, 6.0, 5.0)
STAGES = {  # what the letters of a train stand for
    "a": GearPair.of_teeth(2.0, 18, 50, 22.0),
    "b": GearPair.of_teeth(2.5, 19, 47, 30.0),
    "c": GearPair.of_teeth(3.0, 20, 52, 26.0),
    "P": Planetary(96.0, 28.0, 5.0),
    "Q": Planetary(70.0, 20.0, 4.0),
}
TRAINS = ("Pab", "aPb", "abP", "aPQb", "PaQb")


def slow(*trains):
    """Trains whose tests take longer."""
    return tuple(pytest.param(train, marks=pytest.mark.slow) for train in trains)


def box(train, **given):
    """Gearbox of a train."""
    radii = (7.0, 9.0, 12.0, 15.0, 18.0)
    shafts = tuple(Shaft(r) for r in radii[: len(train) + 1])
    return Gearbox(tuple(STAGES[name] for name in train), shafts, GAPS, **given)


def slab_orders(stages):
    """Ordered partitions of stages without neighbours in one part, by words over part numbers."""
    for word in itertools.product(range(stages), repeat=stages):
        if set(word) == set(range(max(word) + 1)):
            if all(a != b for a, b in itertools.pairwise(word)):
                yield tuple(
                    tuple(s for s in range(stages) if word[s] == k) for k in range(max(word) + 1)
                )


def cylinders(gearbox, slabs):
    """(axis, radius, start, end, kind, stage) of all bodies; None where a disc stops a shaft."""
    pairs, gap = gearbox.pairs, gearbox.clearances.axial
    start, x = {}, gap
    for slab in slabs:
        for s in slab:
            start[s] = x
        x += max(pairs[s].width if isinstance(pairs[s], Planetary) else pairs[s].face_width
                 for s in slab) + gap  # fmt: skip
    length, axis, bodies = x, 0, []
    on = [0]
    for s, pair in enumerate(pairs):
        if isinstance(pair, Planetary):
            bodies.append(
                (axis, 0.5 * pair.tip_diameter, start[s], start[s] + pair.width, "gear", s)
            )
        else:
            for gear, place in ((pair.pinion, axis), (pair.wheel, axis + 1)):
                ends = start[s], start[s] + pair.face_width
                bodies.append((place, 0.5 * gear.tip_diameter, *ends, "gear", s))
            axis += 1
        on.append(axis)
    for k, shaft in enumerate(gearbox.shafts):
        stages = [s for s in (k - 1, k) if 0 <= s < len(pairs)]
        discs = [s for s in stages if isinstance(pairs[s], Planetary)]
        low, high = 0.0, length
        for s in discs:
            others = [t for t in stages if t != s]
            if others:  # towards its other gear
                above = start[others[0]] > start[s]
            else:  # an end of the train: away from the shaft beyond the disc
                above = start[s + 1 if k == s else s - 1] < start[s]
            if above:
                low = max(low, start[s] + pairs[s].width)
            else:
                high = min(high, start[s])
        if low >= high:
            return None
        bodies.append((on[k], shaft.radius, low, high, "shaft", -1))
    for k, pair in enumerate(pairs):  # both shafts of a disc on one side of it
        if isinstance(pair, Planetary):
            ends = bodies[len(bodies) - len(gearbox.shafts) :][k : k + 2]
            sides = [body[2] >= start[k] + pair.width for body in ends]
            if sides[0] == sides[1]:
                return None
    return bodies, length, axis


def scanned(gearbox, steps):
    """Least volume over all orders and a grid of angles."""
    links = [p.centre_distance for p in gearbox.pairs if not isinstance(p, Planetary)]
    angles = 2.0 * np.pi * np.arange(steps) / steps
    grid = np.meshgrid(*([angles] * len(links)), indexing="ij")
    y, z = [0.0 * grid[0]], [0.0 * grid[0]]
    for link, angle in zip(links, grid, strict=True):
        y.append(y[-1] + link * np.cos(angle))
        z.append(z[-1] + link * np.sin(angle))
    best = np.inf
    for slabs in slab_orders(len(gearbox.pairs)):
        made = cylinders(gearbox, slabs)
        if made is None:
            continue
        bodies, length, _ = made
        wrong = np.zeros(grid[0].shape, bool)
        for p, q in itertools.combinations(bodies, 2):
            if p[0] == q[0] or min(p[3], q[3]) - max(p[2], q[2]) <= 1e-9:
                continue
            if p[4] == q[4] == "gear" and p[5] == q[5]:
                continue
            gap = GAPS.gears if p[4] == q[4] == "gear" else GAPS.shafts
            there = np.hypot(y[p[0]] - y[q[0]], z[p[0]] - z[q[0]])
            wrong |= there < p[1] + q[1] + gap - 1e-9
        sides = []
        for c in (y, z):
            low = np.minimum.reduce([c[b[0]] - b[1] for b in bodies])
            high = np.maximum.reduce([c[b[0]] + b[1] for b in bodies])
            sides.append(high - low + 2.0 * GAPS.wall)
        volume = np.where(wrong, np.inf, sides[0] * sides[1] * length)
        best = min(best, float(volume.min()))
    return best


@pytest.mark.parametrize("train", ("aP", "Pa", *slow("Pab", "aPb", "abP", "aPQb", "PaQb")))
def test_the_smallest_box_is_that_of_a_scan(train):
    gearbox = box(train)
    result, _ = run(layout.problem(gearbox))
    least = scanned(gearbox, 360)
    assert result.status == "optimal" and not faults(gearbox)
    assert result.bound <= least and result.value <= least
    assert result.value == pytest.approx(least, rel=1e-2)
    assert possible(gearbox, 5.0)


@pytest.mark.parametrize("train", TRAINS)
def test_orders_are_those_in_which_no_disc_stops_a_shaft(train):
    gearbox = box(train, keep_outs=(KeepOut("end", (900.0, 950.0), (0.0, 9.0), (0.0, 5.0)),))
    allowed = {s for s in slab_orders(len(train)) if cylinders(gearbox, s) is not None}
    assert allowed == {s for s in slab_orders(len(train)) if gearbox.in_line(s)}
    for one in arrangements(gearbox):
        assert one.slabs in allowed
        bodies, length, _ = cylinders(gearbox, one.slabs)
        spans = sorted(b[2:4] for b in bodies if b[4] == "shaft")
        own = [b for k in one.bodies for b in k if b.name.startswith("shaft")]
        assert np.array(sorted(b.x for b in own)) == pytest.approx(np.array(spans))
        assert one.length == length


def test_both_shafts_of_a_planetary_stage_are_in_one_place():
    gearbox = box("aPb", places=(Place(3, (60.0, 80.0)),), level=(0, 2))
    result, outcome = run(layout.problem(gearbox))
    angles, order = read(arrangements(gearbox), outcome.x)
    axes = placed(gearbox, order, angles).axes
    assert result.status == "optimal" and axes[1] == axes[2]
    assert axes[2][1] == pytest.approx(0.0, abs=1e-6) and 60.0 - 1e-6 <= axes[3][0] <= 80.0 + 1e-6
    assert np.hypot(*axes[1]) == pytest.approx(STAGES["a"].centre_distance)


def test_faults_of_places_in_one_line():
    apart = box("aPb", places=(Place(1, (50.0, 51.0)), Place(2, (60.0, 61.0))))
    assert any("9.00 mm apart" in text for text in faults(apart))
    assert possible(apart, 5.0) is False


def test_a_disc_that_is_too_large_for_the_next_stage_clashes():
    large = Planetary(2.0 * STAGES["a"].centre_distance, 28.0, 5.0)
    gearbox = Gearbox((large, STAGES["a"]), tuple(map(Shaft, (5.0, 7.0, 9.0))), GAPS)
    assert any("planetary stage 1 and shaft 3" in text.lower() for text in faults(gearbox))


def test_orders_that_are_given_are_checked():
    with pytest.raises(ValueError, match="between the gears"):
        box("aPb", slabs=((1,), (0, 2)))
    with pytest.raises(ValueError, match="nothing to lay out"):
        Gearbox((STAGES["P"],), (Shaft(5.0), Shaft(9.0)))
    assert arrange(box("aPb"), ((0,), (1,), (2,))).length == pytest.approx(5 * 4 + 22 + 28 + 30)
