"""A servo axis as its result holds it, and words that several of its sections share."""

from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.formulations.servo.servo_design import ServoDesign, ServoReport, Teeth
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.report.measures import Measures
from gearopt.report.words import module_words, number

ARCMIN = 60.0  # a degree
OLD = "with the old tolerances"  # of an error, where new ones are chosen


def design_of(result: Result) -> ServoDesign:
    """The design, typed."""
    design: ServoDesign = typed(ServoDesign, result.design, "design")
    return design


def report_of(result: Result) -> ServoReport:
    """Report beside the design, typed."""
    return ServoReport.from_dict(result.report)


def aged(design: ServoDesign) -> str:
    """Which tolerances the errors of a design are of, where it has old and new ones; else ""."""
    return f", {OLD}" if design.tolerances else ""


def degrees(value: float) -> str:
    """An angle [deg] for reading; the same in metric and inch."""
    return f"{number(float(value))}°"


def arc_minutes(value: float) -> str:
    """An angle [deg] in minutes of arc."""
    return f"{number(ARCMIN * value)} arcmin"


def teeth_words(stages: Sequence[Teeth], measures: Measures) -> str:
    """Teeth and modules of a train in a line."""
    return "; ".join(
        f"{s.pinion_teeth}/{s.wheel_teeth}, {module_words(s.normal_module_mm, measures)}"
        for s in stages
    )


def error_limit(design: ServoDesign, limits: Mapping[str, float]) -> float | None:
    """The largest error [deg] allowed: by a worst-case budget, else to the train."""
    used = limits.get("error")
    for budget in () if design.allocation is None else design.allocation.budgets:
        if budget.rule == "worst_case":
            return budget.limit_deg
    error = None if design.train is None else design.train.error_deg
    return error / used if used and error is not None else None


def limit_line(name: str, limit: float, along: str, width: float) -> dict[str, Any]:
    """The limit of an error [deg] as a line across a plot, along its axis x or y."""
    across = {"x": "y", "y": "x"}[along]
    return {
        "type": "line",
        f"{along}ref": "paper",
        **{f"{across}0": limit, f"{across}1": limit, f"{along}0": 0, f"{along}1": 1},
        "line": {"color": "--warn", "width": width, "dash": "dash"},
        "name": f"{name} {degrees(limit)}",
        "showlegend": True,
    }
