"""A planetary stage in place of the train of a servo axis: its file, and what the axis does."""

import math
from decimal import Decimal

import pytest
from scene_files import dump, mended, parse, walk
from servo_files import changed, solved, text

from gearopt.errors import SceneError
from gearopt.scenes.reading.load import read

STAGE = text("planetary")
NO_ERRORS = [
    ("planetary", name)
    for name in ("sun_thickness", "planet_thickness", "ring_thickness", "pin_radius")
] + [("planetary", "pin_position"), ("planetary", "pin_clearance")]
PAIRS = {"module": "0.5 mm", "pinion_teeth": 20, "wheel_teeth": 100}

TENTH = Decimal("0.1")
REFUSED = [  # edits, dropped, key, words, whether what is to be written is accepted
    ([(("planetary", "ring_teeth"), 61)], [], "planetary.ring_teeth", "no multiple of the 3", True),
    ([(("planetary", "planet_teeth"), 13)], [], "planetary.ring_teeth", "no room", True),
    ([(("planetary", "planets"), 6)], [], "planetary.planets", "no room", True),
    ([(("planetary", "ring_shift"), 1)], [], "planetary.ring_shift", "no room", True),
    ([(("planetary", "ring_shift"), TENTH)], [], "planetary.ring_shift", "thicker", True),
    ([(("planetary", "planet_bore"), "8 mm")], [], "planetary.planet_bore", "root circle", True),
    (
        [(("planetary", "ring_outside_diameter"), "24 mm")],
        [],
        "planetary.ring_outside_diameter",
        "root circle",
        True,
    ),
    ([(("planetary", "fixed"), "planet")], [], "planetary.fixed", "ring", True),
    ([(("mesh",), [PAIRS, PAIRS])], [], "mesh", "gear pairs", True),
    ([(("shaft",), {"diameter": "8 mm", "length": "50 mm"})], [], "shaft", "gear pairs", True),
    ([], [("motor",), ("load",), ("duty",)], "duty", "nothing is asked for", False),
    (
        [(("duty",), {"motion": "swing", "amplitude": "20 deg", "frequency": "2 Hz"})],
        [],
        "planetary.friction",
        "without losses",
        True,
    ),
]


@pytest.mark.parametrize(("edits", "drop", "key", "words", "accepted"), REFUSED)
def test_what_does_not_go_together_is_refused(edits, drop, key, words, accepted):
    content = parse(STAGE)
    for place, value in edits:
        *way, last = place
        walk(content, way)[last] = value
    for place in drop:
        del content[place[0]]
    data = dump(content)
    with pytest.raises(SceneError) as wrong:
        read(data.encode(), "my.toml")
    assert wrong.value.key == key and words in wrong.value.rule
    if accepted:
        read(mended(data, wrong.value.fix).encode(), "my.toml")


@pytest.mark.parametrize(("held", "ratio"), [("ring", 78 / 18), ("carrier", 60 / 18), ("sun", 1.3)])
def test_the_axis_with_a_stage_is_slower_than_the_best(held, ratio):
    """Move time by two ramps of J/N + N (J_M + J_s), efficiency and friction counted by hand."""
    result = solved(STAGE, (("planetary", "fixed"), held))
    report, given = result.report, result.design["ratio"]["given_train"]
    assert report["given_ratio"] == pytest.approx(ratio)
    inertia = 1e3 * (1e-7 * 9.37 + report["given_inertia_kg_m2"])
    load, eta = 1e3 * 150e-7, report["given_efficiency"]
    ahead = (eta * ratio * (27.8 - 0.82) - 10.0) / (load + eta * ratio**2 * inertia)
    back = (ratio * (27.8 + 0.82) + 10.0) / (load + ratio**2 * inertia)
    ramp = 2.0 / (1.0 / ahead + 1.0 / back)
    assert given["value"] == pytest.approx(2.0 * math.sqrt(math.pi / ramp), rel=1e-9)
    assert given["value"] >= report["best_move_time_s"] * (1.0 - 1e-9)


def test_without_friction_the_efficiency_is_that_of_the_load():
    bare = changed(STAGE, (("load", "efficiency"), "90 %"), drop=[("planetary", "friction")])
    assert bare.servo_duty().drive.efficiency == 0.9
    lossy = changed(STAGE, (("load", "efficiency"), "90 %"))
    assert lossy.servo_duty().drive.efficiency == pytest.approx(0.9 * 0.9821794462)


def test_lost_motion_is_told_where_deviations_are():
    figures = solved(STAGE, drop=NO_ERRORS).report
    assert not any("lost_motion" in name for name in figures)
    tight = solved(STAGE, (("planetary", "pin_position"), "0.02 mm")).report
    assert tight["given_least_lost_motion_deg"] < 0.0
