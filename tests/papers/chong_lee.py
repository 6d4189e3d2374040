"""The printed tables of Chong and Lee, and every number of docs/multi_stage.md made by gearopt.

Each function of rows gives a table's lines as they stand in the page.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import gearopt
from gearopt.formulations.drive import continuous_sizing, sizing_text, teeth
from gearopt.formulations.drive import processes as process
from gearopt.formulations.drive.design import describe
from gearopt.optimise.solve import run, solve
from gearopt.optimise.typed import untyped
from gearopt.physics.gears import GearPair
from gearopt.physics.loads import k_factor

PROBLEMS = Path(__file__).parents[2] / "problems"
K, U = 2.07, 48.0  # MPa, Table 1
APART = 0.05  # mm; what is farther from its recomputation is marked


@dataclass(frozen=True)
class Printed:
    """A stage as printed: module [mm], teeth, then ratio, d1, d2, a, b as texts."""

    m: float
    z1: int
    z2: int
    u: str
    d1: str
    d2: str
    a: str
    b: str


DESIGNS = {
    "elevator": (
        Printed(2.5, 24, 119, "4.958", "66.2", "328.26", "198", "40"),
        Printed(3.5, 21, 92, "4.381", "81.1", "355.23", "219", "60"),
    ),
    "Table 2, process one": (
        Printed(2, 25, 124, "4.96", "55.17", "273.64", "164.4", "33.1"),
        Printed(3, 25, 109, "4.36", "82.75", "360.8", "221.76", "62.1"),
    ),
    "Table 2, process two": (
        Printed(2, 23, 114, "4.96", "50.755", "251.57", "151.17", "30.5"),
        Printed(3, 25, 109, "4.36", "82.75", "360.8", "221.76", "62.1"),
    ),
    "Table 4, process one": (
        Printed(1.5, 27, 229, "8.481", "44.7", "379", "211.85", "26.8"),
        Printed(3, 26, 105, "4.038", "86.06", "347.56", "216.8", "47.8"),
        Printed(4, 27, 87, "3.22", "119.16", "384.97", "251.57", "95.3"),
    ),
    "Table 4, process two": (
        Printed(1.25, 27, 237, "8.777", "37.24", "326.87", "182.1", "22.34"),
        Printed(3, 26, 109, "4.192", "86.06", "360.8", "223.4", "51.6"),
        Printed(4, 27, 80, "2.963", "119.16", "353.1", "236.1", "95.3"),
    ),
}
PROPORTIONS = {2: (0.6, 0.75), 3: (0.6, 0.6, 0.75)}  # b/d1, Tables 1 and 3


@cache
def train(stages):
    """The elevator (two stages) or the 110:1 drive (three) with its limits."""
    return gearopt.load(PROBLEMS / ("elevator.toml" if stages == 2 else "three_stage.toml")).train()


def recomputed(name, widths="printed"):
    """A design from its modules, teeth and helix angle; widths: printed, or ruled (b = m_a d1)."""
    rows = DESIGNS[name]
    own = train(len(rows))
    pairs = tuple(own.pair(k, r.m, r.z1, r.z2, float(r.b)) for k, r in enumerate(rows))
    if widths == "ruled":
        shares = PROPORTIONS[2] if len(rows) == 2 else (0.6, 0.6, 0.8)
        rows = zip(shares, pairs, strict=True)
        pairs = tuple(p.of_width(f * p.pinion.reference_diameter) for f, p in rows)
    return untyped(describe(own, pairs))


def cell(text, value):
    """Printed, then recomputed with a digit more; bold where more than APART apart."""
    digits = min(3, len(text.partition(".")[2]) + 1)
    shown = f"{value:.{digits}f}"
    return f"{text} / " + (f"**{shown}**" if abs(float(text) - value) > APART else shown)


def table_rows():
    found = []
    for name, rows in DESIGNS.items():
        for k, (row, s) in enumerate(zip(rows, recomputed(name)["stages"], strict=True), 1):
            cells = [
                cell(row.u, s["ratio"]),
                cell(row.d1, s["pinion_diameter_mm"]),
                cell(row.d2, s["wheel_diameter_mm"]),
                cell(row.a, s["centre_distance_mm"]),
                row.b,
                f"{s['face_width_mm'] / s['pinion_diameter_mm']:.3f}",
                f"{s['k_factor_MPa']:.3f}",
                f"{s['unit_load_MPa']:.2f}",
            ]
            head = f"{name}, stage {k}" if k == 1 else f"stage {k}"
            found.append(f"| {head} | {row.m:g}, {row.z1}/{row.z2} | " + " | ".join(cells) + " |")
    return found


def total_rows():
    found = []
    for name in DESIGNS:
        made = recomputed(name)
        ruled = f"{recomputed(name, 'ruled')['gear_volume_mm3']:,.0f}"
        found.append(
            f"| {name} | {made['ratio']:.4f} | {made['ratio_error_percent']:+.3f} % "
            f"| {made['gear_volume_mm3']:,.0f} | {'' if name == 'elevator' else ruled} |"
        )
    return found


def volume(stages, ratios):
    """Gear volume [mm3] when every stage reaches K = 2.07 MPa, whatever b/d1."""
    torque, total = train(stages).torque, 0.0
    for u in ratios:
        d = math.cbrt(k_factor(torque, 1.0, 0.7, u) / K)
        total += GearPair.of_diameter(1.0, d, d, u, 0.7 * d).volume  # whatever the module
        torque *= u
    return total


@cache
def best_split(stages):
    """Ratios and volume of minimum gear volume at the exact total ratio, by the sizing problem."""
    own = replace(train(stages), tolerance=0)
    result, outcome = run(continuous_sizing.problem(own), "ipopt")
    assert result.status == "optimal"
    return tuple(p.ratio for p in sizing_text.pairs(own, outcome.x)), result.value


def niemann(stages):
    return process.niemann_ratios(float(train(stages).ratio), [K] * stages)


def exact(name):
    """The split of a printed design, its last ratio moved to the exact total ratio."""
    rows = DESIGNS[name]
    first = [row.z2 / row.z1 for row in rows[:-1]]
    return (*first, float(train(len(rows)).ratio) / math.prod(first))


def split_rows():
    cases = [
        ("u = 21.80, minimum volume", 2, best_split(2)[0]),
        ("Niemann, eq. (7)", 2, niemann(2)),
    ]
    cases += [(name, 2, exact(name)) for name in list(DESIGNS)[:3]]
    cases += [("u = 110, minimum volume", 3, best_split(3)[0]), ("Niemann, eq. (8)", 3, niemann(3))]
    cases += [(name, 3, exact(name)) for name in list(DESIGNS)[3:]]
    found = []
    for name, stages, ratios in cases:
        v = volume(stages, ratios)
        over = 100.0 * (v / best_split(stages)[1] - 1.0)
        shown = " x ".join(f"{u:.4f}" for u in ratios)
        excess = "0" if "minimum" in name else f"+{over:.2f} %"
        found.append(f"| {name} | {shown} | {v:,.0f} | {excess} |")
    return found


def sixth(first, total, square=1.0):
    """Eq. (6) over b1 a1^2 as printed; square: (sigma_1/sigma_2)^2."""
    u1, u = first, total
    rest = (u1**3 + u * u1**2 + u**2 * u1 + u**3) / (u * (u1 + 1) ** 3)
    return (u1**2 + 1) / (u1 + 1) ** 2 + square * rest


def bracket(ratios):
    """What the volume is proportional to at equal K: sum of torque share times g(u)."""
    share, total = 1.0, 0.0
    for u in ratios:
        total += share * (u + 1) * (u**2 + 1) / u
        share *= u
    return total


@cache
def optimum(stages, contact=K, root=U):
    """Minimum gear volume [mm3] of whole teeth and standard modules under two load limits."""
    own = train(stages)
    limited = tuple(replace(s, allowable=(contact, root)) for s in own.stages)
    result = solve(teeth.problem(replace(own, stages=limited)))
    assert result.status == "optimal" and result.gap < 1e-9
    return result.value


def own_limits(name):
    """Largest K-factor and unit load [MPa] of a printed design."""
    stages = recomputed(name)["stages"]
    return max(s["k_factor_MPa"] for s in stages), max(s["unit_load_MPa"] for s in stages)


def optimum_rows():
    found = []
    for name, rows in DESIGNS.items():
        v = recomputed(name)["gear_volume_mm3"]
        best, own = optimum(len(rows)), optimum(len(rows), *own_limits(name))
        k, u = own_limits(name)
        found.append(
            f"| {name} | {v:,.0f} | {best:,.0f} | {100 * (best / v - 1):.1f} % "
            f"| {k:.3f}, {u:.2f} | {own:,.0f} | {100 * (own / v - 1):.1f} % |"
        )
    return found


def chain(stages, first, proportions, ratios=None, after=None):
    """Pinion diameters [mm] by eqs. (13), (14); after: {stage: centre distance} put instead."""
    u = ratios or niemann(stages)
    a, found = first, []
    for k in range(stages):
        if k > 0:
            pair = slice(k - 1, k + 1)
            a = process.next_centre_distance(a, u[pair], proportions[pair], (K, K))
        a = (after or {}).get(k, a)
        found.append(process.pinion_diameter(a, u[k]))
    return found


def modules(diameters, pinions):
    """Modules [mm] before rounding."""
    cosine = train(3).stages[0].toothing.cosine
    return [d * cosine / z for d, z in zip(diameters, pinions, strict=True)]
