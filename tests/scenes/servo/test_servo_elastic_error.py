"""A servo axis with bearing fits and with mesh stiffness that varies, by hand and by remedies."""

import json
import math
import re
from decimal import Decimal

import pytest
from servo_files import TOLERANCES, changed, solved, text

from gearopt.errors import SceneError

STIFF, IMPOSSIBLE = text("gimbal_stiff"), text("gimbal_impossible")
FIT = ("mesh", 0, "wheel_bearing_fit")
VARIED = ("stiffness", "mesh_variation")


def test_a_fit_is_a_row_of_the_error_and_a_tolerance():
    """4 um of the wheel of stage 1: 2 e/(r_b n_2) at the output."""
    result = solved(TOLERANCES, (FIT, "4 um"))
    (row,) = (e for e in result.design["errors"] if e["source"] == "bearing fit of wheel 1")
    base = 0.5 * 96 * 0.5 * math.cos(math.radians(20.0))
    assert row["error_deg"] == pytest.approx(math.degrees(2 * 4e-3 / base / 8.0), rel=1e-12)
    assert row["kind"] == "backlash" and row["tolerance_mm"] == 0.004
    assert "bearing fit of wheel 1" in [t["name"] for t in result.design["tolerances"]]


def test_what_the_windup_varies_by_is_held_with_the_error():
    """Rows, sum and stiffness of the chosen train, from its teeth and the numbers of the file."""
    result = solved(STIFF, (VARIED, "50 %"), (("stiffness", "load_torque"), "10 N m"))
    design = result.design
    scene = changed(STIFF)
    k, b = scene.stiffness.line_stiffness.value, scene.train.face_width.value
    first, second = design["train"]["stages"]
    n = second["ratio"]
    soft = [4.0 / (k * b * s["wheel_diameter_mm"] ** 2) for s in (first, second)]
    varied = [math.degrees(1e4 * c * (1 / 0.75 - 1 / 1.25)) for c in (soft[0] / n**2, soft[1])]
    rows = [e for e in design["errors"] if e["kind"] == "elastic"]
    assert [e["error_deg"] for e in rows] == pytest.approx(varied, rel=1e-9)
    assert result.report["elastic_deg"] == pytest.approx(sum(varied), rel=1e-9)
    total = sum(e["error_deg"] for e in design["errors"])
    assert design["train"]["error_deg"] == pytest.approx(total, rel=1e-12)
    asked = math.degrees(scene.accuracy.error.value)
    assert result.limits["error"] == pytest.approx(total / asked, rel=1e-9)
    shaft = 32 * 50.0 / (math.pi * scene.stiffness.shear_modulus.value * 8.0**4) / n**2
    compliance = shaft + (soft[0] / n**2 + soft[1]) / 0.75
    found = design["stiffness"]
    assert 1e3 * found["output_Nm_per_rad"] == pytest.approx(1.0 / compliance, rel=1e-9)
    assert found["windup_variation_deg"] == pytest.approx(sum(varied), rel=1e-9)
    assert found["frequency_Hz"] >= 200.0 * (1 - 1e-9)


def test_a_variation_alone_over_the_maximum_is_refused():
    with pytest.raises(SceneError, match="mesh_variation"):
        changed(STIFF, (VARIED, "150 %"))


@pytest.mark.slow
def test_remedies_of_an_error_that_the_load_makes():
    """0.1 degrees are possible without a load; each remedy is read and solved again."""
    springs = {
        "mesh_variation": "50 %",
        "shear_modulus": "86.1 GPa",
        "line_stiffness": "10300 MPa",
        "load_torque": "20 N m",
    }
    edits = ((("accuracy", "error"), "0.1 deg"), (("stiffness",), springs))
    assert solved(IMPOSSIBLE, edits[0]).status == "optimal"
    found = solved(IMPOSSIBLE, *edits)
    ways = {way["what"]: way["changes"] for way in found.report["ways_out"]["remedies"]}
    assert {"stiffness.mesh_variation", "stiffness.load_torque", "all deviations"} <= set(ways)
    for what in ("stiffness.mesh_variation", "stiffness.load_torque", "all deviations"):
        written = [
            (place(c["key"]), json.loads(c["write"], parse_float=Decimal)) for c in ways[what]
        ]
        again = solved(IMPOSSIBLE, *edits, *written)
        assert again.status == "optimal" and again.limits["error"] > 0.999, what
    factors = [c["factor"] for c in ways["all deviations"]]
    assert min(factors) > max(c["factor"] for c in ways["accuracy.error"])  # the load's part stays


def place(key):
    """Where `mesh[1].pitch` stands in a file."""
    return tuple(int(k) - 1 if k.isdigit() else k for k in re.findall(r"\w+", key))
