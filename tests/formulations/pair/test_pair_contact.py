"""The contact of a pair: numbers computed apart from gearopt, and what must hold of any pair."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearopt.formulations.pair.contact import (
    NODES,
    PairMesh,
    contact,
    contact_stress,
    spectrum,
)
from gearopt.formulations.pair.relief.meshing import Relief
from gearopt.formulations.pair.relief.rules import smooth_shares, without_error
from gearopt.formulations.pair.relief_map import Removed, break_even, finer
from gearopt.physics.gears import Gear, GearPair
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.ladder import LEVELS

LEVEL = "profile + Sainsot"
FORCE = 5675.614786538198  # N
# 25/50 teeth, m 3, b 30, T1 200 N m, bores 30 and 50, computed by other programs: shares at SAP,
# before LPSTC, after HPSTC and at EAP; approach there and at the pitch point [um]; the coupling is
# that of finite elements
ALONE = (0.4248, 0.5665, 0.5752, 0.4335), (8.986, 8.945, 8.986, 8.945)
COUPLED = (0.4008, 0.5880, 0.5992, 0.4120), (11.144, 11.117, 11.144, 11.117)


def gears(z1=25, z2=50, m=3.0, b=30.0):
    return GearPair(Gear(m, z1, m * z1, b), Gear(m, z2, m * z2, b))


def made(coupling, loads=(1.0,), steps=96):
    elastic = ElasticPair(gears(), (30.0, 50.0))
    meshed = PairMesh.of(elastic, LEVEL, 200_000.0, coupling, steps, loads)
    return contact(meshed, "given", (13308.6, 20127.6), ())


@pytest.mark.parametrize(
    ("coupling", "expected"), [(0.0, ALONE), (4.45e-3 / FORCE, COUPLED)], ids=["alone", "coupled"]
)
def test_shares_and_approach_of_the_reference_pair(coupling, expected):
    """Held to half a unit of the last digit; of the coupling three digits are known."""
    found = made(coupling)
    (load,) = found.loads
    alone = [k for k, share in enumerate(load.share) if share == 1.0]
    places = (0, alone[0] - 1, alone[-1] + 1, -1)
    assert load.normal_force_N == pytest.approx(FORCE, rel=1e-12)
    assert [load.share[k] for k in places] == pytest.approx(expected[0], abs=6e-5)
    error = np.array(load.transmission_error_mm)
    single = np.flatnonzero(np.diff(found.travel_mm) == 0.0)
    assert 1e3 * error[0] == pytest.approx(expected[1][0], abs=1e-3)
    assert 1e3 * error[single[0]] == pytest.approx(expected[1][1], abs=1e-3)
    assert 1e3 * error.max() == pytest.approx(15.79, abs=0.01)


def test_the_transmission_error_of_a_coarse_grid_grows_to_that_of_break_points():
    """48 evenly spaced positions saw 7.205 um; both sides of every jump add 0.01 um."""
    fine, coarse = (1e3 * made(0.0, steps=n).loads[0].peak_to_peak_mm for n in (960, 48))
    assert coarse == pytest.approx(7.205, abs=0.012) and coarse > 7.205
    assert fine == pytest.approx(coarse, abs=1e-3)


def test_loads_share_alike_and_no_load_carries_nothing():
    none, half, whole = made(1e-7, (0.0, 0.5, 1.0)).loads
    assert half.share == pytest.approx(whole.share, rel=1e-12)
    assert half.peak_to_peak_mm == pytest.approx(0.5 * whole.peak_to_peak_mm, rel=1e-9)
    assert set(none.share) == {0.0} and none.largest_contact_stress_MPa == 0.0
    assert none.peak_to_peak_mm == 0.0 and none.mean_mesh_stiffness_MPa == 0.0


def test_stiffness_of_the_five_points_and_of_the_mesh():
    """At the ends the models differ within 0.05 modules of the tip, where the source has them."""
    found = made(0.0)
    stiff = {row.point: 1e-3 * row.pair_stiffness_MPa for row in found.points}
    assert list(stiff) == ["SAP", "LPSTC", "pitch point", "HPSTC", "EAP"]
    inner = [stiff[name] for name in ("LPSTC", "pitch point", "HPSTC")]
    assert inner == pytest.approx([11.98, 12.17, 12.11], abs=0.006)
    assert 8.8 < stiff["SAP"] < 9.06 and 9.1 < stiff["EAP"] < 9.29
    assert 1e-3 * found.loads[0].mean_mesh_stiffness_MPa == pytest.approx(18.73, abs=0.05)


def test_contact_stress_at_the_lowest_single_point_is_that_of_a_rating():
    """928.8462 MPa: AGMA's with all factors 1, computed apart from gearopt."""
    elastic = ElasticPair(gears(), (30.0, 50.0))
    at = elastic.path.lowest_single
    assert contact_stress(elastic, at, FORCE) == pytest.approx(928.8462, abs=5e-5)
    assert contact_stress(elastic, at, 0.25 * FORCE) == pytest.approx(0.5 * 928.8462, abs=5e-5)


def test_harmonics_of_jumps_and_lines_are_exact():
    """A square wave has 2/(pi k), a sawtooth 1/(pi k), a sum of cosines its amplitudes."""
    square = spectrum(np.array([0.0, 0.5, 0.5, 1.0]), np.array([1.0, 1.0, 0.0, 0.0]))
    assert square == pytest.approx([0.5, *(2 / (math.pi * k) * (k % 2) for k in range(1, 6))])
    saw = spectrum(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    assert saw == pytest.approx([0.5, *(1 / (math.pi * k) for k in range(1, 6))])
    t = np.sort(np.random.default_rng(4).uniform(size=4000))
    t = np.concatenate([[0.0], t, [1.0]])
    wave = 3.0 + 2.0 * np.cos(2 * np.pi * t + 1.0) + 0.5 * np.sin(6 * np.pi * t)
    assert spectrum(t, wave) == pytest.approx([3.0, 2.0, 0.0, 0.5, 0.0, 0.0], abs=1e-5)


def test_columns_belong_together():
    """One row for every position, both sides of the two jumps, from tip to tip."""
    found = made(1e-7)
    columns = (
        *(found.pinion_diameter_mm, found.wheel_diameter_mm, found.pinion_roll_angle_deg),
        *(found.pair_stiffness_MPa, found.loads[0].share, found.loads[0].contact_stress_MPa),
    )
    assert {len(column) for column in columns} == {len(found.position_mm)}
    assert list(found.position_mm) == sorted(found.position_mm)
    assert found.pinion_diameter_mm[-1] == pytest.approx(81.0, rel=1e-12)
    assert found.wheel_diameter_mm[0] == pytest.approx(156.0, rel=1e-12)
    assert len(found.travel_mm) == len(found.loads[0].transmission_error_mm)
    assert found.travel_mm[-1] == pytest.approx(8.856394302, rel=1e-9)


@pytest.mark.parametrize("coupling", [0.0, 4.45e-3 / FORCE])
def test_a_relief_without_error_at_the_torque_breaks_even_at_half_of_it(coupling):
    """At another load its peak-to-peak is |F/F_n - 1| times that without relief: half and half."""
    meshed = PairMesh.of(ElasticPair(gears(), (30.0, 50.0)), LEVEL, 200_000.0, coupling, 96, (1.0,))
    mesh = meshed.mesh
    apart = without_error(mesh, smooth_shares(mesh), FORCE)
    there = np.where(mesh.cycle.present, apart, 0.0)
    removed = Removed(there, np.zeros_like(there), (1.0, 1.0), None)
    assert break_even(meshed, removed, (1.0,)) == pytest.approx(0.5, abs=1e-4)
    nothing = Removed(0.0 * there, 0.0 * there, (1.0, 1.0), None)
    assert break_even(meshed, nothing, (1.0,)) is None


@pytest.mark.parametrize("free", [False, True])
def test_a_relief_strays_further_between_the_computed_positions(free):
    """On 12 positions, against the difference of two approaches on a grid without break points."""
    coupling = 4.45e-3 / FORCE
    meshed = PairMesh.of(ElasticPair(gears(), (30.0, 50.0)), LEVEL, 200_000.0, coupling, 12, (1.0,))
    path, tips = meshed.mesh.cycle.path, (Relief(10e-3, 5.3), Relief(11e-3, 4.9))
    removed = Removed.of(meshed.mesh, tips)
    along = meshed.mesh.cycle.along
    points = np.stack(
        [along(meshed.mesh.cycle.positions), *map(along, (removed.pinion, removed.wheel))]
    )
    if free:  # by lines between the points
        removed = Removed(removed.pinion, removed.wheel, removed.lengths, None, points)
    deltas = []
    for t in np.linspace(0.0, 1.0, 601)[:-1]:
        at = path.start + (t + np.arange(2)) * path.base_pitch
        at = at[at <= path.end]
        e = [
            10e-3 * max(1 - (path.end - x) / 5.3, 0) + 11e-3 * max(1 - (x - path.start) / 4.9, 0)
            for x in at
        ]
        if free:
            e = np.interp(at, points[0], points[1] + points[2])
        k = 1.0 / (meshed.compliance(at) - coupling)
        ways = [(FORCE + k[i] * e[i]) / k[i] for i in range(len(at))]
        deltas.append(min(*ways, (FORCE + k @ e) / k.sum()))
    fine, coarse = finer(meshed, removed, (1.0,))[0], finer_of(meshed, removed)
    assert np.ptp(deltas) <= fine == pytest.approx(np.ptp(deltas), rel=1e-3)
    assert fine >= coarse if free else fine > 1.05 * coarse


def finer_of(meshed, removed):
    """Peak-to-peak [mm] on the computed positions."""
    mesh = meshed.mesh
    return float(mesh.criteria(removed.separations(mesh)).peak_to_peak[0])


def test_a_dear_model_is_asked_once_for_all_parts_of_an_answer(monkeypatch):
    asked = []

    def compliance(elastic, positions, force):
        asked.append(len(positions))
        return 1e-5 + 0.0 * positions

    dear = replace(LEVELS["finite elements"], compliance=compliance)
    levels = {**LEVELS, "of this test": dear}
    monkeypatch.setattr("gearopt.formulations.pair.contact.LEVELS", levels)
    for loads in ((1.0,), (0.5, 1.0)):  # of contact and of relief
        elastic = ElasticPair(gears(), (30.0, 50.0))
        PairMesh.of(elastic, "of this test", 200_000.0, 0.0, 12, loads)
    assert asked == [NODES]
