"""The cutter of a flexspline for its report: points, edges that replace it, least teeth."""

import math
from typing import Annotated, Any

import numpy as np

from gearopt.formulations.strain_wave.cutter_fit import arc_edge, arc_of_cones, straight_edge
from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown
from gearopt.physics.strain_wave.cutter import Profile, envelope, generated, least_teeth
from gearopt.physics.strain_wave.gearing import StrainWave
from gearopt.physics.strain_wave.vectors import Vector

Columns = tuple[float, ...]
EDGE = "points of the cutting edge"
CUT, CUT_CLEARANCE = "flank as cut", "clearance of the teeth as cut"
CONJUGATE, DEFORMED, MODIFIED = "conjugate", "deformed blank", "modified involute"  # generations
POINTS = 51  # of the cutter's edge that are told
USUAL = math.radians(20.0)  # pressure angle of usual tools


@dataclass(frozen=True)
class Cutter:
    """The cutter that is asked for: a pinion-type cutter or a rack, and what may replace its edge.

    teeth Z_b, 0: a rack; pitch_radius P_f of the blank [mm], 0: m z_f/2. angle [rad]: of a straight
    tool that is there, beside the best one, or of a straight-sided hob, 0: the pressure angle.
    least_radius [mm]: of an arc that replaces the edge, 0: any. replaced: whether a line and an arc
    that replace it are sought. generation: by an edge that is conjugate, or by a straight-sided hob
    on the deformed or on the round blank, whose involute has a tip relief [mm].
    """

    teeth: int = 0
    pitch_radius: float = 0.0
    angle: float = USUAL
    least_radius: float = 0.0
    replaced: bool = True
    generation: str = CONJUGATE
    relief: float = 0.0


@dataclass(frozen=True, kw_only=True)
class ToothForm:
    """Teeth of one form in mesh. deviation: how far they lie within conjugate ones at most.

    play: of one side without load, normal to the flanks. at_ends: the part of the load that teeth
    carry at an end of their flank [%]. shared_pressure: None where the tooth of the largest load
    mostly does.
    """

    deviation_mm: Annotated[float, Shown("largest deviation", unit="um")]
    least_clearance_mm: Annotated[float, Shown("least clearance", unit="um")]
    play_mm: Annotated[float, Shown("play", unit="um")]
    near: Annotated[float, Shown("teeth within 1 µm")]
    nearby: Annotated[float, Shown("teeth within 5 µm")]
    carrying_teeth: Annotated[int, Shown("teeth that carry")]
    effective_teeth: Annotated[float, Shown("equally loaded")]
    windup_mrad: Annotated[float, Shown("windup, mrad")]
    at_ends: Annotated[float, Shown("load at ends of flanks, %", form=".0f")]
    shared_pressure_MPa: Annotated[float | None, Shown("contact pressure")]


@dataclass(frozen=True, kw_only=True)
class CutterDesign:
    """The edge of a cutter, its points from the flank's root to its tip.

    x from the pitch line of a rack, or the centre of a pinion-type cutter, away from the blank; y
    across, half the space for the blank's tooth. speed: least speed along the edge over that along
    the flank; not regular where it is not above 0: then nothing else is told. straight,
    arc: edges of least largest deviation, the arc of least_radius at least; given: an edge at the
    tool's angle. Of a straight-sided hob x is from its reference line, which is reference_radius
    from the blank's axis; cut: the flank as it is cut; forms: conjugate teeth and those as cut.
    """

    generation: str = CONJUGATE
    teeth: int = 0
    pitch_radius_mm: float
    cutter_radius_mm: float = 0.0
    regular: bool
    least_speed: float
    least_teeth: int | None = None
    x_mm: Annotated[Columns, Shown("x", EDGE)] = ()
    y_mm: Annotated[Columns, Shown("y", EDGE)] = ()
    round_trip_mm: float = 0.0
    straight_deg: float = 0.0
    straight_deviation_mm: float = 0.0
    arc_radius_mm: float = 0.0
    arc_deviation_mm: float = 0.0
    least_radius_mm: float = 0.0
    given_deg: float = 0.0
    given_deviation_mm: float = 0.0
    tip_relief_mm: float = 0.0
    reference_radius_mm: float = 0.0
    cut_height_mm: Annotated[Columns, Shown("height over the neutral curve", CUT)] = ()
    cut_half_mm: Annotated[Columns, Shown("half thickness", CUT)] = ()
    cut_within_mm: Annotated[Columns, Shown("within the conjugate flank", CUT, "um", ".4f")] = ()
    cut_wave_deg: Annotated[Columns, Shown("on the wave", CUT_CLEARANCE, form=".4f")] = ()
    cut_clearance_mm: Annotated[Columns, Shown("clearance", CUT_CLEARANCE, "um")] = ()
    forms: tuple[ToothForm, ...] = ()


def cutter_of(gearing: StrainWave, blank: Profile, asked: Cutter) -> CutterDesign:
    """Return the cutter of a blank's flank; an irregular one with the least regular teeth."""
    pitch = asked.pitch_radius or float(gearing.blank_radius)
    radius = pitch * asked.teeth / float(gearing.teeth) if asked.teeth else math.inf
    edge_curve = envelope(blank, pitch, radius)
    slowest = float(np.nan_to_num(edge_curve.speeds, nan=-1e9).min())
    head: dict[str, Any] = {
        "teeth": asked.teeth,
        "pitch_radius_mm": pitch,
        "cutter_radius_mm": radius if asked.teeth else 0.0,
        "regular": edge_curve.regular,
        "least_speed": slowest,
        "least_teeth": least_teeth(blank, pitch, int(gearing.teeth)),
    }
    if not edge_curve.regular:
        return CutterDesign(**head)
    back = (generated(edge_curve.profile, pitch, radius) - blank.points).length
    pick = np.rint(np.linspace(0, len(back) - 1, POINTS)).astype(int)
    edge = edge_curve.profile.points[pick]
    return CutterDesign(
        **head,
        x_mm=tuple(map(float, edge.x)),
        y_mm=tuple(map(float, edge.y)),
        round_trip_mm=float(back.max()),
        **(_replacements(edge, asked) if asked.replaced else {}),
    )


def _replacements(edge: Vector, asked: Cutter) -> dict[str, Any]:
    """Return line and arc of least deviation from an edge, and the line at the tool's angle."""
    line, arc, given = straight_edge(edge), arc_edge(edge), straight_edge(edge, asked.angle)
    if arc.radius < asked.least_radius:
        arc = arc_of_cones(edge, arc, asked.least_radius)
    return {
        "straight_deg": math.degrees(line.angle),
        "straight_deviation_mm": line.deviation,
        "arc_radius_mm": arc.radius,
        "arc_deviation_mm": arc.deviation,
        "least_radius_mm": asked.least_radius,
        "given_deg": math.degrees(asked.angle),
        "given_deviation_mm": given.deviation,
    }
