"""Proven trains beside each other: error over inertia, and over mass."""

from collections.abc import Mapping
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.plot import Figure, axis, layout
from gearopt.report.section import Section, Table
from gearopt.report.servo_words import degrees, error_limit, teeth_words
from gearopt.report.words import amount

GOALS = {  # of a train: its key and unit, what it is called
    "acceleration": ("load_acceleration_rad_per_s2", "rad_per_s2", "load acceleration"),
    "move time": ("move_time_s", "s", "move time"),
    "rms torque": ("rms_torque_Nm", "Nm", "rms torque"),
    "inertia": ("inertia_kg_m2", "kg_m2", "inertia at the motor"),
    "mass": ("mass_kg", "kg", "mass of the gears"),
    "error": ("error_deg", "deg", "error at the output"),
}
STAGE = ("normal_module_mm", "pinion_teeth", "wheel_teeth")
BEST = {  # symbol and colour of the best by a goal
    "inertia": ("diamond", "--series-4"),
    "mass": ("square", "--series-3"),
    "error": ("triangle-up", "--series-5"),
    **dict.fromkeys(("acceleration", "move time", "rms torque"), ("diamond", "--series-4")),
}


def by_inertia(result: Result, measures: Measures) -> Section | None:
    """Error over inertia, or over what the duty is judged by; without an error mass over it."""
    found = _weighed(result)
    return _section(result, measures, found[0], found[-1]) if found else None


def by_mass(result: Result, measures: Measures) -> Section | None:
    """Error over mass of the trains; None where none are told."""
    found = _weighed(result)
    return _section(result, measures, "mass", "error") if "error" in found else None


def _weighed(result: Result) -> list[str]:
    """What the trains are held against each other by; nothing where none are told."""
    found = result.report.get("trains") or []
    if not found:
        return []
    goals = [goal for goal, (key, _, _) in GOALS.items() if key in found[0]]
    return goals if goals[0] == "inertia" else [g for g in goals if g != "inertia"]


def _section(result: Result, measures: Measures, goal: str, other: str) -> Section:
    found = result.report["trains"]
    key, unit, name = GOALS[goal]
    high, high_unit, upwards = GOALS[other]
    pair = goal, other
    rest = [t for t in found if not t["best_of"]]
    traces = (
        [_points("other trains", rest, pair, measures, 8, "circle", "--series-1")] if rest else []
    )
    for best, (symbol, colour) in BEST.items():
        if few := [t for t in found if t["best_of"] == best]:
            most = "largest" if best == "acceleration" else "least"
            traces.append(_points(f"{most} {best}", few, pair, measures, 12, symbol, colour))
    if chosen := _with_duty(result, "chosen", result.design.get("train")):
        traces.append(_points("chosen", [chosen], pair, measures, 20, "circle-open", "--series-2"))
    given = _with_duty(result, "given_train", result.report.get("given_train"))
    if key in given and high in given:
        traces.append(_points("given", [given], pair, measures, 12, "x", "--series-8"))
    limit = error_limit({"train": chosen} if chosen else {}, result.limits)
    values = [measures.of(t[key], unit) for t in (*found, chosen, given) if key in t]
    wide = max(values) > 10.0 * min(values)
    across = axis(f"{name} [{measures.unit(unit)}]", type="log" if wide else "linear")
    if wide:
        across |= {"dtick": "D2", "tickformat": "~g"}
    up = axis(f"{upwards} [{measures.unit(high_unit)}]")
    shapes = [_level(limit)] if limit is not None and other == "error" else []
    figure = Figure(traces, layout(across, up, 400, shapes=shapes), _caption(result))
    tables = (_table(found, measures),) if goal != "mass" else ()
    heading = f"{other.capitalize()} and {goal}"
    return Section(heading, figures=(figure,), tables=tables, half=True)


def _with_duty(result: Result, who: str, train: Mapping[str, Any] | None) -> Mapping[str, Any]:
    """A train with what it gives its duty, as the list of trains has it."""
    duty = result.design.get("ratio") or {}
    own, names = duty.get(who), {words: key for key, _, words in GOALS.values()}
    found = dict(train or {})
    if found and own:
        found[names[duty["name"]]] = own["value"]
    return found


def _table(trains: list[Mapping[str, Any]], measures: Measures) -> Table:
    """All points with their teeth and modules."""
    known = [one for one in GOALS.values() if one[0] in trains[0]]
    heads = [f"{name} [{measures.unit(unit)}]" for _, unit, name in known]
    heads += [f"{what} of stage {k}" for k in (1, 2) for what in ("module [mm]", "z1", "z2")]
    rows = [
        [
            *(measures.of(t[key], unit) for key, unit, _ in known),
            *(s[k] for s in t["stages"] for k in STAGE),
            t["best_of"],
        ]
        for t in trains
    ]
    return Table("trains", [*heads, "best"], rows, folded=True)


def _caption(result: Result) -> str:
    """What the points are."""
    goals, trains = _weighed(result), result.report["trains"]
    signs = [-1.0 if goal == "acceleration" else 1.0 for goal in goals]
    worth = [
        tuple(sign * t[GOALS[goal][0]] for goal, sign in zip(goals, signs, strict=True))
        for t in trains
    ]
    beaten = any(
        a != b and all(x <= y for x, y in zip(a, b, strict=True)) for a in worth for b in worth
    )
    which = f"{len(trains)} of the best trains"
    if not beaten:
        names = f"{', '.join(goals[:-1])} and {goals[-1]}"
        which = f"{len(trains)} trains, none better than another in {names} at once"
    return f"{which}; the pointer tells their teeth.".capitalize()


def _points(
    name: str,
    trains: list[Mapping[str, Any]],
    goals: tuple[str, str],
    measures: Measures,
    size: int,
    symbol: str,
    colour: str,
) -> dict[str, Any]:
    (key, unit, _), (high, high_unit, _) = (GOALS[goal] for goal in goals)
    edge = {"width": 2.6} if symbol.endswith("open") else {"width": 0}
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": [measures.of(t[key], unit) for t in trains],
        "y": [measures.of(t[high], high_unit) for t in trains],
        "text": [_told(t, measures) for t in trains],
        "hovertemplate": "%{text}<extra></extra>",
        "marker": {"color": colour, "size": size, "symbol": symbol, "line": edge},
    }


def _told(train: Mapping[str, Any], measures: Measures) -> str:
    """A train in lines: teeth and modules, then what it is worth."""
    lines = teeth_words(train["stages"]).split("; ")
    worth = [
        f"{goal} {amount(train[key], unit, measures)}"
        for goal, (key, unit, _) in GOALS.items()
        if key in train and goal != "error"
    ]
    error = [f"error {degrees(train['error_deg'])}"] if "error_deg" in train else []
    return "<br>".join([*lines, *worth, *error])


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
