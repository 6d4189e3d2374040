"""The page and the terminal of a helical pair: the flank in numbers, pictures and files."""

import csv
import io
import re
import tomllib
from dataclasses import replace

import pytest
from rich.console import Console

import gearopt
from gearopt.report.kinds.pair import PAGES, binding_limit, contact_of
from gearopt.report.kinds.pair.flank import MEASURED, SOFTER, answers, flank_of, section
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages.result import page, sections, tables
from gearopt.report.terminal import show
from gearopt.report.words import again
from gearopt.scenes.pair import KIND


def printed(result, measures=METRIC):
    screen = Console(file=io.StringIO(), width=110)
    show(result, screen, measures)
    return " ".join(screen.file.getvalue().split())


def test_the_terminal_says_where_the_load_lies_and_what_was_not_measured(solved):
    result = solved("helical_pair")
    said = printed(result)
    assert contact_of(result) is None
    assert "flanks carry up to 263.63 N/mm of face width; the transmission error varies by" in said
    assert "31.95 mm to 48.94 mm long, 39.94 mm on average" in said
    assert "at s = -0.368 mm on the path of contact and y = -2.34 mm across the face" in said
    assert "carries 1.20 times the mean" in said
    assert "26 % at 50 % of the torque, 5.1 % at 100 % of the torque carries nothing" in said
    assert "the gaps of the flanks counted as approach" in said
    assert "off the pinion 12 µm at its tip, from d 78.97 mm on" in said
    assert "this coupling is off was not measured on helical pairs" in said


def test_peak_to_peak_values_of_the_first_lines_have_their_load(solved):
    """Those of all loads with relief, the worst without it."""
    result = solved("helical_pair")
    half, whole = flank_of(result).loads
    at = re.findall(r"([\d.]+) µm at (\d+) % of the torque", binding_limit(result))
    assert [load for _, load in at] == ["50", "100"]
    known = 1e3 * half.peak_to_peak_mm, 1e3 * whole.peak_to_peak_mm
    assert [float(value) for value, _ in at] == pytest.approx(known, rel=1e-3)
    (plain,) = [tile for tile in PAGES.tiles(result, METRIC) if "without relief" in tile.name]
    assert whole.plain_peak_to_peak_mm > half.plain_peak_to_peak_mm
    assert float(plain.value.split()[0]) == pytest.approx(1e3 * whole.plain_peak_to_peak_mm, 1e-3)
    assert plain.remark == "at 100.0 % of the duty's torque"


def test_errors_are_told_by_the_coupling_and_not_of_spur_pairs(solved):
    found = flank_of(solved("helical_pair"))
    of = {
        name: answers(replace(found, coupling=name)) for name in ("finite elements", "ring torsion")
    }
    assert MEASURED in of["finite elements"] and SOFTER not in of["finite elements"]
    assert of["ring torsion"][-1] == SOFTER and MEASURED not in of["ring torsion"]
    assert "finite elements" not in " ".join(answers(replace(found, overlap_ratio=0.0)))


def test_pictures_and_files_hold_the_flank(solved):
    result = solved("helical_pair")
    found = flank_of(result)
    shown = section(result, METRIC)
    line, stress, error = shown.figures
    assert line.data[0]["type"] == stress.data[0]["type"] == "heatmap"
    assert max(map(max, line.data[0]["z"])) <= found.loads[1].largest_line_load_N_per_mm * 1.001
    lines = [trace for trace in line.data if trace["type"] == "scatter"]
    assert 1 <= len(lines) <= 3 and len(error.data) == 2
    for trace, load in zip(error.data, found.loads, strict=True):  # not from zero, as flat lines
        assert min(trace["y"]) < 0.0 < max(trace["y"])
        heights = max(trace["y"]) - min(trace["y"])
        assert heights == pytest.approx(1e3 * load.peak_to_peak_mm, rel=1e-4)
    for trace in lines:  # along the base helix
        (s0, s1), (y0, y1) = trace["x"], trace["y"]
        assert (s1 - s0) == pytest.approx(0.19921 * (y1 - y0), abs=2e-4)
    text = tables(result, METRIC)
    over = list(csv.reader(io.StringIO(text["flank.csv"])))
    assert over[0] == [
        *("s [mm]", "y [mm]"),
        *("line load at 50 % [N/mm]", "contact stress at 50 % [MPa]"),
        *("line load at 100 % [N/mm]", "contact stress at 100 % [MPa]"),
    ]
    assert len(over) == 1 + len(found.path_mm) * len(found.place_mm)
    assert len(list(csv.reader(io.StringIO(text["transmission-error.csv"])))) == 1 + len(
        found.travel_mm
    )


@pytest.mark.parametrize("measures", [METRIC, INCH])
def test_the_page_is_made_in_either_system(solved, measures):
    html = page(solved("helical_pair"), "gearopt solve x.toml", measures)
    assert "Contact over the flank" in html and "Teeth in mesh" not in html


RATED = {  # spur gears with crowned flanks, rated, whose relief is searched
    "gearopt": 1,
    "kind": "pair",
    "duty": {"power": "5 kW", "input_speed": "1450 rpm"},
    "gears": {"treatment": "carburised"},
    "stage": [{"module": "3 mm", "pinion_teeth": 22, "wheel_teeth": 40, "face_width": "30 mm"}],
    "rating": {"life": "1000 h", "quality": 8},
    "flank": {"slices": 11, "crowning": "5 um"},
    "sharing": {"positions": 12, "coupling": "none", "level": "profile + Sainsot"},
    "relief": {"amount": ["0 um", "20 um"], "length": [0.2, 0.5]},
}


def test_the_command_of_a_rated_pair_is_one_that_takes_pairs():
    file = {key: table for key, table in RATED.items() if key != "relief"}
    with pytest.raises(gearopt.SolveError, match="gearopt solve rates a pair"):
        gearopt.rate(file)
    result = replace(gearopt.solve(file), file="pair.toml")
    assert again(result, "x.html", METRIC).startswith("gearopt solve pair.toml ")


def test_a_searched_relief_of_rated_gears_has_a_page_that_calls_the_gears_safe():
    result = gearopt.solve(RATED, budget=gearopt.Budget(evaluations=8))
    (gears,) = result.parts
    assert max(gears.limits.values()) < 1.0 and gears.objective == {}
    assert any("[flank] does not enter the rating" in s for s in result.report["assumptions"])
    made = {section.heading: section for section in sections(result)}
    states = made["What is proven, and how"].tables[0].rows[0]
    assert states[1:] == ["feasible, not proven optimal", "evaluated, all limits met"]
    assert "All required safety factors are met" in printed(result)


@pytest.mark.slow
def test_no_load_at_all_is_said():
    file = tomllib.loads(KIND.example.text)
    file |= {"gears": {"helix_angle": "15 deg"}, "sharing": {"loads": [0]}}
    result = gearopt.solve(file)
    assert "Without load nothing is carried." in printed(result)
    assert PAGES.tiles(result, METRIC)
