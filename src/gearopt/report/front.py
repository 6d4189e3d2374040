"""A Pareto front in words and tables, the same on the terminal and on its page."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.optimise.pareto.front import Front
from gearopt.optimise.pareto.measures import Pick, neighbours
from gearopt.optimise.pareto.objectives import Objective
from gearopt.report.design_tables import OF_TEETH
from gearopt.report.measures import METRIC, Measures, read_in, rounded
from gearopt.report.section import Cell, Table, cell
from gearopt.report.words import (
    MODULE,
    SECONDS,
    goal_words,
    impossible_for,
    number,
    sentence,
    teeth_of,
)

VERDICTS = {
    "complete": ("complete Pareto front, proven", "green"),
    "proven": ("every point proven", "green"),
    "not proven": ("not proven", "yellow"),
    "infeasible": ("impossible, proven", "red"),
    "limit": ("stopped early", "yellow"),
}
PERCENT_DIGITS = (3, 5)  # significant ones of parts in per cent, where they tell designs apart
NAMED = 3  # pieces of a front that are not known, by their places
COARSE_ERROR = 0.1  # of the ranges of the objectives: an error at which a pick is told with care
CHOICES = {  # of stages, beside modules and teeth: head of a column, keys
    "materials": ("pinion_material", "wheel_material"),
    "β [°]": ("helix_angle_deg",),
    "x1/x2": ("pinion_profile_shift", "wheel_profile_shift"),
}
SHIFTED = "x1/x2"  # where these differ, centre distances do not follow from teeth and module
CHOICE_DIGITS = 3
DEFAULTS = {"seconds": SECONDS, "seed": 0}


def title(front: Front) -> str:
    """The name of a front: that of its file or problem, and its objectives."""
    of = front.title or front.file or front.name
    return f"{of}: {' against '.join(words(front, name) for name in front.names)}"


def verdict(front: Front) -> tuple[str, str]:
    """Certainty of a front, and its colour."""
    if not front.points and front.status != "infeasible":
        return "no design found, and no proof that there is none", "yellow"
    words, colour = VERDICTS[front.status]
    scope = front.proof.get("scope")
    if scope and front.status == "infeasible":
        return impossible_for(scope), colour
    return f"{words} ({scope})" if scope else words, colour


def words(front: Front, name: str) -> str:
    """The name of an objective as it is read, with the load in per cent that it is at."""
    name, _, load = name.partition("_at_")
    said = goal_words(name, front.scene)
    return f"{said} at {load.replace('_', '.')} %" if load else said


def decided(front: Front, measures: Measures = METRIC) -> list[str]:
    """Size, ends and certainty of a front, in sentences."""
    sentences = [str(front.proof.get("sentence", ""))]
    count = len(front.points)
    if count:
        ends = "; ".join(
            f"{words(front, objective.name)} {_span(front, k, measures)}"
            for k, objective in enumerate(front.objectives)
        )
        designs = "1 design" if count == 1 else f"{count:,} designs"
        among = "on the Pareto front" if front.whole else "found, none dominated by another of them"
        sentences.insert(0, f"{designs} {among}: {ends}.")
        if not front.whole:
            sentences.append(
                "Parts of the front may be missing; a pick is from these designs alone."
            )
    if front.error is not None:
        part = f"{100.0 * front.error:.2g} % of the ranges of its objectives"
        sentences.append(f"The true front lies within {part} of the line through these points.")
    elif front.epsilon is not None:
        part = f"{100.0 * front.epsilon:.2g} % of the ranges of the objectives"
        sentences.append(
            f"Proven: beside every possible design one of these is worse by at most {part} in each."
        )
    if max(front.error or 0.0, 0.0 if front.error else front.epsilon or 0.0) > COARSE_ERROR:
        sentences.append("A better pick may lie between them.")
    if front.impossible:
        count, proven = len(front.impossible), sum(step.proven for step in front.impossible)
        steps = "1 step was" if count == 1 else f"{count} steps were"
        sentences.append(
            f"{steps} skipped: no design was found within the limits on the objectives there "
            f"({proven} proven impossible)."
        )
    sentences += [_unknown(front, measures), *front.report.get("notes", [])]
    return [one for one in (*sentences, sentence(front.message)) if one]


def _unknown(front: Front, measures: Measures) -> str:
    """Pieces of a front that are not known, by their places; "" where there are none."""
    if not (count := len(front.unknown)):
        return ""
    places = ", ".join(_piece(front, piece, measures) for piece in front.unknown[:NAMED])
    more = f" and {count - NAMED} others" if count > NAMED else ""
    parts = "1 part of the front is" if count == 1 else f"{count} parts of the front are"
    name = words(front, front.names[1])
    return f"{parts} not known, as steps there are not proven: {name} {places}{more}."


def _piece(front: Front, piece: tuple[float | None, float | None], measures: Measures) -> str:
    """Values of the second objective between which a front is not known."""
    low, high = ("" if v is None else amount_of(front, 1, v, measures) for v in piece)
    if low and high:
        return f"{low} to {high}"
    return f"from {low}" if low else f"up to {high}"


def _span(front: Front, k: int, measures: Measures) -> str:
    low, high = ends(front, k, measures)
    return low if low == high else f"{low} to {high}"


def ends(front: Front, k: int, measures: Measures) -> tuple[str, str]:
    """Least and largest value of an objective, with their unit."""
    values = [p.values[k] for p in front.points]
    low, high = (amount_of(front, k, v, measures) for v in (min(values), max(values)))
    return low, high


def picked(front: Front, measures: Measures = METRIC) -> list[str]:
    """Reason of every design that a rule takes, and cost of its neighbours."""
    by_place: dict[int, list[str]] = {}
    for pick in front.picks:
        by_place.setdefault(pick.place, []).append(f"{pick.rule} ({_reason(front, pick)})")
    return [
        f"Design {place + 1}: {'; '.join(reasons)}. {_values(front, place, measures)}."
        f"{_beside(front, place)}"
        for place, reasons in by_place.items()
    ]


def _reason(front: Front, pick: Pick) -> str:
    """Why a rule takes a design, with the objectives in decades and the weights, if any."""
    wide = " and ".join(words(front, name) for name in pick.decades)
    reason = f"{pick.reason}, {wide} in decades" if wide else pick.reason
    weights = zip(front.names, pick.weights, strict=True) if pick.weights else ()
    weighed = ", ".join(f"{words(front, name)} {weight:g}" for name, weight in weights)
    return f"{reason}: {weighed}" if weighed else reason


def _values(front: Front, place: int, measures: Measures) -> str:
    point = front.points[place]
    pairs = zip(front.objectives, point.values, strict=True)
    text = ", ".join(
        f"{words(front, objective.name)} {amount_of(front, k, value, measures)}"
        for k, (objective, value) in enumerate(pairs)
    )
    return text[0].upper() + text[1:]


def _beside(front: Front, place: int) -> str:
    """Gains and losses of the designs next to one, in per cent."""
    import numpy as np

    values = np.array([p.values for p in front.points])
    rows = []
    for other in neighbours(values, place):
        changes = [
            f"{words(front, objective.name)} {_change(after / before - 1.0)}"
            for objective, before, after in zip(
                front.objectives, values[place], values[other], strict=True
            )
            if before
        ]
        rows.append(f"with design {other + 1} instead {_and(changes)}")
    told = "; ".join(rows)
    return f" {told[0].upper()}{told[1:]}." if told else ""


def _and(parts: Sequence[str]) -> str:
    """Parts of a sentence with commas and an "and"."""
    return " and ".join(filter(None, (", ".join(parts[:-1]), *parts[-1:])))


def _change(part: float) -> str:
    """A relative change in per cent, to two digits, with its verb."""
    share = abs(100.0 * part)
    if not share:
        return "stays"
    size = f"{share:.2g}" if share < 99.5 else f"{share:,.0f}"
    return f"{'rises' if part > 0.0 else 'falls'} by {size} %"


def table(front: Front, measures: Measures = METRIC, most: int | None = None) -> Table:
    """The designs with their values, what is picked, and what they are made of.

    most: rows; the picks and the ends are among them.
    """
    kept = chosen(front, most)
    taken = rules(front)
    gears = any(stages_of(p.design) for p in front.points)
    apart = _apart(front, measures)
    values = value_cells(front, [p.values for p in front.points], measures)
    rows = [
        (
            k + 1,
            *values[k],
            ", ".join(taken.get(k, ())),
            *([_gears(front.points[k].design, measures)] if gears else []),
            *(texts[k] for texts in apart.values()),
        )
        for k in kept
    ]
    last = [f"{measures.module[1]}, z1/z2", *apart] if gears else []
    return Table("front", ("", *heads(front, measures), "pick", *last), rows, wrap=10)


def rules(front: Front) -> dict[int, list[str]]:
    """The places that rules pick, each with their names."""
    names: dict[int, list[str]] = {}
    for pick in front.picks:
        names.setdefault(pick.place, []).append(pick.rule)
    return names


def chosen(front: Front, most: int | None) -> list[int]:
    """The places of rows: all, or evenly spread ones with the ends and the picks."""
    count = len(front.points)
    if most is None or count <= most:
        return list(range(count))
    spread = {round(k * (count - 1) / (most - 1)) for k in range(most)}
    return sorted(spread | {pick.place for pick in front.picks})


def digits_of(front: Front, k: int, measures: Measures) -> int:
    """Significant digits of an objective in per cent: more where its designs would look alike."""
    unit, values = unit_of(front.objectives[k]), [p.values[k] for p in front.points]
    few, many = ({rounded(measures.of(v, unit), n) for v in values} for n in PERCENT_DIGITS)
    return PERCENT_DIGITS[len(few) < len(many)]


def value_cells(
    front: Front, rows: Sequence[Sequence[float]], measures: Measures
) -> list[list[Cell]]:
    """Values of all objectives in the units that are shown, a row for every design."""
    columns = []
    for k, objective in enumerate(front.objectives):
        unit, values = unit_of(objective), [row[k] for row in rows]
        cells = [cell(value, unit, measures) for value in values]
        if unit == "percent":
            digits = digits_of(front, k, measures)
            cells = [replace(it, text=rounded(it.value, digits)) for it in cells]
        columns.append(cells)
    return [list(row) for row in zip(*columns, strict=True)]


def amount_of(front: Front, k: int, value: float, measures: Measures) -> str:
    """A value of an objective with its unit, that of its least value, for sentences."""
    if (unit := unit_of(front.objectives[k])) != "percent":
        least = min((p.values[k] for p in front.points), key=abs, default=None)
        return measures.amount(value, unit, beside=least or None)
    return f"{rounded(value, digits_of(front, k, measures))} %"


def unit_of(objective: Objective) -> str:
    """The suffix under which the values of an objective are shown."""
    return read_in(objective.name, objective.unit)


def heads(front: Front, measures: Measures) -> tuple[str, ...]:
    """Heads of the columns of the objectives, with their units."""
    signs = [measures.unit(unit_of(objective)) for objective in front.objectives]
    names = [words(front, name) for name in front.names]
    return tuple(f"{n} [{s}]" if s else n for n, s in zip(names, signs, strict=True))


def stages_of(design: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    """The stages of a drive, or of the train of a servo axis."""
    stages: Sequence[Mapping[str, Any]] = (design.get("train") or design).get("stages", ())
    return stages


def _gears(design: Mapping[str, Any], measures: Measures) -> Cell:
    """Modules and teeth of the stages of a drive."""
    rows = []
    for stage in stages_of(design):
        module = number(measures.of_module(stage[MODULE]))
        rows.append(f"{module}, {teeth_of(stage)}")
    text = "; ".join(rows)
    return Cell(text, text)


def _apart(front: Front, measures: Measures) -> dict[str, list[str]]:
    """Columns that distinguish gears of equal teeth: texts of every design, by head."""
    columns = {}
    for name, keys in CHOICES.items():
        rows = [[_choice(s, keys) for s in stages_of(p.design)] for p in front.points]
        texts = ["; ".join(row) for row in rows]
        if len(set(texts)) > 1 and len({word for row in rows for word in row}) > 1:
            columns[name] = texts
    if SHIFTED in columns:
        distances = [
            "; ".join(measures.number(s["centre_distance_mm"], "mm") for s in stages_of(p.design))
            for p in front.points
        ]
        if len(set(distances)) > 1:
            columns[f"a [{measures.unit('mm')}]"] = distances
    return columns


def _choice(stage: Mapping[str, Any], keys: Sequence[str]) -> str:
    """The values of pinion and wheel; one word where it is that of both."""
    values = [stage.get(key, OF_TEETH[key]) for key in keys]
    if isinstance(values[0], str):
        return "/".join(dict.fromkeys(values))
    return "/".join(rounded(value, CHOICE_DIGITS) for value in values)


def rating_command(front: Front) -> str:
    """The command that rates a design of a front whose file has a rating; "" for others.

    The number is that of the last pick, the compromise.
    """
    if front.scene != "drive" or "rating" not in front.asked or not front.picks:
        return ""
    return f"gearopt rate front.json --design {front.picks[-1].place + 1}"


def command(front: Front, measures: Measures = METRIC, html: str = "") -> str:
    """The command that makes the front again; "" where it is Python's."""
    options = front.options
    if front.file is None or options.get("changes"):
        return ""
    parts = ["gearopt", "pareto", front.file, "--objectives", ",".join(front.names)]
    for name, value in (options.get("most") or {}).items():
        parts += ["--most", f"{name}={value:.12g}"]
    if weights := options.get("weights"):
        parts += ["--weights", ",".join(f"{name}={value:.12g}" for name, value in weights.items())]
    if options.get("seconds") is None:
        parts += ["--seconds", "1e9"]
    for name in ("method", "points", "seconds", "seed"):
        value = options.get(name)
        if value is not None and value != DEFAULTS.get(name):
            parts += [f"--{name}", f"{value:.12g}" if isinstance(value, float) else str(value)]
    if measures is not METRIC:
        parts += ["--units", measures.name]
    return shlex.join([*parts, "--html", html] if html else parts)
