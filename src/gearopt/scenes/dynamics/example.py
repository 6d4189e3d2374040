"""Problem files to start from: a pair on its bearings, and one of least vibration."""

EXAMPLE = """\
gearopt = 1
kind = "dynamics"
title = "A spur pair on elastic bearings"

[pinion]
base_diameter = "120 mm"
mass = "0.6 kg"
inertia = "0.002 kg m^2"
torque = "200 N m"             # the wheel's balances it where its own is not given
bearing_stiffness = "100 kN/mm"
bearing_damping = 0.02

[wheel]
base_diameter = "160 mm"
mass = "0.9 kg"
inertia = "0.004 kg m^2"
bearing_stiffness = "100 kN/mm"
bearing_damping = 0.02

[mesh]
pressure_angle = "20 deg"
teeth = 30                     # of the pinion
speed = "3000 rpm"             # of the pinion: mesh frequency 1500 Hz
wave = "trapezoid"             # or constant, rectangle, fourier, pair (of a file of kind pair)
stiffness = "200 kN/mm"        # mean
depth = 0.5                    # (maximum - minimum)/mean
duty = 0.68                    # contact ratio less 1
ramp = 0.1
damping = 0.03
backlash = "0.1 mm"            # without it the teeth never part
axes = "line"                  # or "plane", "fixed"

[simulate]
duration = "20 ms"
error = 1e-6

[stability]
mesh_frequency = ["500 Hz", "14 kHz"]
frequencies = 136

[speeds]
range = ["500 rpm", "12000 rpm"]
points = 116

# [optimise]                   # the pair of least vibration over a range of speeds
# speeds = ["1500 rpm", "6000 rpm"]
# bearing_stiffness = ["30 kN/mm", "500 kN/mm"]
# contact_ratio = [1.25, 1.95]
# ramp = [0.02, 0.25]
# face_width = ["8 mm", "25 mm"]
# rim = [0.6, 1.4]             # mass and inertia over those of solid discs
# density = "7850 kg/m^3"
# single_stiffness = "13591 MPa" # c' of ISO 6336-1
# mass = "2 kg"                # of both gears, at most
# displacement = "40 um"       # of an axis, at most
"""
