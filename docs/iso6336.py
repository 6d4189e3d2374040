"""The page "Rating by ISO 6336": formulas, choices, published values beside computed ones."""

import iso6336_cases
from agma import grid
from agma_cases import digits, printed

from gearopt.physics.iso6336.factors import CLAUSES
from gearopt.physics.iso6336.materials import LINES, MATERIALS
from gearopt.physics.iso6336.refusals import SENTENCES
from gearopt.physics.planetary.loads import MESH_LOAD_FACTORS

HEAD = """\
# Rating by ISO 6336

External spur and helical gears by ISO 6336, parts 1, 2, 3 and 5, method B, and 6: by
[gearopt rate](rate.md), and from Python by `gearopt.physics.iso6336`, which takes
[rings and planetary stages](#rings-and-planetary-stages), too. `edition` is 2006 or 2019,
tolerances are those of ISO 1328-1:1995 or 2013. The standards themselves were not read: formulas
and values are from public programs, printed reports, rules of ship classes that repeat parts of
them (IACS UR M56) and tables. What has fewer than two sources is marked
*unverified*, in the result too (`Rating.unverified`). Scuffing and micropitting are not rated.

```python
import math

from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.case import Practice
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.iso6336.rating import rate
from gearopt.physics.rating import Operation

pair = GearPair.of_teeth(3.0, 21, 63, 30.0, profile_shifts=(0.2, 0.0))  # m_n, z1, z2, b in mm
operation = Operation(power=7.5e6, pinion_speed=1450 * math.pi / 30, hours=20000)  # N mm/s, rad/s
steel = Material("Eh", "MQ")  # case-hardened
rating = rate(pair, operation, (steel, steel), Practice(grades=(7, 7)))
print([round(s, 2) for s in rating.bending_safety + rating.contact_safety], rating.governs)
```

Inside everything is mm, N, MPa, rad, s; stiffness per face width is in MPa: 1 N/(mm um) is 1000
MPa. `given={"K_Hbeta": 1.15}` puts a factor of yours in the place of a computed one, any of them;
what follows from it is computed from it.
"""

# quantity, formula, source, function
FORMULAS = (
    (
        "sigma_H0",
        "Z_H Z_E Z_eps Z_beta sqrt(F_t (u + 1)/(d_1 b u))",
        "part 2, 5",
        "`contact_factors.contact_stress`",
    ),
    (
        "sigma_H",
        "Z_B sigma_H0 sqrt(K_A K_v K_Hbeta K_Halpha), Z_D of the wheel",
        "part 2, 5",
        "`chain`",
    ),
    ("sigma_HG", "sigma_Hlim Z_NT Z_L Z_v Z_R Z_W Z_X", "part 2, 5", "`chain`"),
    (
        "sigma_F0",
        "F_t/(b_F m_n) Y_F Y_S Y_beta Y_B Y_DT",
        "part 3, 5",
        "`bending_factors.root_stress`",
    ),
    ("sigma_F", "sigma_F0 K_A K_v K_Fbeta K_Falpha", "part 3, 5", "`chain`"),
    ("sigma_FG", "sigma_Flim Y_ST Y_NT Y_deltarelT Y_RrelT Y_X Y_M", "part 3, 5", "`chain`"),
    ("S_H, of stress; S_F", "sigma_HG/sigma_H; sigma_FG/sigma_F", "parts 2, 3", "`rating.rate`"),
    (
        "c'",
        "c'_th C_M C_R C_B cos(beta) E/E_st; times (w/100)^0.25 below w = F_t K_A/b = 100 N/mm "
        "(*unverified*: in no source at hand; DIN 3990 is linear there)",
        "part 1, 9.3",
        "`stiffness.single_stiffness`",
    ),
    (
        "c_gamma_alpha, c_gamma_beta",
        "c' (0.75 eps_alpha + 0.25); 0.85 of it",
        "part 1, 9.3",
        "`stiffness.mesh_stiffness`",
    ),
    (
        "K_v, N ≤ N_S",
        "1 + N (C_v1 B_p + C_v2 B_f + C_v3 B_k)",
        "part 1, 6.5",
        "`load_factors.dynamic_factor`",
    ),
    (
        "K_v, N to 1.15; from 1.5",
        "1 + C_v1 B_p + C_v2 B_f + C_v4 B_k; C_v5 B_p + C_v6 B_f + C_v7; straight between "
        "(*unverified*: no published value)",
        "part 1, 6.5",
        "`load_factors.dynamic_factor`",
    ),
    (
        "f_sh",
        "w 0.023 um (abs(0.7 + K) + 0.3) (b/d_1)², w = F_t K_A K_v/b; K = K' l s/d_1² (d_1/d_sh)⁴: "
        "choice 19",
        "part 1, 7.5",
        "`load_factors.shaft_misalignment`",
    ),
    (
        "K_Hbeta",
        "1 + x, 2 sqrt(x) from x = 1; x = F_betay c_gamma_beta/(2 F_m/b), F_betax = 1.33 B_1 f_sh "
        "+ B_2 f_ma",
        "part 1, 7.5, method C",
        "`load_factors.face_load_factor`",
    ),
    (
        "K_Fbeta",
        "K_Hbeta^(1/(1 + h/b + (h/b)²)); K_Hbeta of crowned teeth and end relief",
        "part 1, 7.6",
        "`load_factors.root_face_load_factor`",
    ),
    (
        "K_Halpha, K_Falpha",
        "eps_gamma/2 (0.9 + 0.4 q), or 0.9 + 0.4 sqrt(2 (eps_gamma - 1)/eps_gamma) q above "
        "eps_gamma = 2; q = c_gamma_alpha (f - y_alpha)/(F_tH/b)",
        "part 1, 8.3",
        "`load_factors.transverse_load_factor`",
    ),
    (
        "y_alpha, y_beta, C_ay",
        "by material, sigma_Hlim and speed; y_alpha of cast iron, and of tempered steel "
        "above 5 m/s, *unverified*",
        "part 1, 6.5, 7.5, 8.3",
        "`running_in`",
    ),
    (
        "Z_H",
        "sqrt(2 cos(beta_b) cos(alpha_wt)/sin(alpha_wt))/cos(alpha_t)",
        "part 2, 6",
        "`contact_factors.zone_factor`",
    ),
    (
        "Z_B, Z_D",
        "M_1, M_2, at least 1, for spur gears; 1 for eps_beta ≥ 1 (2019: sqrt(f_ZCa), "
        "*unverified* but for 1.2); straight in eps_beta between",
        "part 2, 6",
        "`contact_factors.single_contact_factor`",
    ),
    (
        "Z_eps",
        "sqrt((4 - eps_alpha)/3 (1 - eps_beta) + eps_beta/eps_alpha)",
        "part 2, 8",
        "`contact_factors.contact_ratio_factor`",
    ),
    ("Z_beta", "1/sqrt(cos(beta))", "part 2, 9", "`contact_factors.helix_factor`"),
    (
        "Z_L, Z_v, Z_R",
        "by nu_40, v, R_z10 and C_ZL, C_ZR of the softer gear",
        "part 2, 12",
        "`contact_factors`",
    ),
    (
        "Z_W",
        "(1.2 - (HB - 130)/1700) (3 um/R_zH)^0.15; 1 + A (u - 1) of two tempered gears "
        "(static strength *unverified*)",
        "part 2, 13",
        "`contact_factors.work_hardening_factor`",
    ),
    (
        "Y_F",
        "6 h_F cos(alpha_Fen)/(s_Fn² cos(alpha_n)) at the 30-degree tangent of the rack's fillet; "
        "2019: times f_eps (*unverified* "
        "for eps_beta < 1 and eps_alphan ≥ 2)",
        "part 3, 6",
        "`tooth_form.tooth_form`",
    ),
    (
        "Y_S",
        "(1.2 + 0.13 L) q_s^(1/(1.21 + 2.3/L)), L = s_Fn/h_F, q_s = s_Fn/(2 rho_F)",
        "part 3, 7",
        "`tooth_form.tooth_form`",
    ),
    (
        "Y_beta",
        "1 - eps_beta beta/120°; 2019: over cos(beta)³",
        "part 3, 8",
        "`bending_factors.helix_factor`",
    ),
    (
        "Y_B, Y_DT",
        "1.6 ln(2.242 h_t/s_R); 2.366 - 0.666 eps_alphan of grades to 4",
        "part 3, 9, 10",
        "`bending_factors.rim_factor`, `deep_tooth_factor`",
    ),
    (
        "Y_deltarelT",
        "(1 + sqrt(rho' chi))/(1 + sqrt(rho' chi_T)); rho' of St and cast iron, and a yield "
        "point that is estimated, *unverified*",
        "part 3, 13",
        "`bending_factors.notch_factor`",
    ),
    (
        "Y_RrelT",
        "1.674 - 0.529 (R_z + 1)^0.1 and two more, of cast iron *unverified*",
        "part 3, 14",
        "`bending_factors.surface_factor`",
    ),
    ("Y_X", "1.05 - 0.01 m_n and two more", "part 3, 15", "`bending_factors.size_factor`"),
    (
        "Z_NT, Y_NT",
        "straight in log-log from static to reference strength, to `life_factor_at_1e10` (0.85)",
        "parts 2, 3",
        "`curves`",
    ),
    (
        "static strength",
        "the rating at N_L = 0, the peak torque in place of K_A: Z_NT, Y_NT static, Z_L = Z_v = "
        "Z_R = 1, Y_deltarelT static, Y_RrelT = Y_X = 1",
        "parts 2, 3",
        "`static`",
    ),
    (
        "load spectrum",
        "sum n_i/N_i = 1 (of bending *unverified*)",
        "part 6",
        "`rating.rate_spectrum`",
    ),
)
CHOICES = """
## Choices

Correct programs differ in these; this one does as follows.

1. The pinion of c' is the gear with fewer teeth. c_gamma_alpha is not reduced for eps_alpha < 1.2.
2. K_Halpha and K_Falpha take the larger of f_pb and f_falpha, less y_alpha of f_pb; q stands
   outside the square root, so that both branches meet at eps_gamma = 2.
3. K_Fbeta takes h = (h_aP + h_fP) m_n of the rack, without tip alteration, as both published
   cases do.
4. The load's angle is that of the standard's z_n = z/(cos² beta_b cos beta). The printed report is
   met to its last digit by z/cos³ beta: 0.015° of alpha_Fen, 0.16 % of h_F, 0.1 % of Y_F.
5. Y_F takes the nominal shift x; `shift="generating"` the one that thins the tooth, x_E: Y_F is 1.5
   to 4 % larger. c' takes x.
6. Z_beta is 1/sqrt(cos beta), of the corrigendum of 2008 and of 2019. Z_X is 1.
7. Between static and reference strength every factor follows Z_NT or Y_NT in log-log, so that the
   strength is straight there. Beyond 1e10 cycles it is constant, and a life below it infinite.
8. f_ma = hypot(f_Hbeta1, f_Hbeta2). Tolerances of 1995 take the means of their ranges and are
   rounded; upper ends belong to a range.
9. The yield point of St and V that is not given is estimated from the hardness, 3.2 MPa of tensile
   strength a unit and 0.55 (St) or 0.75 of it: at a ratio of 1.5 Y_deltarelT moves by 1 %.
10. Hardness outside the range of a line of part 5 counts as its end. Vickers hardness counts as
    Brinell hardness in Z_W.
11. K factors depend on the load: `Rating.power` is that with the factors of the load asked for;
    `gearopt rate` finds the power at which the least safety factor is the one asked for.
12. A transverse contact ratio below 1 is refused, with any overlap.
13. K_v is continuous at N = 1.15 and 1.5 and jumps at N_S, by the standard: of 21/63 teeth, m_n 4,
    grade 6, 50 kW at 1432 1/min from 1.47 to 2.15, were it to run there. Its table makes C_v2,
    C_v3, C_v4 and C_v6 jump by -1.4, -5.1, -6.7 and -1.8 % at eps_gamma = 2.
14. Sizes outside ISO 1328-1 (for 1995 its nearest range is taken), x_1 + x_2 outside -0.5 to 2 in
    c', alpha_n above 25° and beta above 30° are rated, and said beside the factor.
15. K_Fbeta is K_Hbeta of crowned teeth and of end relief. Z_W may fall below 1 against a rough
    pinion; ship classes (IACS UR M56) take at least 1. It is that of a wheel: a soft pinion gains
    nothing from a hard wheel.
16. Annex C of part 6 has 42 levels of contact stress with their lives: all are met within the
    rounding of the stresses (0.7 %, beyond 5e7 cycles 1.8 %) but five, up to 0.8 % above static
    strength, to which the annex draws the line of Z_NT on and which end the life here. The annex
    keeps Z_L, Z_v and Z_R of reference strength at all lives, as given factors do here.
17. Edition 2019 is held to two printed reports (suns and planets of m_n 40, beta 15°): f_eps,
    Y_F, Y_S, h_F, s_Fn, rho_F to the last digit, sigma_H with f_ZCa = 1.2, sigma_F to 0.2 %.
18. b is the width of both gears in mesh. A gear that is wider bends over its own width, at most one
    module beyond the mesh at each end: b_F1 = min(b_1, b + 2 m_n), and so of the wheel. That is
    part 3 from memory, *unverified*. Line loads, stiffness, K factors, tolerances of the helix,
    eps_beta and m_red are those of b. AGMA takes b for bending, too.
19. K = 0 of a pinion midway between its bearings. A table `[stage.shaft]` or `[rating.shaft]` puts
    it s off the middle of a span l on a shaft d_sh. K' of figure 13 is 0.8, -0.8, 1.33, -0.6, -1.0
    of arrangements a to e, and 0.48, -0.48, 1.33, -0.36, -0.6 of a pinion that stiffens its shaft,
    d_1/d_sh ≥ 1.15: two public programs have these numbers, one of DIN 3990-11; no published case
    was found, so that K_Hbeta is *unverified* then. The figure holds for s/l below 0.3 (c: 0.5).
    Which arrangement is which is from memory: between bearings, a off towards the end with torque,
    where bending adds to twist, b away from it; c overhung; d and e are to be seen in the figure.
    `stiffened = false` is for pinions that slide or are keyed on. AGMA takes s/l for S_1/S.
20. Method C knows helix modifications by kind, not by amount: B_1, B_2 of f_sh and f_ma are 1, 1
    without one; 1, 0.5 crowned; 0.5, 0.5 crowned for deflection; 0.1, 1 helix corrected; 0.1, 0.5
    both; 0.7, 0.7 with end relief. They take a crowning of C_beta = 0.5 f_ma for granted, for
    deflection 0.5 (f_ma + f_sh), and a correction that fits the load: the height is told beside
    K_Hbeta, and other amounts have no formula here. B_1, B_2 have a second source but for *crowned
    for deflection*; the heights are from memory: *unverified*.
"""

RINGS = """
## Rings and planetary stages

A ring is a wheel of negative teeth and diameters, as in ISO 21771, so that all formulas hold with
their signs: u, a and d_2 are negative, and a positive shift moves the ring's profile towards its
centre. `GearPair.internal` makes the pair. What differs from wheels outside:

"""
# quantity, of a ring, source
OF_RINGS = (
    (
        "Y_F, Y_S",
        "tangent at 60 degrees, T = π/6 in H; rho_F with abs(z_n) cos² theta - 2 G",
        "memory; both printed rings are met",
    ),
    (
        "rho_fPv",
        "rho_a0 + (x_0 + h_a0 - rho_a0)^1.95/(3.156 · 1.036^z_0) of its pinion-type cutter in E, "
        "G, s_Fn, h_F and rho_F; without a cutter the round of its rack",
        "memory; both printed rings are met, s_Fn of the fillet that the cutter cuts within 2 %",
    ),
    (
        "c'",
        "1/z_n2 = 0, its x_2 counts; the external gear is the pinion",
        "both printed rings are met",
    ),
    (
        "Z_D",
        "1 (2019, eps_beta > 0: as outside, *unverified*)",
        "printed; a program of DIN 3990-11",
    ),
    (
        "Y_B",
        "1.15 ln(8.324 m_n/s_R) for s_R/m_n of 1.75 to 3.5, at least 1, then 1; refused up to 1.75",
        "memory: *unverified* below 3.5",
    ),
    (
        "m_red",
        "1/(p_1/m_1 + p_2/m_2), m = J/(b r_b²); p: planets at a sun or ring, 1 of a planet, 0 of a "
        "ring that the casing holds",
        "printed of sun and of fixed ring; a public program; of a ring that turns *unverified*",
    ),
    (
        "f_sh of a sun",
        "B* = 1 + 2 (100 - k)/k for 1, k = 100/p per cent",
        "memory: *unverified*, as is K_Hbeta of planetary meshes: method C has no pins. Give it",
    ),
    ("helical rings, edition 2019", "the same laws", "no printed value: Y_F *unverified*"),
)
PLANETS = """
s_R reaches from the root circle to `Gear.outside_diameter`; without one it is 3.5 m_n, which is
said beside Y_B. `Practice.meshes` holds p_1 and p_2. Not covered: bending of the ring between its
supports, planets whose rim is thin on a bearing but for Y_B by s_R/h_t; interference is told by
`geometry.internal`, not by a rating. Each mesh has its own K_v;
the printed reports take the larger of both for both.

The operation of a mesh is that of one planet against the carrier: F_t is T/(N r) without K_gamma,
load cycles (`contacts`) are N a relative turn for sun and ring, one a flank for a planet, whose
`reversed_load` gives Y_M = 0.7. K_gamma is given (`given={"K_gamma": 1.1}`; else it is 1 and
*unverified*); where a file gives none it follows from the number of planets (`MESH_LOAD_FACTORS`,
*wind*); other rules stand beside:

"""
SHARING_RULES = (
    ("class society", "1", "1.2", "1.3", "1.4", "1.4", "a vendor's help on the rules of one"),
    ("square root", "1", "1.25", "1.354", "1.433", "1.5", "1 + 0.25 sqrt(N - 3): *unverified*"),
)
EXAMPLE = """
```python
from dataclasses import replace

from gearopt.physics.gears import Cutter
from gearopt.physics.planetary.loads import MESH_LOAD_FACTORS

ring = GearPair.internal(3.0, 33, -87, 30.0, cutter=Cutter(25, tip_radius=0.3))
speed, cycles = operation.pinion_speed * 21 / 33, (1.0, 3.0)  # of the sun, against the carrier
load = replace(operation, power=operation.power / 3, pinion_speed=speed, contacts=cycles)
planet = Material("Eh", "MQ", reversed_load=True)
given = {"K_gamma": MESH_LOAD_FACTORS[3]}
rating = rate(ring, load, (planet, steel), Practice(meshes=(1.0, 0.0)), given)  # held: 0
print([round(s, 2) for s in rating.bending_safety + rating.contact_safety], rating.unverified)
```
"""


def page() -> str:
    """Return the page as the program computes it now."""
    heads = "quantity", "formula", "source", "function"
    parts = (
        HEAD + "\n## Formulas\n\n" + grid(heads, list(FORMULAS)),
        CHOICES,
        _rings(),
        _cases(),
        _smooth(),
        _factors(),
        _strengths(),
        _refusals(),
    )
    return "".join(parts)


def _rings() -> str:
    """What differs for rings and planetary stages."""
    counts = [f"{n}" for n in MESH_LOAD_FACTORS]
    factors = [f"{factor:.4g}" for factor in MESH_LOAD_FACTORS.values()]
    own = ("wind", *factors, "a public program; 1.10 is printed, too: *unverified*")
    of_rules = grid(("planets", *counts, "source"), [own, *SHARING_RULES])
    heads = "quantity", "of a ring", "source"
    return RINGS + grid(heads, list(OF_RINGS)) + PLANETS + of_rules + EXAMPLE


def _cases() -> str:
    """Return the published cases value by value."""
    titles = {
        "tr30": "ISO/TR 6336-30:2017, example 1\n\nz 17/103, m_n 8, beta 15.8°, b 100, a 500, x "
        "0.145/0, d_a 159.66/872.35, rack 1.4/0.39/1.0; 9000 N m, 360 1/min, 50 000 h;\nISO "
        "1328-1:1995 grade 5, R_z 6 um, ISO VG 320, C_a 70 um, case-hardened 1500 MPa. 2006. Its "
        "bending values were not\nfound in print. Source: gfsReboucas/Drivetrain, `MATISO_6336.m`; "
        "a public test of the edition of 2022.",
        "report": "A printed report: NREL 5 MW, high-speed pair\n\nz 24/95, m_n 14, beta 10°, b "
        "360, a 861, x 0.48/0.6691, k m_n -0.938, rack 1.25/0.38/1.0; 5 MW, 1165.9 1/min, 175 200 "
        "h,\nK_A 1.25; grade 6, R_z 4.8/20 um, ISO VG 220, C_a 2 um, webs 0.25 b and 5 m_n, "
        "case-hardened 430/1500 MPa; K_Hbeta 1.15\ngiven. 2006. Source: gfsReboucas/Drivetrain, "
        "`@NREL_5MW/stage_03.rtf` (KISSsoft 03/2017).",
        "stage 2": "The same report: sun and planet of stage 2\n\nz 18/36, m_n 21, spur, b 550, a "
        "584, x 0.3890/0.5039, k m_n -1.75, rack 1.25/0.38/1.0; F_t 285.9 kN a planet of three, "
        "v 4.88 m/s,\nK_A 1.25, webs 0.25 b and 3.5 m_n (inferred from C_R), otherwise as stage 3; "
        "K_gamma 1.10, K_v 1.06, K_Hbeta 2.06 given as\nprinted. `stage_02.rtf`.",
        "stage 1": "The same report: sun and planet of stage 1\n\nz 19/17, m_n 45, spur, b 491, a "
        "863, x 0.6170/0.8021, k m_n -10.861; F_t 779.5 kN a planet, v 1.60 m/s; K_v 1.01, K_Hbeta "
        "1.15\ngiven as printed, otherwise as stage 2. `stage_01.rtf`.",
        "ring 2": "The same report: planet and ring of stage 2\n\nz 36/-93, m_n 21, a -584, x "
        "0.5039/0.1171, racks 1.25/0.38/1.0 and 1.25/0.30/1.0, ring shaped by a cutter z_0 30, "
        "x_0 0, rho_a0 0.30 and held\nby the casing, outside 2148.82, V 240 HBW, 290/700 MPa, R_z "
        "8 um; C_a 5.25 um, the mean of the printed; K_Hbeta 1.15 given, K_v not: 1.06 is printed "
        "of this mesh.",
        "ring 1": "The same report: planet and ring of stage 1\n\nz 17/-56, m_n 45, a -863, x "
        "0.8021/-0.5013, cutter z_0 36, outside 2994.24; K_v 1.05, K_Hbeta 1.15 given as printed, "
        "otherwise as stage 2.",
    }
    parts = ["\n## Published cases\n\n" + UNITS]
    for name, (make, rows) in iso6336_cases.CASES.items():
        found = iso6336_cases.computed(make())
        table = [_row(symbol, known, found[symbol]) for symbol, known in rows.items()]
        heads = "quantity", "printed", "computed", "off by", "tolerance"
        parts.append(f"\n### {titles[name]}\n\n" + grid(heads, table))
    return "".join(parts)


UNITS = """\
Off by: the largest relative difference of a row. A tolerance is half a unit of the last printed
digit, or what the rounding of inputs is worth (shifts, speeds and given K factors). In the report's
helical pair alpha_Fen, h_F, Y_F, Y_S and stresses follow choice 4; m_red, n_E1 and N are of
diameters with allowances. h_F, s_Fn and rho_F are in normal modules, stiffness in N/(mm um), f in
um, v in m/s, m_red in kg/mm, n_E1 in 1/min, angles in degrees. sigma_H follows from the unrounded
K_v and K_Hbeta.
"""


def _row(symbol: str, known: tuple, found: tuple[float, ...]) -> tuple[object, ...]:
    values, tolerance = known
    off = max(abs(a / b - 1.0) for a, b in zip(found, values, strict=True))
    told = " / ".join(_text(v, printed(v)) for v in values)
    made = " / ".join(_text(a, digits(b)) for a, b in zip(found, values, strict=True))
    return symbol, told, made, f"{off:.1e}" if off > 1e-12 else "0", f"{tolerance:.1g}"


def _text(value: float, places: int) -> str:
    return f"{value:.4g}" if abs(value) >= 1e7 else f"{value:.{places}f}"


def _smooth() -> str:
    return (
        "\n## Rows and the smooth form\n\n`batch.rate_rows` rates arrays by the same text, with a "
        "code where a pair is refused. `batch.smooth_safeties` is\nthat text for an optimiser, of "
        "floats, arrays or casadi scalars: deviations without the ranges and the rounding of\nISO "
        "1328, and the law of one range of K_v, so that there is no jump at N_S; kinks of the "
        "standard's limits stay.\nAgainst the exact form, of 400 helical pairs of modules 1 to 12 "
        "and grades 5 to 8: S_F -7.2 to +4.2 %, S_H -4.0 to\n+2.3 %, half of them within 1.5 and "
        "0.8 % (`batch.smooth_error`; tests/physics/iso6336).\n"
    )


def _factors() -> str:
    """Return the symbols that may be given."""
    rows = [(f"`{symbol}`", clause, unit or "1") for symbol, (clause, unit) in CLAUSES.items()]
    return "\n## Factors that may be given\n\n" + grid(("symbol", "clause, method", "unit"), rows)


def _strengths() -> str:
    rows = []
    for name, stress, quality, core, slope, base, low, high in LINES:
        line = f"{slope:g} x + {base:g}" if slope else f"{base:g}"
        symbol = {"H": "sigma_Hlim", "F": "sigma_Flim"}[stress]
        rows.append((name, symbol, quality, core, line, f"{low:g} to {high:g}"))
    heads = "material", "stress", "quality", "core", "MPa", "hardness x"
    return (
        "\n## Allowable stress numbers\n\nISO 6336-5:2016, table 1: x in Brinell of St, St cast, "
        "GTS, GGG and GG, else in Vickers. sigma_Flim is without Y_ST.\n`GGG ferritic` has the "
        f"lines of GGG and life curves of its own; {len(MATERIALS)} materials. Source: pictures of "
        "the table in a\npublic repository (waa552/fyp-website): *unverified* but for the ME lines "
        "of wrought steels, which its `data.js` repeats,\nand 1500 MPa of Eh, MQ, which a printed "
        "report has.\n\n" + grid(heads, rows)
    )


def _refusals() -> str:
    return "\n## What is refused\n\n" + grid(("name", "because"), list(SENTENCES.items()))
