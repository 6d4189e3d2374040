"""`gearopt bench curvature`: the closed form, derivatives, and what data allow."""

import numpy as np
import pytest

from gearopt.bench import curvature, names
from gearopt.physics.strain_wave.fitted_curvature import FITS


def test_rows_say_which_methods_are_right(monkeypatch):
    monkeypatch.setattr(curvature, "SEEDS", 5)
    rows = curvature.run(1)
    assert "curvature" in names() and len(rows) == 3 + 3 * 4 * len(FITS)
    closed, derivatives, rings = rows[:3]
    assert closed["radius"] < 1e-13 and derivatives["curvature"] < 1e-12
    assert derivatives["radius"] < 1e-11 and rings["radius"] == 0.012
    by = {(r["method"], r["data"], r["points"]): r for r in rows}
    printed = {  # of exact data at 51 points, from another program: curvature, R, p0
        "quartic fit": (2.1e-4, 4.9e-3, 2.5e-3),
        "cubic spline": (1.0e-5, 2.3e-4, 1.2e-4),
        "finite differences": (1.1e-3, 2.6e-2, 1.3e-2),
    }
    for method, errors in printed.items():
        row = by[method, "exact", 51]
        assert [row[k] for k in ("curvature", "radius", "p0")] == pytest.approx(errors, rel=0.2)
    assert by["quintic spline", "exact", 51]["p0"] < 1e-7
    noisy = {m: by[m, "1 nm", 201]["p0"] for m in FITS}
    assert min(noisy, key=noisy.get) == "quartic fit" and noisy["cubic spline"] > 1.0
    assert 0.2 < by["quartic fit", "0.1 um", 201]["p0"]
    assert by["cubic spline", "1 nm", 201]["wrong_sign"] > 40


@pytest.mark.parametrize("name", list(FITS))
def test_fits_of_a_circle(name):
    x = np.linspace(-1.0, 1.0, 201)
    found = FITS[name](x, -np.sqrt(100.0 - x * x), np.linspace(-0.9, 0.9, 9))
    assert found == pytest.approx(np.full(9, 0.1), rel=2e-4)
