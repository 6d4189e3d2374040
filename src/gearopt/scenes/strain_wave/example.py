"""Problem files to start from: a gearing that is given, and one from its duty alone."""

EXAMPLE = """\
gearopt = 1
kind = "strain_wave"
title = "A strain wave gearing: teeth in contact, loads, stress, cutter"

[duty]
torque = "100 N m"             # at the output
ratio = 80
# outer_diameter = "90 mm"     # needed where numbers of [gears] are left out, which are chosen then

[gears]
module = "0.5 mm"
pressure_angle = "20 deg"
profile_shift = 0.9            # this and the next two in modules
addendum = 0.6
deflection = 1
rim = "0.8 mm"
face_width = "10 mm"

[teeth]
law = "involute"               # or double arc, half locus

[wave_generator]
shape = "cosine"               # or ellipse, discs

[sharing]
rim = "elastic"                # or rigid

[cutter]                       # of the flexspline: a rack; teeth = 40 of a pinion-type cutter
tool_angle = "20 deg"

# [design]                     # ranges and limits of what is chosen
# profile_shift = [0, 2]
# [material]
# bending_limit = "400 MPa"
"""
FROM_DUTY = """\
gearopt = 1
kind = "strain_wave"
title = "A strain wave gearing of 80:1 from its duty alone"

[duty]
torque = "100 N m"
ratio = 80
outer_diameter = "90 mm"

[cutter]
"""
MORE_EXAMPLES = {"strain-wave-from-duty": ("a strain wave gearing from its duty alone", FROM_DUTY)}
