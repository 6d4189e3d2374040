"""Answers as they show themselves in Python: a few lines, a fragment for notebooks, pages, rows.

`optimise.result.shown` asks for the functions here by their names. Pages are imported where one is
made: they take a tenth of a second that a line of text does not need.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from difflib import get_close_matches
from itertools import accumulate
from pathlib import Path
from typing import Any

from rich.text import Text

from gearopt.optimise.comparing.comparison import Comparison
from gearopt.optimise.explaining.explanation import Change, Explanation, Remedies
from gearopt.optimise.pareto.front import Front
from gearopt.optimise.result import Result
from gearopt.report import comparison as comparison_words
from gearopt.report import front
from gearopt.report.answer import WAYS, assumed, decided, warnings_of
from gearopt.report.design_tables import OF_LINES, types
from gearopt.report.explained import STEEP, of_influences
from gearopt.report.kinds import pages_of_result
from gearopt.report.measures import METRIC, SYSTEMS, Measures, gap_percent
from gearopt.report.pages import comparison as comparison_pages
from gearopt.report.pages import front as front_pages
from gearopt.report.pages import result as result_pages
from gearopt.report.pages.frame import templates
from gearopt.report.pages.pdf import printed
from gearopt.report.pages.title_block import paper
from gearopt.report.screen import harmless
from gearopt.report.section import ROWS_ON_TERMINAL, Table
from gearopt.report.words import (
    EXACT,
    MODULE,
    NAMES,
    again,
    amount,
    edit,
    goal,
    leading,
    limit_words,
    number,
    of_problem_file,
    parted,
    teeth_of,
    title,
    verdict,
)
from gearopt.scenes.reading.toml_writing import cut

WIDTH = 90  # characters of a line of numbers
LINE_LENGTH = 900  # of a line of words
MAX_SLOPES = 12  # sensitivities that are listed
MAX_LISTED = 5  # numbers of a design, numbers of a file, or remedies that are listed
Block = str | Text | Table


def lines(result: Result) -> str:
    """Status, value, bound and gap, and what is essential of the design, in a few lines."""
    _, unit, value, bound, side = goal(result)
    rows = [_head(result), decided(result), *warnings_of(result)]
    if bound is not None and (value is None or (result.gap or 0.0) > EXACT):
        gap = "" if result.gap is None else f", gap {gap_percent(result.gap)}"
        rows.append(f"bound {METRIC.amount(bound, unit, WAYS[side], value)}{gap}")
    rows += _design(result)
    if "conflict" in result.proof and result.status == "infeasible":
        pass  # the first line names it
    elif result.status != "optimal" or leading(result):
        proof = result.proof.get("sentence", "") if result.status == "infeasible" else ""
        rows += filter(None, [result.message or proof])
    for remedy in result.report.get("ways_out", {}).get("remedies", ())[:1]:
        rows.append(f"possible with {' and '.join(map(edit, remedy['changes']))}")
    return _joined(rows)


def _joined(rows: Sequence[str]) -> str:
    """The lines of an answer, as a terminal may print them."""
    return "\n  ".join(harmless(cut(row, LINE_LENGTH)) for row in rows)


def _head(result: Result) -> str:
    """Title, value and what is certain of it."""
    name, unit, value, _, _ = goal(result)
    known = value is not None and "achieved" not in result.report
    reached = f"{name} {amount(value, unit)}, " if known else ""
    return f"{title(result)}: {reached}{verdict(result)[0]}"


def _design(result: Result) -> list[str]:
    """A line for every stage of gears, then the first numbers of a design."""
    design, goal = result.design, result.objective.get("name")
    groups = [part for part in design.values() if isinstance(part, Mapping)]
    parts = sorted((design, *groups), key=lambda part: not part.get("stages"))
    stages: list[Any] = parts[0].get("stages", [])
    rows = [
        f"stage {k}: m_n {s[MODULE]:.6g} mm, z {teeth_of(s)}"
        for k, s in enumerate(stages, 1)
        if {MODULE, "pinion_teeth", "wheel_teeth"} <= s.keys()
    ]
    if types(stages) - {"parallel"}:
        parts = [{k: v for k, v in part.items() if k not in OF_LINES} for part in parts]
    values = _own(design) if result.scene is None else []
    values = values or next((words for part in parts if (words := _values(part, goal))), [])
    return [*rows, _fitting(values)] if values else rows


def _fitting(values: Sequence[str]) -> str:
    """As many values as fit into a line, at least one."""
    ends = list(accumulate(len(value) + 2 for value in values))
    fit = max(1, sum(end <= WIDTH for end in ends))
    return ", ".join([*values[:fit], *(["..."] if fit < len(values) else [])])


def _own(design: Mapping[str, Any]) -> list[str]:
    """`width_cm = 3.5` of the variables of a problem of one's own."""
    return [
        f"{key} = {_list(v) if isinstance(v, list) else number(v)}" for key, v in design.items()
    ]


def _list(values: Sequence[Any]) -> str:
    more = ["..."] if len(values) > MAX_LISTED else []
    return f"[{', '.join([*map(number, values[:MAX_LISTED]), *more])}]"


def _values(part: Mapping[str, Any], goal: Any) -> list[str]:
    """`width 76.57 mm` of the single numbers of a part of a design, but for its goal."""
    words = []
    for key, value in part.items():
        name, unit = parted(key)
        if isinstance(value, list) and value and all(isinstance(v, int | float) for v in value):
            words.append(f"{name} {_list(value)} {METRIC.unit(unit)}".rstrip())
        elif isinstance(value, int | float) and name != goal:
            words.append(f"{NAMES.get(name, name)} {amount(value, unit)}")
    return [word.replace("_", " ") for word in words]


def explained_lines(explanation: Explanation) -> str:
    """The answer, the limits that bind and the largest sensitivities, or the remedies."""
    rows = [lines(explanation.result)]
    named = {*explanation.conflict} == {*(explanation.result.proof.get("conflict") or ())}
    if explanation.conflict and not named:
        rows.append(f"in conflict: {_names(explanation, explanation.conflict)}")
    for remedy in explanation.remedies[:MAX_LISTED]:
        rows.append(f"possible with {' and '.join(map(_instead, remedy.changes))}")
    rows += _reached(explanation)
    slopes = {
        i.key: i.sensitivity
        for i in explanation.influences
        if i.sensitivity is not None and abs(i.sensitivity) <= STEEP
    }
    if slopes:
        largest = sorted(slopes, key=lambda key: -abs(slopes[key]))
        words = [f"{key} {slopes[key]:+.4g}" for key in largest[:MAX_SLOPES]]
        more = ["..."] if len(largest) > MAX_SLOPES else []
        rows.append(f"sensitivities, % per %: {', '.join([*words, *more])}")
    if explanation.message not in ("", explanation.result.message):
        rows.append(explanation.message)
    return _joined(rows)


def _instead(change: Change) -> str:
    """A change with what it takes the place of."""
    was = f" instead of {change.was}" if change.was and change.write else ""
    return f"{edit(asdict(change))}{was}"


def _names(explanation: Explanation, limits: Sequence[str]) -> str:
    return ", ".join(limit_words(name, of_problem_file(explanation.result)) for name in limits)


def _reached(explanation: Explanation) -> list[str]:
    names = _names(explanation, explanation.binding)
    return [f"limits reached: {names}"] if names else []


def compared_lines(comparison: Comparison) -> str:
    """The verdict of every method, model by model."""
    rows = [f"{comparison.title}: methods compared"]
    for group in comparison.groups:
        rows.append(comparison_words.reference(group, comparison.scene))
        rows += (f"{row.method}: {comparison_words.verdict(group, row)}" for row in group.rows)
    return _joined(rows)


def fragment(result: Result) -> str:
    """Sections of a result for the terminal, as HTML for a notebook."""
    result = Result.from_dict(result.to_dict())
    sections = (make(result, METRIC) for make in pages_of_result(result).terminal)
    blocks = [block for section in sections if section is not None for block in section.terminal]
    first = [decided(result), *leading(result), *warnings_of(result)]
    return _html(_head(result), [*first, *blocks, *assumed(result, 'report["assumptions"] lists')])


def explained_fragment(explanation: Explanation) -> str:
    """An explanation as HTML for a notebook: sensitivities, or the way out."""
    if explanation.result.value is None:
        return fragment(answered(explanation))
    blocks = [
        *_reached(explanation),
        *of_influences(explanation.prices, explanation.result).terminal,
    ]
    return _html(_head(explanation.result), blocks)


def compared_fragment(comparison: Comparison) -> str:
    """A comparison as HTML for a notebook: verdicts and numbers of every method."""
    blocks: list[Block] = []
    for group in comparison.groups:
        blocks += [comparison_words.reference(group, comparison.scene)]
        blocks += [f"{r.method}: {comparison_words.verdict(group, r)}" for r in group.rows]
        for field, name, budget in comparison_words.kinds(comparison):
            heads = [
                f"{head} {unit}".strip() for head, unit, _ in comparison_words.columns(comparison)
            ]
            samples = ((row.method, getattr(row, field)) for row in group.rows)
            rows = [(m, *comparison_words.cells(comparison, s)) for m, s in samples if s]
            blocks += [f"{name}: {budget}", Table(name, ("method", *heads), rows)] if rows else []
    return _html(f"{comparison.title}: methods compared", blocks)


def front_lines(pareto: Front) -> str:
    """Size and certainty of a Pareto front, and the designs picked."""
    rows = [f"{front.title(pareto)}: {front.verdict(pareto)[0]}"]
    rows += [*front.decided(pareto), *front.picked(pareto)]
    return _joined(rows)


def front_fragment(pareto: Front) -> str:
    """Pareto front as the terminal has it, as HTML for a notebook."""
    pareto = Front.from_dict(pareto.to_dict())
    blocks: list[Block] = [*front.decided(pareto)]
    blocks += [front.table(pareto, METRIC, ROWS_ON_TERMINAL)] if pareto.points else []
    head = f"{front.title(pareto)}: {front.verdict(pareto)[0]}"
    return _html(head, [*blocks, *front.picked(pareto)])


def front_page(pareto: Front, units: str) -> str:
    """The page of a Pareto front."""
    return front_pages.page(pareto, measures=measures_of(units))


def answered(explanation: Explanation) -> Result:
    """The result of an impossible request with the conflict and the remedies in it."""
    result, message = explanation.result, explanation.message
    known = explanation.conflict, explanation.remedies
    proven = result.status == "infeasible" and message != result.message
    if not (any(known) or proven):  # the proof says why, once
        return result
    ways = Remedies(*known, message, explanation.any_resolves, explanation.unsure)
    return replace(result, report=result.report | {"ways_out": ways.told})


def _html(head: str, blocks: Sequence[Block]) -> str:
    """A fragment of a page in the colours of where it stands; all text is escaped."""
    parts: list[Any] = [b if isinstance(b, Table) else str(b) for b in blocks]
    return str(templates().get_template("notebook.html").render(head=head, blocks=parts))


def measures_of(units: str) -> Measures:
    """The system of units of a name; ValueError names those there are."""
    if units not in SYSTEMS:
        raise ValueError(f"units={units!r}: write {' or '.join(map(repr, SYSTEMS))}")
    return SYSTEMS[units]


def whole_page(result: Result, units: str) -> str:
    """The page of a result, as `gearopt report --html` writes it."""
    measures = measures_of(units)
    return result_pages.page(result, again(result, "page.html", measures), measures)


def compared_page(comparison: Comparison) -> str:
    """The page of a comparison."""
    return comparison_pages.page(comparison)


def write_pdf(page: str, path: str | Path, asked: Mapping[str, Any], units: str) -> None:
    """Write a page as PDF; asked: the tables of the file."""
    Path(path).write_bytes(printed(page, paper(asked, measures_of(units))))


def _tables(result: Result, units: str) -> Iterator[tuple[str, Table]]:
    return result_pages.tables_by_name(result_pages.each_section(result, measures_of(units)))


def table_names(result: Result, units: str) -> tuple[str, ...]:
    """Names of the tables of a result, in the order of its page."""
    return tuple(name for name, _ in _tables(result, units))


def table_rows(result: Result, name: str, units: str) -> list[dict[str, Any]]:
    """A table of a result as rows {column: value}; ValueError names the tables there are."""
    known = []
    for stem, table in _tables(result, units):
        if stem == name:
            return table.records
        known.append(stem)
    close = get_close_matches(str(name), known, n=1)
    meant = f" (did you mean {close[0]!r}?)" if close else ""
    raise ValueError(f"no table {name!r}{meant}; tables: {', '.join(known)}")
