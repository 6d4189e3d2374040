"""Keys of a stage with planets, or of a pinion in a ring."""

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, Any, Self

from pydantic import Field, PrivateAttr, create_model

from gearopt.formulations.drive.planetary import HELD, ORDERS
from gearopt.scenes.drive.tables.rating import GearTable
from gearopt.scenes.reading.fields import Table, advised, choice, number, quantity, truth, whole
from gearopt.scenes.reading.lists import one_or_several, several, span
from gearopt.units import Quantity

PARALLEL, PLANETARY, INTERNAL = TYPES = ("parallel", "planetary", "internal")
TYPE = advised(
    choice(*TYPES),
    {
        r"planeten\w*|umlauf\w*|epicycl\w*": 'Write type = "planetary"',
        r"innen\w*|hohlrad\w*|annul\w*": 'Write type = "internal"',
        r"stirnrad\w*|extern\w*|spur|helical": 'Write type = "parallel"',
    },
)
USUAL = (3, 3)  # planets
PLANETS = advised(whole(3, 1, 12), {"0": "Write planets = 3"})
REDUCTIONS = (Fraction(0), Fraction(1, 2), Fraction(1))  # by default
Teeth = tuple[int, int] | None


IN_PLANETS = (  # keys of a gear that sun, planets and ring have, too
    *("iso_material", "iso_quality", "iso_core", "flank_hardness", "yield_strength", "sigma_Hlim"),
    *("sigma_Flim", "flank_rz", "accuracy_grade", "root_rz", "addendum", "tip_chamfer"),
    *("tool_addendum", "tool_tip_radius", "tool_protuberance", "grinding_allowance", "steel"),
    *("treatment", "hardness", "elastic_modulus", "poisson_ratio", "roughness", "materials"),
    *("profile_shift", "tip_alteration", "thickness_allowance"),
    *("grade", "surface_hardness", "quality", "s_ac", "s_at"),
)


def _of_gear(*names: str) -> dict[str, Any]:
    """Fields of a gear by their names."""
    known = GearTable.model_fields
    return {name: (known[name].annotation, known[name]) for name in names}


class RingKeys(Table):
    """Keys of a ring: as of other gears, and of the pinion-type cutter that shapes it."""

    outside_diameter: Annotated[Quantity | None, quantity("length", "300 mm")] = Field(
        None, description="Outside diameter of the ring, instead of rim_over_module (3.5)"
    )
    cutter_teeth: Annotated[int | None, whole(30, 5, 500)] = Field(
        None,
        description="Number of teeth of the pinion-type cutter; without it the ring is cut by the "
        "counterpart of its basic rack",
    )
    cutter_profile_shift: Annotated[Fraction | None, number(0.1, -1, 1, zero=True)] = Field(
        None, description="Profile shift x_0 of the cutter; by default 0"
    )
    cutter_addendum: Annotated[Fraction | None, number(1.25, 0, 3)] = Field(
        None,
        description="Addendum h_a0 of the cutter, in normal modules; by default tool_addendum",
    )
    cutter_tip_radius: Annotated[Fraction | None, number(0.3, 0, 1, zero=True)] = Field(
        None,
        description="Radius rho_a0 of the rounds at the cutter's tips, in normal modules; by "
        "default 0",
    )


SunTable = create_model(
    "SunTable",
    __base__=Table,
    __doc__="Keys of a sun, or of a planet.",
    **_of_gear("bore", "hub_over_bore", *IN_PLANETS),
)
RingTable = create_model(
    "RingTable",
    __base__=RingKeys,
    __doc__=RingKeys.__doc__,
    **_of_gear("rim_over_module", *IN_PLANETS),
)


def gear_of(table: Table) -> GearTable:
    """The keys of a sun, planet or ring as those of a gear."""
    held = {name: value for name, value in table if name in GearTable.model_fields}
    return GearTable.model_construct(set(held) & table.model_fields_set, **held)


def bent(table: Table) -> GearTable:
    """The keys of a planet, whose teeth are bent both ways, as those of a gear."""
    gear = gear_of(table).model_copy(update={"reversed_load": True})
    object.__setattr__(gear, "__pydantic_fields_set__", table.model_fields_set)
    return gear


class PlanetaryKeys(Table):
    """What a stage has that is no pair of external gears."""

    type: Annotated[Any, one_or_several(TYPE)] = Field(  # a word, or a tuple of them
        PARALLEL,
        description="parallel: a pair of external gears; planetary: sun, planets and ring; "
        "internal: a pinion in a ring. Sized by ratings in whole teeth, or all given and rated. "
        "A list, of gears that are sized: the best of these types is found",
    )
    fixed: Annotated[str | None, choice(*HELD)] = Field(
        None,
        description="Member of a planetary stage that stands still: ring (by default; the ratio "
        "1 + z_r/z_s is that of sun to carrier), carrier (z_r/z_s, sun to ring, turning the other "
        "way) or sun (1 + z_s/z_r, ring to carrier)",
    )
    planets: Annotated[Teeth, span(PLANETS, [3, 5], single=True)] = Field(
        None, description="Number of planets, or a range to choose from; by default 3"
    )
    sun_teeth: Annotated[Teeth, span(whole(21, 5, 1000), [15, 30], single=True)] = Field(
        None, description="Number of teeth of the sun: fixed, or a range"
    )
    planet_teeth: Annotated[Teeth, span(whole(30, 5, 1000), [20, 50], single=True)] = Field(
        None, description="Number of teeth of a planet: fixed, or a range"
    )
    ring_teeth: Annotated[Teeth, span(whole(81, 10, 2000), [60, 140], single=True)] = Field(
        None, description="Number of teeth of the ring: fixed, or a range"
    )
    planet_teeth_reduction: Annotated[
        tuple[Fraction, ...] | None,
        several(number(0.5, 0, 10, zero=True), [0, 0.5, 1], single=True),
    ] = Field(
        None,
        description="By how many teeth a planet may be smaller than (z_r - z_s)/2: a multiple of "
        "0.5, or several to choose from; by default 0, 0.5 and 1",
    )
    mesh_load_factor: Annotated[Fraction | None, number(1.1, 1, 5)] = Field(
        None,
        description="K_gamma of both meshes; by default by the number of planets: 1.10, 1.25, "
        "1.35, 1.44 and 1.47 for 3 to 7 (practice of wind turbines; only 1.10 is printed in a "
        "report, the rest is unverified)",
    )
    planet_clearance: Annotated[Fraction | None, number(0.5, 0, 20, zero=True)] = Field(
        None,
        description="Smallest gap of the tip circles of neighbouring planets, in normal modules; "
        "by default 0.5 (a rule of thumb of this program)",
    )
    carrier_over_face_width: Annotated[Fraction | None, number(0.5, 0, 10)] = Field(
        None,
        description="Width of both cheeks of the carrier over the face width, which then count in "
        "volume and mass as solid discs, 0.7 d_p larger than the circle of the planets' axes; "
        "without it the carrier is left out",
    )
    mesh_order: Annotated[str | None, choice(*ORDERS)] = Field(
        None,
        description="How planets mesh: any (by default); simultaneous: z_s a multiple of their "
        "number; sequential: it is not; hunting: no common divisor in either mesh",
    )
    equally_spaced: Annotated[bool | None, truth()] = Field(
        None,
        description="Planets are equally spaced (by default), so that z_s + z_r is a multiple of "
        "their number; false: as nearly as teeth allow",
    )
    sun: SunTable = Field(default_factory=SunTable, description="Data of the sun alone")
    planet: SunTable = Field(default_factory=SunTable, description="Data of the planets alone")
    ring: RingTable = Field(default_factory=RingTable, description="Data of the ring alone")

    _mesh: Any = PrivateAttr(None)  # of a stage of which a mesh is rated: an `AsMesh`

    @property
    def as_mesh(self) -> Any:
        """What mesh of a stage is rated in its place, an `AsMesh`; None: it is a pair."""
        return self._mesh

    def rated_as(self, mesh: Any) -> Self:
        """The stage as one of its meshes."""
        copy = self.model_copy()
        copy._mesh = mesh
        return copy

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy, in which its gears stay what checks call pinion and wheel."""
        copy = super().model_copy(update=update, deep=deep)
        return copy.with_gears_named() if {*(update or ())} & {*OWN} else copy

    def with_gears_named(self) -> Self:
        """The stage with sun and planet, or the ring, as what checks call pinion and wheel."""
        named: dict[str, Any] = {}
        if self.type == PLANETARY:
            planet = bent(self.planet)
            named = {"pinion": gear_of(self.sun), "wheel": planet, "pinion_teeth": self.sun_teeth}
            named |= {"wheel_teeth": self.ring_teeth}
        elif self.type == INTERNAL:
            named = {"wheel": gear_of(self.ring), "wheel_teeth": self.ring_teeth}
        copy = super().model_copy(update=named)
        object.__setattr__(copy, "__pydantic_fields_set__", set(self.model_fields_set))
        return copy

    @property
    def types(self) -> tuple[str, ...]:
        """The types to choose from."""
        return self.type if isinstance(self.type, tuple) else (self.type,)

    @property
    def epicyclic(self) -> bool:
        """Whether the stage has planets or a ring."""
        return self.types != (PARALLEL,)

    @property
    def teeth_keys(self) -> tuple[str, str]:
        """Keys of the numbers of teeth that stand for those of pinion and wheel."""
        first = "sun_teeth" if self.type == PLANETARY else "pinion_teeth"
        return first, "ring_teeth" if self.epicyclic else "wheel_teeth"

    @property
    def counts(self) -> tuple[int, ...]:
        """Numbers of planets that it may have; 0: a pinion in a ring."""
        low, high = self.planets or USUAL
        return (0,) if self.type == INTERNAL else tuple(range(low, high + 1))

    @property
    def held(self) -> str:
        """The member that stands still."""
        return self.fixed or HELD[0]


OWN = tuple(name for name in PlanetaryKeys.model_fields if name != "type")
OF_INTERNAL = ("ring_teeth", "ring")  # of these, what a pinion in a ring has
