"""Load sharing: closed form against published formulas, optimality conditions, differences."""

import numpy as np
import pytest
from dense_sharing import share_dense

from gearopt.physics.load_sharing import in_contact, share, slopes

# Spur pair z 25/50, m 3 mm, b 30 mm, 200 Nm: normal load, and compliance [mm/N] of a tooth pair at
# SAP, LPSTC, pitch point, HPSTC, EAP (profile integral, Sainsot's foundation, log Hertz, plane
# strain) and between neighbours (plane finite elements), of a program that is not this one.
LOAD = 5675.614786538198
SAP, LPSTC, PITCH, HPSTC, EAP = (
    3.726948088271126e-06,
    2.7820530132194215e-06,
    2.7389874791618667e-06,
    2.752540628690723e-06,
    3.6352685430674756e-06,
)
COUPLING = 4.4491e-3 / 5675.6148


def random_rows(seed, rows, pairs):
    """Compliances, separations and loads in which some pairs carry and others do not."""
    rng = np.random.default_rng(seed)
    compliances = rng.uniform(2e-6, 5e-6, (rows, pairs))
    separations = rng.uniform(0.0, 20e-3, (rows, pairs)) * rng.integers(0, 2, (rows, pairs))
    separations[rng.random((rows, pairs)) < 0.1] = np.inf
    separations[:, 0] = np.minimum(separations[:, 0], 1.0)  # one pair is always there
    return compliances, separations, 10.0 ** rng.uniform(-3.0, 5.0, rows)


def test_two_pairs_are_the_published_case():
    """F1 + F2 = F with both in contact gives (17) to (20), but (20) with a plus sign."""
    k1, k2, e1, e2, load = 1.0e5, 5.0e4, 0.004, 0.001, 1000.0
    found = share([1 / k1, 1 / k2], [e1, e2], load)
    first = k1 / (k1 + k2) * (load - k2 * (e1 - e2))  # (19)
    printed = k2 / (k1 + k2) * (load - k1 * (e1 - e2))  # (20) as printed
    corrected = k2 / (k1 + k2) * (load + k1 * (e1 - e2))
    assert found.forces == pytest.approx([first, corrected], rel=1e-12)
    assert found.forces == pytest.approx([566.6666667, 433.3333333], rel=1e-9)
    assert found.approach == pytest.approx(0.0096666667, rel=1e-8)
    assert (printed, first + printed) == pytest.approx((233.3333333, 800.0), rel=1e-9)  # not 1000 N
    without = share([1 / k1, 1 / k2], [0.0, 0.0], load).forces  # (17), (18)
    assert without == pytest.approx([load * k1 / (k1 + k2), load * k2 / (k1 + k2)], rel=1e-12)


@pytest.mark.parametrize(
    "coupling, shares, approaches, peak_to_peak",
    [
        (
            0.0,
            [0.4248, 0.5665, 1.0, 0.5752, 0.4335],
            [8.986, 8.945, 15.545, 8.986, 8.945],
            6.600,
        ),
        (
            COUPLING,
            [0.4008, 0.5880, 1.0, 0.5992, 0.4120],
            [11.144, 11.117, 15.545, 11.144, 11.117],
            4.428,
        ),
    ],
)
def test_reference_pair(coupling, shares, approaches, peak_to_peak):
    """Shares and approach at SAP, LPSTC-, pitch, HPSTC+, EAP, as published to four digits.

    Their range is that of these five points; the single zone rises above the pitch point.
    """
    alone = (PITCH, np.inf)
    rows = [(SAP, HPSTC), (LPSTC, EAP), alone, (HPSTC, SAP), (EAP, LPSTC)]
    found = share(rows, np.where(np.isinf(rows), np.inf, 0.0), LOAD, coupling)
    assert found.forces[:, 0] / LOAD == pytest.approx(shares, abs=6e-5)
    assert 1e3 * found.approach == pytest.approx(approaches, abs=6e-4)
    assert 1e3 * np.ptp(found.approach) == pytest.approx(peak_to_peak, abs=1.1e-3)


@pytest.mark.parametrize("pairs", [1, 2, 3, 6])
def test_conditions_of_the_minimum(pairs):
    """Equilibrium, no tension, and C F + e - delta = gap with gap F = 0, in every row."""
    c, e, load = random_rows(pairs, 300, pairs)
    coupling = 0.3e-6
    found = share(c, e, load, coupling)
    assert found.forces.sum(axis=1) == pytest.approx(load, rel=1e-12)
    assert found.forces.min() >= 0.0 and found.gaps.min() >= 0.0
    there = np.isfinite(e)
    shown, gaps = np.where(there, e, 0.0), np.where(there, found.gaps, 0.0)
    left = (c - coupling) * found.forces + (coupling * load)[:, None] + shown
    left = np.where(there, left - found.approach[:, None], 0.0)
    scale = (c * load[:, None]).max(axis=1, keepdims=True) + shown
    assert np.abs((left - gaps) / scale).max() < 1e-12
    assert (gaps * found.forces).max() == 0.0 and np.isinf(found.gaps[~there]).all()


@pytest.mark.parametrize("pairs", [2, 3, 4])
def test_dense_is_the_coupled_closed_form_where_the_coupling_is_constant(pairs):
    """Enumeration of the pairs in contact takes another way to the same forces."""
    c, e, load = random_rows(10 + pairs, 200, pairs)
    coupling = 0.5e-6
    matrix = (c - coupling)[:, :, None] * np.eye(pairs) + coupling
    closed, dense = share(c, e, load, coupling), share_dense(matrix, e, load)
    for ours, theirs in zip(closed, dense, strict=True):
        both = np.isfinite(ours)
        assert (both == np.isfinite(theirs)).all()
        assert theirs[both] == pytest.approx(ours[both], rel=1e-9, abs=1e-11)


def test_dense_two_pairs_unload_where_the_cross_compliance_says():
    """F1 = [W (c22 - c12) - (e1 - e2)]/(c11 + c22 - 2 c12), and nothing from |e1 - e2| = that."""
    matrix, load = np.array([[3.7e-6, 0.8e-6], [0.8e-6, 2.8e-6]]), 5000.0
    limit = load * (2.8e-6 - 0.8e-6)
    half = share_dense(matrix, [0.5 * limit, 0.0], load)
    expected = 0.5 * limit / (3.7e-6 + 2.8e-6 - 1.6e-6)
    assert half.forces[0] == pytest.approx(expected, rel=1e-12)
    open_ = share_dense(matrix, [1.1 * limit, 0.0], load)
    assert open_.forces == pytest.approx([0.0, load], abs=1e-9)
    assert open_.gaps == pytest.approx([0.1 * limit, 0.0], rel=1e-9)


def test_slopes_are_differences():
    """Of the approach, by each separation and by the load; the former sum to 1."""
    c, e, load = random_rows(3, 300, 3)
    e[np.isinf(e)] = 1.0
    coupling, step, more = 0.4e-6, 1e-9, 1e-3
    found = share(c, e, load, coupling)
    by_separation, by_load = slopes(c, found.forces, coupling)
    clear = ((found.gaps > 1e-7) | (found.forces > 1.0)).all(axis=1) & (load > 100.0)
    assert clear.sum() > 80
    for k in range(3):
        moved = e + step * np.eye(3)[k]
        slope = (share(c, moved, load, coupling).approach - found.approach) / step
        assert slope[clear] == pytest.approx(by_separation[clear, k], abs=1e-6)
    slope = (share(c, e, load + more, coupling).approach - found.approach) / more
    assert slope[clear] == pytest.approx(by_load[clear], rel=1e-5)
    assert by_separation.sum(axis=1) == pytest.approx(1.0, rel=1e-12)


def test_no_load_leaves_the_kinematic_error():
    """The least separation; no pair is said to be in contact, nor below 1e-9 of the design load."""
    found = share([3e-6, 4e-6], [2e-3, 5e-3], 0.0)
    assert found.approach == 2e-3 and found.forces.sum() == 0.0 and found.gaps[1] == 3e-3
    assert not in_contact(found.forces, LOAD).any()
    least = share([3e-6, 4e-6], [0.0, 0.0], 1e-6 * LOAD).forces
    assert in_contact(least, LOAD).all() and not in_contact(1e-3 * least, LOAD).any()


def test_huge_separations_keep_the_equilibrium():
    """Relief of a metre on every pair: what counts are the differences."""
    found = share([3e-6, 4e-6], [1000.0, 1000.0 + 2**-10], 5000.0)
    assert found.forces.sum() == pytest.approx(5000.0, rel=1e-12)
    assert found.forces[0] == pytest.approx((4e-6 * 5000.0 + 2**-10) / 7e-6, rel=1e-12)


def test_what_has_no_answer():
    """No pair on the path: an infinite approach; numbers outside the range: an error."""
    nowhere = share([3e-6, 3e-6], [np.inf, np.inf], 100.0)
    assert np.isinf(nowhere.approach) and nowhere.forces.sum() == 0.0
    for c, e, load, coupling in (
        ([3e-6], [0.0], -1.0, 0.0),
        ([3e-6], [0.0], np.nan, 0.0),
        ([3e-6], [np.nan], 1.0, 0.0),
        ([3e-6], [0.0], 1.0, 4e-6),
    ):
        with pytest.raises(ValueError, match=r"load|compliance"):
            share(c, e, load, coupling)
