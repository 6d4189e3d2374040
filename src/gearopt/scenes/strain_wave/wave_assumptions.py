"""What a strain wave gearing takes for granted, and what is to be known of its answer."""

from collections.abc import Iterator

from gearopt.formulations.strain_wave.exchange import STEP_DEG
from gearopt.formulations.strain_wave.wave_report import WaveDesign
from gearopt.scenes.strain_wave.scene import PAIR, RATCHET, Scene


def assumptions(scene: Scene, made: WaveDesign) -> list[str]:
    """Return what the numbers take for granted, in sentences."""
    return [
        "A plane section: no taper of the cup, no stretch of the neutral curve, no friction, no "
        "oil film; teeth do not bend by themselves, and the wave generator is rigid.",
        "Stress: Hertz's line contact; beyond the arc of contact teeth touch at an end of a flank, "
        "which is taken as the nearest conjugate point.",
        *_assumed(scene, made),
    ]


def _assumed(scene: Scene, made: WaveDesign) -> Iterator[str]:
    """Yield the numbers of which the file says nothing."""
    sharing, material = scene.sharing, scene.material
    if sharing.pair_compliance is None:
        stiffness = PAIR * made.face_width_mm
        yield f"Assumed: a stiffness of {stiffness:.3g} N/mm of a pair of teeth."
    if material.bending_limit is None or material.shear_limit is None:
        demand = scene.demand()
        yield (
            f"Assumed: fatigue limits of {demand.bending_limit:g} MPa in bending and "
            f"{demand.shear_limit:g} MPa in shear, with a notch factor of {demand.notch:g}."
        )
    if scene.design.radial_compliance is None:
        stiffness = RATCHET * made.face_width_mm
        yield (
            f"Assumed: ratcheting by a radial stiffness of {stiffness:.3g} N/mm, a model that is "
            "not published."
        )
    if scene.gears.face_width is None:
        yield f"Assumed: a face width of {made.face_width_mm:.4g} mm, 1/9 of the outer diameter."
    if sharing.rim == "elastic":
        yield "Assumed: the rim is a chain of springs, its tension and the shear of the cup's wall."


def notes(made: WaveDesign) -> list[str]:
    """Return what is to be known of this gearing, in sentences."""
    found = [
        f"{made.pairs_in_contact:.3f} pairs of teeth per lobe and flank are conjugate in the mean; "
        f"{made.carrying_teeth} carry, as if {made.effective_teeth:.2f} carried alike.",
    ]
    if made.least_clearance_mm < -1e-9:
        found.append(
            f"Teeth cut each other by {-1e3 * made.least_clearance_mm:.3g} µm where the wave is at "
            f"{made.least_clearance_at_deg:.4g} degrees."
        )
    else:
        found.append(
            f"No teeth interfere at poses {STEP_DEG} deg apart over the whole wave; where a tip "
            "passes the other's tip circle between two of them they may, by some tenths of a µm."
        )
    return found
