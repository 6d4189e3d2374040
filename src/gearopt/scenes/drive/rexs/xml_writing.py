"""A REXS model as a file in XML."""

import xml.etree.ElementTree as ET
from datetime import UTC, datetime
from typing import Any

from gearopt.scenes.drive.rexs.model import Component, Model


def xml_of(model: Model) -> bytes:
    """A model as a REXS file in XML."""
    stamp = datetime.now(UTC).isoformat(timespec="seconds")
    application, _, version = model.source.partition(" ")
    head = {"version": model.version, "applicationId": application, "applicationVersion": version}
    root = ET.Element("model", {**head, "date": stamp, "applicationLanguage": "en"})
    group = ET.SubElement(root, "relations")
    for relation in model.relations:
        order = {"order": str(relation.order)} if relation.order else {}
        attributes = {"id": str(relation.id), "type": relation.type, **order}
        element = ET.SubElement(group, "relation", attributes)
        for role, number in relation.refs:
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
    element = ET.SubElement(
        group, "component", head | ({"name": component.name} if component.name else {})
    )
    for name, attribute in component.attributes.items():
        entry = ET.SubElement(element, "attribute", {"id": name, "unit": attribute.unit})
        if isinstance(attribute.value, list):
            array = ET.SubElement(entry, "array")
            for value in attribute.value:
                ET.SubElement(array, "c").text = _text(value)
        else:
            entry.text = _text(attribute.value)


def _text(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
