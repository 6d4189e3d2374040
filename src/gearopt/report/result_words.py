"""A result in words and cells, as the terminal and its page both show it."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.words import UNITS, VERDICTS, limit_words, number

RULED = ("process one", "process two")  # parts that are designs by rules
EXACT = 1e-6  # a gap below it is called optimal, one above it is named

ROWS = {  # of the stage table: what it is called, and the factor to its unit
    "normal_module_mm": ("module m_n [mm]", 1),
    "pinion_teeth": ("teeth z1", 1),
    "wheel_teeth": ("teeth z2", 1),
    "ratio": ("ratio u", 1),
    "face_width_mm": ("face width b [mm]", 1),
    "pinion_diameter_mm": ("diameter d1 [mm]", 1),
    "wheel_diameter_mm": ("diameter d2 [mm]", 1),
    "centre_distance_mm": ("centres a [mm]", 1),
    "pinion_torque_Nm": ("torque T1 [N m]", 1),
    "k_factor_MPa": ("K-factor [MPa]", 1),
    "unit_load_MPa": ("unit load [MPa]", 1),
    "gear_volume_mm3": ("volume [cm³]", 1e-3),
}


def verdict(result: Result) -> tuple[str, str]:
    """The status in words, and its colour."""
    words, colour = VERDICTS[result.status]
    if result.status == "optimal" and (result.gap or 0.0) > EXACT:
        words = f"proven within {100 * (result.gap or 0.0):.2g} % of the optimum"
    return words, colour


def objective(result: Result) -> tuple[str, str]:
    """Name of the objective in words, and its unit."""
    unit = result.objective.get("unit", "")
    return str(result.objective["name"]).replace("_", " "), UNITS.get(unit, unit)


def stage_rows(stages: Sequence[Mapping[str, Any]]) -> list[tuple[str, list[str]]]:
    """Rows of the stage table: what is called so, and its value in every stage."""
    return [
        (label, [number(s[key] if factor == 1 else factor * s[key]) for s in stages])
        for key, (label, factor) in ROWS.items()
    ]


def train_rows(
    trains: Sequence[Mapping[str, Any]], result: Result
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Heads (a second line is the unit) and rows of the table of next best trains."""
    name, unit = objective(result)
    heads = ("", f"{name}\n{unit}", "ratio", "m_n, z1/z2", "centre distances\nmm")
    rows: list[tuple[str, ...]] = []
    for k, train in enumerate(trains, 1):
        teeth = "  ".join(
            f"{s['normal_module_mm']:g}, {s['pinion_teeth']}/{s['wheel_teeth']}"
            for s in train["stages"]
        )
        distances = "  ".join(f"{s['centre_distance_mm']:.2f}" for s in train["stages"])
        rows.append((str(k), number(train["objective"]), f"{train['ratio']:.4f}", teeth, distances))
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


def proof(result: Result) -> list[str]:
    """What is certain, in sentences."""
    lines: list[str] = []
    name, unit = objective(result)
    if result.bound is not None and result.gap is not None:
        lines.append(
            f"Bound: no {name} below {number(result.bound)} {unit} is possible; "
            f"gap {100 * result.gap:.3g} %."
        )
    lines += _method(result)
    for part in result.parts:
        beside = part.name in ("sizing", "apart")
        if (
            beside
            and part.objective["name"] == result.objective["name"]
            and result.status == "optimal"
        ):
            lines += _beside(result, part, unit)
    lines += result.report.get("notes", []) if result.status != "infeasible" else []
    if result.message and result.status != "infeasible":
        lines.append(result.message[0].upper() + result.message[1:] + ".")
    lines.append(f"{result.method}, {result.evaluations:,} evaluations, {result.seconds:.3g} s.")
    return lines


def _beside(result: Result, part: Result, unit: str) -> list[str]:
    """What another way to the same objective gives: real-valued sizes, or gears chosen first."""
    if part.value is None or result.value is None:
        return []
    more = 100 * (result.value / part.value - 1)
    if part.name == "apart":
        value = f"{number(part.value)} {unit}"
        return [
            f"Gears chosen first and then laid out: {value} (at once is {-more:.2f} % smaller)."
        ]
    return [
        f"With real-valued teeth and modules: {number(part.value)} {unit} "
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
    if result.status == "infeasible" and proof.get("conflict"):
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
