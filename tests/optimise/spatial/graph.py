"""Points of the true graph of a text's columns, in 40 digits, and random texts and boxes."""

import mpmath as mp
import numpy as np

from gearopt.optimise.spatial import columns as c

mp.mp.dps = 40
FUNCTIONS = {
    c.EXP: mp.exp,
    c.LOG: mp.log,
    c.SINE: mp.sin,
    c.COSINE: mp.cos,
    c.TANH: mp.tanh,
    c.ATAN: mp.atan,
    c.ASIN: mp.asin,
    c.ABS: abs,
    c.FLOOR: mp.floor,
}


def graph(form, point):
    """Values of all columns at a point of the variables; None where the text has no number."""
    value = [mp.mpf(float(v)) for v in point] + [None] * (len(form.lower) - len(point))
    start, column, factor, _, constant, _ = form.sums
    for r, (kind, w, u, v) in enumerate(form.relations):
        if kind == c.LINEAR:
            if w < 0:
                continue
            terms = [(column[k], factor[k]) for k in range(start[r], start[r + 1])]
            rest = sum((mp.mpf(f) * value[j] for j, f in terms if j != w), mp.mpf(0))
            value[w] = rest - mp.mpf(constant[r])
            continue
        a, b = value[u], value[v] if v >= 0 else None
        p = mp.mpf(form.exponent[r])
        if kind == c.PRODUCT:
            found = a * b
        elif kind == c.QUOTIENT:
            found = a / b if b else None
        elif kind in (c.POWER, c.ROOT):
            bad = (a == 0 and p < 0) or (kind == c.ROOT and a < 0)
            found = None if bad else a ** (int(p) if kind == c.POWER else p)
        elif kind == c.MAXIMUM:
            found = max(a, b)
        elif kind == c.MINIMUM:
            found = min(a, b)
        elif (kind == c.LOG and a <= 0) or (kind == c.ASIN and abs(a) > 1):
            found = None
        else:
            found = FUNCTIONS[kind](a)
        if found is None:
            return None
        value[w] = found
    return value


OPERATIONS = {
    "log": lambda x, y: np.log(x + 0.3) * y - np.log(y * y + 0.1),
    "root": lambda x, y: np.sqrt(x) * y ** (1.0 / 3.0) + (x + 2.0 * y) ** 1.7 - 0.1 * (0.3 * x),
    "powers": lambda x, y: x**3 * y**2 - (x - y) ** 5 + x**4 / 7.0,
    "inverse": lambda x, y: x / (y + 0.2) + (x - y) ** -3 + 3.0 / (x * y) + (x + y) ** -2,
    "negative root": lambda x, y: (x * x + 0.1) ** -0.4 * y,
    "exp": lambda x, y: np.exp(0.3 * x - y) * x + np.exp(-x * x),
    "waves": lambda x, y: np.sin(2.0 * x + y) * np.cos(x - 3.0 * y) + np.tan(0.1 * x),
    "bounded": lambda x, y: np.tanh(x * y) + np.arctan(x - 2.0 * y) * x,
    "angles": lambda x, y: np.arccos(x / (abs(x) + abs(y) + 0.1)) + np.arcsin(np.tanh(y)),
    "kinks": lambda x, y: np.maximum(x * y, x - y) + abs(x - 1.0) - np.minimum(y**2, 2.0 * x),
    "floor": lambda x, y: np.floor(3.0 * x - y) * y + np.ceil(x * y),
    "hyperbolic": lambda x, y: np.sinh(x - y) / np.cosh(x) + np.hypot(x, y) + abs(x) ** (0.5 * y),
}


def boxes(name, rng, count):
    """Random boxes (count, 2, 2) of x and y: wide, narrow, touching or crossing 0, shifted."""
    ends = rng.normal(size=(count, 2, 2)) * 10.0 ** rng.uniform(-2.0, 0.8, size=(count, 2, 1))
    sort = rng.integers(0, 4, size=(count, 2))
    ends[sort == 0, 0] = 0.0
    ends[sort == 1] = np.abs(ends[sort == 1])
    ends[sort == 2, 1] = ends[sort == 2, 0] + 1e-6
    return np.sort(ends, axis=2)
