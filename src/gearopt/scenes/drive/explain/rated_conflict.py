"""Which requirements of an impossible drive that ratings limit exclude each other.

A family of requirements without which, everything else kept, a design exists is in every conflict:
such a design is mostly found soon, so that each family is asked for a short time. All others are
then dropped at once; where that is not proven impossible, by a search of all teeth, modules and
materials, a deletion filter drops for good what can be dropped. Before all that it is asked whether
there are teeth, whatever they carry, in integers and as they are cut: where none are, the conflict
is of what decides on teeth.
"""

from collections.abc import Sequence
from dataclasses import field, replace

from gearopt.formulations.drive.teeth.search import reaches
from gearopt.formulations.drive.train import Train
from gearopt.formulations.strength.standard import Option
from gearopt.frozen import dataclass
from gearopt.scenes.drive.explain.requirements import (
    BENDING,
    CONTACT,
    GIVEN,
    OF_DISTANCES,
    OF_NUMBERS,
    OF_TEETH,
    Dropped,
    requirements,
    without,
)
from gearopt.scenes.drive.explain.tried import Case, any_of, any_possible
from gearopt.scenes.drive.rating.options import STANDARDS

GLANCE, PROOF = 0.5, 4.0  # s, for a design without one family; for the proof without all others
APART = *GIVEN, "materials"  # without which a drive need not have all designs that it has with them
RATED_BY = {"agma": "rating_by_AGMA", "iso6336": "rating_by_ISO_6336"}


@dataclass(frozen=True)
class Conflict:
    """Names of requirements that are proven to exclude each other.

    unsure: those of them of which it is not known whether they are needed. Of a requirement that
    several stages have it may not be known which of them need it, where time was short.
    any_resolves: any one of them, dropped alone, makes a design possible. whatever_load: there are
    no teeth, whatever they carry.
    """

    names: tuple[str, ...] = ()
    unsure: tuple[str, ...] = ()
    any_resolves: bool = False
    whatever_load: bool = False

    @property
    def proven(self) -> bool:
        """Return whether there is a conflict of which nothing can be left out."""
        return bool(self.names) and not self.unsure


@dataclass
class _Filter:
    """Whether a design exists without some limits, as asked; it has state: answers are kept.

    dropped: for good; needed: known to be in the conflict. exact: whether a design is numbers of
    teeth alone.
    """

    case: Case
    exact: bool = False
    answers: dict[Dropped, bool | None] = field(default_factory=dict)
    dropped: Dropped = frozenset()
    needed: set[str] = field(default_factory=set)

    def possible(self, dropped: Sequence[str] | Dropped, seconds: float = 0.0) -> bool | None:
        """Whether a design exists without the requirements dropped; None: not found out in time.

        seconds: allowed, 0 for those of the case. With fewer, an open answer is not kept, so that
        it may be asked again.
        """
        key = frozenset(dropped)
        if key not in self.answers:
            if (known := self._known(key)) is not None:
                return known
            case = replace(self.case, seconds=seconds, open=[]) if seconds else self.case
            if self.exact and case.clock.over:
                return None
            trains = without(case.scene, key)
            answer = any_of([*map(reaches, trains)]) if self.exact else any_possible(case, trains)
            if answer is None and 0.0 < seconds < self.case.seconds:
                return None
            self.answers[key] = answer
            if answer is not None and not self.exact:
                self.case.answers[key] = answer
        return self.answers[key]

    def _known(self, key: Dropped) -> bool | None:
        """Answer that others have given: a design that keeps more, or none where less is kept."""
        for other, answer in (self.answers if self.exact else self.case.answers).items():
            if answer and other <= key and not {*map(_base, key - other)} & {*APART}:
                return True
            if answer is False and key <= other and not {*map(_base, other - key)} & {*APART}:
                return False
        return None

    def look(self, families: Sequence[Sequence[str]]) -> None:
        """Note the families without which, alone, a design is known soon: none without all."""
        names = [name for family in families for name in family]
        if families and self.possible(self.dropped | {*names}, GLANCE):
            if len(families) == 1:
                self.needed |= {*families[0]}
            else:
                middle = len(families) // 2
                self.look(families[:middle])
                self.look(families[middle:])

    def drop(self, families: Sequence[Sequence[str]]) -> None:
        """Drop all of some families that can be, in halves where all together cannot be."""
        if not families:
            return
        names = [name for family in families for name in family]
        verdict = self.possible(self.dropped | {*names})
        if verdict is False:
            self.dropped |= {*names}
        elif len(families) > 1:
            middle = len(families) // 2
            self.drop(families[middle:])
            self.drop(families[:middle])
        elif verdict:
            self.needed |= {*names}

    def split(self, family: Sequence[str]) -> None:
        """Drop single stages of a family; undecided ones of one that is needed stay so."""
        for name in family:
            verdict = self.possible([name], GLANCE) or self.possible(self.dropped | {name})
            if verdict:
                self.needed.add(name)
            elif verdict is False:
                self.needed.discard(name)
                self.dropped |= {name}


def conflict(case: Case, resolving: bool = True) -> Conflict:
    """Return requirements of an impossible drive that are in conflict with all others dropped.

    resolving: whether it is asked if any of them, dropped alone, makes a design possible.
    None where everything can be dropped, teeth are real-valued, or nothing is known to be needed,
    unless there are no teeth whatever they carry.
    """
    if case.scene.teeth is None:
        return Conflict()
    filtering, groups = _filter_of_requirements(case)
    strength = filtering.dropped
    families = [family for group in groups for family in group]
    fixed = [family for family in families if _base(family[0]) in GIVEN]
    ties = [family for family in families if family[0] in OF_DISTANCES]
    for family in (*ties, *fixed):
        if filtering.possible(filtering.dropped | {*family}, GLANCE):
            filtering.needed |= {*family}
    for each in groups:
        filtering.look([family for family in each if family not in (*fixed, *ties)])
    spare = [
        [f for f in group if f not in fixed and not filtering.needed & {*f}] for group in groups
    ]
    spared = (name for group in spare for family in group for name in family)
    rest = filtering.dropped | frozenset(spared)
    if filtering.possible(rest, PROOF) is False:
        filtering.dropped = rest
    else:
        for group in spare[::-1]:
            filtering.drop(group)
    for family in families:
        if len(family) > 1 and family not in fixed and not filtering.dropped & {*family}:
            filtering.split(family)
    every = [name for family in families for name in family if name not in filtering.dropped]
    if not filtering.needed and not strength:
        return Conflict()
    whole = _Filter(case) if filtering.exact else filtering
    unsure = tuple(name for name in every if name not in filtering.needed)
    alone = resolving and len(every) > 1 and all(whole.possible([n], GLANCE) for n in every)
    names = (*every, *_standard(case, filtering.dropped, every))
    return Conflict(names, unsure, alone, bool(strength))


def _filter_of_requirements(case: Case) -> tuple[_Filter, tuple[tuple[tuple[str, ...], ...], ...]]:
    """Return a filter and the requirements that it is of: those of teeth where none are left."""
    groups = requirements(case.scene)
    for exact, kept in ((True, OF_NUMBERS), (False, OF_TEETH)):
        rest = frozenset(n for group in groups for f in group for n in f if _base(n) not in kept)
        filtering = _Filter(case, exact, dropped=rest)
        if filtering.possible(rest, GLANCE) is False:
            return filtering, tuple(
                tuple(f for f in group if _base(f[0]) in kept) for group in groups
            )
    return _Filter(case), groups


def _base(name: str) -> str:
    """Return the name of a requirement without its stage."""
    return name.split("[")[0]


def _standard(case: Case, dropped: Dropped, names: Sequence[str]) -> list[str]:
    """Return by which one of two standards alone the drive is impossible, if by one.

    Nothing where the conflict has no safety factor.
    """
    asked = case.scene.rating
    assert asked
    if len(STANDARDS[asked.standard]) < 2 or not {BENDING, CONTACT} & {*names}:
        return []
    trains = without(case.scene, dropped)
    for k, name in enumerate(RATED_BY.values()):
        if any_possible(case, [_rated_by(train, k) for train in trains]) is False:
            return [name]
    return []


def _rated_by(train: Train, standard: int) -> Train:
    """Return the drive that one of two standards (0 or 1) rates alone."""

    def alone(option: Option) -> Option:
        each = option.standards
        return replace(option, standards=each[1:] if standard else each[:1])

    stages = [replace(s, options=tuple(map(alone, s.options))) for s in train.stages]
    return replace(train, stages=tuple(stages))
