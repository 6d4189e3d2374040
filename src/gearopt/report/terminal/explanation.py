"""An explanation on the terminal: ways out of the impossible, influences on the possible."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from rich.console import Console, RenderableType
from rich.text import Text

from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.result import Result
from gearopt.report.influence_words import influence_rows, influence_words
from gearopt.report.remedy_words import REMEDY_HEADS, remedy_words
from gearopt.report.result_words import goal, title
from gearopt.report.words import VERDICTS, amount, columns, limit_words


def remedies(found: Mapping[str, Any]) -> list[RenderableType]:
    """What cannot hold together, and the edits that make a design possible.

    found: conflict, remedies and message, as `explain` and `solve` have them.
    """
    why, rows, tried = remedy_words(found)
    blocks: list[RenderableType] = [Text(words) for words in why]
    if rows:
        table = columns(REMEDY_HEADS[0], list(REMEDY_HEADS[1:]))
        table.columns[1].justify = table.columns[2].justify = "left"
        for row in rows:
            table.add_row(*map(Text, row))
        blocks.append(table)
    return [*blocks, *map(Text, tried)]


def show(explanation: Explanation, console: Console) -> None:
    """Print the explanation of a possible request (an impossible one is shown by its result)."""
    result = explanation.result
    name, unit, reached, _, _ = goal(result)
    words, colour = VERDICTS[result.status]
    value = amount(reached, unit)
    console.print(
        Text.assemble((title(result), "bold"), f": {name} {value}, ", (words, f"bold {colour}"))
    )
    full = ", ".join(limit_words(n) for n in explanation.binding)
    console.print(Text(f"Used to the full: {full}." if full else "No limit is used to the full."))
    prices = {
        "influences": [asdict(i) for i in explanation.influences],
        "message": explanation.message,
    }
    for block in influences(prices, result):
        console.print()
        console.print(block)


def influences(found: Mapping[str, Any], result: Result) -> list[RenderableType]:
    """What every number of the file does to the objective, as a table, and what that means."""
    heads = ["now", "+1 % brings", "re-solved", "eased by", "brings"]
    table = columns("number in the file", heads)
    table.columns[0].no_wrap = True
    for key, now, slope, both, step, price in influence_rows(found["influences"]):
        table.add_row(key, now, slope, both, step, price)
    blocks: list[RenderableType] = [table] if found["influences"] else []
    return [*blocks, Text("\n".join(influence_words(found, result)))]
