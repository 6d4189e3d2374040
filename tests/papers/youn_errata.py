"""The twenty errata of docs/servo_train.md, each with the numbers that show it."""

import math

import youn
from youn import ANGLES, OTHER, TABLE_4, angles, chain
from youn_words import CLAIMED, DEVIATIONS, grade_of, printed_total, windows

from gearopt.physics.servo_drive import load_acceleration

NU = 0.28  # of steel, unverified


def first():
    """Acceleration [rad/s2] at N = 48 by eq. (3), and motor torque [N mm] of it by eq. (1)."""
    a = load_acceleration(48.0, youn.J_L, youn.J_M, 47.0, youn.LOAD)
    return a, (youn.J_L / 48.0**2 + youn.J_M) * 48.0 * a + youn.LOAD / 48.0 + 3.0


def slope():
    """Slope of eq. (4) by N [rad/s2] at N = 40 for 50 N mm, by a central difference."""
    a = [load_acceleration(40.0 + h, youn.J_L, youn.J_M, 50.0) for h in (-1e-3, 1e-3)]
    return (a[1] - a[0]) / 2e-3


def printed_slope():
    """Eq. (5) as printed at N = 40 [rad/s2 for 1 N mm]."""
    reflected = 40.0**2 * youn.J_M
    return (youn.J_L - reflected) / (youn.J_L + reflected) ** 2


def diagonal():
    """Length [mm] left along the axis of a full gear 4 that stands on the diagonal of 80 x 80."""
    return 80.0 * math.sqrt(2.0) - 105.0


def equations():
    """Errata 1 to 9."""
    a, torque = first()
    mine, other = angles(*TABLE_4)["both at the output"], angles(*OTHER)
    w = windows()
    k = [1e-3 * v for v in youn.lines()]
    total = printed_total(youn.K_SHAFT, youn.K_34)
    right, literal = youn.shaft_stiffness(), youn.shaft_stiffness(literal=True)
    lengths = [50.0 * v / youn.K_SHAFT for v in (right, literal)]
    return {
        1: "(1), legend: J_L twice, F_M inertia of the gimbal, F_L friction of the motor; one dot "
        "| J_M the second time; F_M, F_L friction torques of motor and load; two dots | so read, "
        f"the {a:.3f} rad/s² that (3) gives at N = 48 for T_M = 50, F_M = 3 and F_L = "
        f"{youn.LOAD:.1f} N mm (assumed) need {torque:.1f} N mm by (1). The dots may be a fault of "
        "the reading",
        2: "(5) | times T_M | at N = 40, T_M = 50 N mm (assumed) (4) grows by "
        f"{slope():.4f} rad/s² a unit of N = 50 x {printed_slope():.6f} as printed; the root stays",
        3: f"Delta_r = 0.0512, 0.0649 degrees | mm | the sums of Table 2 in mm: "
        f"{youn.RADIAL_SUMS[0]:.4f}, {youn.RADIAL_SUMS[1]:.4f}",
        4: "angles of section 3.1 | those of Table 4 | 48, 104 mm and 8 give "
        f"{mine:.4f} degrees at the output, the printed 0.091 is {100 * (1 - 0.091 / mine):.0f} % "
        f"less; 50, 122 mm and 122/13 give {other['both at the output']:.4f}",
        5: f"backlash of stage 12: 0.086 degrees | {other['backlash of stage 12']:.4f} with 50 mm "
        f"| no D2 gives 0.086 ({w[0][0]:.2f} to {w[0][1]:.2f} mm) and 0.066 ({w[1][0]:.2f} to "
        f"{w[1][1]:.2f} mm); probably a rounding on the way",
        6: '(11): K_TS = the sum; N_a = 1/6 of gears 1 and 2, "nearest to the load" | 1/K_TS = the '
        "sum; N = speed of the spring's shaft over that of the output | "
        f"K_TS is k_s and K_s34 in series by 36, {total / 1e6:.3f}e6: a stiffness at the motor, "
        "but turned by the torque at the load; (1) has N_a = 6, and stage 34 is nearest to the "
        "load",
        7: "(12): 4 D² with D a radius | r², without 4 | 4 on a radius makes the teeth "
        f"{4 * k[0]:.0f} and {4 * k[1]:.0f} N/(mm µm) stiff, on a diameter {16 * k[0]:.0f} and "
        f"{16 * k[1]:.0f}, corrected {k[0]:.1f} and {k[1]:.1f} (steel: about 14, "
        "by ISO 6336, unverified)",
        8: f"(13): pi G D⁴/(2 L) with D a diameter | 32 for 2 | {literal / 1e6:.1f}e6 for "
        f"{right / 1e6:.3f}e6 gf cm/rad: {literal / right:.0f} times",
        9: f"k_s = 0.47e8 gf cm/rad | {right / 1e6:.2f}e6 | needs L = {lengths[0]:.1f} mm, or as "
        f"(13) is printed {lengths[1]:.0f} mm; Table 5 has 50 mm: {youn.K_SHAFT / right:.1f} times",
    }


def results():
    """Errata 10 to 14."""
    turn = youn.LOAD / chain()[0]
    budget = angles(*TABLE_4)
    nu, softer = youn.E / (2.0 * youn.G) - 1.0, youn.E / (2.0 * (1.0 + NU))
    bound = chain(shear=softer)
    double = angles(*TABLE_4, pitch=[2.0 * p for p in youn.PITCH])
    return {
        10: f"elastic angle 0.0037 degrees (0.003 in section 3.2) | {math.degrees(turn):.6f} "
        f"degrees | 4300/1.17e6 = {CLAIMED:.5f} rad, {math.degrees(CLAIMED):.4f} degrees",
        11: f"8 mV = 0.06 degrees | {youn.measured(8e-3):.3f} | 45/10 degrees a volt; 0.06 degrees "
        f"are {1e3 * 0.06 * 10 / 45:.1f} mV",
        12: "0.06 compared with 0.091 | 0.036 with the backlash alone | reversing shows lost "
        f"motion, no pitch error: {ANGLES['backlash at the output']} printed, "
        f"{budget['backlash at the output']:.4f} by Table 4; 0.06 would contradict the printed "
        "one, 0.036 contradicts neither",
        13: "Table 3: one pitch error a mesh | one a gear | if the other gear of each mesh had as "
        f"much: {double['pitch error at the output']:.4f} for "
        f"{budget['pitch error at the output']:.4f} degrees at the output",
        14: f"Table 5: E {1e-3 * youn.E:.1f} with G {1e-3 * youn.G:.1f} GPa | G "
        f"{1e-3 * softer:.1f} GPa | Poisson's ratio would be {nu:.2f}; with {NU} (of steel, "
        f"unverified) G is {100 * (youn.G / softer - 1):.0f} % too large, and the output "
        f"{100 * (1 - bound[0] / chain()[0]):.0f} % softer than above",
    }


def wording():
    """Errata 15 to 20."""
    share, discs = youn.weights()
    swapped = [youn.GEARS[2].weight_g / discs[0], youn.GEARS[0].weight_g / discs[2]]
    total = 0.091 + youn.SENSOR + youn.ELASTIC
    grades = [grade_of(p, d) for p, d in DEVIATIONS]
    return {
        15: "Table 1: 15, 11, 1.5, 17.5 g | not known | gear 1 is "
        f"{share[0]:.1f} times a solid disc ({discs[0]:.1f} g at 7.75 g/cm³, assumed), gear 4 "
        f"{100 * share[3]:.1f} % of one ({discs[3]:.0f} g); with rows 1 and 3 exchanged gear 1 is "
        f"{swapped[0]:.2f} and gear 3 still {swapped[1]:.2f} times its disc",
        16: "a full gear 4 in the box | most likely a sector | its tip diameter 105 mm exceeds 80, "
        "so that it lies on no face; standing on the diagonal of 80 x 80 it leaves "
        f"{diagonal():.1f} mm along its axis, with a width of 6. The travel of +-45 degrees agrees",
        17: f'0.0004 degrees, of the sensor, "backlash" | its accuracy | and the sum 0.091 + '
        f"0.0004 + 0.0037 = {total:.4f} is never made",
        18: "(8), (12), (13) after nos. 4, 5 | probably nos. 6, 7 | "
        + ", ".join(f"no. {n} is *{title}*" for n, title in youn.REFERENCES.items()),
        19: "g/cm², g-cm, Kg·cm | gf/cm², gf cm, kgf cm | as gram-force E is "
        f"{1e-3 * youn.E:.1f} and G {1e-3 * youn.G:.1f} GPa, of steel",
        20: 'Table 1: "AGMA QIID" | Q11D, a guess | may be a fault of the reading; Table 3 is '
        f"grade {grades[0]:.2f}, {grades[1]:.2f} of ISO 1328-1, Q {17 - max(grades):.1f} by Q = 17 "
        "- grade (a rule of thumb, unverified), nearer to 11 than to the 13 of the other gears",
    }


def errata_rows():
    return equations() | results() | wording()


def errata_lines():
    return [f"| {n} | {text} |" for n, text in errata_rows().items()]
