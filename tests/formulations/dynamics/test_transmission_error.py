"""The transmission error of a file of kind pair, and K_v beside the dynamic factor, by hand."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.formulations.dynamics.motion.balance import linear_orbit
from gearopt.formulations.dynamics.orbit.collocation import mesh_force
from gearopt.formulations.dynamics.orbit.parting_text import moving
from gearopt.formulations.dynamics.orbit.task import pair_of, parts
from gearopt.formulations.dynamics.parts import unloaded_error
from gearopt.formulations.pair.design import PairContact, PairRelief
from gearopt.optimise.typed import typed
from gearopt.scenes.dynamics import KIND
from gearopt.scenes.dynamics.stiffness_of_teeth import of_teeth
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.load import load

PROBLEMS = Path(__file__).parents[3] / "problems"


@pytest.fixture(scope="module")
def relieved(tmp_path_factory):
    """The pair of relief_two_loads.toml, whose relief is fixed, solved and kept."""
    found = gearopt.solve(PROBLEMS / "relief_two_loads.toml")
    path = tmp_path_factory.mktemp("pair") / "pair.json"
    path.write_text(found.to_json())
    return found.design, path


def with_error(path, wave):
    content = tomllib.loads((PROBLEMS / "teeth_as_springs.toml").read_text())
    for table in ("simulate", "speeds"):
        content.pop(table)
    content["mesh"] |= {"pair": str(path), "transmission_error": "pair"} | wave
    return content


@pytest.mark.slow
def test_unloaded_teeth_are_apart_by_the_least_relief_of_pairs_in_contact(relieved):
    """a (1 - x/l)^p from each tip, over the travel of one base pitch, by the laws themselves."""
    design, _ = relieved
    contact = typed(PairContact, design["contact"], "contact")
    relief = typed(PairRelief, design["relief"], "relief")
    last = contact.position_mm[-1]

    def removed(s):
        depth = 0.0
        for flank, x in ((relief.wheel, s - contact.position_mm[0]), (relief.pinion, last - s)):
            if 0.0 <= x < flank.length_mm:
                depth += flank.amount_mm * (1.0 - x / flank.length_mm) ** flank.exponent
        return depth

    known = []
    for travel in contact.travel_mm:
        places = [contact.position_mm[0] + travel + k * contact.base_pitch_mm for k in range(2)]
        known.append(min(removed(s) for s in places if s <= last + 1e-9))
    assert unloaded_error(contact, relief) == pytest.approx(known, abs=1e-6)
    assert max(known) > 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("wave", [{}, {"wave": "constant", "stiffness": "400 kN/mm"}])
def test_at_low_speeds_error_and_deformation_are_the_loaded_transmission_error(relieved, wave):
    """Nothing counts twice: e - delta = TE under load, or varies as that where k is constant."""
    design, path = relieved
    scene = load(with_error(path, wave)).scene
    given = of_teeth(scene, Ask())
    pair = scene.pair(given.wave, given.error)
    count = 1024
    delta = linear_orbit(pair, "fixed", 1e-2, 200).delta(count)
    turn = 2j * math.pi * np.arange(count) / count
    e = sum((v * np.exp(h * turn)).real for h, v in enumerate(pair.error, 1))
    contact = typed(PairContact, design["contact"], "contact")
    at = next(one for one in typed(PairRelief, design["relief"], "relief").at if one.load == 1.0)
    phase = np.array(contact.travel_mm) / contact.base_pitch_mm
    loaded = np.interp(np.arange(count) / count, phase, at.transmission_error_mm)
    difference = e - delta - loaded
    assert np.std(difference) < 0.05 * np.std(loaded)
    said = "stands for its variation" if wave else "not in it, but in the stiffness"
    assert any(said in sentence for sentence in given.assumed)


@pytest.mark.parametrize(
    ("mesh", "key", "rule"),
    [
        ({"transmission_error": "pair"}, "mesh.pair", "needs it"),
        ({"damping_acts": "always", "backlash": None}, "mesh.damping_acts", "changes nothing"),
        ({"face_width": "20 mm"}, "mesh.face_width", "changes nothing"),
        ({"speed": None, "error_cosines": ["1 um"], "wave": "constant"}, "mesh.speed", "missing"),
    ],
)
def test_what_is_incomplete_or_changes_nothing_is_refused(mesh, key, rule):
    content = tomllib.loads(KIND.example.text)
    left = {"stability", "speeds"} | (set() if mesh.get("wave") else {"simulate"})
    content = {k: v for k, v in content.items() if k not in left}
    away = ("depth", "duty", "ramp") if mesh.get("wave") else ()
    mesh = content["mesh"] | mesh
    content["mesh"] = {k: v for k, v in mesh.items() if v is not None and k not in away}
    with pytest.raises(SceneError) as wrong:
        gearopt.solve(content)
    assert key in str(wrong.value) and rule in str(wrong.value)


@pytest.mark.parametrize("keys", [("error_cosines", ["1 um"]), ("transmission_error", "harmonics")])
def test_a_pair_to_optimise_has_no_errors(keys):
    content = tomllib.loads((PROBLEMS / "least_vibration.toml").read_text())
    content["mesh"][keys[0]] = keys[1]
    with pytest.raises(SceneError, match="is not in .optimise., which is of teeth without errors"):
        gearopt.solve(content)


def test_the_factors_of_both_standards_are_those_by_hand():
    """Pinion of 30 teeth at 3000 rpm: m = 4.2567 mm, v = 20.06 m/s, N = 1500 Hz/4150 Hz.

    ISO 1328-1:1995, grade 6, of a range mean of module (3.5 to 6) and diameter (125 to 280).
    """
    content = tomllib.loads(KIND.example.text)
    for table in ("stability", "speeds"):
        content.pop(table)
    content["mesh"] |= {"face_width": "10 mm", "accuracy_grade": 6}
    found = gearopt.solve(content).design["standard"]
    m, d = math.sqrt(3.5 * 6.0), math.sqrt(125.0 * 280.0)
    step = 2.0 ** (0.5 * (6 - 5))
    f_pt = round(step * (0.3 * (m + 0.4 * math.sqrt(d)) + 4.0), 1)
    f_f = round(step * (2.5 * math.sqrt(m) + 0.17 * math.sqrt(d) + 0.5), 1)
    f_pt, f_f = (round(2.0 * v) / 2.0 if v < 10.0 else round(v) for v in (f_pt, f_f))
    line = 2e5 / 60.0 * math.cos(math.radians(20.0)) / 10.0  # N/mm
    single = 2e5 / 10.0 / (0.75 * 1.68 + 0.25) * 1e-3  # N/(mm um)
    n = 1500.0 / (math.sqrt(2e5 * 3400.0) / (2.0 * math.pi))
    off = 0.32 * single * f_pt * math.cos(math.radians(20.0)) / line + 0.34 * single * f_f / line
    assert found["own_iso"] == pytest.approx(1.0 + n * (off + 0.23), rel=1e-3)
    feet = math.pi * 120.0 / math.cos(math.radians(20.0)) * 50.0 * 60.0 / 304.8  # a minute
    known = ((92.0 + math.sqrt(feet)) / 92.0) ** 0.25
    assert found["own_agma"] == pytest.approx(known, rel=1e-5)
    content["mesh"].pop("accuracy_grade")
    found = gearopt.solve(content).design["standard"]
    assert found.get("own_iso") is None and "[mesh] accuracy_grade is missing" in found["missing"]


HELICAL = {  # 20/40 teeth, 3 mm, 15 degrees, in few slices
    "gearopt": 1,
    "kind": "pair",
    "duty": {"power": "20 kW", "input_speed": "1500 rpm"},
    "gears": {"treatment": "carburised", "helix_angle": "15 deg"},
    "stage": [{"module": "3 mm", "pinion_teeth": 20, "wheel_teeth": 40, "face_width": "40 mm"}],
    "rating": {"standard": "iso6336", "life": "1e4 h", "iso6336": {"accuracy_grade": [6, 5]}},
    "flank": {"slices": 11},
    "sharing": {"positions": 12, "coupling": "none", "level": "profile + Sainsot"},
}


def test_helical_gears_have_the_factor_of_iso_by_hand_at_the_grade_of_their_rating():
    """ISO 6336-1, table 8, of eps_gamma > 2; f_pb = f_pt cos alpha_t of ISO 1328-1:1995."""
    pair, bearings = gearopt.solve(HELICAL), {"bearing_stiffness": "400 kN/mm"}
    asked = {"pinion": bearings, "wheel": bearings, "speeds": {"range": ["900 rpm", "1500 rpm"]}}
    asked["speeds"]["points"] = 2
    found = pair.stage().dynamics(**asked).design
    rest, (mesh,) = found["equilibrium"], pair.design["rating"]["meshes"]
    ratio, overlap = mesh["transverse_contact_ratio"], mesh["overlap_ratio"]
    k, total = rest["mean_stiffness_N_per_mm"] / 40.0, ratio + overlap
    assert total > 2.0
    beta = math.radians(15.0)
    m, d = math.sqrt(2.0 * 3.5), math.sqrt(50.0 * 125.0)
    step = 2.0 ** (0.5 * (6 - 5))
    f_pt = round(2.0 * step * (0.3 * (m + 0.4 * math.sqrt(d)) + 4.0)) / 2.0
    f_f = round(2.0 * step * (2.5 * math.sqrt(m) + 0.17 * math.sqrt(d) + 0.5)) / 2.0
    line = 2e4 / (1500.0 * math.pi / 30.0) / (30e-3 / math.cos(beta)) / 40.0
    single = k / (0.75 * ratio + 0.25) * 1e-3  # N/(mm um)
    transverse = math.atan(math.tan(math.radians(20.0)) / math.cos(beta))
    pitch = 0.32 * single * f_pt * math.cos(transverse) / line
    rest_of = 0.57 / (total - 0.3) * single * f_f / line + 0.096 / (total - 1.56)
    turn = math.sqrt(1e6 * k * 40.0 / (1e3 * rest["mesh_mass_kg"])) / 20.0  # rad/s
    known = [1.0 + n * math.pi / 30.0 / turn * (pitch + rest_of) for n in (900.0, 1500.0)]
    assert found["standard"]["iso"] == pytest.approx(known, rel=2e-3)
    with pytest.raises(SceneError, match="mesh.accuracy_grade = 8: contradicts .* it is 6 there"):
        pair.stage().dynamics(**asked, mesh={"accuracy_grade": 8})


def test_damping_that_acts_always_is_that_of_the_problem_to_optimise_too():
    """Apart, at 5 um and 2 mm/s: the collocated mesh pushes by c_0 v alone, c_0 of its pair."""
    content = tomllib.loads((PROBLEMS / "least_vibration_parting.toml").read_text())
    content["mesh"]["damping_acts"] = "always"
    task = load(content).scene.task
    point = [0.5 * (low + high) for low, high in task.ranges.values()]
    point[2] = 0.05
    pair = pair_of(task, point, 3000.0)
    law = moving(task, point[0], parts(task, *point[:2], *point[3:]), 1e-6)
    assert pair.damping == 0.0 and pair.drag > 0.0
    apart = mesh_force(law, pair.wave.mean, 5.0, 2000.0)  # um, um/s
    assert apart == pytest.approx(2000.0 * pair.drag, rel=1e-6)
