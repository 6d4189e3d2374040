"""Which name a misspelt word was meant to be; words of the field are not misspelt."""

import re
from collections.abc import Iterable
from difflib import SequenceMatcher, get_close_matches

from gearopt.scenes.reading.absent import SENTENCES
from gearopt.scenes.reading.called import CALLED
from gearopt.scenes.reading.not_yet import NEAREST

ALIKE = 0.65  # of the letters of two words: one lost, wrong or moved in three
TOGETHER = 0.85  # of two names whose words are separated otherwise
TERMS = frozenset(  # words with a meaning of their own: `weight` is no misspelt `height`
    word
    for names in (
        *SENTENCES.values(),
        *(names for table in CALLED.values() for names in table.values()),
        *(names for table in NEAREST.values() for names in table),
    )
    for word in re.split(r"[\s_.]+", names)
)


def near(word: str, names: Iterable[str]) -> str | None:
    """Return the name that a word was probably meant to be, in any case; None if none is close.

    A word that only one name begins with is that one.
    """
    plain = {name.lower(): name for name in names}
    typed = re.sub(r"[-\s]+", "_", word[:80].lower())
    close = (name for name in get_close_matches(typed, plain) if _misspelt(typed, name))
    begun = [name for name in plain if len(word) > 2 and name.startswith(f"{word.lower()} ")]
    closest = next(close, begun[0] if len(begun) == 1 else None)
    return None if closest is None else plain[closest]


def _misspelt(typed: str, name: str) -> bool:
    """Return whether every word of a name is one of those typed, but for slips of the pen."""
    here, there = (re.split(r"[\W_]+", text) for text in (typed, name))
    if len(here) != len(there):
        return _alike("".join(here), "".join(there), TOGETHER)
    return all(
        _singular(a) == _singular(b) or (a not in TERMS and _alike(a, b, ALIKE))
        for a, b in zip(here, there, strict=True)
    )


def _singular(word: str) -> str:
    return word.replace("teeth", "tooth").removesuffix("s")


def _alike(a: str, b: str, share: float) -> bool:
    return SequenceMatcher(None, a, b).ratio() >= share
