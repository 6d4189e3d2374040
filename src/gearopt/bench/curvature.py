"""Curvature of a conjugate flank: fits to its points, derivatives by AD and the closed form.

An 80:1 strain wave gearing of module 0.5 mm. The contact needs the difference of two curvatures
that are within 5 % of each other, so that an error of the flank's grows by a factor of 23 to 26 in
the radius R, and by half of that in Hertz's pressure p0.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from gearopt.bench import timed
from gearopt.optimise.tape import legacy_numpy
from gearopt.physics.strain_wave.conjugate import Flank, contact, flank
from gearopt.physics.strain_wave.fitted_curvature import FITS
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.tooth_motion import motion, small_motion

GEARING = StrainWave(0.5, 160, profile_shift=0.9)
STATIONS = 101  # at which curvatures are compared
DATA = {"exact": 0.0, "1 nm": 1e-6, "0.1 um": 1e-4}  # largest error of a point [mm]
POINTS = (11, 21, 51, 201)
SEEDS = 25  # of errors of points
NEWTON_STEPS = 4  # of Newton from a pose to that of a radius


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: method, data, points, relative errors of curvature, R and p0, time.

    The largest over all stations; of data with errors medians over SEEDS draws, and the worst p0.
    A contact whose 1/R comes out negative has neither R nor p0: such stations are counted (median).
    ms: of all stations.
    """
    mated, at = flank(GEARING, STATIONS), flank(GEARING, STATIONS).contacts
    closed, times = timed(lambda: _closed(mated), repeat)
    rows = [_row("closed form", "", "", [closed], at, times)]
    function, angles = by_derivatives(mated), at.motion.angle
    curvature, times = timed(lambda: function(angles), repeat)
    rows.append(_row("AD of the position", "", "", [curvature], at, times))
    curvature, times = timed(lambda: of_small_displacements(mated), repeat)
    rows.append(_row("ring theory of first order", "", "", [curvature], at, times))
    for data, noise in DATA.items():
        for count in POINTS:
            draws = [points(mated, count, noise, seed) for seed in range(SEEDS if noise else 1)]
            for name, fit in FITS.items():
                _, times = timed(partial(fit, *draws[0], at.point.x), repeat)
                curvature = [fit(*draw, at.point.x) for draw in draws]
                rows.append(_row(name, data, count, curvature, at, times))
    return rows


def _closed(made: Flank) -> Any:
    """Return the curvature by the text that the reference is made of."""
    touching = contact(made.gearing, motion(made.gearing, made.curve, made.contacts.motion.angle))
    return touching.curvatures[1]


def of_small_displacements(made: Flank) -> Any:
    """Return the curvature where first-order ring theory has contact at the same radii."""
    gearing, wanted = made.gearing, made.contacts.tangent
    arc = made.contacts.motion.arc
    for _ in range(NEWTON_STEPS):
        touching = contact(gearing, small_motion(gearing, arc))
        arc = arc - (touching.tangent - wanted) / touching.tangent_rate
    return contact(gearing, small_motion(gearing, arc)).curvatures[1]


def points(made: Flank, count: int, noise: float, seed: int = 0) -> tuple[Any, Any]:
    """Return so many points of a flank, thicknesses with uniform errors up to `noise` [mm]."""
    import numpy as np

    angle = made.contacts.motion.angle
    poses = motion(made.gearing, made.curve, np.linspace(angle[0], angle[-1], count))
    exact = contact(made.gearing, poses).point
    rng = np.random.default_rng(seed)
    return exact.x, exact.y + noise * rng.uniform(-1.0, 1.0, count)


def by_derivatives(made: Flank) -> Callable[[Any], Any]:
    """Return the curvature of the flank by two derivatives of its position, traced by casadi."""
    import casadi as ca
    import numpy as np

    with legacy_numpy():
        angle = ca.SX.sym("p")
        at = contact(made.gearing, motion(made.gearing, made.curve, angle)).point
        first = [ca.gradient(v, angle) for v in (at.x, at.y)]
        second = [ca.gradient(v, angle) for v in first]
        cross = first[0] * second[1] - first[1] * second[0]
        curvature = cross / (first[0] ** 2 + first[1] ** 2) ** 1.5
        function = ca.Function("curvature", [angle], [curvature]).map(STATIONS)
    return lambda angles: np.array(function(angles[None])).ravel()


def _row(
    method: str, data: str, count: int | str, found: list[Any], at: Any, times: dict[str, float]
) -> dict[str, Any]:
    """Return the errors of curvatures, of every draw the largest."""
    import numpy as np

    errors = np.array([_errors(one, at) for one in found])
    middle, worst = np.median(errors, axis=0), errors[:, 2].max()
    return {
        "method": method,
        "data": data,
        "points": count,
        "curvature": _short(middle[0]),
        "radius": _short(middle[1]),
        "p0": _short(middle[2]),
        "worst_p0": _short(worst),
        "wrong_sign": int(middle[3]),
        "ms": times["median_ms"],
    }


def _errors(found: Any, at: Any) -> tuple[float, float, float, int]:
    """Return the largest errors of curvature, R and p0, and at how many stations 1/R < 0."""
    import numpy as np

    spline, exact = at.curvatures
    known = spline > found
    share = (spline - found)[known] / at.gap_curvature[known]
    radius = np.abs(1.0 / share - 1.0).max() if known.any() else np.inf
    pressure = np.abs(np.sqrt(share) - 1.0).max() if known.any() else np.inf
    return np.abs(found / exact - 1.0).max(), radius, pressure, int((~known).sum())


def _short(value: float) -> float:
    return float(f"{value:.2g}")
