"""Files with several mistakes: every one is named, in the file's order, in a line of its own."""

import json
import re
from decimal import Decimal
from pathlib import Path
from random import Random

import pytest
from campaigns import few
from mutations import typo
from pydantic_core import PydanticCustomError
from scene_files import BASES, keys, parse, put, rename

from gearopt import units
from gearopt.errors import SceneError
from gearopt.scenes.reading.absent import absent, absent_kind, option
from gearopt.scenes.reading.called import CALLED
from gearopt.scenes.reading.fields import quantity, whole
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import kind_named, read
from gearopt.scenes.reading.mistakes import tables
from gearopt.scenes.reading.not_yet import NEAREST
from gearopt.scenes.reading.toml_writing import dotted

PROBLEMS = Path(__file__).parents[2] / "problems"
WRONG = """\
gearopt = 1
kind = "drive"

[duty]
power = 7.5
input_sped = "1450 rpm"
output_speed = "66,5 rpm"

[bearings]
life = "20000 h"

[gears]
helix_angle = "95 deg"

[[stage]]
face_width_over_diameter = 0.6
material = "16MnCr5"

[limits]
k_factor = "2 N"
unit_load = "48 MPa"
"""
SAID = """\
gearopt: wrong.toml: duty.power = 7.5: is a bare number: power needs a unit (W, kW, MW, hp, PS). \
Write power = "7.5 kW"
gearopt: wrong.toml: duty.input_sped: unknown key. Did you mean input_speed?
gearopt: wrong.toml: duty.output_speed = "66,5 rpm": has a comma: the decimal sign is a \
point. Write output_speed = "66.5 rpm"
gearopt: wrong.toml: bearings = {life = "20000 h"}: is not a key here. Nearest: \
bearing_diameters and bearing_widths of [layout]
gearopt: wrong.toml: gears.helix_angle = "95 deg": is above 45 deg. Write, for example, \
helix_angle = "25 deg"
gearopt: wrong.toml: stage[1].material = "16MnCr5": is not a key here. Nearest: steel, or \
treatment, grade and hardness of a gear, or tables [[material]] to choose from, with a [rating]
gearopt: wrong.toml: limits.k_factor = "2 N": has the unit N of force; units of stress: MPa, Pa, \
kPa, GPa, bar, N/mm^2, psi, ksi. Write, for example, k_factor = "2.07 MPa"
gearopt: wrong.toml: limits.pinion_teeth: is missing. Write, for example, pinion_teeth = [20, 40]
"""


def mistakes(text):
    """The SceneError of a file that must have one."""
    with pytest.raises(SceneError) as wrong:
        read(text.encode(), "my.toml")
    return wrong.value


def test_all_mistakes_of_a_file_are_named_in_its_order(here, tmp_path, monkeypatch):
    (tmp_path / "wrong.toml").write_text(WRONG)
    monkeypatch.chdir(tmp_path)
    for command in ("check", "solve", "explain", "compare"):
        done = here(command, "wrong.toml")
        assert (done.returncode, done.stdout, done.stderr) == (2, "", SAID)
    (found,) = json.loads(here("check", "wrong.toml", "--json").stdout)
    keys = [e["key"] for e in found["errors"]]
    assert keys == [line.split(": ")[2].split(" =")[0] for line in SAID.splitlines()]
    assert found["key"] == "duty.power" and found["fix"]["value"] == '"7.5 kW"'


def test_python_holds_all_mistakes():
    wrong = mistakes(WRONG)
    assert wrong.errors[0] is wrong and len(wrong.errors) == 8
    assert [e.fix and e.fix.action for e in wrong.errors] == [
        "set",
        "rename",
        "set",
        None,
        "set",
        None,
        "set",
        "set",
    ]


def test_the_head_is_reported_with_the_rest():
    duty = '[duty]\npower = "7.5 kW"\ninput_speed = 3\n'
    wrong = mistakes(f'gearopt = 2\nkind = "driv"\nstage = [3]\n{duty}')
    keys = ["gearopt", "kind", "stage[1]", "duty.input_speed", "limits"]
    assert [e.key for e in wrong.errors] == keys
    way = "Write a table [[stage]] with face_width_over_diameter = 0.6"
    assert str(wrong.errors[2]) == f"my.toml: stage[1] = 3: is not a table. {way}"


def test_more_than_twenty_mistakes_are_counted():
    text = BASES["elevator"] + "".join(f"[bolt{k}]\nx = 1\n" for k in range(30))
    wrong = mistakes(text)
    assert len(wrong.errors) == 30
    remedy = "Remove it (tables of your own are named [x-...])"
    assert {e.remedy for e in wrong.errors} == {remedy}
    lines = str(wrong).splitlines()
    assert len(lines) == 21 and lines[-1] == "my.toml: and 10 more"


def broken(rng, text):
    """The text with two or three mistakes in keys of tables, and the places that are wrong."""
    named = [p for p in keys(parse(text)) if len(p) > 1 and len(p[-1]) > 4 and "x-" not in p[0]]
    wrong = set()
    for place in rng.sample(named, rng.choice([2, 3])):
        sort = rng.choice(["value", "name", "unknown"])
        if sort == "name" and (new := typo(rng, place[-1])) != place[-1]:
            text, place = rename(text, place, new).decode(), (*place[:-1], new)
        elif sort == "unknown":
            place = (*place[:-1], f"colour{len(wrong)}")
            text = put(text, place, "red").decode()
        else:
            text = put(text, place, rng.choice([[["x"]], "1 parsec", {"a": 1}])).decode()
        wrong.add(place)
    return text, wrong


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("seeds", few([range(5), range(5, 20)], 1), ids=str)
def test_random_mistakes_are_all_named(base, seeds):
    for seed in seeds:
        text, wrong = broken(Random(f"{base} {seed}"), BASES[base])
        error = mistakes(text)
        named = {e.key for e in error.errors}
        assert {dotted(place) for place in wrong} <= named, text
        assert len(str(error).splitlines()) == len(error.errors)


def test_the_command_refuses_random_mistakes(here, tmp_path):
    path = tmp_path / "my.toml"
    for seed in range(5):
        text, wrong = broken(Random(seed), BASES["laid_out"])
        path.write_text(text, encoding="utf-8")
        done = here("check", path)
        assert done.returncode == 2 and done.stdout == ""
        lines = done.stderr.splitlines()
        assert len(lines) >= len(wrong)
        assert all(line.startswith(f"gearopt: {path}: ") and line.isprintable() for line in lines)


@pytest.mark.parametrize(
    ("table", "line", "said"),
    [
        ("limits", 'center_distance = "120 mm"', "sum_of_centre_distances"),
        ("stage[1]", "addendum_modification = 0.5", "profile_shift, in [stage.pinion]"),
        ("gears", "gear_quality = 6", 'kind = "servo"'),
        ("limits", "safety_factor = 1.5", "minimum_bending_safety"),
        ("duty", "service_factor = 1.25", "multiply duty.power by the factor"),
        ("gears", 'lubricant = "VG 220"', "oil_grade of [rating.iso6336]"),
        ("gears", 'material = "16MnCr5"', "steel, or treatment, grade and hardness"),
        ("duty", 'output-torque = "900 N m"', "the output torque over the ratio"),
    ],
)
def test_what_is_not_supported_yet_names_what_stands_nearest(table, line, said):
    head = "[[stage]]" if table.startswith("stage") else f"[{table}]"
    (wrong,) = mistakes(BASES["elevator"].replace(head, f"{head}\n{line}", 1)).errors
    name = line.split(" = ")[0]
    assert (wrong.key, wrong.rule) == (f"{table}.{name}", "is not a key here")
    assert said in wrong.remedy and wrong.fix is None


def test_the_letters_of_the_field_are_told_their_keys():
    text = BASES["elevator"].replace("[gears]", '[gears]\nbeta = "20 deg"\nnumber_of_stages = 2')
    first, second = mistakes(text).errors
    assert first.remedy == "Write helix_angle, in [gears] or a [[stage]]" and first.fix is None
    assert second.remedy == "Write stages, at the top of the file"
    scene = kind_named("drive").scene
    known = {*scene.model_fields, *(k for _, t in tables(scene) for k in t.model_fields)}
    for there, names in CALLED["drive"].items():
        assert there.split(",")[0].split(" ")[0] in known and not known & set(names.split())


@pytest.mark.parametrize(("kind", "names"), [(k, n) for k, t in NEAREST.items() for n in t])
def test_every_key_of_what_stands_nearest_is_known(kind, names):
    """What a remedy calls a key, with an underscore or a table before it, is one of the kind's."""
    scene = kind_named(kind).scene
    held = {title.strip("[]"): table for title, table in tables(scene)}
    known = {*scene.model_fields, *(k for t in held.values() for k in t.model_fields)}
    known |= {"gear_volume", "sum_of_centre_distances", "mesh_loss"}  # values
    way = NEAREST[kind][names]
    assert set(re.findall(r"\b[a-z]+(?:_[a-z]+)+\b", way)) <= known
    assert {t for t in re.findall(r"\[([a-z_.]+)\]", way)} <= held.keys()
    for table, key in re.findall(r"\b([a-z_]+)\.([a-z_]+)\b(?!\])", way):
        assert key in held[table].model_fields


@pytest.mark.parametrize(
    ("head", "line", "said"),
    [
        ("[motor]", 'max_speed = "800 rad/s"', "Write speed_limit, in [motor]"),
        ("[train]", 'backlash = "0.1 mm"', "Write minimum_backlash, in a [[mesh]], "),
        ("", '[backlash]\nerror = "1 arcmin"', "or, at the output, error, in [accuracy]"),
    ],
)
def test_what_a_servo_file_calls_otherwise(head, line, said):
    base = (PROBLEMS / "servo_gimbal.toml").read_text(encoding="utf-8")
    text = base.replace(head, f"{head}\n{line}", 1) if head else f"{base}\n{line}\n"
    (wrong,) = mistakes(text).errors
    assert said in wrong.remedy and wrong.fix is None


@pytest.mark.parametrize("base", ["elevator", "laid_out"])
def test_a_gearbox_is_a_drive(base):
    (wrong,) = mistakes(BASES[base].replace('"drive"', '"gearbox"')).errors
    assert (wrong.key, wrong.remedy) == ("kind", 'Write kind = "drive"')


def test_a_gearbox_with_the_tables_of_another_kind_is_that():
    servo = (PROBLEMS / "servo_gimbal.toml").read_text(encoding="utf-8")
    for text, kind in ((servo, "servo"), ('gearopt = 1\nkind = "servo"\n', "drive")):
        wrong = mistakes(text.replace('kind = "servo"', 'kind = "gearbox"'))
        assert len(wrong.errors) == 1 and wrong.remedy == f'Write kind = "{kind}"'


def test_weight_is_mass_and_volume_is_asked_back():
    base = BASES["fixed"].replace('"mass"', '"weight"')
    assert read(base.encode())[1].objective.minimise == "mass"
    (wrong,) = mistakes(base.replace('"weight"', '"volume"')).errors
    assert wrong.fix is None and "gear_volume" in wrong.remedy and "box_volume" in wrong.remedy
    (wrong,) = mistakes(base.replace('"weight"', '"centre_distance"')).errors
    assert "sum_of_centre_distances" in wrong.remedy


@pytest.mark.parametrize(
    ("head", "line", "said"),
    [
        ("[gears]", "worm_starts = 3", "= 3: worm gears are not supported. Remove it"),
        ("[[stage]]", "Gangzahl = 2", "= 2: worm gears are not supported. Remove it"),
        ("[duty]", "K_A = 1.25", "has another name here. Write overload_factor, in [rating]"),
        ("[limits]", "SFmin = 1.4", "Write minimum_bending_safety, in [rating]"),
        ("[gears]", "micropitting = 1", "micropitting (ISO/TS 6336-22) is not rated. Remove it"),
        ("[limits]", "minimum_scuffing_safety = 1.2", "is not rated. Remove it"),
        ("[gears]", 'shaft_diameter = "30 mm"', "Write shaft_diameters, in [layout]"),
        ("[gears]", 'Lagerabstand = "90 mm"', "is not a key here. It follows from the layout"),
        ("[gears]", "KHbeta = 1.2", "Write K_Hbeta, in [rating.iso6336.given]"),
        ("[gears]", 'Achsabstand = "90 mm"', "Nearest: centre_distance of a [[stage]]"),
        ("[[stage]]", 'center_distance = "90 mm"', "Write centre_distance, in a [[stage]]"),
        ("[[stage]]", "pinion_tooth = 20", "unknown key. Did you mean pinion_teeth?"),
        ("[gears]", 'k_faktor = "2 MPa"', "unknown key; known here: "),
        ("[limits]", 'k_faktor = "2 MPa"', "Write k_factor, in [limits]"),
        ("[duty]", 'powr = "2 kW"', "unknown key beside power, which may be meant. Remove it"),
        ("[duty]", 'method = "ipopt"', "run `gearopt solve FILE --method NAME`"),
        ("[[stage]]", 'module = "7 in"', 'is a module of 177.8 mm. Write "7 1/in" for a diametral'),
        ("[[stage]]", 'diametral_pitch = "8 DP"', "Write diametral_pitch = 8, without a unit"),
        ("[[stage]]", "pinion_teeth = -20", "Write pinion_teeth = 20"),
        ("[gears]", "sigma_Hlim = 1500", 'Write sigma_Hlim = "1500 MPa"'),
        ("[[stage]]", 'pressure_angle = "50 deg"', "is above 45 deg"),
        ("[gears]", "poisson_ratio = 2", "Write, for example, poisson_ratio = 0.3"),
        ("[gears]", "poisson_ratio = -0.25", "Write poisson_ratio = 0.25"),
        ("[gears]", 'treatment = "carburizing"', '. Write treatment = "carburised"'),
        ("[gears]", 'treatment = "2.5 %"', '. Write treatment = "2.5 % chrome"'),
        ("[[stage]]", "pinion_teeth = [20]", "Write pinion_teeth = [20, 20]"),
        ("[[stage]]", 'pinion_teeth = "20-30"', "Write pinion_teeth = [20, 30]"),
        ("[[stage]]", 'module = "2 to 4 mm"', 'Write module = ["2 mm", "4 mm"]'),
        ("[gears]", "elastic_modulus = 206000", 'Write elastic_modulus = "206000 MPa"'),
        ("[[stage]]", "unit_load = 7000", 'Write unit_load = "7000 psi"'),
        ("[[stage]]", "minimum_face_width = 12", 'Write minimum_face_width = "12 mm"'),
    ],
)
def test_terms_of_the_field_are_answered_by_their_meaning(head, line, said):
    (wrong,) = mistakes(BASES["elevator"].replace(head, f"{head}\n{line}", 1)).errors
    assert said in str(wrong)


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ('input_speed = "1.450 U/min"', 'Write "1450 rpm" or "1.45 rpm"'),
        ('input_speed = "1.450,5 U/min"', 'Write input_speed = "1450.5 rpm"'),
        ('input_speed = "1\'450 rpm"', 'Write input_speed = "1450 rpm"'),
        ("title = 12", 'is not a text. Write title = "12"'),
        ("power = 750", 'power needs a unit (W, kW, MW, hp, PS). Write power = "750 W"'),
        ('ratio = "1:20"', "1/20 is that of a drive that increases speed. Write ratio = 20"),
        ('ratio = "20:1"', "is written with a colon. Write ratio = 20"),
        ('modules = ["7 in"]', 'Write modules = ["2 mm"]'),
        (f"ratio = 0x{'9' * 9999}", "is out of any sensible range"),
        ("ratio = 0.0000001", "is not between 1e-06 and 1000000"),
        ('ratio = "1:2000000"', "is not between 1e-06 and 1000000. Write, for example, ratio = 20"),
        ('ratio = "2000000:1"', "is not between 1e-06 and 1000000. Write, for example, ratio = 20"),
        ("modules = []", '= []: is neither one of "ISO 54 I", "ISO 54 I+II", "DP coarse", '),
    ],
)
def test_numbers_are_answered_as_they_were_meant(written, said):
    base = BASES["elevator"].replace('output_speed = "66.5 rpm"', "ratio = 20")
    name = written.split(" =")[0]
    (wrong,) = mistakes(re.sub(rf"(?m)^{name} = .*$", written, base, count=1)).errors
    assert said in str(wrong)


@pytest.mark.parametrize(
    ("kind", "gears"),
    [
        ("Schneckengetriebe", "worm gears"),
        ("worm_drive", "worm gears"),
        ("bevel", "bevel and hypoid gears"),
        ("rack", "racks"),
        ("cycloidal_gearbox", "cycloidal gears"),
    ],
)
def test_gears_that_no_kind_has_are_named_with_the_kinds(kind, gears):
    (wrong,) = mistakes(BASES["elevator"].replace('"drive"', f'"{kind}"')).errors
    assert (wrong.key, wrong.rule) == ("kind", f"{gears} are not supported") and wrong.fix is None
    assert all(re.search(rf"\b{name}\b", wrong.remedy) for name in kinds())


@pytest.mark.parametrize("kind", ["worm", "worm_set"])
def test_gears_of_a_new_kind_are_no_longer_absent(kind, monkeypatch):
    assert absent("worm_starts") and absent_kind("worm gears")
    monkeypatch.setattr("gearopt.scenes.reading.absent.kinds", lambda: (*kinds(), kind))
    assert not absent("worm_starts") and not absent_kind("worm gears") and absent("bevel")


@pytest.mark.slow
def test_no_key_of_a_file_is_called_absent():
    for kind in kinds():
        scene = kind_named(kind).scene
        known = {*scene.model_fields, *(k for _, t in tables(scene) for k in t.model_fields)}
        wrong = [key for key in known if absent(key) or option(key)]
        assert not wrong, f"scenes/reading/absent.py says of {wrong} of {kind} that no kind has it"


def test_a_long_value_is_cut_to_sixty_characters():
    text = BASES["elevator"].replace("[gears]", f'[gears]\nHRC = "{"6" * 70}"')
    (wrong,) = mistakes(text).errors
    assert wrong.value == '"' + 56 * "6" + "..."


def test_files_of_other_formats_are_named():
    rexs = '<?xml version="1.0"?>\n<!-- by a program -->\n<model version="1.4"></model>'
    for text, form in ((rexs, "a REXS model (XML)"), ("<html>", "XML or HTML"), ("{}", "JSON")):
        assert mistakes(text).rule == f"is {form}, not a problem file"


@pytest.mark.parametrize(
    ("right", "written", "remedy"),
    [
        ('"1 %"', "0,5", "The decimal sign is a point: 0.5"),
        ("[[stage]]", "[stage]", "Each of several tables [[stage]] has double brackets"),
    ],
)
def test_a_decimal_comma_and_single_brackets_are_named(right, written, remedy):
    (wrong,) = mistakes(BASES["elevator"].replace(right, written)).errors
    assert wrong.rule.startswith("is not valid TOML: ")
    assert wrong.remedy == remedy and wrong.fix is None


@pytest.mark.parametrize(
    ("dimension", "example", "text", "readings"),
    [
        ("time", "20000 h", "20.000 h", ("20000 h", "20 h")),
        ("speed", "1450 rpm", "1.450 rpm", ("1450 rpm", "1.45 rpm")),
        ("power", "7.5 kW", "75.000 W", ("75000 W", "75 W")),
        ("speed", "1450 rpm", "1.457 rpm", None),
        ("speed", "1450 rpm", "50.000 rpm", None),
        ("time", "20000 h", "20.5 h", None),
        ("power", "7.5 kW", "1.450 kW", None),
        ("length", "20000 mm", "20.000 mm", None),
        ("time", "20 s", "0.200 ms", None),
    ],
)
def test_a_point_of_thousands_is_asked_back_where_decimals_are_unlikely(
    dimension, example, text, readings
):
    reads = quantity(dimension, example)
    if readings is None:
        assert reads.reader(text, example) == units.parse(text, dimension)
        return
    with pytest.raises(PydanticCustomError, match="may separate thousands") as wrong:
        reads.reader(text, example)
    assert wrong.value.context["write"] == 'Write "{}" or "{}"'.format(*readings)


@pytest.mark.parametrize(
    "value", [Decimal("1.0"), Decimal("6.0"), "1", " 6 ", Decimal("7.0"), "7", 7, -1, 0]
)
def test_a_whole_number_that_is_written_otherwise_is_told_where_it_is_in_range(value):
    with pytest.raises(PydanticCustomError, match="not a whole number") as wrong:
        whole(3, 1, 6).reader(value, 3)
    known = {7: None, -1: 1, 0: 1}  # the least one, and a sign too many
    assert wrong.value.context["write"] == known.get(int(value), int(value))


def test_a_comma_of_thousands_is_asked_back():
    (wrong,) = mistakes(BASES["elevator"].replace('"1450 rpm"', '"1,450 rpm"')).errors
    assert wrong.remedy == 'Write "1450 rpm" or "1.45 rpm"' and wrong.fix is None
