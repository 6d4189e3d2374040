"""A result in words and cells, as the terminal and its page both show it."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.measures import INCH, METRIC, Measures, diametral_pitch
from gearopt.report.words import VERDICTS, amount, limit_words

RULED = ("process one", "process two")  # parts that are designs by rules
EXACT = 1e-6  # a gap below it is called optimal, one above it is named

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


def verdict(result: Result) -> tuple[str, str]:
    """The status in words, and its colour."""
    words, colour = VERDICTS[result.status]
    if result.status == "optimal" and (result.gap or 0.0) > EXACT:
        words = f"proven within {100 * (result.gap or 0.0):.2g} % of the optimum"
    return words, colour


def title(result: Result) -> str:
    """What a result is called: the title of its file, or the file's name."""
    return str(result.asked.get("title") or result.file or result.scene or result.name)


def objective(result: Result) -> tuple[str, str]:
    """Name of the objective in words, and its unit as a key has it."""
    return str(result.objective["name"]).replace("_", " "), str(result.objective.get("unit", ""))


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


def proof(result: Result, measures: Measures = METRIC) -> list[str]:
    """What is certain, in sentences."""
    lines: list[str] = []
    name, unit = objective(result)
    if result.bound is not None and result.gap is not None:
        lines.append(
            f"Bound: no {name} below {amount(result.bound, unit, measures)} is possible; "
            f"gap {100 * result.gap:.3g} %."
        )
    lines += _method(result)
    for part in result.parts:
        alike = part.objective["name"] == result.objective["name"]
        if part.name in ("sizing", "apart") and alike and result.status == "optimal":
            lines += _beside(result, part, measures)
    lines += result.report.get("notes", []) if result.status != "infeasible" else []
    if result.message and result.status != "infeasible":
        lines.append(result.message[0].upper() + result.message[1:] + ".")
    lines.append(f"{result.method}, {result.evaluations:,} evaluations, {result.seconds:.3g} s.")
    return lines


def _beside(result: Result, part: Result, measures: Measures) -> list[str]:
    """What another way to the same objective gives: real-valued sizes, or gears chosen first."""
    if part.value is None or result.value is None:
        return []
    more = 100 * (result.value / part.value - 1)
    value = amount(part.value, objective(result)[1], measures)
    if part.name == "apart":
        return [
            f"Gears chosen first and then laid out: {value} (at once is {-more:.2f} % smaller)."
        ]
    return [
        f"With real-valued teeth and modules: {value} "
        f"(whole teeth and standard modules cost {more:.2f} %)."
    ]


def _method(result: Result) -> list[str]:
    """How it was proven: whole teeth exhausted, cells of angles bounded, or a dual bound."""
    proof, lines = result.proof, []
    exhausted = proof.get("method") == "exhausted"
    if "trains_compared" in proof and exhausted and result.status == "infeasible":
        lines.append(
            "Proof: every choice of teeth and modules was compared or excluded; none "
            "meets all limits."
        )
    elif "trains_compared" in proof and exhausted:
        lines.append(
            f"Proof: {proof['trains_compared']:,} trains compared, all others excluded by "
            f"lower bounds (nodes opened: {proof['nodes']:,})."
        )
    elif "trains_looked_at" in proof and exhausted:
        rest = "meets all limits" if result.status == "infeasible" else "can be better"
        lines.append(
            f"Proof: {proof['trains_looked_at']:,} choices of teeth and modules looked at; no "
            f"other {rest}."
        )
    elif "pairs_matched" in proof:
        lines.append(
            f"Proof: {proof['pairs_matched']:,} ratios of a pair, each with the two that miss "
            "least with it, in rational arithmetic."
        )
    elif "ways_to_share_out" in proof:
        lines.append(_shared_out(proof))
    elif "trains_laid_out" in proof:
        count = sum(proof["nodes"].values())
        lines.append(
            f"Proof: {count:,} trains and parts of trains bounded, {proof['trains_laid_out']:,} "
            f"laid out in full ({proof['method']})."
        )
    elif "pruning_margin" in proof and "nodes" in proof:
        lines.append(
            f"Proof: {proof['nodes']:,} cells of link angles, each bounded by intervals "
            f"({proof['method']})."
        )
    elif proof.get("method") == "dual" and result.bound is not None:
        lines.append(
            "Proof: the problem is convex in logarithms; the bound is a dual one, computed "
            "from our own derivatives."
        )
    elif proof.get("method") == "closed form" and result.bound is not None:
        lines.append("Proof: a closed form, and a bound that follows from convexity alone.")
    if result.status == "infeasible" and proof.get("conflict") and "least_violation" not in proof:
        lines.append(f"Proof: {result.message}.")
    elif result.status == "infeasible" and proof.get("reason"):
        lines.append(f"Proof: {proof['reason']}.")
    elif result.status == "infeasible" and proof.get("conflict"):
        names = ", ".join(limit_words(n) for n in proof["conflict"])
        least = 100 * proof["least_violation"]
        lines.append(
            f"Proof: whatever the sizes, even with real-valued teeth and modules, one of these "
            f"limits is missed by at least {least:.2g} %: {names}."
        )
    return lines


def _shared_out(found: Mapping[str, Any]) -> str:
    """How the bound is known, in a sentence."""
    if found["method"] == "volume":
        return "Bound: the volume of the cylinders, and the widest with the highest of them."
    ways = found["ways_to_share_out"]
    shared = f"{ways:,} ways to share the cylinders out among layers" if ways > 1 else "one layer"
    return (
        f"Bound: {shared}; for each the least plan that discs, pairs and triples in any order "
        "need, by subdivision of the width."
    )
