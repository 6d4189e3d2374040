"""Volumes of gears with webs ring by ring, backup ratios of their rims, and random blanks."""

import math

from gearopt.physics.blanks import Blank


def ring(outer, inner):
    """Area between two diameters."""
    return math.pi / 4 * (outer - inner) * (outer + inner)


def rings(blank, module, d, dedendum=1.25):
    """Return (outer, inner, part of the face width) of every ring of a gear without shift."""
    root, hub = d - 2 * dedendum * module, blank.hub_over_bore * blank.bore
    rim = None
    if blank.rim_over_module is not None:
        rim = blank.rim_over_module * module
    elif blank.rim_thickness is not None:
        rim = blank.rim_thickness
    if rim is not None and root - 2 * rim > hub * (1 + 1e-12):
        inside, web = root - 2 * rim, min(1.0, blank.web_over_width)
        return [(d, inside, 1.0), (inside, hub, web), (hub, blank.bore, 1.0)]
    return [(d, blank.bore if hub < root else 0.0, 1.0)]


def volume(blank, module, d, b):
    """Return the volume of a gear: the sum of its rings."""
    return b * sum(part * ring(outer, inner) for outer, inner, part in rings(blank, module, d))


def backup(blank, module, d):
    """What is below the root over the whole depth of 2.25 modules; None: solid."""
    found = rings(blank, module, d)
    if len(found) == 1 and not found[0][1]:
        return None
    return ((d - found[0][1]) / 2 - 1.25 * module) / (2.25 * module)


def some_blank(rng, module):
    """A random blank of gears with about this module."""
    bore = float(rng.choice([0.0, rng.uniform(2.0, 20.0) * module]))
    rim = rng.uniform(1.5, 6.0)
    rims = [(rim, None), (None, rim * module), (None, None)][rng.integers(3)]
    return Blank(*rims, float(rng.uniform(0.1, 1.0)), bore, float(rng.uniform(1.2, 2.0)))
