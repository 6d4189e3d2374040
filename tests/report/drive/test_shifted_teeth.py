"""Shifted teeth in three dimensions: in mesh at their working centre distance, as they are cut."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from campaigns import few

from gearopt.formulations.drive.layout.layout_design import GearDesign, gear_sizes
from gearopt.formulations.drive.toothing import Toothing
from gearopt.optimise.typed import typed, untyped
from gearopt.physics.gears import ISO_53_A, Rack
from gearopt.physics.geometry.tooth import circumferential_backlash
from gearopt.report.drawing.bodies import meaning
from gearopt.report.drawing.solid import BACKLASH, outline, twist
from gearopt.report.kinds.drive.layout_solid import _toothed
from gearopt.report.measures import METRIC

HOB = Rack(math.radians(25.0), 1.0, 1.25, 0.3), Rack(math.radians(25.0), 1.0, 1.3, 0.25)
BOTH = ISO_53_A, ISO_53_A
PAIRS = {
    "spur, x = 0.5 and 0": (Toothing(profile_shifts=(0.5, 0.0)), 12, 40),
    "helical": (Toothing(math.radians(25.0), BOTH, (0.3, 0.2), (-0.1, -0.1)), 12, 40),
    "other tools, large shifts": (Toothing(0.2, HOB, (0.6, 0.9), (-0.2, -0.2)), 17, 25),
    "negative shifts": (Toothing(profile_shifts=(0.1, -0.4)), 25, 40),
    "thinned": (Toothing(0.0, BOTH, (0.3, 0.0), (0.0, 0.0), (-0.1, -0.2)), 18, 40),
    "wide apart": (Toothing(profile_shifts=(0.4, 0.0), working_distance=88.5), 18, 40),
}


def placed(name, hands=None):
    """A pair of module 3 mm whose line of centres is turned, as it is drawn; hands by member."""
    own, z1, z2 = PAIRS[name]
    pair = own.pair(3.0, z1, z2, 20.0)
    gears = []
    for k, (member, gear) in enumerate(zip(("pinion", "wheel"), pair.gears, strict=True), 1):
        place = {"name": f"{member} 1", "stage": 1, "member": member, "shaft": k}
        place["hand"] = (hands or {}).get(member, "")
        sizes = gear_sizes(gear) | {"teeth": gear.teeth, "from_mm": 0.0, "to_mm": 20.0}
        gears.append(typed(GearDesign, untyped(GearDesign(**place, **sizes)), name))
    a = float(pair.centre_distance)
    places = {1: (1.0, 2.0), 2: (1.0 + a * math.cos(0.7), 2.0 + a * math.sin(0.7))}
    found = SimpleNamespace(gears=gears)
    return pair, [_toothed(found, gear, places) for gear in gears]


def rim(solid, x, turned=0.0):
    """The outline at x along the shafts (n, 2), and which of its points are near a mate."""
    turn = solid.phase + twist(solid.gear) * (x - solid.middle) + turned
    angle, r = np.array(outline(solid.gear, 120)).T
    y, z = solid.centre
    return np.column_stack([y + r * np.cos(angle + turn), z + r * np.sin(angle + turn)])


def cut(one, other):
    """Whether points of one outline lie inside the polygon of the other."""
    a, b = other, np.roll(other, -1, axis=0)
    low, high = np.minimum(a[:, 1], b[:, 1]), np.maximum(a[:, 1], b[:, 1])
    point, row = np.nonzero((low <= one[:, 1, None]) & (one[:, 1, None] < high))
    (y, z), step = one[point].T, b[row] - a[row]
    beyond = a[row, 0] + (z - a[row, 1]) / step[:, 1] * step[:, 0] > y
    return bool((np.bincount(point[beyond], minlength=1) % 2).any())


def meets(solids, x, turned):
    one, other = rim(solids[0], x, turned), rim(solids[1], x)
    (y1, z1), (y2, z2) = (s.centre for s in solids)
    reach = [np.hypot(*(rim_ - c).T).max() for rim_, c in ((one, (y1, z1)), (other, (y2, z2)))]
    near = one[np.hypot(*(one - (y2, z2)).T) < reach[1]]
    facing = other[np.hypot(*(other - (y1, z1)).T) < reach[0]]
    return cut(near, other) or cut(facing, one)


def free(solids, x, sign):
    """How far the pinion turns until flanks touch [rad]."""
    low, high = 0.0, 0.5 * math.pi / solids[0].gear.teeth
    for _ in range(12):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if meets(solids, x, sign * middle) else (middle, high)
    return low


@pytest.mark.parametrize("name", few(PAIRS, 1))
def test_shifted_teeth_mesh_with_their_backlash(name):
    """Twice that of the drawing and their own, half of it on either flank; none cuts the other."""
    pair, solids = placed(name)
    z1, pinion = pair.pinion_teeth, pair.working_diameters[0]
    own = 2.0 * float(circumferential_backlash(pair)) / pinion
    meant = 2.0 * BACKLASH * 2.0 * math.pi / z1 + own
    assert not meets(solids, 10.0, 0.0)
    for sign in (1, -1):
        assert free(solids, 10.0, sign) == pytest.approx(0.5 * meant, rel=0.02)


@pytest.mark.parametrize("hand", ["", "right", "left"])
def test_hands_are_those_of_the_design(hand):
    """Along its axis a right hand helix turns as a right hand screw; by default the pinion's."""
    other = {"right": "left", "left": "right", "": ""}
    _, solids = placed("helical", {"pinion": hand, "wheel": other[hand]})
    turns = tuple(math.copysign(1.0, twist(solid.gear)) for solid in solids)
    assert turns == ((-1.0, 1.0) if hand == "left" else (1.0, -1.0))


def test_drawn_teeth_have_the_diameters_and_tools_of_the_design():
    for name in PAIRS:
        pair, solids = placed(name)
        for gear, solid in zip(pair.gears, solids, strict=True):
            radius = np.array(outline(solid.gear, 9))[:, 1]
            assert radius.max() == pytest.approx(float(gear.tip_diameter) / 2, rel=1e-12)
            deeper = gear.thickness_allowance / math.tan(gear.rack.pressure_angle)
            root = float(gear.root_diameter + deeper) / 2
            assert radius.min() == pytest.approx(root, rel=1e-9)
            assert solid.gear.rack == gear.rack


def test_teeth_and_shift_of_a_drawn_gear_are_told_in_words():
    """z and x are axes of the box."""
    gear = GearDesign(
        **{"name": "wheel 1", "stage": 1, "member": "wheel", "shaft": 2, "teeth": 135},
        **{"normal_module_mm": 2.0, "reference_diameter_mm": 276.03, "tip_diameter_mm": 284.92},
        **{"root_diameter_mm": 270.0, "helix_angle_deg": 12.0},
        **{"from_mm": 0.0, "to_mm": 36.25, "profile_shift": 1.36},
    )
    assert meaning(gear, METRIC).startswith(
        "wheel 1: 135 teeth, m_n 2 mm, profile shift coefficient 1.36, d 276.03 mm"
    )
