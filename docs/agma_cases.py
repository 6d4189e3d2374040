"""Published ratings and gears, value by value, beside what the program computes: for docs/agma.md.

Every row has the tolerance that it is held to (tests/docs/test_agma_cases.py) and, where the
printed value is rounded coarser than that or follows another rule, the reason.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from gearopt.bench.rating import THINNING, TOOL
from gearopt.physics.agma.allowables import PSI
from gearopt.physics.agma.bending import thinned
from gearopt.physics.agma.factors import FEET_PER_MINUTE, INCH
from gearopt.physics.agma.mesh import mean_load_sharing, mesh_of, pitch_point_factor
from gearopt.physics.agma.rating import rate
from gearopt.physics.agma.rating_factors import Practice, Steel
from gearopt.physics.agma.refusals import single_factors
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.contact import active_root_diameters, contact_path, usable_path
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.tooth import base_helix_angle, tip_thickness, virtual_teeth
from gearopt.physics.loads import pitch_line_velocity
from gearopt.physics.rating import Operation, Rating

POUND = 4.4482216152605  # N
HORSEPOWER = 550.0 * 12.0 * POUND * INCH  # N mm/s
RPM = math.pi / 30.0
TOOL_25 = Rack(math.radians(25.0), 1.0, 1.35, 0.27)
SIZES = (1.043, 1.052)  # K_s of Shigley 14-4, which 14-5 keeps


@dataclass(frozen=True)
class Row:
    """A quantity, its printed and computed values, the tolerance, and a remark.

    tolerance: relative; within: absolute, in its place where it is not 0.
    """

    quantity: str
    printed: tuple[float, ...]
    computed: tuple[float, ...]
    tolerance: float = 3e-3
    reason: str = ""
    within: float = 0.0


@dataclass(frozen=True)
class Case:
    """A published case: title, what is given, where it was read."""

    title: str
    given: str
    source: str
    rows: tuple[Row, ...]


def cases() -> tuple[Case, ...]:
    """Return all cases."""
    return (
        _shigley_spur(),
        _shigley_helical(),
        _shigley_four_to_one(),
        _norton(),
        _mott(),
        _report(),
        _iso_example(),
        _shifted(),
    )


def _inches(
    z1: int, z2: int, pitch: float, width: float, rack: Rack = TOOL, psi: float = 0.0
) -> GearPair:
    """Return a pair of a normal diametral pitch and a face width in inches."""
    helix = math.radians(psi)
    pair = GearPair.of_teeth(INCH / pitch, z1, z2, INCH * width, helix, rack)
    return thinned(pair, THINNING * INCH / pitch)


def _operation(hp: float, rpm: float, cycles: float, reliability: float) -> Operation:
    hours = cycles / 60.0 / rpm
    return Operation(HORSEPOWER * hp, RPM * rpm, hours, reliability=reliability)


def _two(values: object) -> tuple[float, ...]:
    """Return a value or those of pinion and wheel as floats."""
    return tuple(float(v) for v in (values if isinstance(values, tuple) else (values,)))


def _factors(found: Rating, **printed: object) -> Iterator[Row]:
    """Return rows of factors by symbol."""
    for symbol, known in printed.items():
        factor = found.factors[symbol]
        scale = {"MPa": PSI, "sqrt(MPa)": PSI**0.5}.get(factor.unit, 1.0)
        made = tuple(v / scale for v in _two(factor.value))
        unit = {"MPa": " [psi]", "sqrt(MPa)": " [sqrt(psi)]"}.get(factor.unit, "")
        yield Row(symbol + unit, _two(known), made)


def _loads(found: Rating, speed: float, load: float) -> tuple[Row, Row]:
    return (
        Row("V [ft/min]", (speed,), (found.speed / FEET_PER_MINUTE,)),
        Row("W_t [lbf]", (load,), (found.load / POUND,)),
    )


def _psi(stresses: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(s / PSI for s in stresses)


SHIGLEY = "4 hp, 1800 rpm, F 1.5 in, Q_v 6, HB 240/200 grade 1, 1e8 cycles, R 0.90, C_p 2300"
STEELS = Steel(hardness=240.0), Steel(hardness=200.0)
POINT = "given: the book takes it at the pitch point; by 908 {}"
CHART = "given: a chart's; by 908 {}"


def _shigley_rating(pair: GearPair, given: dict[str, object]) -> Rating:
    own = {"C_p": 2300.0 * PSI**0.5} | given
    return rate(pair, _operation(4.0, 1800.0, 1e8, 0.9), STEELS, Practice(size=True), own)


def _by_908(pair: GearPair) -> tuple[str, str]:
    found = single_factors(pair)
    first, second = found.bending
    return f"{found.pitting:.4f}", f"{first:.4f}, {second:.4f}"


def _shigley_spur() -> Case:
    pair = _inches(17, 52, 10.0, 1.5)
    factor = pitch_point_factor(pair)
    found = _shigley_rating(pair, {"I": factor, "J": (0.30, 0.40)})
    exact_i, exact_j = _by_908(pair)
    rows = (
        *_loads(found, 801.1, 164.8),
        *_factors(found, K_v=1.377, K_s=SIZES, K_m=1.22),
        *_factors(found, K_R=0.85, Y_N=(0.977, 0.996), Z_N=(0.948, 0.973), C_H=(1.0, 1.005)),
        *_factors(found, s_at=(31350, 28260), s_ac=(106400, 93500)),
        Row("I", (0.121,), (float(factor),), reason=POINT.format(exact_i)),
        Row("J", (0.30, 0.40), (0.30, 0.40), reason=CHART.format(exact_j)),
        Row("bending [psi]", (6417, 4854), _psi(found.bending_stress)),
        Row("S_F", (5.62, 6.82), found.bending_safety),
        Row("contact [psi]", (70360, 70660), _psi(found.contact_stress)),
        Row("S_H", (1.69, 1.52), found.contact_safety),
    )
    source = "read in r3kste/pydome, `test_example_14_4`; S_F, S_H not checked against the print"
    return Case("Shigley, example 14-4: spur", "17/52 teeth, P 10; " + SHIGLEY, source, rows)


def _shigley_helical() -> Case:
    pair = _inches(17, 52, 10.0, 1.5, psi=30.0)
    path = mesh_of(pair).path
    sharing = mean_load_sharing(pair, path)
    factor = pitch_point_factor(pair, sharing)
    found = _shigley_rating(pair, {"I": factor, "J": (0.423, 0.529), "K_s": SIZES})
    exact_i, exact_j = _by_908(pair)
    rows = (
        Row("d_1 [in]", (1.963,), (float(pair.pinion.reference_diameter) / INCH,)),
        *_loads(found, 925.0, 142.7),
        *_factors(found, K_v=1.404, K_m=1.208, K_s=SIZES),
        Row("Z [in]", (0.4507,), (float(path.length) / INCH,)),
        Row("m_N", (0.6895,), (float(sharing),), reason="given: p_N/(0.95 Z)"),
        Row("I", (0.195,), (float(factor),), reason=POINT.format(exact_i)),
        Row("J", (0.423, 0.529), (0.423, 0.529), reason=CHART.format(exact_j)),
        Row("bending [psi]", (3445, 2779), _psi(found.bending_stress)),
        Row("S_F", (10.5, 11.9), found.bending_safety, 6e-3, "one decimal"),
        Row("contact [psi]", (48230, 48440), _psi(found.contact_stress)),
        Row("S_H", (2.46, 2.22), found.contact_safety),
    )
    given = "17/52 teeth, P_n 10, psi 30 deg, K_s of 14-4; " + SHIGLEY
    return Case(
        "Shigley, example 14-5: helical", given, "not checked against the print, recomputed", rows
    )


def _shigley_four_to_one() -> Case:
    pair = _inches(18, 72, 4.0, math.pi)
    steel = Steel("nitralloy", 1, 320.0)
    operation, practice = _operation(100.0, 1120.0, 1e9, 0.95), Practice(size=True)
    found = rate(pair, operation, (steel, steel), practice)
    exact_i, exact_j = _by_908(pair)
    rows = (
        *_loads(found, 1319.0, 2502.0),
        *_factors(found, K_v=1.48, K_R=0.885, Y_N=(0.938, 0.961), Z_N=(0.900, 0.929)),
        Row("K_s", (1.14,), _two(found.factors["K_s"].value)[:1]),
        Row("s_at [psi]", (40310,), _psi(_two(found.factors["s_at"].value))[:1]),
        Row("s_ac [psi]", (170000,), _psi(_two(found.factors["s_ac"].value))[:1]),
        Row("K_m", (1.247,), _two(found.factors["K_m"].value), reason="of C_ma 0.175"),
        Row("I", (0.1286,), (float(pitch_point_factor(pair)),), reason=POINT.format(exact_i)),
        Row("J", (0.32, 0.415), (0.32, 0.415), reason=CHART.format(exact_j)),
    )
    given = "18/72 teeth, P 4, F 3.14 in, 100 hp, 1120 rpm, Q_v 6, nitralloy 320 HB grade 1, 1e9"
    source = "inputs and S_t read in a public answer (mathworks.com, 1705755); rest not checked"
    return Case("Shigley, example 14-8: factors", given + " cycles, R 0.95", source, rows)


def _norton() -> Case:
    first, second = (_inches(*teeth, 6.0, 2.0, TOOL_25) for teeth in ((14, 17), (17, 49)))
    own, steels = {"K_m": 1.6}, (Steel(hardness=250.0), Steel(hardness=250.0))
    idler = 1.42  # K_I: of the stress in Norton, 1/0.7 of the strength in the standard
    speeds = 2500.0, 2500.0 * 14.0 / 17.0
    rated = [
        rate(pair, _operation(20.0, rpm, 1e8, 0.99), steels, None, own | {"J": bent})
        for pair, rpm, bent in zip(
            (first, second), speeds, ((0.33, 0.37), (0.37, 0.46)), strict=True
        )
    ]
    bent = rated[0].bending_stress[0], idler * rated[0].bending_stress[1]
    bent = (*bent, rated[1].bending_stress[1])
    made_i = tuple(float(single_factors(pair).pitting) for pair in (first, second))
    hand = "by hand, by the book's formula"
    rows = (
        *_loads(rated[0], 1527.0, 432.17),
        Row("1/K_v", (0.66,), (1.0 / rated[0].factors["K_v"].value,)),
        Row("I of pinion and idler", (0.0906,), made_i[:1], reason=hand),
        Row("I of idler and wheel", (0.1165,), made_i[1:], reason=hand),
        Row("bending [psi]", (9526, 12065, 6834), _psi(bent), reason="K_I 1.42 of the idler"),
    )
    given = (
        "14/17/49 teeth, 25 deg, P 6, F 2 in, 20 hp, 2500 rpm, Q_v 6, K_m 1.6, J 0.33, 0.37, 0.46"
    )
    return Case(
        "Norton, example 12-6: an idler", given, "not checked against the print, recomputed", rows
    )


def _mott() -> Case:
    pair = _inches(20, 70, 8.0, 1.5)
    own = {"C_p": 2300.0 * PSI**0.5, "I": 0.108, "J": (0.335, 0.42)}
    operation = replace(_operation(25.0, 1750.0, 1e8, 0.99), overload=1.5)
    steels = Steel(hardness=300.0), Steel(hardness=300.0)
    found = rate(pair, operation, steels, Practice(quality=6), own)
    exact_i, exact_j = _by_908(pair)
    other = float(single_factors(_inches(17, 41, 8.0, 1.5)).pitting)
    rows = (
        *_loads(found, 1145.0, 720.0),
        *_factors(found, K_v=1.45, K_m=1.19),
        Row("I", (0.108,), (0.108,), reason=CHART.format(exact_i)),
        Row("J", (0.335, 0.420), (0.335, 0.420), reason=CHART.format(exact_j)),
        Row("bending [psi]", (29700, 23700), _psi(found.bending_stress)),
        Row("contact [psi]", (156000,), _psi(found.contact_stress[:1])),
        Row("I of 17/41 teeth", (0.094356,), (other,), 1e-5, "the book's formula in a program"),
    )
    given = "20/70 teeth, P 8, F 1.5 in, 25 hp, 1750 rpm, Q_v 6, K_o 1.5, C_p 2300"
    source = "inputs read in a public answer (holooly.com); values not checked, recomputed"
    return Case("Mott, example 9-1: spur", given, source, rows)


def _report() -> Case:
    """Return the geometry of a printed report."""
    pair = GearPair.of_teeth(14.0, 24, 95, 360.0, math.radians(10.0), profile_shifts=(0.48, 0.6691))
    gears = [replace(gear, tip_alteration=-0.938 / 14.0) for gear in pair.gears]
    pair = GearPair(*gears, 861.0)
    first, second = pair.gears
    speed = 1165.9 * RPM
    load = 2e3 * 40953.0 / first.reference_diameter
    found = (
        ("alpha_t [deg]", (20.284,), (math.degrees(first.transverse_pressure_angle),)),
        ("alpha_wt [deg]", (22.856,), (math.degrees(pair.working_angle),)),
        ("beta_b [deg]", (9.391,), (math.degrees(base_helix_angle(first)),)),
        ("d", (341.183, 1350.517), (first.reference_diameter, second.reference_diameter)),
        ("d_b", (320.026, 1266.770), (first.base_diameter, second.base_diameter)),
        ("d_a", (380.747, 1395.376), (first.tip_diameter, second.tip_diameter)),
        ("d_w", (347.294, 1374.706), pair.working_diameters),
        ("d_f", (319.623, 1334.252), (first.root_diameter, second.root_diameter)),
        ("d_Ff", (328.991, 1341.487), (form_diameter(first), form_diameter(second))),
        ("d_Nf", (330.798, 1348.584), active_root_diameters(pair)),
        ("s_an", (8.800, 11.034), (tip_thickness(first), tip_thickness(second))),
        ("z_n", (25.037, 99.104), (virtual_teeth(first), virtual_teeth(second))),
        ("g_alpha", (61.276,), (contact_path(pair).length,)),
        ("eps_alpha", (1.463,), (usable_path(pair).transverse_ratio,)),
        ("eps_beta", (1.421,), (pair.overlap_ratio,)),
        ("eps_gamma", (2.884,), (usable_path(pair).transverse_ratio + pair.overlap_ratio,)),
        ("F_t [N]", (240064.4,), (load,)),
        ("v [m/s]", (20.83,), (1e-3 * pitch_line_velocity(speed, first.reference_diameter),)),
    )
    digits = {"F_t [N]": 0.1, "v [m/s]": 0.006}  # printed with three decimals but for these
    rows = tuple(
        Row(name, known, _two(tuple(made)), within=digits.get(name, 6e-4))
        for name, known, made in found
    )
    factors = single_factors(pair)
    other = "not printed: another program's"
    rows += (
        Row("I", (0.2080,), _two(factors.pitting), reason=other),
        Row("J", (0.547, 0.540), _two(factors.bending), reason=other),
    )
    given = (
        "z 24/95, m_n 14, beta 10, x 0.48/0.6691, k m_n -0.938, a 861, b 360, rack 1.25/0.38/1.0; "
        "lengths in mm"
    )
    source = "gfsReboucas/Drivetrain, `@NREL_5MW/stage_03.rtf` (KISSsoft 03/2017)"
    return Case("A printed report: NREL 5 MW, high-speed pair", given, source, rows)


def _iso_example() -> Case:
    """Return the geometry of ISO/TR 6336-30, example 1."""
    rack = Rack(dedendum=1.4, tip_radius=0.39)
    shifts = 0.14522, 0.0
    pair = GearPair.of_teeth(8.0, 17, 103, 100.0, math.radians(15.8), rack, shifts)
    first, second = pair.gears
    load = 2.0 * 9e6 / first.reference_diameter
    velocity = 1e-3 * pitch_line_velocity(360.0 * RPM, first.reference_diameter)
    factors = single_factors(pair)
    other = "not printed: another program's"
    rows = (
        Row("a", (500.0,), _two(pair.centre_distance), within=6e-4),
        Row("d_a", (159.66, 872.35), _two((first.tip_diameter, second.tip_diameter)), within=6e-3),
        Row(
            "z_n",
            (18.905, 114.543),
            _two((virtual_teeth(first), virtual_teeth(second))),
            within=6e-4,
        ),
        Row("F_t [N]", (127352.0,), _two(load), within=0.6),
        Row("v [m/s]", (2.664,), _two(velocity), within=6e-4),
        Row("I", (0.2435,), _two(factors.pitting), reason=other),
        Row("J", (0.523, 0.591), _two(factors.bending), reason=other),
    )
    given = "z 17/103, m_n 8, beta 15.8, x 0.14522/0, b 100, rack 1.4/0.39/1.0; lengths in mm"
    source = "gfsReboucas/Drivetrain, `MATISO_6336.m`; a public test of the 2022 edition"
    return Case("ISO/TR 6336-30, example 1: geometry", given, source, rows)


def _shifted() -> Case:
    """Return the geometry of a shifted pair in the tests of a public program."""
    pair = GearPair.of_teeth(4.0, 19, 104, 48.64, profile_shifts=(0.5, 0.15))
    first, second = pair.gears
    values = (
        ("a", (248.506843355171,), pair.centre_distance),
        ("alpha_wt [deg]", (21.531902292465,), math.degrees(pair.working_angle)),
        ("d_b", (71.416639180, 390.912130247), (first.base_diameter, second.base_diameter)),
        ("d_a", (88.0, 425.2), (first.tip_diameter, second.tip_diameter)),
        ("d_f", (70.0, 407.2), (first.root_diameter, second.root_diameter)),
        ("d_w", (76.774471931, 420.239214779), pair.working_diameters),
        ("eps_alpha", (1.536323594583,), pair.transverse_contact_ratio),
    )
    rows = tuple(Row(name, known, _two(made), 1e-11) for name, known, made in values)
    given = "z 19/104, m_n 4, x 0.5/0.15, rack 1.25/0.25/1.0; lengths in mm"
    source = "hanslhansl/din3990, `tests/test_1.py`: a public program's own values"
    return Case("A shifted pair by another program: geometry", given, source, rows)


def printed(value: float) -> int:
    """Return how many decimals a value has."""
    text = f"{value:.6f}".rstrip("0")
    return len(text) - text.index(".") - 1


def digits(value: float) -> int:
    """Return decimals to show of a computed value: those of the printed one and one more."""
    return printed(value) + (1 if abs(value) < 1000 else 0)
