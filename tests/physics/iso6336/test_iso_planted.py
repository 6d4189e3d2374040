"""Errors seen in public programs, planted one at a time: the check of each passes, and then fails.

A check compares with a published case, or with a number that follows by hand from the standard's
definition. AGMA's own planted errors (M = 0.261 - 0.545 phi) are caught in tests/physics/agma.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from iso6336_cases import CASES, case_report, computed

from gearopt.bench.rating import iso_example
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry import contact as path
from gearopt.physics.iso6336 import bending_factors, contact_factors, running_in, tooth_form
from gearopt.physics.iso6336 import chain as chained
from gearopt.physics.iso6336.case import Case, Practice
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.rating import Operation


def met(name, *symbols):
    """Whether the quantities of a published case lie within their tolerances."""
    make, rows = CASES[name]
    found = computed(make())
    return all(
        found[s] == pytest.approx(rows[s][0], rel=rows[s][1], abs=1e-12) for s in symbols or rows
    )


def spur():
    """A spur pair of 20/40 teeth whose single contact point B lies far below the pitch point."""
    pair = GearPair.of_teeth(4.0, 20, 40, 40.0)
    steel = Material("Eh", "MQ")
    return Case(pair, Operation(1e8, 100.0, 1e4), (steel, steel), Practice())


def of_2019(allowance=0.0):
    """The example by the edition of 2019, with the pinion thinned."""
    case = iso_example()
    pinion = replace(case.pair.pinion, profile_shift=0.14522, thickness_allowance=allowance)
    pair = replace(case.pair, pinion=pinion)
    return replace(
        case, pair=pair, practice=replace(case.practice, edition="2019", shift="generating")
    )


THINNED = 2.0 * 8.0 * math.tan(math.radians(20.0)) * (0.11779 - 0.14522)  # x_E1 = 0.11779


def load_sharing_is_right():
    """eps_alphan 1.6577: 0.7767. Y_F1 = 1.261 with x_E1, as another program has it."""
    found = chained.quantities(of_2019(THINNED))
    return found["Y_F"][0] == pytest.approx(1.261, rel=2e-3)


def helix_of_2019_is_right():
    """(1 - 15.8/120)/cos(15.8)^3."""
    known = (1.0 - 15.8 / 120.0) / math.cos(math.radians(15.8)) ** 3
    return chained.quantities(of_2019())["Y_beta"] == pytest.approx(known, rel=1e-12)


def spur_ratio_is_right():
    """eps_alpha 1.6350 of 20/40 teeth, by the textbook: Z_eps = sqrt((4 - 1.635)/3) = 0.888."""
    return chained.quantities(spur())["Z_eps"] == pytest.approx(0.888, abs=5e-4)


def single_contact_is_right():
    """Z_B of 20/40 teeth from the radii of curvature at B and C: sqrt(rho_C/rho_B)."""
    pair = spur().pair
    line = path.contact_path(pair)

    def curvature(position):
        first, second = line.radii_of_curvature(position)
        return first * second / (first + second)

    expected = math.sqrt(curvature(0.0) / curvature(line.lowest_single))
    return chained.quantities(spur())["Z_BD"][0] == pytest.approx(max(expected, 1.0), rel=1e-12)


def thinning_counts():
    """x_E1 in the place of x1 raises Y_F1 of the example by 1.5 to 4 %."""
    thick, thin = (chained.quantities(of_2019(a))["Y_F"][0] for a in (0.0, THINNED))
    return 1.015 < thin / thick < 1.05


def softer_lubrication_is_right():
    """sigma_Hlim 1000: C_ZL = 1000/4375 + 0.6357 = 0.86427; nu_40 320: Z_L 1.2034 - 0.2034 C."""
    c = 1000.0 / 4375.0 + 0.6357
    known = c + 4.0 * (1.0 - c) / (1.2 + 134.0 / 320.0) ** 2
    return contact_factors.lubricant_factor(1000.0, 320.0) == pytest.approx(known, rel=2e-5)


def slip_layer_is_right():
    """St of a yield point of 400 MPa: 0.0445 mm."""
    return bending_factors.slip_layer("St", 400.0) == 0.0445


def yield_point_is_asked():
    """V of 800 MPa yield and sigma_Flim of 290 MPa: rho' 0.0064, not 0.0281; q_s 2 by hand."""
    steel = Material("V alloy", "ML", 300.0, yield_strength=800.0)
    case = replace(spur(), materials=(steel, steel), operation=Operation(1e8, 100.0, 1e6))
    notch = case.forms[0].notch
    known = (1 + math.sqrt(0.0064 * 0.2 * (1 + 2 * notch))) / (1 + math.sqrt(0.0064 * 1.2))
    return chained.quantities(case)["Y_deltarelT"][0] == pytest.approx(known, rel=1e-12)


def relief_is_right():
    """1500 MPa: (15.4639 - 18.45)^2/18 + 1.5 = 1.995 um, 2.0 in the report."""
    return running_in.tip_relief(1500.0) == pytest.approx(2.0e-3, abs=0.05e-3)


def zeros_of_any_kind_are_zeros():
    """0, 0.0 and numpy's 0.0 of helix angle and shifts give one rating, that of a spur gear."""
    steel = Material("Eh", "MQ")
    found = []
    for zero in (0, 0.0, np.float64(0.0)):
        pair = GearPair.of_teeth(4.0, 20, 40, 40.0, zero, Rack(), (zero, zero))
        case = Case(pair, Operation(1e8, 100.0, 1e4), (steel, steel), Practice())
        found.append(chained.quantities(case))
    same = all(one[s] == found[0][s] for one in found for s in ("sigma_H", "sigma_F", "K_v"))
    return same and single_contact_is_right()


def _tip_load(form):
    """Load at the tip: as if eps_alphan were 1."""

    def law(gear, helix, transverse, shift="nominal"):
        return form(gear, helix, math.cos(helix) ** 2, shift)

    return law


def _reference_distance(law):
    """The path of contact of the reference centre distance."""

    def wrong(pair, forms=None):
        return law(replace(pair, working_distance=pair.reference_distance), forms)

    return wrong


def _by_strength(stress):
    def law(family, strength):
        return bending_factors.SLIP_LAYERS[family][0][1]

    return law


LAWS, ZERO = chained.LAWS, 0.0
ERRORS = {
    "f_eps = 1": (load_sharing_is_right, chained, "load_sharing", lambda ratio, overlap: 1.0),
    "Y_beta of the other edition, 2019": (
        helix_of_2019_is_right,
        bending_factors,
        "helix_factor",
        lambda helix, overlap, edition, law=bending_factors.helix_factor: law(helix, overlap),
    ),
    "Y_beta of the other edition, 2006": (
        lambda: met("report", "Y_beta"),
        bending_factors,
        "helix_factor",
        lambda h, o, edition, law=bending_factors.helix_factor: law(h, o, "2019"),
    ),
    "Z_beta = sqrt(cos(beta))": (
        lambda: met("tr30", "Z_beta", "sigma_H0"),
        contact_factors,
        "helix_factor",
        lambda helix: math.sqrt(math.cos(helix)),
    ),
    "Z_eps = sqrt(1/eps_alpha) of spur gears": (
        spur_ratio_is_right,
        contact_factors,
        "contact_ratio_factor",
        lambda transverse, overlap: transverse**-0.5,
    ),
    "Z_B = Z_D = 1": (
        single_contact_is_right,
        contact_factors,
        "single_contact_factor",
        lambda ratio, overlap, helical=1.0: 1.0,
    ),
    "x_E ignored": (
        thinning_counts,
        tooth_form,
        "virtual_gear",
        lambda gear, shift, law=tooth_form.virtual_gear: law(gear, "nominal"),
    ),
    "load at the tip": (
        lambda: met("report", "Y_F", "h_F", "alpha_Fen", "d_en"),
        tooth_form,
        "tooth_form",
        _tip_load(tooth_form.tooth_form),
    ),
    "c' 1 % off": (
        lambda: met("tr30", "c_prime") and met("report", "c_prime"),
        LAWS,
        "c_prime",
        lambda case, found, law=LAWS["c_prime"]: 1.01 * law(case, found),
    ),
    "K_Fbeta = K_Hbeta": (
        lambda: met("tr30", "K_Fbeta"),
        LAWS,
        "K_Fbeta",
        lambda case, found: found["K_Hbeta"],
    ),
    "Y_X = 1": (
        lambda: met("report", "Y_X", "sigma_FG"),
        bending_factors,
        "size_factor",
        lambda family, module: 1.0,
    ),
    "reference centre distance": (
        lambda: met("report", "eps_gamma", "Z_eps"),
        None,
        "contact_path",
        _reference_distance(path.contact_path),
    ),
    "C_ZL of sigma_Hlim/437.5": (
        softer_lubrication_is_right,
        contact_factors,
        "_lubrication",
        lambda limit: limit / 437.5 + 0.6357,
    ),
    "slip layer 0.445": (
        slip_layer_is_right,
        bending_factors.SLIP_LAYERS,
        "St",
        ((300.0, 0.0833), (400.0, 0.445)),
    ),
    "slip layer by sigma_Flim": (
        yield_point_is_asked,
        bending_factors,
        "slip_layer",
        _by_strength("F"),
    ),
    "C_ay with 1/8": (
        relief_is_right,
        running_in,
        "tip_relief",
        lambda limit: ((limit / 97.0 - 18.45) ** 2 / 8.0 + 1.5) * 1e-3,
    ),
    "tests for 0 by identity": (
        zeros_of_any_kind_are_zeros,
        contact_factors,
        "single_contact_factor",
        lambda m, overlap, helical=1.0: 1.0 if overlap is not ZERO else max(m, 1.0),
    ),
}


@pytest.mark.parametrize("error", ERRORS)
def test_a_planted_error_is_caught(monkeypatch, error):
    check, place, name, wrong = ERRORS[error]
    assert check()
    if isinstance(place, dict):
        monkeypatch.setitem(place, name, wrong)
    elif place is None:
        monkeypatch.setattr("gearopt.physics.iso6336.case.contact_path", wrong)
        monkeypatch.setattr("iso6336_cases.contact_path", wrong)
    else:
        monkeypatch.setattr(place, name, wrong)
    assert not check()


def test_unplanted_cases_are_met():
    assert met("tr30") and met("report")
    assert case_report().practice.edition == iso_example().practice.edition == "2006"
