"""`gearopt bench smooth`: where the smooth form is exact, and the errors that the page tells."""

from pathlib import Path

import numpy as np
import pytest

from gearopt.bench import names, smooth
from gearopt.physics.agma.smooth import smooth_error
from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.batch import smooth_error as iso_error

PAGE = Path(__file__).parents[2] / "docs" / "rate.md"


def test_rows_are_errors_of_pairs_one_at_a_time(monkeypatch):
    """No error of spur gears and low overlap by AGMA; the worst of the others is that of a pair."""
    monkeypatch.setattr(smooth, "COUNT", 12)
    rows = smooth.run(1)
    assert "smooth" in names() and len(rows) == 20
    assert all(row["worst"] < 1e-9 and row["pairs"] == 12 for row in rows[:8])
    assert all(row["median"] <= row["of_1000"] <= row["worst"] for row in rows)
    pair, _ = smooth.random_pairs(smooth.OVERLAPS["conventional"], 2)
    found = [smooth_error(one(pair, k), "conventional")[1] for k in range(12)]
    assert rows[8]["worst"] == pytest.approx(100.0 * np.abs(found).max(), rel=1e-9)
    pair, speed = smooth.random_pairs((0.0, 0.0), 10)
    torque = smooth._torque(smooth.ISO, pair, speed)
    found = []
    for k in range(12):
        case = smooth.ISO.case(one(pair, k), torque[k], speed[k])
        found.append(iso_error(case.pair, case.operation, case.materials, case.practice)[0])
    assert rows[12]["worst"] == pytest.approx(100.0 * np.abs(found).max(), rel=1e-9)


def one(pair, k):
    """One of the pairs, of floats."""
    pinion, wheel = pair.gears
    numbers = (g[k] for g in (pinion.normal_module, pinion.teeth, wheel.teeth, pinion.face_width))
    return GearPair.of_teeth(*map(float, numbers), float(pinion.helix_angle[k]))


@pytest.mark.slow
def test_the_page_has_its_errors():
    """Of pinion and wheel the errors are the same; what is unsafe and called safe is not."""
    lines = []
    rows = smooth.run(1)
    for first, second in zip(rows[::2], rows[1::2], strict=True):
        assert first["worst"] == pytest.approx(second["worst"], abs=1e-9)
        limit = first["limit"].removeprefix("pinion_")
        errors = (f"{first[key]:.1f}" for key in ("median", "of_1000", "worst"))
        wrong = (
            f"{first[key]}, {second[key]}" for key in ("unsafe_called_safe", "safe_called_unsafe")
        )
        lines.append(f"| {' | '.join((first['case'], limit, *errors, *wrong))} |")
    assert "|---|\n" + "\n".join(lines) + "\n" in PAGE.read_text(encoding="utf-8")
