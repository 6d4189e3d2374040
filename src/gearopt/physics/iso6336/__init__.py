"""Rating of spur and helical gears by ISO 6336, parts 1, 2, 3, 5 (method B) and 6.

Editions 2006 and 2019; tolerances by ISO 1328-1:1995 or 2013. Forces in N, lengths, deviations and
roughness in mm, stresses and mesh stiffness in MPa (1 N/(mm um) is 1000 MPa), angles in rad, speeds
in rad/s and mm/s, masses in t, viscosity in mm2/s. Written from public programs, printed reports,
rules of ship classes and memory, not from the standards: what has a single source, or memory alone,
is marked unverified, and so is of the edition of 2019 what no printed report confirms. The wheel
may be a ring, of negative teeth, and the pair a mesh of a planetary stage. Scuffing and
micropitting are not rated.
"""
