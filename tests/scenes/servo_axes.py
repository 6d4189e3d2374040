"""Random servo axes, and geometry of their trains that is independent of the package.

Everything is computed from the numbers that a file is written from; lengths [mm] are fractions.
"""

import math
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction as F
from functools import cached_property
from itertools import product

import numpy as np

SERIES = [F(k, 100) for k in (20, 25, 30, 40, 50, 60, 80, 100, 125, 150, 200, 300, 500, 800)]
TAN = math.tan(math.radians(20.0))
GOALS = ("inertia", "mass", "error")
NEAR = 1e-9  # relative: limits in doubles
SAME = 1e-9  # of an objective, by two texts
LOOKED_AT = 40  # better trains that are laid out on a grid


@dataclass(frozen=True)
class Axis:
    """What a file says; lengths in mm, torque in N mm, stress in MPa, angles in degrees."""

    ratio: tuple[F, F]
    modules: tuple[F, ...]
    pinions: tuple[int, int]
    tips: tuple[F, F]
    width: F
    density: float
    sector: F
    bore: F
    torque: float
    bending: float
    goal: str
    shaft: tuple[F, F]
    radial: tuple[F, F]
    pitch: tuple[F, F]
    error: float
    output: F | None = None
    box: tuple[F, F] | None = None
    motor: F = F(0)
    hub: F = F(0)
    swept: F | None = None
    required: bool = True

    @property
    def thick(self):
        """Diameter of the output shaft with its hub."""
        if self.box is not None:
            return self.hub
        return self.shaft[0] if self.output is None else self.output

    @cached_property
    def whole(self):
        """Modules, and half of shaft, output and motor, in a unit that makes them whole numbers."""
        bodies = [F(v) for v in (self.shaft[0], self.thick, self.motor)]
        unit = 4 * math.lcm(*(v.denominator for v in (*self.modules, *bodies)))
        return {m: int(m * unit) for m in self.modules}, [int(v * unit) // 2 for v in bodies]

    @property
    def half_sweep(self):
        """To either side of the mesh line [rad]."""
        swept = min(2 * self.sector, 1) if self.swept is None else self.swept / 360
        return math.pi * float(swept)

    def text(self):
        """The problem file."""
        low, high = self.ratio
        lines = [
            'gearopt = 1\nkind = "servo"\n[train]',
            f"ratio = [{_n(low)}, {_n(high)}]",
            f"modules = [{', '.join(_mm(m) for m in self.modules)}]",
            f"pinion_teeth = {list(self.pinions)}",
            f"face_width = {_mm(self.width)}",
            f'density = "{self.density} g/cm^3"',
            f'sector = "{_n(100 * self.sector)} %"',
            f"second_pinion_diameter = {_mm(self.bore)}",
            f"wheel_tip_diameters = [{_mm(self.tips[0])}, {_mm(self.tips[1])}]",
            f'output_torque = "{self.torque!r} N mm"',
            f'bending_stress = "{self.bending!r} MPa"',
            f'minimise = "{self.goal}"',
        ]
        lines += [] if self.output is None else [f"output_shaft_diameter = {_mm(self.output)}"]
        lines += [f"[shaft]\ndiameter = {_mm(self.shaft[0])}\nlength = {_mm(self.shaft[1])}"]
        for radial, pitch in zip(self.radial, self.pitch, strict=True):
            lines.append(f"[[mesh]]\ncentre_distance = {_mm(radial)}\npitch = {_mm(pitch)}")
        lines.append(f'[accuracy]\nerror = "{self.error!r} deg"')
        if self.box is not None:
            lines += [f"[space]\nwidth = {_mm(self.box[0])}\nheight = {_mm(self.box[1])}"]
            lines += [f"motor_diameter = {_mm(self.motor)}\nhub_diameter = {_mm(self.hub)}"]
            lines += [] if self.swept is None else [f'swept_angle = "{_n(self.swept)} deg"']
            lines += [f"required = {str(self.required).lower()}"]
        return "\n".join(lines) + "\n"


def _n(value):
    value = F(value)
    found = Context(prec=40).divide(Decimal(value.numerator), Decimal(value.denominator))
    assert F(found) == value, value
    return f"{found:f}"


def _mm(value):
    return f'"{_n(value)} mm"'


def _round(value, digits=2):
    return F(round(float(value) * 10**digits), 10**digits)


def random_axis(seed, most_pinions=3):
    """An axis about a train that is drawn first; its limits may exclude that train."""
    rng = np.random.default_rng(seed)

    def between(low, high):
        return float(rng.uniform(low, high))

    at = int(rng.integers(0, len(SERIES) - 3))
    count = int(rng.integers(1, 4))
    modules = tuple(SERIES[k] for k in sorted(rng.choice(4, count, replace=False) + at))
    low = int(rng.integers(12, 21))
    high = low + int(rng.integers(0, most_pinions + 1))
    m1, m2 = (modules[int(rng.integers(count))] for _ in range(2))
    if rng.random() < 0.7:  # the first wheel then seldom covers the output shaft
        m1, m2 = sorted((m1, m2))
    z1, z3 = (int(z) for z in rng.integers(low, high + 1, 2))
    z2, z4 = (max(z, round(z * math.exp(between(0.0, 2.5)))) for z in (z1, z3))
    total, off = z2 * z4 / (z1 * z3), between(0.002, 0.04)
    radii = [float(m * z) / 2 for m, z in ((m1, z1), (m1, z2), (m2, z3), (m2, z4))]
    a12, a34 = radii[0] + radii[1], radii[2] + radii[3]
    shaft = _round(between(0.1, 1.02) * (2 * radii[2] - 2.5 * float(m2)) + 0.05)
    bore = max(shaft + F(5, 2) * modules[0], _round(between(0.5, 1.05) * 2 * radii[2]))
    left = 2.0 * max(a34 - radii[1] - float(m1), 0.0)
    radial, pitch = ((_round(between(0.005, 0.03), 4),) * 2 for _ in range(2))
    lost = [4 * TAN * float(r) + 2 * float(p) for r, p in zip(radial, pitch, strict=True)]
    error = lost[0] / (2 * radii[1]) / (z4 / z3) + lost[1] / (2 * radii[3])
    width = _round(between(3.0, 15.0) * float(modules[0]) + 0.1)
    torque = round(between(0.1, 50.0) * radii[3], 3)
    stress = max(
        2 * torque / (2 * radii[3]) / float(width * m2) / lewis(z3),
        2 * torque / (z4 / z3) / (2 * radii[1]) / float(width * m1) / lewis(z1),
    )
    axis = Axis(
        ratio=(_round(max(total * (1 - off), 1.01), 3), _round(max(total * (1 + off), 1.02), 3)),
        modules=modules,
        pinions=(low, high),
        tips=tuple(
            _round(between(0.98, 1.35) * 2 * r + 2 * float(m))
            for r, m in ((radii[1], m1), (radii[3], m2))
        ),
        width=width,
        density=round(between(2.0, 8.0), 2),
        sector=F(1) if rng.random() < 0.4 else F(int(rng.integers(5, 101)), 100),
        bore=bore,
        torque=torque,
        bending=round(stress * between(0.95, 4.0), 3),
        goal=GOALS[seed % 3],
        shaft=(shaft, _round(between(1.0, 100.0))),
        radial=radial,
        pitch=pitch,
        error=round(math.degrees(error) * between(0.97, 2.0), 6),
    )
    if rng.random() < 0.2:
        own = _round(between(0.0, 1.2) * left + 0.1) if rng.random() < 0.6 else None
        return Axis(**{**vars(axis), "output": own})
    return _boxed(axis, rng, radii, (a12, a34), left)


def _boxed(axis, rng, radii, links, left):
    """The same with a box about the size that its first train needs."""
    least = 2 * float(axis.sector)
    room = radii[3] * min(0.5 + least, 2.0) + 0.5 * links[1]
    sides = [_round(room * float(rng.uniform(0.7, 2.2))) for _ in range(2)]
    swept = None
    if axis.sector < 1 and rng.random() < 0.7:
        own, most = 360 * axis.sector, min(720 * axis.sector, F(360))
        swept = own + (most - own) * F(int(rng.integers(0, 5)), 4)
    return Axis(
        **{
            **vars(axis),
            "box": tuple(sides),
            "motor": _round(links[0] * float(rng.uniform(0.2, 1.8)) + 0.1),
            "hub": _round(left * float(rng.uniform(0.0, 1.02))),
            "swept": swept,
            "required": bool(rng.random() < 0.8),
        }
    )


def lewis(z):
    """Form factor on the module: pi (0.154 - 0.912/z)."""
    return math.pi * (0.154 - 0.912 / z)


Train = tuple[int, int, int, int, F, F]  # z1, z2, z3, z4, m1, m2


def chosen(result):
    """z1, z2, z3, z4 and both modules of an answer, as it is shown."""
    first, second = result.design["train"]["stages"]
    teeth = [s[f"{gear}_teeth"] for s in (first, second) for gear in ("pinion", "wheel")]
    modules = [F(str(s["normal_module_mm"])) for s in (first, second)]
    return (*teeth, *modules)


def room(axis, train):
    """Bodies that overlap in a plane, by name; touching is no overlap."""
    modules, (middle, output, motor) = axis.whole
    z1, z2, z3, z4, *exact = train
    m1, m2 = (modules[m] for m in exact)
    a12, a34 = m1 * (z1 + z2) // 2, m2 * (z3 + z4) // 2
    tip = [m * (z + 2) // 2 for m, z in ((m1, z1), (m1, z2), (m2, z3), (m2, z4))]
    root = [t - 9 * m // 4 for t, m in zip(tip, (m1, m1, m2, m2), strict=True)]
    pairs = {
        "gear 1, middle shaft": (tip[0] + middle, a12),
        "gear 2, output shaft": (tip[1] + output, a34),
        "gear 3, output shaft": (tip[2] + output, a34),
        "gear 4, middle shaft": (tip[3] + middle, a34),
        "middle and output shaft": (middle + output, a34),
        "gear 2 around its shaft": (middle, root[1]),
        "gear 3 around its shaft": (middle, root[2]),
        "gear 4 around its shaft": (output, root[3]),
        "tip 1 in root 2": (tip[0] + root[1], a12),
        "tip 2 in root 1": (tip[1] + root[0], a12),
        "tip 3 in root 4": (tip[2] + root[3], a34),
        "tip 4 in root 3": (tip[3] + root[2], a34),
    }
    if axis.box is not None:
        pairs["motor, middle shaft"] = (motor + middle, a12)
    return [name for name, (needed, there) in pairs.items() if needed > there]


def worth(axis, train):
    """Inertia [t mm2], mass [kg], error [rad] in the axis's own goal."""
    if axis.goal == "error":
        return error_of(axis, train)
    discs, (first, middle, last) = bodies(axis, train)
    if axis.goal == "mass":
        return 1000.0 * sum(discs)
    z1, z2, z3, z4 = train[:4]
    n1, n2 = z2 / z1, z4 / z3
    return first + middle / n1**2 + last / (n1 * n2) ** 2


def bodies(axis, train):
    """Masses [t] of the four gears, and the inertias [t mm2] of the three shafts at themselves."""
    z1, z2, z3, z4, *modules = train
    m1, m2 = map(float, modules)
    d1, d2, d3, d4 = m1 * z1, m1 * z2, m2 * z3, m2 * z4
    area = math.pi / 4 * axis.density * 1e-9 * float(axis.width)
    discs = [area * d * d for d in (d1, d2, d3, d4)]
    discs[3] *= float(axis.sector)
    polar = [m * d * d / 8 for m, d in zip(discs, (d1, d2, d3, d4), strict=True)]
    thick, long = (float(v) for v in axis.shaft)
    middle = math.pi / 32 * axis.density * 1e-9 * long * thick**4 + polar[1] + polar[2]
    return discs, (polar[0], middle, polar[3])


def error_of(axis, train):
    """Lost motion of both stages at the output [rad]."""
    _, z2, z3, z4, m1, m2 = train
    lost = [4 * TAN * float(r) + 2 * float(p) for r, p in zip(axis.radial, axis.pitch, strict=True)]
    return lost[0] / (float(m1) * z2) * z3 / z4 + lost[1] / (float(m2) * z4)


def trains(axis, clear=True):
    """All trains that keep every limit but the box, the best first; clear: of overlaps too."""
    low, high = axis.ratio
    found = []
    pinions = range(axis.pinions[0], axis.pinions[1] + 1)
    for z1, z3, m1, m2 in product(pinions, pinions, axis.modules, axis.modules):
        if m2 * z3 < axis.bore:
            continue
        for z2 in range(z1, int(axis.tips[0] / m1) - 1):
            first = max(z3, math.ceil(low * z1 * z3 / z2))
            last = min(int(axis.tips[1] / m2) - 2, math.floor(high * z1 * z3 / z2))
            for z4 in range(first, last + 1):
                train = (z1, z2, z3, z4, m1, m2)
                if sound(axis, train) and not (clear and room(axis, train)):
                    found.append(train)
    return sorted(found, key=lambda train: worth(axis, train))


def sound(axis, train):
    """Error and stress."""
    z1, z2, z3, z4, *modules = train
    m1, m2 = map(float, modules)
    if error_of(axis, train) > math.radians(axis.error) * (1 + NEAR):
        return False
    torque, width = axis.torque, float(axis.width)
    stresses = (
        2 * torque / (m2 * z4) / (width * m2 * lewis(z3)),
        2 * torque * z3 / z4 / (m1 * z2) / (width * m1 * lewis(z1)),
    )
    return max(stresses) <= axis.bending * (1 + NEAR)


def outline(axis, train, motor, output, count=2000):
    """Points (x, y) on the edges of all bodies of a layout, seen along the shafts."""
    z1, z2, z3, z4, m1, m2 = (float(v) for v in train)
    at = m2 * (z3 + z4) / 2 * np.exp(1j * output)
    first = at + m1 * (z1 + z2) / 2 * np.exp(1j * motor)
    discs = [(first, m1 * (z1 + 2) / 2), (first, float(axis.motor) / 2)]
    discs += [(at, m1 * (z2 + 2) / 2), (at, m2 * (z3 + 2) / 2), (at, float(axis.shaft[0]) / 2)]
    discs += [(0.0, float(axis.thick) / 2)]
    turn = np.exp(1j * np.linspace(0.0, 2.0 * math.pi, count, endpoint=False))
    edges = [centre + radius * turn for centre, radius in discs]
    swung = output + np.linspace(-axis.half_sweep, axis.half_sweep, count)
    return np.concatenate([*edges, m2 * (z4 + 2) / 2 * np.exp(1j * swung), [0.0]])


def beside_the_output(axis, train, motor, output):
    """By how much motor and gear 1 clear the output shaft [mm]."""
    z1, z2, z3, z4, m1, m2 = (float(v) for v in train)
    place = m2 * (z3 + z4) / 2 * np.exp(1j * output) + m1 * (z1 + z2) / 2 * np.exp(1j * motor)
    largest = max(float(axis.motor), m1 * (z1 + 2)) / 2
    return abs(place) - largest - float(axis.thick) / 2


def fits_on_a_grid(axis, train, degrees=3.0):
    """Whether some layout of a grid of angles fits: a proof if it does."""
    z1, z2, z3, z4, m1, m2 = (float(v) for v in train)
    a, b = m1 * (z1 + z2) / 2, m2 * (z3 + z4) / 2
    first = max(float(axis.motor), m1 * (z1 + 2)) / 2
    second, last = max(m1 * (z2 + 2), m2 * (z3 + 2)) / 2, m2 * (z4 + 2) / 2
    hub, half = float(axis.thick) / 2, axis.half_sweep
    step = np.radians(np.arange(0.0, 360.0, degrees))
    spread = np.linspace(-half, half, 181)
    sides = []
    for turn in (0.0, math.pi / 2, math.pi, 3 * math.pi / 2):
        swung = last * np.cos(step[:, None] - turn + spread[None, :]).max(1)
        own = np.maximum(np.maximum(swung, hub), b * np.cos(step - turn) + second)
        motor = b * np.cos(step - turn)[:, None] + a * np.cos(step - turn)[None, :] + first
        sides.append(np.maximum(own[:, None], motor))
    apart = np.abs(b * np.exp(1j * step)[:, None] + a * np.exp(1j * step)[None, :])
    good = apart >= first + hub
    width, height = (sides[k] + sides[k + 2] for k in (0, 1))
    slack = last * (1.0 - math.cos(half / 180.0))  # the sector's rim between its points
    room_for = [float(side) for side in axis.box]  # fractions would be compared one by one
    good &= (width + 2 * slack <= room_for[0]) & (height + 2 * slack <= room_for[1])
    return bool(good.any())


def held_against(axis, result, known, value):
    """Return the chosen train, None where none is said to exist, held against all known ones.

    known: trains that clear all bodies, the best first; value(train) is what is minimised.
    """
    held = axis.box is not None and axis.required
    if result.status == "infeasible":
        assert not known or held
        assert not any(fits_on_a_grid(axis, train) for train in known[:LOOKED_AT])
        return None
    assert result.status == "optimal", result.message
    train = chosen(result)
    assert train in known and not room(axis, train)
    better = [other for other in known if value(other) < value(train) * (1.0 - SAME)]
    assert held or not better
    assert not any(fits_on_a_grid(axis, other) for other in better[:LOOKED_AT])
    return train
