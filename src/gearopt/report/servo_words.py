"""A servo train in words, for terminal and page: ratio, error, tolerances, stiffness, box."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.report.measures import METRIC, Measures
from gearopt.report.pages.design_tables import STAGE_ROWS as ROWS
from gearopt.report.words import amount, number

GEARS = ("backlash", "pitch")  # kinds that the error allowed to a train is of
KINDS = {"backlash": "backlash", "pitch": "pitch", "windup": "wind-up", "sensor": "sensor"}
RULES = {
    "worst_case": "worst case",
    "rss": "root sum of squares",
    "mean_plus_sd": "mean + {kappa} sd",
}
STAGE_ROWS = ROWS | {"bending_stress_MPa": ("bending stress", "MPa")}
WORTH = {  # keys of a train by which trains are compared, with their units
    "load_acceleration_rad_per_s2": "rad_per_s2",
    "move_time_s": "s",
    "rms_torque_Nm": "Nm",
    "inertia_kg_m2": "kg_m2",
    "mass_kg": "kg",
    "error_deg": "deg",
}
ARCMIN = 60.0  # a degree


def degrees(value: float) -> str:
    """An angle [deg] for reading; the same in metric and inch."""
    return f"{number(float(value))}°"


def arc_minutes(value: float) -> str:
    """An angle [deg] in minutes of arc."""
    return f"{number(ARCMIN * value)} arcmin"


def stage_of(stage: int | None) -> str:
    """Where something is, "whole train" where it is in no one stage."""
    return "whole train" if stage is None else f"stage {stage}"


def kind_words(kind: str) -> str:
    """The kind of an error."""
    return KINDS.get(kind, kind.replace("_", " "))


def rule_words(budget: Mapping[str, Any]) -> str:
    """The rule of a budget of errors."""
    words = RULES.get(budget["rule"], str(budget["rule"]).replace("_", " "))
    return words.format(kappa=number(budget.get("kappa", 3.0)))


def error_words(errors: Sequence[Mapping[str, Any]], limit: float | None) -> list[str]:
    """The sum of an error budget, and that of the gears against what is allowed them [deg]."""
    total = sum(e["error_deg"] for e in errors)
    gears = sum(e["error_deg"] for e in errors if e["kind"] in GEARS)
    words = [
        f"All sources at their limits add up to {degrees(total)} ({arc_minutes(total)}) at the "
        "output."
    ]
    if limit is not None:
        more = f", {degrees(gears - limit)} too much" if gears > limit * (1.0 + 1e-9) else ""
        words.append(
            f"Backlash and pitch make {degrees(gears)} of it: {100.0 * gears / limit:.1f} % of "
            f"the {degrees(limit)} allowed to them{more}."
        )
    return words


def worst_case_limit(design: Mapping[str, Any]) -> float | None:
    """The error [deg] that a worst-case budget allows; None without one."""
    for budget in design.get("allocation", {}).get("budgets", ()):
        if budget["rule"] == "worst_case":
            return float(budget["limit_deg"])
    return None


def error_limit(design: Mapping[str, Any], limits: Mapping[str, float]) -> float | None:
    """The largest error [deg] allowed: of a worst-case budget, else of the train."""
    limit = worst_case_limit(design)
    used, train = limits.get("error"), design.get("train")
    return train["error_deg"] / used if limit is None and used and train else limit


def cost_words(allocation: Mapping[str, Any]) -> list[str]:
    """What the new tolerances cost, and how far they use each budget."""
    new, old = allocation["cost"], allocation["old_cost"]
    change = 100.0 * (new / old - 1.0)
    words = [f"Cost {number(new)}, before {number(old)}: {change:+.1f} %."]
    for budget in allocation["budgets"]:
        used, limit = budget["used_deg"], budget["limit_deg"]
        words.append(
            f"Budget {rule_words(budget)}: {degrees(used)} of {degrees(limit)}, "
            f"{100.0 * used / limit:.1f} %."
        )
    return words


def drawn_words(drawn: Mapping[str, Any]) -> list[str]:
    """What the draws say: yield and quantile with their intervals."""
    sure = f"{100.0 * drawn['confidence']:g} %"
    good = f"{100.0 * drawn['yield_share']:.4f}"
    low = f"{math.floor(1e6 * drawn['yield_low']) / 1e4:.4f}"  # outwards, to hold what is said
    high = f"{math.ceil(1e6 * drawn['yield_high']) / 1e4:.4f}"
    ends = [drawn["quantile_low_deg"], drawn["quantile_high_deg"]]
    share = f"{100.0 * drawn['probability']:g} %"
    known = all(end is not None for end in ends)
    words = [
        f"{good} % of {drawn['count']:,} drawn trains keep the limit of "
        f"{degrees(drawn['limit_deg'])}; with {sure} confidence the yield lies between {low} and "
        f"{high} %."
    ]
    quantile = f"{share} of them have an error of at most {degrees(drawn['quantile_deg'])}"
    interval = f"between {' and '.join(map(degrees, ends))}" if known else ""
    between = f" (this quantile lies {interval} with {sure} confidence)" if known else ""
    few = "" if known else " (too few draws for an interval with this confidence)"
    words.append(f"{quantile}{between}{few}; the largest drawn is {degrees(drawn['largest_deg'])}.")
    return words


def stiffness_words(found: Mapping[str, Any], measures: Measures = METRIC) -> str:
    """Output stiffness, frequency and wind-up in a sentence."""
    words = f"Seen at the output: {amount(found['output_Nm_per_rad'], 'Nm_per_rad', measures)}"
    if found.get("frequency_Hz") is not None:
        words += f"; the load swings at {number(float(found['frequency_Hz']))} Hz, motor locked"
    if found.get("windup_deg") is not None:
        words += f"; wind-up {degrees(found['windup_deg'])} ({arc_minutes(found['windup_deg'])})"
    return f"{words}."


def box_words(box: Mapping[str, Any], measures: Measures = METRIC) -> str:
    """Whether the train fits into its box, and what it needs."""
    needed, inner = (box_size(box, which, measures) for which in ("needed", "inner"))
    verb = "fits" if box["fits"] else "does not fit"
    words = f"The train {verb}: it needs {needed}, the box is {inner} inside."
    over = [
        f"{measures.length(box[f'needed_{side}_mm'] - box[f'inner_{side}_mm'])} "
        f"{measures.unit('mm')} in {side}"
        for side in ("width", "height")
        if box[f"needed_{side}_mm"] > box[f"inner_{side}_mm"]
    ]
    return f"{words} Too large by {' and '.join(over)}." if over else words


def box_size(box: Mapping[str, Any], which: str, measures: Measures) -> str:
    """Width x height of the box ("inner") or of what is needed."""
    sides = (measures.length(box[f"{which}_{side}_mm"]) for side in ("width", "height"))
    return f"{' x '.join(sides)} {measures.unit('mm')}"


def teeth_words(stages: Sequence[Mapping[str, Any]]) -> str:
    """Teeth and modules of a train in a line."""
    return "; ".join(
        f"{s['pinion_teeth']}/{s['wheel_teeth']}, m_n {s['normal_module_mm']:g} mm" for s in stages
    )
