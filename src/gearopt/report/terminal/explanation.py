"""An explanation on the terminal: ways out of the impossible, influences on the possible."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from rich.console import Console, RenderableType
from rich.text import Text

from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.result import Result
from gearopt.report.influence_words import influence_rows, influence_words
from gearopt.report.result_words import objective, title
from gearopt.report.words import VERDICTS, amount, columns, edit, limit_words

KINDS = {"least": "least change", "less": "or ask for less", "choice": "or choose"}


def remedies(found: Mapping[str, Any]) -> list[RenderableType]:
    """What cannot hold together, and the edits that make a design possible.

    found: conflict, remedies and message, as `explain` and `solve` have them.
    """
    blocks: list[RenderableType] = []
    conflict, ways, late = found["conflict"], found["remedies"], found["message"]
    if conflict:
        names = ", ".join(limit_words(n) for n in conflict)
        blocks.append(Text(f"These cannot hold together, and none of them is to spare: {names}."))
    if not ways:
        words = (
            f"{late[0].upper()}{late[1:]}." if late else "No way out was found by moving limits."
        )
        blocks.append(Text(words))
        return blocks
    heads = ["write in the file", "instead of", "factor", "proven least"]
    table = columns("ways out, one is enough", heads)
    table.columns[1].justify = table.columns[2].justify = "left"
    for way in ways:
        label = KINDS.get(way["kind"], f"{way['what'].replace('_', ' ')}, all alike")
        product = "product " if len(way["changes"]) > 1 and way["kind"] == "least" else ""
        for k, change in enumerate(way["changes"]):
            first = k == 0 and way["kind"] != "choice"
            table.add_row(
                Text(label if k == 0 else "  and"),
                Text(edit(change)),
                Text(change["was"].strip('"')),
                _factor(change["factor"]) if way["kind"] != "choice" else "",
                f"{product}{way['bound']:.4f}" if first and way["bound"] is not None else "",
            )
    blocks.append(table)
    sure = all(way["verified"].get("with_less", "infeasible") == "infeasible" for way in ways)
    words = "Each was tried: a design exists with it"
    less = sure and any(way["kind"] != "choice" for way in ways)
    words += ", and none with 0.1 % (or one tooth) less. " if less else ". "
    if conflict:
        words += "Proven least: no smaller factor does, even with real-valued teeth and modules."
    words += f" {late[0].upper()}{late[1:]}." if late else ""
    blocks.append(Text(words))
    return blocks


def _factor(factor: float | None) -> str:
    """A factor; nothing where a number moves away from zero."""
    return "" if factor is None or math.isinf(factor) else f"{factor:.4f}"


def show(explanation: Explanation, console: Console) -> None:
    """Print the explanation of a possible request (an impossible one is shown by its result)."""
    result = explanation.result
    name, unit = objective(result)
    words, colour = VERDICTS[result.status]
    value = amount(result.value, unit)
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
