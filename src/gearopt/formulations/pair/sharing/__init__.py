"""Load sharing of tooth pairs: as a quadratic program, as a conic one, and compiled.

`physics.load_sharing` has the law and its closed form; these check it and each other.
"""

from typing import Any

import numpy as np

from gearopt.optimise.conic.problem import Conic
from gearopt.optimise.kernels import kernel
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Param, Terms, Var

KERNEL = "gearopt.formulations.pair.sharing.sharing_kernel"
SHARE_SPAN = 2.0  # of a share's box: beyond 0 and 1, so that no bound takes part of a multiplier


def problem(compliances: Any, separations: Any, load: float, coupling: float = 0.0) -> Problem:
    """Pose the sharing of a load between n pairs that are on the path, for `qp`.

    Minimise the complementary energy over the load, W/2 sum (c_i - c12) f_i^2 + W c12/2 (sum f)^2 +
    sum e_i f_i [mm], over the shares f = F/W; the limit `pull` keeps them from being negative. By
    `Result.multipliers` the price of `equilibrium` is the approach delta [mm], that of `pull[i]`
    minus the gap of pair i [mm]. compliances (n,) [mm/N], separations (n,) [mm], load W [N],
    coupling c12 [mm/N], all of them parameters.
    """
    count = len(compliances)

    def evaluate(x: Any, p: Any) -> Terms:
        shares, c, e = ([a] if count == 1 else list(a) for a in (x.f, p.c, p.e))
        whole = sum(f + 0.0 for f in shares)
        uncoupled = sum((soft - p.c12) * f**2 for soft, f in zip(c, shares, strict=True))
        energy = 0.5 * p.W * (uncoupled + p.c12 * whole**2)
        energy = energy + sum(apart * f for apart, f in zip(e, shares, strict=True))
        return Terms(
            {"energy": energy},
            {"pull": tuple(1.0 - f for f in shares)},
            equal={"equilibrium": whole},
        )

    return Problem(
        "load sharing",
        _variables(count),
        _parameters(compliances, separations, load, coupling),
        evaluate,
    )


def conic(compliances: Any, separations: Any, load: float, coupling: float = 0.0) -> Conic:
    """Pose the sharing for `conic`: products of parameters are parameters of their own (DPP)."""
    count = len(compliances)
    energies = load * (np.asarray(compliances, float) - coupling)
    parameters = (
        Param("root", "mm^(1/2)", tuple(np.sqrt(energies)), count),
        Param("e", "mm", tuple(np.asarray(separations, float)), count),
        Param("common", "mm^(1/2)", float(np.sqrt(load * coupling))),
    )

    def evaluate(x: Any, p: Any) -> Terms:
        import cvxpy as cp

        shares = cp.reshape(x.f, (count,), order="C")
        uncoupled = cp.sum_squares(cp.multiply(p.root, shares))
        apart = cp.sum(cp.multiply(p.e, shares))
        energy = 0.5 * (uncoupled + cp.square(p.common * cp.sum(shares))) + apart
        return Terms(
            {"energy": energy}, {"pull": 1.0 - shares}, equal={"equilibrium": cp.sum(shares)}
        )

    return Conic("load sharing", _variables(count), parameters, evaluate)


def _variables(count: int) -> tuple[Var, ...]:
    return (Var("f", "", -SHARE_SPAN, SHARE_SPAN, 1.0 / count, count),)


def _parameters(
    compliances: Any, separations: Any, load: float, coupling: float
) -> tuple[Param, ...]:
    c, e = (tuple(float(v) for v in a) for a in (compliances, separations))
    return (
        Param("c", "mm/N", c, len(c)),
        Param("e", "mm", e, len(e)),
        Param("W", "N", float(load)),
        Param("c12", "mm/N", float(coupling)),
    )


def share_rows(
    compliances: Array, separations: Array, load: Array, coupling: float = 0.0
) -> tuple[Array, Array]:
    """Return forces (rows, n) [N] and approach (rows,) [mm] by the compiled closed form.

    compliances, separations (rows, n), loads (rows,): as `physics.load_sharing.share`, which also
    checks them; here they are taken as they are.
    """
    c, e = (np.ascontiguousarray(a, float) for a in (compliances, separations))
    w = np.ascontiguousarray(load, float)
    forces, approach = np.empty(c.shape), np.empty(len(c))
    kernel(KERNEL).share_rows(c, e, w, float(coupling), forces, approach)
    return forces, approach
