"""Drives of least mass with rims, webs and hubs: against every candidate, and their bounds."""

import math
from dataclasses import replace

import numpy as np
import pytest
from blank_rings import some_blank
from brute_force import some_drive
from campaigns import few
from rated_brute_force import cheapest
from rated_drives import RACK, F, agma, rated_drive, some_iso, some_rated_drive
from test_teeth_brute_force import agrees

from gearopt.formulations.drive import continuous_sizing
from gearopt.formulations.drive.teeth import pairs, problem
from gearopt.formulations.drive.teeth.search import search
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.blanks import SOLID, Blank

SLOW = pytest.mark.slow
WEBS = Blank(3.0, None, 0.3, 12.0)


def with_blanks(train, blanks):
    """Return a drive of least mass whose gears have these blanks, by stage, as their ratings do."""
    stages = []
    for stage, both in zip(train.stages, blanks, strict=True):
        options = tuple(
            replace(o, standards=tuple(replace(s, blanks=both) for s in o.standards))
            for o in stage.options
        )
        stages.append(replace(stage, blanks=both, options=options))
    return replace(train, stages=tuple(stages), objective="mass", density=7.85e-9)


def random_blanks(train, seed):
    rng = np.random.default_rng([seed, 5])
    middle = [float(s.modules[min(len(s.modules) // 2, 6)]) for s in train.stages]
    return with_blanks(train, [(some_blank(rng, m), some_blank(rng, m)) for m in middle])


OTHERS = (3, 7, 11, 13, 18)


@pytest.mark.parametrize("number", few([8, 6, *OTHERS], 1))
def test_the_lightest_drive_is_that_of_all_trains(number):
    """With every module: a larger one may have room for a web."""
    assert agrees(random_blanks(some_drive(number, 2), number)).status == "optimal"


@pytest.mark.parametrize("standard", [agma, some_iso], ids=["agma", "iso"])
@pytest.mark.parametrize("block", [0, *(pytest.param(b, marks=SLOW) for b in range(1, 6))])
def test_the_lightest_rated_stage_is_that_of_all_candidates(standard, block):
    """Rims set K_B, Y_B and C_R of what is rated, one candidate at a time."""
    kinds = ("tied", "stepped", "fixed")
    for seed in range(10 * block, 10 * block + (10 if block else 2)):
        train = random_blanks(some_rated_drive(seed, 1, kinds, standard), seed)
        found = search(train, 1, Budget()).found
        best = cheapest(train)
        assert (found[0][0] if found else math.inf) == pytest.approx(best, rel=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(0, 6, 2))
def test_the_lightest_rated_drive_is_that_of_all_candidates(seed):
    train = random_blanks(some_rated_drive(seed, 2, ("tied", "stepped", "fixed")), seed)
    found = search(train, 1, Budget()).found
    best = cheapest(train)
    assert (found[0][0] if found else math.inf) == pytest.approx(best, rel=1e-11)


def pair_of_least_mass(blanks=(SOLID, WEBS), **changes):
    """Return one rated stage of least mass."""
    face = FaceWidth(F(3, 10), F(1))
    modules = tuple(map(F, ("1.25", "1.5", "2", "2.5")))
    train = rated_drive(F(4), [face], pinion_teeth=(20, 21), modules=modules, **changes)
    return with_blanks(train, [blanks])


def best(train):
    return search(train, 1, Budget()).found[0]


def test_mass_follows_density_and_full_webs_are_solid():
    """A rim of 1.5 modules has m_B of 0.67 and K_B of 1.95; from 2.7 modules on K_B is 1."""
    light, train = best(pair_of_least_mass()), pair_of_least_mass()
    assert best(replace(train, density=2.0 * 7.85e-9))[0] == pytest.approx(2.0 * light[0])
    full = replace(WEBS, web_over_width=1.0, bore=0.0)
    solid = best(pair_of_least_mass((SOLID, SOLID)))
    found = best(pair_of_least_mass((SOLID, full)))
    assert found == solid and light[0] < 0.7 * solid[0]
    masses = [best(pair_of_least_mass((SOLID, Blank(rim, None, 1.0))))[0] for rim in (1.5, 2.7)]
    assert masses[0] > masses[1] == solid[0]


def test_rows_know_the_blanks():
    """What rows use at a width is what the safety factors say, thin rims and bores included."""
    rng = np.random.default_rng(8)
    for standard in (agma(), some_iso()):
        train = pair_of_least_mass((Blank(1.6, None, 0.3, 8.0), Blank(None, 5.0, 0.2)))
        made = replace(standard, blanks=train.stages[0].blanks, suffix="")
        module, z1 = rng.uniform(1.0, 5.0, 200), rng.integers(15, 40, 200)
        pair = train.pair(0, module, z1, 3 * z1, 1.0)
        torque, width = 2e4 * module**2, 8.0 * module
        ends = (torque, torque), (100.0 + 0.0 * torque,) * 2
        used = made.rows(made.prepared(pair), pair, *ends, (1.2, 1.1)).used(width, width)
        exact = made.safeties(pair.of_width(width), torque, 100.0)
        worst = [1.2 / exact[0], 1.2 / exact[1], (1.1 / exact[2]) ** 2, (1.1 / exact[3]) ** 2]
        known = np.isfinite(used)
        assert used[known] == pytest.approx(np.max(worst, axis=0)[known], rel=1e-9)
        bare = replace(made, blanks=(SOLID, SOLID)).safeties(pair.of_width(width), torque, 100.0)
        assert known.sum() > 50 and (bare[0] > 1.05 * exact[0])[known].any()


@pytest.mark.parametrize("standard", [agma(), some_iso()], ids=["agma", "iso"])
def test_smooth_forms_know_rims_that_fit(standard):
    """Of casadi scalars: a rim of 1.6 modules lets S_F fall by 1.6 ln(2.242 2.25/1.6)."""
    import casadi as ca

    def bending(module, bore):
        made = replace(standard, blanks=(SOLID, Blank(1.6, None, 1.0, bore)), suffix="")
        tooth, choice = Toothing(0.2, (RACK, RACK)), made.choices(True)[0]
        unknown = made.guess(tooth.pair(2.0, 25, 100, 24.0), choice)
        with legacy_numpy():
            m = ca.SX.sym("m")
            pair = tooth.of_diameter(m, 25, 26.0 * m, 4.0, 12.0 * m)
            found = made.smooth(pair, 1e5 + 0.0 * m, 100.0 + 0.0 * m, choice, unknown)
            return float(ca.Function("S", [m], [found.safeties[1]])(module))

    thin, solid = bending(2.0, 20.0), bending(2.0, 150.0)  # whose hub is above the root circle
    expected = 1.6 * math.log(2.242 * 2.25 / 1.6)
    assert solid / thin == pytest.approx(expected, rel=1e-6)  # K_v knows the bore


@pytest.mark.slow
def test_real_valued_masses_have_a_bound(monkeypatch):
    """It holds for whole teeth of standard modules, too."""
    monkeypatch.setattr(continuous_sizing, "SEARCH", 0.3)
    for train in (pair_of_least_mass(), random_blanks(some_drive(11, 2), 11)):
        found = solve(continuous_sizing.problem(train))
        assert found.status in ("feasible", "stationary", "optimal") and found.bound > 0.0
        assert found.bound <= found.value
        whole, outcome = run(problem(train))
        assert found.bound <= whole.value * (1.0 + 1e-9)
        assert found.bound > 0.5 * whole.value
        assert len(pairs(train, outcome.x)) == len(train.stages)
