"""A kind of file that gearopt does not have: whole numbers of bars, explained by its problem."""

import math
from fractions import Fraction
from typing import Annotated

import numpy as np
from pydantic import Field

from gearopt import Param, Problem, Terms, Var
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.result import Outcome
from gearopt.optimise.solve import solve as solve_problem
from gearopt.scenes.kind import Kind
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.fields import Table, number, quantity, whole
from gearopt.units import Quantity


class Bar(Table):
    """A bar of round steel under a pull."""

    pull: Annotated[Quantity, quantity("torque", "10 N m")] = Field(description="Pull")
    stress: Annotated[Quantity, quantity("stress", "100 MPa")] = Field(description="Allowed")
    safety: Annotated[Fraction, number("1.5", 0, 10)] = Field(description="Factor on the pull")
    most: Annotated[int, whole(1, 1, 100)] = Field(description="Most bars beside each other")
    diameter: Annotated[Quantity, quantity("length", "5 mm")] = Field(description="Largest")


class Bars(Table):
    """A further kind, which has no explain of its own."""

    bar: Bar


def bars(own, method=""):
    """Least section n d^2 of n bars, whole, of d up to a largest; in the units of the file."""
    bar = own.bar

    def evaluate(x, p):
        stress = p.pull * p.safety / (x.n * x.d**2)
        return Terms({"section": x.n * x.d**2}, {"stress": stress / p.stress, "size": x.d / p.most})

    proof = {"method": "closed form", "sentence": "Proof: a closed form."}

    def exact(problem, budget, seed, watch):
        pull, stress, safety, most = problem.parameter_values()
        least = pull * safety / stress
        n = math.ceil(least / most**2 - 1e-9)
        if n > bar.most:
            return Outcome(None, infeasible=True, proof=proof)
        return Outcome(np.array([n, math.sqrt(least / n)]), bound=least * (1 - 1e-12), proof=proof)

    parameters = (
        Param("pull", "N mm", bar.pull.value, key="bar.pull", role="given"),
        Param("stress", "MPa", bar.stress.value, key="bar.stress", role="limit"),
        Param("safety", "", float(bar.safety), key="bar.safety", role="limit"),
        Param("most", "mm", bar.diameter.value, key="bar.diameter", role="limit"),
    )
    n = Var("n", "", 1, bar.most, 1, integer=True, key=("", "bar.most"))
    d = Var("d", "mm", 0.01, 1e3, 1.0, log=True, search=True)
    return Model(Problem("bars", (n, d), parameters, evaluate, methods={"exact": exact}))


def sized(own, ask, known):
    """The least section."""
    return solve_problem(bars(own).problem)


KIND = Kind(scene=Bars, examples={}, steps=one_step(sized), posed=bars)
