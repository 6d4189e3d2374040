"""Every candidate of a small rated drive, each rated by the standard one at a time."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
from blank_rings import backup, rings, volume

from gearopt.formulations.drive.shares import objective_share
from gearopt.formulations.drive.teeth.columns import spans
from gearopt.formulations.drive.teeth.search import within
from gearopt.formulations.strength.iso6336 import Iso6336
from gearopt.physics.agma.rating import rate as agma_rate
from gearopt.physics.agma.rating import rate_spectrum as agma_spectrum
from gearopt.physics.agma.refusals import single_factors
from gearopt.physics.iso6336 import chain
from gearopt.physics.iso6336.case import Case, check
from gearopt.physics.iso6336.rating import rate_spectrum as iso_spectrum
from gearopt.physics.iso6336.refusals import refuse
from gearopt.physics.rating import Operation


def safe(train, k, pair, torque):
    """Return whether the exact ratings of a pair meet the safety factors."""
    speed = train.speed * train.torque / torque
    for standard in train.stages[k].options[0].standards:
        iso = isinstance(standard, Iso6336)
        made = standard.materials if iso else standard.steels, practice(train, k, pair, standard)
        overload = standard.operation.overload
        operations = [
            Operation(
                load.power * torque * speed, load.speed * speed, load.hours, overload=overload
            )
            for load in standard.loads
        ]
        if len(operations) > 1:
            found = (iso_spectrum if iso else agma_spectrum)(pair, tuple(operations), *made)
            bending, contact = found.bending_safety, found.contact_safety
        else:
            bending, contact = (iso_safeties if iso else agma_safeties)(pair, operations[0], *made)
        more = standard.safety if iso else (1.0, 1.0)
        bending, contact = min(bending) / more[0], min(contact) / more[1]
        if min(bending / train.safety[0], contact / train.safety[1]) < 1.0 - 1e-11:
            return False
    return True


def agma_safeties(pair, operation, steels, practice):
    """Return S_F and S_H of both gears; I and J of a pair are the same at every load."""
    found = agma_rate(pair, operation, steels, practice, geometry(pair, practice.load))
    return found.bending_safety, found.contact_safety


@cache
def geometry(pair, load):
    """Return I and J of a pair by symbol."""
    factors = single_factors(pair, load)
    return {"I": float(factors.pitting), "J": tuple(float(j) for j in factors.bending)}


def iso_safeties(pair, operation, materials, practice):
    """Return S_F and S_H of both gears as `iso6336.rating.rate` does, without their lives."""
    check(practice)
    refuse(pair, practice)
    found = chain.quantities(Case(pair, operation, materials, practice))
    names = ("sigma_FG", "sigma_F"), ("sigma_HG", "sigma_H")
    return [[a / b for a, b in zip(found[s], found[t], strict=True)] for s, t in names]


def practice(train, k, pair, standard):
    """Return how a pair of teeth without shift is rated, its rims as `blank_rings` has them."""
    m, blanks = pair.normal_module, train.stages[k].blanks
    each = list(zip(blanks, pair.gears, strict=True))
    ratios = [backup(blank, m, gear.reference_diameter) for blank, gear in each]
    made = replace(standard.practice, backup=tuple(ratios))
    if not isinstance(standard, Iso6336):
        return made
    webs, bores = [], []
    for blank, gear in each:
        parts = rings(blank, m, gear.reference_diameter)
        webbed, (d, inside, _) = len(parts) == 3, parts[0]
        webs.append((blank.web_over_width, (d - inside) / 2 / m - 1.25) if webbed else None)
        bores.append(inside if blank.web_over_width < 1.0 or not webbed else blank.bore)
    return replace(made, webs=tuple(webs), bores=tuple(bores))


def widths(train, k, module, z1):
    """Return the face widths to be tried: those on the step, or a fine grid."""
    face = train.stages[k].face_width
    if face.fixed:
        return np.array([float(face.fixed)])
    d = float(module) * z1 / train.stages[k].toothing.cosine
    low, high = float(face.low) * d, float(face.high) * d
    if face.step:
        step = float(face.step)
        return step * np.arange(math.ceil(low / step - 1e-12), math.floor(high / step + 1e-12) + 1)
    return np.linspace(low, high, 1 if face.tied else 60)


def least_share(train, k, torque, z1, z2, most=math.inf):
    """Return the least share of a pair over modules and widths, rated from the cheapest on.

    inf where none below `most` is safe.
    """
    found = []
    for module in train.stages[k].modules:
        for width in widths(train, k, module, z1):
            pair = train.pair(k, float(module), z1, z2, float(width))
            value = worth(train, k, pair)
            found += [(value, len(found), pair)] if value < most else []
    return next((value for value, _, p in sorted(found) if safe(train, k, p, torque)), math.inf)


def worth(train, k, pair):
    """Share of a pair in the objective: cost and masses of webs by hand."""
    if train.objective == "cost":
        return sum(costs(train, k, pair))
    return sum(masses(train, k, pair)) if train.hollow else objective_share(train, k, pair)


def masses(train, k, pair):
    """Return the masses [kg] of a pair in rings."""
    m, b = pair.normal_module, pair.face_width
    each = zip(train.stages[k].blanks, pair.gears, strict=True)
    densities = [own or train.density for own in train.stages[k].options[0].densities]
    volumes = [volume(blank, m, gear.reference_diameter, b) for blank, gear in each]
    return [1000 * rho * v for rho, v in zip(densities, volumes, strict=True)]


def costs(train, k, pair):
    """Return the costs of a pair: kilograms at their price, and metres of teeth cut at theirs."""
    made, teeth = train.stages[k].options[0], (pair.pinion_teeth, pair.wheel_teeth)
    metres = [z * pair.face_width / 1000 for z in teeth]
    rows = zip(masses(train, k, pair), made.prices, metres, made.cutting_prices, strict=True)
    return [kg * price + cut * per_metre for kg, price, cut, per_metre in rows]


def cheapest(train):
    """Return the least objective of all trains; inf where none is safe."""
    every = [
        [(z1, z2) for z1, a, b in spans(train, k, train.highest_ratio) for z2 in range(a, b + 1)]
        for k in range(len(train.stages))
    ]

    def onward(k, torque, teeth, most):
        """The least objective of the stages from k on; inf where it is not below `most`."""
        if k == len(every):
            return 0.0 if within(train, teeth) else math.inf
        best, last = most, k == len(every) - 1
        for z1, z2 in every[k]:
            if last and not within(train, (*teeth, (z1, z2))):
                continue
            own = least_share(train, k, torque, z1, z2, best)
            if own < best:
                rest = onward(k + 1, torque * (z2 / z1), (*teeth, (z1, z2)), best - own)
                best = min(best, own + rest)
        return best if best < most else math.inf

    return onward(0, train.torque, (), math.inf)
