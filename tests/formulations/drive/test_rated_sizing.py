"""Real-valued sizes of rated drives: a published pair, the bounding program, the smooth form."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from rated_drives import FREE, agma, by, rated_drive

from gearopt.formulations.drive import continuous_sizing, sizing_text, teeth
from gearopt.formulations.drive.rated_continuous import bounding_program as rated_bound
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength import RATED, agma_floor, agma_smooth
from gearopt.formulations.strength.standard import Box, Load, Option
from gearopt.optimise.form import form
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.physics.agma import factors
from gearopt.physics.agma.rating_factors import Practice, Steel, distribution
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.gears import Rack

F = Fraction
SHARP = Rack(tip_radius=0.38)
HOLLOW = (SOLID, Blank(rim_over_module=2.5, web_over_width=0.4))


def published_pair(given=()):
    """15 kW, 1450 rpm, u = 3: a published case, gear cycles 1e8/3."""
    steels, hours = (Steel(hardness=300.0), Steel(hardness=260.0)), 1e8 / 60.0 / 1450.0
    standard = agma(steels, hours=hours, given=dict(given))
    face = FaceWidth(F(3, 10), F(1), over_module=(F(8), F(14)), least=F(254, 10))
    modules = tuple(F(m) for m in "1.5 2 2.5 3 3.5 4 5".split())
    made = {"toothings": (Toothing(0.0, (SHARP, SHARP)),), "options": (Option((standard,)),)}
    stage = Stage((), face, modules, (18, 60), **made)
    speed = 1450.0 * math.pi / 30.0
    return Train(15e6 / speed, F(3), F(0), (stage,), speed=speed, law=RATED)


@pytest.fixture(autouse=True)
def short_search(monkeypatch):
    monkeypatch.setattr(continuous_sizing, "SEARCH", 0.3)


@pytest.mark.slow
def test_a_published_pair_of_least_volume(monkeypatch):
    """The published numbers follow with their constants, which are those of metric prints.

    V = 200 v in K_v, s_ac = 2.22 HB + 200 MPa, -0.930e-4 in C_ma.
    """
    monkeypatch.setattr(factors, "FEET_PER_MINUTE", 5.0)
    monkeypatch.setitem(factors.ALIGNMENT, "commercial", (0.127, 0.0158, -0.930e-4))
    train = published_pair({"s_ac": (2.22 * 300 + 200, 2.22 * 260 + 200)})
    monkeypatch.setattr(continuous_sizing, "SEARCH", 30.0)  # it takes 0.5 s where nothing else runs
    found = solve(continuous_sizing.problem(train))
    assert found.status == "optimal" and found.value == pytest.approx(1703170, abs=0.5)
    assert found.design["pinion_teeth"] == pytest.approx(140 / 3, rel=1e-9)
    assert found.design["module_mm"] == pytest.approx(1.9231, abs=5e-5)
    assert found.design["face_width_mm"] == pytest.approx(26.924, abs=5e-4)
    (pair,) = sizing_text.pairs(train, np.array(list(found.design.values()), float))
    standard = train.stages[0].options[0].standards[0]
    form = standard.case(pair, train.torque, train.speed, {}).geometry.bending
    assert np.round(form, 5).tolist() == [0.48796, 0.51277]
    binding = {name for name, used in found.limits.items() if used > 1.0 - 1e-6}
    assert {"wheel_contact[1]", "face_width_over_module_high[1]"} < binding
    whole = solve(teeth.problem(train))
    assert whole.value == pytest.approx(1717666, abs=0.5)
    assert found.bound < found.value < whole.value
    assert found.gap < 0.05


@pytest.mark.slow
def test_nothing_is_traced_for_ipopt_when_time_is_over(monkeypatch):
    """What it would be given are starts; with seconds they are tried."""
    train, tried = replace(published_pair(), objective="mass", density=7.85e-9), []
    train = replace(train, stages=tuple(replace(s, blanks=HOLLOW) for s in train.stages))
    monkeypatch.setattr(continuous_sizing, "_by_ipopt", lambda *a: tried.append(a) or [])
    over = solve(continuous_sizing.problem(train), budget=Budget(seconds=0.0))
    assert over.status == "limit" and over.value > 0.0 and not tried
    monkeypatch.setattr(continuous_sizing, "whole", lambda *a: [])
    none = solve(continuous_sizing.problem(train), budget=Budget(seconds=0.0))
    assert none.message == "stopped before a design was found" and not tried
    solve(continuous_sizing.problem(train), budget=Budget(seconds=100.0))
    assert len(tried) == 1


@pytest.mark.slow
def test_with_the_constants_of_the_inch_form_that_pair_is_smaller():
    """0.2 % each by K_v and s_ac; its whole teeth are others, as b/m = 14 is no longer in the way.

    No published number: the shares are those of the two constants, to first order.
    """
    found, whole = (solve(made.problem(published_pair())) for made in (continuous_sizing, teeth))
    assert found.value == pytest.approx(1703170 * (1 - 0.0022 - 0.0018), rel=3e-4)
    assert [whole.design[n] for n in ("pinion_teeth", "wheel_teeth")] == [44, 132]


CASES = [(0.0, "spur"), (0.2, "low"), (0.4363, "low"), (0.4363, "conventional")]
HARD, TEMPERED = Steel("carburised"), Steel(hardness=320.0)
SOFTER = replace(TEMPERED, hardness=256.0)
UNLIKE = Rack(addendum=1.2), Rack(addendum=0.85, dedendum=1.5)
STEELS = {  # and hours, factors that are given, practice
    "tempered": ((TEMPERED, SOFTER), 2e4, {}, Practice(quality=7.0)),
    "carburised, brief": ((HARD, HARD), 20.0, {}, Practice(7.0, "open", True, 0.3, True)),
    "nitrided": ((Steel("nitrided", 2, 300.0),) * 2, 2e4, {"I": 0.1}, Practice(9.0, "precision")),
    "hard on soft": ((HARD, SOFTER), 0.2, {"K_v": 1.2, "J": (0.4, 0.45)}, Practice(5.0)),
}
TIGHT = {  # of CASES in turn
    "tempered": (
        (0.9582, 0.9240, 0.9359, 0.9327),
        (0.7870, 0.7171, 0.7666, 0.7654),
        (0.7964, 0.7187, 0.7738, 0.7720),
        (0.9566, 0.9558, 0.9570, 0.9544),
    ),
    "carburised, brief": (
        (0.9387, 0.9265, 0.9376, 0.9376),
        (0.7712, 0.7180, 0.7676, 0.7676),
        (0.7801, 0.7192, 0.7746, 0.7746),
        (0.9377, 0.9589, 0.9600, 0.9600),
    ),
    "nitrided": (
        (0.9600, 0.9261, 0.8804, 0.8630),
        (0.7876, 0.7177, 0.8804, 0.8636),
        (0.7964, 0.7189, 0.8808, 0.8639),
        (0.9589, 0.9580, 0.8799, 0.8629),
    ),
    "hard on soft": (
        (0.9982, 0.8265, 0.8671, 0.9458),
        (0.9990, 0.8270, 0.6570, 0.7052),
        (0.9995, 0.8273, 0.6705, 0.7225),
        (0.9982, 0.8264, 0.8205, 0.8919),
    ),
}


@pytest.mark.parametrize(("helix", "choice"), CASES)
@pytest.mark.parametrize("kind", STEELS)
def test_no_bounding_law_exceeds_the_rating(helix, choice, kind):
    """Loads used, at random pairs of a box; medians of bound over rating as measured."""
    rng, count = np.random.default_rng(7), 1000
    steels, hours, given, practice = STEELS[kind]
    standard = agma(steels, hours=hours, practice=practice, given=given)
    standard = replace(standard, loads=(Load(hours, 0.8, 1.3),))
    toothing = Toothing(helix, UNLIKE if kind == "hard on soft" else (SHARP, SHARP))
    widest = 450.0 if kind == "tempered" else 300.0
    box = Box((18.0, 70.0), (1.5, 6.0), (10.0, 300.0), widest, toothing)
    floor = standard.floor(box, choice)
    z, u = 1 / rng.uniform(1 / 70, 1 / 18, count), rng.uniform(1.5, 6.0, count)
    module = np.exp(rng.uniform(0.0, 2.3, count))
    d = module * z / toothing.cosine
    axial = np.pi * module / max(np.sin(helix), 1e-3)
    low, high = {"spur": (0.1, 2.0), "low": (0.1, 1.0), "conventional": (1.001, 4.0)}[choice]
    width = rng.uniform(low, high, count) * (d if choice == "spur" else axial)
    width = np.minimum(width, widest)
    torque, speed = np.exp(rng.uniform(5, 15, count)), rng.uniform(10.0, 300.0, count)
    pair = toothing.of_diameter(module, z, d, u, width)
    true = np.array(standard.safeties(pair, torque, speed), float)
    used = np.concatenate([1.0 / true[:2], 1.0 / true[2:] ** 2])
    below = floor.utilisations(pair, torque, speed, (1.0, 1.0))
    inside = np.isfinite(used).all(axis=0)
    inside &= (pair.overlap_ratio <= 1.0) if choice == "low" else (pair.overlap_ratio > -1.0)
    inside &= (pair.overlap_ratio > 1.0) if choice == "conventional" else inside
    assert inside.sum() > 300
    medians = []
    for k, mode in enumerate(
        ("pinion_bending", "wheel_bending", "pinion_contact", "wheel_contact")
    ):
        rows = [v for n, v in below.items() if n.startswith(mode)]
        ratio = np.max(rows, axis=0)[inside] / used[k][inside]
        assert ratio.max() <= 1.0 + 1e-12
        medians.append(np.median(ratio))
    assert medians == pytest.approx(TIGHT[kind][CASES.index((helix, choice))], abs=1e-4)


def test_the_bounding_law_is_a_geometric_program():
    train = rated_drive(20, [FREE, FREE])
    for choice in continuous_sizing.choices(train):
        assert form(rated_bound.bounding(train, choice, 1e7)).convex


def test_the_smooth_form_is_the_rating_of_its_regime():
    """Spur gears, and helical ones of the branch of load sharing that holds."""
    mounted = Practice(7.0, "precision", True, 0.175, True, size=True)
    level = (Load(20000.0, 0.8, 1.3),)
    standards = agma(), replace(agma(practice=mounted, given={"K_v": 1.2}), loads=level)
    rng, seen = np.random.default_rng(3), set()
    for k in range(60):
        standard = standards[k % 2]
        helix = float(rng.choice([0.0, 0.4363]))
        toothing = Toothing(helix, (SHARP, SHARP))
        z = rng.uniform(18.0, 50.0)
        pair = toothing.of_diameter(2.0, z, 2.0 * z / toothing.cosine, 3.3, rng.uniform(8.0, 70.0))
        regime = "spur" if not helix else "low" if pair.overlap_ratio <= 1.0 else "conventional"
        choices = [regime]
        if regime == "conventional":
            whole = f"conventional {int(pair.overlap_ratio)} "
            choices = [c for c in standard.refined(pair, regime) if c.startswith(whole)]
        made = []
        for choice in choices:
            unknown = standard.guess(pair, choice)
            if unknown["wheel_tool_angle"] == SHARP.pressure_angle:
                continue  # the parabola touches the flank: the smooth form follows the tool
            smooth = standard.smooth(pair, 1e5, 150.0, choice, unknown)
            assert max(smooth.defines.values()) == pytest.approx(1.0, abs=1e-12)
            assert list(smooth.equal.values()) == pytest.approx([1.0, 1.0], abs=1e-9)
            made.append(smooth.safeties)
        if not made:
            continue
        exact = standard.safeties(pair, 1e5, 150.0)
        assert np.max(made, axis=0) == pytest.approx(exact, rel=1e-9)
        seen.add(regime)
    assert seen == {"spur", "low", "conventional"}


@pytest.mark.parametrize("practice", [Practice(7.0), Practice(7.0, "precision", True, 0.175, True)])
def test_the_largest_branch_of_load_distribution_is_the_factor(practice):
    """Of narrow widths, to 17 inches, above, and above 40 inches, of slim pinions and wide ones."""
    for diameter, width in product((40.0, 1200.0), (20.0, 300.0, 600.0, 1000.0, 1200.0)):
        pair = Toothing(0.0, (SHARP, SHARP)).of_diameter(2.0, diameter / 2.0, diameter, 3.0, width)
        spread = distribution(practice, width, pair.working_diameters[0])
        branches = agma_smooth._distributions(practice, pair, spread)
        assert max(branches.values()) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("widest", [25.0, 300.0, 431.0, 440.0, 456.0, 700.0, 1000.0, 1200.0])
@pytest.mark.parametrize("practice", [Practice(7.0), Practice(7.0, "open", True, 0.3, True)])
def test_lines_below_load_distribution_touch_it(practice, widest):
    width = np.linspace(0.05 * widest, widest, 400)
    rows = agma_floor._spreads(agma(practice=practice), widest)
    left = []
    for diameter in (30.0, 300.0, 3000.0):
        exact = distribution(practice, width, diameter)
        slender = np.maximum(0.1 * width / diameter, 0.05)
        below = np.max([a + b * width + c * slender for a, b, c in rows], axis=0)
        assert (below <= exact * (1.0 + 1e-12)).all()
        left.append((exact - below).min())
    assert min(left) < (1e-3 if widest <= factors.WIDEST else 0.04)


@pytest.mark.slow
@pytest.mark.parametrize("helix", [0.0, 0.4363])
def test_two_stages_are_below_whole_teeth_and_above_the_bound(helix, monkeypatch):
    monkeypatch.setattr(continuous_sizing, "SEARCH", 5.0)
    monkeypatch.setattr(continuous_sizing, "REFINED", 1)
    train = rated_drive(20, [FREE, FREE], helix=helix)
    found, whole = solve(continuous_sizing.problem(train)), solve(teeth.problem(train))
    assert found.status in ("stationary", "feasible") and max(found.limits.values()) <= 1.0 + 1e-8
    assert found.bound <= whole.value and found.value <= whole.value
    assert found.gap < 0.1


def test_what_the_bounding_law_excludes_is_impossible():
    train = published_pair()
    stage = replace(train.stages[0], wheel_diameter=F(150))
    found = solve(continuous_sizing.problem(replace(train, stages=(stage,))))
    assert found.status == "infeasible" and found.value is None


@pytest.mark.slow
@pytest.mark.parametrize("names", [("iso",), ("agma", "iso")])
def test_what_iso_6336_limits_is_rated_by_it(names, monkeypatch):
    """Its own rating, with steps, accepts what is found."""
    monkeypatch.setattr(continuous_sizing, "SEARCH", 5.0)
    train = rated_drive(4, [FREE], helix=0.0, options=by(*names))
    found = solve(continuous_sizing.problem(train))
    (pair,) = sizing_text.pairs(train, np.array(list(found.design.values()), float))
    standard = train.stages[0].options[0].standards[-1]
    assert min(standard.safeties(pair, train.torque, train.speed)) >= 1.0 - 1e-8
    assert found.status in ("feasible", "stationary")
    assert found.bound <= found.value and found.gap < 0.5
    assert found.value <= solve(teeth.problem(train)).value * (1.0 + 1e-9)


GIVEN = {"s_at": (300.0, 300.0), "s_ac": (1100.0, 1100.0), "Y_N": (1.0, 1.0), "Z_N": (1.0, 1.0)}


def two_helical_stages(power):
    """The digest's allowables; 25 degrees, b/d from 0.3 to 0.6, 22:1 exact."""
    option = Option((agma((Steel("carburised"),) * 2, given=GIVEN | {"C_H": (1.0, 1.0)}),))
    toothing = Toothing(math.radians(25.0), (SHARP, SHARP))
    face = FaceWidth(F(3, 10), F(3, 5))
    stage = Stage((), face, (), (20, 60), toothings=(toothing,), options=(option,))
    speed = 150.0
    return Train(power / speed, F(22), F(0), (stage, stage), speed=speed, law=RATED)


@pytest.mark.slow
def test_the_bounding_program_by_two_solvers():
    """Clarabel through cvxpy and Ipopt: one optimum to 1e-9, the dual bound at it."""
    train = two_helical_stages(15e6)
    for choice in continuous_sizing.choices(train):
        made = rated_bound.bounding(train, choice)
        first, second = solve(made, "ipopt"), solve(made, "gp")
        assert first.value == pytest.approx(second.value, rel=1e-9)
        assert first.bound == pytest.approx(first.value, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("power", [1e3, 1e6, 20e9])
def test_random_starts_of_a_watt_to_20_megawatts_end_at_one_design(power):
    """N mm/s; lengths a factor of e around the optimum of the bounding program."""
    train, rng = two_helical_stages(power), np.random.default_rng(5)
    choice = (("conventional",),) * 2
    made, smooth = (
        rated_bound.bounding(train, choice),
        continuous_sizing.smooth_problem(train, choice),
    )
    known = solve(made, "ipopt")
    middle = np.concatenate([np.ravel(v) for v in known.design.values()])
    values = []
    for _ in range(20):
        x = middle * np.exp(rng.uniform(-1.0, 1.0, len(middle)))
        assert solve(made.starting(x), "ipopt").value == pytest.approx(known.value, rel=1e-9)
        guess = np.concatenate([x, continuous_sizing.guess(train, x, choice)])
        values.append(solve(smooth.starting(guess), "ipopt").value)
    assert values == pytest.approx([values[0]] * 20, rel=1e-7)


@pytest.mark.slow
def test_a_budget_is_kept_and_its_bound_holds():
    train = rated_drive(20, [FREE, FREE])
    early = solve(continuous_sizing.problem(train), budget=Budget(seconds=1.5))
    assert early.status == "limit"
    assert early.bound is None or early.bound <= solve(teeth.problem(train)).value
