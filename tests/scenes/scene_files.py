"""Right problem files to start from, written and mended by machine without the code under test."""

import datetime as dt
import re
import tomllib
from decimal import Decimal, InvalidOperation
from pathlib import Path

from gearopt.scenes.drive import KIND

EXAMPLE = KIND.example.text

ELEVATOR = (Path(__file__).parents[2] / "problems" / "elevator.toml").read_text(encoding="utf-8")

BY_COUNT = """
gearopt = 1
kind = "drive"
stages = 3

[duty]
power = "40 hp"
input_speed = "2980 rpm"
ratio = 62.5

[gears]
helix_angle = "12 deg"
face_width_over_diameter = [0.4, 1.1]
face_width_step = "1 mm"

[limits]
k_factor = "1.5 MPa"
unit_load = "6000 psi"
pinion_teeth = [17, 35]
module = ["1 mm", "12 mm"]
stage_ratio = [2, 7]

[teeth]
modules = "ISO 54 I+II"

[objective]
minimise = "sum_of_centre_distances"
"""

FIXED = """
gearopt = 1
kind = "drive"
title = "Second stage given"

[duty]
power = "11 kW"
input_speed = "1480 1/min"
output_speed = "60 1/min"
ratio_tolerance = 0.02

[[stage]]
face_width_over_diameter = [0.3, 0.9]
stage_ratio = [2, 6]
module = ["2 mm", "4 mm"]

[[stage]]
module = "5 mm"
pinion_teeth = 23
wheel_teeth = [80, 130]
face_width = "80 mm"
face_width_over_diameter = [0.3, 1.2]
wheel_diameter = "700 mm"
unit_load = "40 MPa"

[limits]
preset = "chong-lee-elevator"
pinion_teeth = [19, 31]
wheel_teeth = [30, 300]
wheel_diameter = "900 mm"

[teeth]
modules = ["2 mm", "2.5 mm", "3 mm", "4 mm", "5 mm", "0.25 in"]
coprime = true

[objective]
minimise = "mass"
density = "7.85 kg/dm^3"

[x-notes]
author = "a user's own table"
"""

CONTINUOUS = """
gearopt = 1
kind = "drive"

[duty]
power = "2.2 MW"
input_speed = "1500 rpm"
output_speed = "20 rad/s"

[[stage]]
face_width_over_diameter = [0.5, 0.8]
face_width_step = "5 mm"
k_factor = "2 N/mm^2"

[limits]
k_factor = "300 psi"
unit_load = "7 ksi"
pinion_teeth = [20, 40]
"""

LAID_OUT = (
    ELEVATOR.split("[x-expected]")[0]
    + """
[layout]
minimise = "plan_area"
shaft_diameters = ["20 mm", "1.5 in", "60 mm"]
bearing_diameters = ["47 mm", "80 mm", "110 mm"]
bearing_widths = ["14 mm", "18 mm", "22 mm"]
span = "partial"
slabs = [[2], [1]]
wall_clearance = "0 mm"
motor_diameter = "260 mm"
split_line = [1, 2]
largest_height = "900 mm"

[[place]]
shaft = 3
y = ["-300 mm", "-100 mm"]
z = "0.5 in"
tolerance = "0.1 mm"

[[keep_out]]
name = "floor"
y = ["-1 m", "1 m"]
z = ["-500 mm", "-200 mm"]
x = ["0 mm", "100 mm"]
"""
)

PROCESSES = (
    ELEVATOR.split("[x-expected]")[0]
    + """
[process_one]
stage_ratios = [4.96, 4.36]

[process_two]
first_centre_distance = "150 mm"
modules = ["2 mm", "3 mm"]
"""
)

BASES = {
    "elevator": ELEVATOR,
    "example": EXAMPLE,
    "by_count": BY_COUNT,
    "fixed": FIXED,
    "continuous": CONTINUOUS,
    "laid_out": LAID_OUT,
    "processes": PROCESSES,
}


def parse_float(text):
    try:
        return Decimal(text)
    except InvalidOperation:
        return Decimal("inf")


def parse(text):
    return tomllib.loads(text, parse_float=parse_float)


def dump(content):
    """A file's content as TOML, every number exactly as it stands."""
    own = {k: v for k, v in content.items() if isinstance(v, dict)}
    many = {k: v for k, v in content.items() if _tables(v)}
    lines = [_line(k, v) for k, v in content.items() if k not in own and k not in many]
    for name, table in own.items():
        lines += ["", f"[{_key(name)}]", *(_line(k, v) for k, v in table.items())]
    for name, tables in many.items():
        for table in tables:
            lines += ["", f"[[{_key(name)}]]", *(_line(k, v) for k, v in table.items())]
    return "\n".join(lines) + "\n"


def _tables(value):
    return isinstance(value, list) and value != [] and all(isinstance(v, dict) for v in value)


def _line(key, value):
    return f"{_key(key)} = {_value(value)}"


def _key(name):
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _value(name)


def _value(value):
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        plain = value.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in plain) + '"'
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(_line(k, v) for k, v in value.items()) + "}"
    if isinstance(value, Decimal):
        return "nan" if value.is_nan() else str(value).lower().replace("infinity", "inf")
    if isinstance(value, int):
        return str(value) if value.bit_length() < 10_000 else hex(value)
    assert isinstance(value, dt.date | dt.time), value
    return value.isoformat()


def mended(text, fix):
    """The text of a file after a remedy."""
    if fix.action == "replace":
        assert (fix.key, fix.value) == ("", "new drive")
        return EXAMPLE
    content = parse(text)
    *way, last = _parts(fix.key)
    parent = walk(content, way)
    if fix.action == "set":
        parent[last] = parse(f"v = {fix.value}")["v"]
    elif fix.action == "remove":
        del parent[last]
    elif fix.action == "rename":
        assert fix.value not in parent
        parent[fix.value] = parent.pop(last)
    else:
        assert fix.action == "swap"
        *way, other = _parts(fix.value)
        beside = walk(content, way)
        parent[last], beside[other] = beside[other], parent[last]
    return dump(content)


def _parts(path):
    """The parts of `stage[2]."my key"`: "stage", 1, "my key"."""
    found = re.findall(r'\[(\d+)\]|("(?:[^"\\]|\\.)*")|([A-Za-z0-9_-]+)', path)
    return [int(n) - 1 if n else parse(f"v = {q}")["v"] if q else bare for n, q, bare in found]


def walk(content, way):
    """What stands at a place, such as ("stage", 1, "module"); missing tables are made."""
    for part in way:
        content = content[part] if isinstance(part, int) else content.setdefault(part, {})
    return content


def tables_of(content):
    """(place, table) of every table of a file but the user's own."""
    for name, value in content.items():
        if name.startswith("x-"):
            continue
        if isinstance(value, dict):
            yield (name,), value
        elif isinstance(value, list):
            yield from (((name, k), t) for k, t in enumerate(value) if isinstance(t, dict))


def keys(content):
    """The places of all keys with a value."""
    top = [(k,) for k, v in content.items() if not isinstance(v, dict | list)]
    return top + [(*place, key) for place, table in tables_of(content) for key in table]


def quantities(content):
    """The places of all texts with a number and a unit."""
    found = [(place, walk(content, place)) for place in keys(content)]
    return [p for p, v in found if isinstance(v, str) and re.match(r"[0-9.]+ \S", v)]


def put(text, place, value):
    """The file with a value at a place."""
    content = parse(text)
    *way, last = place
    walk(content, way)[last] = value
    return dump(content).encode()


def drop(text, place):
    """The file without what is at a place."""
    content = parse(text)
    *way, last = place
    del walk(content, way)[last]
    return dump(content).encode()


def rename(text, place, name):
    """The file with a key or table under another name, in the same order."""
    content = parse(text)
    *way, last = place
    parent = walk(content, way)
    items = [(name if key == last else key, value) for key, value in parent.items()]
    parent.clear()
    parent.update(items)
    return dump(content).encode()
