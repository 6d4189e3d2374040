"""Unpruned brute force over trains and modules, with all objectives."""

import math
from dataclasses import replace

import numpy as np
from brute_force import cost, k_factor_width, pairs, side, width
from rated_brute_force import safe, widths


def loss(z1, z2):
    """Friction loss of a mesh in per cent, with a coefficient of friction of 0.06."""
    return 6.0 * math.pi * (1 / z1 + 1 / z2)


def costs(train, k, d, b, z1, z2):
    """Shares of a stage in every objective (n, objectives)."""
    made = [
        loss(z1, z2)
        if name == "mesh_loss"
        else cost(replace(train, objective=name), k, d, b, z2 / z1)
        for name in (train.objective, *train.others)
    ]
    return np.stack(made, axis=1)


def every_choice(train):
    """Teeth (n, stages, 2) and values (n, objectives) of all trains and modules in all limits."""
    count = 1 + len(train.others)
    teeth, values = np.empty((1, 0, 2), np.int64), np.zeros((1, count))
    torque, one = np.array([train.torque]), replace(train, others=())
    for k, stage in enumerate(train.stages):
        owner, z1, z2 = pairs(one, k, teeth[:, :, 0].prod(axis=1), teeth[:, :, 1].prod(axis=1))
        rows = []
        for module in stage.modules:
            d = float(module) * z1 / math.cos(stage.toothing.helix_angle)
            b = width(
                stage, module, z1, k_factor_width(stage, torque[owner], d, float(module), z2 / z1)
            )
            if stage.wheel_diameter is not None:
                b[side(stage.toothing, module, z2, stage.wheel_diameter) > 0] = np.inf
            good = np.flatnonzero(np.isfinite(b))
            own = costs(train, k, d[good], b[good], z1[good], z2[good])
            rows.append((owner[good], z1[good], z2[good], own))
        owner, z1, z2, own = (np.concatenate(column) for column in zip(*rows, strict=True))
        teeth = np.concatenate([teeth[owner], np.stack([z1, z2], axis=1)[:, None]], axis=1)
        values, torque = values[owner] + own, torque[owner] * z2 / z1
    return teeth, values


def unbeaten(teeth, values, tie=1e-9):
    """Rows that no other beats; of equal ones that of fewest teeth, then the least teeth."""
    kept: list[int] = []
    rank = np.lexsort((*[t for t in teeth.reshape(len(teeth), -1).T[::-1]], teeth.sum(axis=(1, 2))))
    place = np.argsort(rank)
    for i in np.lexsort(values.T[::-1]):  # what beats a row comes before it, or is equal to it
        near = values[kept]
        lower = (near <= values[i] * (1 + tie)).all(axis=1)
        if (lower & (near < values[i] * (1 - tie)).any(axis=1)).any():
            continue
        same = [k for k, low in zip(kept, lower, strict=True) if low]
        if same and place[same[0]] < place[i]:
            continue
        kept = [k for k in kept if k not in same] + [i]
    near = values[kept]  # ties of the first objective may have come in another order
    for i in list(kept):
        lower = (near <= values[i] * (1 + tie)).all(axis=1)
        if (lower & (near < values[i] * (1 - tie)).any(axis=1)).any():
            kept.remove(i)
    return sorted(kept, key=lambda i: values[i, 0])


def every_rated_choice(train):
    """Teeth and values, as `every_choice`, of all trains that ratings find safe, each rated alone.

    Of every pair and module the widths are rated from the narrowest on: no objective falls as a
    face grows, so a wider one than the first that is safe is not better.
    """
    one, made = replace(train, others=()), [((), train.torque, np.zeros(1 + len(train.others)))]
    for k in range(len(train.stages)):
        a, b = (np.array([math.prod(z[i] for z in teeth) for teeth, _, _ in made]) for i in (0, 1))
        listed = zip(*pairs(one, k, a, b), strict=True)
        made = [
            ((*made[i][0], (int(z1), int(z2))), made[i][1] * (z2 / z1), made[i][2] + own)
            for i, z1, z2 in listed
            for own in safe_costs(train, k, made[i][1], int(z1), int(z2))
        ]
    count = len(train.stages)
    teeth = np.array([teeth for teeth, _, _ in made], np.int64).reshape(-1, count, 2)
    return teeth, np.array([v for _, _, v in made]).reshape(-1, 1 + len(train.others))


def safe_costs(train, k, torque, z1, z2):
    """Yield the shares of a pair in every objective, of each module at its narrowest safe width."""
    for module in train.stages[k].modules:
        for b in widths(train, k, module, z1):
            if safe(train, k, train.pair(k, float(module), z1, z2, float(b)), torque):
                d = float(module) * z1 / train.stages[k].toothing.cosine
                one = (np.array([v]) for v in (d, float(b), z1, z2))
                yield costs(train, k, *one)[0]
                break
