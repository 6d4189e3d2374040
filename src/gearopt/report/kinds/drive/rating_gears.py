"""Capacity and life of every gear of a rating, by every standard: spectrum, factors, sources."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.rating import (
    GIVEN,
    DriveRating,
    GearRating,
    LoadLevel,
    RatingFactor,
    StaticRating,
)
from gearopt.formulations.strength.standard import MIDWAY
from gearopt.optimise.result import Result
from gearopt.report.kinds.drive.rating_tables import figure, name, names, single
from gearopt.report.kinds.drive.rating_words import (
    AT_ONCE,
    LONGEST_LIFE,
    SHOWN_UNITS,
    STANDARD_HEADS,
    efficiency,
    greek,
    hours,
    life,
    life_governed,
    nearest,
    of_standards,
    rated_sentence,
    rating_of,
    stress_words,
    unsure,
    unverified,
)
from gearopt.report.measures import Measures, rounded
from gearopt.report.section import Cell, ListedField, Section, Table, cell, listed_fields, percent
from gearopt.report.words import RATING, parted, series_of

ONCE = 4  # fields of a load level that hold for all gears
DAMAGE_DIGITS = 3
PERMISSIBLE = (
    "σ_FG and σ_HG are the tooth root and the pitting stress limit; permissible are σ_FP and σ_HP, "
    "the limits over the required safety factors."
)
LOAD_FACTORS = (
    "By ISO 6336, K_v and the face and transverse load factors depend on the load: the power "
    "capacity is rated with their values at that power."
)
AT_PEAK = (
    "Static strength by ISO 6336 at the peak torque, at the speed of the duty: K_A is 1, the other "
    "load factors are those of that torque; Z_NT and Y_NT are at their static ends, Z_L, Z_v, Z_R, "
    "Y_RrelT and Y_X are 1. The peak torque is taken to act seldom: it adds nothing to the lives."
)
ABREAST = {"AGMA": 3, "ISO 6336": 2}  # stages whose factors fit side by side on a terminal


def gears(result: Result, measures: Measures) -> Section | None:
    """Stresses, safety factors and lives of every gear; None without a rating."""
    if (rating := rating_of(result)) is None:
        return None
    rows = [[Cell(row[0], greek(row[0])), *row[1:]] for row in _gear_rows(rating, measures)]
    stresses = [it.head(measures) for it in _fields(rating) if it.unit == "MPa"]
    hidden = stresses if rating.levels else []
    heads = [_head(rating, rated, gear) for rated, gear in _columns(rating)]
    table = Table("gears", ["", *heads], rows, csv_only=hidden, across=True)
    half = single(rating) and rating.beside is None
    shown = _on_terminal(result, rating, measures)
    assumed = result.report.get("assumptions") or ()
    words = [*_said(rating), *(line for line in assumed if line.startswith(MIDWAY))]
    return Section("Rating", words=words, tables=(table,), half=half, terminal=shown)


def _said(rating: DriveRating) -> list[str]:
    """Standards, and meaning of safety factors and lives."""
    words = [
        _standards(rating),
        "S_F and S_H are the stress limit, without a safety factor, over the actual stress; S_H "
        "squared is the safety factor of the load.",
    ]
    if any(rated.by == "ISO 6336" for rated in rating.each):
        words += [PERMISSIBLE, LOAD_FACTORS]
    if len(rating.meshes) > 1:
        words.append(f"Closest to their required safety factors: {'; '.join(nearest(rating))}.")
    if rating.levels:
        words.append("Safety factors are of the whole load spectrum, by Miner's rule.")
    lives = [(g.bending_life_cycles, g.contact_life_cycles) for _, g in _columns(rating)]
    if any(None in both for both in lives):
        words.append(
            f"The life curves end at {LONGEST_LIFE} cycles; a longer life is given as over so many "
            "cycles, and as over the hours that they take."
        )
    return words


def _standards(rating: DriveRating) -> str:
    return f"Rated by {'; and by '.join(rated.standard for rated in rating.each)}."


def _columns(rating: DriveRating) -> list[tuple[DriveRating, GearRating]]:
    """Every gear by every standard, those of one gear side by side."""
    each = [[(rated, gear) for gear in rated.gears] for rated in rating.each]
    return [column for columns in zip(*each, strict=True) for column in columns]


def _head(rating: DriveRating, rated: DriveRating, gear: GearRating) -> str:
    """The name of a gear; of two standards with its own."""
    gear_name = name(rating, gear)
    return gear_name if rating.beside is None else f"{gear_name}, {STANDARD_HEADS[rated.by]}"


def _fields(rating: DriveRating) -> list[ListedField]:
    """Fields of a gear's rating, stresses with their symbols."""
    return [
        replace(it, label=stress_words(rating, it.key, it.label))
        for it in listed_fields(GearRating)
    ]


def _gear_rows(rating: DriveRating, measures: Measures) -> Iterator[list[Any]]:
    """Yield the rows of gears, and below every safety factor how much of it is used."""
    asked = {"bending_safety": 0, "contact_safety": 1}
    for it in _fields(rating):
        values = [getattr(gear, it.key) for _, gear in _columns(rating)]
        head = it.head(measures)
        if it.key == "material":
            yield [head, *(Cell(s, s.replace(", ", "\n")) for s in values)]
        elif it.key == "life_h":
            lives = (life(*column).removesuffix(" h") for column in _columns(rating))
            yield [head, *(Cell(value, text) for value, text in zip(values, lives, strict=True))]
        elif "life" in it.key:
            yield [head, *(_life(value, it.key, measures) for value in values)]
        elif not it.key.endswith("_damage"):
            yield [head, *(figure(value, it.key, measures) for value in values)]
        elif rating.levels:
            yield [head, *map(_damage, values)]
        if it.key in asked:
            wanted = [rated.asked_of(gear)[asked[it.key]] for rated, gear in _columns(rating)]
            used = (_used(*both) for both in zip(wanted, values, strict=True))
            words = " and ".join(f"{least:g}" for least in dict.fromkeys(wanted))
            yield [f"utilisation, {it.label} {words} required [%]", *used]


def _used(asked: float, safety_factor: float) -> Cell:
    return percent(asked / safety_factor) if safety_factor > 0.0 else Cell(None, AT_ONCE, 1.0)


def _life(value: float | None, key: str, measures: Measures) -> Cell:
    """A life in cycles; None beyond the end of the curves, 0 before they begin."""
    if not value:
        return Cell(value, f"over {LONGEST_LIFE}" if value is None else AT_ONCE)
    return cell(value, parted(key)[1], measures)


def _damage(value: float | None) -> Cell:
    """A part of Miner's sum; None where the tooth breaks or pits at once."""
    return Cell(None, AT_ONCE) if value is None else Cell(value, rounded(value, DAMAGE_DIGITS))


def _on_terminal(result: Result, rating: DriveRating, measures: Measures) -> list[str | Table]:
    """All gears for the terminal; of an optimum first how it is rated."""
    keys = [it.key for it in listed_fields(GearRating) if it.key.endswith(("_MPa", "_safety"))]
    sign, named = measures.unit("MPa"), rating.beside is not None
    strong = f"limit\n{sign}"
    short = (f"bending\n{sign}", strong, "S_F", f"contact\n{sign}", strong, "S_H")
    rows = [
        [
            name(rating, gear),
            *[STANDARD_HEADS[rated.by]] * named,
            *(figure(getattr(gear, key), key, measures) for key in keys),
        ]
        for rated, gear in _columns(rating)
    ]
    heads = ["gear", *["by"] * named, *keys]
    read = dict(zip(keys, short, strict=True))
    table = Table("gears", heads, rows, short=read, left=1 + named, wrap=9)
    each = [
        f"{life(rated, rated.shortest_lived)} ({life_governed(rated)})" for rated in rating.each
    ]
    asked = f"{';' if named else ','} {hours(rating.required_life_h)} required."
    lives = f"{each[0]} by both" if named and len(set(each)) == 1 else of_standards(rating, each)
    lasts = f"Life at safety factors of 1: {lives}{asked}"
    if rating.efficiency_percent is not None:
        lasts += f" Efficiency of the meshes: {efficiency(rating)}{unsure(rating)}."
    first = [] if result.name == RATING else [measures.words(rated_sentence(rating))]
    end = unverified(rating) if first else []
    return [*first, table, "\n".join([lasts, _standards(rating), *end])]


def levels(result: Result, measures: Measures) -> Section | None:
    """The load spectrum with the damage of every level; None without one."""
    rating = rating_of(result)
    if rating is None or not rating.levels:
        return None
    named = rating.beside is not None
    heads = [it.head(measures) for it in _level_fields(rating)]
    heads[ONCE:ONCE] = ["gear", *["by"] * named]
    each = [[(rated, level) for level in rated.levels] for rated in rating.each]
    pairs = [pair for both in zip(*each, strict=True) for pair in both]
    rows = []
    for rated, level in sorted(pairs, key=lambda pair: pair[1].level):
        row, at = _level_row(rating, level, measures, rated is rating), ONCE + 1
        rows.append([*row[:at], *[STANDARD_HEADS[rated.by]] * named, *row[at:]])
    said = [
        "The damage of a level is its load cycles over those that the gear would bear at this "
        "level alone; the gear fails where the sum of the damages (Miner's sum) reaches 1."
    ]
    said += [
        f"Unverified by {rated.by}: a published spectrum confirms the sum for contact, none for "
        "bending."
        for rated in rating.each
        if any(name.startswith("load spectrum") for name in rated.unverified)
    ]
    return Section(
        "Load spectrum", words=said, tables=(Table("levels", heads, rows),), appendix=True
    )


def static(result: Result, measures: Measures) -> Section | None:
    """Gears under the peak torque, against static strength; None without one."""
    rating = rating_of(result)
    rated = next((one for one in rating.each if one.static), None) if rating else None
    if rating is None or rated is None:
        return None
    rows: list[list[Any]] = []
    for it in listed_fields(StaticRating):
        values = [getattr(gear, it.key) for gear in rated.static]
        rows.append([greek(it.head(measures)), *(figure(v, it.key, measures) for v in values)])
        if it.key.endswith("_safety"):
            least = getattr(rated.static[0], f"required_{it.key}")
            used = [_used(least, value) for value in values]
            rows.append([f"utilisation, {it.label} {least:g} required [%]", *used])
    heads = ["", *(name(rating, gear) for gear in rated.static)]
    table = Table("static", heads, rows, across=True)
    return Section("Static strength", words=[AT_PEAK], tables=(table,), terminal=(table,))


def _level_fields(rating: DriveRating) -> list[ListedField]:
    """Fields of a load level; stresses by their symbols of AGMA, where it rates alone."""
    alone = {rated.by for rated in rating.each} == {"AGMA"}
    symbols = {"bending_stress_MPa": "s_t", "contact_stress_MPa": "s_c"} if alone else {}
    return [replace(it, label=symbols.get(it.key, it.label)) for it in listed_fields(LoadLevel)]


def _level_row(rating: DriveRating, level: LoadLevel, measures: Measures, first: bool) -> list[Any]:
    """A level of a gear; the page shows its load once, at the first gear and standard."""
    cells = [
        _damage(value) if it.key.endswith("damage") else it.cell(value, measures)
        for it in _level_fields(rating)
        for value in [getattr(level, it.key)]
    ]
    load = cells[:ONCE]
    if not first or name(rating, level) != names(rating)[0]:
        load = [replace(cell, text="") for cell in load]
    return [*load, name(rating, level), *cells[ONCE:]]


def factors(result: Result, measures: Measures) -> Section | None:
    """Every factor with its source; None without a rating."""
    if (rating := rating_of(result)) is None:
        return None
    tables = [_table(rated, rating.beside is not None, measures) for rated in rating.each]
    level = (
        " For a load spectrum the factors are those of the level with the largest stress."
        if rating.levels
        else ""
    )
    words = [
        f"A single value applies to both gears; a source names its standard and clause.{level}"
    ]
    words += map(measures.words, unverified(rating))
    blocks: list[str | Table] = []
    for rated in rating.each:
        blocks += _factors_on_terminal(rated, rating.beside is not None, measures)
    blocks += words[1:]
    for table in tables:
        blocks += _remarks(table.rows)
    return Section("Factors", words=words, tables=tables, appendix=True, terminal=blocks)


def _symbols(rating: DriveRating) -> list[list[RatingFactor]]:
    """The factors of a standard, those of one symbol together."""
    symbols: dict[str, list[RatingFactor]] = {}
    for factor in rating.factors:
        symbols.setdefault(factor.symbol, []).append(factor)
    return list(symbols.values())


def _table(rating: DriveRating, named: bool, measures: Measures) -> Table:
    """The factors of a standard, which is named beside another one."""
    heads = ["symbol", "factor", "unit", *names(rating), "unverified", "source", "remark"]
    rows = [_factor_row(rating, group, measures) for group in _symbols(rating)]
    hidden = ["unit", "unverified"] + ([] if any(row[-1].value for row in rows) else ["remark"])
    return Table(
        f"factors by {rating.by}" if named else "factors",
        heads,
        rows,
        caption=f"Factors by {rating.by}" if named else "",
        csv_only=hidden,
        texts=("factor", "source", "remark"),
    )


def _remarks(rows: Sequence[Sequence[Any]]) -> list[str]:
    """Remarks that limit factors, for the terminal; one for several factors once."""
    symbols: dict[str, list[str]] = {}
    for symbol, *_, remark in rows:
        if remark.value:
            symbols.setdefault(remark.text, []).append(greek(symbol.value))
    lines = [f"{series_of(these)}: {remark}." for remark, these in symbols.items()]
    return ["\n".join(lines)] if lines else []


def _factor_row(
    rating: DriveRating, group: Sequence[RatingFactor], measures: Measures
) -> list[Any]:
    """A factor of all stages: its values, where they are from, what limits them."""
    first = group[0]
    sign, symbol, remarks = (
        measures.unit(_unit(first)),
        greek(first.symbol),
        measures.words(_by_stage(rating, group, "remark")),
    )
    return [
        Cell(first.symbol, f"{symbol} [{sign}]" if sign else symbol),
        Cell(first.name, greek(first.name)),
        sign,
        *(value for factor in group for value in _values(factor, measures)),
        ", ".join(str(factor.stage) for factor in group if not factor.verified),
        _by_stage(rating, group, "source"),
        Cell(remarks, greek(remarks)),
    ]


def _unit(factor: RatingFactor) -> str:
    """The unit that a factor is shown in, as `Measures` calls it."""
    return SHOWN_UNITS.get(factor.symbol, factor.unit)


def _by_stage(rating: DriveRating, group: Sequence[RatingFactor], key: str) -> str:
    """Words of a factor in every stage; sources, and what is the same, once."""
    stages: dict[str, list[str]] = {}
    for factor in group:
        stages.setdefault(getattr(factor, key), []).append(str(factor.stage))
    if len(stages) == 1 or key == "source" and GIVEN not in stages:
        return "; ".join(dict.fromkeys(part for words in stages for part in words.split("; ")))
    if rating.named:
        titles = {w: " and ".join(rating.titled(int(k)) for k in of) for w, of in stages.items()}
        return "; ".join(f"{of}: {words}" for words, of in titles.items() if words)
    return "; ".join(f"stage {series_of(k)}: {words}" for words, k in stages.items() if words)


def _values(factor: RatingFactor, measures: Measures) -> list[Cell]:
    """The values of pinion and wheel; of a factor of the mesh the page shows one."""
    first = cell(factor.pinion, _unit(factor), measures)
    if not factor.verified:
        first = replace(first, text=f"{first.text}\nunverified", short=first.text)
    if factor.wheel is None:
        return [first, replace(first, text="", short=None)]
    second = cell(factor.wheel, _unit(factor), measures)
    if not factor.verified:
        second = replace(second, text=f"{second.text}\nunverified", short=second.text)
    return [first, second]


def _factors_on_terminal(
    rating: DriveRating, with_standard: bool, measures: Measures
) -> list[Table]:
    """The factors as the terminal shows them, of so many stages as fit side by side."""
    tables, alone, abreast = [], len(rating.meshes) == 1, ABREAST[rating.by]
    of = STANDARD_HEADS[rating.by] if with_standard else ""
    for start in range(0, len(rating.meshes), abreast):
        heads = [of, *[""] * alone, *names(rating)[2 * start : 2 * (start + abreast)], ""]
        rows = []
        for group in _symbols(rating):
            part = group[start : start + abreast]
            symbol, what = _factor_row(rating, part, measures)[:2]
            values = [value for factor in part for value in _values(factor, measures)]
            rows.append([symbol, *[what] * alone, *values, _state(part)])
        tables.append(Table("factors", heads, rows, left=1 + alone, wrap=0))
    return tables


def _state(group: Sequence[RatingFactor]) -> str:
    """Whether values of a factor are given or unverified."""
    unsure = not all(factor.verified for factor in group)
    given = all(factor.source == GIVEN for factor in group)
    return "unverified" if unsure else GIVEN if given else ""
