"""The tooth pairs, modules and widths of a stage against their definitions, by plain loops."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from brute_force import SAME, best_choice, cost
from campaigns import few
from small_drives import FACES, LIMITED, OBJECTIVES, drive

from gearopt.errors import SolveError
from gearopt.formulations.drive.teeth import columns as staging
from gearopt.formulations.drive.teeth.stage import ALLOWANCE
from gearopt.formulations.drive.teeth.tables import table
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR

F = Fraction


LIMITS = [pytest.param(face, id=f"limited {name}") for name, face in LIMITED.items()]
CASES = [(face, objective) for face in FACES for objective in OBJECTIVES]
CASES += [pytest.param(f, "gear_volume", id=f"limited {n}") for n, f in LIMITED.items()]


@pytest.mark.parametrize(("face", "objective"), few(CASES, CASES[::8]))
def test_the_best_module_and_width_of_every_pair(face, objective):
    train = drive(3, face, F(30), objective=objective, wheel_diameter=F(150), helix_angle=0.2)
    for k, own in enumerate(table(train, k, F(5, 2)) for k in range(3)):
        for torque in np.geomspace(300.0, 1e5, 4):
            index = np.arange(len(own.z1))
            expected = best_choice(train, k, np.full(len(index), torque), own.z1, own.z2)
            found = own._best(np.full(len(index), torque), index)
            good = np.isfinite(expected[0])
            assert (np.isfinite(found[0]) == good).all()
            for a, b in zip(found, expected, strict=True):
                assert a[good] == pytest.approx(b[good], rel=1e-11)
            assert (own.cost(np.full(len(index), torque), index) == found[0]).all()


@pytest.mark.parametrize(("face", "objective"), few(CASES, CASES[1::8]))
def test_capacity_floor_and_slope_of_every_module(face, objective):
    """Of one module alone: what it carries at most, and what it costs at least."""
    whole = drive(2, face, objective=objective, wheel_diameter=F(120), helix_angle=0.2)
    for position, own in enumerate(table(whole, k, F(4)) for k in range(2)):
        index = np.arange(len(own.z1))
        for m, module in enumerate(whole.stages[position].modules):
            one = list(whole.stages)
            one[position] = replace(one[position], modules=(module,))
            alone = replace(whole, stages=tuple(one))

            def price(torque, alone=alone, own=own, position=position):
                return best_choice(alone, position, torque, own.z1, own.z2)[0]

            most, allowed = own.capacity(m), (own.first <= m) & (m <= own.last)
            assert ((most > 0.0) == allowed).all()
            floor = own.floor(m)
            assert (floor <= price(np.full(len(index), 1e-3)) * (1.0 + SAME)).all()
            assert not np.isfinite(price(most * (1.0 + 1e-9)))[most > 0.0].any()
            if own.steps is None:  # the last step may be less than the widest face
                assert np.isfinite(price(most * (1.0 - 1e-9)))[most > 0.0].all()
            least = price(np.full(len(index), 1e-9))
            good = allowed & np.isfinite(least)
            expected = 0.0 if face == "open" and "e" in objective[1:2] else least[good]
            assert floor[good] == pytest.approx(expected, rel=1e-11, abs=1e-6)
            for part in (0.2, 0.7, 0.99):
                loaded = price(part * most)
                good = np.isfinite(loaded) & (most > 0.0)
                assert (own.slope * part * most <= loaded * (1.0 + 1e-9))[good].all()


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_slope_is_what_the_load_alone_costs(objective):
    """A free width that the load decides: K d^2 b = 2 T (1 + 1/u), U d b m = 2 T."""
    train = drive(2, "open", objective=objective, helix_angle=0.3)
    own = table(train, 1, train.highest_ratio)
    assert len(own.slope) == len(own.z1)
    for k, (a, b) in enumerate(zip(own.z1, own.z2, strict=True)):
        u, stage = b / a, train.stages[1]
        contact = 2.0 * (1.0 + 1.0 / u) / stage.allowable[0]  # b d^2 a torque
        bending = 2.0 * (a / math.cos(0.3)) / stage.allowable[1]
        volume = objective in ("gear_volume", "mass")
        one = np.array([1.0])
        expected = cost(train, 1, one, max(contact, bending) * one, u)[0] if volume else 0.0
        assert own.slope[k] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", ["tied", "fixed", "stepped"])
def test_a_torque_at_the_limit_is_carried_whatever_its_rounding(name):
    """Within ALLOWANCE, here and in the grid of the bound."""
    train = drive(1, name, total=F(3), tolerance=F(1, 3), modules=(F(2),), pinion_teeth=(15, 30))
    own = table(train, 0, train.highest_ratio)
    index = np.arange(len(own.z1))
    exact = (2.0 / own.need) ** (1.0 / own.exponent)
    room = (own.last >= own.first) & (exact > 0)
    if name != "stepped":
        assert np.isfinite(own.cost(exact * (1.0 + 0.9 * ALLOWANCE), index))[room].all()
        assert not np.isfinite(own.cost(exact * (1.0 + 4.0 * ALLOWANCE), index)).any()
    carried = own.capacity(0)
    assert (carried >= exact * (1.0 + 2.0 * ALLOWANCE))[room].all()
    assert (carried <= exact * (1.0 + 4.0 * ALLOWANCE)).all()


@pytest.mark.parametrize("face", ["free", "open", "fixed"])
def test_a_width_at_its_limit_is_not_beyond_it_whatever_its_rounding(face):
    own = table(drive(1, face, F(3), tolerance=F(1, 3), modules=(F(2),), helix_angle=0.2), 0, F(4))
    index = np.arange(len(own.z1))
    most = own.capacity(0) / (1.0 + 3.0 * ALLOWANCE)
    for part in (1.0 + 0.9 * ALLOWANCE, 1.0, 1.0 - 0.1 * ALLOWANCE):
        value, module, width = own._best(part * most, index)
        good = own.first <= own.last
        assert (np.isfinite(value) == good).all() and (module == 2.0).all() and good.any()
        limit = 24.0 if face == "fixed" else 0.6 * own.made(module, index).pinion.reference_diameter
        assert (width <= limit)[good].all()
        assert width[good] == pytest.approx(np.broadcast_to(limit, width.shape)[good], rel=1e-11)


def test_of_equal_costs_the_smaller_module_is_taken_on_steps():
    """Idle widths of one step: d of 2 x 30 = 3 x 20 costs the same."""
    face = FaceWidth(F(0), F(2), step=F(1))
    wide = {"modules": (F(2), F(3)), "pinion_teeth": (20, 30), "face_width": face}
    train = Train(1e-3, F(3), F(0), (Stage((1.0, 1.0), **wide),), law=K_FACTOR)
    own = table(train, 0, train.highest_ratio)
    module, width, _ = own.choose(1e-3, 0)
    assert (module, width) == (2.0, 1.0)
    assert own.steps[0].min() == 1  # no width of no step, however small the load
    # 9 steps of d = 40 are as much as 4 of d = 60; the load needs 8.9 and 3.96 of them
    torque = 8.9 * 40**2 / (2.0 * (1.0 + 1.0 / 3.0))
    carried = replace(train, stages=(replace(train.stages[0], allowable=(1.0, 1e9)),))
    assert table(carried, 0, train.highest_ratio).choose(torque, 0) == (2.0, 9.0, 0)
    assert own.first.tolist() == [0] * len(own.z1) and own.last.tolist() == [1] * len(own.z1)


@pytest.mark.parametrize("helix", [0.0, 0.25])
@pytest.mark.parametrize("face", [*FACES, *LIMITS])
def test_modules_and_steps_by_fractions(face, helix):
    """Limits in whole numbers, with ties: m z = 60 of the wheel, b = low d, b = high d."""
    chosen = {"modules": tuple(F(m, 4) for m in (4, 6, 8, 10)), "pinion_teeth": (16, 32)}
    train = drive(2, face, total=F(9), wheel_diameter=F(60), helix_angle=helix, **chosen)
    cosine, stage = F(math.cos(helix)), train.stages[1]
    own, face = table(train, 1, F(4, 3)), stage.face_width
    for k, (a, b) in enumerate(zip(own.z1.tolist(), own.z2.tolist(), strict=True)):
        allowed = []
        for m, module in enumerate(stage.modules):
            d = module * a / cosine
            good = module * b / cosine <= 60
            low = max(face.low * d, (face.over_module[0] or 0) * module, face.least)
            high = [x * y for x, y in ((face.high, d), (face.over_module[1], module)) if x]
            if face.fixed is not None:
                good &= low <= face.fixed and all(face.fixed <= most for most in high)
            elif not face.plain:
                good &= low <= min(high)
            if good:
                allowed.append(m)
            if face.step is not None:
                ends = math.ceil(low / face.step), math.floor(min(high) / face.step)
                assert (own.steps[0][m][k], own.steps[1][m][k]) == (max(1, ends[0]), ends[1])
        assert list(range(own.first[k], own.last[k] + 1)) == allowed
    assert (own.steps is None) == (face.step is None)


@pytest.mark.parametrize("coprime", [False, True])
@pytest.mark.parametrize(
    "limits",
    [
        {},
        {"wheel_teeth": (40, 60)},
        {"ratio": (F(5, 2), F(7, 2))},
        {"ratio": (F(5, 2), None), "wheel_teeth": (1, 55), "wheel_diameter": F(1000)},
    ],
)
def test_pairs_are_all_of_a_stage_by_ratio_then_teeth(limits, coprime):
    train = drive(2, total=F(4), coprime=coprime, **limits)
    stage, cut = train.stages[0], F(19, 6)
    own = table(train, 0, cut)
    least, most = stage.wheel_teeth
    expected = [
        (F(b, a), a, b)
        for a in range(15, 21)
        for b in range(1, 200)
        if max(F(1), stage.ratio[0]) <= F(b, a) <= min(cut, stage.ratio[1] or cut)
        and least <= b <= (most or b)
        and (not coprime or math.gcd(a, b) == 1)
    ]
    found = list(zip(own.z1.tolist(), own.z2.tolist(), strict=True))
    assert found == [(a, b) for _, a, b in sorted(expected)]
    assert own.ratio.tolist() == [b / a for a, b in found]
    assert own.log_ratio.tolist() == np.log(own.ratio).tolist()


def test_more_pairs_than_memory_takes_are_counted_before_they_are_made(monkeypatch):
    """Also where small pinions have none, as their wheels would be too small."""
    train = drive(2, total=F(4), wheel_teeth=(55, None))
    count = len(table(train, 0, F(3)).z1)
    assert count == sum(max(0, 3 * z - 54) for z in range(15, 21))
    monkeypatch.setattr(staging, "PAIRS", count)
    assert len(table(train, 0, F(3)).z1) == count
    monkeypatch.setattr(staging, "PAIRS", count - 1)
    with pytest.raises(SolveError, match=f"has {count} tooth pairs .* narrow its pinion teeth"):
        table(train, 0, F(3))


def test_the_only_stage_keeps_to_the_least_ratio():
    one = drive(1, total=F(3), tolerance=F(1, 10))
    own = table(one, 0, one.highest_ratio)
    assert own.ratio.min() == 2.7 and own.ratio.max() == 3.3
    capped = replace(one, stages=(replace(one.stages[0], ratio=(F(29, 10), None)),))
    assert table(capped, 0, one.highest_ratio).ratio.min() == 2.9
    two = drive(2, total=F(3), tolerance=F(1, 10))
    assert table(two, 0, two.highest_ratio).ratio.min() == 1.0


def test_a_look_at_the_clock_comes_before_after_and_between():
    calls = []
    table(drive(), 0, F(12), lambda: calls.append(1))
    assert len(calls) == 3
