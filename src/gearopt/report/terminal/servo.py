"""A servo train on the terminal: ratio, train, errors, tolerances, stiffness and box."""

from collections.abc import Callable, Mapping
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from gearopt.optimise.result import Result
from gearopt.report.measures import METRIC, Measures
from gearopt.report.pages.design_tables import stage_table
from gearopt.report.servo_achieved import achieved_table, best_words, note, train_words
from gearopt.report.servo_beside import (
    BARE,
    COUNTS,
    WHOSE,
    beside_rows,
    count_rows,
    given_teeth,
)
from gearopt.report.servo_words import (
    ARCMIN,
    STAGE_ROWS,
    WORTH,
    box_words,
    cost_words,
    degrees,
    drawn_words,
    error_limit,
    error_words,
    kind_words,
    stage_of,
    stiffness_words,
    teeth_words,
)
from gearopt.report.terminal.table import columns
from gearopt.report.words import heading, number, parted

Found = Mapping[str, Any]


def design(result: Result, measures: Measures = METRIC) -> list[RenderableType]:
    """A block for every table of the design."""
    found = result.design
    blocks: list[RenderableType] = []
    if ratio := found.get("ratio"):
        blocks += _ratio(ratio, result.report, measures)
    if train := found.get("train"):
        blocks.append(_train(train, measures))
    if best := [t for t in result.report.get("trains") or [] if t["best_of"]]:
        blocks.append(_best(best, measures))
    blocks += _beside(result.report, measures)
    if errors := found.get("errors"):
        blocks.append(_errors(errors, error_limit(found, result.limits), measures))
    if rows := found.get("tolerances"):
        blocks.append(_tolerances(rows, found.get("allocation"), measures))
    if drawn := found.get("drawn"):
        blocks.append(Text("\n".join(drawn_words(drawn))))
    if chain := found.get("stiffness"):
        blocks.append(_stiffness(chain, measures))
    if box := found.get("box"):
        blocks.append(_box(box, measures))
    return blocks


def _ratio(ratio: Found, report: Found, measures: Measures) -> list[RenderableType]:
    """The best ratio and what the trains achieve, in words and side by side."""
    words = best_words(ratio, measures) + train_words(report, ratio, measures)
    blocks: list[RenderableType] = [Text("\n".join(words))]
    heads, rows = achieved_table(ratio, measures)
    if rows:
        table = columns("\nmotor and load", heads[1:])
        for name, *values in rows:
            table.add_row(Text(name), *map(_share if name.endswith("[%]") else _number, values))
        blocks.append(Group(table, "", Text(note(ratio))))
    return blocks


def _share(value: Any) -> str:
    return "" if value is None else f"{value:.3g}"


def _number(value: Any) -> str:
    return "" if value is None else number(float(value))


def _train(train: Found, measures: Measures) -> RenderableType:
    """Stages side by side, then the totals."""
    stages = train["stages"]
    table = columns("train", [f"stage {k}" for k in range(1, len(stages) + 1)])
    for label, *values in stage_table(stages, measures, STAGE_ROWS, ()).rows:
        table.add_row(Text(label), *map(number, values))
    totals = Table.grid(padding=(0, 2))
    for key, value in train.items():
        if key != "stages" and value is not None:
            unit = parted(key)[1]
            shown = measures.of(value, unit) if unit else value
            totals.add_row(Text(heading(key, measures)), number(shown))
    return Group(table, "", totals)


def _best(trains: list[Found], measures: Measures) -> RenderableType:
    """The best train by every goal."""
    goals = {key: unit for key, unit in WORTH.items() if key in trains[0]}
    table = columns("best", ["teeth", *(heading(key, measures) for key in goals)])
    for train in trains:
        values = [number(float(measures.of(train[key], unit))) for key, unit in goals.items()]
        name = train["best_of"].replace("_", " ")
        table.add_row(Text(name), teeth_words(train["stages"]), *values)
    return table


def _beside(report: Found, measures: Measures) -> list[RenderableType]:
    """The given gears beside the chosen ones, and other numbers of stages."""
    blocks: list[RenderableType] = []
    if rows := beside_rows(report, measures):
        table = columns("train", list(WHOSE.values()))
        for name, *values in rows:
            table.add_row(Text(name), *("" if v is None else number(v) for v in values))
        blocks.append(Group(table, "", Text(given_teeth(report))))
    if counts := count_rows(report):
        first, *heads = COUNTS
        table = columns(first, heads)
        for row in counts:
            table.add_row(*map(number, row))
        blocks.append(Group(table, "", Text(BARE)))
    return blocks


def _errors(errors: list[Found], limit: float | None, measures: Measures) -> RenderableType:
    """Every source with its share, then the sum."""
    total = sum(e["error_deg"] for e in errors)
    unit = measures.unit("um")
    table = columns("error at the output", ["kind", "where", f"tolerance [{unit}]", "°", "'", "%"])
    for e in errors:
        size = e.get("tolerance_mm")
        tolerance = "" if size is None else f"{measures.of(size, 'um'):.2f}"
        place = stage_of(e["stage"])
        table.add_row(Text(e["source"]), kind_words(e["kind"]), place, tolerance, *_angle(e, total))
    table.add_row(Text("sum"), "", "", "", *_angle({"error_deg": total}, total))
    return Group(table, "", Text("\n".join(error_words(errors, limit))))


def _angle(one: Found, total: float) -> tuple[str, str, str]:
    """In degrees, minutes of arc and per cent of the sum."""
    error = one["error_deg"]
    share = 100.0 * error / total if total else 0.0
    return f"{error:.5f}", f"{ARCMIN * error:.3f}", f"{share:.1f}"


def _tolerances(rows: list[Found], cost: Found | None, measures: Measures) -> RenderableType:
    """Old and new tolerances and costs, then the sums."""
    unit = measures.unit("um")
    table = columns("tolerance", [f"old [{unit}]", f"new [{unit}]", "new/old", "cost", "new cost"])

    def add(name: str, told: Callable[[str], float]) -> None:
        old, new = (measures.of(told(key), "um") for key in ("old_mm", "new_mm"))
        prices = (f"{told(key):.3f}" for key in ("old_cost", "new_cost"))
        table.add_row(Text(name), f"{old:.2f}", f"{new:.2f}", f"{new / old:.3f}", *prices)

    for row in rows:
        add(row["name"], row.__getitem__)
    add("sum", lambda key: sum(row[key] for row in rows))
    return Group(table, "", Text("\n".join(cost_words(cost)))) if cost else table


def _stiffness(chain: Found, measures: Measures) -> RenderableType:
    """Springs, the softest first, then what they make together."""
    head = f"alone [{measures.unit('Nm_per_rad')}]"
    table = columns("spring", ["share of compliance, %", head])
    for one in sorted(chain["springs"], key=lambda s: -s["compliance_share"]):
        alone = measures.of(one["referred_Nm_per_rad"], "Nm_per_rad")
        table.add_row(Text(one["name"]), f"{100 * one['compliance_share']:.1f}", number(alone))
    return Group(table, "", Text(stiffness_words(chain, measures)))


def _box(box: Found, measures: Measures) -> RenderableType:
    """Whether it fits, and the angles of both links."""
    style = "" if box["fits"] else "yellow"
    angles = ", ".join(
        f"{words} {degrees(box[key])}"
        for words, key in (
            ("from the output shaft to wheel 1", "output_angle_deg"),
            ("from wheel 1 to the motor", "motor_angle_deg"),
        )
    )
    words = Text(f"Angles of the lines of centres, from the width: {angles}.")
    return Group(Text(box_words(box, measures), style=style), words)
