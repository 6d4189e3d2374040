"""Drawing data on narrow terminals: every row keeps its name, every gear its numbers."""

import pytest
from rated_files import two_stages
from rich.console import Console

import gearopt
from gearopt.report.kinds.drive import drawing_tables, rating_tables
from gearopt.report.measures import METRIC
from gearopt.report.section import Cell
from gearopt.report.terminal import grid


@pytest.fixture(scope="module")
def table():
    result = gearopt.rate(two_stages() | {"drawing": {}})
    return drawing_tables.section(result, METRIC).tables[0]


@pytest.mark.parametrize("width", [60, 80, 100, 110, 160])
def test_no_row_loses_its_name_and_no_gear_its_numbers(table, width):
    console = Console(width=width, file=None)
    with console.capture() as seen:
        console.print(grid(table, width))
    lines = seen.get().splitlines()
    assert max(map(len, lines)) <= width
    words = " ".join(seen.get().split())
    assert all(head in words for head in table.heads)
    for label, *cells in table.rows:
        first = label.split()[0]
        texts = [cell.text.split()[0] for cell in cells if isinstance(cell, Cell) and cell.text]
        rows = [line for line in lines if line.startswith(first)]
        held = " ".join(rows).split()
        assert rows and all(any(text in one for one in held) for text in texts), label


def test_groups_are_as_few_as_there_is_room_for(table):
    """Four gears: in one group from 100 columns on, in two of 80, each alone in 40."""
    for width, groups in ((160, 1), (100, 1), (80, 2), (40, 4)):
        console = Console(width=width, file=None)
        with console.capture() as seen:
            console.print(grid(table, width))
        assert seen.get().count("normal module m_n") == groups


def test_backlash_of_a_rating_is_nominal_beside_that_of_its_drawing():
    """Gears without allowances at their reference distance have none."""
    for drawn, ending in (({"drawing": {}}, ", nominal"), ({}, "")):
        section = rating_tables.forces(gearopt.rate(two_stages() | drawn), METRIC)
        rows = {row[0]: row[1:] for row in section.tables[0].rows}
        for name in ("circumferential backlash j_wt", "normal backlash j_bn"):
            assert [cell.value for cell in rows[f"{name}{ending} [mm]"]] == pytest.approx([0, 0])
        assert any("without the allowances of the drawing" in w for w in section.words) is bool(
            ending
        )
