"""Proven trains beside each other: error over inertia, and over mass."""

from collections.abc import Mapping
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.frame import Figure, axis, layout
from gearopt.report.pages.section import Section
from gearopt.report.pages.table import Table
from gearopt.report.servo_words import degrees, error_limit, teeth_words
from gearopt.report.words import amount, number

GOALS = {  # of a train: its key and unit, what it is called
    "inertia": ("inertia_kg_m2", "kg_m2", "inertia at the motor"),
    "mass": ("mass_kg", "kg", "mass of the gears"),
    "error": ("error_deg", "deg", "error at the output"),
}
STAGE = ("normal_module_mm", "pinion_teeth", "wheel_teeth")
BEST = {  # symbol and colour of the best by a goal
    "inertia": ("diamond", "--series-4"),
    "mass": ("square", "--series-3"),
    "error": ("triangle-up", "--series-5"),
}


def by_inertia(result: Result, measures: Measures) -> Section | None:
    """Error over inertia of the trains; None where none are told."""
    return _section(result, measures, "inertia")


def by_mass(result: Result, measures: Measures) -> Section | None:
    """Error over mass of the trains; None where none are told."""
    return _section(result, measures, "mass")


def _section(result: Result, measures: Measures, goal: str) -> Section | None:
    found = result.report.get("trains") or []
    if result.scene != "servo" or not found:
        return None
    key, unit, name = GOALS[goal]
    rest = [t for t in found if not t["best_of"]]
    traces = (
        [_points("other trains", rest, goal, measures, 8, "circle", "--series-1")] if rest else []
    )
    for best, (symbol, colour) in BEST.items():
        if few := [t for t in found if t["best_of"] == best]:
            traces.append(_points(f"least {best}", few, goal, measures, 12, symbol, colour))
    if chosen := result.design.get("train"):
        traces.append(_points("chosen", [chosen], goal, measures, 20, "circle-open", "--series-2"))
    given = result.report.get("given_train") or {}
    if key in given:
        traces.append(_points("given", [given], goal, measures, 12, "x", "--series-8"))
    limit = error_limit({"train": chosen} if chosen else {}, result.limits)
    values = [measures.of(t[key], unit) for t in (*found, *(t for t in (chosen, given) if t))]
    wide = max(values) > 10.0 * min(values)
    across = axis(f"{name} [{measures.unit(unit)}]", type="log" if wide else "linear")
    if wide:
        across |= {"dtick": "D2", "tickformat": "~g"}
    up = axis("error at the output [°]")
    shapes = [] if limit is None else [_level(limit)]
    figure = Figure(traces, layout(across, up, 400, shapes=shapes), _caption(found))
    tables = (_table(found, measures),) if goal == "inertia" else ()
    return Section(f"Error and {goal}", figures=(figure,), tables=tables, half=True)


def _table(trains: list[Mapping[str, Any]], measures: Measures) -> Table:
    """All points with their teeth and modules."""
    heads = [f"{name} [{measures.unit(unit)}]" for _, unit, name in GOALS.values()]
    heads += [f"{what} of stage {k}" for k in (1, 2) for what in ("module [mm]", "z1", "z2")]
    rows = [
        [
            *(measures.of(t[key], unit) for key, unit, _ in GOALS.values()),
            *(s[k] for s in t["stages"] for k in STAGE),
            t["best_of"],
        ]
        for t in trains
    ]
    return Table("trains", [*heads, "least"], rows, folded=True)


def _caption(trains: list[Mapping[str, Any]]) -> str:
    """What the points are."""
    worth = [tuple(t[key] for key, _, _ in GOALS.values()) for t in trains]
    beaten = any(
        a != b and all(x <= y for x, y in zip(a, b, strict=True)) for a in worth for b in worth
    )
    which = f"{len(trains)} of the best trains"
    if not beaten:
        which = f"{len(trains)} trains, none better than another in inertia, mass and error at once"
    return f"{which}; the pointer tells their teeth.".capitalize()


def _points(
    name: str,
    trains: list[Mapping[str, Any]],
    goal: str,
    measures: Measures,
    size: int,
    symbol: str,
    colour: str,
) -> dict[str, Any]:
    key, unit, _ = GOALS[goal]
    edge = {"width": 2.6} if symbol.endswith("open") else {"width": 0}
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": [measures.of(t[key], unit) for t in trains],
        "y": [t["error_deg"] for t in trains],
        "text": [_told(t, measures) for t in trains],
        "hovertemplate": "%{text}<extra></extra>",
        "marker": {"color": colour, "size": size, "symbol": symbol, "line": edge},
    }


def _told(train: Mapping[str, Any], measures: Measures) -> str:
    """A train in lines: teeth and modules, then what it is worth."""
    inertia = amount(train["inertia_kg_m2"], "kg_m2", measures)
    mass = amount(train["mass_kg"], "kg", measures)
    lines = teeth_words(train["stages"]).split("; ")
    return "<br>".join(
        [*lines, f"inertia {inertia}", f"mass {mass}", f"error {number(train['error_deg'])}°"]
    )


def _level(limit: float) -> dict[str, Any]:
    """The error allowed as a line across the plot."""
    line = {"color": "--warn", "width": 1.6, "dash": "dash"}
    return {
        "type": "line",
        "name": f"allowed {degrees(limit)}",
        "showlegend": True,
        "xref": "paper",
        "x0": 0,
        "x1": 1,
        "y0": limit,
        "y1": limit,
        "line": line,
    }
