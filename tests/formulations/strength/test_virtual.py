"""The virtual option uses no more than any of its options, between widths and torques."""

from dataclasses import replace

import numpy as np
import pytest
from campaigns import few
from rated_drives import agma, iso
from test_iso_rows import EH, GREY, LEVELS, NEW, NITRIDED, SOFT, pairs, rows

from gearopt.formulations.strength.standard import Option
from gearopt.formulations.strength.virtual import Strength, may_be_best
from gearopt.physics.agma.rating_factors import Steel
from gearopt.physics.iso6336.materials import Material

SOFTER, HARDER = Material("V alloy", "MQ", 240.0, flank=9e-3), Material("Eh", "ML")
IRON = Material("GGG", "MQ", 250.0)
CASED = Steel("nitrided", 2, 300.0)
CARBURISED, TEMPERED = Steel("carburised", 2), Steel("through-hardened", 1, 300.0)
WEAK, WEAKER = Steel("carburised", 1), Steel("through-hardened", 1, 220.0, finish=0.4e-3)


def steels(*named):
    return [replace(agma(), steels=(a, b)) for a in named for b in named]


def materials(*named, **made):
    return [replace(iso((a, b)), **made) for a in named for b in named]


KINDS = {
    "AGMA": steels(CARBURISED, TEMPERED, WEAK, WEAKER),
    "AGMA, three levels": [replace(o, loads=LEVELS) for o in steels(CARBURISED, WEAKER)],
    "hard and soft": materials(EH, SOFT, SOFTER, HARDER),
    "cast and nitrided": materials(SOFTER, NITRIDED, IRON),
    "2019": materials(HARDER, SOFT, EH, practice=NEW),
    "three levels": materials(EH, HARDER, loads=LEVELS),
}
QUICK = "AGMA, three levels", "hard and soft", "three levels"


@pytest.mark.parametrize("kind", few(KINDS, QUICK[:1]))
def test_a_virtual_option_uses_no_more_than_any(kind):
    options = KINDS[kind]
    virtual = options[0].best_with(options[1:])
    pair, width, torque, power, _ = pairs(0.3, 4)
    for torques, wide in (((torque, torque), 1.0), ((torque, 1.02 * torque), 1.05)):
        least = rows(virtual, pair, torques, power).used(width, wide * width)
        every = [rows(o, pair, torques, power).used(width, wide * width) for o in options]
        found = np.min(every, axis=0)
        assert np.all((least <= 1.0) | (found > 1.0))
        if len(options[0].loads) == 1:  # else a number on the right side of 1
            assert np.all(least <= found * (1.0 + 1e-12))
            sound = np.isfinite(least)
            assert np.median(least[sound] / found[sound]) > 0.75


IDLERS = replace(CARBURISED, modulus=15e4, reversed_load=True), replace(WEAK, modulus=15e4)
BRITTLE = replace(EH, poisson=0.25, flank=3e-3)
MORE = {
    "any": materials(SOFT, SOFTER, IRON, HARDER, BRITTLE, EH),
    "thin oil": materials(SOFT, HARDER, EH, practice=replace(NEW, viscosity=50.0)),
    "soft wheels": [iso((a, SOFT)) for a in (SOFT, HARDER, EH)],
    "AGMA": [o for o in steels(WEAK, CASED, CARBURISED, TEMPERED) if o.steels[0] != o.steels[1]],
    "AGMA, soft wheels": [agma((a, TEMPERED)) for a in (replace(WEAK, finish=1.6e-3), WEAK)],
    "AGMA, idlers": [agma((a, a)) for a in (CARBURISED, *IDLERS)],
}


@pytest.mark.parametrize("kind", MORE)
def test_every_number_of_a_virtual_option_is_that_of_the_best_one(kind):
    """What is used by materials alone, deviations after running-in; C_a is between two ends."""
    options = MORE[kind]
    pair, _, torque, power, _ = pairs(0.3, 4)
    virtual = options[0].best_with(options[1:])
    made, *every = (rows(o, pair, (torque, torque), power).columns for o in (virtual, *options))
    if "AGMA" in kind:
        np.testing.assert_array_equal(made, np.min(every, axis=0))
        return
    elastic = [o.found["Z_E"] / virtual.found["Z_E"] for o in options]
    for name in ("pitch0", "form0", "deviation0", "relief0", "bending_used0", "bending_used1"):
        np.testing.assert_allclose(made[name], np.min([c[name] for c in every], axis=0), rtol=1e-14)
    np.testing.assert_array_equal(made["relief1"], np.max([c["relief1"] for c in every], axis=0))
    for name in ("contact_used0", "contact_used1"):
        least = np.min([c[name] / z**2 for c, z in zip(every, elastic, strict=True)], axis=0)
        np.testing.assert_allclose(made[name], least * min(elastic) ** 2, rtol=1e-13)


def test_options_that_cannot_be_compared_have_no_virtual_one():
    first = iso((EH, EH))
    assert first.best_with([iso((replace(GREY, modulus=126e3), EH))]) is None  # another stiffness
    assert first.best_with([replace(first, practice=NEW)]) is None
    levels = replace(first, loads=LEVELS)
    assert levels.best_with([replace(levels, materials=(SOFT, SOFT))]) is None  # another life curve
    assert agma().best_with([replace(agma(), suffix="_other")]) is None


def test_a_virtual_option_is_as_light_and_as_cheap_as_any():
    first = Option((), "", (None, 7.0e-9), (2.0, 1.5), cutting_prices=(4.0, 0.0))
    second = Option((), "", (8.0e-9, None), (1.0, 3.0), cutting_prices=(3.0, 5.0))
    made = first.cheapest_with([second], 7.5e-9)
    assert made.densities == (7.5e-9, 7.0e-9) and made.prices == (1.0, 1.5)
    assert made.cutting_prices == (3.0, 0.0)
    assert first.cheapest_with([second], None).densities == (8.0e-9, 7.0e-9)


def test_strengths_that_may_be_the_greatest():
    """Of one law and factor the greatest alone; none whose largest factor leaves it below."""
    strengths = [
        Strength("a", (), 900.0),
        Strength("a", (), 1000.0),
        Strength("b", (), 100.0),
        Strength("a", "x", 833.0, 1.2),
        Strength("a", "x", 840.0, 1.2),
        Strength("a", "y", 840.0, 1.2),
        Strength("a", (), 1000.0),
        Strength("a", "z", 1100.0, 1.2),
    ]
    assert may_be_best(strengths) == [1, 2, 4, 5, 7]
