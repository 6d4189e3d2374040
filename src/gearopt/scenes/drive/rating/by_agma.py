"""Rating by AGMA 2001: a stage from its tables, factors by name, materials in words."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.rating import GIVEN, RatingFactor
from gearopt.formulations.strength.agma import Agma
from gearopt.physics.agma.allowables import CURVES, IRONS
from gearopt.physics.agma.factors import ACCURACIES, quality_of_accuracy
from gearopt.physics.agma.rating import rate, rate_spectrum
from gearopt.physics.agma.rating_factors import SHARING, Practice, Steel
from gearopt.physics.gears import GearPair
from gearopt.scenes.drive.rating.gears import Tables, blanks
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.drive.tables.planetary import PLANETARY
from gearopt.scenes.drive.tables.rating import GearTable, RatingTable

__all__ = ["rate", "rate_spectrum"]
NAME = "AGMA"  # in short
NAMES = {  # of the factors, as AGMA 2001 has them
    "K_o": "overload factor",
    SHARING: "mesh load factor, multiplies K_o",
    "K_v": "dynamic factor",
    "K_m": "load distribution factor",
    "K_R": "reliability factor",
    "K_T": "temperature factor",
    "C_f": "surface condition factor",
    "C_p": "elastic coefficient",
    "I": "geometry factor, pitting",
    "K_B": "rim thickness factor",
    "K_s": "size factor",
    "J": "geometry factor, bending",
    "s_at": "allowable bending stress number",
    "s_ac": "allowable contact stress number",
    "Y_N": "stress cycle factor, bending",
    "Z_N": "stress cycle factor, pitting",
    "C_H": "hardness ratio factor",
}
UNITS = {"s_at": "MPa", "s_ac": "MPa", "C_p": "sqrt_MPa"}  # as suffixes of keys
TITLES = {  # by edition
    "D04": "ANSI/AGMA 2001-D04 (2101)",
    "B88": "ANSI/AGMA 2001-B88 for rims and the strength of through-hardened steel, else 2001-D04",
}
LIMIT = Agma  # the rating as a limit of a stage
PROPORTIONAL = True  # stresses, or their squares, grow with the load
FEWER_FIRST = True  # the pinion has fewer teeth than the wheel
STATIC = False  # whether it rates a peak torque against static strength
UNVERIFIED_SPECTRUM = ()  # of a load spectrum: what no second source has


def title(asked: RatingTable, factors: Sequence[RatingFactor]) -> str:
    """The standard that the rating follows, and where its geometry factors are from."""
    geometry = [factor for factor in factors if factor.symbol in ("I", "J")]
    given = dict.fromkeys(f.symbol for f in geometry if f.source == GIVEN)
    parts = ["geometry factors of AGMA 908-B89"] if any(f.source != GIVEN for f in geometry) else []
    parts += [f"{' and '.join(given)} of the file"] if given else []
    return ", ".join([TITLES[asked.edition], *parts])


def names(asked: RatingTable) -> dict[str, str]:
    """Names of factors that are computed."""
    return NAMES


def material(table: GearTable) -> str:
    """Return a gear's material in words."""
    assert table.treatment
    words = [table.treatment, *([] if table.treatment in IRONS else [f"grade {table.grade or 1}"])]
    words = [table.steel, *words] if table.steel else words
    core = " core" if CURVES.get(table.treatment) == "nitrided" else ""
    words += [f"{table.hardness}{core}"] if table.hardness else []
    words += [table.surface_hardness] if table.surface_hardness else []
    words += [accuracy(float(table.quality))] if table.quality is not None else []
    return ", ".join(words)


def steel(table: GearTable) -> Steel:
    """Return the material of a gear; it has a treatment, or its strengths are given."""
    usual = Steel()
    return Steel(
        table.treatment or usual.treatment,
        table.grade or usual.grade,
        table.hardness.value if table.hardness and table.treatment not in IRONS else usual.hardness,
        table.surface_hardness or usual.surface,
        table.modulus or usual.modulus,
        usual.poisson if table.poisson_ratio is None else float(table.poisson_ratio),
        table.roughness.value if table.roughness else usual.finish,
        bool(table.reversed_load),
        (table.s_ac.value if table.s_ac else 0.0, table.s_at.value if table.s_at else 0.0),
    )


def finish(table: GearTable) -> float:
    """Return the roughness R_a of the flanks [mm]."""
    return steel(table).finish


def practice(rating: RatingTable, own: StageTable, pair: GearPair, tables: Tables) -> Practice:
    """Manufacture and rating practice of the pair of a stage."""
    rows = zip(blanks(tables, pair), pair.gears, strict=True)
    first, second = (blank.backup(gear) for blank, gear in rows)
    return replace(bare_practice(rating, tables), backup=(first, second))


def bare_practice(asked: RatingTable, gears: Tables) -> Practice:
    """Manufacture and rating practice of gears, but for their blanks."""
    return Practice(
        quality=min(_quality(asked) if t.quality is None else float(t.quality) for t in gears),
        curve=asked.mounting,
        crowned=asked.crowned,
        offset=float(asked.pinion_offset),
        adjusted=asked.adjusted,
        size=asked.size_factor == "shigley",
        service=asked.service,
        load=asked.bending_load,
        edition=asked.edition,
    )


def accuracy(quality: float) -> str:
    """Return a transmission accuracy Q_v in words, with A_v = 17 - Q_v of D04."""
    return f"Q_v {quality:g} (A_v {ACCURACIES - quality:g})"


def stated_accuracy(asked: RatingTable) -> str:
    """Return the accuracy that a file gives for all gears, in words; "" where it gives none."""
    bare = asked.quality is None and asked.accuracy is None
    return "" if bare else accuracy(_quality(asked))


def _quality(asked: RatingTable) -> float:
    """Return Q_v, by whichever key; any where K_v is given."""
    if asked.accuracy is not None:
        return float(quality_of_accuracy(float(asked.accuracy)))
    return Practice().quality if asked.quality is None else float(asked.quality)


def given(rating: RatingTable, own: StageTable) -> dict[str, Any]:
    """Factors that a file gives for a stage, else for all stages; K_gamma of planets."""
    factors = rating.given.factors() | own.given.factors()
    sharing = own.given_iso6336.factors().get(SHARING) if own.type == PLANETARY else None
    if sharing is not None or own.as_mesh is not None:
        factors[SHARING] = sharing or 1.0
    return factors
