"""Methods: those that a problem brings itself, how any is run, and its result held to its sort.

The claims of such a method count, so that what it returns is held to its sort before it is judged.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from numbers import Real
from pkgutil import iter_modules
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise import solvers
from gearopt.optimise.result import Budget, Event, Outcome, Watch, is_number
from gearopt.optimise.terms import Array


@cache
def back_ends() -> tuple[str, ...]:
    """Return names of the back ends for any problem: the modules of `optimise/solvers`."""
    return tuple(sorted(m.name for m in iter_modules(solvers.__path__)))


def check_methods(name: str, methods: Any) -> None:
    """Raise ValueError unless the methods of a problem are functions by names of their own."""
    if not isinstance(methods, Mapping):
        raise ValueError(
            f"problem {name}: methods are a dict of functions, such as methods={{'mine': run}}, "
            f"not {type(methods).__name__}"
        )
    for method, function in methods.items():
        if not isinstance(method, str) or not callable(function):
            raise ValueError(
                f"problem {name}: methods has {method!r}: {type(function).__name__}; "
                "write a name and a function run(problem, budget, seed, watch)"
            )
        if method in back_ends():
            raise ValueError(
                f"problem {name}: {method!r} is a method of gearopt itself; give your own another "
                "name"
            )


def run_method(
    run: Callable[..., Outcome],
    problem: Any,
    method: str,
    budget: Budget,
    seed: int,
    watch: Watch | None,
) -> Outcome:
    """Return the outcome of a method; of a problem's own one, held to its sort: SolveError."""
    if method not in problem.methods:
        return run(problem, budget, seed, watch)
    outcome = run(problem, budget, seed, watch or _go_on)
    where = f"the method {method!r} of {problem.name}"
    if not isinstance(outcome, Outcome):
        raise SolveError(
            f"{where} returns {type(outcome).__name__}; return Outcome(x), or Outcome(None) where "
            "it found no point"
        )
    _check_claims(where, outcome)
    count = len(problem.columns)
    x = None if outcome.x is None else _point(where, outcome.x, count)
    return replace(outcome, x=x, others=tuple(_point(where, o, count) for o in outcome.others))


def _go_on(event: Event) -> bool:
    """Watcher of a run that nobody follows: go on."""
    return True


def _point(where: str, x: Any, count: int) -> Array:
    """Return a point (n,) of a method; SolveError where it is none."""
    try:
        point = np.asarray(x, float)
    except (TypeError, ValueError):
        raise SolveError(
            f"{where} returns a point of {type(x).__name__}; return the values of all variables "
            f"in order, ({count},)"
        ) from None
    if point.shape != (count,):
        raise SolveError(
            f"{where} returns a point of the shape {point.shape}; return the values of all "
            f"variables in order, ({count},)"
        )
    if np.isnan(point).any():
        raise SolveError(f"{where} returns a point with NaN in it; return Outcome(None) for none")
    return point


def _check_claims(where: str, outcome: Outcome) -> None:
    """Raise SolveError where a bound is no number, or stands without its proof."""
    bound, proof = outcome.bound, outcome.proof
    number = isinstance(bound, Real) and not isinstance(bound, bool) and not np.isnan(bound)
    if bound is not None and not number:
        raise SolveError(f"{where} returns the bound {bound!r}; return a number, or None")
    if proof is not None and not isinstance(proof, Mapping):
        raise SolveError(f"{where} returns the proof {proof!r}; {_PROOF}"[:300])
    sentence = (proof or {}).get("sentence")
    if sentence is not None and not isinstance(sentence, str):
        raise SolveError(f"{where} returns a proof whose sentence is {sentence!r}; {_PROOF}"[:300])
    if is_number(bound) and not sentence:
        raise SolveError(f"{where} returns a bound without its proof; {_PROOF}")
    if outcome.infeasible and proof and not sentence:
        raise SolveError(
            f"{where} returns infeasible with a proof without a sentence; return Outcome(None, "
            'infeasible=True, proof={"method": "exhausted", "sentence": "Proof: ..."})'
        )


_PROOF = (
    "a bound counts only with its proof: return "
    'Outcome(x, bound=..., proof={"method": "exhausted", "sentence": "Proof: ..."}), or no bound'
)
