"""Finite elements of whole helical gears in space, as an oracle of load sharing by slices.

The section mesh of `tooth.mesh`, extruded along the helix; trilinear hexahedra with incompatible
modes (Wilson; Taylor), the bore held, factorised in the order of a nested dissection. Contact lines
press evenly on slices between node planes, as far as they reach, over a stretch of the flank by
Hertz's distribution; what the stretch is wider than the contact, the half plane's logarithm adds.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from gearopt.physics.contact_lines import Face
from gearopt.physics.gears import Gear
from gearopt.physics.geometry.fillet import half_angle
from gearopt.physics.geometry.tooth import base_helix_angle
from gearopt.physics.tooth.mesh import Fineness, GearMesh, gear_mesh

LEAF = 60  # nodes that are not dissected further
PRESSED = 32  # points at which a pressure acts
AT_ONCE = 32  # loads
LEAST = 0.1  # of a slice: a part that is shorter carries nothing


@dataclass(frozen=True)
class Solid:
    """A gear in space: planes z [mm] of nodes; hand 1: its teeth turn clockwise with z."""

    gear: Gear
    mesh: GearMesh
    planes: Any
    hand: float
    factor: Any
    free: Any

    def turn(self, z: Any) -> Any:
        """Return the angle [rad], clockwise, of the section at z."""
        return self.hand * np.tan(base_helix_angle(self.gear)) * z / (0.5 * self.gear.base_diameter)

    def contact(self, tooth: int, y: float, curvature: float, wide: float) -> tuple[Any, Any]:
        """Return nodes (n,) and forces (n, 3) of a unit transverse force on a flank at y [mm].

        wide: half the stretch that is pressed [mm]; 0: the point alone, to measure there.
        """
        line = self.mesh.flanks[tooth]
        points = self.mesh.points[:, line]
        lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=1)))))
        base = 0.5 * float(self.gear.base_diameter)
        at = np.interp(np.hypot(base, curvature), np.hypot(*points), lengths)
        angle = np.pi / (PRESSED + 1) * np.arange(1, PRESSED + 1)
        places = at + wide * np.cos(angle)
        shares = np.where(places <= lengths[-1], np.sin(angle) ** 2, 0.0)
        shares /= shares.sum()
        edge = np.clip(np.searchsorted(lengths, places) - 1, 0, len(lengths) - 2)
        t = (places - lengths[edge]) / (lengths[edge + 1] - lengths[edge])
        weights = np.zeros(len(line))
        np.add.at(weights, edge, shares * (1.0 - t))
        np.add.at(weights, edge + 1, shares * t)
        some = np.flatnonzero(weights)
        pitch = 2.0 * np.pi / float(self.gear.teeth)
        slope = np.arctan2(curvature, base) - half_angle(self.gear, np.hypot(base, curvature))
        slope = slope - self.turn(y) - tooth * pitch
        axial = self.hand * np.tan(base_helix_angle(self.gear))
        normal = -np.array([np.cos(slope), np.sin(slope), -axial])
        j = int(np.clip(np.searchsorted(self.planes, y) - 1, 0, len(self.planes) - 2))
        up = (y - self.planes[j]) / (self.planes[j + 1] - self.planes[j])
        across = self.mesh.points.shape[1]
        nodes = np.concatenate([line[some] + j * across, line[some] + (j + 1) * across])
        both = np.concatenate([(1.0 - up) * weights[some], up * weights[some]])
        return nodes, both[:, None] * normal

    def pressed(self, at: "Segment", wide: float) -> tuple[Any, Any]:
        """Return nodes and forces of a unit force that is even along a segment of a line."""
        rows = [self.contact(at.tooth, *end, wide) for end in at.gauss]
        return np.concatenate([r[0] for r in rows]), 0.5 * np.concatenate([r[1] for r in rows])

    def compliances(self, loads: Any, seen: Any, wide: float) -> list[Any]:
        """Return, of each loaded segment, how far those seen move inwards on average."""
        count = 3 * self.mesh.points.shape[1] * len(self.planes)
        answers = []
        for first in range(0, len(loads), AT_ONCE):
            part = range(first, min(first + AT_ONCE, len(loads)))
            forces = np.zeros((count, len(part)))
            for column, k in enumerate(part):
                nodes, force = self.pressed(loads[k], wide)
                for axis in range(3):
                    np.add.at(forces[:, column], 3 * nodes + axis, force[:, axis])
            moved = np.zeros_like(forces)
            moved[self.free] = self.factor(forces[self.free])
            for column, k in enumerate(part):
                row = []
                for place in seen[k]:
                    nodes, weight = self.pressed(place, 0.0)
                    at = 3 * nodes[:, None] + np.arange(3)
                    row.append(float((moved[at, column] * weight).sum()))
                answers.append(np.array(row))
        return answers


@dataclass(frozen=True)
class Segment:
    """A segment of a contact line on a tooth: (y, radius of curvature) [mm] at two Gauss points."""

    tooth: int
    gauss: tuple[tuple[float, float], tuple[float, float]]


def solid(
    gear: Gear, bore: float, hand: float, planes: Any, reach: Any, modulus: float, poisson: float
) -> Solid:
    """Return the factorised gear; planes z [mm]; reach: (size, lowest, highest) of `Fineness`."""
    mesh = gear_mesh(gear, bore, Fineness(*reach))
    across = mesh.points.shape[1]
    x, y = mesh.points
    turns = hand * np.tan(base_helix_angle(gear)) * planes / (0.5 * gear.base_diameter)
    rows = [
        np.stack([x * np.cos(t) + y * np.sin(t), y * np.cos(t) - x * np.sin(t), 0.0 * x + z])
        for t, z in zip(turns, planes, strict=True)
    ]
    points = np.concatenate(rows, axis=1).T
    layers = np.arange(len(planes) - 1)[:, None, None] * across
    low = mesh.quads[None] + layers
    elements = np.concatenate([low, low + across], axis=1).transpose(0, 2, 1).reshape(-1, 8)
    stiffness = _assembled(points, elements, modulus, poisson)
    held = np.tile(np.hypot(x, y) <= 0.5 * bore * (1.0 + 1e-6), len(planes))
    nodes = np.flatnonzero(~held)
    order = nodes[_dissection(points[nodes], elements, nodes, len(points))]
    free = (3 * order[:, None] + np.arange(3)).ravel()
    lu = splu(
        stiffness[free][:, free].tocsc(),
        permc_spec="NATURAL",
        options={"SymmetricMode": True, "DiagPivotThresh": 0.0},
    )
    return Solid(gear, mesh, planes, hand, lu.solve, free)


CORNERS = np.array(
    [
        [-1, -1, -1],
        [1, -1, -1],
        [1, 1, -1],
        [-1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [1, 1, 1],
        [-1, 1, 1],
    ],
    float,
)


def _assembled(points: Any, elements: Any, modulus: float, poisson: float) -> Any:
    """Stiffness matrix of hexahedra with incompatible modes, condensed an element."""
    shear = modulus / (2.0 * (1.0 + poisson))
    lame = modulus * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    law = np.diag([2.0 * shear] * 3 + [shear] * 3)
    law[:3, :3] += lame
    values, rows, columns = [], [], []
    for first in range(0, len(elements), 4000):
        some = elements[first : first + 4000]
        corners = points[some]
        centre = np.einsum("na,enb->eab", CORNERS / 8.0, corners)
        inner, whole = np.linalg.inv(centre), np.linalg.det(centre)
        total = np.zeros((len(some), 33, 33))
        for xi in CORNERS / np.sqrt(3.0):
            slopes = np.empty((8, 3))
            for a in range(3):
                b, c = (a + 1) % 3, (a + 2) % 3
                slopes[:, a] = (
                    CORNERS[:, a]
                    * (1.0 + CORNERS[:, b] * xi[b])
                    * (1.0 + CORNERS[:, c] * xi[c])
                    / 8.0
                )
            jacobian = np.einsum("na,enb->eab", slopes, corners)
            size = np.linalg.det(jacobian)
            of_nodes = np.einsum("eab,nb->ena", np.linalg.inv(jacobian), slopes)
            of_modes = (inner * (-2.0 * xi)[None, None, :]).transpose(0, 2, 1)
            of_modes = of_modes * (whole / size)[:, None, None]
            gradients = np.concatenate([of_nodes, of_modes], axis=1)
            strain = np.zeros((len(some), 6, 11, 3))
            for a in range(3):
                strain[:, a, :, a] = gradients[:, :, a]
            for k, (a, b) in enumerate(((0, 1), (1, 2), (2, 0))):
                strain[:, 3 + k, :, a] = gradients[:, :, b]
                strain[:, 3 + k, :, b] = gradients[:, :, a]
            strain = strain.reshape(len(some), 6, 33)
            total += strain.transpose(0, 2, 1) @ (law @ strain) * size[:, None, None]
        outer, mixed, modes = total[:, :24, :24], total[:, :24, 24:], total[:, 24:, 24:]
        total = outer - mixed @ np.linalg.solve(modes, mixed.transpose(0, 2, 1))
        dofs = (3 * some[:, :, None] + np.arange(3)).reshape(len(some), 24)
        values.append(total.ravel())
        rows.append(np.repeat(dofs, 24, axis=1).ravel())
        columns.append(np.tile(dofs, (1, 24)).ravel())
    count = 3 * len(points)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return coo_array(entries, shape=(count, count)).tocsr()


def _dissection(points: Any, elements: Any, nodes: Any, count: int) -> Any:
    """Return an order of the nodes by nested dissection along the axes."""
    number = np.full(count, -1)
    number[nodes] = np.arange(len(nodes))
    local = number[elements]
    a, b = np.repeat(local, 8, axis=1).ravel(), np.tile(local, (1, 8)).ravel()
    both = (a >= 0) & (b >= 0)
    graph = coo_array((np.ones(both.sum()), (a[both], b[both])), shape=(len(nodes),) * 2).tocsr()
    order: list[Any] = []
    todo = [(np.arange(len(nodes)), True)]
    while todo:
        part, divisible = todo.pop()
        if not divisible or len(part) <= LEAF:
            order.append(part)
            continue
        best = None
        inside = graph[part][:, part]
        for axis in range(3):
            along = points[part, axis]
            left = along <= np.median(along)
            if left.all():
                continue
            between = left & (inside @ (~left).astype(float) > 0.0)
            if best is None or between.sum() < best[0].sum():
                best = between, left
        assert best is not None
        between, left = best
        todo += [(part[between], False), (part[left & ~between], True), (part[~left], True)]
    return np.concatenate(order)  # what parts others comes after them


@dataclass(frozen=True)
class Lines:
    """Contact lines at a travel: pairs k, slices i and lengths [mm] of n segments; C (n, n).

    lengths across the face; compliances [mm/N] of transverse forces, contact included.
    """

    travel: float
    pairs: Any
    slices: Any
    lengths: Any
    compliances: Any


def contact_lines(
    elastic: Any, face: Face, force: float, travels: Any, size: float, wide: float
) -> list[Lines]:
    """Return the segments in contact of both whole gears at travels of a base pitch, with C.

    elastic: an object with pair, path, bores, moduli, poissons; force [N]: the transverse one, of
    which a pair has the whole in the law of its contact; size, wide [mm]: elements and half the
    stretch that is pressed.
    """
    pair, path = elastic.pair, elastic.path
    planes = face.width * (np.arange(face.count + 1) / face.count - 0.5)
    lines = []
    for travel in travels:
        first = path.start - face.reach + travel * path.base_pitch
        count = int(np.ceil((path.end + face.reach - first) / path.base_pitch))
        part, at = face.parts(path, first + np.arange(count) * path.base_pitch)
        k, i = np.nonzero(part > LEAST)
        ahead = at[k, i] - first - k * path.base_pitch
        y = ahead / face.slope if face.slope else face.places[i]
        lines.append((travel, k, i, part[k, i] * face.slice_width, y, at[k, i]))
    answers = [np.zeros((len(row[1]), len(row[1]))) for row in lines]
    for side in (0, 1):
        hand = 1.0 - 2.0 * side
        ends = np.array([path.start, path.end])
        radii = np.sort(
            np.hypot(0.5 * pair.gears[side].base_diameter, path.radii_of_curvature(ends)[side])
        )
        reach = size, radii[0] - 0.5 * size, radii[1]
        material = elastic.moduli[side], elastic.poissons[side]
        body = solid(pair.gears[side], elastic.bores[side], hand, planes, reach, *material)
        loads: list[Any] = []
        seen: list[Any] = []
        for _, k, _, long, y, s in lines:
            away = 0.5 / np.sqrt(3.0) * long
            gauss = [
                tuple(
                    (float(place), float(path.radii_of_curvature(at)[side]))
                    for place, at in ((y[n] + d, s[n] + face.slope * d) for d in (-a, a))
                )
                for n, a in enumerate(away)
            ]
            for n in range(len(k)):
                loads.append(Segment(0, gauss[n]))
                teeth = (hand * (k - k[n])).astype(int)
                seen.append([Segment(int(t), g) for t, g in zip(teeth, gauss, strict=True)])
        rows = body.compliances(loads, seen, wide)
        first = 0
        for n, row in enumerate(lines):
            answers[n] += np.array(rows[first : first + len(row[1])])
            first += len(row[1])
    return [
        Lines(*row[:4], 0.5 * (c + c.T) + np.diag(_local(elastic, row, force, wide)))
        for row, c in zip(lines, answers, strict=True)
    ]


def _local(elastic: Any, row: Any, force: float, wide: float) -> Any:
    """What the half plane adds to segments that are pressed wider than they touch."""
    cosine = float(np.cos(base_helix_angle(elastic.pair.pinion)))
    soft = sum(
        2.0 * (1.0 - nu**2) / (np.pi * e)
        for e, nu in zip(elastic.moduli, elastic.poissons, strict=True)
    )
    first, second = elastic.path.radii_of_curvature(row[5])
    round_ = first * second / (first + second) / cosine  # in the normal section
    half = np.sqrt(2.0 * force / float(elastic.pair.face_width) * soft * round_)
    return soft / cosine / row[3] * np.log(wide * cosine / half)


def shared(compliances: Any, load: float) -> tuple[Any, float]:
    """Return forces [N] on points without gaps that share a load, and the approach [mm]."""
    acts = np.ones(len(compliances), bool)
    while True:
        per = np.linalg.solve(compliances[np.ix_(acts, acts)], np.ones(int(acts.sum())))
        approach = load / per.sum()
        if (per >= 0.0).all():
            forces = np.zeros(len(acts))
            forces[acts] = approach * per
            return forces, float(approach)
        acts[np.flatnonzero(acts)[per < 0.0]] = False
