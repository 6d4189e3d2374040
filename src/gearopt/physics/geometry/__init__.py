"""Geometry of involute gears with profile shift (ISO 21771 terms), beyond `gears`.

Everything is asked of the `Gear` and `GearPair` that drives, layouts and drawings are made of; an
internal gear, a ring, has negative teeth and diameters. Lengths in mm, angles in rad. Sections lie
in the transverse plane unless a name says normal; the tooth of helical gears is cut there exactly,
by the transverse section of the tool.
"""
