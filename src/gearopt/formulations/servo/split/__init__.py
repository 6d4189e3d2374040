"""How a servo train's ratio is split: stages, whole teeth, modules, widths and the middle shaft.

`core`: number of stages and ratios alone. `problem`: whole teeth and modules of two stages, proven
by enumeration; `relaxation`: its bound as a geometric program. `stiff`: real sizes of minimum mass
under a frequency or stiffness. `staged`: total ratio and its split at once, of real-valued gears.
"""

from gearopt.formulations.servo.split.bodies import Bodies
from gearopt.formulations.servo.split.core import (
    core,
    first_ratio,
    lightest_stage_ratio,
    stage_counts,
    staged,
)
from gearopt.formulations.servo.split.numbers import posed
from gearopt.formulations.servo.split.relaxation import relaxation
from gearopt.formulations.servo.split.servo_train import ServoTrain
from gearopt.formulations.servo.split.stiff import StiffTrain, stiff
from gearopt.formulations.servo.split.teeth import feasible, points, problem, trains

__all__ = [
    "Bodies",
    "ServoTrain",
    "StiffTrain",
    "core",
    "feasible",
    "first_ratio",
    "lightest_stage_ratio",
    "points",
    "posed",
    "problem",
    "relaxation",
    "stage_counts",
    "staged",
    "stiff",
    "trains",
]
