"""Power lost by the sliding of teeth in one mesh: loss factor, coefficient of friction, efficiency.

Losses of bearings, seals and churned oil are others. Arguments are pairs of floats, arrays of one
shape or casadi scalars.
"""

from typing import Any

import numpy as np

from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.geometry.tooth import base_helix_angle

# Part by which a computed coefficient of friction, and so a loss, may be wrong: the largest of the
# differences found. Lubricant factors X_L in a program of authors who measured torque losses of
# gears (cfernandesFEUP/GEARpie: mineral oil 0.846, polyalphaolefin and ester 0.65, polyglycol
# 0.585) are 15 to 22 % below those of the formula (1, 0.8, 0.75: unverified). By local friction a
# loss was 30 % below the one by means over the mesh (J. Tribology 147, 112201, abstract: an
# internal gear). How far the tests scatter that the formula fits was not found: unverified.
FRICTION_ERROR = 0.3


def tooth_loss_factor(pair: GearPair) -> Any:
    """Return H_V = pi (u + 1)/(z_1 u cos(beta_b)) (1 - eps_alpha + eps_1^2 + eps_2^2).

    The power lost over power and coefficient of friction, for eps_alpha of 1 to 2, the pitch point
    between B and D, and a load that two pairs in contact share equally. eps_1, eps_2: parts of the
    contact ratio beyond and before the pitch point. Source: Ohlendorf, in Niemann and Winter and in
    two public programs (cfernandesFEUP/GEARpie; a gearbox model of FZG formulas); derived in
    tests/physics by integrating sliding over the path of contact.
    """
    path = contact_path(pair)
    beyond, before = path.end / path.base_pitch, -path.start / path.base_pitch
    shape = 1.0 - path.transverse_ratio + beyond**2 + before**2
    teeth = pair.pinion_teeth * pair.ratio * np.cos(base_helix_angle(pair.pinion))
    return np.pi * (pair.ratio + 1.0) / teeth * shape


def friction_coefficient(
    pair: GearPair, load: Any, speed: Any, viscosity: Any, roughness: Any, lubricant: Any = 1.0
) -> Any:
    """Return mu = 0.048 (F_bt/b/(v_SigmaC rho_C))^0.2 eta^-0.05 R_a^0.25 X_L, the mean of a mesh.

    load: tangential force at the working pitch circle [N]; speed: pitch line velocity v [mm/s];
    viscosity eta of the oil at its temperature [mPa s]; roughness R_a, mean of both gears [mm];
    lubricant X_L: 1 for mineral oils, 0.65 to 0.8 for polyalphaolefins, 0.6 to 0.75 for polyglycols
    (see FRICTION_ERROR). In the formula F_bt = load/cos(alpha_wt) per b in N/mm, v_SigmaC = 2 v
    sin(alpha_wt) in m/s, rho_C of both flanks at the pitch point, normal, in mm, R_a in um. A fit
    to tests of case-hardened gears; how far it may be off says FRICTION_ERROR.
    Source: Schlenk, in the two programs named in `tooth_loss_factor`.
    """
    angle = pair.working_angle
    line = load / np.cos(angle) / pair.face_width
    rolling = 2e-3 * speed * np.sin(angle)
    first, second = contact_path(pair).curvatures
    curvature = first * second / (first + second) / np.cos(base_helix_angle(pair.pinion))
    loaded = (line / (rolling * curvature)) ** 0.2
    return 0.048 * loaded * viscosity**-0.05 * (1e3 * roughness) ** 0.25 * lubricant


def mesh_efficiency(loss_factor: Any, friction: Any) -> Any:
    """Return 1 - mu H_V; loss_factor H_V, coefficient of friction mu."""
    return 1.0 - friction * loss_factor
