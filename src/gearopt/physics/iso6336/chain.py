"""All quantities of a rating by ISO 6336 in the order in which they follow from one another.

`LAWS` has one function for each symbol: of the case and of what was found before. A value is that
of the pair, or a tuple of pinion and wheel; floats or arrays. What is given is not computed.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from gearopt.physics.choosing import choose
from gearopt.physics.gears import is_internal
from gearopt.physics.iso6336 import bending_factors as bending
from gearopt.physics.iso6336 import contact_factors as contact
from gearopt.physics.iso6336 import load_factors as loads
from gearopt.physics.iso6336 import running_in, stiffness
from gearopt.physics.iso6336.case import Case, ring_rim
from gearopt.physics.iso6336.curves import reference_share
from gearopt.physics.iso6336.materials import SURFACE_HARDENED, strength
from gearopt.physics.iso6336.tooth_form import load_sharing

Values = dict[str, Any]
GEARS = (0, 1)


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def quantities(case: Case) -> Values:
    """Return every quantity of LAWS by its symbol, given ones as they are given."""
    values: Values = {}
    for symbol, law in LAWS.items():
        values[symbol] = case.given[symbol] if symbol in case.given else law(case, values)
    return values


def _line_load(case: Case, values: Values, *factors: str) -> Any:
    """Return F_t times factors per face width [N/mm]."""
    load = case.load / case.pair.face_width
    for factor in ("K_A", "K_gamma", *factors):
        load = load * values[factor]
    return load


def _strengths(case: Case, stress: str) -> tuple[float, float]:
    first, second = (strength(material, stress).stress for material in case.materials)
    return first, second


def _single_stiffness(case: Case, values: Values) -> Any:
    first, second = (material.modulus for material in case.materials)
    line = _line_load(case, values)
    blank = stiffness.mean_blank_factor(case.practice.webs)
    return stiffness.single_stiffness(case.pair, line, (first, second), blank)


def _mesh_stiffness(case: Case, values: Values) -> Any:
    return stiffness.mesh_stiffness(values["c_prime"], case.transverse_ratio)[0]


def _worn(case: Case, values: Values, deviation: Any) -> Any:
    """Return y_alpha of a deviation, the mean of both gears."""
    limits = values["sigma_Hlim"]
    first, second = (
        running_in.pitch_allowance(case.materials[k].family, deviation, limits[k], case.speed)
        for k in GEARS
    )
    return 0.5 * (first + second)


def _relief(case: Case, values: Values) -> Any:
    if case.practice.relief is not None:
        return case.practice.relief
    first, second = (running_in.tip_relief(limit) for limit in values["sigma_Hlim"])
    return 0.5 * (first + second)


def _resonance(case: Case, values: Values) -> Any:
    first, second = (material.density for material in case.materials)
    practice = case.practice
    mass = stiffness.reduced_mass(case.pair, (first, second), practice.bores, practice.meshes)
    resonance = loads.resonance_speed(case.pair.pinion_teeth, values["c_gamma_alpha"], mass)
    return case.operation.pinion_speed / resonance


def _dynamic(case: Case, values: Values) -> Any:
    line, single = _line_load(case, values), values["c_prime"]
    pitch = values["f_pb"] - _worn(case, values, values["f_pb"])
    form = values["f_falpha"] - _worn(case, values, values["f_falpha"])
    relief = np.abs(1.0 - single * values["C_a"] / line)
    dynamics = loads.Dynamics(single * pitch / line, single * form / line, relief, case.total_ratio)
    return loads.dynamic_factor(dynamics, values["N"], line, case.within)


def shaft_misalignment(case: Case, values: Values) -> Any:
    """Return f_sh [mm]."""
    diameter = case.pair.pinion.reference_diameter
    bending = case.practice.bending(diameter)
    line = _line_load(case, values, "K_v")
    return loads.shaft_misalignment(line, case.pair.face_width / diameter, bending)


def _face(case: Case, values: Values) -> Any:
    line, parts = _line_load(case, values, "K_v"), case.practice.helix_modification
    shaft, slope = shaft_misalignment(case, values), case.deviations.helix_slope
    left = loads.HELIX_MODIFICATIONS[parts]
    before = loads.initial_misalignment(shaft, values["f_ma"], line, slope, left)
    limits = values["sigma_Hlim"]
    worn = [
        running_in.helix_allowance(case.materials[k].family, before, limits[k], case.speed)
        for k in GEARS
    ]
    after = before - 0.5 * (worn[0] + worn[1])
    return loads.face_load_factor(after, values["c_gamma_beta"], line)


def _root_face_load_factor(case: Case, values: Values) -> Any:
    """Return K_Fbeta of the deeper tooth: h = (h_aP + h_fP) m_n, without tip alteration.

    K_Hbeta where crowning or end relief takes load off the ends. Source: IACS UR M56, 1.6.4.
    """
    if case.practice.helix_modification in loads.LIGHT_ENDS:
        return values["K_Hbeta"]
    deep = [g.rack.addendum + g.rack.dedendum for g in case.pair.gears]
    depth = np.maximum(*deep) * case.pair.normal_module
    return loads.root_face_load_factor(values["K_Hbeta"], case.pair.face_width, depth)


def _transverse(case: Case, values: Values) -> Any:
    line = _line_load(case, values, "K_v", "K_Hbeta")
    pitch = values["f_pb"]
    deviation = np.maximum(pitch, values["f_falpha"]) - _worn(case, values, pitch)
    return loads.transverse_load_factor(values["c_gamma_alpha"], deviation, line, case.total_ratio)


def _transverse_contact(case: Case, values: Values) -> Any:
    most = case.total_ratio / (case.transverse_ratio * values["Z_eps"] ** 2)
    return loads.limited(_transverse(case, values), most)


def _transverse_bending(case: Case, values: Values) -> Any:
    ratio = case.transverse_ratio
    if case.practice.edition == "2019":
        ratio = case.forms[0].virtual_ratio
    most = case.total_ratio / (case.transverse_ratio * (0.25 + 0.75 / ratio))
    return loads.limited(_transverse(case, values), most)


def _elastic(case: Case, values: Values) -> Any:
    rows = [(m.modulus, m.poisson) for m in case.materials]
    (e1, nu1), (e2, nu2) = rows
    return contact.elasticity_factor((e1, e2), (nu1, nu2))


def _single(case: Case, values: Values) -> Any:
    helical = 1.0
    if case.practice.edition == "2019":
        helical = contact.PROFILE_MODIFICATIONS[case.practice.profile_modification] ** 0.5
    ratios = contact.single_contact_ratios(case.pair, case.transverse_ratio)
    overlap = case.pair.overlap_ratio
    first, second = (contact.single_contact_factor(m, overlap, helical) for m in ratios)
    return first, second


def _nominal_contact(case: Case, values: Values) -> Any:
    product = values["Z_H"] * values["Z_E"] * values["Z_eps"] * values["Z_beta"]
    pair = case.pair
    diameter = pair.pinion.reference_diameter
    return contact.contact_stress(case.load, diameter, pair.face_width, pair.ratio, product)


def _pressed(case: Case, values: Values) -> Any:
    product = values["K_A"] * values["K_gamma"] * values["K_v"]
    product = product * values["K_Hbeta"] * values["K_Halpha"]
    first, second = (z * values["sigma_H0"] * np.sqrt(product) for z in values["Z_BD"])
    return first, second


def _life(contact_: bool) -> Callable[[Case, Values], Any]:
    def law(case: Case, values: Values) -> Any:
        first, second = (case.curve(k, contact_).factor(case.cycles[k]) for k in GEARS)
        return first, second

    return law


def shared(case: Case, member: int, contact_: bool, cycles: Any = None) -> Any:
    """Return how far a gear's strength is from static (0) to reference (1); see `curves`."""
    at = case.cycles[member] if cycles is None else cycles
    return reference_share(case.curve(member, contact_), at)


def _at_cycles(
    reference: Callable[[Case, Values], Any],
    contact_: bool,
    static: Callable[[Case, Values, int], Any] = lambda case, values, k: 1.0,
) -> Callable[[Case, Values], Any]:
    """Return the law of a factor of strength at N_L from those of reference and static strength."""

    def law(case: Case, values: Values) -> Any:
        factor = reference(case, values)
        both = factor if isinstance(factor, tuple) else (factor, factor)
        first, second = (
            both[k] ** (t := shared(case, k, contact_)) * static(case, values, k) ** (1.0 - t)
            for k in GEARS
        )
        return first, second

    return law


def _softer(values: Values) -> Any:
    return np.minimum(*values["sigma_Hlim"])


def lubricant(case: Case, values: Values) -> Any:
    """Return Z_L of reference strength."""
    return contact.lubricant_factor(_softer(values), case.practice.viscosity)


def velocity(case: Case, values: Values) -> Any:
    """Return Z_v of reference strength."""
    return contact.velocity_factor(_softer(values), case.speed)


def roughness(case: Case, values: Values) -> Any:
    """Return Z_R of reference strength."""
    mean = 0.5 * (case.materials[0].flank + case.materials[1].flank)
    curvature = contact.reduced_curvature(case.pair)
    return contact.roughness_factor(_softer(values), mean, curvature)


def hardening(case: Case, values: Values) -> Any:
    """Return Z_W of reference strength, of pinion and wheel: 1 but of a softer wheel."""
    return tuple(hardened(case, k, False) for k in GEARS)


def hardened(case: Case, member: int, static: bool) -> Any:
    """Return Z_W of a gear, static or of reference strength; 1 of a pinion (UR M56, 2.11)."""
    gear, other = case.materials[member], case.materials[1 - member]
    if member == 0 or gear.family not in ("St", "V", "GGG") or gear.hardness <= 0.0:
        return 1.0
    if other.family in SURFACE_HARDENED:
        if static:
            return contact.static_hardening_factor(gear.brinell)
        film = contact.equivalent_roughness(
            other.flank,
            gear.flank,
            contact.reduced_curvature(case.pair),
            case.speed,
            case.practice.viscosity,
        )
        return contact.work_hardening_factor(gear.brinell, film)
    if static or other.family not in ("St", "V", "GGG") or other.hardness <= 0.0:
        return 1.0
    return contact.tempered_hardening_factor(other.brinell, gear.brinell, case.pair.ratio)


def _form(case: Case, values: Values) -> Any:
    factors = [form.form for form in case.forms]
    if case.practice.edition == "2019":
        overlap = case.pair.overlap_ratio
        factors = [f.form * load_sharing(f.virtual_ratio, overlap) for f in case.forms]
    return factors[0], factors[1]


def _rim(case: Case, values: Values) -> Any:
    first, second = (1.0 if r is None else bending.rim_factor(r) for r in case.practice.backup)
    wheel = case.pair.wheel
    if is_internal(wheel.teeth):
        ring = bending.ring_rim_factor(ring_rim(wheel))
        second = choose(np.less(wheel.teeth, 0.0), ring, second)
    return first, second


def _deep(case: Case, values: Values) -> Any:
    worst = max(case.practice.grades)
    return bending.deep_tooth_factor(case.forms[0].virtual_ratio, worst)


def _nominal_root(case: Case, values: Values) -> Any:
    pair, both = case.pair, values["Y_beta"] * values["Y_DT"]
    first, second = (
        bending.root_stress(
            case.load,
            pair.face_width + pair.gears[k].root_excess,
            pair.normal_module,
            both * values["Y_F"][k] * values["Y_S"][k] * values["Y_B"][k],
        )
        for k in GEARS
    )
    return first, second


def _bent(case: Case, values: Values) -> Any:
    product = values["K_A"] * values["K_gamma"] * values["K_v"]
    product = product * values["K_Fbeta"] * values["K_Falpha"]
    first, second = (stress * product for stress in values["sigma_F0"])
    return first, second


def notches(case: Case, values: Values) -> Any:
    """Return Y_deltarelT of reference strength."""
    first, second = (
        bending.notch_factor(bending.slip_layer(m.family, m.strength_for_notches), form.notch)
        for m, form in zip(case.materials, case.forms, strict=True)
    )
    return first, second


def _static_notch(case: Case, values: Values, member: int) -> Any:
    material = case.materials[member]
    strength_ = material.strength_for_notches
    return bending.static_notch_factor(material.family, values["Y_S"][member], strength_)


def surfaces(case: Case, values: Values) -> Any:
    """Return Y_RrelT of reference strength."""
    first, second = (bending.surface_factor(m.family, m.root) for m in case.materials)
    return first, second


def sizes(case: Case, values: Values) -> Any:
    """Return Y_X of reference strength."""
    module = case.pair.normal_module
    first, second = (bending.size_factor(m.family, module) for m in case.materials)
    return first, second


def _permissible(names: tuple[str, ...]) -> Callable[[Case, Values], Any]:
    def law(case: Case, values: Values) -> Any:
        products = [1.0, 1.0]
        for name in names:
            value = values[name]
            both = value if isinstance(value, tuple) else (value, value)
            products = [products[k] * both[k] for k in GEARS]
        return products[0], products[1]

    return law


CONTACT_STRENGTH = ("sigma_Hlim", "Z_NT", "Z_L", "Z_v", "Z_R", "Z_W", "Z_X")
BENDING_STRENGTH = ("sigma_Flim", "Y_ST", "Y_NT", "Y_deltarelT", "Y_RrelT", "Y_X", "Y_M")
LAWS: dict[str, Callable[[Case, Values], Any]] = {
    "K_A": lambda case, values: case.operation.overload,
    "K_gamma": lambda case, values: 1.0,
    "sigma_Hlim": lambda case, values: _strengths(case, "H"),
    "sigma_Flim": lambda case, values: _strengths(case, "F"),
    "f_pb": lambda case, values: case.deviations.base_pitch,
    "f_falpha": lambda case, values: case.deviations.profile_form,
    "f_ma": lambda case, values: case.deviations.alignment,
    "C_a": _relief,
    "c_prime": _single_stiffness,
    "c_gamma_alpha": _mesh_stiffness,
    "c_gamma_beta": lambda case, values: 0.85 * values["c_gamma_alpha"],
    "N": _resonance,
    "Z_H": lambda case, values: contact.zone_factor(case.pair),
    "Z_E": _elastic,
    "Z_eps": lambda case, values: contact.contact_ratio_factor(
        case.transverse_ratio, case.pair.overlap_ratio
    ),
    "Z_beta": lambda case, values: contact.helix_factor(case.pair.pinion.helix_angle),
    "Z_BD": _single,
    "K_v": _dynamic,
    "K_Hbeta": _face,
    "K_Fbeta": _root_face_load_factor,
    "K_Halpha": _transverse_contact,
    "K_Falpha": _transverse_bending,
    "sigma_H0": _nominal_contact,
    "sigma_H": _pressed,
    "Z_NT": _life(True),
    "Z_L": _at_cycles(lubricant, True),
    "Z_v": _at_cycles(velocity, True),
    "Z_R": _at_cycles(roughness, True),
    "Z_W": _at_cycles(hardening, True, lambda case, values, k: hardened(case, k, True)),
    "Z_X": lambda case, values: 1.0,
    "sigma_HG": _permissible(CONTACT_STRENGTH),
    "Y_F": _form,
    "Y_S": lambda case, values: (case.forms[0].concentration, case.forms[1].concentration),
    "Y_beta": lambda case, values: bending.helix_factor(
        case.pair.pinion.helix_angle, case.pair.overlap_ratio, case.practice.edition
    ),
    "Y_B": _rim,
    "Y_DT": _deep,
    "sigma_F0": _nominal_root,
    "sigma_F": _bent,
    "Y_ST": lambda case, values: bending.TEST_GEAR,
    "Y_NT": _life(False),
    "Y_deltarelT": _at_cycles(notches, False, _static_notch),
    "Y_RrelT": _at_cycles(surfaces, False),
    "Y_X": _at_cycles(sizes, False),
    "Y_M": lambda case, values: tuple(
        bending.REVERSED if m.reversed_load else 1.0 for m in case.materials
    ),
    "sigma_FG": _permissible(BENDING_STRENGTH),
}


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def strength_of(case: Case, values: Values, contact_: bool) -> Any:
    """Return sigma_HG or sigma_FG [MPa] at the cycles of a case whose other quantities are found.

    Z_NT and Y_NT are computed even where they are given.
    """
    names = CONTACT_STRENGTH if contact_ else BENDING_STRENGTH
    given = {k: v for k, v in case.given.items() if k not in ("Z_NT", "Y_NT")}
    by_name = dict(values)
    for name in names:
        by_name[name] = given[name] if name in given else LAWS[name](case, values)
    return _permissible(names)(case, by_name)
