"""Torsional compliance of shafts, meshes and of a train, and the frequencies that follow.

Springs in series add compliances [rad/(N mm)], so a rigid part is a plain 0. Arguments are floats,
arrays of one shape, or casadi scalars.
"""

import math
from collections.abc import Iterable
from typing import Any


def shaft_compliance(shear_modulus: Any, diameter: Any, length: Any) -> Any:
    """Return the torsional compliance 32 L/(pi G d^4) [rad/(N mm)] of a solid round shaft.

    shear_modulus G [MPa], diameter d [mm] > 0; length L [mm] >= 0. Source: Youn, eq. (13),
    corrected: the print has 2 for 32 with d called a diameter, which holds for the radius.
    """
    return 32.0 * length / (math.pi * shear_modulus * diameter**4)


def tooth_factor(form_factor: Any) -> Any:
    """Return Buckingham's factor Z = y/(0.242 + 7.25 y) of a tooth's stiffness.

    form_factor y: Lewis factor on the circular pitch, y = Y/pi (0.094 to 0.15 from 16 teeth up).
    Source: Youn, eq. (12); recalled there from Buckingham, whose mean is 0.111 for 20 degrees.
    """
    return form_factor / (0.242 + 7.25 * form_factor)


def lewis_form_factor(teeth: Any) -> Any:
    """Return Lewis's Y = pi (0.154 - 0.912/z) on the module, 20 degrees full depth, tip load.

    teeth z >= 12. The usual textbook fit; from 16 to 300 teeth it lies 0 to 9 % above the table of
    Shigley (0.296 at 16, 0.359 at 30, 0.422 at 60, 0.472 at 300): stresses come out that much less.
    """
    return math.pi * (0.154 - 0.912 / teeth)


def specific_pair_stiffness(
    pinion_modulus: Any, pinion_factor: Any, wheel_modulus: Any, wheel_factor: Any
) -> Any:
    """Return the stiffness k' [N/mm per mm of face width] of a pair of teeth, E Z in series.

    moduli E [MPa] > 0; factors Z of `tooth_factor`. About 1e4 N/mm per mm for steel spur gears.
    Source: Youn, eq. (12), corrected: without the factor 4, with y, not Y (see `mesh_compliance`).
    """
    return 1.0 / (1.0 / (pinion_modulus * pinion_factor) + 1.0 / (wheel_modulus * wheel_factor))


def mesh_compliance(line_stiffness: Any, face_width: Any, diameter: Any) -> Any:
    """Return the compliance 4/(k' b d^2) [rad/(N mm)] of a mesh, at its gear of diameter d.

    line_stiffness k' [N/mm per mm], face_width b, diameter d [mm] > 0. Source: Youn, eq. (12),
    corrected: the torque on a tangential spring has the lever r = d/2, so k' b r^2; the print's
    4 D^2 with D a radius would make steel teeth 4 times as stiff as they are.
    """
    return 4.0 / (line_stiffness * face_width * diameter**2)


def windup_variation(torque: Any, compliance: Any, variation: Any) -> Any:
    """Return T c v/(1 - v^2/4) [rad], by which the windup of a mesh of varying stiffness varies.

    torque T [N mm] at the gear of the compliance c [rad/(N mm)], which is that of the mean
    stiffness k; variation 0 <= v < 2: over a mesh the stiffness lies between k (1 - v/2) and
    k (1 + v/2). Peak to peak, T c/(1 - v/2) - T c/(1 + v/2).
    """
    return torque * compliance * variation / (1.0 - 0.25 * variation**2)


def output_compliance(compliances: Iterable[Any], downstream_ratios: Iterable[Any]) -> Any:
    """Return the compliance sum_i c_i/n_i^2 [rad/(N mm)] of springs in series, at the output.

    compliances c_i [rad/(N mm)] >= 0, each at its own shaft; downstream_ratios n_i: speed of that
    shaft over speed of the output. Source: Youn, eq. (11), with the reciprocal its print omits.
    """
    return sum(c / n**2 for c, n in zip(compliances, downstream_ratios, strict=True))


def locked_frequency(stiffness: Any, load_inertia: Any) -> Any:
    """Return the frequency sqrt(K/J_L)/(2 pi) [Hz] of the load on the train, motor locked.

    stiffness K [N mm/rad] at the load, load_inertia J_L [t mm2] > 0.
    """
    return (stiffness / load_inertia) ** 0.5 / (2.0 * math.pi)


def stiffness_of_frequency(frequency_Hz: Any, load_inertia: Any) -> Any:
    """Return the stiffness (2 pi f)^2 J_L [N mm/rad] for a frequency f, motor locked.

    frequency_Hz f [Hz], load_inertia J_L [t mm2].
    """
    return (2.0 * math.pi * frequency_Hz) ** 2 * load_inertia
