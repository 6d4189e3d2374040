"""[layout], [[place]] and [[keep_out]]: the box around a drive, and obstacles."""

import math
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from gearopt import units
from gearopt.formulations.drive.gearbox import (
    ANYWHERE,
    OBJECTIVES,
    Clearances,
    Gearbox,
    KeepOut,
    Place,
    Range,
    Shaft,
)
from gearopt.physics.gears import GearPair
from gearopt.physics.loads import torsion_diameter
from gearopt.scenes.reading.fields import (
    Reads,
    Table,
    choice,
    quantity,
    refuse,
    truth,
    whole,
    words,
)
from gearopt.scenes.reading.lists import several, span
from gearopt.scenes.reading.numbered_names import numbered
from gearopt.units import Quantity

if TYPE_CHECKING:
    from gearopt.scenes.drive.scene import Scene

CLEARANCE = quantity("length", "5 mm", zero=True)
PLACE = quantity("length", "0 mm", zero=True, signed=True)
SHAFT = whole(3, 1, 7)
STAGES = several(several(whole(1, 1, 6), [1]), [[1], [2]])

Length = Annotated[Quantity | None, quantity("length", "500 mm")]
Lengths = Annotated[
    tuple[Quantity, ...] | None,
    several(quantity("length", "30 mm"), ["20 mm", "35 mm", "60 mm"], in_order=True),
]
Bearings = Annotated[
    tuple[Quantity, ...] | None,
    several(quantity("length", "62 mm"), ["62 mm", "80 mm", "120 mm"], in_order=True),
]
Clearance = Annotated[Quantity, CLEARANCE]
Side = Annotated[tuple[Quantity, Quantity], span(PLACE, ["-300 mm", "-150 mm"])]
Where = Annotated[tuple[Quantity, Quantity] | None, span(PLACE, "0 mm", single=True)]


def _clear(text: str, description: str) -> Any:
    """Return a clearance with its default."""
    return Field(
        default_factory=lambda: units.parse(text, "length"),
        description=description,
        json_schema_extra={"default": text},
    )


def _whole_lists(reads: Reads, word: str | None = None) -> Reads:
    """Read a list that is corrected as a whole, for half of it means nothing; word: for None."""

    def read(value: Any, example: Any) -> Any:
        if word is not None and value == word:
            return None
        try:
            return reads.reader(value, reads.example)
        except PydanticCustomError as wrong:
            rule = (wrong.context or {})["rule"]
            close = word if isinstance(value, str) else None
            raise refuse(rule if word is None else f'{rule}, nor "{word}"', close) from None

    known: list[Any] = [] if word is None else [{"const": word}]
    return Reads(read, reads.example, {"anyOf": [*known, reads.schema]})


class Layout(Table):
    """The box around the gears: shafts, clearances, what to minimise; with it a drive is laid out.

    Shafts are counted from 1, the input shaft, to the output shaft; y (right) and z (up) lie across
    them, measured from the axis of the input shaft, x runs along them from the box's first face.
    """

    minimise: Annotated[str, choice(*OBJECTIVES)] = Field(
        "box_volume",
        description="box_volume, plan_area (width times length), face_area (width times height), "
        "height or longest_side of the box",
    )
    together: Annotated[bool, truth()] = Field(
        False, description="Choose teeth, modules and places together, for the smallest box"
    )
    shaft_diameters: Lengths = Field(
        None, description="Shaft diameters from the input to the output (or give shaft_stress)"
    )
    shaft_stress: Annotated[Quantity | None, quantity("stress", "40 MPa")] = Field(
        None, description="Torsional stress that gives each shaft its diameter instead"
    )
    bearing_diameters: Bearings = Field(
        None, description="Outer diameters of the bearings, one per shaft; with bearing_widths"
    )
    bearing_widths: Lengths = Field(None, description="Widths of the bearings, one per shaft")
    span: Annotated[str, choice("full", "partial")] = Field(
        "full",
        description="full: every shaft runs from wall to wall; partial: it ends beside its gears",
    )
    slabs: Annotated[Any, _whole_lists(STAGES, "best")] = Field(
        None,
        description='Stages of each slab along the shafts, such as [[1, 3], [2]], or "best"',
        json_schema_extra={"default": "best"},
    )
    gear_clearance: Clearance = _clear("5 mm", "Minimum distance between gears that do not mesh")
    shaft_clearance: Clearance = _clear(
        "2 mm", "Minimum distance of a shaft or bearing from other shafts, gears and keep-outs"
    )
    wall_clearance: Clearance = _clear(
        "10 mm", "Clearance from the gears to the box, across the shafts"
    )
    axial_clearance: Clearance = _clear(
        "10 mm", "Clearance between slabs, and from them to the box, along the shafts"
    )
    motor_diameter: Length = Field(
        None,
        description="A motor on the input shaft, outside the face where the output shaft leaves: "
        "the output shaft must pass it",
    )
    split_line: Annotated[tuple[int, ...] | None, _whole_lists(several(SHAFT, [1, 3]))] = Field(
        None, description="Shafts that lie on the level split line of the housing"
    )
    width: Length = Field(None, description="Width of the box, fixed")
    largest_width: Length = Field(None, description="Largest width of the box")
    largest_height: Length = Field(None, description="Largest height of the box")
    largest_length: Length = Field(None, description="Largest length of the box")

    @model_validator(mode="after")
    def _complete(self) -> "Layout":
        if self.shaft_diameters is None and self.shaft_stress is None:
            raise refuse(
                "is missing (or give shaft_diameters)", "40 MPa", ("shaft_stress",), "sample"
            )
        if self.shaft_diameters is not None and self.shaft_stress is not None:
            raise refuse("conflicts with shaft_diameters", at=("shaft_stress",), action="remove")
        for name, other in (("widths", "diameters"), ("diameters", "widths")):
            if getattr(self, f"bearing_{name}") and not getattr(self, f"bearing_{other}"):
                raise refuse(f"is missing beside bearing_{name}", at=(f"bearing_{other}",))
        if self.width and self.largest_width and self.width.value > self.largest_width.value:
            raise refuse("is above largest_width", str(self.largest_width), ("width",))
        for k, (shaft, outer) in enumerate(
            zip(self.shaft_diameters or (), self.bearing_diameters or (), strict=False)
        ):
            if outer.value < shaft.value:
                wider = [str(q) for q in self.bearing_diameters or ()]
                wider[k] = str(shaft)
                rule = f"has a bearing narrower than shaft {k + 1} ({shaft})"
                raise refuse(rule, wider, ("bearing_diameters",))
        if self.split_line is not None and len(set(self.split_line)) < 2:
            raise refuse("names fewer than two shafts", [1, 2], ("split_line",), "sample")
        return self

    def check(self, counts: tuple[int, ...]) -> None:
        """Check that every list fits a drive of these numbers of stages, ascending.

        Places count from the file.
        """
        stages, several = counts[0], len(counts) > 1
        shafts = stages + 1
        for name in ("shaft_diameters", "bearing_diameters", "bearing_widths", "slabs"):
            if several and getattr(self, name) is not None:
                other = "give shaft_stress instead" if name == "shaft_diameters" else "leave it out"
                rule = "is a list for one number of stages, and stages is a range"
                remedy = f"Write stages = {stages}, or {other}"
                raise refuse(rule, remedy, ("layout", name), "tell")
        for name in ("shaft_diameters", "bearing_diameters", "bearing_widths"):
            values = getattr(self, name)
            if values is not None and len(values) != shafts:
                texts = [str(q) for q in values]
                fit = (texts + texts[-1:] * shafts)[:shafts]
                of = f"a drive of {stages} stage{'s' * (stages > 1)}"
                rule = f"names {len(values)} shafts; {of} has {shafts}"
                raise refuse(rule, fit, ("layout", name), "sample")
        if self.split_line is not None and several:
            check_shared(max(self.split_line), counts, ("layout", "split_line"))
        elif self.split_line is not None and max(self.split_line) > shafts:
            raise refuse(
                f"names a shaft above {shafts}", [1, shafts], ("layout", "split_line"), "sample"
            )
        if self.slabs is not None:
            self._check_slabs(stages)

    def _check_slabs(self, stages: int) -> None:
        right = [[k] for k in range(1, stages + 1)]
        if sorted(s for slab in self.slabs for s in slab) != list(range(1, stages + 1)):
            rule = f"does not name each of the {stages} stages once"
            raise refuse(rule, right, ("layout", "slabs"), "sample")
        for slab in self.slabs:
            ordered = sorted(slab)
            if any(b - a == 1 for a, b in zip(ordered, ordered[1:], strict=False)):
                rule = "puts stages that share a shaft into one slab"
                raise refuse(rule, right, ("layout", "slabs"), "sample")


def check_layout(scene: "Scene") -> None:
    """Check the tables of a layout against the drive and each other."""
    if scene.layout is None:
        for name in ("place", "keep_out"):
            if getattr(scene, name):
                raise refuse("needs a table [layout]", at=(name,), action="remove")
        return
    scene.layout.check(scene.counts)
    last = scene.counts[0] + 1
    for k, place in enumerate(scene.place):
        at = ("place", k, "shaft")
        if scene.several:
            check_shared(place.shaft, scene.counts, at)
        elif place.shaft > last:
            raise refuse(f"is above {last}, the output shaft", last, at, "sample")
        elif scene.limits.coaxial and place.shaft == last:
            rule = "is the output shaft, which coaxial = true puts in line with the input"
            raise refuse(rule, at=("place", k), action="remove")
    if scene.layout.together and scene.teeth is None:
        raise refuse("needs a table [teeth]", False, ("layout", "together"))


def check_shared(shaft: int, counts: tuple[int, ...], at: tuple[str | int, ...]) -> None:
    """Check that a shaft is the input shaft or an intermediate one with every number of stages."""
    if shaft > counts[0]:
        fewest = "one stage" if counts[0] == 1 else f"{counts[0]} stages"
        rule = (
            "is for one number of stages, and stages is a range: shaft "
            f"{shaft} is no intermediate shaft of a drive of {fewest}"
        )
        out = "the place" if at[0] == "place" else "it"
        raise refuse(rule, f"Write stages = {shaft - 1}, or leave {out} out", at, "tell")


class PlaceTable(Table):
    """Where the axis of a shaft must be, measured from that of the input shaft; needs [layout]."""

    shaft: Annotated[int, whole(3, 2, 7)] = Field(
        description="Which shaft; the output shaft of a drive of N stages is N + 1"
    )
    y: Where = Field(None, description="To the right of the input shaft: a place or a range")
    z: Where = Field(None, description="Above the input shaft: a place or a range")
    tolerance: Clearance = _clear("0.01 mm", "Permissible deviation from y and z")

    @model_validator(mode="after")
    def _somewhere(self) -> "PlaceTable":
        if self.y is None and self.z is None:
            raise refuse("is missing (or give z)", at=("y",))
        return self

    def place(self) -> Place:
        """Return the place in plain numbers."""
        return Place(self.shaft - 1, self._range(self.y), self._range(self.z))

    def _range(self, ends: tuple[Quantity, Quantity] | None) -> Range:
        if ends is None:
            return ANYWHERE
        return ends[0].value - self.tolerance.value, ends[1].value + self.tolerance.value


class KeepOutTable(Table):
    """A box that nothing on the shafts may enter; needs [layout]."""

    name: Annotated[str, words()] = Field("", description="Name of the keep-out in messages")
    y: Side = Field(description="From left to right of the input shaft's axis")
    z: Side = Field(description="From below to above the input shaft's axis")
    x: Annotated[tuple[Quantity, Quantity] | None, span(PLACE, ["0 mm", "80 mm"])] = Field(
        None,
        description="Along the shafts from the first face of the box; by default the whole length",
    )

    def keep_out(self, name: str) -> KeepOut:
        """Return the keep-out in plain numbers, by a name of its own."""
        y, z = ((side[0].value, side[1].value) for side in (self.y, self.z))
        x = ANYWHERE if self.x is None else (self.x[0].value, self.x[1].value)
        return KeepOut(name, y, z, x)


def gearbox(
    table: Layout,
    places: tuple[PlaceTable, ...],
    keep_outs: tuple[KeepOutTable, ...],
    torque: float,
    pairs: tuple[GearPair, ...],
) -> Gearbox:
    """Drive of gear pairs, to be laid out; torque: at the input shaft [N mm]."""
    torques = [torque]
    for pair in pairs:
        torques.append(torques[-1] * pair.ratio)
    names = numbered([k.name or f"keep-out {n}" for n, k in enumerate(keep_outs, 1)])
    wide, high, long = (
        q.value if q else math.inf
        for q in (table.largest_width, table.largest_height, table.largest_length)
    )
    return Gearbox(
        pairs,
        _shafts(table, torques),
        Clearances(
            table.gear_clearance.value,
            table.shaft_clearance.value,
            table.wall_clearance.value,
            table.axial_clearance.value,
        ),
        table.span == "partial",
        table.slabs and tuple(tuple(s - 1 for s in slab) for slab in table.slabs),
        tuple(k.keep_out(name) for k, name in zip(keep_outs, names, strict=True)),
        0.5 * table.motor_diameter.value if table.motor_diameter else 0.0,
        tuple(p.place() for p in places),
        tuple(sorted({s - 1 for s in table.split_line or ()})),
        table.minimise,
        table.width.value if table.width else None,
        (wide, high, long),
    )


def _shafts(table: Layout, torques: list[float]) -> tuple[Shaft, ...]:
    if table.shaft_diameters is not None:
        diameters = [q.value for q in table.shaft_diameters]
    else:
        assert table.shaft_stress is not None
        diameters = [torsion_diameter(t, table.shaft_stress.value) for t in torques]
    if not (table.bearing_diameters and table.bearing_widths):
        return tuple(Shaft(0.5 * d) for d in diameters)
    bearings = zip(table.bearing_diameters, table.bearing_widths, strict=True)
    return tuple(
        Shaft(0.5 * d, 0.5 * outer.value, wide.value)
        for d, (outer, wide) in zip(diameters, bearings, strict=True)
    )
