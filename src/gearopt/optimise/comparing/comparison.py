"""A comparison of methods as a fact: runs, their statistics and curves; to JSON and back.

A gap is (objective - reference)/|reference|; where the reference is zero, as far as that can be
known, it is relative to the objective's own scale (see `scale`). The reference is the best bound
that we proved in any run, or, where none is proven, the best feasible objective. A point that is
not feasible by our own check has no objective and no gap, and counts as worse than any that is.
"""

import math
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from datetime import date
from pathlib import Path
from typing import Any

from gearopt.errors import CertificateError
from gearopt.frozen import dataclass
from gearopt.optimise.result import as_dict, as_json, loads, shown, versions
from gearopt.optimise.scale import unit
from gearopt.optimise.typed import typed

FORMAT = 1
# gaps that count as success: a catalogue's accuracy, a proof's
CATALOGUE_GAP, PROOF_GAP = 1e-3, 1e-6
BELOW = 1e-6  # a value below a proven bound by more contradicts it; rows may be off by 1e-8
POINTS = 160  # of a curve, beyond which it is thinned to steps even in the logarithm


@dataclass(frozen=True)
class Run:
    """One run of a method: its effort, and the findings of our own check.

    objective and gap: None without a feasible point. violation: of the point it returned, None
    where it returned none. seconds: of the method alone. steps: (seconds, evaluations, best so far)
    as the method reported, no better than the objective it ended with; clipped: it reported better.
    scale: the objective's own at the point, see `scale`. distance: of a front, the mean one
    from the reference front to it (IGD+), in the ranges of the objectives.
    """

    seed: int
    status: str
    objective: float | None
    bound: float | None
    violation: float | None
    evaluations: int
    seconds: float
    message: str = ""
    gap: float | None = None
    steps: tuple[tuple[float, int, float], ...] = ()
    clipped: bool = False
    scale: float = 0.0
    distance: float | None = None


@dataclass(frozen=True)
class Summary:
    """Statistics of the runs of a row; a run without a feasible point is worse than any other.

    median_gap, worst_gap: None where that run has no feasible point. close, tight: share of seeds
    whose gap is at most CATALOGUE_GAP, PROOF_GAP. without: number of seeds without a feasible
    point. violation: the worst. evaluations, seconds, objective, distance: medians.
    """

    seeds: int
    without: int
    objective: float | None
    median_gap: float | None
    worst_gap: float | None
    close: float
    tight: float
    violation: float | None
    evaluations: float
    seconds: float
    distance: float | None = None


@dataclass(frozen=True)
class Curve:
    """Gap so far against effort: median and quartiles over seeds, None: not feasible."""

    spent: tuple[float, ...]
    low: tuple[float | None, ...]
    median: tuple[float | None, ...]
    high: tuple[float | None, ...]


@dataclass(frozen=True)
class Sample:
    """The runs of a method at one budget."""

    runs: tuple[Run, ...]
    summary: Summary
    curve: Curve


@dataclass(frozen=True)
class Row:
    """A method in a group; refused: why it cannot take the problem, "" where it can.

    counts: what it counts as an evaluation. equal_evaluations, equal_time: None before any run.
    """

    method: str
    random: bool = True
    counts: str = ""
    start_up_seconds: float | None = None
    refused: str = ""
    equal_evaluations: Sample | None = None
    equal_time: Sample | None = None


@dataclass(frozen=True)
class Group:
    """The methods that solve one model; proven: the reference is a bound, else the best found.

    scale: the objective's own at the best point. front: of fronts, what their reference is, in
    words.
    """

    model: str
    words: str
    objective: str
    unit: str
    reference: float | None
    proven: bool
    bound_from: str
    best: float | None
    rows: tuple[Row, ...]
    scale: float = 0.0
    front: str = ""


@dataclass(frozen=True)
class Comparison:
    """All groups with the data that they rest on.

    budget: {evaluations, seconds, patience_seconds}; settings: {method: {name: value}}. bound_from:
    the method that was asked for a bound. objectives: of fronts, else (); most: largest values of
    them by name. complete: every run was made; else message says how many. changes: what is
    otherwise than in the file, by key. head: its table [report].
    """

    groups: tuple[Group, ...]
    seeds: tuple[int, ...]
    budget: Mapping[str, float]
    settings: Mapping[str, Any]
    bound_from: str | None = None
    objectives: tuple[str, ...] = ()
    most: Mapping[str, float] = field(default_factory=dict)
    complete: bool = True
    message: str = ""
    title: str = ""
    scene: str | None = None
    file: str | None = None
    file_sha256: str | None = None
    changes: Mapping[str, Any] = field(default_factory=dict)
    head: Mapping[str, Any] = field(default_factory=dict)
    date: str = field(default_factory=lambda: date.today().isoformat())
    machine: Mapping[str, Any] = field(default_factory=lambda: machine())
    versions: Mapping[str, str] = field(default_factory=lambda: versions("numpy", "casadi"))
    comparison: int = FORMAT
    gearopt: str = field(default_factory=lambda: versions("gearopt")["gearopt"])

    def __repr__(self) -> str:
        return str(shown("compared_lines", self))

    def _repr_html_(self) -> str:
        return str(shown("compared_fragment", self))

    def to_html(self) -> str:
        """Return its page, one self-contained HTML text."""
        return str(shown("compared_page", self))

    def to_pdf(self, path: str | Path) -> None:
        """Write its page as PDF, by an installed browser."""
        shown("write_pdf", self.to_html(), path, {"report": self.head}, "metric")

    to_dict, to_json = as_dict, as_json

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Comparison":
        """Inverse of `to_dict`; ValueError for a dict that is none, or of another format."""
        if not isinstance(data, Mapping) or "comparison" not in data:
            raise ValueError("is not a comparison: it has no key `comparison`")
        if data["comparison"] != FORMAT:
            raise ValueError(f"comparison format {data['comparison']!r}: this reads {FORMAT}")
        comparison: Comparison = typed(cls, data)
        _check(comparison)
        return comparison

    @classmethod
    def from_json(cls, text: str) -> "Comparison":
        """Return the inverse of `to_json`."""
        return cls.from_dict(loads(text))


def _check(found: Comparison) -> None:
    """Raise ValueError where the parts of a comparison do not go together."""
    needed = {"evaluations", "seconds", "patience_seconds"}
    if missing := sorted(needed - set(found.budget)):
        raise ValueError(f"lacks in budget: {', '.join(missing)}")
    for row in (row for group in found.groups for row in group.rows):
        if not row.refused and not isinstance(found.settings.get(row.method), Mapping):
            raise ValueError(f"has no settings of the method {row.method!r}")
        for sample in filter(None, (row.equal_evaluations, row.equal_time)):
            curve, runs, seeds = sample.curve, len(sample.runs), sample.summary.seeds
            if len({len(values) for values in vars(curve).values()}) > 1:
                raise ValueError(f"has a curve of {row.method!r} whose lists differ in length")
            if not runs == seeds > 0:
                raise ValueError(f"has {runs} runs of {row.method!r} and a summary of {seeds}")


def machine() -> dict[str, Any]:
    """Return where it was measured."""
    return {"cpus": os.cpu_count(), "platform": platform.platform()}


def excess(value: float, reference: float, scale: float = 0.0) -> float:
    """Return the gap of a value above a reference, at least 0; absolute without a scale.

    CertificateError where it lies below by more than rounding: then the bound is wrong.
    """
    gap = (value - reference) / (unit(reference, scale) or 1.0)
    if gap < -BELOW:
        raise CertificateError(f"a feasible value {value!r} lies below the bound {reference!r}")
    return max(gap, 0.0)


def sample(
    runs: Sequence[Run], reference: float | None, scale: float, by_time: bool
) -> Sample | None:
    """Return the runs of a method with their gaps, statistics and curve; None without a run."""
    if not runs:
        return None
    judged = tuple(_judged(run, reference, scale) for run in runs)
    return Sample(judged, _summary(judged), _curve(judged, reference, scale, by_time))


def _judged(run: Run, reference: float | None, scale: float) -> Run:
    if run.objective is None or reference is None:
        return run
    return replace(run, gap=excess(run.objective, reference, scale))


def quantile(values: Sequence[float], share: float) -> float | None:
    """The value that `share` of the values lie below, the mean of two between which it is.

    None: inf.
    """
    place, sizes = share * len(values), sorted(values)
    k = min(int(place), len(values) - 1)
    value = 0.5 * (sizes[k - 1] + sizes[k]) if 0 < place == k else sizes[k]
    return value if math.isfinite(value) else None


def _summary(runs: Sequence[Run]) -> Summary:
    gaps = [math.inf if r.gap is None else r.gap for r in runs]
    values = [math.inf if r.objective is None else r.objective for r in runs]
    violations = [r.violation for r in runs if r.violation is not None]
    return Summary(
        seeds=len(runs),
        without=sum(r.objective is None for r in runs),
        objective=quantile(values, 0.5),
        median_gap=quantile(gaps, 0.5),
        worst_gap=quantile(gaps, 1.0),
        close=sum(g <= CATALOGUE_GAP for g in gaps) / len(runs),
        tight=sum(g <= PROOF_GAP for g in gaps) / len(runs),
        violation=max(violations, default=None),
        evaluations=quantile([r.evaluations for r in runs], 0.5) or 0,
        seconds=quantile([r.seconds for r in runs], 0.5) or 0.0,
        distance=quantile([math.inf if r.distance is None else r.distance for r in runs], 0.5),
    )


def _curve(runs: Sequence[Run], reference: float | None, scale: float, by_time: bool) -> Curve:
    """Return quantiles of the gap so far wherever a run improved; a finished run keeps its own."""
    if reference is None:
        return Curve((), (), (), ())
    traces = [[(s[0] if by_time else float(s[1]), s[2]) for s in run.steps] for run in runs]
    ends = [run.seconds if by_time else float(run.evaluations) for run in runs]
    spent = sorted({at for trace in traces for at, _ in trace} | {max(ends)})
    if len(spent) > POINTS:
        first, last = max(spent[0], 1e-9), spent[-1]
        spent = [first * (last / first) ** (k / (POINTS - 1)) for k in range(POINTS)]
    columns = [[_so_far(trace, at, reference, scale) for trace in traces] for at in spent]
    quarters = [tuple(quantile(c, q) for c in columns) for q in (0.25, 0.5, 0.75)]
    return Curve(tuple(spent), *quarters)


def _so_far(
    trace: Sequence[tuple[float, float]], at: float, reference: float, scale: float
) -> float:
    reached = [value for spent, value in trace if spent <= at * (1.0 + 1e-12)]
    return excess(reached[-1], reference, scale) if reached else math.inf
