"""A table [drawing] decides no answer: explanations are those of the file without it."""

from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.explaining.numbers import allowed, numbers

PROBLEMS = Path(__file__).parents[3] / "problems"
WHOLE = {"centre_distance": "±0.02 mm", "accuracy_grade": 5, "balls": ["3 mm", "4 mm"]}


@pytest.mark.parametrize("allowance", ["cd25", "27cd", "-0.05/-0.09 mm", ["-0.09 mm", "0 mm"]])
def test_no_number_of_it_moves_and_its_file_reads_itself_again(allowance):
    drawn = {"drawing": {"allowance": allowance} | WHOLE}
    scene = gearopt.load(PROBLEMS / "elevator_small_wheels.toml", drawn)
    assert allowed(scene)
    bare = gearopt.load(PROBLEMS / "elevator_small_wheels.toml")
    for defaults in (False, True):
        keys = {number.key for number in numbers(scene, defaults)}
        assert keys == {number.key for number in numbers(bare, defaults)}


@pytest.mark.slow
@pytest.mark.parametrize("file", ["elevator_small_wheels.toml", "elevator_exact_ratio.toml"])
def test_remedies_and_sensitivities_are_those_without_it(file):
    bare, drawn = (
        gearopt.explain(PROBLEMS / file, changes) for changes in (None, {"drawing": WHOLE})
    )
    assert drawn.remedies == bare.remedies
    assert bare.remedies or bare.influences
    assert drawn.influences == bare.influences


@pytest.mark.parametrize("allowance", ["0.05/0.09 mm", ["0.09 mm", "0.05 mm"]])
def test_allowances_without_their_signs_are_told_with_them(allowance):
    with pytest.raises(SceneError) as wrong:
        gearopt.load(PROBLEMS / "elevator.toml", {"drawing": {"allowance": allowance}})
    assert '"-0.05/-0.09 mm"' in str(wrong.value)
