"""The problem file that `gearopt new servo` prints."""

EXAMPLE = """\
gearopt = 1
kind = "servo"
title = "A servo axis"

[motor]
inertia = "8.6e-6 kg m^2"
torque = "0.05 N m"
friction = "0.003 N m"

[load]
inertia = "1.98e-2 kg m^2"
friction = "4.3 kgf cm"

[duty]                         # motor, load, duty: the best total ratio, what the train achieves
motion = "acceleration"        # or: move, with angle; swing, with amplitude and frequency

[train]                        # two stages: teeth and modules, proven
ratio = 48
modules = ["0.3 mm", "0.4 mm", "0.5 mm", "0.6 mm", "0.8 mm", "1 mm"]
pinion_teeth = [16, 60]
wheel_teeth = 300
face_width = "6 mm"
density = "7.75 g/cm^3"
sector = "25 %"                # the last wheel is no full disc
second_pinion_diameter = "11.5 mm"
wheel_tip_diameters = ["80 mm", "106 mm"]
output_torque = "2.4 N m"
bending_stress = "150 MPa"
minimise = "inertia"           # or mass, error, move_time; or maximise = "acceleration"

[shaft]                        # between the stages; optional, as all below
diameter = "8 mm"
length = "50 mm"

[[mesh]]                       # deviations of stage 1, at the motor
pinion_reading = "0.018 mm"
wheel_reading = "0.024 mm"
centre_distance = "0.0042 mm"
wheel_bearing_clearance = "0.0025 mm"
wheel_bearing_run_out = "0.0025 mm"
pitch = "0.029 mm"

[[mesh]]                       # of stage 2, at the load
pinion_reading = "0.02 mm"
wheel_reading = "0.027 mm"
centre_distance = "0.0054 mm"
pinion_bearing_clearance = "0.0025 mm"
wheel_bearing_clearance = "0.003 mm"
pinion_bearing_run_out = "0.003 mm"
wheel_bearing_run_out = "0.004 mm"
pitch = "0.033 mm"

[accuracy]
error = "0.12 deg"             # of the output, all deviations at their worst

[tolerances]                   # the same deviations reallocated at minimum cost
exponent = 1

[[cost]]                       # of one deviation, where it is another
deviation = "pitch"
stage = 2
cost = 2

[[budget]]
rule = "worst_case"            # or rss, mean_plus_sd

[stiffness]
shear_modulus = "86.1 GPa"
line_stiffness = "10300 MPa"
frequency = "200 Hz"
load_torque = "4.3 kgf cm"

[lightest]                     # real-valued sizes of minimum mass, stiff enough
face_width = "2 mm"
shaft_diameter = "3 mm"
shaft_wall = "3.5 mm"
inertia = "8e-7 kg m^2"

[space]                        # seen along the shafts
width = "80 mm"
height = "130 mm"
motor_diameter = "24 mm"
hub_diameter = "16 mm"
swept_angle = "180 deg"
"""
