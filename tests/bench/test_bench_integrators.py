"""`gearopt bench integrators`: every method reaches its errors; their orders are slopes."""

import pytest

from gearopt.bench import integrators, names


def test_times_between_two_settings_follow_a_line_of_logarithms():
    found = [(1e-2, 1.0), (1e-4, 4.0), (1e-9, 8.0)]
    assert integrators._least(found, 1e-3) == pytest.approx(2.0)
    assert integrators._least(found, 1e-4) == pytest.approx(4.0)
    assert integrators._least(found, 0.1) == 1.0 and integrators._least(found, 1e-10) is None
    assert integrators._slope([0.5, 1e-2, 2.5e-3, 1e-12]) == 2.0


def test_settings_beside_an_error_are_measured():
    assert integrators._needed([0.5, 1e-2, 1e-4, 1e-7, 1e-10]) == [1, 2, 3, 4]
    assert integrators._needed([1e-4, 1e-5]) == [0] and integrators._needed([0.1]) == []


def test_methods_take_turns_and_are_told_over_rk8(monkeypatch):
    """Of a scene of 1 ms and two methods, each round anew."""
    kept, ladders = ("rk4", "rk8"), integrators._ladders
    monkeypatch.setattr(integrators, "TIME", 0.001)
    monkeypatch.setattr(integrators, "OUTPUTS", 21)
    monkeypatch.setattr(integrators, "BATCH", 0.1)
    monkeypatch.setattr(
        integrators, "_ladders", lambda scene: (one for one in ladders(scene) if one[0] in kept)
    )
    rows = integrators.run(2)
    assert [row["method"] for row in rows] == ["rk4", "rk8"] * 3
    for row in rows:
        share = {"rk4": row["over_rk8_1e-09"], "rk8": 1.0}[row["method"]]
        assert row["over_rk8_1e-09"] == share > 0.0 and row["error"] < 1e-9
        assert row["ms_1e-03"] > 0.0 and row["over_rk8_1e-03"] > 0.0


@pytest.mark.slow
def test_every_method_reaches_its_errors_by_its_order(monkeypatch):
    monkeypatch.setattr(integrators, "PATIENCE", 30.0)
    monkeypatch.setattr(integrators, "BATCH", 0.0)
    monkeypatch.setattr(integrators, "TIME", 0.005)
    monkeypatch.setattr(integrators, "OUTPUTS", 101)
    rows = integrators.run(1)
    assert "integrators" in names() and len(rows) == 30
    orders = {"newmark": 2, "hht": 2, "generalised_alpha": 2, "rk4": 4, "symplectic": 6, "rk8": 8}
    for row in rows:
        if row["method"] in orders:
            assert row["order"] == pytest.approx(orders[row["method"]], abs=0.3)
            assert row["error"] < (1e-9 if row["method"] == "rk8" else 3e-3)
        else:
            assert row["order"] is None and row["error"] < 0.1
