"""Whether an impossible drive is possible with some numbers moved; the smallest moves that do."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from gearopt.formulations.drive import sizing
from gearopt.formulations.drive.teeth.progress import Teeth
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.reach import narrowed
from gearopt.formulations.drive.teeth.search import any_train, possible
from gearopt.formulations.drive.train import Train
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explain import THERE
from gearopt.optimise.explaining.repair import WIDEST, Works, least_between, least_value
from gearopt.optimise.solve import solve_within
from gearopt.scenes.drive.explaining.movable import Movable, Moves, applied, less, steps
from gearopt.scenes.drive.scene import Scene

SECONDS = 2.0  # at most, for one question
WHOLE, FEW = 0.7, 0.1  # parts of them, for a rated drive and for one of few pinions


@dataclass(frozen=True)
class Case:
    """A drive that is impossible, and the time to look for remedies.

    open: questions that no answer was found to in time; a list, to be added to. seconds: at most,
    for one question whether whole teeth are possible; shelf: tables that questions share.
    """

    scene: Scene
    clock: Clock
    open: list[Train] = field(default_factory=list)
    seconds: float = SECONDS
    shelf: list[RatedTable] = field(default_factory=list)

    def possible(self, train: Train) -> bool | None:
        """Return whether a drive has a design, with whole teeth where the file asks for them.

        None where that is not known in time.
        """
        if self.clock.over:
            return None
        if self.scene.teeth is None:
            word = solve_within(self.clock, sizing.problem(train)).status
            return True if word in THERE else (False if word == "infeasible" else None)
        if train.rated:
            return self._rated(train)
        few, seconds = narrowed(train), self.clock.within(self.seconds)
        if few != train and possible(few, seconds, self.clock.watch, self.shelf):
            return True
        found = possible(train, seconds, self.clock.watch, self.shelf)
        if found is None:
            self.open.append(train)
        return found

    def _rated(self, train: Train) -> bool | None:
        """Return whether a drive that ratings limit has a design.

        Where that is not known soon, drives of one pinion and of the widest faces are tried, which
        are searched quickly.
        """
        few = _widest(train), _of_pinion(train, 0), _of_pinion(train, -1)
        for one, part in ((train, WHOLE), *((one, FEW) for one in few)):
            seconds = part * self.clock.within(self.seconds)
            found = possible(one, seconds, self.clock.watch, self.shelf)
            if found or one is train and found is False:
                return found
        self.open.append(train)
        return None

    def teeth(self, train: Train) -> Teeth | None:
        """Return the teeth of some train of a drive, (): there is none; None: not known."""
        if self.clock.over:
            return None
        return any_train(train, self.clock.within(self.seconds), self.clock.watch, self.shelf)

    def status(self, scene: Scene) -> str:
        """Return what is known of a changed drive: feasible, infeasible or undecided.

        Real-valued sizes are asked first: where they are impossible, whole teeth are.
        """
        if self.clock.over:
            return "undecided"
        if scene.teeth is not None:
            if solve_within(self.clock, sizing.problem(scene.train())).status == "infeasible":
                return "infeasible"
        found = self.possible(scene.train())
        return "undecided" if found is None else ("feasible" if found else "infeasible")

    def works(self, moves: Sequence[tuple[Movable, float]], back: float = 0.0) -> bool | None:
        """Return whether moves suffice (less a part `back` of each); None: not known."""
        edited = applied(self.scene, moves)
        if edited is None:
            return None
        return self.possible((less(self.scene, edited, back) if back else edited.scene).train())


def _of_pinion(train: Train, end: int) -> Train:
    """Return the drive with the fewest (0) or most (-1) teeth of every pinion."""
    stages = []
    for stage in train.stages:
        teeth = stage.pinion_teeth[end] or stage.pinion_teeth[0]
        stages.append(replace(stage, pinion_teeth=(teeth, teeth)))
    return replace(train, stages=tuple(stages))


def _widest(train: Train) -> Train:
    """Return the drive with the widest faces alone, where they are free."""
    stages = []
    for stage in train.stages:
        face = stage.face_width
        free = face.step is None and face.fixed is None and face.plain
        widest = replace(face, low=face.high) if free and face.high else face
        stages.append(replace(stage, face_width=widest))
    return replace(train, stages=tuple(stages))


def smallest_step(case: Case, number: Movable, most: float) -> tuple[float, bool] | None:
    """Return the smallest factor, at most `most`, of a number that may only take steps.

    And whether every smaller one is known to be impossible.
    """
    sure = True
    for factor in steps(case.scene, number):
        edited = applied(case.scene, [(number, factor)])
        if edited is None or factor > most or case.clock.over:
            break
        found = case.possible(edited.scene.train())
        if found:
            return factor, sure
        sure = sure and found is False
    return None


def smallest_alike(case: Case, moves: Moves) -> Moves | None:
    """Return the smallest moves that suffice, all alike: as given, or enlarged for whole teeth."""
    if case.scene.teeth is None:
        return moves
    return enlarged(case, moves)


def enlarged(case: Case, moves: Moves, fixed: Moves = ()) -> Moves | None:
    """Return moves with the smallest common factor beyond their own with which a design exists.

    fixed: moves that are made beside them, as they are.
    """

    def larger(extra: float) -> Moves:
        return tuple((number, min(f * extra, max(f, number.reach))) for number, f in moves)

    def works(extra: float, back: float = 0.0) -> bool | None:
        return case.works((*larger(extra), *fixed), back)

    hopeless = all(number.eases for number, _ in moves) and works(WIDEST[-1]) is False
    extra = None if hopeless else least_value(1.0, WIDEST, works)
    return None if extra is None else larger(extra)


def trimmed(case: Case, moves: Moves, fixed: Moves = ()) -> Moves:
    """Return moves of which each is needed, and as small as the others and those fixed allow."""
    kept = moves
    for number, factor in reversed(moves):
        beside = tuple(m for m in kept if m[0] is not number)
        others = (*beside, *fixed)
        if others and case.works(others):
            kept = beside
            continue
        least = least_between(1.0, factor, _alone(case, others, number))
        kept = tuple((m, least if m is number else f) for m, f in kept)
    return kept


def _alone(case: Case, others: Moves, number: Movable) -> Works:
    """Return whether a factor of one move will do beside the others: works(factor, back)."""

    def works(factor: float, back: float = 0.0) -> bool | None:
        moves = (*others, (number, factor))
        edited = applied(case.scene, moves)
        if edited is None or not back:
            return case.works(moves)
        one = less(case.scene, edited, back, edited.paths.index(number.path))
        return case.possible(one.train())

    return works
