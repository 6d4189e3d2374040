"""Gears and box at once at given centre distances: against the layout of every row of teeth."""

import itertools
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from gearboxes import every_row, smallest_around
from test_given_distance import written

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.drive import together
from gearopt.formulations.drive.together.tables import numbers
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import run
from gearopt.scenes.drive.layout import box_first
from gearopt.scenes.reading.load import load

GAP = 1e-3
SLOW = 1, 2, 4, 5, 6, 11, 15, 17, 20  # of a few seconds
FILE = """
gearopt = 1
kind = "drive"
[duty]
power = "{power} kW"
input_speed = "1480 rpm"
ratio = {ratio}
ratio_tolerance = "{tolerance} %"
[gears]
helix_angle = {helix}
{width}
treatment = "carburised"
iso_material = "Eh"
iso_quality = "MQ"
{stages}
[limits]
pinion_teeth = [{teeth}, {most}]
{bound}
[teeth]
modules = {modules}
[rating]
standard = "iso6336"
life = "20000 h"
overload_factor = 1.25
minimum_bending_safety = 1.4
minimum_contact_safety = 1.1
[rating.iso6336]
accuracy_grade = 6
oil_grade = "220 mm^2/s"
helix_modification = "helix corrected"
[shift]
tip_thickness = 0.4
{shift}
[layout]
together = true
shaft_stress = "{stress} MPa"
span = "{span}"
minimise = "{aim}"
{largest}
"""
STAGE = """[[stage]]
{width}
centre_distance = {distances}
"""
SERIES = (75, 80, 85, 90, 95, 100, 106, 112, 118, 125, 132, 140, 150, 160, 170, 180, 190, 200, 212)
AIMS = "box_volume", "plan_area", "face_area", "height", "longest_side"
WIDTHS = (
    "face_width_over_diameter = [0.3, 1.0]",
    "face_width_over_diameter = 0.6",
    'face_width_over_diameter = [0.3, 1.0]\nface_width_step = "4 mm"',
)


def listed(values, unit):
    return str([f"{v:g} {unit}" for v in values])


def some_file(seed):
    """A random drive of few teeth, modules and distances of one or two stages, in a box."""
    rng = np.random.default_rng([77, seed])
    count = 1 + int(rng.random() < 0.75)
    low = int(rng.integers(17, 24))
    modules = sorted(rng.choice([2.0, 2.5, 3.0, 4.0], 2, replace=False))
    u = float(rng.uniform(2.5, 4.5))
    own = []
    for k in range(count):
        about = 0.5 * modules[min(k, 1)] * (low + 1) * (1.0 + u) / math.cos(0.2)
        near = [a for a in SERIES if 0.9 < a / about < 1.2]
        own.append(sorted(rng.choice(near, min(len(near), int(rng.integers(1, 4))), replace=False)))
    bound = ""
    if count == 2 and seed % 4 == 1:
        own[1], bound = own[0], "coaxial = true"
    if count == 2 and seed % 4 == 3:
        bound = f'sum_of_centre_distances = "{own[0][0] + own[1][-1]} mm"'
    stages = [
        STAGE.format(width=rng.choice(WIDTHS), distances=listed(distances, "mm"))
        for distances in own
    ]
    span = 2.0 * (own[0][0] + own[-1][0]) * float(rng.uniform(1.0, 1.5))
    sides = rng.choice(["width", "height"], int(rng.integers(0, 3)), replace=False)
    largest = "\n".join(f'largest_{side} = "{span * 0.8:.0f} mm"' for side in sides)
    asked = seed % 6
    helix = [0, 12][: 1 + seed % 2] if rng.random() < 0.5 else [12]
    bound += "\noverlap_ratio = 0.6" * (asked == 2 and 12 in helix)
    return FILE.format(
        width='minimum_face_width = "18 mm"' * (asked == 4) + "\n",
        power=round(float(rng.uniform(1.0, 6.0)), 1),
        ratio=round(u**count, 1),
        tolerance=[3, 5][seed % 2],
        helix=listed(helix, "deg"),
        stages="".join(stages),
        teeth=low,
        most=low + 2,
        bound=bound,
        modules=listed(modules, "mm"),
        shift="pinion_shift = [0, 0.3]" if rng.random() < 0.3 else "",
        stress=int(rng.integers(20, 60)),
        span="partial" if "coaxial" in bound else rng.choice(["full", "partial"]),
        aim=AIMS[seed % len(AIMS)],
        largest=largest,
    )


def as_by_layouts(path):
    """The answer of a file, after holding it to the layouts of all rows of its tables."""
    scene = load(path).scene
    train, make = scene.train(), scene.gearbox
    best = smallest_around(every_row(train), make, 0.2 * GAP)
    result, outcome = run(together.problem(train, make), "exact", Budget(gap=GAP), 0, None, GAP)
    assert result.status == ("infeasible" if math.isinf(best) else "optimal")
    if math.isfinite(best):
        assert result.value == pytest.approx(best, rel=1.2 * GAP)
        assert result.bound <= best * (1.0 + 1e-9)
    return result, best


@pytest.mark.parametrize("seed", [10, *(pytest.param(s, marks=pytest.mark.slow) for s in SLOW)])
def test_random_drives_as_by_the_layout_of_every_row(tmp_path, seed):
    result, best = as_by_layouts(written(tmp_path, some_file(seed)))
    assert (result.value is None) == math.isinf(best)


OF_DISTANCES = "centre_distance", "sum_of_centre_distances", "coaxial"


def of_sums(seed, sums):
    """The same without distances, with sums of shifts; of two stages few rows are left."""
    lines = some_file(seed).splitlines()
    text = "\n".join(line for line in lines if not line.startswith(OF_DISTANCES))
    if text.count("[[stage]]") == 2:
        u = float(re.search(r"\nratio = (.*)", text)[1]) ** 0.5
        text = re.sub(r"pinion_teeth = \[(\d+), \d+\]", r"pinion_teeth = [\1, \1]", text)
        text = re.sub(r"modules = \[(.*?),.*\]", r"modules = [\1]", text)
        ends = f"stage_ratio = [{0.95 * u:.3f}, {1.05 * u:.3f}]"
        text = text.replace("[limits]", f"[limits]\n{ends}")
    return text.replace("[shift]", f"[shift]\nsum = {sums}")


@pytest.mark.parametrize(
    ("seed", "sums"),
    [
        (10, "0.4"),
        *(
            pytest.param(s, sums, marks=pytest.mark.slow)
            for s, sums in ((4, "0.4"), (0, "[0, 0.5]"), (5, "[-0.2, 0.3]"), (14, "[-0.2, 0.3]"))
        ),
        *(
            pytest.param(s, "{from = 0, to = 0.6, step = 0.3}", marks=pytest.mark.slow)
            for s in (1, 9, 11, 12, 13, 15, 21)
        ),
    ],
)
def test_sums_of_shifts_as_by_the_layout_of_every_row(tmp_path, seed, sums):
    path = written(tmp_path, of_sums(seed, sums))
    assert box_first(load(path).scene)
    result, best = as_by_layouts(path)
    assert (result.value is None) == math.isinf(best)


@pytest.mark.slow
def test_a_box_of_gears_by_a_sum_of_shifts_is_drawn_and_explained(tmp_path):
    text = of_sums(4, "0.4")
    result = gearopt.solve(written(tmp_path, text), remedies=False)
    stages, layout = result.design["stages"], result.design["layout"]
    assert result.status == "optimal" and result.design["rating"]["safe"]
    places = [np.array([s["y_mm"], s["z_mm"]]) for s in layout["shafts"]]
    for k, stage in enumerate(stages):
        total = stage["pinion_profile_shift"] + stage["wheel_profile_shift"]
        there = np.linalg.norm(places[k + 1] - places[k])
        assert total == pytest.approx(0.4) and stage["wheel_tip_alteration"] < 0.0
        assert there == pytest.approx(stage["centre_distance_mm"], abs=1e-6)
    sides = 'largest_width = "200 mm"\nlargest_height = "220 mm"\n'
    file = written(tmp_path, "\n".join([text.split("largest_")[0].rstrip(), sides]))
    known = gearopt.explain(file)
    assert known.result.status == "infeasible" and known.remedies
    assert {*known.conflict[:2]} == {"largest_width", "largest_height"}
    for way in known.remedies:
        assert gearopt.solve(file, way.edits, remedies=False).value is not None


@pytest.mark.slow
def test_several_helix_angles_as_by_the_layout_of_every_row(tmp_path):
    lines = some_file(10).replace("['0 deg']", "['8 deg', '16 deg']").splitlines()
    gone = "centre_distance", "[shift]", "tip_thickness", "pinion_shift"
    text = "\n".join(line for line in lines if not line.startswith(gone))
    result, _ = as_by_layouts(written(tmp_path, text.replace("['12 deg']", "['8 deg', '16 deg']")))
    assert result.status == "optimal"


def test_sizes_of_rows_are_those_of_their_gears(tmp_path):
    """Working distance and shortened tips of every row and module; rows that go together alone."""
    scene = load(written(tmp_path, some_file(5))).scene
    train, make = scene.train(), scene.gearbox
    drive, _ = numbers(train, make)
    assert train.distances and drive.fits.sum() > 0
    for j, stage in enumerate(train.stages):
        for p in range(drive.start[j], drive.start[j + 1]):
            cut = stage.toothings[drive.toothing[p]]
            for k in range(drive.first[p], drive.last[p] + 1):
                pair = cut.pair(drive.modules[j, k], drive.z1[p], drive.z2[p], 1.0)
                tips = [0.5 * gear.tip_diameter for gear in pair.gears]
                assert drive.sizes[p, k] == pytest.approx([cut.working_distance, *tips], rel=1e-12)
                assert pair.pinion.tip_alteration <= 0.0
    for first, second in itertools.product(*(range(drive.start[1]), range(*drive.start[1:]))):
        distances = tuple(
            stage.toothings[drive.toothing[p]].working_distance
            for stage, p in zip(train.stages, (first, second), strict=True)
        )
        code = (drive.stride * drive.distance[[first, second]]).sum()
        assert drive.fits[0, code] == (distances in train.distances)


@pytest.mark.slow
def test_a_coaxial_drive_has_its_output_in_line_and_gears_up_to_their_shortened_tips(tmp_path):
    result = gearopt.solve(written(tmp_path, some_file(1)), remedies=False)
    first, second = stages = result.design["stages"]
    assert result.status == "optimal" and result.bound <= result.value
    assert first["centre_distance_mm"] == second["centre_distance_mm"]
    layout = result.design["layout"]
    places = [np.array([s["y_mm"], s["z_mm"]]) for s in layout["shafts"]]
    assert np.abs(places[2]).max() <= 0.01 + 1e-6
    for k, stage in enumerate(stages):
        there = np.linalg.norm(places[k + 1] - places[k])
        assert there == pytest.approx(stage["centre_distance_mm"], abs=1e-6)
    tips = {g["name"]: g["tip_diameter_mm"] for g in layout["gears"]}
    assert tips["wheel 1"] == first["wheel_tip_diameter_mm"]
    assert first["wheel_tip_alteration"] < 0.0
    (apart,) = (part for part in result.parts if part.name == "apart")
    assert apart.value is None or apart.value >= result.value * (1.0 - 1e-9)


@pytest.mark.slow
def test_an_impossible_box_names_its_sides_and_their_least_sizes(tmp_path):
    text = some_file(2) + 'largest_width = "{}"\nlargest_height = "{}"\n'
    path = written(tmp_path, text.format("260 mm", "300 mm"))
    scene = load(path).scene
    train = scene.train()

    def narrow(pairs):
        box = scene.gearbox(pairs)
        return replace(box, objective="width", largest=(math.inf, *box.largest[1:]))

    least = smallest_around(every_row(train), narrow, 1e-5)
    known = gearopt.explain(path)
    assert known.result.status == "infeasible"
    assert known.conflict[:2] == ("largest_width", "largest_height")
    (way,) = (w for w in known.remedies if w.changes[0].key == "layout.largest_width")
    assert way.changes[0].factor == pytest.approx(least / 260.0, rel=5e-3)
    assert (
        way.changes[0].factor >= least / 260.0 * (1.0 - 1e-5)
        and way.verified["with_less"] == "infeasible"
    )
    assert gearopt.solve(path, way.edits, remedies=False).value is not None


def test_gears_that_are_given_at_a_distance_are_none_to_be_chosen_with_the_box(tmp_path):
    stage = 'module = "3 mm"\npinion_teeth = 20\nwheel_teeth = 63\nface_width = "40 mm"\n'
    text = some_file(6)
    head, tail = text.split("[[stage]]")[0], text.split("[limits]")[1]
    text = f'{head}[[stage]]\n{stage}centre_distance = "130 mm"\n[limits]{tail}'
    text = text.split("[shift]")[0] + "[layout]" + text.split("[layout]")[1]
    with pytest.raises(SceneError, match="together takes from the reference circles"):
        load(written(tmp_path, text))
