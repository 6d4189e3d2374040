"""What ISO 6336 uses of a pair between two widths and two torques, from below (Lemma 57).

Line loads W0 = F_t K_A K_gamma/b, W1 = W0 K_v, W2 = W1 K_Hbeta rise with the load; what they are
at the ends bounds them: of two values the first is the least. One text for arrays and for numbers,
for which `rating_kernel` compiles it.
"""

from typing import Any, NamedTuple

import numpy as np

from gearopt.physics.choosing import choose, some
from gearopt.physics.iso6336.accuracy import range_of, slope_2013
from gearopt.physics.iso6336.bending_factors import inclined
from gearopt.physics.iso6336.contact_factors import contact_ratio_factor, single_contact_factor
from gearopt.physics.iso6336.load_factors import (
    MAIN,
    SUPER,
    coefficients,
    face_load_factor,
    initial_misalignment,
    limited,
    lower_limit,
    root_exponent,
    shaft_misalignment,
    transverse_load_factor,
)
from gearopt.physics.iso6336.running_in import cast_helix, hard_helix, tempered
from gearopt.physics.iso6336.stiffness import light_load, mesh_stiffness
from gearopt.physics.iso6336.tooth_form import load_sharing

LOWER, UPPER = np.bool_(False), np.bool_(True)
SMALLEST = 1e-300
BEFORE = 1.0 - 4e-13  # of a border: up to it the law before it holds, roundings included


class IsoRow(NamedTuple):
    """A pair, or of arrays many: `IsoRows` says what the names are."""

    contact: Any
    virtual: Any
    single0: Any
    single1: Any
    overlap: Any
    axial: Any
    stiffness: Any
    depth: Any
    helix: Any
    diameter0: Any
    diameter1: Any
    relief0: Any
    relief1: Any
    force0: Any
    force1: Any
    pace0: Any
    pace1: Any
    speed0: Any
    speed1: Any
    pitch0: Any
    pitch1: Any
    form0: Any
    form1: Any
    deviation0: Any
    bending_used0: Any
    bending_used1: Any
    contact_used0: Any
    contact_used1: Any
    bending: Any
    excess0: Any
    excess1: Any


class IsoWay(NamedTuple):
    """Numbers of the standard for a way of making the gears; factors that are not given are NaN.

    relieved: the parts of f_sh and f_ma that remain; light_ends: K_Fbeta is K_Hbeta; wearing0 and
    wearing1: share of running in of tempered gears, and whether there are cast and hard ones; any
    load: W2 may be any from the least on; modified: Z_BD of eps_beta >= 1; slopes0, slopes1:
    f_Hbeta [mm] by ranges of diameter and width, whose ends are diameters and widths, () in 2013.
    """

    c_prime: float
    c_gamma_alpha: float
    c_gamma_beta: float
    N: float
    K_v: float
    K_Hbeta: float
    K_Fbeta: float
    K_Halpha: float
    K_Falpha: float
    f_ma: float
    Z_eps: float
    Z_BD0: float
    Z_BD1: float
    Y_beta: float
    newer: bool
    shared: bool
    modified: float
    relieved: tuple[float, float]
    light_ends: bool
    wearing0: tuple[float, float, float]
    wearing1: tuple[float, float, float]
    any_load: bool
    grades: tuple[float, float]
    ranged: bool
    slopes0: Any
    slopes1: Any
    diameters: Any
    widths: Any


class IsoBox(NamedTuple):
    """Ends of widths [mm], of W0 [N/mm], eps_beta, eps_gamma and c' [MPa]; same: a point."""

    low: Any
    high: Any
    same: bool
    line0: Any
    line1: Any
    overlap0: Any
    overlap1: Any
    total0: Any
    total1: Any
    single0: Any
    single1: Any


def box_of(at: IsoRow, way: IsoWay, low: Any, high: Any, same: bool) -> IsoBox:
    """Box of widths [mm]; same: the ends are one, of widths and of torques."""
    line = at.force0 / high
    over = low / at.axial
    single = single_stiffness(at, way, line)
    if same:
        total = at.contact + over
        return IsoBox(low, high, same, line, line, over, over, total, total, single, single)
    heavy, wide = at.force1 / low, high / at.axial
    totals = at.contact + over, at.contact + wide
    stiff = single_stiffness(at, way, heavy)
    return IsoBox(low, high, same, line, heavy, over, wide, totals[0], totals[1], single, stiff)


def single_stiffness(at: IsoRow, way: IsoWay, line: Any) -> Any:
    """Return c' [MPa] at a line load."""
    return at.stiffness * light_load(line) if np.isnan(way.c_prime) else way.c_prime


def mesh(at: IsoRow, way: IsoWay, single: Any) -> Any:
    """Return c_gamma_alpha [MPa]."""
    if np.isnan(way.c_gamma_alpha):
        return mesh_stiffness(single, at.contact)[0]
    return way.c_gamma_alpha


def resonance(at: IsoRow, way: IsoWay, pace: Any, single: Any) -> Any:
    """Return N at a pace omega z1 sqrt(m_red)."""
    return pace / np.sqrt(mesh(at, way, single)) if np.isnan(way.N) else way.N


def least_part(at: IsoRow, way: IsoWay, low: Any, high: Any, same: bool) -> tuple[Any, ...]:
    """Least parts of the capacity in use of both gears by bending, then by contact.

    Of more levels of load the stresses; those of contact are squared.
    """
    box = box_of(at, way, low, high, same)
    before = dynamic(at, way, box, LOWER)
    after = spread(at, way, box, before, LOWER)
    shares = transverse(at, way, box, after)
    bending = bent(at, way, box, before, after, shares)
    return parts(at, way, box, bending, pressed(at, way, box, after, shares[0]))


def parts(at: IsoRow, way: IsoWay, box: IsoBox, bent: Any, pressed: Any) -> tuple[Any, ...]:
    """Parts of `least_part` of the least W1 K_Fbeta K_Falpha and W2 K_Halpha."""
    bending = bent * root_factor(at, way, box)
    contact = pressed * ratio_factor(at, way, box.overlap1) ** 2
    first = least_single(way.Z_BD0, at.single0, way, box)
    second = least_single(way.Z_BD1, at.single1, way, box)
    return (
        bending * at.bending_used0 * meshing(box.low, at.excess0),
        bending * at.bending_used1 * meshing(box.low, at.excess1),
        contact * first**2 * at.contact_used0,
        contact * second**2 * at.contact_used1,
    )


def meshing(width: Any, excess: Any) -> Any:
    """Return b/b_F of a gear whose root is wider than the mesh; it rises with the width b."""
    return (width + SMALLEST) / (width + excess + SMALLEST)


def nominal_part(at: IsoRow, way: IsoWay, low: Any, high: Any) -> tuple[Any, ...]:
    """Least parts as of `least_part`, times the width, by the nominal load W0 (Lemma 83).

    At any width between two; K_v is at least 1, above the main resonance C_v7, the others 1.
    """
    box = box_of(at, way, low, high, False)
    fastest = resonance(at, way, at.pace1, box.single0)
    dynamic = choose(fastest > MAIN, coefficients(box.total0)[6], 1.0)
    load = at.force0 * (dynamic if np.isnan(way.K_v) else way.K_v)
    face = 1.0 if np.isnan(way.K_Hbeta) else way.K_Hbeta
    root = np.minimum(face, 1.0) if np.isnan(way.K_Fbeta) else way.K_Fbeta
    pressed = face * (1.0 if np.isnan(way.K_Halpha) else way.K_Halpha)
    bent = root * (1.0 if np.isnan(way.K_Falpha) else way.K_Falpha)
    return parts(at, way, box, load * bent, load * pressed)


def refused(at: IsoRow, high: Any) -> Any:
    """Whether pairs up to a width [mm] are not rated."""
    return np.logical_not((high / at.axial >= at.overlap) & (at.contact >= 1.0))


def dynamic(at: IsoRow, way: IsoWay, box: IsoBox, upper: Any) -> Any:
    """Bound of W1 = W0 K_v: of the ranges that N may lie in, and between them."""
    if not np.isnan(way.K_v):
        return (box.line1 if upper else box.line0) * way.K_v
    low, main, high = ranges(at, way, box, upper)
    slowest = resonance(at, way, at.pace0, box.single1)
    rise = main + (high - main) * past(slowest)
    if box.same:
        return choose(slowest <= lower_limit(box.line1), low, rise)
    fastest = resonance(at, way, at.pace1, box.single0)
    other = main + (high - main) * past(fastest)
    none = -np.inf if upper else np.inf
    above = np.maximum(rise, other) if upper else np.minimum(rise, other)
    below = choose(slowest <= lower_limit(box.line1), low, none)
    beyond = choose(fastest > lower_limit(box.line0), above, none)
    return np.maximum(below, beyond) if upper else np.minimum(below, beyond)


def past(resonance: Any) -> Any:
    """How far N is from the end of the main resonance to the supercritical range, 0 to 1."""
    return np.minimum(np.maximum((resonance - MAIN) / (SUPER - MAIN), 0.0), 1.0)


def ranges(at: IsoRow, way: IsoWay, box: IsoBox, upper: Any) -> tuple[Any, Any, Any]:
    """Bounds of W1 by the laws below, at and above the main resonance.

    C_v1 to C_v6 do not rise with eps_gamma, C_v7 does not fall.
    """
    line, single = (box.line1, box.single1) if upper else (box.line0, box.single0)
    pace, pitch, form = at.pace0, at.pitch0, at.form0
    if upper:
        pace, pitch, form = at.pace1, at.pitch1, at.form1
    c1, c2, c3, c4, c5, c6, c7 = coefficients(box.total0 if upper else box.total1)
    if not box.same:
        c7 = coefficients(box.total1 if upper else box.total0)[6]
    fast = np.maximum(line - single * at.relief1, single * at.relief0 - line)
    fast = np.maximum(fast, 0.0)  # of a virtual way, whose C_a may be any between two
    speed = resonance(at, way, pace, single)
    shared = single * (c1 * pitch + c2 * form)
    low = line + speed * shared + c3 * (speed * fast)
    main = line + shared + c4 * fast
    return low, main, single * (c5 * pitch + c6 * form) + c7 * line


def spread(at: IsoRow, way: IsoWay, box: IsoBox, before: Any, upper: Any) -> Any:
    """Bound of W2 = W1 K_Hbeta from that of W1."""
    if not np.isnan(way.K_Hbeta):
        return before * way.K_Hbeta
    width, speed = (box.high, at.speed1) if upper else (box.low, at.speed0)
    single = box.single1 if upper else box.single0
    shaft = shaft_misalignment(before, width / at.diameter0, at.bending)
    first = slope(way, way.slopes0, at.diameter0, width, way.grades[0])
    second = slope(way, way.slopes1, at.diameter1, width, way.grades[1])
    alignment = (first**2 + second**2) ** 0.5 if np.isnan(way.f_ma) else way.f_ma
    skew = initial_misalignment(shaft, alignment, before, np.maximum(first, second), way.relieved)
    worn = 0.5 * (allowance(way.wearing0, skew, speed) + allowance(way.wearing1, skew, speed))
    stiff = 0.85 * mesh(at, way, single) if np.isnan(way.c_gamma_beta) else way.c_gamma_beta
    return before * face_load_factor(skew - worn, stiff, before)


def slope(way: IsoWay, slopes: Any, diameter: Any, width: Any, grade: float) -> Any:
    """Return f_Hbeta [mm] of a gear."""
    if way.ranged:
        return slopes[range_of(diameter, way.diameters), range_of(width, way.widths)]
    return slope_2013(diameter, width, grade)


def allowance(wearing: tuple[float, float, float], skew: Any, speed: Any) -> Any:
    """Return the most y_beta [mm] of one gear's kinds of material at a speed [mm/s]."""
    share, cast, hard = wearing
    worn = np.maximum(cast * cast_helix(skew, speed), hard * hard_helix(skew))
    return np.maximum(tempered(skew, share, speed), worn)


def pressed(at: IsoRow, way: IsoWay, box: IsoBox, after: Any, share: Any) -> Any:
    """Return the least W2 K_Halpha from that of W2; share: K_alpha without limits."""
    if not np.isnan(way.K_Halpha):
        return after * way.K_Halpha
    most = box.total0 / (at.contact * ratio_factor(at, way, box.overlap0) ** 2)
    return after * limited(share, most)


def transverse(at: IsoRow, way: IsoWay, box: IsoBox, after: Any) -> tuple[Any, Any]:
    """Return K_alpha without limits of the least line load, and of an endless one."""
    stiff, total = mesh(at, way, box.single0), box.total0
    of_least = transverse_load_factor(stiff, at.deviation0, after, total)
    return of_least, transverse_load_factor(stiff, 0.0, after, total)


def bent(
    at: IsoRow, way: IsoWay, box: IsoBox, before: Any, after: Any, shares: tuple[Any, Any]
) -> Any:
    """Return the least W1 K_Fbeta K_Falpha from those of W1 and W2.

    W2^N_F K_alpha(W2) is least at a W2 that may be above the least one.
    """
    power = root_power(at, way, box)
    face = (after / before) ** power if np.isnan(way.K_Fbeta) else way.K_Fbeta
    if not np.isnan(way.K_Falpha):
        return before * face * way.K_Falpha
    factor, endless = shares
    if way.any_load or not box.same:
        above = least_at(at, way, box, power, after, factor / endless - 1.0)
        factor = above**power * (endless + (factor - endless) / above)
    most = box.total0 / (at.contact * (0.25 + 0.75 / (at.virtual if way.newer else at.contact)))
    return before * face * limited(factor, most)


def root_power(at: IsoRow, way: IsoWay, box: IsoBox) -> Any:
    """Return the least N_F with which K_Fbeta follows K_Hbeta; 0 where K_Fbeta is given."""
    if not np.isnan(way.K_Fbeta):
        return 0.0 if np.isnan(way.K_Hbeta) else 1.0
    return 1.0 if way.light_ends else root_exponent(box.low, at.depth)


def least_at(at: IsoRow, way: IsoWay, box: IsoBox, power: Any, after: Any, excess: Any) -> Any:
    """Return W2 over its least value where W2^N_F (1 + excess/W2) is least, at least 1."""
    wanted = excess * (1.0 - power) / np.maximum(power, SMALLEST)
    if way.any_load:  # one of the ways may have any W2 above the least
        return np.maximum(wanted, 1.0)
    inside = ((box.low != box.high) | (at.force0 != at.force1)) & (wanted > 1.0)
    if not some(inside):
        return 1.0
    most = spread(at, way, box, dynamic(at, way, box, UPPER), UPPER) / after
    return choose(inside, np.minimum(wanted, np.maximum(most, 1.0)), 1.0)


def ratio_factor(at: IsoRow, way: IsoWay, overlap: Any) -> Any:
    """Return Z_eps at an end of eps_beta; it does not rise with it."""
    return contact_ratio_factor(at.contact, overlap) if np.isnan(way.Z_eps) else way.Z_eps


def least_single(given: float, spur: Any, way: IsoWay, box: IsoBox) -> Any:
    """Return the least Z_B or Z_D, which is at an end of the widths."""
    if not np.isnan(given):
        return given
    first = single_contact_factor(spur, box.overlap0, way.modified)
    if box.same:
        return first
    return np.minimum(first, single_contact_factor(spur, box.overlap1, way.modified))


def root_factor(at: IsoRow, way: IsoWay, box: IsoBox) -> Any:
    """Return the least Y_beta f_eps; each is monotone in eps_beta."""
    factor = inclined(at.helix, box.overlap1, way.newer) if np.isnan(way.Y_beta) else way.Y_beta
    if not way.shared:
        return 1.0 * factor
    first = load_sharing(at.virtual, box.overlap0)
    return np.minimum(first, load_sharing(at.virtual, box.overlap1)) * factor


def iso_border(at: IsoRow, way: IsoWay, width: Any) -> Any:
    """Return the next width [mm] at which a refusal ends, K_v has other laws, or f_Hbeta a step."""
    first = at.overlap * at.axial * BEFORE
    second = (2.0 - at.contact) * at.axial * BEFORE
    border = choose(width <= first, first, np.inf)
    border = np.minimum(border, choose(width <= second, second, np.inf))
    for step in way.widths:
        border = np.minimum(border, choose(width <= step, step, np.inf))
    return border
