"""The page of a result: drawings, a solid to turn, progress, numbers, and how sure they are."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.answer import opening
from gearopt.report.kinds import pages_of_result
from gearopt.report.measures import METRIC, Measures
from gearopt.report.pages.frame import render
from gearopt.report.pages.title_block import head
from gearopt.report.section import Section, Table
from gearopt.report.words import series_of, title
from gearopt.scenes.reading.toml_writing import short

MARK = "unverified"


def sections(result: Result, measures: Measures = METRIC) -> list[Section]:
    """Sections of a result, in the order of its page."""
    return list(each_section(result, measures))


def each_section(result: Result, measures: Measures) -> Iterator[Section]:
    """Sections of a result, each as soon as it is made."""
    result = Result.from_dict(result.to_dict())  # plain numbers, as a file of it has them
    shown = (section(result, measures) for section in pages_of_result(result).sections)
    return (section for section in shown if section is not None and section.heading)


def page(result: Result, command: str, measures: Measures = METRIC) -> str:
    """One self-contained HTML page; command: what makes it again."""
    return page_of(sections(result, measures), result, command, measures)


def page_of(shown: Sequence[Section], result: Result, command: str, measures: Measures) -> str:
    """The page of a result whose sections are made; command: what makes it again."""
    return render(
        "result.html",
        title(result),
        opening(result, measures),
        {"gearopt": result.gearopt, **result.versions},
        command,
        result.asked,
        plots=any(section.figures for section in shown),
        moves=any(section.animations for section in shown),
        sections=shown,
        left_out=left_out(shown, result.asked),
        source=_source(result),
    )


def left_out(shown: Sequence[Section], asked: Mapping[str, Any]) -> str:
    """What is not printed, how to have it, and what of it is unverified; "" with all."""
    whole = [section for section in shown if section.appendix]
    rest = [section for section in shown if not section.appendix]
    parts = [t for section in rest for t in section.tables if t.appendix and not t.folded]
    names = [section.heading for section in whole]
    names += [f"more on {s.heading}" for s in rest if any(f.appendix for f in s.figures)]
    names += [f"the table of {table.name}" for table in parts]
    if head(asked).get("appendix") is True or not names:
        return ""
    tables = [*parts, *(table for section in whole for table in section.tables if not table.folded)]
    marks = sum(MARK in c.text for table in tables for row in table.on_page[1] for c in row)
    words = [
        f"Not printed: {series_of(names)}. To print all, write appendix = true in the table "
        "[report] of the problem file."
    ]
    if marks:
        are = "is" if marks == 1 else "are"
        words.append(f"{marks} of the values not printed {are} marked {MARK}.")
    said = (text for section in whole for text in (*section.notes, *section.words))
    return " ".join([*words, *(text for text in said if MARK in text.lower())])


def tables(result: Result, measures: Measures = METRIC) -> dict[str, str]:
    """The CSV of every table by the name of its file, such as `stages.csv`."""
    return tables_of(each_section(result, measures))


def tables_of(shown: Iterable[Section]) -> dict[str, str]:
    """The CSV of every table of sections by the name of its file."""
    return {f"{name}.csv": table.csv() for name, table in tables_by_name(shown)}


def tables_by_name(shown: Iterable[Section]) -> Iterator[tuple[str, Table]]:
    """Yield the tables of sections with a name of their own each."""
    taken: set[str] = set()
    for section in shown:
        for table in section.tables:
            names = (f"{table.stem}{k}" for k in ("", *range(2, 1000)))
            name = next(name for name in names if name not in taken)
            taken.add(name)
            yield name, table


def _source(result: Result) -> str | None:
    """The file it is of, and the changes in it."""
    if result.file is None:
        return None
    changes = result.options.get("changes", {})
    edits = [
        f"{key} = {short(value)}" if value is not None else f"no {key}"
        for key, value in changes.items()
    ]
    words = f"File {result.file}, SHA-256 {(result.file_sha256 or '')[:16]}…"
    return ", changed: ".join(filter(None, [words, ", ".join(edits)]))
