"""The page and the terminal of a spur pair: what an engineer asks, answered in numbers once."""

import csv
import io
import math
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

import gearopt
from gearopt.physics.gears import Gear, GearPair
from gearopt.report.kinds.pair import PAGES, contact_of, tiles
from gearopt.report.kinds.pair.words import answers, graded, of_duty
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages.result import tables
from gearopt.report.terminal import show


def printed(result, measures=METRIC, width=110):
    screen = Console(file=io.StringIO(), width=width)
    show(result, screen, measures)
    return screen.file.getvalue()


def rows(result, name, measures=METRIC):
    return list(csv.reader(io.StringIO(tables(result, measures)[f"{name}.csv"])))


def test_the_terminal_says_the_load_the_motion_and_the_stiffness(solved):
    said = printed(solved("reference_pair"))
    head = (
        "A spur pair: how its teeth share the load: evaluated\nOne tooth carries up to 5,675.6 N;"
    )
    assert said.startswith(head) and "limits met" not in said
    flat = " ".join(said.split())
    assert "carries the whole load, 5,676 N, over 2.81 mm of its path (18.8 %)" in flat
    assert "a pair comes into contact with 40.1 % of the load and leaves it with 41.2 %" in flat
    assert "varies by 2.50 µm at 50 % of the torque, 4.99 µm at 100 % of the torque" in flat
    hertz = 25 * 100 / (2 * math.pi)  # teeth, and the speed of the file [rad/s]
    assert f"at the mesh frequency of {hertz:.0f} Hz, has an amplitude of 2.57 µm at" in flat
    assert "22 % below c_γα of ISO 6336-1" in flat and "Method evaluation: 1 evaluation," in flat
    assert "c_γα of ISO 6336-1 [N/(mm µm)] 20.128 20.128" in flat
    ratio = solved("reference_pair").design["stages"][0]["transverse_contact_ratio"]
    assert f"transverse contact ratio ε_α {ratio:.5g}" in flat


def test_the_measured_range_stands_beside_the_transmission_error(solved):
    """Least and largest of the pairs that `gearopt bench levels` keeps; a number has none."""
    kept = Path(__file__).parents[2] / "bench" / "levels.csv"
    with kept.open(encoding="utf-8", newline="") as text:
        names = "profile + Sainsot", "ring torsion"
        rows = [r for r in csv.DictReader(text) if (r["level"], r["coupling"]) == names]
    low, *_, high = sorted(round(float(row["peak_to_peak"])) for row in rows)
    said = f"measured on {len(rows)} random pairs: {low} to {high} % above finite elements"
    file = Path(__file__).parents[3] / "src/gearopt/scenes/pair/examples/pair.toml"
    result = gearopt.solve(file)
    flat = " ".join(printed(result).split())
    assert flat.count(said) == 2  # in the first lines, and where it is told how sure that is
    assert any(said in tile.remark for tile in tiles(result, METRIC))
    flat = " ".join(printed(solved("reference_pair")).split())
    assert "measured on" not in flat and "no error has been measured here" in flat


@pytest.mark.parametrize("measures", [METRIC, INCH])
def test_no_number_of_a_point_is_cut_short_on_a_narrow_terminal(solved, measures):
    said = printed(solved("reference_pair"), measures, 80)
    table = said[said.index("\npoint ") :].split("\n\n")[0]
    assert "…" not in table and "pitch point" in table and "pinion roll [°]" in table


def test_two_pairs_always_in_contact_leave_no_tooth_alone(solved):
    result = solved("almost_two_pairs")
    found = contact_of(result)
    assert any("1.9990 is close to 2" in each for each in found.validity)
    assert "over 0.00886 mm of its path (0.1 %)" in answers(found)[0]
    load = replace(of_duty(found.loads), largest_share=0.6)
    other = replace(found, loads=(load,), contact_ratio=2.001)
    assert "carries at most 60.0 % of the load, as two pairs always touch" in answers(other)[0]
    assert "as three pairs always touch" in answers(replace(other, contact_ratio=3.2))[0]
    idle = replace(load, normal_force_N=0.0)
    assert answers(replace(found, loads=(idle,)))[0] == (
        "Without load no pair of teeth carries anything."
    )


@pytest.mark.parametrize(("measures", "unit"), [(METRIC, "N/(mm µm)"), (INCH, "lbf/(in µin)")])
def test_curves_are_csv_files_in_full(solved, measures, unit):
    result = solved("reference_pair")
    found = contact_of(result)
    path = rows(result, "path-of-contact", measures)
    assert f"stiffness of a pair [{unit}]" in path[0]
    assert len(path) == 1 + len(found.position_mm)
    share = path[0].index("share of the load at 100 %")
    assert [float(row[share]) for row in path[1:]] == pytest.approx(found.loads[1].share)
    travel = rows(result, "transmission-error", measures)
    assert len(travel) == 1 + len(found.travel_mm) and len(travel[0]) == 3


def test_the_page_shows_contact_and_the_rating_of_a_pair_that_was_sized(solved):
    html = solved("pair_from_duty").to_html()
    for words in ("largest load on a tooth", "points-of-contact.csv", "shafts in one plane"):
        assert words in html
    assert "proven optimal" in html and "power capacity" in html
    assert PAGES.pages_of_given is not None and PAGES.drawn


def test_the_largest_load_is_that_at_the_torque_of_the_duty(solved):
    tile = next(t for t in tiles(solved("relief_two_loads"), METRIC) if "largest load" in t.name)
    assert tile.remark.endswith("at 100.0 % of the duty's torque")


def test_what_models_do_not_cover_is_warned_of_once(solved):
    html = solved("undercut_pair").to_html()
    assert html.count("teeth or more without undercut at x = 0") == 1


def test_an_uneven_motion_is_compared_with_accuracy():
    """ISO 1328-1:1995 at grade 5: 2.5 sqrt(m) + 0.17 sqrt(d) + 0.5 um; double at grade 7."""
    pair = GearPair(Gear(3.0, 25, 75.0, 30.0), Gear(3.0, 50, 150.0, 30.0))
    middle = 1e-3 * (2.5 * 3.0**0.5 + 0.17 * 150.0**0.5 + 0.5)
    for factor, words in ((1.0, "grade 5 "), (2.0, "grade 7 "), (0.5, "grade 3 ")):
        assert f"the profile form tolerance of accuracy {words}" in graded(pair, factor * middle)
    assert "below the profile form tolerance of every" in graded(pair, 1e-5) and not graded(
        pair, 0.0
    )
    assert "above the profile form tolerance of every" in graded(pair, 1.0)


def test_what_to_change_is_told_where_nothing_is_relieved(solved):
    """11.34 and 11.17 um by the corrected rule, computed apart from gearopt."""
    flat = " ".join(printed(solved("reference_pair")).split())
    assert "Tip relief of about 11.3 µm on the pinion and 11.2 µm on the wheel would let" in flat
    assert "of accuracy grade 4 of ISO 1328-1" in flat
    assert "Tip relief of about" not in " ".join(printed(solved("relief_two_loads")).split())
