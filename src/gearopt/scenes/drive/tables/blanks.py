"""The bodies of gears in a file: keys of rim, web, bore and hub; checks; flaws."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field, model_validator

from gearopt.physics.blanks import HUB, THIN, Blank
from gearopt.physics.gears import MEMBERS, Gear, GearPair
from gearopt.physics.geometry.flaws import ROUNDING, Flaw
from gearopt.scenes.reading.fields import Table, number, quantity, refuse
from gearopt.units import Quantity

RIM = ("rim_thickness", "rim_over_module")  # two ways of saying one thing
WEB = ("web_thickness", "web_over_face_width")
HUBS = "hub_over_bore"
THINNEST = Fraction(11, 10)  # hub over its bore

Length = Annotated[Quantity | None, quantity("length", "12 mm")]
Place = tuple[Any, ...]


class BlankKeys(Table):
    """What is left of a gear below its teeth; by default it is a solid disc."""

    _kept: bool = False  # the bore is that of a gear that is given, not of those that have room
    rim_thickness: Length = Field(
        None,
        description="Thickness of the rim below the root circle, for K_B and Y_B; where it does "
        "not fit around the hub, and without it, the gear is solid",
    )
    rim_over_module: Annotated[Fraction | None, number(3, 0, 100)] = Field(
        None, description="Rim thickness in normal modules, instead of rim_thickness"
    )
    web_thickness: Length = Field(
        None,
        description="Thickness of the web between rim and hub, for the mass and C_R, of a stage "
        "whose face_width is given; by default the face width",
    )
    web_over_face_width: Annotated[Fraction | None, number(0.3, 0, 2)] = Field(
        None, description="Web thickness over the face width, instead of web_thickness"
    )
    bore: Annotated[Quantity | None, quantity("length", "40 mm", zero=True)] = Field(
        None,
        description="Diameter of the bore; a gear whose hub would not lie inside its root circle "
        "is solid, as on a pinion shaft, but for a given gear with a bore of its own and no "
        "hub_over_bore. By default 0",
    )
    hub_over_bore: Annotated[Fraction | None, number(1.6, 1, 10)] = Field(
        None,
        description=f"Diameter of the hub over the bore; by default {HUB}. Of a gear without a "
        "rim it only decides whether the bore has room inside the root circle",
    )

    @model_validator(mode="after")
    def _one_way(self) -> "BlankKeys":
        for first, second in (RIM, WEB):
            if getattr(self, first) is not None and getattr(self, second) is not None:
                raise refuse(
                    f"conflicts with {first}; one is enough", at=(second,), action="remove"
                )
        if self.hub_over_bore is not None and self.hub_over_bore < THINNEST:
            rule = f"leaves the hub hardly a wall: {float(THINNEST):g} is the least"
            raise refuse(rule, HUB, (HUBS,), "sample")
        return self

    @property
    def rimmed(self) -> bool:
        """Return whether it says how thick a rim is."""
        return any(getattr(self, key) is not None for key in RIM)


def beside(key: str) -> tuple[str, ...]:
    """Return the keys that say the same as one, itself first."""
    other = next((way for way in (RIM, WEB) if key in way), (key,))
    return (key, *(name for name in other if name != key))


def blank(table: BlankKeys, face_width: float | None) -> Blank:
    """Blank of a gear by its table; face_width [mm], where it is given."""
    web = table.web_over_face_width
    thick = 1.0 if web is None else float(web)
    if table.web_thickness is not None and face_width:
        thick = table.web_thickness.value / face_width
    rim, hub = table.rim_over_module, table.hub_over_bore
    return Blank(
        None if rim is None else float(rim),
        table.rim_thickness.value if table.rim_thickness else None,
        thick,
        table.bore.value if table.bore else 0.0,
        HUB if hub is None else float(hub),
        table._kept and hub is None,
    )


def check_blanks(tables: Sequence[tuple[Place, BlankKeys, BlankKeys, bool]]) -> None:
    """Refuse webs without rims, hubs without bores, and webs in mm of unknown face widths.

    tables: of every gear the place of its own keys, these, those with what all gears share, and
    whether its face width is to be chosen.
    """
    rims = any(table.rimmed for _, _, table, _ in tables)
    bores = any(table.bore for _, _, table, _ in tables)
    for place, keys, table, open_width in tables:

        def at(key: str, place: Place = place, own: BlankKeys = keys) -> Place:
            return (*place, key) if getattr(own, key) is not None else ("gears", key)

        web = next((key for key in WEB if getattr(table, key) is not None), None)
        if web and not (table.rimmed or rims and at(web)[0] == "gears"):
            rim = RIM[WEB.index(web)]
            rule = f"is missing (or give {RIM[1 - RIM.index(rim)]}): a gear with a web has a rim"
            raise refuse(rule, "12 mm" if rim == RIM[0] else 3, (*at(web)[:-1], rim), "sample")
        idle = not (table.bore or bores and at(HUBS)[0] == "gears")
        if table.hub_over_bore is not None and idle:
            raise refuse("needs bore, which the hub surrounds", at=at(HUBS), action="remove")
        if web == WEB[0] and open_width:
            rule = "is a length, and the face width of its gear is to be chosen"
            tell = (
                "Write web_over_face_width = 0.3, or give the stage a face_width that its gear has"
            )
            raise refuse(rule, tell, at(web), "tell")


def body_flaws(
    blanks: Sequence[tuple[Blank, Blank]],
    pairs: Sequence[GearPair],
    bored: Sequence[tuple[bool, bool]] = (),
    named: Sequence[Any] = (),
) -> Iterator[Flaw]:
    """Yield flaws of the bodies of a design, of floats: rims and bores that have no room.

    bored: of which gears (pinion and wheel of every stage) the file has the bore. One that leaves
    too little wall is a misfit there; a bore of all gears leaves small ones solid. named:
    the `MeshName` of each, by default those of stages.
    """
    for k, (both, pair) in enumerate(zip(blanks, pairs, strict=True)):
        called, stage = (named[k].gears, named[k].stage) if named else (MEMBERS, k + 1)
        for i, (member, shape, gear) in enumerate(zip(called, both, pair.gears, strict=True)):
            name, body = f"{member} of stage {stage}", shape.body(gear)
            root = float(gear.root_diameter)
            if shape.bore and not body.bore:
                yield _no_bore(shape, gear, name, bool(bored and bored[k][i]))
            elif body.bore and shape.kept and not body.rim_thickness and shape.hub >= root:
                wall = 0.5 * (root - body.bore)
                text = (
                    f"The usual hub of the {name}, {shape.hub:.4g} mm, has no room inside the root "
                    f"circle of {root:.4g} mm: the wall of {wall:.3g} mm around its bore, "
                    f"{float(shape.backup(gear)):.3g} of the whole depth, is rated as its rim."
                )
                yield Flaw("no hub", text)
            elif shape.has_rim and not body.rim_thickness:
                inside = f"{float(shape.inside(gear)):.4g} mm inside its rim"
                hub = f" for a hub of {shape.hub:.4g} mm" if shape.bore else ""
                yield Flaw("no web", f"The {name} has no web: {inside} leave no room{hub}.")


def _no_bore(shape: Blank, gear: Gear, name: str, own: bool) -> Flaw:
    """The flaw of a gear whose bore is left out; own: it is the gear's, which then does not fit."""
    root = largest = float(gear.root_diameter)
    circle = f"inside the root circle of {root:.4g} mm"
    text = f"The bore of the {name}, {shape.bore:.4g} mm, leaves"
    if shape.bore >= root:
        text += f" nothing {circle}; it is rated as solid."
    elif shape.kept:
        largest -= THIN * (float(gear.tip_diameter) - root)
        text += (
            f" a wall of {0.5 * (root - shape.bore):.3g} mm {circle}; it is rated as solid. Up to "
            f"{THIN:g} of the whole depth no standard has a rim factor: the bore has to stay below "
            f"{largest:.4g} mm."
        )
    else:
        text = f"The {name} is solid, without its bore: a hub of {shape.hub:.4g} mm does not lie "
        text += f"{circle}."
    wide = (shape.bore - largest) / gear.normal_module if own else -1.0
    equal = 2.0 * ROUNDING  # a bore as wide as the root circle does not fit either
    return Flaw("no bore", text, misfit=max(0.0, wide + equal))
