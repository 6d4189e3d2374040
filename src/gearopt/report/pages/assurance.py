"""How sure a result is: what was computed to prove it, and what it takes for granted."""

from collections.abc import Mapping
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.proof_words import scope
from gearopt.report.result_words import RULED, objective, verdict
from gearopt.report.section import Cell, Section, Table
from gearopt.report.words import amount

PARTS = {  # of a result: what their names mean
    "sizing": "real-valued sizes",
    "apart": "gears first, then the box",
    "real-valued": "real-valued teeth",
}
ROWS = ("status", "objective", "value", "bound", "gap, %", "method", "proof", "seconds")
TOLD = ("method", "arithmetic", "sentence")  # of a proof: told elsewhere
CHECKS = {  # of a certificate: what each number is
    "feasibility": "largest excess over a limit",
    "stationarity": "largest slope left over",
    "complementarity": "largest multiplier times room",
    "scale": "of the objective, which is zero: the gap is relative to it",
}


def meaning(result: Result) -> str:
    """What the status of a result says, and what it does not say."""
    known, status = result.bound is not None, result.status
    if status == "optimal":
        return (
            f"No design{scope(result)} that meets the limits is better by more than the gap: the "
            "bound was computed by gearopt itself, not taken from a solver."
        )
    if status == "infeasible":
        return "Proven: no design meets all limits."
    if status == "evaluated":
        met = "meets all limits" if result.feasible else "does not meet all limits"
        return f"Nothing was minimised: the design given was evaluated, and {met}."
    if status == "stationary":
        return "No small change improves the design; a better one elsewhere is not excluded."
    if result.value is None:
        return "No design was found; that is no proof that there is none."
    early = "The run ended early. " if status == "limit" else ""
    below = f", but none{scope(result)} is below the bound" if known else ""
    return f"{early}The design meets all limits; a better one may exist{below}."


def proven(result: Result, measures: Measures) -> Section:
    """What the status means, and the numbers of the proof, of every part too."""
    parts = (result, *result.parts)
    heads = ("", *(PARTS.get(part.name, part.name.replace("_", " ")) for part in parts))
    rows = [list(row) for row in zip(*(_column(part, measures) for part in parts), strict=True)]
    tables = [Table("proof", heads, [[n, *row] for n, row in zip(ROWS, rows, strict=True)])]
    if checks := _checks(result):
        tables.append(Table("checks", ("", ""), checks))
    words = [meaning(result)]
    if arithmetic := result.proof.get("arithmetic"):
        words.append(f"Arithmetic: {arithmetic}.")
    return Section("What is proven, and how", words=words, tables=tables, half=len(parts) < 3)


def _column(part: Result, measures: Measures) -> list[Any]:
    """Of a result or one of its parts, what ROWS names."""
    name, unit = objective(part)
    return [
        verdict(part)[0],
        f"{name} [{measures.unit(unit)}]" if unit else name,
        _amount(part.value, unit, measures),
        _amount(part.bound, unit, measures),
        "" if part.gap is None else Cell(100.0 * part.gap, f"{100.0 * part.gap:.3g}"),
        part.method,
        "by rules" if part.name in RULED else str(part.proof.get("method", "")),
        Cell(part.seconds, f"{part.seconds:.3g}"),
    ]


def _amount(value: float | None, unit: str, measures: Measures) -> Cell:
    """A value in the unit that is shown, which its text names."""
    if value is None:
        return Cell(None, "")
    return Cell(measures.of(value, unit), amount(value, unit, measures))


def _checks(result: Result) -> list[tuple[str, Any]]:
    """The certificate, then what else the proof says."""
    found: list[tuple[str, Any]] = [
        (f"{name}: {CHECKS.get(name, '')}", Cell(value, "" if value is None else f"{value:.2g}"))
        for name, value in result.certificate.items()
    ]
    for key, value in result.proof.items():
        if key not in TOLD and not isinstance(value, Mapping | list):
            shown = Cell(value, f"{value:.3g}") if isinstance(value, float) else value
            found.append((key.replace("_", " "), shown))
    return found


def assumptions(result: Result, measures: Measures) -> Section | None:
    """What the numbers rest on beside the file; None where the kind tells nothing."""
    told = result.report.get("assumptions") or []
    return Section("Assumptions and unverified data", words=told, half=True) if told else None
