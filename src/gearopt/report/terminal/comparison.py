"""A comparison on the terminal: one block a model, a table for each way to be equal."""

from rich.console import Console
from rich.table import Table
from rich.text import Text

from gearopt.optimise.comparing.comparison import Comparison, Group
from gearopt.report import comparison_words as words


def show(found: Comparison, console: Console) -> None:
    """Print a comparison."""
    console.print(Text.assemble((found.title, "bold"), ": methods compared"))
    if found.message:
        console.print(Text(found.message[0].upper() + found.message[1:] + ".", style="yellow"))
    if len(found.groups) > 1:
        console.print("Methods of different models answer different questions: they stand apart.")
    for group in found.groups:
        _group(found, group, console)
    console.print()
    for row in (row for group in found.groups for row in group.rows if not row.refused):
        kind = f"{len(found.seeds)} seeds" if row.random else "deterministic, one run"
        line = (
            f"{row.method}: {kind}; evaluation = {row.counts}; "
            f"start-up {row.start_up_seconds:.2g} s; {words.settings(found.settings[row.method])}"
        )
        console.print(Text(line, style="dim"), no_wrap=True, overflow="ellipsis")
    console.print(Text(f"{found.machine['cpus']} cores. {words.command(found)}", style="dim"))


def _group(found: Comparison, group: Group, console: Console) -> None:
    console.print()
    console.print(Text(group.words or group.model, style="bold"))
    console.print(Text(words.reference(group)))
    for row in group.rows:
        console.print(Text(f"- {row.method}: {words.verdict(group, row)}"))
    for field, heading, budget in words.kinds(found):
        heads = [f"{name}\n{unit}" for name, unit, _ in words.COLUMNS]
        table = Table("method", *heads, box=None, header_style="bold", pad_edge=False)
        for column in table.columns[1:]:
            column.justify = "right"
        for row in group.rows:
            sample = getattr(row, field)
            if sample is not None:
                table.add_row(row.method, *words.cells(sample))
        if table.row_count:
            console.print()
            console.print(Text(f"{heading}: {budget}", style="bold"))
            console.print(table)
    for row in group.rows:
        if late := words.ended(found, row):
            console.print(Text(f"Equal evaluations: {late}.", style="yellow"))
