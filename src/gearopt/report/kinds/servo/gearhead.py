"""A planetary stage as the gearhead of a servo axis: its figures, and what they say."""

from gearopt.optimise.result import Result
from gearopt.report.kinds.servo.words import arc_minutes, degrees, design_of
from gearopt.report.measures import Measures
from gearopt.report.section import Section, Table, names_and_values


def section(result: Result, measures: Measures) -> Section | None:
    """Show teeth, inertia, losses and lost motion; None where the file has no planetary stage."""
    stage = design_of(result).gearhead
    if stage is None:
        return None
    words = []
    if (most := stage.lost_motion_deg) is not None and (least := stage.least_lost_motion_deg):
        words.append(
            f"Between both flanks the output turns by {degrees(least)} to {degrees(most)} "
            f"({arc_minutes(least)} to {arc_minutes(most)})"
            + (": planets may bind." if least < 0.0 else ".")
        )
    table = Table("planetary stage", ["quantity", "value"], names_and_values(stage, measures))
    return Section("Planetary stage", words=words, tables=(table,), terminal=(*words, table))
