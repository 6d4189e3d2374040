"""`gearopt bench wave_cutter`: rolls against the envelope, and edges that replace it."""

import numpy as np
import pytest

from gearopt.bench import names, wave_cutter
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.cutter import blank_profile


def test_rolls_come_near_the_envelope_where_they_reach_and_are_not_as_printed():
    """um, from another program."""
    blank = blank_profile(flank(wave_cutter.GEARING, 401))
    rack, pinion = wave_cutter._exact(blank, 1)
    assert rack["error_um"] < 1e-9 and pinion["error_um"] < 1e-9
    rows = wave_cutter._rolled(blank, 1)
    assert [r["steps"] for r in rows] == [21, 81, 321, 321, 321]
    found = [r["error_um"] for r in rows]
    assert found[:2] == pytest.approx([0.039, 0.002], rel=0.15) and found[2] < 1e-3
    assert found[3:] == pytest.approx([1.4, 20.5], abs=0.05)


@pytest.mark.slow
def test_cones_and_linear_programs_find_the_same_arcs(monkeypatch):
    monkeypatch.setattr(wave_cutter, "EVERY", 20)
    monkeypatch.setattr(wave_cutter, "CUTTERS", {"rack": np.inf})
    assert "wave_cutter" in names()
    line, squares, arc, cones, bounded = wave_cutter.run(1)[6:]
    assert line["error_um"] < squares["error_um"] and arc["error_um"] < line["error_um"]
    assert (cones["radius_mm"], cones["error_um"]) == pytest.approx(
        (arc["radius_mm"], arc["error_um"]), rel=1e-3
    )
    assert arc["error_um"] < bounded["error_um"] < line["error_um"]
    assert bounded["radius_mm"] == wave_cutter.LEAST_RADII["rack"]
