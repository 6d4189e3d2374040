"""Stages with an idler between pinion and wheel: each number of its teeth is a way of making them.

A pair is that of pinion and wheel, whose ratio is the stage's whatever the idler; both meshes have
its module and face width. In each mesh the driving gear has no more teeth than the driven one.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import Stage
from gearopt.formulations.strength.standard import Option, Rows
from gearopt.frozen import dataclass
from gearopt.physics.gears import GearPair


@dataclass(frozen=True)
class InMesh:
    """A standard that rates one mesh of stages with an idler of so many teeth.

    second: whether the idler drives the wheel, else the pinion drives it; toothing: of the mesh.
    """

    standard: Any
    toothing: Toothing
    idler: int
    second: bool
    suffix: str
    monotone: bool = False

    def mesh(self, pair: GearPair) -> GearPair:
        """The mesh, of pairs of pinion and wheel."""
        teeth = (self.idler, pair.wheel_teeth) if self.second else (pair.pinion_teeth, self.idler)
        return self.toothing.pair(pair.normal_module, teeth[0], teeth[1], pair.face_width)

    def slower(self, pair: GearPair) -> Any:
        """Torque of the driving gear over the pinion's; NaN where it has more teeth than driven."""
        factor = self.idler / pair.pinion_teeth if self.second else 1.0
        return np.where(self.mesh(pair).ratio < 1.0, np.nan, factor)[()]

    def safeties(self, pair: GearPair, torque: Any, speed: Any) -> Any:
        """Return S_F1, S_F2, S_H1, S_H2; NaN where the pair is refused."""
        slower = self.slower(pair)
        return self.standard.safeties(self.mesh(pair), torque * slower, speed / slower)

    def best_with(self, rivals: Any) -> None:
        """No virtual way: idlers of other teeth differ in more than strength."""

    def like(self, other: Any) -> bool:
        """Whether `prepared` of another standard returns the same."""
        return bool(self == other)

    def prepared(self, pair: GearPair) -> Any:
        """Numbers of pairs (n,) that `rows` takes, of any load and width."""
        return self.standard.prepared(self.mesh(pair))

    def rows(self, prepared: Any, pair: GearPair, torque: Any, speed: Any, safety: Any) -> Rows:
        """Rows of the mesh, at the torques and speeds of its driving gear."""
        loads = [t * self.slower(pair) for t in torque], [w / self.slower(pair) for w in speed]
        rows: Rows = self.standard.rows(prepared, self.mesh(pair), *map(tuple, loads), safety)
        return rows


def with_idler(first: Stage, second: Stage) -> Stage:
    """The stage of two, of which the wheel of the first is the pinion of the second."""
    low, high = first.wheel_teeth
    rated: Any = {
        teeth: tuple(
            InMesh(one, stage.toothing, teeth, late, "_after_idler" * late + one.suffix)
            for stage, late in ((first, False), (second, True))
            for one in stage.options[0].standards
        )
        for teeth in range(low, (high or low) + 1)
    }
    options = tuple(Option(both, f"idler of {z} teeth", idler=z) for z, both in rated.items())
    wheel: Any = {"wheel_teeth": second.wheel_teeth, "wheel_diameter": second.wheel_diameter}
    return replace(first, options=options, **wheel)
