"""Tables of a page and their CSV files; the same in inches."""

import base64
import csv
import io
import math
import re
from dataclasses import dataclass, replace
from typing import Annotated

import layout_cases as cases
import pint
import pytest
from page_reader import Reader
from rich.console import Console

import gearopt
from gearopt.optimise.typed import Shown
from gearopt.report import answer
from gearopt.report.explained import of_influences
from gearopt.report.measures import INCH, METRIC, SYSTEMS
from gearopt.report.pages.result import page, sections, tables
from gearopt.report.section import (
    Table,
    cell,
    names_and_values,
    percent,
    records,
    shown,
    side_by_side,
)
from gearopt.report.terminal import grid, show
from gearopt.report.words import heading, objective, parted

UNITS = {
    "m_per_s": "m/s",
    "Nm": "N*m",
    "mm2": "mm^2",
    "mm3": "mm^3",
    "um": "mm",
    "um_or_uin": "mm",
    "N_per_mm": "newton / millimeter",
    "N_per_mm_um": "MPa",
    "kg_m2": "kg*m^2",
    "Nm_per_rad": "N*m/rad",
    "deg_per_mm": "deg/mm",
    "rad_per_s2": "rad/s^2",
    "sqrt_MPa": "MPa**0.5",
}
INCHES = {
    "in³": "in^3",
    "in²": "in^2",
    "lbf in": "lbf*in",
    "mil": "thou",
    "µin": "microinch",
    "lbf/(in µin)": "lbf/(in*microinch)",
    "oz in²": "oz*in^2",
    "lbf in/rad": "lbf*in/rad",
    "°/in": "deg/in",
    "rad/s²": "rad/s^2",
    "√psi": "psi**0.5",
}


@pytest.fixture(scope="module")
def elevator():
    return gearopt.solve("problems/elevator.toml", top=5, prices=True)


def rows(text):
    return list(csv.reader(io.StringIO(text)))


def test_inch_factors_are_those_of_pint():
    ureg = pint.UnitRegistry()
    for suffix, (sign, factor) in INCH.units.items():
        if suffix in ("percent", "deg", "ms", "Hz", "cycles"):
            continue
        told = ureg.Quantity(1.0, UNITS.get(suffix, suffix)).to(INCHES.get(sign, sign)).magnitude
        assert math.isclose(factor, told, rel_tol=1e-12), suffix


def test_both_systems_know_the_same_units():
    assert set(METRIC.units) == set(INCH.units) and set(SYSTEMS) == {"metric", "inch"}


@pytest.mark.parametrize(
    ("key", "metric", "inch"),
    [
        ("face_width_mm", "face width [mm]", "face width [in]"),
        ("velocity_m_per_s", "velocity [m/s]", "velocity [ft/min]"),
        ("pinion_teeth", "pinion teeth", "pinion teeth"),
        ("mm", "mm", "mm"),
    ],
)
def test_keys_are_read_with_their_units(key, metric, inch):
    assert (heading(key), heading(key, INCH)) == (metric, inch)
    assert parted("gear_volume_mm3") == ("gear_volume", "mm3")


def test_trains_of_other_numbers_of_stages_stand_in_one_list(solved):
    best = solved("elevator")
    stage = best.design["stages"][0]
    listed = [
        {"objective": 1.0 + n, "ratio": 20.0, "stages": [{**stage, "centre_distance_mm": 90.0}] * n}
        for n in (2, 3, 1)
    ]
    several = replace(best, report=best.report | {"trains": listed})
    heads, *trains = rows(tables(several)["best-trains.csv"])
    assert heads[-4].startswith("m_n 3") and [len(train) for train in trains] == [len(heads)] * 3
    assert trains[0][-4:] == [""] * 4 and trains[2][-8:] == [""] * 8 and trains[1][-1] == "90.0"
    assert "best trains" in several.to_html()


@pytest.mark.slow
def test_csv_holds_the_numbers_in_full(elevator):
    found = tables(elevator)
    stages = {row[0]: row[1:] for row in rows(found["stages.csv"])}
    design = elevator.design["stages"]
    assert stages[""] == ["stage 1", "stage 2"]
    assert [float(v) for v in stages["face width b [mm]"]] == [s["face_width_mm"] for s in design]
    used = {row[0]: row[1:] for row in rows(found["limits.csv"])}
    assert float(used["K-factor"][1]) == 100.0 * elevator.limits["k_factor[2]"]
    trains = rows(found["best-trains.csv"])
    assert trains[0][1] == "gear volume [cm³]"
    assert [float(row[1]) for row in trains[1:]] == pytest.approx(
        [t["objective"] / 1e3 for t in elevator.report["trains"]], rel=1e-15
    )
    assert math.isclose(sum(map(float, stages["share of the volume, %"])), 100.0)


def test_csv_of_odd_words_reads_back():
    odd = ['a "quoted", one', "two\nlines", "1=1", "ä³"]
    table = Table("odd, name [mm]", ("x", "y"), [(word, 0.1) for word in odd])
    assert rows(table.csv())[1:] == [[word, "0.1"] for word in odd]
    assert table.stem == "odd-name-mm"
    assert linked(table.link) == table.csv()


def linked(address):
    """The text that a link holds."""
    return base64.b64decode(address.partition("base64,")[2]).decode("utf-8-sig")


def test_what_was_asked_stands_as_in_the_file():
    asked = {"stage": [{"pinion": {"hardness": "335 HB"}, "module": ["2 mm", "8 mm"]}]}
    result = gearopt.Result("drive", "failed", "exact", {"name": "volume"}, asked=asked)
    (table,) = answer.asked(result, METRIC).tables
    shown = [(row[0].value, row[0].text, getattr(row[1], "text", row[1])) for row in table.rows]
    assert shown[0] == ("pinion.hardness", "pinion hardness", "335 HB")
    assert shown[1] == ("module", "module", '["2 mm", "8 mm"]')


def test_no_text_of_a_csv_is_a_formula():
    """A spreadsheet computes what begins so, and `HYPERLINK` sends it away."""
    texts = ('=HYPERLINK("http://x")', "+1+1", "-1+1", "@SUM(1)", "\t=1", "\r=1", " =1", "\uff1d1")
    kept = ("-3.5", "+1e-3", "a=b", -3.5, -1, 1e-300)
    table = Table("odd", ("=x", "y"), [(k, value) for k, value in enumerate((*texts, *kept))])
    heads, *found = csv.reader(io.StringIO(table.csv(), newline=""))
    assert heads == ["'=x", "y"]
    assert [row[1] for row in found] == [*(f"'{text}" for text in texts), *map(str, kept)]


def check_links(result):
    """Every table of the page is linked as a CSV file of its own name."""
    made = [table for section in sections(result) for table in section.tables]
    assert len(tables(result)) == len(made) >= 4
    links = [a for t, a in Reader(page(result, "x")).tags if t == "a"]
    assert len(links) == len(made)
    for link, table in zip(links, made, strict=True):
        assert link["download"] == f"{table.stem}.csv"
        assert linked(link["href"]) == table.csv()


def test_every_table_has_its_csv_and_names_do_not_meet(solved):
    for result in (solved("elevator"), cases.three_stage(), cases.packing()):
        check_links(result)


@pytest.mark.slow
def test_best_trains_and_prices_have_csv_files_of_their_own(elevator):
    check_links(elevator)


def test_inch_tables_are_the_metric_ones_converted(solved):
    metric, inch = tables(solved("elevator")), tables(solved("elevator"), INCH)
    assert set(metric) == set(inch)
    mm = {row[0]: row[1:] for row in rows(metric["stages.csv"])}
    inches = {row[0]: row[1:] for row in rows(inch["stages.csv"])}
    for name in ("face width b", "reference diameter d1", "tip diameter d_a2", "centre distance a"):
        for a, b in zip(mm[f"{name} [mm]"], inches[f"{name} [in]"], strict=True):
            assert math.isclose(float(a), 25.4 * float(b), rel_tol=1e-14)
    pitches = [float(v) for v in inches["diametral pitch P_nd [1/in]"]]
    assert pitches == [12.7, float(f"{25.4 / 3.0:.12g}")] and mm["module m_n [mm]"] == [
        "2.0",
        "3.0",
    ]
    assert math.isclose(float(inches["K-factor [psi]"][0]), 283.755, rel_tol=1e-5)


def test_an_inch_page_names_no_millimetre():
    """What the user wrote stays as it is; nothing else is in mm."""
    asked = {"title": "Gearbox", "duty": {"power": "7.5 kW"}}
    for make in (cases.three_stage, cases.boxed_in, cases.packing):
        html = page(gearopt.Result(**vars(make()) | {"asked": asked}), "x", INCH)
        words = " ".join(Reader(re.sub(r"<script.*?</script>", "", html, flags=re.S)).text)
        left = re.findall(r".{30}\bmm[²³]?\b.{10}", words.replace("\n", " "))
        assert left == []
        for figure in re.findall(r'<script type="application/json">(.*?)</script>', html, re.S):
            assert not re.search(r"\bmm\b", re.sub(r"m_n [\d.]+ mm", "", figure))


def test_units_in_heads_are_no_markup_on_the_terminal():
    console = Console(width=99, record=True, file=io.StringIO())
    show(cases.packing(), console)
    assert "x [mm]" in console.export_text()


LONG = 'mesh[1].wheel_thickness = ["-0.0429 mm", "-0.0184 mm"]'
WAYS = [  # as of remedies
    ["all deviations, by one factor", LONG, '["-0.07 mm", "-0.03 mm"]', 1.628, 1.626],
    ["  and", 'mesh[1].pitch = "0.0184 mm"', "0.03 mm", "", ""],
]


@pytest.mark.parametrize("width", range(60, 160, 10))
def test_what_is_to_be_written_is_never_cut(width):
    heads = ("remedy (any one)", "write in the file", "instead of", "factor", "minimum")
    console = Console(file=io.StringIO(), width=width)
    console.print(grid(Table("remedies", heads, WAYS, words=True, left=3), width))
    lines = console.file.getvalue().splitlines()
    assert max(map(len, lines)) <= width and not any("…" in line for line in lines)
    assert any("all deviations, by" in line for line in lines)  # no column of single letters
    assert (LONG in "\n".join(lines)) == (width >= 90)
    assert "0.0184" in "".join(lines) and len(lines) < 10


def test_drawn_lengths_in_inches():
    shown_ = page(cases.three_stage(), "x", INCH)
    for words in (">16.220<", ">34.381<", ">a1 = 8.340<", ">b1 1.06<"):
        assert words in shown_, words


@pytest.mark.parametrize(
    ("name", "unit", "text"),
    [
        ("peak_to_peak", "mm", "1.2346 µm"),
        ("worst_peak_to_peak", "mm", "1.2346 µm"),
        ("harmonics_at_60", "mm", "1.2346 µm"),
        ("length", "mm", "0.00123 mm"),
        ("rms", "", "0.0012346"),
    ],
)
def test_small_objectives_are_kept_in_mm_and_read_in_micrometres(name, unit, text):
    told = {"name": name, "value": 1.23456e-3, "unit": unit}
    result = gearopt.Result("pair", "feasible", "exact", told)
    assert METRIC.amount(result.value, objective(result)[1]) == text


@pytest.mark.parametrize(
    ("arithmetic", "words"),
    [
        ("double", "double precision"),
        ("rational", "rational numbers"),
        ("teeth rational; loads double", "teeth in rational numbers; loads in double precision"),
        ("intervals in double, widened", "intervals in double precision, widened"),
    ],
)
def test_the_arithmetic_of_a_proof_is_told_in_words(arithmetic, words):
    told = {"method": "exhausted", "arithmetic": arithmetic}
    result = gearopt.Result("x", "optimal", "exact", {"name": "a", "value": 1.0}, proof=told)
    assert f"Arithmetic: {words}." in answer.proven(result, METRIC).words


def test_cells():
    assert shown(True).text == "yes" and shown(None).text == ""
    assert cell(-1e-9, "mm", METRIC).text == "0.00" and cell(3, "", METRIC).text == "3"
    with pytest.raises(TypeError, match="one value"):
        Table("x", ("", ""), [["a", [1, 2]]]).csv()
    used = percent(1.25)
    assert (used.value, used.text, used.share) == (125.0, "125.0", 1.0)
    assert percent(None).text == ""


SAID = {  # a sentence in mm, and in inches as pint has them
    "It reaches 3.2 mm into it.": "It reaches 0.126 in into it.",
    "Steel, 7.85 kg/dm³ (assumed).": "Steel, 0.284 lb/in³ (assumed).",
    "At most 5,782,370.7 mm³ and 25.4 mm.": "At most 352.86191 in³ and 1 in.",
    "Below 120 MPa; 1.5 N m, 10 kg.": "Below 17,405 psi; 13.3 lbf in, 22.0 lb.",
    "A 22 mm2 thing, 3 mmol, m_n2 mm": "A 22 mm2 thing, 3 mmol, m_n2 mm",
}


@pytest.mark.parametrize("text", SAID)
def test_sentences_are_converted(text):
    """5782370.7/25.4^3 = 352.86191, 120 MPa = 17404.5 psi, 1.5 N m = 13.276 lbf in."""
    assert INCH.words(text) == SAID[text] and METRIC.words(text) == text


@dataclass(frozen=True)
class Held:
    """A design of which one table lists lengths, another a share; one field stands in none."""

    width_mm: Annotated[float, Shown("width", "sizes", form=".3f")] = 1.23456
    error_mm: Annotated[float, Shown("error", "sizes", "um")] = 0.0012
    other_mm: float = 2.0
    gap_mm: Annotated[float | None, Shown("gap", "sizes")] = None
    used: Annotated[float, Shown("used, %", "limits", form="share")] = 0.5


def test_a_table_is_the_fields_that_name_it():
    rows = names_and_values(Held(), METRIC, "sizes", values={"error_mm": 0.002})
    assert [(label, cell.text) for label, cell in rows] == [
        *(("width [mm]", "1.235"), ("error [µm]", "2"))
    ]
    ((_, width), *_) = names_and_values(Held(), INCH, "sizes")
    assert width.text == "0.0486" and width.value == pytest.approx(1.23456 / 25.4)
    both = side_by_side([Held(), Held(gap_mm=3.0)], METRIC, "sizes")
    assert [row[0] for row in both] == ["width [mm]", "error [µm]", "gap [mm]"]
    assert [cell.text for cell in both[2][1:]] == ["", "3.00"]
    heads, ((share,),) = records([Held()], METRIC, "limits")
    assert heads == ["used, %"] and (share.text, share.share) == ("50.0", 0.5)


def test_a_field_that_holds_a_module_has_its_unit_like_every_other_length():
    @dataclass(frozen=True)
    class Gear:
        module_mm: Annotated[float, Shown("module m")]
        face_width_mm: Annotated[float, Shown("face width b")]

    ((metric, _), _) = names_and_values(Gear(2.54, 25.4), METRIC)
    ((inch, cell), (width, _)) = names_and_values(Gear(2.54, 25.4), INCH)
    assert metric == "module m [mm]" and inch == "module m [in]" and float(cell.text) == 0.1
    assert width == "face width b [in]"


@pytest.mark.slow
def test_without_a_table_of_sensitivities_its_columns_are_not_explained(elevator):
    """Numbers that change nothing stand in a sentence alone."""
    idle = {"key": "limits.x", "value": "1", "sensitivity": 0.0, "resolved": [0.0, 0.0]}
    idle |= {"step": "", "price": 0.0}
    told = {"influences": [idle], "message": "the time sufficed for 1 of 12", "basis": ""}
    section = of_influences(told, elevator)
    assert section.tables == () and len(section.words) == 2
    assert section.words[1].endswith("limits.x.")
    moved = [idle, idle | {"key": "limits.y", "sensitivity": 1.0, "resolved": [1.0, 1.0]}]
    more = of_influences(told | {"influences": moved}, elevator)
    assert len(more.tables) == 1 and any("d ln / d ln" in words for words in more.words)
