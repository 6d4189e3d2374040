"""Random cells of designs of a stage, and random designs within them."""

from dataclasses import replace

import numpy as np

from gearopt.formulations.strength.cells import Cells


def random_cells(rng, count, toothing, width, helices=None, shifts=None):
    """Return cells of up to twice a width in logarithms, about sizes of a large range.

    helices [rad]: between which the tangents of their helix angles are cells, too; shifts: ends of
    x1 and of x1 + x2, between which they are.
    """

    def between(low, high):
        middle = rng.uniform(np.log(low), np.log(high), count)
        half = width * rng.uniform(0.0, 1.0, count)
        return np.exp(np.stack([middle - half, middle + half]))

    z, u, d = between(18.0, 60.0), np.maximum(between(1.2, 6.0), 1.0), between(15.0, 300.0)
    slim, torque = between(0.2, 1.2), between(1e4, 1e7)
    power = np.exp(rng.uniform(np.log(1e5), np.log(1e9), count))
    speed, ranges, cosines = power / torque[::-1], {}, toothing.cosine
    if helices is not None:
        low, high = np.tan(helices)
        ranges["helix_angle"] = np.arctan(np.clip(between(low, high), low, high))
        cosines = np.cos(ranges["helix_angle"][::-1])
    for name, (low, high) in zip(("pinion_shift", "shift_sum"), shifts or (), strict=False):
        middle = rng.uniform(low, high, count)
        half = width * rng.uniform(0.0, 1.0, count)
        ranges[name] = np.clip(np.stack([middle - half, middle + half]), low, high)
    module = d * cosines / z[::-1]
    return Cells(toothing, z, u, d, d * u, module, slim * d, slim, torque, speed, ranges)


def designs_within(rng, cells):
    """Return a pair, torque and speed in each cell, some of them at its ends."""
    count = cells.teeth.shape[1]

    def parts():
        part = rng.uniform(0.0, 1.0, count)
        kind = rng.integers(0, 5, count)
        return np.where(kind == 0, 0.0, np.where(kind == 1, 1.0, part))

    def some(ends):
        part = parts()
        return ends[0] ** (1.0 - part) * ends[1] ** part

    z, u, d = some(cells.teeth), some(cells.ratio), some(cells.diameter)
    slim, torque = some(cells.slim), some(cells.torque)
    fields = {
        name: ends[0] + parts() * np.diff(ends, axis=0)[0] for name, ends in cells.ranges.items()
    }
    if "helix_angle" in fields:
        fields["helix_angle"] = np.arctan(some(np.tan(cells.ranges["helix_angle"])))
    cut = replace(cells.toothing, **fields)
    pair = cut.of_diameter(d * np.cos(cut.helix_angle) / z, z, d, u, slim * d)
    return pair, torque, cells.torque[0] * cells.speed[1] / torque


def needed_by(standard, pair, torque, speed, safety):
    """Return d1^2 b/(T (1 + 1/u)) of contact and d1^2 b/T of bending that the exact rating asks."""
    made = np.array(standard.safeties(pair, torque, speed), float)
    size = pair.pinion.reference_diameter**2 * pair.face_width / torque
    bent = safety[0] / np.minimum(made[0], made[1])
    pressed = (safety[1] / np.minimum(made[2], made[3])) ** 2
    return pressed * size / (1.0 + 1.0 / pair.ratio), bent * size
