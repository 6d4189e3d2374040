"""The contact of a spur pair for its report: stiffness, load shares, transmission error, stress."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from gearopt.formulations.pair.design import Columns, ContactLoad, ContactPoint, PairContact
from gearopt.formulations.pair.relief.meshing import NO_RELIEF, Mesh
from gearopt.formulations.pair.relief.rules import tip_amounts
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.agma.factors import elastic_coefficient
from gearopt.physics.geometry.contact import ContactPath, diameters_at
from gearopt.physics.mesh_cycle import break_points, cycle
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.ladder import LEVELS
from gearopt.physics.tooth.validity import errors_in_mesh

DEAR = 1000.0  # us a position: of dearer models a few positions are computed, others interpolated
NODES = 33  # of those: the stiffness between them is off by less than 2e-3 (finite elements)
HARMONICS = 5  # of the mesh frequency, that are told


@dataclass(frozen=True)
class PairMesh:
    """An elastic spur pair in mesh at its loads.

    level: the model of its teeth; compliance: by it, of a pair of teeth [mm/N] at positions s [mm].
    force [N]: the normal force at the duty's torque, at which the contact compliance is taken for
    every load; loads: relative to it; mesh: at these.
    """

    elastic: ElasticPair
    level: str
    compliance: Callable[[Array], Array]
    force: float
    loads: tuple[float, ...]
    mesh: Mesh

    @classmethod
    def of(
        cls,
        elastic: ElasticPair,
        level: str,
        torque: float,
        coupling: float,
        steps: int,
        loads: Sequence[float],
    ) -> "PairMesh":
        """Return a pair over its cycle; torque [N mm] of the pinion, steps over a base pitch."""
        force = torque / elastic.members[0].base_radius
        compliance = compliance_of(elastic, level, force)
        forces = tuple(load * force for load in loads)
        mesh = Mesh.of(cycle(elastic.path, steps), compliance, coupling, forces)
        return cls(elastic, level, compliance, force, tuple(loads), mesh)

    def least_compliance(self, level: str) -> float:
        """Return the least compliance [mm/N] of a pair of teeth along its path by any model."""
        path = self.elastic.path
        positions = np.linspace(path.start, path.end, NODES)
        return float(LEVELS[level].compliance(self.elastic, positions, self.force).min())

    def of_loads(self, loads: Sequence[float]) -> Mesh:
        """Return the mesh at other loads, relative to that of the duty."""
        return replace(self.mesh, loads=tuple(load * self.force for load in loads))


def compliance_of(elastic: ElasticPair, level: str, force: float) -> Callable[[Any], Any]:
    """Return the compliance [mm/N] of a pair of teeth by a level, as a function of positions."""
    model = LEVELS[level]

    def exact(positions: Any) -> Any:
        return model.compliance(elastic, positions, force)

    return _interpolated(elastic, level, force) if model.cost > DEAR else exact


@lru_cache(maxsize=4)
def _interpolated(elastic: ElasticPair, level: str, force: float) -> Callable[[Any], Any]:
    """Return a compliance by a cubic spline through NODES positions, dense towards the ends.

    There, within half the width of the contact, it rises steeply as the pressure leaves the flank.
    The last few are kept: contact, relief and sensitivities of an answer ask for the same one.
    """
    from scipy.interpolate import CubicSpline

    path = elastic.path
    turns = 0.5 - 0.5 * np.cos(np.pi * np.arange(NODES) / (NODES - 1))
    nodes = path.start + turns * (path.end - path.start)
    values = LEVELS[level].compliance(elastic, nodes, force)
    spline: Callable[[Any], Any] = CubicSpline(nodes, values)
    return spline


def contact(
    made: PairMesh, coupling: str, iso: tuple[float, float], validity: Sequence[str]
) -> PairContact:
    """Return the contact of a pair of teeth without relief.

    coupling: the name of its model; iso: c' and c_gamma_alpha [MPa].
    """
    path = made.mesh.cycle.path
    positions = made.mesh.cycle.along(made.mesh.cycle.positions)
    teeth = teeth_columns(made.level, made.elastic, path, (coupling, made.mesh.coupling), iso)
    columns = {name: column(values) for name, values in _columns(made, positions).items()}
    return PairContact(
        **(teeth | columns),
        rule_relief_mm=tip_amounts(path, made.compliance, made.mesh.coupling, made.force),
        points=tuple(_points(made)),
        position_mm=column(positions),
        travel_mm=column(made.mesh.cycle.travels * path.base_pitch),
        loads=at_loads(made, made.mesh.separations(NO_RELIEF, NO_RELIEF)),
        validity=tuple(validity),
        in_mesh=errors_in_mesh(made.elastic, made.level, coupling),
    )


def teeth_columns(
    level: str,
    elastic: ElasticPair,
    path: ContactPath,
    coupling: tuple[str, float],
    iso: tuple[float, float],
) -> dict[str, Any]:
    """Fields of `ElasticTeeth`; coupling: its name and value, iso: as of `contact`."""
    known = LEVELS[level]
    errors = (*known.error, *known.wider)
    return {
        "level": level,
        "error_percent": (100.0 * min(errors), 100.0 * max(errors)),
        "plane": elastic.plane,
        "coupling": coupling[0],
        "coupling_mm_per_N": coupling[1],
        "pinion_bore_mm": elastic.bores[0],
        "wheel_bore_mm": elastic.bores[1],
        "base_pitch_mm": float(path.base_pitch),
        "contact_ratio": float(path.transverse_ratio),
        "iso_single_stiffness_MPa": iso[0],
        "iso_mesh_stiffness_MPa": iso[1],
    }


def column(values: Any) -> Columns:
    """Return an array as a column of a result."""
    return tuple(float(v) for v in values)


def _columns(made: PairMesh, positions: Any) -> dict[str, Any]:
    """Columns of positions s [mm] on the path, by the names of fields."""
    path, pair = made.mesh.cycle.path, made.elastic.pair
    first, second = diameters_at(pair, path, positions)
    rolled = [
        np.degrees(curvature / member.base_radius)
        for curvature, member in zip(
            path.radii_of_curvature(positions), made.elastic.members, strict=True
        )
    ]
    return {
        "pinion_diameter_mm": first,
        "wheel_diameter_mm": second,
        "pinion_roll_angle_deg": rolled[0],
        "wheel_roll_angle_deg": rolled[1],
        "pair_stiffness_MPa": 1.0 / (made.compliance(positions) * float(pair.face_width)),
    }


def _points(made: PairMesh) -> list[ContactPoint]:
    """Return the break points and the pitch point, in their order on the path."""
    path = made.mesh.cycle.path
    named = list(break_points(path).items())
    if path.start < 0.0 < path.end:
        named.append(("pitch point", 0.0))
    names, places = zip(*sorted(named, key=lambda row: row[1]), strict=True)
    columns = _columns(made, np.array(places))
    return [
        ContactPoint(
            point=name,
            position_mm=places[k],
            **{key: float(values[k]) for key, values in columns.items()},
        )
        for k, name in enumerate(names)
    ]


def at_loads(made: PairMesh, separations: Array) -> tuple[ContactLoad, ...]:
    """Contact at every load; separations (p, n) [mm] by relief, infinite if absent."""
    shared = made.mesh.sharing(separations)
    return tuple(
        _loaded(made, k, shared.forces[k], shared.approach[k]) for k in range(len(made.loads))
    )


def _loaded(made: PairMesh, k: int, forces: Array, error: Array) -> ContactLoad:
    """Contact at a load (from 0): forces (p, n) [N], approach (p,) [mm]."""
    force, round_ = made.mesh.loads[k], made.mesh.cycle
    shares = forces / force if force else np.zeros_like(forces)
    stress = contact_stress(made.elastic, round_.along(round_.positions), round_.along(forces))
    return ContactLoad(
        load=made.loads[k],
        largest_tooth_force_N=float(forces.max()),
        largest_share=float(shares.max()),
        largest_contact_stress_MPa=float(stress.max()),
        share=column(round_.along(shares)),
        contact_stress_MPa=column(stress),
        **motion(force, float(made.elastic.pair.face_width), round_.travels, error),
    )


def motion(force: float, width: float, travels: Array, error: Array) -> dict[str, Any]:
    """Fields of a `LoadedMesh` by its force [N], face width and transmission error [mm]."""
    mean, *harmonics = spectrum(travels, error)
    stiffness = force / (width * error) if force else np.zeros_like(error)
    return {
        "normal_force_N": force,
        "mean_transmission_error_mm": mean,
        "peak_to_peak_mm": float(np.ptp(error)),
        "harmonics_mm": column(harmonics),
        "mean_mesh_stiffness_MPa": spectrum(travels, stiffness)[0],
        "least_mesh_stiffness_MPa": float(stiffness.min()),
        "most_mesh_stiffness_MPa": float(stiffness.max()),
        "transmission_error_mm": column(error),
    }


def contact_stress(elastic: ElasticPair, positions: Any, forces: Any) -> Any:
    """Return Hertz's line stress sigma_H = Z_E sqrt(F/b (1/rho_1 + 1/rho_2)) [MPa].

    positions s [mm] and forces F [N] of one pair of teeth there. Source: Hertz's cylinders, as ISO
    6336-2 and AGMA 908 take them; edge contact at the tips is not covered.
    """
    (e1, e2), (nu1, nu2) = elastic.moduli, elastic.poissons
    coefficient = elastic_coefficient(e1, nu1, e2, nu2)
    first, second = elastic.path.radii_of_curvature(positions)
    load = forces / float(elastic.pair.face_width)
    return coefficient * np.sqrt(load * (1.0 / first + 1.0 / second))


def spectrum(travels: Any, values: Any, most: int = HARMONICS) -> list[float]:
    """Mean and amplitudes of the first harmonics of a function that repeats with travel 1.

    values at ascending travels from 0 to 1, equal travels where it jumps, are joined by lines,
    whose integrals against exp(-2 pi i k t) are exact: piecewise linear functions have exact
    harmonics. Amplitudes 2 |c_k|: of cosines.
    """
    start, step = travels[:-1], np.diff(travels)
    low, high = values[:-1], values[1:]
    amplitudes = [float((0.5 * (low + high) * step).sum())]
    for k in range(1, most + 1):
        turn = 2j * math.pi * k
        left, right = np.exp(-turn * start), np.exp(-turn * (start + step))
        slope = np.divide(high - low, step, out=np.zeros_like(step), where=step > 0.0)
        ends = (low * left - high * right) / turn  # of a line, by parts; a jump has none
        lines = ends + slope * (left - right) / turn**2
        amplitudes.append(2.0 * abs(complex(np.where(step > 0.0, lines, 0.0).sum())))
    return amplitudes
