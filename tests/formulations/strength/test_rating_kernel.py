"""Kernels of first widths against the same text of arrays."""

import numpy as np
import pytest
from campaigns import few
from rated_drives import agma
from test_iso_rows import KINDS, pairs, rows

from gearopt.formulations.strength import ALLOWANCE, widths
from gearopt.optimise import kernels

STANDARDS = KINDS | {"agma": (agma(), 0.3), "agma, spur": (agma(), 0.0)}
STANDARDS |= {"agma, given": (agma(given={"J": (0.4, 0.3), "K_m": 1.4}), 0.3)}


@pytest.mark.parametrize("kind", few(STANDARDS, ["2019", "agma"]))
@pytest.mark.parametrize("wide", [1.0, 1.02])
def test_numbers_and_arrays_give_the_same_widths(kind, wide):
    standard, helix = STANDARDS[kind]
    pair, width, torque, power, _ = pairs(helix, 3)
    for _ in range(6):  # so that these widths carry, more or less
        used = rows(standard, pair, (torque, torque), power).used(width, width)
        grown = np.where(np.isfinite(used), np.clip(used, 0.3, 3.0) ** -0.95, 1.0)
        torque, power = torque * grown, power * grown
    made = rows(standard, pair, (torque, torque * wide), power)
    ends = 0.4 * width, 1.5 * width
    name, numbers = made.posed
    kernel = getattr(kernels.kernel(widths.KERNEL), name)
    for close, steps in ((ALLOWANCE, widths.MAX_STEPS), (ALLOWANCE, 4), (0.01, 8)):
        expected = widths._first_width_numpy(made, *ends, close, steps)
        found = kernel(*numbers, *ends, close, steps)
        alike = np.isclose(found, expected, rtol=1e-12, atol=0.0)
        some = np.isfinite(expected) & np.isfinite(found)
        both = (np.where(some, w, width) for w in (found, expected))
        used, known = (made.used(w, w) for w in both)  # widths end within 1e-12 of what is used
        assert (alike | (some & np.isclose(used, known, rtol=1e-12, atol=0.0))).all()
        assert some.any()


def test_a_process_of_many_rows_takes_the_kernel(monkeypatch):
    own = widths.Compiled(widths.FEW - 400)
    monkeypatch.setattr(widths, "compiled", lambda: own)
    standard, helix = STANDARDS["agma"]
    pair, width, torque, power, _ = pairs(helix, 3)
    made = rows(standard, pair, (torque, torque), power)
    monkeypatch.setattr(kernels.warm(), "seconds", kernels.PATIENCE)
    of_arrays = []
    real = widths._first_width_numpy
    monkeypatch.setattr(widths, "_first_width_numpy", lambda *a: of_arrays.append(a) or real(*a))
    first, second = (widths.first_width(made, 0.4 * width, width) for _ in range(2))
    np.testing.assert_allclose(first, second, rtol=1e-12)
    assert len(of_arrays) == 1


def test_kernels_are_not_loaded_where_little_time_is_left():
    own = widths.Compiled(widths.FEW)
    assert own.of("agma_widths", 1, lambda: 0.5 * widths.LOADING) is None
    assert own.kernel is None
