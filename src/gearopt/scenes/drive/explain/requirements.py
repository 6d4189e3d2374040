"""Requirements of a drive that ratings limit, by name, and the drive without some of them.

What is dropped: safety factors, limits of sizes, ratios and shifts, hunting teeth and equal
materials as if they were not there; modules within the widest series of [teeth]; b/d1 from WIDTHS
to three; numbers of pinion teeth a quarter fewer and more; the ratio within 5 %; a life to a ten-
thousandth; materials to all of the file, and grades to the best there are; shifts of pinions to
SHIFTS, and sums of shifts to SUMS, beside those of the file. A given centre distance gives way to
that of reference circles: a design without it proves it needed, none proves nothing.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.physics.iso6336.materials import QUALITIES
from gearopt.scenes.drive.driving import trains
from gearopt.scenes.drive.explain.planets import OF_PLANETS, ends_of, of_planets, without_planets
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.explaining.numbers import allowed, put, times
from gearopt.scenes.reading.module_series import SERIES, family

Dropped = frozenset[str]

BENDING, CONTACT = "minimum_bending_safety", "minimum_contact_safety"
DISTANCE = "centre_distance"
OF_DISTANCES = "coaxial", "sum_of_centre_distances"  # of all stages together
SHIFT, SUM = "pinion_shift", "sum_of_profile_shifts"
GIVEN = (DISTANCE,)  # of which no design without them proves nothing
OF_SHIFTS = "specific_sliding", "contact_ratio", "tip_thickness"  # of teeth at given distances
OF_NUMBERS = (  # what decides which numbers of teeth there are, in integers
    *("pinion_teeth", "pinion_teeth_low", "pinion_teeth_high", "wheel_teeth", "wheel_teeth_low"),
    *("wheel_teeth_high", "stage_ratio", "stage_ratio_low", "stage_ratio_high", "ratio_tolerance"),
    *("coprime", "module", "module_low", "module_high", "modules", "wheel_diameter"),
)
# what decides which gears there are, whatever they carry
OF_TEETH = (*OF_NUMBERS, *OF_SHIFTS, SHIFT, SUM, DISTANCE, *OF_DISTANCES, *OF_PLANETS)
ORDER = (  # the likeliest to be in conflict first; those of the second group are dear to drop
    (
        *(CONTACT, BENDING, "face_width", "face_width_over_diameter", "face_width_high"),
        *("module", "module_high", "wheel_diameter", "stage_ratio_high", "least_face_width"),
        *("face_width_over_module_high", "life", "material_grade", "materials", "coprime"),
        *("same_materials", "wheel_teeth", "wheel_teeth_high", "axial_force", "overlap_ratio"),
    ),
    (
        *("pinion_teeth", "pinion_teeth_high", "pinion_teeth_low", "ratio_tolerance"),
        *("stage_ratio_low", "wheel_teeth_low", "module_low", "modules", "face_width_low"),
        *("face_width_over_module_low", *OF_SHIFTS, SHIFT, SUM, DISTANCE, *OF_DISTANCES),
        *OF_PLANETS,
    ),
)
WIDTHS = Fraction(1, 20), Fraction(3)  # b/d1 of free widths
TOLERANCE = Fraction(1, 20)
TEETH = Fraction(5, 4)  # by which numbers of pinion teeth are dropped
SHIFTS = tuple(Fraction(n, 5) for n in range(-3, 7))  # x1, from -0.6 to 1.2
SUMS = tuple(Fraction(n, 10) for n in range(-5, 16, 2))  # x1 + x2, as far as a file may have
LIFE = 1e-4  # times that asked for
NO_SAFETY = 1e-6
BEST_GRADES = (3, 2)
ALWAYS = 1e9  # times a load limit: none


def requirements(scene: Scene) -> tuple[tuple[tuple[str, ...], ...], ...]:
    """Names of the requirements: the groups of ORDER, families, names of their stages.

    A name of a stage is `wheel_diameter[2]`; where the number of stages is open, it is of all.
    """
    train = scene.held(scene.counts[0]).train()
    families: dict[str, list[str]] = {name: [name] for name in _of_all(scene, train)}
    for k, stage in enumerate(train.stages):
        table = scene.stage[k] if scene.stage else StageTable()
        for name in _of_stage(scene, table, stage):
            families.setdefault(name, []).append(f"{name}[{k + 1}]")
    if scene.several:
        families = {name: [name] for name in families}
    groups = (scene.law.names + ORDER[0], ORDER[1])
    return tuple(tuple(tuple(families[n]) for n in group if n in families) for group in groups)


def _of_all(scene: Scene, train: Train) -> Iterator[str]:
    """Yield what the drive as a whole is asked for."""
    asked, teeth = scene.rating, scene.teeth
    assert asked and teeth
    if set(teeth.sizes) != {m.exact[0] for m in SERIES[family(teeth.modules)[-1]]}:
        yield "modules"
    yield from ["coprime"] * teeth.coprime
    yield from ["same_materials"] * scene.gears.same_materials
    yield "ratio_tolerance"
    yield from (name for name in OF_DISTANCES if getattr(scene.limits, name))
    for name, given in ((SHIFT, "pinion_shift"), (SUM, "sum")):
        yield from [name] * (getattr(scene.shift, given, None) is not None)
    yield from OF_SHIFTS if any(stage.toothing.shifting for stage in train.stages) else ()
    if _with_materials(scene) != scene:
        yield "materials"
    if _with_grades(scene) != scene:
        yield "material_grade"
    yield "life"
    yield BENDING
    yield CONTACT


def _of_stage(scene: Scene, own: StageTable, stage: Stage) -> Iterator[str]:
    """Yield what a stage is asked for."""
    yield from scene.law.names
    ends = own.size or scene.limits.module
    if ends and own.size and ends[0] == ends[1]:
        yield "module"
    elif ends:
        yield from ("module_low", "module_high")
    if stage.planetary:
        yield from of_planets(stage)
    else:
        yield from ends_of("pinion_teeth", *stage.pinion_teeth)
        yield from ends_of("wheel_teeth", stage.wheel_teeth[0], stage.wheel_teeth[1], least=1)
    yield from ends_of("stage_ratio", *stage.ratio, least=1)
    face = stage.face_width
    if face.fixed is not None:
        yield "face_width"
    elif face.tied:
        yield "face_width_over_diameter"
    else:
        yield from ("face_width_low", "face_width_high")
    low, high = face.over_module
    yield from ["face_width_over_module_low"] * (low is not None)
    yield from ["face_width_over_module_high"] * (high is not None)
    yield from ["least_face_width"] * bool(face.least)
    yield from ["wheel_diameter"] * (stage.wheel_diameter is not None)
    yield from ["overlap_ratio"] * bool(stage.overlap)
    yield from ["axial_force"] * math.isfinite(stage.axial_force)
    yield from [DISTANCE] * (stage.toothing.working_distance is not None)


def without(scene: Scene, dropped: Dropped) -> tuple[Train, ...]:
    """Drives of every number of stages without the requirements dropped."""
    for name, changed in (("materials", _with_materials), ("material_grade", _with_grades)):
        scene = changed(scene) if name in dropped else scene
    scene = _short_lived(scene) if "life" in dropped else scene
    if "same_materials" in dropped:
        scene = put(scene, ("gears", "same_materials"), False)
    for name in dropped.intersection(OF_DISTANCES):
        scene = put(scene, ("limits", name), None)
    each = (train for count in scene.counts for train in trains(scene.held(count)))
    return tuple(_without(scene, train, dropped) for train in each)


def _without(scene: Scene, train: Train, dropped: Dropped) -> Train:
    stages = []
    for k, stage in enumerate(train.stages):
        here = {name for name in dropped if name.endswith(f"[{k + 1}]") or "[" not in name}
        table = scene.stage[k] if scene.stage else StageTable()
        stages.append(_stage(scene, table, stage, {name.split("[")[0] for name in here}))
    safety = tuple(
        NO_SAFETY if name in dropped else asked
        for name, asked in zip((BENDING, CONTACT), train.safety, strict=True)
    )
    tolerance = train.tolerance
    if "ratio_tolerance" in dropped:
        tolerance = max(TOLERANCE, 2 * tolerance if tolerance < Fraction(1, 4) else tolerance)
    return replace(
        train,
        stages=tuple(stages),
        safety=(safety[0], safety[1]),
        tolerance=tolerance,
        coprime=train.coprime and "coprime" not in dropped,
        distances=() if any(name.startswith(DISTANCE) for name in dropped) else train.distances,
    )


def _stage(scene: Scene, own: StageTable, stage: Stage, dropped: set[str]) -> Stage:
    """Return a stage without what is dropped there."""
    low, high = stage.pinion_teeth
    assert high is not None
    few, many = ({"pinion_teeth", f"pinion_teeth_{end}"} & dropped for end in ("low", "high"))
    pinion = math.floor(low / TEETH) if few else low, math.ceil(high * TEETH) if many else high
    wheel, ratio = (_open(name, dropped, span) for name, span in _spans(stage))
    law = zip(scene.law.names, stage.allowable, strict=True)
    toothings = stage.toothings
    if DISTANCE in dropped:
        free = [
            replace(cut, working_distance=None, shifting=None, pinion_shift=None)
            for cut in toothings
        ]
        toothings = tuple(dict.fromkeys(free))
    for name, field, values in ((SHIFT, "pinion_shift", SHIFTS), (SUM, "shift_sum", SUMS)):
        toothings = _widened(toothings, field, values) if name in dropped else toothings
    toothings = tuple(_unlimited(cut, dropped) for cut in toothings)
    made = replace(
        stage,
        toothings=toothings,
        allowable=tuple(limit * ALWAYS if name in dropped else limit for name, limit in law),
        face_width=_face(stage.face_width, dropped),
        modules=_modules(scene, own, stage, dropped),
        pinion_teeth=pinion,
        wheel_teeth=wheel,
        ratio=ratio,
        wheel_diameter=None if "wheel_diameter" in dropped else stage.wheel_diameter,
        overlap=0.0 if "overlap_ratio" in dropped else stage.overlap,
        axial_force=math.inf if "axial_force" in dropped else stage.axial_force,
    )
    return without_planets(made, dropped) if stage.planetary else made


def _widened(
    toothings: tuple[Toothing, ...], field: str, values: Sequence[Fraction]
) -> tuple[Toothing, ...]:
    """Return toothings of more profile shifts of the pinion, or sums, where these are given."""
    every = {getattr(cut, field) for cut in toothings}
    if None in every:
        return toothings
    wide = sorted({*every, *map(float, values)})
    return tuple(dict.fromkeys(replace(cut, **{field: x}) for cut in toothings for x in wide))


def _unlimited(cut: Toothing, dropped: set[str]) -> Toothing:
    """Return a toothing without the limits of its shifts that are dropped."""
    if cut.shifting is None:
        return cut
    limits = cut.shifting
    if "specific_sliding" in dropped:
        limits = replace(limits, sliding=math.inf)
    if "contact_ratio" in dropped:
        limits = replace(limits, contact_ratio=0.0)
    if "tip_thickness" in dropped:
        limits = replace(limits, tip_thickness=0.0)
    return replace(cut, shifting=limits)


def _spans(stage: Stage) -> tuple[tuple[str, Any], ...]:
    return ("wheel_teeth", stage.wheel_teeth), ("stage_ratio", stage.ratio)


def _open(name: str, dropped: set[str], span: tuple[Any, Any]) -> tuple[Any, Any]:
    """Return a range from 1 on, without the ends that are dropped."""
    gone = [{name, f"{name}_{end}"} & dropped for end in ("low", "high")]
    return (type(span[0])(1) if gone[0] else span[0]), None if gone[1] else span[1]


def _modules(
    scene: Scene, own: StageTable, stage: Stage, dropped: set[str]
) -> tuple[Fraction, ...]:
    """Return the modules of a stage, of a wider series where that of the file is dropped."""
    assert scene.teeth
    ends = own.size or scene.limits.module
    fixed = ends and own.size and ends[0] == ends[1]
    if not {"module", "module_low", "module_high", "modules"} & dropped:
        return stage.modules
    series = set(scene.teeth.sizes)
    if "modules" in dropped:
        series |= {m.exact[0] for m in SERIES[family(scene.teeth.modules)[-1]]}
    if fixed and "module" not in dropped:
        return stage.modules
    low, high = (None, None) if fixed or not ends else (end.exact[0] for end in ends)
    low = None if "module_low" in dropped else low
    high = None if "module_high" in dropped else high
    return tuple(m for m in sorted(series) if (low or m) <= m <= (high or m))


def _face(face: FaceWidth, dropped: set[str]) -> FaceWidth:
    """Return the choice of face widths without what is dropped."""
    over, least = face.over_module, face.least
    for k, end in enumerate(("low", "high")):
        if f"face_width_over_module_{end}" in dropped:
            over = (None, over[1]) if k == 0 else (over[0], None)
    least = Fraction(0) if "least_face_width" in dropped else least
    low, high, fixed = face.low, face.high, face.fixed
    if {"face_width", "face_width_over_diameter"} & dropped:
        low, high, fixed = Fraction(0), None, None
    low = Fraction(0) if "face_width_low" in dropped else low
    high = None if "face_width_high" in dropped else high
    if fixed is None:
        low = low or min(WIDTHS[0], high or WIDTHS[0])
        high = high or max(WIDTHS[1], low)
    return replace(face, low=low, high=high, fixed=fixed, over_module=over, least=least)


def _with_materials(scene: Scene) -> Scene:
    """Return the drive whose gears choose of all materials of the file."""
    every = tuple(one.name for one in scene.material)
    return _of_gears(scene, lambda table: {"materials": every} if table.materials else {})


def _with_grades(scene: Scene) -> Scene:
    """Return the drive of the best metallurgical grades that its file may have."""
    asked = scene.rating
    assert asked
    for grade in BEST_GRADES if asked.by_agma else (None,):
        best: dict[str, Any] = {} if grade is None else {"grade": grade}
        best |= {"iso_quality": QUALITIES[-1]} if asked.by_iso6336 else {}
        other = scene.model_copy(
            update={
                "gears": scene.gears.model_copy(update=best),
                "material": tuple(one.model_copy(update=best) for one in scene.material),
            }
        )
        other = _of_gears(other, lambda table, best=best: _own(table, best))
        if allowed(other):
            return other
    return scene


def _own(table: Any, best: dict[str, Any]) -> dict[str, Any]:
    """Return the values that a gear's own table has better."""
    return {key: value for key, value in best.items() if getattr(table, key) is not None}


def _of_gears(scene: Scene, update: Any) -> Scene:
    """Return the drive with changes of every table of gears: update(table)."""

    def made(table: Any) -> Any:
        new = update(table)
        return table.model_copy(update=new) if new else table

    stages = tuple(
        stage.model_copy(update={"pinion": made(stage.pinion), "wheel": made(stage.wheel)})
        for stage in scene.stage
    )
    return scene.model_copy(update={"gears": made(scene.gears), "stage": stages})


def _short_lived(scene: Scene) -> Scene:
    """Return the drive that need not last."""
    asked = scene.rating
    assert asked
    key = "life" if asked.life is not None else "input_revolutions"
    other: Scene = put(scene, ("rating", key), times(getattr(asked, key), LIFE))
    return other
