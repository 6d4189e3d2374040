"""Gears whose steel a file names: equal to the same by numbers, and what is told or refused."""

import pytest
from campaigns import few
from rated_files import pair

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.reading.load import load

PAIR = """
gearopt = 1
kind = "drive"
[duty]
power = "12 kW"
input_speed = "1450 rpm"
[gears]
GEARS
flank_rz = "4.8 um"
root_rz = "20 um"
[[stage]]
module = "4 mm"
pinion_teeth = 20
wheel_teeth = 75
face_width = "48 mm"
[stage.pinion]
PINION
[stage.wheel]
WHEEL
[rating]
standard = "both"
quality = 9
life = "20000 h"
[rating.iso6336]
accuracy_grade = 6
"""
TEMPERED = 'treatment = "through-hardened"\ngrade = 2\nhardness = "{} HB"\niso_material = "V alloy"'
CASE = 'treatment = "carburised"\ngrade = {}\niso_material = "Eh"\niso_quality = "{}"'
NUMBERS = {  # name, and the same by numbers
    "16MnCr5": CASE.format(2, "MQ"),
    "C15E": CASE.format(1, "ML"),
    "42CrMo4": TEMPERED.format(235),
    "34CrNiMo6": TEMPERED.format(260),
    "C45": 'treatment = "through-hardened"\ngrade = 1\nhardness = "190 HB"\n'
    'iso_material = "V carbon"',
    'C60E"\nhardness = "210 HB': 'treatment = "through-hardened"\ngrade = 1\nhardness = "210 HB"\n'
    'iso_material = "V carbon"',
    '42CrMo4"\ntreatment = "nitrided': 'treatment = "nitrided"\ngrade = 1\nhardness = "255 HB"\n'
    'iso_material = "NV"\nflank_hardness = "550 HV"',
    "34CrAlNi7": 'treatment = "nitralloy"\ngrade = 1\nhardness = "255 HB"\niso_material = "NT"\n'
    'flank_hardness = "850 HV"\nsurface_hardness = "N, 90.0 HR15N"',
    "Cf53": 'treatment = "induction, roots"\ngrade = 1\niso_material = "IF"\n'
    'flank_hardness = "560 HV"',
    '42CrMo4"\nhardness = "300 HB': TEMPERED.format(300),
}


def written(tmp_path, gears, pinion="", wheel=""):
    path = tmp_path / "pair.toml"
    text = PAIR.replace("GEARS", gears).replace("PINION", pinion).replace("WHEEL", wheel)
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", few(NUMBERS, 5))
def test_a_steel_by_name_is_rated_as_by_its_numbers(tmp_path, name):
    more = '\nsurface_hardness = "N, 90.0 HR15N"' if name == "34CrAlNi7" else ""
    by_name = gearopt.rate(written(tmp_path, f'steel = "{name}"{more}'))
    by_numbers = gearopt.rate(written(tmp_path, NUMBERS[name]))
    assert by_name.limits == by_numbers.limits
    assert name.partition('"')[0][:3] in by_name.design["rating"]["gears"][0]["material"]
    assert any("Steels by name" in words for words in by_name.report["assumptions"])


def test_a_steel_of_a_gear_takes_the_place_of_all_that_others_share(tmp_path):
    shared = TEMPERED.format(280)
    mixed = gearopt.rate(written(tmp_path, shared, pinion='steel = "16MnCr5"'))
    numbers = gearopt.rate(written(tmp_path, "", CASE.format(2, "MQ"), TEMPERED.format(280)))
    assert mixed.limits == numbers.limits


@pytest.mark.parametrize(
    ("gears", "told"),
    [
        ('steel = "POM"', "VDI 2736 is not supported"),
        ('steel = "16MnCr6"', 'Write steel = "16MnCr5"'),
        ('steel = "16MnCr5"\ntreatment = "nitrided"', "does not go with 16MnCr5, which is case-"),
        ('steel = "GGG-50"', "has no strength by AGMA 2001"),
        ("steel = 4140", "is not the name of a steel"),
        ('steel = ["42CrMo4"]', "Write materials = ['42CrMo4']"),
        ('steel = "42CrMo4"\ntreatment = "induction, flanks"', "leaves the roots soft"),
    ],
)
def test_what_is_no_steel_of_a_gear_is_refused(tmp_path, gears, told):
    with pytest.raises(SceneError) as refusal:
        load(written(tmp_path, gears))
    assert told in str(refusal.value)


@pytest.mark.parametrize(
    ("gears", "told"),
    [
        (
            'steel = "42CrMo4"\nhardness = "380 HB"',
            "42CrMo4 is quenched and tempered to 235 to 340",
        ),
        (
            'steel = "42CrMo4"\nhardness = "330 HB"',
            "as a bar of 72 mm, 42CrMo4 reaches some 285 HB",
        ),
        ('steel = "16MnCr5"', "reaches 25 HRC to a module of 3 mm"),
        (
            'steel = "42CrMo4"\ntreatment = "nitrided"\nhardness = "340 HB"',
            "has 250 to 320 HB as a",
        ),
    ],
)
def test_a_steel_that_does_not_reach_what_it_is_rated_with_is_told(tmp_path, gears, told):
    flaws = gearopt.rate(written(tmp_path, gears)).design["rating"]["flaws"]
    assert any(told in flaw for flaw in flaws), flaws


def test_irons_are_rated_by_iso6336_alone(tmp_path):
    path = written(tmp_path, 'steel = "GGG-50"')
    path.write_text(path.read_text().replace('"both"\nquality = 9', '"iso6336"'))
    rating = gearopt.rate(path).design["rating"]
    assert "GGG" in rating["gears"][0]["material"] and rating["gears"][0]["contact_safety"] > 0.2


def test_materials_to_choose_from_may_be_steels_by_name(tmp_path):
    names = ("16MnCr5", "42CrMo4")
    tables = "".join(f'[[material]]\nname = "{n}"\nsteel = "{n}"\n' for n in names)
    sized = PAIR.replace("GEARS", f"materials = {list(names)}").replace("PINION", "")
    sized = sized.replace("WHEEL", "").partition("[[stage]]")[0] + (
        f"face_width_over_diameter = 0.6\n[[stage]]\n{tables}[limits]\npinion_teeth = [20, 24]\n"
        f"[teeth]\n[rating]{PAIR.partition('[rating]')[2]}"
    )
    path = tmp_path / "sized.toml"
    path.write_text(
        sized.replace('input_speed = "1450 rpm"', 'input_speed = "1450 rpm"\nratio = 4')
    )
    result = gearopt.solve(path)
    assert result.status == "optimal"
    assert result.design["stages"][0]["pinion_material"] == "16MnCr5"


@pytest.mark.parametrize("standard", ["both", "agma", "iso6336"])
def test_an_iron_without_a_class_is_told_at_once_to_give_strengths(standard):
    """EN-GJS-800-10 is of neither standard: what is told to write is accepted."""
    asked = {"standard": standard} | (
        {"iso6336": {"accuracy_grade": 7}} if standard != "agma" else {}
    )
    tables = pair(asked)
    tables["gears"] = {"steel": "EN-GJS-800-10"}
    if standard == "iso6336":
        del tables["rating"]["quality"]
    with pytest.raises(SceneError, match="Give sigma_Hlim and sigma_Flim") as wrong:
        gearopt.load(tables)
    assert "Write standard" not in str(wrong.value)
    given = {"iso_material": "GGG", "sigma_Hlim": "700 MPa", "sigma_Flim": "300 MPa"}
    iso = pair({"standard": "iso6336", "iso6336": {"accuracy_grade": 7}})
    del iso["rating"]["quality"]
    assert gearopt.rate(iso | {"gears": given | {"yield_strength": "500 MPa"}}).limits
    with pytest.raises(SceneError, match="Y_deltarelT of GGG follows from it"):
        gearopt.load(iso | {"gears": given})
