"""The two design processes: rules against closed forms, methods against the printed tables."""

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SolveError
from gearopt.formulations.drive import processes as process
from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.design import describe
from gearopt.formulations.drive.processes import ProcessOne, ProcessTwo
from gearopt.formulations.drive.train import FaceWidth
from gearopt.optimise.solve import run
from gearopt.physics.loads import k_factor, unit_load

PROBLEMS = Path(__file__).parents[3] / "problems"
PRINTED = (Fraction("4.96"), Fraction("4.36"))
TWO, THREE = (
    gearopt.load(PROBLEMS / f"{name}.toml").train() for name in ("elevator", "three_stage")
)


def made(train, method, one=None, two=None):
    """Result and gears [(m, z1, z2)] of a method; no gears where it makes none."""
    problem = teeth.problem(train)
    problem = replace(problem, methods=process.methods(train, one, two))
    result, outcome = run(problem, method)
    if outcome.x is None:
        return result, []
    pairs = teeth.pairs(train, outcome.x)
    return result, [(p.normal_module, p.pinion_teeth, p.wheel_teeth) for p in pairs]


def loaded(train, k):
    """The drive with its K-factor limits times k, one a stage."""
    pairs = [(s, s.allowable[0] * f, s.allowable[1]) for s, f in zip(train.stages, k, strict=True)]
    return replace(train, stages=tuple(replace(s, allowable=(k, u)) for s, k, u in pairs))


def test_niemann_ratios_as_printed():
    u = float(TWO.ratio)
    assert process.niemann_ratios(u, (2.0, 2.0)) == pytest.approx((6.2439, 3.4921), abs=5e-5)
    three = process.niemann_ratios(110.0, (2.0, 2.0, 2.0))
    assert three == pytest.approx((8.8036, 4.2135, 2.9654), abs=5e-5)
    assert math.prod(three) == pytest.approx(110.0)
    with pytest.raises(SolveError, match=r"two and three stages, not of 4: write stage_ratios"):
        process.niemann_ratios(300.0, (2.0,) * 4)


def test_niemann_ratios_follow_the_allowable_stresses():
    """s_12^2 = K1/K2: exponents of eqs. (7) and (8), by of K times 4, a stress times 2."""

    def slope(k, part):
        far = (
            process.niemann_ratios(200.0, k)[part]
            / process.niemann_ratios(200.0, (1,) * len(k))[part]
        )
        return math.log(far) / math.log(2.0)

    assert slope((4.0, 1.0), 0) == pytest.approx(2 / 3)
    assert slope((4.0, 1.0, 1.0), 0) == pytest.approx(2 / 7 + 4 / 7)
    assert slope((1.0, 4.0, 1.0), 0) == pytest.approx(-2 / 7)
    assert slope((1.0, 1.0, 4.0), 0) == pytest.approx(-4 / 7)
    assert slope((4.0, 1.0, 1.0), 1) == pytest.approx(-4 / 7)
    assert slope((1.0, 4.0, 1.0), 1) == pytest.approx(4 / 7 + 2 / 7)
    assert slope((1.0, 1.0, 4.0), 1) == pytest.approx(-2 / 7)


@pytest.mark.parametrize("k", [(2.0, 2.0), (3.0, 1.0), (0.7, 1.9)])
def test_the_chain_of_centres_loads_every_stage_alike(k):
    ratios, shares, a1, torque = (5.3, 3.7), (0.5, 0.9), 140.0, 6e4
    a2 = process.next_centre_distance(a1, ratios, shares, k)
    use = []
    for t, a, u, share, limit in zip(
        (torque, torque * 5.3), (a1, a2), ratios, shares, k, strict=True
    ):
        d = process.pinion_diameter(a, u)
        use.append(k_factor(t, d, share * d, u) / limit)
    assert use[1] == pytest.approx(use[0], rel=1e-12)


def test_a_balanced_pinion_reaches_both_limits_at_once():
    """With z1 as a real number K and U are reached by one module; the rule cuts that number."""
    stage, u, angle = TWO.stages[0], 4.96, TWO.stages[0].toothing.helix_angle
    z = stage.allowable[1] / stage.allowable[0] * (1 + 1 / u) * math.cos(angle)
    d = math.cbrt(k_factor(5e4, 1.0, 0.6, u) / stage.allowable[0])
    m = d * math.cos(angle) / z
    assert unit_load(5e4, d, 0.6 * d, m) == pytest.approx(stage.allowable[1], rel=1e-12)
    assert process.balanced_pinion(TWO.law, stage, u) == math.floor(z) == 25


def test_the_needed_module_is_the_least_that_carries_the_load():
    stage, angle = TWO.stages[1], TWO.stages[1].toothing.helix_angle
    for z1 in (20, 25, 32):
        z2 = 4 * z1 + 7
        m, u = process.needed_module(TWO.law, stage, 2.5e5, (z1, z2)), z2 / z1
        d = m * z1 / math.cos(angle)
        use = (
            k_factor(2.5e5, d, 0.75 * d, u) / stage.allowable[0],
            unit_load(2.5e5, d, 0.75 * d, m) / stage.allowable[1],
        )
        assert max(use) == pytest.approx(1.0, rel=1e-12)
    assert process.next_module(stage, 2.5) == Fraction("2.5")
    assert process.next_module(stage, 2.5000001) == 3
    assert process.next_module(stage, 50.1) is None


def test_wheel_teeth_are_cut_and_ties_are_exact():
    assert process.wheel_teeth(25, Fraction("4.96")) == 124
    assert process.wheel_teeth(25, Fraction("4.9599999")) == 123
    assert process.wheel_teeth(25, 4.96) == 124
    assert process.wheel_teeth(27, 237.70 / 27) == 237


def test_process_one_makes_table_2():
    result, gears = made(TWO, "process-one", one=ProcessOne(PRINTED))
    assert gears == [(2.0, 25, 124), (3.0, 25, 109)]
    assert result.status == "feasible"
    assert result.value == pytest.approx(8705309.24, abs=0.01)
    assert result.value == pytest.approx(8708993, rel=5e-4)  # with b as printed, rounded


def test_process_two_makes_table_2():
    two = ProcessTwo(150.0, PRINTED, modules=(Fraction(2), Fraction(3)))
    result, gears = made(TWO, "process-two", two=two)
    assert gears == [(2.0, 23, 114), (3.0, 25, 109)]
    assert result.value == pytest.approx(8261041, rel=1e-3)  # b1 = 30.45, printed 30.5


def test_process_two_by_its_own_ratios_breaks_the_limits():
    """Eq. (7) from a1 = 150 mm: the pinion of 19 teeth is too small for K, and that is said."""
    two = ProcessTwo(150.0, modules=(Fraction(2), Fraction(3)))
    result, gears = made(TWO, "process-two", two=two)
    assert gears[0] == (2.0, 19, 118) and result.status == "failed"
    assert result.message == "k_factor[1] is violated by 0.253."


def test_process_two_rounds_modules_of_given_teeth_up():
    train = replace(
        THREE,
        stages=tuple(
            replace(s, modules=tuple(m for m in s.modules if m != 2.5)) for s in THREE.stages
        ),
    )
    result, gears = made(train, "process-two", two=ProcessTwo(160.0, pinion_teeth=(27, 26, 27)))
    assert gears == [(1.25, 27, 237), (3.0, 26, 109), (4.0, 27, 80)]  # Table 4: without 2.5 mm
    assert result.status == "feasible" and not result.message
    _, gears = made(THREE, "process-two", two=ProcessTwo(160.0, pinion_teeth=(27, 26, 27)))
    assert gears[1] == (2.5, 26, 109)


def test_a_given_pinion_that_is_too_small_is_told():
    own = ProcessTwo(160.0, None, (27, 26, 27), (Fraction("1"), Fraction(3), Fraction(4)))
    result, _ = made(THREE, "process-two", two=own)
    assert "pinion 1 has 29.79 mm, its centre distance requires 32.64 mm" in result.message


def test_a_train_beyond_the_series_is_told():
    small = replace(TWO, stages=tuple(replace(s, modules=s.modules[:4]) for s in TWO.stages))
    result, gears = made(small, "process-one", one=ProcessOne(PRINTED))
    assert (result.status, gears) == ("failed", [])
    assert (
        result.message == "stage 2 needs a module of 2.644 mm or more; the largest allowed is 2 mm"
    )
    result, _ = made(small, "process-two", two=ProcessTwo(150.0, pinion_teeth=(23, 25)))
    assert "stage 2 needs a module of" in result.message


@pytest.mark.parametrize("seed", range(20))
def test_process_one_holds_its_loads_whatever_the_drive(seed):
    """K and U are kept in every stage; the next smaller module would break one of them."""
    factor = 1.3 ** (seed - 10)
    train = loaded(replace(TWO, torque=TWO.torque * factor), (1 + seed / 20, 1 - seed / 40))
    _, gears = made(train, "process-one", one=ProcessOne(PRINTED))
    torque = train.torque
    for stage, (m, z1, z2) in zip(train.stages, gears, strict=True):
        share = float(stage.face_width.high)

        def use(m, z1=z1, z2=z2, share=share, stage=stage, torque=torque):
            d = m * z1 / stage.toothing.cosine
            return max(
                k_factor(torque, d, share * d, z2 / z1) / stage.allowable[0],
                unit_load(torque, d, share * d, m) / stage.allowable[1],
            )

        assert use(m) <= 1 + 1e-9
        below = [float(x) for x in stage.modules if x < m]
        assert not below or use(below[-1]) > 1
        torque *= z2 / z1


def test_more_power_never_makes_process_one_smaller():
    volumes = []
    for factor in (0.5, 1.0, 2.0, 4.0, 8.0):
        train = replace(TWO, torque=TWO.torque * factor)
        volumes.append(made(train, "process-one", one=ProcessOne(PRINTED))[0].value)
    assert volumes == sorted(volumes) and volumes[0] < volumes[-1]


def test_a_process_never_undercuts_the_proven_optimum():
    best = run(teeth.problem(TWO))[0].value
    for u1 in ("4.5", "5", "5.5", "6", "6.5"):
        ratios = (Fraction(u1), TWO.ratio / Fraction(u1))
        value = made(TWO, "process-one", one=ProcessOne(ratios))[0].value
        assert value is None or value > best


def test_what_is_missing_is_named():
    for method, key in (("process-one", "stage_ratios"), ("process-two", "first_centre_distance")):
        with pytest.raises(
            SolveError, match=rf"needs a table \[{method.replace('-', '_')}\].*{key}"
        ):
            made(TWO, method)
    with pytest.raises(SolveError, match="2 entries, not one for each stage"):
        made(THREE, "process-one", one=ProcessOne(PRINTED))
    with pytest.raises(ValueError, match="needs pinion teeth or modules"):
        ProcessTwo(150.0)
    free = replace(TWO.stages[0], face_width=FaceWidth(Fraction("0.3"), Fraction("0.6")))
    with pytest.raises(SolveError, match="face_width_over_diameter as one number"):
        made(replace(TWO, stages=(free, TWO.stages[1])), "process-one", one=ProcessOne(PRINTED))


def test_the_design_in_words_has_the_widths_of_the_rule():
    result, gears = made(TWO, "process-one", one=ProcessOne(PRINTED))
    rows = enumerate(zip(gears, (0.6, 0.75), strict=True))
    pairs = tuple(
        TWO.pair(k, m, z1, z2, part * m * z1 / TWO.stages[k].toothing.cosine)
        for k, ((m, z1, z2), part) in rows
    )
    found = describe(TWO, pairs)
    assert found.gear_volume_mm3 == pytest.approx(result.value, rel=1e-12)
