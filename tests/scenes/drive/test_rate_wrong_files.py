"""Mistakes that a newcomer makes in a file to be rated: one message, with what to write; exit 2."""

import re
from pathlib import Path

import pytest

import gearopt
from gearopt.scenes.reading.load import examples

PROBLEMS = Path(__file__).parents[3] / "problems"
RIGHT = examples()["rating"]
RATING = re.search(r"\[rating\].*", RIGHT, re.S)[0]
STEEL = (
    'treatment = "carburised"       # or through-hardened with hardness = "300 HB", nitrided ...'
)
LOADS = '[[load]]\npower = "7.5 kW"\nshare = "50 %"\n[[load]]\npower = "5 kW"\nshare = "40 %"\n'
GIVEN = "# [rating.given]"

WRONG = {  # the mistake: what stands there, what is written, key and value as told, what to write
    "hardness without a unit": (
        STEEL,
        'treatment = "through-hardened"\nhardness = 240',
        "gears.hardness = 240",
        'Write hardness = "240 HB"',
    ),
    "Rockwell of a case": (
        "grade = 1",
        'hardness = "60 HRC"',
        'gears.hardness = "60 HRC"',
        "Brinell hardness is asked for, of through-hardened steel and of the core of nitrided "
        "steel. The strength of carburised and induction hardened steel follows from its grade",
    ),
    "case hardened": (
        '"carburised"',
        '"case hardened"',
        'gears.treatment = "case hardened"',
        'Write "carburised"; or "nitrided"',
    ),
    "a steel as treatment": (
        '"carburised"',
        '"42CrMo4"',
        'gears.treatment = "42CrMo4"',
        'is not one of "through-hardened", "nitrided"',
    ),
    "no treatment": (STEEL, "", "gears.treatment", "Write, for example, treatment = "),
    "no hardness": (
        '"carburised"',
        '"through-hardened"',
        "gears.hardness",
        'Write, for example, hardness = "240 HB"',
    ),
    "grade of another standard": (
        "grade = 1",
        'grade = "MQ"',
        'gears.grade = "MQ"',
        "AGMA has grades 1, 2 and 3",
    ),
    "grade too high": ("grade = 1", "grade = 4", "gears.grade = 4", "Write, for example, grade"),
    "grade without strength": (
        f"{STEEL}\ngrade = 1",
        'treatment = "induction, roots"\ngrade = 3',
        "gears.grade = 3",
        'has no strength of "induction, roots" in the tables. Known: grade 1, grade 2; or give',
    ),
    "surface of a carburised gear": (
        "grade = 1",
        'surface_hardness = "50 HRC"',
        'gears.surface_hardness = "50 HRC"',
        "changes nothing: of carburised steel no strength depends on it. Remove it",
    ),
    "quality too high": (
        "quality = 8 ",
        "quality = 13 ",
        "rating.quality = 13",
        "is not between 5 and 11. So accurate gears have no curve of K_v: write quality = 11",
    ),
    "quality of ISO": (
        "quality = 8 ",
        'quality = "ISO 6" ',
        'rating.quality = "ISO 6"',
        "write accuracy = 6 instead of quality",
    ),
    "quality of AGMA 2015": (
        "quality = 8 ",
        'quality = "A5" ',
        'rating.quality = "A5"',
        "write quality = 11, or give K_v in [rating.given]",
    ),
    "two qualities": (
        "quality = 8 ",
        "quality = 8\naccuracy = 9",
        "rating.accuracy = 9",
        "conflicts with quality; one is enough. Remove it",
    ),
    "life without a unit": (
        '"20000 h"',
        '"20000"',
        'rating.life = "20000"',
        'Write life = "20000 h"',
    ),
    "no life": ('life = "20000 h"\n', "", "rating.life", 'Write, for example, life = "20000 h"'),
    "temperature as a number": (
        "quality = 8 ",
        "temperature = 80\nquality = 8",
        "rating.temperature = 80",
        'Write temperature = "80 degC"',
    ),
    "reliability as a number": (
        "quality = 8 ",
        "reliability = 99\nquality = 8",
        "rating.reliability = 99",
        'Write reliability = "99 %"',
    ),
    "another standard": (
        '"agma"',
        '"din3990"',
        'rating.standard = "din3990"',
        'DIN 3990 is not supported. Nearest: standard = "iso6336"',
    ),
    "application factor": (
        "overload_factor",
        "application_factor",
        "rating.application_factor = 1.25",
        "Write overload_factor, in [rating]",
    ),
    "one J": (
        GIVEN,
        "[rating.given]\nJ = [0.3]\n#",
        "rating.given.J = [0.3]",
        "is not one value nor a list [pinion, wheel]. Write J = [0.3, 0.3]",
    ),
    **{
        f"{symbol} below 1": (
            GIVEN,
            f"[rating.given]\n{symbol} = 0.8\n#",
            f"rating.given.{symbol} = 0.8",
            "is not between 1 and 1000",
        )
        for symbol in ("K_o", "K_v", "K_m", "K_s", "K_B", "K_T", "C_f")
    },
    "shares": ("# [[load]]", f"{LOADS}#", 'load[2].share = "40 %"', 'Write share = "50 %"'),
    "Y_N beside levels": (
        GIVEN,
        f"[rating.given]\nY_N = 0.9\n{LOADS.replace('40', '50')}#",
        "rating.given.Y_N = 0.9",
        "follows from the levels [[load]] and cannot be given. Remove it",
    ),
    "module and diametral pitch": (
        "pinion_teeth = 20",
        "diametral_pitch = 8\npinion_teeth = 20",
        "stage[1].diametral_pitch = 8",
        "conflicts with module; one is enough. Remove it",
    ),
    "shift too large": (
        "profile_shift = 0.2",
        "profile_shift = 5",
        "stage[1].pinion.profile_shift = 5",
        "is not between -3 and 3",
    ),
    "shift as a length": (
        "profile_shift = 0.2",
        'profile_shift = "0.6 mm"',
        'stage[1].pinion.profile_shift = "0.6 mm"',
        "Write the coefficient x, the shift over the normal module",
    ),
    "thicker teeth": (
        "profile_shift = 0.2",
        'thickness_allowance = "0.05 mm"',
        'stage[1].pinion.thickness_allowance = "0.05 mm"',
        'Write thickness_allowance = "-0.05 mm"',
    ),
    "two hands": (
        "# helix_angle",
        'wheel_hand = "right"\n# helix_angle',
        'stage[1].wheel_hand = "right"',
        "Write pinion_hand, in a [[stage]]; the wheel has the other hand",
    ),
    "hand of spur gears": (
        "# helix_angle",
        'pinion_hand = "left"\n# helix_angle',
        'stage[1].pinion_hand = "left"',
        "is the hand of a helix, and these are spur gears. Remove it",
    ),
    "roughness without oil": (
        "grade = 1",
        'roughness = "1 um"',
        'gears.roughness = "1 um"',
        "changes nothing: without oil_viscosity only C_H takes it",
    ),
    "wheel with fewer teeth": (
        "wheel_teeth = 60",
        "wheel_teeth = 16",
        "stage[1].wheel_teeth = 16",
        "Exchange stage[1].wheel_teeth and stage[1].pinion_teeth",
    ),
    "internal gear": (
        "wheel_teeth = 60",
        "wheel_teeth = -60",
        "stage[1].wheel_teeth = -60",
        'A ring has ring_teeth, above zero, in a [[stage]] of type = "internal"',
    ),
    "teeth as a range": (
        "pinion_teeth = 20",
        "pinion_teeth = [18, 24]",
        "stage[1].pinion_teeth = [18, 24]",
        "a rating takes given gears, and to size them takes [limits] and a ratio",
    ),
    "no wheel": (
        "wheel_teeth = 60",
        "",
        "stage[1].wheel_teeth",
        "is missing: a rating takes given gears",
    ),
    "rating misspelt": ("[rating]", "[ratings]", "ratings", "Did you mean rating?"),
    "symbol of 2101": (
        GIVEN,
        "[rating.given]\nY_J = 0.3\n#",
        "rating.given.Y_J = 0.3",
        "Write J, in [rating.given]",
    ),
    "teeth in the table of the pinion": (
        "profile_shift = 0.2",
        "teeth = 20",
        "stage[1].pinion.teeth = 20",
        "Write pinion_teeth",
    ),
    "no rating": (RATING, "", "limits", "to rate given gears, write a table [rating]"),
}


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "pair.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.mark.parametrize("mistake", WRONG)
def test_a_wrong_file_is_told_in_one_line(mistake, file, here):
    old, new, key, write = WRONG[mistake]
    assert old in RIGHT
    path = file(RIGHT.replace(old, new, 1))
    said = here("rate", path)
    assert said.returncode == 2 and said.stdout == ""
    (line,) = said.stderr.splitlines()
    assert line.startswith(f"gearopt: {path}: {key}: ") and write in line


SPELT = {
    "carburized": ('"carburised"', '"carburized"'),
    "AGMA": ('"agma"', '"AGMA"'),
    "German": ('"carburised"', '"einsatzgehärtet"'),
    "80 C": ("quality = 8 ", 'temperature = "80 C"\nquality = 8 '),
    "A_v": ("quality = 8 ", "accuracy = 9 "),
}


@pytest.mark.parametrize("way", SPELT)
def test_other_ways_to_say_the_same(way, file):
    old, new = SPELT[way]
    one, other = (gearopt.rate(file(text)) for text in (RIGHT, RIGHT.replace(old, new, 1)))
    assert one.limits == other.limits


def test_steel_words_are_read(file):
    """Quenched and tempered steel is through-hardened; its hardness is then missed."""
    text = RIGHT.replace('"carburised"', '"quenched and tempered"\nhardness = "300 HB"')
    found = gearopt.rate(file(text))
    assert found.design["rating"]["gears"][0]["material"] == "through-hardened, grade 1, 300 HB"


SIZED = """
[limits]
preset = "chong-lee-elevator"
pinion_teeth = [20, 40]
"""


def test_gears_that_are_open_are_named(file, here):
    """A file to be sized is rated by `solve`: `rate` says which keys are missing."""
    text = RIGHT.replace('module = "3 mm"', "").replace("wheel_teeth = 60", "")
    path = file(text.replace("[duty]", "[duty]\nratio = 3") + SIZED)
    said = here("rate", path)
    assert said.returncode == 2
    assert "write stage[1].module, stage[1].wheel_teeth; or gearopt solve FILE" in said.stderr


@pytest.mark.parametrize("command", ["solve", "explain", "compare"])
def test_what_has_no_limits_is_not_solved(command, file, here):
    said = here(command, file(RIGHT))
    assert said.returncode == 2 and said.stdout == ""
    assert said.stderr.count("gearopt rate FILE rates its gears") == 1


@pytest.mark.parametrize(
    ("line", "key"),
    [
        ('[gears]\ntreatment = "carburised"', "gears.treatment"),
        ('[[load]]\npower = "1 kW"\nshare = 1', "load"),
    ],
)
def test_what_only_a_rating_needs_is_refused_without_one(line, key, file, here):
    text = RIGHT.split("[stage.pinion]")[0].replace("[duty]", "[duty]\nratio = 3")
    said = here("solve", file(f"{text}\n{line}\n{SIZED}"))
    assert said.returncode == 2
    assert f": {key}" in said.stderr and "needs a table [rating]. Remove it" in said.stderr


def test_a_file_without_rating_is_not_rated(here):
    said = here("rate", PROBLEMS / "elevator.toml")
    assert said.returncode == 2 and "gearopt new rating shows how" in said.stderr
    said = here("rate", PROBLEMS / "servo_axis.toml")
    assert said.returncode == 2 and 'takes kind = "drive", not "servo"' in said.stderr
