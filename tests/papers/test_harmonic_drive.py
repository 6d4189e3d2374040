"""docs/harmonic_drive.md: its tables are what the program computes, and its claims hold."""

import re
from dataclasses import replace
from pathlib import Path

import jun_oh
import numpy as np
import pytest
from jun_oh import BASE, base

from gearopt.formulations.strain_wave.sharing import shared
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import blank_profile, envelope
from gearopt.physics.strain_wave.fitted_curvature import graph_curvature

TESTS = Path(__file__).parents[1]
PAGE = (TESTS.parent / "docs" / "harmonic_drive.md").read_text(encoding="utf-8")
CHEAP = (
    *(jun_oh.flank_rows, jun_oh.wave_rows, jun_oh.clearance_rows),
    *(jun_oh.angle_rows, jun_oh.deflection_rows),
    *(jun_oh.made_for_rows, jun_oh.load_rows, jun_oh.cutter_rows, jun_oh.tooth_rows),
)
LONG = (
    *(jun_oh.addendum_rows, jun_oh.one_pair_rows, jun_oh.fit_rows),
    *(jun_oh.ratio_rows, jun_oh.shift_rows, jun_oh.hob_rows),
)
TIMED = (
    jun_oh.construction_rows,
    pytest.param(jun_oh.curvature_rows, marks=pytest.mark.slow),
)


@pytest.mark.parametrize(
    "rows",
    [*CHEAP, *(pytest.param(f, marks=pytest.mark.slow) for f in LONG)],
    ids=lambda f: f.__name__,
)
def test_tables_are_computed(rows):
    found = list(rows())
    assert len(found) > 2 and "\n".join(found) + "\n" in PAGE


@pytest.mark.parametrize("rows", TIMED, ids=lambda f: f.__name__)
def test_tables_with_times_are_computed(rows):
    """The last column is a time: it differs from run to run."""
    told = [line.rsplit("|", 2)[0] + "|" for line in PAGE.splitlines() if line.count("|") > 3]
    found = list(rows())
    assert len(found) > 4
    start = told.index(found[0])
    assert told[start : start + len(found)] == found


def test_counts_are_computed():
    assert jun_oh.within_row() in PAGE


def test_every_test_of_the_page_is_there():
    names = set(re.findall(r"`(test_\w+)`", PAGE))
    written = "".join(p.read_text(encoding="utf-8") for p in TESTS.rglob("test_*.py"))
    assert len(names) > 10 and not [n for n in names if f"def {n}(" not in written]


def test_every_function_of_the_page_is_there():
    from importlib import import_module

    names = re.findall(r"`([a-z_.]+)\.([a-z_]+)` \|", PAGE)
    assert len(names) > 8
    for module, name in names:
        room = "" if "." in module else "physics.strain_wave."
        assert hasattr(import_module(f"gearopt.{room}{module}"), name), name


def test_erratum_of_equation_2_an_arm_times_an_angle():
    """As printed, arm plus angle, (1) and (3) ask for a windup of minus one arm [mm as rad].

    The product gives (4), dtheta = M/(K sum L^2), and loads that are shared by it.
    """
    arms, stiffness, moment = np.linspace(37.0, 39.0, 8), 1e5, 5e4
    found = shared(np.eye(8) / stiffness, np.zeros(8), arms, moment)
    assert found.windup == pytest.approx(moment / (stiffness * (arms @ arms)), rel=1e-12)
    assert found.forces / stiffness == pytest.approx(arms * found.windup, rel=1e-12)
    printed = (moment / stiffness - arms @ arms) / arms.sum()
    assert printed == pytest.approx(-38.0, abs=0.02) and found.windup < 1e-4


def test_erratum_of_equation_9_on_a_circle():
    """R = 10 mm at x = 6: the corrected form gives it, the printed one 2.56."""
    slope, second = -6.0 / 8.0, -100.0 / 8.0**3
    assert 1.0 / abs(graph_curvature(slope, second)) == pytest.approx(10.0, rel=1e-14)
    printed = abs((1.0 + slope) ** 0.5 / second)
    assert printed == pytest.approx(2.56, abs=5e-3)


def test_erratum_of_equation_13_in_um():
    """What tan for sin, and Y left alone, do to a place of the construction: A = 42 mm."""
    beta = np.radians([2.0, 5.0, 10.0])
    along = 42e3 * (np.tan(beta) - np.sin(beta)), 42e3 * (1.0 - np.cos(beta))
    assert along[0] == pytest.approx([0.9, 14.0, 112.0], rel=0.02)
    assert along[1] == pytest.approx([26.0, 160.0, 638.0], rel=0.02)


def test_all_lines_of_action_do_not_coincide():
    """Normals pass an instant centre that wanders by 1.7 mm; all of them touch the base circle."""
    at = base().contacts
    centre = at.motion.centre
    assert (centre[0] - centre[200]).length == pytest.approx(1.7, abs=0.05)
    normal = at.direction.turned(at.motion.turn)
    assert np.abs(at.place.dot(normal)) == pytest.approx(np.full(201, BASE.base_radius), rel=1e-12)


def test_refuted_the_stress_has_no_least_value_over_the_profile_shift():
    """In every variant, with linked and with fixed neutral radius."""
    for change in ({}, {"neutral": 40.0}, {"addendum": 0.55}, {"addendum": 1.0}):
        found = []
        for x in np.arange(0.0, 2.01, 0.4):
            made = flank(replace(BASE, profile_shift=float(x), **change), 41)
            found.append(jun_oh.stress(made, float(made.pairs_in_contact)))
        assert (np.diff(found) < 0.0).all(), change


def test_one_conjugate_pair_at_all_times_would_explain_the_papers_shift():
    """With an addendum of 0.55 modules the pairs are 1 at x = 0.965."""
    pairs = [
        float(flank(replace(BASE, addendum=0.55, profile_shift=x), 3).pairs_in_contact)
        for x in (0.96, 0.97)
    ]
    assert pairs[0] > 1.0 > pairs[1]


def test_refuted_tools_of_20_degrees_can_cut_the_flank():
    """Rack edge: within 0.07 um of one straight line, whose angle is 20.1 degrees."""
    edge = envelope(blank_profile(base()), 40.0).profile
    slope, offset = np.polyfit(edge.points.x, edge.points.y, 1)
    off = (edge.points.y - slope * edge.points.x - offset) / np.hypot(1.0, slope)
    assert 1e3 * np.abs(off).max() < 0.09
    assert np.degrees(np.arctan(abs(slope))) == pytest.approx(20.097, abs=0.01)


def test_refuted_the_pitch_circle_is_not_free():
    """A cutter of 8 teeth: regular on a pitch circle near the tip, cusped on that of 40 mm."""
    blank = blank_profile(base())
    assert envelope(blank, 40.5, 40.5 / 20.0).regular
    assert not envelope(blank, 40.0, 2.0).regular
