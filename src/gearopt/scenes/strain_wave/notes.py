"""Assumptions and notes of the answer for a strain wave gearing, in sentences."""

import math
from collections.abc import Iterator, Sequence

from gearopt.formulations.strain_wave.cutter_report import CONJUGATE
from gearopt.formulations.strain_wave.demand import (
    FREE,
    LAND,
    OUTSIDE_BASE,
    TIP_GAP,
    UNITS,
    Demand,
)
from gearopt.formulations.strain_wave.design import INVOLUTE, WaveDesign
from gearopt.formulations.strain_wave.exchange import CUTTING, RangeEnd
from gearopt.formulations.strain_wave.swept_report import DOUBLE_ARC
from gearopt.scenes.strain_wave.scene import STEEL, Scene

NOT_JUDGED = (
    "Not judged: fatigue of the rim, as [material] has no fatigue limits; those that are assumed "
    "are of steel."
)
STRAIGHT_HOB = (
    "Jun and Oh name the hob on the deformed blank and the modified involute without an equation. "
    "Taken here: a straight-sided hob of the gearing's module, one pitch a tooth, fed in until "
    "teeth touch. Not computed: its tip, fillets, and what bending the rim does to a tooth's shape."
)


def assumptions(scene: Scene) -> list[str]:
    """Return the assumptions behind the numbers, in sentences."""
    model = [
        "A plane section: no taper of the cup, no stretch of the neutral curve, no friction, no "
        "oil film; teeth do not bend by themselves, and the wave generator is rigid.",
        "Stress: Hertz's line contact; beyond the arc of contact teeth touch at an end of a flank, "
        "which is taken as the nearest conjugate point.",
        _mesh_torque(scene),
    ]
    if not scene.involute:
        model.append(
            "A tooth that touches at two points is taken to carry at the one of higher contact "
            "pressure; ratcheting is computed with the pressure angle at the middle of the flank."
        )
    if scene.cutter is not None and scene.cutter.generation != CONJUGATE:
        model.append(STRAIGHT_HOB)
    limits = (
        f"Limits of every gearing: lands and root spaces of {LAND:g} modules, tip circle "
        f"{100.0 * (OUTSIDE_BASE - 1.0):.2g} % outside the base circle, {TIP_GAP:g} modules "
        "between the tips on the minor axis."
    )
    assumed = [*_sizes(scene), *_materials(scene, scene.demand()), *_sharing(scene)]
    ranges = list(_ranges(scene)) if scene.has_free_sizes else []
    sentences = [*model, limits, *(f"Assumed: {words}." for words in (*assumed, *ranges))]
    return sentences if math.isfinite(scene.demand().bending_limit) else [*sentences, NOT_JUDGED]


def _mesh_torque(scene: Scene) -> str:
    """Return a sentence on the torque that the teeth carry."""
    held = scene.loads().reaction
    if held == 1.0:
        return (
            "Load: the teeth carry the output torque, as in Jun and Oh; the circular spline holds "
            f"{1.0 + 1.0 / scene.duty.ratio:.5g} times as much, as it holds the input torque, too."
        )
    return (
        f"Load: the teeth carry the torque on the circular spline, {held:.5g} times the output "
        "torque: the sum of output and input torque."
    )


def _sizes(scene: Scene) -> Iterator[str]:
    """Yield the sizes of which the file says nothing."""
    gears, teeth = scene.gears, scene.teeth
    if gears.face_width is None:
        yield f"a face width of {scene.face_width:.4g} mm, 1/9 of the outer diameter"
    if gears.shell is None:
        yield f"{scene.shell:.4g} mm of the circular spline outside its roots"
    if "clearance" not in gears.model_fields_set:
        yield f"a bottom clearance of {float(gears.clearance):g} modules"
    if scene.wave_generator.shape == "discs" and scene.wave_generator.wrap_angle is None:
        yield f"discs that carry over {math.degrees(scene.demand().wrap):g}° on each side"
    if not scene.involute and teeth.thickness is None:
        yield f"teeth {scene.law().thickness:.4g} mm thick at half their height, half the pitch"
    if teeth.law == DOUBLE_ARC:
        named = teeth.convex_radius, teeth.concave_radius, teeth.tangent
        values = (*scene.law().radii, scene.law().tangent)
        names = "convex radius", "concave radius", "tangent"
        rows = zip(names, values, named, strict=True)
        if left := [f"{name} {value:.4g} mm" for name, value, given in rows if given is None]:
            yield f"double arcs with {_series(left)}, in modules as in the literature"


def _materials(scene: Scene, demand: Demand) -> Iterator[str]:
    """Yield the material's data and factors of which the file says nothing."""
    steel, asked = scene.material, scene.design
    if steel.elastic_modulus is None:
        yield f"a modulus of elasticity of {1e-3 * demand.duty.moduli[0]:.4g} GPa"
    if "poisson_ratio" not in steel.model_fields_set:
        yield f"Poisson's ratio {demand.duty.poissons[0]:g}"
    if scene.steel and steel.bending_limit is None:
        yield f"a fatigue limit of the rim of {demand.bending_limit:g} MPa in bending"
    if scene.steel and steel.shear_limit is None:
        yield f"a fatigue limit of the rim of {demand.shear_limit:g} MPa in shear"
    if "notch" not in asked.model_fields_set:
        yield f"a notch factor of {demand.notch:g} of the teeth on the rim"
    if "safety" not in asked.model_fields_set:
        yield f"a safety of {demand.safety:g} against fatigue of the rim"
    if "ratcheting" not in asked.model_fields_set:
        yield f"a ratcheting torque of at least {demand.ratchet_factor:g} times the torque"
    if "pairs" not in asked.model_fields_set:
        yield f"a mean of at least {demand.pairs:g} conjugate pair per lobe and flank"


def _sharing(scene: Scene) -> Iterator[str]:
    """Yield stiffnesses of which the file says nothing."""
    sharing = scene.sharing
    by_modulus = "" if scene.modulus == STEEL else ", in proportion to the modulus of elasticity"
    if sharing.pair_compliance is None:
        yield f"a stiffness of {scene.pair_stiffness:,.0f} N/mm of a pair of teeth{by_modulus}"
    if scene.design.radial_compliance is None:
        yield (
            f"a radial stiffness of {scene.radial_stiffness:,.0f} N/mm against ratcheting"
            f"{by_modulus}, formula not checked against any source"
        )
    if "wall_over_rim" not in sharing.model_fields_set:
        yield f"a wall of the cup {float(sharing.wall_over_rim):g} times as thick as the rim"
    if sharing.rim == "elastic":
        yield "the rim is a chain of springs, its tension and the shear of the cup's wall"
        if sharing.cup_length is None:
            yield f"a cup {scene.loads().cup.length:.4g} mm long, three face widths"


def _ranges(scene: Scene) -> Iterator[str]:
    """Yield the ranges of which the file says nothing."""
    left = [n for n in FREE if getattr(scene.gears, n) is None and getattr(scene.design, n) is None]
    if left:
        ranges = scene.ranges()
        ends = ((n, *(_amount(n, end) for end in ranges[n])) for n in left)
        each = [f"{_name(name)} {low} to {high}" for name, low, high in ends]
        yield f"ranges of what is chosen: {_series(each)}"


def range_notes(scene: Scene, ends: Sequence[RangeEnd]) -> list[str]:
    """Return which numbers lie at ends of their ranges, and which ends limit the pressure."""
    if not ends:
        return []
    each = []
    for end in ends:
        given = getattr(scene.design, end.name) is not None
        side = "lower end" if end.least else "upper end"
        each.append(
            f"{_name(end.name)} {_amount(end.name, end.value)} ({side}, "
            f"{'of [design]' if given else 'assumed'})"
        )
    sentences = [f"At ends of their ranges: {_series(each)}."]
    if gains := [_name(end.name) for end in ends if end.gain is not None and end.gain > 0.0]:
        limit = (
            f"The ends of the ranges of {_series(gains)} limit the contact pressure: a slightly "
            "wider range of any one"
            if len(gains) > 1
            else f"The end of the range of {gains[0]} limits the contact pressure: a slightly "
            "wider range"
        )
        sentences.append(
            f"{limit}, with all other sizes chosen anew, would lower it (first order)."
        )
    return sentences


def notes(made: WaveDesign) -> list[str]:
    """Return notes on this gearing, in sentences."""
    sentences = [_windup(made)]
    if made.least_clearance_mm < CUTTING:
        sentences.append(
            f"Interference: teeth overlap by {-1e3 * made.least_clearance_mm:.3g} µm, at "
            f"{made.least_clearance_at_deg:.4g} degrees from the major axis."
        )
    elif made.law != INVOLUTE:
        sentences.append(
            "No interference: the circular spline's tooth spaces are cut by the motion of the "
            "flexspline's teeth."
        )
    else:
        sentences.append(
            "No interference was found: the least clearance was sought over the whole revolution "
            "of the wave generator."
        )
        sentences += _without_play(made)
    if made.cutter and made.cutter.forms and made.cutter.forms[-1].least_clearance_mm >= CUTTING:
        sentences.append(
            "This is of conjugate teeth. The teeth as the hob cuts them interfere nowhere; beside "
            "the cutter they are compared with conjugate ones."
        )
    if made.left_out:
        sentences.append(f"Left out for lack of time: {_series(made.left_out)}.")
    return sentences


def _windup(made: WaveDesign) -> str:
    """Return which parts wind up, and which are taken as rigid."""
    if made.elastic_rim:
        return (
            "The windup is that of teeth, rim and cup: wave generator, bearings and shafts are "
            "taken as rigid, so that a real gearing winds up further."
        )
    return (
        "The windup is that of the teeth alone: everything else is taken as rigid, so that a real "
        'gearing winds up many times as far. [sharing] rim = "elastic" adds rim and cup.'
    )


def _without_play(made: WaveDesign) -> list[str]:
    """Return that teeth cut each other on wave generators a little smaller, too, if they do."""
    near = [d for d in made.deflections if abs(d.deflection - made.deflection) < 0.03]
    if not near or max(d.least_clearance_mm for d in near) > CUTTING:
        return []
    each = " and ".join(
        f"{-1e3 * d.least_clearance_mm:.3g} µm at {d.deflection:.4g} modules" for d in near
    )
    return [f"No deviation of the deflection is tolerated: teeth would overlap by {each}."]


def _name(name: str) -> str:
    return name.replace("_", " ")


def _amount(name: str, value: float) -> str:
    """Return a number of FREE with its unit, an angle in degrees."""
    if name == "pressure_angle":
        return f"{math.degrees(value):.4g}°"
    unit = UNITS.get(name, "")
    return f"{value:.4g} {unit}".strip()


def _series(parts: Sequence[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
