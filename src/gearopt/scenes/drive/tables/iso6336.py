"""Tables of a rating by ISO 6336 alone: materials, accuracy, oil, factors."""

from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field, create_model

from gearopt.physics.iso6336.accuracy import TOLERANCES
from gearopt.physics.iso6336.case import EDITIONS
from gearopt.physics.iso6336.contact_factors import PROFILE_MODIFICATIONS
from gearopt.physics.iso6336.factors import CLAUSES, PAIRED
from gearopt.physics.iso6336.load_factors import HELIX_MODIFICATIONS
from gearopt.physics.iso6336.materials import CORES, MATERIALS, QUALITIES
from gearopt.physics.iso6336.tooth_form import SHIFTS
from gearopt.scenes.drive.tables.given import Given
from gearopt.scenes.reading.fields import Table, advised, choice, number, quantity, truth, whole
from gearopt.scenes.reading.lists import each_gear, each_mesh
from gearopt.units import Quantity

NAMES = {  # of the factors, as ISO 6336 has them
    "K_A": "application factor",
    "K_gamma": "mesh load factor",
    "K_v": "dynamic factor",
    "K_Hbeta": "face load factor",
    "K_Fbeta": "face load factor",
    "K_Halpha": "transverse load factor",
    "K_Falpha": "transverse load factor",
    "c_prime": "single stiffness",
    "c_gamma_alpha": "mean mesh stiffness",
    "c_gamma_beta": "mesh stiffness for K_Hbeta",
    "N": "resonance ratio",
    "f_pb": "base pitch deviation",
    "f_falpha": "profile form deviation",
    "f_ma": "manufacturing misalignment",
    "C_a": "tip relief",
    "Z_H": "zone factor",
    "Z_E": "elasticity factor",
    "Z_eps": "contact ratio factor",
    "Z_beta": "helix angle factor",
    "Y_beta": "helix angle factor",
    "Y_DT": "deep tooth factor",
    "Y_ST": "stress correction, test gear",
    "Z_X": "size factor",
    "Z_BD": "single pair contact factor",
    "Z_NT": "life factor",
    "Z_L": "lubricant factor",
    "Z_v": "velocity factor",
    "Z_R": "roughness factor",
    "Z_W": "work hardening factor",
    "sigma_Hlim": "allowable stress number",
    "Y_F": "form factor",
    "Y_S": "stress correction factor",
    "Y_B": "rim thickness factor",
    "Y_NT": "life factor",
    "Y_deltarelT": "relative notch sensitivity",
    "Y_RrelT": "relative surface factor",
    "Y_X": "size factor",
    "Y_M": "mean stress influence factor",
    "sigma_Flim": "nominal stress number",
}
OF = {  # what a factor of the same name as another one is for
    **dict.fromkeys(("K_Hbeta", "K_Halpha", "Z_beta", "Z_X", "Z_NT"), ", contact stress"),
    **dict.fromkeys(("K_Fbeta", "K_Falpha", "Y_beta", "Y_X", "Y_NT"), ", tooth root stress"),
}
READS = {  # by unit of a factor
    "": number(1.1, 0, 10**6),
    "MPa": quantity("stress", "500 MPa", "100 GPa"),
    "mm": quantity("length", "8 um", "1 mm", zero=True),
    "sqrt(MPa)": quantity("elastic coefficient", "189.8 sqrt(MPa)"),
}
LOADS = ("K_gamma", "K_v", "K_Hbeta", "K_Fbeta", "K_Halpha", "K_Falpha", "Z_BD", "Y_B")
LOAD = number(1.1, 1, 10**6)  # of LOADS, largest over mean or nominal: 1 or more by definition
VG = (32, 46, 68, 100, 150, 220, 320, 460, 680, 1000)  # viscosity grades of ISO 3448
GRADES = advised(
    each_gear(whole(6, 0, 12, scale=True)),
    {
        rf"(?:iso|din|grade|q|iso 1328)[ -]*{grade}": f"Write accuracy_grade = {grade}"
        for grade in range(13)
    },
)
MATERIAL = advised(
    choice(*MATERIALS),
    {
        r".*\d.*": 'Write the kind of steel: "Eh" case-hardened, "V alloy" through-hardened, "IF" '
        'induction hardened, "NT" nitriding steel, "NV" nitrided through-hardening steel'
    },
)
OWN = quantity("stress", "430 MPa", "10 GPa")
OIL = advised(
    quantity("kinematic viscosity", "220 mm^2/s"),
    {rf"(iso )?vg[ -]?{grade}": f'Write oil_grade = "{grade} mm^2/s"' for grade in VG},
)


def _field(symbol: str) -> Any:
    """Return the field of a factor: a value, or one for each gear, or mesh of planets."""
    reads = LOAD if symbol in LOADS else READS[CLAUSES[symbol][1]]
    kind: Any = Fraction if CLAUSES[symbol][1] == "" else Quantity
    if symbol in PAIRED:
        kind, reads = tuple[kind, kind], each_gear(reads)
    else:
        kind, reads = kind | tuple[kind, kind], each_mesh(reads)
    words = NAMES[symbol] + OF.get(symbol, "")
    return (Annotated[kind | None, reads], Field(None, description=words[0].upper() + words[1:]))


IsoGiven = create_model(
    "IsoGiven",
    __base__=Given,
    __doc__=f"{Given.__doc__} Those of a mesh may have two values in a planetary stage: [sun and "
    "planet, planet and ring].",
    **{symbol: _field(symbol) for symbol in CLAUSES if symbol != "K_A"},
)


def of_meshes(given: Table) -> list[str]:
    """Factors that are given with a value for each mesh of a planetary stage."""
    held = ((name, getattr(given, name)) for name in CLAUSES if name in type(given).model_fields)
    return [name for name, value in held if name not in PAIRED and isinstance(value, tuple)]


class IsoGearKeys(Table):
    """What a gear has for a rating by ISO 6336."""

    iso_material: Annotated[str | None, MATERIAL] = Field(
        None,
        description="Material of ISO 6336-5; by default V alloy, Eh, IF or NV, as the treatment is",
    )
    iso_quality: Annotated[str | None, choice(*QUALITIES)] = Field(
        None, description="Quality of material of ISO 6336-5; by default MQ"
    )
    iso_core: Annotated[str | None, choice(*CORES)] = Field(
        None,
        description="Core of case-hardened steel (Eh) of quality MQ, for sigma_Flim: its minimum "
        "hardness; Jominy: also at least 28 HRC at J = 12 mm (unverified); by default 25 HRC",
    )
    flank_hardness: Annotated[Quantity | None, quantity("Vickers hardness", "650 HV")] = Field(
        None, description="Vickers hardness of hardened flanks; of others it follows from hardness"
    )
    yield_strength: Annotated[Quantity | None, quantity("stress", "600 MPa")] = Field(
        None, description="Yield point or 0.2 % proof stress, for Y_deltarelT; else estimated"
    )
    sigma_Hlim: Annotated[Quantity | None, OWN] = Field(
        None, description="Allowable stress number (contact) of its own, instead of table 1"
    )
    sigma_Flim: Annotated[Quantity | None, OWN] = Field(
        None,
        description="Nominal stress number (bending) of its own, instead of table 1, without Y_ST",
    )
    flank_rz: Annotated[Quantity | None, quantity("length", "4.8 um", "1 mm")] = Field(
        None, description="Roughness R_z of the flanks; by default 6 R_a"
    )
    accuracy_grade: Annotated[int | None, whole(6, 0, 12, scale=True)] = Field(
        None,
        description="Accuracy grade of ISO 1328-1 of this gear; by default that of "
        "[rating.iso6336]",
    )
    root_rz: Annotated[Quantity | None, quantity("length", "20 um", "1 mm")] = Field(
        None, description="Roughness R_z of the roots; by default 20 um"
    )


ISO_KEYS = tuple(IsoGearKeys.model_fields)


class IsoTable(Table):
    """How gears are rated by ISO 6336, beside what [rating] says of life and loads."""

    edition: Annotated[str, choice(*EDITIONS)] = Field(
        "2006", description="Edition of parts 2 and 3: 2006 or 2019"
    )
    accuracy_grade: Annotated[tuple[int, int] | None, GRADES] = Field(
        None, description="Accuracy grade of ISO 1328-1, of both gears or [pinion, wheel]"
    )
    tolerances: Annotated[str, choice(*TOLERANCES)] = Field(
        "1995", description="Edition of ISO 1328-1 whose tolerances are meant"
    )
    shift: Annotated[str, choice(*SHIFTS)] = Field(
        "nominal", description="Profile shift that Y_F takes: nominal, or generating"
    )
    oil_grade: Annotated[Quantity | None, OIL] = Field(
        None, description="Kinematic viscosity of the oil at 40 degC; by default 220 mm^2/s"
    )
    tip_relief: Annotated[Quantity | None, quantity("length", "30 um", "5 mm", zero=True)] = Field(
        None, description="Tip relief C_a; by default what running-in gives"
    )
    helix_modification: Annotated[str, choice(*HELIX_MODIFICATIONS)] = Field(
        "none", description="Crowning, correction or end relief, in K_Hbeta"
    )
    profile_modification: Annotated[str, choice(*PROFILE_MODIFICATIONS)] = Field(
        "none", description="How tip relief was chosen, in Z_B and Z_D of 2019"
    )
    limited_pitting: Annotated[bool, truth()] = Field(
        False, description="Some pitting is permitted, in Z_NT"
    )
    life_factor_at_1e10: Annotated[Fraction, number(0.9, Fraction(17, 20), 1)] = Field(
        Fraction(17, 20),
        description="Z_NT and Y_NT at 1e10 cycles: 0.85, up to 1 with optimum lubrication, "
        "material and manufacture, by experience",
        json_schema_extra={"default": 0.85},
    )
    given: IsoGiven = Field(
        default_factory=IsoGiven, description="Factors of all stages, instead of computed ones"
    )
