"""Teeth of a stage: helix, tools and shifts of its own, and what takes no shifts that add up."""

import math
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import pytest
from small_drives import drive

from gearopt.errors import SolveError
from gearopt.formulations.drive import continuous_sizing, sizing_text, teeth
from gearopt.formulations.drive import processes as process
from gearopt.formulations.drive.design import describe
from gearopt.formulations.drive.gearbox import Gearbox, Shaft
from gearopt.formulations.drive.processes import ProcessTwo
from gearopt.formulations.drive.together.tables import numbers
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.solve import run
from gearopt.physics.gears import ISO_53_A, Rack

F = Fraction
TOOLS = (Rack(math.radians(25.0), 1.0, 1.35, 0.3), Rack(math.radians(25.0), 0.9, 1.25, 0.2))
OTHER = Toothing(0.3, TOOLS, (0.5, 0.1), (-0.1, 0.0), (-0.05, -0.1), 250.0)


def with_toothing(train, *toothings):
    rows = zip(train.stages, toothings, strict=True)
    return replace(train, stages=tuple(replace(s, toothings=(t,)) for s, t in rows))


def test_shifts_and_tools_change_no_load_volume_or_mass():
    plain = Toothing(0.3).pair(2.0, 20, 61, 30.0)
    other = OTHER.pair(2.0, 20, 61, 30.0)
    assert other.volume == plain.volume
    masses = [[gear.mass(1e-8) for gear in pair.gears] for pair in (plain, other)]
    assert masses[0] == masses[1]
    assert K_FACTOR.indices(other, 1e5, 3.0) == K_FACTOR.indices(plain, 1e5, 3.0)
    assert (other.centre_distance, other.pinion.rack, other.wheel.rack) == (250.0, *TOOLS)


def test_every_stage_has_its_own_helix_in_every_formulation():
    """d = m z/cos(beta) of that stage, in the text of real-valued sizes and of whole teeth."""
    train = with_toothing(drive(2, "tied", F(9)), Toothing(0.4), Toothing(0.1))
    problem = teeth.problem(train)
    result, outcome = run(problem)
    assert result.status == "optimal"
    pairs = teeth.pairs(train, outcome.x)
    for pair, angle in zip(pairs, (0.4, 0.1), strict=True):
        d = pair.normal_module * pair.pinion_teeth / math.cos(angle)
        assert pair.pinion.reference_diameter == pytest.approx(d, rel=1e-15)
        assert pair.face_width == pytest.approx(0.6 * d, rel=1e-15)
    lower, relaxed = run(continuous_sizing.problem(train))
    assert lower.status == "optimal" and lower.bound <= result.value
    text = sizing_text.terms(
        train, SimpleNamespace(**train.numbers()), sizing_text.pairs(train, relaxed.x)
    )
    assert text.minimise["gear_volume"] == pytest.approx(lower.value, rel=1e-9)


def test_a_shifted_pair_is_described_by_its_own_geometry():
    """Spur, m = 2 mm, z = 12 and 40, x = 0.5 and 0: by hand with ISO 21771.

    inv(alpha_w) = inv(20 deg) + 2 tan(20 deg) 0.5/52 = 0.0149044 + 0.0069994 = 0.0219038, so
    alpha_w = 22.6292 deg and a = 52 cos(20 deg)/cos(22.6292 deg) = 52.9396 mm.
    """
    train = with_toothing(drive(1, "tied", F(10, 3)), Toothing(profile_shifts=(0.5, 0.0)))
    (stage,) = describe(train, (train.pair(0, 2.0, 12, 40, 20.0),)).stages
    assert (stage.pinion_diameter_mm, stage.wheel_diameter_mm) == pytest.approx((24.0, 80.0))
    assert stage.pinion_tip_diameter_mm == pytest.approx(30.0)
    assert stage.pinion_root_diameter_mm == pytest.approx(21.0)
    assert (stage.wheel_tip_diameter_mm, stage.wheel_root_diameter_mm) == pytest.approx((84, 75))
    assert stage.centre_distance_mm == pytest.approx(52.9396, abs=1e-4)
    assert stage.working_pressure_angle_deg == pytest.approx(22.6292, abs=1e-4)
    assert (stage.pinion_profile_shift, stage.wheel_profile_shift) == (0.5, 0.0)


def test_what_lies_on_reference_circles():
    assert Toothing(0.3, profile_shifts=(0.3, -0.3)).on_reference
    assert not Toothing(profile_shifts=(0.3, -0.2)).on_reference
    assert not Toothing(working_distance=100.0).on_reference
    shifted = Toothing(0.3, profile_shifts=(0.3, -0.3)).pair(2.0, 20, 61, 30.0)
    assert shifted.centre_distance == shifted.reference_distance


@pytest.mark.parametrize("objective", ["sum_of_centre_distances", "total_length"])
def test_lengths_need_shifts_that_cancel(objective):
    train = drive(2, "tied", F(9), objective=objective)
    with_toothing(train, Toothing(), Toothing(profile_shifts=(0.2, -0.2)))
    for other in (Toothing(profile_shifts=(0.2, 0.0)), Toothing(working_distance=90.0)):
        with pytest.raises(ValueError, match=f"the objective {objective} needs profile shifts"):
            with_toothing(train, Toothing(), other)


def test_process_two_and_layouts_at_once_need_shifts_that_cancel():
    train = with_toothing(drive(1, "tied", F(4)), Toothing(profile_shifts=(0.2, 0.0)))
    two = process.methods(train, two=ProcessTwo(100.0, (F(4),), (20,)))["process-two"]
    with pytest.raises(SolveError, match="profile shifts that cancel in every stage"):
        two(teeth.problem(train), None, 0, None)
    with pytest.raises(SolveError, match="needs profile shifts that cancel"):
        numbers(train, lambda pairs: Gearbox(pairs, (Shaft(5.0), Shaft(8.0))))


def test_angles_that_no_stage_has_are_refused():
    with pytest.raises(ValueError, match="below 60 degrees"):
        Toothing(math.radians(60.0))
    with pytest.raises(ValueError, match="one normal pressure angle"):
        Toothing(racks=(ISO_53_A, TOOLS[0]))
