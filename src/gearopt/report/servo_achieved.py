"""What a servo axis achieves: in sentences, and beside the best possible in a table."""

from collections.abc import Mapping
from typing import Any

from gearopt.report.measures import METRIC, Measures
from gearopt.report.words import amount, number

LINE = "\n"
DUTIES = {"acceleration": "Largest", "move": "Least", "swing": "Least"}
WHO = {  # of `design.ratio`: the head of its column, in two lines
    "best": "best ratio,\nno gears",
    "best_with_train": "best ratio,\nsame inertia",
    "chosen": "chosen\ntrain",
    "given_train": "given\ntrain",
    "given": "given ratio,\nno gears",
}
ROWS = {  # of a column: its name, and its unit
    "loss_percent": ("worse than the best", "percent"),
    "gear_inertia_kg_m2": ("inertia of the train", "kg_m2"),
    "inertia_ratio": ("inertia ratio, load to motor", ""),
    "motor_speed_rpm": ("largest motor speed", "rpm"),
    "motor_speed_used_percent": ("motor speed used", "percent"),
    "motor_torque_used_percent": ("motor torque used", "percent"),
    "peak_motor_torque_Nm": ("peak motor torque", "Nm"),
    "torque_to_load_percent": ("torque to the load", "percent"),
    "torque_to_rotor_percent": ("torque to the motor's rotor", "percent"),
    "torque_to_gears_percent": ("torque to the train", "percent"),
    "torque_to_friction_percent": ("torque to friction", "percent"),
}
REAL_VALUED = tuple(
    f"real_valued_bound_{key}"
    for key in ("load_acceleration_rad_per_s2", "move_time_s", "rms_torque_Nm")
)
NOTE = (
    "Inertias are seen at the motor; their ratio is that of the load to rotor and train together."
)
SPEEDING = " Torques are shares of the motor's while the load speeds up."


def best_words(found: Mapping[str, Any], measures: Measures = METRIC) -> list[str]:
    """The best total ratio, and what the given one loses."""
    unit, ratio = found["unit"], number(float(found["total_ratio"]))
    best = DUTIES.get(found["duty"], "Best")
    without = ", if gears had no inertia" if found.get("chosen") else ""
    words = [
        f"{best} {found['name']}: {amount(found['value'], unit, measures)} at a total ratio "
        f"of {ratio}{without}."
    ]
    if given := found.get("given"):
        words.append(
            f"At the given ratio of {number(float(given['total_ratio']))} it is "
            f"{_value(given, found, measures)}."
        )
    return words


def train_words(
    report: Mapping[str, Any], found: Mapping[str, Any], measures: Measures = METRIC
) -> list[str]:
    """What the chosen and the given train achieve, and what no train can; found: `design.ratio`."""
    words = []
    for who in ("chosen", "given_train"):
        if one := found.get(who):
            inertia = amount(one["gear_inertia_kg_m2"], "kg_m2", measures)
            train, ratio = who.removesuffix("_train"), number(float(one["total_ratio"]))
            words.append(
                f"The {train} train, of ratio {ratio} and {inertia} at the motor, gives "
                f"{_value(one, found, measures)} than the best."
            )
    if one := found.get("best_with_train"):
        words.append(
            "With the chosen train's inertia the best total ratio is "
            f"{number(float(one['total_ratio']))}, with "
            f"{amount(one['value'], found['unit'], measures)}."
        )
    bounds = [v for k, v in report.items() if k in REAL_VALUED]
    if bounds:
        better = "more" if DUTIES.get(found["duty"]) == "Largest" else "less"
        words.append(
            "Not even real-valued teeth and modules within the limits give "
            f"{better} than {amount(bounds[0], found['unit'], measures)}."
        )
    return words


def note(found: Mapping[str, Any]) -> str:
    """What the table's rows are; found: `design.ratio`."""
    return NOTE + (SPEEDING if found["duty"] != "swing" else "")


def achieved_table(
    found: Mapping[str, Any], measures: Measures = METRIC
) -> tuple[list[str], list[list[Any]]]:
    """Heads and rows of what the axis achieves, a column for every train and ratio.

    Heads have a line's end in them; results of older versions have no rows.
    """
    if not found.get("best"):
        return [""], []
    columns = {who: found[who] for who in WHO if found.get(who)}
    rows: list[list[Any]] = [["total ratio", *(c["total_ratio"] for c in columns.values())]]
    value = f"{found['name']} [{measures.unit(found['unit'])}]"
    rows.append([value, *(measures.of(c["value"], found["unit"]) for c in columns.values())])
    for key, (name, unit) in ROWS.items():
        if not any(key in c for c in columns.values()):
            continue
        cells = [None if key not in c else measures.of(c[key], unit) for c in columns.values()]
        rows.append([f"{name} [{measures.unit(unit)}]" if unit else name, *cells])
    return ["", *(WHO[who] for who in columns)], rows


def _value(one: Mapping[str, Any], found: Mapping[str, Any], measures: Measures) -> str:
    """A value with how far it is from the best."""
    lost = one["loss_percent"]
    less = "less" if (DUTIES.get(found["duty"]) == "Largest") == (lost >= 0.0) else "more"
    return f"{amount(one['value'], found['unit'], measures)}, {abs(lost):.3g} % {less}"
