"""Gears without a layout, drawn with all shafts in one plane: to scale, labels clear, told so."""

import xml.etree.ElementTree as ET
from dataclasses import replace
from functools import cache

import layout_cases as cases
import numpy as np
import pytest
from page_reader import Reader, drawings, extents, marks, numbers
from rated_files import pair

import gearopt
from gearopt.formulations.drive.design import describe
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.typed import untyped
from gearopt.physics.blanks import Blank
from gearopt.report.drawing.train_views import BESIDE, PITCH, WIDE, beside, views
from gearopt.report.measures import METRIC
from gearopt.report.pages.result import page

HELICAL = Toothing(0.4)
TRAINS = {  # m_n, z1, z2, b of every stage
    "two stages": ((2.0, 21, 115, 27.805), (3.0, 23, 91, 57.1)),
    "one stage": ((1.5, 28, 125, 33.6),),
    "one to one": ((4.0, 30, 30, 96.0),),
    "1000 in two": ((2.0, 20, 1597, 26.5), (8.0, 20, 248, 132.4)),
    "1000 in one": ((2.0, 20, 19800, 32.0),),
    "six stages": (
        (1.5, 21, 140, 20.854),
        (3.0, 20, 88, 39.722),
        (4.0, 25, 83, 66.203),
        (6.0, 25, 76, 99.304),
        (8.0, 27, 88, 142.998),
        (12.0, 25, 77, 248.26),
    ),
    "six alike": ((2.5, 20, 40, 30.0),) * 6,
    "six one to one": ((2.5, 20, 20, 30.0),) * 6,
    "six that shrink": tuple((m, 20, 60, 10.0 * m) for m in (12.0, 8.0, 6.0, 4.0, 2.5, 1.5)),
    "real-valued": (
        (1.4712345, 21.6341, 170.49123, 28.0971),
        (2.9184321, 22.3801, 95.51234, 57.6361),
        (10.151234, 23.1881, 68.18512, 207.7781),
    ),
    "wide, and a small last wheel": ((1.167, 22.51, 162.1, 78.8), (2.405, 25.06, 27.56, 180.8)),
}


def result(rows, toothing=HELICAL, **blanks):
    width = FaceWidth(0, None)
    stage = Stage((1.0, 1.0), width, (), (1, None), toothings=(toothing,), **blanks)
    stages = (stage,) * len(rows)
    train = Train(5e4, 1, 0, stages, law=K_FACTOR, speed=150.0)
    pairs = tuple(train.pair(k, *row) for k, row in enumerate(rows))
    design = untyped(describe(train, pairs))
    objective = {"name": "gear_volume", "value": 1.0, "unit": "mm3"}
    return gearopt.Result(
        name="drive",
        scene="drive",
        status="optimal",
        method="exact",
        objective=objective,
        design=design,
    )


@cache
def case(name):
    found = result(TRAINS[name])
    return found.design["stages"], drawings(page(found, "gearopt solve x.toml"))


def gears(stages):
    """(place of the axis [mm], stage, member) of every gear."""
    axes = np.cumsum([0.0, *(s["centre_distance_mm"] for s in stages)])
    for k, stage in enumerate(stages):
        yield axes[k], stage, "pinion"
        yield axes[k + 1], stage, "wheel"


def scale_of(stages, front):
    """px/mm, by the length over tip circles."""
    tips = [(y, s[f"{m}_tip_diameter_mm"] / 2) for y, s, m in gears(stages)]
    drawn = [numbers(e, "cx", "r") for e in marks(front, "circle", "tip")]
    length = max(y + r for y, r in tips) - min(y - r for y, r in tips)
    return (max(x + r for x, r in drawn) - min(x - r for x, r in drawn)) / length, length


@pytest.mark.parametrize("name", TRAINS)
def test_circles_are_where_and_as_large_as_the_gears(name):
    stages, (front, _) = case(name)
    scale, _ = scale_of(stages, front)
    for style, key in (("tip", "tip_diameter_mm"), ("reference", "diameter_mm")):
        drawn = np.array(sorted(numbers(e, "cx", "cy", "r") for e in marks(front, "circle", style)))
        meant = sorted((scale * y, scale * s[f"{m}_{key}"] / 2) for y, s, m in gears(stages))
        assert len(drawn) == 2 * len(stages) and np.ptp(drawn[:, 1]) == 0.0
        left = min(numbers(e, "cx")[0] for e in marks(front, "circle", style))
        both = np.array(sorted((x - left, r) for x, _, r in drawn))
        assert np.allclose(both, np.array(sorted(meant)), atol=0.03)


@pytest.mark.parametrize("name", TRAINS)
def test_reference_circles_touch_as_many_times_as_there_are_stages(name):
    stages, (front, _) = case(name)
    circles = [
        (e.get("style"), *numbers(e, "cx", "r")) for e in marks(front, "circle", "reference")
    ]
    touching = [
        (one, other)
        for k, (one, x, r) in enumerate(circles)
        for other, u, s in circles[:k]
        if abs(abs(x - u) - r - s) < 0.04
    ]
    assert sum(one == other for one, other in touching) >= len(stages)


@pytest.mark.parametrize("name", TRAINS)
def test_side_view_has_the_scale_of_the_front_view_and_stages_apart(name):
    stages, (front, side) = case(name)
    scale, _ = scale_of(stages, front)
    drawn = sorted(numbers(e, "width", "height") for e in marks(side, "rect", "tip"))
    meant = sorted(
        (scale * s["face_width_mm"], scale * s[f"{m}_tip_diameter_mm"]) for _, s, m in gears(stages)
    )
    assert np.allclose(drawn, meant, atol=0.03)
    spans = sorted({tuple(numbers(e, "x", "width")) for e in marks(side, "rect", "tip")})
    assert len(spans) == len(stages)
    for (x, wide), (after, other) in zip(spans, spans[1:], strict=False):
        assert after - x - wide > 15.9 and after + other / 2 - x - wide / 2 > PITCH - 0.1
    assert marks(side, "rect", "box") == marks(front, "circle", "shaft") == []
    for svg in (front, side):
        assert float(svg.get("viewBox").split()[2]) <= WIDE + 1e-6


@pytest.mark.parametrize("name", TRAINS)
def test_dimensions_are_told(name):
    stages, (front, side) = case(name)
    shown = [t.text for t in front.iter("text")]
    for stage in stages:
        assert f"{stage['centre_distance_mm']:.2f}" in shown
    assert f"{scale_of(stages, front)[1]:.2f}" in shown
    names = {f"{m} {k}" for m in ("pinion", "wheel") for k in range(1, len(stages) + 1)}
    assert names <= set(shown)
    level = {t.text: float(t.get("y")) for t in front.iter("text")}
    dimensions = [level[f"{stage['centre_distance_mm']:.2f}"] for stage in stages]
    assert max(level[n] for n in names) < min(dimensions)
    beside = [t.text for t in side.iter("text")]
    for k, stage in enumerate(stages, 1):
        assert f"b{k} {stage['face_width_mm']:.1f}" in beside
    assert len([t for t in beside if t.startswith("m_n ")]) == len(stages)
    assert len([t for t in beside if t.startswith("z ")]) == 2 * len(stages)
    for texts in (shown, beside):
        assert {str(k) for k in range(1, len(stages) + 2)} <= set(texts)


@pytest.mark.parametrize("name", TRAINS)
def test_labels_are_inside_and_do_not_cover_each_other(name):
    for svg in case(name)[1]:
        size = np.array(svg.get("viewBox").split()[2:], float)
        texts = list(extents(svg))
        assert len(texts) > 5
        for k, (word, at, half) in enumerate(texts):
            assert (at - half >= 0.0).all() and (at + half <= size).all(), word
            for other, there, reach in texts[:k]:
                assert (abs(at - there) >= half + reach).any(), (word, other)


def test_rims_hubs_and_bores_are_circles():
    """Of pinions of 20 teeth a bore alone: their rims leave no room for a hub of 33.6 mm."""
    made = Blank(3.0, None, 0.3, 21.0)
    found = result(TRAINS["six alike"][:1], blanks=(made, made))
    html = page(found, "x")
    front = drawings(html)[0]
    (stage,) = found.design["stages"]
    tips = [float(e.get("r")) for e in marks(front, "circle", "tip")]
    scale = max(tips) / stage["wheel_tip_diameter_mm"]
    inside = stage["wheel_root_diameter_mm"] - 2.0 * 7.5
    sizes = sorted(float(e.get("r")) / scale for e in marks(front, "circle", "body"))
    assert sizes == pytest.approx([21.0, 21.0, 33.6, inside], rel=1e-3)
    words = "thin ones the insides of rims, hubs and bores"
    assert words in "".join(Reader(html).text)
    assert words not in "".join(Reader(page(result(TRAINS["one stage"]), "x")).text)


def test_wider_gears_are_drawn_about_the_middle_of_their_mesh():
    """Pinions 20 mm wider than the mesh, wheels 4 mm; the page tells all widths."""
    found = result(TRAINS["six alike"][:3], Toothing(0.4, width_excesses=(20.0, 4.0)))
    html = page(found, "x")
    front, side = drawings(html)
    scale, _ = scale_of(found.design["stages"], front)
    drawn = sorted(numbers(e, "x", "width") for e in marks(side, "rect", "tip"))
    widths = sorted(wide / scale for _, wide in drawn)
    assert widths == pytest.approx([34.0] * 3 + [50.0] * 3, abs=0.05)
    middles = [x + wide / 2 for x, wide in sorted(drawn, key=sum)]
    assert sorted(middles)[::2] == pytest.approx(sorted(middles)[1::2], abs=0.05)
    pinions = sorted(each for each in drawn if each[1] > 40.0 * scale)
    assert all(b[0] - a[0] - a[1] > 15.9 for a, b in zip(pinions, pinions[1:], strict=False))
    shown = "".join(Reader(html).text)
    assert "face width of the pinion" in shown and "face width of the wheel" in shown


def test_words_say_that_nothing_is_optimised_and_how_it_would_be():
    html = page(result(TRAINS["two stages"]), "x")
    shown = "".join(Reader(html).text)
    assert "shafts are drawn in one plane: their positions are not optimised" in shown
    assert "A [layout] table" in shown and "Gears with all shafts in one plane" in shown
    other = page(replace(result(TRAINS["two stages"]), scene="another"), "x")
    assert "A [layout] table" not in other and "shafts in one plane" in other  # of drives alone


def test_a_laid_out_or_missing_design_is_not_drawn_so():
    found = result(TRAINS["two stages"])
    assert drawings(page(replace(found, design={}), "")) == []
    laid_out = cases.elevator().design
    html = page(replace(found, design=laid_out), "")
    assert len(drawings(html)) == 3 and "in one plane" not in "".join(Reader(html).text)


def test_several_trains_are_drawn_to_one_scale():
    names = ("two stages", "one stage", "six stages", "one to one")
    designs = {name: result(TRAINS[name]).design["stages"] for name in names}
    drawn = beside(designs, METRIC)
    assert [one.caption for one in drawn] == [f"{name.capitalize()}." for name in names]
    assert max(one.width for one in drawn) == pytest.approx(BESIDE)
    scales = []
    for one, stages in zip(drawn, designs.values(), strict=True):
        svg = ET.fromstring(one.svg)
        scales.append(scale_of(stages, svg)[0])
        tips = sorted(numbers(e, "r")[0] for e in marks(svg, "circle", "tip"))
        meant = sorted(s[f"{m}_tip_diameter_mm"] / 2 for _, s, m in gears(stages))
        assert np.allclose(tips, np.multiply(meant, scales[-1]), atol=0.01)
    assert np.ptp(scales) < 1e-3 * max(scales)


def test_the_output_of_two_stages_of_one_distance_is_drawn_in_line_with_the_input():
    found = result(((2.0, 20, 80, 30.0), (2.0, 24, 76, 40.0)))
    stages = found.design["stages"]
    shown = page(found, "gearopt solve x.toml")
    front, side = drawings(shown)
    axes = sorted({numbers(e, "cx")[0] for e in marks(front, "circle", "tip")})
    tips = {s[f"{m}_tip_diameter_mm"] for s in stages for m in ("pinion", "wheel")}
    scale = 2.0 * max(numbers(e, "r")[0] for e in marks(front, "circle", "tip")) / max(tips)
    assert len(axes) == 2
    assert axes[1] - axes[0] == pytest.approx(scale * stages[0]["centre_distance_mm"], abs=0.03)
    assert [t.text for t in front.iter("text")].count("1") == 1  # a balloon of each shaft
    middles = [
        y + h / 2 for y, h in (numbers(e, "y", "height") for e in marks(side, "rect", "tip"))
    ]
    assert len({round(m, 1) for m in middles}) == 2
    assert "the output in line with the input" in shown
    assert "the design is not of this drawing but of all shafts in one line, over" in shown
    assert "total length in one line [mm]" in shown


def test_a_face_width_that_is_not_dimensioned_stands_with_its_gear():
    """Widths of 45, 40 (an idler) and 36 mm: in the side view, and of each gear under Teeth."""
    own = {"pinion": {"face_width": "45 mm"}, "wheel": {"face_width": "40 mm"}}
    tables = pair(pinion_teeth=20, wheel_teeth=31, **own)
    del tables["stage"][0]["face_width"]
    tables["stage"].append({"idler": True, "wheel_teeth": 60, "wheel": {"face_width": "36 mm"}})
    found = gearopt.rate(tables).design
    texts = list(ET.fromstring(views(found["stages"], METRIC)[-1].svg).itertext())
    assert [t for t in map(str.strip, texts) if t.startswith(("z ", "b1"))] == [
        "b1 40.0",
        "z 60, b 36.0",
        "z 31",
        "z 20, b 45.0",
    ]
    assert [row["face_width_mm"] for row in found["rating"]["teeth"]] == [45.0, 40.0, 40.0, 36.0]
