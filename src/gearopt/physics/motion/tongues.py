"""Where a periodic mesh stiffness makes a pair unstable, to first order: tongues of resonance.

k = mean (1 + sum of a_l cos(2 pi l f t)). A tongue begins at l f = 2 f_p of a mode p, or at
l f = f_p + f_q of two (combination), and widens with a_l.
"""

import math
from dataclasses import dataclass

from gearopt.physics.motion.linear import Linear, mesh_shares, modes
from gearopt.physics.motion.stiffness_wave import Wave


@dataclass(frozen=True)
class Tongue:
    """A tongue: modes p <= q (from 1), harmonic l, mesh frequency f [Hz] at its tip.

    half_width: of f, relative, without damping; damping: the modal damping ratio above which there
    is none (of p = q; for a combination that of both modes).
    """

    modes: tuple[int, int]
    harmonic: int
    frequency: float
    half_width: float
    damping: float


def tongues(system: Linear, wave: Wave, harmonics: int) -> list[Tongue]:
    """Return the tongues of all modes and sums of two modes, the widest first.

    p = q: half width and critical damping are kappa_p a_l/4, kappa_p the strain energy share of the
    mesh. p < q: half width in 2 pi l f is mean a_l |w'phi_p w'phi_q|/(2 sqrt(omega_p omega_q)).
    Amplitudes a_l = 2 |c_l|/mean of the wave. To first order in a_l: where harmonics of a wave act
    together (a_1 with a_2 on l = 3), or tongues overlap, they may be wider. Differences of two
    frequencies are stable, as the coupling is symmetric.
    """
    mean, found = wave.mean, modes(system, wave.mean)
    along, omega = system.direction @ found.shapes, found.frequencies
    kappa, made = mesh_shares(system, mean), []
    for order, c in enumerate(wave.harmonics(harmonics)[1:], 1):
        a = 2.0 * abs(c) / mean
        for p in range(omega.size):
            for q in range(p, omega.size):
                total = omega[p] + omega[q]
                if p == q:
                    width = damping = kappa[p] * a / 4.0
                else:
                    root = math.sqrt(omega[p] * omega[q])
                    width = mean * a * abs(along[p] * along[q]) / (2.0 * root) / total
                    damping = width * total / (2.0 * root)
                made.append(
                    Tongue((p + 1, q + 1), order, total / (2.0 * math.pi * order), width, damping)
                )
    return sorted(made, key=lambda t: -t.half_width)
