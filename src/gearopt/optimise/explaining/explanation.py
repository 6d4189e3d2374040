"""Answers of `explain`: remedies for an impossible request, influences on a possible one."""

import tomllib
from collections.abc import Mapping
from dataclasses import asdict, field, fields
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.result import Result, as_dict, as_json, shown

FORMAT = 1


@dataclass(frozen=True)
class Change:
    """One edit: at `key`, where `was` stands (or is inherited), write `write` ("": remove it).

    factor: how far the limit moves, >= 1. short: what one would write, rounded to relax the limit,
    where a design exists with it, too; "" where `write` is short, or nothing shorter was verified.
    """

    key: str
    was: str
    write: str
    factor: float
    short: str = ""

    @property
    def value(self) -> Any:
        """Value to write, as a value of Python; None for a key that is removed."""
        text = self.short or self.write
        return tomllib.loads(f"value = {text}")["value"] if text else None


@dataclass(frozen=True)
class Remedy:
    """Edits that make a design possible, applied together.

    kind: "least" (smallest change: product of factors over all limits), "even" (one factor for one
    kind of limit), "one" (a number of one stage), "alone" (a number of the file), "pair" (two
    changes, each as small as the other allows), "less" (the duty), or "choice" (a switch of the
    file, or the nearest ratio that the limits reach). what: the limits that move. factor: that
    product or common factor, as written (infinite where a number is shifted). bound: a smaller one
    is proven impossible (None: not proven). verified: status with the edits, and with each taken
    back by 0.1 %, one tooth or one module ({"with": ..., "with_less": ...}); "nearer": of ratios
    nearer to the one asked for; "others": what all other single numbers need; "rounded": how far
    numbers were rounded to relax the limit, after they were taken back.
    """

    kind: str
    what: str
    changes: tuple[Change, ...]
    factor: float
    bound: float | None
    verified: dict[str, str] = field(default_factory=dict)

    @property
    def edits(self) -> dict[str, Any]:
        """Edits as `solve` takes them: {key: value}, None for a key that is removed."""
        return {c.key: c.value for c in self.changes}


@dataclass(frozen=True)
class Remedies:
    """Report of an impossible request: its conflict and its remedies.

    conflict: names of limits in conflict; message: what is missing. any_resolves: whether it was
    found that any one of these limits, dropped alone, makes a design possible. unsure: limits of
    the conflict of which it is not known whether it takes them. untried: no remedy was looked for.
    drawn: what a page shows beside them, by keys of a report.
    """

    conflict: tuple[str, ...] = ()
    remedies: tuple[Remedy, ...] = ()
    message: str = ""
    any_resolves: bool = False
    unsure: tuple[str, ...] = ()
    untried: bool = False
    drawn: Mapping[str, Any] = field(default_factory=dict)

    @property
    def told(self) -> dict[str, Any]:
        """The part of it that a report holds."""
        report = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "drawn"}
        report["remedies"] = [asdict(remedy) for remedy in self.remedies]
        if not self.untried:
            del report["untried"]
        return report


@dataclass(frozen=True)
class Influence:
    """Effect of one input on the objective.

    sensitivity: d ln objective / d ln input by multipliers; resolved: the same by re-solving with
    the input a little smaller and larger (None: no design there). Where the two sides of `resolved`
    differ, a limit is just about to bind. step: an edit that eases a limit, and price: the relative
    change of the objective that it brings (negative: better).
    """

    key: str
    value: str
    sensitivity: float | None
    resolved: tuple[float | None, float | None]
    step: str = ""
    price: float | None = None


@dataclass(frozen=True)
class Explanation:
    """Reasons of an answer.

    result: the answer itself. conflict: limits in conflict, each needed for it.
    remedies: proven ones, smallest first; `edits` of each are changes for `solve`. binding: limits
    used to the full. influences: one per input. basis: of which problem the sensitivities are, the
    end of a sentence. any_resolves: as in `Remedies`.
    """

    result: Result
    conflict: tuple[str, ...] = ()
    remedies: tuple[Remedy, ...] = ()
    binding: tuple[str, ...] = ()
    influences: tuple[Influence, ...] = ()
    message: str = ""
    seconds: float = 0.0
    basis: str = ""
    any_resolves: bool = False
    unsure: tuple[str, ...] = ()

    @property
    def prices(self) -> dict[str, Any]:
        """Influences, and the remarks on them, as the report of a result holds them."""
        influences = [asdict(i) for i in self.influences]
        return {"influences": influences, "message": self.message, "basis": self.basis}

    def __repr__(self) -> str:
        return str(shown("explained_lines", self))

    def _repr_html_(self) -> str:
        return str(shown("explained_fragment", self))

    def to_dict(self) -> dict[str, Any]:
        """Return plain dicts, lists and numbers; no NaN and no infinity (None instead)."""
        return {"explanation": FORMAT, **as_dict(self)}

    to_json = as_json
