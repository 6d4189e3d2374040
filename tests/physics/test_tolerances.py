"""ISO 1328-1:2013 tolerances and transmission errors: known numbers, rounding, identities."""

import math

import numpy as np
import pytest

from gearopt.physics import tolerances
from gearopt.physics.backlash import output_error, pitch_error_angle
from gearopt.physics.tolerances import (
    profile_form_tolerance,
    profile_slope_tolerance,
    rounded_tolerance,
    runout_tolerance,
    scope,
    single_pitch_tolerance,
    total_helix_tolerance,
    total_pitch_tolerance,
    total_profile_tolerance,
)


@pytest.mark.parametrize(("diameter", "deviation", "grade"), [(48, 29, 6.67), (104, 33, 6.72)])
def test_the_papers_pitch_deviations_are_about_grade_7(diameter, deviation, grade):
    unit = total_pitch_tolerance(diameter, 0.5, 5)
    assert 5 + 2 * math.log2(1e-3 * deviation / unit) == pytest.approx(grade, abs=6e-3)
    rounded = {48: 32.5, 104: 36.3}[diameter]
    assert 1e3 * total_pitch_tolerance(diameter, 0.5, 7) == pytest.approx(rounded, abs=0.06)


@pytest.mark.parametrize(
    ("grade", "worst", "rss"),
    [(5, 0.0448, 0.0263), (6, 0.0634, 0.0372), (7, 0.0897, 0.0526), (8, 0.1268, 0.0744)],
)
def test_pitch_term_of_both_members_at_the_output(grade, worst, rss):
    tolerance = [total_pitch_tolerance(d, 0.5, grade) for d in (8.0, 48.0, 13.0, 104.0)]
    angles = [
        pitch_error_angle(t, d) for t, d in zip(tolerance, (48.0, 48.0, 104.0, 104.0), strict=True)
    ]
    ratios = (8.0, 8.0, 1.0, 1.0)
    assert math.degrees(output_error(angles, ratios)) == pytest.approx(worst, abs=6e-5)
    each = [math.degrees(a / n) for a, n in zip(angles, ratios, strict=True)]
    assert math.hypot(*each) == pytest.approx(rss, abs=6e-5)


def test_grade_6_of_a_common_gear():
    """m 3, z 40, b 30, grade 6: 9, 29 and 12 um after rounding, as independent programs print."""
    exact = [
        single_pitch_tolerance(120.0, 3.0, 6),
        total_pitch_tolerance(120.0, 3.0, 6),
        total_profile_tolerance(120.0, 3.0, 6),
    ]
    rounded = 1e3 * rounded_tolerance(np.array(exact))
    assert rounded == pytest.approx([9.0, 29.0, 12.0], rel=1e-12)


def test_rounding_rule():
    sizes = [12.49, 10.4, 7.3, 7.2, 4.96, 4.94, 12.5, 5.25, 10.0, 0.04]
    expected = [12.0, 10.0, 7.5, 7.0, 5.0, 4.9, 13.0, 5.5, 10.0, 0.0]
    assert 1e3 * rounded_tolerance(1e-3 * np.array(sizes)) == pytest.approx(expected, abs=1e-12)


def test_two_grades_double_every_tolerance_and_totals_are_vector_sums():
    for law in (single_pitch_tolerance, total_pitch_tolerance, runout_tolerance):
        assert law(50.0, 2.0, 8) == pytest.approx(2.0 * law(50.0, 2.0, 6), rel=1e-14)
    assert total_helix_tolerance(50.0, 20.0, 8) == pytest.approx(
        2.0 * total_helix_tolerance(50.0, 20.0, 6), rel=1e-14
    )
    parts = profile_slope_tolerance(50.0, 2.0, 7), profile_form_tolerance(2.0, 7)
    assert total_profile_tolerance(50.0, 2.0, 7) == pytest.approx(math.hypot(*parts), rel=1e-14)
    helix = [f(50.0, 20.0, 7) for f in (tolerances.helix_slope_tolerance,)]
    form = tolerances.helix_form_tolerance(50.0, 20.0, 7)
    assert total_helix_tolerance(50.0, 20.0, 7) == pytest.approx(math.hypot(*helix, form))


def test_outside_its_scope_the_standard_says_nothing():
    margins = scope(module=np.array([0.3, 0.5, 2.0]), diameter=104.0, grade=12)
    assert list(margins["module"] < 0.0) == [True, False, False]
    assert margins["diameter"] > 0.0 and margins["grade"] < 0.0
    with pytest.raises(ValueError, match="no range of 'width'"):
        scope(width=3.0)
