"""The total ratio of a servo train: for acceleration, for a move, for a swinging duty.

Each is a posynomial problem for `ipopt` and `gp`, and a closed form (`exact`) with a bound of its
own; the two share nothing but the laws. `staged` splits the ratio at once and has no closed form.
A larger ratio gives more torque at the load and more reflected motor inertia, so there is a best
one; without motor inertia, torque line and speed limit there is none, which is reported.
"""

from gearopt.formulations.ratio.acceleration import acceleration, best_ratio
from gearopt.formulations.ratio.drive import Drive
from gearopt.formulations.ratio.move import move
from gearopt.formulations.ratio.staged import staged
from gearopt.formulations.ratio.swing import swing

__all__ = ["Drive", "acceleration", "best_ratio", "move", "staged", "swing"]
