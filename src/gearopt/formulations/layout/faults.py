"""Data checks: what no angles can mend, found before any search and told in numbers."""

import math
from collections.abc import Iterator

from gearopt.formulations.layout.gearbox import ANYWHERE, Gearbox, KeepOut, Place
from gearopt.formulations.layout.slabs import (
    Arrangement,
    Clash,
    arrange,
    arrangements,
    clashes,
    orders,
)

TOUCH = 1e-6  # mm; by which a place may be out of reach


def faults(box: Gearbox) -> list[str]:
    """Sentences about what is too close, too long, or out of reach; empty if nothing is."""
    found = [*_fixed(box), *_reach(box)]
    one = arrangements(box)[0]
    if clashes(box, one) or one.length > box.largest[2] * (1.0 + 1e-9):
        found += _axial(box)
    return found


def _axial(box: Gearbox) -> list[str]:
    """What every order of slabs lacks: that of the order which lacks least."""
    every = [arrange(box, s) for s in ([box.slabs] if box.slabs is not None else orders(box))]
    clear = [one for one in every if not clashes(box, one)]
    if clear:
        shortest, most = min(one.length for one in clear), f"{box.largest[2]:.7g} mm"
        return [f"The box is at least {shortest:.2f} mm long, and may be {most} at most."]

    def worst(one: Arrangement) -> float:
        return clashes(box, one)[0].short

    return [_sentence(clash) for clash in clashes(box, min(every, key=worst))]


def _fixed(box: Gearbox) -> Iterator[str]:
    """What stands on the input shaft against keep-outs: both are where they are."""
    one = arrangements(box)[0]
    for k, keep in enumerate(box.keep_outs):
        there, need = _distance(keep), float(one.keep_apart[k, 0])
        if need - there > TOUCH:
            yield (
                f"What stands on the input shaft is {need - there:.2f} mm too close to "
                f"{keep.name}: its axis is {there:.2f} mm from it and needs {need:.2f} mm."
            )
        if keep.x == ANYWHERE and box.motor - there > TOUCH:
            yield f"The motor reaches {box.motor - there:.2f} mm into {keep.name}."


def _distance(keep: KeepOut) -> float:
    """From the axis of the input shaft."""
    return math.hypot(
        max(keep.y[0], -keep.y[1], 0.0),
        max(keep.z[0], -keep.z[1], 0.0),
    )


def _reach(box: Gearbox) -> Iterator[str]:
    """Places that the links between two shafts cannot span, or that exclude each other."""
    given = [Place(0, (0.0, 0.0), (0.0, 0.0)), *box.places]
    for n, b in enumerate(given):
        for a in given[:n]:
            first, last = sorted((a.shaft, b.shaft))
            links = [p.centre_distance for p in box.pairs[first:last]]
            near, far = _between(a, b)
            reach = sum(links)
            least = max(0.0, 2.0 * max(links, default=0.0) - reach)
            who = f"The places of shafts {a.shaft + 1} and {b.shaft + 1}"
            if a.shaft == b.shaft and near > TOUCH:
                yield f"Two places of shaft {a.shaft + 1} are {near:.2f} mm apart."
            elif near > reach + TOUCH and links:
                yield (
                    f"{who} are at least {near:.2f} mm apart; the centre distances between them "
                    f"reach {reach:.2f} mm."
                )
            elif far < least - TOUCH:
                yield (
                    f"{who} are at most {far:.2f} mm apart; the centre distances between them "
                    f"keep them {least:.2f} mm apart."
                )


def _between(a: Place, b: Place) -> tuple[float, float]:
    """Least and largest distance of two places."""
    near, far = [], []
    for p, q in ((a.y, b.y), (a.z, b.z)):
        near.append(max(p[0] - q[1], q[0] - p[1], 0.0))
        far.append(max(p[1] - q[0], q[1] - p[0]))
    return math.hypot(*near), math.hypot(*far)


def _sentence(clash: Clash) -> str:
    """What two axes lack, in numbers: `wheel 1 and shaft 3 ...`."""
    first, last = clash.need.between
    a, b = (k + 1 for k in clash.shafts)
    between = f"stage {a}" if b == a + 1 else f"stages {a} to {b - 1} in one line"
    radii = clash.need.distance - clash.need.clearance
    return (
        f"{first[0].upper()}{first[1:]} and {last} are {clash.short:.2f} mm too close: the axes of "
        f"shafts {a} and {b} are at most {clash.there:.2f} mm apart (centre distance of {between}) "
        f"and need {clash.need.distance:.2f} mm ({radii:.2f} for both radii, "
        f"{clash.need.clearance:g} clearance)."
    )
