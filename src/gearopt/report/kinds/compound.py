"""A compound train: its gears to scale, its ratio, and the ratios that its teeth reach."""

from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.layout.layout_design import GearDesign
from gearopt.optimise.result import Result
from gearopt.optimise.typed import typed
from gearopt.report.design_tables import ratio_tile
from gearopt.report.drawing.drawn_stage import DrawnStage
from gearopt.report.drawing.number_line import Guide, Span, number_line
from gearopt.report.drawing.train_views import in_one_line, view_along_shafts
from gearopt.report.kinds import generic
from gearopt.report.measures import METRIC, Measures
from gearopt.report.section import Section, Tile
from gearopt.scenes.compound import CompoundDesign


def _design(result: Result) -> CompoundDesign:
    train: CompoundDesign = typed(CompoundDesign, result.design, "design")
    return train


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """The ratio as a key figure."""
    if not result.design:
        return []
    design = _design(result)
    tile = ratio_tile(design.ratio, design.ratio_error_percent)
    return [replace(tile, remark="") if "achieved" in result.report else tile]


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """Obstacle between the train and its ratio."""
    if not result.design:
        return ""
    if not result.report.get("reach", {"within": True})["within"]:
        return "the allowed numbers of teeth do not reach the ratio"
    if _design(result).ratio_error_percent == 0.0:
        return "the train has the ratio exactly"
    if result.status == "optimal":
        return "no train of the allowed teeth has the ratio exactly"
    return "the train does not have the ratio exactly"


def gears(result: Result, measures: Measures) -> Section | None:
    """Draw the gears along their shafts, in modules; None where there are none."""
    if not result.design:
        return None
    design = _design(result)
    train, scale = in_one_line(
        [_stage(*z) for z in zip(design.driver_teeth, design.driven_teeth, strict=True)]
    )
    named = tuple(replace(gear, name=f"z {gear.teeth}") for gear in train.gears)
    drawing = view_along_shafts(replace(train, gears=named), scale, _modules, _title)
    words = (
        "Drawn to scale as if both pairs were spur gears of one module m with an addendum of m: "
        "diameters, centre distances and the length over tip circles are multiples of m. Solid "
        "lines are tip circles, dash-dotted ones reference circles; numbers in circles are shafts, "
        "1 the input and 3 the output. The drivers may be interchanged, and so may the driven "
        "gears.",
    )
    return Section("Gears", words=words, drawings=(drawing,))


def _stage(driver: int, driven: int) -> DrawnStage:
    """A pair of spur gears in modules; it has no face width."""
    return DrawnStage(
        normal_module_mm=1.0,
        pinion_teeth=driver,
        wheel_teeth=driven,
        face_width_mm=0.0,
        pinion_diameter_mm=driver,
        wheel_diameter_mm=driven,
        pinion_tip_diameter_mm=driver + 2,
        wheel_tip_diameter_mm=driven + 2,
        centre_distance_mm=0.5 * (driver + driven),
    )


def _modules(length: float) -> str:
    return f"{length:g}·m"


def _title(gear: GearDesign) -> str:
    member = "driver" if gear.member == "pinion" else "driven gear"
    return f"{member} of pair {gear.stage}: {gear.name}, d {_modules(gear.reference_diameter_mm)}"


def reach(result: Result, measures: Measures) -> Section | None:
    """Draw the ratio asked beside those that two pairs reach; None where it is among them."""
    reached: dict[str, Any] = result.report.get("reach") or {}
    if not reached or reached["within"]:
        return None
    rows = [_span(reached["teeth"], reached["least_ratio"], reached["most_ratio"])]
    for wider in reached["wider_teeth"]:
        most = (wider[1] / wider[0]) ** 2
        rows.append(_span(wider, 1.0 / most, most))
    caption = "Total ratios of two pairs, by the number of teeth allowed; the axis is logarithmic."
    asked = Guide(reached["ratio"], f"asked {reached['ratio']:.6g}", "gap")
    drawing = number_line(rows, (asked,), "ratio asked and ratios in reach", caption)
    return Section("Out of reach", drawings=(drawing,))


def _span(teeth: list[int], low: float, high: float) -> Span:
    return Span("{} to {} teeth".format(*teeth), low, high, (f"{low:.5g}", f"{high:.5g}"))


PAGES = replace(
    generic.PAGES,
    sections=(*generic.OPENING, reach, gears, *generic.PAGES.sections[len(generic.OPENING) + 1 :]),
    tiles=tiles,
    binding_limit=binding_limit,
)
