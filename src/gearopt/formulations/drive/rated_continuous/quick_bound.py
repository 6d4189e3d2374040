"""A quick bound of drives that ratings limit, in a tenth of a second or, of many ways, half of one.

What ratings need in few wide cells of torque, ratio and sizes (Lemma 64) holds in narrow cells of
torque and ratio within them, along which the least shares are summed up (Lemma 84).
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from gearopt.formulations.drive.rated_continuous import boxes, ways
from gearopt.formulations.drive.rated_continuous.boxes import B_OVER_D, MARGIN, D, U
from gearopt.formulations.drive.train import LENGTHS, Train
from gearopt.formulations.strength.standard import Option, under_each_load
from gearopt.optimise.terms import Array

WIDE, PARTS = 16, 12  # cells of the logarithm of the total ratio, and narrow ones of each
SIZES, SIZE = 16, 0.15  # cells of ln(d1) below the largest of use, and their width
SLIM, MOST_SLIM = 0.5, 4  # width of cells of ln(b/d1), of at most so many
MOST_KINDS = ways.FEW  # ways and options of a stage that are looked at at first
# looks at the kinds of the least sum, up to so much of a known value, and toothings for several
DIVISIONS, NEAR, MANY_WAYS = 6, 0.9, 60
EDGE = 1e-9  # cells overlap by this much in logarithms


def quick_bound(train: Train, most: float) -> float:
    """Lower bound of all trains, of which one has an objective of `most`; -inf: none is known.

    Of stages with many ways the kinds of the least sum are divided, a few times.
    """
    sized = train.by_width or train.objective in LENGTHS
    idle = any(option.idler or option.planets for stage in train.stages for option in stage.options)
    raised = train.lowest_ratio < 1 or train.driver == "wheel"
    if not (sized and most < math.inf) or raised or idle:
        return -math.inf
    count = len(train.stages)
    kinds = [[(kind, _shares(kind, k, most)) for kind in _kinds(train, k)] for k in range(count)]
    if not all(kinds):
        return -math.inf
    many = max(len(stage.toothings) for stage in train.stages) > MANY_WAYS
    for left in reversed(range(DIVISIONS if many else 1)):
        value, path = _least_sum(train, [[share for _, share in of_stage] for of_stage in kinds])
        if value >= most * NEAR or not left or not path:
            break
        divided = False
        for k, cell in enumerate(path):
            place = int(np.argmin([share[cell] for _, share in kinds[k]]))
            halves = [
                replace(train, stages=(*train.stages[:k], way, *train.stages[k + 1 :]))
                for way in ways.halves(kinds[k][place][0].stages[k])
            ]
            if halves:
                kinds[k][place : place + 1] = [(half, _shares(half, k, most)) for half in halves]
                divided = True
        if not divided:
            break
    return min(value, most)


def _least_sum(train: Train, shares: list[list[Array]]) -> tuple[float, list[tuple[int, int]]]:
    """Least sum of shares along cells that meet, and the cells of it: none of an infinite one."""
    count, total = WIDE * PARTS, math.log(float(train.highest_ratio))
    end = np.full(2 * count + 1, np.inf)
    low = math.log(float(train.lowest_ratio)) - EDGE
    end[max(0, math.floor(low / total * count)) : count + 1] = 0.0
    sums, to_go = list[Array](), end
    for rows in reversed(shares):
        share = np.minimum.reduce(rows)
        ahead = sliding_window_view(np.minimum(to_go[:-1], to_go[1:]), count)[: len(share)]
        sums.insert(0, share + ahead)
        to_go = np.full(2 * count + 1, np.inf)
        to_go[: len(share)] = sums[0].min(axis=1)
    value, row, path = float(to_go[0]), 0, list[tuple[int, int]]()
    for later, total_sum in zip([*sums[1:], None], sums, strict=True):
        column = int(total_sum[row].argmin())
        path.append((row, column))
        if later is not None:
            nexts = [n for n in (row + column, row + column + 1) if n < len(later)]
            row = min(nexts, key=lambda n: float(later[n].min()))
    return value, path if value < math.inf else []


def _kinds(train: Train, k: int) -> list[Train]:
    """Drives of one way and option of a stage (from 0), one of which costs no more than any.

    Of options with wheels of one price a virtual one, under each load alone, by the last of their
    standards: ISO 6336, if there are two, whose cells take half as long. None where there is no
    such option, or too many ways.
    """
    stage, groups = train.stages[k], dict[Any, list[Option]]()
    for option in stage.options:
        alike = groups.setdefault((option.densities[1], option.prices[1]), [])
        alike.append(replace(option, standards=under_each_load(option.standards[-1])))
    best = [first.strongest_with(rest) if rest else first for first, *rest in groups.values()]
    cuts, kinds = ways.of(train, stage), []
    if stage.ratio[0] < 1 or len(cuts) * len(best) > MOST_KINDS:
        return []
    for strongest, (_, *rest) in zip(best, groups.values(), strict=True):
        if strongest is None:
            return []
        option = strongest.cheapest_with(rest, train.density)
        for way in cuts:
            stages = (*train.stages[:k], replace(way, options=(option,)), *train.stages[k + 1 :])
            kinds.append(replace(train, stages=stages, same_option=False, distances=()))
    return kinds


def _shares(train: Train, k: int, most: float) -> Array:
    """Least shares of a stage in narrow cells of torque and of ratio; inf: above most, or none.

    The torque of the first stage is one number.
    """
    rows = 0 if k == 0 else 1
    wide, low = _wide(train), math.log(float(train.lowest_ratio)) - EDGE
    i, j = np.indices((WIDE if rows else 1, WIDE)).reshape(2, -1)
    reached = k < len(train.stages) - 1 or (i + rows + j + 1) * wide >= low
    keep = (i + j <= WIDE) & reached
    sizes, i, j = _sizes(train, k, most, i[keep], j[keep])
    share = np.full((WIDE * PARTS if rows else 1, WIDE * PARTS), np.inf)
    if not len(i):
        return share
    at, overlap = np.stack([i, i + rows]) * wide, EDGE * np.array([[-1.0], [1.0]])
    stage, size = train.stages[k], np.exp(sizes)
    cells = boxes.cells_of(train, k, sizes, at + overlap)
    pressed, bent = (need[:, None, None] for need in boxes.needed_by_cells(train, stage, cells))
    step, part = wide / PARTS, np.arange(PARTS)
    row, column = i[:, None] * PARTS + part[: PARTS if rows else 1], j[:, None] * PARTS + part
    u, t = column[:, None, :] * step, row[:, :, None] * step
    first, second = (np.reshape(s, (-1, 1, 1)) for s in boxes.body_squares(stage, sizes))
    power, grown, _ = boxes.growth(train, k, np.exp(u - EDGE), (first, second))
    need = np.maximum(pressed * (1.0 + np.exp(-u - step - EDGE)), bent)
    need = need * train.torque * np.exp(t - EDGE) * (1.0 - MARGIN)  # of d1^2 b
    least, largest = np.exp(3.0 * sizes[D] + sizes[B_OVER_D])[:, :, None, None]
    (lowest, highest), thick = sizes[U][:, :, None, None], size[B_OVER_D, 1][:, None, None]
    inside = (need <= largest) & (u + step >= lowest - EDGE) & (u <= highest + EDGE)
    need = np.maximum(need, least) / (1.0 if train.by_width else thick)
    value = np.where(inside, need**power * grown * (1.0 - MARGIN), np.inf)
    np.minimum.at(share, (row[:, :, None], column[:, None, :]), value)
    return np.where(share <= most, share, np.inf)


def _wide(train: Train) -> float:
    """Width of a wide cell in logarithms."""
    return math.log(float(train.highest_ratio)) / WIDE


def _sizes(train: Train, k: int, most: float, i: Any, j: Any) -> tuple[Array, Any, Any]:
    """Ends (rows, 2, n) of `boxes.ROWS` in wide cells of torque i and ratio j, and these (n,)."""
    every = boxes.first_boxes(boxes.shafts_about(train, 1), k).sizes[:, :, 0]
    face, wide, (thin, thick) = train.stages[k].face_width, _wide(train), every[B_OVER_D]
    slims = max(1, min(MOST_SLIM, math.ceil((thick - thin) / SLIM)))
    slim, size = (np.tile(n.ravel(), len(i)) for n in np.indices((slims, SIZES)))
    i, j = (np.repeat(n, slims * SIZES) for n in (i, j))
    sizes = np.repeat(every[:, :, None], len(i), axis=2)
    sizes[U, 0] = np.maximum(every[U, 0], j * wide - EDGE)
    sizes[U, 1] = np.minimum(every[U, 1], (j + 1) * wide + EDGE)
    sizes[B_OVER_D] = thin + (thick - thin) / slims * np.stack([slim, slim + 1])
    bodies = boxes.body_squares(train.stages[k], sizes)
    power, grown, _ = boxes.growth(train, k, np.exp(sizes[U, 0]), bodies)
    largest = np.log(most / grown) / power  # of d1^2 b; of lengths d1^3
    if face.fixed is not None and train.by_width:
        largest = (largest - math.log(float(face.fixed))) / 2.0
    else:
        largest = (largest - (sizes[B_OVER_D, 0] if train.by_width else 0.0)) / 3.0
    sizes[D, 1] = np.minimum(every[D, 1], largest + MARGIN - SIZE * size)
    sizes[D, 0] = np.where(size < SIZES - 1, sizes[D, 1] - SIZE, every[D, 0])
    boxes.follow(train, k, sizes)
    some = boxes.possible(sizes)
    return sizes[:, :, some], i[some], j[some]
