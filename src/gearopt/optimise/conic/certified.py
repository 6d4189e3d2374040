"""The method run on a problem of cvxpy text, its outcome certified."""

from collections.abc import Callable

from gearopt.errors import SolveError
from gearopt.optimise.certified import GAP, result_of, unknown_method
from gearopt.optimise.clock import Clock, of_problem
from gearopt.optimise.conic.certificate import certify
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.deadline import until
from gearopt.optimise.methods import back_ends
from gearopt.optimise.result import Budget, Outcome, Result, Watch

METHOD = "conic"
LIBRARIES = ("cvxpy", "clarabel")  # what an answer rests on


def run(
    problem: Conic,
    method: str | None = None,
    budget: Budget | None = None,
    seed: int = 0,
    watch: Watch | None = None,
    gap: float = GAP,
) -> tuple[Result, Outcome]:
    """Certified answer to one problem, and the raw outcome; arguments as of a `Problem`."""
    name, budget = method or METHOD, budget or Budget()
    clock, follow = Clock(), of_problem(watch, problem)
    call = method_of(problem, name)
    with until(budget.seconds):
        outcome = call(problem, budget, seed, follow)
        verdict = certify(problem, outcome, gap)
    return result_of(problem, name, outcome, verdict, clock.seconds, seed, LIBRARIES), outcome


def method_of(problem: Conic, name: str) -> Callable[..., Outcome]:
    """`run` of the method for a problem; SolveError for another name."""
    if name in back_ends() and name != METHOD:
        raise SolveError(f"{name} takes a Problem (numpy text); {problem.name} is a Conic")
    if name != METHOD:
        raise unknown_method(name, [METHOD])
    from gearopt.optimise.solvers import conic

    return conic.run
