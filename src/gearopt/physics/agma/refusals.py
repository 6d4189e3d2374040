"""Pairs of gears for which AGMA 908 has no answer, by name, for one pair or arrays of them."""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.agma.bending import bending_factors
from gearopt.physics.agma.mesh import lowest_curvatures, mesh_of, pitting_factor
from gearopt.physics.gears import Gear, GearPair, signed
from gearopt.physics.geometry.contact import usable_path
from gearopt.physics.geometry.fillet import has_tip
from gearopt.physics.geometry.tooth import tip_thickness
from gearopt.physics.iso6336.refusals import has_teeth

REFUSALS = (
    "",
    "internal gear",
    "no centre distance",
    "pointed tool",
    "no root",
    "no involute",
    "pointed tooth",
    "contact ratio below 1",
    "usable contact ratio below 1",
    "contact ratio of 2 or more",
    "larger pinion",
    "contact at the base circle",
    "no bending",
)
SENTENCES = dict(
    zip(
        REFUSALS[1:],
        (
            "a ring is the wheel of a pair and has more teeth than its pinion",
            "the sum of the profile shifts is too small (with a ring too large) for any centre "
            "distance, or a given one makes the base circles overlap",
            "the flanks of a tool meet before its tip round begins",
            "a root circle has no diameter",
            "a tip circle lies inside its base circle",
            "a tooth is pointed below its tip circle",
            "the transverse contact ratio is below 1 and the overlap does not make up for it",
            "undercut or interference leaves a transverse contact ratio below 1, and the overlap "
            "does not make up for it",
            "AGMA 908 has no geometry factors for spur gears, and helical gears with an overlap "
            "ratio of at most 1, with a transverse contact ratio of 2 or more by their tip circles",
            "the pinion is the gear with fewer teeth: AGMA 908 takes I at its lowest point of "
            "single tooth contact",
            "the point of the load that AGMA 908 asks for lies at or below a base circle",
            "the radial part of the load outweighs bending, or there is no critical section (the "
            "load passes below it, or the tool is pointed above it)",
        ),
        strict=True,
    )
)


@dataclass(frozen=True)
class GeometryFactors:
    """I, (J_1, J_2) and the refusal, an index of REFUSALS; NaN where that is not 0."""

    pitting: Any
    bending: tuple[Any, Any]
    refusal: Any


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def geometry_factors(pair: GearPair, load: str = "highest single") -> GeometryFactors:
    """I and J of a pair of floats or of arrays of one shape, and the codes that refuse them.

    load as of `bending.loaded_tooth`. No exception for any finite numbers, and no NaN without a
    refusal. Flaws that a designer may accept refuse nothing: see `geometry.flaws`.
    """
    if np.ndim(fits := has_teeth(pair)) == 0 and not fits:  # z1 + z2 may be 0
        return GeometryFactors(np.nan, (np.nan, np.nan), 1)
    mesh = mesh_of(pair)
    pitting = pitting_factor(mesh)
    bending = [f.value for f in bending_factors(pair, load)]
    ratio, low = mesh.path.transverse_ratio, lowest_curvatures(mesh.path)
    single = mesh.overlap <= 1.0
    bare = [
        ~has_teeth(pair),
        ~(np.abs(pair.working_angle - 0.25 * np.pi) < 0.25 * np.pi),
        *_of_gears(pair),
        ~(ratio > 0.0) | (ratio < 1.0) & (ratio + mesh.overlap < 1.0),
        ~(usable_path(pair).transverse_ratio + mesh.overlap >= 1.0),
        single & (ratio >= 2.0),
        np.greater(pair.pinion_teeth, np.abs(pair.wheel_teeth)),
        ~(np.minimum(low[0], signed(low[1], pair.wheel_teeth)) > 0.0) & single | ~(pitting > 0.0),
        ~(np.minimum(*bending) > 0.0),
    ]
    flags = np.broadcast_arrays(*bare, np.zeros(np.shape(pitting), bool))[:-1]
    refusal = np.select(flags, range(1, len(REFUSALS)), 0)
    values = [np.where(refusal == 0, value, np.nan)[()] for value in (pitting, *bending)]
    return GeometryFactors(values[0], (values[1], values[2]), refusal[()])


def _of_gears(pair: GearPair) -> list[Any]:
    """Return whether a gear has a pointed tool, no root, no involute, a pointed tooth."""

    def either(fault: Any) -> Any:
        return fault(pair.pinion) | fault(pair.wheel)

    return [
        either(lambda g: ~np.asarray(has_tip(g))),
        either(lambda g: np.less_equal(g.root_diameter, 0.0) & np.greater(g.teeth, 0.0)),
        either(_no_involute),
        either(lambda g: ~(np.asarray(tip_thickness(g)) > 0.0)),
    ]


def _no_involute(gear: Gear) -> Any:
    return np.less_equal(np.abs(gear.active_tip_diameter), np.abs(gear.base_diameter))


def check_teeth(pair: GearPair) -> None:
    """Refuse a pair of floats whose numbers of teeth are of no pair, by ValueError."""
    if not has_teeth(pair):
        name = "internal gear"
        raise ValueError(f"{name}: {SENTENCES[name]}")


def single_factors(pair: GearPair, load: str = "highest single") -> GeometryFactors:
    """I and J of one pair of floats; ValueError names the rule that refuses them."""
    geometry = geometry_factors(pair, load)
    if geometry.refusal:
        name = REFUSALS[int(geometry.refusal)]
        raise ValueError(f"{name}: {SENTENCES[name]}")
    return geometry
