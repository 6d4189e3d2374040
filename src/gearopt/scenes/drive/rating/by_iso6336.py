"""Rating by ISO 6336: a stage from its tables, factors by name, materials in words."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.rating import RatingFactor
from gearopt.formulations.strength.iso6336 import Iso6336
from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.case import Practice, of_blanks
from gearopt.physics.iso6336.factors import CLAUSES
from gearopt.physics.iso6336.rating import rate, rate_spectrum
from gearopt.scenes.drive.rating.gears import Tables, blanks
from gearopt.scenes.drive.rating.iso_material import finish, material, steel
from gearopt.scenes.drive.tables.drive import StageTable
from gearopt.scenes.drive.tables.iso6336 import NAMES
from gearopt.scenes.drive.tables.rating import RatingTable

__all__ = ["NAMES", "finish", "material", "rate", "rate_spectrum", "steel"]
NAME = "ISO 6336"  # in short
SUFFIXES = {"MPa": "MPa", "mm": "mm", "sqrt(MPa)": "sqrt_MPa"}
UNITS = {symbol: SUFFIXES[unit] for symbol, (_, unit) in CLAUSES.items() if unit}
LIMIT = Iso6336  # the rating as a limit of a stage
PROPORTIONAL = False  # stresses, or their squares, grow with the load
FEWER_FIRST = False  # of a sun and planets the sun is the pinion, whose twist counts
STATIC = True  # whether it rates a peak torque against static strength
UNVERIFIED_SPECTRUM = ("load spectrum by part 6",)  # what no second source has


def names(asked: RatingTable) -> dict[str, str]:
    """Return the words for each computed factor, by its symbol.

    Without a tip relief in the file C_a is that by running-in, C_ay (ISO 6336-1:2006, 6.5).
    """
    worn = {} if asked.iso6336.tip_relief else {"C_a": "tip relief by running-in, C_ay"}
    return NAMES | worn


def title(asked: RatingTable, factors: Sequence[RatingFactor]) -> str:
    """The standard that the rating follows."""
    return f"ISO 6336 parts 1, 2, 3 and 5, method B, edition {asked.iso6336.edition}"


def practice(rating: RatingTable, own: StageTable, pair: GearPair, tables: Tables) -> Practice:
    """Manufacture and rating practice of the pair of a stage."""
    made = of_blanks(bare_practice(rating, tables), pair, blanks(tables, pair))
    return made if own.as_mesh is None else replace(made, meshes=own.as_mesh.meshes)


def bare_practice(rating: RatingTable, gears: Tables) -> Practice:
    """Manufacture and rating practice of gears, but for their blanks."""
    asked, usual = rating.iso6336, Practice()
    grades = asked.accuracy_grade or usual.grades
    rows = zip(gears, grades, strict=True)
    first, second = (g if t.accuracy_grade is None else t.accuracy_grade for t, g in rows)
    return Practice(
        edition=asked.edition,
        tolerances=asked.tolerances,
        grades=(float(first), float(second)),
        shift=asked.shift,
        viscosity=asked.oil_grade.value if asked.oil_grade else usual.viscosity,
        relief=asked.tip_relief.value if asked.tip_relief else None,
        helix_modification=asked.helix_modification,
        shaft=rating.shaft.made if rating.shaft else usual.shaft,
        profile_modification=asked.profile_modification,
        limited_pitting=asked.limited_pitting,
        lowest=float(asked.life_factor_at_1e10),
    )


def given(rating: RatingTable, own: StageTable) -> dict[str, Any]:
    """Factors that a file gives for a stage, else for all stages."""
    factors: dict[str, Any] = rating.iso6336.given.factors() | own.given_iso6336.factors()
    return factors
