"""kind = "dynamics": a spur pair on moving axes: response, stability, speeds, least vibration."""

import math
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.formulations.dynamics import parts
from gearopt.formulations.dynamics.design import DynamicsDesign
from gearopt.formulations.dynamics.motion.stability import UNSTABLE
from gearopt.formulations.dynamics.motions_over_speed import over_speeds, rms_limited_by_backlash
from gearopt.formulations.dynamics.orbit.task import pair_of
from gearopt.formulations.dynamics.standard_factors import Toothing, standard_factors
from gearopt.optimise.clock import Clock, of_others
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.explaining.explain import binding
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.result import Result, versions
from gearopt.optimise.typed import untyped
from gearopt.physics.motion.moving_pair import MovingPair
from gearopt.scenes.dynamics.notes import warnings
from gearopt.scenes.dynamics.scene import Scene, wave_of
from gearopt.scenes.dynamics.steps import (
    BEST,
    at_ends,
    beside,
    optimised,
    possible,
    remedies,
    resolvable,
    told,
    whole_problem,
)
from gearopt.scenes.dynamics.stiffness_of_teeth import of_teeth
from gearopt.scenes.explaining.explanations import explained
from gearopt.scenes.kind import Kind, examples_in
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.ask import Ask, without_method

METHODS = ("screened",)  # its own
HARMONICS = 20  # of a motion at the pair's own speed
ONCE = (
    "numbers are solved again only where teeth stay in contact, without a limit of the Floquet "
    "multiplier, and the answer is locally optimal"
)
DAMPED = {
    "in_contact": "The mesh damps while teeth are in contact, not while they are apart.",
    "always": "The mesh damps always, also while teeth are apart.",
}
TOOTH_LOAD = (
    "The tooth load is that of all pairs of teeth in contact together, of their spring and damper."
)
K_V = (
    "K_v is of K_A = 1 and deviations that are not run in, with the mean stiffness and the mesh "
    "mass of the motion; teeth are of ISO 53 without profile shift where no file of kind pair is "
    "named; A_v of AGMA is taken as the accuracy grade."
)
NOTHING = "the file has no table [optimise], so that nothing is chosen"


def motion(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Return the motions of the file's pair, or of the pair of least vibration with [optimise]."""
    clock = Clock(ask.budget, ask.watch)
    if scene.mesh.pair is not None:
        wave, error, teeth, assumed = of_teeth(scene, ask)
    else:
        wave, error, teeth, assumed = wave_of(scene.mesh), (), scene.toothing, []
    pair = scene.pair(wave, error)
    if scene.optimise is not None:
        return _least(scene, ask, pair, teeth, assumed, clock)
    without_method(ask, NOTHING)
    design = _design(scene, pair, teeth, scene.mesh.axes, clock)
    missing = _missing(scene, design) if clock.stopped else ""
    evaluated = Result(
        name="dynamics",
        status="limit" if missing else "evaluated",
        method=design.response.method if design.response else "modes",
        objective={},
        certificate={"feasibility": 0.0},
        design=untyped(replace(design, warnings=tuple(warnings(design, scene.module, teeth)))),
        report={"assumptions": [*assumptions(scene), *assumed]},
        message=missing,
        evaluations=clock.evaluations + 1,
        seed=ask.seed,
        versions=versions("numpy"),
    )
    return replace(evaluated, seconds=clock.seconds)


def _least(
    scene: Scene, ask: Ask, before: MovingPair, teeth: Toothing, assumed: list[str], clock: Clock
) -> Result:
    """Return the pair of least vibration, with what the tables of the file ask of it."""
    assert scene.optimise is not None
    result, best, task = optimised(scene, ask, before, clock)
    if best is None:
        return result
    at = best.dense_rpm[best.dense_mm.index(max(best.dense_mm))]
    values = [getattr(best, name) for name in BEST]
    teeth = replace(teeth, contact_ratio=best.contact_ratio, face_width=best.face_width_mm)
    moved = _design(scene, pair_of(task, values, at), teeth, "line", clock)
    design = replace(moved, chosen=best)
    if clock.over:
        text = f"{result.message} {_missing(scene, design)}".strip()
        result = replace(result, message=text)
    said = (*told(best, result, scene.optimise.periods), *warnings(design, scene.module, teeth))
    report: dict[str, Any] = {"assumptions": [*assumptions(scene), *assumed]}
    if notes := at_ends(task, values):
        report["notes"] = notes
    return replace(result, design=untyped(replace(design, warnings=said)), report=report)


def influences(scene: Scene, ask: Ask, result: Result) -> Explanation:
    """Influence of every number on the answer.

    Numbers are solved again from the answer, over its speeds, where teeth stay in contact.
    """
    clock = Clock(ask.budget, of_others(ask.watch))
    if scene.optimise is not None and not resolvable(scene, result):
        return Explanation(result, (), (), binding(result), (), ONCE, clock.seconds)

    def answer(other: Scene) -> Result:
        return motion(other, replace(ask, budget=clock.left, watch=clock.watch), None)

    return explained(scene, result, clock, answer, lambda other: beside(scene, other, result))


def _design(
    scene: Scene, pair: MovingPair, teeth: Toothing, level: str, clock: Clock
) -> DynamicsDesign:
    """Return the motions that the tables of the file ask of a pair, as far as time suffices."""
    simulate, stability, speeds = scene.simulate, scene.stability, scene.speeds
    response = mapped = motions = None
    if simulate is not None and clock.tell():
        span, loaded = simulate.duration.value, simulate.start == "equilibrium"
        error = float(simulate.error)
        response = parts.response(pair, level, (span, simulate.outputs), error, loaded, clock)
    if stability is not None:
        low, high = (end.value for end in stability.mesh_frequency)
        first, last = (float(depth) for depth in stability.depth)
        across, up = (low, high, stability.frequencies), (first, last, stability.depths)
        mapped = parts.stability(pair, level, across, up, clock)
        if mapped is not None and mapped.here is not None and mapped.here > 1.0 + UNSTABLE:
            mapped = replace(
                mapped, limited_rms_mm=rms_limited_by_backlash(pair, level, HARMONICS, clock)
            )
    if speeds is not None:
        low, high = (30.0 / math.pi * end.value for end in speeds.range)
        grid = low, high, speeds.points
        motions = over_speeds(pair, level, scene.mesh.teeth, grid, speeds.harmonics, clock)
        motions = motions if len(motions.speed_rpm) > 1 else None
    standard = None
    if response or motions:
        own_rpm = 60.0 * pair.mesh_frequency / scene.mesh.teeth
        standard = standard_factors(teeth, pair, own_rpm, motions.speed_rpm if motions else ())
    return DynamicsDesign(
        kinematics=pair.kinematics,
        axes=level,
        mesh_frequency_Hz=pair.mesh_frequency,
        equilibrium=parts.equilibrium(pair, level),
        response=response,
        stability=mapped,
        speeds=motions,
        standard=standard,
    )


def _missing(scene: Scene, design: DynamicsDesign) -> str:
    """Return the parts that a stopped run left out, as a sentence; "" where it is complete."""
    simulate, stability, speeds = scene.simulate, scene.stability, scene.speeds
    missing = []
    if simulate is not None and design.response is None:
        missing.append("the motion in time")
    elif simulate is not None and design.response is not None:
        reached = 1e-3 * design.response.time_ms[-1]
        if reached < (1.0 - 1e-9) * simulate.duration.value:
            missing.append(f"the motion after {reached:.4g} s")
        elif not design.response.met:
            missing.append("the error asked of the motion")
    if stability is not None:
        rows = len(design.stability.depth) if design.stability else 0
        if rows < stability.depths:
            missing.append(f"{stability.depths - rows} of {stability.depths} rows of the map")
    if speeds is not None:
        done = len(design.speeds.speed_rpm) if design.speeds else 0
        if done < speeds.points:
            missing.append(f"{speeds.points - done} of {speeds.points} speeds")
        if design.speeds and design.speeds.teeth_part and not design.speeds.falling_rms_mm:
            missing.append("falling speeds")
    if design.chosen is not None and set(design.chosen.before_mm) == {None}:
        missing.append("the motions of the file's own pair over speed")
    if design.chosen is not None and design.chosen.largest_multiplier is None:
        missing.append("the largest Floquet multiplier")
    return f"Stopped early: {', '.join(missing)} missing." if missing else ""


def assumptions(scene: Scene) -> list[str]:
    """Return the assumptions of the model."""
    said = [
        "Rigid gears on massless springs and dampers; the teeth are one spring along the line of "
        "action, its stiffness a function of time at constant mesh frequency.",
    ]
    if scene.mesh.damping and scene.mesh.backlash is not None:
        said.append(DAMPED[scene.mesh.damping_acts])
    if scene.simulate or scene.speeds:
        said.append(TOOTH_LOAD)
    if scene.mesh.accuracy_grade is not None:
        said.append(K_V)
    if scene.mesh.kinematics.startswith("paper"):
        said.append(
            "The paper's kinematics are not those of two involutes: a rotation of the whole pair "
            "changes the deformation. They serve for comparison."
        )
    if scene.mesh.axes == "fixed":
        said.append(
            "Axes do not move: masses of the gears, bearings and kinematics have no effect."
        )
    elif scene.mesh.axes == "line" and "kinematics" in scene.mesh.model_fields_set:
        said.append(
            "Axes move along the line of action, where all kinematics are alike: that key has no "
            "effect."
        )
    if scene.optimise is not None:
        said.append(
            "Gears are discs of the pitch radii, times the rim factor; torques balance; the mesh "
            "stiffness changes between that of one and of two pairs of teeth as a trapezoid."
        )
        said.append(
            "Not used: masses, inertias and bearing stiffnesses of [pinion] and [wheel] and the "
            "wave of [mesh]. They are of the pair of the file, which is only compared; those of "
            "the answer follow from its sizes."
        )
    return said


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    unused = {"top": "no next best answers are listed"}
    if scene.optimise is None:
        unused |= {"seed": NOTHING, "gap": NOTHING}
    return unused


def methods_to_compare(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    _to_optimise(scene)
    return ("screened", "ipopt", "multistart")


def posed(scene: Scene, method: str) -> Model:
    """Return the problem on the speeds of the file; SolveError without [optimise]."""
    words = "Bearings, contact ratio, ramp, width and rim, at the speeds of the file alone"
    return Model(whole_problem(_to_optimise(scene).task), words)


def _to_optimise(scene: Scene) -> Scene:
    if scene.optimise is None:
        raise SolveError(f"{NOTHING}: gearopt solve FILE computes its motion")
    return scene


ABOUT = {  # files in examples, that of the kind first
    "dynamics": "a spur pair on moving axes: response, stability, speeds, least vibration",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    steps=one_step(motion),
    posed=posed,
    methods_to_compare=methods_to_compare,
    methods=METHODS,
    possible=possible,
    remedies=remedies,
    remedied=lambda scene: scene.optimise is not None,
    influences=influences,
    assumptions=assumptions,
    idle=idle,
)
