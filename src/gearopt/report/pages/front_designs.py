"""The designs of a Pareto front as numbers, limits and sketches, and the tables of its page."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import chain
from typing import Any

from gearopt.optimise.pareto.front import Front, FrontPoint, Impossible
from gearopt.report.design_tables import STAGE_ROWS, stage_label
from gearopt.report.front import heads, rules, stages_of, table, unit_of, value_cells
from gearopt.report.measures import Measures
from gearopt.report.section import Cell, Table, cell
from gearopt.report.words import MODULE, heading, is_module, limit_words, parted

MAIN = (MODULE, "pinion_teeth", "face_width_mm", "wheel_teeth")  # of a stage, the first ones first
LONGEST_LIST = 40  # of numbers of a design; longer ones are curves, which front.json has
AXES, FEW = 9, 6  # of parallel coordinates beside the objectives, about; of names of any length
ALIKE = 2**14  # numbers that are kept as they are written
NUMBER_TIE = 1e-9  # relative; numbers that differ by less are alike
DIFFERENT = "Other numbers that differ between designs (front.csv has all)"
Numbers = dict[str, Cell]  # of a design, by what they are called
NONE = Cell(None, "")  # a number that a design does not have


def numbers(design: Mapping[str, Any], measures: Measures) -> Numbers:
    """Every single number of a design, those of its stages first, by name and unit."""
    cells: Numbers = {}
    for k, stage in enumerate(stages_of(design), 1):
        staged = {key: stage[key] for key in STAGE_ROWS if key in stage}
        staged |= {k: v for k, v in stage.items() if k not in STAGE_ROWS and _is_number(v)}
        for key, value in staged.items():
            unit = STAGE_ROWS.get(key, parted(key))[1]
            cells[f"stage {k}: {_label(key, measures)}"] = _cell(value, key, unit, measures)
    _add(cells, design, measures)
    return cells


def _label(key: str, measures: Measures) -> str:
    return stage_label(key, measures) if key in STAGE_ROWS else heading(key, measures)


def _add(cells: Numbers, group: Mapping[str, Any], measures: Measures, first: str = "") -> None:
    """Add single numbers, those of lists by their place, and those of groups by their name."""
    for key, value in group.items():
        if _is_number(value):
            name = f"{first}{heading(key, measures)}"
            cells[name] = _cell(value, key, parted(key)[1], measures)
        elif isinstance(value, dict):
            _add(cells, value, measures, f"{first}{heading(key, measures)}: ")
        elif isinstance(value, list | tuple) and key != "stages" and len(value) <= LONGEST_LIST:
            name = f"{first}{heading(key, measures)}"
            for k, item in enumerate(value, 1):
                if isinstance(item, dict):
                    _add(cells, item, measures, f"{name} {item.get('name', k)}: ")
                elif _is_number(item):
                    cells[f"{name} {k}"] = _cell(item, key, parted(key)[1], measures)


def _is_number(value: Any) -> bool:
    return value.__class__ is float or value.__class__ is int


@lru_cache(ALIKE, typed=True)  # designs of a front share most of their numbers
def _cell(value: Any, key: str, unit: str, measures: Measures) -> Cell:
    if is_module(key):
        return cell(measures.of_module(value), "", measures)
    return cell(value, unit, measures)


def main(front: Front, each: Sequence[Numbers], measures: Measures) -> list[str]:
    """The names of the numbers that tell designs apart, as many as stand side by side.

    each: numbers of every point. Of stages module, teeth and face width; where these are alike, and
    without stages, what varies.
    """
    if not each:
        return []
    stages = stages_of(front.points[0].design)
    keys = MAIN[: max(1, AXES // len(stages))] if stages else ()
    wanted = [
        f"stage {k}: {_label(key, measures)}" for k in range(1, len(stages) + 1) for key in keys
    ]
    if staged := _different(each, wanted):
        return staged[:AXES]
    columns = zip(*(p.values for p in front.points), strict=True)
    known = [
        [measures.of(v, unit_of(objective)) for v in column]
        for column, objective in zip(columns, front.objectives, strict=True)
    ]
    numbered = [n for n in _names(front, each, measures) if _is_number(each[0].get(n, NONE).value)]
    names = _different(each, numbered)
    return [n for n in names if [named[n].value for named in each] not in known][:FEW]


def _different(each: Sequence[Numbers], names: Sequence[str]) -> list[str]:
    """The names of numbers and words that all designs have and that are not the same in all."""
    columns = ((n, [named.get(n, NONE).value for named in each]) for n in names)
    return [n for n, values in columns if None not in values and _varies(values)]


def _is_word(each: Sequence[Numbers], name: str) -> bool:
    return not _is_number(each[0].get(name, NONE).value)


def _varies(values: Sequence[Any]) -> bool:
    if not all(map(_is_number, values)):
        return len(set(values)) > 1
    low, high = min(values), max(values)
    return bool(high - low > NUMBER_TIE * max(abs(low), abs(high)))


def designs(
    front: Front, each: Sequence[Numbers], shown: Sequence[str], measures: Measures
) -> Table:
    """The table of all designs; its CSV holds every number and limit of them, too.

    each: numbers of every point; shown: names of those that the page shows, too, but for modules
    and teeth, which stand in one column.
    """
    front_table = table(front, measures)
    names = _names(front, each, measures)
    limits = list(dict.fromkeys(name for p in front.points for name in p.limits))
    staged = front.scene is not None
    heads = [*front_table.heads, "proven", *names, *(f"used: {_limit(n, staged)}" for n in limits)]
    rows = [
        [*row, p.proven, *map(cells.get, names), *map(p.limits.get, limits)]
        for row, p, cells in zip(front_table.rows, front.points, each, strict=True)
    ]
    gears = any(stages_of(p.design) for p in front.points)
    kept = {n for n in shown if not gears or "teeth" not in n and measures.module[1] not in n}
    hidden = [h for h in heads[len(front_table.heads) :] if h not in kept]
    return Table("front", ("design", *heads[1:]), rows, csv_only=hidden)


def beaten(front: Front, measures: Measures) -> Table | None:
    """The values of designs that others beat, of which the page shows a plot."""
    if not front.beaten:
        return None
    rows = value_cells(front, front.beaten, measures)
    return Table("dominated designs", heads(front, measures), rows, folded=True)


def impossible(front: Front, measures: Measures) -> Table | None:
    """The limits on objectives under which there is no design; None where all had one."""
    if not front.impossible:
        return None
    most = [f"{head}, at most" for head in heads(front, measures)]
    rows = [
        [
            k,
            *_most(front, step, measures),
            "proven impossible" if step.proven else "none found",
        ]
        for k, step in enumerate(front.impossible, 1)
    ]
    return Table("limits without a design", ("", *most, "result"), rows, texts=("result",))


def _most(front: Front, step: Impossible, measures: Measures) -> list[Cell]:
    limits = ((step.limits.get(o.name), unit_of(o)) for o in front.objectives)
    return [Cell(None, "any") if v is None else cell(v, unit, measures) for v, unit in limits]


def growth(front: Front) -> Table | None:
    """Growth of the front; None where a method finds all of it at once."""
    if len(front.growth) < 2 or not front.hypervolume:
        return None
    rows = [
        (g.seconds, g.evaluations, 100.0 * g.hypervolume / front.hypervolume) for g in front.growth
    ]
    return Table("growth", ("seconds", "evaluations", "hypervolume, %"), rows, folded=True)


def data(
    front: Front, each: Sequence[Numbers], shown: Sequence[str], measures: Measures
) -> dict[str, Any]:
    """Texts by row and a sketch of every design, shown beside the pick.

    shown: names of main numbers. parts: heads and first and last row of each table; in the one of
    limits shares are drawn as bars. values: of the objectives, in full, to sort by.
    """
    worded = [n for n in _different(each, _names(front, each, measures)) if _is_word(each, n)]
    main = [*shown, *(n for n in worded if n not in shown)]
    names = [n for n in _names(front, each, measures) if n not in main]
    alike = set.intersection(*map(set, each)).difference(_different(each, names))
    others = [n for n in names if len(each) == 1 or n not in alike]
    limits = list(dict.fromkeys(name for p in front.points for name in p.limits))
    shown_values = value_cells(front, [p.values for p in front.points], measures)
    points = [
        [
            *(c.text for c in values),
            *[named.get(n, NONE).text for n in main],
            *[_used(p, n) for n in limits],
            *[named.get(n, NONE).text for n in others],
        ]
        for values, p, named in zip(shown_values, front.points, each, strict=True)
    ]
    staged = front.scene is not None
    ends = [0, len(front.objectives) + len(main)]
    ends += [ends[-1] + len(limits), ends[-1] + len(limits) + len(others)]
    titles = (
        "Objectives and main numbers",
        "Utilisation of limits, %",
        "Other numbers" if len(each) == 1 else DIFFERENT,
    )
    return {
        "parts": [[t, a, b] for t, a, b in zip(titles, ends, ends[1:], strict=False) if b > a],
        "limits": ends[1:3],
        "rows": [*heads(front, measures), *main, *(_limit(n, staged) for n in limits), *others],
        "points": points,
        "values": [p.values for p in front.points],
        "shares": [[_share(p.limits.get(n)) for n in limits] for p in front.points],
        "sketches": [sketch(p.design) for p in front.points],
        "rules": {str(k): ", ".join(words) for k, words in rules(front).items()},
    }


def _names(front: Front, each: Sequence[Numbers], measures: Measures) -> list[str]:
    """The names of all numbers of designs that are no objective."""
    known = heads(front, measures)
    return [name for name in dict.fromkeys(chain.from_iterable(each)) if name not in known]


def _share(used: float | None) -> float:
    return round(min(1.0, max(0.0, used or 0.0)), 4)


def _limit(name: str, staged: bool) -> str:
    """A limit in words; one of two indices is of no single stage."""
    return limit_words(name, staged and "," not in name)


def _used(point: FrontPoint, name: str) -> str:
    """The use of a limit in per cent; what is far from it has none."""
    return f"{100.0 * max(0.0, point.limits[name]):.1f}" if name in point.limits else ""


def sketch(design: Mapping[str, Any]) -> dict[str, Any] | None:
    """The gears of a design along the shafts, and the box around them if there is one [mm].

    gears: x, y, tip and reference radius, stage and teeth of each, in one line where they are not
    laid out; box: left, bottom, right, top. None where a size is not known.
    """
    corners: list[list[float]] = []
    if placed := design.get("layout"):
        at = {s["shaft"]: (s["y_mm"], s["z_mm"]) for s in placed["shafts"]}
        for g in placed["gears"]:
            sizes = (0.5 * g["tip_diameter_mm"], 0.5 * g["reference_diameter_mm"])
            corners.append([*at[g["shaft"]], *sizes, g["stage"], g["teeth"]])
        box = placed["box"]
        x, y = box["left_mm"], box["bottom_mm"]
        ends = [x, y, x + box["width_mm"], y + box["height_mm"]]
        return {"gears": _rounded(corners), "box": _rounded([ends])[0]}
    start = 0.0
    for k, stage in enumerate(stages_of(design), 1):
        away = stage.get("centre_distance_mm")
        for member, x in (("pinion", start), ("wheel", start + (away or 0.0))):
            reference = stage.get(f"{member}_diameter_mm")
            tip = stage.get(f"{member}_tip_diameter_mm", reference)
            if away is None or reference is None:
                return None
            corners.append([x, 0.0, 0.5 * tip, 0.5 * reference, k, stage[f"{member}_teeth"]])
        start += away or 0.0
    return {"gears": _rounded(corners)} if corners else None


def _rounded(rows: list[list[float]]) -> list[list[float]]:
    return [[float(f"{v:.5g}") for v in row] for row in rows]
