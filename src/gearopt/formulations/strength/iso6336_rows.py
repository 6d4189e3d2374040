"""Least load capacity used by ISO 6336 between two widths and two torques.

Line loads W0 = F_t K_A K_gamma/b, W1 = W0 K_v, W2 = W1 K_Hbeta rise with the load; what they are
at the ends bounds them: of two values the first is the least, the second the greatest.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from gearopt.optimise.terms import Array
from gearopt.physics.iso6336 import bending_factors as bending
from gearopt.physics.iso6336 import contact_factors as contact
from gearopt.physics.iso6336 import load_factors as loads
from gearopt.physics.iso6336 import stiffness
from gearopt.physics.iso6336.accuracy import WIDTHS, helix_slope
from gearopt.physics.iso6336.case import life_curve
from gearopt.physics.iso6336.curves import ROUNDING, Curve
from gearopt.physics.iso6336.tooth_form import load_sharing
from gearopt.physics.rating import Level, damage

if TYPE_CHECKING:
    from gearopt.formulations.strength.iso6336 import Iso6336

Columns = dict[str, Any]
Two = tuple[Any, Any]
LOWER, UPPER = 0, 1
PICK = np.minimum, np.maximum
SMALLEST = 1e-300
BEFORE = 1.0 - 4e-13  # of a border: up to it the law before it holds, roundings included
AT_ENDS = "force", "pace", "speed", "pitch", "form", "deviation"  # of the torques
MODES = ("bending", 0), ("bending", 1), ("contact", 0), ("contact", 1)
MINER_POWERS = {"bending": 8.0, "contact": 6.0}  # of the load in Miner's sum, about
FAR = 1.05  # of what a level alone uses: more need not be known closely
PAST = 1.0 + 1e-13  # a jump of Miner's sum is passed by this factor


@dataclass(frozen=True)
class IsoRows:
    """Rows of pairs: columns by name, of all levels (n,), of each (levels, n).

    contact (eps_alpha), virtual (eps_alphan), singles (Z_B, Z_D of spur gears), overlap (the least
    eps_beta that is rated), axial pitch, stiffness c' from 100 N/mm on, tooth depth, both
    diameters; at both ends of the torques force (F_t K_A K_gamma), pace (omega z1 sqrt(m_red)),
    speed v, deviations after running-in (pitch f_pb, form f_falpha, the one of K_Halpha);
    contact_used and bending_used of both gears: what is used at W = Z_eps = Z_BD = 1 and at W =
    f_eps = Y_beta = 1. Of several levels these are stresses (of contact squared) times the safety
    factors asked for; contact0_0 and so on are strengths at the knots of life curves, cycles0 and
    cycles1 least numbers of cycles, contact0_own and contact0_all strengths (squared, of contact)
    at these of the level and of all levels.
    """

    standard: "Iso6336"
    columns: Columns

    @np.errstate(invalid="ignore", divide="ignore", over="ignore")
    def used(self, low: Array, high: Array) -> Array:
        """Lower bound of the greatest part that is used: of load, so of S_H squared.

        Of several levels of load a number on the same side of 1.
        """
        box, at = Box(self.standard, self.columns, (low, high)), self.columns
        parts = box.parts()
        single = len(self.standard.loads) == 1
        most = np.maximum.reduce(parts) if single else self._spectrum(parts)
        rated = (box.overlap[UPPER] >= at["overlap"]) & (at["contact"] >= 1.0)
        return np.where(rated & ~np.isnan(most), most, np.inf)

    def _spectrum(self, parts: list[Any]) -> Any:
        """Number above 1 where Miner's sum of a mode is; parts: of a mode the stresses (levels, n).

        Near 1 it is continuous, so that secants on it find where it is 1.
        """
        at = self.columns
        ends = [
            [np.max(part / at[f"{name}{k}_{end}"], axis=0) for end in ("own", "all")]
            for part, (name, k) in zip(parts, MODES, strict=True)
        ]
        most = np.maximum.reduce([np.where(every <= 1.0, every, alone) for alone, every in ends])
        for part, (alone, every), mode in zip(parts, ends, MODES, strict=True):
            some = np.flatnonzero((most <= FAR) & (every > np.maximum(most, 1.0)))
            if len(some):
                used = self._together(part[:, some], alone[some], every[some], mode, some)
                most[some] = np.maximum(most[some], used)
        return most

    def _together(self, part: Any, alone: Any, every: Any, mode: tuple[str, int], some: Any) -> Any:
        """Number above 1 where Miner's sum of some rows is, from `alone` to `every`.

        A power of the sum, but where the sum jumps: a level breaks a tooth at once, or begins to
        count at the endless end of its curve.
        """
        (name, k), standard = mode, self.standard
        curve = life_curve(standard.materials[k], standard.practice, name == "contact")
        values = [self.columns[f"{name}{k}_{j}"][..., some] for j in range(len(curve.cycles))]
        power, square = MINER_POWERS[name], 2.0 if name == "contact" else 1.0
        stress, cycles = part ** (1.0 / square), self.columns[f"cycles{k}"][:, some]
        levels = Level(cycles, Curve(curve.cycles, tuple(values)), stress)
        total = damage([levels]).sum(axis=0) ** (1.0 / power)
        total = np.minimum(np.maximum(total, alone), every)
        ends = values[0] * (1.0 + ROUNDING), values[-1] * (1.0 - ROUNDING)
        for used in chain.from_iterable(part / end**square for end in ends):
            near = np.flatnonzero((used - 1.0) * (used - total) < 0.0)
            if len(near):
                counts = used[near] > 1.0
                growth = used[near] ** (-1.0 / square) * np.where(counts, 1.0 / PAST, PAST)
                above = damage([levels.take((..., near))], growth).sum(axis=0) > 1.0
                total[near] = np.where(above != counts, used[near], total[near])
        return total

    def border(self, width: Array) -> Array:
        """Return the next width at which a refusal ends, K_v has other laws, or f_Hbeta a step."""
        at = self.columns
        with np.errstate(invalid="ignore"):  # of spur gears
            shares = at["overlap"], 2.0 - at["contact"]
            ends = [share * at["axial"] * BEFORE for share in shares]
        found = np.full(len(width), np.inf)
        for end in ends:
            found = np.where((width <= end) & (end < found), end, found)
        if self.standard.practice.tolerances == "1995":
            steps = np.array((*WIDTHS[1:-1], np.inf))
            found = np.minimum(found, steps[np.searchsorted(steps, width)])
        return found

    def take(self, place: Any) -> "IsoRows":
        """Return some of the rows."""
        return IsoRows(self.standard, taken(self.columns, place))


def taken(columns: Columns, place: Any) -> Columns:
    """Return some rows of columns; equal ends stay one array."""
    made: dict[int, Any] = {}
    for value in columns.values():
        if id(value) not in made:
            made[id(value)] = value[..., place]
    return {name: made[id(value)] for name, value in columns.items()}


@dataclass(frozen=True)
class Box:
    """Rows between two widths [mm] and two torques."""

    standard: "Iso6336"
    columns: Columns
    widths: Two

    @property
    def given(self) -> Mapping[str, Any]:
        """Factors that are given."""
        return self.standard.given

    def parts(self) -> list[Any]:
        """Least part of the capacity in use, or stress where there are more loads; see MODES."""
        at, before = self.columns, self.dynamic(LOWER)
        after = self.spread(LOWER, before)
        transverse = self._transverse(after)
        bent = self.bent(before, after, transverse) * self.root_factor()
        pressed = self.pressed(after, transverse[0]) * self.ratio_factor(UPPER) ** 2
        found = [bent * at[f"bending_used{k}"] for k in (0, 1)]
        return found + [pressed * self.single(k) ** 2 * at[f"contact_used{k}"] for k in (0, 1)]

    @cached_property
    def line(self) -> Two:
        """F_t K_A K_gamma/b [N/mm]."""
        at, (low, high) = self.columns, self.widths
        same = low is high and at["force0"] is at["force1"]
        return _both(at["force0"] / high, same, lambda: at["force1"] / low)

    @cached_property
    def overlap(self) -> Two:
        """eps_beta."""
        low, high = self.widths
        axial = self.columns["axial"]
        return _both(low / axial, low is high, lambda: high / axial)

    @cached_property
    def total(self) -> Two:
        """eps_gamma."""
        first, second = self.overlap
        ratio = self.columns["contact"]
        return _both(ratio + first, first is second, lambda: ratio + second)

    @cached_property
    def singles(self) -> Two:
        """Return c' [MPa] at both ends of the line loads."""
        line = self.line
        return _both(self._single(line[0]), line[0] is line[1], lambda: self._single(line[1]))

    def _single(self, line: Any) -> Any:
        if "c_prime" in self.given:
            return self.given["c_prime"]
        return self.columns["stiffness"] * stiffness.light_load(line)

    def mesh(self, single: Any) -> Any:
        """Return c_gamma_alpha [MPa]."""
        if "c_gamma_alpha" in self.given:
            return self.given["c_gamma_alpha"]
        return stiffness.mesh_stiffness(single, self.columns["contact"])[0]

    def resonance(self, end: int, single: Any) -> Any:
        """Return N at an end of the speeds."""
        if "N" in self.given:
            return self.given["N"]
        return self.columns[f"pace{end}"] / np.sqrt(self.mesh(single))

    def dynamic(self, end: int) -> Any:
        """Return a bound of W1 = W0 K_v: of the ranges that N may lie in, and between them."""
        if "K_v" in self.given:
            return self.line[end] * self.given["K_v"]
        low, main, high = self._ranges(end)
        line, at, none = self.line, self.columns, (np.inf, -np.inf)[end]
        same = line[0] is line[1] and at["pace0"] is at["pace1"]
        slowest = self.resonance(LOWER, self.singles[UPPER])
        fastest = slowest if same else self.resonance(UPPER, self.singles[LOWER])
        limits = _both(loads.lower_limit(line[0]), same, lambda: loads.lower_limit(line[1]))
        ends = (slowest,) if same else (slowest, fastest)
        rises = [np.clip((n - loads.MAIN) / (loads.SUPER - loads.MAIN), 0.0, 1.0) for n in ends]
        passed = [main + (high - main) * rise for rise in rises]
        above = passed[0] if same else PICK[end](*passed)
        if same:
            return np.where(slowest <= limits[UPPER], low, above)
        return PICK[end](
            np.where(slowest <= limits[UPPER], low, none),
            np.where(fastest > limits[LOWER], above, none),
        )

    def _ranges(self, end: int) -> tuple[Any, Any, Any]:
        """Return bounds of W1 by the laws below, at and above the main resonance.

        C_v1 to C_v6 do not rise with eps_gamma, C_v7 does not fall.
        """
        at, line, single = self.columns, self.line[end], self.singles[end]
        c1, c2, c3, c4, c5, c6, _ = made = loads.coefficients(self.total[1 - end])
        c7 = made[6] if self.total[0] is self.total[1] else loads.coefficients(self.total[end])[6]
        pitch, form = at[f"pitch{end}"], at[f"form{end}"]
        pace = self.resonance(end, single)
        fast = np.maximum(line - single * at["relief1"], single * at["relief0"] - line)
        fast = np.maximum(fast, 0.0)  # of a virtual way, whose C_a may be any between two
        slow = pace * fast
        shared = single * (c1 * pitch + c2 * form)
        low = line + pace * shared + c3 * slow
        main = line + shared + c4 * fast
        return low, main, single * (c5 * pitch + c6 * form) + c7 * line

    def spread(self, end: int, dynamic: Any) -> Any:
        """Return a bound of W2 = W1 K_Hbeta from that of W1."""
        if "K_Hbeta" in self.given:
            return dynamic * self.given["K_Hbeta"]
        at, practice, width = self.columns, self.standard.practice, self.widths[end]
        shaft = loads.shaft_misalignment(dynamic, width / at["diameter0"], practice.offset)
        first, second = (
            helix_slope(at[f"diameter{k}"], width, practice.grades[k], practice.tolerances)
            for k in (0, 1)
        )
        alignment = self.given["f_ma"] if "f_ma" in self.given else (first**2 + second**2) ** 0.5
        before = loads.initial_misalignment(
            shaft, alignment, dynamic, np.maximum(first, second), practice.helix_modification
        )
        after = before - self.standard.helix_allowance(before, at[f"speed{end}"])
        return dynamic * loads.face_load_factor(after, self._c_gamma_beta(end), dynamic)

    def _c_gamma_beta(self, end: int) -> Any:
        """Return c_gamma_beta [MPa]."""
        if "c_gamma_beta" in self.given:
            return self.given["c_gamma_beta"]
        return 0.85 * self.mesh(self.singles[end])

    def pressed(self, spread: Any, transverse: Any) -> Any:
        """Return the least W2 K_Halpha from that of W2; transverse: K_alpha without limits."""
        if "K_Halpha" in self.given:
            return spread * self.given["K_Halpha"]
        most = self.total[LOWER] / (self.columns["contact"] * self.ratio_factor(LOWER) ** 2)
        return spread * loads.limited(transverse, most)

    def _transverse(self, spread: Any) -> Two:
        """Return K_alpha without limits of the least line load, and of an endless one."""
        mesh, total = self.mesh(self.singles[LOWER]), self.total[LOWER]
        made = [
            loads.transverse_load_factor(mesh, deviation, spread, total)
            for deviation in (self.columns["deviation0"], 0.0)
        ]
        return made[0], made[1]

    def bent(self, dynamic: Any, spread: Any, transverse: Two) -> Any:
        """Return the least W1 K_Fbeta K_Falpha from those of W1 and W2.

        W2^N_F K_alpha(W2) is least at a W2 that may be above the least one.
        """
        given, at, power = self.given, self.columns, self._root_power()
        face = given["K_Fbeta"] if "K_Fbeta" in given else (spread / dynamic) ** power
        if "K_Falpha" in given:
            return dynamic * face * given["K_Falpha"]
        found, endless = transverse
        above = self._least_at(power, spread, found / endless - 1.0)
        factor = above**power * (endless + (found - endless) / above)
        ratio = at["virtual"] if self.standard.practice.edition == "2019" else at["contact"]
        most = self.total[LOWER] / (at["contact"] * (0.25 + 0.75 / ratio))
        return dynamic * face * loads.limited(factor, most)

    def _root_power(self) -> Any:
        """Return the least N_F with which K_Fbeta follows K_Hbeta; 0 where K_Fbeta is given."""
        if "K_Fbeta" in self.given:
            return 0.0 if "K_Hbeta" not in self.given else 1.0
        if self.standard.practice.helix_modification in loads.LIGHT_ENDS:
            return 1.0
        return loads.root_exponent(self.widths[LOWER], self.columns["depth"])

    def _least_at(self, power: Any, spread: Any, excess: Any) -> Any:
        """Return W2 over its least value where W2^N_F (1 + excess/W2) is least, at least 1."""
        wanted = np.broadcast_to(excess * (1.0 - power), np.shape(spread)) / np.maximum(
            power, SMALLEST
        )
        at, (low, high) = self.columns, self.widths
        if self.standard.rivals:  # one of them may have any W2 above the least
            return np.maximum(wanted, 1.0)
        free = (low != high) | (at["force0"] != at["force1"])
        inside = free & (wanted > 1.0)
        some = np.flatnonzero(np.any(np.atleast_2d(inside), axis=0))
        found = np.ones(np.shape(spread))
        if len(some):
            part = Box(self.standard, taken(at, some), (low[some], high[some]))
            most = part.spread(UPPER, part.dynamic(UPPER)) / spread[..., some]
            found[..., some] = np.clip(wanted[..., some], 1.0, np.maximum(most, 1.0))
        return found

    def ratio_factor(self, end: int) -> Any:
        """Return Z_eps at an end of the widths; it does not rise with them."""
        if "Z_eps" in self.given:
            return self.given["Z_eps"]
        return contact.contact_ratio_factor(self.columns["contact"], self.overlap[end])

    def single(self, member: int) -> Any:
        """Return the least Z_B or Z_D, which is at an end of the widths."""
        if "Z_BD" in self.given:
            return self.given["Z_BD"][member]
        helical, practice = 1.0, self.standard.practice
        if practice.edition == "2019":
            helical = contact.PROFILE_MODIFICATIONS[practice.profile_modification] ** 0.5
        spur = self.columns[f"single{member}"]
        return self._least(lambda o: contact.single_contact_factor(spur, o, helical))

    def root_factor(self) -> Any:
        """Return the least Y_beta f_eps."""
        given, edition = self.given, self.standard.practice.edition
        factor = 1.0
        if edition == "2019" and "Y_F" not in given:
            factor = self._least(lambda o: load_sharing(self.columns["virtual"], o))
        if "Y_beta" in given:
            return factor * given["Y_beta"]
        return factor * bending.helix_factor(self.columns["helix"], self.overlap[UPPER], edition)

    def _least(self, law: Callable[[Any], Any]) -> Any:
        """Return the least value of a law that is monotone in eps_beta."""
        first, second = self.overlap
        value = law(first)
        return value if first is second else np.minimum(value, law(second))


def _both(first: Any, same: bool, second: Callable[[], Any]) -> Two:
    return first, first if same else second()
