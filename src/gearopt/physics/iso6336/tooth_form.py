"""Y_F and Y_S by method B of ISO 6336-3: the tooth at the 30-degree tangent to its root fillet.

The tooth is the virtual spur gear in the normal plane, in units of the normal module, cut by its
rack; loaded at the outer point of single tooth contact. The fillet is that of `geometry.fillet`,
whose tool angle is pi/2 less the standard's theta. Floats, arrays or casadi scalars.

A ring has z_n < 0, its tangent 60 degrees to the centre line, and the counterpart of the rack as
its tool, whose round stands for that of a pinion-type cutter (`virtual_tip_radius`).
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.choosing import choose
from gearopt.physics.gears import Gear, GearPair, Rack, is_internal, signed
from gearopt.physics.geometry.fillet import base_half_angle, fillet_point, tool_tip
from gearopt.physics.geometry.tooth import base_helix_angle, virtual_teeth

TANGENT = np.pi / 6.0  # between fillet and centre line of the tooth
RING_TANGENT = np.pi / 3.0  # of a ring. Source: ISO 6336-3:2006, 6.2; printed as alfsFn 60.0
NEWTON_STEPS = 8
SHIFTS = ("nominal", "generating")


@dataclass(frozen=True)
class ToothForm:
    """A loaded tooth, lengths in normal modules.

    height h_F and thickness s_Fn of the critical section, fillet_radius rho_F there; load_angle
    alpha_Fen [rad]; load_diameter d_en; virtual_ratio eps_alphan; notch q_s = s_Fn/(2 rho_F);
    undercut: whether the section lies above the end of the fillet. form: Y_F without f_eps;
    concentration: Y_S.
    """

    height: Any
    thickness: Any
    fillet_radius: Any
    load_angle: Any
    load_diameter: Any
    virtual_ratio: Any
    notch: Any
    form: Any
    concentration: Any


def virtual_gear(gear: Gear, shift: str = "nominal") -> Gear:
    """Return the virtual spur gear of z_n teeth and unit module.

    shift: "nominal", of x, or "generating", of x_E, which thins the tooth. z_n = z/(cos(beta_b)^2
    cos(beta)). ValueError for another shift. Source: ISO 6336-3:2006, 6.2.
    """
    if shift not in SHIFTS:
        raise ValueError(f"no shift {shift!r}; known: {', '.join(SHIFTS)}")
    teeth = virtual_teeth(gear)
    allowance = gear.thickness_allowance / gear.normal_module if shift == "generating" else 0.0
    tips = gear.profile_shift, gear.tip_alteration, allowance
    return Gear(1.0, teeth, teeth, 1.0, 0.0, virtual_rack(gear), *tips)


def virtual_rack(gear: Gear) -> Rack:
    """Return the rack whose round leaves the fillet of a gear; its own but of rings by cutters.

    rho_fPv = rho + (x_0 + h - rho)^1.95/(3.156 1.036^z_0) in normal modules, of the addendum h =
    h_a0 and tip radius rho = rho_a0 of the cutter, which stand for h_fP and rho_fP. Source: ISO
    6336-3:2006, 6.2 [memory]; two printed rings are met by it.
    """
    cutter, rack = gear.cutter, gear.rack
    if cutter is None or not is_internal(gear.teeth):
        return rack
    high = cutter.profile_shift + cutter.addendum - cutter.tip_radius
    radius = cutter.tip_radius + high**1.95 / (3.156 * 1.036**cutter.teeth)
    return replace(rack, dedendum=cutter.addendum, tip_radius=radius)


def tangent_angle(gear: Gear) -> Any:
    """Return the angle [rad] between the tangent and the centre line of the tooth."""
    if not is_internal(gear.teeth):
        return TANGENT
    return choose(np.less(gear.teeth, 0.0), RING_TANGENT, TANGENT)


def tangent_theta(gear: Gear) -> Any:
    """Return theta [rad] of the 30-degree tangent: theta = 2 G/z tan(theta) - H.

    of a virtual gear of unit module. G = rho - h_fP + x, H = 2 (pi/2 - E)/z - T, T = pi/3, of rings
    pi/6, E half the width between the centres of the tool's tip rounds. Newton's method from pi/6,
    of rings pi/3, a fixed number of steps. Source: ISO 6336-3:2006, 6.2; DIN 3990-11, annex D, of
    hanslhansl/din3990.
    """
    tip, teeth, tangent_of = tool_tip(gear), gear.teeth, tangent_angle(gear)
    depth = -tip.depth
    shape = 2.0 / teeth * (np.pi / 2.0 - tip.half_width) - np.pi / 2.0 + tangent_of
    theta = tangent_of + 0.0 * depth
    for _ in range(NEWTON_STEPS):
        tangent = np.tan(theta)
        error = theta - 2.0 * depth / teeth * tangent + shape
        theta = theta - error / (1.0 - 2.0 * depth / teeth * (1.0 + tangent**2))
    return theta


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def tooth_form(gear: Gear, helix: Any, transverse: Any, shift: str = "nominal") -> ToothForm:
    """Return the form of a gear's tooth.

    helix: base helix angle [rad]; transverse: eps_alpha of its mesh. The load acts eps_alphan - 1
    normal base pitches below the tip, eps_alphan = eps_alpha/cos(beta_b)^2. rho_F = rho + 2 G^2/
    (cos(theta) (|z_n| cos(theta)^2 - 2 G)), G as in `tangent_theta`; Y_F = 6 h_F cos(alpha_Fen)/
    (s_Fn^2 cos(alpha_n)); Y_S = (1.2 + 0.13 L) q_s^(1/(1.21 + 2.3/L)), L = s_Fn/h_F. With z_n of a
    ring for |z_n| a printed rho_F of 0.494 would be 0.512.
    Source: ISO 6336-3:2006, 6.2 and 7.
    """
    virtual = virtual_gear(gear, shift)
    tip = tool_tip(virtual)
    theta = tangent_theta(virtual)
    point = fillet_point(virtual, np.pi / 2.0 - theta, tip)
    depth, cosine = -tip.depth, np.cos(theta)
    teeth = signed(virtual.teeth, virtual.teeth)
    radius = tip.radius + 2.0 * depth**2 / (cosine * (teeth * cosine**2 - 2.0 * depth))
    ratio = transverse / np.cos(helix) ** 2
    angle = gear.rack.pressure_angle
    base = 0.5 * virtual.base_diameter
    reach = signed(np.sqrt((0.5 * virtual.active_tip_diameter) ** 2 - base**2), base)
    reach = reach - np.pi * np.cos(angle) * (ratio - 1.0)
    load_angle = reach / base - base_half_angle(virtual)
    height, thickness = base / np.cos(load_angle) - point.y, 2.0 * point.x
    notch, slim = 0.5 * thickness / radius, thickness / height
    form = 6.0 * height * np.cos(load_angle) / (thickness**2 * np.cos(angle))
    concentration = (1.2 + 0.13 * slim) * notch ** (1.0 / (1.21 + 2.3 / slim))
    diameter = 2.0 * np.sqrt(reach**2 + base**2)
    return ToothForm(
        height, thickness, radius, load_angle, diameter, ratio, notch, form, concentration
    )


def tooth_forms(
    pair: GearPair, transverse: Any, shift: str = "nominal"
) -> tuple[ToothForm, ToothForm]:
    """Return the forms of both teeth of a pair of transverse contact ratio eps_alpha."""
    helix = base_helix_angle(pair.pinion)
    first, second = (tooth_form(gear, helix, transverse, shift) for gear in pair.gears)
    return first, second


def load_sharing(virtual_ratio: Any, overlap: Any) -> Any:
    """Return f_eps of the edition of 2019, a factor of Y_F.

    sqrt((1 - eps_beta) f + eps_beta/eps_alphan), eps_beta up to 1; f 1, and for eps_alphan >= 2
    1/2 (with eps_beta = 0: 0.7). 2006 has none. Source: ISO 6336-3:2019, 6.2 [memory; printed
    reports have it of eps_beta above 1 and eps_alphan below 2].
    """
    share = np.minimum(overlap, 1.0)
    part = choose(virtual_ratio >= 2.0, 0.5, 1.0)
    mixed = np.sqrt((1.0 - share) * part + share / virtual_ratio)
    spur = choose(virtual_ratio >= 2.0, 0.7, 1.0)
    return choose(overlap == 0.0, spur, mixed)
