"""What the gears of a stage add to the objective of a drive."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gearopt.formulations.strength.rated import Option
from gearopt.physics.gears import GearPair

if TYPE_CHECKING:
    from gearopt.formulations.gear_train import Train

OBJECTIVES = {  # name -> unit
    "gear_volume": "mm3",
    "mass": "kg",
    "sum_of_centre_distances": "mm",
    "total_length": "mm",
    "cost": "",
}
LENGTHS = ("sum_of_centre_distances", "total_length")  # objectives along the line of centres
MASSES = ("mass", "cost")  # objectives of gears as heavy as their blanks


def share(train: "Train", stage: int, pair: GearPair, density: Any = None, option: int = 0) -> Any:
    """Return what the pair of a stage (counted from 0) adds to the objective, in its unit.

    density [t/mm3], by default the train's; those of the stage's option come first. total_length is
    that of the shafts in one line, from the rim of the first pinion to that of the last wheel over
    reference circles: d1/2 + sum of centre distances + d2/2.
    """
    if train.objective in MASSES:
        rows = zip(train.stages[stage].blanks, pair.gears, strict=True)
        volumes = [blank.volume(gear) for blank, gear in rows]
        return _worth(train, stage, volumes, density, option)
    if train.objective == "gear_volume":
        return pair.volume
    length = pair.centre_distance
    if train.objective == "total_length" and stage == 0:
        length = length + 0.5 * pair.pinion.reference_diameter
    if train.objective == "total_length" and stage == len(train.stages) - 1:
        length = length + 0.5 * pair.wheel.reference_diameter
    return length


def least_share(
    train: "Train",
    stage: int,
    pair: GearPair,
    density: Any = None,
    option: int = 0,
    fewest: Sequence[Any] | None = None,
) -> Any:
    """Return a lower bound of `share` that grows with every size of the pair; equal of solid gears.

    fewest: least numbers of teeth of pinion and wheel; None: unknown, then it is proportional to
    b d1^2 at a given ratio.
    """
    blanks = train.stages[stage].blanks
    if not train.hollow:
        return share(train, stage, pair, density, option)
    if fewest is None:
        rows = zip(blanks, pair.gears, strict=True)
        volumes = [blank.least_fraction * gear.volume for blank, gear in rows]
    else:
        each_ = zip(blanks, pair.gears, fewest, strict=True)
        volumes = [blank.least_volume(gear, teeth) for blank, gear, teeth in each_]
    return _worth(train, stage, volumes, density, option)


def _worth(train: "Train", stage: int, volumes: Sequence[Any], density: Any, option: int) -> Any:
    """Return mass [kg] or cost of gears of these volumes [mm3] of a stage."""
    usual: Any = train.density if density is None else density
    options = train.stages[stage].options
    own = options[option] if options else Option(())
    rows = zip(volumes, own.densities, own.prices, strict=True)
    masses = [(1000.0 * (rho or usual) * volume, price) for volume, rho, price in rows]
    return sum(kg if train.objective == "mass" else kg * price for kg, price in masses)
