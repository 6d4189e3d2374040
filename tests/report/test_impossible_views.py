"""Pictures of impossible requests: bars as long as utilisations, dots where a change is enough."""

import math

import numpy as np
import pytest
from page_reader import drawings, extents, marks, numbers

import gearopt
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var
from gearopt.report.pages.result import page

NAMES = ("k_factor", "unit_load", "wheel_diameter", "pinion_teeth_low", "module_low")


def shown(conflict=(), remedies=(), **report):
    ways = {"conflict": list(conflict), "remedies": list(remedies), "message": ""}
    made = gearopt.Result(
        name="drive",
        status="infeasible",
        method="ipopt",
        objective={"name": "gear_volume", "value": None, "unit": "mm3"},
        report={"ways_out": ways} | report,
        scene="drive",
    )
    return {svg.get("aria-label"): svg for svg in drawings(page(made, ""))}


def remedy(key, factor, bound=None, more=()):
    change = {
        "key": key,
        "was": '"300 mm"',
        "write": f'"{300 * (factor or 2):.6g} mm"',
        "factor": factor,
    }
    words = {"kind": "least", "what": "x", "factor": factor, "bound": bound, "verified": {}}
    return words | {"changes": [change, *more]}


def legible(svg):
    size = np.array(svg.get("viewBox").split()[2:], float)
    texts = list(extents(svg))
    for k, (word, at, half) in enumerate(texts):
        assert (at - half >= 0.0).all() and (at + half <= size).all(), word
        for other, there, reach in texts[:k]:
            assert (abs(at - there) >= half + reach).any(), (word, other)


@pytest.mark.parametrize("seed", range(6))
def test_bars_are_as_long_as_the_limits_are_used(seed):
    rng = np.random.default_rng(seed)
    top = (0.01, 0.1, 1.0, 30.0)[seed % 4]
    names = [f"{name}[{k}]" for k in (1, 2, 3) for name in NAMES] + ["ratio_low"]
    some = rng.choice(names, rng.integers(1, 12), replace=False).tolist()
    near = {name: float(1.0 + top * rng.uniform(-0.5, 1.0)) for name in names}
    near = {name: max(value, 0.05) for name, value in near.items()}
    near[some[0]] = 1.0 + top
    svg = shown(some, nearest=near)["limits in conflict"]
    bars, rows = [], {}
    for style in ("range", "excess"):
        bars += [numbers(e, "x", "y", "width") for e in marks(svg, "rect", style)]
    for x, y, width in bars:
        rows.setdefault(y, []).append((x, width))
    (limit,) = (numbers(e, "x1")[0] for e in marks(svg, "line", "gap"))
    left = min(x for x, _, _ in bars)
    lengths = sorted(sum(w for _, w in row) / (limit - left) for row in rows.values())
    assert np.allclose(lengths, sorted(near[name] for name in some), atol=2e-3 * (1.0 + top))
    assert len(marks(svg, "rect", "excess")) == sum(near[name] > 1.0 for name in some)
    assert len([t for t in svg.iter("text") if t.text.endswith(" %")]) == len(some) + 1
    legible(svg)


@pytest.mark.parametrize("seed", range(6))
def test_dots_are_where_a_change_is_enough(seed):
    rng = np.random.default_rng(seed)
    wide = (0.001, 0.2, 2.0, 5.0)[seed % 4]
    factors = np.exp(rng.uniform(0.1, 1.0, rng.integers(1, 9)) * wide).tolist()
    bounds = [f ** rng.uniform(0.5, 1.0) if rng.uniform() < 0.6 else None for f in factors]
    ways = [remedy(f"limits.size_{k}", *w) for k, w in enumerate(zip(factors, bounds, strict=True))]
    ways += [remedy("keep_out[1].z", None), remedy("layout.slabs", 1.0)]
    ways += [remedy("a", 1.5, more=[{"key": "b", "was": "1", "write": "2", "factor": 2.0}])]
    svg = shown(remedies=ways)["asked and what is enough"]
    dots = [numbers(e, "cx")[0] for e in marks(svg, "circle", "enough")]
    (asked,) = (numbers(e, "x1")[0] for e in marks(svg, "line", "gap"))
    scale = (max(dots) - asked) / math.log(max(factors))
    assert np.allclose(dots, [asked + scale * math.log(f) for f in factors], atol=0.02)
    proven = [numbers(e, "x", "width") for e in marks(svg, "rect", "excess")]
    ends = [asked + scale * math.log(b) for b in bounds if b is not None]
    assert np.allclose([x + w for x, w in proven], ends, atol=0.02)
    texts = [t.text for t in svg.iter("text")]
    assert sum(t.startswith("limits.size_") for t in texts) == len(factors)
    legible(svg)


def test_nothing_is_drawn_of_what_is_not_known():
    assert shown() == {} == shown(["k_factor[1]"], [remedy("keep_out[1].z", None)])


def test_an_impossible_problem_reports_its_limits_where_the_largest_excess_is_smallest():
    """a b >= 2, a <= 1, b <= 1; by symmetry a = b = s and 2/s^2 = s."""

    def evaluate(x, _):
        return Terms({"size": x.a + x.b}, {"low": 2.0 / (x.a * x.b), "a": x.a, "b": x.b})

    variables = (Var("a", "", 0.1, 9.0, 1.0, log=True), Var("b", "", 0.1, 9.0, 1.0, log=True))
    result = gearopt.solve(Problem("sizes", variables, (), evaluate))
    near = result.report["nearest"]
    assert result.status == "infeasible" and set(near) == {"low", "a", "b"}
    assert list(near.values()) == pytest.approx([2.0 ** (1 / 3)] * 3, rel=1e-3)
