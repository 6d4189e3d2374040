"""gearopt: constrained optimisation of gears, with a proof of how good the answer is."""

from gearopt.api import load, solve
from gearopt.errors import CertificateError, GearoptError, SceneError, SolveError
from gearopt.optimise.problem import Param, Problem, Repeat, Terms, Var
from gearopt.optimise.result import Budget, Event, Result

__all__ = [
    "Budget",
    "CertificateError",
    "Event",
    "GearoptError",
    "Param",
    "Problem",
    "Repeat",
    "Result",
    "SceneError",
    "SolveError",
    "Terms",
    "Var",
    "load",
    "solve",
]
