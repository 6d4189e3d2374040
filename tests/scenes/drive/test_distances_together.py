"""Centre distances of all stages that go together: coaxial drives, and given sums."""

import itertools
import math

import pytest
from test_given_distance import TWO, written
from test_several_distances import AGMA_ONLY

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.reading.load import load

FEW = TWO.replace("[14, 40]", "[18, 20]").replace('standard = "both"', 'standard = "iso6336"')
FEW = "\n".join(line for line in FEW.splitlines() if not line.startswith(AGMA_ONLY))
FEW = FEW.replace("[teeth]", '[teeth]\nmodules = ["2 mm", "2.5 mm", "3 mm"]')
DISTANCES = 112, 125
slow = pytest.mark.slow
LIST = str([f"{a} mm" for a in DISTANCES])


def asked(limit, first=LIST, second=LIST):
    text = FEW.replace('"100 mm"', first).replace('"160 mm"', second)
    return text.replace("[limits]", f"[limits]\n{limit}")


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Volumes of the drives of every two distances; inf where there is none."""
    values = {}
    for pair in itertools.product(DISTANCES, repeat=2):
        text = asked("", *(f'"{a} mm"' for a in pair))
        result = gearopt.solve(written(tmp_path_factory.mktemp("pair"), text), remedies=False)
        values[pair] = result.value or math.inf
    return values


@pytest.mark.parametrize(
    ("limit", "goes"),
    [
        ("coaxial = true", lambda a, b: a == b),
        ('sum_of_centre_distances = ["237 mm", "240 mm"]', lambda a, b: a + b == 237),
    ],
)
@slow
def test_the_best_distances_are_those_of_each_row_alone(tmp_path, alone, limit, goes):
    result = gearopt.solve(written(tmp_path, asked(limit)), remedies=False)
    least = min(value for pair, value in alone.items() if goes(*pair))
    assert result.status == "optimal" and result.value == pytest.approx(least, rel=1e-12)
    chosen = tuple(round(s["centre_distance_mm"]) for s in result.design["stages"])
    assert goes(*chosen) and alone[chosen] == pytest.approx(least, rel=1e-12)


@pytest.mark.slow
def test_a_layout_puts_the_output_of_a_coaxial_drive_in_line_with_the_input(tmp_path):
    layout = '\n[layout]\nshaft_stress = "40 MPa"\nspan = "partial"\n'
    file = written(tmp_path, asked("coaxial = true") + layout)
    output = gearopt.solve(file, remedies=False).design["layout"]["shafts"][2]
    assert max(abs(output["y_mm"]), abs(output["z_mm"])) <= 0.01 + 1e-6
    with pytest.raises(SceneError, match="in line with the input"):
        place = '[[place]]\nshaft = 3\ny = "0 mm"\n'
        load(written(tmp_path, asked("coaxial = true") + layout + place))


@slow
def test_a_front_of_coaxial_drives_holds_the_best_of_every_row(tmp_path):
    text = asked("coaxial = true").replace(
        "[rating]\n", '[objective]\ndensity = "7.85 kg/dm^3"\n[rating]\n', 1
    )
    path = written(tmp_path, text)
    front = gearopt.pareto(path, objectives=["gear_volume", "mesh_loss"])
    best = [gearopt.solve(path, {"objective.minimise": n}).value for n in front.names]
    assert front.status == "complete"
    ends = [min(point.values[k] for point in front.points) for k in (0, 1)]
    assert ends == pytest.approx(best, rel=1e-9)
    for point in front.points:
        first, second = (s["centre_distance_mm"] for s in point.design["stages"])
        assert first == second


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (asked("coaxial = true", '"100 mm"'), "no centre_distance in common"),
        (
            asked('sum_of_centre_distances = "251 mm"'),
            'Write, for example, sum_of_centre_distances = "250 mm"',
        ),
        (asked("coaxial = true").replace(f"centre_distance = {LIST}", "", 1), "in every"),
    ],
)
def test_rows_that_there_are_none_of_are_refused(tmp_path, text, told):
    with pytest.raises(SceneError) as refusal:
        load(written(tmp_path, text))
    assert told in str(refusal.value)
