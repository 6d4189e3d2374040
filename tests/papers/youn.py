"""The printed data of Youn, and what the laws of gearopt make of it: angles, springs, masses.

Lengths mm, angles rad, forces N, inertias t mm2, unless a name says otherwise. Stage 12 is gears 1
and 2, at the motor; stage 34 is gears 3 and 4, at the load.
"""

import math
from typing import NamedTuple

from gearopt.physics.backlash import (
    backlash_angle,
    output_error,
    pitch_error_angle,
    radial_backlash,
)
from gearopt.physics.gears import disc_mass
from gearopt.physics.stiffness import (
    locked_frequency,
    mesh_compliance,
    output_compliance,
    shaft_compliance,
    specific_pair_stiffness,
    tooth_factor,
)

ALPHA = math.radians(20.0)
J_L, J_M = 19.8, 8.6e-3  # 1.98e-2 and 8.6e-6 N m s2
BOX = (80.0, 80.0, 130.0)
GF_CM = 9.80665e-2  # N mm
PER_CM2 = 98.0665e-6  # MPa of a gf/cm2
STEEL = 7.75e-9  # t/mm3, assumed


class Gear(NamedTuple):
    """A row of Tables 1 and 4."""

    teeth: int
    diameter: float
    weight_g: float


GEARS = (Gear(16, 8, 15), Gear(96, 48, 11), Gear(26, 13, 1.5), Gear(208, 104, 17.5))
WIDTH, SHAFT, E_PRINTED, G_PRINTED = 6.0, (8.0, 50.0), 1.97e9, 8.78e8  # Table 5, gf/cm2
E, G = E_PRINTED * PER_CM2, G_PRINTED * PER_CM2
RADIAL = {  # Table 2, in its order: stages 12 and 34
    "pinion reading": (0.0180, 0.0200),
    "wheel reading": (0.0240, 0.0270),
    "centre distance": (0.0042, 0.0054),
    "pinion bearing clearance": (0.0000, 0.0025),
    "wheel bearing clearance": (0.0025, 0.0030),
    "pinion bearing run-out": (0.0000, 0.0030),
    "wheel bearing run-out": (0.0025, 0.0040),
}
PITCH = (0.0290, 0.0330)  # Table 3
ANGLES = {  # sections 3 and 3.1, degrees
    "backlash of stage 12": "0.086",
    "backlash of stage 34": "0.044",
    "backlash at the output": "0.053",
    "pitch error of stage 12": "0.066",
    "pitch error of stage 34": "0.031",
    "pitch error at the output": "0.038",
    "both at the output": "0.091",
}
K_12, K_34, K_SHAFT, K_TS = 1.8e8, 3.8e8, 0.47e8, 1.17e6  # gf cm/rad, section 3.2
FITS = (2.0, 5.0), (0.0, 3.0)  # um, section 2.3: bearing in housing, on shaft
VARIATION = 0.5  # section 2.1, of the stiffness over a mesh
LOAD_GFCM = 4300.0  # 4.3 kgf cm
LOAD = LOAD_GFCM * GF_CM
ELASTIC, ELASTIC_AGAIN, SENSOR = 0.0037, 0.003, 0.0004  # called degrees
MEASURED, MEASURED_V = 0.06, 8e-3  # degrees, V
POTENTIOMETER = (10.0, 45.0)  # V, degrees, to either side
REFERENCES = {  # titles cited for eqs. (8) and (12), (13), and those that may have been meant
    4: "Load Capacity of a New W-N Gear with Basic Rack of Combined circular and Involute Profile",
    5: "Analysis and Synthesis of Circular Arc Gears by Interactive Graphics",
    6: "Precision Gearing : Theory and Practice",
    7: "Mechanical Engineering in Radar and Communications",
}
TABLE_4 = (48.0, 104.0, 8.0)  # wheels 2 and 4, ratio after stage 12
OTHER = (50.0, 122.0, 122.0 / 13.0)  # with which the printed angles come out
RADIAL_SUMS = tuple(math.fsum(row[k] for row in RADIAL.values()) for k in (0, 1))


def angles(wheel_2, wheel_4, downstream, pitch=PITCH):
    """The quantities of ANGLES [degrees] of two wheels and the ratio after stage 12."""
    wheels, ratios = (wheel_2, wheel_4), (downstream, 1.0)
    lost = [
        backlash_angle(radial_backlash(r, ALPHA), d)
        for r, d in zip(RADIAL_SUMS, wheels, strict=True)
    ]
    turned = [pitch_error_angle(p, d) for p, d in zip(pitch, wheels, strict=True)]
    found = [*lost, output_error(lost, ratios), *turned, output_error(turned, ratios)]
    values = [math.degrees(a) for a in (*found, found[2] + found[5])]
    return dict(zip(ANGLES, values, strict=True))


def window(name, at, text=None):
    """Ends of the quantity that gives an angle as printed, where it is inverse to it; at: now."""
    value, printed = angles(*OTHER)[name], float(text or ANGLES[name])
    return at * value / (printed + 5e-4), at * value / (printed - 5e-4)


def downstream_window(kind):
    """Ratios after stage 12 that give the printed output angle of a kind, with OTHER wheels."""
    made, printed = angles(*OTHER), float(ANGLES[f"{kind} at the output"])
    first, last = made[f"{kind} of stage 12"], made[f"{kind} of stage 34"]
    return first / (printed + 5e-4 - last), first / (printed - 5e-4 - last)


def between(z, low, high):
    """Linear in 1/z between two lines of a table of Lewis factors."""
    (z_low, y_low), (z_high, y_high) = low, high
    return y_high + (1 / z - 1 / z_high) / (1 / z_low - 1 / z_high) * (y_low - y_high)


LEWIS = (  # Y of gears 1 to 4, 20 degree full depth, from Shigley's table
    0.296,
    between(96, (75, 0.435), (100, 0.447)),
    0.346,
    between(208, (150, 0.460), (300, 0.472)),
)
PITCHES = {"y": 1.0 / math.pi, "Y": 1.0}  # on the circular pitch, on the module


def lines(pinion="y", wheel="y"):
    """Line stiffness [MPa] of stages 12 and 34 with either form of the Lewis factor."""
    kinds = (pinion, wheel, pinion, wheel)
    z = [tooth_factor(y * PITCHES[k]) for y, k in zip(LEWIS, kinds, strict=True)]
    return specific_pair_stiffness(E, z[0], E, z[1]), specific_pair_stiffness(E, z[2], E, z[3])


def rule(factor, gears, pinion="y", wheel="y"):
    """Mesh stiffnesses factor D^2 F E Z [gf cm/rad] of both stages; gears: D of which, from 0."""
    return tuple(
        factor * GEARS[g].diameter ** 2 * WIDTH * k / GF_CM
        for g, k in zip(gears, lines(pinion, wheel), strict=True)
    )


def springs(kind="y", shear=G):
    """Compliances [rad/(N mm)] of mesh 34, shaft 2, mesh 12, and their downstream ratios."""
    first, second = lines(kind, kind)
    parts = (
        mesh_compliance(second, WIDTH, GEARS[3].diameter),
        shaft_compliance(shear, *SHAFT),
        mesh_compliance(first, WIDTH, GEARS[1].diameter),
    )
    return parts, (1.0, 8.0, 8.0)


def chain(kind="y", shear=G):
    """Stiffness [N mm/rad] at the output, shares of the three springs, frequency [Hz]."""
    parts, ratios = springs(kind, shear)
    total = output_compliance(parts, ratios)
    shares = [c / n**2 / total for c, n in zip(parts, ratios, strict=True)]
    return 1.0 / total, shares, locked_frequency(1.0 / total, J_L)


def series(*stiffnesses):
    return 1.0 / math.fsum(1.0 / k for k in stiffnesses)


def shaft_stiffness(length=SHAFT[1], literal=False):
    """Eq. (13) for shaft 2 [gf cm/rad]; literal: as printed, with the diameter."""
    found = 1.0 / shaft_compliance(G, SHAFT[0], length) / GF_CM
    return 16.0 * found if literal else found


def measured(volts):
    """Degrees of a voltage on the potentiometer."""
    return volts * POTENTIOMETER[1] / POTENTIOMETER[0]


def weights():
    """Printed weight over that of a solid steel disc, of gears 1 to 4, and those discs [g]."""
    discs = [1e6 * disc_mass(STEEL, WIDTH, g.diameter) for g in GEARS]
    return [g.weight_g / w for g, w in zip(GEARS, discs, strict=True)], discs
