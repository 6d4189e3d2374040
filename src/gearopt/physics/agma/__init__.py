"""Rating of spur and helical gears by ANSI/AGMA 2001-D04, in its metric form 2101-D04.

Forces in N, lengths in mm, stresses in MPa, angles in rad, speeds in rad/s and mm/s, times in s.
The constants of the standard are those of its form in inches, converted exactly; the metric form
rounds them (sqrt(200 v) for sqrt(196.85 v), 0.533 MPa for 77.3 psi). Geometry factors are those of
AGMA 908-B89, by its analytic method, and of rings, which it has not, by analogy, unverified. The
older 2001-B88 is there where it differs.

Read from textbooks, public programs and a summary of a paper, not from the standards: where a
value has a single source, it is marked unverified, and the mark goes with it.
"""
