"""What was found at a glance, and how much of each limit it uses."""

from gearopt.optimise.result import Result
from gearopt.report.kinds import kind_of
from gearopt.report.measures import Measures
from gearopt.report.proof_words import gap_words, proof, scope
from gearopt.report.result_words import certainty, goal, leading, limit_rows
from gearopt.report.section import Section, Table, Tile, percent
from gearopt.report.words import amount


def summary(result: Result, measures: Measures) -> Section:
    """Key figures, and in words what is certain."""
    words = proof(result, measures)
    tiles = [*_tiles(result, measures), *kind_of(result).tiles(result, measures)]
    return Section("Result", tiles, [*leading(result), *words], terminal=("\n".join(words),))


def _tiles(result: Result, measures: Measures) -> list[Tile]:
    """Objective and bound."""
    name, unit, value, bound, _ = goal(result)
    tiles = []
    if value is not None:
        tiles.append(Tile(name, amount(value, unit, measures), certainty(result)[0]))
    if bound is not None:
        title = f"proven bound{scope(result)}"
        tiles.append(Tile(title, amount(bound, unit, measures), gap_words(result)))
    return tiles


def limits(result: Result, measures: Measures, whole: str = "whole") -> Section | None:
    """Utilisation of every limit; None without limits. whole: what is no stage, on the terminal."""
    if not result.limits or (result.value is None and result.status != "evaluated"):
        return None
    stages, rows = limit_rows(result.limits)
    heads = ["limit used, %", *(f"stage {k}" for k in range(1, stages + 1)), "whole"]
    cells = [[words, *map(percent, values)] for words, values in rows]
    table = Table("limits", heads, cells, short={"whole": whole})
    words = ("At 100 a limit is reached.",)
    return Section("Limits", words=words, tables=(table,), half=True, terminal=(table,))
