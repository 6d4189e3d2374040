"""`explain` of a kind on `teeth.problem` needs nothing but the keys of its `Train`."""

import math
from decimal import Decimal
from fractions import Fraction
from types import SimpleNamespace
from typing import Annotated

import numpy as np
import pytest
from edits import edited
from pydantic import Field

from gearopt.formulations.drive import teeth
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.lewis import LEWIS
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.solve import run, solve
from gearopt.physics.gears import MODULES, GearPair
from gearopt.scenes.explaining.explanations import explanation
from gearopt.scenes.kind import Kind
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.fields import Table, number, quantity, whole
from gearopt.scenes.reading.lists import span
from gearopt.units import Quantity

KEYS = {
    "torque": "pair.torque",
    **dict.fromkeys(("lowest_ratio", "highest_ratio"), "pair.ratio_tolerance"),
    "bending_stress": "pair.bending_stress",
    "pinion_low": "pair.pinion_teeth[1]",
    "pinion_high": "pair.pinion_teeth[2]",
    "width_high": "pair.width",
}


class PairTable(Table):
    """A gear pair."""

    torque: Annotated[Quantity, quantity("torque", "50 N m")] = Field(description="Of the pinion")
    ratio: Annotated[Fraction, number("3.5", 1, 10)] = Field(description="Its ratio")
    ratio_tolerance: Annotated[Fraction, number("1 %", 0, Fraction(1, 2), True, True)] = Field(
        description="Its"
    )
    bending_stress: Annotated[Quantity, quantity("stress", "100 MPa")] = Field(description="Most")
    pinion_teeth: Annotated[tuple[int, int], span(whole(17, 12, 99), [17, 40])] = Field(
        description="Of the pinion"
    )
    width: Annotated[Fraction, number("0.8", 0, 10)] = Field(description="b/d1")


class Pairs(Table):
    """A further kind, which has no explain of its own."""

    pair: PairTable


def model(own, method="", modules=MODULES["ISO 54 I"]):
    pair = own.pair
    stage = Stage(
        allowable=(pair.bending_stress.value,),
        face_width=FaceWidth(pair.width, pair.width),
        modules=modules,
        pinion_teeth=pair.pinion_teeth,
        wheel_teeth=(12, None),
    )
    train = Train(
        torque=pair.torque.value,
        ratio=pair.ratio,
        tolerance=pair.ratio_tolerance,
        stages=(stage,),
        law=LEWIS,
        keys=KEYS,
    )
    return Model(teeth.problem(train))


def kind(**given):
    def posed(own, method=""):
        return model(own, method, **given)

    def sized(own, ask, known):
        return solve(posed(own).problem)

    return Kind(scene=Pairs, examples={}, steps=one_step(sized), posed=posed)


FILE = {
    "torque": "50 N m",
    "ratio": Decimal("3.5"),
    "ratio_tolerance": "1 %",
    "bending_stress": "100 MPa",
    "pinion_teeth": [17, 40],
    "width": Decimal("0.8"),
}


def explained(own_kind, **changes):
    content = {"pair": FILE | changes}
    return content, explanation(own_kind, Pairs.model_validate(content), Ask())


def test_sensitivities_and_steps_are_those_of_files_solved_again():
    content, found = explained(kind())
    known = {i.key: i for i in found.influences}

    def again(**changes):
        other = Pairs.model_validate({"pair": content["pair"] | changes})
        return kind().solve(other, Ask()).value / found.result.value - 1.0

    wider = again(width=Decimal("0.80008"))
    assert wider == pytest.approx(1e-4, rel=1e-6)  # d1 stays, and the face width is in proportion
    for key, brings in (("width", wider), ("torque", again(torque="50.005 N m"))):
        one = known[f"pair.{key}"]
        assert (one.sensitivity, *one.resolved) == pytest.approx((1e4 * brings,) * 3, abs=1e-6)
    assert known["pair.bending_stress"].step == "+1%" and known["pair.torque"].step == ""
    least = known["pair.pinion_teeth[1]"]
    assert least.step == "-3" and again(pinion_teeth=[15, 40]) == 0.0
    assert least.price == pytest.approx(again(pinion_teeth=[14, 40]), abs=1e-12) and least.price < 0


@pytest.mark.slow
def test_an_impossible_pair_is_told_its_conflict_and_remedies_that_work():
    """A module of 1 mm: too little for the load with at most 40 teeth."""
    own = kind(modules=(Fraction(1),))
    content, found = explained(own)
    assert found.result.status == "infeasible"
    assert found.conflict == ("bending_stress", "pinion_teeth_high[1]")
    ways = {r.changes[0].key: r for r in found.remedies}
    assert set(ways) == {
        f"pair.{k}" for k in ("bending_stress", "pinion_teeth[2]", "torque", "width")
    }
    assert found.remedies[0].kind == "least"
    assert ways["pair.torque"].kind == ways["pair.width"].kind == "less"  # given, no limits
    for remedy in found.remedies:
        assert remedy.verified["with_less"] == "infeasible"
        assert own.solve(edited(content, remedy, model=Pairs), Ask()).status == "optimal"


def test_a_tolerance_of_zero_is_opened_by_as_little_as_it_takes():
    """3.517 = 3517/1000, of 17 to 40 teeth: 102/29 misses it by 0.0069 %, none by less."""
    content, found = explained(kind(), ratio=Decimal("3.517"), ratio_tolerance=0)
    (remedy,) = found.remedies
    (change,) = remedy.changes
    assert change.key == "pair.ratio_tolerance" and math.isinf(change.factor)
    asked = Fraction("3.517")
    missed = min(abs(Fraction(round(asked * z), z) / asked - 1) for z in range(17, 41))
    opened = edited(content, remedy, model=Pairs)
    assert float(missed) <= float(opened.pair.ratio_tolerance) < 1.002 * float(missed)
    assert kind().solve(opened, Ask()).status == "optimal"


@pytest.mark.parametrize("tolerance", [Fraction(0), Fraction(1, 50)])
def test_the_best_whole_teeth_meet_the_relaxed_limits(tolerance):
    own = Pairs.model_validate({"pair": FILE}).pair
    own = own.model_copy(update={"ratio_tolerance": tolerance})
    problem = model(SimpleNamespace(pair=own)).problem
    module, *z = run(problem)[1].x
    found = problem.relaxed.batch(np.array([[module, z[0], z[1] / z[0]]]))
    assert found.G.max() <= 1.0 + 1e-9 and not found.H.size
    assert sum(q.key != "" for q in problem.relaxed.parameters) == len(KEYS)


def test_a_law_that_is_no_posynomial_is_bounded_from_below():
    pair = GearPair.of_diameter(2.0, 20.0, 40.0, 3.5, 32.0)
    exact, bound = (law.indices(pair, 1e4, 0.0)[0] for law in (LEWIS, LEWIS.relaxed))
    assert bound == pytest.approx(exact * (1.0 - 0.912 / 20.0 / 0.154), rel=1e-12)
