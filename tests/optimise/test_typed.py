"""Dataclasses to plain data and back."""

from dataclasses import dataclass

import pytest

from gearopt.optimise.typed import typed, untyped


@dataclass(frozen=True)
class Gear:
    name: str
    bore_mm: float | None
    teeth: tuple[int, ...] = ()
    sector: float = 1.0


@dataclass(frozen=True)
class Train:
    gears: tuple[Gear, ...]
    ratio: float | None = None


def test_what_holds_its_default_is_left_out_and_read_again():
    train = Train((Gear("1", None), Gear("2", 3.0, (17, 19), 0.25)))
    plain = untyped(train)
    first = {"name": "1", "bore_mm": None}
    assert plain == {
        "gears": [first, {"name": "2", "bore_mm": 3.0, "teeth": [17, 19], "sector": 0.25}]
    }
    assert typed(Train, plain) == train


def test_unknown_and_missing_keys_are_named():
    with pytest.raises(ValueError, match=r"unknown keys in gears\[1\]: tip"):
        typed(Train, {"gears": [{"name": "1", "bore_mm": 1.0, "tip": 2.0}]})
    with pytest.raises(ValueError, match=r"lacks keys in gears\[1\]: bore_mm"):
        typed(Train, {"gears": [{"name": "1"}]})
