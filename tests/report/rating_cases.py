"""Rated drives for tests of their pages: a published pair, an unsafe one, a train, an optimum."""

import functools
import tomllib

import gearopt

SHIGLEY = """
gearopt = 1
kind = "drive"
title = "Shigley, example 14-4"
[duty]
power = "4 hp"
input_speed = "1800 rpm"
[[stage]]
diametral_pitch = 10
pinion_teeth = 17
wheel_teeth = 52
face_width = "1.5 in"
[stage.pinion]
hardness = "240 HB"
[stage.wheel]
hardness = "200 HB"
[gears]
treatment = "through-hardened"
elastic_modulus = "30000 ksi"
[rating]
quality = 6
input_revolutions = 1e8
reliability = "90 %"
size_factor = "shigley"
[rating.given]
I = 0.121
J = [0.30, 0.40]
C_p = "2300 sqrt(psi)"
"""  # as in the book, whose I and J are read from charts
PSI = 0.45359237 * 9.80665 / 25.4**2  # MPa, by definition of inch and pound
METRIC_SHIGLEY = {  # the same in other units: 25.4 mm an inch, 745.69987158227022 W a horsepower
    'power = "4 hp"': 'power = "2.98279948632908088 kW"',
    "diametral_pitch = 10": 'module = "2.54 mm"',
    '"1.5 in"': '"38.1 mm"',
    '"30000 ksi"': f'"{3e7 * PSI!r} MPa"',
    '"2300 sqrt(psi)"': f'"{2300.0 * PSI**0.5!r} sqrt(MPa)"',
}
TRAIN = """
gearopt = 1
kind = "drive"
title = "Two helical stages under a load spectrum"
[duty]
power = "30 kW"
input_speed = "1450 rpm"
[gears]
helix_angle = "15 deg"
treatment = "carburised"
grade = 2
[[stage]]
module = "2.5 mm"
pinion_teeth = 19
wheel_teeth = 83
face_width = "40 mm"
[stage.pinion]
profile_shift = 0.3
thickness_allowance = "-0.05 mm"
[stage.wheel]
treatment = "through-hardened"
hardness = "320 HB"
[[stage]]
module = "4 mm"
pinion_teeth = 21
wheel_teeth = 90
face_width = "70 mm"
[rating]
quality = 9
life = "20000 h"
overload_factor = 1.25
minimum_bending_safety = 1.2
minimum_contact_safety = 1.1
oil_viscosity = "40 mPa s"
[[load]]
power = "30 kW"
share = "10 %"
[[load]]
power = "15 kW"
share = "60 %"
[[load]]
power = "5 kW"
share = "30 %"
"""
ISO = """
gearopt = 1
kind = "drive"
title = "ISO/TR 6336-30, example 1"
[duty]
power = "339.292 kW"
input_speed = "360 rpm"
[[stage]]
module = "8 mm"
pinion_teeth = 17
wheel_teeth = 103
face_width = "100 mm"
helix_angle = "15.8 deg"
centre_distance = "500 mm"
[stage.pinion]
profile_shift = 0.145
[gears]
tool_addendum = 1.4
tool_tip_radius = 0.39
treatment = "carburised"
iso_quality = "MQ"
flank_rz = "6 um"
[rating]
standard = "iso6336"
life = "50000 h"
[rating.iso6336]
accuracy_grade = 5
oil_grade = "320 mm^2/s"
tip_relief = "70 um"
"""  # 9000 N m; the tip relief is that of the print
SIZED = """
gearopt = 1
kind = "drive"
title = "A drive that is sized, then rated"
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
output_speed = "300 rpm"
ratio_tolerance = "1 %"
[gears]
materials = ["steel"]
[[material]]
name = "steel"
treatment = "through-hardened"
hardness = "200 HB"
[[stage]]
face_width_over_diameter = 0.6
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
pinion_teeth = [20, 40]
[rating]
quality = 7
life = "20000 h"
"""


def _tables(text, edits):
    for old, new in edits.items():
        assert old in text
        text = text.replace(old, new)
    return tomllib.loads(text)


def rated(text, edits=None):
    """The rating of a file's text, after edits of it."""
    return gearopt.rate(_tables(text, edits or {}))


SHOWN = {}  # of a result: it is kept beside, so that its id stays its own


def once(show):
    """What is shown of a result, made once; the cases below are made once, too."""

    def shown(result, *how):
        key = show, id(result), how
        if key not in SHOWN:
            SHOWN[key] = result, show(result, *how)
        return SHOWN[key][1]

    return shown


@functools.cache
def shigley():
    return rated(SHIGLEY)


@functools.cache
def metric_shigley():
    return rated(SHIGLEY, METRIC_SHIGLEY)


@functools.cache
def unsafe():
    """Six times the power, at a safety factor of 1.2 against bending."""
    edits = {'"4 hp"': '"24 hp"', "quality = 6": "quality = 6\nminimum_bending_safety = 1.2"}
    return rated(SHIGLEY, edits)


@functools.cache
def train():
    return rated(TRAIN)


@functools.cache
def sized(hardness="200 HB"):
    return gearopt.solve(_tables(SIZED, {"200 HB": hardness}))


BOTH = {'iso6336"': 'both"\nquality = 11'}


AGMA = {  # of ISO, the keys of AGMA in the place of those of ISO 6336
    'iso6336"\n': 'agma"\nquality = 11\n',
    'iso_quality = "MQ"\nflank_rz = "6 um"\n': "",
    '[rating.iso6336]\naccuracy_grade = 5\noil_grade = "320 mm^2/s"\ntip_relief = "70 um"\n': "",
}


@functools.cache
def iso():
    return rated(ISO)


@functools.cache
def both():
    """By AGMA it falls short, by ISO it is safe."""
    return rated(ISO, BOTH)


@functools.cache
def both_safe():
    return rated(ISO, BOTH | {"339.292 kW": "200 kW"})


@functools.cache
def train_by_both():
    """Two stages, a load spectrum, a through-hardened wheel, by both standards."""
    grade = "[rating.iso6336]\naccuracy_grade = 6\n"
    return rated(TRAIN, {"[rating]": f'{grade}[rating]\nstandard = "both"'})


def sized_by_both():
    """The tables of a drive that is sized, then rated by both standards."""
    grade = "[rating.iso6336]\naccuracy_grade = 6\n"
    return _tables(SIZED, {"[rating]": f'{grade}[rating]\nstandard = "both"'})
