"""gearopt: constrained optimisation of gears, with a proof of how good the answer is.

A name is imported when it is first asked for: the command must answer Ctrl-C before numpy is read.
"""

__version__ = "0.1.0"
TYPE_CHECKING = False  # as in typing, which takes its time too
if TYPE_CHECKING:
    from gearopt.api import compare, explain, export, load, pareto, rate, solve
    from gearopt.errors import CertificateError, GearoptError, SceneError, SolveError
    from gearopt.optimise.comparing.comparison import Comparison
    from gearopt.optimise.conic.problem import Conic
    from gearopt.optimise.explaining.explanation import Explanation
    from gearopt.optimise.pareto.front import Front
    from gearopt.optimise.problem import Problem
    from gearopt.optimise.result import Budget, Event, Outcome, Result
    from gearopt.optimise.solve import evaluate
    from gearopt.optimise.terms import Param, Repeat, Terms, Var
    from gearopt.scenes.drive.rexs.reading import read_rexs

__all__ = [
    "Budget",
    "CertificateError",
    "Comparison",
    "Conic",
    "Event",
    "Explanation",
    "Front",
    "GearoptError",
    "Outcome",
    "Param",
    "Problem",
    "Repeat",
    "Result",
    "SceneError",
    "SolveError",
    "Terms",
    "Var",
    "compare",
    "evaluate",
    "explain",
    "export",
    "load",
    "pareto",
    "rate",
    "read_rexs",
    "solve",
]


_PLACES = {  # modules that hold names of `__all__`; `api` holds the others
    "errors": ("CertificateError", "GearoptError", "SceneError", "SolveError"),
    "optimise.comparing.comparison": ("Comparison",),
    "optimise.conic.problem": ("Conic",),
    "optimise.explaining.explanation": ("Explanation",),
    "optimise.pareto.front": ("Front",),
    "optimise.problem": ("Problem",),
    "optimise.result": ("Budget", "Event", "Outcome", "Result"),
    "optimise.solve": ("evaluate",),
    "optimise.terms": ("Param", "Repeat", "Terms", "Var"),
    "scenes.drive.rexs.reading": ("read_rexs",),
}


def __getattr__(name: str) -> object:
    """A name of `__all__`, from the module that holds it."""
    if name not in __all__:
        raise AttributeError(f"module 'gearopt' has no attribute {name!r}")
    from importlib import import_module

    place = next((place for place, names in _PLACES.items() if name in names), "api")
    return getattr(import_module(f"gearopt.{place}"), name)


def __dir__() -> list[str]:
    """The names on offer."""
    return __all__
