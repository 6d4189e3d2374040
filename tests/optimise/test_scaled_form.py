"""Units in which a solver sees a form: powers of two next to each scale, exact to convert."""

import casadi as ca
import numpy as np
import pytest

from gearopt.optimise.form import form
from gearopt.optimise.nonlinear import scaled, split, unit_at
from gearopt.optimise.problem import Problem
from gearopt.optimise.tape import kinds
from gearopt.optimise.terms import Terms, Var


def mixed(minimise=lambda x: 3.0 * x.a + x.b, **kinds):
    """A natural variable of about 5, one of about 1000, and a logarithm."""

    def text(x, p):
        return Terms({"f": minimise(x)}, {"g": x.a * x.c / 8.0}, equal={"h": x.b / 1e3})

    ends = Var("a", "", -9.0, 9.0, 5.0), Var("b", "", 0.0, 2e3, 1e3)
    return Problem("mixed", (*ends, Var("c", "", 0.1, 9.0, 2.0, log=True)), (), text)


def test_units_are_the_powers_of_two_next_to_the_scales():
    """4 for 5, 1024 for 1000, 1 of a logarithm; 2^-7 is next to 0.01 of the objective's 0.95.

    A tenth of each scale moves 3 a + b by 1.5 and 100; divided by it that is 1015, of which 0.01
    are 10.15: 8.
    """
    problem = mixed()
    shape = form(problem)
    unit = unit_at(problem, shape, shape.to_y(np.array([5.0, 1e3, 3.0])))
    assert unit.variables.tolist() == [4.0, 1024.0, 1.0] and unit.objective == 8.0
    curved = mixed(lambda x: x.a**2)  # by 5.5^2 - 5^2, times 10, of that 0.01: 0.525
    shape = form(curved)
    unit = unit_at(curved, shape, shape.to_y(np.array([5.0, 1e3, 3.0])))
    assert unit.objective == 0.5
    steep = mixed(lambda x: np.exp(3.0 * x.a))  # over a tenth: over a hundredth it is half of it
    shape = form(steep)
    unit = unit_at(steep, shape, shape.to_y(np.array([5.0, 1e3, 3.0])))
    assert unit.objective == 2.0**20


@pytest.mark.parametrize(
    ("factor", "unit"), [(0.0, 1.0), (1e-300, 2.0**-900), (1e300, 2.0**900), (1e-12, 2.0**-37)]
)
def test_an_objective_of_any_size_has_a_unit(factor, unit):
    """1 where nothing moves it; within what doubles can divide by."""
    problem = mixed(lambda x: factor * (3.0 * x.a + x.b))
    shape = form(problem)
    found = unit_at(problem, shape, shape.to_y(np.array([5.0, 1e3, 3.0]))).objective
    assert found == unit


def test_an_objective_without_a_number_has_the_unit_1():
    for text in (lambda x: x.a * 1e308 * x.b, lambda x: 1.5e308 * (x.a - 5.0)):
        problem = mixed(text)
        shape = form(problem)
        with np.errstate(all="ignore"):
            unit = unit_at(problem, shape, shape.to_y(np.array([5.0, 1e3, 3.0])))
        assert unit.objective == 1.0


def test_logarithms_stay_as_they_are():
    """Neither variables nor the objective of a form in logarithms have a unit."""
    x = Var("x", "", 0.1, 9.0, 2.0, 2, log=True)
    problem = Problem("logs", (x,), (), lambda x, p: Terms({"f": 1e6 * x.x[0] / x.x[1]}))
    shape = form(problem)
    unit = unit_at(problem, shape, np.zeros(2))
    assert unit.variables.tolist() == [1.0, 1.0] and unit.objective == 1.0
    parts = split(shape, kinds(problem))
    assert scaled(shape, parts, None)[0] is parts.z


def test_terms_are_those_of_the_natural_variables():
    problem = mixed()
    shape = form(problem)
    parts = split(shape, kinds(problem))
    units = ca.SX.sym("units", 3)
    z, *terms = scaled(shape, parts, units)
    seen = ca.Function("seen", [z, parts.p, units], terms)
    own = ca.Function("own", [parts.z, parts.p], [parts.objective, parts.inequalities])
    size, y = np.array([4.0, 1024.0, 1.0]), shape.to_y(np.array([5.0, 1e3, 3.0]))
    f, g, h, levels = (np.array(v).ravel() for v in seen(y / size, [], size))
    assert f == pytest.approx(1015.0) and g == pytest.approx(15.0 / 8.0 - 1.0)
    assert h == pytest.approx(0.0) and len(levels) == 0
    assert f == np.array(own(y, [])[0]).ravel()


def test_epigraphs_stay_as_they_are(monkeypatch):
    monkeypatch.setattr("gearopt.optimise.nonlinear.DENSE_VARIABLES", 1)
    monkeypatch.setattr("gearopt.optimise.nonlinear.GROUP", 2)
    logs = Var("c", "", 0.1, 9.0, 2.0, 4, log=True)

    def text(x, p):
        return Terms({"f": sum(x.c)}, {"g": x.a / 8.0})

    problem = Problem("wide", (Var("a", "", -9.0, 9.0, 5.0), logs), (), text)
    shape = form(problem)
    parts = split(shape, kinds(problem))
    units = np.array([4.0, 1.0, 1.0, 1.0, 1.0])
    z, *terms = scaled(shape, parts, ca.SX(units))
    more = parts.z.numel() - 5
    assert more > 0 and parts.levels.numel() > 0
    y = np.concatenate([[6.0], np.log([1.0, 2.0, 3.0, 4.0]), np.linspace(0.5, 1.5, more)])
    seen = ca.Function("seen", [z, parts.p], terms)(y / np.concatenate([units, np.ones(more)]), [])
    own = [parts.objective, parts.inequalities, parts.equalities, parts.levels]
    for one, other in zip(seen, ca.Function("own", [parts.z, parts.p], own)(y, []), strict=True):
        assert np.array(one).ravel() == pytest.approx(np.array(other).ravel(), rel=1e-14)
