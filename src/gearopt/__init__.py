"""gearopt: constrained optimisation of gears, with a proof of how good the answer is."""

from gearopt.api import compare, explain, load, solve
from gearopt.errors import CertificateError, GearoptError, SceneError, SolveError
from gearopt.optimise.comparing.comparison import Comparison
from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Result
from gearopt.optimise.terms import Param, Repeat, Terms, Var

__all__ = [
    "Budget",
    "CertificateError",
    "Comparison",
    "Conic",
    "Event",
    "Explanation",
    "GearoptError",
    "Param",
    "Problem",
    "Repeat",
    "Result",
    "SceneError",
    "SolveError",
    "Terms",
    "Var",
    "compare",
    "explain",
    "load",
    "solve",
]
