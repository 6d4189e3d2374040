"""Mistakes in a file to be rated by ISO 6336: one message, with what to write; exit 2."""

import math
import tomllib
from pathlib import Path

import pytest

import gearopt

PROBLEMS = Path(__file__).parents[3] / "problems"
RIGHT = (PROBLEMS / "iso_tr_6336_30.toml").read_text(encoding="utf-8").split("[x-expected]")[0]
TREATMENT, GRADE = 'treatment = "carburised"', "accuracy_grade = 5"
LIFE = 'life = "50000 h"'
LOAD = '[[load]]\npower = "300 kW"\nshare = "100 %"\n'

WRONG = {  # the mistake: what stands there, what is written, key and value as told, what to write
    "no accuracy": (
        GRADE,
        "",
        "rating.iso6336.accuracy_grade",
        "is missing (or give f_pb, f_falpha and f_ma in [rating.iso6336.given])",
    ),
    "accuracy beyond the tables": (
        GRADE,
        "accuracy_grade = 13",
        "rating.iso6336.accuracy_grade = 13",
        "0 to 12",
    ),
    "accuracy by words": (
        GRADE,
        'accuracy_grade = "ISO 6"',
        'rating.iso6336.accuracy_grade = "ISO 6"',
        "Write accuracy_grade = 6",
    ),
    "edition": ('"2006"', '"2012"', 'rating.iso6336.edition = "2012"', "2006"),
    "edition by a number": (
        '"2006"',
        "2019",
        "rating.iso6336.edition = 2019",
        'Write edition = "2019"',
    ),
    "oil by its grade": (
        '"320 mm^2/s"',
        '"ISO VG 320"',
        'rating.iso6336.oil_grade = "ISO VG 320"',
        'Write oil_grade = "320 mm^2/s"',
    ),
    "soft roots": (
        TREATMENT,
        'treatment = "induction, flanks"\nflank_hardness = "550 HV"',
        'gears.treatment = "induction, flanks"',
        "Give sigma_Flim in [rating.iso6336.given]",
    ),
    "core of no gear": (
        TREATMENT,
        'treatment = "nitrided"\niso_core = "30 HRC"',
        "gears.iso_core",
        "changes nothing: only Eh of quality MQ has strengths by core. Remove it",
    ),
    "yield strength of a case": (
        TREATMENT,
        f'{TREATMENT}\nyield_strength = "800 MPa"',
        'gears.yield_strength = "800 MPa"',
        "changes nothing: of surface-hardened steel no strength depends on it. Remove it",
    ),
    "two roughnesses": (
        TREATMENT,
        f'{TREATMENT}\nroughness = "1 um"',
        'gears.roughness = "1 um"',
        "changes nothing beside flank_rz, which the rating by ISO 6336 takes. Remove it",
    ),
    "tolerances": ('"1995"', '"2010"', 'rating.iso6336.tolerances = "2010"', '"1995"'),
    "oil grade without a unit": ('"320 mm^2/s"', "320", "rating.iso6336.oil_grade = 320", "mm^2/s"),
    "material": (
        TREATMENT,
        'iso_material = "18CrNiMo7-6"',
        'gears.iso_material = "18CrNiMo7-6"',
        'Write the kind of steel: "Eh" case-hardened',
    ),
    "no material": (
        TREATMENT,
        "",
        "gears.iso_material",
        'Write, for example, iso_material = "Eh"',
    ),
    "no hardness": (
        TREATMENT,
        'iso_material = "V alloy"',
        "gears.hardness",
        'Write, for example, hardness = "240 HB"',
    ),
    "no hardness of a case": (
        TREATMENT,
        'iso_material = "IF"',
        "gears.flank_hardness",
        'Write, for example, flank_hardness = "600 HV"',
    ),
    "quality of AGMA": (
        TREATMENT,
        f"{TREATMENT}\niso_quality = 2",
        "gears.iso_quality = 2",
        "ML",
    ),
    "core of another steel": (
        "profile_shift = 0.145",
        'profile_shift = 0.145\niso_core = "30 HRC"\niso_quality = "ME"',
        "stage[1].pinion.iso_core",
        "changes nothing: only Eh of quality MQ has strengths by core. Remove it",
    ),
    "core by a number": (
        TREATMENT,
        f'{TREATMENT}\niso_core = "35 HRC"',
        'gears.iso_core = "35 HRC"',
        '"30 HRC"',
    ),
    "grade of AGMA": (
        TREATMENT,
        f"{TREATMENT}\ngrade = 2",
        "gears.grade = 2",
        'changes nothing with standard = "iso6336", but with "agma" or "both". Remove it',
    ),
    "quality number of AGMA": (
        LIFE,
        f"{LIFE}\nquality = 8",
        "rating.quality = 8",
        'changes nothing with standard = "iso6336"',
    ),
    "material of ISO for AGMA": (
        'standard = "iso6336"',
        'standard = "agma"\nquality = 8',
        "rating.iso6336",
        'with standard = "agma", but with "iso6336" or "both"; nor does gears.flank_rz. Remove all',
    ),
    "web without a rim": (
        TREATMENT,
        f'{TREATMENT}\nweb_thickness = "20 mm"',
        "gears.rim_thickness",
        "a gear with a web has a rim",
    ),
    "life factor of a spectrum": (
        GRADE,
        f"{GRADE}\ngiven = {{ Z_NT = 1 }}",
        "rating.iso6336.given.Z_NT",
        "follows from the levels [[load]] and cannot be given. Remove it",
    ),
    "keys of AGMA": (
        LIFE,
        f'{LIFE}\nquality = 8\nmounting = "open"\ngiven = {{ K_m = 1.3 }}',
        "rating.quality = 8",
        'but with "agma" or "both"; nor does rating.mounting, rating.given. Remove all, or write '
        'standard = "both"',
    ),
    "edition in the table of AGMA's": (
        LIFE,
        f'{LIFE}\nedition = "2019"',
        'rating.edition = "2019"',
        "that of ISO 6336 is edition of [rating.iso6336]",
    ),
    "strength of a stage": (
        "[[stage]]",
        '[[stage]]\nsigma_Hlim = "1500 MPa"',
        'stage[1].sigma_Hlim = "1500 MPa"',
        "sigma_Hlim, or sigma_Flim of bending, of a gear",
    ),
    **{
        f"{symbol} below 1": (
            GRADE,
            f"{GRADE}\ngiven = {{ {symbol} = {value} }}",
            f"rating.iso6336.given.{symbol} = {value}",
            "is not between 1 and",
        )
        for symbol, value in (
            *dict.fromkeys(("K_gamma", "K_v", "K_Hbeta", "K_Fbeta", "Y_B"), 0.15).items(),
            ("K_Halpha", 0.99),
            ("Z_BD", "[0.9, 1]"),
        )
    },
    "factor of AGMA": (
        GRADE,
        f"{GRADE}\ngiven = {{ K_m = 1.3 }}",
        "rating.iso6336.given.K_m",
        "it belongs in [stage.given] or in [rating.given]",
    ),
    "factor with other letters": (
        GRADE,
        f"{GRADE}\ngiven = {{ K_Hb = 1.3 }}",
        "rating.iso6336.given.K_Hb = 1.3",
        "K_Hbeta",
    ),
}


@pytest.mark.parametrize("mistake", WRONG)
def test_a_wrong_file_is_told_in_one_line(mistake, tmp_path, here):
    old, new, key, write = WRONG[mistake]
    assert old in RIGHT
    path = tmp_path / "pair.toml"
    text = RIGHT.replace(old, new, 1) + (LOAD if "spectrum" in mistake else "")
    path.write_text(text, encoding="utf-8")
    said = here("rate", path)
    assert said.returncode == 2 and said.stdout == ""
    (line,) = said.stderr.splitlines()
    assert line.startswith(f"gearopt: {path}: {key}") and write in line


@pytest.mark.parametrize(
    "given",
    [
        'f_pb = "9 um", f_falpha = "12 um", f_ma = "13 um"',
        "K_v = 1.1, K_Halpha = 1, K_Falpha = 1, K_Hbeta = 1.2",
    ],
)
def test_accuracy_is_asked_for_unless_all_that_follows_from_it_is_given(given):
    """A file without it is rated, and a deviation or factor less is missed."""
    rated = gearopt.rate(tomllib.loads(RIGHT.replace(GRADE, f"given = {{ {given} }}")))
    grade = {f["source"] for f in rated.design["rating"]["factors"]}
    assert "given" in grade
    less = given.rpartition(", ")[0]
    with pytest.raises(gearopt.SceneError, match="accuracy_grade: is missing"):
        gearopt.rate(tomllib.loads(RIGHT.replace(GRADE, f"given = {{ {less} }}")))


@pytest.mark.parametrize(
    ("core", "known"), [("25 HRC", 425.0), ("25 HRC, Jominy", 461.0), ("30 HRC", 500.0)]
)
def test_the_core_decides_the_strength_of_the_root(core, known):
    """Table 1 of ISO 6336-5:2016, Eh, MQ; without the key the lowest line."""
    tables = tomllib.loads(RIGHT.replace(TREATMENT, f'{TREATMENT}\niso_core = "{core}"'))
    found = gearopt.rate(tables).design["rating"]
    assert next(f for f in found["factors"] if f["symbol"] == "sigma_Flim")["pinion"] == known
    assert [gear["material"] for gear in found["gears"]] == [f"Eh, MQ, core {core}"] * 2


def test_forces_do_not_depend_on_the_standard():
    """At the working pitch circles: 9000 N m at 500 mm/(1 + 103/17), by AGMA as by ISO 6336."""
    found = gearopt.rate(tomllib.loads(RIGHT)).design["rating"]["meshes"][0]
    assert found["tangential_force_N"] == pytest.approx(9e6 * (1 + 103 / 17) / 500, rel=1e-12)
    assert found["pitch_line_velocity_m_per_s"] == pytest.approx(
        6 * 2 * math.pi * 0.5 / (1 + 103 / 17), rel=1e-12
    )
