"""Mesh positions: every pair at once, break points from both sides."""

import numpy as np
import pytest

from gearopt.physics.geometry.contact import ContactPath
from gearopt.physics.load_sharing import share
from gearopt.physics.mesh_cycle import break_points, cycle


def path_of(ratio, pitch=10.0):
    """A path of contact with a contact ratio, from -4 mm."""
    return ContactPath(-4.0, -4.0 + ratio * pitch, pitch, (20.0, 40.0))


@pytest.mark.parametrize("ratio", [1.0, 1.2, 1.683, 1.999, 2.0, 2.001, 2.4, 3.0, 3.7])
def test_pairs_are_a_base_pitch_apart_and_all_of_them_are_there(ratio):
    """At travel t the pairs are the positions start + (t + k) p_b within the path."""
    path = path_of(ratio)
    found = cycle(path, 48)
    assert (np.diff(found.travels) >= 0.0).all() and found.travels[-1] == 1.0
    for travel, row in zip(found.travels, found.positions, strict=True):
        inside = row[~np.isnan(row)]
        assert len(inside) in (int(ratio), int(ratio) + 1)
        assert inside == pytest.approx(-4.0 + 10.0 * (travel + np.arange(len(inside))), abs=1e-9)
        assert inside.max() <= path.end and inside.min() >= path.start


@pytest.mark.parametrize("ratio", [1.2, 1.683, 1.999, 2.001, 2.4])
def test_both_sides_of_break_points(ratio):
    """With n and with n + 1 pairs at the travel at which a pair comes, and at which one leaves."""
    found, whole = cycle(path_of(ratio), 7), int(ratio)
    pairs = found.present.sum(axis=1)
    leaves = np.abs(found.travels - (ratio - whole)) < 1e-12
    assert sorted(pairs[leaves]) == [whole, whole + 1]
    assert (found.travels[0], pairs[0]) == (0.0, whole + 1)  # SAP+: it has come
    assert (found.travels[-1], pairs[-1]) == (1.0, whole)  # SAP-: the next one has not
    met = found.along(found.positions)
    assert (np.diff(met) >= -1e-12).all() and (met[0], met[-1]) == (-4.0, found.path.end)
    twice = met[:-1][np.diff(met) < 1e-12]  # inner break points are there from both sides
    inner = list(break_points(found.path).values())[1:-1]
    assert twice == pytest.approx(inner, abs=1e-9)


def test_names_of_break_points():
    """As a textbook has them below a contact ratio of 2."""
    assert break_points(path_of(1.6)) == pytest.approx(
        {"SAP": -4.0, "LPSTC": 2.0, "HPSTC": 6.0, "EAP": 12.0}
    )
    assert list(break_points(path_of(2.4))) == [
        "SAP",
        "EAP - 2 p_b",
        "SAP + 1 p_b",
        "EAP - 1 p_b",
        "SAP + 2 p_b",
        "EAP",
    ]


def test_a_narrow_single_zone_is_not_missed():
    """Contact ratio 1.999: a thousandth of a base pitch with one pair doubles the range."""

    def peak_to_peak(ratio, steps, exact):
        found = cycle(path_of(ratio), steps, exact)
        separations = found.separations(np.zeros_like)
        return np.ptp(share(3e-6, separations, 5000.0).approach)

    assert peak_to_peak(1.999, 400, False) == pytest.approx(0.0, abs=1e-15)
    assert peak_to_peak(1.999, 48, True) == pytest.approx(0.5 * 3e-6 * 5000.0)  # one pair, two
    assert peak_to_peak(2.001, 48, True) == pytest.approx(3e-6 * 5000.0 / 6.0)  # two, three
    assert peak_to_peak(2.0, 48, True) == pytest.approx(0.0, abs=1e-15)


def test_no_continuous_contact():
    """Below a contact ratio of 1 a pair leaves before the next one comes."""
    with pytest.raises(ValueError, match="no continuous contact"):
        cycle(path_of(0.95))
    grid = cycle(path_of(1.683), 48, exact=False)
    assert len(grid.travels) == 48 and grid.present.sum() == 81
