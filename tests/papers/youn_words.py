"""Rows and sentences of docs/servo_train.md about the paper itself and today's standards."""

import math

import youn
from youn import ANGLES, GF_CM, OTHER, TABLE_4, angles, chain, rule, series

from gearopt.physics.backlash import (
    backlash_angle,
    normal_backlash,
    output_error,
    pitch_error_angle,
)
from gearopt.physics.servo_drive import load_acceleration
from gearopt.physics.tolerances import SCOPE, total_pitch_tolerance

BEST = math.sqrt(youn.J_L / youn.J_M)
DEVIATIONS = tuple(zip(youn.PITCH, (48.0, 104.0), strict=True))
BUCKINGHAM = 0.111
CLAIMED = youn.LOAD_GFCM / youn.K_TS  # rad, of the printed K_TS


def lost(ratio):
    """Share of the largest acceleration, without friction, that a ratio loses."""
    numbers = youn.J_L, youn.J_M, 1.0
    return 1.0 - load_acceleration(ratio, *numbers) / load_acceleration(BEST, *numbers)


def angle_rows():
    """Printed, by Table 4, and by the wheels that explain the print; bold: rounds to another."""
    mine, other, found = angles(*TABLE_4), angles(*OTHER), []
    for name, printed in ANGLES.items():
        last = f"{other[name]:.5f}"
        last = last if f"{other[name]:.3f}" == printed else f"**{last}**"
        found.append(f"| {name} | {printed} | {mine[name]:.5f} | {last} |")
    return found


def windows():
    """Diameters of wheel 2 and 4 and ratios that give the printed angles."""
    wheels = [
        youn.window(f"{kind} of stage {stage}", d)
        for stage, d in (("12", 50.0), ("34", 122.0))
        for kind in ("backlash", "pitch error")
    ]
    return [*wheels, *(youn.downstream_window(kind) for kind in ("backlash", "pitch error"))]


def spring_rows():
    parts, ratios = youn.springs()
    _, shares, _ = chain()
    names = ("mesh 34, at gear 4", "shaft 2", "mesh 12, at gear 2")
    found = []
    for name, c, n, share in zip(names, parts, ratios, shares, strict=True):
        own = 1.0 / c / GF_CM / 1e8
        found.append(f"| {name} | {own:.4g} | {n:g} | {own * n**2:.4g} | {share:.3f} |")
    total = 1.0 / youn.output_compliance(parts, ratios) / GF_CM / 1e8
    return [*found, f"| all, at the output | | | {total:.4g} | 1 |"]


RULES = (  # factor, which gears, Lewis factor of pinion and wheel, how it reads
    (1.0, (0, 2), "y", "y", "4 r², pinion"),  # 4 r^2 = D^2
    (4.0, (0, 2), "y", "y", "4 D², pinion"),
    (4.0, (0, 2), "Y", "Y", "4 D², pinion"),
    (4.0, (0, 2), "Y", "y", "4 D², pinion"),
    (4.0, (1, 3), "y", "y", "4 D², wheel"),
    (0.125, (1, 3), "y", "y", "r²/2, wheel"),
    (0.25, (1, 3), "y", "y", "r², wheel: corrected"),
)


def mesh_rows():
    found = [f"| printed | | 1.8 | 3.8 | {youn.K_34 / youn.K_12:.2f} |"]
    for factor, gears, pinion, wheel, name in RULES:
        first, second = rule(factor, gears, pinion, wheel)
        kind = pinion if pinion == wheel else f"{pinion} pinion, {wheel} wheel"
        cells = f"{first / 1e8:.3g} | {second / 1e8:.3g} | {second / first:.2f}"
        found.append(f"| {name} | {kind} | {cells} |")
    return found


def ratios_of(gears):
    """Return the minimum and maximum K_s34/K_s12 of all forms of the Lewis factor."""
    kinds = ("y", "Y")
    found = [rule(1.0, gears, p, w) for p in kinds for w in kinds]
    return min(b / a for a, b in found), max(b / a for a, b in found)


def printed_total(shaft, mesh):
    """K_TS [gf cm/rad] as the paper makes it: shaft 2 and mesh 34 in series, by 6^2."""
    return youn.series(shaft, mesh) / 36.0


def both_members(grade):
    """Errors at the output [degrees] of the four gears' total pitch tolerances."""
    sizes, wheels = (8.0, 48.0, 13.0, 104.0), (48.0, 48.0, 104.0, 104.0)
    turned = [
        pitch_error_angle(total_pitch_tolerance(d, 0.5, grade), w)
        for d, w in zip(sizes, wheels, strict=True)
    ]
    ratios = (8.0, 8.0, 1.0, 1.0)
    each = [math.degrees(a / n) for a, n in zip(turned, ratios, strict=True)]
    return math.degrees(output_error(turned, ratios)), math.hypot(*each)


def grade_rows():
    found = []
    for grade in (5, 6, 7, 8):
        f = [1e3 * total_pitch_tolerance(d, 0.5, grade) for d in (48.0, 104.0)]
        worst, rss = both_members(grade)
        found.append(f"| {grade} | {f[0]:.1f} | {f[1]:.1f} | {worst:.4f} | {rss:.4f} |")
    return found


def grade_of(deviation, diameter):
    """Grade, as a fraction, whose total pitch tolerance is a deviation [mm]."""
    return 5.0 + 2.0 * math.log2(deviation / total_pitch_tolerance(diameter, 0.5, 5))


def least_backlash():
    """Normal and circumferential backlash [mm] of the guide line, and the angle [degrees]."""
    normal = 2.0 / 3.0 * (0.06 + 0.0005 * 58.5 + 0.03 * 0.5)
    tangential = normal / normal_backlash(1.0, youn.ALPHA)
    return normal, tangential, math.degrees(backlash_angle(tangential, 104.0))


def given():
    """Sentences of printed data."""
    z = [g.teeth for g in youn.GEARS]
    d = [f"{g.diameter:g}" for g in youn.GEARS]
    a = [(youn.GEARS[k].diameter + youn.GEARS[k + 1].diameter) / 2 for k in (0, 2)]
    m = {g.diameter / g.teeth for g in youn.GEARS}
    return [
        f"{z[0]}/{z[1]} and {z[2]}/{z[3]} teeth, pitch diameters {', '.join(d[:3])} and {d[3]} mm, "
        f"centre distances {a[0]:g} and {a[1]:g} mm, face width {youn.WIDTH:g} mm",
        f"module {m.pop():g} mm",
        "a box of {:g} x {:g} x {:g} mm".format(*youn.BOX),
        f"J_L = {1e-3 * youn.J_L:.4f} and J_M = {1e3 * youn.J_M:.1f}e-6 kg m²",
        f"shaft 2 of {youn.SHAFT[0]:g} x {youn.SHAFT[1]:g} mm",
        f"{z[1] * z[3] // (z[0] * z[2])}:1",
    ]


def repeated():
    """Sentences that take up printed data, or numbers of the tables, once more."""
    total, lash = "both at the output", "backlash at the output"
    budget, d = angles(*TABLE_4), youn.measured(youn.MEASURED_V)
    teeth = "{:g} V on +-{:g} degrees".format(*youn.POTENTIOMETER)
    whole = series(36.0 * printed_total(youn.K_SHAFT, youn.K_34), 36.0 * youn.K_12) / 36.0
    k = f"{youn.K_34 / 1e8:g}e8"
    return [
        f"the error is {budget[total]:.4f} degrees, not {ANGLES[total]}",
        f"The measured {youn.MEASURED} degrees are {d:.3f}, within the computed backlash",
        "Table 4: {:g}, {:g} mm, N_b {:g} |".format(*TABLE_4),
        "{:g}, {:g} mm, N_b 122/13 |".format(*OTHER),
        f"behind a gear 1 of {youn.GEARS[0].diameter:g} mm",
        f"+-{teeth}, so that {1e3 * youn.MEASURED_V:g} mV are {d:.3f} degrees, not "
        f"{youn.MEASURED}; {youn.MEASURED} would be {1e3 * youn.MEASURED / youn.measured(1.0):.1f} "
        f"mV. A reversal shows lost motion and no pitch error: {d:.3f} is to be compared with the "
        f"backlash at the output, {budget[lash]:.4f} in the worst case",
        f"Why {k} is not",
        f"K_s12 = {youn.K_12 / 1e8:g}e8, K_s34 = {k} and, of shaft 2, k_s = "
        f"{youn.K_SHAFT / 1e8:g}e8 gf cm/rad",
        f"the printed {youn.K_34 / youn.K_12:.2f} is none of them",
        f"{youn.K_12 / 1e8:g}e8 comes out",
        f"{k} would need",
        f"for every k_s that rounds to {youn.K_SHAFT / 1e8:g}e8",
        f"with it, it would be {whole / 1e6:.3f}e6",
        f"with {BEST:.4f} |",
        f"Buckingham's mean Z is {BUCKINGHAM}, unverified",
        "each mesh at their F_pT, on the diameters of Table 4",
        f"The paper takes grade {min(grade_of(p, d) for p, d in DEVIATIONS):.0f}, nearly",
        f"module of {SCOPE['module'][0]:g} mm is its edge",
        f"Modules below {SCOPE['module'][0]:g} mm are outside",
    ]


def about_angles():
    w, other = windows(), angles(50.0, 122.0, 8.0)
    sums = youn.RADIAL_SUMS
    single = 50 / 8 * 122 / 13
    return [
        f"N_opt = {BEST:.5f}; 48 costs {1e8 * lost(48.0):.1f}e-8 of the acceleration",
        f"Delta_r = {sums[0]:.4f} and {sums[1]:.4f} mm",
        f"D2 = {OTHER[0]:g}, D4 = {OTHER[1]:g} mm and 122/13 = {OTHER[2]:.3f} after stage 12",
        f"D4 is {max(w[2][0], w[3][0]):.2f} to {min(w[2][1], w[3][1]):.2f} mm",
        f"the ratio after stage 12 is {max(w[4][0], w[5][0]):.2f} to {min(w[4][1], w[5][1]):.2f}",
        f"with 8 the output would be {other['backlash at the output']:.5f} and "
        f"{other['pitch error at the output']:.5f} degrees",
        f"50/8 x 122/13 = {single:.2f} instead of 48, which costs {100 * lost(single):.1f} % of "
        "acceleration",
        f"its {ANGLES['backlash of stage 12']} asks for D2 of {w[0][0]:.2f} to {w[0][1]:.2f} mm, "
        f"the {ANGLES['pitch error of stage 12']} for {w[1][0]:.2f} to {w[1][1]:.2f} mm",
        f"0.053 + 0.038 = 0.091, while unrounded it is {angles(*OTHER)['both at the output']:.5f}",
    ]


def about_stiffness():
    total, shares, frequency = chain()
    other, _, _ = chain("Y")
    turn = youn.LOAD / total
    k = youn.lines()
    wrong, budget = math.degrees(CLAIMED), ANGLES["both at the output"]
    y = [v / math.pi for v in youn.LEWIS]
    z = [youn.tooth_factor(v) for v in y]
    return [
        f"{total / GF_CM / 1e8:.3f}e8 gf cm/rad = {1e-7 * total:.3f}e4 N m/rad",
        f"{youn.LOAD_GFCM / 1e3:g} kgf cm ({1e-3 * youn.LOAD:.4f} N m, assumed to act at the "
        f"output) turns it by {1e5 * turn:.3f}e-5 rad = {math.degrees(turn):.6f} degrees",
        f"{math.degrees(youn.LOAD / other):.6f} with Y for y",
        f"frequency is {frequency:.1f} Hz",
        f"Seen from the motor it is {total / GF_CM / 48**2 / 1e5:.2f}e5 gf cm/rad",
        f"{1e-3 * k[0]:.1f} and {1e-3 * k[1]:.1f} N/(mm µm)",
        f"y = {', '.join(f'{v:.4f}' for v in y)} and Z = {', '.join(f'{v:.4f}' for v in z)}",
        f"4300/1.17e6 = {CLAIMED:.6f} is in rad, which is {wrong:.4f} degrees",
        f"{wrong / float(budget):.1f} times the whole {budget} degrees",
        f"{wrong / math.degrees(turn):.0f} times the right one; as {youn.ELASTIC} degrees it is "
        f"{youn.ELASTIC / math.degrees(turn):.1f} times too large",
    ]


def about_section_2():
    """Windup and frequency with both meshes at either end; fits by the circle of the axis."""
    (last, shaft, first), (_, n, _) = youn.springs()
    ends = [1.0 - 0.5 * youn.VARIATION, 1.0 + 0.5 * youn.VARIATION]
    soft, hard = (last / e + (shaft + first / e) / n**2 for e in ends)
    soft_turn, hard_turn = (math.degrees(youn.LOAD * c) for c in (soft, hard))
    low, high = ((1.0 / (c * youn.J_L)) ** 0.5 / (2.0 * math.pi) for c in (soft, hard))
    (housing, case), (seat, ring) = youn.FITS
    play = 0.5 * (case + ring)
    both = sum(2.0 * 1e-3 * play / (0.5 * d) / n for d, n in ((48.0, 8.0), (104.0, 1.0)))
    fits = math.degrees(2.0 * both / math.cos(youn.ALPHA))
    apart = math.degrees(2.0 * both * math.tan(youn.ALPHA))
    backlash = angles(*TABLE_4)["backlash at the output"]
    return [
        "Section 2.1 says, after no. 6, that the stiffness of teeth in contact varies by about "
        f"{100 * youn.VARIATION:g} % over a mesh",
        "2/cos(alpha) of this is lost motion",
        f"From {100 * ends[0]:g} to {100 * ends[1]:g} % of the mean",
        f"winds the train by {soft_turn:.6f} degrees where both meshes are softest, of which "
        f"{soft_turn - hard_turn:.6f} degrees come and go, and the frequency lies between "
        f"{low:.1f} and {high:.1f} Hz",
        f"{housing:g} to {case:g} µm between bearing and housing and {seat:g} to {ring:g} µm "
        "between bearing and shaft",
        f"leave an axis free within up to {play:g} µm",
        f"{fits:.5f} degrees at the output, {100 * fits / backlash:.0f} % of the backlash of "
        f"{backlash:.4f} degrees",
        f"would count {apart:.5f} degrees of it, {math.sin(youn.ALPHA):.3f} times as much",
    ]


def about_meshes():
    low, high = ratios_of((0, 2)), ratios_of((1, 3))
    widths = [youn.WIDTH * youn.K_34 / rule(4.0, (0, 2), v, v)[1] for v in ("y", "Y")]
    mixed, misread = rule(4.0, (0, 2), "Y", "y"), 4.8e8
    off = 100.0 * max(1.0 - k / p for k, p in zip(mixed, (youn.K_12, misread), strict=True))
    shaft = 1.0 / (1.0 / (36.0 * 1.165e6) - 1.0 / youn.K_34)
    mean = BUCKINGHAM / 2.0 * youn.E * youn.WIDTH * 24.0**2 / GF_CM
    return [
        f"between {low[0]:.2f} and {low[1]:.2f} on the pinions and between {high[0]:.2f} and "
        f"{high[1]:.2f} on the wheels",
        f"face width of {widths[0]:.1f} mm (y) or {widths[1]:.1f} mm (Y)",
        f"{mean / 1e8:.2f}e8 is r² F E Z/2 of gear 2 with Z = {BUCKINGHAM}",
        f"a misprint of {misread / 1e8:g}e8, one mixed rule would give both within {off:.1f} % "
        f"({mixed[0] / 1e8:.2f} and {mixed[1] / 1e8:.2f}e8)",
        f"then K_TS would be {printed_total(0.465e8, 4.75e8) / 1e6:.3f}e6 or more",
        f"K_TS itself fits 3.8e8: it is {printed_total(youn.K_SHAFT, youn.K_34) / 1e6:.3f}e6, and "
        f"1.17e6 with k_s of {shaft / 1e8:.4f}e8 to 0.475e8",
    ]


def about_standards():
    grades = [grade_of(p, d) for p, d in DEVIATIONS]
    normal, tangential, angle = least_backlash()
    one = angles(*TABLE_4)["pitch error at the output"]
    scope = (
        f"{name} {low:g} to {high:g}"
        for name, (low, high) in SCOPE.items()
        if name != "helix_angle"
    )
    return [
        f"29 µm on 48 mm is grade {grades[0]:.2f} and 33 µm on 104 mm {grades[1]:.2f}",
        f"its {one:.4f} degrees, for one gear of each mesh, is what both gears of grade 5 give",
        f"j_bn = (2/3)(0.06 + 0.0005 a + 0.03 m) mm, is {normal:.4f} mm for a = 58.5 and m = 0.5 "
        f"mm, which is j_t = {tangential:.4f} mm or {angle:.4f} degrees at gear 4",
        f"({', '.join(scope).replace('_', ' ')})",
    ]
