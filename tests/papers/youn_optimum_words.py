"""Sentences of docs/servo_train.md beside the paper's design, and what the examples rest on."""

import math
from dataclasses import replace

import numpy as np
from servo_tolerances import BASE, E_RSS, E_WC, components, stack
from servo_trains import PAPER, STIFF
from youn_optimum import (
    BARE,
    EXPONENTS,
    LIMITED,
    OWN,
    STEPS,
    best,
    cost,
    hertz,
    own_stiff,
    short_side,
    stiff_train,
    swept,
    values,
    widths,
    with_error,
)

from gearopt.formulations.servo import servo_box, split
from gearopt.formulations.servo.ratio import best_ratio
from gearopt.formulations.servo.split.servo_train import pairs
from gearopt.formulations.servo.tolerance.sampling import drawn
from gearopt.optimise.solve import solve

ROOM = servo_box.Room(12.0, 8.0, math.pi / 2, (80.0, 130.0))


def about_statistics():
    parts = components()
    s = np.array([c.sensitivity for c in parts]) * BASE
    mean, sd = (np.array([getattr(c.distribution, n) for c in parts]) for n in ("mean", "sd"))
    radial = np.array(["pitch" not in c.name for c in parts])
    one, wide = s @ mean, np.linalg.norm(s * sd)
    lash, spread = (s * mean)[radial].sum(), np.linalg.norm((s * sd)[radial])
    found = drawn(stack(("worst_case", E_WC)), BASE, E_WC)
    low, high = found.quantile_low_deg, found.quantile_high_deg
    return [
        f"mean {one:.4f}, standard deviation {wide:.4f}, mean + 3 of them {one + 3 * wide:.4f}, "
        f"worst case {s.sum():.4f} degrees",
        f"between {low:.4f} and {high:.4f} degrees (400,000 draws, 99 % confidence)",
        f"mean {lash:.4f}, mean + 3 standard deviations {lash + 3 * spread:.4f}, worst case "
        f"{s[radial].sum():.4f} degrees",
    ]


def about_ratio():
    inertia = 1e-4 * values(np.array([*OWN[0], *OWN[1]]))[0]
    n, a = best_ratio(replace(BARE, gear_inertia=inertia))
    return [
        f"{1e4 * inertia:.3f}e-7 kg m² at the motor, the best N is {n:.3f} and the acceleration "
        f"{100 * (1 - a / best_ratio(BARE)[1]):.1f} % less",
        "T_M = 50 N mm at standstill, F_M = 3 N mm and F_L = 4.3 kgf cm",
    ]


def about_split():
    even = split.core(48.0, 2).batch(np.array([[6.0, 8.0]])).F[0, 0]
    n = split.lightest_stage_ratio()
    own, lighter = (
        values(np.array([*OWN[0], *OWN[1]])),
        values(np.array([19, 29, 101, 263, 0.4, 0.4])),
    )
    return [
        f"The paper's 6 x 8 has {even:.4f}",
        f"stages of {n:.4f} would be lightest, {math.log(48.0) / math.log(n):.2f} of them",
        f"{100 * (1 - lighter[0] / own[0]):.0f} % less inertia and "
        f"{100 * (1 - lighter[1] / own[1]):.0f} % less mass",
        "with modules of 0.4 mm",
    ]


def about_box():
    assert short_side(63.0) <= 80.0 < short_side(63.1)
    small = best(servo_box.problem, in_box(17, 91, 23, 207, 0.3, 0.5)).report
    return [
        "fits up to 63.0 degrees to either side and not at 63.1: a travel of 45 degrees to "
        f"either side leaves a sector of {2 * (63.0 - 45.0):.0f} degrees",
        "of minimum J within 0.12 degrees fits, in "
        f"{small['width']:.1f} x {small['height']:.1f} mm",
    ]


def in_box(z1, z2, z3, z4, m1, m2):
    """A train of 90 degrees to either side, motor radius 12 and hub 8 mm, in 80 x 130 mm."""
    train = pairs((z1, z3, z2, z4, m1, m2))
    return servo_box.of_train(train, ROOM)


def about_tolerances():
    worst = cost(("worst_case", E_WC))
    wide = cost(("mean_plus_sd", E_WC), least=0.25, most=4.0)
    both = cost(("worst_case", E_WC), ("rss", 0.7 * E_RSS))
    loose = cost(("rss", E_WC))
    s = np.array([c.sensitivity for c in components()])
    found = drawn(stack(("worst_case", E_WC)), widths(wide), E_WC)
    return [
        f"E = {E_WC:.6f} degrees in the worst case, {E_RSS:.6f} as a root of the sum of squares",
        f"cost {100 * (1 - worst.value / 14):.0f} % less",
        f"Mean + 3 standard deviations within the same E, each tolerance 0.25 to 4 times the "
        f"paper's: {wide.value:.6f}; the worst case is then {s @ widths(wide):.4f} degrees, the "
        f"99.865 % quantile {found.quantile_low_deg:.4f} to {found.quantile_high_deg:.4f}",
        f"Both budgets, the second by 0.7: {both.value:.6f}",
        f"cost {loose.value:.6f}, but its worst case is {s @ widths(loose):.4f} degrees, "
        f"{s @ widths(loose) / E_WC:.1f} times as much",
    ]


def about_stiff():
    mass, frequency, error, inertia = own_stiff()
    same = best(split.stiff, stiff_train(stiffness=hertz(frequency), error=error, inertia=inertia))
    return [
        f"as stiff and as accurate as the paper's needs {100 * 1e3 * same.value / mass:.0f} % of "
        "its mass",
        f"k' = {1e-3 * STIFF.line_stiffness:g} N/(mm µm), J <= {1e4 * STIFF.inertia:.0f}e-7 "
        f"kg m², E <= {math.degrees(STIFF.error):.4f} degrees",
    ]


def assumptions():
    """What the examples rest on, from the data that the problems are given."""
    modules = ", ".join(f"{float(m):g}" for m in PAPER.modules)
    tips = " and ".join(f"{float(t):g}" for t in PAPER.wheel_tips)
    box = swept(90)
    return [
        f"steel of {1e9 * PAPER.density:g} g/cm³, modules {modules} mm, pinions of "
        f"{PAPER.pinion_teeth[0]} to {PAPER.pinion_teeth[1]} teeth, wheels up to "
        f"{PAPER.max_wheel_teeth}, gear 4 a quarter of a disc, {1e-3 * PAPER.output_torque:g} N m "
        f"peak at the output, {PAPER.bending:g} MPa by Lewis, D3 of {float(PAPER.bore):g} mm at "
        f"least, tip diameters of {tips} mm at most, N within "
        f"{100 * float(PAPER.tolerance):g} % of {float(PAPER.ratio):g}",
        "D2 and D4 of {:g} and {:g} mm at most".format(
            *(tip - 2.0 * STIFF.module for tip in STIFF.wheel_tips)
        ),
        f"D1 of {STIFF.module * STIFF.pinion_teeth[0]:g} mm at least",
        "D3 at least {:g} mm and {:g} mm above shaft 2".format(*STIFF.bore),
        f"widths of {STIFF.face_width:g} and shaft of {STIFF.shaft_diameter:g} mm at least",
        "N of {:g} to {:g}, Lewis factors of {} and {} teeth".format(
            *STIFF.ratio, *STIFF.pinion_teeth
        ),
        "in the face of {:g} x {:g} mm".format(*box.box),
        f"motor of radius {box.radii[0]:g}, hub of {box.hub:g} mm",
        "in {:g} x {:g} |".format(*box.box),
        f"With {math.degrees(box.half_sweep):g} degrees to either side",
        f"motor at {LIMITED.speed_limit:g} rad/s at most",
        f"The {len(components())} tolerances above 0 of",
        f"each costs (t0/t)^k, {len(components())} together as in the paper",
        f"solid discs of one width, N = {48:g}, in terms of one pinion",
        f"The grades are t0 times powers of the root of 2, from 1/{1 / STEPS[0]:.0f} to "
        f"{STEPS[-1]:.0f}. At k = {EXPONENTS[1]:g} the same",
    ]


def counted(error):
    """How many trains keep an error limit [degrees], of how many of the right ratio."""
    proof = solve(split.problem(with_error(error)), "enumeration").proof
    return proof["feasible_trains"], proof["trains_looked_at"]


def fitting():
    """The train of minimum error that fits the box with 90 degrees to either side."""
    wide = with_error(0.1172)
    found = split.trains(wide, wide.error)
    boxes = (servo_box.of_train(pairs(x), ROOM) for x in found)
    place, _ = servo_box.first_that_fits(boxes)
    return found[place]
