"""The data block of a gear drawing: what a maker cuts and measures, gear by gear, mesh by mesh.

Fields are keys of a result, with their units; a list is a table. Numbers of a ring are above 0. The
ends "upper" and "lower" are those of the allowances of the tooth thickness.
"""

from typing import Annotated

from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown

EXACT = ".3f"  # of lengths that are measured


@dataclass(frozen=True, kw_only=True)
class GearData:
    """One gear: teeth, tool, circles, thickness and what measures it, tolerances, material.

    generating shifts: of the tool, at both allowances. form circle: where the involute that the
    tool cuts begins, at the upper allowance. Chord: at the reference circle. Span and balls: of
    what touches the flanks; pins: of helical teeth of odd number alone, where they differ from
    balls. tip relief: amount, and the diameter where it starts, where that is known.
    """

    stage: Annotated[int, Shown("stage")]
    gear: str
    mate: Annotated[str, Shown("mates")]
    teeth: Annotated[float, Shown("teeth z")]
    normal_module_mm: Annotated[float, Shown("normal module m_n")]
    pressure_angle_deg: Annotated[float, Shown("normal pressure angle α_n")]
    helix_angle_deg: Annotated[float, Shown("helix angle β")]
    hand: Annotated[str, Shown("hand of the helix")]
    profile_shift: Annotated[float, Shown("profile shift x", form=".4f")]
    upper_generating_shift: Annotated[float, Shown("generating shift x_Ee", form=".4f")]
    lower_generating_shift: Annotated[float, Shown("generating shift x_Ei", form=".4f")]
    face_width_mm: Annotated[float, Shown("face width b")]
    tool: Annotated[str, Shown("tool: h_aP0/ρ_aP0, m_n")]
    reference_diameter_mm: Annotated[float, Shown("reference diameter d", form=EXACT)]
    base_diameter_mm: Annotated[float, Shown("base diameter d_b", form=EXACT)]
    tip_diameter_mm: Annotated[float, Shown("tip diameter d_a", form=EXACT)]
    tip_form_diameter_mm: Annotated[float | None, Shown("tip form diameter d_Fa", form=EXACT)]
    form_diameter_mm: Annotated[float, Shown("root form diameter d_Ff", form=EXACT)]
    root_diameter_mm: Annotated[float, Shown("root diameter d_f, nominal", form=EXACT)]
    upper_root_diameter_mm: Annotated[float, Shown("root diameter d_fE at A_sne", form=EXACT)]
    lower_root_diameter_mm: Annotated[float, Shown("root diameter d_fE at A_sni", form=EXACT)]
    tooth_thickness_mm: Annotated[float, Shown("normal tooth thickness s_n", form=EXACT)]
    allowances: Annotated[str, Shown("allowances by")]
    upper_allowance_mm: Annotated[float, Shown("upper allowance A_sne", unit="um")]
    lower_allowance_mm: Annotated[float, Shown("lower allowance A_sni", unit="um")]
    chord_mm: Annotated[float, Shown("chordal thickness, nominal", form=EXACT)]
    chord_height_mm: Annotated[float, Shown("height above the chord", form=EXACT)]
    span_teeth: Annotated[int | None, Shown("teeth spanned k")] = None
    span_mm: Annotated[float | None, Shown("span W_k, nominal", form=EXACT)] = None
    upper_span_mm: Annotated[float | None, Shown("span W_ke at A_sne", form=EXACT)] = None
    lower_span_mm: Annotated[float | None, Shown("span W_ki at A_sni", form=EXACT)] = None
    ball_diameter_mm: Annotated[float | None, Shown("ball diameter D_M", form=EXACT)] = None
    over_balls_mm: Annotated[float | None, Shown("over balls M_dK, nominal", form=EXACT)] = None
    upper_over_balls_mm: Annotated[float | None, Shown("M_dKe at A_sne", form=EXACT)] = None
    lower_over_balls_mm: Annotated[float | None, Shown("M_dKi at A_sni", form=EXACT)] = None
    upper_over_pins_mm: Annotated[float | None, Shown("over pins M_dRe", form=EXACT)] = None
    lower_over_pins_mm: Annotated[float | None, Shown("over pins M_dRi", form=EXACT)] = None
    tolerances: Annotated[str, Shown("tolerances by")]
    single_pitch_mm: Annotated[float, Shown("single pitch f_pt", unit="um")]
    total_pitch_mm: Annotated[float, Shown("total cumulative pitch F_p", unit="um")]
    total_profile_mm: Annotated[float, Shown("total profile F_α", unit="um")]
    profile_form_mm: Annotated[float, Shown("profile form f_fα", unit="um")]
    profile_slope_mm: Annotated[float, Shown("profile slope f_Hα", unit="um")]
    total_helix_mm: Annotated[float, Shown("total helix F_β", unit="um")]
    helix_form_mm: Annotated[float, Shown("helix form f_fβ", unit="um")]
    helix_slope_mm: Annotated[float, Shown("helix slope f_Hβ", unit="um")]
    runout_mm: Annotated[float, Shown("runout F_r", unit="um")]
    tip_relief_mm: Annotated[float | None, Shown("tip relief C_a", unit="um")] = None
    relief_diameter_mm: Annotated[float | None, Shown("relief starts at", form=EXACT)] = None
    material: Annotated[str, Shown("material and hardness")] = ""


@dataclass(frozen=True, kw_only=True)
class MeshData:
    """One mesh: centre distance with its allowances, and the range of backlash that follows.

    Backlash: circumferential at the working pitch circles, and normal along the line of action.
    """

    mesh: str
    centre_distance_mm: Annotated[float, Shown("centre distance a", form=EXACT)]
    distance_allowances: Annotated[str, Shown("its allowances by")]
    lower_distance_allowance_mm: Annotated[float, Shown("lower allowance A_ai", unit="um")]
    upper_distance_allowance_mm: Annotated[float, Shown("upper allowance A_ae", unit="um")]
    least_backlash_mm: Annotated[float, Shown("least backlash j_wt", form=EXACT)]
    largest_backlash_mm: Annotated[float, Shown("largest backlash j_wt", form=EXACT)]
    least_normal_backlash_mm: Annotated[float, Shown("least normal backlash j_bn", form=EXACT)]
    largest_normal_backlash_mm: Annotated[float, Shown("largest normal backlash j_bn", form=EXACT)]


@dataclass(frozen=True, kw_only=True)
class DrawingData:
    """Data of the drawing of every gear and mesh; unverified: what no second source has."""

    gears: tuple[GearData, ...]
    meshes: tuple[MeshData, ...]
    unverified: tuple[str, ...] = ()
