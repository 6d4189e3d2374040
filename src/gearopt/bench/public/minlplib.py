"""Instances of MINLPLib by name, and their best known values.

M. R. Bussieck, A. S. Drud, A. Meeraus, MINLPLib: a collection of test models for mixed-integer
nonlinear programming, INFORMS Journal on Computing 15 (2003) 114. The objective stands in the text,
and what an equality defines in its place. Variables without bounds there have wide ones here.
"""

import math
from typing import Any

import numpy as np

from gearopt.bench.public.case import Case, real, whole
from gearopt.bench.public.engineering import himmelblau

RATIO = 0.14427932477276  # of a gear train, 1/6.931
BIT = whole(0, 1)


def logs_and_product(*x: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance nvs09."""
    total, product = 0.0, 1.0
    for v in x:
        total = total + np.log(v - 2) ** 2 + np.log(10 - v) ** 2
        product = product * v
    return total - product**0.2, []


def synthesis(*x: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance ex1223b."""
    a, b, c, d, e, f, g = x
    cost = (d - 1) ** 2 + (e - 2) ** 2 + (f - 1) ** 2 - np.log(1 + g)
    return cost + (a - 1) ** 2 + (b - 2) ** 2 + (c - 3) ** 2, [
        a + b + c + d + e + f <= 5,
        f**2 + a**2 + b**2 + c**2 <= 5.5,
        a + d <= 1.2,
        b + e <= 1.8,
        c + f <= 2.5,
        a + g <= 1.2,
        e**2 + b**2 <= 1.64,
        f**2 + c**2 <= 4.25,
        e**2 + c**2 <= 4.64,
    ]


def linear_synthesis(*x: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance ex1223a."""
    a, b, c, d, e, f, g = x
    cost = (a - 1) ** 2 + (b - 2) ** 2 + (c - 3) ** 2
    return cost - d - 3 * e - f - 0.693147180559945 * g + 6, [
        a + b + c + d + e + f <= 5,
        a**2 + b**2 + c**2 + f <= 5.5,
        a + d <= 1.2,
        b + e <= 1.8,
        c + f <= 2.5,
        a + g <= 1.2,
        b**2 + e <= 1.64,
        c**2 + f <= 4.25,
        c**2 + e <= 4.64,
    ]


def reliability(*x: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance ex1224."""
    a, b, c, d, e, f, g, h, i, j, k = x
    return -a * b * c, [
        -np.log(1 - a) - 2.30258509299405 * d - 1.6094379124341 * e - 1.89711998488588 * f == 0,
        -np.log(1 - b) - 2.99573227355399 * g - 1.6094379124341 * h - 1.89711998488588 * i == 0,
        -np.log(1 - c) - 3.91202300542815 * j - 2.81341071676004 * k <= 0,
        d + e + f >= 1,
        g + h + i >= 1,
        j + k >= 1,
        3 * d + e + 2 * f + 3 * g + 2 * h + i + 3 * j + 2 * k <= 10,
    ]


def by_bits(x: Any, y: Any, *b: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance ex1225."""
    c, d, e, f, g, h = b
    return 7 * x + 10 * y, [
        x**1.2 * y**1.7 - 7 * x - 9 * y <= -24,
        x + 2 * y >= 5,
        y - 3 * x <= 1,
        4 * x - 3 * y <= 11,
        x - c - 2 * d - 4 * e == 1,
        y - f - 2 * g - 4 * h == 1,
        c + e <= 1,
        f + h <= 1,
        d + e <= 1,
        g + h <= 1,
    ]


def half_by_bits(x: Any, y: Any, c: Any, d: Any, e: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance ex1226."""
    return 3 * y - 5 * x, [
        8 * x - 2 * x**0.5 * y**2 + 11 * y + 2 * y**2 - 2 * y**0.5 <= 39,
        x - y <= 3,
        3 * x + 2 * y <= 24,
        y - c - 2 * d - 4 * e == 1,
        d + e <= 1,
    ]


def alloys(a: Any, b: Any, c: Any, d: Any, e: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance ex1221."""
    return 2 * a + 3 * b + 1.5 * c + 2 * d - 0.5 * e, [
        a**2 + c == 1.25,
        b**1.5 + 1.5 * d == 3,
        a + c <= 1.6,
        1.333 * b + d <= 3,
        e <= c + d,
    ]


def whole_himmelblau(*x: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance nvs02."""
    cost, rows = himmelblau(*x)
    return 1e-4 * (cost + 40792.141) + 5.9207859, rows


def parabolas(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance nvs10."""
    return 7 * x**2 + 6 * y**2 - 35 * x - 80.4 * y, [
        9 * x**2 + 10 * x * y + 8 * y**2 <= 583,
        6 * x**2 + 8 * x * y + 6 * y**2 <= 441,
    ]


def booths(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance nvs16, Beale's function of whole numbers."""
    terms = ((1.5, 1), (2.25, 2), (2.625, 3))
    return sum((c - x * (1 - y**k)) ** 2 for c, k in terms), []


def concave(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance st_e22."""
    return -(x**2) - 4 * y**2, [
        x + y <= 10,
        x + 5 * y <= 22,
        2 * y - 3 * x <= 2,
        x + 4 * y >= 4,
        x - 2 * y <= 4,
    ]


def ring(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance st_e18."""
    return x + y, [x**2 + y**2 >= 1, x**2 + y**2 <= 4, y - x <= 1, x - y <= 1]


def alkylation(*x: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance alkyl."""
    a, b, c, d, e, f, g, h, i, j, k, l, m, n = x  # noqa: E741
    return 5.04 * a + 0.35 * b + c + 3.36 * e - 6.3 * d * g, [
        d == 0.819672131147541 * (a + e),
        0.98 * c == (0.01 * d * i + c) * f,
        10 * b + e == a * h,
        d * k == (1.12 + 0.13167 * h - 0.0067 * h * h) * a,
        g * l - 0.01 * (1.098 * h - 0.038 * h * h) - 0.325 * f == 0.57425,
        i * m + 22.2 * j == 35.82,
        j * n - 3 * g == -1.33,
    ]


def feed(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance chance."""
    spread = np.sqrt(0.28 * a**2 + 0.19 * b**2 + 20.5 * c**2 + 0.62 * d**2)
    return 24.55 * a + 26.75 * b + 39 * c + 40.5 * d, [
        a + b + c + d == 1,
        12 * a - 1.645 * spread + 11.9 * b + 41.8 * c + 52.1 * d >= 21,
        2.3 * a + 5.6 * b + 11.1 * c + 1.3 * d >= 5,
    ]


def pool(a: Any, b: Any, c: Any, d: Any, e: Any, f: Any, g: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance ex5_2_4."""
    rest = 6 * a + 16 * b + 15 * c
    return f - 5 * g - (9 - rest) * d - (15 - rest) * e, [
        c * d + c * e <= 50,
        d + f <= 100,
        e + g <= 200,
        (3 * a + b + c - 2.5) * d - 0.5 * f <= 0,
        (3 * a + b + c - 1.5) * e + 0.5 * g <= 0,
        a + b + c == 1,
    ]


def phases(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance ex6_1_2."""
    energy = (0.06391 + np.log(a)) * a + (np.log(b) - 0.02875) * b
    return energy + 0.925356626778358 * a * d + 0.746014540096753 * b * c, [
        c * (a + 0.159040857374844 * b) == a,
        d * (0.307941026821595 * a + b) == b,
        a + b == 1,
    ]


def chained(a: Any, b: Any, c: Any, d: Any, e: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of ex8_1_7 and mhw4d, which differ in bounds and start.

    A chain of powers of differences of five variables, three equalities.
    """
    cost = (a - 1) ** 2 + (a - b) ** 2 + (b - c) ** 3 + (c - d) ** 4 + (d - e) ** 4
    return cost, [
        a + b**2 + c**3 == 6.24264068711929,
        b - c**2 + d == 0.82842712474619,
        a * e == 2,
    ]


def hexagon(*x: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance himmel16.

    A hexagon of diameter 1, its first corner at 0, its second on the axis.
    """
    across, up = (0.0, *x[:5]), (0.0, 0.0, *x[5:])
    area, rows = 0.0, []
    for i in range(6):
        k = (i + 1) % 6
        area = area + 0.5 * (across[i] * up[k] - up[i] * across[k])
        for j in range(i + 1, 6):
            rows.append((across[i] - across[j]) ** 2 + (up[i] - up[j]) ** 2 <= 1)
    return -area, rows


def block(x: Any, y: Any, z: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance nvs01."""
    root = np.sqrt(900 + x**2)
    return 0.04712385 * y * root, [
        420.169404664517 * root == z * x * y,
        296087.631843 * (0.01 + 0.0625 * y**2) / (7200 + x**2) >= z,
    ]


def weld(t: Any, b: Any, h: Any, l: Any, stiff: float, bent: float) -> tuple[Any, list[Any]]:  # noqa: E741
    """Instances nvs05 and nvs22, a welded beam of whole numbers."""
    direct = 4243.28147100424 / (h * l)
    square = 0.25 * l**2 + (0.5 * t + 0.5 * h) ** 2
    polar = h * l * (l**2 / 12 + (0.5 * t + 0.5 * h) ** 2)
    radius = np.sqrt(square)
    twisting = 0.707213578500707 * (84000 + 3000 * l) * radius / polar
    stress = np.sqrt(direct**2 + 2 * direct * twisting * 0.5 * l / radius + twisting**2)
    buckling = 0.0204744897959184 * math.sqrt(stiff) * t * b**3 * (1 - 0.0282346219657891 * t)
    return 1.10471 * h**2 * l + 0.04811 * t * b * (14 + l), [
        stress <= 13600,
        504000 / (b * t**2) <= 30000,
        h <= b,
        buckling >= 6000,
        bent / (b * t**3) <= 0.25,
    ]


def four_squares(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance nvs12."""
    cost = 7 * a**2 + 6 * b**2 - 20 * a - 93.2 * b + 8 * c**2 - 6 * c * a + 4 * c * b - 67.2 * c
    first = 9 * a**2 + 10 * a * b + 8 * b**2 + 5 * c**2 + 6 * c * a + 10 * c * b + 7 * d**2
    second = 6 * a**2 + 8 * a * b + 6 * b**2 + 4 * c**2 + 2 * c * a + 2 * c * b + 8 * d**2
    third = 9 * a**2 + 6 * b**2 + 8 * c**2 - 2 * b * a - 2 * c * b + 6 * d**2
    four = 8 * a**2 + 4 * b**2 + 9 * c**2 + 7 * d**2 + 2 * b * a + 2 * c * a + 4 * c * b
    return cost + 6 * d**2 + 2 * d * a + 2 * d * c - 36.6 * d, [
        first + 10 * d * a + 6 * d * b + 2 * d * c <= 1100,
        second - 2 * d * a - 10 * d * b <= 440,
        third - 4 * d * a - 4 * d * b + 2 * d * c <= 310,
        four - 6 * d * a - 2 * d * b + 2 * d * c <= 460,
    ]


def truss(a: Any, b: Any, c: Any) -> tuple[Any, list[Any]]:
    """Objective and constraints of MINLPLib instance st_e40."""
    stiff = 0.15 * a * b + 0.14142135 * b * c + 0.1319 * a * c
    sizes = (1, 2, 3, 5, 8, 10, 12)
    rows = [math.prod(v - s for s in sizes) == 0 for v in (a, b, c)]
    return 2 * a + b + 1.4142135 * c, [
        1.7317 * b + 1.03366 * c <= stiff,
        0.634 * a + 2.828 * c <= stiff,
        0.5 * a - 2 * b <= stiff,
        2 * b - 0.5 * a <= stiff,
        *rows,
    ]


CASES = (
    Case(
        "gear, Sandgren", 2.700857148886e-12, 4 * whole(12, 60),
        lambda a, b, c, d: ((1 / 6.931 - a * b / (c * d)) ** 2, []),
    ),
    Case(
        "gear4", 1.643428473918, 4 * whole(12, 60),
        lambda a, b, c, d: (1e6 * abs(RATIO - a * b / (c * d)), []),
    ),
    Case("ex1221", 7.66718007, 2 * real(0, 10) + 3 * BIT, alloys),
    Case(
        "nvs03", 16.0, 2 * whole(0, 200),
        lambda x, y: ((x - 8) ** 2 + (y - 2) ** 2, [0.1 * x**2 <= y, x / 3 + y <= 4.5]),
    ),
    Case(
        "nvs04", 0.72, 2 * whole(0, 200),
        lambda x, y: (100 * (0.5 + y - (0.6 + x) ** 2) ** 2 + (0.4 - x) ** 2, []),
    ),
    Case(
        "nvs06", 1.7703125, 2 * whole(1, 200),
        lambda x, y: (
            0.1 * (x**2 + (1 + y**2) / x**2 + (100 + x**2 * y**2) / (x * y) ** 4) + 1.2,
            [],
        ),
    ),
    Case("nvs10", -310.8, 2 * whole(0, 200), parabolas),
    Case("nvs16", 0.703125, 2 * whole(0, 200), booths),
    Case("nvs09", -43.13433692, 10 * whole(3, 9), logs_and_product),
    Case(
        "st_e13", 2.0, real(0, 1.6) + BIT,
        lambda x, y: (2 * x + y, [x**2 + y >= 1.25, x + y <= 1.6]),
    ),
    Case("ex1223b", 4.579582402, 3 * real(0, 10) + 4 * BIT, synthesis),
)  # fmt: skip
MORE = (
    Case(
        "ex1222", 1.0765430833, real(0.2, 1) + real(-2.22554, -1) + BIT,
        lambda x, y, z: (
            5 * (x - 0.5) ** 2 - 0.7 * z + 0.8,
            [np.exp(x - 0.2) + y >= 0, y + 1.1 * z <= -1, x <= 1.2 * z],
        ),
    ),
    Case("ex1223a", 4.579582402, 3 * real(0, 10) + 4 * BIT, linear_synthesis),
    Case(
        "ex1224", -0.9434705, real(0, 0.997) + real(0, 0.9985) + real(0, 0.9988) + 8 * BIT,
        reliability,
    ),
    Case("ex1225", 31.0, 2 * real(1, 5) + 6 * BIT, by_bits),
    Case("ex1226", -17.0, real(1, 10) + real(1, 6) + 3 * BIT, half_by_bits),
    Case(
        "nvs08", 23.44972735, 2 * whole(0, 200) + real(0.001, 200),
        lambda x, y, z: (
            (x - 3) ** 2 + (y - 2) ** 2 + (4 + z) ** 2,
            [
                np.sqrt(z) + x + 2 * y >= 10,
                0.240038406144983 * x**2 - y + 0.255036980362153 * z >= -3,
                y**2 - 1 / (z**3 * np.sqrt(z)) - 4 * x >= -12,
            ],
        ),
    ),
    Case(
        "nvs15", 1.0, 3 * whole(0, 200),
        lambda x, y, z: (
            2 * x**2 - 8 * x + 2 * y**2 - 6 * y + z**2 - 4 * z + 2 * x * y + 2 * x * z + 9,
            [x + y + 2 * z <= 3],
        ),
    ),
    Case("nvs02", 5.964184523, 5 * whole(0, 200), whole_himmelblau),
    Case(
        "st_e01", -20 / 3, real(0, 6) + real(0, 4), lambda x, y: (-x - y, [x * y <= 4])
    ),
    Case(
        "st_e08", 0.7417819582, 2 * real(0, 1),
        lambda x, y: (2 * x + y, [16 * x * y >= 1, 4 * x**2 + 4 * y**2 >= 1]),
    ),
    Case(
        "st_e09", -0.5, 2 * real(0, 1),
        lambda x, y: (-2 * x * y, [4 * x * y + 2 * x + 2 * y <= 3]),
    ),
    Case(
        "st_e11", 189.3116297, real(0, 34) + real(0, 17) + real(0, 300),
        lambda x, y, z: (
            35 * x**0.6 + 35 * y**0.6,
            [600 * x - x * z - 50 * z == -5000, 600 * y + 50 * z == 15000],
        ),
    ),
    Case("st_e18", -2 * math.sqrt(2), 2 * real(-2, 2), ring),
    Case(
        "st_e19", -118.7048598, real(-8, 10) + real(0, 10),
        lambda x, y: (
            x**4 - 14 * x**2 + 24 * x - y**2,
            [y - x <= 8, y - x**2 - 2 * x <= -2],
        ),
    ),
    Case("st_e22", -85.0, real(0, 8) + real(0, 4), concave),
    Case(
        "gear", 2.700857148886e-12, 4 * whole(12, 60),
        lambda a, b, c, d: ((RATIO - a * b / (c * d)) ** 2, []),
    ),
    Case(
        "ex8_1_1", -2.021806783, real(-1, 2) + real(-1, 1),
        lambda x, y: (np.cos(x) * np.sin(y) - x / (y**2 + 1), []),
    ),
)  # fmt: skip
FURTHER = (
    Case(
        "alkyl", -1.764999646, real(0, 2) + real(0, 1.6) + real(0, 1.2) + real(0, 5) + real(0, 2)
        + real(0.85, 0.93) + real(0.9, 0.95) + real(3, 12) + real(1.2, 4) + real(1.45, 1.62)
        + 2 * real(0.99, 1 / 0.99) + real(0.9, 1 / 0.9) + real(0.99, 1 / 0.99), alkylation,
    ),
    Case("chance", 29.89437816, 4 * real(0, 1), feed),
    Case("ex5_2_4", -450.0, 3 * real(0, 1) + 2 * (real(0, 100) + real(0, 200)), pool),
    Case("ex6_1_2", -0.0324637501, 2 * real(1e-6, 1) + 2 * real(0, 100), phases),
    Case("ex8_1_7", 0.0293108307, 5 * real(-5, 5), chained),
    Case("himmel16", -0.8660254038, 10 * real(-100, 100), hexagon, 10 * (0.1,)),
    Case("mhw4d", 0.0293108307, 5 * real(-100, 100), chained, 5 * (1,)),
    Case("nvs01", 12.46966882, 2 * whole(0, 200) + real(0, 100), block),
    Case(
        "nvs05", 5.470934108, 2 * whole(1, 200) + 2 * real(0.01, 200),
        lambda t, b, h, length: weld(t, b, h, length, 1e15, 0.21952),
    ),
    Case("nvs12", -481.2, 4 * whole(0, 200), four_squares),
    Case(
        "nvs22", 6.05822, 2 * whole(1, 200) + 2 * whole(1, 20),
        lambda t, b, h, length: weld(t, b, h, length, 1e13, 2.1952),
    ),
    Case("st_e40", 30.4142135, 3 * whole(1, 12), truss),
)  # fmt: skip
