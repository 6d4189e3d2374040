"""A spur pair in mesh under several loads, and the effect of relief on it."""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.load_sharing import Sharing, share
from gearopt.physics.mesh_cycle import Cycle

HARMONICS = 3  # of the tooth mesh frequency, that criteria name
TOUCHES = 1e-9  # of a load: a pair that carries less is open but for rounding


@dataclass(frozen=True)
class Relief:
    """Depth removed from the flanks of one gear towards its tip: a (1 - x/l)^p, x from the tip.

    amount a [mm] at the tip, normal to the flank; length l [mm] and distance x from the tip along
    the line of action; exponent p: 1 linear, 2 parabolic. Floats, or arrays (N,) of N designs.
    """

    amount: Any
    length: Any
    exponent: Any = 1.0

    def removed(self, from_tip: Any) -> Any:
        """Depth removed [mm] at distances x [mm] from the tip, (..., p, n)."""
        a, length, power = (np.asarray(v, float)[..., None, None] for v in self._numbers)
        return a * np.maximum(1.0 - from_tip / length, 0.0) ** power

    @property
    def _numbers(self) -> tuple[Any, Any, Any]:
        return self.amount, self.length, self.exponent


NO_RELIEF = Relief(0.0, 1.0)


@dataclass(frozen=True)
class Mesh:
    """All tooth pairs of a spur pair over one base pitch of travel, and the loads on them.

    cycle: positions (p, n) of the pairs; compliances (p, n) [mm/N] of one pair alone, coupling
    [mm/N] of neighbours; loads (l,) [N] along the line of action, each at least 0.
    """

    cycle: Cycle
    compliances: Array
    coupling: float
    loads: tuple[float, ...]

    @classmethod
    def of(
        cls,
        cycle: Cycle,
        compliance: Callable[[Array], Any],
        coupling: float,
        loads: tuple[float, ...],
    ) -> "Mesh":
        """Return the mesh with compliances from a function of positions s [mm]."""
        return cls(cycle, cycle.compliances(compliance), coupling, tuple(map(float, loads)))

    @property
    def sampled(self) -> str:
        """Where values are computed, as proofs on these positions name it."""
        return f"at {len(self.cycle.travels)} positions of the gears"

    @cached_property
    def from_tips(self) -> tuple[Array, Array]:
        """Distances (p, n) [mm] of contacts from the tips of pinion and wheel, on their path.

        Infinite of pairs that are not in contact there.
        """
        path, there = self.cycle.path, self.cycle.present
        inside = np.where(there, self.cycle.positions, 0.0)
        ends = path.end - inside, inside - path.start
        pinion, wheel = (np.where(there, np.maximum(x, 0.0), np.inf) for x in ends)
        return pinion, wheel

    @cached_property
    def weights(self) -> Array:
        """Parts of the travel (p,) that positions stand for, which sum to 1; trapezoidal rule."""
        travels = self.cycle.travels
        ahead = np.diff(travels, append=travels[0] + 1.0)
        return np.asarray(0.5 * (ahead + np.roll(ahead, 1)))

    def waves(self, count: int = HARMONICS) -> Any:
        """Return complex factors (count, p) from approaches to the amplitudes of harmonics."""
        order = np.arange(1, count + 1)[:, None]
        waves = 2.0 * self.weights * np.exp(-2j * np.pi * order * self.cycle.travels)
        return waves - waves.sum(axis=1, keepdims=True) * self.weights  # of a constant: 0

    def separations(self, pinion: Relief, wheel: Relief) -> Array:
        """Depth that both reliefs remove at each contact [mm], (..., p, n); infinite without one.

        Source: equation (15) of the paper of Hwang and others: the sum over both flanks.
        """
        removed = [r.removed(x) for r, x in zip((pinion, wheel), self.from_tips, strict=True)]
        return np.where(self.cycle.present, removed[0] + removed[1], np.inf)

    def sharing(self, separations: Any) -> Sharing:
        """Return forces (..., l, p, n), approach (..., l, p), gaps (..., l, p, n) of every load."""
        apart = np.asarray(separations)[..., None, :, :]
        loads = np.array(self.loads)[:, None]
        return share(self.compliances, apart, loads, self.coupling)

    def criteria(self, separations: Any) -> "Criteria":
        """Measures of a relief, from separations (..., p, n) [mm]."""
        return Criteria(self, self.sharing(separations))


@dataclass(frozen=True)
class Criteria:
    """Measures by which reliefs are compared; every value (..., l), one for each load.

    Shares of loads are of the load in question; of a load of zero they are 0.
    """

    mesh: Mesh
    sharing: Sharing

    def of_load(self, number: int) -> "Criteria":
        """Return the criteria of one of the loads, counted from 1."""
        k = number - 1
        forces, approach, gaps = self.sharing
        only = slice(k, k + 1)
        part = Sharing(forces[..., only, :, :], approach[..., only, :], gaps[..., only, :, :])
        return Criteria(replace(self.mesh, loads=self.mesh.loads[only]), part)

    @property
    def peak_to_peak(self) -> Array:
        """Peak-to-peak transmission error max delta - min delta [mm] over the cycle."""
        return np.asarray(np.ptp(self.sharing.approach, axis=-1))

    def harmonics(self, count: int = HARMONICS) -> Array:
        """Return amplitudes (..., l, count) [mm] of the first harmonics of the transmission error.

        2 |integral (delta - mean) exp(-2 pi i h t) dt| over a base pitch of travel t, h = 1 to
        count, by the trapezoidal rule between the positions; jumps at break points stay jumps.
        """
        return np.asarray(np.abs(self.sharing.approach @ self.mesh.waves(count).T))

    @property
    def load_jump(self) -> Array:
        """The largest share of the load with which a pair comes into contact or leaves it."""
        shares = np.where(self._ends, self._shares, 0.0)
        return np.asarray(shares.max(axis=(-2, -1)))

    @property
    def peak_load(self) -> Array:
        """The largest share of the load that one pair carries anywhere."""
        return np.asarray(self._shares.max(axis=(-2, -1)))

    @property
    def contact_ratio(self) -> Array:
        """The mean number of pairs that carry, of positions that are evenly spaced or exact."""
        carries = self._shares > TOUCHES
        return np.asarray(carries.sum(axis=-1) @ self.mesh.weights)

    @property
    def _shares(self) -> Array:
        loads = np.array(self.mesh.loads)[:, None, None]
        return self.sharing.forces / np.where(loads > 0.0, loads, np.inf)

    @property
    def _ends(self) -> Any:
        """Contacts at the first and at the last position of the path."""
        pinion, wheel = self.mesh.from_tips
        least = np.minimum(pinion, wheel)
        return least <= least.min() + 1e-12
