"""The best relief of any shape: what is removed at every sampled point of the path of contact.

The shape falls from the start of the path to its middle and rises from there to its end, and may
have to be convex on either side, as linear, parabolic and power reliefs are. The middle itself is
one of the points: the least value of all such shapes at the positions of the gears bounds that of
every convex relief of both tips that ends at the middle or before.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.formulations.pair.relief.free_search import search
from gearopt.formulations.pair.relief.meshing import Mesh
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Terms, Var

# mm: positions that are one point; between them a shape changes by less than 1e-10 um
POSITION_TIE = 1e-11
UNIT = 1e-3  # mm: of rows of shape and contact


@dataclass(frozen=True)
class Shape:
    """What a free relief may be: most [mm] anywhere; convex on either side of the middle or not.

    short: nothing is removed where a single pair carries. complete: no pair loses contact at any
    load.
    """

    most: float = 30e-3
    convex: bool = True
    short: bool = False
    complete: bool = False


@dataclass(frozen=True)
class Profile:
    """The sampled points of a path and where the pairs of a mesh are on it.

    points s (m,) [mm] in order, the middle of the path among them; place (p, n): number of the
    point of each contact, -1 without one.
    ValueError for contact ratios of 2 and more, of which a relief may end beyond a third pair.
    """

    mesh: Mesh
    shape: Shape

    def __post_init__(self) -> None:
        if self.mesh.cycle.positions.shape[1] > 2:
            raise ValueError("free shapes of relief are searched for contact ratios below 2")

    @cached_property
    def points(self) -> Array:
        """Positions s (m,) [mm]."""
        met = self.mesh.cycle.along(self.mesh.cycle.positions)
        met = np.sort(np.append(met, self._centre))
        return np.asarray(met[np.diff(met, prepend=-np.inf) > POSITION_TIE])

    @cached_property
    def place(self) -> Any:
        """Numbers of points (p, n), -1 of pairs that are not in contact."""
        there = self.mesh.cycle.present
        found = np.searchsorted(
            self.points, np.where(there, self.mesh.cycle.positions, 0.0) - POSITION_TIE
        )
        return np.where(there, found, -1)

    @cached_property
    def middle(self) -> int:
        """Number of the middle of the path among the points."""
        return int(np.abs(self.points - self._centre).argmin())

    @property
    def _centre(self) -> float:
        path = self.mesh.cycle.path
        return float(0.5 * (path.start + path.end))

    @cached_property
    def rows(self) -> Array:
        """Rows (r, m) of which every product with what is removed is at most 0: the shape."""
        size, middle = len(self.points), self.middle
        steps = np.diff(np.eye(size), axis=0)  # rises from point to point
        steps[middle:] *= -1.0
        found = [steps]
        if self.shape.convex:
            slopes = np.diff(np.eye(size), axis=0) / np.diff(self.points)[:, None]
            bends = -np.diff(slopes, axis=0) * np.diff(self.points).max()
            at = np.arange(1, size - 1)
            found.append(bends[at != middle])
        return np.vstack(found)

    @cached_property
    def upper(self) -> Array:
        """Greatest amounts (m,) [mm]."""
        path, most = self.mesh.cycle.path, self.shape.most
        single = (self.points >= path.lowest_single - POSITION_TIE) & (
            self.points <= path.highest_single + POSITION_TIE
        )
        return np.where(single & self.shape.short, 0.0, most)

    def separations(self, removed: Any) -> Array:
        """Return separations (..., p, n) [mm] of what is removed (..., m) [mm] at the points."""
        return np.where(self.place >= 0, np.asarray(removed)[..., self.place], np.inf)


def free_problem(mesh: Mesh, shape: Shape | None = None) -> Problem:
    """Pose the least peak-to-peak of all loads; variable `removed` (m,) [mm], method `exact`."""
    profile = Profile(mesh, shape or Shape())
    kept = profile.rows / UNIT

    def evaluate(x: Any, p: Any) -> Terms:
        removed = np.stack([np.asarray(v, float) for v in x.removed], axis=-1)
        apart = profile.separations(removed)
        found = mesh.sharing(apart)
        defines: dict[str, Any] = {"shape": tuple(np.moveaxis(1.0 + removed @ kept.T, -1, 0))}
        if profile.shape.complete:
            gaps = np.where(np.isinf(found.gaps), 0.0, found.gaps)
            defines["open"] = 1.0 + gaps.max(axis=(-3, -2, -1)) / UNIT
        return Terms({"peak_to_peak": mesh.criteria(apart).peak_to_peak.max(axis=-1)}, {}, defines)

    upper = tuple(map(float, profile.upper))
    columns = (Var("removed", "mm", 0.0, upper, 0.0, len(upper)),)
    methods = {"exact": search(profile)}
    return Problem("free relief", columns, (), evaluate, methods=methods, vectorised=True)
