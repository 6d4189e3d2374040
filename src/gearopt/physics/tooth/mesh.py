"""Meshes of quadrilaterals for the section of a gear: some of its teeth, their fillets, the ring.

Blocks of rows and columns in polar coordinates of the gear, the angle clockwise from the centre
line of the loaded tooth: under each tooth, and each stretch of ring without teeth, a block from its
outer line to the bore; on it the tooth, from where its fillet is inclined by 45 degrees. The right
flank of the loaded tooth, and the material below it, is fine.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear
from gearopt.physics.geometry.fillet import profile

DENSE = 1500  # points on fillet and on flank, between which a profile is interpolated: to 1e-6 m_n
TEETH = 5  # that are meshed: the loaded one and two neighbours on either side
COARSE_ELEMENT = 0.3  # modules: elements of unloaded teeth, and of the ring below its outer line
ROOT = 0.05  # modules: chords of fillets, which add material: 0.3 makes teeth 0.2 % too stiff
GROWTH = 1.35  # of a row of elements to the next, away from the loaded flank
BLEND = 0.5  # modules along a tooth over which columns turn from equal to graded ones
RADIAL = 0.3  # growth of elements per depth in the ring, and their most per distance to the axis
SPREAD = 0.2  # growth of elements per length along the loaded flank, outside the contact
PLAIN = np.radians(7.5)  # of ring without teeth that one element spans


@dataclass(frozen=True)
class Fineness:
    """How fine a mesh is: element size [mm] on the loaded flank between two radii [mm].

    halvings: how often all elements are split in four.
    """

    size: float
    lowest: float
    highest: float
    halvings: int = 0


@dataclass(frozen=True)
class GearMesh:
    """points x, y [mm] (2, N); quads (4, M), counter-clockwise; flanks, one a meshed tooth.

    flanks: of right flanks, by the place of their tooth (0: the loaded one, 1: the next one
    clockwise): the points of the profile from fillet to tip.
    """

    points: Any
    quads: Any
    flanks: dict[int, Any]


@dataclass(frozen=True)
class Side:
    """One side of a tooth, densely: half angles [rad], radii [mm] and arc lengths [mm]."""

    angles: Any
    radii: Any
    lengths: Any

    @classmethod
    def of(cls, angles: Any, radii: Any) -> "Side":
        """Return the side through these points."""
        steps = np.hypot(np.diff(radii), 0.5 * (radii[1:] + radii[:-1]) * np.diff(angles))
        return cls(angles, radii, np.concatenate(([0.0], np.cumsum(steps))))

    def at(self, lengths: Any) -> tuple[Any, Any]:
        """Return half angles and radii at arc lengths."""
        return np.interp(lengths, self.lengths, self.angles), np.interp(
            lengths, self.lengths, self.radii
        )


def gear_mesh(gear: Gear, bore: float, fineness: Fineness) -> GearMesh:
    """Return the mesh of a spur gear of floats; bore d_i [mm]."""
    below, above, fillet = _sides(gear)
    module, halvings = float(gear.normal_module), fineness.halvings
    pitch = 2.0 * np.pi / float(gear.teeth)
    near = min(TEETH // 2, (int(gear.teeth) - 1) // 2)
    down = _halved(_down(below.radii[0], 0.5 * bore, COARSE_ELEMENT * module), halvings)
    root = below.at(_halved(_even(below.lengths[-1], ROOT * module), halvings))
    blocks, flanks = [], {}
    for place in range(-near, near + 1):
        loaded = fineness if place == 0 else None
        across, up, blend = _tooth_steps(above, fillet, module, loaded)
        across, up = _halved(across, halvings), _halved(up, halvings)
        angles, radii = above.at(up)
        uniform = np.linspace(0.0, 1.0, len(across))
        graded = np.minimum(1.0 + (up - blend) / (BLEND * module), 1.0)
        shares = uniform[:, None] + graded * (across - uniform)[:, None]
        centre = place * pitch
        tooth = centre + (2.0 * shares - 1.0) * angles, np.broadcast_to(radii, shares.shape)
        outer = _outer(root, tooth[0][:, 0] - centre, radii[0])
        blocks += [ring_block(outer, centre, 0.5 * pitch, bore, down), tooth]
        flanks[place] = tooth[0][-1], radii
    rest = 2.0 * np.pi - (2 * near + 1) * pitch
    if rest > 1e-9:
        outer = _halved(np.linspace(-1.0, 1.0, int(np.ceil(rest / PLAIN)) + 1), halvings)
        line = 0.5 * rest * outer, np.full(len(outer), below.radii[0])
        blocks.append(ring_block(line, np.pi, 0.5 * rest, bore, down))
    return joined(blocks, flanks, 1e-7 * module)


def _sides(gear: Gear) -> tuple[Side, Side, float]:
    """Return a side from mid-space to the 45-degree point, from there to the tip, and its fillet.

    The last number: the arc length [mm] of the second one up to which it is fillet.
    """
    x, y = profile(gear, DENSE, DENSE)
    angles, radii, half = np.arctan2(x, y), np.hypot(x, y), np.pi / float(gear.teeth)
    steep = int(np.argmax(-np.diff(x) <= np.diff(y)))
    over = Side.of(angles[steep:], radii[steep:])
    fillet = float(over.lengths[DENSE - 1 - steep])
    angles, radii = angles[: steep + 1], radii[: steep + 1]
    if angles[0] > half:  # the fillets of a pointed tool meet above the root circle
        met = np.interp(-half, -angles, radii)
        inside = angles < half
        rows = np.append(half, angles[inside]), np.append(met, radii[inside])
        return Side.of(*rows), over, fillet
    land = np.linspace(half, angles[0], 100)[:-1]
    root = np.concatenate((np.full(len(land), radii[0]), radii))
    return Side.of(np.concatenate((land, angles)), root), over, fillet


def _tooth_steps(
    side: Side, fillet: float, module: float, fineness: Fineness | None
) -> tuple[Any, Any, float]:
    """Return shares of the width from left to right, and arc lengths from root to tip.

    fillet: arc length [mm] up to which the side is fillet; fineness: None of unloaded teeth. The
    last number: the arc length [mm] from which the shares hold; below they approach equal ones.
    """
    if fineness is None:
        return np.linspace(0.0, 1.0, 5), _even(side.lengths[-1], COARSE_ELEMENT * module), module
    at = side.lengths
    low, high = np.interp([fineness.lowest, fineness.highest], side.radii, at)
    away = np.maximum(np.maximum(low - at, at - high), 0.0)
    size = np.minimum(fineness.size + SPREAD * away, COARSE_ELEMENT * module)
    size = np.minimum(size, ROOT * module + SPREAD * np.maximum(at - fillet, 0.0))
    width = 2.0 * np.interp(0.5 * (low + high), at, side.angles * side.radii)
    blend = min(low, BLEND * module)
    return 1.0 - _graded(fineness.size / width, GROWTH)[::-1], _sized(at, size), blend


def _down(outer: float, inner: float, size: float) -> Any:
    """Return shares of the way from an outer radius to an inner one; size [mm] of the first."""
    way = np.linspace(0.0, outer - inner, 400)
    sizes = np.minimum(size + RADIAL * way, RADIAL * (outer - way))
    return _sized(way, sizes) / way[-1]


def _sized(lengths: Any, sizes: Any) -> Any:
    """Return steps from the first of some lengths to the last that are as long as sizes there."""
    middle = 0.5 * (1.0 / sizes[1:] + 1.0 / sizes[:-1]) * np.diff(lengths)
    count = np.concatenate(([0.0], np.cumsum(middle)))
    even = np.linspace(0.0, count[-1], max(int(np.ceil(count[-1])), 2) + 1)
    return np.interp(even, count, lengths)


def _even(length: float, size: float) -> Any:
    """Return equal steps from 0 to a length, none above a size."""
    return np.linspace(0.0, length, max(int(np.ceil(length / size)), 2) + 1)


def _graded(first: float, growth: float) -> Any:
    """Return steps from 0 to 1 that grow by a factor; the first about as long as told."""
    count = max(int(np.ceil(np.log1p((growth - 1.0) / first) / np.log(growth))), 2)
    return np.expm1(np.log(growth) * np.arange(count + 1)) / np.expm1(np.log(growth) * count)


def _halved(steps: Any, times: int) -> Any:
    """Return steps with the middle of each between them, so often."""
    for _ in range(times):
        steps = np.interp(np.arange(2 * len(steps) - 1) / 2.0, np.arange(len(steps)), steps)
    return steps


def _outer(root: tuple[Any, Any], across: Any, radius: float) -> tuple[Any, Any]:
    """Return angles and radii of the line below a tooth, from space to space."""
    angles, radii = root
    angle = np.concatenate((-angles[:-1], across, angles[-2::-1]))
    return angle, np.concatenate((radii[:-1], np.full(len(across), radius), radii[-2::-1]))


def ring_block(
    outer: tuple[Any, Any], centre: float, half: float, bore: float, down: Any
) -> tuple[Any, Any]:
    """Return a block from an outer line to the bore; half: half its angle [rad]."""
    angles, radii = outer
    even = half * np.linspace(-1.0, 1.0, len(angles))
    low = centre + even
    angle = low[:, None] + (centre + angles - low)[:, None] * (1.0 - down[::-1])
    radius = radii[:, None] + (0.5 * bore - radii)[:, None] * down[::-1]
    return angle, radius


def joined(blocks: list[Any], flanks: dict[int, Any], near: float) -> GearMesh:
    """Return one mesh of blocks of (angles, radii) (columns, rows), rows from the axis outwards."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    points, quads, first = [], [], 0
    for angle, radius in blocks:
        at = first + np.arange(angle.size).reshape(angle.shape)
        points.append(np.stack([radius * np.sin(angle), radius * np.cos(angle)]).reshape(2, -1))
        corners = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
        quads.append(np.stack([corner.ravel() for corner in corners]))
        first += angle.size
    nodes = np.concatenate(points, axis=1)
    tree = cKDTree(nodes.T)
    same = tree.query_pairs(near, output_type="ndarray")
    links = coo_array((np.ones(len(same)), (same[:, 0], same[:, 1])), shape=(first, first))
    count, label = connected_components(links, directed=False)
    merged = np.zeros((2, count))
    merged[:, label] = nodes
    named = {
        place: label[tree.query(np.stack([radius * np.sin(angle), radius * np.cos(angle)]).T)[1]]
        for place, (angle, radius) in flanks.items()
    }
    return GearMesh(merged, label[np.concatenate(quads, axis=1)], named)
