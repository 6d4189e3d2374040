"""`gearopt bench wave_sharing`: three ways to the same loads, each with its error."""

import pytest

from gearopt.bench import names, wave_sharing


@pytest.mark.slow
def test_rows_agree_and_meet_the_conditions_of_a_minimum(monkeypatch):
    """Teeth that carry and largest loads [N] at 20 N m are those of another program."""
    monkeypatch.setattr(wave_sharing, "TORQUES", (20.0,))
    rows = wave_sharing.run(1)
    assert "wave_sharing" in names()
    assert [r["method"] for r in rows] == 2 * ["active set", "qp", "conic (Clarabel)"]
    for row in rows:
        carrying, most = (3, 94.4) if row["rim"] == "rigid" else (4, 90.7)
        assert row["carrying"] == carrying
        assert row["largest_N"] == pytest.approx(most, abs=0.06)
        assert row["error_N"] < 3e-6
