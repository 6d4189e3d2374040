"""Every key of a strain wave gearing's file changes the answer, or the refusal says why not."""

import json
from typing import get_args

import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.reading.load import read
from gearopt.scenes.strain_wave import Scene, model
from gearopt.scenes.strain_wave.example import FROM_DUTY

GIVEN = """\
gearopt = 1
kind = "strain_wave"
title = "one"
source = "nowhere"
[duty]
torque = "100 N m"
ratio = 80
outer_diameter = "90 mm"
[gears]
module = "0.5 mm"
pressure_angle = "20 deg"
profile_shift = 0.9
addendum = 0.6
deflection = 1
rim = "0.8 mm"
clearance = 0.25
face_width = "10 mm"
shell = "3 mm"
[sharing]
rim = "elastic"
"""
DISCS = GIVEN + '[wave_generator]\nshape = "discs"\n'
ARCS = GIVEN.replace("addendum = 0.6", "addendum = 0.5") + '[teeth]\nlaw = "double arc"\n'
CUT = GIVEN + "[cutter]\nteeth = 60\n"
KEYS = {  # the file that a key is added to or changed in, and another value of it
    GIVEN: {
        "title": '"two"',
        "source": '"here"',
        "duty.torque": '"110 N m"',
        "duty.ratio": "81",
        "duty.outer_diameter": '"91 mm"',
        "gears.module": '"0.51 mm"',
        "gears.pressure_angle": '"21 deg"',
        "gears.profile_shift": "1.0",
        "gears.addendum": "0.61",
        "gears.deflection": "1.01",
        "gears.rim": '"0.9 mm"',
        "gears.clearance": "0.3",
        "gears.face_width": '"11 mm"',
        "gears.shell": '"4 mm"',
        "teeth.law": '"double arc"',
        "wave_generator.shape": '"ellipse"',
        "material.elastic_modulus": '"200 GPa"',
        "material.poisson_ratio": "0.28",
        "material.bending_limit": '"500 MPa"',
        "material.shear_limit": '"300 MPa"',
        "sharing.torque_of": '"output"',
        "sharing.rim": '"rigid"',
        "sharing.pair_compliance": '"20 um/kN"',
        "sharing.wall_over_rim": "0.7",
        "sharing.cup_length": '"40 mm"',
        "design.pairs": "0.9",
        "design.safety": "2",
        "design.notch": "2",
        "design.ratcheting": "2",
        "design.radial_compliance": '"200 um/kN"',
    },
    DISCS: {"wave_generator.wrap_angle": '"40 deg"'},
    ARCS: {
        "teeth.thickness": '"0.8 mm"',
        "teeth.convex_radius": '"0.8 mm"',
        "teeth.concave_radius": '"0.8 mm"',
        "teeth.tangent": '"0.1 mm"',
    },
    CUT: {
        "cutter.teeth": "70",
        "cutter.pitch_diameter": '"80.2 mm"',
        "cutter.tool_angle": '"21 deg"',
        "cutter.least_radius": '"5 m"',
        "cutter.scale": "20",
        "cutter.grid": '"0.1 mm"',
    },
}
RANGES = {
    "design.module": '["0.5 mm", "0.52 mm"]',
    "design.pressure_angle": '["19 deg", "21 deg"]',
    "design.profile_shift": "[0.1, 1]",
    "design.addendum": "[0.5, 0.6]",
    "design.deflection": "[1, 1.1]",
    "design.rim": '["0.5 mm", "0.6 mm"]',
}


def changed(text, key, value):
    """The text with a key of a table set anew, or added to the table."""
    table, _, name = key.rpartition(".")
    lines, at, out = text.splitlines(), "", []
    done = False
    for line in lines:
        if line.startswith("["):
            at = line.strip("[]")
        if at == table and line.split(" =")[0] == name:
            line, done = f"{name} = {value}", True
        out.append(line)
    if not done and f"[{table}]" in out:
        out.insert(out.index(f"[{table}]") + 1, f"{name} = {value}")
    elif not done:
        out += [f"[{table}]", f"{name} = {value}"]
    return "\n".join(out) + "\n"


def answer(text):
    """All that is told, but for what was asked."""
    found = json.loads(gearopt.solve(read(text.encode())[1]).to_json())
    left = ("asked", "file_sha256", "seconds", "file")
    return {k: v for k, v in found.items() if k not in left}


def test_the_keys_are_those_of_the_file():
    names = set()
    for table, field in Scene.model_fields.items():
        kinds = get_args(field.annotation) or (field.annotation,)
        inner = [n for kind in kinds for n in getattr(kind, "model_fields", ())]
        names |= {f"{table}.{name}" for name in inner} or {table}
    assert names == {key for keys in KEYS.values() for key in keys} | set(RANGES)


CASES = [(text, key, value) for text, keys in KEYS.items() for key, value in keys.items()]


@pytest.fixture(scope="module")
def answers():
    return {}


@pytest.mark.slow
@pytest.mark.parametrize(("text", "key", "value"), CASES, ids=[key for _, key, _ in CASES])
def test_every_key_changes_the_answer(text, key, value, answers):
    """Title and source are only shown; every other key changes what is computed or drawn."""
    if text not in answers:
        answers[text] = answer(text)
    other = changed(text, key, value)
    assert other != text
    if key in ("title", "source"):
        first, second = (dict(read(t.encode())[1]) for t in (text, other))
        assert first[key] != second[key]
        return
    assert answer(other) != answers[text]


@pytest.mark.parametrize(("key", "value"), RANGES.items())
def test_every_range_is_that_of_a_variable(key, value):
    name = key.rpartition(".")[2]
    own = model(read(changed(FROM_DUTY, key, value).encode())[1], "").problem
    usual = model(read(FROM_DUTY.encode())[1], "").problem
    found, before = (
        {v.name: (v.lower, v.upper, v.key) for v, _ in p.columns} for p in (own, usual)
    )
    assert found[name] != before[name] and found[name][2] == key
    assert all(found[n] == before[n] for n in found if n != name)


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("duty.torqe", '"1 N m"', "torque"),
        ("duty.torque", '"100 N mm m"', "N m"),
        ("duty.torque", "100", "needs a unit"),
        ("duty.torque", '"-1 N m"', "not greater than zero"),
        ("duty.ratio", "80.5", "Write ratio = 80"),
        ("gears.module", '"0.5 kg"', "mm"),
        ("gears.addendum", "3", "at most 2"),
        ("gears.rim", '"60 mm"', "bore"),
        ("teeth.law", '"cycloid"', "involute"),
        ("wave_generator.shape", '"elipse"', "ellipse"),
        ("sharing.torque_of", '"input"', "circular spline"),
        ("cutter.teeth", "1", "Write teeth = 4"),
    ],
)
def test_slips_are_told_with_their_key_and_what_to_write(key, value, told):
    with pytest.raises(SceneError) as wrong:
        read(changed(GIVEN, key, value).encode())
    assert key in str(wrong.value) and told in str(wrong.value)
