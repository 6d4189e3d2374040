"""A form in units of its own scale, for solvers whose tolerances are absolute."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearopt.optimise.epigraph import Split
from gearopt.optimise.form import Form
from gearopt.optimise.problem import Problem
from gearopt.optimise.scale import objective_scale, sizes
from gearopt.optimise.terms import Array

SWING = 0.1  # of the variables' scale, over which the objective's is measured
SHARE = 1e-2  # of that is 1 in these units: complementarity of 1e-12 is then 1e-14 of it


@dataclass(frozen=True)
class Unit:
    """Units in which a solver sees a problem, powers of two: of y (n,), and of F."""

    variables: Array
    objective: float


def scaled(shape: Form, parts: Split, units: Any) -> tuple[Any, Any, Any, Any, Any]:
    """The variables that a solver sees, and F, G, H and levels of them; logarithms stay."""
    import casadi as ca

    terms = [parts.objective, parts.inequalities, parts.equalities, parts.levels]
    if shape.logarithmic.all():
        return parts.z, *terms
    z, size = type(parts.z).sym("z", parts.z.numel()), len(shape.logarithmic)
    units = ca.vertcat(units, type(z).ones(z.numel() - size))
    return z, *ca.Function("terms", [parts.z, parts.p], terms)(z * units, parts.p)


def unit_at(problem: Problem, shape: Form, y: Array) -> Unit:
    """Units in which natural variables have a scale of about 1 at y, natural objectives of 100."""
    x = shape.to_x(y)
    own = np.where(shape.logarithmic, 1.0, sizes(problem, x))
    objective = 1.0 if shape.log_objective else SHARE * objective_scale(problem, x, SWING)
    return Unit(_power(own), float(_power(np.array(objective))))


def _power(size: Array) -> Array:
    """The power of two next to each size, exact to multiply by; 1 where it is none."""
    known = np.isfinite(size) & (size > 0.0)
    found: Array = np.exp2(np.clip(np.round(np.log2(np.where(known, size, 1.0))), -900, 900))
    return found
