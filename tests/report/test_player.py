"""Animations of a page: the still of a moment, the numbers that the player reads, the page."""

import base64
import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from page_reader import ATTACK, Reader, ours

from gearopt.report.drawing.player import Animation, Body, Reading, Scale, View
from gearopt.report.drawing.sheet import Sheet, Window
from gearopt.report.pages import frame
from gearopt.report.pages.frame import render
from gearopt.report.plots import Figure, axis, layout
from gearopt.report.section import Section

ROOM = Path(frame.__file__).parent
CONTRIBUTING = Path(__file__).parents[2] / "docs" / "contributing.md"
TIMES = [0.0, 1.0, 1.0, 4.0]  # one jump
SQUARE = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
PLACES = [(0.0, 0.0, 0.0), (4.0, 2.0, 0.5), (np.nan, 0.0, 0.0), (4.0, -2.0, np.pi)]


def animation(still=1, **more):
    sheet = Sheet(Window(-5.0, 5.0, -4.0, 4.0, (10.0, 10.0, 10.0, 10.0)), 20.0)
    sheet.line((-5.0, 0.0), (5.0, 0.0), "axis")
    grows = np.array([1.0, 1.0, 2.0, 3.0])[:, None, None] * np.array(SQUARE)
    behind = Body(grows, style="heat", values=[0.0, 25.0, np.nan, 200.0], title="grows")
    front = Body(SQUARE, PLACES, colour="--series-2", label="P")
    given = {
        "readings": [Reading("load", [0.1, 2.345, np.nan, 1.0], "kN", 1)],
        "scale": Scale("load", 0.0, 100.0, "%"),
        "marks": [[0.0, 1.0], [1.0, 2.0], [1.0, np.nan], [4.0, 3.0]],
    }
    views = [View(sheet, "a view", (behind,), (front,))]
    return Animation("all that moves", views, TIMES, still=still, **(given | more))


def moved(made):
    """Marks of the first view at the still's moment."""
    svg = ET.fromstring(made.row.drawings[0].svg)
    return list(svg), [g for g in svg.iter("g") if g.get("class") == "moves"]


def tracks(made):
    """Numbers that the player reads."""
    data = made.data
    return data, [np.frombuffer(base64.b64decode(t), "<f4") for t in data["tracks"]]


def test_a_still_shows_bodies_where_they_are():
    every, (behind, front) = moved(animation())
    assert every[0] is behind and every[-1] is front and every[1].tag == "line"
    assert front.get("transform") == "translate(190.00 50.00)"  # 10 + 20 (4 + 5), 10 + 20 (4 - 2)
    assert front[0].get("transform") == "rotate(-28.6479)"  # half a rad, y downwards
    assert front[0].get("d") == "M20.00 -20.00L-20.00 -20.00L-20.00 20.00L20.00 20.00Z"
    assert front[1].text == "P" and "--c: var(--series-2)" in front[0].get("style")
    assert "--v: 0.2500" in behind[1].get("style") and behind[0].text == "grows"


def test_bodies_without_a_place_or_a_value_are_not_seen():
    _, (behind, front) = moved(animation(still=2))
    assert behind.get("style") == front.get("style") == "display: none"
    _, (behind, front) = moved(animation(still=3))
    assert "--v: 1.0000" in behind[1].get("style")  # above the scale
    assert behind[1].get("d").startswith("M60.00 -60.00L") and front.get("style") is None


def test_the_player_reads_what_was_given():
    data, found = tracks(animation())
    assert found[data["times"]].tolist() == TIMES  # both sides of the jump
    behind, front = data["bodies"]
    assert set(behind) == {"outline", "values"} and set(front) == {"places"}
    outline = found[behind["outline"]].reshape(4, 4, 2)
    assert np.allclose(outline[3] / 20.0, 3.0 * np.array(SQUARE) * (1.0, -1.0))
    places = found[front["places"]].reshape(4, 3)
    assert np.allclose(places[3], (190.0, 130.0, -180.0)) and np.isnan(places[2, 0])
    assert np.allclose(found[behind["values"]], (0.0, 0.25, np.nan, 1.0), equal_nan=True)
    one, other = (found[k] for k in data["marks"])
    assert one.tolist() == [0.0, 1.0, 1.0, 4.0] and np.isnan(other[2])


def test_equal_numbers_are_kept_once():
    made = animation()
    twice = Animation("two", made.views * 2, TIMES)
    assert len(twice.data["bodies"]) == 4
    assert len(twice.data["tracks"]) == 1 + 2  # times; an outline and places


@pytest.mark.parametrize(
    "change",
    [
        {"times": [0.0, 2.0, 1.0, 4.0]},
        {"times": [1.0, 2.0, 3.0, 4.0]},
        {"times": [0.0]},
        {"times": [0.0, 1.0, 2.0]},
        {"readings": [Reading("load", [1.0, 2.0])]},
    ],
)
def test_numbers_that_do_not_belong_together_are_refused(change):
    given = {"times": TIMES, "readings": []} | change
    with pytest.raises(ValueError, match="times"):
        Animation("a", animation().views, **given)


def test_readings_have_their_decimals_and_unit():
    texts = [animation(still=k).read_out[0][1] for k in range(4)]
    assert texts == ["0.1 kN", "2.3 kN", "–", "1.0 kN"]
    assert Reading("pairs", [2.0], decimals=0).text(0) == "2"


def page(*sections):
    moves = any(section.animations for section in sections)
    given = {"sections": sections, "left_out": "", "source": None, "moves": moves, "plots": False}
    return render("result.html", "A page", "", {"gearopt": "0"}, "", {}, **given)


def test_a_page_has_one_player_for_all_its_animations():
    plot = Figure([], layout(axis("x"), axis("y")), "a plot", follows="all that moves")
    html = page(
        Section("One", animations=[animation()], figures=[plot]),
        Section("Two", animations=[animation(still=3)]),
    )
    read = Reader(html)
    assert [kind for kind, _ in read.scripts].count("") == 1
    players = [a for tag, a in read.tags if tag == "figure" and a.get("class") == "player"]
    assert len(players) == 2
    controls = [a for _, a in read.tags if a.get("class") == "controls"]
    assert len(controls) == 2 and all("hidden" in a for a in controls)  # without a script
    sliders = [a for tag, a in read.tags if tag == "input"]
    assert all(a["type"] == "range" and a["aria-label"] == "load" for a in sliders)
    assert 'data-follows="all that moves"' in html
    assert not re.search(r"https?:|//[a-z]|@import|url\(", ours(html))
    assert 'class="player"' not in page(Section("None")) and "player(" not in page(Section("None"))


def test_words_of_an_animation_are_escaped():
    sheet = Sheet(Window(0.0, 1.0, 0.0, 1.0), 100.0)
    body = Body(SQUARE, label=ATTACK, title=ATTACK)
    reading = Reading(ATTACK, [0.0, 1.0], ATTACK)
    made = Animation(ATTACK, [View(sheet, ATTACK, (body,))], [0.0, 1.0], ATTACK, [reading])
    read = Reader(page(Section("One", animations=[made])))
    assert {tag for tag, _ in read.tags}.isdisjoint({"b"})
    assert "".join(read.text).count(ATTACK) >= 4
    (data,) = (json.loads(text) for kind, text in read.scripts if "json" in kind)
    assert data["name"] == ATTACK


def test_colours_of_the_player_are_those_of_the_page():
    frame_, player = ((ROOM / f"{n}.css").read_text(encoding="utf-8") for n in ("frame", "player"))
    known = re.findall(r"(--[\w-]+):", frame_ + player)
    assert set(re.findall(r"var\((--[\w-]+)\)", player)) <= {*known, "--v"}
    assert known.count("--heat-1") == known.count("--heat-3") == 2  # light and dark


def test_colours_of_a_scale_differ_in_lightness_alone():
    """So they are told apart by everyone: darker on paper, brighter on a dark page."""
    css = (ROOM / "player.css").read_text(encoding="utf-8")
    found = re.findall(r"--heat-[123]: #(\w\w)(\w\w)(\w\w)", css)
    linear = (np.array([[int(v, 16) for v in row] for row in found]) / 255.0) ** 2.2
    light, dark = (linear @ (0.2126, 0.7152, 0.0722)).reshape(2, 3)
    assert (np.diff(light) < -0.25).all() and (np.diff(dark) > 0.15).all()


def test_the_example_for_contributors_is_an_animation():
    text = CONTRIBUTING.read_text(encoding="utf-8").split("## Add an animation")[1]
    code = re.search(r"```python\n(.*?)```", text, re.S)[1]
    made = {}
    exec(code, made)
    assert len(code.splitlines()) <= 25
    (svg,) = (ET.fromstring(d.svg) for d in made["section"].animations[0].row.drawings)
    place = next(g for g in svg.iter("g") if g.get("transform"))
    assert place.get("transform").startswith("translate(")
