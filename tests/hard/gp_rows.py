"""Sizing under AGMA 2001 and ISO 6336 as geometric programs a user writes: rows of posynomials.

Every row is safe: what it takes for a factor is at least the factor (for contact ratio, I and J: at
most), for PINION teeth and RATIOS, so an answer is no less than the least volume of the factors.
Allowables are given; factors of strength and life are 1.
"""

import math
from functools import cache
from types import SimpleNamespace

import numpy as np

from gearopt.formulations.drive.toothing import Toothing
from gearopt.optimise.problem import Problem
from gearopt.optimise.terms import Param, Terms, Var
from gearopt.physics.agma import factors
from gearopt.physics.agma.bending import bending_factor, critical_theta, loaded_tooth
from gearopt.physics.agma.mesh import mesh_of, pitting_factor
from gearopt.physics.geometry.contact import contact_path

PINION, RATIOS = (20.0, 120.0), (1.0, 12.0)
BETA = math.radians(25.0)
QUALITY, OVERLOAD = 7.0, 1.25
CONTACT, BENDING, ELASTIC = 1100.0, 300.0, 189.81  # MPa, MPa, sqrt(MPa)
SLIM, LOST = 0.3, 3.2  # least b/d1; eps_alpha >= cos(beta) (a - LOST (1/z1 + 1/z2))


def duty(kilowatts, rpm, ratio, widest):
    """A drive to size: torque [N mm], pinion speed [rad/s], ratio, largest b/d1 of each stage."""
    speed = rpm * math.pi / 30.0
    return SimpleNamespace(
        torque=kilowatts * 1e6 / speed, speed=speed, ratio=ratio, widest=tuple(widest)
    )


ELEVATOR = duty(7.5, 1450.0, 1450.0 / 66.5, (0.6, 0.75))
THREE = duty(8.0, 3520.0, 110.0, (0.6, 0.6, 0.75))
FIVE = duty(5.0, 1500.0, 1000.0, (0.8,) * 5)


def lattice(helix=BETA):
    """Pairs of all pinion teeth and ratios of the range, of one module, wide enough to overlap."""
    z, u = np.meshgrid(np.arange(PINION[0], PINION[1] + 1.0), np.linspace(*RATIOS, 23))
    z, u = z.ravel(), u.ravel()
    return Toothing(helix).pair(1.0, z, z * u, 1.5 * math.pi / max(math.sin(helix), 0.01))


def line(teeth, values, above):
    """(a, s) with a + s/z on one side of all values, touching, by the ends of the range."""
    side = np.max if above else np.min
    ends = [side(values[teeth == z]) for z in (teeth.min(), teeth.max())]
    slope = (ends[0] - ends[1]) / (1.0 / teeth.min() - 1.0 / teeth.max())
    return float(side(values - slope / teeth)), float(slope)


@cache
def contact_ratio(*degrees):
    """The largest such a for all helix angles [degrees]; the usual 1.88 is for spur gears."""
    found = []
    for helix in np.radians(degrees):
        pair = lattice(helix)
        inverse = (1.0 + 1.0 / pair.ratio) / pair.pinion_teeth
        ratio = contact_path(pair).transverse_ratio / np.cos(helix)
        found.append(np.min(ratio + LOST * inverse))
    return float(min(found))


@cache
def agma_numbers():
    """Constants of the rows: I over e u/(u + 1), and J >= a - s/z1, by physics.agma."""
    pair = lattice()
    mesh = mesh_of(pair, "conventional", smooth=True)  # m_N with 0.95 of the mean length of lines
    pitting = pitting_factor(mesh) * (1.0 + 1.0 / pair.ratio) / mesh.path.transverse_ratio
    tooth = loaded_tooth(mesh)
    form = np.asarray(bending_factor(tooth, critical_theta(tooth)).value)
    j, slope = line(pair.pinion_teeth, form, above=False)
    exponent, offset = factors.dynamic_curve(QUALITY)
    return SimpleNamespace(
        pitting=float(np.min(pitting)), j=j, slope=-slope, exponent=exponent, offset=offset
    )


def chain(drive, x, torque):
    """Number k, torque [N mm], pinion speed [rad/s], d, b, m [mm], u and e of every stage."""
    speed, stages = drive.speed, []
    for k in range(len(drive.widest)):
        sizes = {name: getattr(x, name)[k] for name in "dbmue"}
        stages.append(SimpleNamespace(k=k, torque=torque, speed=speed, **sizes))
        torque, speed = torque * x.u[k], speed / x.u[k]
    return stages


def teeth_rows(s, drive, cosine, sine, most):
    """Teeth, width, overlap and contact ratio of a stage; 1/z1 = m/(d cos(beta))."""
    inverse = s.m / (s.d * cosine)
    return inverse, {
        f"teeth[{s.k + 1}]": PINION[0] * inverse,
        f"most_teeth[{s.k + 1}]": 1.0 / (PINION[1] * inverse),
        f"wide[{s.k + 1}]": s.b / (drive.widest[s.k] * s.d),
        f"slim[{s.k + 1}]": SLIM * s.d / s.b,
        f"overlap[{s.k + 1}]": math.pi * s.m / (s.b * sine),
        f"contact_ratio[{s.k + 1}]": s.e / (most * cosine)
        + LOST / most * inverse * (1.0 + 1.0 / s.u),
    }


def spread_rows(s, km):
    """K_m of the commercial curve without its quadratic term, F/(10 d) at least 0.05."""
    a, b, _ = factors.ALIGNMENT["commercial"]
    width = s.b / factors.INCH
    bases = {"narrow": 1.0 - 0.025 + a, "broad": 1.0 - 0.0375 + a}
    slopes = {"narrow": b, "broad": b + 0.0125}
    slender = {"": s.b / (10.0 * s.d), "_least": 0.05}
    return {
        f"{n}{word}[{s.k + 1}]": (bases[n] + part + slopes[n] * width) / km
        for n in bases
        for word, part in slender.items()
    }


def whole(stages, limits, p):
    """The terms of a drive: its volume, the rows of its stages, its ratio."""
    volume = sum(math.pi / 4.0 * s.d**2 * s.b * (1.0 + s.u**2) for s in stages)
    ratio = math.prod((s.u for s in stages[1:]), start=stages[0].u)
    return Terms({"volume_mm3": volume}, limits, equal={"ratio": ratio / p.ratio})


def parameters(drive):
    return Param("torque", "N mm", drive.torque), Param("ratio", "", drive.ratio)


def scaled(drive):
    """Variables d, b, m, u, e of a drive, lengths within 1e3 of a guess by its torque."""
    n = len(drive.widest)
    size = (drive.torque * 2.0 / CONTACT) ** (1.0 / 3.0) * 10.0
    mean = drive.ratio ** (1.0 / n)
    rows = {"d": size, "b": 0.5 * size, "m": 0.04 * size}
    made = [Var(q, "mm", v / 1e3, v * 1e3, v, n, log=True) for q, v in rows.items()]
    made.append(Var("u", "", *RATIOS, min(mean, RATIOS[1]), n, log=True))
    return [*made, Var("e", "", 0.5, 2.0, 1.4, n, log=True)]


def agma(drive):
    """The rows of AGMA 2001: K_v of Q_v = 7, K_m commercial, I and J from below."""
    numbers, cosine, count = agma_numbers(), math.cos(BETA), len(drive.widest)
    inner = (
        Var("kv", "", 1.0, 10.0, 1.3, count, log=True),
        Var("km", "", 1, 10, 1.3, count, log=True),
    )
    variables = (*scaled(drive), *inner, Var("j", "", 0.05, 1.0, 0.4, count, log=True))

    def evaluate(x, p):
        limits, stages = {}, chain(drive, x, p.torque)
        for s in stages:
            k, n = s.k, f"[{s.k + 1}]"
            inverse, rows = teeth_rows(s, drive, cosine, math.sin(BETA), contact_ratio(25.0))
            root = (0.5 * s.d * s.speed / factors.FEET_PER_MINUTE) ** 0.5
            load = 2.0 * s.torque / (s.d * s.b) * OVERLOAD * x.kv[k] * x.km[k]
            contact = load / s.d * (1.0 + 1.0 / s.u) * ELASTIC**2
            rows["dynamic" + n] = (1.0 + root / numbers.offset) * x.kv[k] ** (-1 / numbers.exponent)
            rows["form" + n] = (x.j[k] + numbers.slope * inverse) / numbers.j
            rows["contact" + n] = contact / (numbers.pitting * s.e * CONTACT**2)
            rows["bending" + n] = load * cosine / (s.m * x.j[k] * BENDING)
            limits |= rows | spread_rows(s, x.km[k])
        return whole(stages, limits, p)

    return Problem("agma rows", variables, parameters(drive), evaluate)
