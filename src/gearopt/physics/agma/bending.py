"""The geometry factor for bending, J, by the analytic method of AGMA 908-B89.

The tooth is the virtual spur gear in the normal plane, in units of the normal module. Its load acts
at the highest point of single tooth contact for spur gears and m_F <= 1, at the tip for m_F > 1 or
where that is asked. The critical section is where the parabola of equal stress, its vertex where
the load's line meets the centre line of the tooth, touches the fillet. 908 has no internal gears:
of a ring it is where the tangent of 60 degrees touches (`iso6336.tooth_form`), of 30 degrees to the
teeth of the rack that cuts it; all else is as outside, with its signs (unverified).
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.agma.mesh import Mesh, mesh_of, virtual_gear
from gearopt.physics.choosing import choose
from gearopt.physics.gears import Gear, GearPair, is_internal, signed
from gearopt.physics.geometry.fillet import (
    ToolTip,
    base_half_angle,
    fillet_point,
    least_fillet_radius,
    tool_tip,
)
from gearopt.physics.iso6336.tooth_form import tangent_theta

NEWTON = 7  # steps from the middle of an interval of 1.2, halving where one leaves it: to rounding
LOADS = ("highest single", "tip")


@dataclass(frozen=True)
class LoadedTooth:
    """A virtual tooth and its load, in normal modules.

    load_angle phi_nL of the load against the normal of the centre line [rad]; apex: where its line
    meets the centre line, from the gear's axis; working_angle phi_nr: normal working pressure angle
    [rad]; fillet_radius rho_F; helix_factor C_h; slant_factor K_psi; mesh: of which it is.
    """

    gear: Gear
    mesh: Mesh
    load_angle: Any
    apex: Any
    working_angle: Any
    fillet_radius: Any
    helix_factor: Any
    slant_factor: Any


@dataclass(frozen=True)
class BendingFactor:
    """J of one member and its parts, lengths in normal modules.

    height h_F and thickness s_F of the critical section; form Y; concentration K_f; value J.
    2101 calls J Y_J.
    """

    value: Any
    form: Any
    concentration: Any
    height: Any
    thickness: Any


def seen_from_wheel(mesh: Mesh) -> Mesh:
    """Return a mesh with its wheel in the place of the pinion, for J of the wheel.

    Load sharing and overlap factor are those of the pair: 908 has one of each.
    """
    pair = mesh.pair
    turned = GearPair(pair.wheel, pair.pinion, pair.working_distance)
    return replace(mesh, pair=turned)


@np.errstate(invalid="ignore", divide="ignore")
def loaded_tooth(mesh: Mesh, load: str = "highest single") -> LoadedTooth:
    """Return the virtual tooth of the pinion of a mesh and its load.

    load: one of LOADS; helical gears with m_F > 1 are loaded at the tip whatever is asked. For the
    wheel pass the mesh `seen_from_wheel`. With t = tan(phi_nW) at the point of load, phi_nL = t -
    (half angle of the tooth on its base circle); apex r_nb/cos(phi_nL). C_h = 1/(1 - sqrt(w (1 -
    w))), w = arctan(tan(psi) sin(phi_n)) in degrees over 100; K_psi = cos(psi_r) cos(psi), both 1
    for spur gears and m_F <= 1. Source: AGMA 908-B89, clause 5.
    """
    if load not in LOADS:
        raise ValueError(f"no load {load!r}; known: {', '.join(LOADS)}")
    pair = mesh.pair
    gear, mate = (virtual_gear(g) for g in pair.gears)
    base, mate_base = 0.5 * gear.base_diameter, 0.5 * mate.base_diameter
    angle = gear.rack.pressure_angle
    helix = pair.pinion.helix_angle
    base_helix = np.arcsin(np.sin(helix) * np.cos(angle))
    working = np.arcsin(np.cos(base_helix) * np.sin(pair.working_angle))
    at_tip = np.sqrt((0.5 * gear.active_tip_diameter / base) ** 2 - 1.0)
    mate_reach = signed(np.sqrt((0.5 * mate.active_tip_diameter) ** 2 - mate_base**2), mate_base)
    start = (base + mate_base) * np.tan(working) - mate_reach
    highest = (start + np.pi * np.cos(angle)) / base
    tangent = mesh.chosen(at_tip, highest) if load == "highest single" else at_tip
    load_angle = tangent - base_half_angle(gear)
    share = np.degrees(np.arctan(np.tan(np.abs(helix)) * np.sin(angle))) / 100.0
    slant = np.cos(np.arctan(np.tan(base_helix) / np.cos(pair.working_angle))) * np.cos(helix)
    helical = 1.0
    if mesh.regime in (None, "conventional"):  # the root of 0 has no derivative
        helical = mesh.chosen(1.0 / (1.0 - np.sqrt(share * (1.0 - share))), 1.0)
    return LoadedTooth(
        gear,
        mesh,
        load_angle,
        base / np.cos(load_angle),
        working,
        least_fillet_radius(gear),
        helical,
        mesh.chosen(slant, 1.0),
    )


def tangency(tooth: LoadedTooth, theta: Any, tip: ToolTip | None = None) -> Any:
    """Return 2 h_F sin(tau) - (s_F/2) cos(tau) [normal modules], 0 where the parabola is tangent.

    theta: tool angle of the point of the fillet; tip: `tool_tip` of the gear, if known; tau: slope
    of the fillet there. It is the stationarity of h_F/s_F^2 in theta, without its derivative:
    positive at the root circle, negative at the end of the fillet. Source: AGMA 908-B89, clause 5,
    y = 2 h_F tan(tau) - s_F/2.
    """
    return _tangency(tooth, theta, tool_tip(tooth.gear) if tip is None else tip)[0]


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def critical_theta(tooth: LoadedTooth) -> Any:
    """Return the tool angle theta [rad] at which the parabola touches the fillet.

    Floats or arrays of one shape. Where it touches only above the fillet (large tip radius of the
    tool, low load), the end of the fillet is the weakest section of it, and theta is alpha_n; 908's
    iteration would follow the round of the tool into its flank: J at most 0.5 % lower, so for 135
    teeth of 25 degrees loaded at the tip, 0.05 % at 20 degrees. NaN where the load passes so low
    that the parabola touches nothing.
    """
    angle = tooth.gear.rack.pressure_angle
    shape = np.shape(tooth.apex + angle)
    low, high = np.broadcast_to(angle, shape), np.full(shape, 0.5 * np.pi)
    start, tip = low, tool_tip(tooth.gear)
    above, below = tangency(tooth, low, tip) >= 0.0, tangency(tooth, high, tip) <= 0.0
    theta = 0.5 * (low + high)
    for _ in range(NEWTON):
        value, slope = _tangency(tooth, theta, tip)
        past = value > 0.0
        low, high = np.where(past, low, theta), np.where(past, theta, high)
        step = theta - value / slope
        theta = np.where((step < low) | (step > high), 0.5 * (low + high), step)
    return np.where(below, np.nan, np.where(above, start, theta))[()]


def _tangency(tooth: LoadedTooth, theta: Any, tip: ToolTip) -> tuple[Any, Any]:
    """Return `tangency` and its derivative by theta.

    The fillet turns by dtau = (1 + c/(r sin(theta)^2)) dtheta along ds = rho dtau + c^2/(r
    sin(theta)^3) dtheta (Euler and Savary), with dx = ds sin(tau), dy = -ds cos(tau).
    """
    point, radius = fillet_point(tooth.gear, theta, tip), 0.5 * tooth.gear.reference_diameter
    height, sine, cosine = tooth.apex - point.y, np.sin(point.slope), np.cos(point.slope)
    across = np.sin(theta)
    turn = 1.0 + tip.depth / (radius * across**2)
    along = tip.radius * turn + tip.depth**2 / (radius * across**3)
    value = 2.0 * height * sine - point.x * cosine
    return value, along * sine * cosine + turn * (2.0 * height * cosine + point.x * sine)


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def bending_factor(tooth: LoadedTooth, theta: Any) -> BendingFactor:
    """Return J = Y C_psi/(K_f m_N) at a tool angle theta [rad], that of `critical_theta`.

    Y = K_psi/((cos(phi_nL)/cos(phi_nr)) (6 h_F/(s_F^2 C_h) - tan(phi_nL)/s_F));
    K_f = H + (s_F/rho_F)^L (s_F/h_F)^M, H = 0.331 - 0.436 phi_n, L = 0.324 - 0.492 phi_n, M = 0.261
    + 0.545 phi_n (Dolan and Broghamer; phi_n of the tool). NaN where 908 has no answer: the radial
    part of the load outweighs bending, or a pointed tool does not cut the section.
    Source: AGMA 908-B89, clause 5; its tables are met within 0.007 (tests/physics/agma).
    """
    point = fillet_point(tooth.gear, theta)
    height, thickness = tooth.apex - point.y, 2.0 * point.x
    angle = tooth.gear.rack.pressure_angle
    direction = np.cos(tooth.load_angle) / np.cos(tooth.working_angle)
    pull = np.tan(tooth.load_angle) / thickness
    stress = 6.0 * height / (thickness**2 * tooth.helix_factor) - pull
    form = tooth.slant_factor / (direction * stress)
    exponents = 0.324 - 0.492 * angle, 0.261 + 0.545 * angle
    notch = (thickness / tooth.fillet_radius) ** exponents[0]
    concentration = 0.331 - 0.436 * angle + notch * (thickness / height) ** exponents[1]
    overlap = tooth.mesh.overlap_factor**0.5
    value = form * overlap / (concentration * tooth.mesh.sharing)
    if isinstance(value, float | np.ndarray):
        tip = tool_tip(tooth.gear)
        cut = tip.half_width + tip.radius * np.cos(theta) >= 0.0
        value = choose((stress > 0.0) & cut, value, np.nan)
    return BendingFactor(value, form, concentration, height, thickness)


def bending_factors(
    pair: GearPair, load: str = "highest single"
) -> tuple[BendingFactor, BendingFactor]:
    """Return J of pinion and wheel; floats or arrays of one shape."""
    mesh = mesh_of(pair)
    teeth = [loaded_tooth(m, load) for m in (mesh, seen_from_wheel(mesh))]
    thetas = critical_theta(teeth[0]), critical_theta(teeth[1])
    if is_internal(pair.wheel_teeth):
        tangent = 0.5 * np.pi - tangent_theta(teeth[1].gear)
        thetas = thetas[0], choose(np.less(pair.wheel_teeth, 0.0), tangent, thetas[1])
    first, second = (bending_factor(t, angle) for t, angle in zip(teeth, thetas, strict=True))
    return first, second


def thinned(pair: GearPair, thinning: Any) -> GearPair:
    """Return a pair whose teeth are thinner by Delta s_n [mm] each, through a deeper cut.

    AGMA 908-B89 takes 0.024 normal modules for its tables.
    """
    pinion, wheel = (replace(gear, thickness_allowance=-thinning) for gear in pair.gears)
    return GearPair(pinion, wheel, pair.working_distance)
