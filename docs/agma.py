"""The page "Rating by AGMA": formulas, sources, and published values beside computed ones."""

import math

import agma_cases
from agma_cases import digits, printed
from agma_tables import J20_TIP, J25, J25_TIP

from gearopt.bench.rating import PUBLISHED, THINNING, TOOL
from gearopt.physics.agma.allowables import BENDING, CONTACT
from gearopt.physics.agma.bending import bending_factors, thinned
from gearopt.physics.agma.refusals import SENTENCES, geometry_factors
from gearopt.physics.agma.smooth import smooth_error
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.mesh_loss import FRICTION_ERROR

HEAD = """\
# Rating by AGMA

External spur and helical gears by ANSI/AGMA 2001-D04 (2101-D04 in metric terms), with the
geometry factors of AGMA 908-B89 by its analytic method: by [gearopt rate](rate.md), and from
Python by `gearopt.physics.agma`, which takes rings, too. The standards themselves were not read:
formulas and values are from textbooks, tables and public programs. What a single source has is
marked *unverified*, in the result too (`Rating.unverified`).

```python
import math

from gearopt.physics.agma.rating import rate
from gearopt.physics.agma.rating_factors import Practice, Steel
from gearopt.physics.gears import GearPair
from gearopt.physics.rating import Operation

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
        "((A + sqrt(V))/A)^B, Q_v 5 to 11; A_v of D04 is 17 - Q_v",
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
        "`factors.hardness_ratio_factor`",
    ),
    (
        "C_p",
        "(pi ((1 - nu_1²)/E_1 + (1 - nu_2²)/E_2))^(-1/2)",
        "2001-D04, 12",
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
        "`mesh_loss.tooth_loss_factor`",
    ),
    (
        "friction",
        "0.048 (F_bt/b/(v_SigmaC rho_C))^0.2 eta^-0.05 R_a^0.25 X_L, off by up to "
        f"{100 * FRICTION_ERROR:.0f} %, *unverified*",
        "Schlenk",
        "`mesh_loss.friction_coefficient`",
    ),
)
REMARKS = """
J of m_F ≤ 1 is that of the load at the highest point of single tooth contact, above that at the
tip, as 908 has it: J jumps at m_F = 1, I does not. Teeth are thinned by a deeper cut. An
optimiser takes `smooth.smooth_factors`: the tangency is an equality, the tool angle of the
section a variable; for m_F > 1 with m_N = p_N/(0.95 Z), which `smooth_error` puts at -5 to +7 %
of the exact one.

Rings (`GearPair.internal`) have negative teeth, diameters and radii of curvature, so that I is
taken at the pinion's lowest point of single tooth contact with 1/rho_1 - 1/abs(rho_2). 908 has no
J for them: the section is where a tangent of 60 degrees touches the fillet of the rack that stands
for the ring's cutter, as ISO 6336-3 has it, Y and K_f are as outside, and a J of yours may be
given. K_B is that of the rim outside the root. No value of either was found in print: I, J and K_B
are *unverified*; load angles and sections are those of two printed ISO ratings. 2101 has no
K_gamma: of planetary stages it is given beside K_o (`given={"K_gamma": 1.1}`), which it multiplies.
"""


def page() -> str:
    """Return the page as the program computes it now."""
    heads = "quantity", "formula", "source", "function"
    parts = (
        HEAD + "\n## Formulas\n\n" + grid(heads, list(FORMULAS)) + REMARKS,
        _tables(),
        _helical(),
        _cases(),
        _smooth(),
        _strengths(),
    )
    return "".join(parts) + _refusals()


def grid(heads: tuple[str, ...], rows: list[tuple[object, ...]]) -> str:
    """Return a table of Markdown."""
    lines = [heads, tuple("---" for _ in heads), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines) + "\n"


def _tables() -> str:
    """Return I and J of the published tables beside the computed ones."""
    rows, worst = [], [0.0, 0.0]
    for z1, z2, *known in PUBLISHED:
        found = geometry_factors(_thin(z1, z2, TOOL))
        made = (float(found.pitting), *map(float, found.bending))
        away = [abs(a - b) for a, b in zip(made, known, strict=True)]
        worst = [max(worst[0], away[0]), max(worst[1], *away[1:])]
        shown = [f"{k:.3f}" if n == 0 else f"{k:.2f}" for n, k in enumerate(known)]
        pairs = zip(shown, (f"{m:.4f}" for m in made), strict=True)
        rows.append((f"{z1}/{z2}", *(cell for both in pairs for cell in both)))
    heads = ("z1/z2", "I", "computed", "J1", "computed", "J2", "computed")
    return (
        "\n## Tables of I and J\n\nSpur gears of 20 degrees, load at the highest point of single "
        "tooth contact; tool h_a0 1.25, rho_a0 0.25,\nteeth 0.024 modules thinner. "
        f"Largest difference: I {worst[0]:.4f}, J {worst[1]:.4f}; the tables have three and two "
        "decimals,\nand most J are truncated rather than rounded: they are met within 0.0006 and "
        "0.007.\nSource: AGMA 908-B89, as in Norton, Machine Design, table 12-9.\n\n"
        + grid(heads, rows)
        + _tables_25()
        + _tips()
    )


def _thin(z1: int, z2: int, tool: Rack) -> GearPair:
    """Return a spur pair of unit module whose teeth are thinned as those of the tables."""
    return thinned(GearPair.of_teeth(1.0, z1, z2, 1.0, rack=tool), THINNING)


def _tables_25() -> str:
    rows, worst = [], 0.0
    for z1, z2, *known in J25:
        made = [float(j) for j in geometry_factors(_thin(z1, z2, agma_cases.TOOL_25)).bending]
        worst = max(worst, *(abs(a - b) for a, b in zip(made, known, strict=True)))
        cells = [f"{k:.2f} | {m:.4f}" for k, m in zip(known, made, strict=True)]
        rows.append((f"{z1}/{z2}", *cells))
    return (
        "\nThe same of 25 degrees, tool h_a0 1.35, rho_a0 0.27 (with 1.25 and 0.25 it is missed by "
        f"0.022).\nLargest difference: {worst:.4f}. Norton, table 12-13.\n\n"
        + grid(("z1/z2", "J1", "computed", "J2", "computed"), rows)
    )


def _tips() -> str:
    rows = []
    for degrees, tool, table in ((20, TOOL, J20_TIP), (25, agma_cases.TOOL_25, J25_TIP)):
        for teeth, known in table:
            made = bending_factors(_thin(teeth, teeth, tool), "tip")[0].value
            rows.append((degrees, teeth, f"{known:.2f}", f"{float(made):.4f}"))
    return "\nLoad at the tip, spur. Norton, tables 12-8 and 12-12.\n\n" + grid(
        ("alpha_n [deg]", "z", "J", "computed"), rows
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
        "\nHelical gears of the same tool at m_F = 2, *unverified*: no published table was found. "
        "Another program has the\nsame within 1 %; the formulas of efirvida/python-gearbox, with "
        "the sign of M and the end of its iteration\nmended, give I and J within 1e-6 of these, of "
        "spur gears and of m_F up to 1 and above, at 14.5, 20 and\n25 degrees, where the section "
        "lies on the fillet; where it lies above, J is up to 0.5 % less there.\n\n"
        + grid(("z1/z2", "psi [deg]", "I", "J1", "J2"), rows)
    )


def _cases() -> str:
    """Return the published cases value by value."""
    heads = "quantity", "printed", "computed", "off by", "tolerance", "remark"
    made = (
        f"\n### {case.title}\n\n{case.given}. Source: {case.source}.\n\n"
        + grid(heads, [_compared(row) for row in case.rows])
        for case in agma_cases.cases()
    )
    return (
        "\n## Published cases\n\nOff by: the largest relative difference of a row. A tolerance of "
        "0.3 % is that of three printed digits;\nthose of geometry are the last printed digit. "
        "Books round on the way, take I at the pitch point, which is\n23 % above 908 for 17/52 "
        "teeth (contact stresses 10 % too low), and read J from charts of an older tool: with\n"
        "theirs given, all else has to follow.\n" + "".join(made)
    )


def _compared(row: agma_cases.Row) -> tuple[object, ...]:
    pairs = list(zip(row.computed, row.printed, strict=True))
    off = max(abs(made / known - 1.0) for made, known in pairs)
    places = [digits(known) for known in row.printed]
    shown = " / ".join(f"{made:.{n}f}" for made, n in zip(row.computed, places, strict=True))
    known = " / ".join(
        f"{k:.{n}f}" for k, n in zip(row.printed, map(printed, row.printed), strict=True)
    )
    away = f"{100 * off:.2g} %" if off > 1e-4 else "< 0.01 %"
    held = f"{row.within:g}" if row.within else f"{100 * row.tolerance:g} %"
    return row.quantity, known, shown, away, held, row.reason


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
        "0.3 rad:\n\n" + grid(("m_F", "regime", "smooth less exact"), rows)
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
        + grid(("", "treatment", "surface", "grade", "psi", "source"), rows)
    )


def _refusals() -> str:
    """What is refused, by name."""
    rows = list(SENTENCES.items())
    return (
        "\n## What is refused\n\nA pair is refused by name; `geometry.flaws` warns of what a "
        "designer may accept: undercut, interference,\nthin tips, no tip clearance, "
        "no backlash.\n\n" + grid(("name", "because"), rows)
    )
