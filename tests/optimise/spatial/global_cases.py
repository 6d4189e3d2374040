"""Public problems with their known optima, posed through the public words.

Sources: Hock and Schittkowski (1981) by number; MINLPLib; CEC 2020 real-world constrained problems.
"""

import math

import numpy as np

from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var

WHOLE = "whole"
R = (-100.0, 100.0)


def posed(bounds, text, guess=None):
    """Problem of text(x) -> (objective, limits <= 0, equalities = 0), ends (low, high[, WHOLE])."""
    variables = []
    for k, (low, high, *kind) in enumerate(bounds):
        start = guess[k] if guess else round(0.5 * (low + high)) if kind else 0.5 * (low + high)
        variables.append(Var(f"x{k + 1}", "", low, high, start, integer=bool(kind)))

    def evaluate(x, p):
        f, g, h = text([getattr(x, f"x{k + 1}") for k in range(len(bounds))])
        rows = {"g": tuple(1.0 + v for v in g)} if g else {}
        return Terms({"f": f}, rows, equal={"h": tuple(1.0 + v for v in h)} if h else {})

    return Problem("case", tuple(variables), (), evaluate)


def spring(x):
    d, D, n = x
    return (
        (n + 2.0) * D * d**2,
        [
            1.0 - D**3 * n / (71785.0 * d**4),
            (4.0 * D**2 - d * D) / (12566.0 * (D * d**3 - d**4)) + 1.0 / (5108.0 * d**2) - 1.0,
            1.0 - 140.45 * d / (D**2 * n),
            (D + d) / 1.5 - 1.0,
        ],
        [],
    )


def vessel(x):
    a, c = 0.0625 * x[0], 0.0625 * x[1]
    r, length = x[2:]
    cost = 0.6224 * a * r * length + 1.7781 * c * r**2
    cost = cost + 3.1661 * a**2 * length + 19.84 * a**2 * r
    volume = math.pi * r**2 * length + 4.0 / 3.0 * math.pi * r**3
    rows = [0.0193 * r / a - 1.0, 0.00954 * r / c - 1.0, 1296000.0 / volume - 1.0]
    return cost, rows, []


def three_bars(x):
    a, b = x
    root = math.sqrt(2.0)
    sum_of = root * a**2 + 2.0 * a * b
    rows = [(root * a + b) / sum_of * 2.0 - 2.0, b / sum_of * 2.0 - 2.0]
    return (2.0 * root * a + b) * 100.0, [*rows, 1.0 / (a + root * b) * 2.0 - 2.0], []


def reactor(x):
    k = 0.09755988, 0.99 * 0.09755988, 0.0391908, 0.9 * 0.0391908
    rows = [
        x[0] + k[0] * x[0] * x[4] - 1.0,
        x[1] - x[0] + k[1] * x[1] * x[5],
        x[2] + x[0] + k[2] * x[2] * x[4] - 1.0,
        x[3] - x[2] + x[1] - x[0] + k[3] * x[3] * x[5],
    ]
    return -x[3], [np.sqrt(x[4]) + np.sqrt(x[5]) - 4.0], rows


def heat_exchangers(x):
    rows = [
        0.0025 * (x[3] + x[5]) - 1.0,
        0.0025 * (x[4] + x[6] - x[3]) - 1.0,
        0.01 * (x[7] - x[4]) - 1.0,
        (100.0 * x[0] + 833.33252 * x[3] - x[0] * x[5] - 83333.333) / 1e5,
        (1250.0 * x[4] + x[1] * x[3] - x[1] * x[6] - 1250.0 * x[3]) / 1e5,
        (x[2] * x[4] - 2500.0 * x[4] + 1250000.0 - x[2] * x[7]) / 1e6,
    ]
    return x[0] + x[1] + x[2], rows, []


def haverly(x):
    cost = -(9.0 * x[0] + 15.0 * x[1] - 6.0 * x[2] - 16.0 * x[3] - 10.0 * (x[4] + x[5]))
    rows = [
        x[8] * x[6] + 2.0 * x[4] - 2.5 * x[0],
        x[8] * x[7] + 2.0 * x[5] - 1.5 * x[1],
    ]
    equal = [
        x[6] + x[7] - x[2] - x[3],
        x[0] - x[6] - x[4],
        x[1] - x[7] - x[5],
        x[8] * x[6] + x[8] * x[7] - 3.0 * x[2] - x[3],
    ]
    return cost, rows, equal


def valley(x):
    return 100.0 * (x[1] - x[0] ** 2) ** 2 + (1.0 - x[0]) ** 2


def gears(x):
    return (1.0 / 6.931 - x[0] * x[1] / (x[2] * x[3])) ** 2, [], []


def logs_and_product(x):
    total, product = 0.0, 1.0
    for v in x:
        total = total + np.log(v - 2.0) ** 2 + np.log(10.0 - v) ** 2
        product = product * v
    return total - product**0.2, [], []


CASES = {  # name: known optimum, bounds, text, guess
    "threebar": (263.8958433765, [(1e-6, 1.0)] * 2, three_bars, None),
    "vessel": (6059.7143350, [(1, 99, WHOLE)] * 2 + [(10.0, 200.0)] * 2, vessel, None),
    "hs1": (0.0, [(-10.0, 10.0), (-1.5, 10.0)], lambda x: (valley(x), [], []), [-2.0, 1.0]),
    "hs5": (
        -1.9132229550,
        [(-1.5, 4.0), (-3.0, 3.0)],
        lambda x: (
            np.sin(x[0] + x[1]) + (x[0] - x[1]) ** 2 - 1.5 * x[0] + 2.5 * x[1] + 1.0,
            [],
            [],
        ),
        [0.0, 0.0],
    ),
    "hs7": (
        -math.sqrt(3.0),
        [R] * 2,
        lambda x: (np.log(1 + x[0] ** 2) - x[1], [], [(1 + x[0] ** 2) ** 2 + x[1] ** 2 - 4.0]),
        [2.0, 2.0],
    ),
    "hs15": (
        306.5,
        [(-100.0, 0.5), R],
        lambda x: (valley(x), [1.0 - x[0] * x[1], -x[0] - x[1] ** 2], []),
        [-2.0, 1.0],
    ),
    "hs33": (
        math.sqrt(2.0) - 6.0,
        [(0.0, 10.0), (0.0, 10.0), (0.0, 5.0)],
        lambda x: (
            (x[0] - 1.0) * (x[0] - 2.0) * (x[0] - 3.0) + x[2],
            [x[0] ** 2 + x[1] ** 2 - x[2] ** 2, 4.0 - x[0] ** 2 - x[1] ** 2 - x[2] ** 2],
            [],
        ),
        [0.0, 0.0, 3.0],
    ),
    "gears": (2.700857148886e-12, [(12, 60, WHOLE)] * 4, gears, None),
    "nvs16": (
        0.703125,
        [(0, 200, WHOLE)] * 2,
        lambda x: (
            (1.5 - x[0] * (1 - x[1])) ** 2
            + (2.25 - x[0] * (1 - x[1] ** 2)) ** 2
            + (2.625 - x[0] * (1 - x[1] ** 3)) ** 2,
            [],
            [],
        ),
        None,
    ),
    "kinks": (
        -0.75,
        [(-3.0, 3.0)] * 2,
        lambda x: (
            x[0] ** 2 - abs(x[0]) + 0.5 * x[1] ** 2 - np.maximum(x[1], -x[1]),
            [],
            [],
        ),
        [0.0, 0.0],
    ),
    "spring": (0.0126652328, [(0.05, 2.0), (0.25, 1.3), (2.0, 15.0)], spring, None),
    "reactor": (-0.3888114343, [(0.0, 1.0)] * 4 + [(1e-5, 16.0)] * 2, reactor, None),
    "haverly": (
        -400.0,
        [(0.0, 100.0), (0.0, 200.0), *[(0.0, 100.0)] * 4, (0.0, 200.0), (0.0, 100.0), (0.0, 200.0)],
        haverly,
        None,
    ),
    "heat exchangers": (
        7049.2480205,
        [(100.0, 1e4), (1e3, 1e4), (1e3, 1e4)] + [(10.0, 1e3)] * 5,
        heat_exchangers,
        [5000.0, 5000.0, 5000.0, 200.0, 350.0, 150.0, 225.0, 425.0],
    ),
    "nvs09": (-43.13433692, [(3, 9, WHOLE)] * 10, logs_and_product, None),
    "hs62": (
        -26272.51448,
        [(1e-9, 1.0)] * 3,
        lambda x: (
            -32.174
            * (
                255.0 * np.log((x[0] + x[1] + x[2] + 0.03) / (0.09 * x[0] + x[1] + x[2] + 0.03))
                + 280.0 * np.log((x[1] + x[2] + 0.03) / (0.07 * x[1] + x[2] + 0.03))
                + 290.0 * np.log((x[2] + 0.03) / (0.13 * x[2] + 0.03))
            ),
            [],
            [x[0] + x[1] + x[2] - 1.0],
        ),
        [0.7, 0.2, 0.1],
    ),
    "goldstein": (
        3.0,
        [(-2.0, 2.0)] * 2,
        lambda x: (
            (
                1
                + (x[0] + x[1] + 1) ** 2
                * (19 - 14 * x[0] + 3 * x[0] ** 2 - 14 * x[1] + 6 * x[0] * x[1] + 3 * x[1] ** 2)
            )
            * (
                30
                + (2 * x[0] - 3 * x[1]) ** 2
                * (18 - 32 * x[0] + 12 * x[0] ** 2 + 48 * x[1] - 36 * x[0] * x[1] + 27 * x[1] ** 2)
            ),
            [],
            [],
        ),
        None,
    ),
}
QUICK = ("threebar", "vessel", "hs1", "hs5", "hs7", "hs15", "hs33", "nvs16", "kinks", "haverly")


def case(name):
    """Known optimum and problem of a case."""
    best, bounds, text, guess = CASES[name]
    return best, posed(bounds, text, guess)
