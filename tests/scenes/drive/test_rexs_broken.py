"""Broken REXS files: each is refused in one line that names the place and what to do."""

import io
import zipfile

import pytest
from rexs_files import as_json, planetary, unit, xml, zipped

import gearopt

HEAD = '<?xml version="1.0"?>\n'
LOL = "".join(f'<!ENTITY l{k + 1} "{f"&l{k};" * 10}">' for k in range(9))
BOMB = f'{HEAD}<!DOCTYPE model [<!ENTITY l0 "lol">{LOL}]><model>&l9;</model>'
OUTSIDE = f'{HEAD}<!DOCTYPE m [<!ENTITY x SYSTEM "file:///etc/passwd">]><model>&x;</model>'


def of(number, **values):
    """The unit with other attributes of a component; None removes one."""

    def changed():
        model = unit()
        held = model["components"][number][1]
        held.update(values)
        model["components"][number] = (
            model["components"][number][0],
            {k: v for k, v in held.items() if v is not None},
        )
        return xml(model)

    return changed


def without(kind, **roles):
    """The unit without the relations of a type that have these roles."""

    def changed():
        model = unit()
        kept = [
            r for r in model["relations"] if not (r[0] == kind and roles.items() <= r[1].items())
        ]
        assert len(kept) < len(model["relations"])
        return xml(model | {"relations": kept})

    return changed


def besides(kind, **roles):
    """The unit with one relation more."""
    return lambda: xml(unit() | {"relations": [*unit()["relations"], (kind, roles)]})


def replaced(before, after, make=xml, model=unit):
    def changed():
        text = make(model())
        assert before in text
        return text.replace(before, after, 1)

    return changed


def of_planets(change):
    def changed():
        model = planetary()
        change(model)
        return xml(model)

    return changed


def drop(kind, **roles):
    def change(model):
        model["relations"] = [
            r for r in model["relations"] if not (r[0] == kind and roles.items() <= r[1].items())
        ]

    return change


def bomb():
    """A small archive that holds more than 20 MB of blanks."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("unit.rexs", b" " * 21_000_000)
    return data.getvalue()


def two_worms():
    model = unit()
    model["components"][99] = ("worm_stage", {})
    return xml(model)


def circle():
    """The unit whose output is coupled to its input."""
    model = unit()
    model["components"][99] = ("coupling", {})
    model["relations"].append(("side", {"assembly": 99, "inner_part": 11, "outer_part": 13}))
    return xml(model)


def idle(model):
    """Leave planets without load and without casing."""
    drop("side")(model)
    drop("assembly", part=9)(model)


GEAR = "component 21 (cylindrical_gear)"
BROKEN = {
    "empty": (lambda: "", "is neither XML nor JSON nor a zip archive"),
    "text": (lambda: "gears", "is neither XML nor JSON nor a zip archive"),
    "cut": (lambda: xml(unit())[:900], "is not well-formed XML"),
    "entities": (lambda: BOMB, "declares a document type or entities"),
    "outside entity": (lambda: OUTSIDE, "declares a document type or entities"),
    "other XML": (lambda: HEAD + "<html/>", "no REXS: it begins with <html>"),
    "encoding": (lambda: '<?xml version="1.0" encoding="martian"?><model/>', "XML"),
    "half a character": (lambda: xml(unit()).encode()[:300] + b"\xff", "is not well-formed XML"),
    "deep XML": (lambda: HEAD + "<model>" + "<a>" * 90_000, "is not well-formed XML"),
    "deep JSON": (lambda: '{"model": ' + "[" * 90_000, "is nested too deeply"),
    "cut JSON": (lambda: as_json(unit())[:500], "is not valid JSON"),
    "other JSON": (lambda: '{"a": 1}', "it has no object `model`"),
    "JSON relations": (
        lambda: '{"model": {"version": "1.7", "components": [{"id": 1}], "relations": 3}}',
        "relations: is no list of objects",
    ),
    "broken archive": (lambda: zipped(xml(unit()))[:-80], "is a broken archive"),
    "empty archive": (lambda: zipped("", "note.txt"), "is an archive with no REXS file"),
    "archive bomb": (bomb, "is larger than 20,000,000 bytes"),
    "no version": (replaced('version="1.4"', ""), "model.version: is missing"),
    "future": (replaced('"1.4"', '"3.1"'), 'model.version = "3.1": is no known version'),
    "no components": (
        lambda: xml(unit() | {"components": {}, "relations": []}),
        "components: is empty",
    ),
    "id": (replaced('component id="21"', 'component id="x"'), "component.id"),
    "id twice": (replaced('component id="22"', 'component id="21"'), "component 21: stands twice"),
    "attribute twice": (
        replaced('id="face_width"', 'id="normal_module"'),
        f"{GEAR}.normal_module: stands twice",
    ),
    "no such component": (replaced('ref id="21"', 'ref id="77"'), "that is not there"),
    "no role": (besides("stage", stage=31, gear_1=21), "(stage): lacks gear_2"),
    "load case": (
        replaced(
            '<component id="71" type="external_load"><attribute id="torque',
            '<component id="78" type="external_load"><attribute id="torque',
        ),
        "load case 1, component 78 (external_load): is not among the components",
    ),
    "no number": (
        of(21, normal_module=("three", "mm")),
        f'{GEAR}.normal_module = "three": is no number',
    ),
    "comma": (of(21, face_width=("45,5", "mm")), f'{GEAR}.face_width = "45,5": is no number'),
    "nan": (of(21, face_width=("NaN", "mm")), f'{GEAR}.face_width = "NaN": is no number'),
    "huge": (of(21, face_width=("1e400", "mm")), f'{GEAR}.face_width = "1e400": is no number'),
    "unit": (of(21, face_width=(45, "inch")), "is in inch, and the unit of the schema is mm"),
    "teeth": (of(21, number_of_teeth=19.5), f'{GEAR}.number_of_teeth = "19.5": is no whole number'),
    "no module": (of(21, normal_module=None), f"{GEAR}.normal_module: is missing"),
    "no width": (of(21, face_width=None), f"{GEAR}.face_width: is missing"),
    "zero module": (of(21, normal_module=(0, "mm")), "is not above 0 mm"),
    "other module": (
        of(22, normal_module=(4, "mm")),
        '(cylindrical_gear).normal_module = "4": differs from 3',
    ),
    "hands": (of(22, helix_angle_reference_diameter=(15, "deg")), "is not opposite to the 15"),
    "sides": (of(42, addendum_modification_coefficient=0.4), "differs from 0.3 of component 41"),
    "distance": (of(31, center_distance=(0, "mm")), "(cylindrical_stage).center_distance"),
    "few teeth": (of(21, number_of_teeth=2), f"{GEAR}.number_of_teeth"),
    "material": (
        of(61, heat_treated_material_type_iso_6336_2006="cheese"),
        'heat_treated_material_type_iso_6336_2006 = "cheese": is no known material',
    ),
    "unit of two lines": (
        lambda: as_json(unit()).replace('"unit": "mm"', '"unit": "m\\nm\\u001b[31m"', 1),
        "is in m m [31m, and the unit of the schema is mm",
    ),
    "two rings": (
        of_planets(
            lambda m: m["components"].update(
                {i: ("ring_gear", m["components"][i][1]) for i in (20, 24, 28)}
            )
        ),
        "meshes two rings",
    ),
    "no flank": (besides("flank", gear=24, left=45, right=62), "is no flank of component 24"),
    "own rating": (of(1, custom_gearopt_rating="{iso6336 = 3}"), "has no table as iso6336"),
    "own attribute": (of(21, custom_gearopt_gear="{x"), 'custom_gearopt_gear = "{x": is no table'),
    "own key": (of(21, custom_gearopt_gear="{profile = 1}"), "is not a key here"),
    "worm": (two_worms, "component 99 (worm_stage): is no stage of cylindrical gears"),
    "no stages": (without("stage"), "component 31 (cylindrical_stage): has no gears"),
    "two shafts": (without("assembly", part=23), "are not joined into one series of shafts"),
    "circle": (circle, "form a circle"),
    "shares": (replaced(">75<", ">70<"), "of all load cases is not 100 %"),
    "no speed": (replaced('id="rotational_speed"', 'id="speed"'), "load case 1: has no speed"),
    "vector": (of(12, support_vector=[1, 2]), "is no vector of three numbers"),
    "planet": (of_planets(drop("stage", gear_2=11, gear_1=20)), "has no gears"),
    "ring": (
        of_planets(
            lambda m: m["components"].update({11: ("cylindrical_gear", m["components"][11][1])})
        ),
        "is no set of one sun, one ring and planets",
    ),
    "carrier": (of_planets(drop("assembly", assembly=3, part=4)), "has no planet_carrier"),
    "planets differ": (
        of_planets(lambda m: m["components"][24][1].update(number_of_teeth=23)),
        "component 24 (cylindrical_gear): differs from component 20",
    ),
    "held twice": (
        of_planets(
            lambda m: m["relations"].append(
                ("side", {"assembly": 5, "inner_part": 8, "outer_part": 2})
            )
        ),
        "carrier and ring joined to the casing",
    ),
    "nothing held": (of_planets(idle), "does not say which of sun, carrier and ring stands still"),
}


def test_there_are_forty_and_more():
    assert len(BROKEN) >= 40


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_refused_in_one_line(name, tmp_path):
    make, said = BROKEN[name]
    data = make()
    path = tmp_path / "unit.rexs"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    with pytest.raises(gearopt.SceneError) as wrong:
        gearopt.read_rexs(path)
    text = str(wrong.value)
    assert text.startswith(f"{path}: ") and "\n" not in text and said in text, text
    assert wrong.value.remedy
