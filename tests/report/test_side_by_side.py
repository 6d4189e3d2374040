"""Processes beside the optimum: the same cells in the terminal and on the page."""

import io
from dataclasses import replace
from pathlib import Path

import pytest
from page_reader import Reader
from rich.console import Console

import gearopt
from gearopt.report.answer import summary
from gearopt.report.kinds.drive import processes
from gearopt.report.measures import METRIC
from gearopt.report.pages.result import page
from gearopt.report.section import shown
from gearopt.report.terminal import show
from gearopt.report.words import sentence
from gearopt.scenes.reading import load

PROBLEMS = Path(__file__).parents[2] / "problems"


@pytest.fixture(scope="module")
def three(solved):
    return solved("three_stage_processes")


def read(cell):
    return shown(cell).text


def side_by_side(result):
    """Heads, rows and sentences about missing designs; nothing without processes."""
    found = processes(result, METRIC)
    return (
        ([], [], [])
        if found is None
        else (*vars(found.tables[0]).values(),)[1:3] + (list(found.words[1:]),)
    )


def printed(result, width=80):
    out = io.StringIO()
    show(result, Console(file=out, width=width, force_terminal=False))
    return out.getvalue()


def test_every_design_is_a_column(three):
    heads, rows, missing = side_by_side(three)
    cells = {row[0]: list(map(read, row[1:])) for row in rows}
    assert heads == ["", "exact", "process one", "process two"] and not missing
    assert cells["stage 1: m_n [mm], z1/z2"] == ["1.5, 21/160", "1.5, 27/229", "1.25, 27/237"]
    assert cells["stage 3: a [mm]"] == ["220.68", "251.57", "236.12"]
    assert cells["ratio error [%]"] == ["-0.860", "0.335", "-0.878"]
    assert cells["gear volume [cm³]"] == ["12,715", "20,369", "17,877"]
    assert cells["above the bound [%]"] == ["0", "60.2", "40.6"]  # 20,369/12,715 ...
    assert len(rows) == 3 * 7 + 4 and all(len(row) == len(heads) for row in rows)


def test_terminal_and_page_show_the_same_cells(three):
    table = processes(three, METRIC).tables[0]
    heads, rows = table.on_page
    assert (heads, rows) == table.on_terminal and heads == ["", "process one", "process two"]
    assert len(rows) == 3 * 4 + 4  # the optimum is in the tables of the design
    lines = [" ".join(line.split()) for line in printed(three).splitlines()]
    for row in rows:
        assert " ".join(cell.text for cell in row) in lines
    html = page(three, "gearopt solve x.toml")
    text = [t.strip() for t in Reader(html).text if t.strip()]
    assert "Processes and optimum" in text
    assert {cell.text for row in rows for cell in row} <= set(text)


def test_without_processes_nothing_is_added(solved):
    plain = solved("elevator")
    assert processes(plain, METRIC) is None and side_by_side(plain) == ([], [], [])
    assert "above the bound" not in printed(plain)


def test_a_process_without_a_design_is_a_sentence(three):
    one, two = three.parts[1:]
    none = replace(
        two,
        status="failed",
        objective=two.objective | {"value": None},
        design={},
        message="k_factor[2] is violated by 0.03.",
    )
    heads, _, missing = side_by_side(replace(three, parts=(three.parts[0], one, none)))
    assert heads[1:] == ["exact", "process one"]
    assert missing == ["No design by process two: K-factor of stage 2 exceeds its limit by 3 %."]
    assert missing[0] in printed(replace(three, parts=(one, none)))
    made = replace(none, design=two.design)
    heads, rows, missing = side_by_side(replace(three, parts=(three.parts[0], one, made)))
    assert heads[1:] == ["exact", "process one", "process two"]
    assert rows[0][3] == "1.25, 27/237" and rows[-1][3].value is None
    assert missing == ["The design by process two: K-factor of stage 2 exceeds its limit by 3 %."]


@pytest.mark.parametrize(
    ("message", "words"),
    [
        ("pinion_teeth[1] = 43 is above its bound 40.", "pinion teeth of stage 1: 43, at most 40"),
        ("pinion_teeth[2] = 9 is below its bound 20.", "pinion teeth of stage 2: 9, at least 20"),
        (
            "module[2] = 3.3 is not one of its values.",
            "module of stage 2: 3.3 mm, not one to choose from",
        ),
        ("ratio_low is violated by 0.000466.", "minimum ratio is missed by 0.0466 %"),
        ("ratio_high is violated by 0.02.", "maximum ratio is exceeded by 2 %"),
        (
            "k_factor[3] is violated by 1e-05. pinion 3 has 52.96 mm, 105.13 mm are required",
            "K-factor of stage 3 exceeds its limit by 0.001 %. pinion 3 has 52.96 mm, 105.13 mm "
            "are required",
        ),
        ("stage 1 needs a module of 3.2 mm or more", "stage 1 needs a module of 3.2 mm or more"),
    ],
)
def test_the_limit_that_a_process_violates_is_in_words(three, message, words):
    one, two = three.parts[1:]
    none = replace(two, status="failed", objective=two.objective | {"value": None}, message=message)
    *_, missing = side_by_side(replace(three, parts=(three.parts[0], one, none)))
    assert missing == [f"The design by process two: {words}."]
    alone = replace(none, parts=(), scene="drive", design={})
    assert sentence(words) in summary(alone, METRIC).words


def test_another_objective_has_its_row():
    text = (PROBLEMS / "elevator_processes.toml").read_text(encoding="utf-8")
    aim = '[objective]\nminimise = "sum_of_centre_distances"\n'
    result = gearopt.solve(load.read((text + aim).encode())[1])
    cells = {row[0]: [getattr(c, "value", c) for c in row[1:]] for row in side_by_side(result)[1]}
    centres = [
        sum(s["centre_distance_mm"] for s in one.design["stages"])
        for one in (result, *result.parts[1:])
    ]
    assert cells["sum of centre distances [mm]"] == pytest.approx(centres, rel=1e-12)
    over = [100 * (c / result.bound - 1) for c in centres]
    assert cells["above the bound [%]"] == pytest.approx(over, abs=1e-9)
    assert min(over[1:]) > 1 and "gear volume [cm³]" in cells


def test_gears_of_a_layout_stand_beside_the_processes():
    text = (PROBLEMS / "elevator_processes.toml").read_text(encoding="utf-8")
    result = gearopt.solve(load.read((text + '[layout]\nshaft_stress = "40 MPa"\n').encode())[1])
    heads, rows, _ = side_by_side(result)
    assert heads[1:] == ["exact", "process one", "process two"]
    over = [c.value for c in next(row[1:] for row in rows if row[0] == "above the bound [%]")]
    assert over == pytest.approx([0.0, 50.549, 42.759], abs=1e-3)
