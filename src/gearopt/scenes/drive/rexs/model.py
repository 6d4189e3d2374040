"""A REXS model: components with attributes, relations, load cases, and what an attribute says."""

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from decimal import Decimal, InvalidOperation
from functools import cached_property
from itertools import zip_longest
from pathlib import Path
from typing import Any

from gearopt.errors import SceneError
from gearopt.frozen import dataclass
from gearopt.scenes.reading.toml_writing import short

VERSION = "2.0.0"
EDITIONS = ("2019", "2006")  # of ISO 6336 in attributes
Keys = dict[str, Any]  # of a table of a problem file; values that the REXS file says are `Said`


@dataclass(frozen=True)
class Spec:
    """An attribute of the schema: unit, sort, least value, ids of earlier versions.

    key: of a problem file, `times` of which it is, a number or "m", the normal module. result: the
    field of an answer that it is, where it is written alone.
    """

    unit: str
    sort: str
    range: str
    formerly: tuple[str, ...]
    times: str
    key: str
    result: str


def _specs() -> dict[str, dict[str, Spec]]:
    """Attributes of `attributes.csv` by component and id."""
    specs: dict[str, dict[str, Spec]] = {}
    with Path(__file__).with_name("attributes.csv").open(encoding="utf-8", newline="") as rows:
        for row in csv.DictReader(rows):
            of_schema = row["unit"], row["sort"], row["range"], tuple(row["formerly"].split())
            times, _, key = row["key"].rpartition(" ")
            results = row["result"].split()
            for name, result in zip_longest(row["attribute"].split(), results, fillvalue=""):
                names = [name.replace("*", year) for year in EDITIONS]
                for of in row["components"].split():
                    each = dict.fromkeys(names, Spec(*of_schema, times, key, result))
                    specs[of] = specs.get(of, {}) | each
    return specs


SPECS = _specs()
BY_NAME = {name: spec for specs in SPECS.values() for name, spec in specs.items()}
UNITS = {  # unit of the schema: other units of files, of its size
    "mm": {"mum": "0.001", "m": "1000"},
    "mum": {"mm": "1000"},
    "deg": {"\u00b0": "1", "degree": "1", "rad": repr(math.degrees(1.0))},
    "MPa": {"N / mm^2": "1", "N/mm^2": "1", "GPa": "1000"},
    "N m": {"Nm": "1", "kN m": "1000", "N mm": "0.001"},
    "kW": {"W": "0.001"},
    "1 / min": {"1/min": "1", "1 / s": "60"},
    "kg / dm^3": {"kg / m^3": "0.001"},
    "none": {"-": "1"},
}
TOML_UNITS = {"1 / min": "rpm", "kg / dm^3": "kg/dm^3", "mm^2 / s": "mm^2/s", "mum": "um"}
GEARS = ("cylindrical_gear", "ring_gear")
BETA = "helix_angle_reference_diameter"
DIGITS = 40  # at most, of a number
PLACES = 20  # before and after the point, of numbers without an exponent
SMALL = 12  # digits after the point of what follows from lengths


def wrong(key: object, value: Any, rule: str, remedy: str) -> SceneError:
    """An error at a place of a REXS file, whose name the reader adds."""
    return SceneError("", str(key), "" if value is None else short(value), rule, remedy)


@dataclass(frozen=True)
class Said:
    """A value for a problem file, and the place of the REXS file that says it.

    needed: nothing says it, and the value is a sample.
    """

    value: Any
    origin: str
    needed: bool = False


@dataclass(frozen=True)
class Component:
    """A component, or what a load case says of it.

    attributes: value and unit, as the file has them. used: ids of those that were asked for.
    """

    id: int
    type: str
    name: str
    attributes: dict[str, tuple[Any, str]]
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
        former = BY_NAME[name].formerly if name in BY_NAME else ()
        return next((n for n in (name, *former) if n in self.attributes), None)

    def get(self, name: str) -> tuple[Any, str]:
        """Value and unit of an attribute, which counts as used; (None, "") where it is unknown."""
        written = self._written(name)
        self.used.update((written,) if written else ())
        return self.attributes[written] if written else (None, "")

    def number(self, name: str) -> Decimal | None:
        """A number in the unit of the schema; SceneError where it is none, or out of its range."""
        (held, unit), spec = self.get(name), BY_NAME[name]
        if held is None:
            return None
        value, sort = as_number(held), "whole number" if spec.sort == "integer" else "number"
        factor = {"": "1", spec.unit: "1", **UNITS.get(spec.unit, {})}.get(unit)
        low, bound = (
            Decimal(spec.range.lstrip(">=") or "-inf"),
            "at least" if "=" in spec.range else "above",
        )
        rule, remedy = "", "Correct it in the program that wrote the file"
        if value is None or (spec.sort == "integer" and value != value.to_integral_value()):
            rule, remedy = f"is no {sort}", f"Write a {sort}"
        elif factor is None:
            rule = f"is in {unit}, and the unit of the schema is {spec.unit}"
            remedy = f"Write it in {spec.unit}"
        elif (scaled := value * Decimal(factor)) > low or (scaled == low and "=" in spec.range):
            return scaled
        else:
            rule = f"is not {bound} {low} {'' if spec.unit == 'none' else spec.unit}".rstrip()
        raise wrong(self.at(name), str(held).strip(), rule, remedy)

    def needed(self, name: str) -> Decimal:
        """A number without which there is no gear."""
        value = self.number(name)
        if value is None:
            raise wrong(self.at(name), None, "is missing", "Export the geometry of all gears")
        return value

    def said(self, name: str) -> Said | None:
        """A number as a problem file has it, with its unit."""
        value, spec = self.number(name), BY_NAME[name]
        if value is None:
            return None
        return Said(in_unit(value, spec.unit, spec.sort == "integer"), self.at(name))

    def word(self, name: str) -> str | None:
        """A text; None: it is unknown."""
        value, _ = self.get(name)
        return None if value is None else str(value).strip()


def as_number(value: Any) -> Decimal | None:
    """A finite number of a file, None where it is none."""
    text = str(value).strip()
    try:
        number = Decimal(text) if len(text) <= DIGITS else Decimal("nan")
    except InvalidOperation:
        return None
    return number if number.is_finite() and abs(number) <= Decimal("1e30") else None


def in_unit(value: Decimal | float, unit: str, whole: bool = False) -> Any:
    """A number of a REXS file as a problem file writes it; unit: of the schema."""
    number = (value if isinstance(value, Decimal) else Decimal(repr(value))).normalize()
    if -PLACES < number.adjusted() < PLACES:  # without an exponent
        number = Decimal(f"{number:f}")
    if unit != "none":
        return f"{number} {TOML_UNITS.get(unit, unit)}"
    return int(number) if whole else number


def rounded(value: Decimal | float) -> Decimal:
    """A number without the rounding errors of what it follows from."""
    return round(Decimal(value), SMALL).normalize()


def same(alike: Iterable[Component], name: str) -> tuple[Component, Decimal] | None:
    """A number that components have alike, and one that says it; None: none says it."""
    known: tuple[Component, Decimal] | None = None
    for component in alike:
        value = component.number(name)
        if known is not None and value is not None and value != known[1]:
            rule = f"differs from {known[1]} of {known[0]}"
            raise wrong(component.at(name), str(value), rule, "gearopt takes equal ones alone")
        known = known or (None if value is None else (component, value))
    return known


def keys_of(
    alike: Sequence[Component], type: str = "", m: Decimal = Decimal(1), leave: str = ""
) -> Keys:
    """Keys of a problem file that components say alike; m: normal module [mm].

    The first attribute of a key counts. Numbers without a unit, and lengths in modules, that are 0
    are left out: it is what is usual, but of radii. type: of the attributes, where not theirs.
    leave: a key.
    """
    keys: Keys = {}
    for name, spec in SPECS[type or alike[0].type].items() if alike else ():
        if spec.key in ("", leave, *keys) or (known := same(alike, name)) is None:
            continue
        component, value = known
        if spec.times == "m":
            number = in_unit(rounded(value / m), "none")
        else:
            value = value / Decimal(spec.times or 1)
            number = in_unit(value, spec.unit, spec.sort == "integer")
        keys[spec.key] = Said(number, component.at(name))
    return {key: s for key, s in keys.items() if s.value or key.endswith("tip_radius")}


@dataclass(frozen=True)
class Relation:
    """A relation: its type, and the component of every role."""

    type: str
    refs: Mapping[str, int]
    order: int = 0


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

    @cached_property
    def _by_role(self) -> dict[tuple[str, str, int], list[Mapping[str, int]]]:
        """Relations by their type and a component of a role."""
        known: dict[tuple[str, str, int], list[Mapping[str, int]]] = {}
        for relation in self.relations:
            for role, number in relation.refs.items():
                known.setdefault((relation.type, role, number), []).append(relation.refs)
        return known

    def of_type(self, *types: str) -> list[Component]:
        """Components of some types, in the order of the file."""
        return [c for c in self.components.values() if c.type in types]

    def related(self, type: str, role: str, of: int, other: str, *kinds: str) -> list[Component]:
        """Components of a role, of some types, in relations where `of` has another role."""
        refs = self._by_role.get((type, role, of), ())
        parts = [self.components[each[other]] for each in refs if other in each]
        return [c for c in parts if not kinds or c.type in kinds]
