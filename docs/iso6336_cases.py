"""Two published ISO cases, inputs and printed values: for docs/iso6336.md and its tests.

tr30: ISO/TR 6336-30:2017, annex A, example 1: reference column of gfsReboucas/Drivetrain,
MATISO_6336.m; tip diameters, h_fP and rho_fP of a public test of the edition of 2022. report:
KISSsoft 03/2017, ISO 6336:2006 method B, high-speed pair of the NREL 5 MW gearbox:
gfsReboucas/Drivetrain, @NREL_5MW/stage_03.rtf.
"""

import math
from dataclasses import replace

from iso6336_reports import (
    RING_1,
    RING_2,
    STAGE_1,
    STAGE_2,
    case_ring_1,
    case_ring_2,
    case_stage_1,
    case_stage_2,
)

from gearopt.bench.rating import iso_example
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.contact import active_root_diameters, contact_path
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.tooth import base_helix_angle, tip_thickness, virtual_teeth
from gearopt.physics.iso6336 import stiffness
from gearopt.physics.iso6336.case import Case, Practice
from gearopt.physics.iso6336.chain import quantities
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.rating import Operation

RPM = math.pi / 30.0


def case_report() -> Case:
    """K_Hbeta 1.15 and sigma_Flim 430 are inputs of the report; n1 is printed rounded (F_t)."""
    made = GearPair.of_teeth(
        14.0, 24, 95, 360.0, math.radians(10.0), Rack(), (0.48, 0.6691), working_distance=861.0
    )
    gears = (replace(g, tip_alteration=-0.938 / 14.0) for g in made.gears)
    pair = GearPair(*gears, working_distance=861.0)
    steel = Material("Eh", "MQ")
    operation = Operation(5e9, 1165.9 * RPM, 175200.0, overload=1.25)
    webs = (0.25, 5.0), (0.25, 5.0)
    practice = Practice(grades=(6.0, 6.0), relief=2e-3, webs=webs, bores=(179.1, 1193.32))
    given = {"K_Hbeta": 1.15, "sigma_Flim": (430.0, 430.0)}
    return Case(pair, operation, (steel, steel), practice, given)


# symbol: printed, relative tolerance. K_v and K_Hbeta are printed rounded
TR30 = {
    "F_t": ((127352.0,), 5e-4),
    "v": ((2.664,), 5e-4),
    "z_n": ((18.905, 114.543), 5e-4),
    "c_prime_th": ((17.85584,), 1e-6),
    "c_prime": ((12.37047,), 1e-6),
    "c_gamma_alpha": ((17.46485,), 1e-6),
    "c_gamma_beta": ((14.84512,), 1e-6),
    "K_v": ((1.003,), 5e-4),
    "K_Hbeta": ((1.16,), 5e-3),
    "K_Fbeta": ((1.12803,), 5e-6),
    "K_Halpha": ((1.0,), 5e-4),
    "K_Falpha": ((1.0,), 5e-4),
    "Z_H": ((2.39533,), 5e-6),
    "Z_E": ((189.8117,), 5e-7),
    "Z_eps": ((0.803,), 6e-4),
    "Z_beta": ((1.01944,), 5e-6),
    "Z_BD": ((1.0, 1.0), 5e-4),
    "sigma_H0": ((1206.58207,), 5e-9),
    "sigma_H": ((1301.35343, 1301.35343), 5e-9),
    "N_L": ((1.08e9, 1.783e8), 5e-4),
    "Z_NT": ((0.91, 0.962), 6e-4),
    "Z_L": ((1.04739, 1.04739), 5e-6),
    "Z_v": ((0.96911, 0.96911), 6e-6),
    "Z_R": ((0.96599, 0.96599), 6e-6),
    "Z_W": ((1.0, 1.0), 5e-4),
    "Z_X": ((1.0,), 5e-4),
    "sigma_HG": ((1338.4805, 1414.52551), 5e-9),
    "S_H": ((1.02853, 1.08696), 6e-6),
}
REPORT = {
    "alpha_t": ((20.284,), 3e-5),
    "alpha_wt": ((22.856,), 3e-5),
    "beta_b": ((9.391,), 6e-5),
    "d": ((341.183, 1350.517), 2e-6),
    "d_b": ((320.026, 1266.77), 2e-6),
    "d_a": ((380.747, 1395.376), 3e-6),
    "d_w": ((347.294, 1374.706), 2e-6),
    "d_f": ((319.623, 1334.252), 4e-6),
    "d_Ff": ((328.991, 1341.487), 4e-6),
    "d_Nf": ((330.798, 1348.584), 4e-6),
    "z_n": ((25.037, 99.104), 2e-5),
    "g_alpha": ((61.276,), 1e-5),
    "eps_alpha": ((1.463,), 4e-4),
    "eps_beta": ((1.421,), 4e-4),
    "eps_gamma": ((2.884,), 2e-4),
    "F_t": ((240064.4,), 2e-5),
    "v": ((20.83,), 3e-4),
    "f_pb": ((15.9,), 4e-3),
    "f_falpha": ((22.0,), 1e-9),
    "C_R": ((0.898,), 6e-4),
    "c_prime": ((13.832,), 4e-5),
    "c_gamma_alpha": ((18.632,), 3e-5),
    "c_gamma_beta": ((15.837,), 4e-5),
    "m_red": ((0.36503,), 0.012),
    "n_E1": ((2843.0,), 6e-3),
    "N": ((0.41,), 6e-3),
    "K_v": ((1.092,), 5e-4),
    "K_Fbeta": ((1.136,), 5e-4),
    "K_Halpha": ((1.069,), 5e-4),
    "K_Falpha": ((1.069,), 5e-4),
    "Y_F": ((1.18, 1.24), 3e-3),
    "Y_S": ((2.28, 2.35), 4e-3),
    "alpha_Fen": ((23.89, 22.20), 1.5e-3),
    "h_F": ((1.004, 1.151), 3e-3),
    "s_Fn": ((2.227, 2.340), 3e-4),
    "rho_F": ((0.425, 0.385), 1e-3),
    "d_en": ((369.487, 1415.619), 2e-6),
    "q_s": ((2.620, 3.036), 2e-4),
    "Y_beta": ((0.917,), 6e-4),
    "Y_DT": ((1.0,), 5e-4),
    "Y_B": ((1.0, 1.0), 5e-3),
    "sigma_F0": ((117.92, 127.69), 1.5e-3),
    "sigma_F": ((195.64, 211.85), 2e-3),
    "Y_deltarelT": ((1.001, 1.005), 6e-4),
    "Y_RrelT": ((0.957, 0.957), 6e-4),
    "Y_X": ((0.91, 0.91), 5e-4),
    "Y_NT": ((0.85, 0.87), 5e-4),
    "sigma_FG": ((637.15, 654.72), 1e-5),
    "S_F": ((3.26, 3.09), 2e-3),
    "Z_H": ((2.307,), 3e-4),
    "Z_E": ((189.812,), 3e-6),
    "Z_eps": ((0.827,), 6e-4),
    "Z_beta": ((1.008,), 5e-4),
    "Z_BD": ((1.0, 1.0), 5e-3),
    "sigma_H0": ((570.79,), 1e-5),
    "sigma_H": ((739.61, 739.61), 5e-4),
    "Z_L": ((1.02, 1.02), 5e-4),
    "Z_v": ((1.022, 1.022), 5e-4),
    "Z_R": ((1.007, 1.007), 5e-4),
    "Z_W": ((1.0, 1.0), 5e-4),
    "Z_X": ((1.0,), 5e-4),
    "Z_NT": ((0.85, 0.881), 5e-4),
    "sigma_HG": ((1338.30, 1387.31), 5e-6),
    "S_H": ((1.81, 1.88), 3e-3),
    "s_an": ((8.8, 11.034), 5e-5),
}
CASES = {
    "tr30": (iso_example, TR30),
    "report": (case_report, REPORT),
    "stage 2": (case_stage_2, STAGE_2),
    "stage 1": (case_stage_1, STAGE_1),
    "ring 2": (case_ring_2, RING_2),
    "ring 1": (case_ring_1, RING_1),
}


def computed(case: Case) -> dict[str, tuple[float, ...]]:
    """Return every quantity by its symbol, in the units of the prints."""
    found = quantities(case)
    found |= _geometry(case) | _sections(case)
    found["S_F"] = [a / b for a, b in zip(found["sigma_FG"], found["sigma_F"], strict=True)]
    found["S_H"] = [a / b for a, b in zip(found["sigma_HG"], found["sigma_H"], strict=True)]
    for symbol in ("c_prime", "c_gamma_alpha", "c_gamma_beta"):
        found[symbol] *= 1e-3
    for symbol in ("f_pb", "f_falpha"):
        found[symbol] *= 1e3
    return {name: _row(value) for name, value in found.items()}


def _row(value) -> tuple[float, ...]:
    rows = value if isinstance(value, tuple | list) else (value,)
    return tuple(float(v) for v in rows)


def _geometry(case: Case) -> dict:
    pair, path = case.pair, contact_path(case.pair)
    of_gears = {
        "d": lambda g: g.reference_diameter,
        "d_b": lambda g: g.base_diameter,
        "d_a": lambda g: g.tip_diameter,
        "d_f": lambda g: g.root_diameter,
        "d_Ff": form_diameter,
        "z_n": virtual_teeth,
        "s_an": tip_thickness,
    }
    return {name: [law(g) for g in pair.gears] for name, law in of_gears.items()} | {
        "alpha_t": math.degrees(pair.pinion.transverse_pressure_angle),
        "alpha_wt": math.degrees(pair.working_angle),
        "beta_b": math.degrees(base_helix_angle(pair.pinion)),
        "d_w": pair.working_diameters,
        "d_Nf": active_root_diameters(pair),
        "g_alpha": path.length,
        "eps_alpha": case.transverse_ratio,
        "eps_beta": pair.overlap_ratio,
        "eps_gamma": case.total_ratio,
        "F_t": case.load,
        "v": 1e-3 * case.speed,
        "N_L": case.cycles,
    }


def _sections(case: Case) -> dict:
    forms, module = case.forms, case.pair.normal_module
    practice = case.practice
    densities = 7.83e-9, 7.83e-9
    mass = stiffness.reduced_mass(case.pair, densities, practice.bores, practice.meshes)
    resonance = quantities(case)["N"]
    web = case.practice.webs[0]
    return {
        "h_F": [f.height for f in forms],
        "s_Fn": [f.thickness for f in forms],
        "rho_F": [f.fillet_radius for f in forms],
        "q_s": [f.notch for f in forms],
        "alpha_Fen": [math.degrees(f.load_angle) for f in forms],
        "d_en": [module * f.load_diameter for f in forms],
        "c_prime_th": 1e-3 * stiffness.theoretical_stiffness(case.pair),
        "m_red": 1e3 * mass,
        "n_E1": case.operation.pinion_speed / resonance / RPM,
        "C_R": 1.0 if web is None else stiffness.blank_factor(*web),
    }
