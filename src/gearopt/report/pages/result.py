"""The page of a result: drawings, a solid to turn, progress, numbers, and how sure they are."""

from gearopt.optimise.result import Result
from gearopt.report.pages import (
    anytime,
    design_tables,
    layout_solid,
    layout_views,
    outcome,
    packing_solid,
    packing_views,
    side_by_side,
    trade_off,
)
from gearopt.report.pages.frame import render
from gearopt.report.result_words import objective, verdict
from gearopt.report.words import number

SECTIONS = (
    outcome.summary,
    outcome.ways_out,
    layout_views.section,
    layout_solid.section,
    packing_views.section,
    packing_solid.section,
    anytime.section,
    trade_off.section,
    side_by_side.section,
    outcome.limits,
    design_tables.section,
    design_tables.trains,
)


def page(result: Result, title: str, command: str) -> str:
    """One self-contained HTML page; command: what makes it again."""
    result = Result.from_dict(result.to_dict())  # plain numbers, as a file of it has them
    sections = [made for section in SECTIONS if (made := section(result)) is not None]
    return render(
        "result.html",
        title,
        _subtitle(result),
        {"gearopt": result.gearopt, **result.versions},
        command,
        plots=any(section.figures for section in sections),
        sections=sections,
        source=result.file and f"File {result.file}, SHA-256 {(result.file_sha256 or '')[:16]}…",
    )


def _subtitle(result: Result) -> str:
    name, unit = objective(result)
    value = "" if result.value is None else f"{name} {number(result.value)} {unit}, "
    return f"{value}{verdict(result)[0]}"
