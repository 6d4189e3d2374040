"""A planetary stage in the file of a layout: what is refused beside it, and what is drawn of it."""

from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.report.drawing.bodies import layout_of, motor

FILE = Path(__file__).parents[3] / "problems" / "planetary_box.toml"
LIST = ["30 mm", "40 mm", "50 mm", "60 mm"]

REFUSED = [  # changes, key, words
    ({"layout.together": True}, "layout.together", "its gears are sized before"),
    ({"layout.slabs": [[1], [2], [3]]}, "layout.slabs", "where they may be is not known"),
    (
        {"layout.bearing_diameters": LIST, "layout.bearing_widths": LIST},
        "layout.bearing_widths",
        "where they may be is not known",
    ),
    (
        {"stage[2].type": "planetary", "stage[3].type": "planetary"},
        "layout",
        "all is in one line",
    ),
]


@pytest.mark.parametrize(("changes", "key", "words"), REFUSED)
def test_what_a_layout_with_planets_has_not_is_refused(changes, key, words):
    with pytest.raises(SceneError) as wrong:
        gearopt.load(FILE, changes)
    assert wrong.value.key == key and words in wrong.value.rule
    assert wrong.value.fix is not None and wrong.value.fix.action == "remove"


@pytest.mark.slow
def test_the_disc_is_drawn_once_and_the_motor_at_its_shaft():
    result = gearopt.solve(FILE)
    layout = layout_of(result)
    (ring,) = (gear for gear in layout.gears if gear.member == "ring")
    stage = result.design["stages"][0]
    assert ring.tip_diameter_mm == pytest.approx(stage["ring_outside_diameter_mm"])
    first, second = layout.shafts[:2]
    assert (first.y_mm, first.z_mm) == (second.y_mm, second.z_mm) == (0.0, 0.0)
    near, far = sorted((first, second), key=lambda shaft: shaft.from_mm)
    assert near.to_mm == pytest.approx(ring.from_mm) and far.from_mm == pytest.approx(ring.to_mm)
    _, start, end = motor(layout)
    assert (end == 0.0) == (first is near) and (start == layout.box.length_mm) == (first is far)
    assert len(layout.link_angles_deg) == 2
