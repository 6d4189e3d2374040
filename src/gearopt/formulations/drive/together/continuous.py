"""Sizes and layout at once with real-valued teeth, modules and widths: a smooth problem for Ipopt.

One order of slabs, and a start: gears with their layout. What whole teeth and standard modules cost
is the difference to `exact`; being nonconvex it has local optima and no bound.
"""

import math
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.formulations.drive import sizing_text
from gearopt.formulations.drive.gearbox import ANYWHERE, Gearbox
from gearopt.formulations.drive.layout.chain import chain
from gearopt.formulations.drive.layout.layout_text import given_places, outside, placed_by, sides
from gearopt.formulations.drive.layout.slabs import (
    Arrangement,
    Body,
    Slabs,
    arrange,
    face_each_other,
)
from gearopt.formulations.drive.together.tables import Make
from gearopt.formulations.drive.train import Train
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Array, Terms, Var, each
from gearopt.physics.gears import GearPair

PLACES_SPAN = 2.0  # times the sum of the start's sides: within this they are searched
# rad from the start's angles; else the interior point is pushed into worse basins
ANGLES_SPAN = 0.6

Facing = list[tuple[int, int, Body, Body]]


def problem(
    train: Train, make: Make, slabs: Slabs, start: tuple[tuple[GearPair, ...], tuple[float, ...]]
) -> Problem:
    """Pose the smallest box over real-valued sizes and link angles: a smooth problem.

    Variables: of `sizing_text`, angle [rad], left, bottom, width, height and the slabs' widths.
    start: gear pairs and link angles. SolveError for keep-outs with a range along the shafts.
    """
    box = make(start[0])
    if any(k.x != ANYWHERE for k in box.keep_outs):
        raise SolveError("a keep-out with a range x along the shafts is for exact alone")
    order = arrange(box, slabs)
    shape = chain(box, (order,))
    facing = _facing_bodies(order)
    sized = sizing_text.exact_text(train)
    round_it = sides(shape, *placed_by([p.centre_distance for p in box.pairs], start[1]))
    variables = _variables(sized, box, slabs, start[1], round_it)

    def evaluate(x: Any, p: Any) -> Terms:
        terms = sized.evaluate(x, p)
        there = make(sizing_text.text_pairs(train, x, p))
        y, z = placed_by([pair.centre_distance for pair in there.pairs], each(x.angle))
        rows = _walls(there, order.bodies, (y, z), x)
        rows |= {
            f"slab[{n + 1}][{s + 1}]": there.pairs[s].face_width / each(x.slab)[n]
            for n, slab in enumerate(slabs)
            for s in slab
        }
        ends = order.length - sum(max(box.pairs[s].face_width for s in slab) for slab in slabs)
        length = ends + sum(each(x.slab))
        edges = {"width": x.width, "height": x.height, "length": length}
        limits, equal = given_places(shape, y, z)
        limits |= _clearance_rows(there, facing, (y, z)) | _keep_out_rows(
            there, order.bodies, (y, z)
        )
        for (name, side), maximum in zip(edges.items(), there.largest, strict=True):
            if math.isfinite(maximum):
                limits[f"largest_{name}"] = side / maximum
        if there.width is not None:
            limits["given_width"] = x.width / there.width
        if there.objective == "longest_side":
            rows |= {f"{n}_below": v / x.longest for n, v in edges.items()}
        return Terms(
            {there.objective: _objective(there, edges, x)},
            {**terms.limits, **limits},
            rows,
            {**terms.equal, **equal},
        )

    return Problem("together", variables, sized.parameters, evaluate)


def _facing_bodies(order: Arrangement) -> Facing:
    """Return the bodies of different shafts that face each other, with their shafts."""
    return [
        (i, j, p, q)
        for (i, own), (j, other) in combinations(enumerate(order.bodies), 2)
        for p in own
        for q in other
        if face_each_other(p, q)
    ]


def _variables(
    sized: Problem, box: Gearbox, slabs: Slabs, angles: tuple[float, ...], sides: dict[str, float]
) -> tuple[Var, ...]:
    """Return the variables with the start, and the box around it, as their guess."""
    values = {
        "module": [p.normal_module for p in box.pairs],
        "pinion_teeth": [p.pinion_teeth for p in box.pairs],
        "ratio": [p.ratio for p in box.pairs],
        "face_width": [p.face_width for p in box.pairs],
    }
    sizing = tuple(
        replace(v, guess=tuple(np.clip(values[v.name], v.lower, v.upper))) for v in sized.variables
    )
    links = [p.centre_distance for p in box.pairs]
    widths = tuple(max(box.pairs[s].face_width for s in slab) for slab in slabs)
    far = PLACES_SPAN * (sides["width"] + sides["height"] + sum(widths))
    near = (tuple(t - ANGLES_SPAN for t in angles), tuple(t + ANGLES_SPAN for t in angles))
    placing = [Var("angle", "rad", *near, angles, len(links), search=True)]
    placing += [Var(n, "mm", -far, 0.0, sides[n], search=True) for n in ("left", "bottom")]
    placing += [
        Var(n, "mm", 1e-3 * far, far, sides[n], log=True, search=True) for n in ("width", "height")
    ]
    slab = Var("slab", "mm", 1e-4 * far, far, widths, len(slabs), log=True, search=True)
    longest = Var("longest", "mm", 1e-3 * far, far, 0.5 * far, log=True, search=True)
    return (*sizing, *placing, slab, *([longest] if box.objective == "longest_side" else []))


def _radius(box: Gearbox, body: Body, k: int) -> Any:
    """Return the radius of a body of shaft k in a gearbox of other sizes."""
    if body.gear:
        return 0.5 * getattr(box.pairs[body.stage], body.name.split()[0]).tip_diameter
    shaft = box.shafts[k]
    return shaft.bearing_radius if body.name.startswith("bearing") else shaft.radius


def _walls(box: Gearbox, bodies: Any, point: Any, x: Any) -> dict[str, Any]:
    """Return rows that keep every body within the four sides."""
    rows: dict[str, Any] = {}
    for k, of_shaft in enumerate(bodies):
        for n, body in enumerate(of_shaft):
            r = _radius(box, body, k) + box.clearances.wall
            for axis, start, side in ((0, x.left, x.width), (1, x.bottom, x.height)):
                c, word = point[axis][k], "yz"[axis]
                rows[f"low_{word}[{k + 1}][{n + 1}]"] = 1.0 + (start - (c - r)) / side
                rows[f"high_{word}[{k + 1}][{n + 1}]"] = 1.0 + (c + r - start - side) / side
    return rows


def _clearance_rows(box: Gearbox, facing: Facing, point: Any) -> dict[str, Any]:
    """Return rows that keep the clearances of bodies that face each other and of the motor."""
    y, z = point
    rows: dict[str, Any] = {}

    def apart(name: str, i: int, j: int, need: Any) -> None:
        there = (y[i] - y[j]) ** 2 + (z[i] - z[j]) ** 2
        rows[name] = 2.0 - there / need**2

    for i, j, p, q in facing:
        gap = box.clearances.gears if p.gear and q.gear else box.clearances.shafts
        name = f"{p.name}_to_{q.name}".replace(" ", "_")
        apart(name, i, j, _radius(box, p, i) + _radius(box, q, j) + gap)
    if box.motor > 0:
        need = box.motor + box.shafts[-1].radius + box.clearances.shafts
        apart("motor_to_output", 0, len(box.shafts) - 1, need)
    return rows


def _keep_out_rows(box: Gearbox, bodies: Any, point: Any) -> dict[str, Any]:
    """Return rows that keep every body clear of every keep-out."""
    y, z = point
    rows: dict[str, Any] = {}
    for n, keep in enumerate(box.keep_outs):
        for k, of_shaft in enumerate(bodies):
            dy, dz = outside(y[k], *keep.y), outside(z[k], *keep.z)
            for b, body in enumerate(of_shaft):
                need = _radius(box, body, k) + box.clearances.shafts
                name = f"clear_of_keep_out[{n + 1}][{k + 1}][{b + 1}]"
                rows[name] = 2.0 - (dy**2 + dz**2) / need**2
    return rows


def _objective(box: Gearbox, sides: dict[str, Any], x: Any) -> Any:
    width = sides["width"] if box.width is None else box.width
    if box.objective == "longest_side":
        return x.longest
    return {
        "box_volume": width * sides["height"] * sides["length"],
        "plan_area": width * sides["length"],
        "face_area": width * sides["height"],
        "height": sides["height"],
    }[box.objective]


def laid_out(
    train: Train, make: Make, slabs: Slabs, x: Array
) -> tuple[Gearbox, tuple[float, ...], Arrangement]:
    """Gearbox of a point of `problem`, its link angles [rad] and arrangement of slabs."""
    count = sum(v.size for v in sizing_text.exact_text(train).variables)
    box = make(sizing_text.pairs(train, x[:count]))
    angles = x[count : count + len(train.stages)]
    return box, tuple(float(t) for t in angles), arrange(box, slabs)
