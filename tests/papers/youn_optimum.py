"""Rows of docs/servo_train.md beside the paper's design: what gearopt finds, and its proofs.

Each function of rows gives a table's lines as they stand in the page.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import youn
from servo_tolerances import BASE, E_RSS, E_WC, components, stack
from servo_trains import PAPER, STIFF

from gearopt.formulations.servo import servo_box, split, tolerance
from gearopt.formulations.servo.ratio import Drive, acceleration, best_ratio, least_move_time
from gearopt.formulations.servo.servo_box import ServoBox
from gearopt.formulations.servo.tolerance import grades
from gearopt.optimise.solve import solve
from gearopt.physics.servo_drive import load_acceleration, shortest_move_time, torque_slope
from gearopt.physics.stiffness import stiffness_of_frequency

BARE = Drive(youn.J_L, youn.J_M, torque=50.0)
BRAKED = replace(BARE, motor_friction=3.0)
REAL = replace(BRAKED, load_friction=youn.LOAD)
LINE = replace(REAL, no_load_speed=800.0)
LIMITED = replace(BARE, speed_limit=800.0)
CASES = (
    ("no friction, as the paper", BARE, 0.0),
    ("F_M", BRAKED, 0.0),
    ("F_M and F_L", REAL, 0.0),
    ("the same, efficiency 0.9", replace(REAL, efficiency=0.9), 0.0),
    ("F_M and F_L, load at 5 rad/s, torque falling to 0 at 800 rad/s", LINE, 5.0),
)
OWN = ((16, 26, 96, 208), (0.5, 0.5))
GOALS = (  # error limit [degrees], goal, how it reads
    (0.1082, "inertia", "minimum J (and minimum mass), E <= 0.1082"),
    (0.12, "inertia", "minimum J, E <= 0.12"),
    (0.12, "mass", "minimum mass, E <= 0.12"),
    (0.12, "error", "minimum E"),
)
SWEEPS = (45, 60, 65, 90)
EXPONENTS = (0.5, 1.0, 2.0)
STEPS = np.sqrt(2.0) ** np.arange(-4, 5)
FREQUENCIES = (150.0, 200.0, 250.0, 300.0)


@cache
def best(problem_of, *given):
    """A proven optimum, within 1e-6 of its bound at least."""
    result = solve(problem_of(*given))
    assert result.status == "optimal" and result.gap < 1e-6
    return result


def at(drive, load_speed, ratio):
    """Acceleration of the load [rad/s2] at a ratio."""
    slope = torque_slope(drive.torque, load_speed, drive.no_load_speed)
    numbers = drive.load_inertia, drive.inertia, drive.net_torque, drive.load_friction
    return load_acceleration(ratio, *numbers, drive.efficiency, slope)


def ratio_rows():
    found = []
    for name, drive, speed in CASES:
        result = best(acceleration, drive, speed)
        n, a = result.design["ratio"], 1.0 / result.value
        found.append(f"| {name} | {n:.4f} | {a:.4f} | {at(drive, speed, 48.0):.4f} |")
    return found


def move_time_at(ratio, turn):
    """Return the minimum time [s] of a turn [rad] at a ratio, motor at 800 rad/s at most."""
    return shortest_move_time(turn, 800.0 / ratio, at(LIMITED, 0.0, ratio))


def move_rows():
    found = []
    for name, turn in (("90", 0.5), ("1080", 6.0), ("10800", 60.0)):
        result = best(least_move_time, LIMITED, turn * math.pi)
        beside = move_time_at(best_ratio(BARE)[0], turn * math.pi)
        n = result.design["ratio"]
        found.append(f"| {name} degrees | {n:.4f} | {result.value:.6f} | {beside:.6f} |")
    return found


@cache
def stages(count, goal="inertia"):
    return best(split.core, 48.0, count, goal)


def stage_rows():
    found = []
    for count in range(1, 7):
        ratios = np.atleast_1d(stages(count).design["ratio"])
        shown = " x ".join(f"{n:.3f}" for n in ratios)
        mass = stages(count, "mass").value
        found.append(f"| {count} | {shown} | {stages(count).value:.4f} | {mass:.3f} |")
    return found


def with_error(degrees):
    return replace(PAPER, error=math.radians(degrees))


def values(point):
    """Inertia [1e-7 kg m2], mass [g], error [degrees] of a train's point."""
    inertia, mass, error = split.problem(PAPER, "inertia", "mass", "error").batch(point[None]).F[0]
    return 1e4 * inertia, 1e3 * mass, math.degrees(error)


def shown(inertia, mass, error):
    return f"{inertia:.3f} | {mass:.1f} | {error:.5f}"


def design_rows():
    own = values(np.array([*OWN[0], *OWN[1]]))
    found = [f"| the paper's | 16/96, 26/208 | 0.5, 0.5 | {shown(*own)} | |"]
    for error, goal, name in GOALS:
        result = best(split.problem, with_error(error), goal)
        (z1, z3), (z2, z4) = result.design["pinion_teeth"], result.design["wheel_teeth"]
        m = result.design["module_mm"]
        made = values(np.array([z1, z3, z2, z4, *m], float))
        if "(and minimum mass)" in name:
            lightest = best(split.problem, with_error(error), "mass")
            assert lightest.design["wheel_teeth"] == [z2, z4]
            assert 1e3 * lightest.value == pytest.approx(made[1], rel=1e-12)
        bound = best(split.relaxation, with_error(error), goal).bound
        least = {
            "inertia": f"J {1e4 * bound:.3f}",
            "mass": f"mass {1e3 * bound:.2f}",
            "error": f"E {math.degrees(bound):.5f}",
        }[goal]
        found.append(
            f"| {name} | {z1}/{z2}, {z3}/{z4} | {m[0]:g}, {m[1]:g} | {shown(*made)} | {least} |"
        )
    return found


def swept(half_sweep, tip=52.5):
    """The paper's geometry with a motor of radius 12 and a hub of 8 mm; half_sweep [degrees]."""
    radii = (12.0, 24.5, tip)
    return ServoBox(radii, (28.0, 58.5), 8.0, math.radians(half_sweep), (80.0, 130.0))


def short_side(half_sweep):
    """Short side [mm] of the smallest box of 80:130."""
    return 80.0 * best(servo_box.problem, swept(half_sweep)).value


def box_rows():
    found = []
    for half in (*SWEEPS, 180):
        side = short_side(half)
        name = "full wheel" if half == 180 else f"{half} degrees to either side"
        fits = "fits" if side <= 80.0 else "does not fit"
        found.append(f"| {name} | {side:.2f} | {130.0 / 80.0 * side:.2f} | {fits} |")
    return found


@cache
def cost(*budgets, **given):
    """Return the minimum cost of tolerances within budgets; each of the paper's costs 1."""
    return best(tolerance.problem, stack(*budgets, **given))


def widths(result):
    return np.array(result.design["t_mm"])


def cost_rows():
    found = []
    for k in EXPONENTS:
        both = [cost((rule, e), k=k).value for rule, e in (("worst_case", E_WC), ("rss", E_RSS))]
        found.append(f"| {k:g} | {both[0]:.6f} | {both[1]:.6f} |")
    both = [cost((r, e), k=(0.5, 2.0)).value for r, e in (("worst_case", E_WC), ("rss", E_RSS))]
    found.append(f"| 0.5 and 2 in turn | {both[0]:.6f} | {both[1]:.6f} |")
    both = [graded(rule, e) for rule, e in (("worst_case", E_WC), ("rss", E_RSS))]
    found.append(f"| 1, nine grades only | {both[0]:.6f} | {both[1]:.6f} |")
    return found


@cache
def graded(rule, error):
    """Return the minimum cost of grades t0 sqrt(2)^(-4..4) that cost t0/t."""
    parts = tuple(
        grades.Graded(c.name, c.sensitivity, tuple((float(t0 * g), float(1 / g)) for g in STEPS))
        for c, t0 in zip(components(), BASE, strict=True)
    )
    return best(grades.problem, grades.Choice(parts, error, rule)).value


def moved_rows():
    """How the worst case at k = 1 shares the same error anew [um]."""
    t = 1e3 * widths(cost(("worst_case", E_WC)))
    found = []
    for name in ("pinion reading", "wheel reading", "pitch"):
        cells = []
        for stage in ("12", "34"):
            k = [c.name for c in components()].index(f"{stage} {name}")
            cells.append(f"{1e3 * BASE[k]:.0f} | {t[k]:.1f}")
        found.append(f"| {name} | {' | '.join(cells)} |")
    return found


def stiff_train(**changes):
    return replace(STIFF, **changes)


def own_stiff():
    """Mass [g], frequency [Hz], error [rad] and inertia [t mm2] of the paper's sizes."""
    batch = split.stiff(STIFF).batch(np.array([[8.0, 13.0, 6.0, 8.0, 6.0, 6.0, 8.0]]))
    names = [row.name for row in split.stiff(STIFF).rows.inequalities]
    use = dict(zip(names, batch.G[0], strict=True))
    f = math.sqrt(1.0 / use["stiffness"] / youn.J_L) / (2.0 * math.pi)
    return 1e3 * batch.F[0, 0], f, use["error"] * STIFF.error, use["inertia"] * STIFF.inertia


def stiff_rows():
    mass, frequency, error, inertia = own_stiff()
    paper = "8 | 13.00 | 6.0000 | 8.0000 | 6.00 | 6.00 | 8.00"
    found = [f"| the paper's sizes, {frequency:.1f} Hz | {mass:.2f} | {paper} |"]
    cases = [(f"{f:.0f} Hz", stiff_train(stiffness=hertz(f))) for f in FREQUENCIES]
    same = stiff_train(stiffness=hertz(frequency), error=error, inertia=inertia)
    for name, train in [("its frequency, E and J", same), *cases]:
        result = best(split.stiff, train)
        design = result.design
        (d1, d3), (n1, n2) = design["pinion_diameter_mm"], design["ratio"]
        b1, b2 = design["face_width_mm"]
        found.append(
            f"| {name} | {1e3 * result.value:.2f} | {d1:.3g} | {d3:.2f} | {n1:.4f} | {n2:.4f} "
            f"| {b1:.2f} | {b2:.2f} | {design['shaft_diameter_mm']:.2f} |"
        )
    return found


def hertz(frequency):
    return stiffness_of_frequency(frequency, youn.J_L)
