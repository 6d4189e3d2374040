"""Influences of numbers that stand at an end of what a problem file may hold."""

import pytest
from edits import scene_of

from gearopt import explain
from gearopt.scenes.explaining.numbers import numbers

ENDS = {  # numbers at an end of what a file may hold: the table they stand in, and their lines
    "ratio 1": ("duty", "ratio = 1"),
    "ratio 1.0005": ("duty", "ratio = 1.0005"),
    "equal speeds": ("duty", "output_speed = '1450 rpm'"),
    "largest ratio": ("duty", "ratio = 1_000_000"),
    "largest tolerance": ("duty", "ratio = 5\nratio_tolerance = '50 %'"),
    "no tolerance": ("duty", "ratio = 1\nratio_tolerance = 0"),
    "least pinion": ("stage", "pinion_teeth = 5"),
    "largest pinion": ("stage", "pinion_teeth = 1000"),
    "both teeth": ("stage", "pinion_teeth = 20\nwheel_teeth = 20"),
    "one module of the list": ("limits", "module = ['2 mm', '2 mm']"),
    "close modules": ("limits", "module = ['2 mm', '2.001 mm']"),
    "close stage ratios": ("limits", "stage_ratio = [1, 1.0002]"),
    "largest helix angle": ("gears", "helix_angle = '45 deg'"),
    "widest faces": ("gears", "face_width_over_diameter = 10"),
}


def at_an_end(end, whole=""):
    """The scene of a drive with a number at an end of its range."""
    place, lines = ENDS[end]
    tables = {
        "duty": "power = '7.5 kW'\ninput_speed = '1450 rpm'",
        "gears": "",
        "stage": "",
        "limits": "k_factor = '2.07 MPa'\nunit_load = '48 MPa'\npinion_teeth = [20, 40]",
    }
    tables["duty"] += "" if place == "duty" else "\nratio = 1"
    tables["gears"] += "" if "face" in lines else "face_width_over_diameter = 0.6"
    tables[place] += "\n" + lines
    heads = (f"[[{n}]]\n{t}" if n == "stage" else f"[{n}]\n{t}" for n, t in tables.items())
    return scene_of("\n".join([*heads, whole]))[0]


WHOLE = "[teeth]\nmodules = ['2 mm', '50 mm']"
OF_WHOLE_TEETH = ("ratio 1", "largest ratio", "both teeth", "one module of the list")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("end", "whole"), [*((end, "") for end in ENDS), *((end, WHOLE) for end in OF_WHOLE_TEETH)]
)
def test_numbers_at_the_ends_of_their_ranges_are_explained(end, whole):
    """A probe that the file would refuse counts as no design there."""
    scene = at_an_end(end, whole)
    found = explain(scene)
    vast = end == "largest ratio" and whole  # more pairs than are listed: no price, and said so
    assert found.result.status == ("limit" if vast else "optimal")
    assert bool(found.message) == bool(vast)
    assert any(i.sensitivity is not None for i in found.influences)
    by = {i.key: i for i in found.influences}
    assert whole or set(by) == {n.key for n in numbers(scene)}
    key = {"ratio 1": "duty.ratio", "equal speeds": "duty.output_speed"}.get(end)
    if key and not whole:  # a drive below 1 is one with a wheel that drives
        assert by[key].resolved == pytest.approx([by[key].sensitivity] * 2, rel=2e-3)
    if end == "close modules":  # 2 mm times 1.001 is above 2.001 mm: the other end is no substitute
        assert by["limits.module[1]"].resolved[1] is None
