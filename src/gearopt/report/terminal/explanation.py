"""An explanation on the terminal: ways out of the impossible, influences on the possible."""

import math
from collections.abc import Mapping
from typing import Any

from rich.console import Console, RenderableType
from rich.text import Text

from gearopt.optimise.explaining.explanation import Explanation
from gearopt.report.words import UNITS, VERDICTS, columns, edit, limit_words, number

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


def show(explanation: Explanation, title: str, console: Console) -> None:
    """Print the explanation of a possible request (an impossible one is shown by its result)."""
    result = explanation.result
    unit = UNITS.get(result.objective.get("unit", ""), result.objective.get("unit", ""))
    name = str(result.objective["name"]).replace("_", " ")
    words, colour = VERDICTS[result.status]
    console.print(
        Text.assemble(
            (title, "bold"),
            f": {name} {number(result.value)} {unit}, ",
            (words, f"bold {colour}"),
        )
    )
    if explanation.message:
        console.print(Text(f"{explanation.message[0].upper()}{explanation.message[1:]}."))
    full = ", ".join(limit_words(n) for n in explanation.binding)
    console.print(Text(f"Used to the full: {full}." if full else "No limit is used to the full."))
    console.print()
    heads = ["now", "+1 % brings", "re-solved", "eased by", "brings"]
    table = columns("number in the file", heads)
    table.columns[0].no_wrap = True
    for i in explanation.influences:
        price = "" if i.price is None else ("none" if abs(i.price) < 1e-9 else f"{i.price:+.3%}")
        table.add_row(i.key, i.value, _percent(i.sensitivity), _sides(i.resolved), i.step, price)
    console.print(table)
    console.print()
    slope = f"What +1 % brings: slope of the {name} (d ln objective / d ln number)"
    words = ", by solving again."
    if any(i.sensitivity is not None for i in explanation.influences):
        words = (
            " with real-valued teeth and modules, by multipliers and, to check, by solving again. "
            "What easing a limit brings: the drive itself solved again."
        )
    console.print(Text(slope + words))


def _percent(slope: float | None) -> str:
    if slope is None:
        return ""
    return "0" if abs(slope) < 1e-9 else f"{slope:+.4f} %"


def _sides(resolved: tuple[float | None, float | None]) -> str:
    """One number where both sides agree, both where a limit is about to bind."""
    below, above = resolved
    if below is None or above is None:
        return _percent(above if below is None else below)
    if abs(above - below) < 0.02:
        return _percent(0.5 * (below + above))
    return f"{_percent(below)} | {_percent(above)}"
