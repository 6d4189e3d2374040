"""A tolerance stack: components with sensitivities and costs, and the budgets of their error.

Every rule is one form, utilisation = sum l_i t_i + (sum (q_i t_i)^2)^(1/2), with for a budget E

    worst_case     sum s t                                         l = s/E
    rss            (sum (s t)^2)^(1/2)                             q = s/E
    mean_plus_sd   sum mu s t + kappa (sum (sigma s t)^2)^(1/2)    l = mu s/E, q = kappa sigma s/E
"""

import math
from collections.abc import Callable
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array

Rule = Literal["worst_case", "rss", "mean_plus_sd"]
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


@dataclass(frozen=True)
class Component:
    """One tolerance t [mm]: its share of the error, its cost and its range.

    sensitivity: s = |d error/d t| >= 0, error per mm. cost, exponent: the cost is a t^-k with
    a > 0, k > 0, and -a ln t for k = 0. least, most: 0 <= least <= most [mm]. distribution: of the
    deviation within t.
    """

    name: str
    sensitivity: float
    cost: float
    exponent: float = 1.0
    least: float = 0.0
    most: float = math.inf
    distribution: Distribution = UNIFORM

    def __post_init__(self) -> None:
        if not (0.0 <= self.sensitivity < math.inf and 0.0 < self.cost < math.inf):
            raise ValueError(f"{self.name}: needs sensitivity >= 0 and cost > 0, both finite")
        if not 0.0 <= self.exponent < math.inf:
            raise ValueError(f"{self.name}: needs a finite exponent >= 0")
        if not (0.0 <= self.least <= self.most and self.most > 0.0 and self.least < math.inf):
            raise ValueError(f"{self.name}: needs 0 <= least <= most, most above 0")


@dataclass(frozen=True)
class ErrorBudget:
    """The error > 0 allowed by a rule, in the unit of the sensitivities times mm.

    kappa >= 0: standard deviations counted by mean_plus_sd. name: by default the rule. key: the
    place of the error in a problem file. only: names of the components that count; None: all.
    """

    rule: Rule
    error: float
    kappa: float = 3.0
    name: str = ""
    key: str = ""
    only: frozenset[str] | None = None

    def __post_init__(self) -> None:
        if self.rule not in get_args(Rule):
            raise ValueError(f"no rule {self.rule!r}; rules: {', '.join(get_args(Rule))}")
        if not (0.0 < self.error < math.inf and 0.0 <= self.kappa < math.inf):
            raise ValueError(f"budget {self.label}: needs error > 0 and kappa >= 0, both finite")

    @property
    def label(self) -> str:
        """Return the name of the limit."""
        return self.name or self.rule

    def weights(self, one: Component) -> tuple[float, float]:
        """Return weights l, q [1/mm] of a component."""
        if self.only is not None and one.name not in self.only:
            return 0.0, 0.0
        share = one.sensitivity / self.error
        if self.rule == "worst_case":
            return share, 0.0
        if self.rule == "rss":
            return 0.0, share
        law = one.distribution
        return law.mean * share, self.kappa * law.sd * share


@dataclass(frozen=True)
class Stack:
    """Components and the budgets that all have to hold.

    ValueError for no component or budget, for names twice, and for a component that no budget
    notices and that has no upper end: its cost falls for ever as it grows.
    """

    components: tuple[Component, ...]
    budgets: tuple[ErrorBudget, ...]

    def __post_init__(self) -> None:
        labels = [b.label for b in self.budgets]
        if not self.components or not labels or len(set(labels)) < len(labels):
            raise ValueError("a stack needs components, and budgets of different names")
        for component, weight in zip(self.components, (self.linear + self.square).T, strict=True):
            if not weight.any() and component.most == math.inf:
                raise ValueError(
                    f"{component.name} has no influence on any budget: give it an upper end (most)"
                )

    @cached_property
    def linear(self) -> Array:
        """Return weights l [1/mm], (budgets, components)."""
        return np.array([[b.weights(c)[0] for c in self.components] for b in self.budgets])

    @cached_property
    def square(self) -> Array:
        """Return weights q [1/mm], (budgets, components)."""
        return np.array([[b.weights(c)[1] for c in self.components] for b in self.budgets])

    @cached_property
    def cost(self) -> Array:
        """Return coefficients a, (components,)."""
        return np.array([c.cost for c in self.components])

    @cached_property
    def exponent(self) -> Array:
        """Return exponents k, (components,)."""
        return np.array([c.exponent for c in self.components])

    @cached_property
    def slope(self) -> Array:
        """Return the w of -d cost/d t = w t^-(k + 1): k a, or a for k = 0; (components,)."""
        return np.where(self.exponent > 0.0, self.exponent, 1.0) * self.cost

    @cached_property
    def least(self) -> Array:
        """Return lower ends [mm], (components,)."""
        return np.array([c.least for c in self.components])

    @cached_property
    def most(self) -> Array:
        """Upper ends [mm], (components,): as given, or the tolerance that alone uses up a budget.

        No t that keeps the limits is beyond them.
        """
        with np.errstate(divide="ignore"):
            alone = 1.0 / (self.linear + self.square).max(0)
        given = np.array([c.most for c in self.components])
        return np.asarray(np.maximum(self.least, np.minimum(alone, given)))

    def used(self, t: Array) -> Array:
        """Return the utilisation of every budget at tolerances t [mm], (budgets,)."""
        total: Array = self.linear @ t + np.linalg.norm(self.square * t, axis=1)
        return total

    def costs(self, t: Array) -> Array:
        """Return the cost of every component at tolerances t [mm], (components,)."""
        log = self.exponent == 0.0
        costs: Array = np.where(log, -self.cost * np.log(t), self.cost * t**-self.exponent)
        return costs
