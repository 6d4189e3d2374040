"""Key figures of a servo train."""

from collections.abc import Mapping
from typing import Any

from gearopt.report.measures import Measures
from gearopt.report.section import Tile
from gearopt.report.servo_words import arc_minutes, box_size, degrees
from gearopt.report.words import amount, number


def tiles(design: Mapping[str, Any], goal: str, measures: Measures) -> list[Tile]:
    """What a glance shall tell; goal: the objective, which has a tile already."""
    found = []
    if ratio := design.get("ratio"):
        found += _ratio(ratio, goal, measures)
    if train := design.get("train"):
        found += _train(train, goal, measures)
    if chain := design.get("stiffness"):
        stiff = amount(chain["output_Nm_per_rad"], "Nm_per_rad", measures)
        frequency = chain.get("frequency_Hz")
        remark = "" if frequency is None else f"{number(float(frequency))} Hz, motor locked"
        found.append(Tile("stiffness at the output", stiff, remark))
    if (cost := design.get("allocation")) and goal != "cost":
        change = 100.0 * (cost["cost"] / cost["old_cost"] - 1.0)
        found.append(Tile("cost of tolerances", number(cost["cost"]), f"{change:+.1f} %"))
    if drawn := design.get("drawn"):
        good = f"{100.0 * drawn['yield_share']:.4g} %"
        found.append(Tile("yield", good, f"of {drawn['count']:,} drawn trains"))
    if box := design.get("box"):
        fits = "fits" if box["fits"] else "does not fit"
        found.append(Tile("needed room", box_size(box, "needed", measures), f"{fits} the box"))
    return found


def _ratio(ratio: Mapping[str, Any], goal: str, measures: Measures) -> list[Tile]:
    """What the chosen train gives, unless that is the objective; the best ratio without gears."""
    made = []
    if (chosen := ratio.get("chosen")) and not ratio["name"].endswith(goal):
        worse = f"{chosen['loss_percent']:.3g} % worse than the best ratio, no gears"
        value = amount(chosen["value"], ratio["unit"], measures)
        made.append(Tile(f"{ratio['name']} of the train", value, worse))
    value = amount(ratio["value"], ratio["unit"], measures)
    best = number(float(ratio["total_ratio"]))
    without = ", no gears" if ratio.get("chosen") else ""
    return [*made, Tile("best total ratio", best, f"{ratio['name']} {value}{without}")]


def _train(train: Mapping[str, Any], goal: str, measures: Measures) -> list[Tile]:
    error = train.get("ratio_error_percent")
    off = "" if error is None else f", {error:+.3f} %"
    teeth = ", ".join(f"{s['pinion_teeth']}/{s['wheel_teeth']}" for s in train["stages"])
    made = [Tile("ratio of the train", number(float(train["ratio"])), f"{teeth}{off}")]
    if goal != "error" and "error_deg" in train:
        angle = train["error_deg"]
        made.append(Tile("error at the output", degrees(angle), arc_minutes(angle)))
    if goal != "inertia" and "inertia_kg_m2" in train:
        inertia = amount(train["inertia_kg_m2"], "kg_m2", measures)
        made.append(Tile("inertia at the motor", inertia))
    if goal != "mass" and "mass_kg" in train:
        made.append(Tile("mass of the gears", amount(train["mass_kg"], "kg", measures)))
    return made
