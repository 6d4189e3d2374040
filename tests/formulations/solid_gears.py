"""Finite elements of whole helical gears in space, as an oracle of load sharing by slices.

The section mesh of `tooth.mesh`, extruded along the helix; trilinear hexahedra with incompatible
modes (Wilson; Taylor), the bore held, factorised in the order of a nested dissection. A contact
line presses in every node plane over a stretch of the flank by Hertz's distribution; what the
stretch is wider than the contact, the half plane's logarithm adds.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from gearopt.physics.gears import Gear
from gearopt.physics.geometry.fillet import half_angle
from gearopt.physics.geometry.tooth import base_helix_angle
from gearopt.physics.tooth.mesh import Fineness, GearMesh, gear_mesh

LEAF = 60  # nodes that are not dissected further
PRESSED = 32  # points at which a pressure acts
AT_ONCE = 32  # loads


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

    def contact(self, tooth: int, plane: int, curvature: float, wide: float) -> tuple[Any, Any]:
        """Return nodes (n, 3 dofs) and forces (n, 3) of a unit transverse force on a flank.

        wide: half the stretch that is pressed [mm]; 0: the point alone, to measure there.
        """
        line = self.mesh.flanks[tooth]
        points = self.mesh.points[:, line]
        lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=1)))))
        base = 0.5 * float(self.gear.base_diameter)
        at = np.interp(np.hypot(base, curvature), np.hypot(*points), lengths)
        angle = np.pi / (PRESSED + 1) * np.arange(1, PRESSED + 1)
        places = at + wide * np.cos(angle)
        there = places <= lengths[-1]
        shares = np.where(there, np.sin(angle) ** 2, 0.0)
        shares /= shares.sum()
        edge = np.clip(np.searchsorted(lengths, places) - 1, 0, len(lengths) - 2)
        t = (places - lengths[edge]) / (lengths[edge + 1] - lengths[edge])
        weights = np.zeros(len(line))
        np.add.at(weights, edge, shares * (1.0 - t))
        np.add.at(weights, edge + 1, shares * t)
        some = np.flatnonzero(weights)
        pitch = 2.0 * np.pi / float(self.gear.teeth)
        turned = self.turn(self.planes[plane]) + tooth * pitch
        slope = np.arctan2(curvature, base) - half_angle(self.gear, np.hypot(base, curvature))
        slope = slope - turned
        axial = self.hand * np.tan(base_helix_angle(self.gear))
        normal = -np.array([np.cos(slope), np.sin(slope), -axial])
        nodes = line[some] + plane * self.mesh.points.shape[1]
        return nodes, weights[some][:, None] * normal

    def compliances(self, loads: list[Any], seen: list[list[Any]], wide: float) -> list[Any]:
        """Return, of each load (tooth, plane, curvature), how far those seen move inwards."""
        count = 3 * self.mesh.points.shape[1] * len(self.planes)
        answers = []
        for first in range(0, len(loads), AT_ONCE):
            part = range(first, min(first + AT_ONCE, len(loads)))
            forces = np.zeros((count, len(part)))
            for column, k in enumerate(part):
                nodes, force = self.contact(*loads[k], wide)
                for axis in range(3):
                    forces[3 * nodes + axis, column] = force[:, axis]
            moved = np.zeros_like(forces)
            moved[self.free] = self.factor(forces[self.free])
            for column, k in enumerate(part):
                row = []
                for place in seen[k]:
                    nodes, weight = self.contact(*place, 0.0)
                    at = 3 * nodes[:, None] + np.arange(3)
                    row.append(float((moved[at, column] * weight).sum()))
                answers.append(np.array(row))
        return answers


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
    """Contact lines at a travel: pairs k, planes j and positions s [mm] of n points; C (n, n).

    compliances [mm/N] of transverse forces along the line of action, contact included.
    """

    travel: float
    pairs: Any
    planes: Any
    positions: Any
    compliances: Any


def contact_lines(
    elastic: Any, force: float, planes: Any, travels: Any, size: float, wide: float
) -> list[Lines]:
    """Return the points in contact of both whole gears at travels of a base pitch, with C.

    elastic: an object with pair, path, bores, moduli, poissons; force [N]: the transverse one, of
    which a pair has the whole in the law of its contact; size, wide [mm]: elements and half the
    stretch that is pressed.
    """
    pair, path = elastic.pair, elastic.path
    slope = float(np.tan(base_helix_angle(pair.pinion)))
    reach = 0.5 * slope * float(planes[-1] - planes[0])
    lines = []
    for travel in travels:
        first = path.start - reach + travel * path.base_pitch
        count = int(np.ceil((path.end + reach - first) / path.base_pitch))
        grid = first + np.arange(count)[:, None] * path.base_pitch + slope * planes
        k, j = np.nonzero((grid > path.start + 1e-9) & (grid < path.end - 1e-9))
        lines.append((travel, k, j, grid[k, j]))
    answers = [np.zeros((len(k), len(k))) for _, k, _, _ in lines]
    for side in (0, 1):
        hand = 1.0 - 2.0 * side
        ends = np.array([path.start, path.end])
        curved = path.radii_of_curvature(ends)[side]
        radii = np.sort(np.hypot(0.5 * pair.gears[side].base_diameter, curved))
        body = solid(
            pair.gears[side],
            elastic.bores[side],
            hand,
            planes,
            (size, radii[0] - 0.5 * size, radii[1]),
            elastic.moduli[side],
            elastic.poissons[side],
        )
        loads: list[Any] = []
        seen: list[Any] = []
        for _, k, j, s in lines:
            rho = path.radii_of_curvature(s)[side]
            for i in range(len(k)):
                loads.append((0, int(j[i]), float(rho[i])))
                teeth = (hand * (k - k[i])).astype(int)
                seen.append(
                    [(int(a), int(b), float(c)) for a, b, c in zip(teeth, j, rho, strict=True)]
                )
        rows = body.compliances(loads, seen, wide)
        at = 0
        for n, (_, k, _, _) in enumerate(lines):
            answers[n] += np.array(rows[at : at + len(k)])
            at += len(k)
    cosine = float(np.cos(base_helix_angle(pair.pinion)))
    weights = plane_widths(planes)
    soft = sum(
        2.0 * (1.0 - nu**2) / (np.pi * e)
        for e, nu in zip(elastic.moduli, elastic.poissons, strict=True)
    )
    result = []
    for (travel, k, j, s), matrix in zip(lines, answers, strict=True):
        first, second = path.radii_of_curvature(s)
        round_ = first * second / (first + second) / cosine  # in the normal section
        line = force / float(pair.face_width)
        half = np.sqrt(4.0 * line * 0.5 * soft * round_)
        extra = soft / cosine / weights[j] * np.log(wide * cosine / half)
        symmetric = 0.5 * (matrix + matrix.T) + np.diag(extra)
        result.append(Lines(travel, k, j, s, symmetric))
    return result


def plane_widths(planes: Any) -> Any:
    """Return the width [mm] that every node plane stands for."""
    return np.gradient(planes) * np.where(np.isin(planes, planes[[0, -1]]), 0.5, 1.0)


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
