"""What ratings need over cells of designs, and the search for a bound by them."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from campaigns import few
from random_cells import designs_within, needed_by, random_cells
from rated_drives import (
    FREE,
    MATERIALS,
    RACK,
    agma,
    by,
    iso,
    rated_drive,
    some_iso,
    some_rated_drive,
    static,
)

from gearopt.formulations.drive import continuous_sizing, sizing_text, teeth
from gearopt.formulations.drive.rated_continuous import boxes as rated_boxes
from gearopt.formulations.drive.rated_continuous import cells as rated_cells
from gearopt.formulations.drive.rated_continuous.boxes import (
    ROWS,
    bounded,
    first_boxes,
    shafts_about,
)
from gearopt.formulations.drive.rated_continuous.cells import _halves
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth
from gearopt.formulations.strength.standard import Load
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.physics.agma.rating_factors import Practice as Mounted
from gearopt.physics.agma.rating_factors import Steel
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import Rack
from gearopt.physics.iso6336.case import Practice
from gearopt.physics.iso6336.load_factors import Shaft

F = Fraction
SAFETY = (1.2, 1.1)
CARBURISED = (Steel("carburised"),) * 2
NEW = Practice("2019", "2013", (5.0, 6.0), helix_modification="crowned")
PARTLY = (Load(20000.0, 0.8, 1.3),)
MOUNTED = Mounted(6.0, "open", crowned=True, offset=0.3, adjusted=True, size=True)
OTHERS = {"K_Halpha": 1.1, "Z_BD": (1.1, 1.0), "Z_H": 2.3, "Z_beta": 1.05, "Y_beta": 0.9}
OTHERS |= {"K_Fbeta": 1.2, "c_gamma_beta": 15e3, "Y_S": (1.6, 1.7), "Z_NT": (0.9, 1.0)}
STANDARDS = {
    "agma": agma(),
    "agma, short life": agma(CARBURISED, hours=20.0),
    "iso": iso(),
    "iso 2019": iso(practice=NEW),
    "iso, short life": some_iso(CARBURISED, 8.0, 20.0),
    "agma, rims": replace(
        agma(practice=MOUNTED),
        blanks=(Blank(), Blank(rim_over_module=2.0, web_over_width=0.4)),
        loads=PARTLY,
    ),
    "agma, given": agma(given={"K_v": 1.3, "J": (0.4, 0.45), "Z_N": (0.9, 0.95), "C_H": (1, 1.02)}),
    "agma, I given": agma(given={"I": 0.11, "K_m": 1.3, "K_s": (1.1, 1.2), "K_B": (1.1, 1.2)}),
    "iso, webs": replace(
        iso((MATERIALS[0], replace(MATERIALS[1], density=7.2e-9))),
        blanks=(Blank(bore=8.0), Blank(rim_thickness=12.0, web_over_width=0.3, bore=20.0)),
        loads=PARTLY,
    ),
    "iso, given": iso(given={"K_v": 1.2, "Z_eps": 0.8, "Y_F": (2.5, 2.3), "f_ma": 0.01}),
    "iso, c_gamma given": iso(given={"c_gamma_alpha": 19e3, "N": 0.3, "C_a": 0.02}),
    "iso, others given": iso(given=OTHERS),
    "iso, static": static(),
    "iso, offset": iso(practice=Practice(shaft=Shaft(200.0, 20.0, 80.0, "a"))),
    "iso, away": iso(practice=Practice(shaft=Shaft(200.0, 40.0, 60.0, "b"))),
}
# what cells ask for over what designs in them need, medians: of contact and bending, helical teeth
# and shifted ones
TIGHT = {
    "agma": (0.9884, 0.9798, 0.9881, 0.9828),
    "agma, short life": (0.9886, 0.9793, 0.9884, 0.9817),
    "iso": (0.9809, 0.9682, 0.9755, 0.9704),
    "iso 2019": (0.9862, 0.9713, 0.9805, 0.9722),
    "iso, short life": (0.9843, 0.9698, 0.9795, 0.9705),
    "agma, rims": (0.9868, 0.9780, 0.9865, 0.9811),
    "agma, given": (0.9914, 0.9915, 0.9910, 0.9912),
    "agma, I given": (0.9947, 0.9816, 0.9941, 0.9832),
    "iso, webs": (0.9772, 0.9621, 0.9710, 0.9641),
    "iso, c_gamma given": (0.9776, 0.9664, 0.9753, 0.9681),
    "iso, given": (0.9868, 0.9764, 0.9846, 0.9793),
    "iso, others given": (0.9875, 0.9779, 0.9851, 0.9786),
    "iso, static": (0.9896, 0.9703, 0.9847, 0.9746),
    "iso, offset": (0.9851, 0.9723, 0.9801, 0.9749),
    "iso, away": (0.9841, 0.9718, 0.9792, 0.9745),
}
TOOTHINGS = {
    "spur": Toothing(0.0, (RACK, RACK)),
    "helical": Toothing(0.4363, (RACK, RACK)),
    "thinned": Toothing(0.1745, (RACK, RACK), thickness_allowances=(-0.1, -0.15)),
    "shifted": Toothing(0.1745, (Rack(), Rack()), (0.48, 0.67), (-0.067, -0.067)),
    "wider": Toothing(0.2, (RACK, RACK), width_excesses=(10.0, 0.0)),
}


def held(name, toothing, width, count, seed):
    """Assert that no random design needs less than its cell says, and return the ratios."""
    rng, standard = np.random.default_rng(seed), STANDARDS[name]
    cells = random_cells(rng, count, TOOTHINGS[toothing], width)
    with np.errstate(all="ignore"):
        least = standard.needed(cells, SAFETY)
        pair, torque, speed = designs_within(rng, cells)
        true = needed_by(standard, pair, torque, speed, SAFETY)
    found = []
    for below, exact in zip(least, true, strict=True):
        rated = np.isfinite(exact)
        assert rated.sum() > 0.8 * count
        found.append((below / exact)[rated])
        assert found[-1].max() <= 1.0 + 1e-10
    return found


@pytest.mark.parametrize("toothing", few(TOOTHINGS, ["shifted"]))
@pytest.mark.parametrize("name", STANDARDS)
def test_no_design_needs_less_than_its_cell(name, toothing):
    pressed, bent = held(name, toothing, 0.02, 300, 1)
    found = np.median(pressed), np.median(bent)
    known = dict(zip(("helical", "shifted"), (TIGHT[name][:2], TIGHT[name][2:]), strict=True))
    assert found == pytest.approx(known.get(toothing, found), abs=1e-4) and min(found) > 0.9


def test_corners_of_a_cell_lie_within_it():
    """By so little that sizes at a border of a law count to the side on which the cell lies."""
    cells = random_cells(np.random.default_rng(9), 50, TOOTHINGS["helical"], 0.02)
    for end, inwards in ((0, 1.0), (1, -1.0)):
        pair = cells.corner(end)
        sizes = pair.normal_module, pair.face_width
        sizes += tuple(gear.reference_diameter for gear in pair.gears)
        ends = cells.module, cells.width, cells.diameter, cells.wheel
        for size, of_cell in zip(sizes, ends, strict=True):
            step = inwards * (size / of_cell[end] - 1.0)
            assert (step > 0.0).all() and (step < 1e-10).all()


@pytest.mark.parametrize(
    "blank",
    [
        Blank(rim_over_module=1.5, web_over_width=0.4, bore=40.0),
        Blank(rim_thickness=9.0, bore=25.0),
    ],
)
def test_no_blank_of_a_cell_is_beyond_its_ends(blank):
    """Small gears are solid, larger ones bored or rimmed; where a cell has two, both count."""
    rng = np.random.default_rng(8)
    cells = random_cells(rng, 300, TOOTHINGS["helical"], 0.3)
    made = [designs_within(rng, cells)[0].pinion for _ in range(8)]
    for law in (blank.backups, blank.inner_diameters):
        least, most = cells.of_bodies(blank, 0, law)
        for gear in made:
            value = blank.where(gear, *law(gear))
            assert (least <= value * (1.0 + 1e-12)).all()
            assert (value <= most * (1.0 + 1e-12)).all()
    bodies = np.array([blank.where(gear, 2, 1, 0) for gear in made])
    mixed = (np.ptp(bodies, axis=0) > 0).sum()
    assert 20 < mixed < 150 and all((bodies == k).any() for k in range(3))
    point = random_cells(rng, 300, TOOTHINGS["helical"], 0.0)
    for law in (blank.backups, blank.inner_diameters):
        least, most = point.of_bodies(blank, 1, law)
        wheel = designs_within(rng, point)[0].wheel
        np.testing.assert_allclose(least, blank.where(wheel, *law(wheel)), rtol=1e-9)
        np.testing.assert_allclose(least, most, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("width", [0.003, 0.03, 0.3])
@pytest.mark.parametrize("toothing", TOOTHINGS)
@pytest.mark.parametrize("name", STANDARDS)
def test_no_design_of_many_needs_less_than_its_cell(name, toothing, width):
    ratios = held(name, toothing, width, 4000, 2)
    assert max(found.max() for found in ratios) <= 1.0 + 1e-10


@pytest.mark.parametrize("name", STANDARDS)
def test_a_point_needs_what_is_rated(name):
    pressed, bent = held(name, "helical", 0.0, 300, 3)
    assert pressed == pytest.approx(1.0, abs=1e-8) and bent == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize("name", ["agma", "iso"])
def test_what_a_cell_leaves_open_falls_with_its_width(name):
    """To first order: a tenth of the width, a tenth of the difference, at most a third."""
    lost = [1.0 - np.median(held(name, "helical", w, 300, 4)[0]) for w in (0.03, 0.003)]
    assert lost[1] < lost[0] / 3.0


def run(train, seconds=20.0, close=1e-3, known=(), most=math.inf):
    return rated_cells.search(train, known, most, Clock(Budget(seconds)), close)


@pytest.mark.parametrize("helix", [None, (0.15, 0.5)])
def test_made_smaller_boxes_hold_all_designs_that_are_accepted(helix):
    """Random designs of one stage that the ratings accept lie in a box, and its share is less."""
    train = rated_drive(4, [FREE], options=by("agma", "iso"), pinion_teeth=(20, 40))
    stage = replace(train.stages[0], helix=helix)
    train = replace(train, stages=(stage,))
    shafts, rng = shafts_about(train, 8), np.random.default_rng(5)
    boxes, least = bounded(shafts, 0, first_boxes(shafts, 0))
    if helix is not None:
        halves = _halves(shafts, 0, boxes)
        boxes, least = bounded(shafts, 0, _halves(shafts, 0, halves))
    low, high = np.log([[20, 0.3, 30, 3.96], [40, 0.75, 400, 4.04]])
    z, slim, d, u = np.exp(rng.uniform(low, high, (4000, 4))).T
    cut = stage.toothing if helix is None else stage.cut(helix_angle=rng.uniform(*helix, len(z)))
    pair = cut.of_diameter(d * np.cos(cut.helix_angle) / z, z, d, u, slim * d)
    load = np.full(len(z), train.torque), np.full(len(z), train.speed)
    used = stage.options[0].utilisations(pair, *load, train.safety)
    module = pair.normal_module
    good = (np.max([*used.values()], axis=0) <= 1.0) & (module >= 1.0) & (module <= 12.0)
    at = {
        "teeth": z,
        "width_over_diameter": slim,
        "diameter": d,
        "end": u,
        "module": module,
        "width": slim * d,
    }
    at |= {"wheel": u * d, "ratio": u}
    at["helix"] = np.ones_like(z) if helix is None else np.tan(cut.helix_angle)
    at |= dict.fromkeys(("pinion_shift", "shift_sum"), np.ones_like(z))
    point = np.log([at[name][good] for name in ROWS])[:, None, :]
    low, high = (boxes.sizes[:, end, :, None] for end in (0, 1))
    inside = (low <= point[:, 0, None] + 1e-12) & (point[:, 0, None] <= high + 1e-12)
    assert inside.all(axis=0).any(axis=0).all() and good.sum() > 100
    assert least.min() <= pair.volume[good].min()


@pytest.mark.parametrize("slim", [F(6, 10000), F(2000)])
def test_first_boxes_hold_face_widths_of_any_proportion(slim):
    """A width that the file ties to 0.0006 d1 is no less possible than one tied to 0.3 d1."""
    train = rated_drive(4, [FaceWidth(slim, slim)], pinion_teeth=(20, 40))
    shafts = shafts_about(train, 8)
    boxes = first_boxes(shafts, 0)
    assert np.exp(boxes.sizes[ROWS.index("width_over_diameter")]) == pytest.approx(float(slim))
    assert len(bounded(shafts, 0, boxes)[0]) == len(boxes)


@pytest.mark.parametrize(("power", "fixed"), [(1e5, None), (1e5, 20), (2e5, 20), (3e5, 40)])
def test_boxes_hold_gears_at_a_step_of_the_tolerances(power, fixed):
    """Modules of 2 mm and widths of 20 and 40 mm have the smaller deviations of ISO 1328."""
    face = FREE if fixed is None else FaceWidth(F(0), None, fixed=F(fixed))
    stages = {"modules": (F(2), F(9, 4)), "pinion_teeth": (20, 24)}
    train = rated_drive(3, [face], power=power, helix=0.0, options=by("iso"), **stages)
    whole = solve(teeth.problem(train))
    (pair,) = teeth.pairs(train, np.array([*whole.design.values()], float))
    shafts = shafts_about(train, 1)
    boxes, d = first_boxes(shafts, 0), pair.pinion.reference_diameter
    rows = {"Z": pair.pinion_teeth, "D": d, "B_OVER_D": pair.face_width / d, "U": pair.ratio}
    for name, value in rows.items():
        row = boxes.sizes[getattr(rated_boxes, name), :, 0]
        row[:] = np.clip(math.log(float(value)) + np.array([-1e-3, 1e-3]), *row)
    (share,) = bounded(shafts, 0, boxes)[1]
    assert 0.99 * whole.value < share <= whole.value


@pytest.mark.parametrize("empty", [0, 1])
def test_a_drive_with_a_stage_that_no_box_allows_is_impossible(empty):
    train = rated_drive(16, [FREE, FREE])
    stages = list(train.stages)
    stages[empty] = replace(stages[empty], pinion_teeth=(20, 40), wheel_diameter=F(1, 1000))
    found = run(replace(train, stages=tuple(stages)))
    assert found.pairs is None and found.bound == found.value == math.inf


@pytest.mark.slow
def test_the_published_pair_is_proven_optimal():
    """1,699,381 by Ipopt; the bound by cells alone."""
    from test_rated_sizing import published_pair

    train = published_pair()
    found = solve(continuous_sizing.problem(train))
    assert found.status == "optimal" and found.gap <= 1e-6
    assert found.bound == pytest.approx(found.value, rel=1e-6)


@pytest.mark.parametrize("name", ["agma", "iso"])
def test_what_no_cell_allows_is_impossible(name):
    """A wheel that is smaller than the ratings need: by AGMA a program proves it, by ISO cells."""
    train = rated_drive(4, [FREE], options=by(name), wheel_diameter=F(60))
    found = solve(continuous_sizing.problem(train))
    assert found.status == "infeasible" and found.value is None


@pytest.mark.slow
@pytest.mark.parametrize("names", [("agma",), ("agma", "iso")])
@pytest.mark.parametrize("helix", [0.0, 0.4363])
def test_the_bound_is_below_whole_teeth_and_designs_that_are_found(names, helix):
    train = rated_drive(20, [FREE, FREE], options=by(*names), helix=helix)
    whole = solve(teeth.problem(train))
    found = run(train, 1.0)
    assert found.bound <= whole.value * (1.0 + 1e-9) and found.bound <= found.value
    assert found.bound > 0.0 and found.pairs is not None


@pytest.mark.slow
@pytest.mark.parametrize("standard", [agma, some_iso])
@pytest.mark.parametrize("block", range(2))
def test_random_small_drives_are_not_better_than_their_bound(standard, block):
    """Whole teeth by the exact search; designs that are found are accepted by the exact text."""
    seen = 0
    for seed in range(6 * block, 6 * block + 6):
        train = some_rated_drive(seed, standard=standard)
        whole = solve(teeth.problem(train), budget=Budget(20.0))
        found = run(train, 0.3, 1e-2)
        if whole.value is not None:
            assert found.bound <= whole.value * (1.0 + 1e-9)
            seen += 1
        if found.pairs is not None:
            assert found.bound <= found.value
            made = continuous_sizing._of_pairs(train, continuous_sizing.problem(train), found)
            assert made is not None
    assert seen > 1


@pytest.mark.slow
def test_three_stages_close_at_a_measured_pace():
    """AGMA: 1e-2, long before half a minute is over."""
    train = rated_drive(110, [FREE, FREE, FREE])
    found = run(train, 30.0, 1e-2)
    assert found.bound > 0.98 * found.value


def test_a_gap_that_is_asked_for_is_reached():
    train = rated_drive(4, [FREE], options=by("agma"))
    method = continuous_sizing.searched(train)
    posed = replace(sizing_text.exact_text(train), methods={"smooth": method})
    found = solve(posed, budget=Budget(20.0, gap=0.05), gap=0.05)
    assert found.status == "optimal" and 0.0 < found.gap <= 0.05


def test_a_search_keeps_to_its_seconds():
    train = rated_drive(20, [FREE, FREE], options=by("agma", "iso"))
    clock = Clock(Budget(0.2))
    found = rated_cells.search(train, (), math.inf, clock, 1e-6)
    assert clock.seconds < 1.5 and 0.0 < found.bound < math.inf
