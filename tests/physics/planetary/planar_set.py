"""A planetary set in the plane: small motions of its members, springs at its contacts, its play.

Members turn and planets move; how far two of them approach each other along a line of action is
taken from the displacements of their points at the pitch point. Nothing here knows base circles.
"""

import numpy as np
from scipy.optimize import linprog

NAMES = ("sun", "ring", "carrier")


class PlanarSet:
    """Sun, ring and carrier turn (0, 1, 2); planet i turns (3 + 3 i) and moves (4, 5 + 3 i).

    The motion of a planet is that of its axis from the carrier's pin: along its circle, outwards.
    """

    def __init__(self, teeth, distance, angles, planets):
        sun, planet, ring = teeth
        self.distance, self.planets, self.size = distance, planets, 3 + 3 * planets
        self.pitch_sun = distance * sun / (sun + planet)  # radii of the pitch points
        self.pitch_ring = distance * ring / (ring - planet)
        self.angles = angles

    def point(self, body, planet, radius):
        """Displacement (along the circle, outwards) of a body's point on the line of centres."""
        tangential, radial = np.zeros((2, self.size))
        if body in NAMES:
            tangential[NAMES.index(body)] = radius
        else:
            tangential[2] = self.distance
            tangential[3 + 3 * planet] = radius - self.distance
            tangential[4 + 3 * planet] = radial[5 + 3 * planet] = 1.0
        return tangential, radial

    def approach(self, planet, inner, flank):
        """Row of the approach of two teeth: of sun and planet, or (inner) of planet and ring.

        flank 1: where the sun drives ahead. The force is inclined by the working angle, and parts
        sun and planet, or presses planet and ring radially together as internal teeth do.
        """
        angle = self.angles[1 if inner else 0]
        if inner:
            first, second = "planet", "ring"
            radius, way = self.pitch_ring, (-flank * np.cos(angle), np.sin(angle))
        else:
            first, second = "sun", "planet"
            radius, way = self.pitch_sun, (flank * np.cos(angle), np.sin(angle))
        ahead, behind = (self.point(name, planet, radius) for name in (first, second))
        return sum(w * (a - b) for w, a, b in zip(way, ahead, behind, strict=True))

    def compliance(self, sink, springs, pin):
        """Turn of the sink by a unit torque, the other two of NAMES locked; springs of both."""
        stiffness = np.zeros((self.size, self.size))
        for k in range(self.planets):
            for inner, spring in enumerate(springs):
                row = self.approach(k, bool(inner), 1)
                stiffness += spring * np.outer(row, row)
            for place in (4 + 3 * k, 5 + 3 * k):
                stiffness[place, place] += pin
        free = [NAMES.index(sink), *range(3, self.size)]
        load = np.zeros(len(free))
        load[0] = 1.0
        return np.linalg.solve(stiffness[np.ix_(free, free)], load)[0]

    def play(self, sink, backlashes, positions, clearance=0.0, sides=360):
        """Turn of the sink from end to end, the other two locked; by linear programming.

        backlashes: of both meshes of every planet, along the line of action; positions: of the
        pins along their circle; clearance: diameter in which a pin is free, a polygon of so many
        sides around it.
        """
        rows, most = [], []
        for k, (outer, inner) in enumerate(backlashes):
            for flank in (1, -1):
                for which, gap in ((False, outer), (True, inner)):
                    row = self.approach(k, which, flank)
                    rows.append(row)
                    most.append(0.5 * gap - row[4 + 3 * k] * positions[k])
            for t in 2.0 * np.pi * np.arange(sides) / sides if clearance else ():
                row = np.zeros(self.size)
                row[4 + 3 * k], row[5 + 3 * k] = np.cos(t), np.sin(t)
                rows.append(row)
                most.append(0.5 * clearance)
        held = [NAMES.index(name) for name in NAMES if name != sink]
        if not clearance:
            held += [place for k in range(self.planets) for place in (4 + 3 * k, 5 + 3 * k)]
        bounds = [(0.0, 0.0) if k in held else (None, None) for k in range(self.size)]
        goal = np.zeros(self.size)
        goal[NAMES.index(sink)] = 1.0
        ends = [linprog(sign * goal, rows, most, bounds=bounds) for sign in (1.0, -1.0)]
        if any(end.status == 2 for end in ends):
            return None
        return -ends[1].fun - ends[0].fun
