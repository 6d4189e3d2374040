"""What is shown of a rating: first sentence, key figures, tables, both systems of units."""

import csv
import io
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
import rating_cases as cases
from campaigns import few
from page_reader import Reader, on_screen, without_input
from rated_files import two_stages
from read_numbers import repeated
from rich.console import Console

import gearopt
from gearopt.report.answer import opening
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages import result as pages
from gearopt.report.terminal import show

BOOK = {  # Shigley, example 14-4: pinion and wheel, as printed
    "bending stress s_t [psi]": (6417.0, 4854.0),
    "S_F": (5.62, 6.82),
    "contact stress s_c [psi]": (70360.0, 70660.0),
    "S_H": (1.69, 1.52),
}
FILES = [
    path
    for path in sorted((Path(__file__).parents[3] / "problems").glob("*.toml"))
    if {"[rating]", 'kind = "drive"'}
    <= set((words := path.read_text(encoding="utf-8")).split("\n"))
    and "[limits]" not in words
]
AGAIN = {  # a title names its standard, 1 % of cycles has their digits, C_p of AGMA is Z_E of ISO
    "iso_tr_6336_30": {"6336": "6 times outside tables"},
    "wind_pair": {"6336": "4 times outside tables"},
    "wind_planetary_stage": {"6336": "3 times outside tables"},
    "shigley_14_4_by_908": {"908": "2 times outside tables"},
    "shigley_14_5_by_908": {"908": "2 times outside tables"},
    "two_stages_rated": {"2646": "in 2 tables"},
    "pair_by_both": {"6336": "in 2 tables", "18981": "in 2 tables"},
}
RATED = (cases.shigley, cases.unsafe, cases.train)
page, sections, tables = map(cases.once, (pages.page, pages.sections, pages.tables))


@cases.once
def told(result, measures=METRIC, width=80):
    out = io.StringIO()
    show(result, Console(file=out, width=width), measures)
    return out.getvalue()


def rows(result, name, measures=METRIC):
    """A table of CSV by the first cell of each row."""
    found = csv.reader(io.StringIO(tables(result, measures)[f"{name}.csv"]))
    return {row[0]: row[1:] for row in found}


def text(html):
    return " ".join(" ".join(Reader(on_screen(html)).text).split())


@pytest.mark.parametrize("key", BOOK)
def test_the_page_has_the_numbers_of_the_book(key):
    """Its intermediate results are rounded to three digits."""
    shown = rows(cases.shigley(), "gears", INCH)[key]
    assert [float(v) for v in shown] == pytest.approx(BOOK[key], rel=2e-3)


def test_factors_are_those_of_the_book():
    """K_v 1.377, K_s 1.043 and 1.052, K_m 1.22, Y_N 0.977 and 0.996, Z_N 0.948 and 0.973."""
    found = rows(cases.shigley(), "factors", INCH)
    book = {"K_v": 1.377, "K_m": 1.22, "C_p": 2300.0, "I": 0.121, "K_R": 0.85}
    for symbol, value in book.items():
        factor, _, pinion, wheel, *_ = found[symbol]
        assert factor and float(pinion) == float(wheel) == pytest.approx(value, rel=1e-3)
    both = {"K_s": (1.043, 1.052), "Y_N": (0.977, 0.996), "Z_N": (0.948, 0.973)}
    for symbol, values in both.items():
        assert [float(v) for v in found[symbol][2:4]] == pytest.approx(values, rel=1e-3)
    assert found["s_at"][1] == "psi" and found["s_at"][5] != "given" == found["I"][5]


def test_the_words_of_a_rating_name_sources_and_what_governs():
    book, own = cases.shigley().design["rating"], cases.train().design["rating"]
    assert book["standard"].endswith("(2101), I and J of the file")
    assert own["standard"].endswith("(2101), geometry factors of AGMA 908-B89")
    shown = text(page(cases.train(), ""))
    assert "stage 1, contact (S_H) of the wheel; stage 2, " in shown
    assert "losses are neglected" not in shown.lower()
    narrow = {'face_width = "40 mm"': 'face_width = "8 mm"'}
    few = cases.rated(cases.TRAIN, narrow)
    teeth = next(s for s in sections(few) if s.heading == "Teeth")
    span = next(row for row in teeth.tables[0].rows if row[0].startswith("span W_k"))
    assert [cell.text for cell in span[1:]].count("–") == 1
    assert teeth.words[-1].startswith("–: a span cannot be measured")
    names = {f["symbol"]: f["name"] for f in cases.iso().design["rating"]["factors"]}
    assert names["C_a"] == "tip relief"  # that of the file
    worn = cases.rated(cases.ISO, {'tip_relief = "70 um"\n': ""}).design["rating"]["factors"]
    assert "tip relief by running-in, C_ay" in {f["name"] for f in worn}


def test_safe_or_not_is_said_first():
    said = (
        "Safe: all required safety factors are met; contact of the wheel governs.",
        "Not safe: 4 safety factors fall short, contact of the wheel most.",
        "Not safe: contact of the wheel of stage 1 falls short.",
    )
    assert tuple(opening(make()) for make in RATED) == said
    for make, words in zip(RATED, said, strict=True):
        html = page(make(), "")
        assert html.index(words) < html.index("<main>") and "What is proven" not in html


def test_the_terminal_begins_with_what_governs():
    """Power that is carried grows with the square of S_H: 4 hp 1.523^2 = 9.28 hp."""
    first, second, third, *_ = told(cases.shigley(), INCH).splitlines()
    assert first == "Shigley, example 14-4: safe"
    assert f"{second.rstrip()} {third}" == (
        "All required safety factors are met; contact of the wheel governs: S_H 1.522, 1 required; "
        "power capacity 9.277 hp, 4.000 hp required."
    )
    first, *lines = told(cases.train()).splitlines()
    assert first.endswith("load spectrum: not safe")
    assert "S_H 0.9692, 1.1 required" in lines[0] and "30 kW required" in lines[1]


@pytest.mark.parametrize("make", [*RATED, cases.sized])
@pytest.mark.parametrize("measures", [METRIC, INCH], ids=lambda m: m.name)
def test_the_terminal_is_80_columns_wide(make, measures):
    lines = [line.rstrip() for line in told(make(), measures).splitlines()]
    wide = [line.rstrip() for line in told(make(), measures, 300).splitlines()]
    shown = [line for line in wide if re.search(r" {2}", line)]  # rows of tables
    assert max(map(len, lines)) <= 80 and shown and set(shown) <= set(lines)


def test_the_terminal_has_every_factor_and_what_is_given_or_unverified():
    single, several = told(cases.shigley()), told(cases.train())
    for symbol in rows(cases.train(), "factors"):
        assert symbol == "symbol" or re.search(rf"^{symbol} ", single, re.M)
        assert symbol == "symbol" or re.search(rf"^{symbol} ", several, re.M)
    assert re.search(r"^J +geometry factor, bending +0\.3 +0\.4 +given$", single, re.M)
    assert re.search(r"^I .*unverified$", several, re.M) and "unverified" not in single.lower()
    assert "F_t 732.94 N" in single and "F_t 164.77 lbf" in told(cases.shigley(), INCH)


def test_the_terminal_says_where_factors_leave_their_range():
    (file,) = (path for path in FILES if path.stem == "catalogue_pair")
    hot = gearopt.rate(file, {"rating.temperature": "130 degC", "duty.input_speed": "30000 rpm"})
    words = " ".join(told(hot).split())
    assert "K_T: above 120 °C the standard has no value." in words
    assert "K_v: beyond the curve, which ends at " in words
    assert re.search(r"Efficiency of the meshes: [\d.]+ ± [\d.]+ %, unverified\.", words)


@pytest.mark.parametrize("make", RATED, ids=lambda f: f.__name__)
@pytest.mark.parametrize("measures", [METRIC, INCH], ids=lambda m: m.name)
def test_no_number_stands_twice(make, measures):
    assert repeated(page(make(), "gearopt rate x.toml", measures)) == {}


@pytest.mark.parametrize("file", few(FILES, FILES[::3]), ids=lambda p: p.stem)
def test_pages_of_the_files_that_are_rated(file):
    """Their tables have names of their own, one value a cell."""
    result = gearopt.rate(file)
    html = page(result, "gearopt rate x.toml")
    assert repeated(html) == AGAIN.get(file.stem, {})
    assert max(map(len, told(result).splitlines())) <= 80
    assert not {"None", "nan", "inf"} & set(text(html).split())
    assert {"gears", "meshes", "shafts", "teeth", "stages"} <= set(result.tables)
    assert any(name.startswith("factors") for name in result.tables)


def test_sources_are_said_once_where_stages_share_them():
    found = rows(cases.train(), "factors")
    assert found["s_at"][-2].count("table 4") == 1 and "stage" not in found["s_at"][-2]
    own = {'face_width = "70 mm"': 'face_width = "70 mm"\n[stage.given]\nK_m = 1.5'}
    mixed = rows(cases.rated(cases.TRAIN, own), "factors")["K_m"][-2]
    assert mixed == "stage 1: 2001-D04, 15; stage 2: given"


def test_key_figures_name_gear_capacity_and_life():
    tiles = {t.name: (t.value, t.remark) for t in sections(cases.train())[0].tiles}
    gears = {row[0]: row[1:] for row in zip(*_table(cases.train(), "gears"), strict=True)}
    least = min(range(4), key=lambda k: float(_column(gears, "S_F")[k]))
    assert list(gears)[1 + least] == "wheel 1"
    assert tiles["minimum S_F, bending"][1] == "wheel of stage 1; 1.2 required"
    assert tiles["power capacity"][1] == "30 kW required"
    assert tiles["life at S = 1"][1] == "wheel of stage 1; 20,000 h required"
    assert tiles["efficiency"][0].endswith(" %")
    beyond = {t.name: (t.value, t.remark) for t in sections(cases.shigley())[0].tiles}
    life, words = beyond["life at S = 1"]
    assert life == f"over {int(1e10 / 60 / 1800):,} h" and "efficiency" not in beyond
    assert words.startswith("pinion, beyond 1e10 cycles; ")
    assert {t.name: t.value for t in sections(cases.unsafe(), INCH)[0].tiles}[
        "power capacity"
    ].endswith(" hp")


def _table(result, name):
    return list(csv.reader(io.StringIO(tables(result)[f"{name}.csv"])))


def _column(columns, label):
    at = columns[""].index(label)
    return [values[at] for name, values in columns.items() if name]


def test_safety_factors_are_never_rounded_up():
    from gearopt.report.kinds.drive.rating_words import beside, safety

    assert beside(1.02853 - 1e-9, 1.02853, "1.02853") == "1.02853"  # met, and not 1.028 beside it
    assert [beside(v, 339.292, "339.3") for v in (339.292, 339.28)] == ["339.3", "339.2"]
    assert [safety(v) for v in (1.1999, 1.2, 1.2 - 1e-12, 0.99999, 15.28)] == [
        *("1.199", "1.2", "1.2", "0.9999", "15.28")
    ]


@pytest.mark.parametrize("make", RATED, ids=lambda f: f.__name__)
def test_a_safety_factor_and_a_capacity_are_written_in_one_way(make):
    """In sentences, key figures and tables, of terminal and page."""
    from gearopt.report.kinds.drive.rating_words import safety

    result = make()
    rating = result.design["rating"]
    factors = {safety(g[f"{m}_safety"]) for g in rating["gears"] for m in ("bending", "contact")}
    capacities = {safety(m["power_capacity_kW"]) for m in rating["meshes"]}
    for shown in (told(result), text(page(result, ""))):
        found = set(re.findall(r"S_[FH] (\d+(?:\.\d+)?)(?![\d.]| required)", shown))
        assert found and found <= factors
        assert set(re.findall(r"capacity (?:\[kW\] )?(\d[\d.,]*\d)", shown)) <= capacities
    for section in sections(result):
        assert {t.value for t in section.tiles if t.name.startswith("minimum S_")} <= factors


def test_contact_ratios_are_of_the_tip_circles_and_what_undercut_leaves_is_beside():
    """eps_gamma = eps_alpha + eps_beta; 12 teeth of 20 degrees lose some of their flanks."""
    plain, cut = (
        cases.shigley(),
        cases.rated(cases.SHIGLEY, {"pinion_teeth = 17": "pinion_teeth = 12"}),
    )
    for result in (plain, cut, cases.train()):
        for mesh in result.design["rating"]["meshes"]:
            whole, left = mesh["transverse_contact_ratio"], mesh.get("usable_contact_ratio")
            assert mesh["total_contact_ratio"] == whole + mesh["overlap_ratio"]
            assert (left is None) is (result is not cut) and (left or 0.0) < whole
    left = cut.design["rating"]["meshes"][0]["usable_contact_ratio"]
    assert f"(undercut leaves {left:.5g} of" in " ".join(told(cut).split())


@pytest.mark.parametrize("measures", [METRIC, INCH], ids=lambda m: m.name)
def test_a_file_in_inches_gives_the_numbers_of_one_in_metric_units(measures):
    there, here = (tables(r, measures) for r in (cases.metric_shigley(), cases.shigley()))
    own = {name for name in here if not name.startswith("asked")}
    assert {"gears.csv", "factors.csv", "meshes.csv", "shafts.csv", "teeth.csv"} <= own
    for name in own:
        cells = zip(*(list(csv.reader(io.StringIO(t[name]))) for t in (there, here)), strict=True)
        for mine, other in cells:
            assert all(map(_same, mine, other)), (name, mine, other)


def _same(one, other):
    try:
        return math.isclose(float(one), float(other), rel_tol=1e-9, abs_tol=1e-12)
    except ValueError:
        return one == other


def test_inch_pages_hold_no_metric_unit():
    """Nor do their CSV files, but for what the file asks in its own words."""
    for make in RATED:
        html = page(make(), "", INCH)
        shown = text(without_input(html))
        assert not re.search(r"\d (mm|kW|N|MPa|N m|m/s|kg)\b|\[(mm|kW|N|MPa|N m|m/s|kg)\]", shown)
        assert "[psi]" in shown and "[lbf]" in shown and "√psi" in shown


def test_every_table_is_rows_in_full_precision():
    result = cases.train()
    assert {"gears", "factors", "meshes", "shafts", "teeth", "levels"} <= set(result.tables)
    rating = result.design["rating"]
    stress = [row["bending stress s_t [MPa]"] for row in result.table("gears")]
    assert stress == [gear["bending_stress_MPa"] for gear in rating["gears"]]
    found = result.table("levels", "inch")
    assert [row["power [hp]"] for row in found[:4]] == pytest.approx([30.0 / 0.745699872] * 4)
    assert sorted({row["level"] for row in found}) == [1, 2, 3] and len(found) == 12
    symbols = {row["symbol"]: row for row in result.table("factors")}
    assert symbols["J"]["unverified"] == "1, 2" and symbols["K_v"]["unverified"] == ""


def test_damages_of_the_levels_add_up_to_the_sum_of_a_gear():
    """Miner's rule, from what the page holds."""
    result = cases.train()
    sums = {row["name"]: row["Miner's sum, contact"] for row in result.table("gears")}
    for name, whole in sums.items():
        parts = [r["damage, contact"] for r in result.table("levels") if r["gear"] == name]
        assert math.fsum(parts) == pytest.approx(whole, rel=1e-12)
    life = {row["name"]: row["life, contact [cycles]"] for row in result.table("gears")}
    cycles = {row["name"]: row["load cycles"] for row in result.table("gears")}
    assert life["wheel 1"] == pytest.approx(cycles["wheel 1"] / sums["wheel 1"])


def test_unverified_stands_beside_every_value_that_is():
    html = on_screen(page(cases.train(), ""))
    cells = re.findall(r"<td[^>]*>([\d.]+)\nunverified</td>", html)
    unsure = [f for f in cases.train().design["rating"]["factors"] if not f["verified"]]
    assert len(cells) == sum(1 if f.get("wheel") is None else 2 for f in unsure) == 6
    assert html.count("Unverified (one source, or no published value): in stages 1 and 2 ") == 1
    assert "nverified" not in text(page(cases.shigley(), "")).partition("Assumptions")[0]


def test_forces_of_a_shaft_balance_in_the_tables():
    """The axial force of an intermediate shaft is that of its two meshes; torques follow ratios."""
    result = cases.train()
    first, second = (row["axial force F_a [N]"] for row in result.table("meshes"))
    shafts = [row["axial force [N]"] for row in result.table("shafts")]
    assert sum(shafts) == pytest.approx(0.0, abs=1e-9 * second)
    assert [abs(shafts[0]), abs(shafts[-1])] == pytest.approx([first, second], rel=1e-12)
    shown = text(page(result, ""))
    assert "F_a of stage 1" in shown and "−F_a of stage 2" in shown


def test_an_optimum_that_is_not_safe_is_warned_of_at_once():
    unsafe, safe = cases.sized(), cases.sized("400 HB")
    words = "Not safe by its rating: 2 safety factors fall short, contact of the pinion most."
    top = sections(unsafe)[0]
    assert top.notes == [words] and words in " ".join(told(unsafe).split("\n\n")[1].split("\n"))
    assert words in repr(unsafe) and words in unsafe._repr_html_() and "note" in page(unsafe, "")
    assert sections(safe)[0].notes == [] and "Safe by its rating: all" in told(safe)
    assert opening(unsafe).startswith("Not safe by its rating; proven optimal (")
    assert opening(safe).startswith("Proven optimal (")
    assert {"minimum S_F, bending", "minimum S_H, contact"} <= {t.name for t in top.tiles}
    headings = [section.heading for section in sections(unsafe)]
    assert headings.index("Rating") < headings.index("Factors") < headings.index("Teeth")
    assert "What is proven, and how" in headings
    (stage,) = unsafe.design["stages"]
    teeth = {f"{stage[key]:.5g}" for key in ("pinion_teeth", "wheel_teeth")}
    again = {"2101": "2 times outside tables"}  # of a standard that is named twice
    again |= {z.replace(".", ""): "in 2 tables" for z in teeth}  # of sizes, and of tooth shapes
    assert repeated(page(unsafe, "gearopt solve x.toml")) == again and len(again) == 3


def test_flaws_of_teeth_are_seen_near_the_top():
    edits = {"pinion_teeth = 17": "pinion_teeth = 12"}
    result = cases.rated(cases.SHIGLEY, edits)
    flaw = result.design["rating"]["flaws"][0]
    assert "undercut" in flaw and flaw in sections(result)[0].notes
    assert flaw in " ".join(told(result).partition("\ngear ")[0].split())


def test_in_a_notebook_and_kept(here, tmp_path):
    result = cases.train()
    assert repr(result).startswith("Two helical stages under a load spectrum: not safe\n")
    assert "S_H 0.9692, 1.1 required" in result._repr_html_()
    kept = tmp_path / "rating.json"
    kept.write_text(result.to_json(), encoding="utf-8")
    done = here("report", kept, "--html", tmp_path / "x.html", "--csv", tmp_path, "--units", "inch")
    assert done.returncode == 0 and "40.2 hp required" in " ".join(done.stdout.split())
    again = gearopt.Result.from_json(kept.read_text(encoding="utf-8"))
    assert (tmp_path / "x.html").read_text(encoding="utf-8") == page(again, "", INCH)
    assert {f"{name}.csv" for name in again.tables} <= {p.name for p in tmp_path.iterdir()}


def test_a_page_names_the_command_that_makes_it(here, tmp_path):
    file, html = tmp_path / "pair.toml", tmp_path / "pair.html"
    file.write_text(cases.SHIGLEY, encoding="utf-8")
    assert here("rate", file, "--html", html).returncode == 0
    assert f"gearopt rate {file} --html {html}" in text(html.read_text(encoding="utf-8"))


def test_what_governs_is_said_by_what_it_is_measured():
    """Least power and least safety factor may be of two stages: then the power is named."""
    rated = gearopt.rate(two_stages(rating={"minimum_contact_safety": 1}))
    rating = rated.design["rating"]
    weak = min(rating["meshes"], key=lambda mesh: mesh["power_capacity_kW"])
    mode, _, member = weak["governs"].partition(" of the ")
    least = min(row[f"{kind}_safety"] for row in rating["gears"] for kind in ("bending", "contact"))
    gears = [
        row if row["stage"] == weak["stage"] else row | {f"{mode}_safety": 0.999 * least}
        for row in rating["gears"]
    ]
    other = replace(rated, design=rated.design | {"rating": rating | {"gears": gears}})
    said = f"{mode} of the {member} of stage {weak['stage']} governs"
    assert f"{said}:" in " ".join(told(rated).split())
    assert f"{said} the power capacity:" in " ".join(told(other).split())
