"""Sections that every kind of result shows: key figures, limits, the file, progress, proof."""

import re
from collections.abc import Mapping
from typing import Any

from gearopt.optimise.pareto.front import Front
from gearopt.optimise.result import Result
from gearopt.optimise.scale import gap
from gearopt.report.explained import remedy_words
from gearopt.report.headline import RATIO_ENDS, headline, lead
from gearopt.report.kinds import pages_of_result
from gearopt.report.measures import METRIC, Measures, gap_percent
from gearopt.report.plots import TEXT, Figure, axis, layout, lines
from gearopt.report.section import Cell, Section, Table, Tile, percent
from gearopt.report.words import (
    EXACT,
    REACHED,
    RULED,
    amount,
    certainty,
    effort,
    goal,
    grouped,
    leading,
    limit_rows,
    limit_words,
    number,
    objective,
    of_gears_first,
    of_problem_file,
    own_limits,
    sentence,
    series_of,
    violation_words,
)
from gearopt.scenes.reading.toml_writing import toml_text

PARTS = {  # of a result: what their names mean
    "sizing": "real-valued sizes",
    "apart": "gears first, then the box",
    "real-valued": "real-valued teeth",
}
ROWS = (
    *("status", "objective", "value", "bound", "gap, %"),
    *("method", "proof", "evaluations", "seconds"),
)
WAYS = {"below": -1, "above": 1}  # in which a bound is rounded, by the side without designs
SHOWN_ELSEWHERE = ("method", "arithmetic", "sentence")  # of a proof, elsewhere
PROOFS = {  # methods of proofs: what their names mean
    "boxes": "search of boxes",
    "corner": "bound at a corner",
    "dual": "dual bound",
    "exhausted": "exhaustive search",
    "patterns": "search of contact patterns",
    "spatial": "spatial branch and bound",
    "subdivision": "subdivision of the width",
    "volume": "volume of the cylinders",
}
CHECKS = {  # of a certificate: what each number is
    "feasibility": "largest violation of a limit, relative",
    "stationarity": "largest gradient of the Lagrangian, 0 at an optimum, relative",
    "complementarity": "largest product of a Lagrange multiplier and the margin of its limit, "
    "0 at an optimum, relative",
    "scale": "of the objective, which is zero: the gap is relative to it",
}
COUNTED = {  # further keys of a proof in words
    "boxes": "parts of the ranges examined",
    "nodes": "partial designs or ranges examined",
    "pruning_margin": "relative margin of what is excluded",
}
ELSEWHERE = (
    "gearopt",
    "kind",
    "title",
    "source",
    "report",
)  # keys of a file that stand at other places
UNUSED = "unused"  # a limit that is farther away than the size to which it is relative
EARLIEST = 1e-4  # s; the logarithmic axis begins here at the earliest


def decided(result: Result, measures: Measures = METRIC) -> str:
    """The first sentence: what decides the answer, with its figures."""
    kind = pages_of_result(result)
    words = lead(result, kind.binding_limit(result, measures)) + kind.figures(result)
    return sentence(measures.words(words))


def opening(result: Result, measures: Measures = METRIC) -> str:
    """The status and what decides the answer, in one sentence."""
    words = pages_of_result(result).binding_limit(result, measures)
    return measures.words(headline(result, words))


def warnings_of(result: Result, measures: Measures = METRIC) -> list[str]:
    """The sentences to be read before the numbers."""
    return list(map(measures.words, pages_of_result(result).warns(result, measures)))


def summary(result: Result, measures: Measures) -> Section | None:
    """Key figures and what must be known beside; None where there is nothing of both.

    On the terminal, which has no key figures, it ends with what is proven.
    """
    tiles = [*_tiles(result, measures), *pages_of_result(result).tiles(result, measures)]
    words = [*leading(result), *_notes(result)]
    warned = warnings_of(result, measures)
    certain = [*bound_words(result, measures), *proof(result, measures), _effort(result)]
    ends = "\n".join([*certain[:-1], *_notes(result), certain[-1]])
    shown, said = tiles or words or warned, list(map(measures.words, words))
    on_terminal = (measures.words(ends),)
    return Section("Result" if shown else "", tiles, said, terminal=on_terminal, notes=warned)


def _tiles(result: Result, measures: Measures) -> list[Tile]:
    """The objective as a key figure, and its bound where that is another number."""
    name, unit, value, bound, side = goal(result)
    tiles = []
    if value is not None:
        tiles.append(Tile(name, amount(value, unit, measures), certainty(result)[0]))
    if bound is not None and (value is None or (result.gap or 0.0) > EXACT):
        kind = "checked" if "checked" in result.proof else "proven"
        title = f"{kind} bound{scope(result)}"
        text = measures.amount(bound, unit, WAYS[side], value)
        tiles.append(Tile(title, text, gap_words(result)))
    return tiles


def _notes(result: Result) -> list[str]:
    """Notes on this answer, and the message of a run."""
    if result.status == "infeasible":
        return []
    lines = list(result.report.get("notes", []))
    if result.message and not leading(result):
        said = violation_words(result.message) if of_problem_file(result) else result.message
        lines.append(sentence(said))
    return lines


def _effort(result: Result) -> str:
    return effort(result.method, result.evaluations, result.seconds)


def limits(result: Result, measures: Measures) -> Section | None:
    """The utilisation of every limit; None without limits."""
    if not result.limits or (result.value is None and not result.given):
        return None
    stages, rows = limit_rows(own_limits(result), of_problem_file(result))
    heads = [
        "utilisation, %",
        *(f"stage {k}" for k in range(1, stages + 1)),
        pages_of_result(result).whole,
    ]
    cells = [[words, *map(_utilisation, values)] for words, values in rows]
    elsewhere = [limit_words(name) for name in pages_of_result(result).elsewhere(result)]
    table = Table("limits", heads, cells, csv_only=elsewhere)
    sized = next((part.limits for part in result.parts if part.name == "sizing"), {})
    words: tuple[str, ...] = ("At 100 % a limit is active.",)
    if any(used < 0.0 for used in result.limits.values()):
        words += (
            f"{UNUSED.capitalize()}: the limit is farther away than the size to which its "
            "utilisation is relative.",
        )
    if {*RATIO_ENDS} <= {*result.limits}:
        words += (
            "The utilisations of minimum and maximum ratio are relative to the ratio itself, not "
            "to its tolerance.",
        )
    if any(result.limits.get(n, 1.0) < 1.0 - REACHED <= used for n, used in sized.items()):
        words += (
            "Limits that determine the result may stay below 100 %, as teeth and modules come in "
            "steps.",
        )
    rated = "rating" in result.design  # tables of it have safety factors and their utilisation
    return Section(
        "Limits", words=words, tables=(table,), half=True, appendix=rated, terminal=(table,)
    )


def _utilisation(used: float | None) -> Cell:
    """A utilisation in per cent; below zero it is unused."""
    return Cell(100.0 * used, UNUSED, 0.0) if used is not None and used < 0.0 else percent(used)


def proof(result: Result, measures: Measures = METRIC) -> list[str]:
    """Say how it is proven, and what other methods give."""
    return [*_method(result), *pages_of_result(result).sentences_on_parts(result, measures)]


def bound_words(result: Result, measures: Measures) -> list[str]:
    """Say the bound in a sentence; nothing without one, or where it is the value."""
    name, unit, value, bound, side = goal(result)
    if bound is None or result.gap is None or (value is not None and result.gap <= EXACT):
        return []
    known = "Lower" if side == "below" else "Upper"
    text = measures.amount(bound, unit, WAYS[side], value)
    sure = ", checked, not proven" if "checked" in result.proof else ""
    return [f"{known} bound of the {name}{scope(result)}{sure}: {text}; {gap_words(result)}."]


def gap_words(result: Result) -> str:
    """Say the gap, and what it is relative to where that is not the objective's value."""
    if result.gap is None:
        return ""
    of = " of the objective's scale (its value is zero)" if "scale" in result.certificate else ""
    return f"gap {gap_percent(result.gap)}{of}"


def scope(result: Result) -> str:
    """Say of what a bound is true: of all designs, or of the gears that were laid out."""
    return " with these gears" if any(part.name == "gears" for part in result.parts) else ""


def _method(result: Result) -> list[str]:
    """The proof in the method's words, and the limits that are in conflict."""
    known, proof = result.bound is not None or result.status == "infeasible", result.proof
    lines = [proof["sentence"]] if known and "sentence" in proof else []
    if result.status == "infeasible" and proof.get("conflict") and "least_violation" in proof:
        minimum = 100 * proof["least_violation"]
        violation = f"{minimum:.2g}" if minimum < 100 else f"{minimum:,.0f}"
        lines.append(
            "Proof: whatever the design, one of these limits is violated by at least "
            f"{violation} %: {series_of(grouped(proof['conflict'], of_problem_file(result)))}."
        )
        ways = result.report.get("ways_out") or {}
        fewer = {*(ways.get("conflict") or proof["conflict"])} < {*proof["conflict"]}
        if fewer and not ways.get("unsure"):
            lines.append(
                "The limits named in the first sentence are in conflict even if all other limits "
                "are dropped; what else the file gives is kept."
            )
    return lines


def meaning(result: Result) -> str:
    """Meaning of the status of a result, and its limits."""
    bounded, status = result.bound is not None, result.status
    if status == "optimal":
        return (
            f"No feasible design{scope(result)} is better by more than the gap. gearopt computed "
            "the bound itself; it is not taken from a solver."
        )
    if status == "infeasible":
        if of_gears_first(result):
            return (
                f"Proven: no layout of {result.proof['scope']} meets all limits. Other gears were "
                "not tried."
            )
        known = "Checked, not proven" if "checked" in result.proof else "Proven"
        return f"{known}: no design meets all limits."
    if result.given:
        met = "meets all limits" if result.feasible else "does not meet all limits"
        ends = f"; it {met}" if result.limits else ""
        early = "The run ended early. " if status == "limit" else ""
        return f"{early}The given design was evaluated, not optimised{ends}."
    if status == "stationary":
        return (
            "Optimality conditions of first and second order verified numerically: no small change "
            "within the limits improves the design; a better one may exist elsewhere."
        )
    if result.value is None:
        return "No design was found; that is no proof that there is none."
    early = "The run ended early. " if status == "limit" else ""
    sure = ", which is checked, not proven" if "checked" in result.proof else ""
    below = f", but none{scope(result)} is better than the bound{sure}" if bounded else ""
    return f"{early}The design meets all limits; a better one may exist{below}."


def proven(result: Result, measures: Measures) -> Section:
    """Meaning and proof of the status, with the numbers of every part."""
    parts = (result, *result.parts)
    heads = ("", *(PARTS.get(part.name, part.name.replace("_", " ")) for part in parts))
    columns = [_column(part, measures) for part in parts]
    rows = [[n, *row] for n, *row in zip(ROWS, *columns, strict=True) if any(c != "" for c in row)]
    hidden = ("value", "bound")  # key figures, or in the design
    tables = [Table("proof", heads, rows, csv_only=hidden, across=True, appendix=True)]
    if checks := _checks(result):
        tables.append(checks)
    words = [meaning(result), *map(measures.words, proof(result, measures))]
    ways = result.report.get("ways_out") or {}
    words += [measures.words(remedy_words(ways)[1])] if ways.get("remedies") else []
    if arithmetic := result.proof.get("arithmetic"):
        words.append(f"Arithmetic: {_numbers(arithmetic)}.")
    return Section("What is proven, and how", words=words, tables=tables, half=len(parts) < 3)


def _numbers(arithmetic: str) -> str:
    """The arithmetic of a proof in words; JSON has "double" and "rational" in it."""
    words = re.sub(r"(in )?\bdouble\b", "in double precision", arithmetic)
    return re.sub(r"(in )?\brational\b", "in rational numbers", words).removeprefix("in ")


def _column(part: Result, measures: Measures) -> list[Any]:
    """Values of ROWS of a result or one of its parts; "" for those it has not."""
    name, unit = objective(part)
    bound = WAYS["above" if part.maximised else "below"]
    amounts = (_amount(v, unit, measures, way) for v, way in ((part.value, 0), (part.bound, bound)))
    return [
        certainty(part)[0],
        f"{name} [{measures.unit(unit)}]" if unit else name,
        *amounts,
        "" if part.gap is None else Cell(100.0 * part.gap, gap_percent(part.gap).rstrip(" %")),
        part.method,
        "by rules" if part.name in RULED else _proven_by(part),
        part.evaluations,
        Cell(part.seconds, f"{part.seconds:.3g}"),
    ]


def _proven_by(part: Result) -> str:
    """The method of a proof in words."""
    method, comma, early = str(part.proof.get("method", "")).partition(",")
    return f"{PROOFS.get(method, method)}{comma}{early}"


def _amount(value: float | None, unit: str, measures: Measures, way: int) -> Cell | str:
    """A value in the unit that its column names."""
    if value is None:
        return ""
    return Cell(measures.of(value, unit), measures.number(value, unit, way))


def _checks(result: Result) -> Table | None:
    """The certificate, then what else the proof says; its sentence is not said again."""
    rows: list[tuple[str, Any]] = [
        (f"{name}: {CHECKS.get(name, '')}", Cell(value, "" if value is None else f"{value:.2g}"))
        for name, value in result.certificate.items()
    ]
    spoken = []
    for key, value in result.proof.items():
        if key not in SHOWN_ELSEWHERE and not isinstance(value, Mapping | list):
            text = f"{value:.3g}" if isinstance(value, float) else number(value)
            rows.append((COUNTED.get(key, key.replace("_", " ")), Cell(value, text)))
            if text in str(result.proof.get("sentence", "")):
                spoken.append(rows[-1][0])
    if not rows:
        return None
    folded = len(spoken) == len(rows)
    return Table("checks", ("", ""), rows, csv_only=spoken, folded=folded, appendix=True)


def assumed(result: Result, lists: str = "--html and --json list") -> list[str]:
    """Where the assumptions of a result are listed, as one sentence; none where it has none.

    lists: what lists them, of the command or of Python, with its verb.
    """
    count = len(result.report.get("assumptions", ()))
    words = "1 assumption; {} it." if count == 1 else f"{count} assumptions; {{}} them."
    return [words.format(lists)] if count else []


def assumptions(result: Result | Front, measures: Measures) -> Section | None:
    """The assumptions beside the file; None where the kind reports none."""
    words = list(map(measures.words, result.report.get("assumptions") or []))
    return Section("Assumptions and unverified data", words=words, half=True) if words else None


def asked(result: Result, measures: Measures) -> Section | None:
    """The numbers of the file's tables as they were written; None where there was no file."""
    asked = {key: value for key, value in result.asked.items() if key not in ELSEWHERE}
    if not asked:
        return None
    source = result.asked.get("source")
    words = [f"Source: {source}."] if source else []
    single = {key: value or "by default" for key, value in asked.items() if not _is_table(value)}
    tables = [_asked_table(key, value) for key, value in asked.items() if _is_table(value)]
    if single:
        tables.insert(0, _asked_table("", single))
    return Section("Input data", words=words, tables=tables, folded=True)


def _is_table(value: Any) -> bool:
    several = isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)
    return several or (isinstance(value, Mapping) and bool(value))


def _asked_table(key: str, value: Any) -> Table:
    """A table of the file, one column per table where several have one name."""
    several = isinstance(value, list)
    columns = [_flat(column) for column in (value if several else (value,))]
    names = list(dict.fromkeys(name for column in columns for name in column))
    title = key.replace("_", " ")
    heads = [title, *(str(k + 1) for k in range(len(columns)))] if several else [title, ""]
    labels = [Cell(name, re.sub("[_.]", " ", name)) for name in names]
    rows = [[label, *(_ends(column.get(label.value)) for column in columns)] for label in labels]
    return Table(f"asked {key}".strip(), heads, rows)


def _flat(table: Mapping[str, Any]) -> dict[str, Any]:
    """A table with those inside it as keys of its own: `pinion.hardness`."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        inner = _flat(value) if isinstance(value, Mapping) else {"": value}
        flat |= {f"{key}.{name}".rstrip("."): entry for name, entry in inner.items()}
    return flat


def _ends(value: Any) -> Any:
    """A value as the file writes it."""
    if isinstance(value, list | Mapping):
        text = toml_text(value)
        return Cell(text, text)
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return Cell(value, f"{value:.15g}") if number else value


def progress(result: Result, measures: Measures) -> Section | None:
    """Plot the progress of the run; None where it was not recorded."""
    name, unit = objective(result)
    steps = [_converted(s, unit, measures) for s in result.report.get("progress") or []]
    best = [s for s in steps if s.get("best") is not None]
    if not best:
        return None
    bound = [s for s in steps if s.get("bound") is not None]
    end = max(result.seconds, steps[-1]["seconds"])
    times = [max(EARLIEST, s["seconds"]) for s in steps]
    wide = max(times) > 30.0 * min(times)
    sign, large = measures.unit(unit), any(abs(s["best"]) >= 1e5 for s in best)
    traces = [_line("best", best, "--series-1", sign, end)]
    if bound:
        traces.append(_line("bound", bound, "--series-2", sign, end))
    plot = layout(
        axis("wall time [s]", type="log" if wide else "linear"),
        axis(f"{name} [{sign}]" if sign else name, tickformat="," if large else ""),
        340,
    )
    words = "Best value so far" + (" and its bound" if bound else "")
    figure = Figure(traces, plot, f"{words} against wall time.")
    return Section("Progress", figures=(figure,), appendix=True)


def _converted(step: dict[str, Any], unit: str, measures: Measures) -> dict[str, Any]:
    """A step with its best value and bound in the unit that is shown."""
    values = {k: measures.of(step[k], unit) for k in ("best", "bound") if step.get(k) is not None}
    return step | values


def _line(
    key: str, steps: list[dict[str, Any]], colour: str, unit: str, end: float
) -> dict[str, Any]:
    """Steps that hold to the end of the run."""
    last = [*steps, steps[-1] | {"seconds": end}]
    x, y = [max(EARLIEST, s["seconds"]) for s in last], [s[key] for s in last]
    marker = {"color": colour, "size": [6] * len(steps) + [0]}
    text = [_hover(s, key, unit) for s in last]
    trace = lines(x, y, colour, 2.2, shape="hv", hover=TEXT, name=key, text=text)
    return trace | {"mode": "lines+markers", "marker": marker}


def _hover(step: dict[str, Any], key: str, unit: str) -> str:
    words = f"{key} {number(step[key])} {unit} at {step['seconds']:.3g} s"
    words += f", {step['evaluations']:,} evaluations"
    best, bound = step.get("best"), step.get("bound")
    if best and bound is not None:
        words += f"; gap {100.0 * gap(best, bound):.3g} %"
    return words
