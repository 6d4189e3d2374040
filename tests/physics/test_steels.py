"""Steels by name: their rows, their names, and what both standards know of them."""

import pytest

from gearopt.physics import steels
from gearopt.physics.agma.allowables import BENDING
from gearopt.physics.iso6336.materials import MATERIALS, QUALITIES


def test_every_row_has_a_class_that_the_standards_know():
    grades = {(treatment, grade) for treatment, _, grade in BENDING}
    for row in steels.steels():
        assert row.iso_material in (*MATERIALS, "") and row.iso_quality in QUALITIES
        assert not row.treatment or (row.treatment, row.grade) in grades
        assert 100.0 <= row.hardness[0] < row.hardness[1] <= 1000.0
        assert row.unit == ("HV" if row.heat not in ("none", "quenched and tempered") else "HB")
        assert set(row.sources) <= set(steels.SOURCES)
        assert row.tensile is None or row.yield_strength is None or row.yield_strength < row.tensile
    assert len(steels.steels()) == 68


@pytest.mark.parametrize(
    ("name", "usual", "treatment"),
    [
        ("16 MnCr 5", "16MnCr5", "carburised"),
        ("1.7131", "16MnCr5", "carburised"),
        ("17CrNiMo6", "18CrNiMo7-6", "carburised"),
        ("42crmo4", "42CrMo4", "through-hardened"),
        ("SAE 8620", "20CrNiMo", "carburised"),
        ("4140", "AISI 4140", "through-hardened"),
        ("AISI 5115", "16MnCr5", "carburised"),
        ("Ck45", "C45E", "through-hardened"),
        ("GGG-40", "EN-GJS-400-15", ""),
        ("1.7223", "41CrMo4", "induction, roots"),
    ],
)
def test_a_steel_is_found_by_any_of_its_names(name, usual, treatment):
    first = steels.named(name)[0]
    assert (first.name, first.treatment) == (usual, treatment)


def test_names_of_no_steel():
    assert steels.named("16MnCr6") == () and steels.near("16MnCr6")[0] == "16MnCr5"
    assert all(map(steels.is_plastic, ("POM", "PA66", "PA 6", "PEEK", "nylon 6")))
    assert not any(map(steels.is_plastic, ("16MnCr5", "S45C", "C45")))


@pytest.mark.parametrize(("diameter", "least"), [(40, 1000), (100, 900), (160, 800), (250, 750)])
def test_the_hardness_of_tempered_steel_falls_with_its_section(diameter, least):
    """R_m of 42CrMo4 by EN 10083 at the largest diameter of each of its rows, from memory."""
    hardness = steels.named("42CrMo4")[0].hardness_at(diameter)
    assert hardness * steels.VICKERS_TENSILE == pytest.approx(least, rel=0.04)
    assert steels.named("16MnCr5")[0].hardness_at(diameter) is None
