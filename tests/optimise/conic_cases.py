"""Conic problems that several test files solve."""

import itertools

import cvxpy as cp
import numpy as np

from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.terms import Param, Terms, Var


def disc(radius=2.0):
    """The lowest point of a disc around (3, 4) and above a line; both limits may hold."""

    def evaluate(x, p):
        return Terms(
            {"height": x.at[1]},
            {"disc": cp.norm(x.at - np.array([3.0, 4.0])) * p.per.radius},
            report={"square": cp.square(x.at), "sum": cp.sum(x.at)},
        )

    at = Var("at", "mm", -10.0, 10.0, 0.0, size=2)
    return Conic("disc", (at,), (Param("radius", "mm", radius),), evaluate)


def linear(c, rows, ends, upper=1.0, integer=False):
    """min c.x, rows x <= ends, 0 <= x <= upper."""
    variable = Var("x", "", 0.0, upper, 0.0, size=len(c), integer=integer)
    return Conic(
        "linear",
        (variable,),
        (),
        lambda x, p: Terms({"c": c @ x.x}, {"r": rows @ x.x - ends + 1.0}),
    )


def catalogue():
    """Tolerances from a list, RSS: a mixed-integer cone program."""
    a, s = np.array([1.0, 2.0, 3.0, 4.0]), np.array([3.0, 1.0, 2.0, 1.0])
    values = (0.01, 0.02, 0.03, 0.05, 0.08)

    def evaluate(x, p):
        return Terms(
            {"c": a @ cp.inv_pos(x.t)}, {"rss": cp.norm(cp.multiply(s, x.t)) * p.per.budget}
        )

    choices = np.array(list(itertools.product(values, repeat=4)))
    best = {
        b: (a / choices)[np.linalg.norm(s * choices, axis=1) <= b].sum(axis=1).min()
        for b in (0.1, 0.2)
    }
    t = Var("t", "mm", 0.01, 0.08, 0.01, size=4, values=values)
    return Conic("catalogue", (t,), (Param("budget", "", 0.2),), evaluate), best
