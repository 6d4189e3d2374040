"""Problems of Hock and Schittkowski by number, with their optima and starting points.

W. Hock, K. Schittkowski, Test Examples for Nonlinear Programming Codes, Springer 1981. Variables
without bounds there have wide ones here.
"""

import math
from typing import Any

import numpy as np

from gearopt.bench.public.case import Case, real

WIDE = real(-100, 100)


def valley(x: Any, y: Any) -> Any:
    """Rosenbrock's function."""
    return 100 * (y - x**2) ** 2 + (1 - x) ** 2


def wave(x: Any, y: Any) -> Any:
    """McCormick's function."""
    return np.sin(x + y) + (x - y) ** 2 - 1.5 * x + 2.5 * y + 1


def yields(a: Any, b: Any, c: Any) -> tuple[Any, list[Any]]:
    """Problem 62."""
    first = (a + b + c + 0.03) / (0.09 * a + b + c + 0.03)
    second = (b + c + 0.03) / (0.07 * b + c + 0.03)
    third = (c + 0.03) / (0.13 * c + 0.03)
    sales = 255 * np.log(first) + 280 * np.log(second) + 290 * np.log(third)
    return -32.174 * sales, [a + b + c == 1]


def transformer(a: Any, b: Any, c: Any, d: Any, e: Any, f: Any) -> tuple[Any, list[Any]]:
    """Problem 93."""
    inner, outer = a * d * (a + b + c), b * c * (a + 1.57 * b + d)
    cost = 0.0204 * inner + 0.0187 * outer + 0.0607 * inner * e**2 + 0.0437 * outer * f**2
    return cost, [
        0.001 * a * b * c * d * e * f >= 2.07,
        0.00062 * inner * e**2 + 0.00058 * outer * f**2 <= 1,
    ]


def seven(a: Any, b: Any, c: Any, d: Any, e: Any, f: Any, g: Any) -> tuple[Any, list[Any]]:
    """Problem 100."""
    cost = (a - 10) ** 2 + 5 * (b - 12) ** 2 + c**4 + 3 * (d - 11) ** 2 + 10 * e**6
    return cost + 7 * f**2 + g**4 - 4 * f * g - 10 * f - 8 * g, [
        2 * a**2 + 3 * b**4 + c + 4 * d**2 + 5 * e <= 127,
        7 * a + 3 * b + 10 * c**2 + d - e <= 282,
        23 * a + b**2 + 6 * f**2 - 8 * g <= 196,
        4 * a**2 + b**2 - 3 * a * b + 2 * c**2 + 5 * f - 11 * g <= 0,
    ]


def reactors(*x: Any) -> tuple[Any, list[Any]]:
    """Problem 104."""
    a, b, c, d, e, f, g, h = x
    cost = 0.4 * a**0.67 * g**-0.67 + 0.4 * b**0.67 * h**-0.67 + 10 - a - b
    return cost, [
        0.0588 * e * g + 0.1 * a <= 1,
        0.0588 * f * h + 0.1 * a + 0.1 * b <= 1,
        4 * c / e + 2 * c**-0.71 / e + 0.0588 * c**-1.3 * g <= 1,
        4 * d / f + 2 * d**-0.71 / f + 0.0588 * d**-1.3 * h <= 1,
    ]


def hexagon(*x: Any) -> tuple[Any, list[Any]]:
    """Problem 108: a hexagon of diameter 1; the optimum is a triangle that is gone around twice."""
    a, b, c, d, e, f, g, h, i = x
    area = 0.5 * (a * d - b * c + c * i - e * i + e * h - f * g)
    return -area, [
        c**2 + d**2 <= 1,
        e**2 + f**2 <= 1,
        (a - e) ** 2 + (b - f) ** 2 <= 1,
        (a - g) ** 2 + (b - h) ** 2 <= 1,
        (c - e) ** 2 + (d - f) ** 2 <= 1,
        (c - g) ** 2 + (d - h) ** 2 <= 1,
        a**2 + (b - i) ** 2 <= 1,
        g**2 + (h - i) ** 2 <= 1,
        i**2 <= 1,
        a * d - b * c >= 0,
        c * i >= 0,
        e * i <= 0,
        e * h - f * g >= 0,
    ]


def ten(*x: Any) -> tuple[Any, list[Any]]:
    """Problem 113."""
    a, b, c, d, e, f, g, h, i, j = x
    cost = a**2 + b**2 + a * b - 14 * a - 16 * b + (c - 10) ** 2 + 4 * (d - 5) ** 2 + (e - 3) ** 2
    cost = cost + 2 * (f - 1) ** 2 + 5 * g**2 + 7 * (h - 11) ** 2 + 2 * (i - 10) ** 2
    return cost + (j - 7) ** 2 + 45, [
        4 * a + 5 * b - 3 * g + 9 * h <= 105,
        10 * a - 8 * b - 17 * g + 2 * h <= 0,
        -8 * a + 2 * b + 5 * i - 2 * j <= 12,
        3 * (a - 2) ** 2 + 4 * (b - 3) ** 2 + 2 * c**2 - 7 * d <= 120,
        5 * a**2 + 8 * b + (c - 6) ** 2 - 2 * d <= 40,
        0.5 * (a - 8) ** 2 + 2 * (b - 4) ** 2 + 3 * e**2 - f <= 30,
        a**2 + 2 * (b - 2) ** 2 - 2 * a * b + 14 * e - 6 * f <= 0,
        -3 * a + 6 * b + 12 * (i - 8) ** 2 - 7 * j <= 0,
    ]


def alkylation(*x: Any) -> tuple[Any, list[Any]]:
    """Problem 114."""
    a, b, c, d, e, f, g, h, i, j = x
    first, second = 35.82 - 0.222 * j - 0.9 * i, -133 + 3 * g - 0.99 * j
    five = 1.12 * a + 0.13167 * a * h - 0.00667 * a * h**2 - 0.99 * d
    six = 57.425 + 1.098 * h - 0.038 * h**2 + 0.325 * f - 0.99 * g
    wide, narrow = 1 / 0.9 - 0.9, 1 / 0.99 - 0.99
    return 5.04 * a + 0.035 * b + 10 * c + 3.36 * e - 0.063 * d * g, [
        first >= 0,
        second >= 0,
        first <= wide * i,
        second <= narrow * j,
        five >= 0,
        six >= 0,
        five <= narrow * d,
        six <= narrow * g,
        1.22 * d == a + e,
        98000 * c / (d * i + 1000 * c) == f,
        (b + e) / a == h,
    ]


def catalyst(a: Any, b: Any) -> tuple[Any, list[Any]]:
    """Problem 59."""
    cost = -75.196 + 3.8112 * a - 0.12694 * a**2 + 0.0020567 * a**3 - 1.0345e-5 * a**4
    cost = cost + 6.8306 * b - 0.25645 * b**2 + 0.0034604 * b**3 - 1.3514e-5 * b**4
    cost = cost - 0.030234 * a * b + 1.28134e-3 * b * a**2 - 3.5256e-5 * a**3 * b
    cost = cost + 2.266e-7 * a**4 * b + 5.2375e-6 * a**2 * b**2 + 6.3e-8 * a**3 * b**2
    cost = cost - 7e-10 * a**3 * b**3 - 3.405e-4 * a * b**2 + 1.6638e-6 * a * b**3
    cost = cost + 28.106 / (b + 1) + 2.8673 * np.exp(0.0005 * a * b)
    return cost, [a * b >= 700, b >= a**2 / 125, (b - 50) ** 2 >= 5 * (a - 55)]


def network(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Problem 74."""
    return 3 * a + 1e-6 * a**3 + 2 * b + 2e-6 / 3 * b**3, [
        d - c <= 0.55,
        c - d <= 0.55,
        1000 * np.sin(-c - 0.25) + 1000 * np.sin(-d - 0.25) + 894.8 == a,
        1000 * np.sin(c - 0.25) + 1000 * np.sin(c - d - 0.25) + 894.8 == b,
        1000 * np.sin(d - 0.25) + 1000 * np.sin(d - c - 0.25) == -1294.8,
    ]


def feed(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Problem 73, a chance constraint on cattle feed."""
    spread = np.sqrt(0.28 * a**2 + 0.19 * b**2 + 20.5 * c**2 + 0.62 * d**2)
    return 24.55 * a + 26.75 * b + 39 * c + 40.5 * d, [
        2.3 * a + 5.6 * b + 11.1 * c + 1.3 * d >= 5,
        12 * a + 11.9 * b + 41.8 * c + 52.1 * d - 1.645 * spread >= 21,
        a + b + c + d == 1,
    ]


def wood(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Problem 38."""
    cost = valley(a, b) + 90 * (d - c**2) ** 2 + (1 - c) ** 2
    return cost + 10.1 * ((b - 1) ** 2 + (d - 1) ** 2) + 19.8 * (b - 1) * (d - 1), []


def circles(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Problem 43, of Rosen and Suzuki."""
    return a**2 + b**2 + 2 * c**2 + d**2 - 5 * a - 5 * b - 21 * c + 7 * d, [
        a**2 + b**2 + c**2 + d**2 + a - b + c - d <= 8,
        a**2 + 2 * b**2 + c**2 + 2 * d**2 - a - d <= 10,
        2 * a**2 + b**2 + c**2 + 2 * a - b - d <= 5,
    ]


def quadratic(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Problem 76."""
    cost = a**2 + 0.5 * b**2 + c**2 + 0.5 * d**2 - a * c + c * d - a - 3 * b + c - d
    return cost, [a + 2 * b + c + d <= 5, 3 * a + b + 2 * c - d <= 4, b + 4 * c >= 1.5]


def bilinear(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Problem 44."""
    return a - b - c - a * c + a * d + b * c - b * d, [
        a + 2 * b <= 8,
        4 * a + b <= 12,
        3 * a + 4 * b <= 12,
        2 * c + d <= 8,
        c + 2 * d <= 8,
        c + d <= 5,
    ]


def cylinders(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Problem 72."""
    return 1 + a + b + c + d, [
        4 / a + 2.25 / b + 1 / c + 0.25 / d <= 0.0401,
        0.16 / a + 0.36 / b + 0.64 / c + 0.64 / d <= 0.010085,
    ]


CASES = (
    Case("hs1", 0.0, real(-10, 10) + real(-1.5, 10), lambda x, y: (valley(x, y), []), (-2, 1)),
    Case(
        "hs2", 0.0504261879, real(-10, 10) + real(1.5, 10), lambda x, y: (valley(x, y), []),
        (-2, 1.5),
    ),
    Case(
        "hs5", -1.9132229550, real(-1.5, 4) + real(-3, 3), lambda x, y: (wave(x, y), []), (0, 0)
    ),
    Case(
        "hs7", -math.sqrt(3), 2 * WIDE,
        lambda x, y: (np.log(1 + x**2) - y, [(1 + x**2) ** 2 + y**2 == 4]), (2, 2),
    ),
    Case(
        "hs10", -1.0, 2 * WIDE, lambda x, y: (x - y, [3 * x**2 - 2 * x * y + y**2 <= 1]),
        (-10, 10),
    ),
    Case(
        "hs12", -30.0, 2 * WIDE,
        lambda x, y: (0.5 * x**2 + y**2 - x * y - 7 * x - 7 * y, [4 * x**2 + y**2 <= 25]), (0, 0),
    ),
    Case(
        "hs15", 306.5, real(-100, 0.5) + WIDE,
        lambda x, y: (valley(x, y), [x * y >= 1, x + y**2 >= 0]), (-2, 1),
    ),
    Case(
        "hs16", 0.25, real(-0.5, 0.5) + real(-100, 1),
        lambda x, y: (valley(x, y), [x + y**2 >= 0, x**2 + y >= 0]), (-0.5, 1),
    ),
    Case(
        "hs18", 5.0, real(2, 50) + real(0, 50),
        lambda x, y: (0.01 * x**2 + y**2, [x * y >= 25, x**2 + y**2 >= 25]), (2, 2),
    ),
    Case(
        "hs19", -6961.81388, real(13, 100) + real(0, 100),
        lambda x, y: (
            (x - 10) ** 3 + (y - 20) ** 3,
            [(x - 5) ** 2 + (y - 5) ** 2 >= 100, (x - 6) ** 2 + (y - 5) ** 2 <= 82.81],
        ),
        (20.1, 5.84),
    ),
    Case(
        "hs20", 38.19872981, real(-0.5, 0.5) + WIDE,
        lambda x, y: (valley(x, y), [x + y**2 >= 0, x**2 + y >= 0, x**2 + y**2 >= 1]), (-0.5, 1),
    ),
    Case(
        "hs21", -99.96, real(2, 50) + real(-50, 50),
        lambda x, y: (0.01 * x**2 + y**2 - 100, [10 * x - y >= 10]), (2, -1),
    ),
    Case(
        "hs24", -1.0, 2 * real(0, 100),
        lambda x, y: (
            ((x - 3) ** 2 - 9) * y**3 / (27 * math.sqrt(3)),
            [x / math.sqrt(3) - y >= 0, x + math.sqrt(3) * y >= 0, x + math.sqrt(3) * y <= 6],
        ),
        (1, 0.5),
    ),
    Case(
        "hs29", -16 * math.sqrt(2), 3 * WIDE,
        lambda x, y, z: (-x * y * z, [x**2 + 2 * y**2 + 4 * z**2 <= 48]), (1, 1, 1),
    ),
    Case(
        "hs30", 1.0, real(1, 10) + 2 * real(-10, 10),
        lambda x, y, z: (x**2 + y**2 + z**2, [x**2 + y**2 >= 1]), (1, 1, 1),
    ),
    Case(
        "hs33", math.sqrt(2) - 6, 2 * real(0, 10) + real(0, 5),
        lambda x, y, z: (
            (x - 1) * (x - 2) * (x - 3) + z,
            [z**2 - y**2 - x**2 >= 0, x**2 + y**2 + z**2 >= 4],
        ),
        (0, 0, 3),
    ),
    Case(
        "hs34", -math.log(math.log(10)), 2 * real(0, 100) + real(0, 10),
        lambda x, y, z: (-x, [y >= np.exp(x), z >= np.exp(y)]), (0, 1.05, 2.9),
    ),
    Case(
        "hs35", 1 / 9, 3 * real(0, 10),
        lambda x, y, z: (
            9 - 8 * x - 6 * y - 4 * z + 2 * x**2 + 2 * y**2 + z**2 + 2 * x * y + 2 * x * z,
            [x + y + 2 * z <= 3],
        ),
        (0.5, 0.5, 0.5),
    ),
    Case(
        "hs36", -3300.0, real(0, 20) + real(0, 11) + real(0, 42),
        lambda x, y, z: (-x * y * z, [x + 2 * y + 2 * z <= 72]), (10, 10, 10),
    ),
    Case(
        "hs37", -3456.0, 3 * real(0, 42),
        lambda x, y, z: (-x * y * z, [x + 2 * y + 2 * z <= 72, x + 2 * y + 2 * z >= 0]),
        (10, 10, 10),
    ),
    Case(
        "hs41", 52 / 27, 3 * real(0, 1) + real(0, 2),
        lambda a, b, c, d: (2 - a * b * c, [a + 2 * b + 2 * c - d == 0]), (0.5, 0.5, 0.5, 1),
    ),
    Case("hs43", -44.0, 4 * WIDE, circles, (0, 0, 0, 0)),
    Case("hs44", -15.0, 4 * real(0, 20), bilinear, (0, 0, 0, 0)),
    Case("hs62", -26272.51448, 3 * real(1e-9, 1), yields, (0.7, 0.2, 0.1)),
    Case(
        "hs64", 6299.842428, 3 * real(1e-5, 300),
        lambda x, y, z: (
            5 * x + 50000 / x + 20 * y + 72000 / y + 10 * z + 144000 / z,
            [4 / x + 32 / y + 120 / z <= 1],
        ),
        (1, 1, 1),
    ),
    Case(
        "hs71", 17.0140173, 4 * real(1, 5),
        lambda a, b, c, d: (
            a * d * (a + b + c) + c,
            [a * b * c * d >= 25, a**2 + b**2 + c**2 + d**2 == 40],
        ),
        (1, 5, 5, 1),
    ),
    Case(
        "hs72", 727.67937, real(0.001, 4e5) + real(0.001, 3e5) + real(0.001, 2e5)
        + real(0.001, 1e5), cylinders, (1, 1, 1, 1),
    ),
    Case("hs76", -4.681818181, 4 * real(0, 10), quadratic, (0.5, 0.5, 0.5, 0.5)),
    Case(
        "hs93", 135.075961, 6 * real(0.01, 50), transformer,
        (5.54, 4.4, 12.02, 11.82, 0.702, 0.852),
    ),
    Case("hs100", 680.6300573, 7 * real(-10, 10), seven, (1, 2, 0, 4, 0, 1, 1)),
    Case("hs104", 3.9511634396, 8 * real(0.1, 10), reactors, (6, 3, 0.4, 0.2, 6, 6, 1, 0.5)),
    Case("hs113", 24.3062091, 10 * real(-20, 20), ten, (2, 3, 5, 5, 1, 2, 7, 3, 6, 10)),
)  # fmt: skip
FURTHER = (
    Case(
        "hs26", 0.0, 3 * WIDE,
        lambda x, y, z: ((x - y) ** 2 + (y - z) ** 4, [(1 + y**2) * x + z**4 == 3]), (-2.6, 2, 2),
    ),
    Case("hs38", 0.0, 4 * real(-10, 10), wood, (-3, -1, -3, -1)),
    Case("hs59", -7.8027894, real(0, 75) + real(0, 65), catalyst, (75, 10)),
    Case(
        "hs65", 0.9535288567, 2 * real(-4.5, 4.5) + real(-5, 5),
        lambda x, y, z: (
            (x - y) ** 2 + (x + y - 10) ** 2 / 9 + (z - 5) ** 2, [x**2 + y**2 + z**2 <= 48]
        ),
        (-4.5, 4.5, 0),
    ),
    Case("hs73", 29.894378, 4 * real(0, 1), feed, (1, 1, 1, 1)),
    Case("hs74", 5126.4981, 2 * real(0, 1200) + 2 * real(-0.55, 0.55), network, (0, 0, 0, 0)),
    Case("hs108", -0.8660254038, 8 * WIDE + real(0, 100), hexagon, 9 * (1,)),
    Case(
        "hs114", -1768.80696, real(1e-5, 2000) + real(1e-5, 16000) + real(1e-5, 120)
        + real(1e-5, 5000) + real(1e-5, 2000) + real(85, 93) + real(90, 95) + real(3, 12)
        + real(1.2, 4) + real(145, 162), alkylation,
        (1745, 12000, 110, 3048, 1974, 89.2, 92.8, 8, 3.6, 145),
    ),
)  # fmt: skip
