"""kind = "pair": a gear pair, sized or given, and how its teeth share the load."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations.drive.design import DriveDesign, drive_design
from gearopt.formulations.pair.relief import parametric
from gearopt.optimise.clock import Clock
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.explaining.explanation import Explanation, Remedies
from gearopt.optimise.pareto.objectives import Tradeoff
from gearopt.optimise.result import Result, versions
from gearopt.optimise.typed import untyped
from gearopt.physics.gears import GearPair
from gearopt.scenes import drive
from gearopt.scenes.drive.drawing import with_drawing
from gearopt.scenes.drive.explain import answers as of_drive
from gearopt.scenes.drive.rating import rated
from gearopt.scenes.drive.scene import Scene as Drive
from gearopt.scenes.drive.tables.blanks import body_flaws
from gearopt.scenes.explaining.explanations import by_solving
from gearopt.scenes.kind import Kind, Trades, examples_in
from gearopt.scenes.pair import relief as relief_part
from gearopt.scenes.pair.contact import Materials, contact_of, mesh_of
from gearopt.scenes.pair.flank import (
    flank_contact_of,
    flank_mesh_of,
    flank_problem,
    in_slices,
    relieved_flank,
)
from gearopt.scenes.pair.notes import contact_assumptions, flank_assumptions
from gearopt.scenes.pair.relief import relieved
from gearopt.scenes.pair.scene import Scene
from gearopt.scenes.plan import Step
from gearopt.scenes.reading.ask import Ask, unseeded, without_method

METHODS = ("exact", "mpec")  # its own
NOTHING = "the gears are given, so that nothing is chosen"
SPUR_FRONT = (
    "a front of reliefs is drawn for spur pairs without a table [flank]: gearopt solve FILE finds "
    "one relief of helical gears"
)


def steps(scene: Scene, ask: Ask) -> tuple[Step[Scene], ...]:
    """Gears, given or sized, with their rating; their contact; their relief; their drawings' data.

    With a table [relief] that is what the answer is about, and a sized pair is its part "gears".
    """
    without_relief = scene.relief is None
    gears: tuple[Step[Scene], ...]
    if not scene.given:
        gears = (Step(sized, own=without_relief),)
    elif scene.rating is None:
        gears = (Step(given, own=without_relief),)
    else:
        gears = tuple(
            Step(run, _as_drive, without_relief)
            for run in (rated.with_given_rating, rated.with_given_gears)
        )
    if scene.given and without_relief:
        without_method(ask, NOTHING)
    relief: tuple[Step[Scene], ...] = () if without_relief else (Step(with_relief),)
    drawn = (Step(with_drawing, _as_drive),) if scene.drawing else ()
    return (*gears, Step(with_contact), *relief, *drawn)


def _as_drive(scene: Scene) -> Drive:
    """The pair as a drive of one stage."""
    return scene.drive


def sized(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Gears sized by their limits or rating, and rated where the file asks for it."""
    return drive.KIND.solve(scene.drive, ask)


def with_contact(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Gears with their contact, by slices of the face where `in_slices`."""
    assert known is not None
    design = drive_design(known.design)
    pair, materials = _pair_of(design)
    seconds = ask.budget.seconds
    try:
        if in_slices(scene, pair):
            mesh, level = flank_mesh_of(scene, pair, materials, seconds)
            flank = flank_contact_of(scene, mesh, level, materials)
            design, said = replace(design, flank=flank), flank_assumptions(scene, flank, pair)
        else:
            plane = mesh_of(scene, pair, materials, seconds)
            contact = contact_of(scene, plane, materials)
            design = replace(design, contact=contact)
            said = contact_assumptions(scene, contact, pair)
    except TimeoutError as reason:
        return replace(known, name="pair", status="limit", design={}, message=str(reason))
    return replace(
        known,
        name="rating" if known.name == "rating" else "pair",
        design=untyped(design),
        report=known.report | {"assumptions": [*known.report.get("assumptions", []), *said]},
    )


def with_relief(scene: Scene, ask: Ask, gears: Result | None) -> Result:
    """The relief with the gears that it is of, a part where they were sized or rated.

    Limits of gears that are given are those of their part: no relief changes them.
    """
    assert gears is not None
    design = drive_design(gears.design)
    pair, materials = _pair_of(design)
    if in_slices(scene, pair):
        best, design = _with_flank_relief(scene, ask, design)
    else:
        best, relief = relieved(scene, mesh_of(scene, pair, materials), ask)
        design = replace(design, relief=relief)
    sized = gears.value is not None
    limited = sized or bool(gears.limits)
    parts = (replace(gears, name="gears", design={}, report={}),) if limited else ()
    notes = [note for one in (gears, best) for note in one.report.get("notes", [])]
    return replace(
        best,
        name="pair",
        design=untyped(design),
        limits=gears.limits if sized else {},
        report=gears.report | best.report | ({"notes": notes} if notes else {}),
        parts=parts,
    )


def _with_flank_relief(scene: Scene, ask: Ask, design: DriveDesign) -> tuple[Result, DriveDesign]:
    """Result of the relief of a pair in slices, and its design with the flank that it makes."""
    pair, materials = _pair_of(design)
    mesh, level = flank_mesh_of(scene, pair, materials)
    best, reliefs = relieved_flank(scene, mesh, ask)
    if reliefs is None or design.flank is None:
        return best, design
    flank = flank_contact_of(scene, replace(mesh, reliefs=reliefs), level, materials)
    loads = tuple(
        replace(load, plain_peak_to_peak_mm=plain.peak_to_peak_mm)
        for load, plain in zip(flank.loads, design.flank.loads, strict=True)
    )
    return best, replace(design, flank=replace(flank, loads=loads))


def _pair_of(design: DriveDesign) -> tuple[GearPair, Materials]:
    """Gears of a design, and names of their materials."""
    stage = design.stages[0]
    return stage.pair, (stage.pinion_material, stage.wheel_material)


def given(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Gears that are given and not to be rated."""
    design, blanks = rated.given_design(scene.drive, (scene.given_pair,))
    flaws = [flaw.sentence for flaw in body_flaws(blanks, (scene.given_pair,))]
    return Result(
        name="pair",
        status="evaluated",
        method="evaluation",
        objective={},
        certificate={"feasibility": 0.0},
        design=untyped(design),
        report={"notes": [*rated.off_ratio(scene.drive, design), *flaws]},
        evaluations=1,
        seed=ask.seed,
        versions=versions("numpy"),
    )


def remedies(scene: Scene, clock: Clock, result: Result, soon: bool) -> Remedies | None:
    """Remedies where no gears meet the limits of loads or ratings.

    soon: of ratings the conflict at most; None where that is not known soon.
    """
    return of_drive.remedies(scene.drive, clock, result, soon)


def influences(scene: Scene, ask: Ask, result: Result) -> Explanation:
    """Sensitivities of the relief, else of the size of the pair, to every number of the file."""
    if scene.relief is not None:
        return by_solving(KIND, scene, ask, result)
    return of_drive.influences(_to_size(scene).drive, ask, result)


def idle(scene: Scene, method: str | None) -> dict[str, str]:
    """Return the options of `solve` that change nothing, each with the reason."""
    if scene.given or scene.relief is not None:
        return {"top": "a pair has no list of next best answers"} | _unseeded(scene, method)
    return drive.idle(scene.drive, method)


def _unseeded(scene: Scene, method: str | None) -> dict[str, str]:
    asked = scene.relief
    if asked is not None and method is None and not _proven(scene):
        return {}
    return unseeded(method)


def _proven(scene: Scene) -> bool:
    """Return whether the relief has a proven search."""
    asked = scene.relief
    if asked is None or scene.helical or scene.flank:
        return False
    return asked.minimise in parametric.PROVEN and not asked.robust


def methods_to_compare(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    if scene.relief is not None:
        if scene.relief.free:
            return ("exact",)
        exact = METHODS if _proven(scene) else ()
        return (*exact, "annealing", "nsga2")
    return drive.methods_to_compare(_to_size(scene).drive)


def posed(scene: Scene, method: str) -> Model:
    """Return the problem of the relief, else that which sizes the pair; SolveError of neither."""
    if scene.relief is None:
        return drive.posed(_to_size(scene).drive, method)
    pair, materials = _gears_of(scene, Ask())
    if in_slices(scene, pair):
        mesh, _ = flank_mesh_of(scene, pair, materials)
        problem, _ = flank_problem(scene, mesh)
        return Model(problem, "Amounts and lengths of relief, by slices of the face", "mm")
    return relief_part.model(scene, mesh_of(scene, pair, materials))


def objectives(scene: Scene) -> Mapping[str, str]:
    """Objectives of a front of reliefs, else of sizes: name and unit."""
    if scene.relief is not None:
        return relief_part.objectives(scene)
    return drive.KIND.trades.objectives(_to_size(scene).drive)


def traded(scene: Scene, names: Sequence[str], ask: Ask) -> Tradeoff:
    """Return the problem of a front of reliefs, else of sizes."""
    if scene.relief is None:
        return drive.KIND.trades.traded(_to_size(scene).drive, names, ask)
    pair, materials = _gears_of(scene, ask)
    if in_slices(scene, pair):
        raise SolveError(SPUR_FRONT)
    try:
        mesh = mesh_of(scene, pair, materials, ask.budget.seconds)
    except TimeoutError as reason:
        raise SolveError(str(reason)) from None
    return relief_part.traded(scene, mesh, names)


def _gears_of(scene: Scene, ask: Ask) -> tuple[GearPair, Materials]:
    """Return the gears, sized where they are not given; SolveError where there are none."""
    if scene.given:
        return scene.given_pair, ("", "")
    sized = drive.KIND.solve(scene.drive, ask.beforehand)
    if sized.status == "infeasible":
        raise SolveError("no pair of gears meets the limits, so that there is none to relieve")
    if sized.value is None:
        raise SolveError("no pair of gears was found in time, so that there is none to relieve")
    return _pair_of(drive_design(sized.design))


def _to_size(scene: Scene) -> Scene:
    """Return the pair; SolveError for one that is given."""
    if scene.given:
        raise SolveError(f"{NOTHING}: gearopt solve FILE computes their contact")
    return scene


ABOUT = {  # files in examples, that of the kind first
    "pair": "a gear pair, sized or given, and how its teeth share the load",
    "pair-of-a-drive": "a pair that is a stage of a drive's file",
    "sized-pair": "a spur pair from duty and steel alone, and how its teeth share the load",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    steps=steps,
    posed=posed,
    methods_to_compare=methods_to_compare,
    methods=METHODS,
    remedies=remedies,
    remedied=lambda scene: scene.relief is None,
    influences=influences,
    trades=Trades(objectives, traded),
    idle=idle,
)
