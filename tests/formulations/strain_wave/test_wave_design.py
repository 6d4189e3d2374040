"""Least pressure without interference: exchange, what it verifies, and what samplers hide."""

from dataclasses import replace

import numpy as np
import pytest

from gearopt.bench.wave_design import DEMAND, STARTS
from gearopt.errors import SolveError
from gearopt.formulations.strain_wave import sampled
from gearopt.formulations.strain_wave.demand import (
    FREE,
    equal_pressure,
    limits,
    shared_pressure,
    squares,
)
from gearopt.formulations.strain_wave.exchange import design_of, exchange, stretched
from gearopt.formulations.strain_wave.sharing import teeth_turned
from gearopt.formulations.strain_wave.sizing import Passage, problem, variables
from gearopt.optimise.clock import Clock
from gearopt.optimise.comparing.compare import compare
from gearopt.optimise.comparing.plan import Model, Plan
from gearopt.optimise.pareto.tradeoff import found
from gearopt.optimise.result import Budget, Outcome
from gearopt.optimise.solve import run
from gearopt.physics.strain_wave.clearance import clearances, interference, least_gaps, poses
from gearopt.physics.strain_wave.conjugate import contact
from gearopt.physics.strain_wave.neutral_curve import neutral_curve
from gearopt.physics.strain_wave.tooth_motion import motion

BEST = np.array([2.0, np.radians(28.519), 0.97, 0.9, 1.4, 0.4991])  # of another program


def posed(numbers, passages=()):
    made = problem(DEMAND, np.array(numbers), passages)
    return made, made.bounds()[2]


def test_the_text_gives_the_base_case_and_what_it_uses_of_every_limit():
    made, guess = posed(STARTS[0])
    batch = made.batch(guess[None])
    assert np.abs(batch.H - 1.0).max() < 1e-9  # the guess meshes and keeps its length
    used = dict(zip([r.name for r in made.rows.inequalities], batch.G[0], strict=True))
    assert batch.F[0, 0] == pytest.approx(117.375, abs=1e-3)
    assert used["rim_fatigue"] == pytest.approx(0.527, abs=1e-3)
    assert 3.0 * 100.0 / used["ratcheting"] == pytest.approx(331.0, abs=0.6)
    assert used["outer_radius"] == pytest.approx((40.5 + 0.5 * 1.75 + 3.0) / 45.0, rel=1e-12)
    assert used["pairs"] == pytest.approx(1.0 / 1.09613, abs=1e-5)
    assert max(used.values()) <= 1.0 + 1e-9


def test_the_limit_on_a_passage_is_how_far_the_tip_cuts_there():
    """By complex numbers: the tip on the tip circle, beside the corner of the circular spline."""
    start = (0.9, np.radians(15.0), 1.0, 0.6, 0.8, 0.5)
    found = least_gaps(design_of(DEMAND, start))[0]
    assert found.point == 1.0 and found.passing and found.gap < -0.03  # mm
    text, guess = posed(start, (Passage(6, True, found.angle),))
    batch = text.batch(guess[None])
    assert np.abs(batch.H - 1.0).max() < 1e-8  # it passes where the guess says
    used = dict(zip([r.name for r in text.rows.inequalities], batch.G[0], strict=True))
    made = design_of(DEMAND, start)
    gear, at = made.gearing, motion(made.gearing, made.curve, found.angle)
    tip = complex(made.contacts.point.x[-1], made.contacts.point.y[-1])
    z = complex(at.place.x, at.place.y) + np.exp(1j * at.turn) * tip
    pressure = np.arccos(gear.base_radius / gear.tip_radius)
    corner = gear.half_angle - np.tan(pressure) + pressure
    assert abs(z) == pytest.approx(gear.tip_radius, abs=1e-9)
    room = gear.base_radius * (corner - np.angle(z))
    assert 1e-5 - 0.1 * (used["interference[1]"] - 1.0) == pytest.approx(room, abs=1e-8)
    assert room == pytest.approx(found.gap, abs=1e-9)


def test_limits_of_numbers_and_of_populations_are_the_same():
    made = sampled.problem(DEMAND, np.array(STARTS[0]), tuple(sampled.OBJECTIVES))
    found = made.batch(np.array([STARTS[0], BEST]))
    used = dict(zip([r.name for r in made.rows.inequalities], found.G.T, strict=True))
    for k, numbers in enumerate((STARTS[0], BEST)):
        gearing = DEMAND.gearing(dict(zip(FREE, map(float, numbers), strict=True)))
        curve = neutral_curve(gearing)
        values = {v.name: v.guess for v in variables(DEMAND, np.array(numbers))}
        at = [contact(gearing, motion(gearing, curve, p)) for p in values["contact"]]
        exact = limits(DEMAND, gearing, curve, at)
        for name in ("rim_fatigue", "ratcheting", "spline_land", "minor_axis", "pairs"):
            assert used[name][k] == pytest.approx(exact[name], rel=1e-9)
        assert found.F[k, 0] == pytest.approx(max(squares(DEMAND, gearing, at)) ** 0.5, rel=1e-9)
        within = clearances(design_of(DEMAND, numbers), poses(0.75, 85.0), 3).min()
        assert used["interference"][k] == pytest.approx(1.0 - (within + 2e-5) / 0.05, abs=1e-4)
    volume = np.pi * (40.5 + 0.5 * 1.75 + 3.0) ** 2 * 10.0 / 100.0
    assert found.F[0, 1] == pytest.approx(volume, rel=1e-12)
    turned = teeth_turned(design_of(DEMAND, STARTS[0]), 1.0, None, (-0.25, 0.0, 0.25, 0.5))
    within = np.mean([(teeth.gaps <= 5e-3).sum() for teeth in turned])
    assert 1.0 / found.F[0, 2] == pytest.approx(within, rel=1e-12)
    assert within == pytest.approx(7.5, abs=0.26)
    assert found.F[1, 0] == pytest.approx(92.568, abs=0.05)


def test_designs_without_a_flank_break_all_limits():
    made = sampled.problem(
        replace(DEMAND, ranges={**DEMAND.ranges, "deflection": (0.6, 1.25)}), np.array(STARTS[0])
    )
    found = made.batch(np.array([[0.9, 0.35, 0.7, 0.6, 0.8, 0.5]]))
    assert (found.G > 1.0).all() and np.isfinite(found.F).all()


def test_other_deflections_of_one_flank():
    """um, from another program: backlash below the design's deflection, interference above."""
    made = design_of(DEMAND, STARTS[0])
    for w, gap in ((0.98, 3.16), (1.05, -8.55)):
        assert 1e3 * interference(stretched(made, w), 0.1).gap == pytest.approx(gap, abs=6e-3)


@pytest.mark.slow
def test_the_least_pressure_of_the_base_case():
    """92.568 MPa by another program with a smoothed limit at poses of 0.25 degrees."""
    found = exchange(DEMAND, np.array(STARTS[0]), Clock())
    assert found.result.status == "stationary" and found.clear
    assert found.result.value == pytest.approx(92.5710, abs=2e-4)
    assert found.result.value == pytest.approx(92.568, abs=4e-3)
    numbers = found.outcome.x[: len(FREE)]
    assert numbers == pytest.approx(BEST, abs=3e-4)
    assert interference(found.design, 0.01).gap >= -1e-9
    assert (
        len(found.rounds) == 1
        and found.rounds[0].gap == found.gap == least_gaps(found.design, 0.05)[0].gap
    )
    assert equal_pressure(DEMAND.duty, found.design) == pytest.approx(found.result.value, rel=1e-9)
    assert shared_pressure(DEMAND.duty, found.design) == pytest.approx(50.61, abs=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("start", STARTS[1:])
def test_every_start_leads_to_the_same_design(start):
    found = exchange(DEMAND, np.array(start), Clock())
    assert found.result.status == "stationary" and found.clear
    assert found.result.value == pytest.approx(92.5710, abs=2e-4)
    assert found.outcome.x[: len(FREE)] == pytest.approx(BEST, abs=3e-4)


@pytest.mark.slow
def test_what_limits_cost_is_what_solving_again_finds(monkeypatch):
    """MPa for 1 % of the outer radius and for 1 um of clearance, by differences of designs."""
    start = np.array(STARTS[0])

    def pressure(demand=DEMAND, more=0.0):
        monkeypatch.setattr("gearopt.formulations.strain_wave.sizing.LEAST_GAP", 1e-5 + more)
        return exchange(demand, start, Clock()).result.value

    prices = exchange(DEMAND, start, Clock()).result.multipliers
    ends = [pressure(replace(DEMAND, outer_radius=45.0 * (1.0 + s))) for s in (-1e-3, 1e-3)]
    assert 0.01 * prices["outer_radius"] == pytest.approx((ends[1] - ends[0]) / 0.2, rel=1e-4)
    least, most = (pressure(more=s) for s in (-5e-4, 5e-4))
    assert -0.01 * prices["interference[1]"] == pytest.approx(most - least, rel=1e-4)


@pytest.mark.slow
def test_passages_that_cut_are_added(monkeypatch):
    """Without any at first: teeth cut by 0.3 mm, as without the limit; then the tip's is found."""
    monkeypatch.setattr("gearopt.formulations.strain_wave.exchange.tip_leaves", lambda *_: ())
    found = exchange(DEMAND, np.array(STARTS[0]), Clock())
    assert [r.cuts for r in found.rounds] == [0, 1]
    assert found.rounds[0].pressure < 66.0 and found.rounds[0].gap < -0.25  # mm
    assert found.clear and found.result.value == pytest.approx(92.5710, abs=2e-4)


@pytest.mark.slow
def test_a_budget_that_ends_in_a_later_round_leaves_the_design_of_the_one_before(monkeypatch):
    """The first round knows no cut: its teeth cut each other by 0.3 mm, and that is told."""
    calls = []

    def stops(posed, *args, **options):
        calls.append(posed)
        result, outcome = run(posed, *args, **options)
        if len(calls) == 1:
            return result, outcome
        return replace(result, status="limit", objective={}), replace(outcome, x=None)

    monkeypatch.setattr("gearopt.formulations.strain_wave.exchange.run", stops)
    monkeypatch.setattr("gearopt.formulations.strain_wave.exchange.tip_leaves", lambda *_: ())
    found = exchange(DEMAND, np.array(STARTS[0]), Clock(Budget(seconds=60.0)))
    assert len(calls) == 2 and len(found.rounds) == 1
    assert found.design.complete and not found.clear and -0.4 < found.gap < -0.25  # mm


@pytest.mark.slow
def test_samplers_come_near_and_interference_is_looked_for_behind_them():
    made = sampled.problem(DEMAND, np.array(STARTS[0]))
    for method in ("annealing", "nsga2"):
        result, outcome = run(made, method, Budget(evaluations=2500), seed=1)
        assert (result.status == "feasible") == (
            sampled.least_clearance(DEMAND, outcome.x) > -1e-6
        )  # mm
        assert result.value is None or 92.5 < result.value < 110.0


def test_the_whole_wave_is_looked_at_where_samplers_do_not():
    """The exact text refuses a design that interferes between poses of 0.75 degrees."""
    base = np.array(STARTS[0])
    exact = sampled.limited(DEMAND, base, "pressure", {"volume_per_torque": 700.0})
    coarse = sampled.problem(DEMAND, base)
    rows = {r.name: k for k, r in enumerate(exact.rows.inequalities)}
    found = exact.batch(base[None])
    assert found.F[0, 0] == pytest.approx(117.375, abs=1e-3) and (found.G <= 1.0 + 1e-9).all()
    volume = np.pi * (40.5 + 0.5 * 1.75 + 3.0) ** 2 * 10.0 / 100.0
    assert found.G[0, rows["most_volume_per_torque"]] == pytest.approx(volume / 700.0)
    longer = base.copy()
    longer[3] = 0.6795  # addendum: above the largest that is free, by another program
    one, other = exact.batch(longer[None]), coarse.batch(longer[None])
    assert one.G[0, rows["interference"]] > 1.0
    names = [r.name for r in coarse.rows.inequalities]
    assert other.G[0, names.index("interference")] < one.G[0, rows["interference"]]


def test_an_answer_that_cuts_between_the_poses_of_a_search_is_none_wherever_it_goes():
    """Teeth cut by 0.44 um at an addendum of 0.68, another program; a search sees nothing of it."""
    cuts = np.array(STARTS[0])
    cuts[3] = 0.68

    def finds(*_):
        return Outcome(cuts, evaluations=1)

    seen = sampled.problem(DEMAND, cuts, ("pressure", "volume_per_torque"))
    assert (seen.batch(cuts[None]).G <= 1.0).all()
    one = replace(sampled.problem(DEMAND, cuts), methods={"finds": finds})
    result = run(one, "finds")[0]
    assert result.status == "failed" and not result.feasible and "interference" in result.message
    assert result.certificate["feasibility"] == pytest.approx(0.44e-3 / 0.05, rel=0.01)
    rows = compare(["finds"], lambda _: Model(one), Plan(1, 0.01, 1)).groups[0]
    assert rows.best is None and rows.rows[0].equal_time.summary.without == 1
    with pytest.raises(SolveError, match="interference"):
        found(replace(seen, methods={"exact": finds}), seen.rows.objectives, {}, "exact")


@pytest.mark.slow
def test_least_volume_under_a_pressure_is_stationary_and_clear():
    """As docs/harmonic_drive.md tells it; more pressure allows less volume."""
    found = {}
    for most in (110.0, 130.0):
        result, outcome = run(
            sampled.limited(DEMAND, np.array(STARTS[0]), "volume_per_torque", {"pressure": most}),
            "exchange",
        )
        assert result.status in ("stationary", "feasible")
        assert sampled.least_clearance(DEMAND, outcome.x) > -1e-6
        assert result.limits["most_pressure"] == pytest.approx(1.0, abs=1e-6)
        found[most] = result.value
    assert found == pytest.approx({110.0: 509.95, 130.0: 431.16}, rel=2e-4)
    assert found[110.0] < 618.6  # of the base case, at 117.4 MPa
