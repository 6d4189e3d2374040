"""Functions in two variables with many minima or with kinks; optima known or in closed form."""

import math
from typing import Any

import numpy as np

from gearopt.bench.public.case import Case, real
from gearopt.bench.public.hock_schittkowski import valley, wave

TURN = 2 * math.pi


def camel(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Six-hump camel back."""
    return (4 - 2.1 * x**2 + x**4 / 3) * x**2 + x * y + (4 * y**2 - 4) * y**2, []


def goldstein(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Function of Goldstein and Price."""
    first = 19 - 14 * x + 3 * x**2 - 14 * y + 6 * x * y + 3 * y**2
    second = 18 - 32 * x + 12 * x**2 + 48 * y - 36 * x * y + 27 * y**2
    return (1 + (x + y + 1) ** 2 * first) * (30 + (2 * x - 3 * y) ** 2 * second), []


def branin(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Function of Branin."""
    hill = (y - 5.1 / (4 * math.pi**2) * x**2 + 5 / math.pi * x - 6) ** 2
    return hill + 10 * (1 - 1 / (8 * math.pi)) * np.cos(x) + 10, []


def ackley(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Function of Ackley."""
    far = -20 * np.exp(-0.2 * np.sqrt(0.5 * (x**2 + y**2))) + 20
    return far - np.exp(0.5 * (np.cos(TURN * x) + np.cos(TURN * y))) + math.e, []


def shubert(x: Any, y: Any) -> tuple[Any, list[Any]]:
    """Function of Shubert."""
    first = sum(i * np.cos((i + 1) * x + i) for i in range(1, 6))
    return first * sum(i * np.cos((i + 1) * y + i) for i in range(1, 6)), []


CASES = (
    Case("camel", -1.0316284535, real(-3, 3) + real(-2, 2), camel),
    Case("Goldstein-Price", 3.0, 2 * real(-2, 2), goldstein),
    Case("Branin", 0.39788735773, real(-5, 10) + real(0, 15), branin),
    Case("Rosenbrock", 0.0, 2 * real(-5, 10), lambda x, y: (valley(x, y), [])),
    Case("kink", -0.25, real(-3, 3), lambda x: (x**2 - abs(x), []), (0,)),
    Case(
        "two kinks", -0.75, 2 * real(-3, 3),
        lambda x, y: (x**2 - abs(x) + 0.5 * y**2 - np.maximum(y, -y), []), (0, 0),
    ),
    Case(
        "lesser of two", 0.0, real(-2, 2),
        lambda x: (np.minimum((x - 1) ** 2, (x + 1) ** 2), []), (0,),
    ),
    Case(
        "roots of squares", -0.5, 2 * real(-3, 3),
        lambda x, y: (x**2 - np.sqrt(x**2) + y**2 - np.sqrt(y**2), []), (0, 0),
    ),
    Case(
        "Rastrigin", 0.0, 2 * real(-5.12, 5.12),
        lambda x, y: (20 + x**2 - 10 * np.cos(TURN * x) + y**2 - 10 * np.cos(TURN * y), []),
        (3, -2),
    ),
    Case("Ackley", 0.0, 2 * real(-3, 4), ackley, (2, 2)),
    Case(
        "Griewank", 0.0, 2 * real(-20, 30),
        lambda x, y: (1 + (x**2 + y**2) / 4000 - np.cos(x) * np.cos(y / math.sqrt(2)), []),
        (5, 5),
    ),
    Case("Shubert", -186.7309088, 2 * real(-5, 5), shubert, (0, 0)),
    Case(
        "four squares", 0.0, 2 * real(-5, 5),
        lambda x, y: ((x**2 + y - 11) ** 2 + (x + y**2 - 7) ** 2, []),
    ),
    Case(
        "egg crate", 0.0, 2 * real(-5, 5),
        lambda x, y: (x**2 + y**2 + 25 * (np.sin(x) ** 2 + np.sin(y) ** 2), []), (3, 3),
    ),
    Case(
        "McCormick", -1.913222954981, real(-1.5, 4) + real(-3, 4),
        lambda x, y: (wave(x, y), []), (1, 1),
    ),
)  # fmt: skip
