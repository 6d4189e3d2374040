"""A result on the terminal: the design, its limits, and what is proven in words."""

import re
from collections.abc import Mapping
from typing import Any

from rich.console import Console, Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from gearopt.optimise.result import Result
from gearopt.report.terminal import packing
from gearopt.report.terminal.explanation import remedies
from gearopt.report.words import UNITS, VERDICTS, columns, heading, limit_words, number

EXACT = 1e-6  # a gap below it is called optimal, one above it is named

ROWS = {  # of the stage table: what it is called, and the factor to its unit
    "normal_module_mm": ("module m_n [mm]", 1),
    "pinion_teeth": ("teeth z1", 1),
    "wheel_teeth": ("teeth z2", 1),
    "ratio": ("ratio u", 1),
    "face_width_mm": ("face width b [mm]", 1),
    "pinion_diameter_mm": ("diameter d1 [mm]", 1),
    "wheel_diameter_mm": ("diameter d2 [mm]", 1),
    "centre_distance_mm": ("centres a [mm]", 1),
    "pinion_torque_Nm": ("torque T1 [N m]", 1),
    "k_factor_MPa": ("K-factor [MPa]", 1),
    "unit_load_MPa": ("unit load [MPa]", 1),
    "gear_volume_mm3": ("volume [cm³]", 1e-3),
}


def show(result: Result, title: str, console: Console) -> None:
    """Print a result."""
    words, colour = VERDICTS[result.status]
    if result.status == "optimal" and (result.gap or 0.0) > EXACT:
        words = f"proven within {100 * (result.gap or 0.0):.2g} % of the optimum"
    console.print(Text.assemble((title, "bold"), ": ", (words, f"bold {colour}")))
    for block in _blocks(result):
        console.print()
        console.print(block)


def _blocks(result: Result) -> list[RenderableType]:
    blocks: list[RenderableType] = []
    if result.value is not None:
        if result.scene == "packing":
            blocks.append(packing.design(result.design))
        else:
            blocks += [_design(result.design), _limits(result.limits)]
        if trains := result.report.get("trains"):
            blocks.append(_trains(trains, result.objective))
    if "ways_out" in result.report:
        blocks += remedies(result.report["ways_out"])
    blocks.append(Text("\n".join(_proof(result))))
    return blocks


def _design(design: Mapping[str, Any]) -> RenderableType:
    """Stages side by side, then the totals."""
    parts: list[RenderableType] = []
    stages = design.get("stages", [])
    if stages:
        table = columns("", [f"stage {k}" for k in range(1, len(stages) + 1)])
        for key, (label, factor) in ROWS.items():
            values = [s[key] for s in stages]
            table.add_row(Text(label), *[number(v if factor == 1 else factor * v) for v in values])
        parts += [table, ""]
    totals = Table.grid(padding=(0, 2))
    for key, value in design.items():
        if key != "stages":
            totals.add_row(Text(heading(key)), number(value))
    return Group(*parts, totals)


def _limits(limits: Mapping[str, float]) -> RenderableType:
    """Utilisation of every limit in percent, stages side by side."""
    rows: dict[str, dict[int, float]] = {}
    for name, value in limits.items():
        match = re.fullmatch(r"(.*)\[(\d+)\]", name)
        stem, index = (match[1], int(match[2])) if match else (name, 0)
        rows.setdefault(stem, {})[index] = value
    stages = range(1, max((i for r in rows.values() for i in r), default=0) + 1)
    table = columns("limit used, %", [*(f"stage {k}" for k in stages), "drive"])
    for stem, values in rows.items():
        cells = [_percent(values.get(k)) for k in (*stages, 0)]
        table.add_row(limit_words(stem), *cells)
    return table


def _percent(value: float | None) -> Text:
    if value is None:
        return Text("")
    text = f"{100 * value:.1f}"
    return Text(text, style="bold" if value > 0.9995 else "")


def _trains(trains: list[Mapping[str, Any]], objective: Mapping[str, Any]) -> RenderableType:
    unit = UNITS.get(objective.get("unit", ""), objective.get("unit", ""))
    heads = (
        "",
        f"{objective['name'].replace('_', ' ')}\n{unit}",
        "ratio",
        "m_n, z1/z2",
        "centre distances\nmm",
    )
    table = Table(*heads, box=None, header_style="bold", pad_edge=False)
    for k, train in enumerate(trains, 1):
        teeth = "  ".join(
            f"{s['normal_module_mm']:g}, {s['pinion_teeth']}/{s['wheel_teeth']}"
            for s in train["stages"]
        )
        distances = "  ".join(f"{s['centre_distance_mm']:.2f}" for s in train["stages"])
        table.add_row(str(k), number(train["objective"]), f"{train['ratio']:.4f}", teeth, distances)
    return table


def _proof(result: Result) -> list[str]:
    """What is certain, in sentences."""
    lines = []
    name = result.objective["name"].replace("_", " ")
    unit = UNITS.get(result.objective.get("unit", ""), result.objective.get("unit", ""))
    if result.bound is not None and result.gap is not None:
        lines.append(
            f"Bound: no {name} below {number(result.bound)} {unit} is possible; "
            f"gap {100 * result.gap:.3g} %."
        )
    proof = result.proof
    if proof.get("method") == "exhausted" and result.status == "infeasible":
        lines.append(
            "Proof: every choice of teeth and modules was compared or excluded; none "
            "meets all limits."
        )
    elif proof.get("method") == "exhausted":
        lines.append(
            f"Proof: {proof['trains_compared']:,} trains compared, all others excluded by "
            f"lower bounds (nodes opened: {proof['nodes']:,})."
        )
    elif proof.get("method") == "dual" and result.bound is not None:
        lines.append(
            "Proof: the problem is convex in logarithms; the bound is a dual one, computed "
            "from our own derivatives."
        )
    elif "ways_to_share_out" in proof:
        lines.append(packing.proof(proof))
    if result.status == "infeasible" and proof.get("conflict"):
        names = ", ".join(limit_words(n) for n in proof["conflict"])
        least = 100 * proof["least_violation"]
        lines.append(
            f"Proof: whatever the sizes, even with real-valued teeth and modules, one of these "
            f"limits is missed by at least {least:.2g} %: {names}."
        )
    for part in result.parts:
        if part.value is not None and result.value is not None and result.status == "optimal":
            lines.append(
                f"With real-valued teeth and modules: {number(part.value)} {unit} "
                f"(whole teeth and standard modules cost "
                f"{100 * (result.value / part.value - 1):.2f} %)."
            )
    lines += result.report.get("notes", [])
    if result.message and result.status != "infeasible":
        lines.append(result.message[0].upper() + result.message[1:] + ".")
    lines.append(f"{result.method}, {result.evaluations:,} evaluations, {result.seconds:.3g} s.")
    return lines


def rows_table(rows: list[dict[str, Any]]) -> RenderableType:
    """Rows of a bench as a table."""
    heads = [escape(heading(k)) for k in rows[0]]
    table = Table(*heads, box=None, header_style="bold", pad_edge=False)
    for row in rows:
        table.add_row(*["" if v is None else number(v) for v in row.values()])
    return table
