"""Gears with rims, webs and hubs: volumes, what does not fit, lower bounds, involute teeth."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearopt.formulations.drive.toothing import Toothing
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.gears import GearPair, Rack, reference_diameter
from gearopt.physics.geometry.fillet import profile

RACKS = (Rack(math.radians(20.0)),) * 2
WHEEL = Toothing(0.0, RACKS).pair(4.0, 20, 100, 50.0).wheel  # d 400, d_f 390
MADE = Blank(3.0, None, 0.25, 60.0, 1.5)  # rim 12, inside 366, hub 90


def ring(outer, inner):
    return math.pi / 4.0 * (outer**2 - inner**2)


def gears(seed, count=400):
    """Return random gears of arrays, with blanks of about their size."""
    rng = np.random.default_rng(seed)
    teeth, module = rng.integers(8, 200, count).astype(float), 10.0 ** rng.uniform(-0.5, 1.3, count)
    made = Toothing(float(rng.uniform(0.0, 0.6)), RACKS, (float(rng.uniform(-0.4, 0.8)), 0.0))
    gear = made.pair(module, teeth, teeth, module * rng.uniform(3.0, 20.0, count)).pinion
    rim = [(float(rng.uniform(0.5, 8.0)), None), (None, float(rng.uniform(0.5, 30.0)))]
    bore = float(rng.choice([0.0, 10.0 ** rng.uniform(0.5, 2.5)]))
    web, hub = float(rng.uniform(0.05, 1.2)), float(rng.uniform(1.1, 2.5))
    return gear, Blank(*rim[int(rng.integers(0, 2))], web, bore, hub)


def test_a_webbed_wheel_by_hand():
    whole = 50.0 * (ring(400, 366) + 0.25 * ring(366, 90) + ring(90, 60))
    assert MADE.volume(WHEEL) == pytest.approx(whole, rel=1e-13)
    body = MADE.body(WHEEL)
    found = body.rim_thickness, body.web_thickness, body.hub_diameter, body.bore
    assert found == pytest.approx((12.0, 12.5, 90.0, 60.0))
    assert MADE.backup(WHEEL) == pytest.approx(12.0 / 9.0)
    assert MADE.web(WHEEL) == pytest.approx((0.25, 3.0))
    assert MADE.inner_diameter(WHEEL) == pytest.approx(366.0)
    bare = replace(MADE, bore=0.0)  # the web reaches the axis
    assert bare.volume(WHEEL) == pytest.approx(50.0 * (ring(400, 366) + 0.25 * ring(366, 0)))
    assert SOLID.volume(WHEEL) == WHEEL.volume and SOLID.backup(WHEEL) is None


def test_a_rim_is_in_modules_or_in_mm():
    same = replace(MADE, rim_over_module=None, rim_thickness=12.0)
    assert same.volume(WHEEL) == MADE.volume(WHEEL)
    assert same.backup(WHEEL) == MADE.backup(WHEEL) and same.web(WHEEL) == MADE.web(WHEEL)


def test_a_web_as_thick_as_the_face_is_a_bored_disc():
    full = replace(MADE, web_over_width=1.0)
    assert full.volume(WHEEL) == pytest.approx(50.0 * ring(400, 60), rel=1e-14)
    assert full.web(WHEEL) is None and full.inner_diameter(WHEEL) == 60.0
    webs = [replace(MADE, web_over_width=w).volume(WHEEL) for w in (0.1, 0.3, 0.7, 1.0)]
    assert webs == sorted(webs)


@pytest.mark.parametrize(
    ("hub", "rim", "bored"),
    [(365.9, True, True), (366.0, False, True), (389.9, False, True), (390.0, False, False)],
)
def test_what_does_not_fit_is_left_out(hub, rim, bored):
    """A rim that touches the hub leaves no web; a hub that touches the root circle, no bore."""
    made = replace(MADE, bore=hub / 1.5)
    body = made.body(WHEEL)
    assert (body.rim_thickness is not None, body.bore is not None) == (rim, bored)
    if not rim:
        inside = hub / 1.5 if bored else 0.0
        assert made.volume(WHEEL) == pytest.approx(50.0 * ring(400, inside), rel=1e-13)
        assert made.inner_diameter(WHEEL) == pytest.approx(inside)
        wall = 0.5 * (390.0 - inside) / 9.0
        assert made.backup(WHEEL) == (pytest.approx(wall) if bored else 10.0)


@pytest.mark.parametrize("hub", [366.0, 390.0])
def test_rounding_does_not_decide_what_fits(hub):
    """Lengths that are equal but for the last digits, as of inches."""
    made = [replace(MADE, bore=hub / 1.5 * (1.0 + k * 2.0**-50)) for k in (-2, -1, 0, 1, 2)]
    assert len({round(one.volume(WHEEL), 6) for one in made}) == 1


@pytest.mark.parametrize("seed", range(40))
def test_lower_bounds_of_random_gears(seed):
    gear, made = gears(seed)
    volume = made.volume(gear)
    assert (volume > 0.0).all() and (volume <= gear.volume).all()
    margin = 1.0 - 1e-12
    assert (made.least_fraction * gear.volume * margin <= volume).all()
    for fewest in (gear.teeth, np.maximum(5.0, 0.7 * gear.teeth), float(gear.teeth.min())):
        assert (made.least_volume(gear, fewest) * margin <= volume).all()


@pytest.mark.parametrize("seed", range(10))
def test_bounds_of_larger_modules_are_larger(seed):
    gear, made = gears(seed)
    larger = replace(
        gear,
        normal_module=1.3 * gear.normal_module,
        reference_diameter=1.3 * gear.reference_diameter,
    )
    least = (made.least_volume(one, gear.teeth) for one in (gear, larger))
    np.testing.assert_allclose(1.3**2 * next(least), next(least), rtol=1e-12)


def test_bounds_are_close_to_webs_without_bores():
    """With the teeth known, equal up to rounding."""
    gear, made = gears(3)
    made = Blank(3.0, None, 0.3)
    gear = replace(gear, profile_shift=0.0)
    fits = made.where_rim(gear, True, False)
    ratio = made.least_volume(gear, gear.teeth) / made.volume(gear)
    assert ratio[fits] == pytest.approx(1.0, rel=1e-12) and fits.sum() > 300


def involute_area(gear, points=400):
    """Area [mm2] of a transverse section with involute flanks and fillets, from its outline."""
    x, y = profile(gear, points, points)
    radius, angle = np.hypot(x, y), np.arctan2(x, y)
    flank = -0.25 * np.sum((radius[1:] ** 2 + radius[:-1] ** 2) * np.diff(angle))
    ends = radius[-1] ** 2 * angle[-1] + radius[0] ** 2 * (math.pi / gear.teeth - angle[0])
    return 2.0 * gear.teeth * (flank + 0.5 * ends)


@pytest.mark.parametrize(
    ("shift", "solid", "webbed"),
    [(0.0, (0.08, 1.96), (0.24, 2.38)), (0.3, (-4.88, -0.40), (-6.08, -1.16))],
)
def test_errors_of_the_reference_circle_that_the_docs_tell(shift, solid, webbed):
    """Per cent, against the section of involute teeth: 17 to 200 teeth, 0 to 35 degrees."""
    made, whole, hollow = Blank(3.0, None, 0.3), [], []
    for teeth in (17, 30, 60, 200):
        for helix in (0.0, 25.0, 35.0):
            tooth = Toothing(math.radians(helix), RACKS, (shift, 0.0))
            gear = tooth.pair(1.0, teeth, teeth, 1.0).pinion
            assert gear.reference_diameter == reference_diameter(1.0, teeth, math.radians(helix))
            exact, disc, light = involute_area(gear), gear.volume, made.volume(gear)
            whole.append(100.0 * (disc / exact - 1.0))
            hollow.append(100.0 * (light / (light + exact - disc) - 1.0))
    assert solid[0] < min(whole) and max(whole) < solid[1]
    assert webbed[0] < min(hollow) and max(hollow) < webbed[1]


@pytest.mark.parametrize("blank", [SOLID, MADE, Blank(bore=60.0)])
def test_an_internal_gear_is_a_tube_of_any_blank(blank):
    """From its reference circle, 284, to its outside, 340 mm, 40 mm wide."""
    gear = replace(GearPair.internal(4.0, 25, -71, 40.0).wheel, outside_diameter=-340.0)
    assert blank.volume(gear) == pytest.approx(40.0 * ring(340.0, 284.0), rel=1e-12)
    body = blank.body(gear)
    assert (body.web_thickness, body.bore) == (None, None)
