"""The page of a Pareto front: self-contained, complete, to be sorted, filtered and clicked."""

import base64
import copy
import csv
import io
import json
import re
import shutil
import subprocess
from dataclasses import replace
from html import unescape
from pathlib import Path

import front_cases as cases
import numpy as np
import pytest
from page_reader import ATTACK, Reader, marks, ours
from page_reader import drawings as drawn
from plotly.offline import get_plotlyjs

from gearopt import Front
from gearopt.optimise.pareto.front import Impossible
from gearopt.optimise.pareto.measures import picks
from gearopt.report.front import _apart, decided, picked, table, value_cells
from gearopt.report.measures import INCH, METRIC
from gearopt.report.pages import frame
from gearopt.report.pages import front as front_page
from gearopt.report.pages.front import page, tables
from gearopt.report.pages.front_designs import numbers
from gearopt.report.words import goal_words

ROOM = Path(frame.__file__).parent


@pytest.fixture(scope="module")
def two():
    return page(cases.drive())


def links(html):
    found = {}
    for tag, attributes in Reader(html).tags:
        if tag == "a" and "download" in attributes:
            found[attributes["download"]] = attributes["href"]
    return found


def plots(html):
    told = [json.loads(text) for kind, text in Reader(html).scripts if kind == "application/json"]
    return [one for one in told if "layout" in one], next(o for o in told if "points" in o)


def traces(plot):
    return {trace.get("meta") or trace.get("name"): trace for trace in plot["data"]}


def test_nothing_is_loaded_from_anywhere(two):
    for _, attributes in Reader(two).tags:
        for name in ("src", "href", "action", "srcset"):
            assert attributes.get(name, "data:").startswith("data:")
    for name in ("front.html", "front.css", "front.js", "section.html"):
        text = (ROOM / name).read_text(encoding="utf-8").replace("http://www.w3.org/2000/svg", "")
        assert not re.search(r"https?://|@import|url\(|fetch\(|import\(", text), name


def test_losses_have_the_digits_that_tell_designs_apart():
    """Of 1.2343 and 1.2344 % five; of 2, 1 and 0.66667 % three."""
    front = cases.drive()
    points = [
        replace(p, values=(p.values[0], 1.2343 + 1e-4 * k)) for k, p in enumerate(front.points)
    ]
    close = replace(front, points=tuple(points))
    texts = [
        [row[1].text for row in value_cells(f, [p.values for p in f.points], METRIC)]
        for f in (close, front)
    ]
    assert texts == [["1.2343", "1.2344", "1.2345"], ["2", "1", "0.667"]]
    assert "mesh loss 1.2343 % to 1.2345 %" in decided(close)[0]
    assert "1.2344" in page(close) and "0.667" in page(front)


def test_both_ends_of_a_range_have_one_unit():
    """Below 10 dm³ volumes are read in cm³, above in dm³."""
    front = cases.drive()
    values = 6.4486e6, 8.0e6, 1.1194e7
    points = tuple(
        replace(p, values=(v, *p.values[1:])) for p, v in zip(front.points, values, strict=True)
    )
    limited = tuple(
        replace(o, most=m) for o, m in zip(front.objectives, (2.0e7, None), strict=True)
    )
    wide = replace(front, points=points, objectives=limited)
    assert "gear volume 6,448.6 cm³ to 11,194 cm³" in decided(wide)[0]
    html = page(wide)
    assert "to 11,194 cm³" in html and "at most 20,000 cm³" in html and "11.194 dm³" not in html


def test_a_total_length_is_called_so_in_every_table():
    told = page(cases.drive(objectives=3))
    assert "total length in one line [mm]" in told
    assert not re.findall(r"total length(?! in one line| of the design)", told)
    assert goal_words("total_length", "pair") == "total length in one line"


@pytest.mark.parametrize(
    ("unknown", "said"),
    [
        ((), ""),
        (((300.0, 301.5),), "1 part of the front is {}300 mm to 301.5 mm."),
        (((None, 300.0), (310.0, None)), "2 parts of the front are {}up to 300 mm, from 310 mm."),
        (
            tuple((300.0 + k, 300.5 + k) for k in range(5)),
            "5 parts of the front are {}300 mm to 300.5 mm, 301 mm to 301.5 mm, 302 mm to 302.5 mm "
            "and 2 others.",
        ),
    ],
)
def test_pieces_that_are_not_known_are_named_by_label_and_unit(unknown, said):
    front = cases.drive(objectives=3)
    points = tuple(replace(p, values=(p.values[0], p.values[2])) for p in front.points)
    front = replace(front, objectives=(front.objectives[0], front.objectives[2]), points=points)
    known = Front.from_json(replace(front, unknown=unknown, message="no bounds").to_json())
    said = said.format("not known, as steps there are not proven: total length in one line ")
    assert decided(known)[-2:] == [said or decided(front)[-1], "No bounds."]


def test_the_reason_of_a_pick_names_objectives_as_the_rest_does():
    front = cases.drive(objectives=3)
    names = ["gear_volume", "mesh_loss", "total_length"]
    values = np.array([p.values for p in front.points])
    values[:, 2] = 10.0, 200.0, 3000.0
    chosen = tuple(picks(values, names, {"total_length": 2.0}))
    known = Front.from_json(replace(front, picks=chosen).to_json())
    (first,) = (line for line in picked(known) if "weights" in line)
    assert "total length in one line in decades: gear volume 0, mesh loss 0" in first
    assert "total length in one line 2)" in first and "total length 2" not in first


def test_names_are_escaped():
    html = page(cases.drive(title=ATTACK, message=ATTACK, file=ATTACK))
    assert {tag for tag, _ in Reader(html).tags}.isdisjoint({"b"})
    scripts = [kind for kind, _ in Reader(html).scripts]
    assert scripts.count("") == 2 and not any("alert(" in t for _, t in Reader(html).scripts[1:2])


def test_every_value_is_in_the_table_the_csv_and_the_json(two):
    front, found = cases.drive(), links(two)
    data = base64.b64decode(found["front.json"].partition("base64,")[2])
    assert Front.from_json(data.decode()) == front
    text = base64.b64decode(found["front.csv"].partition("base64,")[2]).decode("utf-8-sig")
    rows = list(csv.DictReader(io.StringIO(text)))
    for row, point in zip(rows, front.points, strict=True):
        assert float(row["gear volume [cm³]"]) == pytest.approx(point.values[0] / 1e3, rel=1e-12)
        assert int(row["stage 1: teeth z2"]) == point.design["stages"][0]["wheel_teeth"]
        assert float(row["used: K-factor of stage 1"]) == point.limits["k_factor[1]"]
    table = re.search(r'<section id="designs">.*?</section>', ours(two), re.S)[0]
    seen = [unescape(one) for one in re.findall(r"<t[hd][^>]*>([^<]*)", table)]
    for words in ("6,000", "6,246.9", "knee", "2, 21/116; 3, 23/91"):
        assert words in seen, words


def test_a_design_is_compared_with_the_pick(two):
    shown, told = plots(two)
    assert told["pair"][0] == 1 and told["rules"] == {"1": "knee"}
    row = told["rows"].index("K-factor of stage 1")
    assert [point[row] for point in told["points"]] == ["100.0", "90.0", "80.0"]
    assert told["limits"][0] <= row < told["limits"][1]
    gears = told["sketches"][2]["gears"]
    stages = cases.drive().points[2].design["stages"]
    assert [g[5] for g in gears] == [
        t for s in stages for t in (s["pinion_teeth"], s["wheel_teeth"])
    ]
    # wheel 1 and pinion 2 are on one shaft, at the centre distance from pinion 1
    assert gears[1][0] == gears[2][0] == pytest.approx(stages[0]["centre_distance_mm"], rel=1e-4)


def test_beaten_and_impossible_points_are_grey(two):
    shown, _ = plots(two)
    first = traces(shown[0])
    assert sorted(first["dominated"]["x"]) == pytest.approx([6100.0, 6200.0])
    assert first["limits without a design"]["y"] == [0.5, 0.6]
    for name in ("dominated", "limits without a design"):
        assert first[name]["marker"]["color"].startswith("--axis")
    assert "proven impossible" in two and "none found" in two
    assert first["designs"]["customdata"] == [1, 2, 3]
    grown = next(plot for plot in shown if "exact" in traces(plot))
    assert traces(grown)["exact"]["y"] == [50.0, 100.0]


def test_three_objectives_are_seen_in_pairs_and_in_space():
    shown, _ = plots(page(cases.drive(objectives=3)))
    kinds = [plot["data"][0]["type"] for plot in shown]
    assert kinds == ["scatter"] * 3 + ["scatter3d"] + ["scatter"] * 2


def test_the_still_holds_every_design_and_pick(two):
    still = next(s for s in drawn(two) if "against" in s.get("aria-label"))
    assert len(marks(still, "circle", "design")) == 3 and len(marks(still, "circle", "beaten")) == 2
    assert [text.text for text in still.iter("text") if text.get("class") == "name"] == ["knee"]


def test_on_paper_a_long_table_has_its_ends_and_picks():
    html = page(cases.drive(count=60, impossible=(), beaten=()))
    rows = re.findall(r'<tr( class=hushed)?><th scope="row">(\d+)</th>', ours(html))
    printed = [int(k) for hushed, k in rows if not hushed]
    assert len(rows) == 60 and 24 <= len(printed) <= 26 and {1, 2, 60} <= set(printed)
    assert f"{len(printed)} of 60 designs" in html


def test_a_front_without_a_design_says_why():
    html = page(cases.impossible())
    words = "".join(Reader(html).text)
    assert "Impossible, proven" in words and "Proof: none is so small." in words
    assert "gearopt explain my.toml" in words and "gear volume at most 1,000 cm³" in words
    assert not plots(html + '<script type="application/json">{"points": 0}</script>')[0]
    open_ = page(cases.impossible(status="not proven"))
    assert "No design found" in open_


def test_one_design_stands_alone():
    shown, told = plots(page(cases.drive(count=1)))
    assert told["pair"] == [0] and len(told["points"]) == 1


def test_materials_helix_angles_and_shifts_that_differ_have_columns():
    front = cases.drive()
    chosen = [("A", "B", 0.0), ("A", "A", 0.0), ("B", "B", 8.0)]
    for point, (pinion, wheel, angle) in zip(front.points, chosen, strict=True):
        first = {"pinion_material": pinion, "wheel_material": wheel, "helix_angle_deg": angle}
        point.design["stages"][0].update(first)
        point.design["stages"][1].update(pinion_material="A", wheel_material="B")
    shown = table(front)
    assert shown.heads[-2:] == ("materials", "β [°]")  # all shifts are 0
    assert [row[-2:] for row in shown.rows] == [
        *(("A/B; A/B", "0; 25"), ("A; A/B", "0; 25"), ("B; A/B", "8; 25"))
    ]
    assert "stage 1: pinion material" in plots(page(front))[1]["rows"]
    for shift, point in enumerate(front.points):
        point.design["stages"][0].update(pinion_profile_shift=shift, centre_distance_mm=90 + shift)
    assert table(front).heads[-3:] == ("β [°]", "x1/x2", "a [mm]")


def test_inches_are_shown_in_page_and_tables():
    front = cases.drive()
    html = page(front, measures=INCH)
    assert "gear volume [in³]" in html and "P_nd, z1/z2" in html and "--units inch" in html
    rows = list(csv.DictReader(io.StringIO(tables(front, INCH)["front.csv"])))
    assert float(rows[0]["gear volume [in³]"]) == pytest.approx(6.0e6 / 25.4**3)


def test_an_own_problem_shows_its_variables_and_itself_in_notebooks():
    front = cases.own()
    shown, told = plots(front.to_html())
    assert "x [mm]" in told["rows"] and told["sketches"] == [None] * len(front.points)
    assert repr(front).startswith("parabolas: a against b") and "knee" in repr(front)
    assert "<table>" in front._repr_html_() and "compromise" in front._repr_html_()
    with pytest.raises(ValueError, match="metric"):
        front.to_html("cubits")


def test_a_kept_front_is_reported_again(here, tmp_path):
    kept, html, folder = tmp_path / "front.json", tmp_path / "page.html", tmp_path / "csv"
    kept.write_text(cases.drive().to_json(), encoding="utf-8")
    told = here("report", kept, "--html", html, "--csv", folder)
    assert told.returncode == 0 and "3 designs" in told.stdout
    assert html.read_text(encoding="utf-8") == page(cases.drive(), str(html))
    names = {"front.csv", "dominated-designs.csv", "limits-without-a-design.csv", "growth.csv"}
    assert {path.name for path in folder.iterdir()} == names
    kept.write_text(cases.impossible().to_json(), encoding="utf-8")
    assert here("report", kept).returncode == 3


def test_pareto_writes_its_page(here, tmp_path):
    html = tmp_path / "page.html"
    file = Path(__file__).parents[2] / "problems" / "elevator_small_wheels.toml"
    told = here("pareto", file, "--objectives", "gear_volume,mesh_loss", "--html", html)
    assert told.returncode == 3 and f"Page: {html}" in told.stdout
    assert "Impossible, proven" in html.read_text(encoding="utf-8")


def test_designs_of_different_numbers_of_stages_stand_in_one_table():
    front = cases.drive(count=2)
    short = {"stages": front.points[0].design["stages"][:1]}
    limits = {"k_factor[1]": 0.7}
    first = replace(front.points[0], design=short, limits=limits)
    last = replace(front.points[1], design=short, limits=limits)
    html = page(replace(front, points=(first, front.points[1])))
    told = plots(html)[1]
    row = told["rows"].index("stage 2: reference diameter d2 [mm]")
    assert told["points"][0][row] == "" and float(told["points"][1][row]) > 300.0
    assert 'hidden><th scope="row">K-factor of stage 2' not in html
    both = page(replace(front, points=(first, last, front.points[1]), picks=()))
    assert 'hidden><th scope="row">K-factor of stage 2' not in both
    alone = replace(front, points=(first, last, front.points[1]), picks=front.picks)
    three = plots(page(alone))[1]
    assert three["pair"] == [1, 0]
    assert 'hidden><th scope="row">K-factor of stage 2' in page(alone)


def test_designs_that_differ_by_their_materials_alone_have_a_page():
    """Words differ, too: they are listed, but have no axis."""
    front = cases.drive(count=2)
    designs = [copy.deepcopy(front.points[0].design) for _ in range(2)]
    for design, name in zip(designs, ("case-hardened", "tempered"), strict=True):
        design["stages"][0]["pinion_material"] = name
    points = [replace(p, design=d) for p, d in zip(front.points, designs, strict=True)]
    told = plots(page(replace(front, points=tuple(points))))[1]
    row = told["rows"].index("stage 1: pinion material")
    assert [texts[row] for texts in told["points"]] == ["case-hardened", "tempered"]


def test_neighbours_cost_what_they_cost():
    words = repr(cases.drive())
    first = "design 1 instead gear volume falls by 2 % and mesh loss rises by 100 %"
    assert first in words  # 2 against 1
    assert "design 3 instead gear volume rises by 2 % and mesh loss falls by 33 %" in words


def test_layouts_are_drawn_with_their_boxes_at_one_scale():
    kept = Path(__file__).parents[2] / "docs" / "pictures" / "elevator_box.json"
    one = json.loads(kept.read_text(encoding="utf-8"))["design"]
    other = copy.deepcopy(one)
    other["layout"]["box"]["width_mm"] *= 2.0
    front = cases.drive(count=2, picks=(), beaten=(), impossible=())
    points = [replace(p, design=d) for p, d in zip(front.points, (one, other), strict=True)]
    html = page(replace(front, points=tuple(points)))
    left, bottom, right, top = plots(html)[1]["sketches"][0]["box"]
    box = one["layout"]["box"]
    assert right - left == pytest.approx(box["width_mm"], rel=1e-3)
    assert top - bottom == pytest.approx(box["height_mm"], rel=1e-3)
    views = [s for s in drawn(html) if marks(s, "rect", "box")]
    wide = [float(marks(s, "rect", "box")[0].get("width")) for s in views]
    assert wide[1] == pytest.approx(2.0 * wide[0], rel=1e-3)
    assert "layout: box: width [mm]" in plots(html)[1]["rows"]


HOOK = """<script>
const all = (what) => [...document.querySelectorAll(what)];
const seen = [], note = (what) => seen.push(what);
const names = (rows) => rows.map((row) => row.cells[0].textContent);
const plots = () => all("figure.drawn .plot").filter((p) => p.data.some((t) => t.meta));
setTimeout(() => {
  all("#designs tbody tr")[2].click();
  note(all("#beside thead th")[2].textContent);
  plots()[0].emit("plotly_click", { points: [{ customdata: 1 }] });
}, 4000);
setTimeout(() => {
  note(all("#beside thead th")[2].textContent);
  note(plots().map((p) => p.data.find((t) => t.meta === "chosen").x.length > 0));
  all("#designs thead button")[2].click();
  note(names(all("#designs tbody tr")));
  const least = all("#designs .filter input")[0];
  least.value = "6100"; least.dispatchEvent(new Event("input"));
  note(names(all("#designs tbody tr").filter((row) => !row.hidden)));
  note(plots().map((p) => new Set(p.data.find((t) => t.meta === "designs").customdata).size));
  document.body.dataset.seen = JSON.stringify(seen);
}, 5000);</script>"""


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("chromium"), reason="needs a browser")
def test_a_browser_clicks_sorts_and_filters(two, tmp_path):
    path = tmp_path / "page.html"
    text = two.replace("/* plotly.js */", get_plotlyjs()).replace("</body>", f"{HOOK}</body>")
    path.write_text(text, encoding="utf-8")
    words = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    words += [f"--user-data-dir={tmp_path / 'user'}", "--virtual-time-budget=10000", path.as_uri()]
    dom = subprocess.run(words, capture_output=True, text=True, timeout=120, check=True).stdout
    seen = json.loads(unescape(re.search(r'data-seen="([^"]*)"', dom)[1]))
    assert seen == [
        "design 3",
        "design 1",
        [True, True],
        ["3", "2", "1"],  # by the second objective
        ["3", "2"],
        [2, 2],
    ]


def test_columns_tell_designs_apart_by_what_they_hold_not_by_the_number_of_stages():
    stage = {
        "normal_module_mm": 2.0,
        "pinion_teeth": 20,
        "wheel_teeth": 40,
        "helix_angle_deg": 15.0,
    }
    front = cases.drive()
    designs = [{"stages": [stage] * n} for n in (2, 3)]
    points = [replace(p, design=d) for p, d in zip(front.points, designs, strict=False)]
    alike = replace(front, points=tuple(points))
    assert _apart(alike, METRIC) == {}
    designs[1]["stages"][0] = stage | {"helix_angle_deg": 20.0}
    assert list(_apart(alike, METRIC).values()) == [["15; 15", "20; 15; 15"]]


def test_steps_without_a_design_are_said_to_be_impossible_where_that_is_proven():
    steps = (Impossible({"mesh_loss": 1.0}, True), Impossible({"mesh_loss": 1.2}, False))
    told = " ".join(decided(replace(cases.drive(), impossible=steps)))
    assert "2 steps were skipped: no design was found within the limits" in told
    assert "(1 proven impossible)" in told


def test_a_page_shows_some_of_very_many_designs_with_the_picks(monkeypatch):
    front = cases.drive()
    points = tuple(
        replace(front.points[0], values=(1.0 + k, *(9.0 - 0.1 * k for _ in front.names[1:])))
        for k in range(60)
    )
    picked = tuple(replace(pick, place=17) for pick in front.picks)
    many = replace(front, points=points, picks=picked)
    whole = page(many)
    monkeypatch.setattr(front_page, "MOST_ON_PAGE", 20)
    html = page(many)
    _, told = plots(html)
    assert len(told["points"]) == 21 and [18.0] == [v[0] for v in told["values"] if v[0] == 18.0]
    assert "This page shows 21 of the designs" in html and "shows" not in whole
    assert "front.json" in links(whole) and "front.json" not in links(html)
    assert ">60<" in html  # the number of all designs
    assert len(tables(many)["front.csv"].splitlines()) == 61


def test_numbers_of_a_curve_are_none_of_a_design():
    design = {"loads": [0.5, 1.0], "removed_mm": [0.001] * 241, "gears": [{"teeth": 20}] * 60}
    assert list(numbers(design, METRIC)) == ["loads 1", "loads 2"]
