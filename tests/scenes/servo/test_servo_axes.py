"""Random servo axes against geometry and enumeration of their own: no clash, nothing outside."""

import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from fractions import Fraction as F
from functools import cache

import numpy as np
import pytest
from campaigns import few
from servo_axes import (
    SAME,
    beside_the_output,
    fits_on_a_grid,
    held_against,
    outline,
    random_axis,
    room,
    trains,
    worth,
)

import gearopt
from gearopt.formulations.servo import split
from gearopt.optimise.clock import Clock
from gearopt.report.kinds.servo.housing import box as box_section
from gearopt.report.measures import METRIC
from gearopt.scenes.reading.load import read
from gearopt.scenes.servo.explain import remedies

PIXEL = 0.02  # rounding of a drawing


def solved(axis):
    return gearopt.solve(read(axis.text().encode(), "axis.toml")[1])


def check(seed, most_pinions=3):
    """Status of an axis, after everything that is shown of it was looked at."""
    axis = random_axis(seed, most_pinions)
    result = solved(axis)
    train = held_against(axis, result, trains(axis), lambda other: worth(axis, other))
    if train is None:
        return "infeasible"
    scale = {"inertia": 1e-3, "mass": 1.0, "error": 180.0 / math.pi}[axis.goal]
    assert result.value == pytest.approx(scale * worth(axis, train), rel=SAME)
    if axis.box is not None:
        laid_out(axis, train, result)
    return "optimal"


def laid_out(axis, train, result):
    """The layout in numbers and as it is drawn: inside the box, the motor beside the output."""
    box = result.design["box"]
    motor, output = (math.radians(box[f"{k}_angle_deg"]) for k in ("motor", "output"))
    points = outline(axis, train, motor, output)
    size = np.array([np.ptp(points.real), np.ptp(points.imag)])
    needed = np.array([box["needed_width_mm"], box["needed_height_mm"]])
    assert (size <= needed * (1.0 + 1e-9)).all() and size == pytest.approx(needed, rel=1e-4)
    inner = np.array([float(side) for side in axis.box])
    assert box["fits"] == bool((needed <= inner * (1.0 + 1e-8)).all())
    assert box["fits"] or not axis.required
    assert beside_the_output(axis, train, motor, output) >= -1e-6
    if not box["fits"]:
        assert not fits_on_a_grid(axis, train)
    drawn(axis, train, box, ET.fromstring(box_section(result, METRIC).drawings[0].svg))


def drawn(axis, train, box, svg):
    """Circles and sector of a drawing: to scale, within what is needed, clear of each other."""
    frame = next(e for e in svg.iter("rect") if "box" in e.get("class").split())
    scale = float(frame.get("width")) / float(axis.box[0])
    told = {}
    for circle in svg.iter("circle"):
        if (title := circle.find("title")) is not None:
            place = [float(circle.get(k)) for k in ("cx", "cy")]
            told.setdefault(title.text.split(":")[0].split(",")[0], []).append(
                (np.array(place), float(circle.get("r")) / scale)
            )
    z1, z2, z3, z4, m1, m2 = (float(v) for v in train)
    radii = {
        "motor": [axis.motor / 2],
        "wheel 1": [m1 * (z2 + 2) / 2],
        "pinion": [m1 * (z1 + 2) / 2, m2 * (z3 + 2) / 2],
        "output shaft with hub": [axis.thick / 2] * (axis.thick > 0),
        "shaft between the stages": [axis.shaft[0] / 2],
    }
    for name, sizes in radii.items():
        shown = sorted(radius for _, radius in told.get(name, []))
        assert shown == pytest.approx(sorted(map(float, sizes)), abs=PIXEL / scale), name
    places = {name: found[0][0] / scale for name, found in told.items()}
    links = float(m1) * (z1 + z2) / 2, float(m2) * (z3 + z4) / 2
    apart = math.dist(places["motor"], places["wheel 1"])
    assert apart == pytest.approx(links[0], abs=3 * PIXEL / scale)
    for a, b, needed in (
        ("motor", "shaft between the stages", axis.motor / 2 + axis.shaft[0] / 2),
        ("motor", "output shaft with hub", axis.motor / 2 + axis.thick / 2),
        ("wheel 1", "output shaft with hub", F(str(m1)) * F(z2 + 2) / 2 + axis.thick / 2),
    ):
        if a in places and b in places:
            assert math.dist(places[a], places[b]) >= float(needed) - 3 * PIXEL / scale, (a, b)
    wall = next(e for e in svg.iter("rect") if "wall" in e.get("class").split())
    x, y, width, height = (float(wall.get(k)) for k in ("x", "y", "width", "height"))
    for name, found in told.items():
        for (cx, cy), radius in found:
            r = radius * scale - 2 * PIXEL
            assert x <= cx - r and cx + r <= x + width, name
            assert y <= cy - r and cy + r <= y + height, name
    assert width / scale == pytest.approx(box["needed_width_mm"], abs=2 * PIXEL / scale)


@pytest.mark.parametrize("seed", few(range(4), 1))
def test_a_random_axis_has_no_clash_and_no_better_train(seed):
    assert check(seed) in ("optimal", "infeasible")


FIELDS = {
    "shaft.diameter": "shaft",
    "space.motor_diameter": "motor",
    "space.hub_diameter": "hub",
    "train.output_shaft_diameter": "output",
}


def thinned(change):
    """Whether a change makes a diameter smaller."""
    if change.key not in FIELDS:
        return False
    was, write = (F(text.strip('"').split()[0]) for text in (change.was, change.write))
    return write < was


def thinner(axis, remedy, more=1.0):
    """The axis with a remedy's diameters, so many times as large."""
    new = {FIELDS[c.key]: F(c.write.strip('"').split()[0]) * F(more) for c in remedy.changes}
    if "shaft" in new:
        new["shaft"] = (new["shaft"], axis.shaft[1])
    return replace(axis, **new)


def check_ways_out(seed, most_pinions=3):
    """How many remedies an axis has whose gears have no room; each is the least, by enumeration."""
    axis = random_axis(seed, most_pinions)
    if trains(axis) or not trains(axis, clear=False):
        return None
    explained = remedies(read(axis.text().encode(), "axis.toml")[1], Clock())
    assert set(explained.conflict) <= {"shaft", "motor", "output_shaft"} and explained.conflict
    sized = [r for r in explained.remedies if all(thinned(c) for c in r.changes)]
    for remedy in sized:
        assert trains(thinner(axis, remedy))
        assert not trains(thinner(axis, remedy, 1.001))
        assert remedy.verified["with"] == "feasible"
        assert read(thinner(axis, remedy).text().encode(), "axis.toml")
    return len(sized)


def listed(axis):
    """All trains that the kernel finds, in the order of `trains`."""
    rows = split.feasible(read(axis.text().encode())[1].servo_train())
    modules = {float(m): m for m in axis.modules}
    return {
        (*(int(z) for z in (z1, z2, z3, z4)), modules[m1], modules[m2])
        for z1, z3, z2, z4, m1, m2 in rows
    }


TOUCHING = {  # what is made to touch exactly, and the larger size that does not fit
    "hub": lambda z1, z2, z3, z4, m1, m2, axis: m2 * (z3 + z4) - m1 * (z2 + 2),
    "motor": lambda z1, z2, z3, z4, m1, m2, axis: m1 * (z1 + z2) - axis.shaft[0],
    "shaft": lambda z1, z2, z3, z4, m1, m2, axis: min(
        m1 * z2 - m1 * F(5, 2), m2 * z3 - m2 * F(5, 2)
    ),
}


@cache
def any_train(seed):
    """An axis with nothing in the way but the shaft, and its trains whatever they run into."""
    axis = random_axis(seed)
    axis = replace(axis, box=(F(500), F(500)), motor=F(1, 100), hub=F(0), output=None)
    return axis, trains(axis, clear=False)


@pytest.mark.parametrize("what", TOUCHING)
@pytest.mark.parametrize("seed", few([0, 1, 3, 5], 1))
def test_what_touches_exactly_is_clear(what, seed):
    """The kernel has all trains of an enumeration in fractions, the one that touches too."""
    free, every = any_train(seed)
    clear = [train for train in every if not room(free, train)]
    train = clear[len(clear) // 2]
    size = TOUCHING[what](*train, free)
    for value, touches in ((size, True), (size + F(1, 10**9), False)):
        axis = replace(free, **{what: value})
        if what == "shaft":
            bore = max(free.bore, value + F(5, 2) * min(free.modules))
            axis = replace(free, shaft=(value, free.shaft[1]), bore=bore)
        known = [t for t in every if t[5] * t[2] >= axis.bore and not room(axis, t)]
        assert (train in known) == (touches and train[5] * train[2] >= axis.bore)
        assert listed(axis) == set(known)
        best = min((worth(axis, t) for t in known), default=math.inf)
        own = read(axis.text().encode())[1].servo_train()
        for method in ("exact", "enumeration"):
            result = gearopt.solve(split.problem(own, axis.goal), method=method)
            assert result.status == ("optimal" if known else "infeasible")
            assert not known or result.value == pytest.approx(best, rel=SAME)
        assert result.proof["feasible_trains"] == len(known)
        if known:
            relaxed = gearopt.solve(split.relaxation(own, axis.goal))
            assert relaxed.status == "optimal" and relaxed.bound <= best * (1.0 + SAME)


@pytest.mark.parametrize("seed", few([13, 35, 39, 79], 1))
def test_the_diameter_that_is_proposed_is_the_largest_that_leaves_a_train(seed):
    assert check_ways_out(seed) > 0


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 70, 10))
def test_seventy_axes(first):
    found = [check(seed) for seed in range(first, first + 10)]
    assert 0 < found.count("optimal") < 10


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 1010, 5))
def test_axes_of_many_pinions(first):
    for seed in range(first, first + 5):
        assert check(seed, most_pinions=12) in ("optimal", "infeasible")


@pytest.mark.slow
def test_ways_out_of_many_axes():
    found = [check_ways_out(seed) for seed in range(80)]
    assert sum(bool(count) for count in found) >= 6
