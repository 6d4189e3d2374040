"""`gearopt bench rating`: rows of the table are ratings; the published tables are met."""

import pytest

from gearopt.bench import names, rating


def test_published_factors_and_rows(monkeypatch):
    monkeypatch.setattr(rating, "ROWS", 2000)
    monkeypatch.setattr(rating, "CHECKED", 3)
    monkeypatch.setattr(rating, "TEETH", (range(17, 25), range(40, 60, 5)))
    pitting, bending, *rows = rating.run(1)
    assert pitting["error"] < 6e-4 and bending["error"] < 0.007
    assert len({tuple(row) for row in (pitting, bending, *rows)}) == 1
    assert [row["method"] for row in rows[:3]] == [
        "one at a time",
        "table of pairs",
        "rows of the table",
    ]
    assert [row["error"] for row in rows[2::3]] == pytest.approx([0.0, 0.0], abs=1e-11)
    assert "rating" in names()
