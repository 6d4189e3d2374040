"""What was found at a glance, how much of each limit it uses, and ways out of the impossible."""

from collections.abc import Mapping
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.section import Section, Tile
from gearopt.report.pages.servo.tiles import tiles as servo_tiles
from gearopt.report.pages.table import Table, percent
from gearopt.report.proof_words import gap_words, proof, scope
from gearopt.report.remedy_words import REMEDY_HEADS, remedy_words
from gearopt.report.result_words import certainty, goal, leading, limit_rows
from gearopt.report.words import amount, number


def summary(result: Result, measures: Measures) -> Section:
    """Key figures, and in words what is certain."""
    words = [*leading(result), *proof(result, measures)]
    return Section("Result", _tiles(result, measures), words)


def _tiles(result: Result, measures: Measures) -> list[Tile]:
    name, unit, value, bound, _ = goal(result)
    tiles = []
    if value is not None:
        tiles.append(Tile(name, amount(value, unit, measures), certainty(result)[0]))
    if bound is not None:
        title = f"proven bound{scope(result)}"
        tiles.append(Tile(title, amount(bound, unit, measures), gap_words(result)))
    design = result.design
    if result.scene == "servo":
        return tiles + servo_tiles(design, name, measures)
    if "ratio" in design:
        error = design.get("ratio_error_percent")
        off = "" if error is None else f"{error:+.3f} % off"
        tiles.append(Tile("total ratio", number(design["ratio"]), off))
    if "output_torque_Nm" in design:
        tiles.append(Tile("output torque", amount(design["output_torque_Nm"], "Nm", measures)))
    if "mass_kg" in design and name != "mass":
        tiles.append(Tile("mass of the gears", amount(design["mass_kg"], "kg", measures)))
    if box := design.get("layout", {}).get("box"):
        sides = (measures.length(box[f"{side}_mm"], 1) for side in ("width", "height", "length"))
        size = f"{' x '.join(sides)} {measures.unit('mm')}"
        tiles.append(Tile("box", size, "width, height, length"))
    return tiles


def limits(result: Result, measures: Measures) -> Section | None:
    """Utilisation of every limit; None without limits."""
    if not result.limits or result.value is None:
        return None
    stages, rows = limit_rows(result.limits)
    heads = ["limit used, %", *(f"stage {k}" for k in range(1, stages + 1)), "whole"]
    cells = [[words, *map(percent, values)] for words, values in rows]
    table = Table("limits", heads, cells)
    return Section("Limits", words=("At 100 a limit is reached.",), tables=(table,), half=True)


def ways_out(result: Result, measures: Measures) -> Section | None:
    """Why nothing meets the limits, and what to write instead; None elsewhere."""
    found: Mapping[str, Any] = result.report.get("ways_out") or {}
    if not found:
        return None
    why, rows, tried = remedy_words(found)
    if not found["conflict"] and result.message not in ("", found["message"]):
        why.insert(0, result.message)
    tables = [Table("ways out", REMEDY_HEADS, rows, words=True)] if rows else []
    return Section("Ways out", words=[*why, *tried], tables=tables)
