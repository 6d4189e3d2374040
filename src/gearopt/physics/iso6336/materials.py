"""Strengths of materials by ISO 6336-5, table 1, and what else parts 1 to 3 ask of a material."""

from dataclasses import dataclass

from gearopt.physics.iso6336.strength_table import LINES

QUALITIES = ("ML", "MQ", "ME")
CORES = ("25 HRC", "25 HRC, Jominy", "30 HRC")  # of Eh, quality MQ, bending
MATERIALS = tuple(dict.fromkeys(line[0] for line in LINES)) + ("GGG ferritic",)
# family: whose life curves, running-in, notch and size factors a material has
FAMILIES = {name: name for name in MATERIALS} | {
    "St cast": "St",
    **dict.fromkeys(("V carbon", "V alloy", "V cast carbon", "V cast alloy"), "V"),
}
SURFACE_HARDENED = ("Eh", "IF", "NT", "NV", "NV nitrocarburised")
VICKERS_TENSILE = 3.2  # MPa of tensile strength a unit of hardness; unverified, from memory
YIELD_RATIO = {"St": 0.55, "V": 0.75}  # of yield point and tensile strength; unverified, memory


@dataclass(frozen=True)
class Material:
    """A gear's material: name of MATERIALS, quality of QUALITIES, surface hardness.

    hardness: Brinell of St, St cast, GTS, GGG, GG, else Vickers; core: of CORES, for Eh.
    yield_strength: yield point sigma_S or 0.2 % proof stress [MPa] of St and V, tensile strength of
    GG and GGG ferritic; 0: estimated. modulus E [MPa], poisson nu, density [t/mm3]; flank and root:
    roughness R_z [mm]; reversed_load: of idlers, 0.7 of sigma_Flim.
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
    """Return sigma_Hlim ("H") or sigma_Flim ("F") [MPa] of a material.

    Beyond the range of its line the end of the range counts: nothing is extrapolated. ValueError
    for a material, quality or core that is not known, and for a hardness that is missing where the
    strength depends on it. Source: ISO 6336-5:2016, table 1.
    """
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
