"""The train of a servo axis: chosen, given, beside other trains and other numbers of stages."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.servo.servo_design import (
    GOALS,
    MOTIONS,
    OBJECTIVES,
    Goal,
    ListedTrain,
    RatioDesign,
    ServoDesign,
    ServoReport,
    Teeth,
    TrainDesign,
    train_figures,
)
from gearopt.optimise.result import Result
from gearopt.optimise.typed import untyped
from gearopt.report.design_tables import stage_table
from gearopt.report.drawing import train_views
from gearopt.report.kinds.servo.words import (
    aged,
    degrees,
    design_of,
    error_limit,
    limit_line,
    report_of,
    teeth_words,
)
from gearopt.report.measures import Measures
from gearopt.report.plots import TEXT, Figure, axis, layout, points
from gearopt.report.section import Section, Table, cell
from gearopt.report.words import amount, heading, parted

BARE_TRAINS = (
    "For comparison, trains of the same total ratio by number of stages, without any other limit: "
    "equal pinions, all gears solid discs of one face width. Inertia at the motor and mass are "
    "multiples of one pinion's."
)
COMPARED_GOALS = (*MOTIONS.values(), *(GOALS[name] for name in OBJECTIVES))  # the duty first
MAXIMISED = GOALS["inverse_acceleration"]  # whose value is maximised
IN_RATIO_TABLE = ("ratio", "inertia_kg_m2")  # of a train: in the table of motor and load, too
TORQUE_TIE = 1e-9  # relative: torques that are equal
STAGE_KEYS = ("normal_module_mm", "pinion_teeth", "wheel_teeth")
MARKS_OF_BEST = {  # symbol and colour of the best by a goal
    "inertia": ("diamond", "--series-4"),
    "mass": ("square", "--series-3"),
    "error": ("triangle-up", "--series-5"),
    **{goal.label: ("diamond", "--series-4") for goal in MOTIONS.values()},
}


def section(result: Result, measures: Measures) -> Section | None:
    """Show the train's tables, drawn in one line where no box is asked for; None without one."""
    design = design_of(result)
    train = design.train
    if train is None:
        return None
    plain = untyped(train)
    stages = plain.pop("stages")
    totals = []
    for key, value in plain.items():
        totals.append([heading(key, measures), cell(value, parted(key)[1], measures)])
    words = [_sector(train.sector)] if train.sector < 1.0 else []
    carried = _carried(train, measures)
    words += carried
    if train.error_deg is not None:
        words.append(
            f"The error is the worst case of backlash and pitch at the output{aged(design)}."
        )
    if train.inertia_kg_m2 is not None:
        words.append("Inertia is referred to the motor shaft.")
    drawn = train_views.views(stages, measures) if design.box is None else ()
    if drawn:
        words.append(
            "All shafts are drawn in one plane, wheels as full discs; reference circles are "
            f"dash-dotted. Dimensions in {measures.lengths}."
        )
    side_by_side = replace(stage_table(stages, measures, page_only=()), short={"": "train"})
    compared = [row[0] for row in _given_rows(design, report_of(result), measures)]
    compared += [heading(key, measures) for key in _moved(design)]
    whole = Table("train", ("", ""), totals, csv_only=compared)
    tables = (side_by_side, replace(whole, folded=len(compared) >= len(totals)))
    half = not drawn
    shown: list[Any] = [*tables, *carried]
    return Section("Train", words=words, drawings=drawn, tables=tables, half=half, terminal=shown)


def _carried(train: TrainDesign, measures: Measures) -> list[str]:
    """Say which torque the teeth carry: that of the motion or output_torque; [] without [duty]."""
    if train.motion_torque_Nm is None:
        return []
    moved = f"In the motion of [duty] the motor puts {_torque(train.motion_torque_Nm, measures)}"
    if train.output_torque_Nm is None:
        return [f"{moved} on the last wheel; the teeth carry this torque."]
    asked = _torque(train.output_torque_Nm, measures)
    through = [
        stage.pinion_torque_Nm * ratio > train.output_torque_Nm * (1.0 + TORQUE_TIE)
        for stage, ratio in zip(train.stages, (train.ratio, train.stages[1].ratio), strict=True)
        if stage.pinion_torque_Nm is not None
    ]
    which = f"output_torque, {asked}, is larger and governs"
    if all(through):
        which = f"this governs, as output_torque, {asked}, is less"
    elif any(through):
        stage = 1 + through.index(True)
        which = f"it governs stage {stage}, and output_torque, {asked}, stage {3 - stage}"
    return [f"{moved} on the last wheel: {which}."]


def _torque(value: float, measures: Measures) -> str:
    return amount(value, "Nm", measures)


def _sector(share: float) -> str:
    return (
        f"The last wheel is a sector of {360.0 * share:.4g}°, {100.0 * share:.4g} % of a full one; "
        "its mass and inertia are those of the sector."
    )


def best(result: Result, measures: Measures) -> Section | None:
    """Show the best train by every goal; None where no trains are listed."""
    chosen = design_of(result).train
    trains = [t for t in report_of(result).trains or () if t.best_of]
    trains = [t for t in trains if chosen is None or _teeth(t.stages) != _teeth(chosen.stages)]
    if not trains:
        return None
    keys = [goal.key for goal in _known(trains[0])]
    heads = ["best", "teeth", *(heading(key, measures) for key in keys)]
    rows = [
        [t.best_of, teeth_words(t.stages, measures)]
        + [cell(getattr(t, key), parted(key)[1], measures) for key in keys]
        for t in trains
    ]
    return Section("Best trains", terminal=(Table("best", heads, rows),))


def _teeth(stages: Sequence[Teeth]) -> list[tuple[Any, ...]]:
    return [tuple(getattr(s, key) for key in STAGE_KEYS) for s in stages]


def compared_with_given(result: Result, measures: Measures) -> Section | None:
    """Show chosen, given and real-valued bound side by side; None where no gears are given."""
    design, report = design_of(result), report_of(result)
    given, rows = report.given_train, _given_rows(design, report, measures)
    if given is None or not rows:
        return None
    teeth = f"Given: {teeth_words(given.stages, measures)}."
    words = [
        teeth,
        "Real-valued bound: no train is better, even with real-valued teeth and modules.",
    ]
    if _moved(design):
        words.append("The inertias of both trains are in the table of the total ratio.")
    heads = ("", "chosen", "given", "real-valued bound")
    table = Table("chosen and given", heads, rows, short={"": "train"}, across=True)
    terminal = (table, teeth)
    return Section("The given train", words=words, tables=(table,), half=True, terminal=terminal)


def _given_rows(design: ServoDesign, report: ServoReport, measures: Measures) -> list[list[Any]]:
    """A row for every figure; none where gears are given without being compared."""
    chosen, given, moved = design.train, report.given_train, _moved(design)
    if chosen is None or given is None or chosen.mass_kg is None:
        return []
    chosen_figures = train_figures(chosen, design.stiffness)
    other = train_figures(given, report.given_stiffness)
    rows = []
    for key in chosen_figures | other:
        bound, unit = report.figures.get(f"real_valued_bound_{key}"), parted(key)[1]
        shown = [cell(v, unit, measures) for v in (chosen_figures.get(key), other.get(key))]
        if key in moved:  # the page has only the bound here
            shown = [replace(figure, text="", short=figure.text) for figure in shown]
        if bound is not None or key not in moved:
            rows.append([heading(key, measures), *shown, cell(bound, unit, measures)])
    return rows


def _moved(design: ServoDesign) -> Sequence[str]:
    """The figures of a train that the table of motor and load shows."""
    return IN_RATIO_TABLE if design.ratio is not None and design.ratio.chosen is not None else ()


def _known(train: ListedTrain) -> list[Goal]:
    """Goals by which a train is known."""
    return [goal for goal in COMPARED_GOALS if getattr(train, goal.key) is not None]


def stage_counts(result: Result, measures: Measures) -> Section | None:
    """Show inertia and mass by number of stages; None without a train."""
    design, report = design_of(result), report_of(result)
    most = max((len(row.ratios_of_least_inertia) for row in report.stage_counts or ()), default=0)
    rows = [
        [
            row.stages,
            row.inertia_in_pinions,
            " x ".join(f"{n:.3f}" for n in row.ratios_of_least_inertia if row.stages > 1),
            row.mass_in_pinions,
            *row.ratios_of_least_inertia,
            *[None] * (most - len(row.ratios_of_least_inertia)),
        ]
        for row in report.stage_counts or ()
    ]
    if not rows:
        return None
    single = [f"ratio {k}" for k in range(1, most + 1)]
    heads = ("stages", "minimum inertia", "at ratios", "minimum mass", *single)
    table = Table("stage counts", heads, rows, csv_only=single, read_only=("at ratios",))
    half = bool(_given_rows(design, report, measures))
    words = (BARE_TRAINS,)
    return Section(
        "Number of stages", words=words, tables=(table,), half=half, terminal=(table, BARE_TRAINS)
    )


def by_inertia(result: Result, measures: Measures) -> Section | None:
    """Plot error over inertia, or over what the duty is judged by; else mass."""
    goals = _weighed(result)
    return _front(result, measures, goals[0], goals[-1]) if goals else None


def by_mass(result: Result, measures: Measures) -> Section | None:
    """Plot error over mass of the trains; None where none are listed."""
    known = GOALS["error"] in _weighed(result)
    return _front(result, measures, GOALS["mass"], GOALS["error"]) if known else None


def _weighed(result: Result) -> list[Goal]:
    """Goals by which the trains are compared; none where no trains are listed."""
    trains = report_of(result).trains
    if not trains:
        return []
    goals = _known(trains[0])
    return goals if not goals[0].motion else [g for g in goals if g.name != "inertia"]


def _front(result: Result, measures: Measures, goal: Goal, other: Goal) -> Section:
    """Plot trains by two goals."""
    design, report = design_of(result), report_of(result)
    trains, ratio = report.trains or (), design.ratio
    key, high = goal.key, other.key
    groups: list[tuple[str, Sequence[ListedTrain], tuple[int, str, str]]] = []
    if rest := [t for t in trains if not t.best_of]:
        groups.append(("other trains", rest, (8, "circle", "--series-1")))
    for name, (symbol, colour) in MARKS_OF_BEST.items():
        if few := [t for t in trains if t.best_of == name]:
            end = "maximum" if name == MAXIMISED.label else "minimum"
            groups.append((f"{end} {name}", few, (12, symbol, colour)))
    for name, train, mark in (
        ("chosen", design.train, (20, "circle-open", "--series-2")),
        ("given", report.given_train, (12, "x", "--series-8")),
    ):
        if train is not None and train.mass_kg is not None:
            groups.append((name, [_listed(train, ratio, name)], mark))
    groups = [g for g in groups if all(getattr(g[1][0], k) is not None for k in (key, high))]
    values = [measures.of(getattr(t, key), parted(key)[1]) for _, some, _ in groups for t in some]
    wide = max(values) > 10.0 * min(values)
    across, up = (axis(_head(it, measures)) for it in (goal, other))
    if wide:
        across |= {"type": "log", "dtick": "D2", "tickformat": "~g"}
    else:
        across["type"] = "linear"
    known = replace(design, allocation=None)  # its own limit, not that of tolerances
    limit = error_limit(known, result.limits) if other.name == "error" else None
    shapes = [] if limit is None else [limit_line("allowed", limit, "x", 1.6)]
    traces = [_points(*group, (key, high), measures) for group in groups]
    figure = Figure(traces, layout(across, up, 400, shapes=shapes), _caption(result, trains, goal))
    tables = (_table(trains, measures),) if goal.name != "mass" else ()
    title = f"{other.label.capitalize()} and {goal.label}"
    return Section(title, figures=(figure,), tables=tables, half=True)


def _listed(train: TrainDesign, ratio: RatioDesign | None, who: str) -> ListedTrain:
    """The chosen or the given train as the list of trains has it."""
    assert train.inertia_kg_m2 is not None and train.mass_kg is not None
    achieved = ratio and (ratio.chosen if who == "chosen" else ratio.given_train)
    judged: dict[str, Any] = (
        {} if ratio is None or achieved is None else {MOTIONS[ratio.duty].key: achieved.value}
    )
    worth = train.inertia_kg_m2, train.mass_kg, train.error_deg
    return ListedTrain(train.stages, train.ratio, "", *worth, **judged)


def _table(trains: Sequence[ListedTrain], measures: Measures) -> Table:
    """All points with their teeth and modules."""
    known = _known(trains[0])
    heads = [_head(goal, measures) for goal in known]
    module = "{} [{}]".format(*measures.module[::2])
    heads += [f"{what} of stage {k}" for k in (1, 2) for what in (module, "z1", "z2")]
    rows = [
        [
            *(measures.of(getattr(t, goal.key), parted(goal.key)[1]) for goal in known),
            *(v for s in t.stages for v in _gears(s, measures)),
            t.best_of,
        ]
        for t in trains
    ]
    return Table("trains", [*heads, "best"], rows, folded=True)


def _gears(stage: Teeth, measures: Measures) -> tuple[float, int, int]:
    return measures.of_module(stage.normal_module_mm), stage.pinion_teeth, stage.wheel_teeth


def _head(goal: Goal, measures: Measures) -> str:
    """The head of a column, or the title of an axis."""
    return f"{goal.title} [{measures.unit(parted(goal.key)[1])}]"


def _caption(result: Result, trains: Sequence[ListedTrain], goal: Goal) -> str:
    """Caption: the points, and whether one dominates another."""
    if goal.name == "mass":  # the second plot, of the same trains
        return "The same trains by mass."
    goals = _weighed(result)
    signs = [-1.0 if g is MAXIMISED else 1.0 for g in goals]
    worth = np.array(
        [[s * getattr(t, g.key) for s, g in zip(signs, goals, strict=True)] for t in trains]
    )
    each, other = worth[:, None], worth[None]
    dominated = ((each <= other).all(axis=-1) & (each != other).any(axis=-1)).any()
    which = f"{len(trains)} of the best trains"
    if not dominated:
        *names, last = (goal.label for goal in goals)
        several = f"{', '.join(names)} and {last}"
        which = f"Pareto front of {len(trains)} trains: none dominates another in {several}"
    return f"{which}; point at one to see its teeth.".capitalize()


def _points(
    name: str,
    trains: Sequence[ListedTrain],
    mark: tuple[int, str, str],
    keys: tuple[str, str],
    measures: Measures,
) -> dict[str, Any]:
    """Trains as points; mark: size, symbol and colour; keys: across and up."""
    size, symbol, colour = mark
    x, y = ([measures.of(getattr(t, k), parted(k)[1]) for t in trains] for k in keys)
    edge = {"width": 2.6 if symbol.endswith("open") else 0}
    marker = {"color": colour, "size": size, "symbol": symbol, "line": edge}
    return points(x, y, name, marker, TEXT, text=[_hover_text(t, measures) for t in trains])


def _hover_text(train: ListedTrain, measures: Measures) -> str:
    """A train in lines: teeth and modules, then what it is worth."""
    lines = teeth_words(train.stages, measures).split("; ")
    for goal in _known(train):
        value, unit = getattr(train, goal.key), parted(goal.key)[1]
        shown = degrees(value) if goal.name == "error" else amount(value, unit, measures)
        lines.append(f"{goal.label} {shown}")
    return "<br>".join(lines)
