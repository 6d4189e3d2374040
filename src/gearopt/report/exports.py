"""Files for other programs, of what pages show: drawings as DXF, bodies as STEP, tables as CSV."""

from collections.abc import Callable, Iterable

from gearopt.formulations.drive.design import drive_design
from gearopt.optimise.result import Result
from gearopt.report.drawing.dxf import dxf
from gearopt.report.drawing.gear_sections import sections
from gearopt.report.drawing.placed import parts
from gearopt.report.drawing.sheet import Drawing
from gearopt.report.drawing.step import step
from gearopt.report.kinds import Export, MakeSection
from gearopt.report.measures import METRIC
from gearopt.report.section import Table


def drawn(*pages: MakeSection, also: Callable[[Result], Iterable[Drawing]]) -> Export:
    """The way to the DXF of a result: what is drawn for CAD alone, and drawings of its page."""

    def export(result: Result) -> bytes:
        shown = (page(result, METRIC) for page in pages)
        return dxf((*also(result), *(d for it in shown if it is not None for d in it.drawings)))

    return export


def gears(result: Result) -> Iterable[Drawing]:
    """Sections of the gears and meshes of a drive or a pair."""
    return sections(drive_design(result.design), METRIC)


def solids(result: Result) -> bytes:
    """The STEP of the gears of a drive or a pair, with shafts and bearings of a layout."""
    return step(parts(result))


def listed(*pages: MakeSection, lacking: str, ending: str = "") -> Export:
    """The way to the CSV of tables of a page; several each below its name, an empty line between.

    lacking: what a result without such tables is told. ending: of the names of those wanted.
    """

    def export(result: Result) -> bytes:
        shown = [page(result, METRIC) for page in pages]
        tables = {
            table.name: table
            for it in shown
            if it is not None
            for table in (*it.tables, *it.terminal)
            if isinstance(table, Table) and table.name.endswith(ending)
        }
        if not tables:
            raise ValueError(lacking)
        texts = [table.csv() for table in tables.values()]
        if len(texts) > 1:
            texts = [f"{name}\r\n{text}" for name, text in zip(tables, texts, strict=True)]
        return "\r\n".join(texts).encode()

    return export
