"""Files of servo axes with a few keys changed."""

from pathlib import Path

from scene_files import dump, parse, walk

import gearopt
from gearopt.scenes.reading.load import read

PROBLEMS = Path(__file__).parents[2] / "problems"


def text(name):
    return (PROBLEMS / f"servo_{name}.toml").read_text(encoding="utf-8")


def changed(base, *edits, drop=()):
    """The scene of a file with (place, value) set and places dropped."""
    content = parse(base)
    for place, value in edits:
        *way, last = place
        walk(content, way)[last] = value
    for place in drop:
        *way, last = place
        del walk(content, way)[last]
    return read(dump(content).encode(), "my.toml")[1]


def solved(base, *edits, drop=()):
    return gearopt.solve(changed(base, *edits, drop=drop))


RATIO = text("gimbal_ratio")

TOLERANCES = text("gimbal_tolerances")

STIFF = text("gimbal_stiff")

GIVEN_GEARS = {"module": "1 mm", "pinion_teeth": 20, "wheel_teeth": 100, "grade": 7}

NARROW = (
    (("accuracy", "error"), "0.15 deg"),
    (("space", "width"), "74 mm"),
    (("train", "modules"), ["0.5 mm"]),
)

BARE = [("stiffness",), ("lightest",), ("tolerances",), ("cost",), ("budget",)]
