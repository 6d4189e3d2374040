"""REXS files for tests, written by hand: a two-stage unit, a planetary one; XML, JSON, zip."""

import copy
import io
import json
import zipfile
from xml.sax.saxutils import quoteattr

UNIT = {  # a two-stage helical unit of REXS 1.4, as other programs write it
    "version": "1.4",
    "components": {
        1: ("gear_unit", {"model_name": "Two stages"}),
        2: ("gear_casing", {}),
        11: ("shaft", {"support_vector": [0, 0, 0]}),
        12: ("shaft", {"support_vector": [10, -90, 90]}),
        13: ("shaft", {"support_vector": [0, 60, 90]}),
        21: (
            "cylindrical_gear",
            {
                "normal_module": (3, "mm"),
                "number_of_teeth": 19,
                "helix_angle_reference_diameter": (15, "\u00b0"),
                "face_width": (45, "mm"),
                "tip_diameter": (66.21074228337473, "mm"),
            },
        ),
        22: (
            "cylindrical_gear",
            {
                "normal_module": (3, "mm"),
                "number_of_teeth": 62,
                "helix_angle_reference_diameter": (-15, "deg"),
                "face_width": (40, "mm"),
                "upper_backlash_allowance_referenced_to_span": (-60, "mum"),
                "lower_backlash_allowance_referenced_to_span": (-100, "mum"),
            },
        ),
        23: (
            "cylindrical_gear",
            {
                "normal_module": (4.5, "mm"),
                "number_of_teeth": 18,
                "helix_angle_reference_diameter": (-12, "deg"),
                "face_width": (65, "mm"),
                "arithmetic_average_roughness_flank": (0.6, "mum"),
            },
        ),
        24: (
            "cylindrical_gear",
            {
                "normal_module": (4.5, "mm"),
                "number_of_teeth": 61,
                "helix_angle_reference_diameter": (12, "deg"),
                "face_width": (65, "mm"),
                "tip_diameter": (1, "mm"),
            },
        ),
        31: ("cylindrical_stage", {"center_distance": (127.5, "mm")}),
        32: (
            "cylindrical_stage",
            {
                "center_distance": (0.183, "m"),
                "application_factor_iso_6336_2006": 1.25,
            },
        ),
        41: ("cylindrical_gear_flank", {"addendum_modification_coefficient": 0.3}),
        42: ("cylindrical_gear_flank", {"addendum_modification_coefficient": 0.3}),
        43: ("cylindrical_gear_flank", {"addendum_modification": (-0.3, "mm")}),
        44: (
            "cylindrical_gear_flank",
            {"addendum_modification_coefficient": 0.25, "normal_pressure_angle": (20, "deg")},
        ),
        45: ("cylindrical_gear_flank", {"addendum_modification_coefficient": 0}),
        51: (
            "rack_shaped_tool",
            {
                "addendum_coefficient_reference_profile": 1.4,
                "dedendum_coefficient_reference_profile": 1.1,
                "tip_radius_factor": 0.25,
            },
        ),
        52: ("cylindrical_gear_manufacturing_settings", {}),
        61: (
            "material",
            {
                "endurance_limit_flank": (1500, "N / mm^2"),
                "basic_strength_root": (922, "N / mm^2"),
                "elastic_modulus": (210000, "N / mm^2"),
                "heat_treated_material_type_iso_6336_2006": "case_hardened_wrought_steel",
                "surface_hardness_brinell": (700, "HB"),
                "density": (7.83, "kg / dm^3"),
            },
        ),
        62: ("lubricant", {"viscosity_at_40_degree_celsius": (320, "mm^2 / s")}),
        71: ("external_load", {"defines_torque": "true"}),
        72: ("external_load", {"defines_torque": "false"}),
        81: ("shaft_section", {"length": (100, "mm"), "outer_diameter_begin": (40, "mm")}),
    },
    "relations": [
        *(("assembly", {"assembly": 1, "part": part}) for part in (2, 31, 32, 11, 12, 13)),
        ("assembly", {"assembly": 11, "part": 21}),
        ("assembly", {"assembly": 12, "part": 22}),
        ("assembly", {"assembly": 12, "part": 23}),
        ("assembly", {"assembly": 13, "part": 24}),
        ("assembly", {"assembly": 11, "part": 71}),
        ("assembly", {"assembly": 13, "part": 72}),
        ("assembly", {"assembly": 12, "part": 81}),
        ("stage", {"stage": 31, "gear_1": 21, "gear_2": 22}),
        ("stage", {"stage": 32, "gear_1": 23, "gear_2": 24}),
        ("flank", {"gear": 21, "left": 41, "right": 42}),
        ("flank", {"gear": 22, "left": 43}),
        ("flank", {"gear": 23, "left": 44}),
        ("flank", {"gear": 24, "left": 45}),
        ("manufacturing_step", {"workpiece": 41, "tool": 51, "manufacturing_settings": 52}),
        *(("reference", {"origin": gear, "referenced": 61}) for gear in (21, 22, 23, 24)),
        ("reference", {"origin": 2, "referenced": 62}),
    ],
    "cases": [
        {
            1: {"load_duration_fraction": (share, "%")},
            11: {"rotational_speed": (speed, "1 / min")},
            71: {"torque_around_u_axis": (torque, "N m")},
        }
        for share, speed, torque in ((25, 1500, 120), (75, 900, 200))
    ],
}
for _number in (11, 12, 13):
    UNIT["components"][_number][1].update(u_axis_vector=[1, 0, 0], w_axis_vector=[0, 0, 1])


def unit():
    """The two-stage unit, to be changed."""
    return copy.deepcopy(UNIT)


def planetary(count=3):
    """A sun, planets and ring: 17/22/61, m 4, a 78; the ring is coupled to the casing."""

    def gear(kind, teeth):
        numbers = {"normal_module": (4, "mm"), "number_of_teeth": teeth, "face_width": (50, "mm")}
        return kind, numbers

    components = {
        1: ("gear_unit", {}),
        2: ("gear_casing", {}),
        3: ("planetary_stage", {}),
        4: ("planet_carrier", {}),
        5: ("coupling", {}),
        6: ("shaft", {"rotational_speed": (1000, "1 / min")}),
        7: ("shaft", {}),
        8: ("shaft", {}),
        9: ("external_load", {"torque_around_u_axis": (400, "N m")}),
        10: gear("cylindrical_gear", 17),
        11: gear("ring_gear", 61),
    }
    relations = [
        ("assembly", {"assembly": 3, "part": 4}),
        ("assembly", {"assembly": 6, "part": 10}),
        ("assembly", {"assembly": 7, "part": 11}),
        ("assembly", {"assembly": 6, "part": 9}),
        ("assembly", {"assembly": 4, "part": 8}),
        ("side", {"assembly": 5, "inner_part": 7, "outer_part": 2}),
        ("planet_carrier_shaft", {"planetary_stage": 3, "shaft": 8}),
    ]
    for k in range(count):
        planet, pin, of_sun, of_ring = (20 + 4 * k + i for i in range(4))
        components[planet] = gear("cylindrical_gear", 22)
        components[pin] = ("shaft", {})
        for mesh, pair in ((of_sun, (10, planet)), (of_ring, (planet, 11))):
            components[mesh] = ("cylindrical_stage", {"center_distance": (78, "mm")})
            relations += [
                ("assembly", {"assembly": 3, "part": mesh}),
                ("stage", {"stage": mesh, "gear_1": pair[0], "gear_2": pair[1]}),
            ]
        relations += [
            ("assembly", {"assembly": 4, "part": pin}),
            ("assembly", {"assembly": pin, "part": planet}),
            ("planet_pin", {"planetary_stage": 3, "shaft": pin}),
        ]
    return {"version": "1.7", "components": components, "relations": relations, "cases": []}


def _attribute(name, value):
    value, unit = value if isinstance(value, tuple) else (value, "")
    if isinstance(value, list):
        inner = f"<array>{''.join(f'<c>{v}</c>' for v in value)}</array>"
    else:
        inner = str(value)
    return f"<attribute id={quoteattr(name)} unit={quoteattr(unit)}>{inner}</attribute>"


def _component(number, kind, attributes):
    inner = "".join(_attribute(*item) for item in attributes.items())
    return f'<component id="{number}" type="{kind}">{inner}</component>'


def xml(model):
    """A file in XML."""
    refs = [
        f'<relation id="{k}" type="{kind}">'
        + "".join(f'<ref id="{i}" role="{role}"/>' for role, i in roles.items())
        + "</relation>"
        for k, (kind, roles) in enumerate(model["relations"], 1)
    ]
    parts = [_component(i, *held) for i, held in model["components"].items()]
    kinds = {i: held[0] for i, held in model["components"].items()}
    cases = [
        f'<load_case id="{k}">'
        + "".join(_component(i, kinds.get(i, ""), said) for i, said in case.items())
        + "</load_case>"
        for k, case in enumerate(model["cases"], 1)
    ]
    spectrum = f'<load_spectrum id="1">{"".join(cases)}</load_spectrum>' if cases else ""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model version="{model["version"]}" applicationId="Hand" applicationVersion="1" '
        f'date="2026-01-01T00:00:00+00:00"><relations>{"".join(refs)}</relations>'
        f"<components>{''.join(parts)}</components>{spectrum}</model>"
    )


def _rows(attributes):
    for name, value in attributes.items():
        value, unit = value if isinstance(value, tuple) else (value, "none")
        sort = "floating_point" if isinstance(value, int | float) else "string"
        sort = "floating_point_array" if isinstance(value, list) else sort
        yield {"id": name, "unit": unit, sort: value}


def as_json(model):
    """A file in JSON."""
    kinds = {i: held[0] for i, held in model["components"].items()}
    components = [
        {"id": i, "type": kind, "attributes": list(_rows(attributes))}
        for i, (kind, attributes) in model["components"].items()
    ]
    relations = [
        {"id": k, "type": kind, "refs": [{"id": i, "role": r} for r, i in roles.items()]}
        for k, (kind, roles) in enumerate(model["relations"], 1)
    ]
    cases = [
        {
            "id": k,
            "components": [
                {"id": i, "type": kinds[i], "attributes": list(_rows(said))}
                for i, said in case.items()
            ],
        }
        for k, case in enumerate(model["cases"], 1)
    ]
    head = {"version": model["version"], "applicationId": "Hand", "applicationVersion": "1"}
    whole = {**head, "relations": relations, "components": components}
    return json.dumps({"model": whole | {"load_spectrum": {"id": 1, "load_cases": cases}}})


def zipped(text, name="unit.rexs"):
    """The bytes of an archive with a file."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, text)
    return data.getvalue()
