"""Plane finite elements of whole gears: the compliance of a pair of teeth, and of neighbours.

Biquadratic quadrilaterals (scikit-fem) on the meshes of `tooth.mesh`, the bore held. A contact
presses by Hertz's distribution along the normal of the flank; what counts is the displacement at
its middle, along that normal. One factorisation a gear, whatever the number of loads. Small
strains, no friction, a rigid shaft. scikit-fem and scipy are imported where they are needed.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.tooth.elastic import ElasticGear, ElasticPair
from gearopt.physics.tooth.hertz import half_width
from gearopt.physics.tooth.mesh import Fineness, GearMesh, gear_mesh

PER_HALF_WIDTH = 3.0  # elements: halving all of them changes a stiffness by less than 1e-3
FINEST = 0.01  # modules: no element is smaller, however light the load
HALF_CONTACT = 0.04  # modules: half a contact under a load that teeth of steel may carry
AT_ONCE = 64  # loads, each of which takes a column of all dofs
PRESSED = 64  # points at which the pressure of a contact acts
EXTRA = "finite elements of teeth need scikit-fem: pip install 'gearopt[fem]'"


@dataclass(frozen=True)
class Body:
    """A gear whose stiffness is factorised, per unit face width.

    solve: displacements (dofs, N) [mm] of forces [N/mm]; flanks, of the right flank of each meshed
    tooth (0: the loaded one, 1: the next one clockwise): radii and arc lengths [mm] of its points
    (n,), and dofs x, y (2, 2 n - 1) of points and of the middles between them.
    """

    member: ElasticGear
    solve: Callable[[Any], Any]
    flanks: dict[int, tuple[Any, Any, Any]]
    dofs: int

    def place_on(self, tooth: int, radii: Any, offsets: Any) -> tuple[Any, Any]:
        """Return dofs (2, 3, ...) and shape functions (3, ...) on the right flank of a tooth.

        radii [mm]; offsets [mm] along the flank from there, towards the tip, beyond which the
        shape functions are 0; their shapes broadcast.
        """
        known, lengths, numbers = self.flanks[tooth]
        at = np.interp(radii, known, lengths) + offsets
        edge = np.clip(np.searchsorted(lengths, at) - 1, 0, len(lengths) - 2)
        t = (at - lengths[edge]) / (lengths[edge + 1] - lengths[edge])
        shapes = np.stack([(1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)])
        dofs = np.stack([numbers[:, 2 * edge + k] for k in range(3)], axis=1)
        return dofs, np.where(at <= lengths[-1], shapes, 0.0)

    def normals(self, tooth: int, curvatures: Any) -> Any:
        """Return normals (2, N) into a tooth at radii of curvature [mm] of its right flank."""
        turn = 2.0 * np.pi / float(self.member.gear.teeth) * tooth
        angle = self.member.load_line(curvatures).angle - turn
        return -np.stack([np.cos(angle), np.sin(angle)])

    def pressed(self, curvatures: Any, widths: Any) -> Any:
        """Return displacements (dofs, N) under unit forces on the loaded tooth, one a column.

        curvatures [mm] (N,) of the contacts, widths b_H [mm] (N,) half theirs. Pressure beyond the
        tip is left out, and the rest raised to a unit force. Source: Hertz's semi-ellipse, by the
        rule of Gauss and Chebyshev of the second kind.
        """
        angle = np.pi / (PRESSED + 1) * np.arange(1, PRESSED + 1)
        radii = self.member.load_line(curvatures).radius
        dofs, shapes = self.place_on(0, radii[:, None], np.multiply.outer(widths, np.cos(angle)))
        shares = shapes * np.sin(angle) ** 2
        shares = shares / shares.sum(axis=(0, 2))[:, None]
        forces = np.zeros((self.dofs, len(radii)))
        column = np.broadcast_to(np.arange(len(radii))[:, None], shares.shape)
        for axis, normal in enumerate(self.normals(0, curvatures)):
            np.add.at(forces, (dofs[axis], column), normal[:, None] * shares)
        return self.solve(forces)

    def moved(self, displacements: Any, tooth: int, curvatures: Any) -> Any:
        """Return how far flanks move inwards (N,) [mm], one of displacements (dofs, N) each."""
        radii = self.member.load_line(curvatures).radius
        dofs, shapes = self.place_on(tooth, radii, 0.0)
        there = (displacements[dofs, np.arange(len(radii))] * shapes).sum(axis=1)
        return (there * self.normals(tooth, curvatures)).sum(axis=0)


@lru_cache(maxsize=4)
def body(member: ElasticGear, fineness: Fineness) -> Body:
    """Return the factorised gear; ImportError as in `factorised`."""
    elements = gear_mesh(member.gear, member.bore, fineness)
    basis, solve = factorised(member, elements)
    flanks = {place: _flank(basis, line) for place, line in elements.flanks.items()}
    return Body(member, solve, flanks, int(basis.N))


def factorised(member: ElasticGear, made: GearMesh) -> tuple[Any, Callable[[Any], Any]]:
    """Basis of a mesh of scikit-fem, and the solver for displacements (dofs, N).

    Per unit face width, the bore held; plane stress or strain as the member says. ImportError that
    names the extra to install, without scikit-fem.
    """
    try:
        from skfem import Basis, ElementQuad2, ElementVector, MeshQuad
    except ImportError as error:
        raise ImportError(EXTRA) from error
    from scipy.sparse.linalg import splu

    mesh = MeshQuad(np.ascontiguousarray(made.points), np.ascontiguousarray(made.quads))
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    stiffness = _stiffness(member, basis)
    held = np.hypot(*basis.doflocs) <= 0.5 * member.bore * (1.0 + 1e-6)
    free = np.flatnonzero(~held)
    factor = splu(
        stiffness[free][:, free],
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True, "DiagPivotThresh": 0.0},  # positive definite
    )

    def solve(forces: Any) -> Any:
        displacements = np.zeros_like(forces)
        displacements[free] = factor.solve(np.ascontiguousarray(forces[free]))
        return displacements

    return basis, solve


def _stiffness(member: ElasticGear, basis: Any) -> Any:
    """Stiffness matrix (dofs, dofs) [MPa], sparse by columns.

    Of shape functions i along axis a and j along b, by their slopes i_a, i_b, ...: the integral of
    lambda i_a j_b + mu i_b j_a, and for a = b of mu grad i . grad j besides.
    """
    from scipy.sparse import coo_array

    across = 1.0 if member.plane == "stress" else 2.0
    shear = member.shear_modulus
    lame = 2.0 * shear * member.poisson / (1.0 - across * member.poisson)
    slopes = np.stack([fields[0].grad[0] for fields in basis.basis[::2]])  # (9, 2, elements, q)
    count, _, elements, _ = slopes.shape
    rows = (slopes * np.sqrt(basis.dx)).transpose(2, 0, 1, 3).reshape(elements, 2 * count, -1)
    products = (rows @ rows.transpose(0, 2, 1)).reshape(elements, count, 2, count, 2)
    whole = lame * products + shear * products.transpose(0, 1, 4, 3, 2)
    for axis in range(2):
        whole[:, :, axis, :, axis] += shear * np.einsum("niaja->nij", products)
    places = basis.element_dofs.T
    at = np.broadcast_arrays(places[:, :, None], places[:, None, :])
    entries = whole.ravel(), tuple(place.ravel() for place in at)
    return coo_array(entries, shape=(basis.N, basis.N)).tocsc()


def _flank(basis: Any, line: Any) -> tuple[Any, Any, Any]:
    """Return radii, arc lengths and dofs of a flank, whose points' numbers are given."""
    mesh = basis.mesh
    points = mesh.p[:, line]
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=1)))))
    pairs = np.sort(np.stack([line[:-1], line[1:]]), axis=0)
    count = mesh.p.shape[1]
    edges = mesh.facets[0].astype(np.int64) * count + mesh.facets[1]
    order = np.argsort(edges)
    facet = order[np.searchsorted(edges, pairs[0] * count + pairs[1], sorter=order)]
    dofs = np.empty((2, 2 * len(line) - 1), int)
    dofs[:, ::2], dofs[:, 1::2] = basis.nodal_dofs[:, line], basis.facet_dofs[:, facet]
    return np.hypot(*points), lengths, dofs


def fineness_of(elastic: ElasticPair, force: Any, halvings: int) -> tuple[Fineness, Fineness]:
    """Return how fine both gears are meshed for a force [N], or the least of some.

    The whole path of contact is fine: `PER_HALF_WIDTH` elements over the narrowest b_H on it,
    rounded down to steps of sqrt(2), so that loads of about one size share a factorisation.
    """
    path = elastic.path
    ends = np.array([path.start, path.end])
    module = float(elastic.pair.normal_module)
    narrow = half_width(elastic, ends, np.min(force)).min() / PER_HALF_WIDTH / module
    step = max(np.floor(2.0 * np.log2(narrow / FINEST)), 0.0)
    size = FINEST * module * 2.0 ** (0.5 * step)
    margin = 2.0 * PER_HALF_WIDTH * size
    of_gears = [
        Fineness(
            size, float(line.radius.min()) - margin, float(line.radius.max()) + margin, halvings
        )
        for line in elastic.load_lines(ends)
    ]
    return of_gears[0], of_gears[1]


def bodies(elastic: ElasticPair, force: Any, halvings: int = 0) -> tuple[Body, Body]:
    """Both gears, factorised; the last few gears are kept."""
    rows = zip(elastic.members, fineness_of(elastic, force, halvings), strict=True)
    pinion, wheel = (body(*row) for row in rows)
    return pinion, wheel


def _pressed_widths(elastic: ElasticPair, positions: Any, force: Any) -> tuple[Any, Any]:
    """Return half widths that a mesh resolves, and ln(those/b_H): of light loads above 0."""
    exact = half_width(elastic, positions, force)
    least = PER_HALF_WIDTH * FINEST * float(elastic.pair.normal_module)
    wide = np.maximum(exact, least)
    return wide, np.log(wide / exact)


def pair_compliance(elastic: ElasticPair, positions: Any, force: Any, halvings: int = 0) -> Any:
    """Return the compliance [mm/N] of a pair of teeth in contact, of both whole gears.

    positions s [mm], force F > 0 [N]; halvings: how often the elements are halved, to see whether
    they are small enough. Contacts too narrow for the smallest elements are pressed over a wider
    stretch, and the half plane's 2 f/(pi E b) ln(width/b_H) of each gear is added.
    """
    shape = np.broadcast_shapes(np.shape(positions), np.shape(force))
    places = np.broadcast_to(np.asarray(positions, float), shape).ravel()
    forces = np.broadcast_to(np.asarray(force, float), shape).ravel()
    elastic.load_lines(places)
    wide, lost = _pressed_widths(elastic, places, forces)
    width = float(elastic.pair.face_width)
    total = np.zeros(len(places))
    for each, at in zip(
        bodies(elastic, forces, halvings), elastic.path.radii_of_curvature(places), strict=True
    ):
        member = each.member
        total += 2.0 * member.plane_factor / (np.pi * member.rigidity) * lost
        for k in range(0, len(places), AT_ONCE):
            some = slice(k, k + AT_ONCE)
            total[some] += each.moved(each.pressed(at[some], wide[some]), 0, at[some]) / width
    return total.reshape(shape)[()]


def _matrix(elastic: ElasticPair, places: Any, force: float, halvings: int = 0) -> Any:
    """Return C (n, n) [mm/N] of pairs of teeth at positions [mm], neighbours in their order."""
    path = elastic.path
    wide, lost = _pressed_widths(elastic, places, force)
    compliances = np.zeros((len(places), len(places)))
    rows = zip(
        (1, -1), bodies(elastic, force, halvings), path.radii_of_curvature(places), strict=True
    )
    for side, each, at in rows:
        under = each.pressed(at, wide)
        for loaded in range(len(places)):
            column = np.broadcast_to(under[:, [loaded]], under.shape)
            for seen in range(len(places)):
                tooth = side * (seen - loaded)
                compliances[seen, loaded] += each.moved(column[:, [seen]], tooth, at[[seen]])[0]
    compliances /= float(elastic.pair.face_width)
    soft = sum(2.0 * m.plane_factor / (np.pi * m.rigidity) for m in elastic.members)
    return compliances + soft * np.diag(lost)


@lru_cache(maxsize=4)
def coupling(elastic: ElasticPair) -> float:
    """Return c_12 [mm/N], how far a pair of teeth gives way under a unit force on its neighbour.

    Both as far from the middle of the path, the mean of both directions, which are equal by
    reciprocity. Along the path it varies by 0.5 %, and with the width of the contact not at all;
    that is `HALF_CONTACT` here. 0 where no two pairs touch.
    """
    path = elastic.path
    if path.transverse_ratio <= 1.0:
        return 0.0
    unit = half_width(elastic, 0.0, 1.0)
    force = (HALF_CONTACT * float(elastic.pair.normal_module) / unit) ** 2
    first = 0.5 * (path.start + path.lowest_single)
    compliances = _matrix(elastic, np.array([first, first + path.base_pitch]), force)
    return float(0.5 * (compliances[0, 1] + compliances[1, 0]))
