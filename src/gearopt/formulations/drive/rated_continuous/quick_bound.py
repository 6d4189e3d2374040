"""A quick bound of drives that ratings limit, in a tenth of a second.

What ratings need in few wide cells of torque, ratio and sizes (Lemma 64) holds in narrow cells of
torque and ratio within them, along which the least shares are summed up (Lemma 84).
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from gearopt.formulations.drive.rated_continuous import boxes
from gearopt.formulations.drive.rated_continuous.boxes import B_OVER_D, D2, MARGIN, B, D, M, U, Z
from gearopt.formulations.drive.train import LENGTHS, Train
from gearopt.formulations.strength.cells import Cells
from gearopt.formulations.strength.standard import Option, under_each_load
from gearopt.optimise.terms import Array

WIDE, PARTS = 16, 12  # cells of the logarithm of the total ratio, and narrow ones of each
SIZES, SIZE = 16, 0.15  # cells of ln(d1) below the largest of use, and their width
SLIM, MOST_SLIM = 0.5, 4  # width of cells of ln(b/d1), of at most so many
MOST_KINDS = 6  # toothings and options of a stage that are looked at
EDGE = 1e-9  # cells overlap by this much in logarithms


def quick_bound(train: Train, most: float) -> float:
    """Lower bound of all trains, of which one has an objective of `most`; -inf: none is known."""
    sized = train.by_width or train.objective in LENGTHS
    if not (sized and most < math.inf) or train.lowest_ratio < 1:
        return -math.inf
    kinds = [_kinds(train, k) for k in range(len(train.stages))]
    if not all(kinds):
        return -math.inf
    count, total = WIDE * PARTS, math.log(float(train.highest_ratio))
    to_go = np.full(2 * count + 1, np.inf)
    low = math.log(float(train.lowest_ratio)) - EDGE
    to_go[max(0, math.floor(low / total * count)) : count + 1] = 0.0
    for k in reversed(range(len(train.stages))):
        share = np.minimum.reduce([_shares(kind, k, most) for kind in kinds[k]])
        ahead = sliding_window_view(np.minimum(to_go[:-1], to_go[1:]), count)[: len(share)]
        to_go = np.full(2 * count + 1, np.inf)
        to_go[: len(share)] = (share + ahead).min(axis=1)
    return float(min(to_go[0], most))


def _kinds(train: Train, k: int) -> list[Train]:
    """Drives of one toothing and option of a stage (from 0), one of which costs no more than any.

    Of options with wheels of one price a virtual one, under each load alone, by the last of their
    standards: ISO 6336, if there are two, whose cells take half as long. None where there is no
    such option, too many of them, or where teeth have shifts or centre distances of their own.
    """
    stage, groups = train.stages[k], dict[Any, list[Option]]()
    for option in stage.options:
        alike = groups.setdefault((option.densities[1], option.prices[1]), [])
        alike.append(replace(option, standards=under_each_load(option.standards[-1])))
    best = [first.strongest_with(rest) if rest else first for first, *rest in groups.values()]
    cuts, kinds = stage.toothings, []
    plain = all(cut.shifting is None and cut.working_distance is None for cut in cuts)
    if not plain or stage.ratio[0] < 1 or len(cuts) * len(best) > MOST_KINDS:
        return []
    for strongest, (_, *rest) in zip(best, groups.values(), strict=True):
        if strongest is None:
            return []
        option = strongest.cheapest_with(rest, train.density)
        for cut in cuts:
            kind = replace(stage, options=(option,), toothings=(cut,))
            stages = (*train.stages[:k], kind, *train.stages[k + 1 :])
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
    torque, size = train.torque * np.exp(at + overlap), np.exp(sizes)
    ends = size[Z], size[U], size[D], size[D2], size[M], size[B], size[B_OVER_D]
    stage = train.stages[k]
    cells = Cells(stage.toothing, *ends, torque, train.speed_at(torque)[::-1])
    pressed, bent = (need[:, None, None] for need in boxes.needed_by_cells(train, stage, cells))
    step, part = wide / PARTS, np.arange(PARTS)
    row, column = i[:, None] * PARTS + part[: PARTS if rows else 1], j[:, None] * PARTS + part
    u, t = column[:, None, :] * step, row[:, :, None] * step
    power, grown, _ = boxes.growth(train, k, np.exp(u - EDGE))
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
    power, grown, _ = boxes.growth(train, k, np.exp(sizes[U, 0]))
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
