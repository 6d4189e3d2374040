"""Remedies of an impossible drive that ratings limit: each number or choice of the file alone."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.train import Train
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Remedies
from gearopt.optimise.result import Budget
from gearopt.scenes.drive.driving import trains
from gearopt.scenes.drive.explain.choice_moves import choice_groups, teeth_groups
from gearopt.scenes.drive.explain.influences import GRADES, eases
from gearopt.scenes.drive.explain.moves import WIDTH, next_module
from gearopt.scenes.drive.explain.rated_choices import choices, choices_of_planets
from gearopt.scenes.drive.explain.rated_conflict import Conflict, conflict
from gearopt.scenes.drive.explain.requirements import (
    DISTANCE,
    OF_SHIFTS,
    OF_TEETH,
    ORDER,
    TEETH,
)
from gearopt.scenes.drive.explain.tried import Case, any_possible
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.drive.tables.planetary import INTERNAL
from gearopt.scenes.explaining.engine import (
    FeasibilityQuestions,
    Group,
    of_use,
    singles,
    with_least,
    within,
)
from gearopt.scenes.explaining.moves import DUTY, LIMIT, Move
from gearopt.scenes.explaining.numbers import Number, apart, numbers, one_at
from gearopt.scenes.explaining.possible import Possible, Verdict, of_status

USUAL_SECONDS = 60.0  # budget of all; with more, what follows is allowed in proportion
TRANSMITTED = (("duty", "power"), ("duty", "torque"))
# s, at most, for the conflict: beside an answer, before remedies, and after them if it is open
CONFLICT_SECONDS, CONFLICT_SECONDS_BESIDE_REMEDIES, CONFLICT_SECONDS_LATER = 1.5, 0.6, 1.5
# s, at most, for a first number that helps, for the others then, and for one question
ROUGH_SECONDS, OTHERS_SECONDS, QUESTION_SECONDS = 8.0, 4.0, 2.0
LAST_SECONDS = 12.0  # s, at most, for whether a little less than what is proposed suffices
FARTHEST_FACTOR, LAST_FACTOR = 3.0, 100.0  # of a remedy of use; of one, where there is none
SHARE_OF_TIME = 0.4  # at most, of the time that is left, for each of these
SHARPEN_SECONDS, CHOICE_SECONDS = 45.0, 4.0  # s, at most, to make them sharper, and for choices
CHOSEN = (DISTANCE, "sum_of_centre_distances", "helix_angle", "pinion_shift", "sum")
MODES = ("bending", "contact")
SAFETIES = tuple(f"minimum_{mode}_safety" for mode in MODES)
STEPPED = (*GRADES, "accuracy_grade", "grade")  # moved by ones


def conflict_soon(scene: Scene, clock: Clock) -> Remedies | None:
    """Conflict of an impossible drive alone; None where it is not found soon."""
    case = Case(scene, Clock(Budget(clock.within(CONFLICT_SECONDS)), clock.watch))
    known = conflict(case, resolving=False)
    if not known.names:
        return None
    names, unsure = (_told(scene, each) for each in (known.names, known.unsure))
    return Remedies(names, (), "", known.any_resolves, unsure, untried=True)


def remedies(scene: Scene, clock: Clock, status: Callable[[Scene], str]) -> Remedies:
    """The conflict, and the changes that alone make the drive possible, the smallest first.

    status(scene): of a changed drive, solved; asked where sizes are real-valued.
    """
    patience = max(1.0, (clock.left.seconds or 0.0) / USUAL_SECONDS)

    def soon(seconds: float) -> Clock:
        return within(clock, patience * seconds, SHARE_OF_TIME)

    early = Case(scene, soon(CONFLICT_SECONDS_BESIDE_REMEDIES))
    known = conflict(early)
    case = replace(early, clock=clock, open=[], seconds=patience * QUESTION_SECONDS)
    sharpen = patience * SHARPEN_SECONDS

    def works(other: Scene, case: Case = case) -> bool | None:
        if other.teeth is None:
            return of_status(status(other)).answer
        return any_possible(case, [t for n in other.counts for t in trains(other.held(n))])

    def some(judge: Callable[[Train], bool]) -> Possible[Scene]:
        def possible(other: Scene, clock: Clock) -> Verdict:
            return Verdict(any(judge(t) for n in other.counts for t in trains(other.held(n))))

        return possible

    asked = FeasibilityQuestions(scene, lambda other, clock: Verdict(works(other)), clock)
    longer = replace(case, seconds=patience * LAST_SECONDS)
    asked.sure = lambda other, clock: Verdict(works(other, longer))
    if scene.teeth is not None and not any(map(scene.choosing, scene.stage_tables)):
        asked.likely, asked.near, asked.kin = map(some, (case.like, case.near, case.kin))
    turns = _Turns(soon(ROUGH_SECONDS), lambda: soon(OTHERS_SECONDS), asked)
    ways = singles(asked, turns.until(_groups(scene, known, asked)), sharpen)
    of_planets = soon(CHOICE_SECONDS)
    around = [*choices_of_planets(scene, lambda o: None if of_planets.over else works(o))]
    short = of_planets.over
    if not ways:
        rest = soon(ROUGH_SECONDS) if around else clock
        turns = replace(turns, first=rest, over=False)
        unnamed = Conflict(whatever_load=known.whatever_load)
        groups = turns.until(_groups(scene, unnamed, asked, LAST_FACTOR))
        ways = singles(asked, groups, sharpen)
    last = soon(CHOICE_SECONDS)
    chosen = choices(scene, known, lambda other: None if last.over else works(other))
    ways += [*around, *chosen]
    if early.clock.over and not known.proven:
        again = conflict(replace(early, clock=soon(CONFLICT_SECONDS_LATER), open=[]))
        known = again if again.names else known
    complete = not (turns.over or clock.over or case.open)
    late = "time ran out before all remedies were tried" if clock.over else ""
    late = late or ("not all remedies were tried" if turns.over or last.over or short else "")
    words = "; ".join(filter(None, (_doubts(known, case), late)))
    names, unsure = (_told(scene, each) for each in (known.names, known.unsure))
    return Remedies(names, with_least(ways, complete), words, known.any_resolves, unsure)


def _told(scene: Scene, names: Sequence[str]) -> tuple[str, ...]:
    """Names of a conflict; safety factors are those of a peak torque, too, where there is one."""
    peak = scene.rating is not None and scene.rating.static_torque_factor is not None
    tail = "_or_that_at_the_peak_torque" * peak
    inner = [f"[{k}]" for k, table in enumerate(scene.stage, 1) if table.type == INTERNAL]
    called = [n.replace("sun", "pinion") if n.endswith((*inner,)) else n for n in names]
    return tuple(f"{name}{tail}" if name in SAFETIES else name for name in called)


@dataclass
class _Turns:
    """Time for the numbers that may help; it has state as it is over when one has had no turn.

    first: until one is known to suffice; others: then; asked: which knows.
    """

    first: Clock
    others: Callable[[], Clock]
    asked: FeasibilityQuestions
    over: bool = False

    def until(self, groups: Iterator[Group]) -> Iterator[Group]:
        """Yield groups as long as there is time."""
        clock = self.first
        for group in groups:
            if clock is self.first and self.asked.sufficient:
                clock = self.others()
            if clock.over:
                self.over = True
                return
            yield group


def _doubts(known: Conflict, case: Case) -> str:
    if known.names:
        return ""
    return "time ran out before the conflict was identified" if case.clock.over or case.open else ""


def _groups(
    scene: Scene, known: Conflict, asked: FeasibilityQuestions, far: float = FARTHEST_FACTOR
) -> Iterator[Group]:
    """Yield the numbers that may help, each alone; those of teeth, which take longest, come last.

    What is in no conflict keeps the drive impossible however it is moved; where there are no teeth
    whatever they carry, so does what they carry. Unlikely ones are first moved all at once.
    """
    dropped = known.names and {name.split("[")[0] for name in known.names}
    yield from _of_distances(scene, far, 1)
    likely, unlikely, slow = list[Group](), list[Group](), list[Group]()
    for number in sorted(numbers(scene), key=_rank):
        if any(step in CHOSEN for step in number.path):
            continue
        way = -1 if number.path in TRANSMITTED else eases(scene, number) or _wider(number)
        name = _name(number) if way else ""
        idle = known.whatever_load and name not in OF_TEETH
        if way and not idle and not (dropped and name in _PROVEN and name not in dropped):
            group = Group((_move(scene, number, way, far),))
            late, rank = _rank(number)
            (slow if late else likely if rank < len(ORDER[0]) else unlikely).append(group)
    yield from likely
    yield from of_use(asked, unlikely)
    yield from slow
    yield from _of_distances(scene, far, -1)
    for way in (1, -1):
        yield from teeth_groups(scene, way)


def _of_distances(scene: Scene, far: float, way: int) -> Iterator[Group]:
    """Yield centre distances, given or chosen from, and their sum, up (way +1) or down (-1)."""
    given = [n for n in numbers(scene) if n.path[-1] == DISTANCE]
    if not scene.limits.coaxial and scene.limits.sum_of_centre_distances is None:
        for number in given:
            yield Group((replace(_move(scene, number, way, far), far_first=False),))
    yield from choice_groups(scene, way)


def _move(scene: Scene, number: Number, way: int, far: float) -> Move:
    """Return the move of a number; numbers of pinion teeth go no farther than TEETH."""
    role = DUTY if number.path in TRANSMITTED else LIMIT
    if values := _values(scene, number, way, far):
        return Move(number.path, way, role, inherits=one_at).to_values(number.value, values)
    if "pinion_teeth" in number.path:
        far = min(far, float(TEETH))
    return Move(number.path, way, role, far=far, inherits=one_at)


def _values(scene: Scene, number: Number, way: int, far: float) -> list[Any]:
    """Return the next values of a number that takes steps, near ones first; none: it takes none.

    far: the factor of the farthest.
    """
    values = list[Any]()
    if scene.teeth is not None and "module" in number.path:
        value = next_module(scene, number.value, way)
        while value is not None and apart(number.value, value) <= far:
            values.append(value)
            value = next_module(scene, value, way)
    elif number.path[-1] in STEPPED:
        values = [new for k in (1, 2, 3) if (new := number.value + way * k) > 0]
    return values


_PROVEN = (  # whose moves up to FARTHEST_FACTOR are within what the conflict was proven without
    *("minimum_bending_safety", "minimum_contact_safety", "life", "module_high", "module_low"),
    *("wheel_diameter", "stage_ratio_high", "stage_ratio_low", "least_face_width"),
    *("face_width_over_module_high", "face_width_over_module_low", "face_width_low"),
    *("wheel_teeth_high", "wheel_teeth_low", "face_width_high", "axial_force", "overlap_ratio"),
    *OF_SHIFTS,
)


def _name(number: Number) -> str:
    """Return the requirement that a number is of."""
    end = number.path[-1] if isinstance(number.path[-1], int) else None
    field = str(number.path[-1] if end is None else number.path[-2])
    requirements = {"minimum_face_width": "least_face_width", "input_revolutions": "life"}
    requirements |= {f"minimum_static_{m}_safety": f"minimum_{m}_safety" for m in MODES}
    tail = ("_low", "_high")[end] if end in (0, 1) else ""
    return requirements.get(field, field.replace(WIDTH, "face_width" if tail else WIDTH)) + tail


def _wider(number: Number) -> int:
    """Return +1 for a face width that is tied or given, else 0."""
    return int(number.path[-1] in (WIDTH, "face_width"))


def _rank(number: Number) -> tuple[bool, int]:
    """Sort key of numbers: ranges of teeth take longest, and likely conflicts come first."""
    slow = any(str(step).endswith("_teeth") for step in number.path)
    likely, name = ORDER[0], _name(number)
    return slow, likely.index(name) if name in likely else len(likely)
