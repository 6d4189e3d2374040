"""Ranges of a strain wave gearing's file are those of its variables; slips are told."""

import pytest

from gearopt.errors import SceneError
from gearopt.scenes.reading.load import read
from gearopt.scenes.strain_wave import KIND as WAVES
from gearopt.scenes.strain_wave import posed

FROM_DUTY = WAVES.examples["strain-wave-from-duty"].text

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


@pytest.mark.parametrize(("key", "value"), RANGES.items())
def test_every_range_is_that_of_a_variable(key, value):
    name = key.rpartition(".")[2]
    own = posed(read(changed(FROM_DUTY, key, value).encode())[1], "").problem
    usual = posed(read(FROM_DUTY.encode())[1], "").problem
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
        ("gears.addendum", "3", "between 0.05 and 2"),
        ("gears.addendum", "1e-9", "between 0.05 and 2"),
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
