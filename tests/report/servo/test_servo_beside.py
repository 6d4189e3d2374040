"""The given train beside the chosen one, stages and tables, of problems/servo_gimbal.toml."""

import csv
import io
from dataclasses import replace

import pytest
from rich.console import Console

import gearopt
from gearopt.formulations.servo.servo_design import (
    BoxDesign,
    ListedTrain,
    ServoDesign,
    ServoReport,
)
from gearopt.optimise.typed import untyped
from gearopt.report.answer import bound_words
from gearopt.report.kinds import servo
from gearopt.report.kinds.servo.housing import box
from gearopt.report.measures import METRIC
from gearopt.report.pages.result import page, sections, tables
from gearopt.report.terminal import show


@pytest.fixture(scope="module")
def result(solved):
    return solved("servo_gimbal")


@pytest.fixture(scope="module")
def found(result):
    return {s.heading: s for s in sections(result)}


@pytest.fixture(scope="module")
def html(result):
    return page(result, "x")


def read(text):
    return list(csv.reader(io.StringIO(text)))


@pytest.mark.slow
def test_given_gears_stand_beside_the_chosen_and_the_bound(found):
    """7.578e-7 kg m2, 191.4 g, 0.10819 degrees, 210.1 Hz against 5.142e-7, 167.7, 0.10813."""
    section = found["The given train"]
    rows = {row[0]: [c.value for c in row[1:]] for row in section.tables[0].rows}
    assert rows["inertia [g cm²]"] == pytest.approx([5.142, 7.578, 4.884], abs=6e-4)
    shown = {row[0]: [c.text for c in row[1:]] for row in section.tables[0].rows}
    assert shown["inertia [g cm²]"] == ["", "", "4.8838"]  # the others are with the total ratio
    assert rows["mass [kg]"] == pytest.approx([0.1677, 0.1914, 0.16577], abs=6e-5)
    assert rows["error [°]"][:2] == pytest.approx([0.10813, 0.10819], abs=6e-6)
    assert rows["frequency [Hz]"][1] == pytest.approx(210.1, abs=0.06)
    assert rows["frequency [Hz]"][2] is None
    assert section.words[0] == "Given: 16/96, m_n 0.5 mm; 26/208, m_n 0.5 mm."


def test_numbers_of_stages(found):
    """J/J_p of 48:1 by k stages, with the ratios of two."""
    rows = found["Number of stages"].tables[0].rows
    inertia = [26.0211, 9.1018, 6.6698, 6.0584, 5.8851]
    assert [row[1] for row in rows][1:] == pytest.approx(inertia, abs=6e-5)
    assert rows[1][2] == "4.082 x 11.760"


def test_the_best_ratio_with_the_train_is_a_column(found):
    table = found["Total ratio"].tables[0]
    column = [head.replace("\n", " ") for head in table.heads].index("best ratio, same inertia")
    rows = {row[0]: row[column].value for row in table.rows if row[column] is not None}
    assert rows["total ratio"] == pytest.approx(56.437, abs=6e-4)
    assert rows["load acceleration [rad/s²]"] == pytest.approx(45.686, abs=6e-4)
    assert rows["inertia of the train [g cm²]"] == pytest.approx(5.1419, abs=6e-5)


@pytest.mark.parametrize(
    ("heading", "x"), [("Error and inertia", 7.5775), ("Error and mass", 0.19141)]
)
def test_the_given_train_is_a_marker(found, heading, x):
    drawn = {t["name"]: t for t in found[heading].figures[0].data}
    assert drawn["given"]["x"] == [pytest.approx(x, rel=1e-4)]
    assert drawn["given"]["y"] == [pytest.approx(0.10819, abs=6e-6)]
    assert "16/96" in drawn["given"]["text"][0]


def test_every_plot_has_its_csv(result):
    texts = tables(result)
    errors, trains, curve, bars = (
        read(texts[f"{name}.csv"])
        for name in ("errors", "trains", "ratio-curve", "monte-carlo-errors")
    )
    assert len(errors) == 15
    assert sum(float(row[4]) for row in errors[1:]) == pytest.approx(0.10813, abs=6e-6)
    assert len(trains) == 1 + len(result.report["trains"])
    assert all(len(row) == len(trains[0]) for row in trains)
    assert max(float(row[1]) for row in curve[1:]) == pytest.approx(47.287374, abs=1e-6)
    assert sum(int(row[2]) for row in bars[1:]) == 400_000


def test_a_table_behind_a_plot_is_a_link_only(html):
    assert 'download="errors.csv"' in html and ">of the sum, %</th>" not in html


def test_the_terminal_tells_them_too(result):
    console = Console(width=99, record=True, file=io.StringIO())
    show(result, console)
    shown = console.export_text()
    for phrase in ("real-valued bound", "4.8838", "Given: 16/96", "4.082 x 11.760", "56.437"):
        assert phrase in shown, phrase
    assert max(map(len, shown.splitlines())) <= 99


def test_without_given_gears_there_is_no_such_section(result):
    bare = {k: v for k, v in result.report.items() if not k.startswith(("given", "stage_c"))}
    headings = {s.heading for s in sections(replace(result, report=bare))}
    assert not headings & {"The given train", "Number of stages"}


def test_an_acceleration_is_told_as_one(solved):
    """47.287 rad/s2 is the most; its inverse is what is minimised."""
    result = solved("servo_gimbal_ratio")
    assert result.objective["name"] == "inverse_acceleration"
    near = replace(result, gap=0.02, status="feasible")
    assert bound_words(near, METRIC)[0].startswith("Upper bound of the acceleration: 47.288 rad/s²")
    tiles = {t.name: t.value for t in sections(near)[0].tiles}
    assert (tiles["acceleration"], tiles["proven bound"]) == ("47.287 rad/s²", "47.288 rad/s²")
    assert [t.name for t in sections(result)[0].tiles] == ["acceleration", "best total ratio"]
    move = solved("servo_gimbal_move")
    assert "Lower bound of the move time: 1.196" in bound_words(replace(move, gap=0.1), METRIC)[0]


def test_on_paper_tiles_stay_with_what_follows(html):
    """Stiffness was cut between its tiles and its chart."""
    paper = html.split("@media print")
    tiles = [rule for part in paper for rule in part.split("\n") if rule.startswith("  .tiles {")]
    assert any("break-inside: avoid; break-after: avoid;" in rule for rule in tiles)
    assert any(".card > figure { zoom: 0.8; }" in part for part in paper)  # two plots on a sheet


def boxed(best_s=0.2, **more):
    """A train of 0.21 s in a box that it meets exactly; best_s: that of the best without a box."""
    told = {"needed_width_mm": 120.0 * (1.0 + 1e-9), "fits": True} | more
    room = BoxDesign(
        inner_width_mm=120.0,
        inner_height_mm=200.0,
        needed_height_mm=199.7,
        motor_angle_deg=45.0,
        output_angle_deg=97.0,
        radii_mm=(30.0, 40.0, 60.0),
        motor_mm=30.0,
        shaft_mm=7.5,
        links_mm=(46.0, 70.0),
        hub_mm=12.5,
        half_sweep_deg=180.0,
        **told,
    )
    best = ListedTrain((), 40.0, "move time", 1e-5, 2.0, move_time_s=best_s)
    goal = {"name": "move_time", "value": 0.21, "unit": "s"}
    design, report = untyped(ServoDesign(box=room)), ServoReport(trains=(best,)).to_dict()
    return gearopt.Result("servo", "optimal", "exact", goal, design=design, report=report)


def test_a_train_that_fits_is_not_called_too_large():
    said = box(boxed(), METRIC).words[0]
    assert (
        said == "The train fits: it needs 120.00 x 199.70 mm, the box is 120.00 x 200.00 mm inside."
    )
    large = box(boxed(needed_width_mm=121.0, fits=False), METRIC).words[0]
    assert "does not fit" in large and large.endswith("Too large by 1.00 mm in width.")


def test_the_first_sentence_names_a_box_that_costs_something():
    assert (
        servo.binding_limit(boxed())
        == "the box determines the move time: without it there is a better train"
    )
    assert servo.binding_limit(boxed(best_s=0.21)) == ""
    assert servo.binding_limit(replace(boxed(), status="feasible")) == ""
