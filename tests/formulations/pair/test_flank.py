"""Contact over the flank in slices: spur pairs, limits, modifications, the quadratic program."""

import numpy as np
import pytest
from dense_slices import matrix
from flank_pairs import flank, gears

from gearopt.formulations.pair.contact import PairMesh, at_loads, compliance_of
from gearopt.formulations.pair.flank import FlankMesh, Modifications, flank_loads
from gearopt.formulations.pair.flank_relief import peak_to_peak
from gearopt.formulations.pair.relief.meshing import NO_RELIEF, Relief
from gearopt.optimise.problem import Problem
from gearopt.optimise.solve import solve
from gearopt.optimise.terms import Terms, Var
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import usable_path
from gearopt.physics.iso6336.stiffness import mesh_stiffness, single_stiffness
from gearopt.physics.slice_sharing import Springs
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.ladder import USUAL, ring_torsion
from gearopt.physics.tooth.slices import Sliced, normal_section


@pytest.fixture(scope="module")
def plane():
    """The spur pair by the plane models, without relief and with it."""
    pair, bores, force = gears("spur")
    elastic = ElasticPair(pair, bores)
    torque = force * elastic.members[0].base_radius
    mesh = PairMesh.of(elastic, USUAL, torque, ring_torsion(elastic), 96, (0.5, 1.0))
    relief = Relief(0.012, 4.0), Relief(0.009, 5.0, 2.0)
    apart = [mesh.mesh.separations(NO_RELIEF, NO_RELIEF), mesh.mesh.separations(*relief)]
    return [at_loads(mesh, each) for each in apart], relief


@pytest.mark.parametrize("slices", [1, 8, 41])
@pytest.mark.parametrize("relieved", [0, 1])
def test_a_spur_pair_is_one_slice_or_many(plane, slices, relieved):
    mesh = flank("spur", slices, loads=(0.5, 1.0))
    if relieved:
        mesh = mesh.__class__(
            mesh.sliced, mesh.face, mesh.cycle, mesh.loads, mesh.modifications, plane[1]
        )
    for found, known in zip(flank_loads(mesh), plane[0][relieved], strict=True):
        assert found.transmission_error_mm == pytest.approx(known.transmission_error_mm, rel=1e-9)
        for name in (
            "peak_to_peak_mm",
            "largest_contact_stress_MPa",
            "mean_mesh_stiffness_MPa",
            "least_mesh_stiffness_MPa",
            "harmonics_mm",
        ):
            assert getattr(found, name) == pytest.approx(getattr(known, name), rel=1e-9)
        line = known.largest_tooth_force_N / 30.0
        assert found.largest_line_load_N_per_mm == pytest.approx(line, rel=1e-9)
        assert found.face_load_factor == pytest.approx(1.0, abs=1e-9)


def test_helix_angles_towards_zero_are_the_spur_pair():
    spur = flank_loads(flank("spur"))[0]
    away = []
    for angle in (0.1, 0.01, 0.001):
        found = flank_loads(flank("spur", angle=angle))[0]
        away.append(
            [
                abs(found.peak_to_peak_mm / spur.peak_to_peak_mm - 1.0),
                abs(found.mean_mesh_stiffness_MPa / spur.mean_mesh_stiffness_MPa - 1.0),
            ]
        )
    assert np.all(np.diff(away, axis=0) < 0.0) and max(away[-1]) < 2e-4


def test_sharing_at_a_position_is_the_optimum_of_its_quadratic_program():
    """Certified by a solver that knows nothing of slices: forces, and approach as a price."""
    mesh = flank("12 degrees", 5, crowning=0.01, misalignment=0.04, steps=12)
    at = 7
    springs = Springs(*(part[at] for part in mesh.springs[:3]), mesh.sliced.coupling)
    apart = mesh.separated(mesh.reliefs)[at]
    there = np.flatnonzero(np.isfinite(apart.ravel()))
    whole, load = matrix(springs)[np.ix_(there, there)], mesh.sliced.force
    gaps, count = apart.ravel()[there], len(there)

    def evaluate(x, p):
        f = list(x.f)
        total = sum(v + 0.0 for v in f)
        energy = sum(gap * v for gap, v in zip(gaps, f, strict=True))
        for i in range(count):
            energy = energy + 0.5 * load * f[i] * sum(whole[i, j] * f[j] for j in range(count))
        return Terms(
            {"energy": energy}, {"pull": tuple(1.0 - v for v in f)}, equal={"equilibrium": total}
        )

    posed = Problem("slices", (Var("f", "", -2.0, 2.0, 1.0 / count, count),), (), evaluate)
    found = solve(posed, "qp")
    assert found.status == "optimal"
    shared = mesh.sharing
    forces = shared.forces[0, at].ravel()[there]
    assert (forces == 0.0).any() and (forces > 0.0).sum() > 3
    assert np.array(found.design["f"]) * load == pytest.approx(forces, abs=1e-6 * load)
    assert found.multipliers["equilibrium"] == pytest.approx(shared.approach[0, at], rel=1e-8)


def random_mesh(rng):
    """A helical pair with modifications, misalignment and tip relief."""
    teeth = int(rng.integers(17, 40)), int(rng.integers(40, 120))
    module = rng.uniform(1.0, 6.0)
    pair = GearPair.of_teeth(
        module,
        *teeth,
        module * rng.uniform(4.0, 15.0),
        rng.uniform(0.02, 0.6),
        profile_shifts=(rng.uniform(0.0, 0.4), rng.uniform(-0.2, 0.2)),
    )
    bores = tuple(float(gear.root_diameter) / rng.uniform(1.5, 5.0) for gear in pair.gears)
    force = rng.uniform(20.0, 400.0) * float(pair.face_width)
    normal, path = normal_section(pair, bores), usable_path(pair)
    level = compliance_of(normal, USUAL, force)
    sliced = Sliced(pair, path, normal, level, force, 0.9 * ring_torsion(normal))
    gaps = Modifications(*(1e-3 * rng.uniform((0.0, -20.0, -20.0), 20.0)))
    long = rng.uniform(0.1, 0.8) * float(path.base_pitch)
    reliefs = Relief(rng.uniform(0.0, 0.02), long), Relief(rng.uniform(0.0, 0.02), long, 2.0)
    return FlankMesh.of(sliced, int(rng.integers(11, 42)), 12, (0.1, 1.0), gaps, reliefs)


@pytest.mark.parametrize("count", [12, pytest.param(200, marks=pytest.mark.slow)])
def test_random_pairs_meet_equilibrium_and_complementarity(count):
    rng = np.random.default_rng(count)
    for _ in range(count):
        mesh = random_mesh(rng)
        forces, approach, gaps = mesh.sharing
        loads = mesh.sliced.force * np.array(mesh.loads)[:, None]
        assert np.abs(forces.sum(axis=(-2, -1)) / loads - 1.0).max() < 1e-12
        assert forces.min() >= 0.0 and gaps.min() >= 0.0
        carries = forces > 0.0
        assert not gaps[carries].any()
        at = int(rng.integers(len(mesh.cycle.travels)))
        springs = Springs(*(part[at] for part in mesh.springs[:3]), mesh.sliced.coupling)
        apart = mesh.separated(mesh.reliefs)[at].ravel()
        there = np.isfinite(apart)
        for k in range(2):
            moved = (matrix(springs) @ forces[k, at].ravel())[there] + apart[there]
            assert moved - approach[k, at] == pytest.approx(
                gaps[k, at].ravel()[there], abs=1e-12 * max(approach[k, at], apart[there].max())
            )


def test_a_helix_correction_makes_up_for_a_misalignment():
    plain = flank_loads(flank("17 degrees"))[0]
    both = flank_loads(flank("17 degrees", misalignment=0.015, helix_correction=0.015))[0]
    assert both == plain
    tilted = flank_loads(flank("17 degrees", misalignment=0.015))[0]
    other = flank_loads(flank("17 degrees", misalignment=-0.015))[0]
    assert tilted.face_load_factor > 1.3 > 1.1 > plain.face_load_factor
    assert tilted.line_load_place_mm < 0.0 < other.line_load_place_mm


def test_crowning_unloads_the_ends_of_the_face():
    wide, crowned = (
        np.array(flank_loads(flank("spur", 15, crowning=c))[0].line_load_N_per_mm)
        for c in (0.0, 0.01)
    )
    middle = slice(5, -5)  # columns of the path in which one pair carries
    assert np.all(crowned[7, middle] > wide[7, middle])
    assert np.all(crowned[[0, -1], middle] < wide[[0, -1], middle])
    assert crowned == pytest.approx(crowned[::-1], rel=1e-9)


def test_relief_of_many_designs_is_that_of_each():
    mesh = flank("12 degrees", 7, steps=12, loads=(0.5, 1.0))
    amounts, lengths = np.array([0.0, 0.01, 0.02]), np.array([2.0, 3.0, 4.0])
    at_once = peak_to_peak(mesh, Relief(amounts, lengths), Relief(amounts[::-1], lengths))
    for k in range(3):
        first, second = Relief(amounts[k], lengths[k]), Relief(amounts[2 - k], lengths[k])
        assert at_once[k] == pytest.approx(peak_to_peak(mesh, first, second), rel=1e-12)


def test_mean_stiffness_lies_within_the_scatter_of_iso():
    """Spur pairs with bores are 22 % below c_gamma_alpha by finite elements."""
    for name in ("12 degrees", "17 degrees", "25 degrees"):
        pair, _, force = gears(name)
        mesh = flank(name)
        line = force * np.cos(pair.pinion.transverse_pressure_angle) / pair.face_width
        iso = mesh_stiffness(single_stiffness(pair, line), mesh.sliced.path.transverse_ratio)[0]
        assert 0.75 < flank_loads(mesh)[0].mean_mesh_stiffness_MPa / iso < 1.15


def test_the_usual_number_of_slices_is_close_to_many():
    """Peak to peak and stiffness of 41 slices against 161; largest line load within a tenth."""
    for name in ("12 degrees", "25 degrees"):
        usual, many = (flank_loads(flank(name, n))[0] for n in (41, 161))
        assert usual.peak_to_peak_mm == pytest.approx(many.peak_to_peak_mm, rel=0.01)
        stiff = many.mean_mesh_stiffness_MPa
        assert usual.mean_mesh_stiffness_MPa == pytest.approx(stiff, rel=1e-3)
        line = many.largest_line_load_N_per_mm
        assert usual.largest_line_load_N_per_mm == pytest.approx(line, rel=0.1)
