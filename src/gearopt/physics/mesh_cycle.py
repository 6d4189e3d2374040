"""The positions of all tooth pairs over one base pitch of travel, break points exactly.

A pair comes into contact at the start of the path A (SAP) and leaves at its end E (EAP). One base
pitch away from them lie the highest and the lowest points of single tooth contact (HPSTC, LPSTC)
where the contact ratio is below 2, of n-pair contact in general. The number of pairs jumps there,
and with it load and transmission error: both sides are sampled, as no uniform grid finds a zone of
one pair that is a thousandth of a base pitch.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.geometry.contact import ContactPath

Array = np.ndarray[Any, np.dtype[np.float64]]
NARROW = 1e-9  # base pitches: a zone that is narrower is none


@dataclass(frozen=True)
class Cycle:
    """One base pitch of travel: travels (p,), positions (p, n), path they lie on.

    travels: of the pairs, in base pitches, 0 where a pair comes into contact; from 0 to 1, in which
    1 is just before the next pair comes. positions s [mm] on the line of action, NaN where a pair
    is not on the path; pair k + 1 is one base pitch ahead of pair k.
    """

    travels: Array
    positions: Array
    path: ContactPath

    @property
    def present(self) -> Any:
        """Whether a pair is on the path of contact, (p, n)."""
        return ~np.isnan(self.positions)

    def separations(self, separation: Any) -> Array:
        """Return separations (p, n) [mm] from a function of positions, infinite where none is."""
        return np.where(self.present, separation(self._inside), np.inf)

    def compliances(self, compliance: Any) -> Array:
        """Return compliances (p, n) [mm/N] from a function of positions, where a pair is present.

        Elsewhere they are those at the middle of the path, which do not matter.
        """
        compliances: Array = compliance(self._inside.ravel()).reshape(self.positions.shape)
        return compliances

    @property
    def _inside(self) -> Array:
        middle = 0.5 * (self.path.start + self.path.end)
        return np.where(self.present, self.positions, middle)

    def along(self, values: Any) -> Array:
        """Return values (p, n) of pairs in the order in which one pair meets them on its path.

        Break points are there twice, with the value on either side.
        """
        met: Array = np.asarray(values).T[self.present.T]
        return met


def cycle(path: ContactPath, steps: int = 48, exact: bool = True, also: Any = ()) -> Cycle:
    """Return the positions of all pairs at `steps` travels of a base pitch and at break points.

    also: positions s [mm] at which a pair is met, too, such as where a relief begins. exact: with
    both sides of every break point; without, the grid alone, as sampled programs have it. Where the
    contact ratio is n + r, n + 1 pairs touch for a travel of r and n for the rest.
    ValueError where it is below 1: there is no continuous contact.
    """
    ratio = float(path.transverse_ratio)
    if not ratio >= 1.0 - NARROW:
        raise ValueError(f"a contact ratio of {ratio:.6g} gives no continuous contact")
    whole = int(np.floor(ratio + NARROW))
    rest = max(ratio - whole, 0.0)
    more = (np.asarray(also, float) - path.start) / path.base_pitch % 1.0
    grid = np.union1d(np.arange(steps) / steps, more)
    if not exact:
        count = np.where(grid <= rest + NARROW, whole + 1, whole)
        return _cycle(path, grid, count)
    more, fewer = grid[(grid > 0.0) & (grid < rest)], grid[(grid > rest) & (grid > 0.0)]
    zones = []
    if rest > NARROW:
        zones.append((np.array([0.0, *more, rest]), whole + 1))
    if rest < 1.0 - NARROW:
        zones.append((np.array([rest, *fewer, 1.0]), whole))
    travels = np.concatenate([t for t, _ in zones])
    return _cycle(path, travels, np.concatenate([np.full(len(t), n) for t, n in zones]))


def _cycle(path: ContactPath, travels: Array, count: Any) -> Cycle:
    ahead = np.arange(int(count.max()))
    positions = path.start + (travels[:, None] + ahead) * path.base_pitch
    last = positions > path.end - NARROW * path.base_pitch  # but for rounding, the end
    positions = np.where(last, path.end, positions)
    return Cycle(travels, np.where(ahead < count[:, None], positions, np.nan), path)


def break_points(path: ContactPath) -> dict[str, float]:
    """Return the positions s [mm] of the break points in their order, by name.

    SAP, LPSTC, HPSTC, EAP for contact ratios below 2; above, those a number of base pitches from
    the ends are named after them, as "SAP + 2 p_b".
    """
    ratio = float(path.transverse_ratio)
    whole = int(np.floor(ratio + NARROW))
    if whole < 2:
        single = {"LPSTC": path.lowest_single, "HPSTC": path.highest_single}
        points = {"SAP": path.start, **single, "EAP": path.end}
    else:
        points = {"SAP": path.start, "EAP": path.end}
        for k in range(1, whole + 1):
            points[f"SAP + {k} p_b"] = path.start + k * path.base_pitch
            points[f"EAP - {k} p_b"] = path.end - k * path.base_pitch
    return {name: float(s) for name, s in sorted(points.items(), key=lambda pair: pair[1])}
