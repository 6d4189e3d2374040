"""`gearopt bench integrators`: every method reaches its errors; their orders are slopes."""

import pytest

from gearopt.bench import integrators, names


def test_times_between_two_settings_follow_a_line_of_logarithms():
    found = [(1e-2, 1.0), (1e-4, 4.0), (1e-9, 8.0)]
    assert integrators._least(found, 1e-3) == pytest.approx(2.0)
    assert integrators._least(found, 1e-4) == pytest.approx(4.0)
    assert integrators._least(found, 0.1) == 1.0 and integrators._least(found, 1e-10) is None
    assert integrators._slope([0.5, 1e-2, 2.5e-3, 1e-12]) == 2.0


@pytest.mark.slow
def test_every_method_reaches_its_errors_by_its_order(monkeypatch):
    monkeypatch.setattr(integrators, "PATIENCE", 150.0)
    monkeypatch.setattr(integrators, "TIME", 0.005)
    monkeypatch.setattr(integrators, "OUTPUTS", 101)
    rows = integrators.run(1)
    assert "integrators" in names() and len(rows) == 30
    orders = {"newmark": 2, "hht": 2, "generalised_alpha": 2, "rk4": 4, "symplectic": 6, "rk8": 8}
    for row in rows:
        if row["method"] in orders:
            assert row["order"] == pytest.approx(orders[row["method"]], abs=0.3)
        assert row["error"] < (1e-9 if row["method"] == "rk8" else 1e-3)
        assert row["ms_1e-03"] > 0.0
