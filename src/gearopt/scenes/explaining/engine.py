"""The smallest changes of a file that make it possible: one search for all kinds of files.

A kind gives the numbers that may move (`moves.Move`) and answers whether a changed file has a
design (`possible.Possible`). A number, or several by one factor, is moved as little as that takes:
numbers that take steps to the first that does; others by secants where the excess of the nearest
design is known, else to the farthest first, which rejects most by one question, and by halving the
logarithm of the change. A remedy is reported only if the file with it, as written, has a design.
"""

import logging
import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import field, replace
from typing import Any

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Remedy
from gearopt.optimise.explaining.halving import DOUBTS, ROUGH, between, middles, take
from gearopt.optimise.explaining.handles import REACH
from gearopt.optimise.explaining.repair import FACTOR_TOLERANCE, SLACK_TRIED
from gearopt.scenes.explaining.moves import DUTY, Edited, Move, Moves, edited, less, shorter
from gearopt.scenes.explaining.possible import UNKNOWN, WORDS, Possible, Verdict
from gearopt.scenes.reading.toml_writing import dotted

logger = logging.getLogger("gearopt.remedies")
FACTORS_TRIED = (1e6, 1e3, 16.0, 4.0, 2.0, 1.3, 1.1)  # the first that is decided counts
LAST = 1.5  # times the time to make numbers sharper, for whether less suffices
SHARE_OF_TIME = 0.75  # at most, of the time that is left, to make numbers sharper in given seconds
SECANTS, NO_PROGRESS = 24, 1e-2  # of a logarithm: what falls by less in a step does not fall
# power by which steps grow; after so many designs for less, questions of ones like them
FASTER, OFTEN, FEW = 4.0, 4, 5
NEGLIGIBLE, LOG_TOLERANCE = 1e-9, 2e-5  # of a factor; of the log of a utilisation that counts as 1
ROOM = (1.0, 1.001, 1.01)  # times a factor that was found by an excess, until a design is found
CLOSER = (1.00005, 1.000005, 1.0 + 1e-7, 1.0 + 1e-9)  # in turn, where a little less suffices
JOINT = "least"  # kind of a remedy whose numbers do not move alike: each of them is needed
EACH, DEAR = (JOINT, "pair"), 0.1  # s, of a question whose answer is no
DIGITS = (3, 4)  # significant digits of what one would write, tried in turn


@dataclass(frozen=True)
class Group:
    """Numbers that move by one factor.

    floor: the least factor that may suffice; bound: the same as proven; what: their name in a
    remedy, by default the numbers'.
    """

    numbers: tuple[Move, ...]
    floor: float = 1.0
    bound: float | None = None
    what: str = ""

    @property
    def moves(self) -> Moves:
        """Return the numbers at the least factor that they may have."""
        return tuple((move, self.floor) for move in self.numbers)


@dataclass
class FeasibilityQuestions:
    """Questions whether a changed file has a design; it has state because it keeps the answers.

    scene: the impossible file. possible: asked while a factor is sought; sure: the same of a remedy
    as it is written, where that takes longer. clock: of all questions; seconds: of one, at most.
    excess: that of the file itself, where it is known. lower_bounds: whether a factor that is
    proven too small is told as a bound. far: the factor, beyond a floor, up to which is tried.
    likely: whether known designs suffice for a changed file, asked as a factor is narrowed once a
    no was dear; only yes counts. near: the same, of designs like them; kin: of designs like the
    last one, narrowed by it to the end. sufficient: how many groups of numbers are known to
    suffice. apply: makes the file with numbers moved. halving: seconds of a question while a change
    is halved, and once one stayed open, of which so many doubts may; ladder: factors tried where
    the farthest stays open. open: keys of numbers without any factor.
    """

    scene: Any
    possible: Possible[Any]
    clock: Clock
    sure: Possible[Any] | None = None
    seconds: float = math.inf
    excess: float | None = None
    lower_bounds: bool = False
    likely: Possible[Any] | None = None
    near: Possible[Any] | None = None
    kin: Possible[Any] | None = None
    far: float = REACH
    halving: tuple[float, float] = (math.inf, math.inf)
    doubts: int = DOUBTS
    ladder: tuple[float, ...] = FACTORS_TRIED
    apply: Callable[[Any, Moves], Edited | None] = edited
    open: list[str] = field(default_factory=list)
    dear: bool = False
    sufficient: int = 0
    answers: dict[tuple[Any, ...], Verdict] = field(default_factory=dict)

    def edited(self, moves: Moves) -> Edited | None:
        """Return the file with numbers moved; None where its rules refuse it."""
        return self.apply(self.scene, moves)

    def verdict(self, moves: Moves) -> Verdict | None:
        """Return whether the file with numbers moved is possible; None: its rules refuse it."""
        there = self.edited(moves)
        return None if there is None else self.verdict_of(there)

    def verdict_of(self, there: Edited, seconds: float = math.inf) -> Verdict:
        """Return whether a changed file is possible, which is asked once; in seconds, at most."""
        key = tuple((change.key, change.write) for change in there.changes)
        if key not in self.answers:
            begun = time.monotonic()
            verdict = self.ask(there.scene, self.possible, seconds)
            if self.clock.over:
                return verdict
            self.dear |= not verdict.answer and time.monotonic() - begun > DEAR
            self.answers[key] = verdict
        return self.answers[key]

    def possible_with(self, moves: Moves) -> bool | None:
        """Return whether the file with numbers moved is possible; None: refused, or not known."""
        verdict = self.verdict(moves)
        return None if verdict is None else verdict.answer

    def beside(self, fixed: Moves) -> "FeasibilityQuestions":
        """Return the questions whose moves stand beside others, which are as they are."""
        return replace(self, apply=lambda scene, moves: self.apply(scene, (*moves, *fixed)))

    def ask(self, scene: Any, possible: Possible[Any], seconds: float = math.inf) -> Verdict:
        """Return the answer to one question; unknown where time is up or nothing decides it."""
        if self.clock.over:
            return UNKNOWN
        clock, seconds = self.clock, min(seconds, self.seconds)
        if math.isfinite(seconds):
            budget = replace(clock.left, seconds=clock.within(seconds))
            clock = Clock(budget, clock.watch)
        try:
            return possible(scene, clock)
        except (SolveError, TimeoutError):
            return UNKNOWN


@dataclass
class FactorBracket:
    """Moves with a common factor that suffice; it has state because the search narrows it.

    moves: with the least factors they may have, times which `low` does not suffice (sure: that is
    proven) and `high` does. excess: whether an excess led there. bound: proven for the factor.
    stepped: every smaller change was tried; doubts: answers that stayed open as it was narrowed.
    """

    moves: Moves
    low: float
    high: float
    sure: bool = True
    excess: bool = False
    bound: float | None = None
    stepped: bool = False
    doubts: int = 0

    def at(self, factor: float) -> Moves:
        """Return the moves with another common factor, none beyond the farthest it may have."""
        return grown(self.moves, factor)


def grown(moves: Moves, factor: float) -> Moves:
    """Return moves times a common factor, none beyond the farthest it may have."""
    return tuple((m, min(f * factor, max(f, m.far))) for m, f in moves)


def within(clock: Clock, seconds: float, share: float = 1.0) -> Clock:
    """Clock of so many seconds, or of a share of the time left if that is less."""
    left = clock.left.seconds
    limit = seconds if left is None else min(seconds, share * left)
    return Clock(replace(clock.left, seconds=limit if math.isfinite(limit) else None), clock.watch)


def smallest(
    asked: FeasibilityQuestions, moves: Moves, bound: float | None = None
) -> FactorBracket | None:
    """Return the common factor of moves that is known roughly to suffice; None: none is known."""
    steps = moves[0][0].steps
    if steps and all(move.steps == steps for move, _ in moves):
        return _first_step(asked, [move for move, _ in moves], bound)
    if any(factor > 1.0 for _, factor in moves):  # a floor, which often suffices
        first = asked.verdict(moves)
        if first is not None and first.answer:
            return FactorBracket(moves, 1.0, 1.0, bound=bound)
    if asked.excess is not None:
        return _by_secants(asked, moves, asked.excess)
    known = _sufficient_factor(asked, moves)
    if known is not None:
        known.bound = bound
        narrow(asked, known, ROUGH)
    return known


def _first_step(
    asked: FeasibilityQuestions, numbers: Sequence[Move], bound: float | None
) -> FactorBracket | None:
    """Return the first step of numbers that take the same ones with which the file is possible."""
    steps = numbers[0].steps
    few = _too_few(asked, numbers)
    sure, before, doubts = True, steps[few - 1] if few else 1.0, 0
    for factor in steps[few:]:
        moves = tuple((move, factor) for move in numbers)
        verdict = asked.verdict(moves)
        if asked.clock.over:
            return None
        if verdict is None:  # a list may have a value already that another lacks
            if numbers[0].together is None:
                return None
            continue
        if verdict.answer:
            return FactorBracket(moves, before / factor, 1.0, sure, bound=bound, stepped=True)
        sure, before = sure and verdict.answer is False, factor
        doubts += verdict.answer is None
        if doubts > asked.doubts:
            break
    return None


def _too_few(asked: FeasibilityQuestions, numbers: Sequence[Move]) -> int:
    """Return how many steps, near ones first, are known not to suffice, even all together.

    Halves their number; 0 of steps that cannot be taken together.
    """
    steps, every = numbers[0].steps, [m.together for m in numbers if m.together]
    if len(every) < len(numbers):
        return 0
    together = [replace(move, write=write) for move, write in zip(numbers, every, strict=True)]

    def suffice(count: int) -> bool | None:
        return asked.possible_with(tuple((move, steps[count - 1]) for move in together))

    low, high = 0, len(steps)
    if suffice(high) is False:
        return high
    if suffice(1):
        return 0
    low = 1 if suffice(1) is False else 0
    while high - low > 1:
        middle = (low + high) // 2
        answer = suffice(middle)
        if answer is None:
            break
        low, high = (low, middle) if answer else (middle, high)
    return low


def _by_secants(asked: FeasibilityQuestions, moves: Moves, excess: float) -> FactorBracket | None:
    """Return the factor with which the excess of the nearest design vanishes; None: not found.

    Utilisations are nearly powers of a number, so that secants of their logarithms come near in a
    few steps, between factors that are known to suffice and not to; `power` says at first which.
    """
    low, high, stalled = 0.0, math.inf, 0
    last, before = 0.0, math.log1p(excess)
    x = before / moves[0][0].power
    for _ in range(SECANTS):
        verdict = asked.verdict(grown(moves, math.exp(x))) if x < math.log(REACH) else None
        if verdict is None or verdict.excess is None:
            break
        now = math.log1p(verdict.excess)
        low, high = (low, min(high, x)) if now <= 0.0 else (max(low, x), high)
        if -LOG_TOLERANCE < now <= 0.0 or high - low < math.log(FACTOR_TOLERANCE):
            break
        stalled += math.isinf(high) and now > before - NO_PROGRESS
        if stalled > 1:
            return None
        slope = min((now - before) / (x - last), -0.1)
        last, before, x = x, now, max(x - (now + 0.5 * LOG_TOLERANCE) / slope, 0.1 * x)
        x = x if low < x < high else 0.5 * (low + high)
    if math.isinf(high):
        return None
    return FactorBracket(moves, math.exp(high), math.exp(high), excess=True)


def _sufficient_factor(asked: FeasibilityQuestions, moves: Moves) -> FactorBracket | None:
    """Return a factor that suffices; None where the farthest that is decided does not.

    Other numbers are tried from near on.
    """
    far = min(asked.far, max(move.far / factor for move, factor in moves))
    far = _largest_allowed_factor(asked, moves, far)
    tried = [far, *(f for f in asked.ladder if f < far)]
    if not all(move.far_first for move, _ in moves):
        low = 1.0
        for factor in tried[::-1]:
            verdict = asked.verdict(grown(moves, factor))
            if verdict is not None and verdict.answer:
                return FactorBracket(moves, low, factor)
            low = factor
        return None
    for factor in tried:
        verdict = asked.verdict(grown(moves, factor))
        if verdict is not None and verdict.answer is not None:
            known = FactorBracket(moves, 1.0, factor)
            return known if verdict.answer else None
        if asked.clock.over:
            break
    asked.open.append(" and ".join(dotted(move.path) for move, _ in moves))
    return None


def _largest_allowed_factor(asked: FeasibilityQuestions, moves: Moves, far: float) -> float:
    """Return the largest factor up to one with which the rules of the file hold, nearly."""
    low, high = 1.0, far
    if asked.edited(grown(moves, far)) is not None:
        return far
    while high > low * FACTOR_TOLERANCE:
        middle = between(low, high)
        refused = asked.edited(grown(moves, middle)) is None
        low, high = (low, middle) if refused else (middle, high)
    return low


def narrow(
    asked: FeasibilityQuestions, known: FactorBracket, close: float, clock: Clock | None = None
) -> None:
    """Halve the logarithm of the change that is not known, until its ends are this close.

    What stays undecided is not known to suffice; between steps there is nothing. clock: of this
    search, beside that of all.
    """
    if known.stepped:
        return
    ends = [asked.edited(known.at(end)) for end in (known.low, known.high)]
    for middle in middles(known, close, asked.doubts):
        if asked.likely is not None and asked.dear:
            _narrow_by_designs(asked, known, close, clock or asked.clock)
            return
        if asked.clock.over or clock is not None and clock.over:
            return
        there = asked.edited(known.at(middle))
        if there is not None and any(_same(there, end) for end in ends):
            return  # of whole numbers
        seconds = asked.halving[known.doubts > 0]
        verdict = UNKNOWN if there is None else asked.verdict_of(there, seconds)
        take(known, middle, verdict.answer)
        ends[bool(verdict.answer)] = there


def _narrow_by_designs(
    asked: FeasibilityQuestions, known: FactorBracket, close: float, clock: Clock
) -> None:
    """Lower a factor to what known designs need, until a little less does not suffice.

    Of rough factors there is no less. Where it often suffices, far less is asked of designs like
    those. As long as designs for less need nearly as much the steps grow.
    """
    near = min(close, FACTOR_TOLERANCE)
    _lower(asked, known, near, asked.likely)
    if not known.sure and close < ROUGH:  # what stayed open may be possible
        known.low, known.sure = 1.0, True
    step, known.doubts, lowered = near, 0, 0
    while close < ROUGH and known.high > known.low * near * (1.0 + NEGLIGIBLE):
        if known.doubts >= asked.doubts or asked.clock.over or clock.over:
            return
        factor, before = max(known.high / step, between(known.low, known.high)), known.high
        there = asked.edited(known.at(factor))
        if there is not None and _same(there, asked.edited(known.at(known.high))):
            return  # of whole numbers
        sure, left = asked.sure or asked.possible, clock.left.seconds
        verdict = UNKNOWN if there is None else asked.ask(there.scene, sure, left or math.inf)
        take(known, factor, verdict.answer)
        lowered += bool(verdict.answer)
        if verdict.answer:
            _lower(asked, known, near, asked.near, FEW if lowered == OFTEN else 0)
            _lower(asked, known, near, asked.kin if lowered >= OFTEN else None)
            _lower(asked, known, near, asked.likely)
        slow = lowered > OFTEN or known.high > before / near ** (2.0 * FASTER)
        step = min(step**FASTER, REACH) if verdict.answer and slow else near


def _lower(
    asked: FeasibilityQuestions,
    known: FactorBracket,
    near: float,
    judge: Possible[Any] | None,
    most: float = math.inf,
) -> None:
    """Lower the factor that is known to suffice by halves, with at most so many questions."""
    low = max(1.0, known.low)
    while judge is not None and known.high > low * near * (1.0 + NEGLIGIBLE) and most > 0:
        factor, most = between(low, known.high), most - 1
        there = None if asked.clock.over else asked.edited(known.at(factor))
        if there is not None and asked.ask(there.scene, judge).answer:
            known.high = factor
        else:
            low = factor


def _same(one: Edited, other: Edited | None) -> bool:
    return other is not None and [c.write for c in one.changes] == [c.write for c in other.changes]


def as_remedy(asked: FeasibilityQuestions, known: FactorBracket, kind: str) -> Remedy | None:
    """Return moves as edits that were tried as they are written; None where no design is known."""
    tried = _checked_remedy(asked, known, kind)
    return None if tried is None else _with_short_form(asked, *tried)


def _checked_remedy(
    asked: FeasibilityQuestions,
    known: FactorBracket,
    kind: str,
    what: str = "",
    sharp: Clock | None = None,
    last: Clock | None = None,
) -> tuple[Remedy, Edited] | None:
    """Return a remedy and its edits, exactly.

    sharp: a clock of making it smaller; last: of whether less suffices.
    """
    there = _edits_as_written(asked, known)
    if there is None:
        return None
    word, closer = _less(asked, known, there, kind, last), list(CLOSER)
    while word == "feasible" and kind not in EACH and closer:
        before = known.high
        narrow(asked, known, closer[0], sharp)
        closer = closer[1:] if known.high == before or asked.likely is None else closer
        there = _edits_as_written(asked, known) or there
        word = _less(asked, known, there, kind, last)
    factors = [change.factor for change in there.changes]
    factor = math.prod(factors) if kind in EACH else max(factors)
    names = dict.fromkeys(move.words for move, _ in known.moves)
    verified = {"with": "feasible"} | ({"with_less": word} if word else {})
    what = what or ", ".join(names)
    return Remedy(kind, what, there.changes, factor, known.bound, verified), there


def _edits_as_written(asked: FeasibilityQuestions, known: FactorBracket) -> Edited | None:
    """Return the edits of moves that were tried as they are written; None: no design is known."""
    for room in ROOM if known.excess else (1.0,):
        moves = known.at(known.high * room)
        there = asked.edited(moves)
        if there is not None and _works(asked, there, moves):
            return there
    return None


def _less(
    asked: FeasibilityQuestions, known: FactorBracket, there: Edited, kind: str, last: Clock | None
) -> str:
    """Verdict, in one word, on moves taken back a little, together or each of them."""
    if known.stepped:
        return "infeasible" if known.sure else "undecided"
    if known.excess:
        return "undecided"
    moved = [k for k, move in enumerate(there.places) if move.switch is None]
    each = moved if kind in EACH else [None]
    tried = [less(asked.scene, there, SLACK_TRIED, k) for k in each]
    if kind not in EACH and _is_excluded(asked, known, tried[0]):
        return "infeasible"
    if last is not None and last.over or asked.near and not known.sure:
        return "undecided"
    words = {WORDS[_possible(asked, scene)] for scene in tried}
    return "mixed" if len(words) > 1 else next(iter(words), "")


def _is_excluded(asked: FeasibilityQuestions, known: FactorBracket, scene: Any) -> bool:
    """Return whether numbers of a changed file move no farther than what is proven too little."""
    if scene is None or not known.sure or known.low <= 1.0:
        return False
    return all(
        move.far_first
        and move.factor(*(move.inherits(one, move.path) for one in (asked.scene, scene)))
        <= factor * known.low
        for move, factor in known.moves
    )


def least(asked: FeasibilityQuestions, moves: Moves) -> FactorBracket | None:
    """Return the common factor of moves that suffices, closely; None: none is known."""
    known = smallest(asked, moves)
    if known is not None:
        narrow(asked, known, FACTOR_TOLERANCE)
    return known


def enlarged(asked: FeasibilityQuestions, moves: Moves) -> Moves | None:
    """Return moves with the least common factor beyond their own that suffices; None: none does."""
    known = least(asked, moves)
    return None if known is None else known.at(known.high)


def trimmed(asked: FeasibilityQuestions, moves: Moves) -> Moves:
    """Return moves of which each is needed, and as small as the others allow."""
    kept = moves
    for move, factor in moves[::-1]:
        others = tuple(m for m in kept if m[0] is not move)
        beside = asked.beside(others)
        if others and beside.possible_with(()):
            kept = others
            continue
        known = FactorBracket(((move, 1.0),), 1.0, factor)
        narrow(beside, known, FACTOR_TOLERANCE)
        kept = tuple((m, known.high if m is move else f) for m, f in kept)
    return kept


def _works(asked: FeasibilityQuestions, there: Edited, moves: Moves) -> bool:
    if asked.sure is None:
        verdict = asked.verdict(moves)
        return verdict is not None and bool(verdict.answer)
    return bool(asked.ask(there.scene, asked.sure).answer)


def _possible(asked: FeasibilityQuestions, scene: Any) -> bool | None:
    return None if scene is None else asked.ask(scene, asked.sure or asked.possible).answer


def _with_short_form(asked: FeasibilityQuestions, remedy: Remedy, there: Edited) -> Remedy:
    """Return a remedy with `short`: as one would write it, where a design exists so, too."""
    judge = asked.possible if asked.excess is None else asked.sure or asked.possible
    for digits in DIGITS:
        short = shorter(asked.scene, there, digits)
        if short is not None and asked.ask(short.scene, judge).answer:
            return replace(remedy, changes=short.changes)
    return remedy


def of_use(asked: FeasibilityQuestions, groups: Sequence[Group]) -> list[Group]:
    """Return groups but for those that do not suffice all at once at their farthest, by halves.

    Of numbers that are easier the farther they move, whether in steps or not.
    """
    far = [(move, _farthest(asked, move)) for group in groups for move in group.numbers]
    verdict = asked.possible_with(tuple(far)) if len(groups) > 1 else None
    if not verdict:  # what all cannot decide is decided of each alone
        return list(groups) if verdict is None else []
    middle = len(groups) // 2
    return of_use(asked, groups[:middle]) + of_use(asked, groups[middle:])


def _farthest(asked: FeasibilityQuestions, move: Move) -> float:
    """Return the largest factor of a number that the rules of the file allow, nearly."""
    if move.steps:
        allowed = (f for f in move.steps[::-1] if asked.edited(((move, f),)) is not None)
        return next(allowed, 1.0)
    return _largest_allowed_factor(asked, ((move, 1.0),), min(asked.far, move.far))


def singles(
    asked: FeasibilityQuestions, groups: Iterable[Group], seconds: float = math.inf
) -> list[Remedy]:
    """Return the groups of numbers that suffice by one factor: first roughly, then sharper.

    seconds: at most, to make them sharper; LAST times as many, for whether less suffices.
    """
    rough = list[tuple[Group, FactorBracket]]()
    for group in groups:
        known = smallest(asked, group.moves, group.bound)
        if known is not None:
            _tell_first(asked, known, rough)
            rough.append((group, known))
            asked.sufficient += 1
    sharp = within(asked.clock, seconds, SHARE_OF_TIME if math.isfinite(seconds) else 1.0)
    last = within(asked.clock, LAST * seconds, SHARE_OF_TIME if math.isfinite(seconds) else 1.0)
    sufficient = list[tuple[Remedy, Edited]]()
    for group, known in rough:
        narrow(asked, known, FACTOR_TOLERANCE, sharp)
        if asked.lower_bounds and known.sure and known.low > 1.0 and known.bound is None:
            known.bound = known.low
        kind = "even" if len(group.numbers) > 1 else "alone"
        kind = "less" if all(move.role == DUTY for move in group.numbers) else kind
        tried = _checked_remedy(asked, known, kind, group.what, sharp, last)
        sufficient += [] if tried is None else [tried]
    return [_with_short_form(asked, *tried) for tried in sufficient]


def _tell_first(asked: FeasibilityQuestions, known: FactorBracket, others: Sequence[Any]) -> None:
    """Log the first change that makes the file possible, while smaller ones are sought."""
    there = None if others else _edits_as_written(asked, known)
    if there is not None:
        edits = ", ".join(f"{change.key} = {change.write}" for change in there.changes)
        logger.info("a design exists with %s; smaller changes are looked for", edits)


def with_least(found: Sequence[Remedy], complete: bool) -> tuple[Remedy, ...]:
    """Return remedies of which the smallest that keeps the duty is said to be so.

    complete: whether all others were tried, with an answer.
    """
    found = sorted(found, key=_order)
    if not found or found[0].kind not in ("alone", "even"):
        return tuple(found)
    others = "need more" if complete else "not all known"
    verified = {**found[0].verified, "others": others}
    return (replace(found[0], kind="least", verified=verified), *found[1:])


def _order(remedy: Remedy) -> tuple[int, float]:
    """Sort key of remedies: those that keep the duty first, choices last."""
    return ("less", "choice").index(remedy.kind) + 1 if remedy.kind in (
        "less",
        "choice",
    ) else 0, remedy.factor
