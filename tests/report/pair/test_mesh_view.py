"""Teeth in mesh as a page of ratings draws them."""

import math
import re

import pytest

import gearopt
from gearopt.formulations.drive.design import drive_design
from gearopt.report.drawing.mesh_view import ALONG, SEVERAL, WIDE, section
from gearopt.report.measures import METRIC

FILE = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "5 kW", "input_speed": "1450 rpm"},
    "gears": {"treatment": "carburised"},
    "stage": [
        {
            "module": "3 mm",
            "pinion_teeth": 12,
            "wheel_teeth": 40,
            "face_width": "30 mm",
            "pinion": {"profile_shift": 0.5, "tool_tip_radius": 0.25},
            "wheel": {"thickness_allowance": "-0.1 mm"},
        }
    ],
    "rating": {"life": "1000 h", "quality": 8},
}


@pytest.fixture(scope="module")
def drawn():
    result = gearopt.rate(FILE)
    shown = section(result, METRIC)
    (one,) = shown.drawings
    assert shown.words[0].endswith("of contact; from B to D one pair of spur teeth carries alone.")
    return drive_design(result.design).stages[0].pair, one.svg


def outlines(svg):
    """Outlines of pinion and wheel, in px, without their axes."""
    found = re.findall(r'<path class="tip"[^>]* d="M ([^"]*) Z"', svg)
    return [[tuple(map(float, p.split())) for p in path.split(" L ")][1:] for path in found]


def test_the_gears_of_a_design_are_those_that_were_rated(drawn):
    pair, _ = drawn
    assert pair.pinion.profile_shift == 0.5 and pair.pinion.rack.tip_radius == 0.25
    assert pair.wheel.thickness_allowance == -0.1 and pair.wheel.rack.tip_radius == 0.38
    reach = 0.5 * (math.sqrt(45.0**2 - 33.829**2) + math.sqrt(126.0**2 - 112.763**2))
    by_hand = (reach - 79.4094 * math.sin(math.radians(22.6292))) / 8.8564  # ISO 21771
    assert pair.transverse_contact_ratio == pytest.approx(by_hand, abs=2e-4)


def test_both_flanks_pass_the_pitch_point(drawn):
    _, svg = drawn
    dots = re.findall(r'<circle class="tip"[^>]*cx="([\d.]+)" cy="([\d.]+)"', svg)
    (at,) = [(float(x), float(y)) for x, y in dots if abs(float(x) - 0.5 * WIDE) < 0.01]
    for outline in outlines(svg):
        assert min(_away(at, a, b) for a, b in zip(outline, outline[1:], strict=False)) < 0.12


def test_the_line_of_action_is_as_long_as_contact(drawn):
    """|AE| is the contact ratio times the base pitch; |AD| and |BE| are one base pitch."""
    pair, svg = drawn
    dots = [tuple(map(float, d)) for d in re.findall(r'cx="([\d.]+)" cy="([\d.]+)"', svg)]
    scale = (WIDE - 16.0) / (2.0 * ALONG * 3.0)
    a, e, _, b, d = dots[:5]
    base = math.pi * 3.0 * math.cos(math.radians(20.0))
    ratio = float(pair.transverse_contact_ratio)
    assert math.dist(a, e) / scale == pytest.approx(ratio * base, abs=0.01)
    assert math.dist(a, d) / scale == pytest.approx(base, abs=0.01)
    assert math.dist(b, e) / scale == pytest.approx(base, abs=0.01)


def test_of_helical_teeth_no_pair_is_said_to_carry_alone():
    """Overlap keeps a second pair in contact for most of the way."""
    helical = FILE | {"gears": FILE["gears"] | {"helix_angle": "10 deg"}}
    result = gearopt.rate(helical)
    shown, mesh = section(result, METRIC), result.design["rating"]["meshes"][0]
    ratio = mesh["transverse_contact_ratio"] + mesh["overlap_ratio"]
    assert 1.0 < ratio < 2.0 and "alone" not in shown.words[0]
    words = f"Total contact ratio {ratio:.4g}: 1 or 2 pairs of teeth touch at once."
    assert shown.drawings[0].caption == words
    two = section(gearopt.rate(FILE | {"stage": FILE["stage"] * 2}), METRIC)
    assert two.words[0].endswith(SEVERAL) and SEVERAL not in shown.words[0]
    assert not {"B", "D"} & set(re.findall(r">([A-E])<", shown.drawings[0].svg))


def _away(p, a, b):
    """Distance of a point from a stretch."""
    length = math.dist(a, b) or 1.0
    share = ((p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])) / length**2
    share = min(1.0, max(0.0, share))
    return math.dist(p, (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])))
