"""Blocks in texts: a tuple that is indexed, unpacked and summed, and has no arithmetic."""

import operator

import numpy as np
import pytest

from gearopt import Param, Problem, SolveError, Terms, Var, evaluate, solve
from gearopt.optimise.terms import Block

SIGNS = ("add", "sub", "mul", "truediv", "pow")


@pytest.mark.parametrize("sign", SIGNS)
@pytest.mark.parametrize("other", [2, 2.0, (1.0, 2.0), Block((1.0, 2.0))])
def test_a_block_has_no_arithmetic_on_either_side(sign, other):
    block, of = Block((3.0, 4.0)), getattr(operator, sign)
    for pair in ((block, other), (other, block)):
        if sign == "add" and type(other) is tuple and pair[0] is other:
            continue  # tuple's own + comes first, and tells nothing of the right side
        with pytest.raises(TypeError, match=r"write np.array\(x.w\)"):
            of(*pair)


def test_a_block_is_neither_negated_nor_ordered_and_neither_is_a_slice():
    block = Block((3.0, 4.0, 5.0))
    for wrong in (lambda: -block, lambda: block < block, lambda: block[:2] * 2):
        with pytest.raises(TypeError, match=r"np.array\(x.w\)"):
            wrong()


def test_a_block_is_a_tuple_otherwise():
    block = Block((3.0, 4.0, 5.0))
    first, *rest = block
    assert (first, rest, block[-1], len(block)) == (3.0, [4.0, 5.0], 5.0, 3)
    assert block[1:] == (4.0, 5.0) and isinstance(block[1:], Block) and sum(block) == 12.0
    assert (np.array(block) * 2 == [6.0, 8.0, 10.0]).all() and max(block) == 5.0
    assert block == (3.0, 4.0, 5.0) and hash(block) == hash((3.0, 4.0, 5.0))


def problem(text):
    """A block w of two in [1, 2], and a parameter block q = (3, 4)."""
    w, q = Var("w", "", 1.0, 2.0, 1.5, size=2), Param("q", "", (3.0, 4.0), size=2)
    return Problem("blocks", (w,), (q,), text)


@pytest.mark.parametrize(
    "text",
    [
        lambda x, p: Terms({"f": sum(x.w * 2)}),
        lambda x, p: Terms({"f": sum(x.w + p.q)}),
        lambda x, p: Terms({"f": sum(2 * p.q) / x.w[0]}),
    ],
)
def test_a_text_that_replicates_a_block_is_refused(text):
    with pytest.raises(SolveError, match=r"blocks.*in line \d+.*write np.array\(x.w\)"):
        solve(problem(text))


def test_arithmetic_of_arrays_of_blocks_is_traced_and_evaluated_alike():
    """The least of 3 w1 + 4 w2 on [1, 2]^2 is 7; at (2, 1) it is 10."""
    own = problem(lambda x, p: Terms({"f": np.sum(np.array(x.w) * np.array(p.q))}))
    assert solve(own).value == pytest.approx(7.0, rel=1e-7)
    assert evaluate(own, {"w": [2.0, 1.0]}).value == 10.0
    assert own.batch(np.array([[2.0, 1.0], [1.0, 1.0]])).F[:, 0].tolist() == [10.0, 7.0]


def test_blocks_of_limits_of_an_own_problem_are_no_stages():
    d = Var("d", "mm", 1.0, 9.0, 3.0, size=2, log=True)
    text = lambda x, p: Terms(  # noqa: E731
        {"f": 1.0 / (x.d[0] * x.d[1])}, {"shaft_length": (x.d[0] / 4.0, x.d[1] / 5.0)}
    )
    found = solve(Problem("shafts", (d,), (), text))
    assert "The limits on shaft length[1] and shaft length[2] determine" in repr(
        found
    ) and "stage" not in repr(found)
    assert [row["utilisation, %"] for row in found.table("limits")] == [
        "shaft length[1]",
        "shaft length[2]",
    ]
