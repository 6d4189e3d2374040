"""Pictures of impossible requests: bars as long as utilisations, dots where a change is enough."""

import math

import layout_cases as cases
import numpy as np
import pytest
from page_reader import drawings, extents, marks, numbers

import gearopt
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Terms, Var
from gearopt.report.explained import remedies
from gearopt.report.measures import METRIC, rounded
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
    assert {f"× {rounded(f, 5)}" for f in factors} <= set(texts)
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


def nearest(**asked):
    """An impossible layout whose first remedy is laid out as the elevator is."""
    found = cases.elevator()
    change = {"key": "layout.largest_width", "was": "1 mm", "write": '"2 mm"', "factor": 2.0}
    way = {"kind": "least", "what": "x", "changes": [change], "factor": 2.0, "bound": None}
    ways = {"conflict": [], "remedies": [way | {"verified": {"with": "feasible"}}], "message": ""}
    near = {"keep_outs": [], "motor_mm": None, "largest_mm": [None, None, None]}
    near |= {"layout": found.design["layout"]} | asked
    report = {"ways_out": ways, "nearest_layout": near}
    objective = {"name": "box_volume", "value": None, "unit": "mm3"}
    made = gearopt.Result("drive", "infeasible", "exact", objective, report=report, scene="drive")
    views = {svg.get("aria-label"): svg for svg in drawings(page(made, ""))}
    box = found.design["layout"]["box"]
    frames = {name: marks(views[f"{name} view"], "rect", "box")[0] for name in ("front", "side")}
    scale = numbers(frames["front"], "width")[0] / box["width_mm"]
    return views, frames, scale, box


@pytest.mark.parametrize("seed", range(4))
def test_sides_asked_of_a_box_stand_over_the_nearest_one(seed):
    rng = np.random.default_rng(seed)
    parts = rng.uniform(0.4, 1.4, 3)
    parts[seed % 3] = rng.uniform(0.4, 0.9)
    box = cases.elevator().design["layout"]["box"]
    keys = ("width_mm", "height_mm", "length_mm")
    sides = [float(p * box[key]) for p, key in zip(parts, keys, strict=True)]
    views, frames, scale, _ = nearest(largest_mm=sides)
    sizes = [min(side, box[key]) for side, key in zip(sides, keys, strict=True)]
    asked = marks(views["front view"], "rect", "asked")
    assert len(asked) == (min(parts[:2]) < 1.0)
    for e in asked:
        assert np.allclose(numbers(e, "width", "height"), np.multiply(sizes[:2], scale), atol=0.03)
        assert numbers(e, "x") == numbers(frames["front"], "x")  # from the left and the floor
        ends = [sum(numbers(one, "y", "height")) for one in (e, frames["front"])]
        assert abs(ends[0] - ends[1]) < 0.03
    long = marks(views["side view"], "rect", "asked")
    assert len(long) == (parts[2] < 1.0)
    for e in long:
        assert abs(numbers(e, "width")[0] - scale * sides[2]) < 0.03
        assert numbers(e, "x") == numbers(frames["side"], "x")


@pytest.mark.parametrize("seed", range(4))
def test_keep_outs_and_motor_that_are_asked_are_where_the_file_has_them(seed):
    rng = np.random.default_rng(seed)
    at = np.sort(rng.uniform(-100.0, 100.0, (3, 2)), axis=1)
    names = ("left_mm", "right_mm", "bottom_mm", "top_mm", "from_mm", "to_mm")
    keep_out = {"name": "beam"} | dict(zip(names, at.ravel().tolist(), strict=True))
    views, frames, scale, box = nearest(keep_outs=[keep_out], motor_mm=230.0)
    x, y = numbers(frames["front"], "x", "y")
    (e,) = marks(views["front view"], "rect", "asked")
    (y0, y1), (z0, z1), _ = at
    top = box["bottom_mm"] + box["height_mm"]
    meant = [x + scale * (y0 - box["left_mm"]), y + scale * (top - z1)]
    assert np.allclose(numbers(e, "x", "y"), meant, atol=0.03)
    assert np.allclose(
        numbers(e, "width", "height"), [scale * (y1 - y0), scale * (z1 - z0)], atol=0.03
    )
    (motor,) = marks(views["front view"], "circle", "asked")
    assert abs(numbers(motor, "r")[0] - scale * 115.0) < 0.02


@pytest.mark.parametrize("hatched", [True, False])
def test_hatched_boxes_are_named_where_there_are_any(hatched):
    made = cases.elevator() if hatched else cases.three_stage()
    change = {"key": "layout.largest_width", "was": "1 mm", "write": '"2 mm"', "factor": 2.0}
    near = {"keep_outs": [], "motor_mm": None, "largest_mm": [1.0, None, None]}
    near |= {"layout": made.design["layout"]}
    ways = {"conflict": [], "remedies": [remedy("a", 2.0) | {"changes": [change]}], "message": ""}
    report = {"ways_out": ways, "nearest_layout": near}
    shown = page(cases.elevator(status="infeasible", design={}, limits={}, report=report), "")
    assert "what was asked. One scale" in shown
    assert ("hatched boxes are keep-outs" in shown) == hatched


@pytest.mark.parametrize(("bounds", "shown_"), [((None, None), False), ((None, 1.2), True)])
def test_remedies_without_a_proven_minimum_have_no_column_of_it(bounds, shown_):
    ways = [remedy("limits.wheel_diameter", 1.3, bound) for bound in bounds]
    report = {"ways_out": {"conflict": ["wheel_diameter[1]"], "remedies": ways, "message": ""}}
    result = gearopt.Result("drive", "infeasible", "ipopt", {}, report=report, scene="drive")
    (table,) = remedies(result, METRIC).tables
    for heads, _ in (table.on_page, table.on_terminal):
        assert ("proven minimum" in heads) is shown_
    assert "proven minimum" in table.values[0]
