"""Data of teeth made in blocks against those made at once."""

from dataclasses import dataclass

import numpy as np
import pytest
from rated_drives import RACK, agma, iso

from gearopt.formulations.drive.teeth import prepared
from gearopt.physics.gears import GearPair

COUNT, BLOCK = 59, 7


@dataclass(frozen=True)
class Numbers:
    """A table of one column."""

    value: np.ndarray

    def take(self, place):
        """Some of its rows."""
        return Numbers(self.value[place])


def columns(value):
    """All arrays and numbers of a table."""
    if isinstance(value, tuple):
        return [column for part in value for column in columns(part)]
    return [value] if np.ndim(value) or np.isscalar(value) else columns(tuple(vars(value).values()))


def test_few_teeth_of_many_blocks_are_made_alone(monkeypatch):
    monkeypatch.setattr(prepared, "BLOCK", 10)
    monkeypatch.setattr(prepared, "CALL", 1)
    asked = []

    def make(shapes):
        asked.append(list(shapes))
        return Numbers(shapes * 2.0)

    data = prepared.Prepared(100, make)
    some = np.array([90, 5, 41, 5])
    for _ in range(2):
        assert data.take(some).value.tolist() == [180.0, 10.0, 82.0, 10.0]
    assert asked == [[5, 41, 90]]  # once, and without the rest of three blocks
    others = np.array([1, 11, 21, 31, 41, 51, 61, 71, 81, 91])
    for k in range(1, 10):  # blocks are made before so much is spent on shapes apart
        shapes = others[: k + 1] + k % 9
        assert data.take(shapes).value.tolist() == (2.0 * shapes).tolist()
    assert sum(map(len, asked)) <= 200 and len(data.blocks) >= 5


@pytest.mark.parametrize("standard", [agma(), iso()], ids=["agma", "iso"])
@pytest.mark.parametrize("helices", [(0.0,), (0.3,), (0.0, 0.3)])
def test_rows_are_those_of_all_teeth(standard, helices, monkeypatch):
    monkeypatch.setattr(prepared, "BLOCK", BLOCK)
    rng = np.random.default_rng(len(helices))
    z1 = rng.integers(17, 40, COUNT).astype(float)
    z2, several = np.ceil(z1 * rng.uniform(1.0, 6.0, COUNT)), len(helices) > 1
    helix = rng.choice(helices, COUNT)
    helix[: 2 * BLOCK] = helices[0]  # blocks of one angle beside others
    asked = []

    def make(shapes):
        asked.extend(shapes)
        angle = helix[shapes] if several else helices[0]
        return standard.prepared(
            GearPair.of_teeth(np.ones(len(shapes)), z1[shapes], z2[shapes], 1.0, angle, RACK)
        )

    every = make(np.arange(COUNT))
    asked.clear()
    data = prepared.Prepared(COUNT, make)
    assert not len(columns(data.take(np.zeros(0, np.int64)))[0])
    rows = [np.array([3, 1, 3]), np.array([58, 2, 40, 9]), rng.integers(0, COUNT, 80)]
    for place in rows:
        for table, shapes in ((data, place), (data.part(place).part(np.arange(2)), np.array([1]))):
            expected = every.take(place if table is data else place[:2][shapes])
            pairs = zip(columns(table.take(shapes)), columns(expected), strict=True)
            assert all(np.array_equal(*pair, equal_nan=True) for pair in pairs)
        assert len(asked) == len(set(asked))  # each is made once
    assert len(asked) == COUNT
