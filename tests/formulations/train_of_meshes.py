"""Speeds, torques and losses of any epicyclic train, from its meshes, in exact arithmetic.

A mesh of gears of z_1 and z_2 teeth, whose axes a carrier holds, asks in the frame of the carrier
for z_1 (n_1 - n_c) + z_2 (n_2 - n_c) = 0; a ring gear has negative teeth, as in ISO 21771. Members
are named; those that turn together have one name. A frame that stands still is a carrier that is
held. Source: R. Willis, Principles of Mechanism (1841); losses by rolling power, as in Looman,
Zahnradgetriebe, and Mueller, Epicyclic Drive Trains, checked in tests against closed forms.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product

from gearopt.frozen import dataclass

ONE = Fraction(1)
Speeds = Mapping[str, Fraction]


@dataclass(frozen=True)
class Mesh:
    """Two gears in mesh on a carrier: names of members, teeth (of a ring negative).

    efficiency: power given over power taken in the frame of the carrier, whichever gear drives.
    """

    first: str
    second: str
    carrier: str
    first_teeth: int
    second_teeth: int
    efficiency: Fraction = ONE

    @property
    def members(self) -> tuple[str, str, str]:
        """First and second gear, carrier."""
        return self.first, self.second, self.carrier


@dataclass(frozen=True)
class MeshPower:
    """A mesh under load: rolling power that the driving gear gives, and what of it is lost."""

    mesh: Mesh
    driver: str
    rolling: Fraction
    lost: Fraction


@dataclass(frozen=True)
class Balance:
    """Torques from outside on every member of a train, in units of the input's, and its meshes.

    efficiency: power given at the output over power taken at the input.
    """

    torques: Mapping[str, Fraction]
    meshes: tuple[MeshPower, ...]
    efficiency: Fraction


def members(meshes: Sequence[Mesh]) -> tuple[str, ...]:
    """Names of the members, in the order of the meshes."""
    return tuple(dict.fromkeys(name for mesh in meshes for name in mesh.members))


def speeds(meshes: Sequence[Mesh], given: Speeds) -> dict[str, Fraction]:
    """Speeds of all members from those of some; ValueError where these do not set every speed."""
    names = members(meshes)
    rows = []
    for mesh in meshes:
        row = dict.fromkeys(names, Fraction(0))
        row[mesh.first] += mesh.first_teeth
        row[mesh.second] += mesh.second_teeth
        row[mesh.carrier] -= mesh.first_teeth + mesh.second_teeth
        rows.append([*row.values(), Fraction(0)])
    for name, speed in given.items():
        rows.append([*(Fraction(name == other) for other in names), Fraction(speed)])
    known = solved(rows)
    if known is None:
        raise ValueError("these speeds do not set those of all members, or contradict each other")
    return dict(zip(names, known, strict=True))


def solved(rows: Sequence[Sequence[Fraction]]) -> list[Fraction] | None:
    """Solution of equations, each a row of coefficients and a right side.

    None where there is none or more than one.
    """
    left, unknowns = [list(row) for row in rows], len(rows[0]) - 1
    for k in range(unknowns):
        pivot = next((i for i in range(k, len(left)) if left[i][k]), None)
        if pivot is None:
            return None
        left[k], left[pivot] = left[pivot], left[k]
        scale = left[k][k]
        left[k] = [value / scale for value in left[k]]
        for i, row in enumerate(left):
            if i != k and (factor := row[k]):
                left[i] = [a - factor * b for a, b in zip(row, left[k], strict=True)]
    if any(row[-1] for row in left[unknowns:]):
        return None
    return [row[-1] for row in left[:unknowns]]


def balances(
    meshes: Sequence[Mesh], turning: Speeds, source: str, sink: str, held: Sequence[str]
) -> list[Balance]:
    """Every equilibrium in which power goes from one member (torque 1) to another.

    turning: speeds of all members, that of the source above 0; held: members on which a torque acts
    beside these two. Of each mesh the driven gear has the torque of a loss-free one times the
    efficiency, if the first gear drives, else divided by it: all ways are tried, and those kept
    whose rolling power has the sign that was taken, and whose output gives power. None: the train
    locks itself. The moments of a mesh on both gears and the carrier add up to zero.
    """
    flows = []
    for signs in product((1, -1), repeat=len(meshes)):
        balance = _with_drivers(meshes, turning, source, sink, held, signs)
        if balance is not None and balance.efficiency > 0 and balance not in flows:
            flows.append(balance)
    return flows


def _with_drivers(
    meshes: Sequence[Mesh],
    turning: Speeds,
    source: str,
    sink: str,
    held: Sequence[str],
    signs: Sequence[int],
) -> Balance | None:
    """Equilibrium in which of every mesh the first gear (1) drives or the second (-1)."""
    names, outside = members(meshes), (sink, *held)
    on = [_moments(mesh, sign) for mesh, sign in zip(meshes, signs, strict=True)]
    rows = [
        [
            *(moment.get(name, Fraction(0)) for moment in on),
            *(Fraction(name == other) for other in outside),
            -Fraction(name == source),
        ]
        for name in names
    ]
    known = solved(rows)
    if known is None:
        return None
    powers = []
    for mesh, moment, force, sign in zip(meshes, on, known, signs, strict=False):
        carrier = turning[mesh.carrier]
        first = -force * moment[mesh.first] * (turning[mesh.first] - carrier)
        second = -force * moment[mesh.second] * (turning[mesh.second] - carrier)
        rolling = first if sign > 0 else second
        if rolling < 0:
            return None
        driver = mesh.second if rolling and sign < 0 else mesh.first
        powers.append(MeshPower(mesh, driver, rolling, first + second))
    torques = dict(zip(outside, known[len(meshes) :], strict=True)) | {source: ONE}
    given, taken = -torques[sink] * turning[sink], turning[source]
    return Balance(torques, tuple(powers), given / taken)


def _moments(mesh: Mesh, sign: int) -> dict[str, Fraction]:
    """Moments of a mesh on its members for a unit of tooth force."""
    first, second = Fraction(mesh.first_teeth), mesh.second_teeth * mesh.efficiency**sign
    moments = dict.fromkeys(mesh.members, Fraction(0))
    for name, moment in zip(mesh.members, (first, second, -first - second), strict=True):
        moments[name] += moment
    return moments
