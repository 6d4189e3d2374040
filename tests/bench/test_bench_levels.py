"""`gearopt bench levels`: what is kept of it is what it measures, and pages print what is kept."""

import csv
from pathlib import Path

import pytest

from gearopt.bench import levels
from gearopt.physics.tooth.ladder import USUAL
from gearopt.physics.tooth.measured import FILE, IN_MESH, PAIRS

KEPT = Path(__file__).with_name("levels.csv")  # every pair, in per cent
PAGE = Path(__file__).parents[2] / "docs" / "tooth_stiffness.md"


def kept():
    with KEPT.open(encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


def test_the_table_is_the_range_of_all_pairs():
    rows = kept()
    assert {int(row["pair"]) for row in rows} == set(range(PAIRS)) and PAIRS == levels.PAIRS
    with FILE.open(encoding="utf-8", newline="") as text:
        table = {(row["level"], row["coupling"]): row for row in csv.DictReader(text)}
    assert table.keys() == IN_MESH.keys() == {(row["level"], row["coupling"]) for row in rows}
    for names, errors in IN_MESH.items():
        own = [row for row in rows if (row["level"], row["coupling"]) == names]
        for measure in levels.MEASURES:
            values = sorted(float(row[measure]) for row in own)
            least, median, largest = getattr(errors, measure)
            assert 100.0 * least == pytest.approx(values[0], abs=0.06)
            assert values[len(own) // 2 - 1] - 0.06 <= 100.0 * median
            assert 100.0 * median <= values[len(own) // 2] + 0.06
            assert 100.0 * largest == pytest.approx(values[-1], abs=0.06)
            assert float(table[names][f"{measure} least"]) == pytest.approx(100.0 * least)


def test_the_pages_have_every_row():
    page = PAGE.read_text(encoding="utf-8")
    for (level, coupling), errors in IN_MESH.items():
        (row,) = (line for line in page.splitlines() if f"| `{level}` | `{coupling}` |" in line)
        low, high = (100.0 * errors.peak_to_peak[k] for k in (0, 2))
        assert f"| {low:+.0f} to {high:+.0f} (" in row
    usual = [100.0 * IN_MESH[USUAL, "ring torsion"].peak_to_peak[k] for k in (0, 2)]
    said = f"On 30 random pairs it was {usual[0]:.0f} to {usual[1]:.0f} % too large"
    assert said in PAGE.with_name("pair.md").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 3])
def test_kept_rows_are_what_is_measured(number):
    """The search ends within 2 %, so that another machine may end at other amounts."""
    own = {(row["level"], row["coupling"]): row for row in kept() if int(row["pair"]) == number}
    rows = list(levels.of_pair(number))
    assert len(rows) == len(own)
    for row in rows:
        there = own[row["level"], row["coupling"]]
        assert 100.0 * row["peak_to_peak"] == pytest.approx(float(there["peak_to_peak"]), abs=0.3)
        proven = 1.0 + row["proven"], 1.0 + 0.01 * float(there["proven"])
        assert proven[0] == pytest.approx(proven[1], rel=0.03)
