"""`gearopt bench stiffness`: the errors that levels of stiffness record are what it measures."""

import pytest

from gearopt.bench import stiffness
from gearopt.physics.tooth.ladder import LEVELS


@pytest.mark.slow
def test_recorded_errors_are_what_is_measured(monkeypatch):
    """Elements of half the size, which take long, on one of the random pairs."""
    monkeypatch.setattr(stiffness, "HALVED", 1)
    rows = stiffness.run(1)
    assert {row["method"] for row in rows} == set(LEVELS) and len(rows) == 5 * len(LEVELS)
    others = {row["method"]: row for row in rows if "random" in row["case"]}
    for name, level in LEVELS.items():
        wider = others[name]["least_error"], others[name]["largest_error"]
        assert wider == pytest.approx(level.wider, abs=2e-3)
        own = [row for row in rows if row["method"] == name and "random" not in row["case"]]
        assert min(row["least_error"] for row in own) == pytest.approx(level.error[0], abs=2e-3)
        assert max(row["largest_error"] for row in own) == pytest.approx(level.error[1], abs=2e-3)
        assert min(row["us_per_position"] for row in own) > 0.0
    elements = [row for row in rows if row["method"] == "finite elements"]
    assert len(elements) == 5
    assert all(abs(row["least_error"]) < 1e-3 > row["largest_error"] for row in elements)
