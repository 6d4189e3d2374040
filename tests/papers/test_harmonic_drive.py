"""docs/harmonic_drive.md: its tables are what the program computes, and its claims hold."""

import re
from dataclasses import replace
from pathlib import Path

import jun_oh
import numpy as np
import pytest
from jun_oh import BASE, base

from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import blank_profile, envelope

PAGE = (Path(__file__).parents[2] / "docs" / "harmonic_drive.md").read_text(encoding="utf-8")
SLOW = pytest.param(jun_oh.fit_rows, marks=pytest.mark.slow)
TABLES = (jun_oh.flank_rows, jun_oh.angle_rows, jun_oh.shift_rows, jun_oh.cutter_rows)


@pytest.mark.parametrize(
    "rows", [*TABLES, jun_oh.tooth_rows, jun_oh.load_rows, SLOW], ids=lambda f: f.__name__
)
def test_tables_are_computed(rows):
    found = list(rows())
    assert len(found) > 3 and "\n".join(found) + "\n" in PAGE


def test_clearances_and_counts_are_computed():
    assert jun_oh.clearance_row() in PAGE and jun_oh.within_row() in PAGE


def test_every_function_of_the_page_is_there():
    from importlib import import_module

    names = re.findall(r"`([a-z_.]+)\.([a-z_]+)` \|", PAGE)
    assert len(names) > 8
    for module, name in names:
        room = "" if "." in module else "physics.strain_wave."
        assert hasattr(import_module(f"gearopt.{room}{module}"), name), name


def test_refuted_the_stress_has_no_least_value_over_the_profile_shift():
    """In every variant, with linked and with fixed neutral radius."""
    for change in ({}, {"neutral": 40.0}, {"addendum": 0.55}, {"addendum": 0.8}):
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
