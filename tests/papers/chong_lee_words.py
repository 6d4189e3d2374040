"""Rows of docs/multi_stage.md that are sentences with numbers in them: rules and errata."""

import math

import chong_lee as paper
from chong_lee import DESIGNS, K, chain, modules, niemann, recomputed, sixth, train

from gearopt.formulations.drive import processes as process
from gearopt.physics.loads import k_factor, unit_load

SPLIT = (4.96, 4.36)  # as printed for both processes of Table 2
TOTAL = 1450 / 66.5
TEETH = (27, 26, 27)  # pinions of Table 4


def from_loads():
    """Balanced teeth, and modules by unit load and by K-factor, of process one in Table 2."""
    own, found = train(2), []
    torque, cosine = own.torque, own.stages[0].toothing.cosine
    for stage, u, share in zip(own.stages, SPLIT, paper.PROPORTIONS[2], strict=True):
        balanced = paper.U / K * (u + 1) / u * cosine
        z = process.balanced_pinion(own.law, stage, u)
        d = z / cosine
        by_root = math.cbrt(unit_load(torque, d, share * d, 1.0) / paper.U)
        by_contact = math.cbrt(k_factor(torque, d, share * d, u) / K)
        found.append((balanced, z, by_root, by_contact))
        torque *= u
    return found


def centres(first=150.0, square=True):
    """(a2, K2/K1) of the elevator; square: False for eq. (3) with the cube as printed."""
    f, m = process.load_share(*SPLIT), 0.6 / 0.75
    growth = f * (SPLIT[1] + 1) / (SPLIT[0] + 1) * m
    a2 = first * growth ** (1 / 3 if square else 1 / 4)
    d = [process.pinion_diameter(a, u) for a, u in zip((first, a2), SPLIT, strict=True)]
    torque = train(2).torque
    loads = [
        k_factor(t, one, share * one, u)
        for t, one, share, u in zip(
            (torque, torque * SPLIT[0]), d, paper.PROPORTIONS[2], SPLIT, strict=True
        )
    ]
    return a2, loads[1] / loads[0]


def rule_rows():
    """What the rules give beside what is printed."""
    one, two = from_loads()
    cosine = train(2).stages[0].toothing.cosine
    d1 = process.pinion_diameter(150.0, SPLIT[0])
    d2 = process.pinion_diameter(centres()[0], SPLIT[1])
    small = modules(chain(3, 160.0, paper.PROPORTIONS[3]), TEETH)
    enlarged = modules(chain(3, 160.0, paper.PROPORTIONS[3], after={0: 182.06}), TEETH)
    later = modules(chain(3, 160.0, paper.PROPORTIONS[3], after={1: 223.43}), TEETH)
    wheels = [u * z for u, z in zip(niemann(3), TEETH, strict=True)]
    return [
        f"| process one, Table 2 | z1 = (U/K)((u + 1)/u) cos(beta) | {one[0]:.2f}, {two[0]:.2f} "
        "| 25, 25 | cut |",
        f"| | m from U; from K | {one[2]:.3f}, {two[2]:.3f}; {one[3]:.3f}, {two[3]:.3f} mm "
        "| 2, 3 | next module up; 2.5 mm is too small for stage 2 |",
        "| | z2 = u z1 with u = 4.96, 4.36 | 124.00, 109.00 | 124, 109 | |",
        f"| process two, Table 2 | z1 = d1 cos(beta)/m, a1 = 150 mm | {d1 * cosine / 2:.2f}, "
        f"{d2 * cosine / 3:.2f} | 23, 25 | up |",
        "| process two, Table 4 | m = d1 cos(beta)/z1, a1 = 160 mm, nothing rounded before, "
        "b3 = 0.75 d1 (Table 3) | "
        f"{', '.join(f'{m:.3f}' for m in small)} mm | 1.25, 3, 4 "
        "| next module up would be 1.25, 2.5, 4: 2.5 mm is skipped |",
        f"| | the same, a1 after the module of stage 1 | {enlarged[1]:.3f}, {enlarged[2]:.3f} mm "
        "| 3, 4 | stage 3 would be 5 mm |",
        f"| | the same, a2 after the module of stage 2 | {later[2]:.3f} mm | 4 | would be 5 mm |",
        f"| | z2 = u z1, u after eq. (8) | {', '.join(f'{z:.2f}' for z in wheels)} | 237, 109, 80 "
        "| cut: to the nearest it would be 238, 110, 80 |",
    ]


def made_of(name):
    """Modules [mm], pinion and wheel teeth of a printed design."""
    return [(row.m, row.z1, row.z2) for row in DESIGNS[name]]


def used():
    """Least and most of K/2.07 and U/48 in both processes of Table 2."""
    names = ("Table 2, process one", "Table 2, process two")
    stages = [s for name in names for s in recomputed(name)["stages"]]
    shares = [s["k_factor_MPa"] / K for s in stages]
    shares += [s["unit_load_MPa"] / paper.U for s in stages]
    return min(shares), max(shares)


def sentences():
    """Sentences of the page with numbers in them, white space aside."""
    cosine = train(3).stages[0].toothing.cosine
    spans = ", in ".join(f"{low:.2f} to {high:.2f}" for low, high in balance_needed())
    volumes = [recomputed(name)["gear_volume_mm3"] for name in DESIGNS]
    over = [100 * (v / paper.optimum(2) - 1) for v in volumes[:3]]
    one = from_loads()[0]
    least, most = used()
    return [
        f"27, 26, 27 teeth need (U/K) cos(beta) in {spans}.",
        f"That of the elevator is {paper.U / K * cosine:.2f}, which gives 26 and 27",
        f"K would be {skipped():.2f} MPa, above the 2.07 MPa",
        f"the designs of Table 2 are {min(over):.0f} to {max(over):.0f} % above the optimum",
        f"use {100 * least:.0f} to {100 * most:.0f} % of the K and U",
        f"{one[3]:.3f} mm becomes 2 mm, so that K is ({one[3]:.3f}/2)^3 = "
        f"{(one[3] / 2) ** 3:.3f} of its limit",
    ]


def skipped():
    """K-factor [MPa] of stage 2 of Table 4, process two, with a module of 2.5 mm."""
    own = train(3)
    first, second, _ = DESIGNS["Table 4, process two"]
    d = 2.5 * second.z1 / own.stages[0].toothing.cosine
    return k_factor(own.torque * first.z2 / first.z1, d, 0.6 * d, second.z2 / second.z1)


def balance_needed():
    """Least and most (U/K) cos(beta) that give the pinions of process one in Table 4."""
    rows = DESIGNS["Table 4, process one"]
    shares = [1.0 + row.z1 / row.z2 for row in rows]
    return [(row.z1 / s, (row.z1 + 1) / s) for row, s in zip(rows, shares, strict=True)]


def errata_rows():
    """The thirteen errata, each with the numbers that show it."""
    a2, even = centres()
    cubed, odd = centres(square=False)
    elevator = recomputed("elevator")["stages"]
    third = recomputed("Table 4, process one")["stages"][2]
    second = recomputed("Table 4, process one")["stages"][1]
    first = recomputed("Table 2, process one")["stages"]
    shares = [s["face_width_mm"] / s["pinion_diameter_mm"] for s in first]
    grown = ((TOTAL + 1) ** 3 / TOTAL) / ((4.96 + 1) ** 3 / 4.96)
    u1, u2 = niemann(2)
    b = "face_width_mm"
    d1 = "pinion_diameter_mm"
    return {
        1: f"(3): (a2/a1)^3 | (a2/a1)^2 | elevator, a1 = 150 mm: a2 = {a2:.2f} mm loads both "
        f"stages alike (K2/K1 = {even:.3f}); with the cube a2 = {cubed:.2f} mm and K2/K1 = "
        f"{odd:.3f}",
        2: "(14): sigma_Hlim1/sigma_Hlim2 | its square | with K1 = 2 K2 allowed, the square uses "
        f"both limits alike; as printed stage 2 carries {math.sqrt(2):.3f} times its share",
        3: "(12): m_a = d_p/b | b/d_p | Table 2, process one: b/d1 = "
        f"{shares[0]:.3f}, {shares[1]:.3f}; d1/b = {1 / shares[0]:.3f}, {1 / shares[1]:.3f}",
        4: "(6): no pi; minimised with b1 a1^2 fixed | pi; b1 a1^2 grows as (u1 + 1)^3/u1 | from "
        f"u1 = 4.96 to 21.80 that factor grows {grown:.1f}-fold while the rest of (6) falls from "
        f"{sixth(4.96, TOTAL):.3f} to {sixth(TOTAL, TOTAL):.3f}",
        5: "(1): E_r; (2): = | E_g; proportional | P = 2.094e-7 K u/(u + 1)^3 n b a^2 [kW, MPa, "
        "rpm, mm] in all twelve stages of Tables 2 and 4",
        6: f"Table 2, process two: u1 = 4.96 | (7) gives {u1:.2f} | {u1:.4f} x {u2:.4f} is not "
        "4.96 x 4.36",
        7: "two equations numbered (13) | the second is another | the width b = 2 a m_a/(u + 1), "
        "and the objective F",
        8: "Table 2, elevator: a = 198, 219; d2 = 355.23 | "
        f"{elevator[0]['centre_distance_mm']:.2f}, {elevator[1]['centre_distance_mm']:.2f}; "
        f"{elevator[1]['wheel_diameter_mm']:.2f} | from m, z, beta; profile shift or rounding may "
        "explain a, not d2",
        9: f"Table 4, process one: d2 = 384.97 | {third['wheel_diameter_mm']:.2f} | "
        f"m z2/cos(beta), and 2 a - d1 = {2 * 251.57 - 119.16:.2f} with the printed a and d1",
        10: "Table 4: b = 95.3; process one b2 = 47.8 | 0.75 d1 = "
        f"{0.75 * third[d1]:.2f}; 0.6 d1 = {0.6 * second[d1]:.2f} | b/d1 = "
        f"{third[b] / third[d1]:.3f} and {second[b] / second[d1]:.3f}; Table 3 says 0.75 and 0.6",
        11: "carburised and case hardened, 335 and 300 HB | contradictory | 335 and 300 HB lie in "
        "the 225 to 352 HB of quenched and tempered steel; carburised teeth have 55 to 63 HRC "
        "([KHK](https://khkgears.net/new/gear_knowledge/gear-nomenclature/hardness-of-gears.html))",
        12: 'Fig. 2 for a total ratio of "2" | probably 20 | not verifiable without the figure: '
        "(6) falls on all of [1, u] for u = 2 as for u = 20",
        13: "all examples have one material | s = 1 | errata 1 and 2 change nothing in Tables 2 "
        f"and 4: (14) as printed gives the same a2 = {a2:.2f} mm",
    }


def errata_lines():
    return [f"| {n} | {text} |" for n, text in errata_rows().items()]
