"""Problem files to start from: drives to be sized by load limits or ratings; gears to be rated."""

EXAMPLE = """\
gearopt = 1
kind = "drive"
title = "A two-stage drive"
# stages = [1, 4]              # instead of the tables [[stage]]: the best number of stages

[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
output_speed = "66.5 rpm"      # or: ratio = 21.8
ratio_tolerance = "1 %"

[gears]
helix_angle = "25 deg"

[[stage]]                      # from the input on; what is fixed or differs in this stage
face_width_over_diameter = 0.6 # b/d1; a range [0.3, 0.6] leaves the width free

[[stage]]
face_width_over_diameter = 0.75

[limits]
k_factor = "2.07 MPa"          # contact; or: preset = "chong-lee-elevator"
unit_load = "48 MPa"           # tooth root
pinion_teeth = [20, 40]

[teeth]                        # whole teeth, standard modules; without it sizes are continuous
modules = "ISO 54 I"

[objective]
minimise = "gear_volume"       # or mass, sum_of_centre_distances, total_length

# [layout]                     # without the # the gears are laid out in the smallest box
# shaft_stress = "40 MPa"      # torsion; or: shaft_diameters = ["20 mm", "35 mm", "60 mm"]
# span = "full"                # shafts from wall to wall; or partial

# [process_one]                # designs by the rules of a paper, beside the best one:
# stage_ratios = [4.96, 4.36]  # by K-factor and unit load,
# [process_two]                # and after Niemann
# first_centre_distance = "150 mm"
# modules = ["2 mm", "3 mm"]   # or: pinion_teeth = [23, 25]
"""

RATING = """\
gearopt = 1
kind = "drive"
title = "A pair of spur gears, rated"

[duty]
power = "7.5 kW"
input_speed = "1450 rpm"

[[stage]]                      # one table per pair, from the input on
module = "3 mm"                # or: diametral_pitch = 8
pinion_teeth = 20
wheel_teeth = 60
face_width = "30 mm"
# helix_angle = "15 deg"       # normal module and pressure angle then
# centre_distance = "121 mm"   # of spur gears here; without it the one without backlash

[stage.pinion]                 # data of the pinion alone; likewise [stage.wheel]
profile_shift = 0.2

[gears]                        # what all gears share
treatment = "carburised"       # or through-hardened with hardness = "300 HB", nitrided ...
grade = 1

[rating]                       # gearopt rate FILE
standard = "agma"              # or "iso6336", or "both" with accuracy_grade in [rating.iso6336]
life = "20000 h"
quality = 8                    # Q_v; larger is better
overload_factor = 1.25
mounting = "commercial"        # or open, precision, "extra precision"
minimum_bending_safety = 1.2
minimum_contact_safety = 1.1
# oil_viscosity = "40 mPa s"   # for the efficiency of the mesh

# [rating.given]               # factors of your own, instead of computed ones
# K_m = 1.3
# J = [0.30, 0.40]             # pinion, wheel

# [[load]]                     # a load spectrum instead of the duty's power
# power = "7.5 kW"
# share = "30 %"
"""
SIZING = """\
gearopt = 1
kind = "drive"
title = "A helical unit, sized by its rating"

[duty]
power = "15 kW"
input_speed = "1480 rpm"
output_speed = "45 rpm"        # or: ratio = 32.9
ratio_tolerance = "3 %"

[gears]                        # what all gears share
helix_angle = "15 deg"
treatment = "carburised"       # or through-hardened with hardness = "300 HB", nitrided ...
grade = 2
# rim_over_module = 3          # rims and webs: lighter gears, for minimise = "mass" or "cost"
# web_over_face_width = 0.3

[[stage]]                      # from the input on; what is fixed or differs in this stage
face_width_over_diameter = 0.7 # b/d1; a range [0.4, 1.0] leaves the width free

[[stage]]
face_width_over_diameter = 0.7

[limits]                       # k_factor and unit_load here would be limits beside [rating]
pinion_teeth = [17, 40]

[teeth]                        # whole teeth, standard modules
modules = "ISO 54 I"

[rating]                       # whose safety factors limit the gears
standard = "agma"              # or "iso6336", or "both" with accuracy_grade in [rating.iso6336]
life = "20000 h"
quality = 10                   # Q_v; larger is better
overload_factor = 1.25
mounting = "precision"         # or open, commercial, "extra precision"
minimum_bending_safety = 1.4
minimum_contact_safety = 1.1

[objective]
minimise = "gear_volume"       # or mass, cost, sum_of_centre_distances, total_length

# [[material]]                 # to choose from: materials = ["hard"] in [gears]
# name = "hard"
# treatment = "carburised"
# density = "7.85 kg/dm^3"
# price = 9                    # of a kilogram, for minimise = "cost"
"""
MORE_EXAMPLES = {
    "rating": ("gears that are given, rated by AGMA or ISO 6336", RATING),
    "sizing": ("a drive of least volume that is safe by its rating", SIZING),
}
