"""The virtual best of several ways of making a pair: strengths that may be the greatest."""

from collections.abc import Hashable, Sequence

from gearopt.frozen import dataclass


@dataclass(frozen=True)
class Strength:
    """The strength of a gear made in one way, as a product of three factors.

    law: on what a factor that varies from pair to pair depends; factor: the same of another one of
    at most `most`, which is 1 where it is (); fixed: of all pairs [MPa].
    """

    law: Hashable
    factor: Hashable
    fixed: float
    most: float = 1.0

    def at_least(self, other: "Strength") -> bool:
        """Return whether no pair is stronger in the other way."""
        if self.law != other.law:
            return False
        same = self.factor == other.factor and self.fixed >= other.fixed
        return same or (self.factor == () and self.fixed >= other.fixed * other.most)


def may_be_best(strengths: Sequence[Strength]) -> list[int]:
    """Return places of strengths, of which one is the greatest for every pair."""
    kept: list[int] = []
    for n, one in enumerate(strengths):
        if any(strengths[k].at_least(one) for k in kept):
            continue
        kept = [k for k in kept if not one.at_least(strengths[k])]
        kept.append(n)
    return kept
