"""`gearopt bench sharing`: closed forms and solvers on the same positions, error beside time."""

import pytest

from gearopt.bench import names, sharing

MOST = {  # error of a share: rounding, active sets, splitting polished, interior points
    "numpy": 1e-14,
    "kernel": 1e-14,
    "DAQP": 1e-9,
    "OSQP": 1e-9,
    "Clarabel": 1e-4,
    "cvxpy, DPP": 1e-4,
}


@pytest.mark.parametrize(
    "methods", [("numpy", "kernel", "DAQP"), pytest.param(tuple(MOST), marks=pytest.mark.slow)]
)
def test_errors_are_those_of_the_methods(monkeypatch, methods):
    monkeypatch.setattr(sharing, "POSITIONS", 300)
    monkeypatch.setattr(sharing, "CHECKED", 5)
    chosen = {name: build for name, build in sharing.SOLVERS.items() if name in methods}
    monkeypatch.setattr(sharing, "SOLVERS", chosen)
    rows = sharing.run(1)
    assert [row["case"] for row in rows[:: len(methods)]] == ["2 pairs", "4 pairs", "6 pairs"]
    assert [row["method"] for row in rows] == 3 * list(methods)
    assert all(row["error"] < MOST[row["method"]] for row in rows)
    assert "sharing" in names()
