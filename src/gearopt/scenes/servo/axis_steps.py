"""Steps of the answer for a servo axis: train, ratio, lightest train, box, errors; with bounds."""

import math
from dataclasses import replace

from gearopt.formulations.servo import servo_box, split
from gearopt.formulations.servo.choice import train_problem
from gearopt.formulations.servo.front import front
from gearopt.formulations.servo.ratio.achieved import (
    Candidate,
    achieved,
    best_ratio_of,
    judged,
    landmarks,
    values_about_best,
)
from gearopt.formulations.servo.servo_design import (
    GOALS,
    KG_M2,
    ErrorSource,
    ListedTrain,
    MeshBacklash,
    RatioDesign,
    ServoDesign,
    ServoReport,
    Stage,
    StageCount,
    Teeth,
    TrainDesign,
)
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.formulations.servo.split.servo_train import (
    ServoTrain,
    bending_stress,
    motion_torques,
    objectives,
    pairs,
    pinion_torques,
)
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock, in_part, of_others
from gearopt.optimise.result import Budget, Result
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Array
from gearopt.optimise.typed import typed, untyped
from gearopt.physics.gears import GearPair
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.servo.scene import Scene
from gearopt.scenes.servo.tables.mesh import Source

STAGES = 6  # that a ratio is split into, at most, for comparison
COUNTS = {"combinations": "trains_looked_at", "feasible_trains": "feasible_trains"}
LISTED = 400  # trains that are shown
PATIENCE = 10.0  # seconds, for the Pareto front
BOUNDS = 0.3  # s, at least, for real-valued bounds beside a train
NO_DESIGN, NO_REPORT = ServoDesign(), ServoReport()


def added(
    known: Result | None,
    result: Result | None,
    design: ServoDesign = NO_DESIGN,
    report: ServoReport = NO_REPORT,
) -> Result:
    """Add a part to the result of an axis; the first part is the answer to the file.

    result: of the part, where it has one. design, report: what it adds to those of the answer.
    """
    if known is None:
        assert result is not None
        return replace(result, design=untyped(design), report=report.to_dict())
    return replace(
        known,
        design=known.design | untyped(design),
        report=known.report | report.to_dict(),
        parts=known.parts if result is None else (*known.parts, result),
    )


def gears_of(scene: Scene, known: Result | None) -> Pairs | None:
    """Gear pairs of the train that was chosen, or that the file gives; None: there are none."""
    if scene.train is None:
        return given_gears(scene)
    train = None if known is None else design_of(known).train
    if train is None:
        return None
    first, second = train.stages
    teeth = first.pinion_teeth, second.pinion_teeth, first.wheel_teeth, second.wheel_teeth
    modules = first.normal_module_mm, second.normal_module_mm
    return pairs((*teeth, *modules), scene.servo_train().face_width)


def design_of(known: Result) -> ServoDesign:
    """Design of an axis that a result holds."""
    design: ServoDesign = typed(ServoDesign, known.design)
    return design


def sensitivity(pairs: Pairs, source: Source) -> float:
    """Return the error of the output [rad] per mm of a deviation."""
    first, second = pairs
    if source.stage == 1:
        return float(source.per_mm / (first.wheel.reference_diameter * second.ratio))
    return float(source.per_mm / second.wheel.reference_diameter)


def of_point(scene: Scene, x: Array, train: ServoTrain | None = None) -> Pairs:
    """Return the gear pairs of a point of `split.problem`; train: that of the scene, if known."""
    train = scene.servo_train() if train is None and scene.train is not None else train
    width = math.nan if train is None else train.face_width
    return pairs((*(round(float(z)) for z in x[:4]), float(x[4]), float(x[5])), width)


def given_gears(scene: Scene) -> Pairs | None:
    """Return the gear pairs that a file gives in its [[mesh]] tables."""
    if not scene.mesh or not scene.mesh[0].given:
        return None
    width = math.nan if scene.train is None else scene.servo_train().face_width
    first, second = (mesh.pair(width) for mesh in scene.mesh)
    return first, second


def errors(scene: Scene, gears: Pairs) -> tuple[ErrorSource, ...]:
    """Return every source of error at the output, all at their worst; they add up."""
    deviations = tuple(
        ErrorSource(
            source=s.name,
            kind=s.kind,
            stage=s.stage,
            tolerance_mm=s.most,
            error_deg=math.degrees(s.most * sensitivity(gears, s)),
        )
        for s in scene.sources
    )
    return deviations + tuple(
        ErrorSource(f"varying stiffness of mesh {k}", "elastic", k, None, math.degrees(varied))
        for k, varied in enumerate(elastic(scene, gears), 1)
    )


def elastic(scene: Scene, gears: Pairs) -> tuple[float, ...]:
    """Return the error [rad] of either mesh whose stiffness varies; nothing where none does."""
    springs = scene.elastic
    return () if springs is None else tuple(map(float, springs.variations(gears)))


def backlashes(scene: Scene) -> tuple[MeshBacklash, ...]:
    """Return minimum and maximum backlash of both stages, where the file has two-sided allowances.

    Or a minimum backlash.
    """
    meshes = scene.mesh
    if not any(m.minimum_backlash or m.two_sided for m in meshes):
        return ()
    return tuple(
        MeshBacklash(
            k,
            *scene.backlash(k),
            None if mesh.minimum_backlash is None else mesh.minimum_backlash.value,
        )
        for k, mesh in enumerate(meshes, 1)
    )


def _stage(pair: GearPair) -> Stage:
    """Return a stage in the words of a drawing."""
    pinion, wheel = pair.gears
    return Stage(
        normal_module_mm=pair.normal_module,
        pinion_teeth=pinion.teeth,
        wheel_teeth=wheel.teeth,
        ratio=pair.ratio,
        pinion_diameter_mm=float(pinion.reference_diameter),
        wheel_diameter_mm=float(wheel.reference_diameter),
        pinion_tip_diameter_mm=float(pinion.tip_diameter),
        wheel_tip_diameter_mm=float(wheel.tip_diameter),
        centre_distance_mm=float(pair.centre_distance),
    )


def described(
    scene: Scene,
    gears: Pairs,
    train: ServoTrain | None = None,
    sources: tuple[Source, ...] | None = None,
) -> TrainDesign:
    """Return the train of a result; train, sources: the scene's, where they are known."""
    first, second = gears
    n, table = first.ratio * second.ratio, scene.train
    train = scene.servo_train() if train is None and table is not None else train
    sources = scene.sources if sources is None else sources
    error = sum(s.most * sensitivity(gears, s) for s in sources) + sum(elastic(scene, gears))
    design = TrainDesign(
        stages=(_stage(first), _stage(second)),
        ratio=n,
        error_deg=math.degrees(error) if sources else None,
    )
    if table is None or train is None:
        return design
    worth = objectives(train, ("inertia", "mass"), gears)
    torques, moved = pinion_torques(train, gears), motion_torques(train, gears)
    stages = tuple(
        replace(
            stage,
            face_width_mm=pair.face_width,
            pinion_torque_Nm=1e-3 * float(torque),
            bending_stress_MPa=float(bending_stress(torque * pair.ratio, pair)),
        )
        for stage, pair, torque in zip(design.stages, gears, torques, strict=True)
    )
    single = table.ratio[0] == table.ratio[1]
    return replace(
        design,
        stages=stages,
        motion_torque_Nm=None if moved is None else 1e-3 * float(moved[1]),
        output_torque_Nm=1e-3 * train.output_torque or None,
        ratio_error_percent=100.0 * (n / float(train.ratio) - 1.0) if single else None,
        inertia_kg_m2=float(KG_M2 * worth["inertia"]),
        mass_kg=float(worth["mass"]),
        sector=float(table.sector),
    )


def with_train(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The best train."""
    choice = scene.choice()
    unit = GOALS[choice.goal].shown
    problem, watch = train_problem(choice), in_part(ask.watch, unit)
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": unit})
    counts = {k: result.proof[v] for k, v in COUNTS.items() if "feasible_trains" in result.proof}
    report = ServoReport(figures=counts)
    if result.value is None or outcome.x is None:
        return added(known, result, report=report)
    gears = of_point(scene, outcome.x)
    return added(known, result, ServoDesign(train=described(scene, gears)), report)


def with_other_trains(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The best train with bounds, figures of other numbers of stages and the Pareto front.

    None of them where no time is left, which the notes say.
    """
    assert known is not None
    clock, train = Clock(ask.budget, of_others(ask.watch)), known.value is not None
    report = ServoReport()
    if clock.budget.seconds != 0.0:
        report |= beside(scene, gears_of(scene, known), clock)
    if train:
        report |= ServoReport(trains=neighbours(scene, clock))
    return added(known, None, report=report)


def neighbours(scene: Scene, clock: Clock) -> tuple[ListedTrain, ...]:
    """Return the Pareto front of trains; nothing where time is up, at most PATIENCE.

    A box is left aside. Thinned if many. One that is the best by two goals stands there twice,
    each time named by one of them.
    """
    import numpy as np

    choice = scene.choice(boxed=False)
    within = Clock(replace(clock.left, seconds=clock.within(PATIENCE)), clock.watch)
    points, worth = front(choice, choice.weighed, within)
    if within.stopped or not len(points):
        return ()
    best = worth.argmin(0).tolist()
    many = np.linspace(0, len(points) - 1, min(LISTED, len(points))).round().astype(int)
    shown = [(k, "") for k in many.tolist() if k not in best]
    shown += [(k, name) for k, name in zip(best, choice.weighed, strict=True)]
    return tuple(
        _neighbour(scene, of_point(scene, points[k]), float(worth[k, 0]), name)
        for k, name in sorted(shown)
    )


def _neighbour(scene: Scene, gears: Pairs, first: float, best_of: str) -> ListedTrain:
    """Return a train as the list shows it; first: its first objective."""
    train, duty = described(scene, gears), scene.servo_duty()
    assert scene.train is not None and train.inertia_kg_m2 and train.mass_kg
    judged_by = {}
    if duty is not None and scene.train.goal == duty.goal:
        judged_by = {GOALS[duty.goal].key: GOALS[duty.goal].value(first)}
    return ListedTrain(
        stages=tuple(Teeth(p.normal_module, p.pinion_teeth, p.wheel_teeth) for p in gears),
        ratio=train.ratio,
        best_of=GOALS[best_of].label if best_of else "",
        inertia_kg_m2=train.inertia_kg_m2,
        mass_kg=train.mass_kg,
        error_deg=train.error_deg,
        **judged_by,
    )


def beside(scene: Scene, chosen: Pairs | None, clock: Clock) -> ServoReport:
    """Real-valued bounds, and the figures of other numbers of stages.

    These are of the ratio that is asked for, or of the chosen train where a range is. Bounds are
    sought for what is left of the clock, or BOUNDS seconds.
    """
    assert scene.train is not None
    choice, figures = scene.choice(), {}
    left = clock.left.seconds
    within = Clock(Budget(None if left is None else max(left, BOUNDS)))
    for goal in dict.fromkeys(("inertia", *choice.weighed)):
        bound = solve(split.relaxation(choice.train, goal), budget=within.left).bound
        if bound is None:
            continue
        figures[f"real_valued_bound_{GOALS[goal].key}"] = GOALS[goal].value(bound)
    low, high = scene.train.ratio
    ratio = (
        float(low)
        if low == high
        else 1.0
        if chosen is None
        else math.prod(pair.ratio for pair in chosen)
    )
    figures["stage_ratio_of_least_mass"] = split.lightest_stage_ratio()
    return ServoReport(stage_counts=_counts(ratio) if ratio > 1.0 else (), figures=figures)


def _counts(ratio: float) -> tuple[StageCount, ...]:
    """Return inertia and mass of the bare train in pinions, by number of stages."""
    rows = []
    pairs = (split.stage_counts(ratio, STAGES, goal) for goal in ("inertia", "mass"))
    for count, (inertia, mass) in enumerate(zip(*pairs, strict=True), 1):
        ratios = inertia.design["ratio"]
        assert inertia.value is not None and mass.value is not None
        each = tuple(ratios) if isinstance(ratios, list) else (ratios,)
        rows.append(StageCount(count, inertia.value, mass.value, each))
    return tuple(rows)


def candidates(scene: Scene, chosen: TrainDesign | None) -> dict[str, Candidate]:
    """Return the ratio of [duty], the chosen and the given train, to be judged."""
    by_name = {}
    if scene.duty is not None and scene.duty.ratio is not None:
        asked = float(scene.duty.ratio)
        by_name["given"] = Candidate(f"At the given ratio of {asked:g}", asked)
    trains = {"chosen": chosen if scene.train else None}
    if scene.train is not None and (gears := given_gears(scene)) is not None:
        trains["given_train"] = described(scene, gears)
    for who, train in trains.items():
        if train is not None and train.inertia_kg_m2 is not None:
            where = f"With the {who.removesuffix('_train')} train, of ratio {train.ratio:.6g},"
            by_name[who] = Candidate(where, train.ratio, train.inertia_kg_m2 / KG_M2)
    if scene.planetary is not None:
        stage = scene.planetary.design()
        where = f"With the planetary stage, of ratio {stage.ratio:.6g},"
        by_name["given_train"] = Candidate(where, stage.ratio, stage.inertia_kg_m2 / KG_M2)
    return by_name


def with_gearhead(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The axis with its planetary stage: inertia, efficiency, lost motion and stiffness."""
    assert known is not None and scene.planetary is not None and scene.load is not None
    design, springs = scene.planetary.design(), scene.planetary.springs(scene.load.inertia.value)
    axis = ServoDesign(gearhead=design, stiffness=springs)
    figures = untyped(design) | {"output_stiffness_Nm_per_rad": springs.output_Nm_per_rad}
    figures |= {"frequency_Hz": springs.frequency_Hz, "windup_deg": springs.windup_deg}
    named = {f"given_{k}": v for k, v in figures.items() if isinstance(v, float)}
    return added(known, None, axis, ServoReport(figures=named))


def with_ratio(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The best total ratio, with the chosen train and the given one judged beside it."""
    duty, chosen = scene.servo_duty(), None if known is None else design_of(known).train
    assert duty is not None
    goal = GOALS[duty.goal]
    watch = in_part(ask.watch, goal.shown, factor=goal.factor)
    result, outcome = run(duty.problem(), ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = scaled(result, goal.factor, goal.shown)
    if result.value is None or outcome.x is None:
        return added(known, result)
    best = float(outcome.x[0])
    reached, judged_beside = float(judged(duty, best)), candidates(scene, chosen)
    figures = {"best_total_ratio": best, f"best_{goal.key}": reached} | landmarks(duty)
    with_train = None if "chosen" not in judged_beside else judged_beside["chosen"].inertia
    if with_train is not None:
        other = best_ratio_of(duty.with_gears(with_train))
        if other is not None:
            judged_beside["best_with_train"] = Candidate("", other, with_train)
            figures["best_total_ratio_with_train"] = other
    others = {who: achieved(duty, one, reached) for who, one in judged_beside.items()}
    for who, at_ratio in others.items():
        stem, _, end = f"{who}_{goal.key}".partition("_with_train_")
        if at_ratio is not None:
            figures[f"{stem}_{end}_with_train" if end else stem] = at_ratio.value
    ratio = RatioDesign(
        duty=duty.motion,
        total_ratio=best,
        value=reached,
        name=goal.title,
        unit=goal.value_unit,
        best=achieved(duty, Candidate("", best), reached),
        curve=values_about_best(duty, best, with_train),
        **({"given": None} | others),
    )
    design = ServoDesign(ratio=ratio)
    result = replace(result, design=untyped(design))
    return added(known, result, design, ServoReport(figures=figures))


def scaled(result: Result, factor: float, unit: str) -> Result:
    """Return a result whose objective and bound are in another unit."""
    value = None if result.value is None else factor * result.value
    bound = None if result.bound is None else factor * result.bound
    return replace(result, objective=result.objective | {"value": value, "unit": unit}, bound=bound)


def with_lightest(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The lightest real-valued train that is stiff enough."""
    watch = in_part(ask.watch, "kg", "stiff")
    result = solve(split.stiff(scene.stiff_train()), None, ask.budget, ask.seed, watch, ask.gap)
    result = replace(scaled(result, 1.0, "kg"), name="stiff")
    if result.value is None:
        return added(known, result)
    mass = {"lightest_mass_kg": result.value}
    report = ServoReport(lightest_train=result.design, figures=mass)
    return added(known, result, report=report)


def with_box(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The smallest box of the train, of the proportions that are asked for."""
    gears, bodies = gears_of(scene, known), scene.servo_train().bodies
    assert bodies is not None
    if gears is None:
        assert known is not None
        return known
    box = scene.box(gears)
    watch, gap = in_part(ask.watch, part="box"), max(ask.gap, servo_box.GAP)
    result, outcome = run(servo_box.problem(box), None, ask.budget, ask.seed, watch, gap)
    result = replace(result, name="box", objective=result.objective | {"unit": ""})
    if outcome.x is None or result.value is None:
        return added(known, result)
    radii = 0.5 * float(bodies.motor), 0.5 * float(bodies.shaft)
    design = servo_box.box_design(box, result, outcome.x, *radii)
    return added(known, result, ServoDesign(box=design))


def with_errors(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """The axis with errors, backlash and stiffness of its gears, chosen or given."""
    assert known is not None
    gears = gears_of(scene, known)
    if gears is None:
        return known
    rows, springs = errors(scene, gears), scene.springs
    sums = {
        f"{kind}_deg": sum(row.error_deg for row in rows if row.kind == kind)
        for kind in dict.fromkeys(("backlash", "pitch", *(row.kind for row in rows)))
        if rows
    }
    design = ServoDesign(
        train=described(scene, gears),
        errors=rows,
        backlash=backlashes(scene),
        stiffness=None if springs is None else springs.design(gears),
    )
    return added(known, None, design, ServoReport(figures=sums))
