"""Gears of more teeth than are drawn: the page says so, and has all else."""

import pytest

from gearopt import solve
from gearopt.report.pages.result import sections

PAIR = {"module": "3 mm", "pinion_teeth": 25, "wheel_teeth": 20_000, "face_width": "30 mm"}
GIVEN = {
    "kind": "pair",
    "duty": {"power": "20 kW", "input_speed": "955 rpm"},
    "stage": [PAIR],
}
LAID_OUT = {
    "kind": "drive",
    "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 1000},
    "stage": [{"face_width_over_diameter": 0.6}],
    "limits": {"k_factor": "2.07 MPa", "unit_load": "48 MPa", "pinion_teeth": [20, 20]},
    "teeth": {"modules": ["4 mm"]},
    "layout": {"shaft_stress": "40 MPa"},
}


@pytest.mark.parametrize("tables", [GIVEN, LAID_OUT], ids=["pair", "layout"])
def test_gears_of_too_many_teeth_are_named_instead_of_drawn(tables):
    result = solve({"gearopt": 1, **tables})
    (space,) = (s for s in sections(result) if s.heading == "In three dimensions")
    teeth = result.design["stages"][0]["wheel_teeth"]
    assert teeth > 10_000 and not space.figures
    assert space.words == (
        f"Not drawn: a gear has {teeth:,} teeth, and teeth are drawn of up to 10,000.",
    )
