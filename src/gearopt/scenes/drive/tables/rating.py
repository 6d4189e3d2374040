"""Tables of a rating: materials and tools of gears, service, factors, loads."""

from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from gearopt.physics.agma.allowables import CONTACT, MODULI, TREATMENTS
from gearopt.physics.agma.bending import LOADS
from gearopt.physics.agma.factors import ALIGNMENT, QUALITIES
from gearopt.physics.agma.life import SERVICES
from gearopt.physics.agma.rating_factors import EDITIONS
from gearopt.physics.iso6336.load_factors import ARRANGEMENTS, Shaft
from gearopt.scenes.drive.tables.blanks import BlankKeys, beside
from gearopt.scenes.drive.tables.given import Given
from gearopt.scenes.drive.tables.iso6336 import ISO_KEYS, OWN, IsoGearKeys, IsoTable
from gearopt.scenes.drive.tables.steel_names import steel_name
from gearopt.scenes.reading.fields import (
    Table,
    advised,
    choice,
    number,
    quantity,
    refuse,
    truth,
    whole,
    words,
)
from gearopt.scenes.reading.lists import each_gear, several
from gearopt.units import Quantity

SURFACES = tuple(dict.fromkeys(surface for _, surface, _ in CONTACT if surface))
FACTOR = number(1.25, 0, 1000)
Number = Annotated[Fraction | None, FACTOR]
Numbers = Annotated[tuple[Fraction, Fraction] | None, each_gear(FACTOR)]
LOAD = number(1.25, 1, 1000)  # factors that by their definition only add to a load or a stress
Load = Annotated[Fraction | None, LOAD]
Loads = Annotated[tuple[Fraction, Fraction] | None, each_gear(LOAD)]
Stresses = Annotated[
    tuple[Quantity, Quantity] | None, each_gear(quantity("stress", "220 MPa", "10 GPa"))
]
KIND = ("steel", "treatment", "iso_material")  # keys of a gear that say what it is made of
OF_STEEL = (  # what a steel of the gear's own leaves of another one's
    *("grade", "hardness", "surface_hardness", "iso_quality", "iso_core", "flank_hardness"),
    *("yield_strength", "sigma_Hlim", "sigma_Flim", "s_ac", "s_at"),
)
STEEL = (*KIND, *OF_STEEL, "elastic_modulus", "poisson_ratio")  # what a material has of a gear
MATERIAL = tuple(  # keys of a gear that only a rating needs
    dict.fromkeys(
        (*STEEL, "roughness", "reversed_load", "contacts", "materials", "quality", *ISO_KEYS)
    )
)
MATERIALS = several(words(), ["case-hardened", "through-hardened"])
TREATMENT = choice(
    *TREATMENTS,
    means={
        "carburized": "carburised",
        "through hardened": "through-hardened",
        "quenched and tempered": "through-hardened",
        "einsatzgehärtet": "carburised",
        "einsatzgehaertet": "carburised",
        "vergütet": "through-hardened",
        "verguetet": "through-hardened",
        "nitriert": "nitrided",
    },
    other=dict.fromkeys(
        ("case hardened", "case-hardened", "surface hardened", "surface-hardened"),
        'Write "carburised"; or "nitrided", or "induction, roots" and "induction, flanks", which '
        "harden a case too",
    )
    | dict.fromkeys(
        ("induction", "induction hardened", "induction-hardened", "flame hardened"),
        'Write "induction, roots" where roots are hardened with the flanks, "induction, flanks" '
        "where they are not",
    ),
)
STEEL_NAME = steel_name()
HARDNESS = advised(
    quantity("hardness", "240 HB", "800 HB"),
    {
        r".*h(rc?|v|ra|r15n)\d*": "Brinell hardness is asked for, of through-hardened steel and of "
        "the core of nitrided steel. The strength of carburised and induction hardened steel "
        "follows from its grade: remove hardness",
    },
)
GRADE = advised(
    whole(1, 1, 3),
    {"m[lqe]": "AGMA has grades 1, 2 and 3; ML, MQ and ME are those of ISO 6336-5"},
)
SHIFT = advised(
    number(0.2, -3, 3, zero=True),
    {r".*\d\s*(mm|in)": "Write the coefficient x, the shift over the normal module"},
)
GRADES = "(?:a|iso|iso 1328|din|grade)[ -]*"
QUALITY = advised(
    number(8, int(QUALITIES[0]), int(QUALITIES[1]), scale=True),
    {
        f"{GRADES}{grade}": "Q_v grows with accuracy. A grade of AGMA 2015 or ISO 1328, which "
        f"falls, is about A_v: write accuracy = {grade} instead of quality"
        for grade in range(6, 13)
    }
    | {
        f"{GRADES}[1-5]|1[2-9]": "So accurate gears have no curve of K_v: write quality = 11, or "
        "give K_v in [rating.given]",
    },
)
STANDARD = advised(
    choice("agma", "iso6336", "both", means={"AGMA": "agma", "ISO 6336": "iso6336"}),
    {
        "din.*": 'DIN 3990 is not supported. Nearest: standard = "iso6336"',
        ".*(agma.*iso|iso.*agma).*": 'Write standard = "both"',
        "iso.*": 'Write standard = "iso6336"; [rating.iso6336] has its edition',
        ".*agma.*": 'Write standard = "agma"; edition = "D04" or "B88" says which',
    },
)

EDITION = advised(
    choice(*EDITIONS),
    {
        "2006|2019": "edition of [rating] is that of AGMA 2001; that of ISO 6336 is edition of "
        "[rating.iso6336]",
    },
)


class GearKeys(BlankKeys, IsoGearKeys):
    """What gears share unless they have their own: the tool that cuts them, and their steel."""

    addendum: Annotated[Fraction | None, number(1.0, 0, 3)] = Field(
        None, description="Addendum of the basic rack, in normal modules; by default 1"
    )
    tip_chamfer: Annotated[Fraction | None, number(0.05, 0, 1, zero=True)] = Field(
        None,
        description="Radial height of the chamfer or round of the tips, in normal modules: contact "
        "ends below it, at the tip form diameter d_Na; by default 0",
    )
    tool_addendum: Annotated[Fraction | None, number(1.25, 0, 3)] = Field(
        None, description="Addendum of the tool, in normal modules; by default 1.25 (ISO 53 A)"
    )
    tool_tip_radius: Annotated[Fraction | None, number(0.38, 0, 1, zero=True)] = Field(
        None, description="Tip radius of the tool, in normal modules; by default 0.38 (ISO 53 A)"
    )
    tool_protuberance: Annotated[Fraction | None, number(0.02, 0, 1, zero=True)] = Field(
        None,
        description="Protuberance of the tool in normal modules; by default 0",
    )
    grinding_allowance: Annotated[Fraction | None, number(0.02, 0, 1, zero=True)] = Field(
        None,
        description="Stock q that grinding takes off a flank, in normal modules, of the "
        "protuberance: the rest is the undercut of the finished tooth; by default 0",
    )
    steel: Annotated[str | None, STEEL_NAME] = Field(
        None,
        description="Steel or iron by name or number (gearopt materials lists them), which sets "
        "treatment, grade, hardness and the material of ISO 6336-5 where these are not given",
    )
    treatment: Annotated[str | None, TREATMENT] = Field(
        None,
        description="Heat treatment of the steel, or iron by ASTM; a rating needs it (or steel)",
    )
    grade: Annotated[int | None, GRADE] = Field(
        None, description="Metallurgical grade of AGMA; by default 1"
    )
    hardness: Annotated[Quantity | None, HARDNESS] = Field(
        None,
        description="Brinell hardness of through-hardened steel; of nitrided steel its core",
    )
    surface_hardness: Annotated[str | None, choice(*SURFACES)] = Field(
        None,
        description="Hardness of nitrided and induction hardened flanks; by default the lower one "
        "of the tables",
    )
    s_ac: Annotated[Quantity | None, OWN] = Field(
        None,
        description="Allowable contact stress number of its own, instead of the tables of AGMA",
    )
    s_at: Annotated[Quantity | None, OWN] = Field(
        None,
        description="Allowable bending stress number of its own, instead of the tables of AGMA",
    )
    elastic_modulus: Annotated[Quantity | None, quantity("stress", "206 GPa")] = Field(
        None, description="Modulus of elasticity; by default 206 GPa, of irons by ASTM less"
    )
    poisson_ratio: Annotated[Fraction | None, number(0.3, 0, Fraction(1, 2), zero=True)] = Field(
        None, description="Poisson's ratio; by default 0.3"
    )
    roughness: Annotated[Quantity | None, quantity("length", "0.8 um", "100 um")] = Field(
        None,
        description="Arithmetic roughness R_a of the flanks, for friction by oil_viscosity, C_H, "
        "and R_z where flank_rz is not given; by default 0.8 um",
    )
    reversed_load: Annotated[bool | None, truth()] = Field(
        None, description="The load reverses, as on idlers: 0.7 of the bending strength"
    )
    contacts: Annotated[int | None, whole(1, 1, 100)] = Field(
        None, description="Load cycles of a tooth per revolution; by default 1"
    )
    quality: Annotated[Fraction | None, QUALITY] = Field(
        None,
        description="Q_v of this gear, the lower of a pair counts; by default that of [rating]",
    )
    materials: Annotated[tuple[str, ...] | None, MATERIALS] = Field(
        None,
        description="Names of [[material]], of which the best one is chosen, instead of a steel",
    )

    @property
    def modulus(self) -> float | None:
        """Modulus of elasticity [MPa]; None: that of steel."""
        own = self.elastic_modulus
        return own.value if own else MODULI.get(self.treatment or "")


class GearTable(GearKeys):
    """Keys of one gear, [stage.pinion] or [stage.wheel]: width, shift, tool, material, body."""

    face_width: Annotated[Quantity | None, quantity("length", "45 mm")] = Field(
        None, description="Face width of this gear, where all are given; by default the stage's"
    )
    profile_shift: Annotated[Fraction | None, SHIFT] = Field(
        None, description="Profile shift coefficient x; by default 0"
    )
    tip_alteration: Annotated[Fraction | None, number(-0.05, -2, 2, zero=True)] = Field(
        None, description="Tip alteration coefficient k, negative: shorter teeth; by default 0"
    )
    thickness_allowance: Annotated[
        Quantity | None, quantity("length", "-0.05 mm", zero=True, signed=True)
    ] = Field(
        None,
        description="Allowance of the normal tooth thickness, negative: thinner; by default 0",
    )

    @model_validator(mode="after")
    def _thinner(self) -> "GearTable":
        allowance = self.thickness_allowance
        if allowance is not None and allowance.number > 0:
            rule = "is above zero: teeth are thinned, not thickened"
            raise refuse(rule, f"-{allowance}", ("thickness_allowance",))
        return self


def _said_by(name: str) -> tuple[str, ...]:
    """Keys of a gear that say the same as one, or take its place."""
    if name == "steel":
        return KIND
    return (*beside(name), *(("steel",) if name in (*KIND, *OF_STEEL) else ()))


SAID_BY = tuple((name, _said_by(name)) for name in GearKeys.model_fields)


def with_shared(own: GearTable, shared: GearKeys) -> GearTable:
    """Keys of a gear: its own, else those of all gears."""
    absent = {name for name, value in vars(own).items() if value is None}
    of_all = vars(shared)
    taken = {name: of_all[name] for name, same in SAID_BY if absent.issuperset(same)}
    return own.model_copy(update=taken)


class GivenTable(Given):
    """Factors instead of computed ones; [pinion, wheel], or one value for both."""

    K_o: Load = Field(None, description="Overload factor")
    K_v: Load = Field(
        None,
        description="Dynamic factor, 1 or more (C_v of editions before 1995 is its reciprocal)",
    )
    K_m: Load = Field(None, description="Load distribution factor")
    K_R: Number = Field(None, description="Reliability factor")
    K_T: Load = Field(None, description="Temperature factor")
    C_f: Load = Field(None, description="Surface condition factor")
    C_p: Annotated[Quantity | None, quantity("elastic coefficient", "190 sqrt(MPa)")] = Field(
        None, description="Elastic coefficient"
    )
    I: Number = Field(None, description="Geometry factor of pitting resistance")  # noqa: E741
    K_s: Loads = Field(None, description="Size factor")
    K_B: Loads = Field(None, description="Rim thickness factor")
    J: Numbers = Field(None, description="Geometry factor of bending strength")
    s_at: Stresses = Field(None, description="Allowable bending stress number")
    s_ac: Stresses = Field(None, description="Allowable contact stress number")
    Y_N: Numbers = Field(None, description="Stress cycle factor of bending")
    Z_N: Numbers = Field(None, description="Stress cycle factor of pitting")
    C_H: Numbers = Field(None, description="Hardness ratio factor")


OF_STAGE = ("overload_factor", "minimum_bending_safety", "minimum_contact_safety", "shaft")  # too


class ShaftTable(Table):
    """Where a pinion is on its shaft: K_Hbeta of ISO 6336, and K_m of AGMA beside it."""

    span: Annotated[Quantity, quantity("length", "200 mm")] = Field(description="Bearing span l")
    offset: Annotated[Quantity, quantity("length", "30 mm", zero=True)] = Field(
        description="Distance s of the pinion from the middle of the bearings"
    )
    diameter: Annotated[Quantity, quantity("length", "45 mm")] = Field(description="Diameter d_sh")
    arrangement: Annotated[str, choice(*ARRANGEMENTS)] = Field(
        "a",
        description="K' by figure 13 of ISO 6336-1: a, b between bearings, off towards the end "
        "with torque or the other one; c overhung; d, e as drawn there",
    )
    stiffened: Annotated[bool, truth()] = Field(
        True, description="The pinion stiffens its shaft, where d1 >= 1.15 d_sh"
    )

    @property
    def made(self) -> Shaft:
        """The shaft in plain numbers [mm]."""
        lengths = self.span.value, self.offset.value, self.diameter.value
        return Shaft(*lengths, self.arrangement, self.stiffened)

    @property
    def share(self) -> Fraction:
        """The offset over the span, S_1/S."""
        return self.offset.exact[0] / self.span.exact[0]

    @model_validator(mode="after")
    def _between(self) -> "ShaftTable":
        if self.share >= Fraction(1, 2):
            fifth = str(self.span.of(self.span.exact[0] / 5))
            raise refuse("is half of the span or more", fifth, ("offset",), "sample")
        return self


class RatingTable(Table):
    """How the gears are rated: standard, service, quality, mounting, oil."""

    standard: Annotated[str, STANDARD] = Field(
        "agma",
        description="agma: ANSI/AGMA 2001 (2101) with AGMA 908; iso6336: ISO 6336; both: side by "
        "side",
    )
    edition: Annotated[str, EDITION] = Field(
        "D04", description="Edition of AGMA 2001: rim factors and strengths differ"
    )
    life: Annotated[Quantity | None, quantity("time", "20000 h", "1e9 h")] = Field(
        None, description="Life at this duty (or give input_revolutions)"
    )
    input_revolutions: Annotated[Fraction | None, number(1e8, 1, 10**15)] = Field(
        None, description="Life as revolutions of the input shaft"
    )
    reliability: Annotated[Fraction, number("99 %", 0, 1, percent=True)] = Field(
        default_factory=lambda: Fraction(99, 100),
        description="Reliability, from 50 % to 99.99 %",
        json_schema_extra={"default": "99 %"},
    )
    overload_factor: Annotated[Fraction, number(1.25, 1, 10)] = Field(
        default_factory=lambda: Fraction(1),
        description="K_o: loads beyond the nominal one, of driving and driven machine",
        json_schema_extra={"default": 1},
    )
    temperature: Annotated[
        Quantity | None, quantity("temperature", "80 degC", zero=True, signed=True)
    ] = Field(
        None, description="Temperature of the gear blanks; by default below 120 degC, K_T = 1"
    )
    quality: Annotated[Fraction | None, QUALITY] = Field(
        None,
        description="Transmission accuracy Q_v of AGMA 2001-C95, larger is better: sets K_v (or "
        "give accuracy)",
    )
    accuracy: Annotated[Fraction | None, number(9, 6, 12, scale=True)] = Field(
        None, description="Transmission accuracy A_v of AGMA 2001-D04, smaller is better: 17 - Q_v"
    )
    mounting: Annotated[str, choice(*ALIGNMENT)] = Field(
        "commercial", description="Housing, as its curve of mesh alignment in K_m"
    )
    crowned: Annotated[bool, truth()] = Field(False, description="Teeth are crowned (K_m)")
    adjusted: Annotated[bool, truth()] = Field(
        False, description="Contact is improved at assembly, by lapping or adjusting (K_m)"
    )
    pinion_offset: Annotated[Fraction, number(0.1, 0, Fraction(1, 2), zero=True)] = Field(
        default_factory=lambda: Fraction(0),
        description="S_1/S: offset of the pinion from mid-span over bearing span (K_m)",
        json_schema_extra={"default": 0},
    )
    size_factor: Annotated[str, choice("one", "shigley")] = Field(
        "one", description="K_s: 1, as the standard allows, or Shigley's formula"
    )
    bending_load: Annotated[str, choice(*LOADS)] = Field(
        "highest single",
        description="Where the load of J acts on spur teeth: highest point of single tooth "
        "contact, or tip",
    )
    service: Annotated[str, choice(*SERVICES)] = Field(
        "general", description="Branch of the life curves beyond 1e7 cycles"
    )
    minimum_bending_safety: Annotated[Fraction, number(1.2, 0, 100)] = Field(
        default_factory=lambda: Fraction(1),
        description="Required safety factor against bending",
        json_schema_extra={"default": 1},
    )
    minimum_contact_safety: Annotated[Fraction, number(1.1, 0, 100)] = Field(
        default_factory=lambda: Fraction(1),
        description="Required safety factor against pitting, of stress: its square is of load",
        json_schema_extra={"default": 1},
    )
    static_torque_factor: Annotated[Fraction | None, number(2.5, 1, 100)] = Field(
        None,
        description="Peak torque, of starting or of a seldom overload, over the torque of the "
        "duty: takes the place of K_A against static strength (ISO 6336 alone)",
    )
    minimum_static_bending_safety: Annotated[Fraction | None, number(1.5, 0, 100)] = Field(
        None, description="Required safety factor of static bending strength; by default 1"
    )
    minimum_static_contact_safety: Annotated[Fraction | None, number(1.2, 0, 100)] = Field(
        None, description="Required safety factor of static contact strength; by default 1"
    )
    friction_coefficient: Annotated[Fraction | None, number(0.05, 0, 1)] = Field(
        None, description="Mean coefficient of friction of a mesh, for its efficiency"
    )
    oil_viscosity: Annotated[Quantity | None, quantity("viscosity", "40 mPa s")] = Field(
        None,
        description="Dynamic viscosity of the oil at its temperature, from which the friction is "
        "computed",
    )
    shaft: ShaftTable | None = Field(None, description="Where every pinion is on its shaft")
    given: GivenTable = Field(
        default_factory=GivenTable, description="Factors of all stages, instead of computed ones"
    )
    iso6336: IsoTable = Field(
        default_factory=IsoTable, description="Further data of a rating by ISO 6336"
    )

    @property
    def by_agma(self) -> bool:
        """Return whether AGMA is a standard of the rating."""
        return self.standard != "iso6336"

    @property
    def by_iso6336(self) -> bool:
        """Whether ISO 6336 is a standard, or the only one, that rates."""
        return self.standard != "agma"

    @model_validator(mode="after")
    def _one_of_two(self) -> "RatingTable":
        conflicts = {
            "input_revolutions": ("life", "; one is enough"),
            "friction_coefficient": ("oil_viscosity", ", from which it is computed"),
            "accuracy": ("quality", "; one is enough"),
            "pinion_offset": ("shaft", ", whose offset over span it is"),
        }
        for name, (other, why) in conflicts.items():
            if {name, other} <= self.model_fields_set:
                raise refuse(f"conflicts with {other}{why}", at=(name,), action="remove")
        if self.life is None and self.input_revolutions is None:
            raise refuse("is missing (or give input_revolutions)", "20000 h", ("life",), "sample")
        bare = self.quality is None and self.accuracy is None and self.given.K_v is None
        if bare and self.by_agma:
            raise refuse("is missing (or give accuracy)", 8, ("quality",), "sample")
        self._check_static()
        if not Fraction(1, 2) <= self.reliability <= Fraction(9999, 10000):
            raise refuse("is not from 50 % to 99.99 %", "99 %", ("reliability",), "sample")
        return self

    def _check_static(self) -> None:
        """Refuse a peak torque without ISO 6336, and safety factors without a peak torque."""
        if self.static_torque_factor is not None and not self.by_iso6336:
            rule = "is rated by ISO 6336 alone, not by AGMA"
            tell = 'Write standard = "both" or "iso6336", or remove static_torque_factor'
            raise refuse(rule, tell, ("static_torque_factor",), "tell")
        for name in ("minimum_static_bending_safety", "minimum_static_contact_safety"):
            if self.static_torque_factor is None and getattr(self, name) is not None:
                rule = f"is missing: {name} is of a peak torque"
                raise refuse(rule, 2.5, ("static_torque_factor",), "sample")


class LoadTable(Table):
    """One level of a load spectrum; without any the drive runs at the duty's power."""

    power: Annotated[Quantity, quantity("power", "5 kW")] = Field(
        description="Power at the input shaft"
    )
    input_speed: Annotated[Quantity | None, quantity("speed", "1450 rpm")] = Field(
        None, description="Speed of the input shaft; by default the duty's"
    )
    share: Annotated[Fraction, number("20 %", 0, 1, percent=True)] = Field(
        description="Share of the life; those of all levels add up to 100 %"
    )
