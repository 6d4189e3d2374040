"""Keys that a gear engineer expects: what stands nearest to those that no kind knows yet.

A key is found by its name in any table of a file, also where another table has a key of that name
with another meaning, as the deviation `centre_distance` of a servo train's [[mesh]].
"""

from gearopt.scenes.reading.absent import looked_up

FACTORS = "service_factor load_factor betriebsfaktor"
MATERIAL = (
    "material materials pinion_material wheel_material gear_material steel hardness werkstoff "
    "surface_hardness heat_treatment yield_strength tensile_strength haerte"
)
SAFETY = (
    "safety_factor safety_factors safety s_h s_f minimum_safety contact_safety bending_safety "
    "safety_factor_contact safety_factor_bending required_safety sicherheit sicherheiten"
)
STRESS = (
    "allowable_stress allowable_stresses contact_stress hertz_stress hertzian_stress sigma_h "
    "sigma_f tooth_root_stress root_stress hertzian_pressure contact_pressure "
    "allowable_bending_stress allowable_contact_stress zulaessige_spannung hertz"
)
STRENGTH = "sigma_hlim sigma_flim sigma_h_lim sigma_f_lim endurance_limit"
CENTRES = (
    "centre_distance center_distance centre_distances center_distances axis_distance "
    "shaft_distance achsabstand maximum_centre_distance maximum_center_distance"
)
SHIFT = (
    "profile_shift profile_shifts profile_shift_coefficient profile_shift_coefficients "
    "addendum_modification x1 x2"
)
QUALITY = (
    "quality accuracy grade gear_quality accuracy_grade quality_grade iso_grade agma_quality "
    "iso_quality_grade din_quality verzahnungsqualitaet qualitaet flankenqualitaet"
)
OIL = (
    "lubricant lubrication oil viscosity oil_temperature temperature schmierstoff schmierung oel "
    "viskositaet oil_type"
)
LOSS = "efficiency mesh_efficiency friction_coefficient wirkungsgrad eta mu"
LIFE = (
    "life lifetime service_life life_hours operating_hours load_cycles cycles load_spectrum "
    "load_case load_cases duty_cycle lebensdauer lastkollektiv lastwechsel n_l"
)
RACK = (
    "addendum dedendum addendum_coefficient dedendum_coefficient tip_radius rack tool profile "
    "basic_rack reference_profile bezugsprofil h_ap h_fp rho_fp"
)
SHAPE = "gear_type gear_types"
BODY = "rim_thickness web_thickness web hub_diameter bore bore_diameter lightening_holes"
BEARINGS = "bearing bearings bearing_type lager"
SPANS = "bearing_distance bearing_span bearing_spacing bearing_positions lagerabstand"
DIAMETERS = (
    "reference_diameter pitch_diameter base_diameter tip_diameter root_diameter outside_diameter "
    "d1 d2 d_a1 d_a2 d_f1 d_f2 d_b1 d_b2 kopfkreisdurchmesser fusskreisdurchmesser "
    "teilkreisdurchmesser"
)
CONTACT = (
    "contact_ratio transverse_contact_ratio overlap_ratio noise profilueberdeckung "
    "sprungueberdeckung eps_alpha eps_beta"
)
PLANETARY = (
    "planetary planetary_gear planetary_stage planet planets epicyclic planet_gears planet_teeth "
    "number_of_planets planet_count n_planets sun sun_gear sun_teeth z_sun ring ring_gear "
    "ring_teeth z_ring carrier planet_carrier annulus wolfrom planetengetriebe umlaufgetriebe "
    "sonnenrad hohlrad planeten planetenzahl planetentraeger steg"
)
EPICYCLIC = (
    'Nearest: kind = "drive" with a stage of type = "planetary", sized by ratings, or kind = '
    '"epicyclic", trains by their numbers of teeth'
)
MONEY = "cost price costs budget maximum_cost"

KEYS = frozenset(  # of the names above, those that a drive has as keys
    "hardness surface_hardness overload_factor centre_distance profile_shift quality grade life "
    "temperature friction_coefficient addendum rim_thickness web_thickness bore "
    "accuracy_grade".split()
)


def _but_keys(names: str) -> str:
    return " ".join(name for name in names.split() if name not in KEYS)


NEAREST: dict[str, dict[str, str]] = {  # kind -> names -> what stands nearest
    "drive": {
        _but_keys(CENTRES): "Nearest: centre_distance of a [[stage]], or objective.minimise = "
        '"sum_of_centre_distances", or a [[place]] beside [layout], which says where a shaft is',
        _but_keys(
            MATERIAL + " " + STRESS
        ): "Nearest: steel, or treatment, grade and hardness of a gear, or "
        "tables [[material]] to choose from, with a [rating]",
        SAFETY: "Nearest: minimum_bending_safety and minimum_contact_safety, in [rating] or a "
        "[[stage]], which limit sizes where [limits] has no k_factor and unit_load",
        FACTORS: "Nearest: overload_factor, in [rating] or a [[stage]]; without it multiply "
        "duty.power by the factor",
        _but_keys(SHIFT): "Nearest: profile_shift, in [stage.pinion] and [stage.wheel]",
        _but_keys(
            QUALITY
        ): "Nearest: quality of [rating], or accuracy_grade of [rating.iso6336]; or kind = "
        '"servo", which counts deviations and grades of gears',
        _but_keys(OIL): "Nearest: oil_viscosity and temperature of [rating], or oil_grade of "
        "[rating.iso6336]",
        _but_keys(
            LOSS
        ): "Nearest: friction_coefficient or oil_viscosity of [rating], or objective.minimise = "
        '"mesh_loss"; sizes are those of loss-free gears',
        _but_keys(LIFE): "Nearest: life of [rating], and tables [[load]]",
        _but_keys(
            RACK
        ): "Nearest: addendum, tool_addendum and tool_tip_radius, in [gears], [stage.pinion] or "
        "[stage.wheel]",
        SHAPE: "Drives have external gears on parallel shafts: helix_angle of [gears] says whether "
        "spur or helical",
        _but_keys(
            BODY
        ): "Nearest: rim_over_module, web_over_face_width, bore and hub_over_bore, in [gears], "
        "[stage.pinion] or [stage.wheel]; holes in webs are not counted",
        BEARINGS: "Nearest: bearing_diameters and bearing_widths of [layout]",
        SPANS: "It follows from the layout. Nearest: span of [stage.shaft], for K_Hbeta, and of "
        "[layout], which says whether shafts reach from wall to wall",
        DIAMETERS: "It follows from module, teeth and profile_shift. Nearest: wheel_diameter of "
        "[limits], the largest that is allowed; addendum and tip_alteration of a gear",
        "backlash flank_clearance normal_backlash circumferential_backlash j_bn j_wt": "Nearest: "
        "thickness_allowance of a gear and centre_distance of a [[stage]]; kind = "
        '"servo" counts backlash and its causes',
        CONTACT: "The contact ratio is reported. Nearest: gears.helix_angle, which raises it",
        MONEY: 'Nearest: objective.minimise = "cost", with prices of every [[material]]',
        "transverse_module m_t stirnmodul circular_pitch p_t p_n teilung": "Nearest: module, the "
        "normal one: the transverse module times the cosine of helix_angle, or normal pitch over "
        "pi",
        "output_torque abtriebsmoment t2 t_2": "Nearest: torque of [duty], that of the input: the "
        "output torque over the ratio, as gears are loss-free",
        "weight mass maximum_mass max_mass maximum_weight max_weight": "Nearest: "
        'objective.minimise = "mass", with its density',
        "depth length width height size": "Nearest: largest_width, largest_height and "
        "largest_length of the box in [layout]",
    },
    "servo": {
        CENTRES: "Nearest: modules and teeth of [train], which it follows from, or the box of "
        "[space]; centre_distance of a [[mesh]] is its deviation",
        f"{MATERIAL} {STRESS} {STRENGTH}": "Nearest: bending_stress and density of [train]",
        SAFETY: "Nearest: bending_stress of [train]: divide what the material bears by the factor",
        FACTORS: "Nearest: output_torque of [train]: multiply it by the factor",
        SHIFT: "Nearest: pinion_teeth of [train]: with a minimum of 17 teeth a pinion of 20 deg "
        "needs no profile shift",
        QUALITY: "Nearest: grade of a [[mesh]] with given gears, or its pitch deviations",
        OIL: "Nearest: friction of [motor] and [load]",
        LIFE: "Nearest: bending_stress of [train], which is chosen for a life",
        "helix_angle beta helical": "The gears of a servo train are spur gears. Nearest: kind = "
        '"drive", whose gears may be helical',
        "stages number_of_stages": "A servo train has two stages, or three by kind = "
        '"drive". Nearest: ratio and teeth of [train]',
        BODY: "Gears are solid. Nearest: second_pinion_diameter and output_shaft_diameter of "
        "[train]",
        SHAPE: "Servo trains have external spur gears on parallel shafts",
        CONTACT: "Nearest: pinion_teeth of [train]",
    },
    "compound": {
        f"{CENTRES} module modules": 'Nearest: kind = "drive" or "servo", which have modules; here '
        "only numbers of teeth are chosen",
        f"{MATERIAL} {STRESS} {STRENGTH} {SAFETY} power torque load face_width": "Nearest: kind = "
        '"drive", which has loads; here only numbers of teeth are chosen',
        "stages number_of_stages idler": 'Nearest: kind = "drive", of up to six stages; a compound '
        "train has two pairs",
        "ratio_tolerance tolerance": "Nearest: train.ratio, which is met as nearly as teeth allow; "
        'kind = "drive" has a tolerance',
    },
    "packing": {
        "weight mass density material": 'Nearest: objective.minimise = "volume"',
        "height maximum_height max_height depth": "The height follows from the cylinders. Nearest: "
        "most or exactly of [layers]",
        "length radius": "Nearest: diameter and height of a [[cylinder]], width of a rectangle",
        "orientation rotation axis tilt": "All axes are upright. Nearest: at of a [[cylinder]], "
        "which fixes its place",
    },
    "strain_wave": {
        "speed power input_speed output_speed rpm": "The gearing is loaded at rest. Nearest: "
        "torque of [duty]",
        "flexspline_teeth circular_spline_teeth number_of_teeth zaehnezahl": "They follow from "
        "ratio of [duty]: the flexspline has twice as many teeth, the circular spline two more",
        "helix_angle beta": "The teeth are straight. Nearest: face_width of [gears]",
    },
    "dynamics": {
        "module helix_angle profile_shift number_of_teeth": "Nearest: pair of [mesh], a "
        "file of kind pair, whose teeth give the stiffness; or stiffness and wave of [mesh]",
        "friction friction_coefficient": "Friction of teeth is not modelled. Nearest: damping of "
        "[mesh]",
        "dt step time_step": "Nearest: error of [simulate], which sets the steps",
    },
}

NEAREST["pair"] = NEAREST["drive"] | {
    _but_keys(CENTRES): "Nearest: centre_distance of a [[stage]]",
    "depth length width height size": "Nearest: face_width of a [[stage]]",
    "layout place keep_out process_one process_two": 'Nearest: kind = "drive" with one [[stage]], '
    "which is laid out, and sized by the rules of processes; a pair's contact is computed here",
    "stages number_of_stages num_stages stage_count": 'A pair is one. Nearest: kind = "drive"',
    SHAPE: "A pair has external gears on parallel shafts: helix_angle of [gears] says whether "
    "spur or helical",
    **dict.fromkeys(
        (BEARINGS, SPANS, "shaft_diameter shaft_diameters wellendurchmesser"),
        "Shafts and bearings are rigid here. Nearest: bore of a gear, where it is held",
    ),
    "end_relief face_relief endrelief endruecknahme bias twist verschraenkung": "Along the face "
    "flanks are crowned, straight or misaligned. Nearest: crowning of [flank]",
}

for _kind in NEAREST:
    NEAREST[_kind] = NEAREST[_kind] | {PLANETARY: EPICYCLIC}
NEAREST["servo"] |= {PLANETARY: "Nearest: a table [planetary], a planetary stage as the gearhead"}
NEAREST["epicyclic"] = {
    f"{CENTRES} module modules {MATERIAL} {STRESS} {STRENGTH} {SAFETY} power torque load "
    "face_width speed input_speed": "Only numbers of teeth are chosen, and nothing is rated. "
    'Nearest: kind = "drive", which has loads',
    "stages number_of_stages": 'Nearest: arrangement = "coupled", of two sets',
}


def nearest(kind: str, name: str) -> str | None:
    """Nearest key to one that a kind does not have; None of any other name."""
    return looked_up({way: names for names, way in NEAREST.get(kind, {}).items()}, name)
