"""Duals of the rows of a box from HiGHS, warm started, in columns of the box's own scale.

Entries of rows spread over many decades as boxes shrink, and a solver drops what is small. So every
box is given in units of its widths, rows to a largest entry of 1. What comes back is a hint alone.
"""

import math
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.spatial.step import Stepper, scaling
from gearopt.optimise.terms import Array

ITERATIONS = 20_000  # of one linear program
SMALL = 1e-300


@dataclass(frozen=True)
class Hint:
    """Answer of the linear solver: duals (m,), its point (C,) or None, basis; ray: of emptiness."""

    y: Array
    x: Array | None
    basis: Any
    ray: bool = False


class Linear:
    """One HiGHS object for all boxes of a run; it has state because it keeps model and basis."""

    def __init__(self, stepper: Stepper) -> None:
        from highspy._core import _Highs as Highs  # the public class says its version on making

        self.stepper, self.solver = stepper, Highs()
        options = {"output_flag": False, "presolve": "off", "threads": 1, "solver": "simplex"}
        options |= {"simplex_iteration_limit": ITERATIONS}
        for name, value in options.items():
            self.solver.setOptionValue(name, value)
        width = len(stepper.columns.lower)
        self.shift, self.unit, self.factor, self.out = scaling(stepper)
        self.cost, self.aimed, self.kinds = np.zeros(width), -1, np.zeros(width, np.int32)

    def load(self, lower: Array, upper: Array, aim: int, sign: float, basis: Any) -> None:
        """Pass the filled rows of a box, to minimise sign times a column."""
        from highspy import MatrixFormat, ObjSense

        kernel, out = self.stepper.kernel, self.out
        entries = kernel.scale(
            self.stepper.rows, lower, upper, self.shift, self.unit, self.factor, out
        )
        self.cost[:] = 0.0
        self.cost[aim], self.aimed = sign, aim
        first, column, number, least, most, low, high = out
        self.solver.passModel(
            len(low), len(least), entries, int(MatrixFormat.kRowwise), int(ObjSense.kMinimize),
            0.0, self.cost, low, high, least, most, first[:-1], column[:entries],
            number[:entries], self.kinds,
        )  # fmt: skip
        if basis is not None:
            self.solver.setBasis(basis)

    def aim(self, j: int, sign: float) -> None:
        """Minimise sign times another column of the model that is loaded."""
        self.solver.changeColCost(self.aimed, 0.0)
        self.solver.changeColCost(j, sign)
        self.aimed = j

    def solved(self) -> Hint:
        """Solve what is loaded."""
        from highspy import HighsModelStatus

        self.solver.run()
        status = self.solver.getModelStatus()
        if status == HighsModelStatus.kInfeasible:
            _, there, ray = self.solver.getDualRay()
            y = np.array(ray) * self.factor if there else np.zeros(self.stepper.count)
            return Hint(np.nan_to_num(y), None, None, True)
        if status != HighsModelStatus.kOptimal:
            return Hint(np.zeros(self.stepper.count), None, None)
        solution = self.solver.getSolution()
        x = self.shift + self.unit * np.array(solution.col_value)
        y = np.array(solution.row_dual) * self.factor * self.unit[self.aimed]
        finite = bool(np.isfinite(y).all() and np.isfinite(x).all())
        return Hint(
            y if finite else np.zeros(len(y)), x if finite else None, self.solver.getBasis()
        )


def better_ray(stepper: Stepper, y: Array, lower: Array, upper: Array) -> Array:
    """The dual ray in that one of its signs that proves more."""
    plus, minus = (stepper.safe(s * y, -1, 0.0, lower, upper) for s in (1.0, -1.0))
    return y if plus >= minus or math.isnan(minus) else -y
