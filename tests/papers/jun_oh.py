"""Rows of the tables of docs/harmonic_drive.md, made by the program: tests ask for them there."""

from dataclasses import replace
from functools import cache

import numpy as np

from gearopt.formulations.strain_wave.cutter_fit import arc_edge, straight_edge
from gearopt.formulations.strain_wave.wave_sharing import shared, teeth_of
from gearopt.physics.strain_wave.clearance import (
    interference,
    teeth_within,
    tooth_arcs,
    tooth_clearances,
)
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import blank_profile, envelope, least_teeth
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.rim import Cup
from gearopt.physics.strain_wave.strength import contact_modulus, equal_share, hertz_pressure

BASE = StrainWave(0.5, 160, profile_shift=0.9)
CASES = {
    "base": BASE,
    "alpha 15, h_a 0.5": replace(BASE, pressure_angle=np.radians(15.0), addendum=0.5),
    "alpha 28": replace(BASE, pressure_angle=np.radians(28.0)),
    "320:1, m 0.2": replace(BASE, teeth=640, module=0.2, rim=1.6),
}
STEEL = contact_modulus((206e3, 206e3), (0.3, 0.3))
TORQUE, WIDTH = 1e5, 10.0  # N mm, mm


@cache
def base():
    return flank(BASE)


def row(*cells):
    return "| " + " | ".join(str(c) for c in cells) + " |"


def flank_rows():
    at = base().contacts
    for k in (0, 50, 100, 150, 200):
        radii = [1.0 / abs(c[k]) for c in (at.curvatures[1], at.curvatures[0], at.gap_curvature)]
        yield row(
            f"{np.degrees(at.motion.arc[k]):.4f}",
            f"{at.radius[k]:.4f}",
            f"{at.point.x[k]:.5f}",
            f"{at.point.y[k]:.5f}",
            *(f"{r:.4f}" for r in radii[:2]),
            f"{radii[2]:.2f}",
        )


def angle_rows():
    for angle in (8, 10, 12, 15, 20, 25, 28):
        made = flank(replace(BASE, pressure_angle=np.radians(angle)))
        gap = min(0.0, round(1e3 * interference(made, 0.25).least, 1))
        yield row(angle, f"{made.pairs_in_contact:.2f}", f"{gap:.1f}")


def clearance_row():
    found = 1e3 * tooth_clearances(base(), tooth_arcs(base(), np.arange(-5, 6)))
    return row("clearance um", *(f"{v:.1f}" for v in found))


def within_row():
    found = teeth_within(base(), np.array([1, 2, 5, 10, 20]) * 1e-3)
    return row("mean teeth", *(f"{v:.1f}" for v in found))


def stress(made, pairs):
    load = equal_share(TORQUE, made.gearing.base_radius, pairs) / WIDTH
    return float(hertz_pressure(load, STEEL, made.contacts.gap_curvature.max()))


def shift_rows():
    for x in (0.0, 0.6, 0.9, 1.2, 1.8):
        made = flank(replace(BASE, profile_shift=x))
        pairs = float(made.pairs_in_contact)
        radius = 1.0 / made.contacts.gap_curvature.max()
        yield row(
            x,
            f"{pairs:.3f}",
            f"{radius:.0f}",
            f"{stress(made, pairs):.1f}",
            f"{stress(made, np.floor(pairs)):.1f}",
        )


def cutter_rows():
    blank = blank_profile(base())
    for teeth in (np.inf, 100, 40, 20, 8):
        found = envelope(blank, 40.0, 0.25 * teeth)
        name = "rack" if np.isinf(teeth) else teeth
        yield row(name, f"{found.speeds.min():.3f}", "yes" if found.regular else "no: cusp")


def tooth_rows():
    blank = blank_profile(base())
    for pitch in (40.0, 40.148, 40.25, 40.5, 40.754):
        yield row(pitch, least_teeth(blank, pitch, 160))


def load_rows():
    for torque in (1, 5, 20, 50, 100, 200):
        cells = []
        for rim in (None, (Cup(), WIDTH)):
            own = teeth_of(base(), 1e5, rim)
            arms = np.full(len(own.gaps), own.arm)
            found = shared(own.compliance, own.gaps, arms, 500.0 * torque)
            cells += [found.carrying, f"{found.forces.max():.1f}", f"{1e3 * found.windup:.4f}"]
        yield row(torque, *cells)


def fit_rows():
    for name, gearing in CASES.items():
        edge = envelope(blank_profile(flank(gearing, 61)), gearing.blank_radius).profile.points
        line, arc = straight_edge(edge), arc_edge(edge)
        fixed = straight_edge(edge, np.radians(20.0))
        yield row(
            name,
            f"{np.degrees(line.angle):.3f}",
            f"{1e3 * line.deviation:.4f}",
            f"{1e3 * line.least_squares:.4f}",
            f"{arc.radius:.0f}",
            f"{1e3 * arc.deviation:.1e}",
            f"{1e3 * fixed.deviation:.2f}",
        )


if __name__ == "__main__":
    for made in (
        flank_rows(),
        angle_rows(),
        [clearance_row(), within_row()],
        shift_rows(),
        cutter_rows(),
        tooth_rows(),
    ):
        print("\n".join(made), end="\n\n")
