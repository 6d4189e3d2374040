"""The rows of ISO 6336 as a geometric program, of uncorrected carburised gears of grade 8.

As in `gp_rows` every row is safe, where K_v is below resonance and deviations, by ISO 1328-1:1995
without its ranges, are at most 40 um. K_v takes wheels and tooth tips as heavy as can be, no tip
relief and C_v1 to C_v3 at the least eps_gamma; K_Hbeta is 1 + x, above 2 sqrt(x); K_Halpha without
its limit; K_F as K_H.
"""

import math
from functools import cache
from types import SimpleNamespace

import numpy as np
from gp_rows import (
    BENDING,
    BETA,
    CONTACT,
    ELASTIC,
    OVERLOAD,
    chain,
    contact_ratio,
    lattice,
    line,
    parameters,
    scaled,
    teeth_rows,
    whole,
)

from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Var
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.iso6336 import accuracy, bending_factors, load_factors, stiffness
from gearopt.physics.iso6336.contact_factors import zone_factor
from gearopt.physics.iso6336.tooth_form import tooth_forms

GRADE = 8.0
STEEPEST = math.radians(35.0)
GRID = tuple(np.linspace(0.0, 35.0, 29))  # degrees
DENSITY = 7.83e-9  # t/mm3
UPPER = 0.08  # eps_alpha rises with z1 by this power near 20 teeth, by less above
WORN, WORN_ALONG = 1.0 - 0.075, 1.0 - 0.15  # left by running-in, to 40 um


def zone(beta):
    """Z_H^2 of a helix angle [rad]."""
    return float(zone_factor(lattice(beta)) ** 2)


@cache
def numbers(*degrees):
    """Constants of the rows, each the worst over helix angles [degrees].

    zone: (f, p) of Z_H^2 <= f cos(beta)^p; helix: (f, q) of Y_beta <= f sin(beta)^q; root: (a, s)
    of Y_F Y_S <= a + s/z1 of both; stiff: (least, most) c'/cos(beta) [MPa]; phase: C_v1 to C_v3;
    fast: 1/cos(alpha_t), pitch: cos(alpha_t); most: of `contact_ratio`; upper: of `_most_contact`.
    """
    gears = [lattice(math.radians(d)) for d in degrees]
    cosines, sines = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    zones = np.array([zone(math.radians(d)) for d in degrees])
    powers = (0.0, 0.0)
    if len(degrees) > 1:  # that of Y_beta is its slope at 25 degrees
        powers = float(np.polyfit(np.log(cosines), np.log(zones), 1)[0]), -0.25
    relief = np.array([float(bending_factors.helix_factor(math.radians(d), 1.0)) for d in degrees])
    steep = sines > 0.1  # below, eps_beta = 1 takes b > 30 m
    stiff = [stiffness.single_stiffness(g, 1e9) / c for g, c in zip(gears, cosines, strict=True)]
    roots = [_root(g) for g in gears]
    angles = [float(np.max(g.pinion.transverse_pressure_angle)) for g in gears]
    upper = [_most_contact(g, c) for g, c in zip(gears, cosines, strict=True)]
    least = min(float(np.min(contact_path(g).transverse_ratio)) for g in gears)
    near = 1.0 + (1e-4 if len(degrees) > 1 else 0.0)  # between the angles of a grid
    return SimpleNamespace(
        zone=(near * float(np.max(zones / cosines ** powers[0])), powers[0]),
        helix=(near * float(np.max(relief[steep] / sines[steep] ** powers[1])), powers[1]),
        root=tuple(max(r[i] for r in roots) for i in (0, 1)),
        stiff=(min(float(np.min(c)) for c in stiff), max(float(np.max(c)) for c in stiff)),
        phase=load_factors.coefficients(1.0 + least)[:3],
        fast=1.0 / math.cos(max(angles)),
        pitch=math.cos(min(angles)),
        most=contact_ratio(*degrees),
        upper=max(upper),
    )


def _most_contact(pair, cosine):
    """The least f of eps_alpha <= f cos(beta) z1^UPPER."""
    ratio = contact_path(pair).transverse_ratio / cosine
    return float(np.max(ratio / pair.pinion_teeth**UPPER))


def _root(pair):
    forms = tooth_forms(pair, contact_path(pair).transverse_ratio)
    both = np.maximum(*(form.form * form.concentration for form in forms))
    return line(pair.pinion_teeth, both, above=True)


def iso(drive, free=False):
    """The rows of ISO 6336; free: the helix angle of each stage, up to 35 degrees, is chosen."""
    count = len(drive.widest)
    given = numbers(*GRID) if free else numbers(25.0)
    more = [Var(name, "", 1.0, 50.0, 1.3, count, log=True) for name in ("kv", "kb", "ka")]
    if free:
        least, most = math.cos(STEEPEST), math.sin(STEEPEST)
        more.append(Var("c", "", least, 1.0, math.cos(BETA), count, log=True))
        more.append(Var("s", "", 0.1, most, math.sin(BETA), count, log=True))

    def evaluate(x, p):
        limits, stages = {}, chain(drive, x, p.torque)
        for stage in stages:
            k = stage.k
            c, s = (x.c[k], x.s[k]) if free else (math.cos(BETA), math.sin(BETA))
            if free:
                limits[f"circle[{k + 1}]"] = c**2 + s**2
            limits |= _stage(stage, drive, given, (c, s), (x.kv[k], x.kb[k], x.ka[k]))
        return whole(stages, limits, p)

    variables = (*scaled(drive), *more)
    return Problem("iso rows", variables, parameters(drive), evaluate)


def _stage(stage, drive, given, helix, loads):
    (c, s), (kv, kb, ka), end = helix, loads, f"[{stage.k + 1}]"
    d, u, e = stage.d, stage.u, stage.e
    inverse, rows = teeth_rows(stage, drive, c, s, given.most)
    rows |= _load_rows(stage, given, helix, inverse, loads)
    load = 2.0 * stage.torque / (d * stage.b) * OVERLOAD * kv * kb * ka
    zone = given.zone[0] * c ** given.zone[1] / (e * c)  # Z_H^2 Z_eps^2 Z_beta^2
    rows["contact" + end] = load / d * (1.0 + 1.0 / u) * zone * (ELASTIC / CONTACT) ** 2
    root = (given.root[0] + given.root[1] * inverse) * given.helix[0] * s ** given.helix[1]
    rows["bending" + end] = load / stage.m * root / BENDING
    return rows


def _load_rows(stage, given, helix, inverse, loads):
    """K_v, K_Hbeta and K_Halpha are at least what deviations [mm] and line load [N/mm] make."""
    (c, _), (kv, kb, ka), end = helix, loads, f"[{stage.k + 1}]"
    d, e, b = stage.d, stage.e, stage.b
    wheel = stage.u * d
    line = 2.0 * stage.torque * OVERLOAD / (d * b)
    pitch = accuracy.single_pitch_1995(wheel, stage.m, GRADE) * given.pitch
    form = accuracy.profile_form_1995(wheel, stage.m, GRADE)
    slope = accuracy.helix_slope_1995(wheel, b, GRADE)
    soft, stiff = given.stiff
    ratio = given.upper * c * inverse**-UPPER  # at least eps_alpha, as e is at most that
    mesh = stiff * c * (0.75 * ratio + 0.25)  # c_gamma_alpha
    speed = stage.speed / inverse * d * given.fast * (math.pi / 8.0 * DENSITY) ** 0.5
    one, two, three = given.phase  # 0.75 e + 0.25 >= e^0.75
    shaking = WORN * (one * pitch + two * form) / line * (stiff * c) ** 0.5
    still = three / (soft * c) ** 0.5
    resonance = speed / e**0.375  # N sqrt(c')
    light = still * (line / stiffness.LEAST_LINE_LOAD) ** -0.125  # as c' falls with the load
    bent = 1.33 * load_factors.PER_LOAD * (b / d) ** 2
    skew = WORN_ALONG * 0.85 * mesh * 0.5 * (bent + 2.0**0.5 * slope / (line * kv))
    shared = 0.4 * 2.0**0.5 * mesh / (line * kv * kb)
    return {
        "dynamic" + end: (1.0 + resonance * (shaking + still)) / kv,
        "dynamic_light" + end: (1.0 + resonance * (shaking + light)) / kv,
        "face" + end: (1.0 + skew) / kb,
        "transverse_pitch" + end: (0.9 + shared * WORN * pitch) / ka,
        "transverse_form" + end: (0.9 + shared * form) / ka,
    }
