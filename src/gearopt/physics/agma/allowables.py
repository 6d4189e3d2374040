"""Allowable stress numbers of steel and iron by AGMA 2001-D04: s_at of bending, s_ac of pitting.

For 1e7 cycles, unidirectional load and a reliability of 0.99, as a hardness times HB plus a
constant in psi, converted exactly. 2101 calls them sigma_FP and sigma_HP. What has a single source,
or memory alone, is not verified, and says so to whoever uses it.
"""

from gearopt.frozen import dataclass

PSI = 4.4482216152605 / 25.4**2  # MPa
HARDNESS = (180.0, 400.0)  # HB: range of the lines of through-hardened steel
NITRIDED_CORE = {
    "nitrided": (255.0, 345.0),
    "nitralloy": (255.0, 345.0),
}  # HB, unverified: of no text at hand
REVERSED = 0.7  # of s_at: idlers and fully reversed loads. AGMA 2001-D04, clause 16; Shigley

# the public program: r3kste/pydome, `Spur`; the table: engineersedge.com
PRINTED = "2001-D04, 16, as in Shigley, ch. 14, and in a public program"
SHIGLEY = "2001-D04, table 4, as in Shigley, table 14-3, and in a transcription"
TABLE = "2001-D04, table 3, as in a public table of it"
OLD = "2001-B88; two public programs of its allowables"
SINGLE = "2001-B88; a single source"
IRON = "2001-D04, tables 3 and 4, lower values of ranges, from memory of Shigley, ch. 14"
IRONS = {  # by ASTM: s_ac, s_at [ksi], E [10^6 psi], the last of Shigley, table 14-8
    "ASTM A48 class 20": (50.0, 5.0, 22.0),
    "ASTM A48 class 30": (65.0, 8.5, 22.0),
    "ASTM A48 class 40": (75.0, 13.0, 22.0),
    "ASTM A536 60-40-18": (77.0, 22.0, 24.0),
    "ASTM A536 80-55-06": (77.0, 22.0, 24.0),
    "ASTM A536 100-70-03": (92.0, 27.0, 24.0),
    "ASTM A536 120-90-02": (103.0, 31.0, 24.0),
}
MODULI = {iron: 1e6 * PSI * modulus for iron, (_, _, modulus) in IRONS.items()}  # MPa

# (treatment, surface, grade): psi per HB, psi, source; surface: "" where it does not matter
BENDING: dict[tuple[str, str, int], tuple[float, float, str]] = {
    ("through-hardened", "", 1): (77.3, 12800.0, PRINTED),
    ("through-hardened", "", 2): (102.0, 16400.0, PRINTED),
    ("nitrided", "", 1): (82.3, 12150.0, PRINTED),
    ("nitrided", "", 2): (108.6, 15890.0, PRINTED),
    ("nitralloy", "", 1): (86.2, 12730.0, PRINTED),
    ("nitralloy", "", 2): (113.8, 16650.0, PRINTED),
    ("2.5 % chrome", "", 1): (105.2, 9280.0, PRINTED),
    ("2.5 % chrome", "", 2): (105.2, 22280.0, PRINTED),
    ("2.5 % chrome", "", 3): (105.2, 29280.0, PRINTED),
    ("carburised", "", 1): (0.0, 55000.0, SHIGLEY),
    ("carburised", "", 2): (0.0, 65000.0, SHIGLEY),  # 70000 where bainite and cracks are limited
    ("carburised", "", 3): (0.0, 75000.0, SHIGLEY),
    ("induction, roots", "", 1): (0.0, 45000.0, SHIGLEY),
    ("induction, roots", "", 2): (0.0, 55000.0, SHIGLEY),
    ("induction, flanks", "", 1): (0.0, 22000.0, SHIGLEY),
    ("induction, flanks", "", 2): (0.0, 22000.0, SHIGLEY),
    **{(iron, "", 1): (0.0, 1000.0 * bending, IRON) for iron, (_, bending, _) in IRONS.items()},
}

CONTACT: dict[tuple[str, str, int], tuple[float, float, str]] = {
    ("through-hardened", "", 1): (322.0, 29100.0, PRINTED),
    ("through-hardened", "", 2): (349.0, 34300.0, PRINTED),
    **{
        (treatment, surface, grade): (0.0, 1000.0 * ksi, TABLE)
        for treatment, surface, values in (
            ("nitrided", "83.5 HR15N", (150, 163, 175)),
            ("nitrided", "84.5 HR15N", (155, 168, 180)),
            ("2.5 % chrome", "87.5 HR15N", (155, 172, 189)),
            ("2.5 % chrome", "90.0 HR15N", (176, 196, 216)),
            ("nitralloy", "135M, 90.0 HR15N", (170, 183, 195)),
            ("nitralloy", "N, 90.0 HR15N", (172, 188, 205)),
            ("carburised", "", (180, 225, 275)),
            ("induction, roots", "50 HRC", (170, 190)),
            ("induction, roots", "54 HRC", (175, 195)),
            ("induction, flanks", "50 HRC", (170, 190)),
            ("induction, flanks", "54 HRC", (175, 195)),
        )
        for grade, ksi in enumerate(values, 1)
    },
    **{(iron, "", 1): (0.0, 1000.0 * contact, IRON) for iron, (contact, _, _) in IRONS.items()},
}

# through-hardened steel, psi: constant, per HB, per HB^2
BENDING_B88 = {1: (-274.0, 167.0, -0.152, OLD), 2: (6235.0, 174.0, -0.126, SINGLE)}
CONTACT_B88 = {1: (26000.0, 327.0, 0.0, OLD), 2: (27000.0, 364.0, 0.0, OLD)}

TREATMENTS = tuple(dict.fromkeys(treatment for treatment, _, _ in BENDING))
CURVES = (
    {"through-hardened": "through-hardened"}
    | dict.fromkeys(("nitrided", "nitralloy", "2.5 % chrome"), "nitrided")
    | dict.fromkeys(IRONS, "iron")
)  # kind of the life curves; carburised for all others


@dataclass(frozen=True)
class Allowable:
    """An allowable stress number [MPa], where it is from, whether two sources have it.

    within: whether the hardness lies in the range for which the line is drawn.
    """

    stress: float
    source: str
    verified: bool
    within: bool = True


def bending_allowable(treatment: str, grade: int, hardness: float = 0.0) -> Allowable:
    """Return s_at [MPa] of a treatment and a metallurgical grade.

    treatment: one of TREATMENTS ("induction, roots": flank and root hardened, type A; "flanks":
    type B). hardness [HB]: of through-hardened steel, of the core of nitrided steel; others need
    none. ValueError names what is missing. Source: AGMA 2001-D04, clause 16, figures 9 to 11, table
    4.
    """
    slope, base, source = _found(BENDING, treatment, "", grade)
    return _allowable(slope, base, source, hardness, treatment)


def contact_allowable(
    treatment: str, grade: int, hardness: float = 0.0, surface: str = ""
) -> Allowable:
    """Return s_ac [MPa] of a treatment and a metallurgical grade.

    hardness [HB] of through-hardened steel; surface: hardness of nitrided and induction hardened
    flanks as in CONTACT ("50 HRC", "84.5 HR15N"), by default the lower one of its treatment.
    ValueError names what is missing. Source: AGMA 2001-D04, clause 16, figure 8, table 3.
    """
    known = [s for t, s, g in CONTACT if (t, g) == (treatment, grade)]
    slope, base, source = _found(CONTACT, treatment, surface or (known or [""])[0], grade)
    return _allowable(slope, base, source, hardness, treatment)


def bending_allowable_b88(grade: int, hardness: float) -> Allowable:
    """Return s_at [MPa] of through-hardened steel by AGMA 2001-B88: -274 + 167 HB - 0.152 HB^2 psi.

    Grade 2: 6235 + 174 HB - 0.126 HB^2, unverified. hardness [HB], 180 to 400.
    """
    return _old(BENDING_B88, grade, hardness)


def contact_allowable_b88(grade: int, hardness: float) -> Allowable:
    """Return s_ac [MPa] of through-hardened steel by AGMA 2001-B88: 26000 + 327 HB psi.

    Grade 2: 27000 + 364 HB. hardness [HB], 180 to 400.
    """
    return _old(CONTACT_B88, grade, hardness)


def _old(
    lines: dict[int, tuple[float, float, float, str]], grade: int, hardness: float
) -> Allowable:
    if grade not in lines:
        raise ValueError(f"no grade {grade} in AGMA 2001-B88: 1 or 2")
    if not hardness > 0.0:
        raise ValueError("the strength of through-hardened steel needs its hardness in HB")
    base, slope, bend, source = lines[grade]
    at = min(hardness, HARDNESS[1])
    psi = base + slope * at + bend * at**2
    within = HARDNESS[0] <= hardness <= HARDNESS[1]
    return Allowable(PSI * psi, source, source != SINGLE, within)


def _found(
    table: dict[tuple[str, str, int], tuple[float, float, str]],
    treatment: str,
    surface: str,
    grade: int,
) -> tuple[float, float, str]:
    if (treatment, surface, grade) in table:
        return table[treatment, surface, grade]
    if treatment not in TREATMENTS:
        raise ValueError(f"no treatment {treatment!r}; known: {', '.join(TREATMENTS)}")
    known = [f"grade {g} {s}".strip() for t, s, g in table if t == treatment]
    raise ValueError(
        f"no allowable stress of {treatment} steel, grade {grade} {surface}".rstrip()
        + f"; known: {', '.join(known)}"
    )


def _allowable(
    slope: float, base: float, source: str, hardness: float, treatment: str
) -> Allowable:
    """Return base + slope HB, beyond the line its end; a hardness is asked for where it matters."""
    if slope and hardness <= 0.0:
        raise ValueError(f"the strength of {treatment} steel needs its hardness in HB")
    low, high = NITRIDED_CORE.get(treatment, HARDNESS)
    within = not slope or low <= hardness <= high
    verified = source not in (SINGLE, IRON)
    return Allowable(PSI * (base + slope * min(hardness, high)), source, verified, within)
