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
from gearopt.scenes.reading.lists import each_gear
from gearopt.units import Quantity

NAMES = {  # of the factors
    "K_A": "application",
    "K_gamma": "mesh load, of several paths",
    "K_v": "dynamic",
    "K_Hbeta": "face load, contact",
    "K_Fbeta": "face load, bending",
    "K_Halpha": "transverse load, contact",
    "K_Falpha": "transverse load, bending",
    "c_prime": "single stiffness",
    "c_gamma_alpha": "mean mesh stiffness",
    "c_gamma_beta": "mesh stiffness for K_Hbeta",
    "N": "resonance ratio",
    "f_pb": "base pitch deviation",
    "f_falpha": "profile form deviation",
    "f_ma": "misalignment, manufacture",
    "C_a": "tip relief",
    "Z_H": "zone",
    "Z_E": "elasticity",
    "Z_eps": "contact ratio, contact",
    "Z_beta": "helix angle, contact",
    "Y_beta": "helix angle, bending",
    "Y_DT": "deep tooth",
    "Y_ST": "stress correction, test gear",
    "Z_X": "size, contact",
    "Z_BD": "single pair tooth contact",
    "Z_NT": "life, contact",
    "Z_L": "lubricant",
    "Z_v": "velocity",
    "Z_R": "roughness",
    "Z_W": "work hardening",
    "sigma_Hlim": "allowable stress number",
    "Y_F": "form",
    "Y_S": "stress correction",
    "Y_B": "rim thickness",
    "Y_NT": "life, bending",
    "Y_deltarelT": "relative notch sensitivity",
    "Y_RrelT": "relative surface",
    "Y_X": "size, bending",
    "Y_M": "mean stress",
    "sigma_Flim": "nominal stress number",
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
OIL = advised(
    quantity("kinematic viscosity", "220 mm^2/s"),
    {rf"(iso )?vg[ -]?{grade}": f'Write oil_grade = "{grade} mm^2/s"' for grade in VG},
)


def _field(symbol: str) -> Any:
    """Return the field of a factor: a value, or one for each gear."""
    reads = LOAD if symbol in LOADS else READS[CLAUSES[symbol][1]]
    kind: Any = Fraction if CLAUSES[symbol][1] == "" else Quantity
    if symbol in PAIRED:
        kind, reads = tuple[kind, kind], each_gear(reads)
    text, comma, of = NAMES[symbol].partition(",")
    described = text[0].upper() + text[1:] + " factor" * (symbol[0] in "KYZ") + comma + of
    return (Annotated[kind | None, reads], Field(None, description=described))


IsoGiven = create_model(
    "IsoGiven",
    __base__=Given,
    __doc__=Given.__doc__,
    **{symbol: _field(symbol) for symbol in CLAUSES if symbol != "K_A"},
)


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
    given: IsoGiven = Field(
        default_factory=IsoGiven, description="Factors of all stages, instead of computed ones"
    )
