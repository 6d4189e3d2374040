"""Other names of kinds and of their keys: symbols of ISO and AGMA, words of programs, German ones.

`{what it is called here, and where: its other names}`, compared as `absent.plain` writes them.
"""

from gearopt.scenes.reading.absent import looked_up

DRIVE = {
    "pinion_teeth, in a [[stage]] or [limits]": "z1 z_1 z_p n_p teeth_1 pinion.z pinion.teeth "
    "pinion.number_of_teeth",
    "wheel_teeth, in a [[stage]] or [limits]": "z2 z_2 z_g n_g teeth_2 gear_teeth wheel.z "
    "wheel.teeth wheel.number_of_teeth",
    "pinion_teeth and wheel_teeth, in a [[stage]] or [limits]": "stage.teeth limits.teeth "
    "gears.teeth number_of_teeth num_teeth tooth_number tooth_numbers tooth_count zaehnezahl "
    "zaehnezahlen",
    "sun_teeth, in a [[stage]], or pinion_teeth in [limits]": "limits.sun_teeth",
    "ring_teeth, in a [[stage]], or wheel_teeth in [limits]": "limits.ring_teeth",
    "planet_teeth, in a [[stage]]": "limits.planet_teeth",
    "planets, in a [[stage]]": "limits.planets",
    "module, in a [[stage]] or [limits]": "m m_n normal_module modul normalmodul",
    "diametral_pitch, in a [[stage]]": "p_nd pnd dp normal_diametral_pitch",
    "face_width, in a [[stage]]": "b b1 b2 stage.width tooth_width zahnbreite breite "
    "effective_face_width",
    "centre_distance, in a [[stage]]": "a a_w stage.center_distance stage.axis_distance "
    "stage.achsabstand working_centre_distance",
    "sum_of_centre_distances, in [limits]": "sum_of_center_distances sum_of_distances",
    "coaxial, in [limits]": "coaxial_shafts co_axial koaxial in_line inline",
    "overlap_ratio, in [limits] or a [[stage]]": "limits.overlap stage.overlap overlap "
    "minimum_overlap_ratio min_overlap_ratio limits.eps_beta stage.eps_beta limits.epsilon_beta "
    "face_contact_ratio limits.sprungueberdeckung",
    "axial_force, in [limits] or a [[stage]]": "thrust thrust_force axial_load axial_thrust "
    "maximum_axial_force max_axial_force f_ax axialkraft",
    "pinion_shift, in [shift]": "shift.x shift.x1 shift.x_1 shift.profile_shift shift.pinion_x "
    "pinion_shifts shift.pinion_profile_shift",
    "pinion_shift, in [shift]: the shift of the wheel follows from the distance": "shift.x2 "
    "shift.x_2 shift.wheel_shift wheel_shift",
    "tip_thickness, in [shift]": "s_an minimum_tip_thickness min_tip_thickness zahnkopfdicke",
    "contact_ratio, in [shift], beside a centre_distance": "limits.contact_ratio shift.eps_alpha "
    "limits.eps_alpha limits.transverse_contact_ratio shift.minimum_contact_ratio",
    "specific_sliding, in [shift]": "sliding zeta maximum_specific_sliding spezifisches_gleiten",
    "ratio in [duty], stage_ratio in a [[stage]]": "i u i_ges u_ges m_g gear_ratio total_ratio "
    "transmission_ratio overall_ratio reduction reduction_ratio uebersetzung "
    "uebersetzungsverhaeltnis",
    "helix_angle, in [gears] or a [[stage]]": "beta helix psi schraegungswinkel "
    "helix_angle_at_reference_diameter",
    "pressure_angle, in [gears]": "alpha alpha_n phi phi_n normal_pressure_angle eingriffswinkel "
    "normaleingriffswinkel",
    "profile_shift, in [stage.pinion] and [stage.wheel]": "x1 x2 x_1 x_2 x_sum profile_shift_sum "
    "sum_of_profile_shifts pinion_profile_shift wheel_profile_shift pinion.x wheel.x "
    "profilverschiebung profilverschiebungsfaktor",
    "elastic_modulus, in [gears]": "youngs_modulus young_modulus e_modulus e_modul emodul "
    "modulus_of_elasticity",
    "poisson_ratio, in [gears]": "poisson poissons_ratio poissonzahl querkontraktionszahl",
    "flank_rz, in [gears]": "rz r_z flank_roughness surface_roughness",
    "idler, in a [[stage]]: its pinion is the wheel before": "idler_gear intermediate_gear "
    "zwischenrad",
    'type = "planetary", in a [[stage]] of kind "drive"': "planetary epicyclic planet_gear "
    "planet_gears planetengetriebe umlaufgetriebe carrier planet_carrier planetentraeger steg",
    'type = "internal", in a [[stage]] of kind "drive", with ring_teeth': "internal internal_gear "
    "internal_gears internal_teeth innenverzahnung",
    'planets, in a [[stage]] of type = "planetary"': "number_of_planets planet_count n_planets "
    "planeten planetenzahl stage.planet_number",
    'sun_teeth, in a [[stage]] of type = "planetary"': "z_sun stage.z_sun sun_gear sonnenrad",
    'ring_teeth, in a [[stage]] of type = "planetary" or "internal"': "z_ring stage.z_ring "
    "ring_gear annulus annulus_teeth stage.annulus_teeth hohlrad",
    'mesh_load_factor, in a [[stage]] of type = "planetary"': "k_gamma load_sharing_factor "
    "lastaufteilungsfaktor",
    'carrier_over_face_width, in a [[stage]] of type = "planetary"': "carrier_width cheek_width "
    "carrier_thickness stage.carrier stegbreite",
    "reversed_load, of a gear": "reverse_bending alternating alternating_load wechselbiegung",
    "tool_protuberance, of a gear": "protuberance",
    "tip_chamfer, of a gear, in normal modules": "chamfer tip_form_diameter d_na kopfkantenbruch",
    "grinding_allowance, of a gear, in normal modules": "machining_allowance grinding_stock "
    "finishing_allowance schleifzugabe schleifaufmass bearbeitungszugabe",
    "rim_thickness, of a gear: the ratio is computed": "backup_ratio m_b",
    "pinion_hand, in a [[stage]]; the wheel has the other hand": "hand wheel_hand helix_hand "
    "hand_of_helix flank_direction",
    "pinion, a table [stage.pinion]": "ritzel pinion_gear",
    "wheel, a table [stage.wheel]": "rad gear wheel_gear gegenrad grossrad driven",
    "duty, a table of its own": ".motor .drive .operation .operating_data .input antrieb",
    "gears, a table of its own": ".gear .gear_data",
    "objective, a table of its own": ".optimization .optimisation .objectives .goal .target ziel",
    "limits, a table of its own": ".constraints .restrictions .bounds .boundaries grenzen",
    "material, tables [[material]] to choose from": ".materials .werkstoffe",
    "layout, a table with shaft_diameters or shaft_stress": ".shaft .shafts .wellen",
    "layout, a table with largest_width, largest_height and largest_length": ".housing .space "
    ".envelope .box gehaeuse",
    "title or source, at the top of the file; tables of your own are named [x-...]": "version "
    "description comment project general",
    "title, at the top of the file": "report.title report.name report.subject",
    "engineer, in [report]": "author designer prepared prepared_by drawn_by checked_by bearbeiter",
    "approved, in [report]": "approved_by released_by freigegeben",
    "customer, in [report]": "client kunde",
    "company, in [report]": "firm firma",
    "crowned, in [rating], or helix_modification in [rating.iso6336]": "crowning lead_crowning",
    "helix_modification, in [rating.iso6336]": "end_relief lead_modification helix_correction "
    "flankenlinienkorrektur",
    "profile_modification and tip_relief, in [rating.iso6336]": "root_relief profile_correction",
    "thickness_allowance, of a gear": "tooth_thickness tooth_thickness_tolerance "
    "thickness_tolerance base_tangent_length span_measurement zahndickenabmass zahnweite",
    "flank_hardness in HV, or hardness in HB, in [gears]": "hrc hardness_hrc rockwell "
    "rockwell_hardness",
    "grade, in [gears]; by ISO 6336 iso_quality": "steel_grade material_grade material_quality",
    "largest_height, in [layout]": "max_height maximum_height height_limit",
    "largest_width, in [layout]": "max_width maximum_width",
    "largest_length, in [layout]": "max_length maximum_length",
    "gear_clearance, shaft_clearance, wall_clearance or axial_clearance, in [layout]": "clearance "
    "clearances",
    "module, a range in [limits]": "max_module min_module maximum_module minimum_module",
    "k_factor, in [limits]": "k k_star limits.k_faktor",
    "coprime, in [teeth]": "hunting hunting_tooth hunting_teeth",
    "modules, in [teeth]": "teeth.module teeth.series module_series standard_modules",
    "power, in [duty]": "p p1 p_in input_power leistung antriebsleistung rated_power nominal_power",
    "torque, in [duty]": "input_torque drehmoment antriebsmoment t1 t_1 nominal_torque",
    "input_speed, in [duty]": "n1 n_1 n_in rpm speed input_rpm speed_in input_shaft_speed "
    "motor_speed pinion_speed drehzahl antriebsdrehzahl eingangsdrehzahl",
    "output_speed, in [duty]": "n2 n_2 n_out output_rpm speed_out output_shaft_speed "
    "abtriebsdrehzahl ausgangsdrehzahl",
    "stages, at the top of the file": "number_of_stages num_stages stage_count stufen stufenzahl",
    "overload_factor, in [rating] or a [[stage]]; without a [rating] multiply power of [duty] by "
    "it": "k_a application_factor anwendungsfaktor overload service_class",
    "static_torque_factor, in [rating]": "peak_torque_factor maximum_torque starting_torque "
    "static_torque peak_load anfahrmoment spitzenmoment maximalmoment",
    "quality, in [rating]": "q_v agma_quality",
    "accuracy, in [rating]": "a_v",
    "life, in [rating]": "hours required_life l_h",
    "minimum_bending_safety, in [rating] or a [[stage]]": "s_f_min s_f_required "
    "minimum_root_safety minimum_bending_safety_factor fusssicherheit zahnfusssicherheit",
    "minimum_contact_safety, in [rating] or a [[stage]]": "s_h_min s_h_required "
    "minimum_pitting_safety minimum_flank_safety minimum_contact_safety_factor flankensicherheit "
    "gruebchensicherheit",
    "oil_grade, in [rating.iso6336]": "nu_40 iso_vg viscosity_grade",
    "shaft_diameters, in [layout], one of every shaft": "shaft_diameter wellendurchmesser d_sh "
    "d_shaft",
    "keep_out, a table [[keep_out]] beside [layout]": "obstacle obstacles keepout keepouts "
    "keep_outs forbidden forbidden_zone no_go_zone exclusion_zone",
    "largest_width, largest_height and largest_length, in [layout]": "layout.box box_size "
    "housing_size bounding_box available_space bauraum",
    "J, in [rating.given]": "y_j",
    "I, in [rating.given]": "z_i",
    "K_m, in [rating.given]": "k_h",
    "C_p, in [rating.given]": "z_e",
    "C_f, in [rating.given]": "z_r",
    "C_H, in [rating.given]": "z_w",
    "K_R, in [rating.given]": "y_z",
    "K_T, in [rating.given]": "y_theta",
    "s_at, in [rating.given]": "sigma_fp",
    "s_ac, in [rating.given]": "sigma_hp",
    "sigma_Hlim, or sigma_Flim of bending, of a gear; by AGMA s_ac and s_at": "sigma_hlim "
    "sigma_flim sigma_h_lim sigma_f_lim endurance_limit",
    "K_Hbeta, in [rating.iso6336.given]": "k_hb k_h_beta",
    "K_Fbeta, in [rating.iso6336.given]": "k_fb k_f_beta",
    "K_Halpha, in [rating.iso6336.given]": "k_ha k_h_alpha",
    "K_Falpha, in [rating.iso6336.given]": "k_fa k_f_alpha",
    "Z_eps, in [rating.iso6336.given]": "z_epsilon",
    "Z_BD, in [rating.iso6336.given]": "z_b z_d",
    "Y_deltarelT, in [rating.iso6336.given]": "y_drelt y_delta_rel_t",
    "Y_RrelT, in [rating.iso6336.given]": "y_rrel y_r_rel_t",
}
PAIR = {
    "loads, in [sharing]": "sharing.load",
    "amount, in [relief]": "relief.tip_relief relief.root_relief relief_amount",
    "coupling, in [sharing]": "c12 sharing.c12",
    "crowning, in [flank]": "crowning lead_crowning c_beta flank.c_b breitenballigkeit "
    "face_crowning",
    "helix_correction, in [flank]": "helix_modification helix_angle_modification "
    "helix_slope_modification lead_correction lead_modification c_hbeta c_h_beta "
    "flankenlinienwinkelkorrektur",
    "misalignment, in [flank]": "f_beta_y f_betay f_hbeta f_h_beta flank.slope shaft_deflection "
    "deflection flankenlinienabweichung",
    "slices, in [flank]": "number_of_slices slice_count n_slices scheiben",
    "level, in [sharing]": "model sharing.model stiffness",
    "positions, in [sharing]": "steps sharing.steps phases",
}
SERVO = {
    "speed_limit, in [motor]; what its voltage allows is no_load_speed": "motor.speed rated_speed "
    "max_speed maximum_speed max_motor_speed",
    "minimum_backlash, in a [[mesh]], or, at the output, error, in [accuracy]": "backlash "
    "flank_clearance",
    "inertia, in [motor]": "motor.j motor_inertia rotor_inertia j_m",
    "inertia, in [load]": "load_inertia j_l",
    "torque, in [motor]": "motor_torque max_torque peak_torque stall_torque rated_torque "
    "maximum_torque",
    "ratio, in [train]": "i gear_ratio total_ratio uebersetzung",
    "modules, in [train]": "train.module m m_n normal_module modul",
    "pinion_teeth and wheel_teeth, in [train]": "train.teeth number_of_teeth zaehnezahl",
    "face_width, in [train]": "b tooth_width zahnbreite",
    "efficiency, in [load]": "eta wirkungsgrad mesh_efficiency",
    "error, in [accuracy]": "transmission_error positioning_error position_error",
}
COMPOUND = {
    "teeth, in [train]: a range for every gear": "z zaehnezahl number_of_teeth min_teeth "
    "max_teeth minimum_teeth maximum_teeth z_min z_max pinion_teeth wheel_teeth",
    "ratio, in [train]": "i gear_ratio total_ratio target_ratio uebersetzung",
}
EPICYCLIC = {
    "sun, in [teeth]": "sun_teeth z_sun z_s teeth_sun sonnenrad teeth.z1",
    "planet, in [teeth]": "planet_teeth z_planet z_p teeth_planet planetenrad teeth.planets",
    "ring, in [teeth]": "ring_teeth z_ring z_r teeth_ring annulus hohlrad annulus_teeth",
    "planets, in [train]": "number_of_planets planet_count n_planets planetenzahl planeten",
    "fixed, in [train]": "held stationary grounded ground fixed_member",
    "input, in [train]": "input_member driver driving antrieb",
    "output, in [train]": "output_member driven abtrieb",
    "ratio, in [train]": "i gear_ratio total_ratio reduction uebersetzung",
    "minimum_efficiency, in [limits]": "limits.efficiency min_efficiency",
    "sun and ring, in [efficiency]": "mesh_efficiency eta eta_0 basic_efficiency losses",
    "neighbour_clearance, in [limits]": "clearance planet_clearance gap",
    "coaxial_difference, in [limits]": "coaxial profile_shift",
}
PACKING = {
    "cylinder, a table [[cylinder]] of each": "circle circles cylinders disc discs disk disks",
    "container, a table of its own": "box bin enclosure",
    "gap, in [container]": "spacing clearance distance",
    "count, in a [[cylinder]]": "number quantity amount",
    "at, in a [[cylinder]]": "position place",
}
STRAIN_WAVE = {
    "torque, in [duty]": "output_torque rated_torque t drehmoment",
    "ratio, in [duty]": "i gear_ratio reduction uebersetzung",
    "outer_diameter, in [duty]": "diameter outside_diameter housing_diameter",
    "module, in [gears]": "m m_n normal_module modul",
    "pressure_angle, in [gears]": "alpha alpha_n",
    "profile_shift, in [gears]": "x x1",
    "face_width, in [gears]": "b tooth_width zahnbreite",
    "rim, in [gears]": "rim_thickness wall_thickness flexspline_thickness",
    "deflection, in [gears]": "radial_deflection radial_deformation w0",
    "elastic_modulus, in [material]": "youngs_modulus e_modulus emodul",
    "bending_limit, in [material]": "sigma_b allowable_bending_stress fatigue_limit "
    "endurance_limit",
    "shear_limit, in [material]": "tau allowable_shear_stress",
    "wave_generator, a table of its own": "generator cam",
}
DYNAMICS = {
    "stiffness, in [mesh]": "mesh_stiffness k_m",
    "damping, in [mesh]": "damping_ratio zeta",
    "base_diameter, in [pinion] and [wheel]": "pinion.radius wheel.radius pinion.diameter "
    "wheel.diameter d_b base_circle_diameter base_radius",
    "duration, in [simulate]": "time t_end",
    "speed, in [mesh]": "rpm n1 rotational_speed",
    "inertia, in [pinion] and [wheel]": "j mass_moment_of_inertia moment_of_inertia",
    "pressure_angle, in [mesh]": "alpha alpha_n",
    "backlash, in [mesh]": "clearance play",
    "face_width, in [mesh]": "width b",
    "accuracy_grade, in [mesh]": "quality accuracy iso_grade quality_grade",
    "error_cosines, in [mesh]": "transmission_error_cosines te static_transmission_error",
    "error_sines, in [mesh]": "transmission_error_sines",
}
KINDS = {
    "drive": "gearbox gear_unit transmission reducer speed_reducer gear_reducer gear gears "
    "gear_drive spur helical spur_gear helical_gear helical_gears parallel_shaft cylindrical "
    "cylindrical_gear cylindrical_gears rating rate getriebe stirnrad stirnraeder "
    "stirnradgetriebe planetary planetary_gear planetary_gears planetary_gearbox planetary_stage "
    "planetary_set planetary_gear_set planetary_drive planetengetriebe internal internal_gear "
    "internal_gears",
    "pair": "gear_pair spur_pair spur_gears mesh gear_mesh contact tooth_contact relief "
    "tip_relief profile_modification transmission_error",
    "compound": "compound_train compound_gear_train train gear_train",
    "servo": "servo_drive servo_train backlash actuator positioning",
    "dynamics": "vibration vibrations dynamic oscillation schwingung",
    "strain_wave": "harmonic_drive harmonic strain_wave_gear strain_wave_gearing wave wellgetriebe",
    "epicyclic": "planetary_train epicyclic_gear epicyclic_train planet planets sun ring annulus "
    "wolfrom stepped_planet 3k umlaufgetriebe",
    "packing": "cylinders circles cylinder_packing circle_packing",
}
CALLED: dict[str, dict[str, str]] = {
    "drive": DRIVE,
    "pair": PAIR | DRIVE,  # its own names first
    "servo": SERVO,
    "compound": COMPOUND,
    "epicyclic": EPICYCLIC,
    "packing": PACKING,
    "strain_wave": STRAIN_WAVE,
    "dynamics": DYNAMICS,
}


def kind_called(name: str) -> str | None:
    """Return the kind of file that another name stands for; None of any other name."""
    return looked_up(KINDS, name)


def called(kind: str, name: str) -> str | None:
    """Name here of a key that others call otherwise, and its table; None of any other name."""
    return looked_up(CALLED.get(kind, {}), name)
