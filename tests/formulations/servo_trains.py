"""The servo train of the examples, and its known designs, in mm, N, rad, MPa, t."""

import math
from fractions import Fraction as F
from itertools import product

from gearopt.formulations.servo.split import ServoTrain, StiffTrain

TAN = math.tan(math.radians(20.0))
LOST = (4.0 * TAN * 0.0512 + 2.0 * 0.029, 4.0 * TAN * 0.0649 + 2.0 * 0.033)

PAPER = ServoTrain(
    ratio=F(48),
    tolerance=F(1, 100),
    modules=tuple(F(k, 10) for k in (3, 4, 5, 6, 8, 10)),
    pinion_teeth=(16, 60),
    max_wheel_teeth=300,
    face_width=6.0,
    density=7.75e-9,
    output_torque=2400.0,
    bending=150.0,
    bore=F(23, 2),
    wheel_tips=(F(80), F(106)),
    shaft=(8.0, 50.0),
    lost_motion=LOST,
    error=math.radians(0.1082),
    sector=0.25,
)

STIFF = StiffTrain(
    stiffness=1.0,
    line_stiffness=10.3e3,
    shear_modulus=8.78e8 * 98.0665e-6,
    ratio=(48.0, 48.48),
    module=0.5,
    pinion_teeth=(16, 23),
    bore=(11.5, 3.5),
    wheel_tips=(61.0, 105.0),
    face_width=2.0,
    shaft_diameter=3.0,
    shaft_length=50.0,
    density=7.75e-9,
    output_torque=2400.0,
    bending=150.0,
    lost_motion=LOST,
    error=math.radians(0.1095),
    inertia=8e-4,
    sector=0.25,
)


def trains_within(train):
    """Teeth (4) and modules (2) of all trains within ratio, wheel tips and bore, as fractions."""
    low, high = train.ratios
    pinions = range(train.pinion_teeth[0], train.pinion_teeth[1] + 1)
    wheels = range(train.pinion_teeth[0], train.max_wheel_teeth + 1)
    for z1, z2, z3, z4 in product(pinions, wheels, pinions, wheels):
        if z2 < z1 or z4 < z3 or not low <= F(z2 * z4, z1 * z3) <= high:
            continue
        for m1, m2 in product(train.modules, repeat=2):
            tips = m1 * (z2 + 2) <= train.wheel_tips[0] and m2 * (z4 + 2) <= train.wheel_tips[1]
            if tips and m2 * z3 >= train.bore:
                yield (z1, z2, z3, z4), (m1, m2)
