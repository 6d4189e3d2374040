"""Sizing as geometric programs of rows: two solvers and a dual bound, and the rows are safe."""

import math

import gp_rows
import numpy as np
import pytest
from gp_rows import BETA, ELEVATOR, FIVE, THREE

from gearopt.formulations.toothing import Toothing
from gearopt.optimise.solve import solve
from gearopt.physics.agma import factors
from gearopt.physics.agma.bending import bending_factor, critical_theta, loaded_tooth
from gearopt.physics.agma.mesh import mesh_of, pitting_factor
from gearopt.physics.geometry.contact import contact_path

CASES = {
    "elevator, AGMA": lambda: gp_rows.agma(ELEVATOR),
    "three stages, AGMA": lambda: gp_rows.agma(THREE),
    "1000:1 in five, AGMA": lambda: gp_rows.agma(FIVE),
}
QUICK = ("elevator, AGMA",)
ALL = [c if c in QUICK else pytest.param(c, marks=pytest.mark.slow) for c in CASES]


@pytest.mark.parametrize("case", ALL)
def test_cvxpy_and_ipopt_agree(case):
    problem = CASES[case]()
    cone, found = (solve(problem, method) for method in ("gp", "ipopt"))
    assert found.status == cone.status == "optimal"
    assert cone.value == pytest.approx(found.value, rel=1e-9)
    assert 0.0 <= found.gap < 1e-9
    assert found.bound <= min(found.value, cone.value)


def random_starts(problem, count):
    """Points of sizes within a factor of 30 of the guess, ratios and factors of all the box."""
    rng = np.random.default_rng(5)
    low, high, guess = problem.bounds()
    ends = np.maximum(low, guess / 30.0), np.minimum(high, guess * 30.0)
    return [problem.starting(np.exp(rng.uniform(*np.log(ends)))) for _ in range(count)]


POWERS = [1e-3, 1.0, 1e3, 2e4]  # kW


@pytest.mark.slow
@pytest.mark.parametrize("kilowatts", POWERS)
def test_twenty_starts_of_any_size_end_at_one_optimum(kilowatts):
    drive = gp_rows.duty(kilowatts, 3520.0, 110.0, THREE.widest)
    problem = gp_rows.agma(drive)
    best = solve(problem)
    assert best.gap < 1e-9
    found = [solve(start) for start in random_starts(problem, 20)]
    assert [f.value for f in found] == pytest.approx([best.value] * 20, rel=1e-9)
    assert max(f.evaluations for f in found) < 100


def pairs(found, helix=BETA):
    """Exact gears of an answer, one a stage."""
    got = {name.removesuffix("_mm"): v for name, v in found.design.items()}
    rows = zip(*(got[n] for n in ("m", "d", "u", "b")), strict=True)
    toothing = Toothing(helix)
    return got, [toothing.of_diameter(m, d * math.cos(helix) / m, d, u, b) for m, d, u, b in rows]


def test_the_rows_of_agma_are_safe():
    """Factors of the answer against physics.agma."""
    found = solve(gp_rows.agma(THREE))
    got, gears = pairs(found)
    speed, constant = THREE.speed, gp_rows.agma_numbers().pitting
    for k, pair in enumerate(gears):
        d = got["d"][k]
        velocity = 0.5 * speed * d
        exact_spread = factors.load_distribution_factor(got["b"][k], d)
        assert got["kv"][k] == pytest.approx(factors.dynamic_factor(velocity, 7.0), rel=1e-8)
        assert exact_spread * (1 - 1e-8) <= got["km"][k] <= exact_spread * 1.003
        mesh = mesh_of(pair, "conventional", smooth=True)
        taken = constant * got["e"][k] * pair.ratio / (pair.ratio + 1.0)
        assert 0.85 < taken / pitting_factor(mesh) <= 1.0 + 1e-8
        tooth = loaded_tooth(mesh)
        form = float(bending_factor(tooth, critical_theta(tooth)).value)
        assert 0.85 < got["j"][k] / form <= 1.0 + 1e-8
        speed /= got["u"][k]


def test_the_usual_contact_ratio_is_no_lower_bound():
    """cos(beta) (1.88 - 3.2 (1/z1 + 1/z2)) is up to 10 % too large, at 35 degrees."""
    over = []
    for degrees in (0.0, 25.0, 35.0):
        pair = gp_rows.lattice(math.radians(degrees))
        inverse = 1.0 / pair.pinion_teeth + 1.0 / (pair.pinion_teeth * pair.ratio)
        taken = np.cos(np.radians(degrees)) * (1.88 - 3.2 * inverse)
        over.append(float(np.max(taken / contact_path(pair).transverse_ratio)))
    assert over == pytest.approx([1.0082, 1.0467, 1.1001], abs=1e-4)
