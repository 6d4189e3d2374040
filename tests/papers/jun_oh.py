"""Rows of the tables of docs/harmonic_drive.md, made by the program: tests ask for them there."""

from dataclasses import replace
from functools import cache

import numpy as np

from gearopt.bench import curvature, wave_cutter
from gearopt.formulations.strain_wave.cutter_fit import arc_edge, straight_edge
from gearopt.formulations.strain_wave.cutter_report import DEFORMED, MODIFIED, Cutter
from gearopt.formulations.strain_wave.demand import Duty, equal_pressure, shared_pressure
from gearopt.formulations.strain_wave.hob_report import hob_design
from gearopt.formulations.strain_wave.sharing import shared, teeth_of
from gearopt.formulations.strain_wave.shift import largest_addendum, last_shift_of_one_pair
from gearopt.physics.strain_wave.clearance import (
    interference,
    teeth_within,
    tooth_arcs,
    tooth_clearances,
)
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import blank_profile, envelope, least_teeth
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.neutral_curve import neutral_curve
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
DUTY = Duty(TORQUE, WIDTH, (206e3, 206e3), (0.3, 0.3), 1e5, Cup(), elastic=False)


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


def wave_rows():
    for wave, name in (("cosine", "cos 2 phi"), ("ellipse", "ellipse"), ("discs", "two discs")):
        made = flank(replace(BASE, wave=wave))
        radius = 1.0 / made.contacts.gap_curvature.max()
        yield row(name, f"{radius:.0f}", f"{made.pairs_in_contact:.3f}")


def angle_rows():
    for angle in (8, 10, 12, 15, 20, 25, 28):
        made = flank(replace(BASE, pressure_angle=np.radians(angle)))
        gap = min(0.0, round(1e3 * interference(made, 0.25).gap, 1))
        yield row(angle, f"{made.pairs_in_contact:.2f}", f"{gap:.1f}")


def clearance_rows():
    for n in (0, 1, 2, 3, 4, 5, 6, 8, 10):
        found = 1e3 * tooth_clearances(base(), tooth_arcs(base(), np.array([-n, n])))
        yield row(n, *(f"{v:.1f}" for v in found))


def within_row():
    found = teeth_within(base(), np.array([0.5, 1, 2, 5, 10, 20]) * 1e-3)
    return row("mean teeth", *(f"{v:.1f}" for v in found))


def addendum_rows():
    for x in (0.0, 0.5, 0.9, 1.5):
        found = largest_addendum(replace(BASE, profile_shift=x))
        made = flank(replace(BASE, profile_shift=x, addendum=found))
        yield row(x, f"{found:.2f}", f"{made.pairs_in_contact:.2f}")


def deflection_rows():
    for w in (0.95, 0.98, 1.02, 1.05, 1.1):
        run = replace(BASE, deflection=w, neutral=BASE.neutral_radius)
        gap = interference(replace(base(), gearing=run, curve=neutral_curve(run)), 0.1).gap
        yield row(w, f"{1e3 * gap:.1f}")


def made_for_rows():
    for w in (0.9, 1.0, 1.1, 1.2, 1.3, 1.5):
        made = flank(replace(BASE, deflection=w))
        arc = np.degrees(made.contacts.motion.arc[[0, -1]])
        gap = min(0.0, round(1e3 * interference(made, 0.25).gap, 1))
        radius = 1.0 / made.contacts.gap_curvature.max()
        yield row(w, f"{arc[0]:.2f} to {arc[1]:.2f}", f"{radius:.0f}", f"{gap:.1f}")


def ratio_rows():
    for ratio in (30, 50, 80, 100, 160, 320):
        made = flank(replace(BASE, teeth=2 * ratio, module=40.0 / ratio))
        radius = 1.0 / made.contacts.gap_curvature.max()
        blank = blank_profile(made)
        edge = envelope(blank, made.gearing.blank_radius).profile.points
        lean = np.degrees(np.arctan(-np.polyfit(edge.x, edge.y, 1)[0]))
        stresses = equal_pressure(DUTY, made), shared_pressure(DUTY, made)
        yield row(
            ratio,
            f"{made.pairs_in_contact:.3f}",
            f"{radius:.0f}",
            *(f"{s:.1f}" for s in stresses),
            f"{lean:.2f}",
        )


def stress(made, pairs):
    load = equal_share(TORQUE, made.gearing.base_radius, pairs) / WIDTH
    return float(hertz_pressure(load, STEEL, made.contacts.gap_curvature.max()))


def shift_rows():
    for x in (0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8):
        made = flank(replace(BASE, profile_shift=x))
        held = flank(replace(BASE, profile_shift=x, neutral=40.0))
        pairs = float(made.pairs_in_contact)
        stresses = (
            stress(made, pairs),
            stress(made, np.floor(pairs)),
            shared_pressure(DUTY, made),
            stress(held, float(held.pairs_in_contact)),
        )
        radius = 1.0 / made.contacts.gap_curvature.max()
        yield row(x, f"{pairs:.3f}", f"{radius:.0f}", *(f"{s:.1f}" for s in stresses))


def one_pair_rows():
    for addendum in (0.52, 0.55, 0.58, 0.6):
        last = last_shift_of_one_pair(replace(BASE, addendum=addendum))
        yield row(addendum, f"{last:.2f}")


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
        edge = envelope(blank_profile(flank(gearing, 301)), gearing.blank_radius).profile.points
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


HOBS = (  # case, tool angle in degrees, tip reliefs in um
    ("base", 20.0, (0.0, 1.0)),
    ("alpha 15, h_a 0.5", 15.0, (0.0, 8.0)),
    ("alpha 28", 28.0, (0.0,)),
    ("alpha 28", 20.0, (0.0,)),
    ("320:1, m 0.2", 20.0, (0.0,)),
)


def hob_rows():
    for case, angle, reliefs in HOBS:
        conjugate = flank(CASES[case])
        ways = [(DEFORMED, 0.0), *((MODIFIED, 1e-3 * um) for um in reliefs)]
        for generation, relief in ways:
            asked = Cutter(angle=np.radians(angle), generation=generation, relief=relief)
            exact, cut = hob_design(DUTY, conjugate, asked).forms
            if generation == DEFORMED and (case, angle) != ("alpha 28", 20.0):
                yield hob_row(case, "", "conjugate", exact)
            name = generation + (f", relief {1e3 * relief:g}" if relief else "")
            yield hob_row(case, f"{angle:g}", name, cut)


def hob_row(case, angle, name, form):
    lengths = form.deviation_mm, form.least_clearance_mm, form.play_mm
    pressure = form.shared_pressure_MPa
    return row(
        *(case, angle, name),
        *(f"{1e3 * v:.{3 if abs(v) < 1e-5 else 2}f}" for v in lengths),
        *(f"{n:.1f}" for n in (form.near, form.nearby, form.effective_teeth)),
        f"{form.windup_mrad:.4f}",
        f"{form.at_ends:.0f}",
        "" if pressure is None else f"{pressure:.1f}",
    )


def construction_rows():
    """Without the last column, which is time."""
    for found in wave_cutter._rolled(blank_profile(flank(BASE, 401)), 1):
        error = found["error_um"]
        yield row(found["edge"], found["steps"], f"{error:.1f}" if error > 1.0 else f"{error:.2g}")


def curvature_rows():
    """Without the last column, which is time."""
    shown = {("", ""), ("exact", 51), ("1 nm", 51), ("1 nm", 201), ("0.1 um", 201)}
    for found in curvature.run(1):
        if (found["data"], found["points"]) in shown:
            points = f"{found['points']}, {found['data']}" if found["data"] else ""
            errors = (told(found[k], found["wrong_sign"]) for k in ("curvature", "radius", "p0"))
            yield row(found["method"], points, *errors, found["wrong_sign"])


def told(error, wrong):
    """A relative error; useless where 1/R has the wrong sign at some stations."""
    if wrong or error >= 1.0:
        return "useless"
    below = [bound for bound in ("1e-11", "1e-7") if error < float(bound)]
    return f"< {below[0]}" if below else f"{error:.2g}"


if __name__ == "__main__":
    for rows in (
        *(
            flank_rows,
            wave_rows,
            clearance_rows,
            angle_rows,
            addendum_rows,
            deflection_rows,
            made_for_rows,
        ),
        *(ratio_rows, shift_rows, one_pair_rows, load_rows, cutter_rows, tooth_rows, fit_rows),
        *(construction_rows, curvature_rows),
    ):
        print(rows.__name__, *rows(), sep="\n", end="\n\n")
    print(within_row())
