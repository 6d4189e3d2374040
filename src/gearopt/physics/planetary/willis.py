"""Ratio and efficiency of one or two sets of sun, planets, ring and carrier in closed form.

Willis: n_s + r n_r = (1 + r) n_c, with r = z_r/z_s, of stepped planets z_p1 z_r/(z_s z_p2). Members
of two sets that turn together have one name. Two sets on the same planets are those of a Wolfrom
train (3K). Numbers may be floats, arrays or fractions; whole numbers stay whole.
"""

from collections.abc import Iterator, Sequence
from itertools import product
from math import inf
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.choosing import choose


@dataclass(frozen=True)
class Use:
    """Sets, each by the names of sun, ring and carrier, and which member does what.

    shared: both sets have the same planets.
    """

    sets: tuple[tuple[str, str, str], ...]
    source: str
    sink: str
    held: tuple[str, ...]
    shared: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """All members but the planets."""
        return tuple(dict.fromkeys(name for names in self.sets for name in names))

    @property
    def free(self) -> tuple[str, ...]:
        """Members without a torque from outside."""
        return tuple(n for n in self.names if n not in (self.source, self.sink, *self.held))


Teeth = Sequence[tuple[Any, Any]]  # (a, b) of every set, r = b/a


def _rows(use: Use, teeth: Teeth) -> list[dict[str, Any]]:
    """The equation a n_s + b n_r - (a + b) n_c = 0 of every set, by member."""
    rows = []
    for names, (a, b) in zip(use.sets, teeth, strict=True):
        row: dict[str, Any] = dict.fromkeys(use.names, 0)
        for name, factor in zip(names, (a, b, -(a + b)), strict=True):
            row[name] = row[name] + factor
        rows.append(row)
    return rows


def _minor(use: Use, rows: list[dict[str, Any]], name: str, *other: str) -> Any:
    """Determinant of two members' columns; of one set its coefficient."""
    if len(use.sets) == 1:
        return rows[0][name]
    first, second = rows
    return first[name] * second[other[0]] - second[name] * first[other[0]]


def ratio_parts(use: Use, teeth: Teeth) -> tuple[Any, Any]:
    """Numerator and denominator of the ratio of input over output speed, whole of whole numbers.

    Cramer's rule; a denominator of 0 means that the output stands still, a numerator of 0 that the
    input cannot turn.
    """
    rows = _rows(use, teeth)
    return -_minor(use, rows, use.sink, *use.free), _minor(use, rows, use.source, *use.free)


def efficiency(use: Use, teeth: Teeth, losses: Sequence[tuple[Any, Any]]) -> Any:
    """Power given at the output over power taken at the input; 0: the train locks itself.

    losses: efficiency of the sun's and the ring's mesh of every set. A central gear j that drives
    in the frame of its carrier, T_j (n_j - n_c) > 0, gives its planets that power times the
    efficiency of its mesh; a driven one takes it divided by it. So torques are those of a train
    without losses whose r are r' = r eta_s^s eta_r^-t, s and t being 1 for gears that drive and -1
    for others, and eta = i(r')/i(r), where the powers that follow have these signs. If several ways
    do, the lowest efficiency counts. Where the ratio is no number eta is none.
    """
    above, below = ratio_parts(use, teeth)
    known: Any = inf
    with np.errstate(all="ignore"):
        for eta, consistent in _ways(use, teeth, losses, above, below):
            known = choose(consistent & (eta > 0) & (eta < known), eta, known)
    return choose(known < inf, known, 0)


def _ways(
    use: Use, teeth: Teeth, losses: Sequence[tuple[Any, Any]], above: Any, below: Any
) -> Iterator[tuple[Any, Any]]:
    """Efficiency with every choice of the gears that drive, and whether the powers agree."""
    rows = _rows(use, teeth)
    turning = _slips(use, rows, above, below)
    for suns, rings in _signs(use):
        lossy = [
            (a, b * sun**s * ring**-t)
            for (a, b), (sun, ring), s, t in zip(teeth, losses, suns, rings, strict=True)
        ]
        new = _rows(use, lossy)
        over, under = (_minor(use, new, name, *use.free) for name in (use.sink, use.source))
        if np.all(under == 0):
            continue
        forces = [1 / under]  # times the rows: torques from outside, that of the input 1
        if len(new) == 2:
            (x,) = use.free
            forces = [new[1][x] / under, -new[0][x] / under]
        of_suns = [force * row[0] for force, row in zip(forces, lossy, strict=True)]
        driving = [sum(of_suns)] * len(of_suns) if use.shared else of_suns
        powers = zip(suns, driving, rings, forces, lossy, teeth, turning, strict=True)
        consistent: Any = True
        for s, torque, t, force, row, (a, b), slip in powers:
            sun, ring = s * torque * slip, -t * force * row[1] * slip * a / b
            consistent = consistent & (sun >= 0) & (ring >= 0)
        yield -over / under * below / above, consistent


def _slips(use: Use, rows: list[dict[str, Any]], above: Any, below: Any) -> list[Any]:
    """Speed of every sun beyond its carrier's, of the input at 1."""
    known: dict[str, Any] = dict.fromkeys(use.held, 0) | {use.source: 1, use.sink: below / above}
    for name in use.free:
        known[name] = _minor(use, rows, use.sink, use.source) / above
    return [known[sun] - known[carrier] for sun, _, carrier in use.sets]


def _signs(use: Use) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Suns and rings that may drive in the frame of their carriers: of planets not all or none."""
    if not use.shared:
        for suns in product((1, -1), repeat=len(use.sets)):
            yield suns, tuple(-s for s in suns)
        return
    for sun, *rings in product((1, -1), repeat=1 + len(use.sets)):
        if len({sun, *rings}) > 1:
            yield (sun,) * len(rings), tuple(rings)
