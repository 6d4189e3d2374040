"""A Pareto front as a fact: its designs, their proof, how it grew; to JSON and back."""

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.pareto.measures import Pick
from gearopt.optimise.pareto.objectives import Objective
from gearopt.optimise.result import as_dict, as_json, loads, shown, versions
from gearopt.optimise.typed import typed

FORMAT = 1
STATUSES = ("complete", "proven", "not proven", "infeasible", "limit")


@dataclass(frozen=True)
class FrontPoint:
    """One design of a front: its values in the order of the objectives.

    proven: nothing beats it by more than 1e-6 of its first objective. bound: least value of the
    first objective among designs whose others are no larger. slopes: change of the first objective
    by a unit more of each other one, None where it is infinite. design, limits: as of a `Result`.
    """

    values: tuple[float, ...]
    proven: bool = False
    bound: float | None = None
    slopes: tuple[float | None, ...] | None = None
    design: Mapping[str, Any] = field(default_factory=dict)
    limits: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Impossible:
    """Limits on objectives under which no design was found; proven: there is none."""

    limits: Mapping[str, float]
    proven: bool


@dataclass(frozen=True)
class Growth:
    """The hypervolume of the points found after so many seconds and evaluations, of the whole."""

    seconds: float
    evaluations: int
    hypervolume: float


@dataclass(frozen=True)
class Front:
    """The Pareto-optimal designs, by the first objective.

    status: complete (proven: there is no other), proven (every point is; the front between them is
    known to `epsilon`), not proven, infeasible (proven: no design at all), limit (stopped early).
    epsilon: additive epsilon indicator, proven: of every design, one of the points is at most this
    part of the ranges of the objectives worse in each of them. error, of a convex problem: largest
    distance of the true front to the line through its points, in the same ranges. unknown: values
    of the second objective between which the front is not known, None: no end. beaten: values
    of dominated feasible designs. corner: the point from which the hypervolume is measured. picks:
    the designs that rules take.
    """

    name: str
    status: str
    method: str
    objectives: tuple[Objective, ...]
    points: tuple[FrontPoint, ...] = ()
    error: float | None = None
    epsilon: float | None = None
    picks: tuple[Pick, ...] = ()
    beaten: tuple[tuple[float, ...], ...] = ()
    impossible: tuple[Impossible, ...] = ()
    unknown: tuple[tuple[float | None, float | None], ...] = ()
    corner: tuple[float, ...] = ()
    hypervolume: float | None = None
    growth: tuple[Growth, ...] = ()
    proof: Mapping[str, Any] = field(default_factory=dict)
    report: Mapping[str, Any] = field(default_factory=dict)
    message: str = ""
    evaluations: int = 0
    seconds: float = 0.0
    seed: int = 0
    title: str = ""
    scene: str | None = None
    file: str | None = None
    file_sha256: str | None = None
    asked: Mapping[str, Any] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=lambda: versions("numpy", "casadi"))
    front: int = FORMAT
    gearopt: str = field(default_factory=lambda: versions("gearopt")["gearopt"])

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names of the objectives."""
        return tuple(one.name for one in self.objectives)

    @property
    def whole(self) -> bool:
        """Return whether no part is missing: complete, or proven to its epsilon."""
        known = self.error is not None or self.epsilon is not None
        return self.status == "complete" or (known and all(p.proven for p in self.points))

    def __repr__(self) -> str:
        return str(shown("front_lines", self))

    def _repr_html_(self) -> str:
        return str(shown("front_fragment", self))

    def to_html(self, units: str = "metric") -> str:
        """Return its page, one self-contained HTML text; units: "metric" or "inch"."""
        return str(shown("front_page", self, units))

    def to_pdf(self, path: str | Path, units: str = "metric") -> None:
        """Write its page as PDF, by an installed browser; units: "metric" or "inch"."""
        shown("write_pdf", self.to_html(units), path, self.asked, units)

    to_dict, to_json = as_dict, as_json

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Front":
        """Inverse of `to_dict`; ValueError for a dict that is none, or of another format."""
        if not isinstance(data, Mapping) or "front" not in data:
            raise ValueError("is not a Pareto front: it has no key `front`")
        if data["front"] != FORMAT:
            raise ValueError(f"front format {data['front']!r}: this gearopt reads {FORMAT}")
        front: Front = typed(cls, data)
        if front.status not in STATUSES:
            raise ValueError(f"has the status {front.status[:40]!r}, which no front has")
        count = len(front.objectives)
        if any(len(p.values) != count for p in front.points):
            raise ValueError(f"has a point with other than {count} values")
        return front

    @classmethod
    def from_json(cls, text: str) -> "Front":
        """Return the inverse of `to_json`."""
        return cls.from_dict(loads(text))
