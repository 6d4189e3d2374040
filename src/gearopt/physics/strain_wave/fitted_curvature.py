"""Curvature of a flank that is known by points alone: fits, splines, differences.

Each takes heights x (n,) in rising order, half thicknesses y (n,) and heights at which curvature is
wanted, all [mm], and returns signed curvatures [1/mm], positive where the graph is convex.
`conjugate.contact` has the curvature itself; these are what measured or tabulated points allow.
"""

from collections.abc import Callable
from typing import Any

import numpy as np


def graph_curvature(slope: Any, second: Any) -> Any:
    """Return f''/(1 + f'^2)^(3/2) [1/mm]; source: (9) of the paper, corrected.

    Printed is the radius {1 + f'}^(1/2)/f''; on a circle only (1 + f'^2)^(3/2)/|f''| is its radius.
    """
    return second / (1.0 + slope * slope) ** 1.5


def of_quartic(x: Any, y: Any, at: Any) -> Any:
    """Return curvatures of the least-squares quartic, (8) of the paper."""
    middle, half = 0.5 * (x[0] + x[-1]), 0.5 * (x[-1] - x[0])
    fit = np.polynomial.Polynomial(np.polynomial.polynomial.polyfit((x - middle) / half, y, 4))
    u = (at - middle) / half
    return graph_curvature(fit.deriv(1)(u) / half, fit.deriv(2)(u) / half**2)


def of_cubic_spline(x: Any, y: Any, at: Any) -> Any:
    """Return curvatures of the interpolating cubic spline (not-a-knot)."""
    return _of_spline(x, y, at, 3)


def of_quintic_spline(x: Any, y: Any, at: Any) -> Any:
    """Return curvatures of the interpolating quintic spline (not-a-knot)."""
    return _of_spline(x, y, at, 5)


def _of_spline(x: Any, y: Any, at: Any, degree: int) -> Any:
    from scipy.interpolate import make_interp_spline

    spline = make_interp_spline(x, y, k=degree)
    return graph_curvature(spline(at, nu=1), spline(at, nu=2))


def of_differences(x: Any, y: Any, at: Any) -> Any:
    """Return curvatures of second differences, one-sided at the ends, linear in between."""
    slope = np.gradient(y, x, edge_order=2)
    second = np.gradient(slope, x, edge_order=2)
    return np.interp(at, x, graph_curvature(slope, second))


FITS: dict[str, Callable[[Any, Any, Any], Any]] = {
    "quartic fit": of_quartic,
    "cubic spline": of_cubic_spline,
    "quintic spline": of_quintic_spline,
    "finite differences": of_differences,
}
