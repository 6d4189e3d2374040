"""What is shown of a rating by ISO 6336, alone and beside AGMA."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
import rating_cases as cases
from page_reader import without_input
from read_numbers import repeated
from test_rating_page import page, rows, sections, text, told

import gearopt
from gearopt.formulations.strength.standard import MIDWAY
from gearopt.report.answer import decided, opening
from gearopt.report.kinds.drive import rating_words
from gearopt.report.kinds.drive.rating_words import greek
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages import result as pages
from gearopt.report.words import limit_words
from gearopt.scenes.drive.notes import assumptions
from gearopt.scenes.reading.load import read

PROBLEMS = Path(__file__).parents[3] / "problems"
PRINTED = {  # ISO/TR 6336-30, example 1: pinion and wheel
    "S_H": (1.02853, 1.08696),
    "contact stress sigma_H [MPa]": (1301.35, 1301.35),
}
INCHES = 25.4
PSI = cases.PSI


@pytest.mark.parametrize("label", PRINTED)
def test_the_csv_has_the_printed_numbers(label):
    found = rows(cases.iso(), "gears")[label]
    assert [float(v) for v in found] == pytest.approx(PRINTED[label], rel=2e-4)


def test_factors_are_the_printed_ones():
    """K_Hbeta 1.16 and Z_eps 0.803, in three digits."""
    found = rows(cases.iso(), "factors")
    assert float(found["K_Hbeta"][2]) == pytest.approx(1.16, abs=5e-3)
    assert float(found["Z_eps"][2]) == pytest.approx(0.803, abs=5e-4)
    assert found["K_Hbeta"][5] == "6336-1:2006, 7.5, method C"
    assert found["C_a"][1] == "µm" and float(found["C_a"][2]) == pytest.approx(70.0)


def test_the_terminal_has_the_printed_numbers():
    shown = told(cases.iso())
    rating = shown.partition("Life")[0]
    assert re.search(r"^pinion .* 1,301\.3 .* 1\.028$", rating, re.M)
    assert re.search(r"^wheel .* 1,301\.3 .* 1\.087$", rating, re.M)
    assert re.search(r"^K_Hβ +face load factor +1\.1[56]\d\d *$", shown, re.M)
    assert re.search(r"^Z_ε +contact ratio factor +0\.803\d+ *$", shown, re.M)
    assert re.search(r"^σ_Flim \[MPa\] .* 425 +425 +unverified$", shown, re.M)
    assert "σ_Flim: read from pictures of the table." in shown


def test_symbols_are_greek_where_they_are_read_and_ascii_in_data():
    html, found = page(cases.iso(), ""), rows(cases.iso(), "factors")
    assert {"K_Hβ", "c_γα [N/(mm µm)]", "Y_δrelT", "f_pb [µm]"} <= set(
        re.findall(r">([^<]+)<", html)
    )
    shown = text(html)
    assert "contact stress σ_H [MPa]" in shown and "stress limit σ_FG [MPa]" in shown
    assert "σ_HG are the tooth root and the pitting stress limit; permissible are σ_FP" in shown
    assert not re.search(r"K_Hbeta|sigma_|Z_eps|delta", text(without_input(html)))
    assert all(symbol.isascii() for symbol in found)
    symbols = [f["symbol"] for f in cases.iso().design["rating"]["factors"]]
    assert "Y_deltarelT" in symbols and list(found)[1:] == symbols


@pytest.mark.parametrize(
    ("ascii_", "shown"),
    [
        ("sigma_Hlim", "σ_Hlim"),
        ("c_gamma_alpha", "c_γα"),
        ("c_prime", "c'"),
        ("K_Falpha", "K_Fα"),
        ("Z_BD", "Z_B, Z_D"),
        ("slip layer, steps and a beta", "slip layer, steps and a beta"),
        ("s_at and K_o", "s_at and K_o"),
    ],
)
def test_greek_symbols(ascii_, shown):
    assert greek(ascii_) == shown


def test_forces_are_those_of_the_working_circles_by_either_standard():
    """T = P/omega; a = 500 mm, u = 103/17; F_t = 2 T/d_w."""
    (mesh,), (other,) = (r.design["rating"]["meshes"] for r in (cases.iso(), cases.both()))
    torque = 339.292e6 / (360.0 * 2.0 * 3.141592653589793 / 60.0)
    working = 2.0 * 500.0 / (103.0 / 17.0 + 1.0)
    assert mesh["tangential_force_N"] == pytest.approx(2.0 * torque / working, rel=1e-12)
    keys = ("tangential_force_N", "radial_force_N", "axial_force_N", "pitch_line_velocity_m_per_s")
    assert [mesh[key] for key in keys] == [other[key] for key in keys]


@pytest.mark.slow
def test_the_first_sentence_has_both_verdicts():
    said = (
        "Not safe: by AGMA, 3 safety factors fall short, contact of the pinion most; "
        "safe by ISO 6336 alone."
    )
    assert opening(cases.both()) == said
    safe = (
        "Safe: all required safety factors are met by AGMA and by ISO 6336; contact of the pinion "
    )
    assert opening(cases.both_safe()) == f"{safe}governs both."
    fails = "Not safe: by AGMA and by ISO 6336, contact of the wheel of stage 1 falls short."
    assert opening(cases.train_by_both()) == fails
    assert "S_H 0.8348 by AGMA, S_H 1.028 by ISO 6336, 1 required; power" in decided(cases.both())


def test_each_standard_beside_the_other_is_as_it_is_alone():
    """In the table of gears, a column each; and in the limits."""
    found, alone = rows(cases.both(), "gears"), rows(cases.iso(), "gears")
    assert found[""] == ["pinion, AGMA", "pinion, ISO", "wheel, AGMA", "wheel, ISO"]
    agma = rows(cases.rated(cases.ISO, cases.AGMA), "gears")
    for key in ("S_F", "S_H", "life [h]"):
        assert found[key] == [v for both in zip(agma[key], alone[key], strict=True) for v in both]
    assert found["bending stress s_t, sigma_F [MPa]"][1] == alone["bending stress sigma_F [MPa]"][0]
    limits = cases.both().limits
    for name, used in cases.iso().limits.items():
        assert limits[name.replace("[", "_iso[")] == used
    assert len(limits) == 8 and not cases.both().feasible and cases.iso().feasible
    assert limit_words("pinion_bending_iso[1]") == "pinion bending by ISO 6336 of stage 1"


def test_key_figures_are_the_least_by_each_standard():
    tiles = {t.name: (t.value, t.remark) for t in sections(cases.both())[0].tiles}
    assert tiles["minimum S_H, contact by AGMA"][0] == "0.8348"
    assert tiles["minimum S_H, contact by ISO 6336"] == ("1.028", "pinion; 1 required")
    assert {"minimum S_F, bending by AGMA", "minimum S_F, bending by ISO 6336"} < set(tiles)
    own, other = cases.both().design["rating"], cases.both().design["rating"]["beside"]
    assert own["power_capacity_kW"] < other["power_capacity_kW"] and own["life_h"] < other["life_h"]
    assert re.fullmatch(
        r"pinion; [\d,.]+ h by ISO 6336; 50,000 h required", tiles["life at S = 1 by AGMA"][1]
    )
    assert "power capacity by AGMA" in tiles
    assert not rating_words.figures(cases.both()).endswith("governs")
    weak = replace(cases.both(), design={"rating": own | {"power_capacity_kW": 1e3}})
    assert rating_words.figures(weak).endswith("kW required; ISO 6336 governs")
    tiles = {t.name: t.remark for t in rating_words.tiles(weak, METRIC)}
    assert tiles["power capacity by ISO 6336"].startswith("1,000 kW by AGMA; ")


def test_factors_have_a_table_for_each_standard_and_teeth_one():
    tables = cases.both().tables
    assert {"factors-by-agma", "factors-by-iso-6336", "teeth", "meshes", "shafts"} <= set(tables)
    assert "factors" not in tables and len(cases.both().table("teeth")) == 2
    assert rows(cases.both(), "factors-by-iso-6336") == rows(cases.iso(), "factors")
    mesh = rows(cases.both(), "meshes")
    assert (
        mesh["governs the power capacity by AGMA"]
        == mesh["governs the power capacity by ISO 6336"]
        == ["contact of the pinion"]
    )


@pytest.mark.parametrize("make", [cases.iso, cases.both, cases.train_by_both])
@pytest.mark.parametrize("measures", [METRIC, INCH], ids=lambda m: m.name)
def test_the_terminal_is_80_columns_wide(make, measures):
    lines = [line.rstrip() for line in told(make(), measures).splitlines()]
    wide = [line.rstrip() for line in told(make(), measures, 300).splitlines()]
    shown = [line for line in wide if re.search(r" {2}", line)]  # rows of tables
    assert max(map(len, lines)) <= 80 and shown and set(shown) <= set(lines)


@pytest.mark.parametrize("make", [cases.iso, cases.both, cases.train_by_both])
def test_no_number_stands_twice(make):
    same = {"18981", "6336"}  # the elastic coefficient of steel by either standard; a standard
    assert set(repeated(page(make(), "gearopt rate x.toml"))) <= same


def test_inches():
    """psi, µin, and stiffness as lbf/(in µin) = 1e6 psi."""
    metric, inch = (rows(cases.iso(), "factors", m) for m in (METRIC, INCH))
    for symbol, unit, size in (
        ("sigma_Hlim", "psi", 1.0 / PSI),
        ("f_pb", "µin", 1e3 / INCHES),
        ("c_prime", "lbf/(in µin)", 1e-3 / PSI),
    ):
        assert inch[symbol][1] == unit
        assert float(inch[symbol][2]) == pytest.approx(size * float(metric[symbol][2]), rel=1e-12)
    shown = told(cases.both(), INCH) + text(without_input(page(cases.both(), "", INCH)))
    assert not re.search(r"\d (mm|kW|N|MPa|N m|m/s|µm)\b|\[(mm|kW|N|MPa|N m|m/s|µm)\]", shown)
    assert "f_pb [µin]" in shown and "power capacity 3" in " ".join(shown.split())


def test_a_spectrum_by_both_has_the_damages_of_each():
    """Miner's sums are those of the levels."""
    result = cases.train_by_both()
    levels = result.table("levels")
    assert len(levels) == 24 and {row["by"] for row in levels} == {"AGMA", "ISO"}
    for row in result.table("gears"):
        gear, by = row["name"].split(", ")
        own = [r for r in levels if (r["gear"], r["by"]) == (gear, by)]
        assert sum(r["damage, contact"] for r in own) == pytest.approx(row["Miner's sum, contact"])


def test_unverified_values_are_listed_by_the_stages_they_are_of():
    """Of values that single sources have in some stages, and of the spectrum, which has none."""
    rating = rating_words.rating_of(cases.train_by_both())
    names = "K_v of stage 1", "N of stage 1", "K_v of stage 2", "N of stage 2"
    names += "sigma_Flim of stage 2", "load spectrum by part 6"
    (said,) = rating_words.unverified(replace(rating, unverified=names, beside=None))
    assert said == (
        "Unverified (one source, or no published value): in stages 1 and 2 K_v and N (resonance "
        "ratio); in stage 2 σ_Flim; load spectrum by part 6."
    )


def test_a_spectrum_by_iso_is_unverified():
    """In the result, on the page beside the levels and on the terminal; not by AGMA."""
    result = cases.train_by_both()
    agma = result.design["rating"]
    assert "load spectrum by part 6" in agma["beside"]["unverified"]
    assert not any("spectrum" in name for name in agma["unverified"])
    said = (
        "Unverified by ISO 6336: a published spectrum confirms the sum for contact, none for "
        "bending."
    )
    assert text(page(result, "")).count(said) == 1
    assert "load spectrum by part 6" in " ".join(told(result).split())
    assert "load spectrum" not in str(cases.iso().design["rating"]["unverified"])


def test_what_is_taken_for_granted_is_that_of_the_standard():
    agma, iso, both = (
        " ".join(make().report["assumptions"])
        for make in (cases.train, cases.iso, cases.train_by_both)
    )
    assert "K_m follows the curve" in agma and "6336" not in agma
    assert "carburised as Eh" in iso and "K_Hβ by method C" in iso
    assert "K_m" not in iso and "AGMA" not in iso and "reliability" not in iso
    assert "K_m follows the curve" in both and "through-hardened as V alloy" in both
    assert all("Scuffing, micropitting" in words for words in (agma, iso, both))
    assert all("solid cylinders" in words and "7.85 kg/dm³" in words for words in (iso, agma))
    assert "K_v is that of transmission accuracy Q_v 9 (A_v 8)" in agma
    given = " ".join(cases.shigley().report["assumptions"])  # I and J of the file
    assert "highest point of single tooth contact" in agma and "Bending stresses" not in given


@pytest.mark.parametrize(
    ("file", "factor"), [("elevator_box_rated", "C_pm"), ("unit_in_box", "K_Hβ"), ("elevator", "")]
)
def test_pinions_are_midway_in_a_rating_and_elsewhere_in_a_box(file, factor):
    scene = read((PROBLEMS / f"{file}.toml").read_bytes())[1]
    said = [line for line in assumptions(scene) if line.startswith(MIDWAY)]
    assert len(said) == bool(factor) and all(f", {factor} may be larger" in s for s in said)
    result = replace(cases.iso(), report={"assumptions": said})
    shown = next(s for s in pages.sections(result, METRIC) if s.heading == "Rating")
    assert [line for line in shown.words if line.startswith(MIDWAY)] == said


def test_both_are_kept_and_told_by_the_command(here, tmp_path):
    file = tmp_path / "both.toml"
    file.write_text(cases.ISO.replace('"iso6336"', '"both"\nquality = 11'), encoding="utf-8")
    done = here("rate", file)
    assert done.returncode == 0 and "safe by ISO 6336 alone" in " ".join(done.stdout.split())
    again = gearopt.Result.from_json(cases.both().to_json())
    assert page(again, "") == page(cases.both(), "")


def test_an_optimum_that_is_not_safe_by_either_is_warned_of():
    result = gearopt.solve(cases.sized_by_both())
    words = "Not safe by its rating: by AGMA and by ISO 6336, 2 safety factors fall short, contact"
    (note,) = sections(result)[0].notes
    assert note.startswith(words) and max(map(len, told(result).splitlines())) <= 80
