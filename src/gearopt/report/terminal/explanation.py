"""An explanation on the terminal: ways out of the impossible, influences on the possible."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console, RenderableType
from rich.text import Text

from gearopt.optimise.explanation import Explanation
from gearopt.report.words import UNITS, columns, limit_words, number

KINDS = {"least": "least change", "less": "or ask for less", "choice": "or choose"}


def remedies(conflict: Sequence[str], ways: Sequence[Mapping[str, Any]]) -> list[RenderableType]:
    """What cannot hold together, and the edits that make a design possible."""
    blocks: list[RenderableType] = []
    if conflict:
        names = ", ".join(limit_words(n) for n in conflict)
        blocks.append(Text(f"These cannot hold together, and none of them is to spare: {names}."))
    if not ways:
        blocks.append(Text("No way out was found by moving limits; see docs/explain.md."))
        return blocks
    heads = ["write in the file", "instead of", "factor", "proven least"]
    table = columns("ways out, one is enough", heads)
    table.columns[1].justify = table.columns[2].justify = "left"
    for way in ways:
        label = KINDS.get(way["kind"], f"{way['what'].replace('_', ' ')}, all alike")
        for k, change in enumerate(way["changes"]):
            first = k == 0 and way["kind"] != "choice"
            table.add_row(
                Text(label if k == 0 else "  and"),
                Text(f"{change['key']} = {change['write']}"),
                Text(change["was"].strip('"')),
                f"{change['factor']:.4f}" if way["kind"] != "choice" else "",
                f"{way['bound']:.4f}" if first and way["bound"] is not None else "",
            )
    blocks.append(table)
    sure = all(way["verified"].get("with_less", "infeasible") == "infeasible" for way in ways)
    words = "Each was tried: a design exists with it"
    words += ", and none with 0.1 % (or one tooth) less. " if sure else ". "
    words += "Proven least: no smaller factor does, even with real-valued teeth and modules."
    blocks.append(Text(words))
    return blocks


def show(explanation: Explanation, title: str, console: Console) -> None:
    """Print the explanation of a possible request (an impossible one is shown by its result)."""
    result = explanation.result
    unit = UNITS.get(result.objective.get("unit", ""), result.objective.get("unit", ""))
    name = str(result.objective["name"]).replace("_", " ")
    console.print(Text.assemble((title, "bold"), f": {name} {number(result.value)} {unit}"))
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
    console.print(
        Text(
            f"What +1 % brings: slope of the {name} (d ln objective / d ln number) with "
            "real-valued teeth and modules, by multipliers and, to check, by solving again. "
            "What easing a limit brings: the drive itself solved again."
        )
    )


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
