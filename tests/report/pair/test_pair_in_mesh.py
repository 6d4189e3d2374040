"""A spur pair drawn, in space, and moving in mesh: held against geometry that is not its own.

Numbers of the reference pair, m 3, z 25/50, 20 degrees, are those of an independent calculation.
"""

import base64
import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from page_reader import extents, marks, ours

from gearopt.physics.blanks import Body
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import usable_path
from gearopt.physics.mesh_cycle import cycle
from gearopt.report.drawing.sheet import SIZE
from gearopt.report.kinds.pair.mesh_motion import Carried, in_mesh
from gearopt.report.kinds.pair.path_plots import Line, over_path, zone_words
from gearopt.report.kinds.pair.solid import figure
from gearopt.report.kinds.pair.tooth_section import sections
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages.result import page
from gearopt.report.pages.result import sections as sections_of

PAIRS = {
    "reference": GearPair.of_teeth(3.0, 25, 50, 30.0),
    "shifted": GearPair.of_teeth(4.0, 18, 40, 40.0, profile_shifts=(0.3, -0.1)),
    "undercut": GearPair.of_teeth(3.0, 12, 50, 30.0),
}


def carried(pair):
    """A cycle whose pairs carry 30 and 70 per cent where two touch; the error is 5 and 8 um."""
    found = cycle(usable_path(pair), 24)
    two = found.present.all(axis=1)
    shares = np.where(two[:, None], [0.3, 0.7], [1.0, 0.0])
    return Carried(found.travels, found.positions, shares, np.where(two, 0.005, 0.008))


@pytest.fixture(scope="module", params=PAIRS)
def moving(request):
    pair = PAIRS[request.param]
    given = carried(pair)
    return pair, given, in_mesh(pair, "mesh", {"": given}, METRIC)


def outlines(made, view=0):
    """Polygon of each body at every moment [px], as the player draws them."""
    data = made.data
    tracks = [np.frombuffer(base64.b64decode(t), "<f4").astype(float) for t in data["tracks"]]
    svg = ET.fromstring(made.row.drawings[view].svg)
    groups = [g for g in svg.iter("g") if g.get("class") == "moves"]
    found = []
    for body, group in zip(data["bodies"], groups, strict=True):
        d = group.find("path").get("d")
        points = np.array(re.findall(r"-?[\d.]+", d), float).reshape(-1, 2)
        places = tracks[body["places"]].reshape(-1, 3)
        turn = np.radians(places[:, 2])[:, None]
        x, y = points.T
        at = np.stack(
            (x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)), axis=-1
        )
        found.append((group, at + places[:, None, :2], body))
    return found, tracks


def away(point, polygon):
    """Distance of a point from a polygon's edge."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    edge = b - a
    share = ((point - a) * edge).sum(1) / np.maximum((edge**2).sum(1), 1e-12)
    foot = a + np.clip(share, 0.0, 1.0)[:, None] * edge
    return float(np.hypot(*(point - foot).T).min())


def inside(point, polygon):
    """Whether a point lies in a polygon."""
    (x, y), a, b = point, polygon, np.roll(polygon, -1, axis=0)
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (y - a[:, 1]) * (b - a)[:, 0] / (b - a)[:, 1]
    return bool((crosses & (x < at)).sum() % 2)


def test_both_flanks_touch_where_the_dots_are_and_teeth_do_not_overlap(moving):
    """At every third moment, to what chords and rounding of the drawn flanks leave."""
    pair, given, made = moving
    found, _ = outlines(made)
    titles = [g.find("title").text for g, _, _ in found]
    pinion, wheel = (found[titles.index(name)][1] for name in ("pinion", "wheel"))
    scale = made.views[0].sheet.scale
    chord = 0.004 * pair.normal_module
    for moment in range(0, len(given.travels), 3):
        for k in range(2):
            if np.isnan(given.positions[moment, k]):
                continue
            dot = found[titles.index(f"point of contact of pair {k + 1}")][1][moment].mean(axis=0)
            assert away(dot, pinion[moment]) < scale * chord
            assert away(dot, wheel[moment]) < scale * chord
            for member in ("pinion", "wheel"):
                tooth = found[titles.index(f"{member}, pair {k + 1}")][1][moment]
                assert away(dot, tooth) < scale * chord
        middle = np.array(made.views[0].sheet.at(0.0, 0.0))
        near = [
            p for p in pinion[moment] if np.hypot(*(p - middle)) < 4 * pair.normal_module * scale
        ]
        deep = [away(p, wheel[moment]) for p in near if inside(p, wheel[moment])]
        assert len(near) > 60 and max(deep, default=0.0) < 2.0 * scale * chord


def test_dots_lie_on_the_tangent_of_both_base_circles(moving):
    pair, given, made = moving
    found, _ = outlines(made)
    sheet = made.views[0].sheet
    first, second = (0.5 * float(d) for d in pair.working_diameters)
    axes = sheet.at(0.0, -first), sheet.at(0.0, second)
    tangents = math.sqrt((first + second) ** 2 - (0.5 * _base(pair)) ** 2)
    for _, polygon, _ in found[-2:]:
        for dot in polygon.mean(axis=1)[~np.isnan(polygon[:, 0, 0])]:
            reach = [
                math.sqrt((np.hypot(*(dot - axis)) / sheet.scale) ** 2 - 0.25 * float(d) ** 2)
                for axis, d in zip(axes, (g.base_diameter for g in pair.gears), strict=True)
            ]
            assert sum(reach) == pytest.approx(tangents, abs=2e-3)


def _base(pair):
    return float(pair.pinion.base_diameter) + float(pair.wheel.base_diameter)


def test_one_base_pitch_later_each_pair_is_in_the_place_of_the_next(moving):
    _, _, made = moving
    found, _ = outlines(made)
    titles = [g.find("title").text for g, _, _ in found]
    for member in ("pinion", "wheel"):
        one, two = (found[titles.index(f"{member}, pair {k}")][1] for k in (1, 2))
        assert np.allclose(one[-1], two[0], atol=0.03)


def test_teeth_are_coloured_by_what_they_carry(moving):
    _, given, made = moving
    found, tracks = outlines(made)
    shown = {g.find("title").text: tracks[b["values"]] for g, _, b in found if "values" in b}
    assert len(shown) == 4
    two = ~np.isnan(given.positions[:, 1])
    for member in ("pinion", "wheel"):
        one, other = (shown[f"{member}, pair {k}"] for k in (1, 2))
        assert np.allclose(one, np.where(two, 0.3, 1.0))
        assert np.allclose(other[two], 0.7) and np.isnan(other[~two]).all()
    jump = np.flatnonzero(np.diff(given.travels) == 0.0)
    assert len(jump) == 1 and two[jump[0]] and not two[jump[0] + 1]
    assert two[made.still]
    assert dict(made.read_out)["share of pair 2"] == "70.0 %"
    assert dict(made.read_out)["transmission error"] == "5.00 µm"


def test_before_and_after_stand_side_by_side_on_one_clock():
    pair = PAIRS["reference"]
    given = carried(pair)
    made = in_mesh(pair, "mesh", {"before": given, "after": given}, INCH)
    assert [d.caption for d in made.row.drawings] == ["Before", "After"]
    names = [name for name, _ in made.read_out]
    assert names[0] == "pair 1 at s" and "after: share of pair 2" in names
    assert dict(made.read_out)["before: transmission error"] == "0.1969 mil"
    place = made.readings[0].text(0)
    assert place == f"{-7.7700 / 25.4:.3f} in"
    assert len(made.data["bodies"]) == 2 * 8
    alone = in_mesh(pair, "mesh", {"": given}, METRIC)
    assert alone.row.widest > made.row.widest  # two fit beside each other


def test_columns_of_a_path_become_pairs_again():
    found = cycle(usable_path(PAIRS["reference"]), 7)
    given = carried(PAIRS["reference"])
    columns = given.along(given.positions), given.along(given.shares)
    again = Carried.of_columns(given.travels, *columns, given.error)
    assert np.array_equal(again.positions, given.positions, equal_nan=True)
    assert np.allclose(again.percent, given.percent, equal_nan=True)
    assert np.array_equal(given.along(given.positions), np.sort(columns[0]))
    assert found.positions.shape[1] == 2


def test_the_tooth_section_has_the_numbers_of_the_gear():
    drawn = sections(PAIRS["reference"], METRIC)
    pinion, wheel = ({t.text for t in ET.fromstring(d.svg).iter("text")} for d in drawn)
    assert {"d_a 81.00", "d 75.00", "d_Ff 70.94", "d_b 70.48", "d_f 67.50"} <= pinion
    assert {"d_a 156.00", "d 150.00", "d_Ff 144.94", "d_b 140.95", "d_f 142.50"} <= wheel
    assert {"s 4.712", "s_a 2.159", "α 20.00°", "α_L 18.17°", "ρ_F 1.310"} <= pinion
    assert {"s 4.712", "s_a 2.326", "α 20.00°", "α_L 19.60°", "ρ_F 1.228"} <= wheel


def test_the_tooth_section_is_to_scale():
    """Tip land, and the waist at the form circle of the reference pinion."""
    drawn, _ = sections(PAIRS["reference"], METRIC)
    svg = ET.fromstring(drawn.svg)
    (tooth,) = marks(svg, "path", "tip")
    points = np.array(re.findall(r"-?[\d.]+", tooth.get("d")), float).reshape(-1, 2)
    scale = 400.0 / (2.0 * 2.3 * 3.0)
    middle = 14.0 + 200.0
    top = points[points[:, 1] < points[:, 1].min() + 0.02]
    assert np.ptp(top[:, 0]) == pytest.approx(scale * 81.0 * math.sin(2.159458 / 81.0), abs=0.05)
    assert np.mean(top[:, 0]) == pytest.approx(middle, abs=0.02)
    root = points[np.abs(points[:, 0] - middle) < 0.55 * math.pi * 3.0 * scale]
    deep = root[:, 1].max() - top[0, 1]
    assert deep == pytest.approx(scale * (40.5 - 33.75 * math.cos(math.pi / 25)), abs=1.5)


@pytest.mark.parametrize("name", PAIRS)
def test_texts_of_the_tooth_section_are_inside_and_apart(name):
    for drawn in sections(PAIRS[name], METRIC):
        svg = ET.fromstring(drawn.svg)
        size = np.array(svg.get("viewBox").split()[2:], float)
        texts = list(extents(svg))
        assert len(texts) >= 8
        for k, (word, at, half) in enumerate(texts):
            assert (at - half >= -1.0).all() and (at + half <= size + 1.0).all(), word
            for other, there, reach in texts[:k]:
                assert (abs(at - there) >= 0.9 * (half + reach)).any(), (word, other)
        assert f"font: {SIZE:g}px" not in drawn.svg  # of drawing.css


def volume(trace):
    """Volume of a closed mesh; 0 < where its faces look outwards."""
    kinds = {"f4": "<f4", "u2": "<u2", "u4": "<u4"}

    def unpacked(part):
        return np.frombuffer(base64.b64decode(part["bdata"]), kinds[part["dtype"]])

    points = np.stack([unpacked(trace[k]).astype(float) for k in "xyz"], axis=1)
    a, b, c = (points[unpacked(trace[k])] for k in "ijk")
    return float((a * np.cross(b, c)).sum()) / 6.0


def test_gears_in_space_have_the_volume_of_their_bodies():
    """Disc, bored disc, web between rim and hub: sections by hand, teeth as the ring to d."""
    pair = PAIRS["reference"]
    wheel = math.pi / 4.0 * 30.0 * 150.0**2
    bodies = {
        "disc": (Body(None, None, None, None), 0.0),
        "bored": (Body(None, None, None, 50.0), math.pi / 4.0 * 30.0 * 50.0**2),
        "web": (
            Body(12.0, 10.0, 80.0, 50.0),
            math.pi / 4.0 * (30.0 * 50.0**2 + 20.0 * ((142.5 - 24.0) ** 2 - 80.0**2)),
        ),
    }
    found = {}
    for name, (body, off) in bodies.items():
        made = figure(pair, (Body(None, None, None, 30.0), body), METRIC)
        found[name] = volume(made.data[1]) + off
        faces = re.findall(r'class="face gear"', made.still.svg)
        assert len(faces) == (4 if name == "web" else 2)  # rim and hub are seen on paper, too
    assert found["bored"] == pytest.approx(found["disc"], rel=1e-3)
    assert found["web"] == pytest.approx(found["disc"], rel=1e-3)
    assert 0.96 * wheel < found["disc"] < wheel  # the dedendum is the larger half


@pytest.mark.parametrize("teeth", [(25, 50), (18, 400)])
def test_gears_in_space_are_light(teeth):
    pair = GearPair.of_teeth(3.0, *teeth, 30.0)
    made = figure(pair, (Body(None, None, None, 20.0), Body(12.0, 10.0, 80.0, 50.0)), METRIC)
    size = sum(len(t[k]["bdata"]) for t in made.data for k in "xyzijk")
    assert size < 1_000_000 and len(made.still.svg) < 120_000
    assert [t["name"] for t in made.data] == ["pinion", "wheel", "shafts", "shafts"]


def test_a_plot_over_the_path_has_its_zones_and_jumps_exactly():
    pair = PAIRS["reference"]
    given, path = carried(pair), usable_path(pair)
    lines = [Line(given.percent, "share", 1), Line(1e3 * given.error, "error", 2)]
    made = over_path(given, path, lines, "share [%]", "Share.", METRIC, "mesh", [("c'", 13.3)])
    share, error, level = made.data
    assert share["x"][0] == pytest.approx(-7.7700, abs=1e-4)
    assert share["x"][-1] == pytest.approx(7.1367, abs=1e-4)
    at = [(x, y) for x, y in zip(share["x"], share["y"], strict=True)]
    for place, values in ((-1.7197, [30.0, 100.0]), (1.0864, [70.0, 100.0])):
        assert sorted(y for x, y in at if abs(x - place) < 1e-4) == sorted(values), place
    assert sorted({round(y, 6) for y in error["y"]}) == [5.0, 8.0] and level["y"] == [13.3, 13.3]
    (zone,) = (s for s in made.layout["shapes"] if s["type"] == "rect")
    assert (zone["x0"], zone["x1"]) == pytest.approx((-1.7197, 1.0864), abs=1e-4)
    names = [note["text"] for note in made.layout["annotations"]]
    assert names == list("ABCDE")  # in their order
    assert made.follows == "mesh" and "one pair" in zone_words(path)


def test_letters_of_points_that_are_close_stand_as_one(solved):
    found = sections_of(solved("almost_two_pairs"))
    mesh = next(section for section in found if section.heading == "Teeth in mesh")
    for plot in mesh.figures:
        assert [n["text"] for n in plot.layout["annotations"]] == ["A", "B D C", "E"]
        assert len([s for s in plot.layout["shapes"] if s["type"] == "line"]) == 5


def test_zones_of_fewest_pairs_above_a_contact_ratio_of_two():
    """z 40/50 with long addenda: two zones of two pairs, each as long as 3 - eps base pitches."""
    pair = GearPair.of_teeth(3.0, 40, 50, 30.0)
    gears = [_longer(gear) for gear in pair.gears]
    pair = GearPair(*gears)
    path = usable_path(pair)
    ratio = float(path.transverse_ratio)
    assert 2.0 < ratio < 3.0
    found = cycle(path, 12)
    given = Carried(found.travels, found.positions, np.ones_like(found.positions), found.travels)
    made = over_path(given, path, [Line(given.error, "a", 1)], "a", "A.", METRIC)
    rects = [s for s in made.layout["shapes"] if s["type"] == "rect"]
    assert len(rects) == 2 and "fewest" in zone_words(path)
    for rect in rects:
        assert rect["x1"] - rect["x0"] == pytest.approx((3.0 - ratio) * float(path.base_pitch))


def _longer(gear):
    return replace(gear, rack=replace(gear.rack, addendum=1.3, dedendum=1.5, tip_radius=0.25))


def test_the_page_of_a_pair_shows_it_moving(solved):
    """Reference pair: shares at the ends of the path and beside the single zone, as printed."""
    result = solved("reference_pair")
    found = sections_of(result)
    heads = [section.heading for section in found]
    shown = ["Teeth in mesh", "Contact", "Tooth sections", "In three dimensions"]
    assert [head for head in heads if head in shown] == shown
    mesh = found[heads.index("Teeth in mesh")]
    (moves,) = mesh.animations
    assert [figure.follows for figure in mesh.figures] == [moves.name] * 3
    half, full = mesh.figures[0].data
    assert [half["name"], full["name"]] == ["at 50 %", "at 100 %"]
    for trace in (half, full):
        y = trace["y"]
        assert (y[0], y[-1]) == pytest.approx((40.08, 41.20), abs=0.02)
        jumps = [(a, b) for a, b in pairwise(y) if abs(a - b) > 20.0]
        assert jumps == [
            (pytest.approx(58.80, abs=0.02), 100.0),
            (100.0, pytest.approx(59.92, abs=0.02)),
        ]
    shares = [r.values for r in moves.readings if r.name.startswith("share")]
    assert np.allclose(np.nansum(shares, axis=0), 100.0)
    pairs, whole, *iso = mesh.figures[2].data
    assert max(pairs["y"]) == pytest.approx(12.17, abs=0.01) and iso[1]["y"][0] > 13.3
    alone = [y for x, y in zip(whole["x"], whole["y"], strict=True) if -1.7 < x < 1.0]
    assert alone == pytest.approx(
        [y for x, y in zip(pairs["x"], pairs["y"], strict=True) if -1.7 < x < 1.0], rel=1e-5
    )  # one pair alone is the mesh


def test_the_page_of_a_pair_is_light_and_loads_nothing(solved):
    html = ours(page(solved("reference_pair"), "gearopt solve x.toml"))
    assert len(html) < 260_000 and html.count('class="player"') == 1
    assert not re.search(r"https?:|//[a-z]|@import|url\(", html)
