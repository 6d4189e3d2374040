"""The tolerances before and after they were shared out anew, with what they cost."""

from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.section import Cell, Section, Table, percent
from gearopt.report.servo_words import cost_words, kind_words

ENDS = 1e-6  # relative: a tolerance as near to an end of its range stands at it
SHORT = 0.999  # of a cell: a full bar would mark a limit that is reached


def section(result: Result, measures: Measures) -> Section | None:
    """Old and new tolerances; None where the file has none."""
    rows = result.design.get("tolerances")
    if not rows:
        return None
    unit = measures.unit("um")
    heads = ["tolerance", "stage", "kind", f"old [{unit}]", f"new [{unit}]", "new/old"]
    heads += ["of the error, %", "cost, old", "cost, new"]
    total = sum(r["sensitivity_deg_per_mm"] * r["new_mm"] for r in rows)
    dearest = max(max(r["old_cost"], r["new_cost"]) for r in rows)
    cells = [_row(r, total, dearest, measures) for r in rows]
    sums: list[Any] = ["sum", None, "", *_sums(rows, measures)]
    words = cost_words(found) if (found := result.design.get("allocation")) else []
    words.append(
        "Of the error: sensitivity times new tolerance, of their sum. The words least and most: "
        "the new tolerance is the least or the most that the file allows."
    )
    table = Table("tolerances", heads, [*cells, sums])
    return Section("Tolerances", words=words, tables=(table,))


def _row(row: Any, total: float, dearest: float, measures: Measures) -> list[Any]:
    old, new = (measures.of(row[k], "um") for k in ("old_mm", "new_mm"))
    ratio = row["new_mm"] / row["old_mm"]
    return [
        row["name"],
        row["stage"],
        kind_words(row["kind"]),
        _size(old),
        Cell(new, f"{_end(row)} {new:.2f}".strip()),
        Cell(ratio, f"{ratio:.3f}"),
        percent(row["sensitivity_deg_per_mm"] * row["new_mm"] / total if total else None),
        *(_cost(row[k], dearest) for k in ("old_cost", "new_cost")),
    ]


def _size(value: float) -> Cell:
    """A tolerance to four digits, at most hundredths."""
    return Cell(value, f"{value:.2f}")


def _end(row: Any) -> str:
    """Whether a new tolerance is the least or the most allowed."""
    for name, key in (("least", "lower_mm"), ("most", "upper_mm")):
        end = row.get(key)
        if end and abs(row["new_mm"] / end - 1.0) < ENDS:
            return name
    return ""


def _cost(cost: float, dearest: float) -> Cell:
    """A cost with its bar; all bars of the table have one scale."""
    share = SHORT * max(0.0, cost) / dearest if dearest > 0.0 else None
    return Cell(cost, f"{cost:.3f}", share)


def _sums(rows: Any, measures: Measures) -> list[Any]:
    """Of tolerances and costs."""
    old, new = (sum(measures.of(r[k], "um") for r in rows) for k in ("old_mm", "new_mm"))
    costs = [sum(r[k] for r in rows) for k in ("old_cost", "new_cost")]
    ratio = Cell(new / old, f"{new / old:.3f}")
    return [_size(old), _size(new), ratio, Cell(100.0, "100.0")] + [
        Cell(cost, f"{cost:.3f}") for cost in costs
    ]
