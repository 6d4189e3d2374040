"""Both published ISO cases, every quantity, and that errors seen in other programs are caught.

Tolerances are half a unit of the last printed digit, but where the print follows another rule:
gamma_e of the report is that of z/cos(beta)^3 teeth (0.015 degrees of alpha_Fen, 0.16 % of h_F, 0.1
% of Y_F and sigma_F), and its m_red, n_E1 and N those of tip and root with their allowances.
"""

import pytest
from iso6336_cases import CASES, case_report, computed

from gearopt.bench.rating import iso_example
from gearopt.physics.iso6336.rating import rate

ROWS = [(name, symbol) for name, (_, rows) in CASES.items() for symbol in rows]


@pytest.fixture(scope="module")
def values():
    return {name: computed(make()) for name, (make, _) in CASES.items()}


@pytest.mark.parametrize(("name", "symbol"), ROWS)
def test_a_printed_quantity_is_met(values, name, symbol):
    printed, tolerance = CASES[name][1][symbol]
    assert values[name][symbol] == pytest.approx(printed, rel=tolerance, abs=1e-12)


def rating(case):
    return rate(case.pair, case.operation, case.materials, case.practice, case.given)


def test_the_ratings_are_those_of_the_quantities(values):
    for name, make in (("tr30", iso_example), ("report", case_report)):
        found = rating(make())
        assert found.contact_safety == pytest.approx(values[name]["S_H"], rel=1e-14)
        assert found.bending_safety == pytest.approx(values[name]["S_F"], rel=1e-14)
        assert (found.load,) == values[name]["F_t"]
    assert rating(iso_example()).governs == ("pinion", "contact")
    assert rating(case_report()).governs == ("wheel", "bending")


def test_published_cases_are_verified_but_for_strengths():
    """sigma_Flim of 425 MPa has pictures of the table alone; what is given is not doubted."""
    assert rating(iso_example()).unverified == ("sigma_Flim",)
    assert rating(case_report()).unverified == ()


def test_predictions_of_another_program():
    """Bending of the example as a second program computes it: 2006, x = 0.145, to 0.1 %."""
    found = computed(iso_example())
    assert found["Y_F"] == pytest.approx((1.556, 1.337), rel=1e-3)
    assert found["Y_S"] == pytest.approx((1.825, 2.075), rel=1e-3)
    assert found["Y_beta"] == pytest.approx((0.868,), rel=6e-4)
    assert found["sigma_F0"] == pytest.approx((392.5, 383.4), rel=1e-3)
