"""Results of kind servo on the numbers of Youn's gimbal drive, made by the formulations."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
from servo_tolerances import PRESSURE_ANGLE, TERMS
from servo_trains import PAPER

import gearopt
from gearopt.formulations.servo import ratio, servo_box, split, tolerance
from gearopt.formulations.servo.ratio import Drive, best_ratio
from gearopt.formulations.servo.servo_design import OBJECTIVES, Achieved
from gearopt.formulations.servo.split.servo_train import objectives, pairs
from gearopt.formulations.servo.tolerance.sampling import drawn
from gearopt.formulations.servo.tolerance.stack import (
    RUN_OUT,
    UNIFORM,
    Component,
    ErrorBudget,
    Stack,
)
from gearopt.optimise.solve import solve
from gearopt.optimise.typed import untyped
from gearopt.physics import stiffness
from gearopt.physics.loads import lewis_stress
from gearopt.physics.servo_drive import load_acceleration

INNER = (80.0, 130.0)  # mm
MOTOR, HUB, HALF_SWEEP = 12.0, 8.0, 90.0  # mm, mm, deg
LOAD, ROTOR = 19.8, 8.6e-3  # t mm2
TORQUE, LOAD_FRICTION, MOTOR_FRICTION = 50.0, 421.68595, 3.0  # N mm
WIDE = replace(PAPER, error=math.radians(0.12))
DRAWS = 40_000
GIVEN = 48.0


@cache
def ratio_part():
    """An independent computation: N* = 57.786211, a* = 47.287374, a(48) = 46.304224 rad/s2."""
    drive = Drive(LOAD, ROTOR, TORQUE, LOAD_FRICTION, MOTOR_FRICTION)
    best, most = best_ratio(drive)

    def law(n):
        net = TORQUE - MOTOR_FRICTION
        return load_acceleration(n, LOAD, ROTOR, net, LOAD_FRICTION)

    ends = np.geomspace(best / 5.0, best * 5.0, 200)
    ratios = np.unique([*ends, best])

    def achieved(n):
        lost = 100.0 * (1.0 - law(n) / most)
        inertias = LOAD / n**2 / ROTOR
        return Achieved(total_ratio=n, value=law(n), loss_percent=lost, inertia_ratio=inertias)

    return solve(ratio.acceleration(drive)), {
        "duty": "acceleration",
        "total_ratio": best,
        "value": most,
        "name": "load acceleration",
        "unit": "rad/s²",
        "given": untyped(achieved(GIVEN)),
        "best": untyped(achieved(best)),
        "curve": {"total_ratio": ratios.tolist(), "value": law(ratios).tolist()},
    }


@cache
def train_part():
    """Least inertia with an error of at most 0.12 deg: 17/91, 23/207, modules 0.3 and 0.5."""
    return solve(split.problem(WIDE))


def goals(point):
    gears = pairs([float(v) for v in point], WIDE.face_width)
    found = objectives(WIDE, OBJECTIVES, gears)
    return {
        "inertia_kg_m2": 1e-3 * found["inertia"],
        "mass_kg": found["mass"],
        "error_deg": math.degrees(found["error"]),
    }


def stages(point):
    z1, z3, z2, z4, m1, m2 = (float(v) for v in point)
    found = []
    torques = (WIDE.output_torque * z3 / z4, WIDE.output_torque)
    for m, pinion, wheel, torque in ((m1, z1, z2, torques[0]), (m2, z3, z4, torques[1])):
        factor = stiffness.lewis_form_factor(pinion)
        found.append(
            {
                "normal_module_mm": m,
                "pinion_teeth": int(pinion),
                "wheel_teeth": int(wheel),
                "ratio": wheel / pinion,
                "pinion_diameter_mm": m * pinion,
                "wheel_diameter_mm": m * wheel,
                "pinion_tip_diameter_mm": m * (pinion + 2),
                "wheel_tip_diameter_mm": m * (wheel + 2),
                "centre_distance_mm": 0.5 * m * (pinion + wheel),
                "face_width_mm": WIDE.face_width,
                "bending_stress_MPa": lewis_stress(torque, m * wheel, WIDE.face_width, m, factor),
            }
        )
    return found


def train(point):
    total = math.prod(s["ratio"] for s in stages(point))
    return {
        "stages": stages(point),
        "ratio": total,
        "ratio_error_percent": 100.0 * (total / 48.0 - 1.0),
        "sector": WIDE.sector,
    } | goals(point)


def front():
    """Trains of which none is better in inertia, mass and error, from neighbours of the best."""
    rows = [*split.trains(WIDE, math.radians(0.1))[::40]] + [
        solve(split.problem(WIDE, goal)).design for goal in OBJECTIVES
    ]
    points = [row if isinstance(row, np.ndarray) else point_of(row) for row in rows]
    told = [goals(p) for p in points]
    kept = [k for k, one in enumerate(told) if not any(dominates(other, one) for other in told)]
    found = []
    for k in kept:
        keys = ("normal_module_mm", "pinion_teeth", "wheel_teeth")
        few = [{key: s[key] for key in keys} for s in stages(points[k])]
        ratio = math.prod(s["ratio"] for s in stages(points[k]))
        found.append(told[k] | {"stages": few, "ratio": ratio, "best_of": ""})
    for goal, key in (("mass", "mass_kg"), ("error", "error_deg"), ("inertia", "inertia_kg_m2")):
        min(found, key=lambda row, key=key: row[key])["best_of"] = goal
    return found


def dominates(one, other):
    pairs = [(one[k], other[k]) for k in one]
    return all(a <= b for a, b in pairs) and any(a < b for a, b in pairs)


def point_of(design):
    return [*design["pinion_teeth"], *design["wheel_teeth"], *design["module_mm"]]


@cache
def tolerances_part(point):
    """Section 3c on the wheels of a train: the old worst case, mean + 3 sd within it."""
    d2, d4 = (pair.wheel.reference_diameter for pair in pairs(point))
    wheels = ((d2, point[3] / point[1]), (d4, 1.0))
    parts, rows = [], []
    for stage, (diameter, after) in enumerate(wheels, 1):
        for name, widths in TERMS.items():
            t = 1e-3 * widths[stage - 1]
            if t == 0.0:
                continue
            pitch = name == "pitch"
            per_mm = 2.0 if pitch else 4.0 * math.tan(PRESSURE_ANGLE)
            s = math.degrees(per_mm / (diameter * after))
            law = RUN_OUT if "run-out" in name else UNIFORM
            parts.append(Component(f"{name} of stage {stage}", s, t, 1.0, 0.25 * t, 4.0 * t, law))
            rows.append((stage, "pitch" if pitch else "backlash"))
    old = np.array([c.cost for c in parts])
    worst = sum(c.sensitivity * t for c, t in zip(parts, old, strict=True))
    stack = Stack(tuple(parts), (ErrorBudget("mean_plus_sd", worst, 3.0),))
    result = solve(tolerance.problem(stack))
    new = np.array(result.design["t_mm"])
    table = [
        {
            "name": c.name,
            "stage": stage,
            "kind": kind,
            "old_mm": float(t0),
            "new_mm": float(t),
            "lower_mm": c.least,
            "upper_mm": c.most,
            "sensitivity_deg_per_mm": c.sensitivity,
            "old_cost": 1.0,
            "new_cost": float(c.cost / t),
        }
        for c, (stage, kind), t0, t in zip(parts, rows, old, new, strict=True)
    ]
    return result, stack, new, table


def draws(stack, t, limit):
    return untyped(drawn(stack, t, limit, DRAWS))


def springs(point):
    """Section 3d: both meshes and the middle shaft, seen at the output, with k' = 10.3 GPa."""
    d2, d4 = (pair.wheel.reference_diameter for pair in pairs(point))
    n2 = point[3] / point[1]
    parts = {
        "mesh of stage 1": (stiffness.mesh_compliance(10.3e3, 6.0, d2), n2),
        "shaft between the stages": (
            stiffness.shaft_compliance(8.78e8 * 98.0665e-6, *WIDE.shaft),
            n2,
        ),
        "mesh of stage 2": (stiffness.mesh_compliance(10.3e3, 6.0, d4), 1.0),
    }
    seen = {name: c / n**2 for name, (c, n) in parts.items()}
    total = sum(seen.values())
    return {
        "output_Nm_per_rad": 1e-3 / total,
        "frequency_Hz": stiffness.locked_frequency(1.0 / total, LOAD),
        "windup_deg": math.degrees(LOAD_FRICTION * total),
        "springs": [
            {"name": name, "compliance_share": c / total, "referred_Nm_per_rad": 1e-3 / c}
            for name, c in seen.items()
        ],
    }


@cache
def box_part(point, half_sweep=HALF_SWEEP):
    """The smallest box of a train; 0.12 deg: 78.77 x 103.9 mm."""
    box = servo_box.of_train(
        pairs(point), servo_box.Room(MOTOR, HUB, math.radians(half_sweep), INNER)
    )
    result = solve(servo_box.problem(box))
    motor, output = (result.design[f"{k}_angle_rad"] for k in ("motor", "output"))
    width, height = servo_box.extents(box, motor, output)
    return result, {
        "inner_width_mm": INNER[0],
        "inner_height_mm": INNER[1],
        "needed_width_mm": float(width),
        "needed_height_mm": float(height),
        "fits": result.value <= 1.0,
        "motor_angle_deg": math.degrees(motor),
        "output_angle_deg": math.degrees(output),
        "radii_mm": list(box.radii),
        "motor_mm": MOTOR,
        "shaft_mm": 4.0,
        "links_mm": list(box.links),
        "hub_mm": HUB,
        "half_sweep_deg": half_sweep,
    }


def servo(point=None, half_sweep=HALF_SWEEP, **more):
    """Everything that a file can ask for, on the proven train of least inertia within 0.12 deg."""
    return replace(_whole(point, half_sweep), **more)


@cache
def _whole(point, half_sweep):
    best = train_part()
    point = point or tuple(point_of(best.design))
    allotted, stack, new, table = tolerances_part(point)
    budget = stack.budgets[0]
    boxed, box = box_part(point, half_sweep)
    chain, ratios = springs(point), ratio_part()
    sources = [
        {
            "source": row["name"],
            "kind": row["kind"],
            "stage": row["stage"],
            "tolerance_mm": row["old_mm"],
            "error_deg": row["sensitivity_deg_per_mm"] * row["old_mm"],
        }
        for row in table
    ]
    design = {
        "ratio": ratios[1],
        "train": train(point),
        "errors": sources,
        "tolerances": table,
        "allocation": {
            "budgets": [
                {
                    "rule": budget.rule,
                    "kappa": budget.kappa,
                    "limit_deg": budget.error,
                    "used_deg": float(stack.used(new)[0] * budget.error),
                }
            ],
            "cost": sum(row["new_cost"] for row in table),
            "old_cost": float(len(table)),
            "method": "exact",
        },
        "drawn": draws(stack, new, budget.error),
        "stiffness": chain,
        "box": box,
    }
    goal = goals(point)["inertia_kg_m2"]
    bound = None if best.bound is None else 1e-3 * best.bound
    parts = [
        named(ratios[0], "ratio", "inverse_acceleration", "s²/rad"),
        replace(
            best,
            name="train",
            objective={"name": "inertia", "value": goal, "unit": "kg_m2"},
            bound=bound,
        ),
        named(boxed, "box", "scale", ""),
        named(allotted, "tolerances", "cost", ""),
    ]
    told = {
        "name": "servo",
        "status": "optimal",
        "method": "exact",
        "objective": {"name": "inertia", "value": goal, "unit": "kg_m2"},
        "bound": bound,
        "gap": best.gap,
        "proof": best.proof,
        "certificate": best.certificate,
        "design": design,
        "limits": best.limits | {"box": boxed.value},
        "report": {
            "trains": front(),
            "best_total_ratio": ratios[1]["total_ratio"],
            "assumptions": ["Density, motor radius and costs are assumed, not those of the paper."],
            "notes": ["The last wheel is a sector: a full one does not fit."],
        },
        "parts": tuple(parts),
        "evaluations": best.evaluations,
        "seconds": best.seconds,
        "scene": "servo",
        "file": "youn.toml",
        "asked": {"title": "Gimbal drive"},
    }
    return gearopt.Result(**told)


def named(part, name, goal, unit):
    told = {"name": goal, "value": part.value, "unit": unit}
    return replace(part, name=name, objective=told)


def too_wide(**more):
    """The paper's own teeth, whose swept half disc needs 90.3 mm: it does not fit."""
    return servo((16, 26, 96, 208, 0.5, 0.5), **more)


def part_of(*keys, **more):
    """A result whose file asked for some of the tables only."""
    whole = servo()
    report = {k: v for k, v in whole.report.items() if k != "trains" or "train" in keys}
    design = {k: v for k, v in whole.design.items() if k in keys}
    return replace(whole, design=design, report=report, **more)
