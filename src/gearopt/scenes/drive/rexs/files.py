"""REXS files: XML, JSON or either in a zip archive, read into a `Model`."""

import io
import json
import re
import xml.etree.ElementTree as ET
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring

from gearopt.errors import SceneError
from gearopt.scenes.drive.rexs.model import VERSION, Component, Model, Relation, wrong
from gearopt.scenes.reading.file_bytes import first_bytes

LARGEST = 20_000_000  # bytes of a file, also of one in an archive
KNOWN = re.compile(r"1\.[0-7]|2\.0(\.0)?")
ENDINGS = (".rexs", ".rexsj", ".xml", ".json")
AGAIN = "Write it again with the program that it comes from"
ROLES = {  # roles that a relation must have, of those that are read
    "stage": ("stage", "gear_1", "gear_2"),
    "stage_gear_data": ("stage", "gear", "stage_gear_data"),
    "assembly": ("assembly", "part"),
    "reference": ("origin", "referenced"),
    "side": ("assembly", "inner_part", "outer_part"),
    "flank": ("gear",),
    "planet_carrier_shaft": ("planetary_stage", "shaft"),
}
INSIDE = {  # lists of JSON: elements of XML
    **{"relations": "relation", "components": "component", "load_cases": "load_case"},
    **{"refs": "ref", "attributes": "attribute"},
}
DEEPEST = 5  # elements within one another
Raw = dict[str, Any]  # an element: its attributes and "children", as `_plain` makes them


def read_model(path: str | Path) -> Model:
    """The model of a REXS file; SceneError, without its name, says what is wrong with it."""
    try:
        data = first_bytes(path, LARGEST)
    except (OSError, ValueError) as refused:
        reason = getattr(refused, "strerror", None) or str(refused)
        raise _refused(f"cannot be read ({reason})", "Check the name") from None
    if data[:4] == b"PK\x03\x04":
        data = _unpacked(data)
    if len(data) > LARGEST:
        raise _refused(f"is larger than {LARGEST:,} bytes", "Export fewer results")
    start = data[:200].lstrip(b"\xef\xbb\xbf \t\r\n")
    if start[:1] == b"{":
        return _checked(_of_json(data))
    if start[:1] == b"<" or start[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return _checked(_of_xml(data))
    raise _refused("is neither XML nor JSON nor a zip archive", "Name a file of REXS")


def _refused(rule: str, remedy: str = AGAIN) -> SceneError:
    return wrong("", None, rule, remedy)


def _unpacked(data: bytes) -> bytes:
    """The REXS file of an archive."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            names = [n for n in archive.namelist() if n.lower().endswith(ENDINGS)]
            if len(names) != 1:
                listed = f"{len(names)} REXS files" if names else "no REXS file"
                raise _refused(f"is an archive with {listed}", "Put one into it")
            with archive.open(names[0]) as file:
                return file.read(LARGEST + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as odd:
        raise _refused(f"is a broken archive ({odd})") from None


def _of_xml(data: bytes) -> Raw:
    try:
        root = fromstring(data, forbid_dtd=True)
    except DefusedXmlException:
        rule = "declares a document type or entities, which no REXS file needs"
        raise _refused(rule, "Remove the lines <!DOCTYPE ...>") from None
    except ET.ParseError as odd:
        raise _refused(f"is not well-formed XML ({odd})") from None
    except (ValueError, LookupError) as odd:
        raise _refused(f"is XML of an unknown encoding ({odd})", "Save it as UTF-8") from None
    if (tag := _tag(root)) != "model":
        raise _refused(f"is XML, but no REXS: it begins with <{tag}>")
    raw: Raw = {**root.attrib, "relations": [], "components": [], "load_spectrum": []}
    for part in root:
        group = _tag(part)
        if group in raw and group not in root.attrib:
            raw[group] += _plain(part)[group] if group in INSIDE else [_plain(part)]
    return raw


def _plain(element: ET.Element, depth: int = 0) -> Raw:
    """An element as JSON has it; an attribute has its text or list as "value"."""
    if depth > DEEPEST:
        raise _refused("is nested too deeply")
    if _tag(element) == "attribute":
        listed = [c.text or "" for c in element.iter() if _tag(c) == "c"]
        return {**element.attrib, "value": listed if len(element) else element.text}
    inner = {
        group: [_plain(e, depth + 1) for e in element if _tag(e) == tag]
        for group, tag in INSIDE.items()
    }
    return {**element.attrib, **inner}


def _tag(element: ET.Element) -> str:
    return str(element.tag).rpartition("}")[2]


def _of_json(data: bytes) -> Raw:
    try:
        raw = json.loads(data.decode("utf-8-sig"), parse_float=str)
    except RecursionError:
        raise _refused("is nested too deeply") from None
    except ValueError as odd:
        raise _refused(f"is not valid JSON ({odd})") from None
    model = raw.get("model")
    if not isinstance(model, dict):
        raise _refused("is JSON, but no REXS: it has no object `model`")
    spectra = model.get("load_spectrum") or []
    return model | {"load_spectrum": spectra if isinstance(spectra, list) else [spectra]}


def _listed(raw: Any, key: str, place: str) -> list[Raw]:
    """Objects of a list that stands at a key, none where it is absent."""
    rows = raw.get(key) or []
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise wrong(f"{place}{key}", None, "is no list of objects", AGAIN)
    return rows


def _checked(raw: Raw) -> Model:
    """The model of plain data, whose ids and relations fit."""
    version = str(raw.get("version", "")).strip()
    if not KNOWN.fullmatch(version):
        rule = "is no known version: 1.0 to 1.7 and 2.0.0 are read" if version else "is missing"
        raise wrong("model.version", version or None, rule, f"Export it as REXS {VERSION}")
    components = _components(_listed(raw, "components", ""), "")
    if not components:
        raise wrong("components", None, "is empty: there is no gear", AGAIN)
    relations = [_relation(row, components) for row in _listed(raw, "relations", "")]
    relations.sort(key=lambda relation: relation.order)
    spectra = _listed(raw, "load_spectrum", "")
    if len(spectra) > 1:
        rule = f"stands {len(spectra)} times, and a drive has one"
        raise wrong("load_spectrum", None, rule, "Leave the one that counts")
    cases = []
    for k, row in enumerate(_listed(spectra[0], "load_cases", "") if spectra else [], 1):
        case = _components(_listed(row, "components", f"load case {k}, "), f"load case {k}, ")
        for number in case.keys() - components.keys():
            raise wrong(str(case[number]), None, "is not among the components", AGAIN)
        cases.append(case)
    source = (str(raw.get(key) or "") for key in ("applicationId", "applicationVersion"))
    return Model(version, " ".join(source).strip(), components, relations, cases)


def _number(value: Any, place: str) -> int:
    try:
        return int(str(value))
    except ValueError:
        raise wrong(place, value, "is no whole number", AGAIN) from None


def _components(rows: Iterable[Raw], place: str) -> dict[int, Component]:
    components: dict[int, Component] = {}
    for row in rows:
        number, kind = _number(row.get("id"), f"{place}component.id"), str(row.get("type", ""))
        if number in components:
            raise wrong(f"{place}component {number}", None, "stands twice", "Give each its own id")
        component = Component(number, kind, str(row.get("name") or ""), {}, place)
        for entry in _listed(row, "attributes", f"{component}."):
            name = str(entry.get("id", ""))
            if name in component.attributes:
                raise wrong(f"{component}.{name}", None, "stands twice", "Remove one")
            values = [v for k, v in entry.items() if k not in ("id", "unit") and v is not None]
            unit = str(entry.get("unit") or "").strip()
            component.attributes[name] = (values[0] if values else "", unit)
        components[number] = component
    return components


def _relation(row: Raw, components: Mapping[int, Component]) -> Relation:
    kind = str(row.get("type", ""))
    at, refs = f"relation {row.get('id')} ({kind})", dict[str, int]()
    for ref in _listed(row, "refs", f"{at}."):
        of, role = _number(ref.get("id"), f"{at}.ref.id"), str(ref.get("role", ""))
        if of not in components:
            raise wrong(at, of, "names a component that is not there", AGAIN)
        if role in refs and role in ROLES.get(kind, ()):
            raise wrong(at, None, f"has the role {role} twice", "Give it each role once")
        refs[role] = of
    if lacking := [role for role in ROLES.get(kind, ()) if role not in refs]:
        raise wrong(at, None, f"lacks {lacking[0]}", "Give it each role once")
    return Relation(kind, refs, _number(row.get("order") or 0, f"{at}.order"))
