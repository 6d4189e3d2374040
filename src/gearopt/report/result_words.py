"""A result in cells, as the terminal and its page both show it."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import INCH, METRIC, Measures, diametral_pitch
from gearopt.report.words import VERDICTS, limit_words

RULED = ("process one", "process two")  # parts that are designs by rules
EXACT = 1e-6  # a gap below it is called optimal, one above it is named

INVERSE = {"inverse acceleration": ("acceleration", "rad/s²")}  # name and unit of the inverse

ROWS = {  # of the stage table: what it is called, and its unit (modules are metric in any system)
    "normal_module_mm": ("module m_n [mm]", ""),
    "pinion_teeth": ("teeth z1", ""),
    "wheel_teeth": ("teeth z2", ""),
    "ratio": ("ratio u", ""),
    "face_width_mm": ("face width b", "mm"),
    "pinion_diameter_mm": ("diameter d1", "mm"),
    "wheel_diameter_mm": ("diameter d2", "mm"),
    "centre_distance_mm": ("centres a", "mm"),
    "pinion_torque_Nm": ("torque T1", "Nm"),
    "k_factor_MPa": ("K-factor", "MPa"),
    "unit_load_MPa": ("unit load", "MPa"),
    "gear_volume_mm3": ("volume", "cm3"),
}
_MORE = {  # rows that a page has room for, and after which row they stand
    "wheel_diameter_mm": {
        "pinion_tip_diameter_mm": ("tip diameter d_a1", "mm"),
        "wheel_tip_diameter_mm": ("tip diameter d_a2", "mm"),
        "pinion_root_diameter_mm": ("root diameter d_f1", "mm"),
        "wheel_root_diameter_mm": ("root diameter d_f2", "mm"),
    },
    "centre_distance_mm": {
        "transverse_contact_ratio": ("transverse contact ratio ε_α", ""),
        "overlap_ratio": ("overlap ratio ε_β", ""),
    },
    "pinion_torque_Nm": {"pitch_line_velocity_m_per_s": ("pitch-line velocity v", "m_per_s")},
    "gear_volume_mm3": {
        "pinion_mass_kg": ("pinion mass", "kg"),
        "wheel_mass_kg": ("wheel mass", "kg"),
        "mass_kg": ("mass of both", "kg"),
    },
}
PAGE_ROWS = {
    key: row for last in ROWS for key, row in ({last: ROWS[last]} | _MORE.get(last, {})).items()
}


def certainty(result: Result) -> tuple[str, str]:
    """The status in words, and its colour."""
    words, colour = VERDICTS[result.status]
    if result.status == "optimal" and (result.gap or 0.0) > EXACT:
        words = f"proven within {100 * (result.gap or 0.0):.2g} % of the optimum"
    if "achieved" in result.report:  # something is come near to
        words = words.replace("optimal", "nearest")
    return words, colour


def verdict(result: Result) -> tuple[str, str]:
    """What a reader must know first, and its colour: what is achieved, and how sure that is."""
    words, colour = certainty(result)
    achieved = result.report.get("achieved")
    return (f"{achieved}; {words}" if achieved else words), "yellow" if leading(result) else colour


def leading(result: Result) -> list[str]:
    """What must be read before the numbers: how far the wanted is out of reach; else nothing."""
    reach = result.report.get("reach")
    return [result.message] if reach and not reach["within"] and result.message else []


def title(result: Result) -> str:
    """What a result is called: the title of its file, or the file's name."""
    return str(result.asked.get("title") or result.file or result.scene or result.name)


def objective(result: Result) -> tuple[str, str]:
    """Name of the objective in words, and its unit as a key has it."""
    return str(result.objective["name"]).replace("_", " "), str(result.objective.get("unit", ""))


def goal(result: Result) -> tuple[str, str, float | None, float | None, str]:
    """The objective as a reader asks for it: name, unit, value, bound, on which side none is.

    An inverse that is made least is told as what is made largest by it.
    """
    name, unit = objective(result)
    if name not in INVERSE:
        return name, unit, result.value, result.bound, "below"
    value, bound = (None if not v else 1.0 / v for v in (result.value, result.bound))
    return *INVERSE[name], value, bound, "above"


def stage_rows(
    stages: Sequence[Mapping[str, Any]],
    measures: Measures = METRIC,
    rows: Mapping[str, tuple[str, str]] = ROWS,
) -> list[tuple[str, list[float]]]:
    """Rows of the stage table: what is called so, and its value in every stage."""
    found = []
    for key, (words, unit) in rows.items():
        if not all(key in s for s in stages):
            continue
        label = f"{words} [{measures.unit(unit)}]" if unit else words
        found.append((label, [measures.of(s[key], unit) for s in stages]))
        if key == "normal_module_mm" and measures is INCH:
            pitches = [diametral_pitch(s[key]) for s in stages]
            found.append(("diametral pitch P_nd [1/in]", pitches))
    return found


def ranked(result: Result) -> Result | None:
    """The answer whose next best trains are known: itself, or the gears that were laid out."""
    gears = (part for part in result.parts if part.name == "gears")
    for one in (result, *gears):
        found = one.report.get("trains", ())
        if len(found) > 1 and "objective" in found[0]:  # those of a servo axis have three
            return one
    return None


def train_rows(
    trains: Sequence[Mapping[str, Any]], result: Result, measures: Measures = METRIC
) -> tuple[tuple[str, ...], list[tuple[Any, ...]]]:
    """Heads (a second line is the unit) and rows of the table of next best trains."""
    name, unit = objective(result)
    length = measures.unit("mm")
    heads = (
        "",
        f"{name}\n{measures.unit(unit)}",
        "ratio",
        "m_n, z1/z2",
        f"centre distances\n{length}",
    )
    rows: list[tuple[Any, ...]] = []
    for k, train in enumerate(trains, 1):
        teeth = "  ".join(
            f"{s['normal_module_mm']:g}, {s['pinion_teeth']}/{s['wheel_teeth']}"
            for s in train["stages"]
        )
        distances = "  ".join(measures.length(s["centre_distance_mm"]) for s in train["stages"])
        value = measures.of(train["objective"], unit)
        rows.append((k, value, train["ratio"], teeth, distances))
    return heads, rows


def limit_rows(limits: Mapping[str, float]) -> tuple[int, list[tuple[str, list[float | None]]]]:
    """Number of stages; every limit with its utilisation in each stage, then in the whole."""
    rows: dict[str, dict[int, float]] = {}
    for name, value in limits.items():
        match = re.fullmatch(r"(.*)\[(\d+)\]", name)
        stem, index = (match[1], int(match[2])) if match else (name, 0)
        rows.setdefault(stem, {})[index] = value
    stages = max((i for r in rows.values() for i in r), default=0)
    order = (*range(1, stages + 1), 0)
    return stages, [(limit_words(stem), [r.get(k) for k in order]) for stem, r in rows.items()]
