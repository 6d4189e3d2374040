"""Contact lines of helical pairs: their closed form against lines that are cut by hand."""

import numpy as np
import pytest

from gearopt.physics.contact_lines import Face, length_range, mean_length
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import usable_path
from gearopt.physics.slice_sharing import Springs, share_slices


def pair_of(rng):
    teeth = int(rng.integers(18, 30)), int(rng.integers(30, 60))
    return GearPair.of_teeth(3.0, *teeth, rng.uniform(10, 60), rng.uniform(0.05, 0.5))


def cut(pair, path, travel):
    """Length of all lines x = x0 + k p + y tan(beta_b) in the rectangle of the plane of action."""
    beta = np.arcsin(np.sin(pair.pinion.helix_angle) * np.cos(pair.pinion.rack.pressure_angle))
    slope, half, total = np.tan(beta), 0.5 * pair.face_width, 0.0
    for k in range(-20, 21):
        at = path.start - slope * half + (travel + k) * path.base_pitch
        low = max(-half, (path.start - at) / slope)
        high = min(half, (path.end - at) / slope)
        total += max(high - low, 0.0) / np.cos(beta)
    return total


def test_slices_have_the_length_of_the_lines_whatever_their_number():
    rng = np.random.default_rng(1)
    for count in (1, 2, 7, 41):
        pair = pair_of(rng)
        path, face = usable_path(pair), Face.of(pair, count)
        cycle = face.cycle(path, 17)
        part, _ = face.parts(path, cycle.positions)
        length = part.sum(axis=(-2, -1)) * face.slice_width * np.hypot(1.0, face.slope)
        by_hand = [cut(pair, path, travel) for travel in cycle.travels]
        assert length == pytest.approx(by_hand, rel=1e-9)


def test_least_mean_and_largest_length_are_closed_forms():
    """And the least is that of a public text on helical pairs: 1 - f_a f_b/(eps_a eps_b)."""
    rng = np.random.default_rng(2)
    for k in range(20):
        pair = pair_of(rng)
        path = usable_path(pair)
        alpha, beta = float(path.transverse_ratio), float(pair.overlap_ratio)
        corners = [0.0, alpha % 1.0, beta % 1.0, (alpha + beta) % 1.0]
        lengths = [cut(pair, path, travel) for travel in corners]
        mean = mean_length(pair, path)
        low, high = length_range(alpha, beta)
        assert [low * mean, high * mean] == pytest.approx([min(lengths), max(lengths)], rel=1e-9)
        if k < 3:
            travels = (np.arange(2000) + 0.5) / 2000
            numbers = [cut(pair, path, t) for t in travels]
            assert np.mean(numbers) == pytest.approx(mean, rel=1e-5)


def test_no_fluctuation_where_a_contact_ratio_is_whole():
    assert length_range(1.6, 2.0) == pytest.approx((1.0, 1.0), abs=1e-12)
    assert length_range(2.0, 0.7) == pytest.approx((1.0, 1.0), abs=1e-12)
    assert length_range(1.5, 0.5) == pytest.approx((1 - 0.25 / 0.75, 1 + 0.25 / 0.75))


def test_stiffness_in_proportion_to_the_lines_is_shared_by_their_length():
    """Without tooth, body and coupling the approach is q W/(L cos(beta_b)): closed form."""
    pair = GearPair.of_teeth(3.0, 25, 50, 24.0, np.radians(12.0))
    path, face, soft, load = usable_path(pair), Face.of(pair, 15), 5e-5, 6000.0
    cycle = face.cycle(path, 20)
    part, at = face.parts(path, cycle.positions)
    there = part > 1e-9
    contacts = soft / (np.where(there, part, 1.0) * face.slice_width)
    stiff = np.full(at.shape, 1e15)
    springs = Springs(contacts, stiff, np.zeros((*at.shape[:-1], face.count - 1)), 0.0)
    shared = share_slices(springs, np.where(there, 0.0, np.inf), load)
    lines = np.array([cut(pair, path, travel) for travel in cycle.travels])
    cosine = 1.0 / np.hypot(1.0, face.slope)
    assert shared.approach == pytest.approx(soft * load / (lines * cosine), rel=1e-7)
