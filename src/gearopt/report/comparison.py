"""A comparison in words and cells, the same on the terminal and on a page."""

import shlex
from collections.abc import Mapping
from typing import Any

from gearopt.optimise.comparing.comparison import (
    CATALOGUE_GAP,
    PROOF_GAP,
    Comparison,
    Group,
    Row,
    Sample,
    excess,
)
from gearopt.optimise.scale import is_known
from gearopt.report.measures import read_in
from gearopt.report.words import amount, goal_words

GAP_ROUNDING = 1e-12  # a gap below it is rounding
COLUMNS = (  # of a table: heading, unit, what it says
    ("median gap", "%", "Median over the seeds of the gap to the reference"),
    ("worst gap", "%", "Gap of the worst seed"),
    ("within 0.1\u00a0%", "seeds", "Seeds whose feasible point is within 0.1 % of the reference"),
    ("within 1e-6", "seeds", "Seeds whose feasible point is within a millionth of it"),
    ("no point", "seeds", "Seeds without a feasible point"),
    ("violation", "relative", "Largest violation of any limit by our own check, of all seeds"),
    ("spent", "evals", "Median of evaluations; what counts as one differs by method"),
    ("time", "s", "Median wall time, start-up left out"),
)
DISTANCE = (
    "IGD+",
    "%",
    "Mean distance of the reference front to the points, in the ranges of the objectives",
)
assert (CATALOGUE_GAP, PROOF_GAP) == (1e-3, 1e-6)  # as the headings say


def columns(comparison: Comparison) -> tuple[tuple[str, str, str], ...]:
    """The columns of its tables: heading, unit, what it says."""
    return (*COLUMNS, DISTANCE) if comparison.objectives else COLUMNS


def cells(comparison: Comparison, sample: Sample) -> tuple[str, ...]:
    """The row of a method, in the order of `columns`."""
    s = sample.summary
    row = (
        percent(s.median_gap),
        percent(s.worst_gap),
        f"{round(s.close * s.seeds)}/{s.seeds}",
        f"{round(s.tight * s.seeds)}/{s.seeds}",
        f"{s.without}/{s.seeds}" if s.without else "0",
        "–" if s.violation is None else "0" if s.violation == 0 else f"{s.violation:.0e}",
        f"{s.evaluations:,.0f}",
        f"{s.seconds:.3g}",
    )
    return (*row, percent(s.distance)) if comparison.objectives else row


def counted(count: int, what: str) -> str:
    """A number of things in words: "1 seed", "25 seeds"."""
    return f"{count} {what}{'s' * (count != 1)}"


def percent(gap: float | None) -> str:
    """A gap in percent; "none" where there is no feasible point."""
    if gap is None:
        return "none"
    if gap <= GAP_ROUNDING:
        return "0"
    value = 100.0 * gap
    return f"{value:,.0f}" if value >= 100 else f"{value:.2g}" if value < 10 else f"{value:.3g}"


def kinds(comparison: Comparison) -> tuple[tuple[str, str, str], ...]:
    """Field of a row, heading and budget of both comparisons."""
    budget = comparison.budget
    return (
        ("equal_evaluations", "Equal evaluations", f"{budget['evaluations']:,} per run"),
        ("equal_time", "Equal time", f"{budget['seconds']:g} s per run"),
    )


def heading(comparison: Comparison, group: Group) -> str:
    """What the methods of a group are compared on."""
    names = [goal_words(name, comparison.scene) for name in comparison.objectives]
    return f"Front of {', '.join(names)}" if names else group.words or group.model


def reference(group: Group, scene: str | None = None) -> str:
    """Reference from which the gaps of a group of a kind of file are measured."""
    name = goal_words(group.objective, scene)
    proving = [row.method for row in group.rows if _impossible(row)]
    if proving:
        return f"No design meets all limits, proven ({', '.join(proving)}): there are no gaps."
    if group.front:
        return group.front
    if group.reference is None:
        return "No method found a feasible point, and nothing is proven: there are no gaps."
    zero = not is_known(group.reference, group.scale)
    value = amount(0.0 if zero else group.reference, unit_of(group))
    if not group.proven:
        return (
            f"Nothing is proven here: gaps are measured from the best {name} found, {value}, which "
            "may itself not be the optimum."
        )
    words = f"Gaps are measured from the proven lower bound of the {name}, {value}"
    words += f" (by {group.bound_from}"
    if zero:
        words += f"; relative to {_own(group)}"
    if group.best is None:
        return f"{words}). No method found a feasible point."
    if _closed(group):
        return f"{words}), which a feasible point attains: it is the optimum."
    if zero:
        above = amount(group.best - group.reference, unit_of(group))
        return f"{words}). The best found is {above} above it; the optimum lies between."
    apart = 100.0 * excess(group.best, group.reference, group.scale)
    return f"{words}). The best found is {apart:.2g} % above it; the optimum lies between."


def unit_of(group: Group) -> str:
    """The suffix under which the objective of a model is shown."""
    return read_in(group.objective, group.unit)


def _own(group: Group) -> str:
    """Scale of gaps to a reference of zero."""
    if not group.scale:
        return "1, because the bound is zero"
    scale = amount(group.scale, unit_of(group))
    return f"the objective's own scale, {scale}, because the bound is zero"


def _closed(group: Group) -> bool:
    """Whether the reference is the proven optimum."""
    if not group.proven or group.best is None or group.reference is None:
        return False
    return excess(group.best, group.reference, group.scale) <= PROOF_GAP


def _impossible(row: Row) -> bool:
    """Whether a method proved that there is no feasible point."""
    samples = (row.equal_evaluations, row.equal_time)
    return any(run.status == "infeasible" for s in samples if s is not None for run in s.runs)


def verdict(group: Group, row: Row) -> str:
    """Achievement of a method in equal time, in one sentence without its name."""
    if row.refused:
        return f"cannot take this problem: {row.refused}"
    sample = row.equal_time
    if sample is None:
        return "not run"
    s = sample.summary
    if _impossible(row):
        return "proves that no design meets the limits"
    ended = any(run.status == "limit" for run in sample.runs)
    why = _why(sample)
    if s.without == s.seeds and not row.random:
        return f"no feasible point{' before the time ended its one run' if ended else ''}{why}"
    if s.without == s.seeds:
        return f"no feasible point in any of {counted(s.seeds, 'seed')}{why}"
    than = "proven optimum" if _closed(group) else "bound" if group.proven else "best design found"
    reaches, apart = f"reaches the {than}", f"% above the {than}"
    if group.front:
        reaches, apart = "has the whole front", "% of the hypervolume is missing"
    if not row.random:
        once = "where the time ended its one run" if ended else "in the one run it needs"
        if s.median_gap is not None and s.median_gap <= PROOF_GAP:
            return f"{reaches} in {s.seconds:.2g} s, {once}"
        return f"{percent(s.median_gap)} {apart}, {once}"
    missed = f", {s.without} without a feasible point{why}" if s.without else ""
    close = f"{round(s.close * s.seeds)} of {counted(s.seeds, 'seed')} within 0.1 %{missed}"
    if s.median_gap is None:
        return f"no feasible point in the median seed; {close}"
    if s.median_gap <= PROOF_GAP:
        return f"{reaches} in the median seed, {s.seconds:.2g} s; {close}"
    return f"median {percent(s.median_gap)} {apart}, {close}"


def _why(sample: Sample) -> str:
    """Message of the first run without a feasible point, in brackets; "" for none."""
    messages = (r.message for r in sample.runs if r.objective is None and r.message)
    message = next(messages, "").partition(". ")[0].rstrip(".")
    return f" ({message})" if message else ""


def ended(comparison: Comparison, row: Row) -> str:
    """Say how many runs by evaluations the clock ended, "" for none."""
    sample = row.equal_evaluations
    planned, patience = comparison.budget["evaluations"], comparison.budget["patience_seconds"]
    runs = sample.runs if sample else ()
    late = [run for run in runs if run.seconds >= patience and run.evaluations < planned]
    if not late:
        return ""
    return f"{counted(len(late), 'run')} of {row.method} ended by the clock, after {patience:g} s"


def settings(values: Mapping[str, Any]) -> str:
    """The settings of a method on one line."""
    return ", ".join(f"{name} {_setting(value)}" for name, value in values.items())


def _setting(value: Any) -> str:
    if isinstance(value, list | tuple):
        return " … ".join(_setting(v) for v in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def command(comparison: Comparison, html: str = "") -> str:
    """The command that repeats the comparison; html: where it writes the page."""
    methods = [row.method for group in comparison.groups for row in group.rows]
    budget = comparison.budget
    if comparison.file is None or comparison.changes:
        fronts = f"objectives={list(comparison.objectives)}, " if comparison.objectives else ""
        fronts += f"most={dict(comparison.most)}, " if comparison.most else ""
        what = f"{comparison.file!r}, {comparison.changes!r}" if comparison.file else "problem"
        return (
            f"gearopt.compare({what}, {fronts}methods={methods}, seeds={len(comparison.seeds)}, "
            f"evaluations={budget['evaluations']}, seconds={budget['seconds']:g})"
        )
    more = f" --bound-from {comparison.bound_from}" if comparison.bound_from else ""
    more += f" --objectives {','.join(comparison.objectives)}" if comparison.objectives else ""
    more += "".join(f" --most {name}={value:g}" for name, value in comparison.most.items())
    return (
        f"gearopt compare {shlex.quote(comparison.file)} --methods {','.join(methods)} "
        f"--seeds {len(comparison.seeds)} --evaluations {budget['evaluations']} "
        f"--seconds {budget['seconds']:g}{more}{f' --html {shlex.quote(html)}' if html else ''}"
    )


FAIRNESS = (
    "All methods of a table solve the same model from the same file, with settings fixed "
    "beforehand and none tuned to the problem.",
    "Equal evaluations: a run ends at the given number of evaluations, as its method counts them, "
    "to within one generation, sweep or partial design. Equal time: a run ends at the given wall "
    "time of the method alone; checking its answer is not counted. A method that is done earlier "
    "ends earlier; a run by evaluations is stopped by the clock at ten times the time budget.",
    "Start-up (imports, tracing, building the model) is the time of a first short call less that "
    "of the same call again; no other number includes it. A library that methods share is charged "
    "to the first of them; CasADi, which our own check needs, to none.",
    "Random methods run once for each of the same seeds; a deterministic one runs once. Methods "
    "take turns, so that a slower minute of the machine affects all alike.",
    "A point counts only if it passes our own check of every limit (within 1e-8). A seed without "
    "one has no gap and ranks behind every other in the median and the worst.",
    "Annealing and NSGA-II plan their run over the evaluations they are given; for equal time they "
    "are given as many as their own speed, measured before, allows.",
)
