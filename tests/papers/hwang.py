"""The pair on which docs/profile_modification.md recomputes the paper of Hwang and others.

25/50 teeth, m 3 mm, b 30 mm, bores 30 and 50 mm, 200 N m: the paper prints no pair of its own.
"""

import math
from functools import cache

import numpy as np

from gearopt.formulations.pair.relief.meshing import NO_RELIEF, Mesh
from gearopt.formulations.pair.relief.parametric import Ranges, at_point, problem
from gearopt.formulations.pair.relief.rules import short_relief, tip_amounts
from gearopt.optimise.solve import solve
from gearopt.physics.agma.factors import elastic_coefficient
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.fillet import profile
from gearopt.physics.load_sharing import share
from gearopt.physics.mesh_cycle import cycle
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.hertz import contact_compliance, linear_contact_compliance
from gearopt.physics.tooth.ladder import LEVELS
from gearopt.physics.tooth.trapezoid import bending_integral, trapezoid

PAIR = GearPair.of_teeth(3.0, 25, 50, 30.0, 0.0, Rack(tip_radius=0.38))
ELASTIC = ElasticPair(PAIR, (30.0, 50.0))
PATH = ELASTIC.path
FORCE = 5675.614786538198  # N
COUPLING = 0.784e-6  # mm/N, of plane finite elements
INCH = 25.4
BEST = (  # um on 48 even positions, the least that annealing and a local method found: published
    ("uncoupled", (1.0,), 0.475, 1.494),
    ("uncoupled", (0.6, 1.0), 1.680, 2.101),
    ("uncoupled", (0.5, 1.0, 1.25), 2.901, 3.032),
    ("coupled", (1.0,), 0.456, 1.006),
    ("coupled", (0.6, 1.0), 1.237, 1.349),
    ("coupled", (0.5, 1.0, 1.25), 2.033, 2.068),
)
EXAMPLE = (1.0e5, 5.0e4), (0.004, 0.001), 1000.0  # stiffnesses [N/mm], amounts [mm], load [N]


def compliance(positions, level="profile + Sainsot"):
    return LEVELS[level].compliance(ELASTIC, positions, FORCE)


@cache
def mesh(coupling=COUPLING, level="profile + Sainsot"):
    return Mesh.of(cycle(PATH, 96), lambda s: compliance(s, level), coupling, (FORCE,))


def peak_to_peak(made, reliefs=(NO_RELIEF, NO_RELIEF)):
    """Of the transmission error [um]."""
    return 1e3 * float(made.criteria(made.separations(*reliefs)).peak_to_peak[0])


def amounts(coupling):
    """Tip relief [um] of pinion and wheel by the second rule; coupling 0: the paper's own."""
    return [1e3 * a for a in tip_amounts(PATH, compliance, coupling, FORCE)]


def short(coupling, exponent):
    """Peak-to-peak [um] with the rule's amounts from the first double contact on."""
    found = tuple(1e-3 * a for a in amounts(coupling))
    return peak_to_peak(mesh(coupling), short_relief(PATH, found, exponent))


def brackets(scale=1.0):
    """Both brackets of (7) over S_F^3, times their factors, of the pinion at the pitch point.

    As printed, corrected, and as the integral; scale: units a millimetre.
    """
    member = ELASTIC.members[0]
    shape = trapezoid(member, "A")
    load = float(member.load_line(PATH.curvatures[0]).crossing) - shape.base
    s_f, s_k, h, c, s_c = (
        scale * v for v in (shape.root_width, shape.tip_width, shape.height, shape.rectangle, load)
    )
    q = (h * s_f - c * s_k) / (s_f - s_k)
    z = (q - s_c) / (q - c)
    printed = 12.0 * (s_c**2 + c**2 / 3.0 - c * s_c) + 6.0 * (q - c) ** 3 * z * (4.0 - z)
    right = 12.0 * c * (s_c**2 + c**2 / 3.0 - c * s_c)
    right += 6.0 * (q - c) ** 3 * (z * (4.0 - z) - 2.0 * math.log(z) - 3.0)
    return printed / s_f**3, right / s_f**3, float(bending_integral(shape, load)), z


def share_of(k, e, load):
    """Forces of two pairs by (19) and by (20) as printed and corrected."""
    first = k[0] / sum(k) * (load - k[1] * (e[0] - e[1]))
    printed = k[1] / sum(k) * (load - k[0] * (e[0] - e[1]))
    return first, printed, k[1] / sum(k) * (load + k[0] * (e[0] - e[1]))


def hertz():
    """Least and largest factor by which the linear contact is too stiff on the path, and [um]."""
    s = np.linspace(PATH.start + 0.15, PATH.end - 0.15, 41)
    logarithmic = contact_compliance(ELASTIC, s, ELASTIC.load_lines(s), FORCE)
    linear = linear_contact_compliance(ELASTIC)
    ratio = logarithmic / linear
    return float(ratio.min()), float(ratio.max()), 1e3 * FORCE * linear


def axial():
    """Compression of the pinion's tooth [um] at EAP, and all of its teeth's deflection there."""
    member = ELASTIC.members[0]
    line = member.load_line(PATH.radii_of_curvature(PATH.end)[0])
    x, y = profile(member.gear, 400, 400)
    inside = y <= float(line.height)
    slender = float(np.trapezoid(1.0 / (2.0 * x[inside]), y[inside]))
    factor = member.plane_factor * np.sin(line.angle) ** 2 / member.rigidity
    return 1e3 * FORCE * float(factor) * slender, slender


def double_zone(coupling):
    """Approach [um] in the middle of double contact."""
    s = PATH.start + 0.5 * (PATH.length - PATH.base_pitch)
    pair = np.array([compliance(s), compliance(s + PATH.base_pitch)])
    return 1e3 * float(share(pair, np.zeros(2), FORCE, coupling).approach)


def ramp(exponent):
    """How far the share strays from a line between 0 and 1 as a pair comes in, of the load."""
    found = tuple(1e-3 * a for a in amounts(COUPLING))
    made = mesh()
    shares = made.sharing(made.separations(*short_relief(PATH, found, exponent))).forces[0] / FORCE
    s, f = made.cycle.along(made.cycle.positions), made.cycle.along(shares)
    inside = s <= PATH.lowest_single
    line = (s[inside] - PATH.start) / (PATH.length - PATH.base_pitch)
    return float(np.abs(f[inside] - line).max())


def model_errors():
    """Least and largest error [%] of the paper's model against finite elements, and as repaired."""
    rows = []
    for name in ("Nakada A as printed", "Nakada A"):
        level = LEVELS[name]
        rows.append([100.0 * f(*level.error, *level.wider) for f in (min, max)])
    return rows


def carried(coupling):
    """Contact ratio that is left under load with the parabolas of the rule."""
    found = tuple(1e-3 * a for a in amounts(coupling))
    made = mesh()
    criteria = made.criteria(made.separations(*short_relief(PATH, found)))
    return float(criteria.contact_ratio[0])


def deflections():
    """Errata 1 to 7: of the deflection of a tooth."""
    printed, right, _, z = brackets()
    inch = brackets(1.0 / INCH)[0]
    low, high, linear = hertz()
    pressed, slender = axial()
    errors, repaired = model_errors()
    return {
        1: "(7), first bracket: S_C² + C²/3 - C S_C | times C | a length is missing: both "
        f"brackets of the pinion at the pitch point over S_F³ are {printed:.1f} as printed in "
        f"mm and {inch:.1f} in inches, where they are a number",
        2: "(7), second bracket: Z (4 - Z) | Z (4 - Z) - 2 ln Z - 3 | with both corrected they "
        f"are {right:.4f}, the integral of 12 (S_C - x)²/s³ to every digit; as printed a load "
        "at the end of the rectangle, Z = 1, would bend the trapezoid it does not reach by 3 "
        "instead of 0",
        3: "(9): W; (10): W | S_F; Q | one letter for two lengths: Q is where the flanks of "
        f"the trapezoid meet, and Z what is left of S_F at the load, here {z:.3f}",
        4: "(7) twice, (8) in the heading of section 3-3 | delta_B (7), delta_S (8) | the "
        "labels go from 7 to 9; may be the reading's fault, as 1 to 3 may",
        5: "(7): shear without a factor, no compression | kappa = 1.2; F sin²/(E B) int dx/s | "
        f"a parabola of shear stress has 6/5 of the energy; compression is {pressed:.2f} µm at "
        "the pinion's tip",
        6: "(12): 1 + nu² | 1 - nu² | plane strain; 1.198 times too soft as printed. And it is "
        f"linear: {linear:.2f} µm here, where Hertz's logarithm gives {low:.1f} to {high:.1f} "
        "times that",
        7: "(11): 24/pi | 18/pi | 24 is the slope in the middle of a half plane under a linear "
        "pressure, 18 its mean over that pressure; the body's shift and torsion are missing. "
        f"With (6) to (12) a pair of teeth is {errors[0]:.0f} to {errors[1]:.0f} % too stiff as "
        f"printed, {repaired[0]:.0f} to {repaired[1]:.0f} % with 1 - nu²",
    }


def sharing():
    """Errata 8, 9 and 13: of load sharing and relief."""
    first, printed, right = share_of(*EXAMPLE)
    alone, coupled = double_zone(0.0), double_zone(COUPLING)
    own, corrected = amounts(0.0), amounts(COUPLING)
    lost = share_of((4.0e5, 4.0e5), (0.03, 0.0), FORCE)[0]
    line, curve = (short(COUPLING, p) for p in (1.0, 2.0))
    more = 100.0 * (own[0] / corrected[0] - 1.0)
    return {
        8: "(20): F - K_1 (e_1 - e_2) | F + K_1 (e_1 - e_2) | with K = 1e5, 5e4 N/mm, e = 4, 1 "
        f"µm, F = 1000 N (19) gives {first:.2f} N, (20) {printed:.2f} N as printed and "
        f"{right:.2f} N corrected; only then (16) holds, printed it is {first + printed:.0f} N",
        9: "(17) to (20), and both rules: pairs without influence on each other, both loaded | "
        "c - c_12; none below zero | in the middle of double contact the gears give way by "
        f"{coupled:.2f} µm, not {alone:.2f}; so relief by the whole deflection, {own[0]:.2f} "
        f"and {own[1]:.2f} µm, is {more:.0f} % more than the {corrected[0]:.2f} and "
        f"{corrected[1]:.2f} µm that unload the pair, and leaves a contact ratio of "
        f"{carried(0.0):.2f}; and 30 µm at K = 4e5 N/mm make (19) {lost:.0f} N",
        10: 'K_T, C_T, C_H, not explained; C_B in the list of (3); C_p "equivalent modulus" | '
        "temperature and hardness ratio factors; not in (3); elastic coefficient | C_p of (5) "
        f"has the unit sqrt(MPa): {elastic_coefficient(206000.0, 0.3, 206000.0, 0.3):.2f} for "
        "steel",
        11: "[4]: 2001-B88, 1998 | 1988 | the edition is in its name, as 908-B89 of [5] is of 1989",
        12: "(13), (14): rho_1 of the gear, rho_2 of the pinion; I_1, I_2 only in a figure | "
        "either way | (12) splits one value: the shares rho_2/(rho_1 + rho_2) of both teeth "
        "add up to 1",
        13: "Figure 15, conclusions: load without jumps, so less transmission error | the "
        "first is met, the second hardly | with either shape the share strays from a line by "
        f"{100 * ramp(1.0):.1f} to {100 * ramp(2.0):.1f} % of the load; but a parabola of the "
        f"corrected amounts leaves {curve:.2f} of {peak_to_peak(mesh()):.2f} µm, straight "
        f"flanks {line:.2f} µm",
    }


def errata_rows():
    """Rows of the table of errata by number, without the number."""
    return dict(sorted((deflections() | sharing()).items()))


def levels():
    """Rows of the stiffness of a pair of teeth [N/(mm um)] at five points, by level."""
    places = (PATH.start, PATH.lowest_single, 0.0, PATH.highest_single, PATH.end)
    names = ("Nakada A as printed", "Nakada A", "trapezoid + Sainsot", "profile + Sainsot")
    found = []
    for name in names:
        values = (1e-3 / (compliance(s, name) * 30.0) for s in places)
        found.append(f"| {name} | {' | '.join(f'{v:.2f}' for v in values)} |")
    return found


def rules():
    """Rows of rules: amounts, exponent, peak-to-peak alone and coupled, contact ratio left."""
    found = []
    for words, coupling, exponent in (
        ("the paper's, parabolic", 0.0, 2.0),
        ("the paper's, straight", 0.0, 1.0),
        ("corrected, parabolic", COUPLING, 2.0),
        ("corrected, straight", COUPLING, 1.0),
    ):
        made, (first, second) = mesh(), amounts(coupling)
        both = short_relief(PATH, (1e-3 * first, 1e-3 * second), exponent)
        left = float(made.criteria(made.separations(*both)).contact_ratio[0])
        found.append(
            f"| {words} | {first:.2f} | {second:.2f} | {peak_to_peak(mesh(0.0), both):.2f} | "
            f"{peak_to_peak(made, both):.2f} | {left:.3f} |"
        )
    return found


def sampled(model, loads, steps, exact):
    """The pair at loads, on even positions and, if exact, on both sides of every break point."""
    coupling = COUPLING if model == "coupled" else 0.0
    given = tuple(load * FORCE for load in loads)
    return Mesh.of(cycle(PATH, steps, exact), compliance, coupling, given)


def best(model, loads, exponent):
    """Least peak-to-peak [um]: on 48 even positions, with break points, that on 480 with these."""
    found = []
    for exact in (False, True):
        made = sampled(model, loads, 48, exact)
        ranges = Ranges.of(made, exponent)
        result = solve(problem(made, ranges), "exact")
        assert result.status == "optimal"
        found.append(1e3 * result.value)
    x = np.array([*result.design["amount_mm"], *result.design["length_mm"]])
    fine = sampled(model, loads, 480, True)
    finer = fine.criteria(fine.separations(*at_point(x, ranges))).peak_to_peak.max()
    return *found, 1e3 * float(finer)


def best_row(model, loads, *published):
    """A row of the table of the best relief, linear and parabolic."""
    cells = []
    for exponent, known in zip((1.0, 2.0), published, strict=True):
        cells.append(" / ".join(f"{v:.3f}" for v in (known, *best(model, loads, exponent))))
    percents = ", ".join(f"{100.0 * load:g}" for load in loads)
    return f"| {percents} % | {model} | {' | '.join(cells)} |"
