"""What a rating tells of files that are possible but that no designer would build."""

import pytest
from campaigns import few

import gearopt

PAIR = """
gearopt = 1
kind = "drive"
[duty]
power = "12 kW"
input_speed = "1450 rpm"
[gears]
treatment = "carburised"
grade = 1
iso_material = "Eh"
iso_quality = "MQ"
flank_rz = "4.8 um"
root_rz = "20 um"
#gears
[[stage]]
module = "4 mm"
pinion_teeth = 20
wheel_teeth = 75
face_width = "48 mm"
#stage
[stage.pinion]
profile_shift = 0.3
#pinion
[stage.wheel]
#wheel
[rating]
standard = "both"
quality = 9
life = "20000 h"
#rating
[rating.iso6336]
accuracy_grade = 6
#iso
"""
SECOND = """[[stage]]
module = "{}"
pinion_teeth = 20
wheel_teeth = 70
face_width = "{}"
[rating]"""
GEARS = 'treatment = "carburised"\ngrade = 1\niso_material = "Eh"\niso_quality = "MQ"'
CASES = {  # name -> (replacements, what is told)
    "wide face": ({'"48 mm"': '"170 mm"'}, "2.12 d1: above 2"),
    "wider face": ({'"48 mm"': '"400 mm"'}, "5 d1: above 2"),
    "narrow face": ({'"48 mm"': '"10 mm"'}, "2.5 m_n: below 3"),
    "very narrow face": ({'"48 mm"': '"4 mm"'}, "1 m_n: below 3"),
    "small overlap": ({"#stage": 'helix_angle = "8 deg"'}, "overlap ratio of stage 1 is 0.532"),
    "smaller overlap": ({"#stage": 'helix_angle = "3 deg"'}, "overlap ratio of stage 1 is 0.2"),
    "flat flanks": (
        {
            "#gears": 'pressure_angle = "9 deg"\naddendum = 0.5',
            '"both"': '"iso6336"',
            "quality = 9\n": "",
            "grade = 1\n": "",
        },
        "pressure angle of stage 1 is 9°",
    ),
    "modules": ({"[rating]": SECOND.format("2 mm", "80 mm")}, "4 and 2 mm, are out of proportion"),
    "modules, a little": ({"[rating]": SECOND.format("3.5 mm", "80 mm")}, "4 and 3.5 mm, are out"),
    "heavy": (
        {"[rating]": SECOND.format("10 mm", "200 mm")},
        "weigh 682 kg, 654 kg of it in stage 2",
    ),
    "heavy by contact": (
        {"[rating]": SECOND.format("10 mm", "200 mm"), '"12 kW"': '"60 kW"'},
        "The contact stress of its pinion decides that: mass",
    ),
    "oversize": (
        {'"4 mm"': '"10 mm"', '"48 mm"': '"100 mm"'},
        "kW where 12 kW is asked for: far smaller gears would do",
    ),
    "wide distance": ({"#stage": 'centre_distance = "193.5 mm"'}, "than gears are made with"),
    "tight distance": ({"#stage": 'centre_distance = "190.5 mm"'}, "do not fit in"),
    "undercut": ({"profile_shift = 0.3": "profile_shift = -0.5"}, "undercut"),
    "pointed": ({"profile_shift = 0.3": "profile_shift = 1.2"}, "tip"),
    "thin tip": ({"profile_shift = 0.3": "profile_shift = 0.9"}, "tip"),
    "large shift": (
        {"#wheel": "profile_shift = 1.5"},
        "profile shift of the wheel of stage 1 is 1.5: those of usual gears are from -0.7 to 1.2",
    ),
    "few teeth": ({"pinion_teeth = 20": "pinion_teeth = 10"}, "undercut"),
    "bore through the root": ({"#pinion": 'bore = "75 mm"'}, "75 mm, leaves nothing"),
    "bore near the root": ({"#pinion": 'bore = "66 mm"'}, "66 mm, leaves a wall of"),
    "shaft of the wheel": ({"#wheel": 'bore = "290 mm"'}, "290 mm, leaves nothing"),
    "coarse": ({"accuracy_grade = 6": "accuracy_grade = 11"}, "of the face width of stage 1"),
    "too hard": ({GEARS: 'steel = "42CrMo4"\nhardness = "390 HB"'}, "42CrMo4 is"),
    "too thick": (
        {GEARS: 'steel = "C45"\nhardness = "240 HB"', '"4 mm"': '"20 mm"', '"48 mm"': '"300 mm"'},
        "C45 reaches some",
    ),
    "soft core": (
        {GEARS: 'steel = "16MnCr5"', '"4 mm"': '"12 mm"', '"48 mm"': '"150 mm"'},
        "reaches 25 HRC",
    ),
    "tip in the root": ({"#wheel": "addendum = 1.3"}, "into the mate's root"),
    "small contact ratio": ({"#gears": "addendum = 0.7"}, "contact ratio of stage 1 is small"),
    "large allowance": ({"#wheel": 'thickness_allowance = "-0.9 mm"'}, "than gears are made with"),
    "interference": ({"#stage": 'centre_distance = "190.2 mm"'}, "tips cut"),
    "two bores": ({"#pinion": 'bore = "100 mm"', "#wheel": 'bore = "400 mm"'}, "leaves nothing"),
}
ALIKE = "wider face", "very narrow face", "smaller overlap", "modules, a little"


@pytest.mark.parametrize("name", few(CASES, [name for name in CASES if name not in ALIKE]))
def test_what_is_unusual_is_told(name, tmp_path):
    changes, told = CASES[name]
    text = PAIR
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "pair.toml"
    path.write_text(text)
    result = gearopt.rate(path)
    rating = result.design["rating"]
    every = *rating.get("flaws", ()), *rating.get("misfits", ()), *result.report.get("notes", ())
    assert any(told in sentence for sentence in every)


def test_usual_gears_have_no_remarks(tmp_path):
    path = tmp_path / "pair.toml"
    text = PAIR.replace('"48 mm"', '"40 mm"').replace("accuracy_grade = 6", "accuracy_grade = 4")
    path.write_text(text)
    assert "flaws" not in gearopt.rate(path).design["rating"]
