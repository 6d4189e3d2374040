"""Drawn errors of a stack, with intervals of their quantiles that need no assumption.

The error is e = sum s_i t_i X_i, X_i from the components' distributions. Its quantile has the
interval between two order statistics: X_(r) <= Q_p unless fewer than r of the draws are below Q_p,
a binomial chance. The yield has the interval of Clopper and Pearson (Biometrika 26, 1934).
"""

from typing import Any

import numpy as np

from gearopt.formulations.servo.servo_design import DrawnErrors, Histogram
from gearopt.formulations.servo.tolerance.stack import Stack
from gearopt.optimise.terms import Array

BINS = 60  # of the histogram
THREE_SD = 0.99865  # of a normal error, below its mean and three standard deviations


def drawn(
    stack: Stack,
    t: Array,
    limit: float,
    count: int = 400_000,
    probability: float = THREE_SD,
    confidence: float = 0.99,
    seed: int = 0,
    start: float = 0.0,
) -> DrawnErrors:
    """Draw the error of tolerances t [mm] and hold its quantile and yield against a limit.

    Errors in degrees, as the sensitivities have them. The quantile and the yield are one-sided, of
    the signed error. An end of the quantile's interval is None where the draws are too few for it.
    start: error that is always there, of two-sided deviations at their lower ends.
    ValueError for less than two draws, and for a probability or a confidence not between 0 and 1.
    """
    if count < 2 or not 0.0 < probability < 1.0 or not 0.0 < confidence < 1.0:
        raise ValueError("needs two draws or more, and probabilities between 0 and 1")
    e = start + errors(stack, t, count, seed)
    counts, edges = np.histogram(e, BINS)
    good = int((e <= limit).sum())
    low, high = binomial_interval(good, count, confidence)
    return DrawnErrors(
        count=count,
        seed=seed,
        probability=probability,
        confidence=confidence,
        yield_share=good / count,
        yield_low=low,
        yield_high=high,
        mean_deg=float(e.mean()),
        sd_deg=float(e.std(ddof=1)),
        **_quantile(e, probability, confidence),
        limit_deg=limit,
        largest_deg=float(e.max()),
        worst_case_deg=float(
            start + sum(c.sensitivity * w for c, w in zip(stack.components, t, strict=True))
        ),
        histogram=Histogram(tuple(edges.tolist()), tuple(counts.tolist())),
    )


def _quantile(e: Array, probability: float, confidence: float) -> dict[str, Any]:
    """Return a quantile of drawn errors with the ends of its interval, None beyond the draws."""
    count = len(e)
    first, last = order_interval(count, probability, confidence)
    middle = min(max(int(np.ceil(probability * count)), 1), count)
    ranks = {"_low": first, "": middle, "_high": last}
    inside = {name: k for name, k in ranks.items() if 1 <= k <= count}
    e = np.partition(e, [k - 1 for k in inside.values()])
    return {f"quantile{n}_deg": float(e[k - 1]) if n in inside else None for n, k in ranks.items()}


def errors(stack: Stack, t: Array, count: int, seed: int) -> Array:
    """Draw `count` errors, (count,): one component after the other, from one generator."""
    generator = np.random.default_rng(seed)
    total = np.zeros(count)
    for component, width in zip(stack.components, t, strict=True):
        total += (
            component.sensitivity * float(width) * component.distribution.draw(generator, count)
        )
    return total


def order_interval(count: int, probability: float, confidence: float) -> tuple[int, int]:
    """Return ranks r < s, from 1, of X_(r) <= Q_p <= X_(s); 0 and count + 1 for none."""
    from scipy.stats import binom

    tail = 0.5 * (1.0 - confidence)
    return int(binom.ppf(tail, count, probability)), int(binom.isf(tail, count, probability)) + 1


def binomial_interval(good: int, count: int, confidence: float) -> tuple[float, float]:
    """Return the ends of the share whose draws are as few, or as many, by half 1 - confidence."""
    from scipy.stats import beta

    tail = 0.5 * (1.0 - confidence)
    low = float(beta.ppf(tail, good, count - good + 1)) if good > 0 else 0.0
    high = float(beta.isf(tail, good + 1, count - good)) if good < count else 1.0
    return low, high
