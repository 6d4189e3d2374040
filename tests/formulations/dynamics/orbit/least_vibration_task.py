"""The pair of least vibration of an independent program: its task, and designs that it measured."""

import math

import numpy as np

from gearopt.formulations.dynamics.orbit.task import Task

ANGLE = math.radians(20.0)
SPEEDS = tuple(np.linspace(1500.0, 6000.0, 16))
TASK = Task(
    torque=2e5,
    base_radii=(60.0, 80.0),
    radii=(60.0 / math.cos(ANGLE), 80.0 / math.cos(ANGLE)),
    teeth=30,
    pressure_angle=ANGLE,
    density=7.85e-9,
    single=13591.0,
    mesh_damping=0.03,
    bearing_damping=0.02,
    speeds_rpm=SPEEDS,
    ranges={
        "bearing_stiffness": (10**4.5, 10**5.7),
        "contact_ratio": (1.25, 1.95),
        "ramp": (0.02, 0.25),
        "face_width": (8.0, 25.0),
        "rim": (0.6, 1.4),
    },
    most_mass=2e-3,
    most_displacement=0.04,
)
# Designs of the independent program: bearing stiffness [N/mm], contact ratio, ramp, width, rim.
BEST = np.array([10**5.70000008698802, 1.9500000194986844, 0.0499999829891968, 11.799749, 0.6])
REFERENCE = np.array([10**5.2, 1.68, 0.10, 11.9, 0.6])
HEAVY = np.array([10**5.2, 1.68, 0.10, 14.0, 1.0])
LEAST = 3.2956414804843366  # um, of the independent program
