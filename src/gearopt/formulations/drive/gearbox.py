"""The input of a layout: gear pairs, shafts, clearances, obstacles, and the objective.

Stages and shafts are counted from 0 here; shaft k carries wheel k - 1 and pinion k, so that the
input shaft is 0 and the output shaft is the number of stages. y and z lie across the shafts with
the input shaft at 0, 0; x runs along them from the inner face of the box. All lengths in mm.
"""

import math
from itertools import accumulate
from typing import Any

from gearopt.frozen import dataclass

Range = tuple[float, float]
ANYWHERE: Range = (-math.inf, math.inf)
OBJECTIVES = {  # name -> unit; width along y, height along z, length along x
    "box_volume": "mm3",
    "plan_area": "mm2",  # width times length, seen from above
    "face_area": "mm2",  # width times height, seen along the shafts
    "height": "mm",
    "longest_side": "mm",
}
SIDES = {"width": "mm", "height": "mm", "length": "mm"}  # that may be limited


@dataclass(frozen=True)
class Shaft:
    """Radius of a shaft; radius and width of each of its two bearings (0: none)."""

    radius: float
    bearing_radius: float = 0.0
    bearing_width: float = 0.0


@dataclass(frozen=True)
class Clearances:
    """Minimum distances: of gears, of a gear or shaft and another shaft, to the walls, along x."""

    gears: float = 5.0
    shafts: float = 2.0
    wall: float = 10.0
    axial: float = 10.0


@dataclass(frozen=True)
class KeepOut:
    """A box that no gear, shaft or bearing may enter, nor come closer to than the clearance."""

    name: str
    y: Range
    z: Range
    x: Range = ANYWHERE


@dataclass(frozen=True)
class Place:
    """Where the axis of a shaft must be, measured from that of the input shaft."""

    shaft: int
    y: Range = ANYWHERE
    z: Range = ANYWHERE


@dataclass(frozen=True)
class Planetary:
    """A planetary stage as a disc on the line of its input and output shaft, which end at it.

    tip_diameter: outside diameter of the ring [mm]. It stands for the gears of both shafts.
    """

    tip_diameter: float
    width: float
    ratio: float
    centre_distance: float = 0.0

    @property
    def gears(self) -> tuple["Planetary", "Planetary"]:
        """Itself, on either shaft."""
        return self, self

    pinion = wheel = property(lambda self: self)


@dataclass(frozen=True)
class Gearbox:
    """Gears, shafts and obstacles that are to be laid out.

    pairs: `GearPair` or `Planetary` of every stage.
    partial: shafts end beside their gears instead of passing the whole box. slabs: the stages of
    each axial slab in order (None: the best). motor: radius of a motor on the input shaft at the
    face where the output shaft leaves (0: none in its way). level: shafts on the split line of the
    housing, of equal z. width: the box is made as wide as this. largest: maximum width, height and
    length.
    """

    pairs: tuple[Any, ...]
    shafts: tuple[Shaft, ...]
    clearances: Clearances = Clearances()
    partial: bool = False
    slabs: tuple[tuple[int, ...], ...] | None = None
    keep_outs: tuple[KeepOut, ...] = ()
    motor: float = 0.0
    places: tuple[Place, ...] = ()
    level: tuple[int, ...] = ()
    objective: str = "box_volume"
    width: float | None = None
    largest: tuple[float, float, float] = (math.inf, math.inf, math.inf)

    def __post_init__(self) -> None:
        if len(self.shafts) != len(self.pairs) + 1 or not self.pairs:
            raise ValueError("a gearbox of N stages has N + 1 shafts")
        if all(isinstance(pair, Planetary) for pair in self.pairs):
            raise ValueError("planetary stages alone are in one line: there is nothing to lay out")
        if self.width is not None and self.width > self.largest[0]:
            raise ValueError("the given width is above the largest width")
        if self.objective not in OBJECTIVES and self.objective != "width":
            raise ValueError(f"no objective {self.objective!r}; {', '.join(OBJECTIVES)}")
        if self.objective == "width" and self.width is not None:
            raise ValueError("the width is given: it cannot be minimised")
        if self.slabs is not None:
            if sorted(s for slab in self.slabs for s in slab) != list(range(len(self.pairs))):
                raise ValueError("slabs must name every stage once")
            if any(s + 1 in slab for slab in self.slabs for s in slab):
                raise ValueError("stages that follow each other cannot share a slab")
            if not self.in_line(self.slabs):
                raise ValueError("a planetary stage stands between the gears of its two shafts")
        if any(not 1 <= p.shaft < len(self.shafts) for p in self.places):
            raise ValueError("a place is that of a shaft after the input shaft")
        if any(not 0 <= k < len(self.shafts) for k in self.level):
            raise ValueError("the split line names a shaft that there is not")
        ranges = [r for p in self.places for r in (p.y, p.z)]
        ranges += [r for k in self.keep_outs for r in (k.y, k.z, k.x)]
        if any(not low <= high for low, high in ranges):
            raise ValueError("the range of a place or keep-out ends before it starts")

    @property
    def axes(self) -> tuple[int, ...]:
        """The axis of every shaft, from 0: those of a planetary stage have one."""
        apart = (0, *(not isinstance(pair, Planetary) for pair in self.pairs))
        return tuple(accumulate(map(int, apart)))

    def in_line(self, slabs: tuple[tuple[int, ...], ...]) -> bool:
        """Whether no shaft of an order of slabs would pass through a planetary stage."""
        place = {stage: k for k, slab in enumerate(slabs) for stage in slab}
        steps = [place[k + 1] - place[k] for k in range(len(self.pairs) - 1)]
        turns = zip(self.pairs[1:], steps, steps[1:], strict=False)
        return all(a * b > 0 for pair, a, b in turns if isinstance(pair, Planetary))

    @property
    def unit(self) -> str:
        """Unit of the objective."""
        return (OBJECTIVES | SIDES)[self.objective]
