"""A compound train: its ratio beside what all kinds show; tooth numbers alone have no drawing."""

from dataclasses import replace

from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.report.design_tables import ratio_tile
from gearopt.report.kinds import generic
from gearopt.report.measures import Measures
from gearopt.report.section import Tile
from gearopt.scenes.compound import CompoundDesign


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Return the ratio as a key figure."""
    if not result.design:
        return []
    design: CompoundDesign = typed(CompoundDesign, result.design, "design")
    return [ratio_tile(design.ratio, design.ratio_error_percent)]


KIND = replace(generic.KIND, tiles=tiles, drawn=False)
