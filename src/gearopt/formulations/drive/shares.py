"""Shares of the stages in the objective of a drive."""

import math
from collections.abc import Sequence
from typing import Any

from gearopt.formulations.drive.train import MASSES, WEIGHTED, Train
from gearopt.formulations.strength.standard import Option
from gearopt.physics.gears import GearPair

FRICTION = 0.06  # coefficient of friction of `mesh_loss`


def objective_share(
    train: Train,
    stage: int,
    pair: GearPair,
    density: Any = None,
    option: int = 0,
    objective: str | None = None,
) -> Any:
    """Share of the pair of a stage (counted from 0) in an objective, in its unit.

    density [t/mm3], by default the train's; those of the stage's option come first. objective: by
    default the train's. total_length is that of the shafts in one line, from the rim of the first
    gear to that of the last one over reference circles: d1/2 + sum of centre distances + d2/2.
    Given centre distances count as they are given.
    mesh_loss is the power lost by tooth friction, in per cent of the input power: FRICTION pi
    (1/z1 + 1/z2).
    """
    objective = objective or train.objective
    if objective == WEIGHTED:
        return sum(
            w * objective_share(train, stage, pair, density, option, n) for n, w in train.weights
        )
    if (planets := _making(train, stage, option).planets) is not None:
        return _of_planets(train, stage, pair, planets, density, option, objective)
    idler = _idler(train, stage, pair, option)
    if objective in MASSES:
        rows = zip(train.stages[stage].blanks, pair.gears, strict=True)
        volumes = [blank.volume(gear) for blank, gear in rows]
        volumes[1] = volumes[1] + idler
        worth = _worth(train, stage, volumes, density, option, objective)
        return worth + (_making(train, stage, option).cutting(pair) if objective == "cost" else 0.0)
    if objective == "gear_volume":
        return pair.volume + idler
    if objective == "mesh_loss":
        return 100.0 * FRICTION * math.pi * (1.0 / pair.pinion_teeth + 1.0 / pair.wheel_teeth)
    length = pair.centre_distance
    if pair.working_distance is not None:  # one of all pairs, of each its own
        length = length + 0.0 * pair.pinion.reference_diameter
    first, last = pair.gears if train.driver == "pinion" else pair.gears[::-1]
    if objective == "total_length" and stage == 0:
        length = length + 0.5 * first.reference_diameter
    if objective == "total_length" and stage == len(train.stages) - 1:
        length = length + 0.5 * last.reference_diameter
    return length


def _of_planets(
    train: Train,
    stage: int,
    pair: GearPair,
    planets: Any,
    density: Any,
    option: int,
    objective: str,
) -> Any:
    """Share of a stage with planets, or of a pinion in a ring; the rolling power counts as loss."""
    if objective == "mesh_loss":
        return 100.0 * FRICTION * math.pi * planets.loss(pair)
    if objective == "gear_volume":
        return sum(planets.volumes(pair, solid=True))
    return _worth(train, stage, planets.volumes(pair), density, option, objective)


def _idler(train: Train, stage: int, pair: GearPair, option: int) -> Any:
    """Volume [mm3] of the idler of an option; 0 where there is none."""
    options = train.stages[stage].options
    teeth = options[option].idler if options else 0
    return pair.pinion.volume * (teeth / pair.pinion_teeth) ** 2 if teeth else 0.0


def least_share(
    train: Train,
    stage: int,
    pair: GearPair,
    density: Any = None,
    option: int = 0,
    fewest: Sequence[Any] | None = None,
    objective: str | None = None,
) -> Any:
    """Lower bound of a share that grows with every size of the pair, without what cutting costs.

    Equal of solid gears, and of planets, but for that. fewest: least numbers of teeth of pinion and
    wheel; None: unknown, then it is proportional to b d1^2 at a given ratio.
    """
    objective, blanks = objective or train.objective, train.stages[stage].blanks
    if objective == WEIGHTED:
        rest = density, option, fewest
        return sum(w * least_share(train, stage, pair, *rest, n) for n, w in train.weights)
    if objective == "mesh_loss" and fewest is None:
        return 0.0 * pair.volume  # it falls with more teeth
    planets = _making(train, stage, option).planets
    if planets is not None and fewest is None:  # of teeth that are no numbers of planets
        return 0.0 * pair.volume
    if objective not in MASSES or planets is not None:
        return objective_share(train, stage, pair, density, option, objective)
    if not train.hollow:
        volumes = [gear.volume for gear in pair.gears]
    elif fewest is None:
        rows = zip(blanks, pair.gears, strict=True)
        volumes = [blank.least_fraction * gear.volume for blank, gear in rows]
    else:
        each_ = zip(blanks, pair.gears, fewest, strict=True)
        volumes = [blank.least_volume(gear, teeth) for blank, gear, teeth in each_]
    return _worth(train, stage, volumes, density, option, objective)


def _worth(
    train: Train, stage: int, volumes: Sequence[Any], density: Any, option: int, objective: str
) -> Any:
    """Return mass [kg] or cost of gears of these volumes [mm3] of a stage, its cutting left out."""
    usual: Any = train.density if density is None else density
    making = _making(train, stage, option)
    rows = zip(volumes, making.densities, making.prices, strict=True)
    masses = [(1000.0 * (rho or usual) * volume, price) for volume, rho, price in rows]
    return sum(kg if objective == "mass" else kg * price for kg, price in masses)


def _making(train: Train, stage: int, option: int) -> Option:
    """The way of making the gears of a stage."""
    options = train.stages[stage].options
    return options[option] if options else Option(())
