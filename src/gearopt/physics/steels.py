"""Gear steels and irons by name: class and grade of both standards, hardness, strength, sources.

Numbers are those of `steels.csv`. A source stands for names, numbers, strength and hardness; class,
quality and grade follow from the treatment, no source prints them beside a steel: they are
unverified, and what a supplier certifies decides.
"""

import csv
import math
import re
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from itertools import chain

from gearopt.frozen import dataclass
from gearopt.physics.iso6336.materials import VICKERS_TENSILE

SOURCES = {  # by the letters of a row
    "A": "a public list of shaft and gear steels after DIN 743-3",
    "B": "a public table of equivalent steels",
    "C": "KHK, The hardness of gears",
    "D": "a Japanese guide, Gear materials and heat treatments",
    "E": "a supplier's sheet after EN 10084",
    "F": "a supplier's sheet of 16MnCr5 after EN 10084:2008",
    "G": "a heat treater's guide",
    "K": "a report of a calculated pair",
    "L": "a supplier's page on gear materials",
}
BAR, LARGEST = 16.0, 300.0  # mm: of the strength in the list, and to which it falls
FALLS = 0.26  # of R_m a decade of the diameter, of tempered steel: DIN 743-2, memory; it meets
# the least of 42CrMo4 to 40, 100, 160, 250 mm (1000, 900, 800, 750 MPa) within 4 %
PLASTICS = re.compile(
    r"pom|pa ?\d*(\.\d+)?|pbt|peek|pet|pe(-uhmw)?|nylon.*|delrin.*|acetal|polyamid.*"
)


@dataclass(frozen=True)
class Steel:
    """A steel in one treatment; "", None and () for what is not known or does not apply.

    names: the usual one first; numbers: of EN 10027-2; us: AISI, SAE or ASTM. heat: how it is
    treated. iso_material and iso_quality of ISO 6336-5; treatment and grade of AGMA 2001. hardness:
    its range [HB, or HV of hardened flanks], core: that of the core [HB]; tensile, yield_strength
    [MPa] of a bar of BAR; sources: letters of SOURCES; module [mm]: to which its core reaches 25
    HRC.
    """

    names: tuple[str, ...]
    numbers: tuple[str, ...]
    us: str
    heat: str
    iso_material: str
    iso_quality: str
    treatment: str
    grade: int | None
    hardness: tuple[float, float]
    unit: str
    core: tuple[float, float] | None
    tensile: float | None
    yield_strength: float | None
    sources: str
    module: float | None

    @property
    def name(self) -> str:
        """Its usual name."""
        return self.names[0]

    @property
    def verified(self) -> bool:
        """Whether two sources have its name, strength and hardness."""
        return len(self.sources) > 1

    @property
    def hardened(self) -> bool:
        """Whether its flanks are harder than its core."""
        return self.unit == "HV"

    def hardness_at(self, diameter: float) -> float | None:
        """Greatest hardness [HB] of tempered steel in a section of a diameter [mm].

        R_m (1 - FALLS lg(d/BAR)) from BAR to LARGEST, over 3.2 MPa a unit of hardness (unverified).
        None of other steel, and where its strength is not known.
        """
        if self.hardened or self.tensile is None or not self.heat.startswith("quenched"):
            return None
        section = min(max(diameter, BAR), LARGEST)
        return self.tensile * (1.0 - FALLS * math.log10(section / BAR)) / VICKERS_TENSILE


@cache
def steels() -> tuple[Steel, ...]:
    """All rows of the list."""
    text = files("gearopt.physics").joinpath("steels.csv").read_text(encoding="utf-8")
    return tuple(map(_steel, csv.DictReader(text.splitlines())))


def _steel(row: dict[str, str]) -> Steel:
    def several(key: str) -> tuple[str, ...]:
        return tuple(word for word in row[key].split("|") if word)

    def number(key: str) -> float | None:
        return float(row[key]) if row[key] else None

    low, high = number("core_low"), number("core_high")
    return Steel(
        several("names"),
        several("numbers"),
        row["us"],
        row["heat"],
        row["iso_material"],
        row["iso_quality"],
        row["treatment"],
        int(row["grade"]) if row["grade"] else None,
        (float(row["hardness_low"]), float(row["hardness_high"])),
        row["unit"],
        None if low is None or high is None else (low, high),
        number("tensile"),
        number("yield"),
        row["sources"],
        number("module"),
    )


def named(name: str) -> tuple[Steel, ...]:
    """The treatments of a steel by its name or number, the usual one first; (): it is not known.

    Case, blanks, hyphens and dots do not count, nor does SAE or AISI before four digits. Such a
    name is that of a steel that bears it, else of the first equivalent one.
    """
    asked = _plain(name)
    for words in (_names, _others):
        if asked in words():
            usual = words()[asked]
            return tuple(one for one in steels() if usual in one.names)
    return ()


@cache
def _names() -> dict[str, str]:
    """The usual name of a steel by its names and numbers."""
    rows = ((word, one) for one in reversed(steels()) for word in (*one.names, *one.numbers))
    return {_plain(word): _among(word, one) for word, one in rows}


def _among(word: str, steel: Steel) -> str:
    return word if word in steel.names else steel.names[-1 if word in steel.numbers[1:] else 0]


@cache
def _others() -> dict[str, str]:
    """The usual name of a steel by its American name."""
    return {_plain(one.us): one.name for one in reversed(steels()) if one.us}


def _plain(name: str) -> str:
    """Return a name as it is compared: SAE and AISI number steels alike."""
    word = re.sub(r"[\s.\-_/]", "", name).lower()
    return re.sub(r"^(sae|aisi)?(\d{4})$", r"aisi\2", word)


def near(name: str) -> tuple[str, ...]:
    """Names that a wrong one may mean, the nearest first."""
    words = {_plain(word): word for word in chain(*(one.names for one in steels()))}
    return tuple(words[w] for w in get_close_matches(_plain(name), words, n=3, cutoff=0.6))


def is_plastic(name: str) -> bool:
    """Whether a name is that of a plastic."""
    return bool(PLASTICS.fullmatch(name.strip().lower()))
