"""A planetary stage as the gearhead of a servo axis."""

from gearopt.optimise.result import Result
from gearopt.report.kinds.servo.words import design_of
from gearopt.report.measures import Measures
from gearopt.report.section import Section, Table, names_and_values

BINDS = "Planets may bind: the least lost motion is below zero."


def section(result: Result, measures: Measures) -> Section | None:
    """Show its inertia, losses and lost motion; None where the file has no planetary stage."""
    stage = design_of(result).gearhead
    if stage is None:
        return None
    words = [BINDS] if (stage.least_lost_motion_deg or 0.0) < 0.0 else []
    table = Table("planetary stage", ["quantity", "value"], names_and_values(stage, measures))
    return Section("Planetary stage", words=words, tables=(table,), terminal=(*words, table))
