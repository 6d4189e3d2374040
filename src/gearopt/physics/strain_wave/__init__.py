"""Strain wave gearing: neutral curve, conjugate flank, clearance, cutter, strength.

A plane section in mm and rad, seen in the frame of the wave generator, whose major axis is the
x axis. Arguments are floats, arrays that broadcast, or casadi scalars, unless a function says so.
"""
