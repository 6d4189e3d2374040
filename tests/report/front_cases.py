"""Pareto fronts made by hand: of the elevator's designs, and of a problem without gears."""

import copy
import json
from pathlib import Path

from gearopt import Front
from gearopt.optimise.pareto.front import FrontPoint, Growth, Impossible
from gearopt.optimise.pareto.measures import Pick
from gearopt.optimise.pareto.objectives import Objective

KEPT = Path(__file__).parents[2] / "docs" / "pictures" / "elevator.json"
KNEE = "the point furthest below the straight line"


def drive(count=3, objectives=2, **changes):
    """Designs k = 0, 1 ... of the elevator whose wheel 1 has k teeth more; others as invented."""
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    points = []
    for k in range(count):
        design = copy.deepcopy(kept["design"])
        design["stages"][0]["wheel_teeth"] += k
        values = (6.0e6 + 1.234567e5 * k, 2.0 / (1.0 + k), 300.0 + (k - 1) ** 2)[:objectives]
        limits = {"k_factor[1]": 1.0 - 0.1 * k, "k_factor[2]": 0.5}
        points.append(FrontPoint(values, True, design=design, limits=limits))
    named = [("gear_volume", "mm3"), ("mesh_loss", "percent"), ("total_length", "mm")]
    told = {
        "picks": (Pick(1, "knee", KNEE),) if count > 1 else (),
        "beaten": ((6.1e6, 2.4, 310.0)[:objectives], (6.2e6, 2.1, 320.0)[:objectives]),
        "impossible": (Impossible({"mesh_loss": 0.5}, True), Impossible({"mesh_loss": 0.6}, False)),
        "growth": (Growth(0.1, 10, 5.0), Growth(0.5, 40, 10.0)),
        "hypervolume": 10.0,
        "proof": {"sentence": "Proof: made by hand."},
        "file": "my.toml",
        "scene": "drive",
        "title": "Two gears",
    }
    shown = tuple(Objective(name, unit) for name, unit in named[:objectives])
    return Front("drive", "complete", "exact", shown, tuple(points), **told | changes)


def impossible(**changes):
    """A front of which it is proven that there is no design."""
    shown = Objective("gear_volume", "mm3", 1.0e6), Objective("mesh_loss", "percent")
    told = {"file": "my.toml", "scene": "drive", "proof": {"sentence": "Proof: none is so small."}}
    told |= {"name": "drive", "status": "infeasible", "method": "exact", "objectives": shown}
    return Front(**told | changes)


def own():
    """A front of a problem without gears: (x - 2)^2 against x^2."""
    shown = Objective("a"), Objective("b")
    points = [
        FrontPoint((x**2, (x - 2.0) ** 2), design={"x_mm": x}, limits={"room": x / 4.0})
        for x in (0.0, 1.0, 2.0)
    ]
    picks = Pick(1, "knee", KNEE), Pick(1, "compromise", "the point nearest to both")
    return Front("parabolas", "not proven", "epsilon", shown, tuple(points), picks=picks)
