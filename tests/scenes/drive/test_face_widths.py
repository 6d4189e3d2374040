"""Gears that are wider than their mesh: ratings by hand, the best of all trains, refusals."""

import copy
import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt.errors import SceneError
from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.batch import rate_rows
from gearopt.physics.iso6336.case import Practice
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.rating import Operation

PAIR = "problems/pair_by_both.toml"
MODULE, OMEGA = 3.0, 1460.0 * math.pi / 30.0
DRIVE = {
    "gearopt": 1,
    "kind": "drive",
    "duty": {"power": "30 kW", "input_speed": "1460 rpm", "ratio": 3.2, "ratio_tolerance": "3 %"},
    "gears": {
        "treatment": "carburised",
        "flank_rz": "4.8 um",
        "helix_angle": "12 deg",
        "face_width_over_diameter": [0.3, 1.0],
        "pinion_face_width_excess": "6 mm",
    },
    "stage": [{}],
    "limits": {"pinion_teeth": [18, 21]},
    "teeth": {"modules": ["2.5 mm", "3 mm", "4 mm"]},
    "rating": {
        "standard": "iso6336",
        "life": "20000 h",
        "minimum_bending_safety": 2.9,
        "iso6336": {"accuracy_grade": 6},
    },
}


def rated(**widths):
    """The rating of the pair with face widths of its gears: by AGMA and by ISO, and its stage."""
    changes = {f"stage[1].{member}.face_width": width for member, width in widths.items()}
    design = gearopt.rate(PAIR, changes=changes).design
    return design["rating"], design["rating"]["beside"], design["stages"][0]


def factor(rating, symbol, member="pinion"):
    row = next(f for f in rating["factors"] if f["symbol"] == symbol)
    return row[member] if row.get(member) is not None else row["pinion"]


@pytest.mark.parametrize("width, root", [("45 mm", 45.0), ("46 mm", 46.0), ("60 mm", 46.0)])
def test_stress_of_a_wider_pinion_by_hand(width, root):
    """sigma_F1 = F_t/(b_F1 m_n) Y_F Y_S Y_beta Y_B Y_DT K_A K_v K_Fbeta K_Falpha, m_n = 3 mm.

    T = 30 kW/(1460 pi/30 1/s) = 196.2 N m and d1 = 3 21/cos(12 deg) = 64.41 mm: F_t = 6093 N. The
    mesh has b = 40 mm; b_F1 = b_1 = 45 mm, or at most 40 + 2 3 = 46 mm.
    """
    agma, iso, stage = rated(pinion=width)
    diameter = MODULE * 21 / math.cos(math.radians(12.0))
    load = 2.0 * 30e6 / OMEGA / diameter
    assert load == pytest.approx(6093.0, abs=1.0)
    symbols = "Y_F", "Y_S", "Y_beta", "Y_B", "Y_DT", "K_A", "K_v", "K_Fbeta", "K_Falpha"
    product = math.prod(factor(iso, symbol) for symbol in symbols)
    stress = load / (root * MODULE) * product
    assert iso["gears"][0]["bending_stress_MPa"] == pytest.approx(stress, rel=1e-9)
    before, iso_before, stage_before = rated()
    assert [f["pinion"] for f in iso["factors"]] == [f["pinion"] for f in iso_before["factors"]]
    assert iso["gears"][1] == iso_before["gears"][1]
    assert (agma["gears"], agma["factors"]) == (before["gears"], before["factors"])
    own = float(width.split()[0])
    assert stage["pinion_face_width_mm"] == own and stage["face_width_mm"] == 40.0
    mass = stage_before["pinion_mass_kg"] * own / 40.0
    assert stage["pinion_mass_kg"] == pytest.approx(mass, rel=1e-12)
    volume = stage["gear_volume_mm3"] - stage_before["gear_volume_mm3"]
    assert volume == pytest.approx(math.pi / 4.0 * diameter**2 * (own - 40.0), rel=1e-9)


def test_the_narrower_gear_is_the_mesh():
    """Of 45 and 38 mm what rates is 38 mm, whichever gear has it and however it is written."""
    changes = {"stage[1].face_width": "38 mm", "stage[1].pinion_face_width_excess": "7 mm"}
    by_excess = gearopt.rate(PAIR, changes=changes).design
    changes = {"stage[1].face_width": None, "stage[1].pinion.face_width": "45 mm"}
    by_gears = gearopt.rate(PAIR, changes=changes | {"stage[1].wheel.face_width": "38 mm"}).design
    assert by_gears == by_excess
    assert by_gears["stages"][0]["pinion_face_width_mm"] == 45.0
    _, iso, stage = rated(wheel="45 mm")
    assert stage["wheel_face_width_mm"] == 45.0
    wheel = rated()[1]["gears"][1]["bending_stress_MPa"] * 40.0 / 45.0
    assert iso["gears"][1]["bending_stress_MPa"] == pytest.approx(wheel, rel=1e-9)


def least_volume(excess, bending):
    """The least volume [mm3] of all teeth and modules of DRIVE, each rated at many widths."""
    steel, best = Material("Eh", "MQ", flank=4.8e-3), math.inf
    helix, practice = math.radians(12.0), Practice(grades=(6.0, 6.0))
    for z1 in range(18, 22):
        for z2 in range(math.ceil(3.2 * 0.97 * z1), math.floor(3.2 * 1.03 * z1) + 1):
            for module in (2.5, 3.0, 4.0):
                unit = GearPair.of_teeth(module, z1, z2, 1.0, helix)
                d1, d2 = (gear.reference_diameter for gear in unit.gears)
                low, high = 0.3 * d1, 1.0 * d1
                for _ in range(4):  # the first of a grid that carries, and a finer grid before it
                    widths = np.linspace(low, high, 201)
                    pair = GearPair.of_teeth(*np.broadcast_arrays(module, z1, z2, widths), helix)
                    pair = replace(pair, pinion=replace(pair.pinion, width_excess=excess))
                    operation = Operation(30e6, OMEGA, 20000.0)
                    found = rate_rows(pair, operation, (steel, steel), practice, {})
                    rows = [np.minimum(*found.bending) / bending, np.minimum(*found.contact)]
                    safe = np.flatnonzero(np.minimum(*rows) >= 1.0)
                    if not len(safe):
                        break
                    high = widths[safe[0]]
                    low = widths[max(safe[0] - 1, 0)]
                else:
                    best = min(best, math.pi / 4.0 * (d1**2 * (high + excess) + d2**2 * high))
    return best


@pytest.mark.parametrize("excess, bending", few([(0.0, 2.9), (6.0, 2.9), (30.0, 3.5)], (1,)))
def test_the_best_is_that_of_all_trains(excess, bending):
    asked = copy.deepcopy(DRIVE)
    asked["gears"]["pinion_face_width_excess"] = f"{excess:g} mm"
    asked["rating"]["minimum_bending_safety"] = bending
    found = gearopt.solve(asked)
    assert found.status == "optimal"
    assert found.value == pytest.approx(least_volume(excess, bending), rel=1e-7)
    stage = found.design["stages"][0]
    if excess:
        assert stage["pinion_face_width_mm"] == pytest.approx(stage["face_width_mm"] + excess)


@pytest.mark.slow
def test_a_wider_pinion_in_its_box():
    """Both gears lie about the middle of the mesh, and the box holds the wider one."""
    layout = {"shaft_stress": "40 MPa"}
    design = gearopt.solve(copy.deepcopy(DRIVE) | {"layout": layout}).design
    pinion, wheel = design["layout"]["gears"]
    own = pinion["to_mm"] - pinion["from_mm"]
    assert own == pytest.approx(design["stages"][0]["face_width_mm"] + 6.0)
    assert wheel["from_mm"] == pytest.approx(pinion["from_mm"] + 3.0)
    assert wheel["to_mm"] == pytest.approx(pinion["to_mm"] - 3.0)


REFUSED = [
    ({"teeth": None}, "pinion_face_width_excess"),
    ({"rating": None, "limits.preset": "chong-lee-elevator"}, r"needs a table \[rating\]"),
    ({"layout": {"shaft_stress": "40 MPa", "together": True}}, "one width of a stage"),
    ({"stage[1].pinion.face_width": "40 mm"}, "wheel.face_width: is missing"),
    (
        {"stage[1].face_width": "40 mm", "stage[1].pinion.face_width": "45 mm"},
        "Write pinion_face_width_excess",
    ),
]


@pytest.mark.parametrize("changes, words", REFUSED)
def test_what_a_wider_gear_does_not_go_with(changes, words):
    with pytest.raises(SceneError, match=words):
        gearopt.solve(copy.deepcopy(DRIVE), changes=changes)


def test_cutting_costs_the_width_of_each_gear():
    """A metre of teeth is z b = 1000 mm, with b of the gear itself."""
    steel = {"name": "hard", "treatment": "carburised", "price": 0.001, "cutting_price": 8}
    found = gearopt.solve(
        "problems/given_distance.toml",
        {
            "material": [steel],
            "gears.materials": ["hard"],
            "gears.treatment": None,
            "gears.grade": None,
            "gears.iso_material": None,
            "gears.iso_quality": None,
            "gears.pinion_face_width_excess": "12 mm",
            "objective": {"minimise": "cost", "density": "7.85 kg/dm^3"},
        },
    )
    (stage,) = found.design["stages"]
    widths = stage["face_width_mm"] + 12.0, stage["face_width_mm"]
    teeth = stage["pinion_teeth"], stage["wheel_teeth"]
    by_hand = [8e-3 * z * b for z, b in zip(teeth, widths, strict=True)]
    assert [row["cutting"] for row in found.design["costs"]] == pytest.approx(by_hand, rel=1e-12)
    assert found.value == pytest.approx(sum(row["total"] for row in found.design["costs"]))
