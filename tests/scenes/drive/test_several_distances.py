"""Stages that choose their centre distance from several: against each alone, and refusals."""

import numpy as np
import pytest
from campaigns import few
from test_given_distance import PAIR, written

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.drive import teeth
from gearopt.optimise.result import Budget
from gearopt.scenes.reading.load import load

FEW = PAIR.replace("[14, 40]", "[24, 25]").replace('standard = "both"', 'standard = "iso6336"')
AGMA_ONLY = ("grade", "quality", "mounting", "oil_viscosity")
FEW = "\n".join(line for line in FEW.splitlines() if not line.startswith(AGMA_ONLY))
LIST = '["112 mm", "118 mm", "125 mm"]'
SERIES = '{ from = "110 mm", to = "130 mm", series = "R40" }'


@pytest.mark.slow
@pytest.mark.parametrize("several", few([SERIES, LIST], 1))
def test_the_best_distance_and_helix_are_those_of_each_alone(tmp_path, several):
    chosen = FEW.replace('"125 mm"', several).replace('"12 deg"', '["0 deg", "12 deg"]')
    result = gearopt.solve(written(tmp_path, chosen))
    alone = {}
    for angle in (0, 12):
        for distance in (112, 118, 125):
            text = FEW.replace("125 mm", f"{distance} mm").replace("12 deg", f"{angle} deg")
            value = gearopt.solve(written(tmp_path, text), remedies=False).value
            alone[value or float("inf")] = angle, distance
    stage = result.design["stages"][0]
    assert result.status == "optimal"
    assert result.value == pytest.approx(min(alone), rel=1e-12)
    found = stage.get("helix_angle_deg", 0.0), stage["centre_distance_mm"]
    assert found == alone[min(alone)]


def test_a_series_without_ends_reaches_all_distances_of_its_teeth(tmp_path):
    train = load(written(tmp_path, FEW.replace('"125 mm"', '"R20"'))).scene.train()
    distances = [toothing.working_distance for toothing in train.stages[0].toothings]
    assert distances[0] == 25.0 and distances[-1] > 0.5 * 50.0 * 25 * 5
    assert {100.0, 112.0, 125.0, 140.0} <= {*distances}


def test_points_of_several_toothings_are_what_each_is_alone(tmp_path):
    path = written(
        tmp_path, FEW.replace('"125 mm"', LIST).replace('"12 deg"', '["0 deg", "12 deg"]')
    )
    train = load(path).scene.train()
    problem = teeth.problem(train)
    every = [problem.methods["exact"](problem, Budget(), 0, None).x]
    far = every[0].copy()
    far[-1] = 1.0  # the first toothing
    every += [far, every[0]]
    together = problem.batch(np.array(every))
    for k, point in enumerate(every):
        alone = problem.batch(point[None])
        assert np.array_equal(together.F[k], alone.F[0], equal_nan=True)
        assert np.allclose(together.G[k], alone.G[0], rtol=1e-12, atol=0.0, equal_nan=True)


def test_distances_that_no_teeth_fit_are_named(tmp_path):
    text = FEW.replace('"125 mm"', '["20 mm", "22.4 mm"]')
    result = gearopt.solve(written(tmp_path, text), remedies=False)
    assert result.status == "infeasible"
    assert "No teeth fit any of the 2 centre distances from 20 to 22.4 mm" in result.message


@pytest.mark.parametrize(
    ("several", "told"),
    [
        ('"R5"', "is none of the series R10, R20, R40 of ISO 3"),
        ('{ from = "100 mm", to = "200 mm", series = "R5" }', "has no series of R10, R20, R40"),
        ('{ from = "101 mm", to = "105 mm", series = "R20" }', "holds no value of R20"),
        ('{ from = "100 mm", series = "R20" }', "is not a range with from, to and step or series"),
        ('{ from = "125 mm", to = "112 mm", series = "R20" }', "its ends in the wrong order"),
    ],
)
def test_what_is_no_choice_of_distances_is_refused(tmp_path, several, told):
    with pytest.raises(SceneError) as refusal:
        load(written(tmp_path, FEW.replace('"125 mm"', several)))
    assert told in str(refusal.value)


def test_given_gears_have_one_distance(tmp_path):
    size = 'module = "2 mm"\npinion_teeth = 25\nwheel_teeth = 97\nface_width = "40 mm"'
    text = FEW.replace('"125 mm"', f"{LIST}\n{size}")
    with pytest.raises(SceneError, match="these are all given"):
        load(written(tmp_path, text.replace("face_width_over_diameter = [0.3, 1.0]\n", "")))


@pytest.mark.slow
def test_a_coaxial_drive_has_a_bound_as_soon_as_it_has_a_design():
    """A quick one at once, then that of all rows of distances before the first is begun."""
    events = []

    def until_known(event):
        events.append(event)
        return event.best is None or event.bound is None or event.bound < 4e6

    result = gearopt.solve("problems/coaxial_unit.toml", watch=until_known)
    first = next(event for event in events if event.best is not None)
    assert first.bound is not None and 0.0 < first.bound < 6159497.0
    assert result.status == "limit" and 4e6 < result.bound < 6159497.0 < result.value
