"""The designs of Chong and Lee and the minimum volumes, rated by AGMA and by ISO 6336."""

from functools import cache

import chong_lee as paper

import gearopt

DUTIES = {
    2: {"power": "7.5 kW", "input_speed": "1450 rpm"},
    3: {"power": "8 kW", "input_speed": "3520 rpm"},
}
GEARS = {
    "helix_angle": "25 deg",
    "treatment": "through-hardened",
    "grade": 1,
    "iso_material": "V alloy",
    "iso_quality": "ML",
    "flank_rz": "4.8 um",
    "root_rz": "20 um",
    "tool_addendum": 1.25,
    "tool_tip_radius": 0.25,
}
HARDNESS = {"pinion": {"hardness": "335 HB"}, "wheel": {"hardness": "300 HB"}}
RATING = {
    "standard": "both",
    "life": "20000 h",
    "reliability": "99 %",
    "overload_factor": 1.25,
    "quality": 7,
    "mounting": "commercial",
    "iso6336": {"accuracy_grade": 8, "oil_grade": "220 mm^2/s"},
}
OPTIMA = {2: "optimum, two stages", 3: "optimum, three stages"}


def stages():
    """Module, teeth and face width [mm] of every stage, of every design by its name."""
    found = {
        name: [(s.m, s.z1, s.z2, float(s.b)) for s in design]
        for name, design in paper.DESIGNS.items()
    }
    for count, name in OPTIMA.items():
        found[name] = [
            (s["normal_module_mm"], s["pinion_teeth"], s["wheel_teeth"], s["face_width_mm"])
            for s in optimum(count)["stages"]
        ]
    return found


@cache
def optimum(count):
    """The design of minimum volume of two or three stages."""
    return gearopt.solve(paper.PROBLEMS / f"{'elevator' if count == 2 else 'three_stage'}.toml").design


def rated(name):
    """The rating of a design by AGMA, that by ISO 6336 beside it."""
    made = stages()[name]
    tables = [
        {"module": f"{m} mm", "pinion_teeth": z1, "wheel_teeth": z2, "face_width": f"{b} mm"}
        | HARDNESS
        for m, z1, z2, b in made
    ]
    file = {"gearopt": 1, "kind": "drive", "duty": DUTIES[len(made)], "gears": GEARS}
    return gearopt.rate(file | {"stage": tables, "rating": RATING}).design["rating"]
