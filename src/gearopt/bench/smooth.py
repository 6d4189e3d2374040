"""Smooth forms of ratings against the exact ones: errors of random pairs, and wrong verdicts.

The loads are such that the least safety factor is between 0.8 and 1.25. The smooth form of AGMA has
the mean load sharing; that of ISO 6336 is taken in the range of K_v that a pair runs in.
"""

import math
from collections.abc import Callable
from typing import Any

from gearopt.bench import timed
from gearopt.formulations.strength.agma import Agma
from gearopt.formulations.strength.agma_smooth import UNKNOWNS
from gearopt.formulations.strength.iso6336 import Iso6336
from gearopt.formulations.strength.standard import MODES, Load
from gearopt.physics.agma.bending import critical_theta, loaded_tooth, seen_from_wheel
from gearopt.physics.agma.mesh import REGIMES, mesh_of
from gearopt.physics.agma.rating_factors import Practice, Steel, distribution
from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.case import Practice as IsoPractice
from gearopt.physics.iso6336.chain import quantities
from gearopt.physics.iso6336.load_factors import MAIN, RANGES, SUPER, lower_limit
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.rating import Operation

COUNT = 20_000  # pairs of a case
HOURS = 20_000.0
OPERATION = Operation(1.0, 1.0, HOURS, overload=1.25)
AGMA = Agma((Load(HOURS),), OPERATION, (Steel("carburised", 1),) * 2, Practice(quality=8))
ISO = Iso6336(
    (Load(HOURS),), OPERATION, (Material("Eh", "MQ"),) * 2, IsoPractice(grades=(6.0, 6.0))
)
OVERLAPS = {"spur": (0.0, 0.0), "low": (0.1, 1.0), "conventional": (1.05, 3.0)}  # m_F
Safeties = Callable[[GearPair, Any, Any], Any]


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, limit, pairs, median, of 1000 the largest but one, worst, wrong verdicts.

    Errors are those of safety factors [%], smooth over exact. unsafe_called_safe: exact below 1,
    smooth not; safe_called_unsafe: the other way round. ms: of all pairs in the smooth form.
    """
    rows = []
    for seed, regime in enumerate(REGIMES):
        pair, speed = random_pairs(OVERLAPS[regime], seed)
        rows += _compared(f"AGMA, {regime}", AGMA, pair, speed, _of_agma(regime), repeat)
    for seed, (case, overlap) in enumerate({"spur": 0.0, "helical": 1.0}.items()):
        pair, speed = random_pairs((0.1 * overlap, 3.0 * overlap), 10 + seed)
        rows += _compared(f"ISO 6336, {case}", ISO, pair, speed, _of_iso, repeat)
    return rows


def random_pairs(overlap: tuple[float, float], seed: int) -> tuple[GearPair, Any]:
    """Return COUNT random pairs as one `GearPair` of arrays, and speeds of their pinions [rad/s].

    Overlap ratios are uniform between the two ends; (0, 0): spur gears. Modules of 1 to 10 mm,
    pinions of 18 to 60 teeth, ratios of 1 to 6, helix angles of 0.1 to 0.5 rad.
    """
    import numpy as np

    rng = np.random.default_rng(seed)
    module = 10.0 ** rng.uniform(0.0, 1.0, COUNT)
    pinion = rng.integers(18, 61, COUNT).astype(float)
    wheel = np.ceil(pinion * rng.uniform(1.0, 6.0, COUNT))
    width, helix = module * rng.uniform(6.0, 18.0, COUNT), np.zeros(COUNT)
    if overlap[1]:
        helix = rng.uniform(0.1, 0.5, COUNT)
        width = rng.uniform(*overlap, COUNT) * math.pi * module / np.sin(helix)
    speed = 10.0 ** rng.uniform(1.0, 2.5, COUNT)
    return GearPair.of_teeth(module, pinion, wheel, width, helix), speed


def _compared(
    case: str, standard: Any, pair: GearPair, speed: Any, smooth: Safeties, repeat: int
) -> list[dict[str, Any]]:
    """Return a row for every limit."""
    import numpy as np

    torque = _torque(standard, pair, speed)
    exact = np.array(standard.safeties(pair, torque, speed))
    estimates, times = timed(lambda: np.array(smooth(pair, torque, speed)), repeat)
    known = np.isfinite(exact).all(axis=0)
    rows = []
    for mode, right, estimated in zip(MODES, exact[:, known], estimates[:, known], strict=True):
        error = np.sort(np.abs(estimated / right - 1.0)) * 100.0
        rows.append(
            {
                "case": case,
                "limit": mode,
                "pairs": len(error),
                "median": float(np.median(error)),
                "of_1000": float(error[-(len(error) // 1000 + 1)]),
                "worst": float(error[-1]),
                "unsafe_called_safe": int(((right < 1.0) & (estimated >= 1.0)).sum()),
                "safe_called_unsafe": int(((right >= 1.0) & (estimated < 1.0)).sum()),
                "ms": times["median_ms"],
            }
        )
    return rows


def _torque(standard: Any, pair: GearPair, speed: Any) -> Any:
    """Return torques [N mm] at which the least safety factor is near 1."""
    import numpy as np

    rng = np.random.default_rng(100)
    torque = 5.0 * pair.pinion.reference_diameter**2 * pair.face_width
    for _ in range(4):  # loads enter factors, too
        safeties = standard.safeties(pair, torque, speed)
        torque = torque * np.minimum(np.minimum(*safeties[:2]), np.minimum(*safeties[2:]) ** 2)
    return torque * rng.uniform(0.64, 1.25, COUNT)


def _of_agma(regime: str) -> Safeties:
    """Return the smooth form of a regime with its unknowns at their solution."""

    def smooth(pair: GearPair, torque: Any, speed: Any) -> Any:
        mesh, practice = mesh_of(pair, regime), AGMA.practice
        teeth = [loaded_tooth(m, practice.load) for m in (mesh, seen_from_wheel(mesh))]
        spread = distribution(practice, pair.face_width, pair.working_diameters[0])
        unknown = dict(zip(UNKNOWNS, (*map(critical_theta, teeth), spread), strict=True))
        return AGMA.smooth(pair, torque, speed, regime, unknown).safeties

    return smooth


def _of_iso(pair: GearPair, torque: Any, speed: Any) -> Any:
    """Return the smooth form, of every pair in its range of K_v."""
    import numpy as np

    case = ISO.case(pair, torque, speed)
    numbers = quantities(case)
    limit = lower_limit(case.load * numbers["K_A"] * numbers["K_gamma"] / pair.face_width)
    place = np.where(numbers["N"] <= limit, 0, np.where(numbers["N"] < 0.5 * (MAIN + SUPER), 1, 2))
    by_range = [np.array(ISO.smooth(pair, torque, speed, r, {}).safeties) for r in RANGES]
    return np.choose(place, by_range)
