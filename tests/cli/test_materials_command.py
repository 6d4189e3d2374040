"""`gearopt materials`: the list of steels, one of them, and names that are wrong."""

import json

from gearopt.physics import steels


def test_all_steels_are_listed_with_their_sources(here):
    said = here("materials").stdout
    assert all(row.name in said for row in steels.steels())
    assert "unverified" in said and "KHK, The hardness of gears" in said.replace("\n", " ")


def test_one_steel_has_all_its_treatments(here):
    rows = json.loads(here("materials", "1.7225", "--json").stdout)
    assert [row["treatment"] for row in rows] == [
        "through-hardened",
        "nitrided",
        "induction, roots",
    ]
    assert all(row["hardness"][0] < row["hardness"][1] for row in rows) and rows[0]["verified"]


def test_a_wrong_name_is_answered_by_near_ones(here):
    said = here("materials", "16MnCr6")
    assert said.returncode == 2 and "near: 16MnCr5" in said.stderr
