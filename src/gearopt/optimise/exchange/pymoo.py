"""Problems to and from pymoo: the same text, as pymoo's algorithms ask for it, and back."""

from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var

INFINITE = 1e300  # where a text has no number: no algorithm prefers it


def exported(problem: Problem) -> Any:
    """A problem of pymoo: F (N, f), G (N, g) <= 0, H (N, h) = 0, in the columns' order.

    SolveError for listed values, which pymoo has not, and for variables without bounds.
    """
    from pymoo.core.problem import Problem as Pymoo

    rows, (lower, upper, _) = problem.rows, problem.bounds()
    if listed := [name for v, name in problem.columns if v.values is not None]:
        raise SolveError(f"{problem.name}: pymoo has no list of values, as {listed[0]} has")
    if wide := [n for (_, n), b in zip(problem.columns, upper - lower, strict=True) if b == np.inf]:
        raise SolveError(f"{problem.name}: pymoo samples between bounds; {wide[0]} has none")
    whole = [v.integer for v, _ in problem.columns]

    class Exported(Pymoo):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(
                n_var=len(lower),
                n_obj=len(rows.objectives),
                n_ieq_constr=len(rows.inequalities),
                n_eq_constr=len(rows.equalities),
                xl=lower,
                xu=upper,
                vtype=int if all(whole) else float,
            )
            self.name = problem.name

        def _evaluate(self, x: Any, out: dict[str, Any], *rest: Any, **more: Any) -> None:
            with np.errstate(all="ignore"):
                batch = problem.batch(np.where(whole, np.rint(x), x))
            parts = {"F": batch.F, "G": batch.G - 1.0, "H": batch.H - 1.0}
            out |= {k: np.nan_to_num(v, nan=INFINITE, posinf=INFINITE) for k, v in parts.items()}

    return Exported()


def imported(problem: Any, name: str = "") -> Problem:
    """The problem of a pymoo problem: one variable x of its length, rows g <= 0 and h = 0.

    Its text is pymoo's evaluation of one point, which has no derivatives: annealing and nsga2 take
    it. name: by default that of the class. ValueError for variables that are no numbers.
    """
    from pymoo.core.problem import Problem as Pymoo

    if not isinstance(problem, Pymoo) or getattr(problem, "vars", None):
        raise ValueError("from_pymoo takes a pymoo Problem of numbers, without mixed variables")
    size, several = problem.n_var, problem.n_obj > 1
    lower, upper = (np.broadcast_to(np.asarray(b, float), size) for b in (problem.xl, problem.xu))
    middle = (lower + upper) / 2.0
    whole = problem.vtype in (int, np.int64)
    guess = np.rint(middle) if whole else middle
    low, high, first = (tuple(b.tolist()) for b in (lower, upper, guess))
    variable = Var("x", "", low, high, first, size, integer=whole)

    def evaluate(x: Any, p: Any) -> Terms:
        point = np.array([x.x] if size == 1 else x.x, float)
        out = problem.evaluate(point[None], return_as_dictionary=True)
        values = {k: np.asarray(out[k], float).reshape(-1) for k in ("F", "G", "H") if k in out}
        goals = [f"f{k}" for k in range(1, problem.n_obj + 1)] if several else ["f"]
        limits = 1.0 + values.get("G", np.empty(0))
        equal = 1.0 + values.get("H", np.empty(0))
        return Terms(
            dict(zip(goals, values["F"].tolist(), strict=True)),
            {"g": tuple(limits.tolist())} if limits.size else {},
            equal={"h": tuple(equal.tolist())} if equal.size else {},
        )

    return Problem(name or type(problem).__name__, (variable,), (), evaluate)
