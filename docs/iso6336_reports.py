"""Both planetary stages of a printed report: for docs/iso6336.md and its tests.

KISSsoft 03/2017, ISO 6336:2006 method B, NREL 5 MW gearbox: gfsReboucas/Drivetrain,
@NREL_5MW/stage_01.rtf and stage_02.rtf. Spur gears, in stage 1 of 19 and 17 teeth; load of one
planet, speed against the carrier. Shifts, K_v and K_Hbeta are as printed, rounded; s_R/m_n 3.5 of
the webs is inferred from C_R. Rings are held by the casing and cut by a pinion-type cutter.
"""

import math
from dataclasses import replace

from gearopt.physics.gears import Cutter, GearPair, Rack
from gearopt.physics.iso6336.case import Case, Practice
from gearopt.physics.iso6336.materials import Material
from gearopt.physics.rating import Operation

RPM = math.pi / 30.0
HOURS = 175200.0
PLANETS = 3.0


def _sun_and_planet(
    pair: GearPair, shortening: float, load: float, rpm: float, given: dict[str, float]
) -> Case:
    """Return the case of a tip alteration [mm], a tangential load F_t [N] and a relative speed."""
    first, second = (replace(g, tip_alteration=shortening / g.normal_module) for g in pair.gears)
    pair = GearPair(first, second, pair.working_distance)
    power = 0.5 * load * first.reference_diameter * rpm * RPM
    operation = Operation(power, rpm * RPM, HOURS, overload=1.25, contacts=(PLANETS, 1.0))
    bores = (194.32, 576.96) if pair.pinion_teeth == 18 else (482.33, 408.99)
    webs = ((0.25, 3.5),) * 2
    practice = Practice(webs=webs, relief=2e-3, bores=bores, meshes=(PLANETS, 1.0))
    sun = Material("Eh", "MQ")
    planet = Material("Eh", "MQ", reversed_load=True)
    strengths = {"sigma_Flim": (430.0, 430.0), "K_gamma": 1.10}
    return Case(pair, operation, (sun, planet), practice, strengths | given)


def case_stage_2() -> Case:
    """Z 18/36, m_n 21, b 550, a 584; F_t 285.9 kN a planet."""
    pair = GearPair.of_teeth(21.0, 18, 36, 550.0, 0.0, Rack(), (0.3890, 0.5039), 584.0)
    rpm = 7782.3e6 / PLANETS / HOURS / 60.0
    return _sun_and_planet(pair, -1.750, 285900.438, rpm, {"K_v": 1.06, "K_Hbeta": 2.06})


def case_stage_1() -> Case:
    """Z 19/17, m_n 45, b 491, a 863; F_t 779.5 kN a planet."""
    pair = GearPair.of_teeth(45.0, 19, 17, 491.0, 0.0, Rack(), (0.6170, 0.8021), 863.0)
    rpm = 1124.7e6 / PLANETS / HOURS / 60.0
    return _sun_and_planet(pair, -10.861, 1587.48 * 491.0, rpm, {"K_v": 1.01, "K_Hbeta": 1.15})


def _planet_and_ring(
    pair: GearPair, lengths: tuple[float, float, float], load: float, cycles: float
) -> Case:
    """Return the case of planet and fixed ring, K_v computed; F_t [N], cycles of a planet's flank.

    lengths [mm]: tip alteration and bore of the planet, outside diameter of the ring. C_a: the mean
    of the printed 2.0 and 8.5 um.
    """
    shortening, bore, outside = lengths
    planet = replace(pair.pinion, tip_alteration=shortening / pair.normal_module)
    pair = GearPair(planet, replace(pair.wheel, outside_diameter=-outside), pair.working_distance)
    speed = cycles / HOURS / 60.0 * RPM
    power = 0.5 * load * planet.reference_diameter * speed
    operation = Operation(power, speed, HOURS, overload=1.25, contacts=(1.0, PLANETS))
    webs = ((0.25, 3.5),) * 2
    practice = Practice(webs=webs, relief=5.25e-3, bores=(bore, 0.0), meshes=(1.0, 0.0))
    hard = Material("Eh", "MQ", reversed_load=True)
    soft = Material("V alloy", "MQ", 240.0, yield_strength=1000.0, flank=8e-3)
    given = {"sigma_Flim": (430.0, 290.0), "sigma_Hlim": (1500.0, 700.0), "K_gamma": 1.10}
    return Case(pair, operation, (hard, soft), practice, given | {"K_Hbeta": 1.15})


RACK_B = Rack(tip_radius=0.30)  # ISO 53 profile B, of both rings


def case_ring_2() -> Case:
    """Z 36/-93, m_n 21, b 550, a -584, cutter of 30 teeth; F_t 285.9 kN a planet."""
    racks, shifts, cutter = (Rack(), RACK_B), (0.5039, 0.1171), Cutter(30, tip_radius=0.30)
    pair = GearPair.internal(21.0, 36, -93, 550.0, 0.0, racks, shifts, -584.0, cutter)
    return _planet_and_ring(pair, (-1.750, 576.96, 2148.82), 285900.438, 1297.1e6)


def case_ring_1() -> Case:
    """Z 17/-56, m_n 45, b 491, a -863, cutter of 36 teeth; F_t 779.5 kN a planet, K_v given."""
    racks, shifts, cutter = (Rack(), RACK_B), (0.8021, -0.5013), Cutter(36, tip_radius=0.30)
    pair = GearPair.internal(45.0, 17, -56, 491.0, 0.0, racks, shifts, -863.0, cutter)
    case = _planet_and_ring(pair, (-10.861, 408.99, 2994.24), 779454.877, 419.0e6)
    return replace(case, given={**case.given, "K_v": 1.05})


# symbol: printed, relative tolerance
STAGE_2 = {
    "m_red": ((0.1534,), 4e-4),
    "n_E1": ((5357.0,), 1e-4),
    "N": ((0.046,), 0.011),
    "alpha_wt": ((24.169,), 3e-5),
    "d_b": ((355.204, 710.408), 2e-6),
    "d_a": ((432.838, 815.663), 3e-6),
    "d_w": ((389.333, 778.667), 2e-6),
    "d_f": ((341.838, 724.663), 3e-6),
    "d_Ff": ((359.324, 737.389), 3e-6),
    "d_Nf": ((363.547, 746.983), 3e-6),
    "s_an": ((12.910, 14.858), 1e-4),
    "g_alpha": ((84.952,), 2e-5),
    "eps_alpha": ((1.370,), 4e-4),
    "F_t": ((285900.438,), 1e-8),
    "v": ((4.88,), 2e-3),
    "N_L": ((7782.3e6, 1297.1e6), 5e-5),
    "C_R": ((0.862,), 6e-4),
    "c_prime": ((12.240,), 1e-3),
    "c_gamma_alpha": ((15.640,), 1e-3),
    "c_gamma_beta": ((13.294,), 1e-3),
    "K_Fbeta": ((1.94,), 3e-3),
    "K_Halpha": ((1.0,), 5e-3),
    "K_Falpha": ((1.0,), 5e-3),
    "Y_F": ((1.47, 1.38), 4e-3),
    "Y_S": ((2.04, 2.18), 3e-3),
    "h_F": ((1.159, 1.225), 5e-4),
    "s_Fn": ((2.132, 2.271), 3e-4),
    "rho_F": ((0.453, 0.414), 1.2e-3),
    "alpha_Fen": ((25.74, 24.68), 2e-4),
    "sigma_F0": ((73.95, 74.21), 1e-4),
    "sigma_F": ((209.38, 210.14), 5e-3),
    "Y_deltarelT": ((0.999, 1.002), 6e-4),
    "Y_RrelT": ((0.957, 0.957), 6e-4),
    "Y_X": ((0.84, 0.84), 5e-4),
    "Y_NT": ((0.854, 0.886), 6e-4),
    "Y_M": ((1.0, 0.7), 5e-4),
    "sigma_FG": ((589.60, 429.38), 2e-5),
    "S_F": ((2.82, 2.04), 5e-3),
    "Z_H": ((2.25,), 3e-3),
    "Z_E": ((189.81,), 3e-5),
    "Z_eps": ((0.936,), 6e-4),
    "Z_beta": ((1.0,), 5e-4),
    "Z_BD": ((1.08, 1.0), 5e-3),
    "sigma_H0": ((573.40,), 2e-5),
    "sigma_H": ((1071.17, 994.13), 1e-3),
    "Z_L": ((1.020, 1.020), 5e-4),
    "Z_v": ((0.982, 0.982), 6e-4),
    "Z_R": ((1.007, 1.007), 6e-4),
    "Z_W": ((1.0, 1.0), 5e-4),
    "Z_NT": ((0.857, 0.905), 6e-4),
    "sigma_HG": ((1295.42, 1368.61), 1e-5),
    "S_H": ((1.21, 1.38), 4e-3),
}
STAGE_1 = {
    "m_red": ((0.6606,), 1e-4),
    "n_E1": ((2266.0,), 3e-4),
    "N": ((0.016,), 0.032),
    "d_b": ((803.437, 718.865), 2e-6),
    "d_a": ((978.808, 905.470), 5e-6),
    "d_w": ((910.944, 815.056), 2e-6),
    "d_f": ((798.030, 724.692), 6e-6),
    "d_Ff": ((825.979, 748.795), 6e-6),
    "d_Nf": ((845.350, 762.541), 3e-6),
    "s_an": ((32.599, 26.588), 1e-4),
    "v": ((1.60,), 4e-3),
    "N_L": ((1124.7e6, 419.0e6), 2e-4),
    "C_R": ((0.862,), 6e-4),
    "c_prime": ((12.362,), 1e-3),
    "c_gamma_alpha": ((13.426,), 1e-3),
    "c_gamma_beta": ((11.412,), 1e-3),
    "K_Fbeta": ((1.12,), 5e-3),
    "K_Halpha": ((1.0,), 5e-3),
    "K_Falpha": ((1.0,), 5e-3),
    "Y_F": ((1.56, 1.44), 4e-3),
    "Y_S": ((2.06, 2.14), 3e-3),
    "h_F": ((1.441, 1.450), 5e-4),
    "s_Fn": ((2.248, 2.314), 3e-4),
    "rho_F": ((0.403, 0.382), 1.4e-3),
    "alpha_Fen": ((30.75, 33.33), 2e-4),
    "sigma_F0": ((113.46, 108.94), 1e-4),
    "sigma_F": ((175.90, 168.90), 6e-3),
    "Y_deltarelT": ((1.003, 1.005), 6e-4),
    "Y_RrelT": ((0.957, 0.957), 6e-4),
    "Y_X": ((0.80, 0.80), 5e-4),
    "Y_NT": ((0.888, 0.906), 6e-4),
    "sigma_FG": ((586.11, 419.35), 5e-5),
    "S_F": ((3.33, 2.48), 6e-3),
    "Z_H": ((2.06,), 3e-3),
    "Z_eps": ((0.981,), 6e-4),
    "Z_BD": ((1.04, 1.05), 5e-3),
    "sigma_H0": ((759.92,), 1e-5),
    "sigma_H": ((996.13, 1002.73), 3e-3),
    "Z_L": ((1.020, 1.020), 5e-4),
    "Z_v": ((0.961, 0.961), 6e-4),
    "Z_R": ((1.024, 1.024), 6e-4),
    "Z_NT": ((0.909, 0.937), 6e-4),
    "sigma_HG": ((1368.61, 1410.69), 5e-5),
}
RING_2 = {
    "alpha_wt": ((15.630,), 4e-5),
    "d_b": ((710.408, -1835.220), 2e-6),
    "d_a": ((815.663, -1906.081), 2e-6),
    "d_w": ((737.684, -1905.684), 2e-6),
    "d_Nf": ((738.082, -1969.750), 2e-6),
    "s_an": ((14.858, 18.937), 1e-4),
    "g_alpha": ((100.284,), 2e-5),
    "eps_alpha": ((1.618,), 4e-4),
    "F_t": ((285900.438,), 1e-8),
    "v": ((4.88,), 2e-3),
    "N_L": ((1297.1e6, 1506.3e6), 5e-5),
    "f_pb": ((20.7,), 3e-3),
    "f_falpha": ((27.0,), 1e-9),
    "C_R": ((0.862,), 6e-4),
    "c_prime": ((14.053,), 4e-5),
    "c_gamma_alpha": ((20.563,), 3e-5),
    "c_gamma_beta": ((17.479,), 3e-5),
    "m_red": ((1.4684,), 4e-5),
    "n_E1": ((993.0,), 6e-4),
    "N": ((0.124,), 4e-3),
    "K_v": ((1.06,), 5e-3),
    "K_Fbeta": ((1.14,), 5e-3),
    "K_Halpha": ((1.0,), 5e-3),
    "K_Falpha": ((1.0,), 5e-3),
    "Y_F": ((1.01, 1.20), 5e-3),
    "Y_S": ((2.48, 2.34), 3e-3),
    "h_F": ((0.880, 1.444), 6e-4),
    "s_Fn": ((2.271, 2.703), 3e-4),
    "rho_F": ((0.414, 0.418), 1.2e-3),
    "alpha_Fen": ((22.21, 18.63), 3e-4),
    "Y_B": ((1.0, 1.0), 5e-3),
    "sigma_F0": ((61.98, 69.12), 1e-4),
    "sigma_F": ((102.77, 114.61), 6e-3),
    "Y_deltarelT": ((1.002, 1.005), 6e-4),
    "Y_RrelT": ((0.957, 0.957), 6e-4),
    "Y_X": ((0.840, 0.904), 6e-4),
    "Y_NT": ((0.886, 0.883), 6e-4),
    "Y_M": ((0.7, 1.0), 5e-4),
    "sigma_FG": ((429.38, 444.89), 2e-5),
    "S_F": ((4.18, 3.88), 6e-3),
    "Z_H": ((2.85,), 2e-3),
    "Z_E": ((189.81,), 3e-5),
    "Z_eps": ((0.891,), 6e-4),
    "Z_beta": ((1.0,), 5e-4),
    "Z_BD": ((1.0, 1.0), 5e-3),
    "sigma_H0": ((312.44,), 2e-5),
    "sigma_H": ((404.76, 404.76), 4e-3),
    "Z_L": ((1.038, 1.038), 5e-4),
    "Z_v": ((0.961, 0.961), 6e-4),
    "Z_R": ((1.026, 1.026), 5e-4),
    "Z_W": ((1.0, 1.135), 5e-4),
    "Z_NT": ((0.905, 0.901), 6e-4),
    "sigma_HG": ((1388.39, 732.21), 2e-5),
    "S_H": ((3.43, 1.81), 4e-3),
}
RING_1 = {
    "alpha_wt": ((17.161,), 3e-5),
    "d_b": ((718.865, -2368.025), 2e-6),
    "d_a": ((905.470, -2475.118), 4e-6),
    "d_w": ((752.359, -2478.359), 2e-6),
    "d_Nf": ((749.170, -2594.369), 2e-6),
    "s_an": ((26.588, 38.407), 1e-4),
    "g_alpha": ((169.815,), 1e-5),
    "eps_alpha": ((1.278,), 4e-4),
    "v": ((1.60,), 4e-3),
    "N_L": ((419.0e6, 381.6e6), 2e-4),
    "f_falpha": ((40.0,), 1e-9),
    "c_prime": ((13.289,), 4e-5),
    "c_gamma_alpha": ((16.063,), 4e-5),
    "c_gamma_beta": ((13.653,), 4e-5),
    "m_red": ((2.4597,), 4e-5),
    "n_E1": ((1435.0,), 4e-4),
    "N": ((0.028,), 0.018),
    "K_Fbeta": ((1.12,), 5e-3),
    "K_Halpha": ((1.0,), 5e-3),
    "K_Falpha": ((1.0,), 5e-3),
    "Y_F": ((1.14, 1.27), 4e-3),
    "Y_S": ((2.38, 2.13), 3e-3),
    "h_F": ((1.101, 1.742), 5e-4),
    "s_Fn": ((2.314, 2.875), 3e-4),
    "rho_F": ((0.382, 0.494), 1.2e-3),
    "alpha_Fen": ((29.87, 19.59), 3e-4),
    "sigma_F0": ((95.70, 95.32), 1e-4),
    "sigma_F": ((154.50, 153.89), 5e-3),
    "Y_deltarelT": ((1.005, 1.003), 6e-4),
    "Y_RrelT": ((0.957, 0.957), 6e-4),
    "Y_NT": ((0.906, 0.907), 6e-4),
    "sigma_FG": ((419.35, 429.14), 2e-5),
    "S_F": ((2.71, 2.79), 5e-3),
    "Z_H": ((2.71,), 2e-3),
    "Z_eps": ((0.952,), 6e-4),
    "Z_BD": ((1.0, 1.0), 5e-3),
    "sigma_H0": ((588.62,), 1e-5),
    "sigma_H": ((758.46, 758.46), 3e-3),
    "Z_L": ((1.038, 1.038), 5e-4),
    "Z_v": ((0.916, 0.916), 6e-4),
    "Z_R": ((1.025, 1.025), 5e-4),
    "Z_W": ((1.0, 1.135), 5e-4),
    "Z_NT": ((0.937, 0.940), 6e-4),
    "sigma_HG": ((1368.95, 727.36), 3e-5),
    "S_H": ((1.80, 0.96), 8e-3),
}
