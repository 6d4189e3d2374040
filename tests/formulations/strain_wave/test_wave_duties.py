"""From a duty alone: ratios from 30 to 320 and all wave generators end stationary and clear."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from gearopt.formulations.strain_wave.demand import FREE
from gearopt.formulations.strain_wave.exchange import exchange
from gearopt.optimise.clock import Clock
from gearopt.physics.strain_wave.clearance import least_gaps
from gearopt.scenes.reading.load import read
from gearopt.scenes.strain_wave import KIND as WAVES

FROM_DUTY = WAVES.examples["strain-wave-from-duty"].text

PAGE = Path(__file__).parents[3] / "docs" / "strain_wave.md"
SHAPES = ("cosine", "ellipse", "discs")
TABLE = {  # MPa, as docs/strain_wave.md tells them
    (30, "90 mm", "100 N m"): (163.00, 170.46, 148.31),
    (50, "60 mm", "25 N m"): (110.95, None, None),
    (80, "90 mm", "100 N m"): (93.15, 94.76, 85.69),
    (100, "90 mm", "100 N m"): (86.32, 87.78, 78.36),
    (120, "120 mm", "200 N m"): (71.91, None, None),
    (160, "200 mm", "800 N m"): (59.71, 60.32, None),
    (200, "150 mm", "300 N m"): (51.84, None, None),
    (320, "90 mm", "30 N m"): (25.19, None, 22.96),
}
CASES = [
    (*duty, shape, value)
    for duty, row in TABLE.items()
    for shape, value in zip(SHAPES, row, strict=True)
    if value
]


@cache
def posed(ratio, diameter, torque, shape):
    text = FROM_DUTY.replace("ratio = 80", f"ratio = {ratio}").replace("90 mm", diameter)
    text = text.replace("100 N m", torque)
    text = text.replace("[cutter]", f'[wave_generator]\nshape = "{shape}"')
    return read(text.encode())[1]


def solved(ratio, diameter, torque, shape, start=None):
    scene = posed(ratio, diameter, torque, shape)
    demand = scene.demand()
    return demand, exchange(demand, scene.start() if start is None else start, Clock())


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "diameter", "torque", "shape", "value"), CASES)
def test_a_duty_alone_has_a_stationary_design_that_is_clear(ratio, diameter, torque, shape, value):
    demand, found = solved(ratio, diameter, torque, shape)
    assert found.result.status == "stationary" and found.clear and len(found.rounds) == 1
    assert found.result.value == pytest.approx(value, abs=6e-3)
    assert least_gaps(found.design, 0.02)[0].gap >= -1e-9  # mm, at finer poses too
    for name, number in zip(FREE, found.outcome.x, strict=False):
        low, high = demand.ranges[name]
        assert low - 1e-8 <= number <= high + 1e-8


def test_the_page_tells_these_pressures():
    told = PAGE.read_text()
    for (ratio, diameter, torque), row in TABLE.items():
        cells = (f"{v:.2f}" if v else "" for v in row)
        line = "|".join(
            f" {c} ".replace("  ", " ") for c in (ratio, f"{diameter}, {torque}", *cells)
        )
        assert f"|{line}|" in told


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [(80, "90 mm", "100 N m", "ellipse"), (320, "90 mm", "30 N m", "cosine")]
)
def test_random_starts_end_at_the_same_design(case):
    scene = posed(*case)
    low, high = np.array([scene.demand().ranges[name] for name in FREE]).T
    draw = np.random.default_rng(5)
    values = [solved(*case)[1].result.value]
    for _ in range(2):
        found = solved(*case, start=low + (high - low) * draw.random(6))[1]
        assert found.result.status == "stationary" and found.clear
        values.append(found.result.value)
    assert values == pytest.approx([values[0]] * 3, rel=1e-7)
