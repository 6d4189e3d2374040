"""What stands beside a servo train: given gears, real-valued bounds, numbers of stages."""

from collections.abc import Mapping
from typing import Any

from gearopt.report.measures import METRIC, Measures
from gearopt.report.servo_words import teeth_words
from gearopt.report.words import heading

DUTY = ("load_acceleration_rad_per_s2", "move_time_s", "rms_torque_Nm")
ROWS = (  # of the report, after chosen_, given_ or real_valued_bound_
    *("ratio", "inertia_kg_m2", "mass_kg", "error_deg"),
    *("output_stiffness_Nm_per_rad", "frequency_Hz", "windup_deg"),
    *DUTY,
)
WHOSE = {"chosen": "chosen", "given": "given", "real_valued_bound": "real-valued bound"}
COUNTS = ("stages", "least inertia", "at ratios", "least mass")
BARE = (
    "A bare train of the same ratio by its number of stages: all pinions alike, all gears full "
    "discs of one width, no limit but the ratio; inertia at the motor and mass in those of a "
    "pinion."
)
UNITS = {
    "inertia_kg_m2": "kg_m2",
    "mass_kg": "kg",
    "error_deg": "deg",
    "output_stiffness_Nm_per_rad": "Nm_per_rad",
    "frequency_Hz": "Hz",
    "windup_deg": "deg",
    "load_acceleration_rad_per_s2": "rad_per_s2",
    "move_time_s": "s",
    "rms_torque_Nm": "Nm",
}


def beside_rows(report: Mapping[str, Any], measures: Measures = METRIC) -> list[list[Any]]:
    """A row for every figure: name, chosen, given, real-valued bound; none without given gears."""
    if "given_ratio" not in report or "chosen_ratio" not in report:
        return []
    rows = []
    for key in ROWS:
        train = "_train" if key in DUTY else ""  # given_ alone is at a given ratio, without gears
        values = [
            report.get(f"{whose}{train if whose == 'given' else ''}_{key}") for whose in WHOSE
        ]
        if all(value is None for value in values[:2]):
            continue
        unit = UNITS.get(key, "")
        shown = [None if v is None else float(measures.of(v, unit)) for v in values]
        rows.append([heading(key, measures), *shown])
    return rows


def given_teeth(report: Mapping[str, Any]) -> str:
    """The given gears in a sentence."""
    return f"Given: {teeth_words(report['given_train']['stages'])}."


def count_rows(report: Mapping[str, Any]) -> list[list[Any]]:
    """Rows below COUNTS."""
    return [
        [
            row["stages"],
            row["inertia_in_pinions"],
            " x ".join(f"{n:.3f}" for n in row["ratios_of_least_inertia"]),
            row["mass_in_pinions"],
        ]
        for row in report.get("stage_counts") or ()
    ]
