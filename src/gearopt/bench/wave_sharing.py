"""Load of the teeth of a strain wave gearing: active set, quadratic and conic program.

An 80:1 gearing of module 0.5 mm; the rim rigid or elastic. Errors are against the conditions of a
minimum: the largest load that a tooth has too much or too little.
"""

from functools import partial
from typing import Any

from gearopt.bench import timed
from gearopt.formulations.strain_wave.sharing import Teeth, conic, problem, shared, teeth_of
from gearopt.optimise.solve import solve
from gearopt.physics.strain_wave.conjugate import flank
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.rim import Cup

GEARING = StrainWave(0.5, 160, profile_shift=0.9)
STIFFNESS, WIDTH = 1e5, 10.0  # N/mm a pair, mm
TORQUES = (1.0, 20.0, 100.0, 200.0)  # N m at the output


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: torque, rim, method, teeth that carry, largest load, error of a load [N], ms."""
    import numpy as np

    shape, rows = flank(GEARING), []
    for torque in TORQUES:
        for rim, cup in (("rigid", None), ("elastic", (Cup(), WIDTH))):
            teeth = teeth_of(shape, STIFFNESS, cup)
            given = teeth.compliance, teeth.gaps, np.full(len(teeth.gaps), teeth.arm), 500 * torque
            exact, times = timed(partial(shared, *given), repeat)
            answers = {"active set": (exact.forces, times)}
            posed: dict[str, Any] = {
                "qp": (problem(*given), "qp"),
                "conic (Clarabel)": (conic(*given), None),
            }
            for name, (stated, method) in posed.items():
                answer, times = timed(partial(solve, stated, method), repeat)
                shares = np.array(list(answer.design.values())).ravel()
                answers[name] = shares * 500 * torque / teeth.arm, times
            for name, (forces, times) in answers.items():
                rows.append(
                    {
                        "torque_Nm": torque,
                        "rim": rim,
                        "method": name,
                        "carrying": exact.carrying,
                        "largest_N": round(float(forces.max()), 3),
                        "error_N": float(f"{_error(teeth, forces, 500 * torque):.2g}"),
                        "ms": times["median_ms"],
                    }
                )
    return rows


def _error(teeth: Teeth, forces: Any, moment: float) -> float:
    """Return how far loads are from the minimum's conditions [N], by the pair's own stiffness."""
    import numpy as np

    carries = forces > 1e-6 * forces.max()
    left = teeth.compliance @ forces + teeth.gaps
    windup = left[carries].mean()
    apart = np.where(carries, np.abs(left - windup), np.maximum(windup - left, 0.0))
    return max(float(apart.max()) * STIFFNESS, abs(float(forces.sum()) - moment / teeth.arm))
