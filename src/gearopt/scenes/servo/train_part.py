"""The train of a servo axis: chosen and proven, with its stiffness, its box and its neighbours."""

import math
from dataclasses import replace
from typing import Any

from gearopt.formulations.servo import servo_box, split
from gearopt.formulations.servo.ratio import ServoDuty
from gearopt.optimise.clock import Clock, in_part
from gearopt.optimise.result import Result
from gearopt.optimise.solve import run, solve
from gearopt.optimise.terms import Array
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.servo.achieved import NAMES
from gearopt.scenes.servo.choice import FRONT, SHOWN, box_of, front, posed, weighed
from gearopt.scenes.servo.gears import Gears, described, of_point
from gearopt.scenes.servo.key_figures import GOALS
from gearopt.scenes.servo.ratio_part import scaled
from gearopt.scenes.servo.scene import Scene

WORDS = {  # objectives as a list of trains calls them
    "inverse_acceleration": "acceleration",
    "move_time": "move time",
    "rms_torque": "rms torque",
}
STAGES = 6  # that a ratio is split into, at the most, for comparison


def train_part(scene: Scene, ask: Ask) -> tuple[Result, Gears | None]:
    """The certified best train."""
    assert scene.train is not None
    unit = SHOWN[scene.train.goal][1]
    watch = in_part(ask.watch, unit)
    result, outcome = run(posed(scene), ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": unit})
    if result.value is None or outcome.x is None:
        return result, None
    gears = of_point(outcome.x)
    return replace(result, design={"train": described(scene, gears)}), gears


def neighbours(scene: Scene, clock: Clock) -> list[dict[str, Any]]:
    """The trains that no other is better than in all that is weighed; none if time is up.

    Thinned if many. One that is the best by two goals stands there twice, each time named by one
    of them.
    """
    import numpy as np

    found = front(scene, clock)
    if found is None:
        return []
    points, worth = found
    best = worth.argmin(0).tolist()
    many = np.linspace(0, len(points) - 1, min(FRONT, len(points))).round().astype(int)
    shown = [(k, "") for k in many.tolist() if k not in best]
    shown += [(k, name) for k, name in zip(best, weighed(scene), strict=True)]
    return [
        _neighbour(scene, of_point(points[k]), float(worth[k, 0]), name)
        for k, name in sorted(shown)
    ]


def _neighbour(scene: Scene, gears: Gears, first: float, best_of: str) -> dict[str, Any]:
    """A train as the list shows it; first: what it is weighed by first."""
    train, duty = described(scene, gears), scene.servo_duty()
    found = {key: train[key] for key in (*GOALS.values(), "ratio") if key in train}
    if duty is not None and weighed(scene)[0] == duty.goal:
        value = SHOWN[duty.goal][0] * first
        found[NAMES[duty.motion][2]] = 1.0 / value if duty.motion == "acceleration" else value
    return found | {
        "stages": [
            {"normal_module_mm": m, "pinion_teeth": z, "wheel_teeth": w}
            for m, z, w in zip(gears.modules, gears.pinions, gears.wheels, strict=True)
        ],
        "best_of": WORDS.get(best_of, best_of),
    }


def beside(scene: Scene, chosen: Gears | None) -> dict[str, Any]:
    """What else is known of a train: real-valued bounds, and other numbers of stages.

    These are of the ratio that is asked for, or of the chosen train where a range is.
    """
    assert scene.train is not None
    train = scene.servo_train()
    report: dict[str, Any] = {}
    for goal in dict.fromkeys(("inertia", *weighed(scene))):
        if (bound := solve(split.relaxation(train, goal)).bound) is not None:
            report |= _bound(goal, bound, train.duty)
    low, high = scene.train.ratio
    ratio = float(low) if low == high else 1.0 if chosen is None else math.prod(chosen.ratios)
    report["stage_counts"] = _counts(ratio) if ratio > 1.0 else []
    report["stage_ratio_of_least_mass"] = split.lightest_stage_ratio()
    return report


def _bound(goal: str, bound: float, duty: ServoDuty | None) -> dict[str, float]:
    """What no train is better than, by the name of what it bounds."""
    factor, unit = SHOWN[goal]
    name, value = f"{goal}_{unit}", factor * bound
    if duty is not None and goal == duty.goal:
        name = NAMES[duty.motion][2]
        value = 1.0 / value if duty.motion == "acceleration" else value
    return {f"real_valued_bound_{name}": value}


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
    motor, output, fits = _laid_out(box, result, outcome.x)
    bodies = scene.servo_train().bodies
    assert bodies is not None
    width, height = (float(side) for side in servo_box.extents(box, motor, output))
    return result, {
        "inner_width_mm": box.box[0],
        "inner_height_mm": box.box[1],
        "needed_width_mm": width,
        "needed_height_mm": height,
        "fits": fits,
        "motor_angle_deg": math.degrees(motor),
        "output_angle_deg": math.degrees(output),
        "radii_mm": list(box.radii),
        "motor_mm": 0.5 * float(bodies.motor),
        "shaft_mm": 0.5 * float(bodies.shaft),
        "links_mm": list(box.links),
        "hub_mm": box.hub,
        "half_sweep_deg": math.degrees(box.half_sweep),
    }


def _laid_out(box: servo_box.ServoBox, result: Result, x: Array) -> tuple[float, float, bool]:
    """Angles of motor and output, and whether they fit; decided anew within the gap of the box."""
    least, most = result.bound, 1.0 + servo_box.TIE
    assert result.value is not None
    if result.value > most and least is not None and least <= most:
        found = servo_box.first_that_fits([box])
        if found is not None:
            return float(found[1][0]), float(found[1][1]), True
    return float(x[0]), float(x[1]), result.value <= most
