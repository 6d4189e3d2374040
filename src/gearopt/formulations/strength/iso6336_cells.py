"""Least d1^2 b that ISO 6336 needs over cells of designs.

With s = W0/c', V1 = W1/c', V2 = W2/c' of the line loads W0 = F_t K_A K_gamma/b, W1 = W0 K_v,
W2 = W1 K_Hbeta [N/mm] all is a matter of lengths [mm]: deviations and deflections.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, partial, reduce
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from gearopt.formulations.strength.cells import LOWER, NUDGE, UPPER, Cells
from gearopt.formulations.strength.use.iso6336 import meshing
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import Gear, GearPair
from gearopt.physics.iso6336 import bending_factors as bending
from gearopt.physics.iso6336 import contact_factors as contact
from gearopt.physics.iso6336 import load_factors as loads
from gearopt.physics.iso6336 import running_in, stiffness
from gearopt.physics.iso6336.accuracy import Deviations
from gearopt.physics.iso6336.case import Case
from gearopt.physics.iso6336.tooth_form import load_sharing

if TYPE_CHECKING:
    from gearopt.formulations.strength.iso6336 import Iso6336

GEARS = (0, 1)
ENDLESS = 1e9  # mm: of a deviation whose allowance is the greatest one


@dataclass(frozen=True)
class IsoCells:
    """Cells of designs under the standard; teeth: their ranges (2, n) by name, of `iso_teeth`."""

    standard: "Iso6336"
    cells: Cells
    teeth: dict[str, Array]

    @property
    def given(self) -> Any:
        """Factors that are given."""
        return self.standard.given

    @cached_property
    def cases(self) -> tuple[Case, Case]:
        """Cases at the least and the greatest sizes and speeds."""
        made = [
            self.standard.case(self.cells.corner(k), self.cells.torque[k], self.cells.speed[k])
            for k in (LOWER, UPPER)
        ]
        return made[0], made[1]

    @cached_property
    def found(self) -> dict[str, Any]:
        """Numbers of the materials alone, of a virtual way the best Z_E."""
        return self.standard.found | {"Z_E": min(way.found["Z_E"] for way in self.standard.each)}

    @cached_property
    def _reliefs(self) -> tuple[Any, Any]:
        """The least and the greatest C_a [mm] of all ways."""
        reliefs = [way.found["C_a"] for way in self.standard.each]
        return min(reliefs), max(reliefs)

    @cached_property
    def line(self) -> Array:
        """Line load F_t K_A K_gamma/b [N/mm] of every cell, its least and its greatest."""
        force = 2.0 * self.found["K_A"] * self.found["K_gamma"] * self.cells.torque
        load = self.standard.loads[0]
        area = self.cells.diameter * self.cells.width
        return np.asarray(force * (load.power / load.speed) / area[::-1])

    def single(self, end: int, line: int) -> Any:
        """Return c' [MPa], the least or greatest at an end of the line loads."""
        if "c_prime" in self.given:
            return self.given["c_prime"]
        first, second = (m.modulus for m in self.standard.materials)
        modulus = 2.0 * first * second / (first + second) / stiffness.STEEL
        bare = self.teeth["stiffness"][end] * modulus * self._blank[end]
        return bare * stiffness.light_load(self.line[line])

    @cached_property
    def _blank(self) -> tuple[Any, Any]:
        """The least and the greatest C_R, the mean of both gears."""

        def law(blank: Blank, gear: Gear) -> tuple[Any, Any, Any]:
            if not blank.has_rim:
                return 1.0, 1.0, 1.0
            part = blank.rim(gear) / gear.normal_module
            return stiffness.blank_factor(blank.web_over_width, part), 1.0, 1.0

        (low1, high1), (low2, high2) = self._bodies(law)
        return 0.5 * (low1 + low2), 0.5 * (high1 + high2)

    def _bodies(self, law: Callable[[Blank, Gear], tuple[Any, Any, Any]]) -> list[tuple[Any, Any]]:
        """Least and greatest value of a law of bodies (`Cells.of_bodies`) of pinion and wheel."""
        return [
            self.cells.of_bodies(blank, k, partial(law, blank))
            for k, blank in enumerate(self.standard.blanks)
        ]

    @cached_property
    def deflection(self) -> tuple[Any, Any]:
        """S [mm], which does not fall with W0."""
        return self.line[0] / self.single(UPPER, LOWER), self.line[1] / self.single(LOWER, UPPER)

    def mesh(self, end: int) -> Any:
        """Return c_gamma_alpha/c', at least or at most."""
        if "c_gamma_alpha" in self.given:
            return self.given["c_gamma_alpha"] / self.single(1 - end, 1 - end)
        return stiffness.mesh_stiffness(1.0, self.teeth["contact"][end])[0]

    def c_gamma_beta_over_c_prime(self, end: int) -> Any:
        """Return c_gamma_beta/c', at least or at most."""
        if "c_gamma_beta" in self.given:
            return self.given["c_gamma_beta"] / self.single(1 - end, 1 - end)
        return 0.85 * self.mesh(end)

    @cached_property
    def total(self) -> Array:
        """eps_gamma."""
        return np.asarray(self.teeth["contact"] + self.cells.overlap)

    @cached_property
    def deviations(self) -> tuple[tuple[Any, Any, Any], tuple[Any, Any, Any]]:
        """Pitch, form and the deviation of K_Halpha after running-in [mm], least and greatest."""
        toothing = [case.deviations for case in self.cases]
        pitches = [self.given.get("f_pb", gear.base_pitch) for gear in toothing]
        forms = [self.given.get("f_falpha", gear.profile_form) for gear in toothing]
        each, wears = [], (True, not self.standard.rivals)  # virtual ways are the softest
        for end, case in enumerate(self.cases):
            pitch, form_worn_as_pitch, form = (
                size - (wears[end] and self.standard.running_in_allowance(case, worn))
                for size, worn in (
                    (pitches[end], pitches[end]),
                    (forms[end], pitches[1 - end]),
                    (forms[end], forms[end]),
                )
            )
            each.append((pitch, form, np.maximum(pitch, form_worn_as_pitch)))
        return each[0], each[1]

    @cached_property
    def resonance(self) -> tuple[Any, Any]:
        """N, at least and at most."""
        if "N" in self.given:
            return self.given["N"], self.given["N"]
        standard, cells, ratios = self.standard, self.cells, []
        densities = standard.materials[0].density, standard.materials[1].density
        meshes = standard.practice.meshes
        inner = self._inner_parts()
        for end in (LOWER, UPPER):
            z, d = cells.teeth[end], cells.diameter[end]
            masses = []
            for i, j in product(
                (LOWER, UPPER)[: 2 if "helix_angle" in cells.ranges else 1], repeat=2
            ):
                module = d * np.cos(cells.helix_bounds[i]) / z
                cut = cells.cut(j, pinion_shift=end)
                pair = cut.of_diameter(module, z, d, cells.ratio[end], 1.0)
                pair = self._shortened(pair, end)
                rows = zip(inner, pair.gears, strict=True)
                first, second = (p[1 - end] * stiffness.mean_diameter(gear) for p, gear in rows)
                masses.append(stiffness.reduced_mass(pair, densities, (first, second), meshes))
            mass = (np.minimum, np.maximum)[end].reduce(masses)
            stiff = self.mesh(1 - end) * self.single(1 - end, 1 - end)
            speed = standard.loads[0].speed * cells.speed[end]
            pace = speed * z * np.sqrt(mass / stiff)
            ratios.append(np.where(np.isfinite(pace), pace, 0.0 if end == LOWER else np.inf))
        return ratios[0], ratios[1]

    def _shortened(self, pair: GearPair, end: int) -> GearPair:
        """Return a pair whose tips are shortened the most or the least, where shifts are chosen."""
        if self.cells.toothing.shifting is None:
            return pair
        shorter = self.teeth["shorter"][end]
        first, second = (replace(gear, tip_alteration=shorter) for gear in pair.gears)
        return GearPair(first, second, pair.working_distance)

    def _inner_parts(self) -> list[tuple[Any, Any]]:
        """Return d_i/d_m of pinion and wheel, at least and at most."""

        def law(blank: Blank, gear: Gear) -> tuple[Any, Any, Any]:
            mean = stiffness.mean_diameter(gear)
            rim, bored, solid = (np.clip(d / mean, 0.0, 1.0) for d in blank.inner_diameters(gear))
            return rim, bored, solid

        return self._bodies(law)

    @cached_property
    def dynamic(self) -> Any:
        """The least K_v."""
        if "K_v" in self.given:
            return self.given["K_v"]
        c1, c2, c3, c4, c5, c6, _ = loads.coefficients(self.total[UPPER])
        c7 = loads.coefficients(self.total[LOWER])[6]
        pitch, form, _ = self.deviations[LOWER]
        s, slow = self.deflection, self.resonance[LOWER]
        ratios = [1.0 - relief / x for relief, x in zip(self._reliefs[::-1], s, strict=True)]
        relief = np.where(ratios[0] * ratios[1] < 0.0, 0.0, np.minimum(*np.abs(ratios)))
        shared = (c1 * pitch + c2 * form) / s[1]
        low = 1.0 + slow * (shared + c3 * relief)
        main = 1.0 + shared + np.minimum(c4 * relief, c4 * np.maximum(*np.abs(ratios)))
        return self._of_ranges(LOWER, low, main, (c5 * pitch + c6 * form) / s[1] + c7)

    def _of_ranges(self, end: int, low: Any, main: Any, high: Any) -> Any:
        """Return the least or greatest of the laws of the ranges in which N may lie."""
        pick, none = ((np.minimum, np.inf), (np.maximum, -np.inf))[end]
        slow, fast = self.resonance
        begins = loads.lower_limit(self.line)
        width = loads.SUPER - loads.MAIN
        passed = [
            main + (high - main) * np.clip((n - loads.MAIN) / width, 0.0, 1.0) for n in (slow, fast)
        ]
        below = np.where(slow <= begins[1], low, none)
        above = np.where(fast > begins[0], pick(*passed), none)
        return pick(below, above)

    @cached_property
    def loaded(self) -> Any:
        """The greatest V1 [mm]."""
        s = self.deflection
        if "K_v" in self.given:
            return s[1] * self.given["K_v"]
        c1, c2, c3, c4, c5, c6, _ = loads.coefficients(self.total[LOWER])
        c7 = loads.coefficients(self.total[UPPER])[6]
        pitch, form, _ = self.deviations[UPPER]
        relief = np.maximum(s[1] - self._reliefs[0], self._reliefs[1] - s[0])
        shared = c1 * pitch + c2 * form
        low = s[1] + self.resonance[UPPER] * (shared + c3 * relief)
        main = s[1] + shared + np.maximum(c4, 0.0) * relief
        return self._of_ranges(UPPER, low, main, c5 * pitch + c6 * form + c7 * s[1])

    @cached_property
    def spread(self) -> Any:
        """The least K_Hbeta."""
        if "K_Hbeta" in self.given:
            return self.given["K_Hbeta"]
        practice, slow = self.standard.practice, self.cases[LOWER]
        alignment, slope = self._alignment(LOWER)
        first, second = loads.HELIX_MODIFICATIONS[practice.helix_modification]
        bent = loads.shaft_misalignment(1.0, self.cells.slim[LOWER], self._bending[LOWER])
        parts = (
            (1.33 * first * bent, second * alignment),
            (loads.LEAST_PER_LOAD, 0.0),
            (0.0, 0.5 * slope),
        )
        stiff = self.c_gamma_beta_over_c_prime(LOWER) * self.single(LOWER, LOWER)
        x = np.zeros(len(slow.speed))
        sure = self.c_gamma_beta_over_c_prime(LOWER) / self.loaded
        possible = self.c_gamma_beta_over_c_prime(UPPER) / (self.deflection[LOWER] * self.dynamic)
        for share, worn in self._worn():
            for per_load, fixed in parts:
                rest = share * fixed - worn
                by_fixed = rest * np.where(rest >= 0.0, sure, possible)
                x = np.maximum(x, 0.5 * (stiff * share * per_load + by_fixed))
        return loads.face_load_factor(x, 2.0, 1.0)

    @cached_property
    def _bending(self) -> tuple[Any, Any]:
        """K of the shaft where |0.7 + K| is least and greatest: at ends, and where K' jumps."""
        practice, (low, high) = self.standard.practice, self.cells.diameter
        jump = loads.STIFF * practice.shaft.diameter
        inside = [np.clip(jump * (1.0 + e), low, high) for e in (-NUDGE, NUDGE)]
        ends = np.stack([practice.bending(d) for d in (low, high, *inside)])
        least, most = ends.min(axis=0), ends.max(axis=0)
        far = np.abs(loads.STRAIGHT + least) > np.abs(loads.STRAIGHT + most)
        return np.clip(-loads.STRAIGHT, least, most), np.where(far, least, most)

    def _alignment(self, end: int) -> tuple[Any, Any]:
        """Return f_ma and f_Hbeta [mm]."""
        made: Deviations = self.cases[end].deviations
        return self.given.get("f_ma", made.alignment), made.helix_slope

    def _worn(self) -> list[tuple[Any, Any]]:
        """Return shares and sizes [mm]: F_betay is at least each share of F_betax less the size.

        Of each gear y_beta = min(k F_betax, most).
        """
        speed, found = self.cases[LOWER].speed, [(1.0, 0.0)]
        for kinds in self.standard.wearing:
            share, most = (
                reduce(
                    np.maximum,
                    (running_in.helix_allowance(f, size, soft, speed) / size for f, soft in kinds),
                )
                for size in (1e-9, ENDLESS)
            )
            found = [
                pair
                for part, size in found
                for pair in ((part - 0.5 * share, size), (part, size + 0.5 * most * ENDLESS))
            ]
        return found

    @cached_property
    def spread_loaded(self) -> Any:
        """The greatest V2 [mm]."""
        if "K_Hbeta" in self.given:
            return self.loaded * self.given["K_Hbeta"]
        practice, fast = self.standard.practice, self.cases[UPPER]
        alignment, slope = self._alignment(UPPER)
        line = self.loaded * self.single(UPPER, UPPER)
        shaft = loads.shaft_misalignment(line, self.cells.slim[UPPER], self._bending[UPPER])
        before = loads.initial_misalignment(
            shaft, alignment, line, slope, loads.HELIX_MODIFICATIONS[practice.helix_modification]
        )
        worn: Any = 0.0
        for k, m in enumerate(() if self.standard.rivals else self.standard.materials):
            limit = self.found["sigma_Hlim"][k]
            worn = worn + 0.5 * running_in.helix_allowance(m.family, before, limit, fast.speed)
        after = before - worn
        return self.loaded * loads.face_load_factor(
            after, self.c_gamma_beta_over_c_prime(UPPER), self.loaded
        )

    def transverse(self, name: str, most: Any) -> Any:
        """Return the least K_Halpha or K_Falpha; most: the least of its greatest value."""
        if name in self.given:
            return self.given[name]
        deviation = self.deviations[LOWER][2]
        found = loads.transverse_load_factor(
            self.mesh(LOWER), deviation, self.spread_loaded, self.total[LOWER]
        )
        return loads.limited(found, most)

    @property
    def _ratio_factor(self) -> Any:
        """The least Z_eps, which falls with both contact ratios."""
        own = contact.contact_ratio_factor(self.teeth["contact"][UPPER], self.cells.overlap[UPPER])
        return self.given.get("Z_eps", own)

    def pressed(self, safety: float) -> Any:
        """Return the least d1^2 b/(T (1 + 1/u)) [1/MPa] of contact."""
        given, ratio = self.given, self.teeth["contact"][LOWER]
        if "Z_eps" in given:
            most = (1.0 + self.cells.overlap[LOWER] / self.teeth["contact"][UPPER]) / given[
                "Z_eps"
            ] ** 2
        else:
            low = contact.contact_ratio_factor(ratio, self.cells.overlap[LOWER])
            most = self.total[LOWER] / (ratio * low**2)
        factor = self.dynamic * self.spread * self.transverse("K_Halpha", most)
        helix = self.cells.helix_bounds[LOWER]
        z = given.get("Z_H", self.teeth["zone"][LOWER]) * self.found["Z_E"]
        z = z * given.get("Z_beta", contact.helix_factor(helix)) * self._ratio_factor
        used = [
            (self._single(k) * z * safety / self.standard.strongest(self, k, True)) ** 2
            for k in GEARS
        ]
        return self._unit * factor * np.maximum(*used)

    @property
    def _unit(self) -> Any:
        load = self.standard.loads[0]
        return 2.0 * self.found["K_A"] * self.found["K_gamma"] * load.power / load.speed

    def _single(self, member: int) -> Any:
        """Return the least Z_B or Z_D."""
        if "Z_BD" in self.given:
            return self.given["Z_BD"][member]
        helical, practice = 1.0, self.standard.practice
        if practice.edition == "2019":
            helical = contact.PROFILE_MODIFICATIONS[practice.profile_modification] ** 0.5
        spur = np.maximum(self.teeth[f"single{member}"][LOWER], 1.0)
        made = [contact.single_contact_factor(spur, o, helical) for o in self.cells.overlap]
        return np.minimum(*made)

    def bent(self, safety: float) -> Any:
        """Return the least d1^2 b/T [1/MPa] of bending."""
        given, cells = self.given, self.cells
        edition = self.standard.practice.edition
        ratio = self.teeth["virtual" if edition == "2019" else "contact"][LOWER]
        most = self.total[LOWER] / (self.teeth["contact"][LOWER] * (0.25 + 0.75 / ratio))
        factor = self.dynamic * self._root_spread() * self.transverse("K_Falpha", most)
        module = cells.teeth[LOWER] / np.cos(cells.helix_bounds[LOWER])
        used = []
        for k in GEARS:
            form = given["Y_F"][k] if "Y_F" in given else self.teeth[f"form{k}"][LOWER]
            notch = self.teeth[f"concentration{k}"][LOWER]
            form = form * (given["Y_S"][k] if "Y_S" in given else notch)
            excess = np.minimum(cells.toothing.width_excesses[k], 2.0 * cells.module[UPPER])
            form = form * meshing(cells.width[LOWER], excess)
            used.append(form * self._rim(k) / self.standard.strongest(self, k, False))
        return self._unit * factor * module * self._root_factor() * np.maximum(*used) * safety

    def _root_spread(self) -> Any:
        """Return the least K_Fbeta."""
        if "K_Fbeta" in self.given:
            return self.given["K_Fbeta"]
        if self.standard.practice.helix_modification in loads.LIGHT_ENDS:
            return self.spread
        racks = self.cells.toothing.racks
        deep = max(rack.addendum + rack.dedendum for rack in racks)
        over = (
            self.cells.slim[LOWER]
            * self.cells.teeth[LOWER]
            / np.cos(self.cells.helix_bounds[LOWER])
        )
        return self.spread ** loads.root_exponent(over, deep)

    def _root_factor(self) -> Any:
        """Return the least Y_beta f_eps Y_DT."""
        given, practice = self.given, self.standard.practice
        factor = 1.0
        if practice.edition == "2019" and "Y_F" not in given:
            virtual = self.teeth["virtual"]
            made = [load_sharing(v, o) for v in virtual for o in self.cells.overlap]
            factor = np.minimum.reduce(made)
        least, most = self.cells.helix_bounds
        inclined = bending.helix_factor(most, self.cells.overlap[UPPER], practice.edition)
        if practice.edition != "2006":  # over the third power of a cosine, which falls
            inclined = inclined * (np.cos(most) / np.cos(least)) ** 3
        deep = bending.deep_tooth_factor(self.teeth["virtual"][UPPER], max(practice.grades))
        return factor * given.get("Y_beta", inclined) * given.get("Y_DT", deep)

    def _rim(self, member: int) -> Any:
        """Return the least Y_B, which falls with the backup ratio."""
        if "Y_B" in self.given:
            return _of(self.given["Y_B"], member)
        blank = self.standard.blanks[member]
        backup = self.cells.of_bodies(blank, member, blank.backups)[UPPER]
        return np.where(backup > 0.5, bending.rim_factor(backup), 1.0)


def _of(value: Any, member: int) -> Any:
    return value[member] if isinstance(value, tuple | list) else value
