"""Ipopt's side of casadi: a nonlinear program, its options, and the monitor of its iterates."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from gearopt.optimise.epigraph import WIDE
from gearopt.optimise.terms import Array

OPTIONS = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-12,  # the dual bound is as tight as the multipliers
    "constr_viol_tol": 1e-12,
    "compl_inf_tol": 1e-12,
    "dual_inf_tol": 1e-9,
    "acceptable_tol": 1e-10,
    "acceptable_iter": 8,
    "bound_relax_factor": 0.0,  # the default buys 1e-8 of every bound
    "max_iter": 3000,
}


def program(z: Any, p: Any, f: Any, g: Any, size: int) -> tuple[Any, Any]:
    """Ipopt for a program in z, and its monitor, which is told the first `size` of z."""
    import casadi as ca

    monitor = _monitor_class()(z.numel(), g.numel(), size)
    options = {f"ipopt.{k}": v for k, v in OPTIONS.items()}
    options |= {
        "print_time": False,
        "iteration_callback": monitor,
        "error_on_fail": False,
        "show_eval_warnings": False,
        "calc_lam_p": False,  # nobody asks for them, and casadi warns where they are no numbers
    }
    if size > WIDE:
        options |= dense_hessian(z, p, f, g)
    return ca.nlpsol("ipopt", "ipopt", {"x": z, "p": p, "f": f, "g": g}, options), monitor


def dense_hessian(z: Any, p: Any, f: Any, g: Any) -> dict[str, Any]:
    """The option that spares casadi the colouring of a dense Hessian, which takes n^3 steps."""
    import casadi as ca

    given = [z, p, type(z).sym("lam_f"), type(z).sym("lam_g", g.numel())]
    slope = ca.gradient(given[2] * f + ca.dot(given[3], g), z)
    if ca.Function("slope", given, [slope]).jac_sparsity(0, 0).nnz() <= WIDE * z.numel():
        return {}
    names = ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]
    return {"hess_lag": ca.Function("hessian", given, [ca.triu(ca.jacobian(slope, z))], *names)}


@cache
def _monitor_class() -> Any:
    """The class of casadi's iteration callback (casadi is imported late)."""
    import casadi as ca

    class Monitor(ca.Callback):  # type: ignore[misc]
        """It has state because casadi calls it: follow(y) says whether the run goes on."""

        def __init__(self, n: int, m: int, size: int) -> None:
            super().__init__()
            self.sizes = {"f": 1, "x": n, "lam_x": n, "g": m, "lam_g": m}
            self.size = size
            self.follow: Callable[[Array], bool] = lambda y: True
            self.construct("monitor", {})

        def get_n_in(self) -> int:
            return int(ca.nlpsol_n_out())

        def get_n_out(self) -> int:
            return 1

        def get_name_in(self, i: int) -> Any:
            return ca.nlpsol_out(i)

        def get_sparsity_in(self, i: int) -> Any:
            return ca.Sparsity.dense(self.sizes.get(ca.nlpsol_out(i), 0), 1)

        def eval(self, arguments: Any) -> list[int]:
            point = np.array(arguments[ca.nlpsol_out().index("x")]).ravel()
            return [int(not self.follow(point[: self.size]))]

    return Monitor
