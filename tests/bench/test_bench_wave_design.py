"""`gearopt bench wave_design`: what samplers reach, and the interference that they hide."""

import numpy as np
import pytest

from gearopt.bench import names, wave_design


@pytest.mark.slow
def test_samplers_stay_above_the_exchange_and_tell_what_cuts(monkeypatch):
    """92.568 MPa is the least pressure that another program found without interference."""
    monkeypatch.setattr(wave_design, "EVALUATIONS", 480)
    monkeypatch.setattr(wave_design, "STARTS", wave_design.STARTS[:1])
    monkeypatch.setattr(wave_design, "_exchanged", lambda: [])
    assert "wave_design" in names()
    annealing, evolution, front = wave_design.run(2)
    for row in (annealing, evolution):
        assert row["found"] + row["cutting"] == 2 and row["found"] > 0  # what cuts is no answer
        assert 92.5 < row["pressure_MPa"] <= row["worst_MPa"] < 140.0
        assert (row["cutting"] > 0) == (row["least_gap_um"] < -0.01)
    assert front["found"] > 20 and front["cutting"] == 0
    least, worst = (float(v.strip("()")) for v in front["volume"].split())
    assert 400.0 < least <= worst < 700.0
    most, fewest = (float(v.strip("()")) for v in front["teeth"].split())
    assert np.all(np.diff([6.0, fewest, most, 12.0]) >= 0.0)
