"""Keys that a gear engineer expects: what stands nearest to those that no kind knows yet.

Those that are called otherwise here are named too.

A key is found by its name in any table of a file, also where another table has a key of that name
with another meaning, as the deviation `centre_distance` of a servo train's [[mesh]].
"""

import re

FACTORS = "application_factor service_factor overload_factor k_a ka"
MATERIAL = (
    "material materials pinion_material wheel_material gear_material steel hardness "
    "surface_hardness heat_treatment yield_strength tensile_strength"
)
SAFETY = (
    "safety_factor safety_factors safety s_h s_f minimum_safety contact_safety bending_safety "
    "safety_factor_contact safety_factor_bending"
)
STRESS = (
    "allowable_stress allowable_stresses contact_stress hertz_stress hertzian_stress sigma_hlim "
    "sigma_flim sigma_h_lim sigma_f_lim sigma_h sigma_f endurance_limit tooth_root_stress "
    "root_stress hertzian_pressure contact_pressure"
)
CENTRES = (
    "centre_distance center_distance centre_distances center_distances axis_distance shaft_distance"
)
SHIFT = (
    "profile_shift profile_shifts profile_shift_coefficient profile_shift_coefficients "
    "addendum_modification x1 x2"
)
QUALITY = "quality accuracy grade gear_quality accuracy_grade quality_grade iso_grade agma_quality"
OIL = "lubricant lubrication oil viscosity oil_temperature temperature scuffing"
LOSS = "efficiency mesh_efficiency friction_coefficient"
LIFE = "life lifetime service_life life_hours operating_hours load_cycles cycles load_spectrum"
RACK = "addendum dedendum addendum_coefficient dedendum_coefficient tip_radius rack tool profile"
SHAPE = "gear_type gear_types internal ring_gear planetary planets bevel worm hypoid crossed_axes"
BODY = "rim_thickness web_thickness web hub_diameter bore bore_diameter lightening_holes"
BEARINGS = "bearing bearings bearing_life bearing_type"
CONTACT = "contact_ratio transverse_contact_ratio overlap_ratio noise"
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
        _but_keys(MATERIAL + " " + STRESS): "Nearest: treatment, grade and hardness in [gears] or "
        "[stage.pinion], for a [rating], which limits sizes where [limits] has no k_factor",
        SAFETY: "Nearest: minimum_bending_safety and minimum_contact_safety of [rating], which "
        "limit sizes where [limits] has no k_factor and unit_load",
        _but_keys(
            FACTORS
        ): "Nearest: overload_factor of [rating]; of sizes duty.power: multiply it by the factor",
        _but_keys(SHIFT): "Nearest: profile_shift, in [stage.pinion] and [stage.wheel]",
        _but_keys(
            QUALITY
        ): "Nearest: quality of [rating], or accuracy_grade of [rating.iso6336]; or kind = "
        '"servo", which counts deviations and grades of gears',
        _but_keys(
            OIL
        ): "Nearest: oil_viscosity and temperature of [rating]; scuffing is not checked",
        _but_keys(
            LOSS
        ): "Nearest: friction_coefficient or oil_viscosity of [rating]; sizes are those of "
        "loss-free gears",
        _but_keys(LIFE): "Nearest: life of [rating], and tables [[load]]",
        _but_keys(
            RACK
        ): "Nearest: addendum, tool_addendum and tool_tip_radius, in [gears], [stage.pinion] or "
        "[stage.wheel]",
        SHAPE: "Drives have external spur or helical gears on parallel shafts. Nearest: "
        "gears.helix_angle",
        _but_keys(
            BODY
        ): "Nearest: rim_over_module, web_over_face_width, bore and hub_over_bore, in [gears], "
        "[stage.pinion] or [stage.wheel]; holes in webs are not counted",
        BEARINGS: "Nearest: bearing_diameters and bearing_widths of [layout]",
        "backlash flank_clearance": "Nearest: thickness_allowance of a gear and centre_distance "
        'of a [[stage]]; kind = "servo" counts backlash and its causes',
        CONTACT: "The contact ratio is reported. Nearest: gears.helix_angle, which raises it",
        MONEY: 'Nearest: objective.minimise = "mass", or "gear_volume"',
        "torque input_torque output_torque": "Nearest: duty.power and input_speed: power is torque "
        "times angular speed",
        "weight mass maximum_mass max_mass maximum_weight max_weight": "Nearest: "
        'objective.minimise = "mass", with its density',
        "depth length width height size": "Nearest: largest_width, largest_height and "
        "largest_length of the box in [layout]",
    },
    "servo": {
        CENTRES: "Nearest: modules and teeth of [train], which it follows from, or the box of "
        "[space]; centre_distance of a [[mesh]] is its deviation",
        f"{MATERIAL} {STRESS}": "Nearest: bending_stress and density of [train]",
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
        f"{MATERIAL} {STRESS} {SAFETY} power torque load face_width": 'Nearest: kind = "drive", '
        "which has loads; here only numbers of teeth are chosen",
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
}

NEAREST["pair"] = NEAREST["drive"] | {
    _but_keys(CENTRES): "Nearest: centre_distance of a [[stage]]",
    "depth length width height size": "Nearest: face_width of a [[stage]]",
    "layout place keep_out process_one process_two": 'Nearest: kind = "drive" with one [[stage]], '
    "which is laid out, and sized by the rules of processes; a pair's contact is computed here",
    "stages number_of_stages num_stages stage_count": 'A pair is one. Nearest: kind = "drive"',
    SHAPE: "A pair has external spur gears, as the models of its contact are plane",
    BEARINGS: "Shafts and bearings are rigid here. Nearest: bore of a gear, where it is held",
    "crowning lead_crowning helix_modification": "Plane models have no crowning: nothing varies "
    "across the face width",
}

CALLED: dict[str, dict[str, str]] = {  # kind -> other names of its keys -> what they are called
    "drive": {
        "z1 z_1 teeth_1 pinion.z pinion.teeth": "pinion_teeth, in a [[stage]] or [limits]",
        "z2 z_2 teeth_2 wheel.z wheel.teeth": "wheel_teeth, in a [[stage]] or [limits]",
        "m m_n mn normal_module": "module, in a [[stage]] or [limits]",
        "b b1 b2 tooth_width facewidth": "face_width, in a [[stage]]",
        "i u": "ratio in [duty], stage_ratio in a [[stage]]",
        "beta": "helix_angle, in [gears]",
        "alpha alpha_n": "pressure_angle, in [gears]",
        "p_nd pnd dp": "diametral_pitch, in a [[stage]]",
        "x1 x2 x_1 x_2 pinion.x wheel.x": "profile_shift, in [stage.pinion] and [stage.wheel]",
        "q_v qv agma_quality": "quality, in [rating]",
        "a_v av": "accuracy, in [rating]",
        "hours required_life": "life, in [rating]",
        "s_f_min s_fmin sf_min": "minimum_bending_safety, in [rating]",
        "s_h_min s_hmin sh_min": "minimum_contact_safety, in [rating]",
        "backup_ratio m_b": "rim_thickness, of a gear: the ratio is computed",
        "y_j": "J, in [rating.given]",  # symbols of 2101
        "z_i": "I, in [rating.given]",
        "k_h": "K_m, in [rating.given]",
        "z_e": "C_p, in [rating.given]",
        "k_hb k_h_beta khbeta": "K_Hbeta, in [rating.iso6336.given]",  # of ISO 6336
        "k_fb k_f_beta kfbeta": "K_Fbeta, in [rating.iso6336.given]",
        "k_ha k_h_alpha khalpha": "K_Halpha, in [rating.iso6336.given]",
        "k_fa k_f_alpha kfalpha": "K_Falpha, in [rating.iso6336.given]",
        "z_epsilon": "Z_eps, in [rating.iso6336.given]",
        "z_b z_d": "Z_BD, in [rating.iso6336.given]",
        "y_drelt y_delta_rel_t": "Y_deltarelT, in [rating.iso6336.given]",
        "y_rrel y_r_rel_t": "Y_RrelT, in [rating.iso6336.given]",
        "nu_40 nu40": "oil_grade, in [rating.iso6336]",
        "z_r": "C_f, in [rating.given]",
        "z_w": "C_H, in [rating.given]",
        "y_z": "K_R, in [rating.given]",
        "y_theta": "K_T, in [rating.given]",
        "sigma_fp": "s_at, in [rating.given]",
        "sigma_hp": "s_ac, in [rating.given]",
        "hand wheel_hand helix_hand hand_of_helix": "pinion_hand, in a [[stage]]; the wheel has "
        "the other hand",
        "p": "power, in [duty]",
        "n1 n_1 n_in rpm speed input_rpm": "input_speed, in [duty]",
        "n2 n_2 n_out output_rpm": "output_speed, in [duty]",
        "number_of_stages num_stages stage_count": "stages, at the top of the file",
    },
    "servo": {
        "max_speed maximum_speed": "speed_limit, in [motor]",
        "backlash flank_clearance": "minimum_backlash, in a [[mesh]], or, at the output, error, in "
        "[accuracy]",
    },
}

CALLED["pair"] = CALLED["drive"] | {
    "sharing.load": "loads, in [sharing]",
    "c12 sharing.c12": "coupling, in [sharing]",
    "model sharing.model stiffness": "level, in [sharing]",
    "steps sharing.steps phases": "positions, in [sharing]",
}

KINDS = {
    "gearbox gear_box gear_unit transmission reducer speed_reducer gear_reducer": "drive",
    "gear_pair spur_pair spur_gears mesh": "pair",
}


def kind_called(name: str) -> str | None:
    """Return the kind of file that another name stands for; None of any other name."""
    return _found({"": KINDS}, "", name)


def called(kind: str, name: str) -> str | None:
    """Return what a key with another name is called here, and where; None of any other name."""
    return _found(CALLED, kind, name)


def nearest(kind: str, name: str) -> str | None:
    """Return what stands nearest to a key that is not supported yet; None of any other name."""
    return _found(NEAREST, kind, name)


def _found(table: dict[str, dict[str, str]], kind: str, name: str) -> str | None:
    plain = re.sub(r"[-\s]+", "_", name[:80].strip().lower())
    found = (way for names, way in table.get(kind, {}).items() if plain in names.split())
    return next(found, None)
