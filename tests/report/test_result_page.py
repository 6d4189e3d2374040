"""The page of a result: drawings to scale, gears that mesh, numbers, self-contained, escaped."""

import base64
import json
import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import layout_cases as cases
import numpy as np
import pytest
from campaigns import few
from page_reader import ATTACK, Reader, drawings, extents, marks, numbers, ours

import gearopt
from gearopt.formulations.drive.layout.layout_design import LayoutDesign
from gearopt.optimise.typed import typed
from gearopt.physics.gears import Gear
from gearopt.report.drawing.bodies import cropped_keep_outs, layout_of, nearest
from gearopt.report.drawing.sheet import SHEET, SIZE
from gearopt.report.drawing.solid import Toothed, block, gear_mesh, rod, upright
from gearopt.report.kinds.drive.layout_solid import MAX_TRIANGLES
from gearopt.report.pages import frame
from gearopt.report.pages.result import page

ROOM = Path(frame.__file__).parent
MADE = (cases.three_stage, cases.partial_span, cases.elevator, cases.boxed_in)
LAYOUTS = {f.__name__: f for f in MADE}
PACKINGS = {f.__name__: f for f in (cases.packing, cases.round_packing)}


def figures(html):
    return [json.loads(text) for kind, text in Reader(html).scripts if "json" in kind]


@pytest.fixture(scope="module", params=LAYOUTS)
def layout(request):
    result = LAYOUTS[request.param]()
    return result.design["layout"], page(result, "gearopt solve x.toml")


def scales(found, svgs):
    """px/mm of the box in the front, side and top view, both ways."""
    sizes = [("width_mm", "height_mm"), ("length_mm", "height_mm"), ("length_mm", "width_mm")]
    boxes = [marks(svg, "rect", "box")[0] for svg in svgs]
    return [
        np.divide(numbers(drawn, "width", "height"), [found["box"][key] for key in pair])
        for pair, drawn in zip(sizes, boxes, strict=True)
    ]


def test_views_have_one_scale(layout):
    found, html = layout
    svgs = drawings(html)
    scale = np.array(scales(found, svgs))
    assert scale.shape == (3, 2) and np.ptp(scale) < 1e-4 * scale.mean()
    shares = [float(v) for v in re.findall(r"px; max-width: ([\d.]+)%", html)]
    widths = [float(v) for v in re.findall(r'<figure style="--width: ([\d.]+)px', html)]
    drawn = [float(svg.get("viewBox").split()[2]) for svg in svgs]
    assert widths == drawn and max(shares) == 100.0
    assert np.ptp(np.divide(shares, drawn)) < 1e-6  # so they also shrink alike
    assert max(drawn) <= 640.0
    printed = float(re.search(r"--printed: ([\d.]+)", html)[1])
    assert printed == 1.0 or printed * (drawn[0] + drawn[1] + 18.0) <= 680.0 * (1.0 + 1e-4)
    tall = max(float(svg.get("viewBox").split()[3]) for svg in svgs)
    assert 0.58 <= printed and (printed in (0.58, 1.0) or printed * tall <= 480.1)


def test_heights_of_front_and_side_view_are_the_same(layout):
    _, html = layout
    front, side, _ = (marks(svg, "rect", "box")[0] for svg in drawings(html))
    assert numbers(front, "y", "height") == numbers(side, "y", "height")


def test_circles_are_where_and_as_large_as_the_gears(layout):
    found, html = layout
    svgs = drawings(html)
    scale = np.mean(scales(found, svgs))
    box, (left, bottom) = found["box"], numbers(marks(svgs[0], "rect", "box")[0], "x", "y")
    bottom += scale * box["height_mm"]
    places = {s["shaft"]: (s["y_mm"], s["z_mm"]) for s in found["shafts"]}
    for style, key in (("tip", "tip_diameter_mm"), ("reference", "reference_diameter_mm")):
        drawn = sorted(numbers(e, "cx", "cy", "r") for e in marks(svgs[0], "circle", style))
        meant = sorted(
            (
                left + scale * (places[g["shaft"]][0] - box["left_mm"]),
                bottom - scale * (places[g["shaft"]][1] - box["bottom_mm"]),
                scale * g[key] / 2,
            )
            for g in found["gears"]
        )
        assert np.allclose(drawn, meant, atol=0.02)
    assert len(marks(svgs[0], "circle", "shaft")) == len(found["shafts"])


def test_gears_from_the_side_are_as_wide_as_they_are(layout):
    found, html = layout
    svgs = drawings(html)
    scale = np.mean(scales(found, svgs))
    for svg in svgs[1:]:
        drawn = sorted(numbers(e, "width", "height") for e in marks(svg, "rect", "tip"))
        meant = sorted(
            (scale * (g["to_mm"] - g["from_mm"]), scale * g["tip_diameter_mm"])
            for g in found["gears"]
        )
        assert np.allclose(drawn, meant, atol=0.02)
        assert len(marks(svg, "rect", "bearing")) == len(found["bearings"])
        near = cropped_keep_outs(typed(LayoutDesign, found))
        assert len(marks(svg, "rect", "obstacle")) == len(near)
        assert len(marks(svg, "rect", "motor")) == (found["motor"] is not None)


def test_keep_outs_are_cut_off_near_the_box():
    result = cases.boxed_in()
    found = result.design["layout"]
    near = {it.name: it for it in cropped_keep_outs(layout_of(result))}
    assert set(near) == {"floor", "step"}
    bottom, height = found["box"]["bottom_mm"], found["box"]["height_mm"]
    lowest = min(bottom, -50.0)  # the motor's underside is lower than the box
    assert math.isclose(near["floor"].bottom_mm, lowest - 0.12 * (bottom + height - lowest))
    assert near["floor"].top_mm == -60.0 and near["step"].left_mm == 300.0
    html = page(result, "x")
    words = text(html)
    assert "cut off" in words and "as long as it is wide" in words and "far wall" in words
    front, side, _ = drawings(html)
    assert {"floor", "step", "motor ⌀ 100"} <= {t.text for t in (*front.iter(), *side.iter())}


@pytest.mark.parametrize("case", LAYOUTS)
def test_gaps_are_drawn_as_long_as_they_are(case):
    found = layout_of(LAYOUTS[case]())
    for gap in found.gaps:
        for names in (gap.between, gap.between[::-1]):
            ends = nearest(found, *names)
            assert ends is not None, names
            assert math.isclose(math.dist(*ends), gap.gap_mm, rel_tol=1e-9), names
    assert nearest(found, "wheel 1", "nothing") is None


def test_labels_are_inside_and_do_not_cover_each_other(layout):
    for svg in drawings(layout[1]):
        size = np.array(svg.get("viewBox").split()[2:], float)
        texts = list(extents(svg))
        assert len(texts) > 8
        for k, (word, at, half) in enumerate(texts):
            assert (at - half >= 0.0).all() and (at + half <= size).all(), word
            for other, there, reach in texts[:k]:
                assert (abs(at - there) >= half + reach).any(), (word, other)


def test_dimensions_and_names():
    svgs = drawings(page(cases.three_stage(), "x"))
    front, side, top = ({t.text for t in svg.iter("text")} for svg in svgs)
    assert {"411.98", "873.29", "gap 3.31", "a1 = 211.85", "a2 = 216.81", "a3 = 251.57"} <= front
    assert {"209.90", "b1 26.8", "b2 47.8", "b3 95.3"} <= side & top
    names = {f"{member} {k}" for member in ("pinion", "wheel") for k in (1, 2, 3)}
    assert names | {"1", "2", "3", "4"} <= front & side & top
    front = {t.text for t in drawings(page(cases.elevator(), ""))[0].iter("text")}
    assert {"split", "rope sheave"} <= front


def packed(array):
    return np.frombuffer(base64.b64decode(array["bdata"]), "<" + array["dtype"])


def solid(trace):
    """Points (n, 3) and triangles (m, 3) of a trace."""
    return (
        np.stack([packed(trace[k]) for k in "xyz"], axis=1),
        np.stack([packed(trace[k]) for k in "ijk"], axis=1),
    )


def gear_traces(found, html):
    traces = [t for t in figures(html)[0]["data"] if t["name"].startswith("stage")]
    assert len(traces) == len(found["gears"])
    return traces


def test_solid_gears_have_their_teeth_between_root_and_tip(layout):
    found, html = layout
    places = {s["shaft"]: (s["y_mm"], s["z_mm"]) for s in found["shafts"]}
    total = 0
    for gear, trace in zip(found["gears"], gear_traces(found, html), strict=True):
        points, triangles = solid(trace)
        total += len(triangles)
        assert triangles.max() < len(points)
        rims, middles = points[:-2], points[-2:]
        place = np.array(places[gear["shaft"]])
        assert np.allclose(middles[:, 1:], place, atol=1e-3)
        radius = np.hypot(*(rims[:, 1:] - place).T)
        assert radius.min() > gear["root_diameter_mm"] / 2 - 1e-3
        assert radius.max() < gear["tip_diameter_mm"] / 2 + 1e-3
        assert np.allclose(
            [points[:, 0].min(), points[:, 0].max()], [gear["from_mm"], gear["to_mm"]]
        )
        ring = radius[rims[:, 0] == rims[0, 0]]
        high = ring > gear["reference_diameter_mm"] / 2
        assert np.sum(high & ~np.roll(high, 1)) == gear["teeth"]
        assert trace["color"] == f"--series-{gear['stage']}"
    assert 1000 < total <= MAX_TRIANGLES


def test_solid_gears_are_twisted_by_their_helix(layout):
    """Over the face by 2 b tan(beta)/d: opposite in a pair, alike on a shaft."""
    found, html = layout
    places = {s["shaft"]: (s["y_mm"], s["z_mm"]) for s in found["shafts"]}
    hands = {}
    for gear, trace in zip(found["gears"], gear_traces(found, html), strict=True):
        points = solid(trace)[0][:-2].astype(float)
        around = np.sum(points[:, 0] == points[0, 0])
        y, z = (points[[0, -around]][:, 1:] - places[gear["shaft"]]).T
        start, end = np.arctan2(z, y)
        turn = (end - start + math.pi) % (2 * math.pi) - math.pi
        slope = math.tan(math.radians(gear["helix_angle_deg"]))
        meant = 2 * slope * (gear["to_mm"] - gear["from_mm"]) / gear["reference_diameter_mm"]
        assert abs(abs(turn) - meant) < 1e-4
        hands.setdefault(("stage", gear["stage"]), []).append(np.sign(turn))
        hands.setdefault(("shaft", gear["shaft"]), []).append(np.sign(turn))
    for (kind, _), signs in hands.items():
        assert sum(signs) == (0 if kind == "stage" else len(signs) * signs[0])


def depth(points, polygon):
    """How deep the deepest of the points lies inside a polygon; 0 where none does."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    p = points[:, None, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (p[..., 1] - a[:, 1]) * (b - a)[:, 0] / (b - a)[:, 1]
    crossed = ((a[:, 1] > p[..., 1]) != (b[:, 1] > p[..., 1])) & (p[..., 0] < at)
    inside = crossed.sum(axis=1) % 2 == 1
    share = ((p - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1)
    foot = a + np.clip(share, 0.0, 1.0)[..., None] * (b - a)
    far = np.hypot(*np.moveaxis(p - foot, -1, 0)).min(axis=1)
    return float(np.max(far * inside, initial=0.0))


def test_teeth_in_mesh_do_not_overlap(layout):
    """At both faces of every stage, though pinion and wheel are twisted there."""
    found, html = layout
    traces = gear_traces(found, html)
    for pinion, wheel, gear in zip(traces[::2], traces[1::2], found["gears"][::2], strict=True):
        (p, _), (w, _) = solid(pinion), solid(wheel)
        for x in (p[0, 0], p[-3, 0]):
            one, other = (q[:-2][q[:-2, 0] == x][:, 1:].astype(float) for q in (p, w))
            module = gear["normal_module_mm"]
            pitch_point = other[np.argmin(np.hypot(*(other - one.mean(axis=0)).T))]
            near = [q[np.hypot(*(q - pitch_point).T) < 8 * module] for q in (one, other)]
            assert min(map(len, near)) >= 10
            assert max(depth(near[0], other), depth(near[1], one)) < 0.06 * module


def volume(mesh):
    points, triangles = np.array(mesh[0]), np.array(mesh[1])
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum()) / 6.0


def test_bodies_are_closed_and_turned_outwards():
    around = 48 / 2 / math.pi * math.sin(2 * math.pi / 48)  # polygon over circle
    assert math.isclose(volume(rod((3, 4), 10, 5, 25)), around * math.pi * 2000)
    assert math.isclose(volume(rod((3, 4), 10, 5, 25, 5)), around * math.pi * 1500)
    assert math.isclose(volume(upright(rod((3, 4), 10, 5, 25))), around * math.pi * 2000)
    assert math.isclose(volume(block((1, 2, 3), (2, 4, 6))), 6.0)
    rack = [
        volume(gear_mesh(Toothed(Gear(3.0, 60, 180.0, 30.0, helix), 0, 30, (1, 2)), 3, 0.05))
        for helix in (0.0, 0.4, -0.4)
    ]
    middle = math.pi / 4 * 180**2 * 30
    assert all(0.97 * middle < v < middle for v in rack)  # the dedendum is the larger half


def test_clearances_are_hidden_at_first_and_the_narrowest_gap_is_right():
    traces = figures(page(cases.three_stage(), "x"))[0]["data"]
    hidden = [t for t in traces if t.get("visible") == "legendonly"]
    assert {t["legendgroup"] for t in hidden} == {"clearances"} and len(hidden) == 8
    line = hidden[-1]
    ends = np.array([line[k] for k in "xyz"]).T
    assert math.isclose(np.linalg.norm(ends[1] - ends[0]), 3.3086034943, rel_tol=1e-6)


@pytest.mark.parametrize("case", PACKINGS)
def test_packing_plans_are_to_scale(case):
    result = PACKINGS[case]()
    html = page(result, "x")
    svgs, design = drawings(html), result.design
    assert len(svgs) == len(design["layers"])
    scale = set()
    for svg, layer in zip(svgs, design["layers"], strict=True):
        drawn = marks(svg, "circle", "cylinder")
        on = [c for c in design["cylinders"] if c["layer"] == layer["layer"]]
        for element, it in zip(drawn, on, strict=True):
            scale.add(round(2.0 * float(element.get("r")) / it["diameter_mm"], 2))
            assert ("fixed" in element.get("class")) == it["fixed"]
        places = np.array([numbers(e, "cx", "cy") for e in drawn])
        meant = np.array([(c["x_mm"], -c["y_mm"]) for c in on])
        assert np.allclose(places - places[0], max(scale) * (meant - meant[0]), atol=0.1)
        size = "⌀ 30.00" if case == "round_packing" else "40.00"
        assert size in {t.text for t in svg.iter("text")}
    assert len(scale) == 1
    solids = [t for t in figures(html)[0]["data"] if t["type"] == "mesh3d"]
    assert len(solids) == len(design["cylinders"])


@pytest.mark.slow
def test_progress_tells_best_bound_and_gap():
    plot = figures(page(cases.three_stage(), "x"))[1]
    best, bound = plot["data"]
    assert best["y"] == [98.3e3, 76.0e3, 75516.512, 75516.512] and plot["layout"]["xaxis"]
    assert bound["y"] == [41.2e3, 55.1e3, 70.2e3, 75508.96, 75508.96]
    assert "gap 43.9 %" in best["text"][0] and "40 evaluations" in best["text"][0]
    assert plot["layout"]["xaxis"]["type"] == "log"
    unbounded = [step | {"bound": None} for step in cases.PROGRESS]
    plot = figures(page(cases.three_stage(report={"progress": unbounded}), "x"))[1]
    assert [t["name"] for t in plot["data"]] == ["best"]
    assert "gap" not in " ".join(plot["data"][0]["text"])
    for none in ([], [cases.PROGRESS[0]]):
        assert len(figures(page(cases.three_stage(report={"progress": none}), ""))) == 1


EVERY = LAYOUTS | PACKINGS


@cache
def page_of(case):
    return page(EVERY[case](), "x")


@pytest.mark.parametrize("case", EVERY)
def test_nothing_is_loaded_from_anywhere(case):
    html = page_of(case)
    loads = [
        value
        for _, attributes in Reader(html).tags
        for name, value in attributes.items()
        if name in ("src", "href", "xlink:href", "data", "action", "srcset", "poster")
    ]
    assert loads[0] == "data:,"
    assert all(address.startswith("data:text/csv;charset=utf-8;base64,") for address in loads[1:])
    assert not re.search(r"https?:|//[a-z]|@import|url\(", ours(html))


@pytest.mark.parametrize("case", few(EVERY, ["boxed_in", "packing"]))
def test_words_of_the_user_are_escaped(case):
    result = EVERY[case]()
    design = json.loads(json.dumps(result.design))
    for body in (*design.get("layout", {}).get("obstacles", ()), *design.get("cylinders", ())):
        body["name"] += ATTACK
    report = result.report | {"notes": [ATTACK]}
    asked = {"title": ATTACK, "source": ATTACK, "duty": {ATTACK: ATTACK}}
    result = replace(result, design=design, report=report, message=ATTACK, asked=asked)
    html = page(result, ATTACK)
    read = Reader(html)
    assert {tag for tag, _ in read.tags}.isdisjoint({"b"})
    assert [kind for kind, _ in read.scripts].count("") == 1
    assert "".join(read.text).count(ATTACK) >= 5
    for trace in (t for figure in figures(html) for t in figure["data"]):
        assert "<script" not in trace.get("hovertemplate", "")  # plotly reads tags there


@pytest.mark.parametrize("case", few(EVERY, ["boxed_in", "packing"]))
def test_the_page_needs_nothing_but_the_json(case):
    again = gearopt.Result.from_json(EVERY[case]().to_json())
    assert page(again, "x") == page_of(case)


@pytest.mark.slow
def test_colours_are_those_of_the_page():
    style = (ROOM / "frame.css").read_text(encoding="utf-8")
    known = set(re.findall(r"(--[\w-]+):", style))
    for make in EVERY.values():
        for figure in figures(page(make(), "x")):
            used = set(re.findall(r'"(--[\w-]+)(?:/[\d.]+)?"', json.dumps(figure)))
            assert used and used <= known
    drawing = (ROOM / "drawing.css").read_text(encoding="utf-8")
    assert set(re.findall(r"var\((--[\w-]+)\)", drawing)) <= known | {"--c", "--width", "--printed"}
    assert f"font: {SIZE:g}px" in drawing


def text(html):
    return re.sub(r"\s+", " ", "".join(Reader(html).text))


def test_a_plain_drive_gives_a_light_page_without_plots():
    result = gearopt.solve("problems/elevator.toml", top=3)
    html = page(result, "gearopt solve x.toml")
    assert len(html) < 42_000 and len(drawings(html)) == 2 and figures(html) == []
    shown = text(html)
    assert (
        "Proven optimal: the limits on K-factor of stages 1 and 2 determine the gear volume"
        in shown
    )
    for words in ("5,782.4 cm³", "trains compared", "150.06", "5,789.2"):
        assert words in shown, words


@pytest.mark.slow
def test_an_impossible_request_says_what_to_write(solved):
    result = solved("elevator_small_wheels")
    shown = text(page(result, "x"))
    assert "impossible, proven" in shown and "Remedies" in shown
    assert 'limits.wheel_diameter = "283 mm"' in shown and "282.492" not in shown
    for way in result.report["ways_out"]["remedies"]:
        for change in way["changes"]:
            assert f"{change['key']} = {change['short'] or change['write']}" in shown


@pytest.mark.slow
def test_the_page_takes_what_the_solver_gives(solved):
    result = solved("table4_process_one_layout")
    front, side, _ = drawings(page(result, "x"))
    words = {t.text for t in front.iter("text")}
    assert {"411.98", "873.29", "a1 = 211.85"} <= words and any(w[:4] == "gap " for w in words)
    assert "209.90" in {t.text for t in side.iter("text")}
    found = layout_of(result)
    for gap in found.gaps:
        ends = nearest(found, *gap.between)
        assert ends is not None
        assert math.isclose(math.dist(*ends), abs(gap.gap_mm), rel_tol=1e-9)


def test_numbers_of_the_layout_are_in_its_tables():
    shown = text(page(cases.three_stage(), "x"))
    for words in (
        "75.517 dm³",
        "Proven within 0.01 %",
        "evaluations6,503",
        "382.01",
        "3.31",
    ):
        assert words in shown, words


def test_plots_are_as_wide_as_a_printed_page():
    """Browsers lay a page out for paper only after the script could ask how wide it is."""
    script = (ROOM / "frame.js").read_text(encoding="utf-8")
    assert f"const sheet = {SHEET:g};" in script and "layout.width = sheet" in script
