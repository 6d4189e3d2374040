"""The page of a flexspline that a straight-sided hob cuts."""

import re
from dataclasses import replace

import numpy as np
import pytest

from gearopt.formulations.strain_wave.design import WaveDesign
from gearopt.optimise.typed import typed
from gearopt.report.kinds.strain_wave import cutter, moving, warns
from gearopt.report.kinds.strain_wave.hob import mesh
from gearopt.report.measures import METRIC

NAME = "strain_wave_modified_involute"


@pytest.fixture
def result(solved):
    return solved(NAME)


@pytest.fixture
def found(result):
    return typed(WaveDesign, result.design)


def outlines(svg, title):
    """Corners in px of the shapes of a title."""
    paths = re.findall(rf'd="M ([^"]+) Z"[^>]*><title>{title}', svg)
    return [np.array([p.split() for p in path.split(" L ")], float) for path in paths]


def test_teeth_as_cut_stand_beside_conjugate_ones(result):
    section = cutter(result, METRIC)
    assert "A straight-sided hob of 15°" in section.words[0] and "8 µm" in section.words[0]
    assert "40.4491 mm" in section.words[0]  # another program clears involutes there by 0.0 um
    names = [table.name for table in section.tables]
    files = ["teeth as cut", "flank as cut", "clearance of the teeth as cut"]
    assert names == [*files, "points of the cutting edge"]
    rows = {row[0]: row[1:] for row in section.tables[0].rows}
    assert rows["least clearance [µm]"][0].value == pytest.approx(-6.7, abs=0.05)
    assert rows["least clearance [µm]"][1].value == pytest.approx(0.0, abs=1e-4)


def test_the_hob_touches_the_teeth_that_it_cuts_in_the_drawing(found):
    """At the major axis: half the hob's space and half the tooth at the same heights, to 0.1 px."""
    svg = mesh(found, found.cutter, METRIC).svg
    hobs, teeth = outlines(svg, "tooth of the hob"), outlines(svg, "tooth of the blank, as cut")
    assert (len(hobs), len(teeth)) == (4, 5)
    scale = 612.0 / (5.0 * np.pi * 0.5)
    middle = sum(t[:, 0].mean() for t in teeth) / 5.0
    hob, tooth = hobs[2], teeth[2]
    assert hob[0, 0] - middle == pytest.approx(scale * found.cutter.y_mm[0], abs=0.1)
    assert np.ptp(tooth[:, 0]) == pytest.approx(2 * scale * found.cutter.cut_half_mm[0], abs=0.1)
    inside = [np.abs(t[:, 0] - middle).min() for t in hobs[1:3]]
    assert min(inside) > 0.0


def test_only_conjugate_teeth_are_warned_of_and_both_are_plotted(result):
    words = warns(result, METRIC)[0]
    assert "conjugate teeth, but not those that the hob cuts, overlap by 6.71 µm" in words
    assert "interference" not in result.limits and result.feasible
    names = [trace["name"] for trace in moving(result, METRIC).figures[0].data]
    assert names == ["clearance", "clearance of the teeth as cut"]


def test_a_hob_that_cuts_no_flank_is_told(result):
    none = {"generation": "modified involute", "pitch_radius_mm": 40.0, "given_deg": 5.0}
    none |= {"regular": False, "least_speed": 0.0}
    own = replace(result, design=result.design | {"cutter": none})
    assert "No such hob: a straight edge of 5°" in cutter(own, METRIC).words[0]
    assert any("No such hob" in words for words in warns(own, METRIC))
