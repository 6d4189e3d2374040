"""What makes the train soft: shares of meshes and shafts in the compliance at the output."""

from collections.abc import Mapping
from html import escape
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.plot import Figure, axis, layout
from gearopt.report.section import Section, Table, Tile, percent
from gearopt.report.servo_words import arc_minutes, degrees
from gearopt.report.words import amount, number

ROW, REST = 44.0, 70.0  # px of a spring, and of the axis


def section(result: Result, measures: Measures) -> Section | None:
    """Springs in series, the softest first; None where the file asks for no stiffness."""
    found = result.design.get("stiffness")
    if not found:
        return None
    tiles = [
        Tile("stiffness at the output", amount(found["output_Nm_per_rad"], "Nm_per_rad", measures))
    ]
    if found.get("frequency_Hz") is not None:
        frequency = f"{number(float(found['frequency_Hz']))} Hz"
        tiles.append(Tile("lowest frequency", frequency, "motor locked"))
    if found.get("windup_deg") is not None:
        angle = found["windup_deg"]
        tiles.append(Tile("wind-up", degrees(angle), arc_minutes(angle)))
    springs = sorted(found["springs"], key=lambda s: s["compliance_share"])
    shares = [100.0 * s["compliance_share"] for s in springs]
    trace = {
        "type": "bar",
        "orientation": "h",
        "y": [escape(s["name"]) for s in springs],
        "x": shares,
        "text": [f"{share:.1f} %" for share in shares],
        "textposition": "outside",
        "cliponaxis": False,
        "customdata": [
            f"{escape(s['name'])}: {share:.2f} %, alone "
            f"{amount(s['referred_Nm_per_rad'], 'Nm_per_rad', measures)} at the output"
            for s, share in zip(springs, shares, strict=True)
        ],
        "hovertemplate": "%{customdata}<extra></extra>",
        "marker": {"color": "--series-1"},
    }
    plot = layout(
        axis("share of the compliance [%]", range=[0.0, 1.18 * max(shares)]),
        axis("", ticks=""),
        round(REST + ROW * len(springs)),
        bargap=0.35,
        showlegend=False,
    )
    caption = "Share of every spring in the compliance seen at the output, the softest at the top."
    figures, tables = (Figure([trace], plot, caption),), (_table(springs, measures),)
    half = "drawn" in result.design
    return Section("Stiffness", tiles, figures=figures, tables=tables, half=half)


def _table(springs: list[Mapping[str, Any]], measures: Measures) -> Table:
    """The springs, the softest first."""
    heads = ["spring", "share, %", f"alone at the output [{measures.unit('Nm_per_rad')}]"]
    rows = [
        [
            s["name"],
            percent(s["compliance_share"]),
            measures.of(s["referred_Nm_per_rad"], "Nm_per_rad"),
        ]
        for s in reversed(springs)
    ]
    return Table("springs", heads, rows)
