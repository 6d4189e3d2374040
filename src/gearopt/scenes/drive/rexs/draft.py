"""A REXS model that is being made, and its file in XML."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import field
from datetime import UTC, datetime
from typing import Any

from gearopt.formulations.drive.design import DriveDesign
from gearopt.frozen import dataclass
from gearopt.scenes.drive.rexs.gears_read import CUSTOM
from gearopt.scenes.drive.rexs.model import (
    EDITIONS,
    SPECS,
    VERSION,
    Component,
    Model,
    Relation,
)

SIZES = {"mum": 1000, "kg / dm^3": 10**9}  # of gearopt's own units, mm and t/mm3


@dataclass(frozen=True)
class Draft:
    """A model that is being made of a drive: components and relations are numbered as they come.

    shared: materials and tools that gears share, by what they say.
    """

    scene: Any
    design: DriveDesign
    components: dict[int, Component] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)
    shared: dict[str, int] = field(default_factory=dict)

    def add(self, type: str, name: str = "", **values: Any) -> int:
        """Add a component; return its number."""
        number = len(self.components) + 1
        self.components[number] = Component(number, type, name, of_schema(type, values))
        return number

    def part(self, type: str, name: str = "", of: int = 1, **values: Any) -> int:
        """Add a component that is a part of another one, by default of the gear unit."""
        number = self.add(type, name, **values)
        self.relate("assembly", assembly=of, part=number)
        return number

    def say(self, number: int, **values: Any) -> None:
        """Add attributes to a component."""
        component = self.components[number]
        component.attributes.update(of_schema(component.type, values))

    def relate(self, type: str, order: int = 0, **roles: int) -> None:
        """Add a relation of components by role."""
        self.relations.append(Relation(type, roles, order))

    def once(self, type: str, name: str, **values: Any) -> int:
        """Add a component once for all gears that have the same; return its number."""
        key = f"{type} {sorted((k, v) for k, v in values.items() if v is not None)}"
        if key not in self.shared:
            self.shared[key] = self.add(type, name, **values)
        return self.shared[key]


def of_schema(type: str, values: Mapping[str, Any]) -> dict[str, tuple[Any, str]]:
    """Attributes with the units of the schema; what is None is left out."""
    return {
        name: (value, "none" if name.startswith(CUSTOM) else SPECS[type][name].unit)
        for name, value in values.items()
        if value is not None
    }


def attributes(
    type: str, record: Any, by: str = "key", m: float = 1.0, edition: str = ""
) -> dict[str, Any]:
    """Attributes of a component that a record says, by keys of a problem file, or by "result".

    record: an object or a dict. m: normal module [mm]. edition: of ISO 6336, where rated by it.
    """
    values: dict[str, Any] = {}
    done = set[str]()
    for name, spec in SPECS[type].items():
        source = getattr(spec, by)
        raw = record.get(source) if isinstance(record, Mapping) else getattr(record, source, None)
        if raw is None or source in done or (name[-4:] in EDITIONS and name[-4:] != edition):
            continue
        number = raw.exact[0] if hasattr(raw, "exact") else raw
        value = float(number * SIZES.get(spec.unit, 1)) * (m if spec.times == "m" else 1.0)
        if by == "key":
            if not value and spec.range == ">0":
                continue  # a length in mm may be 0
            done.add(source)
        elif spec.range:  # a ring's are below 0 inside
            value = abs(value)
        values[name] = round(value) if spec.sort == "integer" else value
    return values


def xml_of(model: Model) -> bytes:
    """A model as a REXS file in XML."""
    stamp = datetime.now(UTC).isoformat(timespec="seconds")
    application, _, version = model.source.partition(" ")
    head = {"version": VERSION, "applicationId": application, "applicationVersion": version}
    root = ET.Element("model", {**head, "date": stamp, "applicationLanguage": "en"})
    group = ET.SubElement(root, "relations")
    for k, relation in enumerate(model.relations, 1):
        order = {"order": str(relation.order)} if relation.order else {}
        about = {"id": str(k), "type": relation.type, **order}
        element = ET.SubElement(group, "relation", about)
        for role, number in relation.refs.items():
            hint = model.components[number].type
            ET.SubElement(element, "ref", {"id": str(number), "role": role, "hint": hint})
    group = ET.SubElement(root, "components")
    for component in model.components.values():
        _add(group, component)
    if model.cases:
        spectrum = ET.SubElement(root, "load_spectrum", {"id": "1"})
        for k, case in enumerate(model.cases, 1):
            group = ET.SubElement(spectrum, "load_case", {"id": str(k)})
            for component in case.values():
                _add(group, component)
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _add(group: ET.Element, component: Component) -> None:
    """Add the element of a component."""
    head = {"id": str(component.id), "type": component.type}
    head |= {"name": component.name} if component.name else {}
    element = ET.SubElement(group, "component", head)
    for id, (value, unit) in component.attributes.items():
        entry = ET.SubElement(element, "attribute", {"id": id, "unit": unit})
        if isinstance(value, list):
            array = ET.SubElement(entry, "array")
            for number in value:
                ET.SubElement(array, "c").text = str(number)
        else:
            entry.text = str(value).lower() if isinstance(value, bool) else str(value)
