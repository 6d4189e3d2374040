"""Strengths of a gear's own, in place of those of the tables: rated, chosen of, refused."""

import re

import pytest
from test_steels_by_name import CASE, TEMPERED, written

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.reading.load import load

OWN = 's_ac = "{} MPa"\ns_at = "{} MPa"\nsigma_Hlim = "{} MPa"\nsigma_Flim = "{} MPa"\n'
GIVEN = """
[rating.given]
s_ac = [1300, 900]
s_at = [400, 280]
[rating.iso6336.given]
sigma_Hlim = [1400, 700]
sigma_Flim = [410, 290]
"""


def test_own_strengths_are_rated_as_the_same_given_for_both(tmp_path):
    kinds = CASE.format(2, "MQ"), TEMPERED.format(280)
    own = OWN.format(1300, 400, 1400, 410), OWN.format(900, 280, 700, 290)
    by_gear = gearopt.rate(written(tmp_path, "", *map("\n".join, zip(kinds, own, strict=True))))
    path = written(tmp_path, "", *kinds)
    numbers = re.sub(r"(\d{3,4})(?=[,\]])", r'"\1 MPa"', GIVEN)
    path.write_text(path.read_text() + numbers)
    assert by_gear.limits == pytest.approx(gearopt.rate(path).limits, rel=1e-12)


def test_one_gear_may_have_strengths_of_its_own(tmp_path):
    """By ISO 6336 sigma_Hlim enters running-in, too, and through it all loads a little."""
    usual = gearopt.rate(written(tmp_path, 'steel = "16MnCr5"'))
    own = gearopt.rate(written(tmp_path, 'steel = "16MnCr5"', 'sigma_Hlim = "1600 MPa"'))
    contact = "pinion_contact_iso[1]"
    assert own.limits[contact] == pytest.approx(usual.limits[contact] * 1500 / 1600, rel=0.01)
    others = {name: used for name, used in usual.limits.items() if "_iso" not in name}
    assert others == {name: own.limits[name] for name in others}


def test_iron_without_a_class_is_rated_by_its_own_strengths(tmp_path):
    own = 'iso_material = "GGG"\nhardness = "280 HB"\n'
    own += 'sigma_Hlim = "600 MPa"\nsigma_Flim = "250 MPa"'
    path = written(tmp_path, own)
    path.write_text(path.read_text().replace('"both"\nquality = 9', '"iso6336"'))
    factors = {f["symbol"]: f for f in gearopt.rate(path).design["rating"]["factors"]}
    assert (factors["sigma_Hlim"]["pinion"], factors["sigma_Flim"]["wheel"]) == (600.0, 250.0)


def test_strengths_of_the_gear_and_of_both_are_one_too_many(tmp_path):
    path = written(tmp_path, 'steel = "16MnCr5"', 'sigma_Hlim = "1400 MPa"')
    path.write_text(path.read_text() + '[rating.iso6336.given]\nsigma_Hlim = "1500 MPa"\n')
    with pytest.raises(SceneError, match="changes nothing beside the factor that is given"):
        load(path)
