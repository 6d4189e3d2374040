"""What a misspelt word or quantity was probably meant to be."""

import re
from collections.abc import Iterable
from difflib import get_close_matches
from unicodedata import normalize

from gearopt import units


def near(word: str, names: Iterable[str]) -> str | None:
    """The name that a word was probably meant to be, in whatever case; None if none is close."""
    plain = {name.lower(): name for name in names}
    found = get_close_matches(re.sub(r"[-\s]+", "_", word[:80].lower()), plain, n=1)
    return plain[found[0]] if found else None


# A comma before three digits may separate thousands, so it is not taken for a decimal one.
_NUMBER = r"(\+?[0-9]*(?:\.|,(?![0-9]{3}(?![0-9])))?[0-9]+(?:[eE][+-]?[0-9]{1,3})?)"
_SLIP = re.compile(rf"\s*{_NUMBER}\s*((?![eE][+-]?[0-9])[^\s\d.,].*?|1/\S+)?\s*")


def meant(text: str, dimension: str, usual: str) -> str:
    """A text whose decimal comma, missing unit or misspelt unit is mended; "" if it has none."""
    match = _SLIP.fullmatch(text[:80])
    unit = _spelt(match[2], units.UNITS[dimension]) if match and match[2] else usual
    return f"{match[1].replace(',', '.')} {unit}" if match and unit else ""


def _spelt(word: str, names: Iterable[str]) -> str | None:
    """The unit that differs from a word in case or punctuation only.

    Not mW for MW: that is another unit, and the number would be wrong.
    """

    def plain(unit: str) -> str:
        return re.sub(r"[^a-z0-9/%]", "", normalize("NFKC", unit).lower())  # also of a raised 2

    found = next((n for n in names if plain(n) == plain(word)), None)
    return None if found and found[0] != word[0] and found[1:] == word[1:] else found
