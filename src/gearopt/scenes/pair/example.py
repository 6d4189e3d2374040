"""Problem files to start from: a spur pair that is given, and one from duty and material alone."""

EXAMPLE = """\
gearopt = 1
kind = "pair"
title = "A spur pair: how its teeth share the load"

[duty]
power = "20 kW"
input_speed = "955 rpm"

[[stage]]                      # the pair; without it the pair is sized by [rating]
module = "3 mm"
pinion_teeth = 25
wheel_teeth = 50
face_width = "30 mm"

[stage.pinion]                 # data of the pinion alone; likewise [stage.wheel]
bore = "30 mm"                 # where the gear is held on its shaft

[stage.wheel]
bore = "50 mm"

[sharing]
loads = [0.5, 1]               # relative to the torque of [duty]
# plane = "strain"             # of wide gears; "stress" of narrow ones
# coupling = "0.8 um/kN"       # of neighbouring teeth, instead of a model's

# [relief]                     # without the # the best tip relief is found
# minimise = "peak_to_peak"    # transmission error; or harmonics, load_jump, peak_load
# loads = [0.6, 1]             # the worst of all counts
# shape = "linear"             # or parabolic, or an exponent
"""
SIZED = """\
gearopt = 1
kind = "pair"
title = "A spur pair from its duty and its steel"

[duty]
power = "15 kW"
input_speed = "1450 rpm"
ratio = 3

[gears]
treatment = "through-hardened" # or carburised, nitrided ...
hardness = "300 HB"

[rating]                       # whose safety factors size the pair
standard = "agma"              # or "iso6336", "both"
life = "20000 h"
quality = 8                    # Q_v; larger is better
overload_factor = 1.25

# [limits]                     # what is left out is taken as it stands here
# pinion_teeth = [18, 60]
# [teeth]
# modules = "ISO 54 I"
# [objective]
# minimise = "gear_volume"     # or mass, sum_of_centre_distances, total_length
"""
MORE_EXAMPLES = {
    "sized-pair": ("a spur pair from duty and steel alone, and how its teeth share the load", SIZED)
}
