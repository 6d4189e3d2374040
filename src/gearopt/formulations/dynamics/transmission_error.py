"""Transmission error in motion: by how much the driven gear lags behind, along the line of action.

That of the unloaded teeth and the deformation of the mesh together, e - delta: at slow speed the
transmission error under load.
"""

from typing import NamedTuple

import numpy as np

from gearopt.optimise.terms import Array
from gearopt.physics.motion.moving_pair import MovingPair


class Lag(NamedTuple):
    """RMS about the mean, peak to peak, and largest value of a transmission error [mm]."""

    rms: float
    height: float
    most: float


def lag_of(pair: MovingPair, phases: Array, delta: Array) -> Array:
    """Return the transmission error [mm] at phases of the mesh, of deformations there [mm]."""
    return np.asarray(pair.error_at(phases) - delta)


def extent(lag: Array) -> Lag:
    """Return the extent of a transmission error at equal steps of time [mm]."""
    return Lag(float(lag.std()), float(np.ptp(lag)), float(lag.max()))
