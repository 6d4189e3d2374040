"""A REXS model: components with attributes, relations, load cases, and what an attribute says."""

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any

from gearopt.errors import SceneError
from gearopt.frozen import dataclass
from gearopt.scenes.reading.toml_writing import short

VERSION = "2.0.0"
Value = str | float | int | bool | list[Any]


@dataclass(frozen=True)
class Spec:
    """An attribute of the schema: unit, sort, least value, ids of earlier versions."""

    unit: str
    sort: str
    range: str
    formerly: tuple[str, ...]


def _specs() -> dict[tuple[str, str], Spec]:
    """Attributes of `attributes.csv` by component and id."""
    specs: dict[tuple[str, str], Spec] = {}
    with Path(__file__).with_name("attributes.csv").open(encoding="utf-8", newline="") as rows:
        for row in csv.DictReader(rows):
            spec = Spec(row["unit"], row["sort"], row["range"], tuple(row["formerly"].split()))
            specs |= {(of, row["attribute"]): spec for of in row["components"].split()}
    return specs


SPECS = _specs()
BY_NAME = {name: spec for (_, name), spec in SPECS.items()}
UNITS: dict[str, dict[str, Decimal]] = {  # unit of the schema: units of files, of its size
    "mm": {"mm": Decimal(1), "mum": Decimal("0.001"), "m": Decimal(1000)},
    "mum": {"mum": Decimal(1), "mm": Decimal(1000)},
    "deg": {
        **dict.fromkeys(("deg", "\u00b0", "degree"), Decimal(1)),
        "rad": Decimal(repr(math.degrees(1.0))),
    },
    "MPa": {**dict.fromkeys(("MPa", "N / mm^2", "N/mm^2"), Decimal(1)), "GPa": Decimal(1000)},
    "N m": {"N m": Decimal(1), "Nm": Decimal(1), "kN m": Decimal(1000), "N mm": Decimal("0.001")},
    "kW": {"kW": Decimal(1), "W": Decimal("0.001")},
    "1 / min": {"1 / min": Decimal(1), "1/min": Decimal(1), "1 / s": Decimal(60)},
    "h": {"h": Decimal(1)},
    "%": {"%": Decimal(1)},
    "kg / dm^3": {"kg / dm^3": Decimal(1), "kg / m^3": Decimal("0.001")},
    "none": dict.fromkeys(("none", "-"), Decimal(1)),
}
TOML_UNITS = {
    **{"1 / min": "rpm", "kg / dm^3": "kg/dm^3", "mm^2 / s": "mm^2/s", "mum": "um", "none": ""},
    **{"%": "%", "HB": "HB", "HV": "HV", "mm": "mm", "deg": "deg", "MPa": "MPa", "N m": "N m"},
    **{"kW": "kW", "h": "h"},
}
DIGITS = 40  # at most, of a number
PLACES = 20  # before and after the point, of numbers without an exponent


def wrong(key: str, value: Any, rule: str, remedy: str) -> SceneError:
    """An error at a place of a REXS file, whose name the reader adds."""
    return SceneError("", key, "" if value is None else short(value), rule, remedy)


@dataclass(frozen=True)
class Said:
    """A value for a problem file, and the place of the REXS file that says it.

    needed: nothing says it, and the value is a sample.
    """

    value: Any
    origin: str
    needed: bool = False


@dataclass(frozen=True)
class Attribute:
    """Value and unit of an attribute, as the file has them."""

    value: Value
    unit: str = ""


@dataclass(frozen=True)
class Component:
    """A component, or what a load case says of it; used: ids of attributes that were asked for."""

    id: int
    type: str
    name: str
    attributes: Mapping[str, Attribute]
    place: str = ""
    used: set[str] = field(default_factory=set)

    def __str__(self) -> str:
        return f"{self.place}component {self.id} ({self.type})"

    def at(self, name: str) -> str:
        """The place of an attribute, for messages."""
        return f"{self}.{self._written(name) or name}"

    def has(self, name: str) -> bool:
        """Whether the file says anything of an attribute, by its id now or of earlier versions."""
        return self._written(name) is not None

    def _written(self, name: str) -> str | None:
        spec = BY_NAME.get(name)
        known = (name, *(spec.formerly if spec else ()))
        return next((n for n in known if n in self.attributes), None)

    def get(self, name: str) -> Attribute | None:
        """An attribute, which counts as used; None: it is unknown."""
        written = self._written(name)
        if written is None:
            return None
        self.used.add(written)
        return self.attributes[written]

    def number(self, name: str) -> Decimal | None:
        """A number in the unit of the schema; SceneError where it is none, or out of its range."""
        attribute, spec = self.get(name), BY_NAME[name]
        if attribute is None:
            return None
        text = str(attribute.value).strip()
        sort = "whole number" if spec.sort == "integer" else "number"
        try:
            value = Decimal(text) if len(text) <= DIGITS else Decimal("nan")
        except InvalidOperation:
            value = Decimal("nan")
        if not value.is_finite() or abs(value) > Decimal("1e30"):
            raise wrong(self.at(name), attribute.value, f"is no {sort}", f"Write a {sort}")
        known = UNITS.get(spec.unit, {spec.unit: Decimal(1)})
        unit = attribute.unit.strip() or spec.unit
        if unit not in known:
            rule = f"is in {unit}, and the unit of the schema is {spec.unit}"
            raise wrong(self.at(name), text, rule, f"Write it in {spec.unit}")
        if sort == "whole number" and value != value.to_integral_value():
            raise wrong(self.at(name), text, "is no whole number", "Write a whole number")
        value *= known[unit]
        low = Decimal(spec.range.lstrip(">=")) if spec.range else None
        if low is not None and (value < low or (value == low and "=" not in spec.range)):
            words = f"at least {low}" if "=" in spec.range else f"above {low}"
            rule = f"is not {words} {'' if spec.unit == 'none' else spec.unit}".rstrip()
            raise wrong(self.at(name), text, rule, "Correct it in the program that wrote the file")
        return value

    def said(self, name: str, sign: bool = True) -> Said | None:
        """A number as a problem file has it, with its unit; sign: else its amount."""
        value = self.number(name)
        if value is None:
            return None
        spec, value = BY_NAME[name], value if sign else abs(value)
        return Said(in_unit(value, spec.unit, spec.sort == "integer"), self.at(name))

    def word(self, name: str) -> str | None:
        """A text; None: it is unknown."""
        attribute = self.get(name)
        return None if attribute is None else str(attribute.value).strip()


def in_unit(value: Decimal | float, unit: str, whole: bool = False) -> Any:
    """A number of a REXS file as a problem file writes it; unit: of the schema."""
    number = (value if isinstance(value, Decimal) else Decimal(repr(value))).normalize()
    if -PLACES < number.adjusted() < PLACES:  # without an exponent
        number = Decimal(f"{number:f}")
    name = TOML_UNITS[unit]
    if name:
        return f"{number} {name}"
    return int(number) if whole else number


@dataclass(frozen=True)
class Relation:
    """A relation: its type, and the component of every role."""

    type: str
    refs: tuple[tuple[str, int], ...]
    order: int = 0
    id: int = 0

    def of(self, role: str) -> int | None:
        """The component of a role."""
        return next((i for name, i in self.refs if name == role), None)


@dataclass(frozen=True)
class Model:
    """Version and source of a file, its components by id, relations by order, and load cases.

    cases: components by id that a load case changes.
    """

    version: str
    source: str
    components: Mapping[int, Component]
    relations: Sequence[Relation]
    cases: Sequence[Mapping[int, Component]] = ()

    def of_type(self, *types: str) -> list[Component]:
        """Components of some types, in the order of the file."""
        return [c for c in self.components.values() if c.type in types]

    def related(self, type: str, role: str, of: int, other: str) -> Iterator[Component]:
        """Components of a role in relations where `of` has another role, by their order."""
        for relation in self.relations:
            if relation.type == type and relation.of(role) == of:
                number = relation.of(other)
                if number is not None:
                    yield self.components[number]

    @property
    def everything(self) -> Iterator[Component]:
        """All components, also those of load cases."""
        yield from self.components.values()
        for case in self.cases:
            yield from case.values()
