"""Strength laws: what they promise, and laws of a few lines in everything that sizes gears."""

import math
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from brute_force import every_train
from campaigns import few
from gearboxes import smallest_box
from small_drives import FACES, OBJECTIVES, drive

from gearopt.errors import SolveError
from gearopt.formulations.drive import continuous_sizing, teeth, together
from gearopt.formulations.drive import processes as process
from gearopt.formulations.drive.gearbox import Gearbox, Shaft
from gearopt.formulations.drive.processes import ProcessOne
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength import Law, LimitedIndex, agma_floor
from gearopt.formulations.strength.laws import laws
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.formulations.strength.laws.lewis import LEWIS
from gearopt.optimise import tape
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run, solve
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.loads import lewis_stress
from gearopt.physics.stiffness import lewis_form_factor
from gearopt.scenes import drive as drives
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.drive import Limits, StageTable, limited_by
from gearopt.scenes.explaining.explanations import explanation
from gearopt.scenes.reading.ask import Ask

F = Fraction


def contact(pair, torque, speed):
    return (3.0 * torque / (pair.pinion.reference_diameter**2 * pair.face_width),)


CONTACT = Law("contact pressure", (LimitedIndex("pressure"),), contact, proportional=True)


def faster(pair, torque, speed):
    """Grows with the speed v = omega d/2 of the pitch lines, and less than 1/b with the width."""
    d = pair.pinion.reference_diameter
    uneven = 1.0 / pair.face_width + 0.2 / d
    return (3.0 * torque * (1.0 + 0.5 * speed * d / 2000.0) * uneven / d**2,)


FASTER = Law("dynamic contact pressure", (LimitedIndex("pressure"),), faster)


def test_every_file_of_a_law_is_known():
    assert [law.title for law in laws()] == ["K-factor and unit load", "Lewis stress"]


def test_a_law_may_ask_for_the_helix_angle():
    """Lewis stress of virtual teeth, with the promise and without it, against every train."""
    beta = math.radians(30)

    def stress(pair, torque, speed):
        form = lewis_form_factor(pair.pinion_teeth / math.cos(pair.pinion.helix_angle) ** 3)
        d = pair.pinion.reference_diameter
        return (lewis_stress(torque, d, pair.face_width, pair.normal_module, form),)

    law = Law("virtual teeth", (LimitedIndex("bending_stress"),), stress, proportional=True)
    modules = tuple(map(F, (1, 2, 3, 4, 5)))
    stage = Stage(
        (40.0,), FaceWidth(F(1, 2), F(1)), modules, (17, 20), (17, 80), toothings=(Toothing(beta),)
    )
    train = Train(5e4, F(3), F(1, 100), (stage,), law=law)
    values = []
    for z1, m in product(range(17, 21), range(1, 6)):
        d = m * z1 / math.cos(beta)
        form = math.pi * (0.154 - 0.912 * math.cos(beta) ** 3 / z1)
        b = max(2 * 5e4 / (d * m * form * 40.0), d / 2)
        inside = (z2 for z2 in range(17, 81) if 297 * z1 <= 100 * z2 <= 303 * z1)
        values += [0.25 * math.pi * b * d**2 * (1 + (z2 / z1) ** 2) for z2 in inside if b <= d]
    for promised in (True, False):
        own = replace(train, law=replace(law, proportional=promised))
        result = solve(teeth.problem(own), "exact")
        assert result.status == "optimal"
        assert result.value == pytest.approx(min(values), rel=1e-11)


def test_a_pinion_below_the_range_of_a_law_is_refused():
    """With 4 teeth the Lewis factor is negative, and any load would be carried."""
    train = drive(1)
    low = tuple(replace(s, allowable=(100.0,), pinion_teeth=(11, 40)) for s in train.stages)
    with pytest.raises(ValueError, match="Lewis stress needs pinions of 12 teeth"):
        replace(train, stages=low, law=LEWIS)
    assert LEWIS.largest_utilisation(GearPair.of_teeth(2.0, 5, 20, 10.0), 1e3, 0.0, (100.0,)) < 0.0


def pressed(law=CONTACT, stages=2, face="tied", allowable=1.5, **changes):
    """A small drive with a law of one limit."""
    train = drive(stages, face, **changes)
    own = tuple(replace(s, allowable=(allowable + 0.2 * k,)) for k, s in enumerate(train.stages))
    return replace(train, stages=own, law=law, speed=150.0)


def contact_width(stage, torque, d, m, u):
    return 3.0 * torque / (d**2 * stage.allowable[0])


def faster_width(train):
    """The width that FASTER needs, solved for by hand; inf where none is enough."""

    def needed(stage, torque, d, m, u):
        speed = train.speed * train.torque / torque
        load = 3.0 * torque * (1.0 + 0.5 * speed * d / 2000.0) / (d**2 * stage.allowable[0])
        left = 1.0 / load - 0.2 / d
        with np.errstate(divide="ignore"):
            return np.where(left > 0.0, 1.0 / left, np.inf)

    return needed


@pytest.mark.parametrize("law", [*laws(), CONTACT, FASTER], ids=lambda law: law.title)
def test_a_law_keeps_its_promises(law):
    draw = np.random.default_rng(1)
    for _ in range(200):
        z, u, m, b = draw.integers(12, 80), draw.uniform(1, 9), draw.uniform(1, 9), 30.0
        torque, speed, f = draw.uniform(1e3, 1e6), draw.uniform(1, 300), draw.uniform(1.01, 3)
        pair = GearPair.of_teeth(m, z, z * u, b, draw.uniform(0, 0.4))

        def use(pair, torque, speed=speed, law=law):
            found = law.utilisations(pair, torque, speed, (1.0,) * len(law.limits))
            assert tuple(found) == law.names
            return np.array(list(found.values()), float)

        now = use(pair, torque)
        assert (use(pair.of_width(f * b), torque) < now).all()
        assert (use(pair, f * torque, speed / f) > now).all()
        steeper = GearPair.of_teeth(m, z, z * u, b, pair.pinion.helix_angle, Rack(0.4))
        assert law.pressure_angle or (use(steeper, torque) == now).all()
        if law.proportional:
            larger = GearPair.of_teeth(f * m, z, z * u, f * b, pair.pinion.helix_angle)
            assert use(larger, f**3 * torque, 7 * speed) == pytest.approx(now, rel=1e-12)
            assert use(pair.of_width(f * b), f * torque) == pytest.approx(now, rel=1e-12)
            d = pair.pinion.reference_diameter
            finer = GearPair.of_diameter(m * z / (z + 1), z + 1, d, u, b, pair.pinion.helix_angle)
            assert (use(finer, torque) >= now * (1 - 1e-12)).all()
            slower = GearPair.of_diameter(m, z, d, f * u, b, pair.pinion.helix_angle)
            assert (use(slower, torque) * f * (u + 1) >= now * (f * u + 1) * (1 - 1e-12)).all()


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("objective", few(OBJECTIVES, 1))
def test_what_is_bisected_is_what_has_a_closed_form(face, objective):
    """K-factor and unit load without their promise give the same trains."""
    train = drive(2, face, objective=objective, wheel_diameter=F(150), helix_angle=0.2)
    train = replace(train, torque=1e4)
    unpromised = replace(train, law=replace(K_FACTOR, proportional=False))
    ways = [run(teeth.problem(t), "exact") for t in (train, unpromised)]
    values, points = [r.value for r, _ in ways], [o.x for _, o in ways]
    assert [r.status for r, _ in ways] == ["optimal", "optimal"]
    assert values[1] == pytest.approx(values[0], rel=1e-11)
    assert points[1] == pytest.approx(points[0], rel=1e-11)


@pytest.mark.parametrize("face", FACES)
def test_a_law_of_three_lines_in_whole_teeth(face):
    train = pressed(face=face)
    result = solve(teeth.problem(train))
    best = every_train(train, contact_width)
    assert result.status == "optimal"
    assert result.value == pytest.approx(best.values.min(), rel=1e-12)
    if face != "fixed alone":  # what needs no load there is none
        assert max(result.limits[f"pressure[{k}]"] for k in (1, 2)) > 0.6
    assert run(teeth.problem(pressed(face=face, allowable=0.01)))[0].status == "infeasible"


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("allowable", few([1.2, 3.0], 1))
def test_a_law_that_depends_on_speed_and_width_in_whole_teeth(face, allowable):
    train = pressed(FASTER, face=face, allowable=allowable)
    result = solve(teeth.problem(train))
    found = every_train(train, faster_width(train)).values
    assert (result.status == "optimal") == bool(len(found))
    if len(found):
        assert result.value == pytest.approx(found.min(), rel=1e-11)


def test_a_law_of_three_lines_with_real_valued_sizes():
    """Volume is pi/4 3 T/s (1 + u^2) a stage, whatever the teeth: one number to choose."""
    train = pressed(total=12, modules=(), tolerance=F(0))
    problem = continuous_sizing.problem(train)
    assert tape.kinds(problem).log_convex
    result = solve(problem)
    u = np.linspace(2.0, 6.0, 400_001)
    first, second = (s.allowable[0] for s in train.stages)
    load = (1 + u**2) / first + u * (1 + (12 / u) ** 2) / second
    assert result.status == "optimal"
    assert result.value == pytest.approx(0.75 * math.pi * train.torque * load.min(), rel=1e-9)
    assert result.limits["pressure[1]"] == pytest.approx(1.0, abs=1e-7)


def test_a_law_that_is_no_posynomial_goes_to_ipopt_as_it_is():
    """The fewest teeth: d^3 = 2 T z/(h Y(z) s)."""
    face = FaceWidth(F(3, 5), F(3, 5))
    train = drive(1, total=4, tolerance=F(0), modules=(), pinion_teeth=(15, 20))
    stage = replace(train.stages[0], allowable=(90.0,), face_width=face)
    problem = continuous_sizing.problem(replace(train, stages=(stage,), law=LEWIS))
    assert not tape.kinds(problem).log_convex
    result = solve(problem)
    form = math.pi * (0.154 - 0.912 / 15)
    cube = 2 * train.torque * 15 / (0.6 * form * 90.0)
    assert result.status == "stationary" and result.bound is None
    assert result.value == pytest.approx(math.pi / 4 * 0.6 * cube * (1 + 16), rel=1e-7)


def on_shafts(pairs):
    return Gearbox(pairs, (Shaft(6.0), Shaft(9.0), Shaft(14.0)))


def boxed(train, gap=3e-3):
    return run(together.problem(train, on_shafts), "exact", Budget(gap=gap), 0, None, gap)[0]


FEW = {"modules": (F(2), F(3)), "pinion_teeth": (17, 17), "wheel_teeth": (40, 44)}
SLOW = [pytest.param(face, marks=pytest.mark.slow) for face in ("tied", "stepped")]
SLOWER = [pytest.param(face, marks=pytest.mark.slow) for face in ("free", "stepped")]


@pytest.mark.slow
@pytest.mark.parametrize("face", ["fixed", *SLOW, SLOWER[0]])
def test_laws_in_gears_and_box_at_once(face):
    """A pressure is a K-factor without its ratio; unpromised, its widths are bounds in cells."""
    train = pressed(face=face, total=6, allowable=2.5, **FEW)
    found = boxed(train)
    assert found.status == "optimal"
    assert max(found.limits["pressure[1]"], found.limits["pressure[2]"]) <= 1.0 + 1e-11
    other = boxed(replace(train, law=replace(CONTACT, proportional=False)))
    assert other.status == "optimal"
    assert other.value == pytest.approx(found.value, rel=3.1e-3)
    assert max(other.bound, found.bound) <= min(other.value, found.value) * (1 + 1e-9)
    dynamic = boxed(replace(train, law=FASTER, speed=10.0))
    assert dynamic.status == "optimal" and dynamic.value >= found.bound


@pytest.mark.parametrize("face", ["fixed", *SLOW, SLOWER[0]])
@pytest.mark.parametrize("allowable", few([2.5, 4.0], [4.0]))
def test_a_law_without_closed_form_in_gears_and_box_as_by_brute_force(face, allowable):
    train = pressed(FASTER, face=face, total=6, allowable=allowable, **FEW)
    best = smallest_box(train, on_shafts, 1e-5, faster_width(train))
    result = boxed(train, 1e-3)
    assert (result.status == "optimal") == math.isfinite(best)
    if math.isfinite(best):
        assert result.value == pytest.approx(best, rel=1.1e-3)
        assert result.bound <= best * (1 + 1e-9) and best <= result.value * (1 + 1.1e-5)


def test_a_process_refuses_a_law_it_has_no_rule_for():
    train = pressed()
    problem = teeth.problem(train)
    methods = process.methods(train, ProcessOne((F(3), F(4))))
    with pytest.raises(SolveError, match="two limits in proportion .* not contact pressure"):
        run(replace(problem, methods=methods), "process-one")


PressedLimits, PressedStage = (limited_by(CONTACT)(table) for table in (Limits, StageTable))


class PressedScene(Scene):
    """A drive limited by a contact pressure."""

    limits: PressedLimits
    stage: tuple[PressedStage, ...] = ()


def scene(**limits):
    known = {"pressure": "2 MPa", "pinion_teeth": [20, 40]} | limits
    return PressedScene.model_validate(
        {
            "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 20},
            "stage": [{"face_width_over_diameter": Decimal(w)} for w in ("0.6", "0.75")],
            "limits": known,
        }
    )


@pytest.mark.slow
def test_explain_knows_the_limits_of_a_law_from_its_declaration():
    found = explanation(drives.KIND, scene(), Ask())
    own = {i.key: i for i in found.influences}["limits.pressure"]
    assert found.result.status == "optimal" and "pressure[1]" in found.binding
    assert own.sensitivity == pytest.approx(-1.0, abs=1e-7)  # V ~ T/s
    assert own.price == pytest.approx(1 / 1.01 - 1, rel=1e-5)
    assert "pressure_MPa" in found.result.design["stages"][0]


@pytest.mark.slow
def test_a_conflict_and_remedies_of_a_law():
    found = explanation(drives.KIND, scene(wheel_diameter="200 mm"), Ask())
    assert found.result.status == "infeasible"
    assert {"pressure[1]", "pressure[2]", "wheel_diameter[1]"} <= set(found.conflict)
    (way,) = (r for r in found.remedies if r.what == "pressure" and r.kind == "even")
    (change,) = way.changes
    assert change.key == "limits.pressure" and way.verified["with"] == "feasible"
    least = float(change.write.strip('"').split()[0])
    for pressure, status in ((least, "optimal"), (0.999 * least, "infeasible")):
        other = scene(wheel_diameter="200 mm", pressure=f"{pressure} MPa")
        assert solve(continuous_sizing.problem(other.train())).status == status


def test_a_limit_is_called_by_its_words_else_by_its_name():
    assert (
        LimitedIndex("unit_load").label == "unit load"
        and LimitedIndex("a_b", words="c").label == "c"
    )


@pytest.mark.parametrize("count", (1, 4))
def test_a_line_lies_above_the_values_it_bounds(count):
    teeth = np.linspace(20.0, 80.0, count)
    values, gain = np.linspace(2.0, 3.0, count), np.linspace(1.2, 1.0, count)
    line = agma_floor._line(teeth, values, gain)
    above = line.constant - line.slope / teeth
    assert (above >= values * gain).all() and above[0] <= 1.3 * values[0] * gain[0]
    inverse = line.inverse(teeth)
    assert (inverse <= (1.0 + 1e-15) / above).all() and inverse == pytest.approx(
        1.0 / above, rel=1e-3
    )
