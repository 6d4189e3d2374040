"""`gearopt bench relief`: published cases are beaten, and no method is below the bound.

All of them: `test_the_published_table` of a relief, `test_published_profiles` of any shape.
"""

import pytest

from gearopt.bench import names, relief
from gearopt.optimise.result import Budget


@pytest.mark.slow
def test_published_cases(monkeypatch):
    methods = ("annealing", "mpec")
    monkeypatch.setattr(relief, "SAMPLED", dict.fromkeys(methods, Budget(evaluations=200)))
    monkeypatch.setattr(relief, "PUBLISHED", dict(list(relief.PUBLISHED.items())[:2]))
    rows = relief.run(1)
    assert len(rows) == (5 + 2 * len(methods)) * 2 and "relief" in names()
    for row in rows:
        assert row["um"] >= row["bound_um"] - 1e-5
        if row["method"] == "exact" and row["published_um"]:
            assert row["um"] < row["published_um"] + 6e-5
            assert row["um"] == pytest.approx(row["bound_um"], rel=1e-4)
