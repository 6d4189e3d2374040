"""The page of a comparison: verdicts, tables, anytime curves, final gaps, how it was measured."""

from typing import Any

from gearopt.optimise.comparing.comparison import Comparison, Group
from gearopt.report import comparison_words as words
from gearopt.report.pages.comparison_figures import LEAST, anytime, final, span
from gearopt.report.pages.frame import render

KNOWN = ("exact", "ipopt", "annealing", "nsga2", "scip", "gp", "multistart")
COLOURS = 8  # --series-1 ... in frame.css, told apart by the colour-blind


def page(found: Comparison) -> str:
    """One self-contained HTML page."""
    colour = colours([row.method for group in found.groups for row in group.rows])
    rows = [row for group in found.groups for row in group.rows if not row.refused]
    samples = [s for row in rows for s in (row.equal_evaluations, row.equal_time) if s]
    clipped = sum(run.clipped for sample in samples for run in sample.runs)
    return render(
        "comparison.html",
        f"{found.title}: methods compared",
        _subtitle(found),
        {"gearopt": found.gearopt, **found.versions},
        words.command(found),
        found=found,
        blocks=[_block(found, group, colour) for group in found.groups],
        columns=words.COLUMNS,
        colours=colour,
        methods=[(row, words.settings(found.settings[row.method])) for row in rows],
        fairness=words.FAIRNESS,
        clipped=f" (it was so in {clipped} runs)" if clipped else "",
    )


def colours(methods: list[str]) -> dict[str, str]:
    """The colour of every method: its own for a known one, on every page, else the next free."""
    taken = {name: KNOWN.index(name) + 1 for name in methods if name in KNOWN}
    free = [k for k in range(COLOURS, 0, -1) if k not in taken.values()] or [COLOURS]
    others = (name for name in dict.fromkeys(methods) if name not in KNOWN)
    taken |= {name: free[k % len(free)] for k, name in enumerate(others)}
    return {name: f"--series-{k}" for name, k in taken.items()}


def _subtitle(found: Comparison) -> str:
    methods = ", ".join(row.method for group in found.groups for row in group.rows)
    budget = found.budget
    return (
        f"{methods}; {len(found.seeds)} seeds for random methods; "
        f"{budget['evaluations']:,} evaluations or {budget['seconds']:g} s a run"
    )


def _block(found: Comparison, group: Group, colour: dict[str, str]) -> dict[str, Any]:
    """What the template shows of a group."""
    sides = []
    least, worst, top = span(group)
    for field, heading, budget in words.kinds(found):
        samples = {row.method: getattr(row, field) for row in group.rows if getattr(row, field)}
        if not samples:
            continue
        figures = []
        if group.reference is not None:
            figures = [anytime(samples, colour, least, top, by_time=field == "equal_time")]
        if worst > LEAST:
            figures.append(final(samples, colour, least, worst))
        rows = [(method, words.cells(sample)) for method, sample in samples.items()]
        late = [words.ended(found, row) for row in group.rows if field == "equal_evaluations"]
        side = {"heading": heading, "budget": budget, "rows": rows, "figures": figures}
        sides.append(side | {"ended": "; ".join(filter(None, late))})
    return {
        "heading": group.words or group.model,
        "reference": words.reference(group),
        "verdicts": [(row.method, words.verdict(group, row)) for row in group.rows],
        "sides": sides,
    }
