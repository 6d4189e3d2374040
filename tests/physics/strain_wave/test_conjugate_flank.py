"""Neutral curve, instant centre and conjugate flank of a strain wave gearing, 80:1 of m 0.5 mm.

TABLE was computed elsewhere.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.strain_wave.clearance import involute_gap
from gearopt.physics.strain_wave.conjugate import contact, existence, flank, least_deflection
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import (
    angle_of_arc,
    arc_angle,
    curvature,
    disc_constants,
    neutral_curve,
    perimeter_error,
    radii,
    whole_curve,
)
from gearopt.physics.strain_wave.tooth_motion import motion, small_motion
from gearopt.physics.strain_wave.vectors import Vector

BASE = StrainWave(0.5, 160, profile_shift=0.9)
# phi deg, r_c, height, half thickness, R_f, R_c, R_eq
TABLE = [
    (1.01052, 40.65, 0.52264, 0.5026, 13.66184, 14.28444, 313.44313),
    (1.62711, 40.79419, 0.66814, 0.44896, 14.06853, 14.68975, 332.67063),
    (2.24369, 40.94219, 0.81758, 0.39196, 14.47665, 15.09588, 352.91767),
    (2.86026, 41.09409, 0.97102, 0.33146, 14.8865, 15.50312, 374.28103),
    (3.47682, 41.25, 1.12856, 0.26728, 15.29843, 15.9118, 396.86809),
]


@cache
def base():
    return flank(BASE)


def test_radii_of_the_base_case():
    found = BASE.base_radius, BASE.tip_radius, BASE.active_radius, BASE.neutral_radius
    assert found == pytest.approx((38.0576, 40.65, 41.25, 39.625), abs=5e-5)
    assert BASE.ratio == 80.0


def test_the_flank_agrees_with_a_table_made_elsewhere():
    at = base().contacts
    for row, k in zip(TABLE, (0, 50, 100, 150, 200), strict=True):
        spline, own = (1.0 / abs(c[k]) for c in at.curvatures)
        found = np.degrees(at.motion.arc[k]), at.radius[k], at.point.x[k], at.point.y[k]
        assert found == pytest.approx(row[:4], abs=6e-6)
        assert (own, spline, 1.0 / at.gap_curvature[k]) == pytest.approx(row[4:], abs=6e-6)
    assert base().pairs_in_contact == pytest.approx(1.09613, abs=5e-6)


def test_the_flank_agrees_with_40_digits():
    """Its position by differences of poses alone, its curvature by differences of its position.

    The difference of curvatures is 4 % of either and yet has 12 digits.
    """
    from mpmath import mp, mpf

    with mp.workdps(40):
        m, radius, angle = mpf(BASE.module), mpf(BASE.neutral_radius), mpf(BASE.pressure_angle)
        ratio, arm = mpf(160) / 162, mpf(81) * m * mp.cos(angle)
        eta = (mp.pi / 2 + 2 * mpf(BASE.profile_shift) * mp.tan(angle)) / 162
        eta += mp.tan(angle) - angle

        def arc(mean, p):
            lift = radius + m - mean  # so that rho(0) = R_m + w_0

            def speed(u):
                return mp.hypot(mean + lift * mp.cos(2 * u), 2 * lift * mp.sin(2 * u))

            return mp.quad(speed, [0, p]) / radius

        mean = mp.findroot(lambda r: arc(r, mp.pi / 2) - mp.pi / 2, (radius, radius - mpf("0.01")))
        lift = radius + m - mean

        def pose(p):
            rho, slope = mean + lift * mp.cos(2 * p), -2 * lift * mp.sin(2 * p)
            phi = arc(mean, p)
            return rho * mp.expj(p - ratio * phi), p - mp.atan2(slope, rho) - ratio * phi

        def point(p):
            h = mpf(10) ** -10
            (low, less), (place, turn), (high, more) = (pose(p + k * h) for k in (-1, 0, 1))
            centre = place + 1j * (high - low) / (more - less)
            t = eta - mp.arg(centre) + mp.acos(arm / abs(centre))
            return mp.expj(-turn) * (arm * mp.expj(eta - t) * (1 + 1j * t) - place), t

        for k in (0, 200):
            at, h = base().contacts, mpf(10) ** -8
            low, (here, t), high = (point(mpf(at.motion.angle[k]) + s * h) for s in (-1, 0, 1))
            first, second = (high[0] - low[0]) / (2 * h), (high[0] - 2 * here + low[0]) / h**2
            kappa = (mp.conj(first) * second).imag / abs(first) ** 3
            assert at.point.x[k] == pytest.approx(float(here.real), abs=3e-13)
            assert at.point.y[k] == pytest.approx(float(here.imag), abs=3e-13)
            assert at.curvatures[1][k] == pytest.approx(float(kappa), rel=1e-12)
            assert at.gap_curvature[k] == pytest.approx(float(-1 / (arm * t) - kappa), rel=1e-12)
    assert float(mean - radius) == pytest.approx(-6.4e-3, abs=1e-4)  # mm


def test_no_equation_of_meshing_is_needed_to_find_the_flank():
    """The largest half thickness that passes the involute at every pose is the closed form."""
    at = base().contacts
    pose = motion(BASE, base().curve, np.radians(np.linspace(-20.0, 30.0, 4001))[:, None])
    pick = slice(20, -20, 40)
    height, half = at.point.x[pick], at.point.y[pick] - 0.05
    with np.errstate(invalid="ignore"):
        half = half + np.zeros((4001, 1))
        for _ in range(6):
            gap, radius = involute_gap(BASE, pose.placed(Vector(height, half)))
            more, _ = involute_gap(BASE, pose.placed(Vector(height, half + 1e-6)))
            half = half - gap / ((more - gap) / 1e-6)
        half = np.where((radius >= BASE.tip_radius) & np.isfinite(half), half, np.inf)
    k = half.argmin(axis=0)
    low, middle, high = (half[k + d, np.arange(len(k))] for d in (-1, 0, 1))
    least = middle - (low - high) ** 2 / (8.0 * (low - 2.0 * middle + high))
    assert 1e3 * np.abs(least - at.point.y[pick]).max() < 1e-6  # um


def test_the_normal_passes_the_instant_centre_and_the_tooth_turns_about_it():
    angle, step = np.radians([1.0, 8.0, 35.0, 70.0]), 1e-5
    at, before, after = (motion(BASE, base().curve, angle + s) for s in (0.0, -step, step))
    turned = after.turn - before.turn
    shift = (after.place - before.place) * (1.0 / turned)
    numeric = at.place + shift.left
    assert (at.centre - numeric).length.max() < 1e-6
    found = base().contacts
    along = found.direction.turned(found.motion.turn)
    assert np.abs((found.place - found.motion.centre).dot(along)).max() < 1e-12
    assert motion(BASE, base().curve, 0.0).centre.length == pytest.approx(40.2181, abs=5e-5)


def test_neutral_curves_keep_their_length():
    """The ellipse's perimeter is scipy's elliptic integral; others by a fine trapezoidal rule."""
    from scipy.special import ellipe

    for wave in ("cosine", "ellipse", "discs"):
        curve = neutral_curve(replace(BASE, wave=wave))
        assert abs(perimeter_error(curve)) < 1e-13
        assert radii(curve, 0.0)[0] == pytest.approx(curve.radius + 0.5, abs=1e-12)
        angle = np.linspace(0.0, np.pi / 2, 20001)
        rho, slope, *_ = radii(curve, angle)
        length = np.trapezoid(np.hypot(rho, slope), angle)
        assert length == pytest.approx(curve.radius * np.pi / 2, rel=1e-9)
    a, b = (lambda c: (c.first, c.second))(neutral_curve(replace(BASE, wave="ellipse")))
    assert 4.0 * a * ellipe(1.0 - (b / a) ** 2) == pytest.approx(2.0 * np.pi * 39.625, rel=1e-13)


def test_discs_and_other_waves_change_little():
    found = disc_constants(np.radians(30.0))
    assert found == pytest.approx((-2.4467, 3.4467, -8.0586, 7.0148, 11.2237), abs=5e-5)
    for wave, least in (("ellipse", 305), ("cosine", 313), ("discs", 361)):
        made = flank(replace(BASE, wave=wave))
        assert 1.0 / made.contacts.gap_curvature.max() == pytest.approx(least, abs=0.5)
    curve = neutral_curve(replace(BASE, wave="discs"))
    angle = np.radians(np.array([-70.0, -31.0, -10.0, 5.0, 29.0, 40.0, 80.0]))
    h = 1e-5
    for k in range(3):
        low, high = (radii(curve, angle + s)[k] for s in (-h, h))
        assert (high - low) / (2 * h) == pytest.approx(radii(curve, angle)[k + 1], abs=2e-7)


def test_curvature_and_its_slope_are_derivatives_of_the_curve():
    for wave in ("cosine", "ellipse"):
        curve, angle, h = neutral_curve(replace(BASE, wave=wave)), np.linspace(-1.5, 1.5, 7), 1e-4
        low, mid, high = (_place(curve, angle + s) for s in (-h, 0.0, h))
        d1, d2 = (high - low) * (0.5 / h), (high - mid - mid + low) * (1.0 / h**2)
        kappa, slope = curvature(curve, angle)
        assert d1.cross(d2) / d1.length**3 == pytest.approx(kappa, rel=1e-6)
        ahead, behind = (curvature(curve, angle + s)[0] for s in (h, -h))
        assert (ahead - behind) / (2 * h) == pytest.approx(slope, abs=1e-9)


def _place(curve, angle):
    rho = radii(curve, angle)[0]
    return Vector(rho * np.cos(angle), rho * np.sin(angle))


def test_arcs_and_angles_are_inverse_all_round():
    curve = base().curve
    arc = np.linspace(-1.55, 1.55, 9)
    assert arc_angle(curve, angle_of_arc(curve, arc)) == pytest.approx(arc, abs=1e-14)
    place, normal = whole_curve(curve, np.array([0.3, 0.3 + np.pi, 0.3 + 2 * np.pi]))
    assert place.x == pytest.approx(place.x[0] * np.array([1, -1, 1]), abs=1e-12)
    assert normal - normal[0] == pytest.approx([0.0, np.pi, 2 * np.pi], abs=1e-12)
    many = np.linspace(-7.0, 7.0, 1000)  # these are interpolated
    few = whole_curve(curve, many[::7])[0]
    assert whole_curve(curve, many)[0].x[::7] == pytest.approx(few.x, abs=1e-7)


def test_first_order_ring_theory_is_good_near_the_major_axis_alone():
    """um of the place's radius, from another program; the tooth's turn is the neutral curve's."""
    arc = np.radians(np.array([0.0, 5.0, 90.0]))
    found = small_motion(BASE, arc)
    exact = motion(BASE, base().curve, angle_of_arc(base().curve, arc))
    off = 1e3 * (found.place.length - exact.place.length)
    assert off == pytest.approx([0.0, -0.07, 13.0], abs=0.08)
    assert np.abs(found.turn - exact.turn).max() < 2e-4
    fine = np.radians(np.linspace(-89.0, 89.0, 357))
    place = motion(BASE, base().curve, angle_of_arc(base().curve, fine)).place
    off = 1e3 * (small_motion(BASE, fine).place.length - place.length)
    assert (off.min(), off.max()) == pytest.approx((-1.0, 13.0), abs=0.07)


def test_instant_centres_of_first_order_ring_theory_are_those_of_its_poses():
    arc, step = np.array([0.1, 0.5, 1.2]), 1e-5
    at, before, after = (small_motion(BASE, arc + s) for s in (0.0, -step, step))
    turned = after.turn - before.turn
    assert turned / (2.0 * step) == pytest.approx(at.turn_rate, rel=1e-8)
    numeric = at.place + ((after.place - before.place) * (1.0 / turned)).left
    assert (at.centre - numeric).length.max() < 1e-7
    rate = (after.centre - before.centre) * (0.5 / step)
    assert (rate - at.centre_rate).length.max() < 1e-6


def test_contact_of_first_order_ring_theory():
    """Its flank misses by 0.016 um, 1/R by 1.2 %, the angle of contact by 0.011 degrees."""
    at = base().contacts
    arc = at.motion.arc
    for _ in range(5):
        found = contact(BASE, small_motion(BASE, arc))
        arc = arc - (found.tangent - at.tangent) / found.tangent_rate
    found = contact(BASE, small_motion(BASE, arc))
    aside = 1e3 * np.abs((found.point - at.point).dot(at.direction.left)).max()
    assert aside == pytest.approx(0.016, abs=5e-4)
    off = np.abs(at.gap_curvature / found.gap_curvature - 1.0).max()
    assert off == pytest.approx(0.012, abs=5e-4)
    assert np.degrees(np.abs(arc - at.motion.arc).max()) == pytest.approx(0.011, abs=1e-4)


def test_existence():
    """Below w of 0.8139 the instant centre of the major axis is inside the base circle."""
    assert least_deflection(BASE) == pytest.approx(0.81385, abs=1e-5)
    for w, limit in ((0.8, 26.4), (0.7, 35.0)):
        found = np.degrees(existence(replace(BASE, deflection=w)))
        assert found == pytest.approx(np.array([[-90.0, -limit], [limit, 90.0]]), abs=0.05)
    assert np.degrees(existence(BASE)) == pytest.approx(np.array([[-90.0, 90.0]]))


def test_a_radius_has_one_admissible_contact_and_one_on_the_mirrored_involute():
    """t rises over the wave; where it is below 0 contact is on the other side's involute."""
    arc = np.radians(np.linspace(-60.0, 60.0, 24001))
    at = contact(BASE, motion(BASE, base().curve, angle_of_arc(base().curve, arc)))
    sides = np.sign(at.radius - 40.95)
    crossings = np.flatnonzero(sides[1:] != sides[:-1])
    assert np.degrees(arc[crossings]) == pytest.approx([-41.8, 2.28], abs=0.05)
    assert (at.tangent[crossings] > 0.0).tolist() == [False, True]
    assert at.gap_curvature[crossings[1]] > 0.0
    whole = slice(*np.searchsorted(arc, np.radians([-40.0, 40.0])))
    assert (np.diff(at.tangent[whole]) > 0.0).all()


def test_gearings_at_once_and_one_by_one_are_the_same():
    angle = np.radians([[18.0], [20.0], [25.0]])
    many = flank(StrainWave(np.full((3, 1), 0.5), 160, angle, np.full((3, 1), 0.9)), 7)
    for k in range(3):
        one = flank(replace(BASE, pressure_angle=angle[k, 0]), 7)
        assert many.pairs_in_contact[k] == pytest.approx(one.pairs_in_contact, rel=1e-12)
        assert many.contacts.gap_curvature[k] == pytest.approx(one.contacts.gap_curvature)
    assert many.complete.all()


def test_the_text_is_traced_as_it_is_run():
    import casadi as ca

    with legacy_numpy():
        p = ca.SX.sym("p")
        at = contact(BASE, motion(BASE, base().curve, p))
        traced = ca.Function("f", [p], [at.point.x, at.point.y, at.gap_curvature, at.speeds[1]])
    at = base().contacts
    for k in (0, 77, 200):
        found = [float(v) for v in traced(at.motion.angle[k])]
        exact = at.point.x[k], at.point.y[k], at.gap_curvature[k], at.speeds[1][k]
        assert found == pytest.approx(exact, rel=1e-13)


def test_the_virtual_internal_pair_explains_the_conformity():
    """R_c - R_f is nearly a_v sin(alpha_C), a_v from the neutral curve's centre of curvature.

    Numbers and the approximation of |C_0| for small w_0 are those of another program.
    """
    at, kappa = motion(BASE, base().curve, 0.0), curvature(base().curve, 0.0)[0]
    radius = BASE.neutral_radius
    assert kappa * radius == pytest.approx(1.0374, abs=5e-6)
    apart = radius + 0.5 - 1.0 / kappa
    angle = np.arccos(BASE.base_radius / at.centre.length)
    assert (apart, np.degrees(angle)) == pytest.approx((1.928, 18.87), abs=6e-3)
    spline, flex = (1.0 / abs(c[0]) for c in base().contacts.curvatures)
    near = apart * np.sin(angle)
    assert (near, spline - flex) == pytest.approx((0.6236, 0.6226), abs=6e-5)
    assert flex * spline / near * base().contacts.gap_curvature[0] == pytest.approx(1.0, abs=2e-3)
    first = 4.0 * 0.5 * (radius + 0.5) / (radius * (2.0 / 162 + 3.0 * 0.5 / radius))
    assert first == pytest.approx(40.343, abs=5e-4)
    assert at.centre.length == pytest.approx(first, rel=4e-3)


@pytest.mark.parametrize(("wave", "off"), [("ellipse", 0.05), ("discs", 0.22)])
def test_the_wave_generator_changes_the_flank_by_tenths_of_a_um(wave, off):
    made = flank(replace(BASE, wave=wave)).contacts.point
    own = base().contacts.point
    low, high = max(own.x[0], made.x[0]), min(own.x[-1], made.x[-1])
    height = np.linspace(low, high, 50)
    found = [CubicSpline(p.x, p.y) for p in (own, made)]
    apart = (found[1](height) - found[0](height)) / np.hypot(1.0, found[0](height, 1))
    assert 1e3 * np.abs(apart).max() == pytest.approx(off, abs=0.016)
