"""Form factors are monotone in teeth and contact ratio: proven by interval arithmetic.

For all of 17 to 120 virtual teeth of two racks of 20 degrees, at some contact ratios, with the text
of the laws itself.
"""

from dataclasses import replace

import numpy as np
import pytest
from ranges import Range

from gearopt.physics.agma import bending
from gearopt.physics.agma.mesh import Mesh
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.fillet import base_half_angle, least_fillet_radius, tool_tip
from gearopt.physics.iso6336 import tooth_form as form

RACKS = {"0.38": Rack(tip_radius=0.38), "0.25": Rack(tip_radius=0.25)}
TANGENT = form.tangent_theta
FEWEST, MOST, WIDEST = 17.0, 120.0, 0.008


def cells():
    """Cells (2, n) of teeth, the narrower the more: derivatives fall with their square."""
    ends = [FEWEST]
    while ends[-1] < MOST:
        ends.append(ends[-1] + min(WIDEST, 4.0 * WIDEST * (FEWEST / ends[-1]) ** 2))
    return np.array([ends[:-1], ends[1:]])


def virtual(rack, z):
    """The virtual gear of numbers of teeth or their ranges."""
    gear = GearPair.of_teeth(1.0, 20.0, 40.0, 1.0, rack=rack).pinion
    return replace(gear, teeth=z, reference_diameter=z)


def implicit(law, low, high, by_theta, by_other):
    """The range of an angle, a root between low and high, with its implicit slopes."""
    found = []
    for own in by_other:
        ratios = [-a / b for a in own for b in by_theta]
        found.append((np.minimum.reduce(ratios), np.maximum.reduce(ratios)))
    return lambda z: Range(low, high, law(z.middle), tuple(found), z.half)


def iso_theta(rack, z):
    """The angle of the 30-degree tangent: it rises with the teeth, as its error says."""
    tip = tool_tip(virtual(rack, 20.0))
    depth = -tip.depth
    assert depth < 0.0  # then the error rises with theta and with 1/z

    def law(x):
        return TANGENT(virtual(rack, x))

    low, high = law(z.low), law(z.high)
    rises = [
        1.0 - 2.0 * depth / x * (1.0 + np.tan(y) ** 2) for x in (z.low, z.high) for y in (low, high)
    ]
    falls = [
        (2.0 * depth * np.tan(y) - 2.0 * (0.5 * np.pi - tip.half_width)) / x**2
        for x in (z.low, z.high)
        for y in (low, high)
    ]
    by_theta = np.minimum.reduce(rises), np.maximum.reduce(rises)
    zero = np.zeros(len(low))
    by_other = (np.minimum.reduce(falls), np.maximum.reduce(falls)), (zero, zero)
    return implicit(law, low, high, by_theta, by_other)(z)


def certain(ranges, signs):
    """Whether all slopes that a number has are of these signs; 0: of any."""
    slopes = zip(ranges.slopes, signs, strict=True)
    return all(not sign or (s[0] if sign > 0 else -s[1]).min() >= 0.0 for s, sign in slopes)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [1.2, 1.9])
@pytest.mark.parametrize("rack", RACKS)
def test_form_factors_of_iso(rack, ratio, monkeypatch):
    """Y_F falls with z and eps_alpha, Y_S rises with both, q_s with z; Y_F Y_S does not fall."""
    ends = cells()
    both = np.full_like(ends, ratio) + np.array([[0.0], [1e-3]])
    z, eps = Range.variables([ends, both])
    gear, theta = virtual(RACKS[rack], z), iso_theta(RACKS[rack], z)
    monkeypatch.setattr(form, "tangent_theta", lambda _: theta)
    monkeypatch.setattr(form, "virtual_gear", lambda *_: gear)
    made = form.tooth_form(gear, 0.0, eps)
    assert certain(made.form, (-1, -1))
    assert certain(made.concentration, (1, 1))
    assert certain(made.notch, (1, 0))


def loaded(rack, z, tangent):
    """A tooth under a load whose radius of curvature over the base radius is `tangent`."""
    gear = virtual(rack, z)
    base = 0.5 * gear.base_diameter
    angle = tangent - base_half_angle(gear)
    mesh = Mesh(None, None, 0.0, 1.0, 1.0, "spur")
    slim = least_fillet_radius(gear)
    apex = base / np.cos(angle)
    return bending.LoadedTooth(gear, mesh, angle, apex, rack.pressure_angle, slim, 1.0, 1.0)


def agma_tangent(rack, z, mate):
    """At the tip (mate None), or at the highest point of single contact with a mate's addendum.

    mate: what its addendum adds to eps_alpha, which rises with its teeth.
    """
    gear = virtual(rack, z)
    base, alpha = 0.5 * gear.base_diameter, rack.pressure_angle
    if mate is None:
        return np.sqrt((0.5 * gear.tip_diameter / base) ** 2 - 1.0)
    return np.tan(alpha) + (1.0 - mate) * np.pi * np.cos(alpha) / base


@pytest.mark.slow
@pytest.mark.parametrize("mate", [None, 0.8])
@pytest.mark.parametrize("rack", RACKS)
def test_bending_factors_of_agma(rack, mate):
    """J rises with z and, of loads at the highest point of single contact, with the mate."""
    own, ends = RACKS[rack], cells()
    add = np.full_like(ends, mate or 0.0) + np.array([[0.0], [1e-3]])

    def law(x, y):
        tangent = agma_tangent(own, x, None if mate is None else y)
        return bending.critical_theta(loaded(own, x, tangent))

    corners = [law(x, y) for x in ends for y in add]
    low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
    low, high = low - 0.1 * (high - low) - 1e-9, high + 0.1 * (high - low) + 1e-9
    z, part, theta = Range.variables([ends, add, np.array([low, high])])
    tooth = loaded(own, z, agma_tangent(own, z, None if mate is None else part))
    at_low, at_high = (bending.tangency(tooth, edge + 0.0 * theta) for edge in (low, high))
    assert (at_low.high < 0.0).all() and (at_high.low > 0.0).all()
    by_z, by_part, by_theta = bending.tangency(tooth, theta).slopes
    assert (by_theta[0] > 0.0).all()
    z, part = Range.variables([ends, add])
    tooth = loaded(own, z, agma_tangent(own, z, None if mate is None else part))
    middle = law(z.middle, part.middle)
    at = implicit(lambda _: middle, low, high, by_theta, (by_z, by_part))(z)
    assert certain(bending.bending_factor(tooth, at).value, (1, 1 if mate is not None else 0))
