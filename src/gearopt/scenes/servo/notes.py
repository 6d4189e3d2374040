"""Assumptions and notes of the answer for a servo axis, in sentences."""

import math
from dataclasses import replace
from fractions import Fraction

from gearopt.formulations.servo.ratio.achieved import why_not
from gearopt.formulations.servo.servo_design import ServoDesign, ServoReport
from gearopt.formulations.servo.split.bodies import broken
from gearopt.optimise.result import Result
from gearopt.physics.gears import GearPair, Rack
from gearopt.scenes.parts import tooth_warnings
from gearopt.scenes.reading.module_series import unverified
from gearopt.scenes.servo.axis_steps import candidates, given_gears
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.planetary import Planetary
from gearopt.scenes.servo.tables.trains import Train

SLOWEST = "acceleration"  # what nobody minimises
FRICTION = {
    "acceleration": "The motor accelerates the load with its full torque at that speed, "
    "and the efficiency is constant; friction is Coulomb's and opposes the motion. Heating of the "
    "motor is not checked.",
    "move": "The motor accelerates and brakes the load with its full torque, which is the same up "
    "to its speed limit. Coulomb friction opposes acceleration and helps braking, so the ramps "
    "differ; losses of the train are not counted while the motor brakes. Heating of the motor, "
    "by its rms torque, is not checked.",
    "swing": "Coulomb friction is in phase with the speed, inertia with the acceleration; no "
    "losses in the train. Where [motor] has a torque, it is the maximum rms torque.",
}


def assumptions(scene: Scene) -> list[str]:
    """Return all assumptions that hold for this file."""
    sentences = []
    if scene.duty is not None:
        sentences.append(FRICTION[scene.duty.motion])
        sentences.append(
            "The best total ratio is computed with the motor's inertia, without that of a train."
        )
    if scene.train is not None:
        sentences += _of_train(scene)
    if scene.planetary is not None:
        sentences += _of_planetary(scene.planetary)
    if scene.mesh:
        sides = "" if any(mesh.two_sided for mesh in scene.mesh) else "one-sided and "
        sentences.append(
            "The error at the output is lost motion between both flanks plus pitch error, by small "
            f"angles, in the worst case: every deviation is {sides}at its limit at the same time."
        )
    if any(mesh.pinion_bearing_fit or mesh.wheel_bearing_fit for mesh in scene.mesh):
        sentences.append(
            "In a loose fit of its bearings an axis goes with the force of the teeth, along one "
            "line of action or the other."
        )
    if any(mesh.two_sided or mesh.minimum_backlash for mesh in scene.mesh):
        sentences.append(
            "Backlash: at the reference circle, -(sum of thickness allowances) + 2 tan(alpha) "
            "times what moves the gears apart (ISO 21771, DIN 3967); at its minimum one-sided "
            "deviations are zero and run-outs close the mesh by as much as they open it. Pitch and "
            "helix deviations, heat and swelling are not counted."
        )
    if scene.tolerances is not None and any(mesh.two_sided for mesh in scene.mesh):
        sentences.append(
            "Of two-sided allowances the end that gives less backlash stays as it is; their width "
            "is the tolerance that is chosen."
        )
    if any(mesh.grade is not None for mesh in scene.mesh):
        sentences.append(
            "Pitch deviations by grade are F_pT of ISO 1328-1:2013, not rounded, of both gears."
        )
    if scene.tolerances is not None:
        sentences.append(
            "The cost of a tolerance is that of the old one times (old/new)^exponent. Of Monte "
            "Carlo errors run-outs are t cos(phi), phi uniform; all else is uniform from 0 to t."
        )
    if any(budget.rule == "rss" for budget in scene.budget):
        sentences.append(
            "The root of the sum of squares neglects the mean of one-sided deviations, which is "
            "above zero; the Monte Carlo yield includes it."
        )
    return sentences


def _of_planetary(stage: Planetary) -> list[str]:
    """Say what is counted of a planetary stage."""
    return [
        "The planetary stage is given and not rated. Gears have racks of 20 degrees and count as "
        "cylinders and tubes of mean tip and root diameter; planets share the load alike. Meshes "
        "are as stiff as c_gamma_alpha of ISO 6336-1, along the line of action; carrier, ring and "
        "shafts are rigid. c' is that of 100 N/mm and more; at a load_torque below it is less by "
        "the fourth root of the load: unverified.",
        "Teeth lose friction times Ohlendorf's loss factor of their rolling power. Lost motion is "
        "the play of the tightest planet, for the allowances exactly, largest where all are at "
        "their loosest; pitch and run-out are not counted.",
        *(() if stage.carrier_inertia else ("The inertia of the carrier is not counted.",)),
    ]


def _of_train(scene: Scene) -> list[str]:
    assert scene.train is not None
    sentences = [
        "The gears are external spur gears without profile shift, with an addendum of one module: "
        "solid discs of one face width.",
        *_sector(scene.train),
        *_carried(scene),
        "The bending stress is Lewis's at the tip of one tooth, with the form factor pi (0.154 - "
        "0.912/z) of full-depth teeth of 20 degrees (up to 8 % above tables, so that stresses may "
        "be that much higher), without dynamic, load distribution and notch factors and without "
        "contact stress. It is no rating by ISO 6336 or AGMA 2101.",
        _counted(scene),
        *unverified(scene.train.modules),
    ]
    sentences += _of_bodies(scene)
    if scene.stiffness is not None:
        sentences.append(
            "Stiffness is that of one pair of teeth in mesh and of the shaft between the stages, "
            "twisted over its length; bearings, housing, motor and output shaft are rigid, and the "
            "motor is locked."
        )
        if scene.stiffness.mesh_variation is not None:
            sentences.append(
                "This is the mean of a mesh, which varies by "
                f"{100 * float(scene.stiffness.mesh_variation):g} % of it: stiffness, frequency "
                "and windup are those of both meshes at their softest; what the windup by "
                "load_torque varies by is an error, of both together, whatever their phases."
            )
        if scene.stiffness.line_stiffness is None:
            sentences.append(
                "Line stiffness of a mesh after Buckingham and Lewis: formula not checked against "
                "any source."
            )
    if scene.space is not None:
        chosen = "" if scene.space.required else " As required = false, no train is refused for it."
        sentences.append(
            "Checked against the box of [space]: all gears, the last wheel wherever it swings, "
            "shafts, hub and motor, seen along the shafts, without clearances; the depth is not "
            f"checked. Lists and plots of other trains ignore the box.{chosen}"
        )
    return sentences


def _sector(train: Train) -> tuple[str, ...]:
    """Say what part of a disc the last wheel is, where it is no whole one."""
    share = 100.0 * float(train.sector)
    return () if share == 100.0 else (f"The last wheel is a sector of {share:g} % of a disc.",)


def _carried(scene: Scene) -> tuple[str, ...]:
    """Say which torques the teeth carry."""
    assert scene.train is not None
    if scene.duty is None:
        return ("Teeth carry output_torque; no motion of [duty] is known.",)
    given = "output_torque or, where it is larger, " if scene.train.output_torque else ""
    motion = (
        ""
        if scene.duty.motion == "swing"
        else (
            ", with all the motor's torque: what its rotor and the gears before a mesh do not take "
            "loads the mesh, before losses"
        )
    )
    lightest = " The lightest train carries output_torque alone." if scene.lightest else ""
    return (f"Teeth carry {given}the peak torque of the motion{motion}.{lightest}",)


def _counted(scene: Scene) -> str:
    """Say what mass and inertia count."""
    if scene.shaft is None:
        return "Mass and inertia of a train are those of its gears; no shaft is counted."
    lightest = ", and so has the mass of [lightest]" if scene.lightest is not None else ""
    return (
        "The mass of a train is that of its gears; its inertia has the shaft between the stages in "
        f"it{lightest}."
    )


def _of_bodies(scene: Scene) -> list[str]:
    """Say what keeps clear of what, and how thick the output shaft is taken to be."""
    assert scene.train is not None
    bodies = scene.servo_train().bodies
    assert bodies is not None
    thick = f"{float(bodies.output_shaft):g} mm"
    if scene.space is not None:
        thick += ", hub_diameter of [space]"
    elif scene.train.output_shaft_diameter is None and scene.shaft is None:
        thick = "not given, taken as 0"
    elif scene.train.output_shaft_diameter is None:
        thick += ", as thick as the shaft between the stages"
    thin = "" if scene.shaft is not None else " The middle shaft is not given and taken as a line."
    solid = "Gears, shafts and motor" if scene.space is not None else "Gears and shafts"
    return [
        "There are three planes along the shafts: motor, stage 1, stage 2. The motor's shaft ends "
        f"at its pinion, the other two pass through all three. {solid} in the same plane do not "
        "overlap; no clearance is added. Root circles, 1.25 modules inside the reference circle, "
        f"lie outside their shafts. Diameter of the output shaft with hub: {thick}.{thin}"
    ]


WHAT = {
    "output_shaft": "the first wheel runs into the output shaft",
    "hub": "the output shaft is thicker than the last wheel's root circle",
    "shaft": "the middle shaft is thicker than the root circle of a gear on it",
    "motor": "the motor runs into the middle shaft",
}


def given_overlap(scene: Scene) -> str:
    """Say which gears of [[mesh]] overlap something; empty where none do."""
    gears = given_gears(scene)
    if scene.train is None or gears is None:
        return ""
    bodies = scene.servo_train().bodies
    assert bodies is not None
    return _told("In the given train", broken(bodies, gears))


def _overlaps(scene: Scene, results: tuple[Result, ...]) -> str:
    """Say which gears of the lightest train overlap something: its mass is a lower bound."""
    lightest = [r for r in results if r.name == "stiff" and r.value is not None]
    if not lightest:
        return ""
    design, train = lightest[0].design, scene.servo_train()
    assert train.bodies is not None
    m = float(train.modules[0])
    first, second = (
        GearPair.of_diameter(m, d / m, d, n, b)
        for d, n, b in zip(
            design["pinion_diameter_mm"], design["ratio"], design["face_width_mm"], strict=True
        )
    )
    bodies = replace(train.bodies, shaft=Fraction(design["shaft_diameter_mm"]))
    return _told("In the lightest train", broken(bodies, (first, second)))


def _told(whose: str, broken: list[str]) -> str:
    return f"{whose} {' and '.join(WHAT[name] for name in broken)}." if broken else ""


UNLISTED = "Other trains are not listed: time ran out before all were compared."
UNCOUNTED = "Bounds with real-valued sizes and other numbers of stages are left out: time ran out."


def notes(
    scene: Scene, results: tuple[Result, ...], design: ServoDesign, report: ServoReport
) -> list[str]:
    """Notes for the reader beside the numbers."""
    duty, sentences = scene.servo_duty(), []
    if duty is not None and design.ratio is not None:
        judged = candidates(scene, design.train).values()
        sentences = [said for one in judged if (said := why_not(duty, one))]
    if scene.train is not None and scene.train.maximise is None and scene.train.aim == SLOWEST:
        sentences.append(
            f'minimise = "{SLOWEST}" was read as maximise: the maximum was searched for.'
        )
    if design.box is not None and not design.box.fits:
        sentences.append("The best train does not fit the box of [space].")
    asked, drawn = scene.accuracy.error, design.drawn
    if asked is not None and drawn is not None:
        limit = math.degrees(asked.value)
        worst = drawn.worst_case_deg
        if worst > limit * (1.0 + 1e-9):
            sentences.append(
                f"With all new tolerances at their limits the error is {worst:.5g} degrees, above "
                f"the {limit:.5g} of [accuracy]: their budget is not by the rule worst_case."
            )
    stages = () if design.train is None else design.train.stages
    rack = Rack(scene.accuracy.pressure_angle.value)
    sentences += tooth_warnings(
        GearPair.of_teeth(s.normal_module_mm, s.pinion_teeth, s.wheel_teeth, 1.0, rack=rack)
        for s in stages
    )
    if scene.lightest is not None:
        sentences.append(
            "The lightest train has real-valued sizes: its mass is a lower bound for whole teeth."
        )
    sentences += [said for said in (_overlaps(scene, results), given_overlap(scene)) if said]
    if report.trains == ():
        sentences.append(UNLISTED)
    if scene.train is not None and report.stage_counts is None:
        sentences.append(UNCOUNTED)
    sentences += [
        f"There is no answer for the part {part.name}: {(part.message or part.status).rstrip('.')}."
        for part in results[1:]
        if part.value is None
    ]
    return sentences
