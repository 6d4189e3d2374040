"""One stage of a drive with its rating by a standard, at every level of load."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.iso6336.static import static_given, static_operation
from gearopt.physics.loads import torque_ratios
from gearopt.physics.rating import Operation, Rating
from gearopt.scenes.drive.driving import drivers
from gearopt.scenes.drive.rating.gears import Tables, gear_tables, operations
from gearopt.scenes.drive.rating.options import of_stage
from gearopt.scenes.drive.scene import Scene

Materials = Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Mesh:
    """One stage (from 1) with its rating: hardest of all levels, and safety against all of them.

    standard: a module of `by_agma` and its like.
    """

    standard: Any
    stage: int
    pair: GearPair
    tables: Tables
    operations: tuple[Operation, ...]
    levels: tuple[Rating, ...]
    bending_safety: tuple[float, float]
    contact_safety: tuple[float, float]
    damages: tuple[tuple[float, float], tuple[float, float]] | None  # of bending, of contact
    grown: Callable[[float], "Mesh"]  # the same with all powers times a factor
    static: Rating | None = None  # under the peak torque, if there is one
    own: Any = None  # an `AsMesh` of a stage with planets or a ring

    @property
    def hardest(self) -> Rating:
        """Return the rating at the level of the largest stresses, which K_v raises with speed."""
        return max(self.levels, key=lambda level: level.bending_stress)

    @property
    def unverified(self) -> tuple[str, ...]:
        """Return the symbols of factors that have no second source."""
        return (*self.hardest.unverified, *(self.static.unverified if self.static else ()))

    @property
    def largest_load(self) -> tuple[float, float]:
        """Return torque of the pinion [N mm] and pitch-line velocity [mm/s] at the largest torque.

        At the working pitch circles, whichever circles the standard has its load at.
        """
        hardest = max(self.operations, key=lambda level: float(level.power / level.pinion_speed))
        moved = float(hardest.power / hardest.pinion_speed)
        return moved, 0.5 * float(self.pair.working_diameters[0] * hardest.pinion_speed)


def rated_meshes(
    scene: Scene, pairs: tuple[GearPair, ...], standard: Any, materials: Materials
) -> list[Mesh]:
    """Rate all stages; SolveError names those that have no rating, and why.

    materials: names of those chosen, of pinion and wheel of every stage; "": there was no choice.
    """
    meshes, refused = [], list[str]()
    slower = torque_ratios([float(pair.ratio) for pair in pairs], drivers(scene))
    for k, pair in enumerate(pairs):
        own, title = scene.stage_tables[k].as_mesh, f"stage {k + 1}"
        if own is not None:
            title, slower[k] = own.name.title, (own.slower, slower[k][1])
        known = flaws(pair, "", own.name.gears if own and own.name.suffix else None)
        sentences = [flaw.sentence[0].lower() + flaw.sentence[1:].rstrip(".") for flaw in known]
        try:
            if known and known[0].fatal:
                raise ValueError(sentences.pop(0))
            meshes.append(_mesh(scene, k, pair, slower[k][0], standard, materials[k]))
        except ValueError as reason:
            why = "; ".join([str(reason), *sentences])
            refused.append(f"{title} cannot be rated: {why}")
    if refused:
        raise SolveError("; ".join(refused))
    return meshes


def _mesh(
    scene: Scene, k: int, pair: GearPair, slower: float, standard: Any, named: tuple[str, str]
) -> Mesh:
    """Rate one stage (from 0); slower: input over pinion speed; named: its materials."""
    stage = scene.stage_tables[k]
    assert scene.rating
    rating = of_stage(scene.rating, stage)
    tables = gear_tables(stage, scene.gears, scene.material, k, named)
    steels = standard.steel(tables[0]), standard.steel(tables[1])
    practice = standard.practice(rating, stage, pair, tables)
    share = 1.0 if stage.as_mesh is None else stage.as_mesh.share
    levels = operations(rating, scene.duty, scene.load, slower, tables, share)
    given, peak = standard.given(rating, stage), rating.static_torque_factor
    (at_duty,) = operations(rating, scene.duty, (), slower, tables, share)

    def static(factor: float) -> Rating | None:
        if peak is None or not standard.STATIC:
            return None
        loaded = static_operation(at_duty, factor * float(peak))
        rated: Rating = standard.rate(pair, loaded, steels, practice, static_given(given))
        return rated

    def grown(factor: float) -> Mesh:
        loaded = tuple(replace(operation, power=factor * operation.power) for operation in levels)
        if not scene.load:
            rated = standard.rate(pair, loaded[0], steels, practice, given)
            both = rated.bending_safety, rated.contact_safety
            made = standard, k + 1, pair, tables, loaded, (rated,)
            return Mesh(*made, *both, None, grown, static(factor), stage.as_mesh)
        spectrum = standard.rate_spectrum(pair, loaded, steels, practice, given)
        damages = spectrum.bending_damage, spectrum.contact_damage
        both = spectrum.bending_safety, spectrum.contact_safety
        made = standard, k + 1, pair, tables, loaded, spectrum.levels
        return Mesh(*made, *both, damages, grown, static(factor), stage.as_mesh)

    return grown(1.0)
