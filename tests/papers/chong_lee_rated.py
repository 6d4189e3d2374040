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
    return gearopt.solve(
        paper.PROBLEMS / f"{'elevator' if count == 2 else 'three_stage'}.toml"
    ).design


@cache
def rated(name, quality=None, grade=None):
    """The rating of a design by AGMA, that by ISO 6336 beside it.

    quality of material and accuracy grade of ISO, if they are not those of `GEARS` and `RATING`.
    """
    made = stages()[name]
    tables = [
        {"module": f"{m} mm", "pinion_teeth": z1, "wheel_teeth": z2, "face_width": f"{b} mm"}
        | HARDNESS
        for m, z1, z2, b in made
    ]
    gears = GEARS | ({"iso_quality": quality} if quality else {})
    iso = RATING["iso6336"] | ({"accuracy_grade": grade} if grade else {})
    file = {"gearopt": 1, "kind": "drive", "duty": DUTIES[len(made)], "gears": gears}
    asked = {"stage": tables, "rating": RATING | {"iso6336": iso}}
    return gearopt.rate(file | asked).design["rating"]


def least(name, quality=None, grade=None):
    """Of both standards: least S_F, least S_H, what governs, power [kW], whether both reach 1."""
    found, rows = rated(name, quality, grade), []
    for each in (found, found["beside"]):
        root, flank = (
            min(gear[f"{mode}_safety"] for gear in each["gears"]) for mode in ("bending", "contact")
        )
        rows.append(
            (root, flank, each["governs"], each["power_capacity_kW"], min(root, flank) >= 1.0)
        )
    return rows


def rated_rows():
    """The least safety factors of every design by both standards."""
    found = []
    for name in stages():
        for words, row in zip(("AGMA", "ISO 6336"), least(name), strict=True):
            root, flank, governs, power, safe = row
            said = "safe" if safe else "not safe"
            head = name if words == "AGMA" else ""
            cells = f"{root:.2f} | {flank:.2f} | {governs} | {power:.1f} | {said}"
            found.append(f"| {head} | {words} | {cells} |".replace("|  |", "| |"))
    return found


def rated_sentences():
    """Sentences of the page on safety, with their numbers."""
    names = list(stages())
    agma, iso = zip(*(least(name) for name in names), strict=True)
    better = [least(name, "MQ", 5)[1] for name in names]
    factors = rated(OPTIMA[2])["beside"]["factors"]
    first = {f["symbol"]: f for f in factors if f["stage"] == 1}
    limits = [f for f in rated(OPTIMA[2])["factors"] if f["symbol"] == "s_ac"]
    spread = [f for f in rated(OPTIMA[2])["factors"] if f["symbol"] == "K_m"]
    return [
        f"S_H of {span(row[1] for row in agma)} and S_F of {span(row[0] for row in agma)}",
        f"S_H of {span(row[1] for row in iso)}",
        f"{span(row[3] for row in iso)} kW of the",
        f"({first['sigma_Hlim']['wheel']:.0f} against {limits[0]['wheel']:.0f} MPa, of the wheels)",
        f"K_Hbeta K_Halpha of {first['K_Hbeta']['pinion']:.2f} and "
        f"{first['K_Halpha']['pinion']:.2f} beside K_m of {spread[0]['pinion']:.2f}",
        f"S_H rises to {span(row[1] for row in better)}, and of the {len(names)} designs "
        f"{' and '.join(n for n, row in zip(names, better, strict=True) if row[4])} alone is safe",
    ]


def span(values):
    """Least and most of numbers, in words."""
    found = list(values)
    return f"{min(found):.2f} to {max(found):.2f}"
