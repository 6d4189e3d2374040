"""A compound train drawn in modules, and a ratio out of reach on a line with those in reach."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_reader import drawings, extents, marks, numbers

import gearopt
from gearopt.optimise.explaining.explanation import Explanation, Influence
from gearopt.report.design_tables import ratio_text
from gearopt.report.pages.result import page


def result(driver, driven, **reach):
    design = {"driver_teeth": driver, "driven_teeth": driven, "ratio_error_percent": 0.0}
    design["ratio"] = math.prod(driven) / math.prod(driver)
    objective = {"name": "squared_error", "value": 0.0, "unit": ""}
    report = {"reach": {"within": True} | reach}
    return gearopt.Result(
        "compound", "optimal", "exact", objective, design=design, report=report, scene="compound"
    )


def shown(made):
    return drawings(page(made, ""))


def out_of_reach(ratio, teeth, wider):
    low, high = ((teeth[k] / teeth[1 - k]) ** 2 for k in (0, 1))
    reach = {"within": False, "ratio": ratio, "teeth": teeth, "least_ratio": low}
    return shown(result([20, 20], [30, 30], **reach, most_ratio=high, wider_teeth=wider))[0]


def legible(svg):
    size = np.array(svg.get("viewBox").split()[2:], float)
    texts = list(extents(svg))
    for k, (word, at, half) in enumerate(texts):
        assert (at - half >= 0.0).all() and (at + half <= size).all(), word
        for other, there, reach in texts[:k]:
            assert (abs(at - there) >= half + reach).any(), (word, other)


def test_a_ratio_has_the_digits_that_tell_its_error():
    """Sandgren's 43 49/(16 19) = 6.930921 for 6.931: five digits would show 6.9309."""
    off = 100.0 * (43 * 49 / (16 * 19) / 6.931 - 1.0)
    assert ratio_text(43 * 49 / (16 * 19), off) == "6.930921"
    assert ratio_text(31.95118, -2.85) == "31.951" and ratio_text(6.0, 0.0) == "6"
    made = result([16, 19], [43, 49])
    made = replace(made, design=made.design | {"ratio_error_percent": off})
    assert page(made, "").count("6.930921") == 2  # key figure and table


@pytest.mark.parametrize("seed", range(6))
def test_gears_mesh_and_are_as_large_as_their_teeth(seed):
    teeth = np.random.default_rng(seed).integers(5, (30, 61, 120, 401)[seed % 4], 4).tolist()
    (svg,) = shown(result(teeth[:2], teeth[2:]))
    circles = {}
    for mark in marks(svg, "circle", "reference"):
        circles.setdefault(mark.get("style"), []).append(numbers(mark, "cx", "r"))
    ends = [(x + s * r, s) for rows in circles.values() for x, r in rows for s in (-1, 1)]
    assert len(circles) == 2 and len(ends) == 8
    for pair, (z1, z2) in zip(
        circles.values(), zip(teeth[:2], teeth[2:], strict=True), strict=True
    ):
        (x1, r1), (x2, r2) = pair if pair[0][0] < pair[1][0] else pair[::-1]
        assert abs(x2 - x1 - r1 - r2) < 0.03  # reference circles touch
        assert abs(r1 / z1 - r2 / z2) < 0.02 / min(z1, z2)
    texts = [t.text for t in svg.iter("text")]
    distances = {f"{0.5 * (z1 + z2):g}·m" for z1, z2 in zip(teeth[:2], teeth[2:], strict=True)}
    assert {f"z {z}" for z in teeth} | distances <= set(texts)
    legible(svg)


@pytest.mark.parametrize(
    ("ratio", "teeth", "wider"),
    [
        (1000.0, [12, 60], [[12, 380]]),
        (0.01, [12, 60], [[12, 120], [6, 60]]),
        (25.4, [12, 60], [[12, 61]]),
        (1.0001, [20, 20], [[20, 21]]),
        (1e6, [12, 60], []),
        (1e-5, [17, 17], []),
    ],
)
def test_the_asked_ratio_stands_beside_the_ratios_in_reach(ratio, teeth, wider):
    svg = out_of_reach(ratio, teeth, wider)
    bars = [numbers(e, "x", "width") for e in marks(svg, "rect", "range")]
    (asked,) = (numbers(e, "x1")[0] for e in marks(svg, "line", "gap"))
    spans = [2.0 * math.log(high / low) for low, high in [teeth, *wider]]
    assert len(bars) == len(spans)
    scale = [width / 2.0 / span for (_, width), span in zip(bars, spans, strict=True) if span]
    for per, (left, width), span in zip(scale, bars, spans, strict=False):
        middle = asked - per * math.log(ratio)  # ratio 1, in the middle of every range
        assert abs(left + 0.5 * width - middle) < 0.03 and abs(width - 2.0 * per * span) < 0.03
        assert abs(per - scale[0]) < 1e-3
    assert (asked > bars[0][0] + bars[0][1]) if ratio > 1 else (asked < bars[0][0])
    for (left, width), _ in zip(bars[1:], wider, strict=True):
        assert left - 0.02 <= asked <= left + width + 0.02
    legible(svg)


def test_a_ratio_in_reach_has_no_line():
    assert len(shown(result([16, 19], [43, 49]))) == 1


def influence(key, slope=None, price=None):
    step = "+7" if price else ""
    return Influence(key, "60", slope, (slope, slope), step, price)


@pytest.mark.parametrize("others", [(), (influence("train.play", 0.25),)])
def test_no_sensitivity_in_per_cent_is_given_of_an_objective_near_zero(others):
    """The squared error 2.7e-12 of a ratio of 6.931 changes by 175,583 % per 1 % of the ratio."""
    several = influence("train.ratio", 175583.6), influence("train.teeth[2]", price=-0.8), *others
    known = Explanation(result((16, 19), (43, 49)), influences=several)
    html = page(answered(known), "")
    assert "No sensitivity is given of train.ratio: 0.1 % of it changes the squared error" in html
    assert ("Sensitivities are changes of the squared error" in html) == bool(others)
    assert "175583" not in html.replace(",", "") and "175583" not in repr(known).replace(",", "")
    assert "train.teeth[2]" in html and ("train.play +0.25" in repr(known)) == bool(others)


def answered(known):
    return replace(known.result, report={**known.result.report, "prices": known.prices})
