"""The page and the terminal report of a servo train: the numbers of figures and drawings."""

import io
import json
import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
import servo_cases as cases
from page_reader import ATTACK, Reader, drawings, extents, marks, numbers, ours
from rich.console import Console

import gearopt
from gearopt.formulations.servo.servo_design import BoxDesign
from gearopt.optimise.typed import typed
from gearopt.report.kinds.servo.housing import axes
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages.result import page, sections, tables
from gearopt.report.terminal import show

HEADINGS = (
    "Result",
    "Total ratio",
    "Train",
    "Train and box",
    "Error and inertia",
    "Error and mass",
    "Where the error comes from",
    "Tolerances",
    "Monte Carlo errors",
    "Stiffness",
    "Limits",
    "What is proven, and how",
    "Assumptions and unverified data",
)


@pytest.fixture(scope="module")
def result():
    return cases.servo()


@pytest.fixture(scope="module")
def found(result):
    return {s.heading: s for s in sections(result)}


def drawing(result):
    (found,) = (s for s in sections(result) if s.heading == "Train and box")
    return ET.fromstring(found.drawings[0].svg)


def text(html):
    return re.sub(r"\s+", " ", "".join(Reader(html).text))


def test_the_cases_are_those_known_independently(result):
    design = result.design
    assert design["ratio"]["total_ratio"] == pytest.approx(57.786211, abs=1e-6)
    assert design["ratio"]["value"] == pytest.approx(47.287374, abs=1e-6)
    teeth = [(s["pinion_teeth"], s["wheel_teeth"]) for s in design["train"]["stages"]]
    assert teeth == [(17, 91), (23, 207)]
    assert design["train"]["error_deg"] == pytest.approx(0.11975, abs=5e-6)
    wide = cases.too_wide().design
    assert wide["train"]["error_deg"] == pytest.approx(0.1081916, abs=1e-7)
    assert wide["stiffness"]["frequency_Hz"] == pytest.approx(210.1, abs=0.05)
    assert wide["box"]["needed_width_mm"] == pytest.approx(90.32, abs=0.006)


def test_every_part_has_its_section_in_order(found):
    assert tuple(found) == HEADINGS


def test_the_bound_is_said_once(result, found):
    told = {tile.name: tile for tile in found["Result"].tiles}
    assert "proven bound" not in told and told["inertia"].remark == "proven optimal"
    near = {s.heading: s for s in sections(replace(result, gap=0.02))}["Result"]
    told = {tile.name: tile for tile in near.tiles}
    assert told["proven bound"].value.endswith("g cm²") and "gap 2 %" in told["proven bound"].remark


def test_the_curve_of_the_ratio_is_highest_at_the_optimum(result, found):
    made = found["Total ratio"]
    curve, best, given = made.figures[0].data
    top = int(np.argmax(curve["y"]))
    assert curve["x"][top] == best["x"][0] == result.design["ratio"]["total_ratio"]
    assert best["y"][0] == curve["y"][top] and given["x"] == [48.0]
    assert given["y"][0] == pytest.approx(46.304224, abs=1e-6)
    assert best["name"] == "best 57.786: 47.287 rad/s²"
    assert made.figures[0].layout["xaxis"]["type"] == "log"
    assert result.design["ratio"]["best"] is None or made.tables[0].name == "motor and load"
    near = [n for n, a in zip(curve["x"], curve["y"], strict=True) if a >= best["y"][0] / 1.01]
    assert f"from {near[0]:.1f} to {near[-1]:.1f}" in made.words[0]


def test_a_move_is_shortest_at_its_optimum():
    ratios = [10.0, 20.0, 40.0]
    ratio = {"duty": "move", "total_ratio": 20.0, "value": 1.0, "name": "move time", "unit": "s"}
    ratio |= {"given": None, "best": None}
    ratio |= {"curve": {"total_ratio": ratios, "value": [1.5, 1.0, 1.4]}}
    result = cases.servo()
    made = sections(replace(result, design={"ratio": ratio}, parts=()))[1]
    console = Console(width=99, record=True, file=io.StringIO())
    show(replace(result, design={"ratio": ratio}, parts=()), console)
    assert "Minimum move time: 1 s at a total ratio of 20." in console.export_text()
    assert [t["name"] for t in made.figures[0].data] == ["move time", "best 20: 1 s"]


def test_steps_of_the_errors_add_up_to_the_total(result, found):
    figure = found["Where the error comes from"].figures[0]
    *steps, total = figure.data
    bars = [bar for t in steps for bar in zip(t["y"], t["base"], t["x"], strict=True)]
    order = figure.layout["yaxis"]["categoryarray"][::-1]
    bars.sort(key=lambda bar: order.index(bar[0]))
    end = 0.0
    for (name, start, size), source in zip(bars, result.design["errors"], strict=True):
        assert name == source["source"] and math.isclose(start, end, abs_tol=1e-15)
        end = start + size
    assert total["x"] == [pytest.approx(end, abs=1e-15)] and total["y"] == [order[-1]]
    assert end == pytest.approx(0.11975, abs=5e-6)
    limit = figure.layout["shapes"][0]
    assert limit["x0"] == limit["x1"] == pytest.approx(0.12, rel=1e-9)
    over = replace(result, limits=result.limits | {"error": 1.25})
    section = {s.heading: s for s in sections(over)}["Where the error comes from"]
    old = ", with the old tolerances"  # beside which new ones stand
    assert section.words[0] == f"All sources at their limits exceed the limit by 0.023950°{old}."
    assert section.figures[0].caption.endswith(f"{old}.")
    assert section.tables[0].heads[3] == "old tolerance [µm]"
    tile = next(t for t in found["Result"].tiles if t.name == "error at the output")
    assert tile.remark == f"7.1850 arcmin{old}"
    assert found["Tolerances"].tables[0].heads[6] == "of the new error, %"


def test_equal_sources_are_bars_apart(result):
    design = result.design | {"errors": [result.design["errors"][0]] * 3}
    made = {s.heading: s for s in sections(replace(result, design=design))}
    figure = made["Where the error comes from"].figures[0]
    assert len(set(figure.data[0]["y"])) == 3
    assert figure.data[0]["base"][2] == 2.0 * design["errors"][0]["error_deg"]


def test_histogram_holds_every_draw(result, found):
    bars, mean, quantile, limit = found["Monte Carlo errors"].figures[0].data
    drawn = result.design["drawn"]
    assert sum(bars["y"]) == drawn["count"] and len(bars["x"]) == 60
    assert sum(bars["width"]) == pytest.approx(np.ptp(drawn["histogram"]["edges_deg"]))
    assert np.average(bars["x"], weights=bars["y"]) == pytest.approx(mean["x"][0], rel=2e-3)
    assert quantile["x"][0] == drawn["quantile_deg"] and limit["x"][0] == drawn["limit_deg"]
    band = found["Monte Carlo errors"].figures[0].layout["shapes"][0]
    assert band["x0"] == drawn["quantile_low_deg"] < quantile["x"][0] < band["x1"]
    share = re.match(
        r"([\d.]+) % of the Monte Carlo .* between ([\d.]+) and ([\d.]+) %", words(found)
    )
    good, low, high = map(float, share.groups())
    assert good == pytest.approx(100.0 * drawn["yield_share"], abs=1e-4)
    assert low <= 100.0 * drawn["yield_low"] and high >= 100.0 * drawn["yield_high"]
    assert high - low < 100.0 * (drawn["yield_high"] - drawn["yield_low"]) + 3e-4


def test_where_the_worst_case_is_within_the_limit_the_yield_is_100_percent(result):
    drawn = result.design["drawn"]
    drawn = drawn | {"limit_deg": 1.01 * drawn["worst_case_deg"]}
    made = sections(replace(result, design=result.design | {"drawn": drawn}))
    told = words({s.heading: s for s in made})
    assert "and so does every train: the yield is 100 %" in told and "confidence" not in told
    largest = {s.heading: s for s in made}["Monte Carlo errors"].words[1]
    assert "% of the Monte Carlo trains have" in largest and "the largest error drawn" in largest
    tile = next(t for t in made[0].tiles if t.name == "worst-case error, new tolerances")
    assert float(tile.value.rstrip("°")) == pytest.approx(drawn["worst_case_deg"], rel=1e-4)


def words(found):
    return found["Monte Carlo errors"].words[0]


def test_too_few_draws_have_no_interval(result):
    drawn = result.design["drawn"] | {"quantile_high_deg": math.inf}  # None in JSON
    made = {s.heading: s for s in sections(replace(result, design={"drawn": drawn}))}[
        "Monte Carlo errors"
    ]
    assert "too few draws" in made.words[1] and made.figures[0].layout["shapes"] == []


def test_trains_are_where_they_belong_and_the_chosen_one_is_marked(result, found):
    for heading, key, factor in (
        ("Error and inertia", "inertia_kg_m2", 1e7),
        ("Error and mass", "mass_kg", 1.0),
    ):
        figure = found[heading].figures[0]
        drawn = {t["name"]: t for t in figure.data}
        shown = sum(len(t["x"]) for name, t in drawn.items() if name != "chosen")
        assert shown == len(result.report["trains"])
        chosen = result.design["train"]
        assert drawn["chosen"]["x"] == [pytest.approx(factor * chosen[key])]
        assert drawn["chosen"]["y"] == [chosen["error_deg"]]
        told = drawn["minimum error"]["text"][0]
        assert "50/264, m_n 0.3 mm" in told and "29/263, m_n 0.4 mm" in told
    assert "none dominates another" in found["Error and inertia"].figures[0].caption
    trains = result.report["trains"]
    worse = trains[0] | {"error_deg": 2.0 * trains[0]["error_deg"], "best_of": ""}
    made = sections(replace(result, report={"trains": [*trains, worse]}))
    caption = {s.heading: s for s in made}["Error and inertia"].figures[0].caption
    assert "none better" not in caption and caption.startswith(f"{len(trains) + 1} of the best")


def test_tolerance_table_and_its_sums(result, found):
    table = found["Tolerances"].tables[0]
    *rows, sums = table.rows
    given = result.design["tolerances"]
    assert [r[3].value for r in rows] == [pytest.approx(1e3 * g["old_mm"]) for g in given]
    assert [r[4].value for r in rows] == [pytest.approx(1e3 * g["new_mm"]) for g in given]
    assert sums[3:6] == ["", "", ""] and sums[7].value == pytest.approx(14.0)
    assert sums[8].value == pytest.approx(result.design["allocation"]["cost"])
    assert sum(r[6].value for r in rows) == pytest.approx(100.0)
    bars = np.array([(r[8].share, r[8].value) for r in rows])
    assert np.ptp(bars[:, 0] / bars[:, 1]) < 1e-9 and bars[:, 0].max() < 0.9995
    at_end = [r[0] for r in rows if r[4].text.startswith("max")]
    assert at_end and all("stage 1" in name for name in at_end)


def test_shares_of_springs(result, found):
    made = found["Stiffness"]
    (bars,) = made.figures[0].data
    assert sum(bars["x"]) == pytest.approx(100.0) and bars["y"][-1] == "shaft between the stages"
    assert [t.value for t in made.tiles] == ["0.00060263°"]
    stiff = {tile.name: tile for tile in found["Result"].tiles}["stiffness at the output"]
    assert (stiff.value, stiff.remark) == (
        "40,092 N m/rad",
        "natural frequency 226.47 Hz, motor locked",
    )


@pytest.mark.parametrize("make", [cases.servo, cases.too_wide])
def test_axes_reach_as_far_as_the_box_needs(make):
    box = make().design["box"]
    at = axes(typed(BoxDesign, box))
    assert at.right - at.left == pytest.approx(box["needed_width_mm"], rel=1e-12)
    assert at.top - at.bottom == pytest.approx(box["needed_height_mm"], rel=1e-12)
    assert math.dist(at.motor, at.middle) == pytest.approx(box["links_mm"][0])
    assert math.hypot(*at.middle) == pytest.approx(box["links_mm"][1])


@pytest.mark.parametrize("make", [cases.servo, cases.too_wide])
def test_the_box_is_drawn_to_scale(make):
    result = make()
    box, svg = result.design["box"], drawing(result)
    rectangle = marks(svg, "rect", "box")[0]
    width, height = numbers(rectangle, "width", "height")
    scale = width / box["inner_width_mm"]
    assert height == pytest.approx(scale * box["inner_height_mm"], abs=0.02)
    needed = numbers(marks(svg, "rect", "wall")[0], "width", "height")
    meant = [scale * box[f"needed_{side}_mm"] for side in ("width", "height")]
    assert needed == pytest.approx(meant, abs=0.02)
    motor, wheel = marks(svg, "circle", "motor")[0], marks(svg, "circle", "tip")[0]
    for drawn, radius in zip((motor, wheel), box["radii_mm"][:2], strict=True):
        assert float(drawn.get("r")) == pytest.approx(scale * radius, abs=0.02)
    places = [
        numbers(mark, "cx", "cy") for mark in (motor, wheel, marks(svg, "circle", "shaft")[0])
    ]
    links = [math.dist(a, b) for a, b in zip(places, places[1:], strict=False)]
    assert links == pytest.approx([scale * a for a in box["links_mm"]], abs=0.03)


def test_the_sector_has_its_radius_and_angles():
    result = cases.servo()
    box, svg = result.design["box"], drawing(result)
    scale = numbers(marks(svg, "rect", "box")[0], "width")[0] / box["inner_width_mm"]
    for style, half in (("swept", 90.0), ("tip", 45.0)):
        path = marks(svg, "path", style)[0].get("d")
        move, rest = re.match(r"M (\S+ \S+) L (.*) Z", path).groups()
        edge, radius, large, sweep, end = re.match(
            r"(\S+ \S+) A (\S+) \S+ 0 (\d) (\d) (\S+ \S+)", rest
        ).groups()
        (cx, cy), start, stop = ([float(v) for v in p.split()] for p in (move, edge, end))
        assert float(radius) == pytest.approx(scale * 52.25, abs=0.01) and sweep == "0"
        assert large == "0" or half == 90.0  # of half a turn either arc is the same
        turns = [math.degrees(math.atan2(cy - y, x - cx)) for x, y in (start, stop)]
        off = [(t - box["output_angle_deg"] + 180.0) % 360.0 - 180.0 for t in turns]
        assert off == pytest.approx([-half, half], abs=0.02)


def test_a_wide_sweep_takes_the_longer_arc():
    svg = drawing(cases.servo(half_sweep=120.0))
    assert " 0 1 0 " in marks(svg, "path", "swept")[0].get("d")
    full = drawing(cases.servo(half_sweep=180.0))
    assert not marks(full, "path", "swept") and len(marks(full, "circle", "tip")) == 4


@pytest.mark.parametrize("make", [cases.servo, cases.too_wide])
def test_labels_are_inside_and_do_not_cover_each_other(make):
    svg = drawing(make())
    size = np.array(svg.get("viewBox").split()[2:], float)
    told = list(extents(svg))
    names = {word for word, _, _ in told}
    assert {"80.00", "130.00", "motor", "wheel 1", "wheel 2", "hub", "sweep ±90°"} <= names
    for k, (word, at, half) in enumerate(told):
        assert (at - half >= 0.0).all() and (at + half <= size).all(), word
        for other, there, reach in told[:k]:
            assert (abs(at - there) >= half + reach).any(), (word, other)


def test_what_does_not_fit_is_said_so():
    html = page(cases.too_wide(), "x")
    shown = text(html)
    assert "does not fit: it needs 90.32 x 104" in shown and "10.32 mm in width" in shown
    assert "mirror" not in shown
    assert "The train fits: it needs 78.77 x 103.88 mm" in text(page(cases.servo(), "x"))


def test_generic_sections_look_right(result):
    shown = text(page(result, "x"))
    for phrase in (
        "31,877 choices of teeth and modules examined",
        "91/17 · 207/23, +0.368 %",
        "inverse acceleration",
        "bending stress",
        "Density, motor radius",
        "7.1850 arcmin",
        "1.5623 g cm²",
    ):
        assert phrase in shown, phrase
    assert "Next best trains" not in shown and "Design" not in [s.heading for s in sections(result)]


@pytest.mark.parametrize(
    ("keys", "headings"),
    [
        (("ratio",), ["Total ratio"]),
        (("train",), ["Train", "Error and inertia", "Error and mass"]),
        (("tolerances", "allocation", "drawn"), ["Tolerances", "Monte Carlo errors"]),
        (("errors",), ["Where the error comes from"]),
        (("box",), ["Train and box"]),
        (("stiffness",), ["Stiffness"]),
    ],
)
def test_missing_tables_are_missing_sections(keys, headings):
    part = cases.part_of(*keys)
    made = [s.heading for s in sections(part)]
    assert [h for h in made if h in HEADINGS[1:10]] == headings
    console = Console(width=99, record=True, file=io.StringIO())
    show(part, console)
    assert len(console.export_text()) > 100


def test_a_train_without_a_box_is_drawn_in_one_line():
    front, side = drawings(page(cases.part_of("train"), "x"))
    assert {"16.20", "57.50", "wheel 2"} <= {t.text for t in front.iter("text")}
    assert "z 207" in {t.text for t in side.iter("text")}


def test_proven_impossible_says_why():
    told = {"status": "infeasible", "bound": None, "gap": None, "design": {}, "report": {}}
    told |= {"objective": {"name": "cost", "value": None}, "limits": {}, "certificate": {}}
    proof = {"method": "closed form", "sentence": "Proof: friction takes all its torque."}
    assert "Proof: friction takes" in text(page(cases.servo(**told, proof=proof), "x"))


def test_an_inch_page_names_no_millimetre_but_those_of_modules(result):
    html = page(result, "x", INCH)
    shown = text(ours(html))
    for near in re.findall(r".{20}\bmm[²³]?\b", shown):
        assert "m_n" in near
    for figure in re.findall(r'<script type="application/json">(.*?)</script>', html, re.S):
        assert not re.search(r"\bmm\b|µm", re.sub(r"m_n [\d.]+ mm", "", figure))
    assert "3.101 x 4.090 in" in shown and "354,844 lbf in/rad" in shown
    assert "0.0085421 oz in²" in shown and "old [mil]" in shown
    metric = {s.heading: s for s in sections(result, METRIC)}["Tolerances"].tables[0].rows
    inch = {s.heading: s for s in sections(result, INCH)}["Tolerances"].tables[0].rows
    for a, b in zip(metric[:-1], inch[:-1], strict=True):
        assert a[4].value == pytest.approx(25.4 * b[4].value)


def test_nothing_is_loaded_from_anywhere(result):
    html = page(result, "x")
    loads = [
        value
        for _, attributes in Reader(html).tags
        for name, value in attributes.items()
        if name in ("src", "href", "xlink:href", "data", "action", "srcset", "poster")
    ]
    assert loads[0] == "data:,"
    assert all(address.startswith("data:text/csv;charset=utf-8;base64,") for address in loads[1:])
    assert not re.search(r"https?:|//[a-z]|@import|url\(", ours(html))


def test_words_of_the_user_are_escaped(result):
    design = json.loads(json.dumps(result.to_dict()["design"]))
    for row in (*design["tolerances"], *design["stiffness"]["springs"]):
        row["name"] += ATTACK
    for row in design["errors"]:
        row["source"] += ATTACK
        row["kind"] += ATTACK
    html = page(replace(result, design=design, asked={"title": ATTACK}), ATTACK)
    read = Reader(html)
    assert {tag for tag, _ in read.tags}.isdisjoint({"b"})
    assert [kind for kind, _ in read.scripts].count("") == 1
    for kind, script in (s for s in read.scripts if "json" in s[0]):
        if kind:
            assert "<" not in json.dumps(json.loads(script)["data"]).replace("<br>", "").replace(
                "<extra></extra>", ""
            )


def test_the_page_needs_nothing_but_the_json(result):
    again = gearopt.Result.from_json(result.to_json())
    assert page(again, "x") == page(result, "x")


def test_tables_are_csv(result):
    names = set(tables(result))
    assert {"stages.csv", "train.csv", "tolerances.csv", "springs.csv", "limits.csv"} <= names


def test_the_terminal_tells_all_below_100_columns(result):
    console = Console(width=99, record=True, file=io.StringIO())
    show(result, console)
    shown = console.export_text()
    for phrase in (
        "The limit on minimum second pinion diameter determines the inertia;",
        "inertia [g cm²]",
        "tolerance [µm]",
        "0.11975  7.185  100.0",
        "99.8850 % of the Monte Carlo trains",
        "alone [N m/rad]",
        "The train fits",
        "171.19°",
    ):
        assert phrase in shown, phrase
    assert max(map(len, shown.splitlines())) <= 99 and "…" not in shown
