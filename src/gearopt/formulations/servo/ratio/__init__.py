"""The total ratio of a servo train: for acceleration, for a move, for a swinging duty.

Each is a posynomial problem for `ipopt` and `gp`, and a closed form or root (`exact`) with a bound
of its own; the two share nothing but the laws. A larger ratio gives more torque at the load and
more reflected motor inertia, so there is a best one; without motor inertia, torque line and speed
limit there is none, which is reported. `ServoDuty` is one of the three with its numbers.
"""

from gearopt.formulations.servo.ratio.acceleration import acceleration, best_ratio
from gearopt.formulations.servo.ratio.drive import Drive
from gearopt.formulations.servo.ratio.duty import ServoDuty
from gearopt.formulations.servo.ratio.move import least_move_time
from gearopt.formulations.servo.ratio.swing import swing

__all__ = ["Drive", "ServoDuty", "acceleration", "best_ratio", "least_move_time", "swing"]
