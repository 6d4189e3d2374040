"""How a deviation lies within its tolerance t: mean, standard deviation and draws per unit t."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearopt.optimise.terms import Array

Draw = Callable[[np.random.Generator, int], Array]


@dataclass(frozen=True)
class Distribution:
    """A deviation X t: mean and sd of X, >= 0, and draw(generator, count) -> X (count,)."""

    name: str
    mean: float
    sd: float
    draw: Draw

    def __post_init__(self) -> None:
        if not (self.mean >= 0.0 and self.sd >= 0.0):
            raise ValueError(f"distribution {self.name}: needs mean >= 0 and sd >= 0")


def _uniform(generator: np.random.Generator, count: int) -> Array:
    return generator.random(count)


def _run_out(generator: np.random.Generator, count: int) -> Array:
    return np.cos(2.0 * np.pi * generator.random(count))


def _normal(generator: np.random.Generator, count: int) -> Array:
    return generator.standard_normal(count) / 3.0


UNIFORM = Distribution("uniform on [0, t]", 0.5, 12.0**-0.5, _uniform)
RUN_OUT = Distribution("t cos(phi), phi uniform", 0.0, 0.5**0.5, _run_out)
NORMAL = Distribution("normal, 3 sd = t", 0.0, 1.0 / 3.0, _normal)


def offset(law: Distribution) -> Distribution:
    """X on [-t, t] seen from the offset t that it needs, as a part of 2 t: (1 + X)/2."""
    return Distribution(
        f"{law.name}, offset by t",
        0.5 * (1.0 + law.mean),
        0.5 * law.sd,
        lambda generator, count: 0.5 * (1.0 + law.draw(generator, count)),
    )
