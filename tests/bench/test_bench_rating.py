"""`gearopt bench rating`: rows of the table are ratings; the published tables are met."""

import pytest

from gearopt.bench import names, rating


def test_published_factors_and_rows(monkeypatch):
    monkeypatch.setattr(rating, "ROWS", 2000)
    monkeypatch.setattr(rating, "CHECKED", 3)
    monkeypatch.setattr(rating, "ISO_ROWS", 2000)
    monkeypatch.setattr(rating, "TEETH", (range(17, 25), range(40, 60, 5)))
    pitting, bending, *rows = rating.run(1)
    assert pitting["error"] < 6e-4 and bending["error"] < 0.007
    assert len({tuple(row) for row in (pitting, bending, *rows)}) == 1
    assert [row["method"] for row in rows[:3]] == [
        "one at a time",
        "table of pairs",
        "rows of the table",
    ]
    assert [row["error"] for row in rows[2:6:3]] == pytest.approx([0.0, 0.0], abs=1e-11)
    assert "rating" in names()


def test_ratings_by_iso_6336(monkeypatch):
    """The published example to its printed digits; rows are ratings; the smooth form's error."""
    monkeypatch.setattr(rating, "ISO_ROWS", 2000)
    monkeypatch.setattr(rating, "CHECKED", 3)
    one, rows, smooth = rating._iso(1)
    assert [row["method"] for row in (one, rows, smooth)] == [
        "one at a time",
        "rows",
        "smooth form",
    ]
    assert one["error"] < 1e-5 and rows["error"] < 1e-12 and 1e-4 < smooth["error"] < 0.03
