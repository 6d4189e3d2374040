"""What an internal pair needs beside its strength: margins by name, as the field calls the limits.

Margins are in normal modules, of contact ratios their excess, and negative where a limit is broken.
They are floats, or arrays of pairs whose numbers are arrays, without NaN: minus infinity where a
pair or a cut has no centre distance, or a member no involute, of which margins of their own tell.
Lengths here are positive, and so are the teeth of the ring.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import Gear, GearPair
from gearopt.physics.geometry.contact import contact_path, curvature_at
from gearopt.physics.geometry.cutter import cutter_tip, reference_and_base
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.involute import involute, shift_sum
from gearopt.physics.geometry.tooth import circumferential_backlash, tip_clearances, tip_thickness


@dataclass(frozen=True)
class Engagement:
    """A pinion, or a cutter, within a ring: radii of tips and base circles [mm], both members.

    distance a [mm]; angle: alpha_wt [rad]; play: half the backlash as an angle of the ring [rad].
    """

    tips: tuple[Any, Any]
    bases: tuple[Any, Any]
    distance: Any
    angle: Any
    play: Any = 0.0

    def ring_tip(self, tip: Any) -> Any:
        """Return the angle of the ring's tip [rad] while the pinion's tip behind it is at an angle.

        (z1/z2) (tip + inv(alpha_a1) - inv(alpha_wt)) + inv(alpha_wt) - inv(alpha_a2): the flanks
        of both touch. Angles at both centres, from the line of centres.
        """
        rows = zip(self.tips, self.bases, strict=True)
        first, second = (involute(np.arccos(np.minimum(base / top, 1.0))) for top, base in rows)
        working, share = involute(self.angle), self.bases[0] / self.bases[1]
        return (tip + first - working) * share + working - second

    @property
    def crossing(self) -> Any:
        """Angle at the pinion's centre of the point where the tip circles cross [rad]."""
        (first, second), a = self.tips, self.distance
        return np.arccos(np.clip((second**2 - first**2 - a**2) / (2.0 * a * first), -1.0, 1.0))


def trochoidal_clearance(mesh: Engagement) -> Any:
    """How far the tips pass each other [mm] at the ring's tip circle, as they leave mesh.

    r_a2 (`ring_tip`(theta_1) - theta_2), theta: angles of the crossing of the tip circles at both
    centres. Negative: trochoidal interference, or fouling. Source: SDP/SI, Elements of Metric Gear
    Technology, eqs. (5-6) and (5-7); derived as well.
    """
    (first, second), a, corner = mesh.tips, mesh.distance, mesh.crossing
    at = np.arctan2(first * np.sin(corner), a + first * np.cos(corner))
    return second * (mesh.ring_tip(corner) - at)


@np.errstate(invalid="ignore", divide="ignore")
def radial_clearance(mesh: Engagement) -> Any:
    """Return the least distance [mm] of tips while the pinion is put in along the line of centres.

    sin(theta_1)^2 = (1 - k^2)/(1 - (z1/z2)^2), k = cos(alpha_a1)/cos(alpha_a2), up to the crossing
    of the tip circles; sin(theta_2) = r_a1/r_a2 sin(theta_1): where tips would touch first. As
    `trochoidal_clearance` with these angles, and half the backlash. Negative: the pinion, or the
    cutter, fits in axially only (trimming interference). Source: the same, eqs. (5-9) and (5-10).
    """
    (first, second), (b1, b2) = mesh.tips, mesh.bases
    share = (1.0 - (b1 / first * second / b2) ** 2) / (1.0 - (b1 / b2) ** 2)
    corner = np.minimum(np.arcsin(np.sqrt(np.clip(share, 0.0, 1.0))), mesh.crossing)
    at = np.arcsin(np.minimum(first * np.sin(corner) / second, 1.0))
    return second * (mesh.ring_tip(corner) + mesh.play - at)


def engagement(pair: GearPair) -> Engagement:
    """The numbers of an internal pair, its tips as they are without chamfers."""
    first, second = pair.gears
    return Engagement(
        (0.5 * first.tip_diameter, -0.5 * second.tip_diameter),
        (0.5 * first.base_diameter, -0.5 * second.base_diameter),
        -pair.centre_distance,
        pair.working_angle,
        -circumferential_backlash(pair) / pair.working_diameters[1],
    )


def cutting(ring: Gear) -> Engagement:
    """The numbers of a ring and its cutter, of sharp tips, at the end of the cut."""
    working, distance = ring.cutting(ring.generating_shift)
    tips = 0.5 * ring.cutter_tip_diameter, -0.5 * ring.tip_diameter
    bases = reference_and_base(ring)[1], -0.5 * ring.base_diameter
    return Engagement(tips, bases, -distance, working)


@np.errstate(invalid="ignore", divide="ignore")
def margins(pair: GearPair) -> dict[str, Any]:
    """Margins of an internal pair by name, as of a contact ratio of 1; of members named 0 and 1.

    Interference is measured in radii of curvature: of the involute from its end at the base circle
    to the mate's tip, of fillets from the form circle to there. With tip clearances below 0.1 the
    corners of tips may still touch fillets, by thousandths (`flaws.tip_intrusion`).
    """
    module, path, (pinion, ring) = pair.normal_module, contact_path(pair), pair.gears
    ends = path.root_curvatures
    fillets = [
        end - curvature_at(gear, form_diameter(gear), 0.0)
        for end, gear in zip(ends, pair.gears, strict=True)
    ]
    mesh, clear = engagement(pair), tip_clearances(pair)
    of_mesh = {
        "contact_ratio": (path.transverse_ratio - 1.0) * module,
        "involute_interference": ends[0],
        "trochoidal_interference": trochoidal_clearance(mesh),
        "radial_assembly": radial_clearance(mesh),
        "fillet_interference0": fillets[0],
        "fillet_interference1": np.where(np.isnan(fillets[1]), -np.inf, fillets[1]),  # no cut
        "tip_clearance0": np.where(np.isnan(ring.root_diameter), -np.inf, clear[0]),  # no cut
        "tip_clearance1": clear[1],
    }
    above = [
        0.5 * (pinion.active_tip_diameter - pinion.base_diameter),
        0.5 * (ring.base_diameter - ring.active_tip_diameter),
    ]
    distance = _distance(pair)
    has_mesh = np.isfinite(pair.working_angle) & (np.minimum(*above) >= 0.0)
    left = {name: np.where(has_mesh, each, -np.inf) for name, each in of_mesh.items()}
    left["centre_distance"] = distance
    for k, gear in enumerate(pair.gears):
        left[f"involute{k}"] = above[k]
        left[f"tip_thickness{k}"] = np.where(above[k] >= 0.0, tip_thickness(gear), -np.inf)
    left |= _of_cutter(ring) if ring.cutter is not None else {}
    return {name: (each / module)[()] for name, each in left.items()}


def _distance(pair: GearPair) -> Any:
    """How far the pair is from having no line of action [mm], as distance or in shifts."""
    angle, given = pair.pinion.transverse_pressure_angle, pair.working_distance
    if given is not None:
        return pair.reference_distance * np.cos(angle) - given
    shifts = pair.pinion.profile_shift + pair.wheel.profile_shift
    return _shifts_left(pair.pinion, pair.pinion_teeth + pair.wheel_teeth, shifts)


def _shifts_left(gear: Gear, teeth: Any, shifts: Any) -> Any:
    """By how much [mm] a sum of shifts is less than that of a working angle of 0."""
    largest = shift_sum(0.0, teeth, gear.rack.pressure_angle, gear.transverse_pressure_angle)
    return (largest - shifts) * gear.normal_module


def _of_cutter(ring: Gear) -> dict[str, Any]:
    """Return the margins [mm] of a ring and its cutter.

    overcut: of the ring's tips by the end of the cutter's involute at its base circle, and by its
    tips as they leave the cut; infeed: the cutter is fed in radially.
    """
    assert ring.cutter is not None
    mesh, tip = cutting(ring), cutter_tip(ring)
    reach = -curvature_at(ring, ring.tip_diameter, 0.0)
    shifts = ring.generating_shift + ring.cutter.profile_shift
    of_cut = {
        "cutter_involute": reach - mesh.distance * np.sin(mesh.angle),
        "cutter_overcut": trochoidal_clearance(mesh),
        "cutter_infeed": radial_clearance(mesh),
    }
    left = {name: np.where(np.isfinite(mesh.angle), each, -np.inf) for name, each in of_cut.items()}
    left["cutter_distance"] = _shifts_left(ring, ring.teeth + ring.cutter.teeth, shifts)
    left["cutter_tip"] = np.where(np.isfinite(tip.angle), tip.angle * tip.centre, -np.inf)
    return left
