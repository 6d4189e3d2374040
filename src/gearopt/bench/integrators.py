"""Time integration of a pair on moving axes: time beside the error reached, method by method.

Data of Yoon, Kim and Chung, who print no result; their mesh stiffness is assumed (2e5 N/mm). From
rest, 20 ms, 401 outputs. Error: largest difference of delta from steps of RK8 eight times shorter
than any compared, over the largest |delta|. Times are of the processor, which other programs do not
lengthen by waiting; all methods take turns, so that what slows the machine slows all of them.
"""

import math
import statistics
import time
from collections.abc import Callable, Iterator
from typing import Any

from gearopt.formulations.dynamics.motion.integrate import STEPPERS, conservative, march
from gearopt.formulations.dynamics.motion.reference import SCIPY, cvodes, scipy_motion
from gearopt.formulations.dynamics.motion.timeline import timeline
from gearopt.frozen import dataclass
from gearopt.physics.motion.moving_pair import MovingPair, Rotor
from gearopt.physics.motion.stiffness_wave import Wave, constant, trapezoid

TARGETS = (1e-3, 1e-6, 1e-9)
STIFFNESS = 2e5  # N/mm
TIME, OUTPUTS = 0.02, 401
REFERENCE = 128  # steps of RK8 between two outputs
PATIENCE = 1200.0  # ms that a run may take for the next finer one to be tried
BATCH = 10.0  # ms: shorter runs are timed several together
TOLERANCES = tuple(10.0**-p for p in range(3, 14))
COARSEST = {"rk8": 1, "rk4": 4, "symplectic": 2}  # steps between two outputs; of others 4
YARDSTICK = "rk8"


def pair(kinematics: str, wave: Wave, frequency: float = 0.0) -> MovingPair:
    """Return the pair of the paper: SI data converted to mm, t, N."""
    bearings = (1e3, 1e3)
    rotors = Rotor(60.0, 6e-4, 2.0, bearings, torque=2e5), Rotor(80.0, 9e-4, 4.0, bearings)
    return MovingPair(*rotors, math.radians(20.0), wave, frequency, kinematics=kinematics)


def moving_pairs() -> dict[str, MovingPair]:
    """Return the pairs that are integrated, by name: kinematics and mesh stiffness."""
    return {
        "paper, constant stiffness": pair("paper", constant(STIFFNESS)),
        "paper, trapezoid 1 kHz": pair("paper", trapezoid(STIFFNESS, 0.5, 0.6, 0.1), 1000.0),
        "exact, constant stiffness": pair("exact", constant(STIFFNESS)),
    }


def run(repeat: int) -> list[dict[str, Any]]:
    """Return rows: case, method, order, ms to each error of TARGETS, over RK8's; least error.

    The time to an error lies between those of two settings, on a straight line of the logarithms.
    Medians of so many rounds, in each of which all methods take their turn; over_rk8: the median of
    the ratios within a round. order: the largest slope of log error over log step of two settings
    whose errors lie between 1e-9 and 0.02. None: not reached, within a second a run; or no order,
    of adaptive methods.
    """
    rows = []
    for case, scene in moving_pairs().items():
        known = reference(scene)
        settings_of = {name: list(_climbed(ladder, known)) for name, ladder in _ladders(scene)}
        rounds = [_round(settings_of) for _ in range(max(repeat, 1))]
        for name, settings in settings_of.items():
            errors = [one.error for one in settings]
            slope = _slope(errors) if name in STEPPERS else None
            row = {"case": case, "method": name, "order": slope}
            for index, target in enumerate(TARGETS):
                times = [one[name][index] for one in rounds]
                row[f"ms_{target:.0e}"] = _median(times)
                bases = [one[YARDSTICK][index] for one in rounds]
                shares = [t / b if t and b else None for t, b in zip(times, bases, strict=True)]
                row[f"over_rk8_{target:.0e}"] = _median(shares)
            rows.append({**row, "error": min(errors)})
    return rows


Run = Callable[[], Any]


def _ladders(scene: MovingPair) -> Iterator[tuple[str, Iterator[Run]]]:
    """Yield every method with its runs, from the coarsest setting to finer ones."""
    import numpy as np

    times, rest = np.linspace(0.0, TIME, OUTPUTS), np.zeros(10)
    between = TIME / (OUTPUTS - 1)

    def steps(name: str, level: str) -> Iterator[Run]:
        intervals = timeline(scene, times)
        for power in range(13):
            longest = between / (COARSEST.get(name, 4) * 2**power)
            yield lambda h=longest: march(scene, level, intervals, name, h, rest)  # type: ignore[misc]

    for name, stepper in STEPPERS.items():
        level = "way" if stepper.undamped else "plane"
        if not stepper.undamped or conservative(scene, level):
            yield name, steps(name, level)
    for name in SCIPY:
        yield (
            f"scipy {name}",
            (
                lambda m=name, r=rtol: scipy_motion(scene, "plane", times, m, r, rest)  # type: ignore[misc]
                for rtol in TOLERANCES
            ),
        )
    built = (cvodes(scene, "plane", times, rtol) for rtol in TOLERANCES)
    yield "CVODES", (lambda b=b: b(rest) for b in built)  # type: ignore[misc]


@dataclass(frozen=True)
class _Setting:
    """A run of a method, the error it ends with, and how often it runs at a time."""

    run: Run
    error: float
    calls: int


def _climbed(ladder: Iterator[Run], known: Any) -> Iterator[_Setting]:
    """Yield the settings of a method, until the least target is met or patience ends."""
    import numpy as np

    scale = np.max(np.abs(known))
    for run_ in ladder:
        motion = run_()  # the first compiles
        error = float(np.max(np.abs(motion.delta - known)) / scale)
        took = _took(run_, 1)
        calls = max(1, round(BATCH / max(took, 1e-3)))
        yield _Setting(run_, error if math.isfinite(error) else math.inf, calls)
        if error <= TARGETS[-1] or took > PATIENCE:
            return


def _took(run_: Run, calls: int) -> float:
    """Return the processor's time of one of so many runs [ms]."""
    begun = time.process_time()
    for _ in range(calls):
        run_()
    return 1000.0 * (time.process_time() - begun) / calls


def _round(made: dict[str, list[_Setting]]) -> dict[str, list[float | None]]:
    """Return the time of every method to each error of TARGETS [ms], measured anew."""
    milliseconds: dict[str, list[float | None]] = {}
    for name, settings in made.items():
        needed = _needed([one.error for one in settings])
        times = [(settings[i].error, _took(settings[i].run, settings[i].calls)) for i in needed]
        milliseconds[name] = [_least(times, target) for target in TARGETS]
    return milliseconds


def _needed(errors: list[float]) -> list[int]:
    """Return which settings lie beside an error of TARGETS."""
    firsts = [next((i for i, e in enumerate(errors) if e <= t), None) for t in TARGETS]
    return sorted({j for i in firsts if i is not None for j in (max(i - 1, 0), i)})


def _median(values: list[float | None]) -> float | None:
    known = [v for v in values if v is not None]
    return float(f"{statistics.median(known):.3g}") if known else None


def reference(scene: MovingPair) -> Any:
    """Return delta [mm] at the outputs by RK8 with REFERENCE steps between two of them."""
    import numpy as np

    times = np.linspace(0.0, TIME, OUTPUTS)
    longest = TIME / (OUTPUTS - 1) / REFERENCE
    motion = march(scene, "plane", timeline(scene, times), "rk8", longest, np.zeros(10))
    return motion.delta


def _least(found: list[tuple[float, float]], target: float) -> float | None:
    """Return the time to an error, between two settings by a straight line of the logarithms."""
    for (worse, less), (better, more) in zip([(math.inf, 0.0), *found], found, strict=False):
        if better <= target:
            if not math.isfinite(worse) or worse <= better or more <= less:
                return more
            share = math.log(worse / target) / math.log(worse / better)
            return float(less * (more / less) ** share)
    return None


def _slope(errors: list[float]) -> float | None:
    """Return log2 of the largest fall of an error as the steps are halved."""
    pairs = zip(errors, errors[1:], strict=False)
    falls = [math.log2(a / b) for a, b in pairs if 0.02 > a > b > 1e-9]
    return round(max(falls), 2) if falls else None
