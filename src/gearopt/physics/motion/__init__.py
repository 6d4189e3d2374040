"""Motion of a spur pair whose axes move on their bearings: contact, stiffness, levels, statics.

Lengths in mm, forces in N, masses in t, times in s. Angles count counter-clockwise for both gears,
which turn against each other. The deformation delta of the mesh is negative where teeth are
pressed together. Index 1 is the driving pinion, 2 the wheel.
"""
