"""Contact over the flank of a pair in slices across its face: loads, pressure, errors."""

from functools import cached_property
from typing import Any

import numpy as np

from gearopt.formulations.pair.contact import column, motion
from gearopt.formulations.pair.flank_design import FlankLoad
from gearopt.formulations.pair.relief.meshing import NO_RELIEF, Relief
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.agma.factors import elastic_coefficient
from gearopt.physics.contact_lines import Face
from gearopt.physics.mesh_cycle import Cycle
from gearopt.physics.slice_sharing import SliceSharing, Springs, share_slices
from gearopt.physics.tooth.slices import Sliced, Slices

COLUMNS = 41  # positions on the path of a picture of the flank
TOUCHING = 1e-9  # of a slice: a part that is shorter does not touch
MISSING = 0.7  # of a slice: as much may be beyond the end of a contact line
SHORT = 1.0  # modules: contact lines that are shorter, at corners of a flank, are not told


@dataclass(frozen=True)
class Modifications:
    """Gaps of both flanks together [mm], in the direction of the transverse line of action.

    crowning C_beta: at both ends, a parabola; misalignment f: opens the end of the face where
    contact begins, in a straight line from the other; helix_correction C_Hbeta: opens that other
    end likewise, so that an equal one makes up for a misalignment. Source: ISO 21771:2007, crowning
    and helix slope modification.
    """

    crowning: float = 0.0
    helix_correction: float = 0.0
    misalignment: float = 0.0

    def gaps(self, face: Face) -> Array:
        """Return gaps [mm] (m,) of the slices of a face, the least of a straight part 0."""
        ahead = face.places / face.width
        slope = self.misalignment - self.helix_correction
        straight = slope * ahead + 0.5 * abs(slope)
        return np.asarray(self.crowning * (2.0 * ahead) ** 2 + straight)


@dataclass(frozen=True)
class FlankMesh:
    """All contact lines of a pair over one base pitch of travel, in slices, and its loads.

    loads: relative to the force of `sliced`; reliefs of the tips of pinion and wheel.
    """

    sliced: Sliced
    face: Face
    cycle: Cycle
    loads: tuple[float, ...]
    modifications: Modifications
    reliefs: tuple[Relief, Relief] = (NO_RELIEF, NO_RELIEF)

    @classmethod
    def of(
        cls,
        sliced: Sliced,
        slices: int,
        steps: int,
        loads: tuple[float, ...],
        modifications: Modifications,
        reliefs: tuple[Relief, Relief] = (NO_RELIEF, NO_RELIEF),
    ) -> "FlankMesh":
        """Return the mesh of a pair with so many slices; steps over a base pitch."""
        face = Face.of(sliced.pair, slices)
        cycle = face.cycle(sliced.path, steps)
        return cls(sliced, face, cycle, loads, modifications, reliefs)

    @cached_property
    def parts(self) -> tuple[Array, Array]:
        """Parts of slices in contact (p, n, m), and positions [mm] of their middles."""
        part, at = self.face.parts(self.sliced.path, self.cycle.positions)
        return np.where(part > TOUCHING, part, 0.0), at

    @cached_property
    def compliances(self) -> Slices:
        """Compliances of the slices (p, n, m)."""
        return self.sliced.compliances(self.parts[1])

    @cached_property
    def springs(self) -> Springs:
        """Springs of all slices (p, n, m)."""
        part, wide = self.parts[0], self.face.slice_width
        bed, links = self.compliances.springs(wide, self.face.slope)
        length = np.where(part > 0.0, part, 1.0) * wide
        return Springs(self.compliances.contact / length, bed, links, self.sliced.coupling)

    def separated(self, reliefs: tuple[Relief, Relief]) -> Array:
        """Gaps of unloaded slices [mm] (..., p, n, m) with tip reliefs.

        Infinite where none is; reliefs of pinion and wheel, of arrays (N,) for N designs.
        """
        part, at = self.parts
        path, flat = self.sliced.path, at.reshape(len(at), -1)
        ends = path.end - flat, flat - path.start
        removed = [r.removed(np.maximum(x, 0.0)) for r, x in zip(reliefs, ends, strict=True)]
        gaps = (removed[0] + removed[1]).reshape(*removed[0].shape[:-2], *at.shape)
        return np.where(part > 0.0, gaps + self.modifications.gaps(self.face), np.inf)

    @cached_property
    def sharing(self) -> SliceSharing:
        """Forces (l, p, n, m), approach (l, p), gaps (l, p, n, m) of every load."""
        forces = self.sliced.force * np.array(self.loads)
        return share_slices(self.springs, self.separated(self.reliefs)[None], forces[:, None])

    @cached_property
    def told(self) -> Any:
        """Whether slices (p, n, m) touch over their width, on a contact line that is not `SHORT`.

        The load of the part of a slice at the end of a line depends on how slices are cut, and the
        springs of a line as short as a tooth is high are not those of the models.
        """
        part, _ = self.parts
        long = part.sum(axis=-1, keepdims=True) * self.face.slice_width / self.sliced.cosine
        least = min(SHORT * float(self.sliced.pair.normal_module), 0.5 * float(long.max()))
        return (part >= 1.0 - MISSING) & (long >= least)

    def line_loads(self, k: int) -> Array:
        """Transverse forces per face width [N/mm] (p, n, m) at a load, counted from 0.

        0 where they are not `told`.
        """
        part, _ = self.parts
        length = np.where(part > 0.0, part, 1.0) * self.face.slice_width
        return np.where(self.told, self.sharing.forces[k] / length, 0.0)

    def stresses(self, line_loads: Array) -> Array:
        """Return Hertz's stress [MPa] of line loads F_bt/b [N/mm] (p, n, m).

        sigma_H = Z_E sqrt(F_bt/b cos(beta_b) (1/rho_t1 + 1/rho_t2)): force over length of the line
        is F_bt/b, and the radii of the normal section are rho_t/cos(beta_b). Source: Hertz's
        cylinders; ISO 21771:2007, radii of curvature in the normal section.
        """
        _, at = self.parts
        elastic = self.sliced.normal
        (e1, e2), (nu1, nu2) = elastic.moduli, elastic.poissons
        first, second = self.sliced.path.radii_of_curvature(at)
        curved = self.sliced.cosine * (1.0 / first + 1.0 / second)
        return np.asarray(elastic_coefficient(e1, nu1, e2, nu2) * np.sqrt(line_loads * curved))

    @cached_property
    def path_columns(self) -> Array:
        """Positions s [mm] on the path of the pictures of a flank."""
        path = self.sliced.path
        return np.linspace(float(path.start), float(path.end), COLUMNS)

    def picture(self, values: Array) -> tuple[tuple[float, ...], ...]:
        """Return values (p, n, m) over the flank, one row per slice, at `path_columns`.

        Between the positions at which a slice is met by lines; at a jump, the mean.
        """
        _, at = self.parts
        rows = []
        for j in range(self.face.count):
            there = self.told[..., j]
            s, v = at[..., j][there], values[..., j][there]
            order = np.argsort(s, kind="stable")
            rows.append(column(np.interp(self.path_columns, s[order], v[order])))
        return tuple(rows)


def flank_loads(mesh: FlankMesh) -> tuple[FlankLoad, ...]:
    """Contact over the flank at every load."""
    return tuple(_loaded(mesh, k) for k in range(len(mesh.loads)))


def _loaded(mesh: FlankMesh, k: int) -> FlankLoad:
    """Contact over the flank at a load, counted from 0."""
    force = mesh.loads[k] * mesh.sliced.force
    line = mesh.line_loads(k)
    stress = mesh.stresses(line)
    (s_line, y_line), (s_stress, y_stress) = (_place(mesh, each) for each in (line, stress))
    return FlankLoad(
        load=mesh.loads[k],
        largest_line_load_N_per_mm=float(line.max()),
        line_load_position_mm=s_line,
        line_load_place_mm=y_line,
        face_load_factor=_face_load_factor(mesh, k) if force else 1.0,
        largest_contact_stress_MPa=float(stress.max()),
        contact_stress_position_mm=s_stress,
        contact_stress_place_mm=y_stress,
        open_share=_open_share(mesh, k),
        line_load_N_per_mm=mesh.picture(line),
        contact_stress_MPa=mesh.picture(stress),
        **motion(force, mesh.face.width, mesh.cycle.travels, mesh.sharing.approach[k]),
    )


def _place(mesh: FlankMesh, values: Array) -> tuple[float, float]:
    """Return s and y [mm] where a value (p, n, m) is largest."""
    at = np.unravel_index(int(values.argmax()), values.shape)
    return float(mesh.parts[1][at]), float(mesh.face.places[at[2]])


def _face_load_factor(mesh: FlankMesh, k: int) -> float:
    """Largest over mean of the force per face width, averaged over a base pitch."""
    forces = mesh.sharing.forces[k].sum(axis=1)
    average = np.trapezoid(forces, mesh.cycle.travels, axis=0)
    return float(average.max() / average.mean())


def _open_share(mesh: FlankMesh, k: int) -> float:
    """Part of the length of the contact lines that carries nothing, averaged over a base pitch."""
    part, _ = mesh.parts
    idle = np.where(mesh.sharing.forces[k] > 0.0, 0.0, part).sum(axis=(1, 2))
    whole = part.sum(axis=(1, 2))
    travels = mesh.cycle.travels
    return float(np.trapezoid(idle, travels) / np.trapezoid(whole, travels))
