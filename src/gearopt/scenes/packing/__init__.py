"""kind = "packing": cylinders with parallel axes in the smallest container, in one or more layers.

Places are searched by annealing and Ipopt; the bound is computed, and proves the packing where it
is met.
"""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from typing import Annotated, Any

from pydantic import Field, model_validator

from gearopt import units
from gearopt.formulations import packing
from gearopt.formulations.packing import packing_text
from gearopt.formulations.packing.container_bound import bound
from gearopt.formulations.packing.design import describe, packing_design, places
from gearopt.formulations.packing.plan import (
    OBJECTIVES,
    SHAPES,
    Cylinder,
    Plan,
    minimum_layers,
    overlap,
)
from gearopt.formulations.packing.sa import lateness, ready
from gearopt.optimise.certificate import reconcile
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock, in_part, of_others
from gearopt.optimise.comparing.plan import Model
from gearopt.optimise.explaining.explanation import Explanation
from gearopt.optimise.explaining.repair import CERTAIN
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result
from gearopt.optimise.solve import solve_within
from gearopt.optimise.typed import untyped
from gearopt.scenes.explaining.explanations import at_point, eases, of_design
from gearopt.scenes.explaining.influences import SMALL_CHANGES, Basis
from gearopt.scenes.explaining.numbers import rounded
from gearopt.scenes.kind import Kind, examples_in
from gearopt.scenes.plan import Step, carried_out
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.fields import ProblemFile, Table, choice, quantity, refuse, whole, words
from gearopt.scenes.reading.lists import pair
from gearopt.scenes.reading.numbered_names import numbered
from gearopt.scenes.reading.toml_writing import dotted
from gearopt.units import Quantity

METHODS = ("hop", "sa")  # its own
MAX_CYLINDERS = 50  # their 1,225 pairs take two seconds to trace, once
LENGTH = quantity("length", "20 mm")
CLEARANCE = quantity("length", "0 mm", zero=True)
PLACE = pair(quantity("length", "10 mm", zero=True, signed=True))
NONE = units.parse("0 mm", "length")
SMOOTH = ("ipopt", "multistart")  # methods that need derivatives
BOUND_SECONDS = 0.1  # seconds for a bound after a run that has spent all of its time
FOLLOWED = f"sensitivities are those of this arrangement, {SMALL_CHANGES}"
UNTRIED = "whole numbers are not tried, because the packing is not proven to be the best"
UNPROVEN = "Best found, not proven: a smaller packing may exist, but none below the bound."


class CylinderTable(Table):
    """One or more cylinders of a size, with upright axes."""

    diameter: Annotated[Quantity, LENGTH] = Field(description="Diameter of the cylinder")
    height: Annotated[Quantity, quantity("length", "10 mm")] = Field(
        description="Height of the cylinder, along its axis"
    )
    count: Annotated[int, whole(1, 1, MAX_CYLINDERS)] = Field(1, description="How many of them")
    name: Annotated[str, words()] = Field("", description="What the report calls it")
    at: Annotated[tuple[Quantity, Quantity] | None, PLACE] = Field(
        None, description="Fixed place [x, y] of the axis, from an origin of your choice"
    )
    layer: Annotated[int | None, whole(1, 1, MAX_CYLINDERS)] = Field(
        None,
        description="Fixed layer, counted from the floor: 1 is the lowest, and every layer below "
        "it holds a cylinder",
    )


class Container(Table):
    """The container, whose volume or area is minimised."""

    shape: Annotated[str, choice(*SHAPES)] = Field(
        "rectangle", description="Plan of the container: rectangle, square or circle"
    )
    width: Annotated[Quantity | None, LENGTH] = Field(
        None, description="Fixed width (x) of a rectangle; without it both sides are free"
    )
    gap: Annotated[Quantity, CLEARANCE] = Field(
        NONE,
        description="Minimum clearance between cylinders of a layer",
        json_schema_extra={"default": "0 mm"},
    )
    wall: Annotated[Quantity, CLEARANCE] = Field(
        NONE,
        description="Minimum clearance to the container's side",
        json_schema_extra={"default": "0 mm"},
    )


class Layers(Table):
    """How many layers; one without this table. A layer is as high as its highest cylinder."""

    most: Annotated[int | None, whole(2, 1, MAX_CYLINDERS)] = Field(
        None, description="At most this many layers (or give exactly)"
    )
    exactly: Annotated[int | None, whole(2, 1, MAX_CYLINDERS)] = Field(
        None, description="Exactly this many layers, each with a cylinder"
    )

    @model_validator(mode="after")
    def _one(self) -> "Layers":
        if self.most is not None and self.exactly is not None:
            raise refuse("conflicts with exactly, which sets it", at=("most",), action="remove")
        if self.most is None and self.exactly is None:
            raise refuse("is missing (or give exactly)", at=("most",))
        return self


class Aim(Table):
    """What to minimise."""

    minimise: Annotated[str, choice(*OBJECTIVES)] = Field(
        "volume", description="volume of the container, or area of its plan"
    )


class Scene(ProblemFile):
    """A packing."""

    cylinder: tuple[CylinderTable, ...] = Field(description="One table per size or place")
    container: Container = Field(default_factory=Container)
    layers: Layers = Field(default_factory=lambda: Layers(most=1))
    objective: Aim = Field(default_factory=Aim)

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        if not self.cylinder:
            raise refuse("is missing: one table [[cylinder]] per size", at=("cylinder",))
        for k, table in enumerate(self.cylinder):
            if table.at is not None and table.count > 1:
                rule = "cannot be combined with at, which places one cylinder"
                raise refuse(rule, 1, ("cylinder", k, "count"))
            if table.layer is not None and table.layer > self._max_layers:
                rule = f"is above the {self._max_layers} of [layers]"
                raise refuse(rule, self._layer_for(k), ("cylinder", k, "layer"))
        if all(cylinder.at is not None for cylinder in self.cylinder):
            rule = "fixes the last free cylinder: nothing is left to place"
            raise refuse(rule, at=("cylinder", len(self.cylinder) - 1, "at"), action="remove")
        total = sum(cylinder.count for cylinder in self.cylinder)
        if total > MAX_CYLINDERS:
            most = max(range(len(self.cylinder)), key=lambda k: self.cylinder[k].count)
            rule = f"makes {total} cylinders; at most {MAX_CYLINDERS} can be packed"
            left = max(1, self.cylinder[most].count - (total - MAX_CYLINDERS))
            raise refuse(rule, left, ("cylinder", most, "count"))
        self._check_layers()
        self._check_container()
        self._check_places()
        return self

    @property
    def _max_layers(self) -> int:
        return self.layers.exactly or self.layers.most or 1

    def _layer_for(self, k: int) -> int:
        """Return the highest layer for a cylinder that leaves none empty; else the top."""
        movable = sum(cylinder.count for cylinder in self.cylinder if cylinder.layer is None)
        others = {
            cylinder.layer for j, cylinder in enumerate(self.cylinder) if cylinder.layer and j != k
        }
        for layer in range(self._max_layers, 0, -1):
            given = others | {layer}
            if max(self.layers.exactly or 0, *given) <= len(given) + movable:
                return layer
        return self._max_layers

    def _check_layers(self) -> None:
        """Check that no layer that must hold a cylinder stays empty."""
        exactly = self.layers.exactly or 0
        given = {cylinder.layer for cylinder in self.cylinder if cylinder.layer is not None}
        movable = sum(cylinder.count for cylinder in self.cylinder if cylinder.layer is None)
        filled, top = len(given) + movable, max(given, default=0)
        if max(exactly, top) <= filled:
            return
        rule = f"leaves a layer empty: only {movable} cylinders are free to fill layers"
        edits: dict[tuple[str | int, ...], int] = _lowered(self.cylinder, filled)
        place: tuple[str | int, ...] = ("layers", "exactly")
        if exactly > filled:
            edits = {place: filled} | edits
        else:
            place = ("cylinder", next(k for k, c in enumerate(self.cylinder) if c.layer == top))
            place, rule = (*place, "layer"), f"{rule}, and every layer below it must be filled"
        if len(edits) == 1:
            raise refuse(rule, edits[place], place)
        together = [f"{dotted(key)} = {layer}" for key, layer in edits.items()]
        write = f"Write {', '.join(together[:-1])} and {together[-1]}, all of them"
        raise refuse(rule, write, place, "tell")

    def _check_container(self) -> None:
        """Check that a given width holds the widest cylinder, and all that are fixed."""
        width, wall = self.container.width, self.container.wall.value
        if width is None:
            return
        if self.container.shape != "rectangle":
            rule = f"is for a rectangle, not for a {self.container.shape}"
            raise refuse(rule, at=("container", "width"), action="remove")
        widest = max(cylinder.diameter.value for cylinder in self.cylinder)
        fixed = [
            (cylinder.at[0].value, cylinder.diameter.value / 2)
            for cylinder in self.cylinder
            if cylinder.at
        ]
        span = max((x + r for x, r in fixed), default=0) - min((x - r for x, r in fixed), default=0)
        for size, what in ((widest, "the widest cylinder"), (span, "the fixed cylinders")):
            if width.value < (size + 2.0 * wall) * (1.0 - 1e-12):
                need = rounded(size + 2.0 * wall, width, 1.0)
                rule = f"is too narrow: {what} with the clearance to the sides needs {need}"
                raise refuse(rule, need, ("container", "width"))

    def _check_places(self) -> None:
        """Check that fixed cylinders that must share a layer do not overlap."""
        plan = self.plan()
        where = [k for k, cylinder in enumerate(self.cylinder) for _ in range(cylinder.count)]
        for i, j in combinations(plan.fixed, 2):
            same = (
                plan.max_layers == 1
                or plan.cylinders[i].layer == plan.cylinders[j].layer is not None
            )
            missing, at = overlap(plan, i, j), self.cylinder[where[j]].at
            if same and missing and at:
                names = " and ".join(plan.cylinders[k].name for k in (j, i))
                short = f"{float(at[0].of(Fraction(missing)).number):.4g} {at[0].unit}"
                rule = f"is too near: the gap between {names} is {short} too small"
                raise refuse(rule, _away(plan, i, j, at), ("cylinder", where[j], "at"))
        need = minimum_layers(plan)
        if need > plan.max_layers:
            key = "most" if self.layers.exactly is None else "exactly"
            rule = f"is too few: fixed cylinders overlap in plan and need {need} layers"
            raise refuse(rule, need, ("layers", key))

    def plan(self) -> Plan:
        """Return the packing as plain numbers."""
        cylinders: list[Cylinder] = []
        stems = [t.name or f"d {t.diameter}" for t in self.cylinder for _ in range(t.count)]
        names = numbered(stems)
        for table in self.cylinder:
            place = None if table.at is None else (table.at[0].value, table.at[1].value)
            size = (table.diameter.value / 2.0, table.height.value, place, table.layer)
            cylinders += [Cylinder(next(names), *size) for _ in range(table.count)]
        width = self.container.width
        return Plan(
            cylinders=tuple(cylinders),
            shape=self.container.shape,
            width=None if width is None else width.value,
            gap=self.container.gap.value,
            wall=self.container.wall.value,
            min_layers=self.layers.exactly or 1,
            max_layers=self._max_layers,
            objective=self.objective.minimise,
        )


def _lowered(cylinders: tuple[CylinderTable, ...], most: int) -> dict[tuple[str | int, ...], int]:
    """Return the layers to write for cylinders whose own is above `most`: the highest free ones.

    Cylinders that share a layer still do, and no others.
    """
    given = {cylinder.layer for cylinder in cylinders if cylinder.layer is not None}
    free = [layer for layer in range(1, most + 1) if layer not in given]
    above = sorted(layer for layer in given if layer > most)
    new = dict(zip(above, free[len(free) - len(above) :], strict=True))
    return {
        ("cylinder", k, "layer"): new[cylinder.layer]
        for k, cylinder in enumerate(cylinders)
        if cylinder.layer in new
    }


def _away(plan: Plan, i: int, j: int, at: tuple[Quantity, Quantity]) -> list[str]:
    """Return the nearest place of cylinder j, on the line of both axes, that is clear of i.

    at: its place in the file, whose units are kept.
    """
    (a, b), (c, d) = plan.cylinders[i].at or (0.0, 0.0), plan.cylinders[j].at or (0.0, 0.0)
    far = math.hypot(c - a, d - b)
    u, v = ((c - a) / far, (d - b) / far) if far > 0 else (1.0, 0.0)

    need = plan.apart(i, j)
    return [rounded(a + need * u, at[0], u), rounded(b + need * v, at[1], v)]


def assumptions(scene: Scene) -> list[str]:
    """Return the assumptions of a packing."""
    size = "Cylinders are rigid, upright and of their nominal size"
    return [f"{size}; they may touch each other and walls."]


def steps(scene: Scene, ask: Ask) -> tuple[Step[Scene], ...]:
    """Packing by a method, then the bound of a packing that brings none."""
    return Step(packed), Step(bounded)


def packed(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Cylinders packed by the method that is asked for."""
    plan = scene.plan()
    problem = _problem(plan, ask.method)
    if ask.method in (None, *problem.methods):
        ready(ask.watch)
    watch = in_part(ask.watch, plan.unit())
    result, outcome = run(problem, ask.method, ask.budget, ask.seed, watch, ask.gap)
    result = replace(result, objective=result.objective | {"unit": plan.unit()})
    if result.value is None or outcome.x is None:
        return result
    design = describe(plan, packing_text.places(plan, problem, outcome.x))
    return replace(result, design=untyped(design))


def bounded(scene: Scene, ask: Ask, known: Result | None) -> Result:
    """Packing with the computed bound of its plan, in the time left, or BOUND_SECONDS."""
    assert known is not None
    report: dict[str, Any] = {"assumptions": assumptions(scene)}
    if known.bound is None:
        plan, left = scene.plan(), ask.budget.seconds
        clock = Clock(Budget(), in_part(ask.watch, plan.unit()))
        clock.evaluations, clock.best = known.evaluations, known.value or math.inf
        floor = bound(plan, lateness(clock, None if left is None else max(left, BOUND_SECONDS)))
        relaxation = replace(known, objective={"value": None}, bound=floor.value)
        relaxation = replace(relaxation, status="feasible", proof=packing.proof(floor))
        known = reconcile(known, relaxation, ask.gap)
    if known.status != "optimal":
        report["notes"] = [UNPROVEN]
    return replace(known, report=report)


def influences(scene: Scene, ask: Ask, result: Result) -> Explanation:
    """Sensitivity of the packing to every number, with its layers and contacts held.

    Solved again from the packing itself, which is followed; whole numbers are packed again.
    """
    clock = Clock(ask.budget, of_others(ask.watch))
    if result.value is None:
        return Explanation(result, message="no packing was found in time", seconds=clock.seconds)
    positions = places(packing_design(result.design))
    layers, x = positions.layer, packing_text.point_of_packing(scene.plan(), positions)

    def posed(other: Scene) -> Problem:
        return packing_text.smooth(other.plan(), layers).starting(x)

    def packed(other: Scene) -> float | None:
        if result.status not in CERTAIN:  # a difference to what is not the best means nothing
            return None
        asked = replace(ask, budget=clock.left, watch=clock.watch)
        again = carried_out(steps(other, asked), other, asked)
        return again.value if again.status in CERTAIN else None

    def followed(other: Scene) -> float | None:
        return solve_within(clock, posed(other), "ipopt").value

    if clock.over:  # a problem of many cylinders takes longer to pose than most budgets
        return of_design(scene, result, clock, Basis(result.value, followed), packed, "", {})
    basis = at_point(result.value, followed, posed, scene, x)
    note = FOLLOWED if result.status in CERTAIN else f"{FOLLOWED}; {UNTRIED}"
    return of_design(scene, result, clock, basis, packed, note, eases(posed(scene)))


def methods_to_compare(scene: Scene) -> tuple[str, ...]:
    """Return the methods of a comparison that names none."""
    return ("hop", "sa", "multistart", "annealing", "nsga2")


def posed(scene: Scene, method: str) -> Model:
    """Return the problem that a method solves, without a bound that proves nothing."""
    plan = scene.plan()
    words = f"Places{' and layers' * bool(plan.free_layers)} of the cylinders"
    return Model(_problem(plan, method, loose=False), words, plan.unit())


def _problem(plan: Plan, method: str | None, loose: bool = True) -> Problem:
    if method in SMOOTH:
        return packing_text.smooth(plan)
    return packing.problem(plan, loose)


ABOUT = {  # files in examples, that of the kind first
    "packing": "cylinders with parallel axes in the smallest container, in one or more layers",
}
KIND = Kind(
    scene=Scene,
    examples=examples_in(__file__, ABOUT),
    steps=steps,
    posed=posed,
    methods_to_compare=methods_to_compare,
    methods=METHODS,
    influences=influences,
    assumptions=assumptions,
)
