"""The train of a servo axis: chosen and proven, with its stiffness, its box and its neighbours."""

import math
from dataclasses import replace
from typing import Any

from gearopt.formulations import servo_box, split
from gearopt.optimise.progress import in_part
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run, solve
from gearopt.optimise.terms import Array
from gearopt.scenes.axis.choice import FRONT, SHOWN, box_of, front, posed
from gearopt.scenes.axis.gears import KG_M2, Gears, described, of_point
from gearopt.scenes.axis.ratio import scaled
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.tables.servo import Scene

STAGES = 6  # that a ratio is split into, at the most, for comparison


def train_part(scene: Scene, ask: Ask) -> tuple[Result, Gears | None]:
    """The certified best train."""
    assert scene.train is not None
    unit = SHOWN[scene.train.minimise][1]
    watch = in_part(ask.watch, unit)
    result, outcome = run(posed(scene), ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": unit})
    if result.value is None or outcome.x is None:
        return result, None
    gears = of_point(outcome.x)
    return replace(result, design={"train": described(scene, gears)}), gears


def neighbours(scene: Scene) -> list[dict[str, Any]]:
    """The trains that no other is better than in inertia, mass and error; thinned if many.

    One that is the best by two goals stands there twice, each time named by one of them.
    """
    import numpy as np

    found = front(scene)
    if found is None:
        return []
    points, worth = found
    best = worth.argmin(0).tolist()
    many = np.linspace(0, len(points) - 1, min(FRONT, len(points))).round().astype(int)
    shown = [(k, "") for k in many.tolist() if k not in best]
    shown += [(k, name) for k, name in zip(best, SHOWN, strict=True)]
    return [_neighbour(of_point(points[k]), worth[k], name) for k, name in sorted(shown)]


def _neighbour(gears: Gears, worth: Array, best_of: str) -> dict[str, Any]:
    inertia, mass, error = (float(v) for v in worth)
    return {
        "inertia_kg_m2": KG_M2 * inertia,
        "mass_kg": mass,
        "error_deg": math.degrees(error),
        "stages": [
            {"normal_module_mm": m, "pinion_teeth": z, "wheel_teeth": w}
            for m, z, w in zip(gears.modules, gears.pinions, gears.wheels, strict=True)
        ],
        "best_of": best_of,
    }


def beside(scene: Scene) -> dict[str, Any]:
    """What else is known of a train: real-valued bounds, the given gears, numbers of stages."""
    assert scene.train is not None
    train = scene.servo_train()
    report: dict[str, Any] = {}
    for goal, (factor, unit) in SHOWN.items():
        relaxed = solve(split.relaxation(train, goal))
        if relaxed.bound is not None:
            report[f"real_valued_bound_{goal}_{unit}"] = factor * relaxed.bound
    report["stage_counts"] = _counts(float(train.ratio)) if train.ratio > 1 else []
    report["stage_ratio_of_least_mass"] = split.lightest_stage_ratio()
    return report


def _counts(ratio: float) -> list[dict[str, Any]]:
    """Inertia and mass of the bare train in pinions, by number of stages."""
    rows = []
    pairs = (split.stage_counts(ratio, STAGES, goal) for goal in ("inertia", "mass"))
    for count, (inertia, mass) in enumerate(zip(*pairs, strict=True), 1):
        ratios = inertia.design["ratio"]
        rows.append(
            {
                "stages": count,
                "inertia_in_pinions": inertia.value,
                "mass_in_pinions": mass.value,
                "ratios_of_least_inertia": ratios if isinstance(ratios, list) else [ratios],
            }
        )
    return rows


def lightest_part(scene: Scene, ask: Ask) -> Result:
    """The lightest real-valued train that is stiff enough, in plain units."""
    watch = in_part(ask.watch, "kg", "stiff")
    result = solve(split.stiff(scene.stiff_train()), None, ask.budget, ask.seed, watch, ask.gap)
    return replace(scaled(result, 1.0, "kg"), name="stiff")


def box_part(scene: Scene, gears: Gears, ask: Ask) -> tuple[Result, dict[str, Any]]:
    """The smallest box of the train's proportions, and its part of the design."""
    box = box_of(scene, gears.point)
    watch = in_part(ask.watch, part="box")
    result, outcome = run(
        servo_box.problem(box), None, ask.budget, ask.seed, watch, max(ask.gap, servo_box.GAP)
    )
    result = replace(result, name="box", objective=result.objective | {"unit": ""})
    if outcome.x is None or result.value is None:
        return result, {}
    width, height = (float(side) for side in servo_box.extents(box, *outcome.x))
    return result, {
        "inner_width_mm": box.box[0],
        "inner_height_mm": box.box[1],
        "needed_width_mm": width,
        "needed_height_mm": height,
        "fits": result.value <= 1.0 + servo_box.TIE,
        "motor_angle_deg": math.degrees(outcome.x[0]),
        "output_angle_deg": math.degrees(outcome.x[1]),
        "radii_mm": list(box.radii),
        "links_mm": list(box.links),
        "hub_mm": box.hub,
        "half_sweep_deg": math.degrees(box.half_sweep),
    }
