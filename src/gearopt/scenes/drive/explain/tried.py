"""Whether an impossible drive is possible with some numbers moved."""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field, replace

from gearopt.formulations.drive import continuous_sizing
from gearopt.formulations.drive.teeth.progress import Teeth
from gearopt.formulations.drive.teeth.rated import RatedTable
from gearopt.formulations.drive.teeth.reach import narrowed
from gearopt.formulations.drive.teeth.search import any_train, possible, reaches
from gearopt.formulations.drive.train import Train
from gearopt.frozen import dataclass
from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.repair import FARTHEST
from gearopt.optimise.result import THERE
from gearopt.optimise.solve import solve_within
from gearopt.scenes.drive.driving import trains
from gearopt.scenes.drive.explain.moves import applied
from gearopt.scenes.drive.scene import Scene
from gearopt.scenes.explaining.engine import FeasibilityQuestions
from gearopt.scenes.explaining.possible import Verdict, of_status

SECONDS = 2.0  # at most, for one question
LIKE = 2  # known designs whose teeth are tried
NEAR = 0.7  # s, at most, for a drive of given pinions
WHOLE, FEW = 0.7, 0.1  # parts of them, for a rated drive and for one of few pinions


@dataclass(frozen=True)
class Case:
    """A drive that is impossible, and the time to look for remedies.

    open: questions that no answer was found to in time; a list, to be added to. seconds: at most,
    for one question whether whole teeth are possible; shelf: tables that questions share. known:
    teeth of designs of rated drives that questions found, the last one first; a list, too.
    answers: to questions without some requirements.
    """

    scene: Scene
    clock: Clock
    open: list[Train] = field(default_factory=list)
    seconds: float = SECONDS
    shelf: list[RatedTable] = field(default_factory=list)
    known: list[Teeth] = field(default_factory=list)
    answers: dict[frozenset[str], bool] = field(default_factory=dict)

    def possible(self, train: Train) -> bool | None:
        """Return whether a drive has a design, with whole teeth where the file asks for them.

        None where that is not known in time.
        """
        if self.clock.over:
            return None
        if self.scene.teeth is None:
            word = solve_within(self.clock, continuous_sizing.problem(train)).status
            return True if word in THERE else (False if word == "infeasible" else None)
        if train.rated:
            return self._rated(train)
        few, seconds = narrowed(train), self.clock.within(self.seconds)
        if few != train and possible(few, seconds, self.clock.watch, self.shelf):
            return True
        verdict = possible(train, seconds, self.clock.watch, self.shelf)
        if verdict is None:
            self.open.append(train)
        return verdict

    def _rated(self, train: Train) -> bool | None:
        """Return whether a drive that ratings limit has a design.

        Teeth of designs of like drives are tried first, where there are teeth at all. Where it is
        not known soon then, drives of one pinion and of the widest faces are tried, which are
        searched quickly.
        """
        if reaches(train) is False:
            return False
        tried = self.known[:LIKE] if len(train.stages) > 1 else ()
        like = [one for teeth in tried for one in _of_teeth(train, teeth)]
        few = _widest(train), _of_pinion(train, 0), _of_pinion(train, -1)
        parts = (train, WHOLE), *((one, FEW) for one in few)
        if self._any(like, FEW * self.seconds):
            return True
        for narrower, part in parts:
            seconds = part * self.clock.within(self.seconds)
            teeth = any_train(narrower, seconds, self.clock.watch, self.shelf)
            if teeth:
                self._keep(teeth)
                return True
            if narrower is train and teeth is not None:
                return False
        self.open.append(train)
        return None

    def like(self, train: Train) -> bool:
        """Return whether teeth of designs that are known make a drive possible."""
        like = (one for teeth in self.known[:LIKE] for one in _of_teeth(train, teeth))
        return self._any(like, FEW)

    def near(self, train: Train) -> bool:
        """Return whether teeth of known designs, their pinions or extreme ones make it possible."""
        known = (tuple(z for z, _ in teeth) for teeth in self.known[:LIKE])
        ends = ((s.pinion_teeth[1] or s.pinion_teeth[0], s.pinion_teeth[0]) for s in train.stages)
        pinions = dict.fromkeys((*known, *itertools.product(*ends)))
        drives = (one for each in pinions for one in _of_teeth(train, [(z, None) for z in each]))
        return self.like(train) or self._any(drives, NEAR)

    def kin(self, train: Train) -> bool:
        """Return whether pinions of the design that is known last make a drive possible."""
        known = [[(z, None) for z, _ in teeth] for teeth in self.known[:1]]
        return self._any((one for teeth in known for one in _of_teeth(train, teeth)), NEAR)

    def _any(self, few: Iterable[Train], seconds: float) -> bool:
        """Return whether one of some drives, which are searched quickly, is possible."""
        for one in few:
            teeth = any_train(one, self.clock.within(seconds), self.clock.watch, self.shelf)
            if teeth:
                self._keep(teeth)
                return True
        return False

    def _keep(self, teeth: Teeth) -> None:
        """Note teeth of a design, as those that are known last."""
        self.known[:] = [teeth, *(other for other in self.known if other != teeth)]

    def teeth(self, train: Train) -> Teeth | None:
        """Return the teeth of some train of a drive, (): there is none; None: not known."""
        if self.clock.over:
            return None
        return any_train(train, self.clock.within(self.seconds), self.clock.watch, self.shelf)

    def status(self, scene: Scene) -> str:
        """Status of a changed drive in a word: feasible, infeasible or undecided.

        Real-valued sizes are asked first: where they are impossible, whole teeth are.
        """
        if self.clock.over:
            return "undecided"
        if scene.teeth is not None:
            real = (continuous_sizing.problem(train) for train in trains(scene))
            if all(solve_within(self.clock, one).status == "infeasible" for one in real):
                return "infeasible"
        verdict = any_possible(self, trains(scene))
        return "undecided" if verdict is None else ("feasible" if verdict else "infeasible")

    @property
    def asked(self) -> FeasibilityQuestions:
        """Return the questions of the search for the smallest change."""

        def sized(scene: Scene, clock: Clock) -> Verdict:
            return Verdict(any_possible(self, trains(scene)))

        def sure(scene: Scene, clock: Clock) -> Verdict:
            return of_status(self.status(scene))

        both = sized if self.scene.teeth is None else sure
        return FeasibilityQuestions(
            self.scene, sized, self.clock, both, far=FARTHEST, apply=applied
        )


def any_possible(case: Case, trains: Sequence[Train]) -> bool | None:
    """Return whether one of some drives has a design; None where that is not known in time."""
    return any_of([case.possible(train) for train in trains])


def any_of(answers: Sequence[bool | None]) -> bool | None:
    """Whether one of some answers is yes; None where that is not known."""
    return True if True in answers else (None if None in answers else False)


def _of_pinion(train: Train, end: int) -> Train:
    """Return the drive with the fewest (0) or most (-1) teeth of every pinion."""
    stages = []
    for stage in train.stages:
        teeth = stage.pinion_teeth[end] or stage.pinion_teeth[0]
        stages.append(replace(stage, pinion_teeth=(teeth, teeth)))
    return replace(train, stages=tuple(stages))


def _of_teeth(train: Train, teeth: Sequence[tuple[int, int | None]]) -> Iterator[Train]:
    """Yield the drive of these teeth alone, where every stage may have them; None: any wheel."""
    stages = []
    for stage, pair in zip(train.stages, teeth, strict=False):
        ends = [stage.pinion_teeth, stage.wheel_teeth]
        for k, z in enumerate(pair):
            low, high = ends[k]
            if z is not None and (z < low or high is not None and z > high):
                return
            ends[k] = ends[k] if z is None else (z, z)
        stages.append(replace(stage, pinion_teeth=ends[0], wheel_teeth=ends[1]))
    if len(teeth) == len(train.stages):
        yield replace(train, stages=tuple(stages))


def _widest(train: Train) -> Train:
    """Return the drive with the widest faces alone, where they are free."""
    stages = []
    for stage in train.stages:
        face = stage.face_width
        free = face.step is None and face.fixed is None and face.plain
        widest = replace(face, low=face.high) if free and face.high else face
        stages.append(replace(stage, face_width=widest))
    return replace(train, stages=tuple(stages))
