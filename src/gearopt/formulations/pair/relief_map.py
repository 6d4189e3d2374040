"""The relief of a spur pair for its report: both flanks, the contact at every load, and rules."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.pair.contact import PairMesh, at_loads, column
from gearopt.formulations.pair.design import (
    FlankRelief,
    MadeRelief,
    PairRelief,
    ReliefRow,
)
from gearopt.formulations.pair.relief.free_form import Profile
from gearopt.formulations.pair.relief.meshing import NO_RELIEF, Mesh, Relief
from gearopt.formulations.pair.relief.parametric import objective
from gearopt.formulations.pair.relief.relief_tolerance import Tolerance, drawn, worst
from gearopt.formulations.pair.relief.rules import short_relief, tip_amounts
from gearopt.frozen import dataclass
from gearopt.optimise.result import Budget, Watch
from gearopt.optimise.terms import Array
from gearopt.physics.geometry.contact import diameters_at
from gearopt.physics.mesh_cycle import cycle

LEAST_RELIEF = 1e-6  # mm: less than that is no relief
LOADS_COMPARED = 100  # loads at which relief is held against none
FINER = 10  # times as many positions, on which a relief is judged again
DRAWN, MOST = 2000, 0.95  # reliefs as they are made, and the part of them told beside the median


@dataclass(frozen=True)
class Removed:
    """Depth removed from both flanks [mm] at the contacts (p, n) of a mesh; 0 where there is none.

    lengths [mm] on the line of action; exponent of both, None of a shape of its own, whose points
    (3, m) are positions and what is removed there from pinion and wheel [mm].
    """

    pinion: Array
    wheel: Array
    lengths: tuple[float, float]
    exponent: float | None
    points: Array | None = None

    @classmethod
    def of(cls, mesh: Mesh, reliefs: tuple[Relief, Relief]) -> "Removed":
        """Depth that reliefs by amount, length and exponent remove."""
        rows = zip(reliefs, mesh.from_tips, strict=True)
        pinion, wheel = (relief.removed(x) for relief, x in rows)
        first, second = reliefs
        lengths = float(first.length), float(second.length)
        return cls(pinion, wheel, lengths, float(first.exponent))

    @classmethod
    def of_profile(cls, profile: Profile, removed: Array) -> "Removed":
        """Return a free shape, of amounts (m,) [mm] at the points of a profile.

        Beyond the middle of the path it is the pinion's, before it the wheel's.
        """
        s, middle = profile.points, profile.middle
        beyond = np.arange(len(s)) >= middle
        points = np.stack([s, np.where(beyond, removed, 0.0), np.where(beyond, 0.0, removed)])
        rising = np.flatnonzero(removed > LEAST_RELIEF)
        later, sooner = rising[rising > middle], rising[rising < middle]
        lengths = (
            float(s[-1] - s[later[0] - 1]) if len(later) else 0.0,
            float(s[sooner[-1] + 1] - s[0]) if len(sooner) else 0.0,
        )
        there = profile.place >= 0
        pinion, wheel = (np.where(there, flank[profile.place], 0.0) for flank in points[1:])
        return cls(pinion, wheel, lengths, None, points)

    def on(self, mesh: Mesh, other: Mesh) -> "Removed":
        """Return the depths at the contacts of another mesh of the gears, free shapes by lines."""
        if self.points is None:
            assert self.exponent is not None
            ends = zip(self.amounts(mesh), self.lengths, strict=True)
            first, second = (Relief(*end, self.exponent) for end in ends)
            return Removed.of(other, (first, second))
        there, (s, *flanks) = other.cycle.present, self.points
        at = np.where(there, other.cycle.positions, 0.0)
        pinion, wheel = (np.where(there, np.interp(at, s, flank), 0.0) for flank in flanks)
        return replace(self, pinion=pinion, wheel=wheel)

    def separations(self, mesh: Mesh) -> Array:
        """Return the separations of flanks by relief at each contact [mm], infinite without one."""
        return np.where(mesh.cycle.present, self.pinion + self.wheel, np.inf)

    def amounts(self, mesh: Mesh) -> tuple[float, float]:
        """Depth removed at the tips [mm] of pinion and wheel."""
        along = mesh.cycle.along
        return float(along(self.pinion)[-1]), float(along(self.wheel)[0])


def described(
    made: PairMesh, removed: Removed, minimise: str, loads: Sequence[float]
) -> PairRelief:
    """Return the relief of a pair, and rules beside it; loads: it was made for."""
    mesh = made.mesh
    beside = {name: Removed.of(mesh, both) for name, both in rules(made).items()}
    return PairRelief(
        minimise=minimise,
        loads=tuple(loads),
        pinion=_flank(made, 0, removed),
        wheel=_flank(made, 1, removed),
        pinion_removed_mm=column(mesh.cycle.along(removed.pinion)),
        wheel_removed_mm=column(mesh.cycle.along(removed.wheel)),
        at=at_loads(made, removed.separations(mesh)),
        rows=tuple(
            _row(made, name, one, minimise, loads)
            for name, one in (beside | {"this": removed}).items()
        ),
        break_even=break_even(made, removed, loads),
        finer_mm=column(finer(made, removed, loads)),
    )


def finer(made: PairMesh, removed: Removed, loads: Sequence[float]) -> Array:
    """Return the peak-to-peak (l,) [mm] at loads on ten times as many positions of the gears.

    Those where reliefs begin and where they part a pair of teeth are among them: kinks of the
    transmission error, which a relief that was chosen on some positions has between them.
    """
    mesh = made.of_loads(loads)
    path, (pinion, wheel) = mesh.cycle.path, removed.lengths
    kinks = np.array([path.end - pinion, path.start + wheel])
    for _ in range(2):
        places = cycle(path, FINER * len(mesh.cycle.travels), also=kinks)
        fine = Mesh.of(places, made.compliance, mesh.coupling, mesh.loads)
        apart = removed.on(mesh, fine).separations(fine)
        kinks = np.append(kinks, _partings(fine, apart))
    there = fine.criteria(apart).peak_to_peak
    return np.maximum(there, mesh.criteria(removed.separations(mesh)).peak_to_peak)


def _partings(mesh: Mesh, apart: Array) -> Array:
    """Return positions (k,) [mm] at which a pair on the path comes into contact or leaves it.

    There its separation is the depth of the others alone, which has no kink, as its gap has.
    """
    positions, loads = [np.zeros(0)], np.array(mesh.loads)[:, None]
    for pair, s in enumerate(mesh.cycle.positions.T):
        others = apart.copy()
        others[:, pair] = np.inf
        depth = mesh.sharing(others).approach - mesh.coupling * loads
        there = np.isfinite(depth) & np.isfinite(apart[:, pair])
        lacks = np.full(depth.shape, np.nan)
        np.subtract(apart[:, pair], depth, out=lacks, where=there)
        before, after = lacks[:, :-1], lacks[:, 1:]
        crossed = before * after < 0.0
        part = before[crossed] / (before[crossed] - after[crossed])
        ends = (np.broadcast_to(end, crossed.shape)[crossed] for end in (s[:-1], s[1:]))
        positions.append((1.0 - part) * next(ends) + part * next(ends))
    return np.concatenate(positions)


def break_even(made: PairMesh, removed: Removed, loads: Sequence[float]) -> float | None:
    """Return the load, relative to the duty's, below which no relief has less peak-to-peak.

    The largest below the least of the loads it is made for; None where it is better at all of them
    down to a hundredth, or worse at the least one already.
    """
    least = min(loads)
    low, high = 0.01 * least, least
    for _ in range(2):  # the second time between the two loads that the first one found
        tried = np.linspace(low, high, LOADS_COMPARED)
        mesh = made.of_loads([float(load) for load in tried])
        plain = mesh.criteria(mesh.separations(NO_RELIEF, NO_RELIEF)).peak_to_peak
        lost = mesh.criteria(removed.separations(mesh)).peak_to_peak - plain
        worse = np.flatnonzero(lost[:-1] > 0.0)
        if not least or lost[-1] >= 0.0 or not len(worse):
            return None
        low, high = tried[worse[-1]], tried[worse[-1] + 1]
    before, after = lost[worse[-1] : worse[-1] + 2]
    return float(low + before / (before - after) * (high - low))


def rules(made: PairMesh) -> dict[str, tuple[Relief, Relief]]:
    """Return reliefs by name: none, those of the paper's rule and of the corrected one.

    They are made for the load of the duty.
    """
    path, coupling = made.mesh.cycle.path, made.mesh.coupling
    printed = tip_amounts(path, made.compliance, 0.0, made.force)
    right = tip_amounts(path, made.compliance, coupling, made.force)
    return {
        "none": (NO_RELIEF, NO_RELIEF),
        "paper's rule": short_relief(path, printed),
        "corrected": short_relief(path, right),
        "corrected, linear": short_relief(path, right, 1.0),
    }


def _flank(made: PairMesh, k: int, removed: Removed) -> FlankRelief:
    """Return the relief of the pinion (k = 0) or the wheel in the words of a drawing."""
    path, member = made.mesh.cycle.path, made.elastic.members[k]
    length = removed.lengths[k]
    start = path.end - length if k == 0 else path.start + length
    tip = path.end if k == 0 else path.start

    def place(s: Any) -> tuple[float, float]:
        rolled = path.radii_of_curvature(s)[k] / member.base_radius
        return float(diameters_at(made.elastic.pair, path, s)[k]), float(np.degrees(rolled))

    (begin, roll), (end, tip_roll) = place(start), place(tip)
    return FlankRelief(
        amount_mm=removed.amounts(made.mesh)[k],
        length_mm=length,
        exponent=removed.exponent,
        start_diameter_mm=begin,
        start_roll_angle_deg=roll,
        tip_diameter_mm=end,
        tip_roll_angle_deg=tip_roll,
    )


def _row(
    made: PairMesh, name: str, removed: Removed, minimise: str, loads: Sequence[float]
) -> ReliefRow:
    mesh = made.of_loads(loads)
    measures = mesh.criteria(removed.separations(mesh))
    pinion, wheel = removed.amounts(mesh)
    return ReliefRow(
        name=name,
        pinion_amount_mm=pinion,
        wheel_amount_mm=wheel,
        exponent=removed.exponent,
        value=float(objective(measures, minimise)),
        peak_to_peak_mm=column(measures.peak_to_peak),
        load_jump=column(measures.load_jump),
    )


def as_made(
    mesh: Mesh,
    nominal: tuple[Relief, Relief],
    tolerance: Tolerance,
    budget: Budget,
    seed: int,
    watch: Watch | None = None,
) -> MadeRelief | None:
    """Worst case of a relief within tolerances, proven, and the spread of drawn ones.

    None where the watcher ended it before anything was known.
    """
    worst_case = worst(mesh, nominal, tolerance, budget, watch)
    if worst_case is None:
        return None
    values = drawn(mesh, nominal, tolerance, DRAWN, seed)
    point = [float(v) for v in worst_case.point]
    return MadeRelief(
        amount_tolerance_mm=tolerance.amount,
        length_tolerance_mm=tolerance.length,
        worst_mm=worst_case.value,
        bound_mm=worst_case.bound,
        worst_amounts_mm=(point[0], point[1]),
        worst_lengths_mm=(point[2], point[3]),
        drawn=DRAWN,
        median_mm=float(np.median(values)),
        most_mm=float(np.quantile(values, MOST)),
    )
