"""The search for the smallest change, on files whose answer is a formula."""

from decimal import Decimal

import pytest
from bars import Bars

from gearopt.optimise.clock import Clock
from gearopt.scenes.explaining.engine import (
    FeasibilityQuestions,
    Group,
    of_use,
    singles,
    with_least,
)
from gearopt.scenes.explaining.moves import DUTY, Move
from gearopt.scenes.explaining.possible import UNKNOWN, Verdict

BAR = {"pull": "10 N m", "stress": "100 MPa", "safety": Decimal("1.5"), "most": 4}
SCENE = Bars.model_validate({"bar": BAR | {"diameter": "5 mm"}})
STRESS = Move(("bar", "stress"), 1, power=2.5)


def asked(answer, **more):
    """FeasibilityQuestions of which answer(number of MPa) is the verdict, and the numbers asked."""
    seen = []

    def possible(scene, clock):
        seen.append(float(scene.bar.stress.number))
        return answer(seen[-1])

    return FeasibilityQuestions(SCENE, possible, Clock(), **more), seen


@pytest.mark.parametrize("power", [2.5, 0.7])
def test_secants_of_the_excess_find_the_number_in_few_questions(power):
    """A utilisation 8 (100/s)^p is 1 at 100 8^(1/p)."""
    questions, seen = asked(lambda s: Verdict(None, 8.0 * (100.0 / s) ** power - 1.0), excess=7.0)
    questions.sure = lambda scene, clock: Verdict(True)
    (remedy,) = singles(questions, [Group((STRESS,))])
    needed = 8.0 ** (1.0 / power)
    assert needed <= remedy.factor < needed * (1.0 + 1e-4) and len(seen) < 8
    assert remedy.verified == {"with": "feasible", "with_less": "undecided"}
    assert float(remedy.changes[0].short.strip('"').split()[0]) >= 100.0 * needed


def test_an_excess_that_does_not_fall_ends_the_search_soon():
    questions, seen = asked(lambda s: Verdict(False, 0.5), excess=0.5)
    assert singles(questions, [Group((STRESS,))]) == [] and len(seen) < 4


@pytest.mark.parametrize("least", [1.0004, 1.05, 1.4, 30.0, 5e4])
@pytest.mark.parametrize("band", [1.0, 1.003, 1.3])
def test_what_is_undecided_is_not_known_to_suffice_and_hides_nothing(least, band):
    def answer(stress):
        enough = stress >= 100.0 * least
        return Verdict(True if enough else (None if stress * band >= 100.0 * least else False))

    questions, seen = asked(answer)
    (remedy,) = singles(questions, [Group((STRESS,))])
    assert least <= remedy.factor <= least * max(1.0006, band) and len(seen) < 22
    assert band > 1.0 or remedy.verified["with_less"] == "infeasible"


def test_one_question_rejects_a_number_that_does_not_help():
    questions, seen = asked(lambda s: Verdict(False))
    assert singles(questions, [Group((STRESS,))]) == [] and len(seen) == 1
    questions, _ = asked(lambda s: UNKNOWN)
    assert singles(questions, [Group((STRESS,))]) == []


def test_a_number_of_steps_goes_to_the_first_that_does():
    """4 bars become 7; 6 would not do, which was tried."""
    move = Move(("bar", "most"), 1, steps=tuple(k / 4.0 for k in range(5, 12)))
    questions = FeasibilityQuestions(SCENE, lambda own, clock: Verdict(own.bar.most >= 7), Clock())
    (remedy,) = singles(questions, [Group((move,))])
    assert remedy.changes[0].write == "7" and remedy.verified["with_less"] == "infeasible"


def test_numbers_that_move_alike_have_one_factor_and_the_duty_comes_last():
    """Stress times diameter squared, over pull: 2 is 100 * 5^2/10 times 1.25^-3."""

    def possible(own, clock):
        bar = own.bar
        return Verdict(float(bar.stress.number * bar.diameter.number**2 / bar.pull.number) >= 500)

    both = (STRESS, Move(("bar", "diameter"), 1))
    pull = Move(("bar", "pull"), -1, DUTY)
    questions = FeasibilityQuestions(SCENE, possible, Clock(), lower_bounds=True)
    found = with_least(singles(questions, [Group((pull,)), Group(both)]), True)
    even, less = found
    assert (even.kind, less.kind) == ("least", "less")
    assert even.factor == pytest.approx(2.0 ** (1.0 / 3.0), rel=6e-4)
    assert even.bound < 2.0 ** (1.0 / 3.0) and less.factor == pytest.approx(2.0, rel=6e-4)
    assert even.verified["others"] == "need more"


@pytest.mark.parametrize("needs", [[130.0], [130.0, 131.0, 160.0, 400.0, 3e4], range(111, 1000, 7)])
def test_known_designs_lead_to_the_least_change_in_fewer_questions(needs):
    """Designs need so many MPa; the most demanding of those that carry is found."""
    known = []

    def answer(stress):
        enough = [need for need in needs if need <= stress]
        known.extend(enough[-1:] and [max(enough)])
        return Verdict(bool(enough))

    def likely(scene, clock):
        return Verdict(float(scene.bar.stress.number) >= min(known[-2:]) or None)

    plain, every = asked(answer)
    (least,) = singles(plain, [Group((STRESS,))])
    questions, seen = asked(answer, likely=likely, dear=True)
    (remedy,) = singles(questions, [Group((STRESS,))])
    assert min(needs) <= 100.0 * remedy.factor <= min(needs) * 1.0006
    assert remedy.verified["with_less"] == least.verified["with_less"] == "infeasible"
    assert len(needs) > 5 or len(seen) < 0.7 * len(every)


def test_numbers_of_no_use_together_are_asked_about_at_once():
    """The diameter alone helps: of five numbers three questions leave the two with it."""
    others = [Move(("bar", "pull"), -1, far=far) for far in (2.0, 3.0, 4.0)]
    groups = [Group((move,)) for move in (STRESS, *others[:2])]
    wide = Group((Move(("bar", "diameter"), 1),))
    count = []

    def possible(own, clock):
        count.append(own)
        return Verdict(own.bar.diameter.number >= 8)

    questions = FeasibilityQuestions(SCENE, possible, Clock())
    assert of_use(questions, groups) == [] and len(count) == 1
    assert of_use(questions, [*groups, wide])[-1] == wide and len(count) <= 4
