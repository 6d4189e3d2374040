"""Problems in two lines for the tests of boxes, and the public ones of `gearopt bench global`."""

from importlib import import_module

from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var

CASES = import_module("gearopt.bench.global").cases()


def posed(bounds, text, guess=None):
    """Problem of text(x) -> (objective, limits <= 0, equalities = 0), ends (low, high[, WHOLE])."""
    variables = []
    for k, (low, high, *kind) in enumerate(bounds):
        start = guess[k] if guess else round(0.5 * (low + high)) if kind else 0.5 * (low + high)
        variables.append(Var(f"x{k + 1}", "", low, high, start, integer=bool(kind)))

    def evaluate(x, p):
        f, g, h = text([getattr(x, f"x{k + 1}") for k in range(len(bounds))])
        rows = {"g": tuple(1.0 + v for v in g)} if g else {}
        return Terms({"f": f}, rows, equal={"h": tuple(1.0 + v for v in h)} if h else {})

    return Problem("case", tuple(variables), (), evaluate)


def case(name):
    """Known optimum and problem of a public case."""
    return CASES[name].optimum, CASES[name].problem()
