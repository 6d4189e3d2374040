"""A design that is only evaluated: every limit's utilisation at a point, and what is made of it."""

import json
import math

import cvxpy as cp
import numpy as np
import pytest
from typer.testing import CliRunner

import gearopt
from gearopt import Conic, Param, Problem, Repeat, Result, Terms, Var, evaluate
from gearopt.cli import app
from gearopt.cli.app import exit_code
from gearopt.report.pages.result import page
from gearopt.report.words import certainty


def beam():
    """Mass and bending of a bar, whose height is one of a list."""

    def evaluate(x, p):
        bending = p.moment / (x.width[0] * x.height**2 / 6.0)
        return Terms(
            {"mass": (x.width[0] + x.width[1]) * x.height},
            {"bending": bending / 100.0, "slenderness": x.height / x.width[1] / 20.0},
            report={"stress": bending},
            equal={"even": x.width[0] / x.width[1]},
        )

    width = Var("width", "mm", 1.0, 50.0, 5.0, size=2)
    height = Var("height", "mm", 1.0, 100.0, 10.0, values=(10.0, 20.0, 40.0))
    return Problem("beam", (width, height), (Param("moment", "N mm", 1e4),), evaluate)


def test_a_point_is_evaluated_by_name_or_in_order():
    result = evaluate(beam(), {"width": (5.0, 5.0), "height": 20.0})
    assert Result.from_json(result.to_json()).to_json() == result.to_json()
    assert result.status == "evaluated" and result.feasible and result.message == ""
    assert (
        result.objective == {"name": "mass", "value": 200.0} and result.bound is result.gap is None
    )
    assert result.limits == {"bending": pytest.approx(0.3), "slenderness": pytest.approx(0.2)}
    assert result.design == {"width_mm": [5.0, 5.0], "height_mm": 20.0}
    assert result.report == {"stress": pytest.approx(30.0)}
    again = evaluate(beam(), np.array([5.0, 5.0, 20.0]))
    assert again.limits == result.limits and again.design == result.design
    at = evaluate(beam().at(moment=5e4), {"width": (5.0, 5.0), "height": 20.0})
    assert at.limits["bending"] == pytest.approx(1.5) and not at.feasible
    assert at.message == "bending is violated by 0.5"


@pytest.mark.parametrize(
    ("point", "words"),
    [
        ([5.0, 4.0, 20.0], "even is violated by 0.25"),
        ([5.0, 5.0, 15.0], "height = 15 is not one of its values"),
        ([60.0, 60.0, 20.0], "width[1] = 60 is above its bound 50"),
        ([50.0 + 1e-6, 50.0 + 1e-6, 20.0], "bound of width[1] is violated by 2.04e-08"),
    ],
)
def test_what_the_user_did_not_name_a_limit_counts_too(point, words):
    result = evaluate(beam(), np.array(point))
    assert not result.feasible and result.message.startswith(words)
    assert max(result.limits.values()) <= 1.0  # none of them is a limit of the user's


@pytest.mark.parametrize(
    ("point", "words"),
    [
        ({"width": (5.0, 5.0)}, "missing height; variables: width, height"),
        ({"width": (5.0, 5.0), "height": 20.0, "depth": 1.0}, "unknown depth"),
        ({"width": 5.0, "height": 20.0}, "width=5.0: write 2 numbers"),
        (np.ones(2), "needs 3 numbers"),
        ([1.0, math.nan, 1.0], "needs 3 numbers"),
    ],
)
def test_a_wrong_point_is_named(point, words):
    with pytest.raises(ValueError, match=words):
        evaluate(beam(), point)


def test_repeats_and_conic_problems_are_evaluated():
    own = Var("v", "", 0.0, 9.0, 1.0)
    rows = Repeat(
        "row",
        (own,),
        {"pull": [1.0, 2.0]},
        lambda x, p, r: Terms({"cost": (x.v - r.pull) ** 2}, {"high": x.v / x.top}),
    )
    top = Var("top", "", 1.0, 9.0, 2.0)
    problem = Problem("rows", (top,), (), lambda x, p: Terms({"cost": x.top}), (rows,))
    result = evaluate(problem, {"top": 2.0, "row[1].v": 1.0, "row[2].v": 4.0})
    assert result.value == pytest.approx(6.0) and not result.feasible
    assert result.limits == {"row.high[1]": 0.5, "row.high[2]": 2.0}
    t = Var("t", "mm", 0.5, 9.0, 2.0, size=2)
    conic = Conic(
        "sum", (t,), (), lambda x, p: Terms({"cost": cp.sum(x.t)}, {"least": cp.inv_pos(x.t[0])})
    )
    found = evaluate(conic, {"t": (2.0, 3.0)})
    assert found.value == 5.0 and found.feasible and found.limits == {"least": pytest.approx(0.5)}


def test_an_objective_that_is_no_number_is_none():
    x = Var("x", "", 0.0, 2.0, 1.0)
    problem = Problem("odd", (x,), (), lambda x, p: Terms({"f": np.log(x.x)}, {"g": x.x}))
    result = evaluate(problem, [0.0])
    assert result.value is None and result.design == {"x": 0.0} and result.limits == {"g": 0.0}


def test_exit_codes_words_and_page(tmp_path):
    met = evaluate(beam(), {"width": (5.0, 5.0), "height": 20.0})
    broken = evaluate(beam().at(moment=5e4), {"width": (5.0, 5.0), "height": 20.0})
    assert (exit_code(met), exit_code(broken)) == (0, 3)
    assert certainty(met)[0] == "evaluated, all limits met"
    assert certainty(broken)[0] == "evaluated, a limit is exceeded"
    assert "The given design was evaluated, not optimised; it meets all limits." in page(
        met, "solve"
    )
    assert "not optimised; it does not meet all limits." in page(broken, "solve")
    kept = tmp_path / "kept.json"
    kept.write_text(broken.to_json())
    shown = CliRunner().invoke(app, ["report", str(kept)])
    assert shown.exit_code == 3 and "bending" in shown.output and "150" in shown.output


def test_a_result_without_an_objective_is_evaluated():
    """As a rating has it: limits only."""
    data = json.loads(evaluate(beam(), {"width": (5.0, 5.0), "height": 20.0}).to_json())
    bare = Result.from_dict({**data, "objective": {}})
    assert bare.value is None and bare.feasible and exit_code(bare) == 0
    assert "bending" in page(bare, "solve")
    with pytest.raises(ValueError, match="an objective without a name"):
        Result.from_dict({**data, "objective": {}, "status": "feasible"})


@pytest.mark.slow
def test_other_results_know_whether_they_are_feasible():
    found = gearopt.solve(beam(), method="annealing", budget=gearopt.Budget(evaluations=4000))
    assert found.status == "feasible" and found.feasible
    impossible = gearopt.solve(gearopt.load("problems/servo_gimbal_impossible.toml"))
    assert not impossible.feasible


def test_a_design_is_a_point_and_a_wrong_value_names_its_variable():
    result = evaluate(beam(), {"width": (5.0, 6.0), "height": 20.0})
    assert set(result.design) == {"width_mm", "height_mm"}
    assert evaluate(beam(), result.design).value == result.value == 220.0
    wrong = {"width": (5.0, 6.0), "height": "3 mm"}
    with pytest.raises(ValueError, match="beam: height='3 mm': write a number"):
        evaluate(beam(), wrong)
    with pytest.raises(ValueError, match="beam: width_*=5.0: write 2 numbers"):
        evaluate(beam(), {"width": 5.0, "height": 20.0})


def test_the_version_is_that_of_the_package():
    assert gearopt.__version__ == result_version()


def result_version():
    """The version as results carry it."""
    return evaluate(beam(), {"width": (5.0, 6.0), "height": 20.0}).gearopt
