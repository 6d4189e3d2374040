"""The best design and those made by rules, side by side: rows that terminal and page both show."""

from collections.abc import Sequence

from gearopt.optimise.result import Result
from gearopt.report.result_words import RULED, objective
from gearopt.report.words import heading, limit_words, number

OF_STAGE = {
    "ratio": "ratio u",
    "centre_distance_mm": "a [mm]",
    "face_width_mm": "b [mm]",
}
OF_DRIVE = ("ratio", "ratio_error_percent", "gear_volume_mm3")


def side_by_side(result: Result) -> tuple[list[str], list[list[str]], list[str]]:
    """Heads, rows (a label, then a cell a design) and sentences; no rows without such parts.

    The first column is the result itself, or the gears that its layout is of.
    """
    best = next((part for part in result.parts if part.name == "gears"), result)
    ruled = [part for part in best.parts if part.name in RULED]
    missing = [_missing(part) for part in ruled if part.value is None]
    designs = [best, *(part for part in ruled if part.value is not None)]
    if best.value is None or not ruled:
        return [], [], []
    heads = ["", best.method, *(part.name for part in designs[1:])]
    return heads, [*_stages(designs), *_totals(designs, best.bound)], missing


def _stages(designs: Sequence[Result]) -> list[list[str]]:
    rows = []
    for k in range(len(designs[0].design["stages"])):
        stages = [one.design["stages"][k] for one in designs]
        teeth = [
            f"{number(s['normal_module_mm'])}, {s['pinion_teeth']}/{s['wheel_teeth']}"
            for s in stages
        ]
        rows.append([f"stage {k + 1}: m_n, z1/z2", *teeth])
        rows += [
            [f"stage {k + 1}: {label}", *(number(s[key]) for s in stages)]
            for key, label in OF_STAGE.items()
        ]
    return rows


def _totals(designs: Sequence[Result], bound: float | None) -> list[list[str]]:
    rows = [[heading(key), *(number(one.design[key]) for one in designs)] for key in OF_DRIVE]
    name, unit = objective(designs[0])
    if name != "gear volume":
        rows.append([f"{name} [{unit}]", *(number(one.value) for one in designs)])
    if bound is not None and bound > 0.0:
        over = (100.0 * ((one.value or 0.0) / bound - 1.0) for one in designs)
        rows.append(["over the bound [%]", *(f"{max(x, 0.0):.2f}" for x in over)])
    return rows


def _missing(part: Result) -> str:
    """Why there is no design by a process, with the violated limit in words."""
    first, _, rest = part.message.partition(" ")
    return f"No design by {part.name}: {limit_words(first)} {rest}".rstrip(". ") + "."
