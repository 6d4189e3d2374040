"""Assumptions of the contact of a pair."""

from collections.abc import Iterator

from gearopt.formulations.pair.design import PairContact
from gearopt.formulations.pair.flank_design import FlankContact
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.iso6336.stiffness import LEAST_LINE_LOAD
from gearopt.scenes.drive.tables.rating import with_shared
from gearopt.scenes.pair.contact import UNBORED, line_load
from gearopt.scenes.pair.scene import Scene


def flank_assumptions(scene: Scene, flank: FlankContact, pair: GearPair) -> list[str]:
    """Assumptions of contact by slices, in sentences."""
    coupled = 1e6 * flank.coupling_mm_per_N
    return [
        "Contact: involute helicoids with the modifications of the file and no other errors, no "
        "friction, no dynamics; shafts and bearings give way by the misalignment of the file "
        "alone, and gears are held at their bores. Loads are those of the duty without "
        "application and dynamic factors. Teeth are taken to meet in the plane of action; "
        "deflected ones without relief meet before it, at the edge of a tip.",
        f"{flank.slices} slices across the face, spur gears of the normal section by "
        f"{flank.level}, in plane {flank.plane}; the contact compliance is that at the torque of "
        "the duty, at every load. Slices of a tooth hold each other as strips of a plate do.",
        f"All slices are coupled by {coupled:.3g} µm/kN ({flank.coupling}).",
        *["[flank] does not enter the rating, whose load factors follow the keys of [rating]."]
        * bool(scene.rating and scene.flank),
        *_by_default(scene),
        *_held(scene, flank),
        *_light(line_load(scene, pair)),
    ]


def contact_assumptions(scene: Scene, made: PairContact, pair: GearPair) -> list[str]:
    """Assumptions of the contact, in sentences."""
    strain = "strain (wide gears)" if made.plane == "strain" else "stress (narrow gears)"
    coupled = 1e6 * made.coupling_mm_per_N
    return [
        "Contact: exact involutes without errors and modifications, plane models, no friction, "
        "no dynamics; shafts and bearings are rigid, and gears are held at their bores. Loads are "
        "those of the duty without application, dynamic and face load factors, spread evenly over "
        "the face width. Teeth are taken to meet at SAP; without relief deflected teeth meet "
        "before it, at the edge of a tip.",
        f"Teeth by {made.level}, in plane {strain}; the contact compliance is that at the torque "
        "of the duty, at every load.",
        f"Neighbouring teeth are coupled by {coupled:.3g} µm/kN ({made.coupling}).",
        *_by_default(scene),
        *_held(scene, made),
        *_light(line_load(scene, pair)),
    ]


def _by_default(scene: Scene) -> Iterator[str]:
    """Yield that a table [relief] has another model of spur teeth, where the file names none."""
    asked = scene.sharing
    if not scene.helical and {asked.level, asked.coupling, asked.error} == {None}:
        yield (
            "[sharing] names no model: by default it is the finest with a table [relief], the "
            "usual one without. Compare gears with and without relief by one level and coupling."
        )


def _light(line: float) -> Iterator[str]:
    """Yield what is unverified of the stiffness by ISO 6336-1 at a line load F_t/b [N/mm]."""
    if line < LEAST_LINE_LOAD:
        yield (
            f"Unverified: stiffness by ISO 6336-1 is reduced by (F_t/b / {LEAST_LINE_LOAD:g} "
            f"N/mm)^0.25 at light loads, here {line:.3g} N/mm (without K_A)."
        )


def _held(scene: Scene, made: PairContact | FlankContact) -> Iterator[str]:
    """Yield where a gear without a bore is taken to be held."""
    table = scene.drive.stage[0]
    for member in MEMBERS:
        if not with_shared(getattr(table, member), scene.gears).bore:
            held = getattr(made, f"{member}_bore_mm")
            yield (
                f"The {member} has no bore in the file: it is taken as held at {held:.4g} mm, "
                f"1/{UNBORED:g} of its root circle."
            )
