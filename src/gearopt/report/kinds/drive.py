"""Drives of cylindrical gears, laid out or not: drawings, stages, processes, next best trains."""

from functools import partial

from gearopt.formulations.design import drive_design
from gearopt.optimise.result import Result
from gearopt.report.kinds import Kind
from gearopt.report.kinds.generic import ASKED, FIRST, LAST, TOLD
from gearopt.report.measures import Measures
from gearopt.report.pages import (
    design_tables,
    layout_solid,
    layout_tables,
    layout_views,
    outcome,
    side_by_side,
    trade_off,
    train_views,
)
from gearopt.report.result_words import objective
from gearopt.report.section import Tile
from gearopt.report.words import amount


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Ratio, torque, mass and box."""
    if not result.design:
        return []
    design = drive_design(result.design)
    torque = amount(design.output_torque_Nm, "Nm", measures)
    found = [design_tables.ratio_tile(design.ratio, design.ratio_error_percent)]
    found.append(Tile("output torque", torque))
    if objective(result)[0] != "mass":
        found.append(Tile("mass of the gears", amount(design.mass_kg, "kg", measures)))
    if design.layout is not None:
        box = design.layout.box
        sides = (measures.length(v, 1) for v in (box.width_mm, box.height_mm, box.length_mm))
        size = f"{' x '.join(sides)} {measures.unit('mm')}"
        found.append(Tile("box", size, "width, height, length"))
    return found


def beside(result: Result, measures: Measures) -> list[str]:
    """What other ways to the same objective give: real-valued sizes, or gears chosen first."""
    found = []
    for part in result.parts:
        alike = part.objective["name"] == result.objective["name"]
        if part.name in ("sizing", "apart") and alike and result.status == "optimal":
            found += _other_way(result, part, measures)
        if part.name == "sizing" and result.status == "limit" and result.value is None:
            found += _instead(part, measures)
    return found


def _other_way(result: Result, part: Result, measures: Measures) -> list[str]:
    if part.value is None or result.value is None:
        return []
    more = 100 * (result.value / part.value - 1)
    value = amount(part.value, objective(result)[1], measures)
    if part.name == "apart":
        less = f"{-more:.2f}".replace("-0.00", "0.00")
        return [f"Gears chosen first and then laid out: {value} (at once is {less} % smaller)."]
    cost = f"{more:.2f}".replace("-0.00", "0.00")
    return [
        f"With real-valued teeth and modules: {value} "
        f"(whole teeth and standard modules cost {cost} %)."
    ]


def _instead(part: Result, measures: Measures) -> list[str]:
    """What is known where no whole teeth were found: the answer with real-valued ones."""
    name, unit = objective(part)
    if part.value is None or part.bound is None:
        return []
    return [
        f"With real-valued teeth and modules there is a {name} of "
        f"{amount(part.value, unit, measures)}; whole teeth have none below "
        f"{amount(part.bound, unit, measures)}."
    ]


KIND = Kind(
    sections=(
        *FIRST,
        layout_views.section,
        layout_solid.section,
        train_views.section,
        side_by_side.section,
        design_tables.section,
        *ASKED,
        design_tables.trains,
        trade_off.section,
        *LAST,
    ),
    terminal=(
        design_tables.section,
        layout_tables.section,
        partial(outcome.limits, whole="drive"),
        design_tables.trains,
        side_by_side.section,
        *TOLD,
    ),
    tiles=tiles,
    beside=beside,
)
