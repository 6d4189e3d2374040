"""A drive with a [layout] table: sized, laid out, or told in numbers why it cannot be."""

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from campaigns import few
from edits import scene_of

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.optimise.explaining.explanation import Remedies
from gearopt.scenes.drive import layout
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.load import read

PROBLEMS = Path(__file__).parents[3] / "problems"
TABLE4 = (PROBLEMS / "table4_process_one_layout.toml").read_text(encoding="utf-8")
BOX = (PROBLEMS / "elevator_box.toml").read_text(encoding="utf-8")


def scene(text):
    return read(text.encode())[1]


def with_layout(**keys):
    """Table 4, process one, with other lines in [layout]."""
    text = TABLE4
    for key, value in keys.items():
        line = f"{key} = {value}"
        pattern = re.compile(rf"^{key} = .*$", re.M)
        if pattern.search(text):
            text = pattern.sub(line, text)
        else:
            text = text.replace("[layout]\n", f"[layout]\n{line}\n")
    return text


NONE = ("shaft_clearance", "wall_clearance", "axial_clearance")


@pytest.fixture(scope="module")
def table4(solved):
    return solved("table4_process_one_layout")


def test_the_given_train_is_only_laid_out(table4):
    """A box found by another search: 411.98 x 873.29 x 209.9 mm."""
    assert table4.status == "optimal" and table4.gap <= 1e-4
    assert table4.value == pytest.approx(75_516_512, abs=0.6)
    box = table4.design["layout"]["box"]
    assert sorted((box["width_mm"], box["height_mm"])) == pytest.approx([411.98, 873.29], abs=5e-3)
    assert box["length_mm"] == pytest.approx(209.9)
    assert [p.name for p in table4.parts] == ["gears"]
    assert table4.parts[0].value == pytest.approx(19_977_138, abs=1)
    assert not any("together" in note for note in table4.report["notes"])


def test_the_design_is_a_drawing(table4):
    """Meshes are exact, gears lie within the box less the walls, gaps keep their needs."""
    layout, stages = table4.design["layout"], table4.design["stages"]
    axes = [(s["y_mm"], s["z_mm"]) for s in layout["shafts"]]
    for stage, a, b in zip(stages, axes, axes[1:], strict=False):
        assert math.dist(a, b) == pytest.approx(stage["centre_distance_mm"], rel=1e-12)
    box, wall = layout["box"], layout["clearances"]["wall_mm"]
    sides = {"left": [], "right": [], "bottom": [], "top": []}
    for gear in layout["gears"]:
        (y, z), r = axes[gear["shaft"] - 1], 0.5 * gear["tip_diameter_mm"]
        sides["left"].append(y - r - wall - box["left_mm"])
        sides["right"].append(box["left_mm"] + box["width_mm"] - y - r - wall)
        sides["bottom"].append(z - r - wall - box["bottom_mm"])
        sides["top"].append(box["bottom_mm"] + box["height_mm"] - z - r - wall)
        assert gear["root_diameter_mm"] < gear["reference_diameter_mm"] < gear["tip_diameter_mm"]
        assert 10 - 1e-9 <= gear["from_mm"] < gear["to_mm"] <= box["length_mm"] - 10 + 1e-9
    assert all(min(s) == pytest.approx(0.0, abs=1e-6) for s in sides.values())
    for gap in layout["gaps"]:
        assert gap["gap_mm"] >= gap["needed_mm"] - 1e-6
    assert table4.limits["wheel_1_to_shaft_3"] == pytest.approx((191.004 + 22.5 + 2) / 216.81, 1e-4)
    steps = table4.report["progress"]
    assert steps[-1]["best"] == table4.value and len(steps) > 2


@pytest.mark.parametrize(
    ("keys", "value"),
    [
        (
            dict(shaft_clearance='"0 mm"', wall_clearance='"0 mm"', axial_clearance='"0 mm"'),
            56826192,
        ),
        pytest.param(dict(span='"partial"'), 55_654_946, marks=pytest.mark.slow),
    ],
)
def test_other_clearances_and_spans(keys, value):
    result = gearopt.solve(scene(with_layout(**keys)))
    assert result.status == "optimal" and result.value == pytest.approx(value, abs=0.6)


TRAINS = {  # m, z1, z2, b of each stage; shafts; box (full, partial span)
    "process two": (
        [(1.25, 27, 237, 22.34), (3, 26, 109, 51.6), (4, 27, 80, 95.3)],
        (66_689_036, 50_183_602),
    ),
    "optimum": (
        [(1.5, 21, 162, 20.854), (3, 21, 89, 41.708), (4, 24, 80, 79.443)],
        (47_483_118, 40_113_089),
    ),
    "elevator, process one": ([(2, 25, 124, 33.1), (3, 25, 109, 62.1)], (27_094_106, None)),
    "elevator, optimum": ([(2, 21, 115, 27.805), (3, 23, 91, 57.1)], (18_406_834, None)),
}


def train_file(rows, span):
    stages = "".join(
        f'[[stage]]\nmodule = "{m} mm"\npinion_teeth = {z1}\nwheel_teeth = {z2}\n'
        f'face_width = "{b} mm"\n'
        for m, z1, z2, b in rows
    )
    head, rest = TABLE4.split("[[stage]]", 1)
    text = head + stages + "[limits]" + rest.split("[limits]", 1)[1]
    if len(rows) == 2:
        duty = 'power = "7.5 kW"\ninput_speed = "1450 rpm"\noutput_speed = "66.5 rpm"\n'
        text = re.sub(r'power = "8 kW"\n.*\n.*\n', duty, text)
        text = re.sub(
            r"shaft_diameters = .*", 'shaft_diameters = ["20 mm", "35 mm", "60 mm"]', text
        )
    return text.replace("[layout]\n", f'[layout]\nspan = "{span}"\n')


@pytest.mark.parametrize("name", few(TRAINS, ["elevator, optimum"]))
def test_published_trains(name):
    """Boxes found before by a grid and SLSQP."""
    rows, values = TRAINS[name]
    for span, value in zip(("full", "partial"), values, strict=True):
        if value is not None:
            result = gearopt.solve(scene(train_file(rows, span)))
            assert result.status == "optimal" and result.gap <= 1e-4
            assert result.value == pytest.approx(value, abs=1.0)


def test_stages_1_and_3_in_one_slab_are_43_mm_too_close():
    text = with_layout(slabs="[[1, 3], [2]]", gear_clearance='"5 mm"')
    result = gearopt.solve(scene(text))
    assert result.status == "infeasible" and result.method == "data check"
    assert "Wheel 1 and pinion 3 are 42.77 mm too close" in result.message
    assert result.evaluations < 100  # before any search
    (way,) = result.report["ways_out"]["remedies"]
    (change,) = way["changes"]
    assert (change["key"], change["write"]) == ("layout.slabs", '"best"')
    assert (change["was"], change["factor"]) == ("[[1, 3], [2]]", 1.0)


@pytest.mark.slow
def test_a_shaft_through_a_wheel_is_told_with_cures_that_work():
    _, content = scene_of(with_layout(shaft_diameters='["16 mm", "30 mm", "52 mm", "70 mm"]'))
    found = gearopt.explain(scene_of(with_layout())[0].model_validate(content))
    assert found.result.status == "infeasible"
    assert "Wheel 1 and shaft 3 are 2.19 mm too close" in found.result.message
    thinner, partial = found.remedies
    assert thinner.changes[0].key == "layout.shaft_diameters[3]"
    assert float(thinner.changes[0].write.strip('"').split()[0]) == pytest.approx(
        2 * (216.807 - 191.004 - 2), abs=0.02
    )
    assert partial.changes[0].write == '"partial"'
    span = {**content, "layout": {**content["layout"], "span": "partial"}}
    diameters = ["16 mm", "30 mm", thinner.changes[0].write.strip('"'), "70 mm"]
    thin = {**content, "layout": {**content["layout"], "shaft_diameters": diameters}}
    for right in (span, thin):
        assert gearopt.solve(type(scene(TABLE4)).model_validate(right)).status == "optimal"


def test_a_search_and_the_ways_out_of_it_share_a_budget(monkeypatch):
    given = []
    none = Remedies()
    monkeypatch.setattr(
        "gearopt.scenes.drive.explain.box_remedies.remedies",
        lambda *asked: given.append(asked[-1].left) or none,
    )
    tight = scene(with_layout(largest_height='"415 mm"', largest_width='"600 mm"'))
    result = gearopt.solve(tight, budget=gearopt.Budget(50.0))
    assert 0.0 < given[0].seconds <= 50.0 - result.parts[0].seconds


def test_an_impossible_height_names_the_least_one():
    """The lowest box is as high as the largest wheel with walls; nothing else helps."""
    result = gearopt.solve(scene(with_layout(largest_height='"350 mm"')))
    assert result.status == "infeasible" and result.proof["method"] == "closed form"
    assert "The box is at least 411.98 mm high (391.98 mm for wheel 3" in result.message
    best = next(r for r in result.report["ways_out"]["remedies"] if r["what"] == "largest_height")
    needed = float(best["changes"][0]["write"].strip('"').split()[0])
    assert needed == pytest.approx(391.98 + 20, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["sa", "sa-polish", "sa-paper", "multistart", "nsga2", "ipopt"])
def test_every_method_lays_out(method, table4):
    result = gearopt.solve(
        scene(TABLE4),
        method=method,
        budget=gearopt.Budget(evaluations=128_701 if method == "sa-paper" else 20_000),
    )
    assert result.value >= table4.bound
    assert result.design["layout"]["box"]["volume_mm3"] == pytest.approx(result.value, rel=1e-6)


@pytest.mark.slow
def test_a_method_that_only_sizes_says_so():
    with pytest.raises(SolveError, match="gp"):
        gearopt.solve(scene(TABLE4), method="gp")


@pytest.mark.slow
def test_slopes_of_the_box():
    """Length 209.9 = 169.9 + 4 axial gaps; the gears do not touch the walls' slope otherwise."""
    found = gearopt.explain(scene(TABLE4))
    assert "hold for small changes only, while the same bodies touch" in found.message
    slopes = {i.key: i.resolved for i in found.influences}
    assert slopes["layout.axial_clearance"] == pytest.approx((40 / 209.9,) * 2, abs=1e-4)
    wall = 10 * (2 / 411.98 + 2 / 873.29)
    assert slopes["layout.wall_clearance"] == pytest.approx((wall,) * 2, abs=1e-4)
    assert slopes["layout.shaft_diameters[1]"] == pytest.approx((0.0, 0.0), abs=1e-7)


WRONG = {
    "a shaft too few": (dict(shaft_diameters='["16 mm", "30 mm"]'), "layout.shaft_diameters"),
    "no unit": (dict(wall_clearance="10"), "layout.wall_clearance"),
    "a stage twice": (dict(slabs="[[1], [2], [2]]"), "layout.slabs"),
    "stages on one shaft": (dict(slabs="[[1, 2], [3]]"), "layout.slabs"),
    "an unknown objective": (dict(minimise='"boxvolume"'), "layout.minimise"),
    "both ways to a shaft": (dict(shaft_stress='"40 MPa"'), "layout.shaft_stress"),
    "one shaft on the split line": (dict(split_line="[1]"), "layout.split_line"),
    "a shaft that is not there": (dict(split_line="[1, 5]"), "layout.split_line"),
    "bearings without widths": (dict(bearing_diameters='["20 mm"]'), "layout.bearing_widths"),
    "a span of another kind": (dict(span='"half"'), "layout.span"),
    "a misspelt key": (dict(clearence='"1 mm"'), "layout.clearence"),
}


@pytest.mark.parametrize("keys", WRONG.values(), ids=WRONG)
def test_wrong_tables_are_refused_with_what_to_write(keys):
    changed, place = keys
    with pytest.raises(SceneError) as wrong:
        read(with_layout(**changed).encode(), "box.toml")
    assert wrong.value.key.startswith(place) and wrong.value.remedy and wrong.value.fix


def test_places_need_a_layout():
    text = TABLE4.split("[layout]")[0] + '[[place]]\nshaft = 4\nz = "0 mm"\n'
    with pytest.raises(SceneError, match=r"needs a table \[layout\]"):
        read(text.encode())


def test_a_place_below_the_input_is_kept():
    text = TABLE4 + '\n[[place]]\nshaft = 4\nz = "-150 mm"\ntolerance = "0.5 mm"\n'
    result = gearopt.solve(scene(text))
    assert result.status == "optimal"
    assert result.design["layout"]["shafts"][3]["z_mm"] == pytest.approx(-150, abs=0.5 + 1e-5)


def test_keep_outs_and_the_motor_are_kept_clear(solved):
    layout = solved("elevator_box").design["layout"]
    named = [g["between"] for g in layout["gaps"]]
    apart = {tuple(g["between"]): g["axes_mm"] for g in layout["gaps"]}
    assert max(apart.values()) > 130 + 0.5 * layout["shafts"][2]["diameter_mm"] + 2
    assert sum(b[1] in ("floor", "ceiling", "brake") for b in named) == 9
    assert all(g["gap_mm"] >= g["needed_mm"] - 1e-6 for g in layout["gaps"])


@pytest.mark.slow
def test_gears_and_box_at_once(solved):
    """Below the box of a scan near the least gear volume (44,506,647), with its bound."""
    result = solved("three_stage_together")
    assert result.status == "optimal" and result.value <= 44_506_647
    assert result.bound >= 0.99 * result.value
    apart, real = result.parts
    assert real.status == "stationary" and 0.97 * result.value < real.value < result.value
    assert apart.name == "apart" and apart.value == pytest.approx(47_483_050, abs=1)
    stages = result.design["stages"]
    assert [(s["normal_module_mm"], s["pinion_teeth"], s["wheel_teeth"]) for s in stages] == [
        (1.5, 21, 157),
        (3.0, 21, 74),
        (4.0, 22, 91),
    ]
    assert result.design["gear_volume_mm3"] == pytest.approx(13_014_531, abs=1)
    assert result.limits["shaft_2_to_wheel_3"] <= 1.0 + 1e-9


@pytest.mark.slow
def test_real_valued_gears_and_box_at_once():
    """Below whole teeth; every limit of the text is kept, and the drawing's box is the value."""
    text = (PROBLEMS / "three_stage_together.toml").read_text(encoding="utf-8")
    result = gearopt.solve(scene(text), method="ipopt")
    assert result.status == "stationary"
    assert 0.9 * 44_383_628 < result.value < 47_483_050  # from the gears sized first
    box = result.design["layout"]["box"]
    assert box["volume_mm3"] == pytest.approx(result.value, rel=1e-6)
    assert max(result.limits.values()) <= 1.0 + 1e-7


@pytest.mark.slow
def test_together_is_for_exact_and_ipopt():
    text = (PROBLEMS / "three_stage_together.toml").read_text(encoding="utf-8")
    with pytest.raises(SolveError, match="together"):
        gearopt.solve(scene(text), method="sa")


STATIC = {  # what is added to the file, and a part of what is said
    "out of reach": ('[[place]]\nshaft = 4\nz = "700 mm"\n', "reach 680.23 mm"),
    "too near": ('[[place]]\nshaft = 2\ny = "0 mm"\nz = "100 mm"\n', "keep them 211.85 mm apart"),
    "two places": (
        '[[place]]\nshaft = 4\nz = "180 mm"\n[[place]]\nshaft = 4\nz = "100 mm"\n',
        "Shaft 4 has two places, 79.98 mm apart",
    ),
    "on the input": (
        '[[keep_out]]\nname = "post"\ny = ["-5 mm", "5 mm"]\nz = ["-5 mm", "5 mm"]\n',
        "Pinion 1 violates the clearance to post by 25.84 mm",
    ),
}


@pytest.mark.parametrize("name", few(STATIC, ["on the input"]))
def test_what_no_search_can_mend_is_told_in_numbers(name):
    added, said = STATIC[name]
    result = gearopt.solve(scene(TABLE4.split("[x-expected]")[0] + added))
    assert result.status == "infeasible" and result.method == "data check"
    assert said in result.message
    removed = [r["changes"][0] for r in result.report["ways_out"]["remedies"]]
    assert any(c["write"] == "" or "tolerance" in c["key"] for c in removed)


def test_keep_outs_of_one_name_are_numbered():
    pit = '[[keep_out]]\nname = "pit"\ny = ["-900 mm", "-800 mm"]\nz = ["0 mm", "9 mm"]\n'
    drive = scene(TABLE4 + 2 * pit + pit.replace('name = "pit"\n', ""))
    sizes = (1.5, 27, 229, 26.8), (3.0, 26, 105, 47.8), (4.0, 27, 87, 95.3)
    pairs = tuple(drive.train().pair(k, *size) for k, size in enumerate(sizes))
    names = [keep.name for keep in drive.gearbox(pairs).keep_outs]
    assert names == ["pit 1", "pit 2", "keep-out 3"]


def test_a_motor_within_a_keep_out_is_told():
    result = gearopt.solve(scene(BOX.replace('"-140 mm"]', '"-100 mm"]', 1)), remedies=False)
    assert result.message == "The motor reaches 30.00 mm into floor."


def test_a_box_wider_than_allowed_is_refused():
    with pytest.raises(SceneError, match="above largest_width"):
        read(with_layout(width='"400 mm"', largest_width='"300 mm"').encode())


@pytest.mark.slow
def test_a_box_that_is_too_long_names_the_shortest_order():
    """In order the box is 209.9 mm long; in partial span no other order is shorter."""
    result = gearopt.solve(scene(with_layout(largest_length='"200 mm"')), remedies=False)
    assert "at least 209.90 mm long, and may be 200 mm" in result.message


TOGETHER = (
    TABLE4.split("[[stage]]")[0]
    + """
[[stage]]
face_width_over_diameter = 0.6
[[stage]]
face_width_over_diameter = 0.75
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
pinion_teeth = [20, 24]
[teeth]
modules = "ISO 54 I"
[layout]
together = true
shaft_diameters = ["20 mm", "35 mm", "60 mm"]
"""
)


@pytest.fixture(scope="module")
def small():
    text = TOGETHER.replace('output_speed = "32 rpm"', 'output_speed = "160 rpm"')
    return scene(text)


def test_the_drive_is_read_once_for_all_its_boxes(small, monkeypatch):
    """A search over gears and box makes hundreds of boxes of one drive."""
    from gearopt.optimise.clock import Clock
    from gearopt.scenes.drive.explain.other_gears import _some_gears_fit

    read, train = [], type(small).train
    monkeypatch.setattr(type(small), "train", lambda one: read.append(1) or train(one))
    assert _some_gears_fit(small, Clock(gearopt.Budget(seconds=0.0))) is None
    assert len(read) <= 2


@pytest.mark.slow
def test_together_stopped_at_once_gives_the_gears_chosen_first(small):
    from gearopt.scenes.drive.layout import steps
    from gearopt.scenes.drive.sizing import sized
    from gearopt.scenes.drive.without import without
    from gearopt.scenes.plan import carried_out
    from gearopt.scenes.reading.ask import Ask

    gears = sized(without(small, "layout"), Ask())
    ask = Ask(budget=gearopt.Budget(seconds=0.0))
    result = carried_out(steps(small), small, ask, gears)
    whole = gearopt.solve(small)
    assert result.status == "limit" and result.value is not None
    assert whole.status == "optimal" and whole.value <= result.value
    assert whole.bound <= whole.value <= whole.parts[0].value


def test_a_stop_is_heard_while_the_gears_chosen_first_are_laid_out(small):
    """And their box, which is not the answer's, is not told as the best one so far."""
    from gearopt.scenes.drive.layout import steps
    from gearopt.scenes.drive.sizing import sized
    from gearopt.scenes.drive.without import without
    from gearopt.scenes.plan import carried_out
    from gearopt.scenes.reading.ask import Ask

    seen = []
    gears = sized(without(small, "layout"), Ask())
    ask = Ask(watch=lambda event: bool(seen.append(event)))
    result = carried_out(steps(small), small, ask, gears)
    assert result.parts[0].status == "limit" and seen[0].best is None
    assert "real-valued" not in [part.name for part in result.parts]  # a start is no answer


@pytest.mark.slow
def test_every_answer_makes_a_page(small, tmp_path):
    """Also of gears and box at once, and of what is impossible; numbers of numpy never reach it."""
    from gearopt.report.pages.result import page

    html = page(gearopt.solve(small), "gearopt solve")
    assert "Front view" in html and "clearances" in html


@pytest.mark.slow
def test_impossible_at_once_is_explained(small):
    low = small.layout.model_copy(
        update={
            "largest_height": scene(with_layout(largest_height='"80 mm"')).layout.largest_height
        }
    )
    found = gearopt.explain(small.model_copy(update={"layout": low}))
    assert found.result.status == "infeasible"
    assert "No gears within the limits can be arranged" in found.result.message
    assert found.remedies[0].what == "largest_height"


def test_a_box_is_not_sought_again_without_time_or_a_start(monkeypatch, solved):
    gears = solved("elevator")
    none = replace(gears, status="limit", design={}, objective={})
    monkeypatch.setattr(layout, "sized_gears", lambda scene, ask: gears)
    monkeypatch.setattr(layout, "lay_out", lambda scene, ask, sized: none)
    sought = []
    monkeypatch.setattr(layout, "at_once", lambda *given: sought.append(given) or gears)
    own, late = scene(BOX), Ask(budget=gearopt.Budget(seconds=0.0))
    assert layout.with_sized_first(own, late, none).value is None and not sought
    layout.with_sized_first(own, Ask(), none)
    assert len(sought) == 1
