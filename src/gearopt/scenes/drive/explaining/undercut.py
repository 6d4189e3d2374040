"""Pinions that a rack undercuts, in sentences."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from gearopt.physics.gears import NEGLIGIBLE, Rack, teeth_without_undercut


def undercut(
    stages: Sequence[Mapping[str, Any]], rack: Rack, helix_angle: float, more: str = ""
) -> Iterator[str]:
    """A sentence for every pinion of a design that is noticeably undercut; more: what follows it.

    At 20 degrees 17 spur teeth are not: the rack reaches 0.006 modules too deep.
    """
    limit = float(teeth_without_undercut(rack, helix_angle))
    least = (1.0 - NEGLIGIBLE) * limit
    for k, stage in enumerate(stages, 1):
        if (teeth := stage["pinion_teeth"]) < least:
            yield (
                f"The pinion of stage {k} is undercut, with {teeth:.4g} teeth: without profile "
                f"shift a rack cuts {math.ceil(least)} teeth and more cleanly (in theory "
                f"{limit:.1f}).{more}"
            )
