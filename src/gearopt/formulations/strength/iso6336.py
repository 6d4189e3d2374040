"""ISO 6336 as a standard of rated stages.

At one power a slower, stronger torque may take less: it can leave the main resonance.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from types import SimpleNamespace
from typing import Any, Self

import numpy as np

from gearopt.formulations.strength.cells import Cells
from gearopt.formulations.strength.iso6336_cells import IsoCells
from gearopt.formulations.strength.iso6336_rows import AT_ENDS, Columns, IsoRows, way_of
from gearopt.formulations.strength.standard import Box, Load, Smooth, together
from gearopt.formulations.strength.teeth_alone import iso_teeth
from gearopt.formulations.strength.use.iso6336 import IsoWay
from gearopt.formulations.strength.virtual import Strength as Rival
from gearopt.formulations.strength.virtual import may_be_best
from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.physics.blanks import SOLID, Blank
from gearopt.physics.choosing import choose
from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336 import accuracy, chain, contact_factors, running_in, stiffness
from gearopt.physics.iso6336 import bending_factors as bending
from gearopt.physics.iso6336.batch import rate_rows, smooth_safeties, spectrum_rows
from gearopt.physics.iso6336.case import Case, Practice, life_curve, of_blanks
from gearopt.physics.iso6336.curves import Curve, reference_share, share_of_life
from gearopt.physics.iso6336.load_factors import RANGES
from gearopt.physics.iso6336.materials import SURFACE_HARDENED, Material
from gearopt.physics.iso6336.rating import check_lives
from gearopt.physics.iso6336.table import ToothTable, tooth_table
from gearopt.physics.rating import Operation

GEARS = (0, 1)
UNIT = GearPair.of_teeth(1.0, 20.0, 20.0, 1.0)  # on which numbers of materials do not depend
Law = Callable[[Case, dict[str, Any]], Any]


@dataclass(frozen=True)
class Iso6336:
    """The rating of stages made in one way by ISO 6336.

    operation: its overload and contacts count. blanks: of pinion and wheel, for Y_B, C_R and m_red,
    which practice does not have. given: as of `iso6336.rating.rate`. rivals: other ways of making
    them; of all of them `rows` then has every factor at its best. safety: S_F and S_H asked by it
    over those of the stage.
    """

    loads: tuple[Load, ...]
    operation: Operation
    materials: tuple[Material, Material]
    practice: Practice
    blanks: tuple[Blank, Blank] = (SOLID, SOLID)
    given: Mapping[str, Any] = field(default_factory=dict)
    suffix: str = ""
    monotone: bool = False
    rivals: tuple["Iso6336", ...] = ()
    safety: tuple[float, float] = (1.0, 1.0)

    def case(self, pair: GearPair, torque: Any, speed: Any, level: int = 0) -> Case:
        """Return the case of a level of load."""
        operation = self.loads[level].of(self.operation, torque, speed)
        return Case(pair, operation, self.materials, self._practice(pair), self.given)

    @property
    def thinnest_ring(self) -> float:
        """s_R/m_n up to which no ring is rated: it has no Y_B."""
        return 0.0 if "Y_B" in self.given else bending.THIN_RING

    @property
    def steps(self) -> dict[str, tuple[float, ...]]:
        """Return the sizes [mm] at which deviations jump, by name of `Cells`."""
        if self.practice.tolerances != "1995":
            return {}
        across = accuracy.DIAMETERS[1:-1]
        sizes = {"diameter": across, "wheel": across, "module": accuracy.MODULES[1:-1]}
        return sizes | {"width": accuracy.WIDTHS[1:-1]}

    def needed(self, cells: Cells, safety: tuple[float, float]) -> tuple[Any, Any]:
        """Return the least d1^2 b/(T (1 + 1/u)) of contact and d1^2 b/T of bending."""
        teeth = cells.teeth_alone(iso_teeth(self.practice.shift))
        for name in ("contact", "virtual"):  # with less than one pair in contact none is rated
            teeth[name] = np.maximum(teeth[name], 1.0)
        rated = IsoCells(self, cells, teeth)
        with np.errstate(all="ignore"):
            return rated.pressed(safety[1] * self.safety[1]), rated.bent(safety[0] * self.safety[0])

    def strongest(self, made: IsoCells, member: int, contact: bool) -> Any:
        """Return the greatest sigma_HG or sigma_FG [MPa] of a gear in cells of designs."""
        cells, teeth = made.cells, made.teeth
        ends: Any = SimpleNamespace(
            notches=[teeth[f"notch{k}"][1] for k in GEARS],
            concentrations=[teeth[f"concentration{k}"][1] for k in GEARS],
        )
        (low, high), (u_low, u_high) = cells.teeth, cells.ratio
        cut = cells.cut(1)
        total = sum(cut.profile_shifts) if cut.shift_sum is None else cut.shift_sum
        fewest = low * (1.0 + u_low) / (1.0 + u_high)
        z = np.where(np.greater(total, 0.0), fewest, high)  # of the greatest alpha_wt
        pair = cut.of_diameter(cells.module[0], z, cells.diameter[1], u_high, 1.0)
        far = cut.of_diameter(cells.module[0], z, cells.diameter[1], u_low, 1.0)
        slow, fast = (self.case(pair, 1.0, speed) for speed in cells.speed)
        last, strengths = self.case(far, 1.0, cells.speed[1]), []
        for way in self.strongest_ways[contact, member]:
            at = [replace(case, materials=way.materials) for case in (slow, fast, last)]
            strength = _strength(way, (at[0], at[1]), ends, member, contact, way.found)
            strengths.append(strength.greatest((at[0], at[2])))
        return np.maximum.reduce(strengths)

    def _practice(self, pair: GearPair) -> Practice:
        made = of_blanks(self.practice, pair, self.blanks)
        first, second = (
            None if ratio is None else choose(ratio > 0.5, ratio, np.nan) for ratio in made.backup
        )
        return replace(made, backup=(first, second))

    def safeties(self, pair: GearPair, torque: Any, speed: Any) -> tuple[Any, Any, Any, Any]:
        """Return S_F1, S_F2, S_H1, S_H2; NaN where ISO 6336 refuses the pair, or a rim."""
        operations = [load.of(self.operation, torque, speed) for load in self.loads]
        made = self.materials, self._practice(pair), self.given
        if len(operations) == 1:
            ratings = rate_rows(pair, operations[0], *made)
        else:
            ratings = spectrum_rows(pair, operations, *made)
        return self._of_stage((*ratings.bending, *ratings.contact))

    def _of_stage(self, found: tuple[Any, Any, Any, Any]) -> tuple[Any, Any, Any, Any]:
        """Return safety factors as they compare with those asked of the stage."""
        (bending, contact), (b1, b2, c1, c2) = self.safety, found
        return b1 / bending, b2 / bending, c1 / contact, c2 / contact

    def root_balance(self, pair: GearPair, speed: Any) -> Any:
        """Return S_F1/S_F2 of pairs (n,) under the first load, whatever the width and the torque.

        speed [rad/s] of the pinion, by which the life factors count.
        """
        table, unit = self.prepared(pair), pair.of_width(1.0)
        case = self.case(unit, 1.0, speed)
        ends, bent = (case, case), self._bending(table, case, self.found)
        safe = [
            _strength(self, ends, table, k, False, self.found).greatest(ends) / bent[k]
            for k in GEARS
        ]
        return safe[0] / safe[1]

    @property
    def unknowns(self) -> dict[str, tuple[float, float, bool]]:
        """Ends of the unknowns of the smooth form: none, for it has no unknowns."""
        return {}

    def choices(self, helical: bool) -> tuple[str, ...]:
        """Return the range of K_v in which a search begins."""
        return RANGES[:1]

    def refined(self, pair: GearPair, choice: str) -> tuple[str, ...]:
        """Return the other ranges of K_v."""
        return tuple(other for other in RANGES if other != choice)

    def guess(self, pair: GearPair, choice: str) -> dict[str, float]:
        """Unknowns of a pair of floats: none, as of `unknowns`."""
        return {}

    def smooth(
        self, pair: GearPair, torque: Any, speed: Any, choice: str, unknown: dict[str, Any]
    ) -> Smooth:
        """Return the rating in a range of K_v, with deviations that have no steps."""
        operation = self.loads[0].of(self.operation, torque, speed)
        practice = self._practice(pair)
        made = smooth_safeties(pair, operation, self.materials, practice, choice, self.given)
        return Smooth(self._of_stage(made), {}, {}, {})

    def floor(self, box: Box, choice: str) -> None:
        """Lower bounds of the used capacity as posynomials: None, for none are known."""

    def best_with(self, rivals: Sequence[Self]) -> Self | None:
        """Return the virtual way with every factor at its best; None where rows cannot be compared.

        Stiffness, mass and laws of the levels of a spectrum have to be the same.
        """
        alike = all(replace(rival, materials=self.materials) == self for rival in rivals)
        same = alike and all(rival._compared == self._compared for rival in rivals)
        return replace(self, rivals=tuple(rivals)) if same else None

    @property
    def _compared(self) -> Any:
        """What a virtual best way needs to be the same in all."""
        first, second = (m.modulus for m in self.materials)
        several = range(len(GEARS) if len(self.loads) > 1 else 0)
        curves = [self._curve(k, contact) for k in several for contact in (True, False)]
        densities = [m.density for m in self.materials]
        return first * second / (first + second), densities, curves

    def _curve(self, k: int, contact: bool) -> Curve:
        return life_curve(self.materials[k], self.practice, contact)

    @cached_property
    def each(self) -> tuple["Iso6336", ...]:
        """Return all ways of making the gears, this one first."""
        return (replace(self, rivals=()), *self.rivals) if self.rivals else (self,)

    @cached_property
    def way(self) -> IsoWay:
        """Return the numbers of it that `least_part` takes."""
        return way_of(self)

    @cached_property
    def wearing(self) -> tuple[tuple[tuple[str, float], ...], ...]:
        """Return families and sigma_Hlim [MPa] of pinion and wheel that may run in most."""
        softest: list[dict[str, tuple[str, float]]] = [{}, {}]
        for k in GEARS:
            for way in self.each:
                family, limit = way.materials[k].family, way.found["sigma_Hlim"][k]
                kind = running_in.kind(family)
                if kind not in softest[k] or limit < softest[k][kind][1]:
                    softest[k][kind] = family, limit
        return tuple(tuple(by_kind.values()) for by_kind in softest)

    @cached_property
    def strongest_ways(self) -> dict[tuple[bool, int], tuple["Iso6336", ...]]:
        """Return the ways that may be the strongest, by contact (else bending) and member."""
        ways = {}
        for contact in (True, False):
            for k in GEARS:
                rivals = [way._strength_of(k, contact) for way in self.each]
                ways[contact, k] = tuple(self.each[n] for n in may_be_best(rivals))
        return ways

    def _strength_of(self, k: int, contact: bool) -> Rival:
        """Strength of a gear, to compare with that of rivals."""
        material, curve, limits = (
            self.materials[k],
            self._curve(k, contact),
            self.found["sigma_Hlim"],
        )
        if not contact:
            fixed = _two(self.found["sigma_Flim"])[k] * _two(self.found["Y_M"])[k]
            notches = material.strength_for_notches
            return Rival((material.family, notches, material.root, curve), (), fixed)
        softer = contact_factors.counted_limit(min(limits))
        law = softer, self.materials[0].flank + self.materials[1].flank, curve
        hardens = k == 1 and material.family not in SURFACE_HARDENED and "Z_W" not in self.given
        if not hardens:
            return Rival(law, (), limits[k])
        return Rival(law, self.materials, limits[k], contact_factors.LARGEST_HARDENING)

    def like(self, other: Any) -> bool:
        """Return whether `prepared` of another standard is the same."""
        return isinstance(other, Iso6336) and other.practice.shift == self.practice.shift

    def prepared(self, pair: GearPair) -> ToothTable:
        """Quantities of the teeth of pairs (n,), of any width."""
        return tooth_table(pair, self.practice.shift)

    @np.errstate(invalid="ignore", divide="ignore", over="ignore")
    def rows(
        self,
        prepared: ToothTable,
        pair: GearPair,
        torque: tuple[Array, Array],
        speed: tuple[Array, Array],
        safety: tuple[float, float],
    ) -> IsoRows:
        """Return rows; of two values at the ends of the torques that of the least load is first.

        Loads are least at the weakest torque; deviations, N and cycles at the slowest speed.
        """
        if len(self.loads) > 1:
            check_lives(self.given)
        unit, shape, load = pair.of_width(1.0), np.shape(torque[0]), together(self.loads)
        slow, fast = (load.of(self.operation, torque[0], s) for s in (speed[1], speed[0]))
        same = np.array_equal(*torque)
        first = Case(unit, slow, self.materials, self._practice(unit), self.given)
        cases = first, first if same else replace(first, operation=fast)
        values = self._columns(prepared, cases, load, torque, safety)
        columns = {
            name: np.broadcast_to(value, np.broadcast_shapes(np.shape(value), shape))
            for name, value in values.items()
        }
        return IsoRows(self, columns | {f"{n}1": columns[f"{n}0"] for n in AT_ENDS if same})

    def nominal(
        self,
        prepared: ToothTable,
        pair: GearPair,
        torque: tuple[Array, Array],
        speed: tuple[Array, Array],
        safety: tuple[float, float],
        widths: tuple[Array, Array],
    ) -> Array:
        """Least widths [mm] over the torque [N mm] by W0 and the strengths of any torque."""
        rows = self.rows(prepared, pair, torque, speed, safety)
        return np.asarray(rows.nominal(*widths) / torque[0])

    def _columns(
        self,
        table: ToothTable,
        cases: tuple[Case, Case],
        load: Load,
        torque: tuple[Array, Array],
        safety: tuple[float, float],
    ) -> Columns:
        """Columns of `IsoRows`; cases: of unit width at the slow and fast end."""
        slow = cases[0]
        columns = self._teeth(table, slow) | self._loads(cases, load, torque)
        reliefs = [way.found["C_a"] for way in self.each]
        columns["relief0"], columns["relief1"] = min(reliefs), max(reliefs)
        factors = self.found | {"Z_E": min(way.found["Z_E"] for way in self.each)}
        pressed, bent = self._contact(table, slow, factors), self._bending(table, slow, factors)
        for k in GEARS:
            columns[f"contact_used{k}"] = pressed * (safety[1] * self.safety[1]) ** 2
            columns[f"bending_used{k}"] = bent[k] * safety[0] * self.safety[0]
            for contact, name in ((True, "contact"), (False, "bending")):
                strengths = self._strengths(cases, table, k, contact)
                if len(self.loads) == 1:
                    most = np.maximum.reduce([each.greatest(cases) for each in strengths])
                    columns[f"{name}_used{k}"] /= most**2 if contact else most
                    continue
                columns[f"cycles{k}"] = cycles = slow.cycles[k]
                columns |= _under_levels(strengths, f"{name}{k}", cycles)
        return columns

    def _strengths(
        self, cases: tuple[Case, Case], table: ToothTable, k: int, contact: bool
    ) -> list["Strength"]:
        """Return the strengths of a gear, of which the greatest counts."""
        strengths = []
        for way in self.strongest_ways[contact, k]:
            slow = replace(cases[0], materials=way.materials)
            same = cases[0] is cases[1]
            ends = slow, slow if same else replace(cases[1], materials=way.materials)
            strengths.append(_strength(way, ends, table, k, contact, way.found))
        return strengths

    @cached_property
    def found(self) -> dict[str, Any]:
        """Numbers of the materials alone, by symbol."""
        case = Case(UNIT, self.operation, self.materials, self.practice, self.given)
        names = ("K_A", "K_gamma", "sigma_Hlim", "sigma_Flim", "C_a", "Z_E", "Z_X", "Y_ST", "Y_M")
        found: dict[str, Any] = {}
        for name in names:
            found[name] = self.given[name] if name in self.given else chain.LAWS[name](case, found)
        return found

    def _teeth(self, table: ToothTable, case: Case) -> Columns:
        """Quantities of the teeth, lengths [mm]."""
        pair = case.pair
        first, second = (m.modulus for m in self.materials)
        modulus = 2.0 * first * second / (first + second) / stiffness.STEEL
        blank = stiffness.mean_blank_factor(case.practice.webs)
        deep = np.maximum(*(g.rack.addendum + g.rack.dedendum for g in pair.gears))
        return {
            "contact": table.contact,
            "virtual": table.virtual,
            "single0": table.singles[0],
            "single1": table.singles[1],
            "overlap": table.overlap,
            "axial": table.axial,
            "stiffness": table.stiffness * modulus * blank,
            "depth": deep * pair.normal_module,
            "helix": pair.pinion.helix_angle,
            "diameter0": pair.pinion.reference_diameter,
            "diameter1": abs(pair.wheel.reference_diameter),
            "bending": self.practice.bending(pair.pinion.reference_diameter),
            "excess0": pair.pinion.root_excess,
            "excess1": pair.wheel.root_excess,
        }

    def _loads(self, cases: tuple[Case, Case], load: Load, torque: tuple[Array, Array]) -> Columns:
        """Return loads [N], speeds, and deviations after running-in [mm], at both ends."""
        slow = cases[0]
        found, d1 = self.found, slow.pair.pinion.reference_diameter
        force = 2.0 * found["K_A"] * found["K_gamma"] * load.power / load.speed / d1
        densities = self.materials[0].density, self.materials[1].density
        practice = slow.practice
        mass = stiffness.reduced_mass(slow.pair, densities, practice.bores, practice.meshes)
        made = slow.deviations
        pitch = self.given.get("f_pb", made.base_pitch)
        form = self.given.get("f_falpha", made.profile_form)
        columns = {}
        for k, case in enumerate(cases[: 1 if cases[0] is cases[1] else 2]):
            worn = [self.running_in_allowance(case, value) for value in (pitch, form)]
            columns[f"force{k}"] = force * torque[k]
            columns[f"pace{k}"] = case.operation.pinion_speed * slow.pair.pinion_teeth * mass**0.5
            columns[f"speed{k}"] = case.speed
            columns[f"pitch{k}"] = pitch - worn[0]
            columns[f"form{k}"] = form - worn[1]
            columns[f"deviation{k}"] = np.maximum(pitch, form) - worn[0]
        return columns

    def running_in_allowance(self, case: Case, deviation: Any) -> Any:
        """Return y_alpha of a deviation [mm], the mean of both gears."""
        first, second = (
            np.maximum.reduce(
                [running_in.pitch_allowance(f, deviation, limit, case.speed) for f, limit in kinds]
            )
            for kinds in self.wearing
        )
        return 0.5 * (first + second)

    def _contact(self, table: ToothTable, case: Case, found: dict[str, Any]) -> Any:
        """Return sigma_H^2 at w = K_v = K_H = Z_eps = Z_BD = 1."""
        beta = self.given.get("Z_beta", contact_factors.helix_factor(case.pair.pinion.helix_angle))
        product = self.given.get("Z_H", table.zone) * found["Z_E"] * beta
        ratio, d1 = case.pair.ratio, case.pair.pinion.reference_diameter
        return contact_factors.contact_stress(1.0, d1, 1.0, ratio, product) ** 2

    def _bending(self, table: ToothTable, case: Case, found: dict[str, Any]) -> tuple[Any, Any]:
        """Return sigma_F at w = K_v = K_F = f_eps = Y_beta = 1."""
        deep = bending.deep_tooth_factor(table.virtual, max(self.practice.grades))
        both = self.given.get("Y_DT", deep)
        rims = _two(self.given.get("Y_B", chain.LAWS["Y_B"](case, found)))
        forms = _two(self.given.get("Y_F", table.forms))
        shapes = _two(self.given.get("Y_S", table.concentrations))
        first, second = (
            bending.root_stress(
                1.0, 1.0, case.pair.normal_module, both * forms[k] * shapes[k] * rims[k]
            )
            for k in GEARS
        )
        return first, second


def _two(value: Any) -> Any:
    return value if isinstance(value, tuple | list) else (value, value)


def _notches(standard: Iso6336, table: ToothTable) -> tuple[Law, Callable[..., Any]]:
    """Return the laws of Y_deltarelT of reference and of static strength."""

    def reference(case: Case, found: dict[str, Any]) -> Any:
        rows = zip(standard.materials, table.notches, strict=True)
        return tuple(
            bending.notch_factor(bending.slip_layer(m.family, m.strength_for_notches), q)
            for m, q in rows
        )

    def static(case: Case, k: int) -> Any:
        shape = _two(standard.given.get("Y_S", table.concentrations))[k]
        material = standard.materials[k]
        return bending.static_notch_factor(material.family, shape, material.strength_for_notches)

    return reference, static


@dataclass(frozen=True)
class Strength:
    """The greatest sigma_HG or sigma_FG [MPa] of a gear at any speed between two ends.

    fixed: of what does not depend on the cycles; reference and static: other factors at the fast
    end; life: the given factor, or 0.
    """

    fixed: Any
    reference: Any
    static: Any
    life: Any
    member: int
    contact: bool
    curve: Curve

    def greatest(self, cases: tuple[Case, Case]) -> Any:
        """Return the greatest strength [MPa] at the cycles of cases: an upper bound.

        Life factors are those of the slow end, exponents of the better one.

        cases: at the slow and at the fast end.
        """
        slow, fast = cases
        life = self.curve.factor(slow.cycles[self.member])
        others = self._other(share_of_life(self.curve, life))
        if slow is not fast:
            other = self._other(reference_share(self.curve, fast.cycles[self.member]))
            others = np.maximum(others, other)
        return self.fixed * (self.life or life) * others

    def knots(self) -> list[Any]:
        """Return the greatest strength [MPa] at each knot of the life curve."""
        shares = [float(reference_share(self.curve, n)) for n in self.curve.cycles]
        rows = zip(self.curve.values, shares, strict=True)
        return [self.fixed * value * self._other(share) for value, share in rows]

    def _other(self, share: Any) -> Any:
        return self.reference**share * self.static ** (1.0 - share)


def _under_levels(strengths: list[Strength], name: str, cycles: Any) -> Columns:
    """Columns of `IsoRows` at numbers of cycles (levels, n), their names beginning with one.

    strengths: with the knots of one life curve, of which the greatest counts.
    """
    every = zip(*(strength.knots() for strength in strengths), strict=True)
    knots = [np.maximum.reduce(values) for values in every]
    curve = Curve(strengths[0].curve.cycles, tuple(knots))
    columns = {f"{name}_{place}": value for place, value in enumerate(knots)}
    for end, at in (("own", cycles), ("all", cycles.sum(axis=0))):
        strength = np.where(cycles > 0.0, curve.factor(at), np.inf)
        columns[f"{name}_{end}"] = strength**2 if strengths[0].contact else strength
    return columns


def _strength(
    standard: Iso6336,
    cases: tuple[Case, Case],
    table: ToothTable,
    member: int,
    contact: bool,
    found: dict[str, Any],
) -> Strength:
    """Return the strength of a gear; cases: at the slow and at the fast end."""
    given, slow = standard.given, cases[0]
    laws, static = _laws(standard, table, contact)
    names = chain.CONTACT_STRENGTH if contact else chain.BENDING_STRENGTH
    life = "Z_NT" if contact else "Y_NT"
    fixed, reference, still = 1.0, 1.0, 1.0
    for name in names:
        if name in given:
            fixed = fixed * (1.0 if name == life else _two(given[name])[member])
        elif name in laws:
            reference = reference * _two(laws[name](cases[1], found))[member]
            still = still * (static[name](slow, member) if name in static else 1.0)
        elif name != life:
            fixed = fixed * _two(found[name])[member]
    known = _two(given[life])[member] if life in given else 0.0
    curve = slow.curve(member, contact)
    return Strength(fixed, reference, still, known, member, contact, curve)


def _laws(
    standard: Iso6336, table: ToothTable, contact: bool
) -> tuple[dict[str, Law], dict[str, Callable[..., Any]]]:
    """Return the laws of factors of reference strength, and of those of static strength."""
    laws: dict[str, Law]
    if contact:
        laws = {
            "Z_L": chain.lubricant,
            "Z_v": chain.velocity,
            "Z_R": chain.roughness,
            "Z_W": chain.hardening,
        }
        return laws, {"Z_W": lambda case, k: chain.hardened(case, k, True)}
    notch, static = _notches(standard, table)
    laws = {"Y_deltarelT": notch, "Y_RrelT": chain.surfaces, "Y_X": chain.sizes}
    return laws, {"Y_deltarelT": static}
