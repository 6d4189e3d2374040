"""The data of gear drawings as tables: each gear a column, each mesh a column."""

from gearopt.formulations.drive.design import drive_design
from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.section import Section, Table, side_by_side
from gearopt.report.words import series_of

WORDS = (
    "For the data block of each drawing: e and i are the ends of the allowances of the tooth "
    "thickness, which the tool cuts deeper, so that the root follows. Span, balls and pins are to "
    "be measured between both ends; the chord lies at the reference circle. Of a ring the "
    "measures grow as its teeth get thinner."
)


def section(result: Result, measures: Measures) -> Section | None:
    """Drawing data of each gear, and backlash of each mesh; None where none were asked for."""
    if not result.design.get("drawing"):
        return None
    data = drive_design(result.design).drawing
    assert data is not None
    rows = side_by_side(data.gears, measures)
    gears = Table("drawing data", ["", *(gear.gear for gear in data.gears)], rows, across=True)
    rows = side_by_side(data.meshes, measures)
    heads = ["", *(mesh.mesh for mesh in data.meshes)]
    meshes = Table("backlash", heads, rows, across=True)
    notes = [f"Unverified: {series_of(data.unverified)}."] if data.unverified else []
    return Section(
        "Drawing data of each gear",
        words=(WORDS,),
        tables=(gears, meshes),
        terminal=(gears, meshes, *notes),
        notes=notes,
    )
