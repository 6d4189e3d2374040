"""The page "Rating by AGMA": formulas, sources, and published values beside computed ones."""

import math
from dataclasses import replace

from gearopt.bench.rating import PUBLISHED, THINNING, TOOL
from gearopt.physics.agma.allowables import BENDING, CONTACT, PSI
from gearopt.physics.agma.bending import thinned
from gearopt.physics.agma.mesh import mean_load_sharing, mesh_of, pitch_point_factor
from gearopt.physics.agma.rating import Rating, rate
from gearopt.physics.agma.rating_factors import Operation, Practice, Steel
from gearopt.physics.agma.refusals import SENTENCES, geometry_factors
from gearopt.physics.agma.smooth import smooth_error
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import active_root_diameters, contact_path, usable_path
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.tooth import tip_thickness, virtual_teeth

HEAD = """\
# Rating by AGMA

External spur and helical gears by ANSI/AGMA 2001-D04 (2101-D04 in metric terms), with the
geometry factors of AGMA 908-B89 by its analytic method, so far from Python:
`gearopt.physics.agma`. The standards themselves were not read: formulas and values are from
textbooks, tables and public programs. What a single source has is marked *unverified*, in the
result too (`Rating.unverified`).

```python
import math

from gearopt.physics.agma.rating import rate
from gearopt.physics.agma.rating_factors import Operation, Practice, Steel
from gearopt.physics.gears import GearPair

pair = GearPair.of_teeth(3.0, 21, 63, 30.0, profile_shifts=(0.2, 0.0))  # m_n, z1, z2, b in mm
operation = Operation(power=7.5e6, pinion_speed=1450 * math.pi / 30, hours=20000)  # N mm/s, rad/s
steel = Steel("carburised", grade=1)
rating = rate(pair, operation, (steel, steel), Practice(quality=8))
print([round(s, 2) for s in rating.bending_safety + rating.contact_safety], rating.governs)
```

Inside everything is mm, N, MPa, rad, s. The constants are those of the inch form, converted
exactly: the metric form rounds them, sqrt(200 v) for sqrt(196.85 v) in K_v, 0.533 MPa for 77.3
psi, which changes no result by more than 0.5 %. `given={"J": (0.30, 0.40)}` puts a factor of
yours in the place of a computed one, any of them.
"""

# quantity, formula, source, function
FORMULAS = (
    (
        "bending stress",
        "W_t K_o K_v K_s K_m K_B/(b m_t J)",
        "2001-D04, 5",
        "`stress.bending_stress`",
    ),
    (
        "contact stress",
        "C_p sqrt(W_t K_o K_v K_s K_m C_f/(d_w1 b I))",
        "2001-D04, 5",
        "`stress.contact_stress`",
    ),
    (
        "S_F",
        "s_at Y_N/(K_T K_R s_t)",
        "2001-D04, 5",
        "`stress.bending_safety`",
    ),
    (
        "S_H, of stress; S_H² is of load",
        "s_ac Z_N C_H/(K_T K_R s_c)",
        "2001-D04, 5",
        "`stress.contact_safety`",
    ),
    (
        "I",
        "cos(alpha_wt) C_psi²/((1/rho_1 + 1/rho_2) d_w1 m_N)",
        "908-B89, 4",
        "`mesh.pitting_factor`",
    ),
    (
        "m_N",
        "1; for m_F > 1 F/L_min",
        "908-B89, 4",
        "`mesh.load_sharing`",
    ),
    (
        "C_psi², m_F ≤ 1",
        "1 - m_F (1 - rho_m1 rho_m2 Z/(rho_1 rho_2 p_N))",
        "908-B89, 4",
        "`mesh.mesh_of`",
    ),
    (
        "J",
        "Y C_psi/(K_f m_N)",
        "908-B89, 5",
        "`bending.bending_factor`",
    ),
    (
        "Y",
        "K_psi/((cos phi_nL/cos phi_nr) (6 h_F/(s_F² C_h) - tan phi_nL/s_F))",
        "908-B89, 5",
        "`bending.bending_factor`",
    ),
    (
        "K_f",
        "H + (s_F/rho_F)^L (s_F/h_F)^M",
        "Dolan and Broghamer",
        "`bending.bending_factor`",
    ),
    (
        "critical section",
        "2 h_F tan(tau) = s_F/2 on the fillet",
        "908-B89, 5",
        "`bending.tangency`",
    ),
    (
        "K_v",
        "((A + sqrt(V))/A)^B, Q_v 5 to 11",
        "2001-D04, 8",
        "`factors.dynamic_factor`",
    ),
    (
        "K_s",
        "1, or 1.192 (F sqrt(Y)/P)^0.0535",
        "2001-D04, 20; Shigley",
        "`factors.size_factor`",
    ),
    (
        "K_m",
        "1 + C_mc (C_pf C_pm + C_ma C_e)",
        "2001-D04, 15",
        "`factors.load_distribution_factor`",
    ),
    (
        "K_B",
        "1.6 ln(2.242/m_B); B88: 3.4 - 2 m_B, *unverified*",
        "2001, annex B",
        "`factors.rim_factor`",
    ),
    (
        "K_R",
        "table; 0.658 - 0.0759 ln(1 - R), 0.50 - 0.109 ln(1 - R)",
        "2001-D04, 18; Shigley",
        "`factors.reliability_factor`",
    ),
    (
        "K_T",
        "1 to 120 °C, then (460 + T)/620 (customary, not the standard's)",
        "2001-D04, 19",
        "`factors.temperature_factor`",
    ),
    (
        "C_H",
        "1 + A (u - 1); 1 + B (450 - HB) with a hardened pinion",
        "2001-D04, 14",
        "`hardness`",
    ),
    (
        "C_p",
        "(pi ((1 - nu_1²)/E_1 + (1 - nu_2²)/E_2))^(-1/2)",
        "2001-D04, 11",
        "`factors.elastic_coefficient`",
    ),
    (
        "Y_N, Z_N",
        "A N^-B, two branches joined where they cross",
        "2001-D04, 17",
        "`life`",
    ),
    (
        "spectrum",
        "sum n_i/N_i = 1",
        "Palmgren, Miner",
        "`rating.rate_spectrum`",
    ),
    (
        "sliding loss",
        "pi (u + 1)/(z_1 u cos beta_b) (1 - eps_alpha + eps_1² + eps_2²)",
        "Ohlendorf",
        "`mesh_loss`",
    ),
)
REMARKS = """
J of m_F ≤ 1 is that of the load at the highest point of single tooth contact, above that at the
tip, as 908 has it: J jumps at m_F = 1, I does not. Teeth are thinned by a deeper cut. An
optimiser takes `smooth.smooth_factors`: the tangency is an equality, the tool angle of the
section a variable; for m_F > 1 with m_N = p_N/(0.95 Z), which `smooth_error` puts at -5 to +7 %
of the exact one.
"""


def page() -> str:
    """Return the page as the program computes it now."""
    heads = "quantity", "formula", "source", "function"
    parts = (
        HEAD + "\n## Formulas\n\n" + _grid(heads, list(FORMULAS)) + REMARKS,
        _tables(),
        _helical(),
        _examples(),
        _geometry(),
        _smooth(),
        _strengths(),
    )
    return "".join(parts) + _refusals()


def _grid(heads: tuple[str, ...], rows: list[tuple[object, ...]]) -> str:
    lines = [heads, tuple("---" for _ in heads), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines) + "\n"


def _tables() -> str:
    """Return I and J of the published tables beside the computed ones."""
    rows, worst = [], [0.0, 0.0]
    for z1, z2, *known in PUBLISHED:
        pair = thinned(GearPair.of_teeth(1.0, z1, z2, 1.0, rack=TOOL), THINNING)
        found = geometry_factors(pair)
        made = (float(found.pitting), *map(float, found.bending))
        away = [abs(a - b) for a, b in zip(made, known, strict=True)]
        worst = [max(worst[0], away[0]), max(worst[1], *away[1:])]
        shown = [f"{k:.3f}" if n == 0 else f"{k:.2f}" for n, k in enumerate(known)]
        pairs = zip(shown, (f"{m:.4f}" for m in made), strict=True)
        rows.append((f"{z1}/{z2}", *(cell for both in pairs for cell in both)))
    heads = ("z1/z2", "I", "computed", "J1", "computed", "J2", "computed")
    return (
        "\n## Published values\n\nSpur gears of 20 degrees, load at the highest point of single "
        "tooth contact; tool h_a0 1.25, rho_a0 0.25,\nteeth 0.024 modules thinner. "
        f"Largest difference: I {worst[0]:.4f}, J {worst[1]:.4f}; the tables have three and two "
        "decimals.\nSource: AGMA 908-B89, as in Norton, Machine Design, table 12-9. The 56 values "
        "of 25 degrees and those of tip\nloads are in `tests/physics/agma`.\n\n"
        + _grid(heads, rows)
    )


def _helical() -> str:
    """Return helical I and J, which no table confirms."""
    rows = []
    for z2 in (21, 55):
        for degrees in (10, 15, 20, 25, 30):
            helix = math.radians(degrees)
            width = 2.0 * math.pi / math.sin(helix)
            pair = thinned(GearPair.of_teeth(1.0, 21, z2, width, helix, TOOL), THINNING)
            found = geometry_factors(pair)
            first, second = found.bending
            rows.append(
                (f"21/{z2}", degrees, f"{found.pitting:.4f}", f"{first:.4f}", f"{second:.4f}")
            )
    return (
        "\nHelical gears of the same tool at m_F = 2, *unverified*: another program has the same "
        "within 1 %, no published\ntable was found.\n\n"
        + _grid(("z1/z2", "psi [deg]", "I", "J1", "J2"), rows)
    )


def _examples() -> str:
    """Return Shigley's examples with the book's I and J, and with those of 908."""
    inch, pound = 25.4, 4.4482216152605
    power = 4.0 * 550.0 * 12.0 * pound * inch
    steels = Steel(hardness=240.0), Steel(hardness=200.0)
    operation = Operation(power, 1800.0 * math.pi / 30.0, 1e8 / 60.0 / 1800.0, reliability=0.9)
    practice, own = Practice(quality=6, size=True), {"C_p": 2300.0 * PSI**0.5}
    spur = GearPair.of_teeth(2.54, 17, 52, 38.1, rack=TOOL)
    helical = GearPair.of_teeth(2.54, 17, 52, 38.1, math.radians(30.0), TOOL)
    sharing = mean_load_sharing(helical, mesh_of(helical).path)
    books = (
        {"I": pitch_point_factor(spur), "J": (0.30, 0.40)},
        {"I": pitch_point_factor(helical, sharing), "J": (0.423, 0.529), "K_s": (1.043, 1.052)},
    )
    cut = {"K_s": (1.043, 1.052)}
    rated = [
        (rate(spur, operation, steels, practice, own | books[0]), EXAMPLES[0]),
        (rate(thinned(spur, 0.024 * 2.54), operation, steels, practice, own), None),
        (rate(helical, operation, steels, practice, own | books[1]), EXAMPLES[1]),
        (rate(thinned(helical, 0.024 * 2.54), operation, steels, practice, own | cut), None),
    ]
    names = ("14-4, the book's I and J", "14-4 by 908", "14-5, the book's I and J", "14-5 by 908")
    rows = [
        row
        for name, (found, known) in zip(names, rated, strict=True)
        for row in _rows(name, found, known)
    ]
    return (
        "\nShigley, Mechanical Engineering Design, examples 14-4 and 14-5: 17/52 teeth, P 10 (P_n "
        "10, psi 30), F 1.5 in,\n1800 rpm, 4 hp, Q_v 6, HB 240/200, 1e8 cycles, R 0.90. The book "
        "takes I at the pitch point, which 908 does not:\nits contact stress is 10 % low. Its "
        "chart's J of the helical wheel, 0.529, is 13 % above 908. Stresses in psi.\n\n"
        + _grid(("case", "", "I", "J", "bending", "contact", "S_F", "S_H"), rows)
    )


# I, J, stresses [psi], S_F, S_H as printed; those of 14-5 from memory, recomputed
EXAMPLES = (
    ("0.121", "0.30 / 0.40", "6417 / 4854", "70360 / 70660", "5.62 / 6.82", "1.69 / 1.52"),
    ("0.195", "0.423 / 0.529", "3445 / 2779", "48230 / 48440", "10.5 / 11.9", "2.46 / 2.22"),
)


def _rows(name: str, found: Rating, known: tuple[str, ...] | None) -> list[tuple[object, ...]]:
    def both(values: tuple[float, float], digits: int) -> str:
        return " / ".join(f"{v:.{digits}f}" for v in values)

    bent, pressed = (
        tuple(s / PSI for s in stresses)
        for stresses in (found.bending_stress, found.contact_stress)
    )
    made = (
        f"{found.factors['I'].value:.4f}",
        both(found.factors["J"].value, 4),
        both(bent, 0),
        both(pressed, 0),
        both(found.bending_safety, 2),
        both(found.contact_safety, 2),
    )
    printed = [(name, "printed", *known)] if known else []
    return [*printed, (name, "computed", *made)]


def _geometry() -> str:
    """Return the printed geometry of a KISSsoft report beside the computed one."""
    pair = GearPair.of_teeth(14.0, 24, 95, 360.0, math.radians(10.0), profile_shifts=(0.48, 0.6691))
    gears = [replace(gear, tip_alteration=-0.938 / 14.0) for gear in pair.gears]
    pair = GearPair(*gears, 861.0)
    first, second = pair.gears
    rows = [
        (name, f"{one:.3f} / {two:.3f}" if two else f"{one:.3f}", *made)
        for name, (one, two), made in (
            ("alpha_wt [deg]", (22.856, 0), _cells(math.degrees(pair.working_angle))),
            ("d_a", (380.747, 1395.376), _cells(first.tip_diameter, second.tip_diameter)),
            ("d_w", (347.294, 1374.706), _cells(*pair.working_diameters)),
            ("d_f", (319.623, 1334.252), _cells(first.root_diameter, second.root_diameter)),
            ("d_Ff", (328.991, 1341.487), _cells(form_diameter(first), form_diameter(second))),
            ("d_Nf", (330.798, 1348.584), _cells(*active_root_diameters(pair))),
            ("s_an", (8.800, 11.034), _cells(tip_thickness(first), tip_thickness(second))),
            ("z_n", (25.037, 99.104), _cells(virtual_teeth(first), virtual_teeth(second))),
            ("g_alpha", (61.276, 0), _cells(contact_path(pair).length)),
            ("eps_alpha", (1.463, 0), _cells(usable_path(pair).transverse_ratio)),
            ("eps_beta", (1.421, 0), _cells(pair.overlap_ratio)),
        )
    ]
    return (
        "\nGeometry of a printed KISSsoft report (03/2017, NREL 5 MW gearbox, high-speed pair, "
        "gfsReboucas/Drivetrain): z 24/95,\nm_n 14, beta 10, x 0.48/0.6691, k m_n -0.938, a 861; "
        "lengths in mm.\n\n" + _grid(("quantity", "printed", "computed"), rows)
    )


def _cells(*values: float) -> tuple[str]:
    return (" / ".join(f"{float(value):.3f}" for value in values),)


def _smooth() -> str:
    """Return the error of the smooth form of I and J for some overlap ratios."""
    rows = []
    for overlap in (0.0, 0.5, 1.01, 1.25, 1.5, 2.0, 2.5):
        helix = 0.3 if overlap else 0.0
        width = overlap * math.pi / math.sin(helix) if overlap else 10.0
        regime = "spur" if not overlap else "low" if overlap <= 1.0 else "conventional"
        error = smooth_error(GearPair.of_teeth(1.0, 25, 75, width, helix), regime)[0]
        rows.append(
            (f"{overlap:g}", regime, f"{100.0 * error + 0.0:+.2f} %" if abs(error) > 1e-9 else "0")
        )
    return (
        "\n## The smooth form\n\nI and J of `smooth_factors` against the exact ones, z 25/75, beta "
        "0.3 rad:\n\n" + _grid(("m_F", "regime", "smooth less exact"), rows)
    )


def _strengths() -> str:
    """Return the allowable stress numbers with their sources."""
    rows = []
    for title, table in (("s_at", BENDING), ("s_ac", CONTACT)):
        for (treatment, surface, grade), (slope, base, source) in table.items():
            line = f"{slope:g} HB + {base:,.0f}" if slope else f"{base:,.0f}"
            rows.append((title, treatment, surface, grade, line, source))
    return (
        "\n## Allowable stress numbers\n\npsi, at 1e7 cycles and a reliability of 0.99; MPa are "
        "0.00689476 of it. Flame hardening counts as induction\nhardening.\n\n"
        + _grid(("", "treatment", "surface", "grade", "psi", "source"), rows)
    )


def _refusals() -> str:
    """Return what is refused, by name."""
    rows = list(SENTENCES.items())
    return (
        "\n## What is refused\n\nA pair is refused by name; `geometry.flaws` warns of what a "
        "designer may accept: undercut, interference,\nthin tips, no tip clearance, "
        "no backlash.\n\n" + _grid(("name", "because"), rows)
    )
