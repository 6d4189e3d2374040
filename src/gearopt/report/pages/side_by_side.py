"""The best design beside those that the design processes make by rules."""

from collections.abc import Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.result_words import RULED, objective
from gearopt.report.section import Section, Table
from gearopt.report.words import heading, limit_words, number, parted

OF_STAGE = {"ratio": "ratio u", "centre_distance_mm": "a", "face_width_mm": "b"}
OF_DRIVE = ("ratio", "ratio_error_percent", "gear_volume_mm3")


def section(result: Result, measures: Measures) -> Section | None:
    """Designs as columns; None where the file asks for no process.

    The first column is the result itself, or the gears that its layout is of.
    """
    best = next((part for part in result.parts if part.name == "gears"), result)
    ruled = [part for part in best.parts if part.name in RULED]
    if best.value is None or not ruled:
        return None
    missing = [_missing(part) for part in ruled if part.value is None]
    designs = [best, *(part for part in ruled if part.design)]
    heads = ["", best.method, *(part.name for part in designs[1:])]
    rows = [*_stages(designs, measures), *_totals(designs, best.bound, measures)]
    words = "The processes choose by rules, without a search; limits and bound are those of all."
    table = Table("processes and optimum", heads, rows)
    told = (table, *missing) if result.value is not None else ()
    return Section("Processes and optimum", words=(words, *missing), tables=(table,), terminal=told)


def _stages(designs: Sequence[Result], measures: Measures) -> list[list[Any]]:
    rows: list[list[Any]] = []
    for k in range(len(designs[0].design["stages"])):
        stages = [one.design["stages"][k] for one in designs]
        teeth = [
            f"{number(s['normal_module_mm'])}, {s['pinion_teeth']}/{s['wheel_teeth']}"
            for s in stages
        ]
        rows.append([f"stage {k + 1}: m_n, z1/z2", *teeth])
        for key, label in OF_STAGE.items():
            unit = parted(key)[1]
            sign = f" [{measures.unit(unit)}]" if unit else ""
            values = (measures.of(s[key], unit) for s in stages)
            rows.append([f"stage {k + 1}: {label}{sign}", *values])
    return rows


def _totals(designs: Sequence[Result], bound: float | None, measures: Measures) -> list[list[Any]]:
    rows: list[list[Any]] = []
    for key in OF_DRIVE:
        values = (measures.of(one.design[key], parted(key)[1]) for one in designs)
        rows.append([heading(key, measures), *values])
    name, unit = objective(designs[0])
    if name != "gear volume":
        shown = (None if one.value is None else measures.of(one.value, unit) for one in designs)
        rows.append([f"{name} [{measures.unit(unit)}]", *shown])
    if bound is not None and bound > 0.0:
        rows.append(["over the bound [%]", *(_over(one, bound) for one in designs)])
    return rows


def _over(one: Result, bound: float) -> float | None:
    """By how much a design is above the bound [%]; None where it meets not all limits."""
    return None if one.value is None else max(100.0 * (one.value / bound - 1.0), 0.0)


def _missing(part: Result) -> str:
    """Why a process has no design that counts, with the violated limit in words."""
    first, _, rest = part.message.partition(" ")
    shown = "The design" if part.design else "No design"
    return f"{shown} by {part.name}: {limit_words(first)} {rest}".rstrip(". ") + "."
