"""The chosen train: its stages side by side, and what they add up to."""

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages import train_views
from gearopt.report.pages.design_tables import stage_table
from gearopt.report.section import Section, Table
from gearopt.report.servo_words import STAGE_ROWS, arc_minutes, degrees
from gearopt.report.words import heading, parted


def section(result: Result, measures: Measures) -> Section | None:
    """Tables of the train, drawn in one line where no box is asked for; None without a train."""
    found = result.design.get("train")
    if not found:
        return None
    stages = found["stages"]
    totals = []
    for key, value in found.items():
        if key == "stages" or value is None:
            continue
        unit = parted(key)[1]
        totals.append([heading(key, measures), measures.of(value, unit) if unit else value])
    words = [_sector(found["sector"])] if found.get("sector", 1.0) < 1.0 else []
    if "error_deg" in found:
        words.append(
            f"The error of {degrees(found['error_deg'])} ({arc_minutes(found['error_deg'])}) is "
            "the worst case of backlash and pitch at the output."
        )
    if "inertia_kg_m2" in found:
        words.append("Inertia is seen at the motor.")
    drawn = train_views.views(stages, measures) if "box" not in result.design else ()
    if drawn:
        words.append(
            "All shafts are drawn in one line, wheels as full discs; reference circles are "
            f"dash-dotted. Dimensions in {measures.lengths}."
        )
    tables = (stage_table(stages, measures, STAGE_ROWS, ()), Table("train", ("", ""), totals))
    return Section("Train", words=words, drawings=drawn, tables=tables, half=not drawn)


def _sector(share: float) -> str:
    return (
        f"The last wheel is a sector of {360.0 * share:.4g}°, {100.0 * share:.4g} % of a full one; "
        "its mass and inertia are counted so."
    )
