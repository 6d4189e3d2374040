"""`gearopt bench global`: its problems are complete, and its rows say what was proven.

That they are proven: `tests/optimise/spatial/test_search.py::test_known_optima_are_proven`.
"""

from importlib import import_module

import pytest

from gearopt.bench import growth, names

bench = import_module("gearopt.bench.global")


def test_problems_have_names_of_their_own():
    assert {"global", "growth"} <= set(names()) and "public" not in names()
    assert len(bench.cases()) == sum(map(len, bench.SETS.values())) == 112


def test_rows_end_with_totals(monkeypatch):
    some = {"first": (bench.cases()["hs21"],), "second": (bench.cases()["nvs03"],)}
    monkeypatch.setattr(bench, "SETS", some)
    monkeypatch.setattr(bench, "WARMING", ())
    rows = bench.run(1)
    assert [row["status"] for row in rows[:2]] == ["optimal"] * 2
    assert abs(rows[0]["off"]) < 1e-9 and rows[1]["whole"] == 2
    assert [row["problem"] for row in rows[-3:]] == ["proven", "median of 2", "sum of 2"]
    assert rows[-3]["status"] == rows[-3]["scip"] == "2 of 2"
    assert len({tuple(row) for row in rows}) == 1


@pytest.mark.parametrize("family", growth.FAMILIES)
def test_families_grow(family):
    sizes, posed = growth.FAMILIES[family]
    assert len(posed(sizes[0]).columns) == sizes[0] and sorted(sizes) == list(sizes)
