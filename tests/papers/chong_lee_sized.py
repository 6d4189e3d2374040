"""The duties of Chong and Lee sized by their rating, beside the paper's designs made as wide."""

from functools import cache

import chong_lee as paper
from chong_lee_rated import DUTIES, GEARS, HARDNESS, RATING, stages

import gearopt

TOTALS = {2: {"output_speed": "66.5 rpm"}, 3: {"ratio": 110}}
BY = {"agma": "AGMA", "iso6336": "ISO 6336", "both": "both"}
WIDEST = 2.0  # b/d1 of a widened design, to which K_m is given
ONLY = {  # keys of one standard
    "agma": ("grade", "quality", "mounting", "reliability"),
    "iso6336": ("iso_material", "iso_quality", "flank_rz", "root_rz", "iso6336"),
}


def file(standard, tables):
    """Return the file of a drive that its rating limits; tables: of its stages."""
    count = len(tables)
    other = {"agma": "iso6336", "iso6336": "agma", "both": ""}[standard]
    without = ONLY.get(other, ())
    return {
        "gearopt": 1,
        "kind": "drive",
        "duty": DUTIES[count] | TOTALS[count],
        "gears": {k: v for k, v in GEARS.items() if k not in without},
        "stage": tables,
        "limits": {"pinion_teeth": [20, 40]},
        "teeth": {"modules": "ISO 54 I"},
        "rating": {k: v for k, v in RATING.items() if k not in without} | {"standard": standard},
    }


@cache
def sized(count, standard, low=0.0):
    """Return the result of least volume; low: least b/d1, 0 where widths are the paper's."""
    spans = [[low, high] if low else high for high in paper.PROPORTIONS[count]]
    tables = [{"face_width_over_diameter": span} | HARDNESS for span in spans]
    return gearopt.solve(file(standard, tables))


@cache
def widened(name, standard):
    """Return the volume [mm3] of a design whose stages are just wide enough, None: none is."""
    made = stages()[name]
    tables = []
    for module, z1, z2, width in made:
        d = module * z1 / paper.train(3).stages[0].toothing.cosine
        span = [min(width / d, WIDEST), WIDEST]
        tables.append(
            {"module": f"{module} mm", "pinion_teeth": z1, "wheel_teeth": z2}
            | {"face_width_over_diameter": span}
            | HARDNESS
        )
    asked = file(standard, tables)
    asked["duty"] = asked["duty"] | {"ratio_tolerance": "2 %"}
    found = gearopt.solve(asked, remedies=False)
    return None if found.status == "infeasible" else found.value


WIDTHS = {"tied": 0.0, "free": 0.3}  # least b/d1
CASES = [(count, standard, widths) for count in (2, 3) for standard in BY for widths in WIDTHS]


def first_cells(count, standard, widths):
    """How the row of a case begins."""
    return f"| {count} | {BY[standard]} | {widths} |"


def sized_row(count, standard, widths):
    """Volume of least size by a standard, with what governs."""
    result = sized(count, standard, WIDTHS[widths])
    design = result.design["stages"]
    made = ", ".join(
        f"{s['normal_module_mm']:g} {s['pinion_teeth']}/{s['wheel_teeth']}" for s in design
    )
    breadth = ", ".join(f"{s['face_width_mm']:.1f}" for s in design)
    said = " | ".join((f"{result.value / 1e3:,.0f}", made, breadth, governs(result)))
    return f"{first_cells(count, standard, widths)} {said} |"


def governs(result):
    """What is used most, of which standard."""
    name, used = max(
        (item for item in result.limits.items() if "_bending" in item[0] or "_contact" in item[0]),
        key=lambda item: item[1],
    )
    member, mode = name.split("[")[0].split("_")[:2]
    return f"{mode} of {member} {name.split('[')[1][:-1]}, {100 * used:.1f} %"


def widened_rows():
    """Volumes of the paper's designs, made as wide as their ratings ask for."""
    found = []
    for name, made in paper.DESIGNS.items():
        cells = []
        best = sized(len(made), "agma")
        for standard in ("agma", "iso6336"):
            value = widened(name, standard)
            cells.append("none up to b/d1 = 2" if value is None else f"{value / 1e3:,.0f}")
        saved = 100.0 * (1.0 - best.value / widened(name, "agma"))
        found.append(f"| {name} | {cells[0]} | {cells[1]} | {saved:.1f} |")
    return found


def why_iso_is_larger():
    """Say what quality of material and accuracy make of two stages by ISO 6336, widths tied."""
    first = sized(2, "iso6336")
    factors = {(f["symbol"], f["stage"]): f["pinion"] for f in first.design["rating"]["factors"]}
    face, transverse = (
        [f"{factors[name, k]:.2f}" for k in (1, 2)] for name in ("K_Hbeta", "K_Halpha")
    )
    quality, grade = {"iso_quality": "MQ"}, {"accuracy_grade": 5}
    steel, finer, both = map(_iso_with, (quality, grade, quality | grade))
    return (
        f"Of the two stages with tied widths ({first.value / 1e6:.0f} dm³ by ISO 6336, "
        f"{sized(2, 'agma').value / 1e6:.1f} by AGMA) quality MQ in place of ML leaves "
        f"{steel / 1e6:.1f} dm³, accuracy grade 5 in place of 8 leaves {finer / 1e6:.1f}, "
        f"both leave {both / 1e6:.1f}: grade 8 without modification costs K_Hβ of "
        f"{' and '.join(face)} and K_Hα of {' and '.join(transverse)}."
    )


def _iso_with(better):
    """Return the volume [mm3] with another quality of material, another accuracy grade."""
    tables = [{"face_width_over_diameter": b} | HARDNESS for b in paper.PROPORTIONS[2]]
    asked = file("iso6336", tables)
    if quality := better.get("iso_quality"):
        asked["gears"] = asked["gears"] | {"iso_quality": quality}
    if grade := better.get("accuracy_grade"):
        made = asked["rating"]["iso6336"] | {"accuracy_grade": grade}
        asked["rating"] = asked["rating"] | {"iso6336": made}
    return gearopt.solve(asked).value
