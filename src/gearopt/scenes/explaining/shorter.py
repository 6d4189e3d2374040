"""Remedies as one would write them: 283 mm instead of 282.546 mm, where a design still exists."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from typing import Any

from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedy

DIGITS = (3, 4)  # significant digits that are tried in turn
SECONDS = 2.0  # at most, for one question whether a design exists
EXACT = "choice"  # kind of remedies that are not rounded: the nearest ratio is one number
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")

Works = Callable[[dict[str, Any], float], bool]  # (edits, seconds): whether a design exists


def shorter(found: Sequence[Remedy], clock: Clock, works: Works) -> tuple[Remedy, ...]:
    """Return remedies with `short` of each change: few digits, rounded to relax the limit.

    Only where the file with these edits, read and solved again, has a design; as long as time is
    left.
    """
    return tuple(_one(remedy, clock, works) for remedy in found)


def _one(remedy: Remedy, clock: Clock, works: Works) -> Remedy:
    tried = remedy
    if any(change.short for change in remedy.changes):
        return remedy
    for digits in DIGITS if remedy.kind != EXACT else ():
        short = [_short(change, digits) for change in remedy.changes]
        pairs = zip(remedy.changes, short, strict=True)
        other = replace(tried, changes=tuple(replace(c, short=s) for c, s in pairs))
        if not any(short) or clock.over:
            return remedy
        edits = {c.key: c.value for c in other.changes}
        if works(edits, clock.within(SECONDS)):
            return other
    return remedy


def _short(change: Change, digits: int) -> str:
    """Return what is written with few digits, away from what was; "" where it has few."""
    before, after = NUMBER.findall(change.was), NUMBER.findall(change.write)
    if len(before) != len(after):
        return ""
    numbers = iter(
        _rounded(new, Decimal(new) > Decimal(old), digits) if new != old else new
        for old, new in zip(before, after, strict=True)
    )
    text = NUMBER.sub(lambda match: next(numbers), change.write)
    return "" if text == change.write else text


def _rounded(number: str, up: bool, digits: int) -> str:
    """Return a decimal number of a file with few digits; whole numbers stay."""
    if "." not in number:
        return number
    context = Context(prec=digits, rounding=ROUND_CEILING if up else ROUND_FLOOR)
    return f"{context.create_decimal(Decimal(number)).normalize():f}"
