"""Strain wave gearings that are hard to compute: cusps, lost contact, conformity, other waves.

Numbers are those of another program, unless a limit or an identity is asked for.
"""

from dataclasses import replace

import numpy as np
import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.strain_wave.demand import Duty, equal_pressure, loads_at, shared_pressure
from gearopt.physics.strain_wave.clearance import interference
from gearopt.physics.strain_wave.conjugate import contact, flank
from gearopt.physics.strain_wave.cutter import blank_profile, envelope
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import angle_of_arc, neutral_curve, radii
from gearopt.physics.strain_wave.rim import Cup
from gearopt.physics.strain_wave.tooth_motion import motion
from gearopt.scenes.reading.load import read
from gearopt.scenes.strain_wave import KIND

EXAMPLE = KIND.example.text

BASE = StrainWave(0.5, 160, profile_shift=0.9)


def at_arc(gearing, degrees):
    curve = neutral_curve(gearing)
    arc = np.radians(np.atleast_1d(np.asarray(degrees, float)))
    return contact(gearing, motion(gearing, curve, angle_of_arc(curve, arc)))


def test_a_cusp_is_a_speed_of_zero_and_curvature_grows_as_one_over_the_distance():
    low, high = -30.0, -10.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        same = at_arc(BASE, middle).speeds[1][0] * at_arc(BASE, high).speeds[1][0] > 0.0
        low, high = (low, middle) if same else (middle, high)
    assert high == pytest.approx(-18.85, abs=5e-3)
    assert at_arc(BASE, high).tangent[0] == pytest.approx(0.013, abs=5e-4)
    near = at_arc(BASE, high + np.array([1.0, 0.1, 0.01])).curvatures[1]
    assert near == pytest.approx([-1.34, -13.5, -148.0], rel=0.1)
    assert near[1:] / near[:-1] == pytest.approx([10.0, 10.0], rel=0.1)


def test_contact_that_is_lost_is_no_number_and_leaves_the_rest_alone():
    """Below w of 0.8139 two intervals of the wave are left; there is no complete flank."""
    low = replace(BASE, deflection=0.8)
    found = at_arc(low, [0.0, 20.0, 26.0, 27.0, 40.0])
    assert np.isnan(found.tangent[:3]).all() and np.isfinite(found.tangent[3:]).all()
    assert not flank(replace(BASE, deflection=0.7)).complete


@pytest.mark.parametrize(
    ("gearing", "least", "most", "pairs"),
    [
        (replace(BASE, teeth=640, module=0.2, rim=1.6), 1936, 2066, 1.16),
        (replace(BASE, teeth=640, module=0.125), 1188, 1267, 1.16),
        (replace(BASE, teeth=60, module=1.2), 119, 205, 0.987),
    ],
    ids=["320:1", "320:1 of the same size", "30:1"],
)
def test_other_ratios(gearing, least, most, pairs):
    made = flank(gearing)
    found = 1.0 / made.contacts.gap_curvature
    assert made.complete and interference(made, 0.25).free
    assert (found.min(), found.max()) == pytest.approx((least, most), abs=0.6)
    assert made.pairs_in_contact == pytest.approx(pairs, abs=6e-3)


def test_nearly_conformal_flanks_keep_their_digits():
    """kappa_f over kappa_c is 1.040 to 1.046: errors grow by 23 to 26, and yet 1/R is exact."""
    at = flank(BASE).contacts
    spline, flex = at.curvatures
    ratio = flex / spline
    assert (ratio.min(), ratio.max()) == pytest.approx((1.0401, 1.0456), abs=6e-5)
    grown = np.abs(flex) / at.gap_curvature
    assert (grown.min(), grown.max()) == pytest.approx((23.0, 26.0), abs=0.6)
    assert spline - flex == pytest.approx(at.gap_curvature, rel=1e-11)


@pytest.mark.parametrize(("w", "radius"), [(1.1, 240), (1.2, 197), (1.3, 169), (1.5, 133)])
def test_teeth_made_for_a_larger_deflection(w, radius):
    made = flank(replace(BASE, deflection=w))
    assert made.complete and interference(made, 0.25).free
    assert 1.0 / made.contacts.gap_curvature.max() == pytest.approx(radius, abs=0.6)
    assert (made.contacts.motion.arc < 0.0).all()  # contact moves to the other side


def test_teeth_made_for_a_small_deflection_interfere():
    found = interference(flank(replace(BASE, deflection=0.9)), 0.1)
    assert 1e3 * found.gap == pytest.approx(-42.0, abs=0.6)


def test_short_teeth_of_a_low_pressure_angle_interfere_as_they_disengage():
    made = flank(replace(BASE, pressure_angle=np.radians(12.0), addendum=0.4))
    assert 1e3 * interference(made, 0.1).gap == pytest.approx(-9.8, abs=0.15)


@pytest.mark.parametrize(("wrap", "radius"), [(20.0, 328), (45.0, 400)])
def test_discs_of_other_angles(wrap, radius):
    """The curve is smooth to its second derivative at the discs' ends; the third one jumps."""
    gearing = replace(BASE, wave="discs", wrap=np.radians(wrap))
    made = flank(gearing)
    assert 1.0 / made.contacts.gap_curvature.max() == pytest.approx(radius, abs=0.6)
    before, after = (radii(made.curve, np.radians(wrap) + s) for s in (-1e-9, 1e-9))
    jumps = [abs(a - b) for a, b in zip(before, after, strict=True)]
    assert max(jumps[:3]) < 1e-7 < 0.1 < jumps[3]


def test_flanks_without_an_instant_centre_far_away_do_not_overflow():
    """Where R_m kappa = k the tooth only shifts: its pole is at infinity, contact ends before."""
    found = at_arc(BASE, np.linspace(-89.0, 89.0, 357))
    far = found.motion.centre.length
    assert np.isfinite(far).all() and far.max() > 1e3
    assert np.isfinite(found.motion.place.length).all()


RATIOS = (30, 50, 60, 80, 100, 120, 160, 200, 320)


def test_from_30_to_320_of_one_size_more_teeth_share_less_pressure():
    """Geometry, contact, loads and pressures at a module of 80 mm/z_f: finite, and of one sense.

    The angle of the tool falls towards the involute's 20 degrees.
    """
    duty = Duty(1e5, 10.0, (206e3, 206e3), (0.3, 0.3), 1e5, Cup(), elastic=False)
    rows = []
    for ratio in RATIOS:
        made = flank(replace(BASE, teeth=2 * ratio, module=40.0 / ratio))
        assert made.complete and interference(made, 0.25).free
        _, loads = loads_at(duty, made)
        assert loads.forces.sum() * made.gearing.base_radius == pytest.approx(5e4, rel=1e-12)
        edge = envelope(blank_profile(made), made.gearing.blank_radius)
        lean = np.polyfit(edge.profile.points.x, edge.profile.points.y, 1)[0]
        stresses = equal_pressure(duty, made), shared_pressure(duty, made)
        rows.append((made.pairs_in_contact, -stresses[0], -stresses[1], lean))
        assert edge.regular
    assert (np.diff(np.array(rows), axis=0) > 0.0).all()
    assert rows[3][1:3] == pytest.approx((-117.38, -58.68), abs=0.005)
    assert np.degrees(np.arctan(-rows[-1][3])) == pytest.approx(20.0, abs=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", RATIOS[::4])
def test_files_from_30_to_320_have_no_number_that_is_none(ratio):
    text = EXAMPLE.replace("ratio = 80", f"ratio = {ratio}")
    found = gearopt.solve(read(text.replace("0.5 mm", f"{40 / ratio} mm").encode())[1])
    assert found.status == "evaluated" and found.design["cutter"]["regular"]
    numbers = list(leaves(found.design))
    assert len(numbers) > 900 and np.isfinite(numbers).all()


def leaves(design):
    for value in design.values() if isinstance(design, dict) else design:
        if isinstance(value, dict | list | tuple):
            yield from leaves(value)
        elif isinstance(value, float | int):
            yield value


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('rim = "0.8 mm"', 'rim = "100 mm"', r"rim.*bore of -120 mm.*Write rim = \"0.8 mm\""),
        ('module = "0.5 mm"', 'module = "1 um"', "rim.*bore of -1.4"),
    ],
)
def test_a_rim_that_leaves_no_bore_is_refused(old, new, told):
    with pytest.raises(SceneError, match=told):
        read(EXAMPLE.replace(old, new).encode())


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("deflection = 1\n", "deflection = 0.1\n", "below 0.8139.*contact exists nowhere"),
        ("deflection = 1\n", "deflection = 0.7\n", "below 0.8139.*from 35.0 degrees"),
        ("deflection = 1\n", "deflection = 0.82\n", "without conjugate contact"),
        ('"20 deg"\nprofile', '"5 deg"\nprofile', "below 1.0129"),
        ('rim = "0.8 mm"', 'rim = "20 mm"', "rim.*no deflection up to 2.*Write rim = .0.8 mm"),
    ],
)
def test_gearings_without_a_flank_are_refused_with_what_would_help(old, new, told):
    assert old in EXAMPLE
    with pytest.raises(SceneError, match=told):
        read(EXAMPLE.replace(old, new).encode())
