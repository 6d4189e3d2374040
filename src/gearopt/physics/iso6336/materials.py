"""Strengths of materials by ISO 6336-5, table 1, and their families in parts 1 to 3."""

from gearopt.frozen import dataclass

LINES: tuple[tuple[str, str, str, str, float, float, float, float], ...] = (
    ("St", "H", "ML/MQ", "", 1.0, 190.0, 110.0, 210.0),
    ("St", "H", "ME", "", 1.52, 250.0, 110.0, 210.0),
    ("St", "F", "ML/MQ", "", 0.455, 69.0, 110.0, 210.0),
    ("St", "F", "ME", "", 0.386, 147.0, 110.0, 210.0),
    ("St cast", "H", "ML/MQ", "", 0.986, 131.0, 140.0, 210.0),
    ("St cast", "H", "ME", "", 1.143, 237.0, 140.0, 210.0),
    ("St cast", "F", "ML/MQ", "", 0.313, 62.0, 140.0, 210.0),
    ("St cast", "F", "ME", "", 0.254, 137.0, 140.0, 210.0),
    ("GTS", "H", "ML/MQ", "", 1.371, 143.0, 135.0, 250.0),
    ("GTS", "H", "ME", "", 1.333, 267.0, 175.0, 250.0),
    ("GGG", "H", "ML/MQ", "", 1.434, 211.0, 175.0, 300.0),
    ("GGG", "H", "ME", "", 1.5, 250.0, 200.0, 300.0),
    ("GG", "H", "ML/MQ", "", 1.033, 132.0, 150.0, 240.0),
    ("GG", "H", "ME", "", 1.465, 122.0, 175.0, 275.0),
    ("GTS", "F", "ML/MQ", "", 0.345, 77.0, 135.0, 250.0),
    ("GTS", "F", "ME", "", 0.403, 128.0, 175.0, 250.0),
    ("GGG", "F", "ML/MQ", "", 0.35, 119.0, 175.0, 300.0),
    ("GGG", "F", "ME", "", 0.38, 134.0, 200.0, 300.0),
    ("GG", "F", "ML/MQ", "", 0.256, 8.0, 150.0, 240.0),
    ("GG", "F", "ME", "", 0.2, 53.0, 175.0, 275.0),
    ("V carbon", "H", "ML", "", 0.963, 283.0, 135.0, 210.0),
    ("V carbon", "H", "MQ", "", 0.925, 360.0, 135.0, 210.0),
    ("V carbon", "H", "ME", "", 0.838, 432.0, 135.0, 210.0),
    ("V alloy", "H", "ML", "", 1.313, 188.0, 200.0, 360.0),
    ("V alloy", "H", "MQ", "", 1.313, 373.0, 200.0, 360.0),
    ("V alloy", "H", "ME", "", 2.213, 260.0, 200.0, 390.0),
    ("V carbon", "F", "ML", "", 0.25, 108.0, 115.0, 215.0),
    ("V carbon", "F", "MQ", "", 0.24, 163.0, 115.0, 215.0),
    ("V carbon", "F", "ME", "", 0.283, 202.0, 115.0, 215.0),
    ("V alloy", "F", "ML", "", 0.423, 104.0, 200.0, 360.0),
    ("V alloy", "F", "MQ", "", 0.425, 187.0, 200.0, 360.0),
    ("V alloy", "F", "ME", "", 0.358, 231.0, 200.0, 390.0),
    ("V cast carbon", "H", "ML/MQ", "", 0.831, 300.0, 130.0, 215.0),
    ("V cast carbon", "H", "ME", "", 0.951, 345.0, 130.0, 215.0),
    ("V cast alloy", "H", "ML/MQ", "", 1.276, 298.0, 200.0, 360.0),
    ("V cast alloy", "H", "ME", "", 1.35, 356.0, 200.0, 360.0),
    ("V cast carbon", "F", "ML/MQ", "", 0.224, 117.0, 130.0, 215.0),
    ("V cast carbon", "F", "ME", "", 0.286, 167.0, 130.0, 215.0),
    ("V cast alloy", "F", "ML/MQ", "", 0.364, 161.0, 200.0, 360.0),
    ("V cast alloy", "F", "ME", "", 0.356, 186.0, 200.0, 360.0),
    ("Eh", "H", "ML", "", 0.0, 1300.0, 600.0, 800.0),
    ("Eh", "H", "MQ", "", 0.0, 1500.0, 660.0, 800.0),
    ("Eh", "H", "ME", "", 0.0, 1650.0, 660.0, 800.0),
    ("Eh", "F", "ML", "", 0.0, 312.0, 600.0, 800.0),
    ("Eh", "F", "MQ", "25 HRC", 0.0, 425.0, 660.0, 800.0),
    ("Eh", "F", "MQ", "25 HRC, Jominy", 0.0, 461.0, 660.0, 800.0),
    ("Eh", "F", "MQ", "30 HRC", 0.0, 500.0, 660.0, 800.0),
    ("Eh", "F", "ME", "", 0.0, 525.0, 660.0, 800.0),
    ("IF", "H", "ML", "", 0.74, 602.0, 485.0, 615.0),
    ("IF", "H", "MQ", "", 0.541, 882.0, 500.0, 615.0),
    ("IF", "H", "ME", "", 0.505, 1013.0, 500.0, 615.0),
    ("IF", "F", "ML", "", 0.305, 76.0, 485.0, 615.0),
    ("IF", "F", "MQ", "", 0.138, 290.0, 500.0, 570.0),
    ("IF", "F", "MQ", "", 0.0, 369.0, 570.0, 615.0),
    ("IF", "F", "ME", "", 0.271, 237.0, 500.0, 615.0),
    ("NT", "H", "ML", "", 0.0, 1125.0, 650.0, 900.0),
    ("NT", "H", "MQ", "", 0.0, 1250.0, 650.0, 900.0),
    ("NT", "H", "ME", "", 0.0, 1450.0, 650.0, 900.0),
    ("NV", "H", "ML", "", 0.0, 788.0, 450.0, 650.0),
    ("NV", "H", "MQ", "", 0.0, 998.0, 450.0, 650.0),
    ("NV", "H", "ME", "", 0.0, 1217.0, 450.0, 650.0),
    ("NT", "F", "ML", "", 0.0, 270.0, 650.0, 900.0),
    ("NT", "F", "MQ", "", 0.0, 420.0, 650.0, 900.0),
    ("NT", "F", "ME", "", 0.0, 468.0, 650.0, 900.0),
    ("NV", "F", "ML", "", 0.0, 258.0, 450.0, 650.0),
    ("NV", "F", "MQ", "", 0.0, 363.0, 450.0, 650.0),
    ("NV", "F", "ME", "", 0.0, 432.0, 450.0, 650.0),
    ("NV nitrocarburised", "H", "ML", "", 0.0, 650.0, 300.0, 650.0),
    ("NV nitrocarburised", "H", "MQ/ME", "", 1.167, 425.0, 300.0, 450.0),
    ("NV nitrocarburised", "H", "MQ/ME", "", 0.0, 950.0, 450.0, 650.0),
    ("NV nitrocarburised", "F", "ML", "", 0.0, 224.0, 300.0, 650.0),
    ("NV nitrocarburised", "F", "MQ/ME", "", 0.653, 94.0, 300.0, 450.0),
    ("NV nitrocarburised", "F", "MQ/ME", "", 0.0, 388.0, 450.0, 650.0),
)


QUALITIES = ("ML", "MQ", "ME")
CORES = ("25 HRC", "25 HRC, Jominy", "30 HRC")  # of Eh, quality MQ, bending
MATERIALS = tuple(dict.fromkeys(line[0] for line in LINES)) + ("GGG ferritic",)
# family: whose life curves, running-in, notch and size factors a material has
FAMILIES = {name: name for name in MATERIALS} | {
    "St cast": "St",
    **dict.fromkeys(("V carbon", "V alloy", "V cast carbon", "V cast alloy"), "V"),
}
SURFACE_HARDENED = ("Eh", "IF", "NT", "NV", "NV nitrocarburised")
VICKERS_TENSILE = 3.2  # MPa of tensile strength a unit of hardness; unverified: of no text at hand
YIELD_RATIO = {"St": 0.55, "V": 0.75}  # of yield point and tensile strength; unverified, memory


@dataclass(frozen=True)
class Material:
    """A gear's material: name of MATERIALS, quality of QUALITIES, surface hardness.

    hardness: Brinell of St, St cast, GTS, GGG, GG, else Vickers; core: of CORES, for Eh.
    yield_strength: yield point sigma_S or 0.2 % proof stress [MPa] of St and V, tensile strength of
    GG and GGG ferritic; 0: estimated. modulus E [MPa], poisson nu, density [t/mm3]; flank and root:
    roughness R_z [mm]; reversed_load: of idlers, 0.7 of sigma_Flim; limits: its own sigma_Hlim and
    sigma_Flim [MPa], 0: those of table 1.
    """

    name: str = "Eh"
    quality: str = "MQ"
    hardness: float = 0.0
    core: str = "25 HRC"
    yield_strength: float = 0.0
    modulus: float = 206000.0
    poisson: float = 0.3
    density: float = 7.83e-9
    flank: float = 4.8e-3
    root: float = 20e-3
    reversed_load: bool = False
    limits: tuple[float, float] = (0.0, 0.0)

    def own(self, stress: str) -> float:
        """Its own sigma_Hlim ("H") or sigma_Flim ("F") [MPa], 0 where it has none."""
        return self.limits[stress == "F"]

    @property
    def family(self) -> str:
        """Family of FAMILIES; ValueError for a material that is not known."""
        if self.name not in FAMILIES:
            raise ValueError(f"no material {self.name!r}; known: {', '.join(MATERIALS)}")
        return FAMILIES[self.name]

    @property
    def by_core(self) -> bool:
        """Whether sigma_Flim depends on the core."""
        return (self.name, self.quality) == ("Eh", "MQ")

    @property
    def brinell(self) -> float:
        """Hardness as Brinell: Vickers hardness counts as Brinell hardness, below 400 or so."""
        return self.hardness

    @property
    def strength_for_notches(self) -> float:
        """Yield point [MPa] that the slip layer is looked up with, estimated where not given.

        Estimate: 3.2 MPa of tensile strength a unit of hardness, 0.55 (St) or 0.75 (V) of it.
        """
        if self.yield_strength > 0.0:
            return self.yield_strength
        if self.family == "GG":
            return 300.0 if self.hardness >= 200.0 else 150.0
        return VICKERS_TENSILE * self.hardness * YIELD_RATIO.get(self.family, 0.65)


@dataclass(frozen=True)
class Strength:
    """An allowable stress number [MPa]; within: whether the hardness is in the range of its line.

    nearest: the end of the range [hardness] that was taken where it is not.
    """

    stress: float
    within: bool = True
    nearest: float = 0.0


def strength(material: Material, stress: str) -> Strength:
    """Return sigma_Hlim ("H") or sigma_Flim ("F") [MPa] of a material, its own where it has one.

    Beyond the range of its line the end of the range counts: nothing is extrapolated. ValueError
    for a material, quality or core that is not known, and for a hardness that is missing where the
    strength depends on it. Source: ISO 6336-5:2016, table 1.
    """
    if own := material.own(stress):
        return Strength(own)
    name = "GGG" if material.name == "GGG ferritic" else material.name
    of_name = [line for line in LINES if line[0] == name and line[1] == stress]
    if not of_name:
        raise ValueError(f"no material {material.name!r}; known: {', '.join(MATERIALS)}")
    found = [line for line in of_name if material.quality in line[2].split("/")]
    if not found:
        known = ", ".join(QUALITIES)
        raise ValueError(f"no quality {material.quality!r} of {material.name}; known: {known}")
    if any(line[3] for line in found):
        if material.core not in CORES:
            raise ValueError(f"no core {material.core!r}; known: {', '.join(CORES)}")
        found = [line for line in found if line[3] == material.core]
    return _along(material, found)


def _along(
    material: Material, lines: list[tuple[str, str, str, str, float, float, float, float]]
) -> Strength:
    """Return the strength on lines that follow one another in hardness."""
    hardness = material.hardness
    if hardness <= 0.0:
        if len(lines) > 1 or lines[0][4]:
            raise ValueError(f"the strength of {material.name} needs its surface hardness")
        return Strength(lines[0][5])
    low, high = lines[0][6], lines[-1][7]
    at = min(max(hardness, low), high)
    slope, base = next((line[4], line[5]) for line in lines if at <= line[7])
    return Strength(slope * at + base, at == hardness, at)


# material, stress (H: contact, F: bending), qualities, core, A [MPa a unit of hardness], B [MPa],
# range of hardness. sigma_lim = A x + B, x: surface hardness, Brinell of St, St cast, GTS, GGG and
# GG, else Vickers; sigma_Flim is nominal, without Y_ST = 2.
# Source: pictures of the table in waa552/fyp-website, whose data.js repeats part of the ME lines
