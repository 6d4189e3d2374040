"""A file takes its gears from the answer of another: what follows, what is refused, by which name.

Values are held to files typed by hand and to closed forms.
"""

import json
import math
import tomllib

import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt.errors import GearoptError, SceneError
from gearopt.scenes.kind import Kind
from gearopt.scenes.reading import linked_files
from gearopt.scenes.reading.json_schema import reference
from gearopt.scenes.reading.load import kind_named

DRIVE = """gearopt = 1
kind = "drive"

[duty]
power = "15 kW"
input_speed = "1480 rpm"
output_speed = "120 rpm"
ratio_tolerance = "3 %"

[gears]
treatment = "carburised"
grade = 2
face_width_over_diameter = [0.3, 1]
pinion_face_width_excess = "4 mm"
rim_over_module = 4
web_over_face_width = 0.4
bore = "25 mm"

[[stage]]

[[stage]]
minimum_bending_safety = 1.2

[limits]
pinion_teeth = [18, 24]
stage_ratio = [3, 4.2]

[teeth]
modules = ["2 mm", "2.5 mm", "3 mm", "4 mm"]

[objective]
minimise = "mass"
density = "7.8 kg/dm^3"

[rating]
standard = "agma"
input_revolutions = 1e8
quality = 10
overload_factor = 1.25

[[load]]
power = "15 kW"
share = "30 %"

[[load]]
power = "10 kW"
input_speed = "1200 rpm"
share = "70 %"
"""
BEARINGS = {"bearing_stiffness": "400 kN/mm"}
PAIR = {"gearopt": 1, "kind": "pair", "gears": {"from": "drive.json", "stage": 2}}
DYNAMICS = PAIR | {"kind": "dynamics", "pinion": BEARINGS, "wheel": BEARINGS, "mesh": {}}
RATING = {"gearopt": 1, "kind": "drive", "gears": {"from": "drive.json"}}
OF = {"pair": PAIR, "dynamics": DYNAMICS, "drive": RATING}


@pytest.fixture(scope="module")
def drive():
    """The answer to a drive of two spur stages."""
    result = gearopt.solve(tomllib.loads(DRIVE))
    assert result.status == "optimal"
    return result


@pytest.fixture
def kept(drive, tmp_path, monkeypatch):
    """A folder with that drive and its kept answer, which the commands are run in."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drive.toml").write_text(DRIVE)
    (tmp_path / "drive.json").write_text(drive.to_json())
    return tmp_path


def leaves(value, place=()):
    """Yield place and value of everything in tables and lists."""
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(inner, (*place, key))
    else:
        yield place, value


def same(one, two, apart=()):
    """Whether two designs are equal but for rounding."""
    first, second = ({p: v for p, v in leaves(each) if not {*p} & {*apart}} for each in (one, two))
    assert first.keys() == second.keys()
    for place, value in first.items():
        if isinstance(value, float):
            assert value == pytest.approx(second[place], rel=1e-12, abs=1e-15), place
        else:
            assert value == second[place], place


def by_hand(drive):
    """The second stage of the drive, typed by hand: its loads and speeds by its own arithmetic."""
    first, stage = drive.design["stages"]
    ratio = first["wheel_teeth"] / first["pinion_teeth"]
    gears = {"treatment": "carburised", "grade": 2, "pinion_face_width_excess": "4 mm"}
    gears |= {"rim_over_module": 4, "web_over_face_width": 0.4, "bore": "25 mm"}
    sizes = {"pinion_teeth": stage["pinion_teeth"], "wheel_teeth": stage["wheel_teeth"]}
    sizes |= {"module": f"{stage['normal_module_mm']} mm", "minimum_bending_safety": 1.2}
    rating = {"standard": "agma", "input_revolutions": 1e8 / ratio, "quality": 10}
    return {
        "gearopt": 1,
        "kind": "pair",
        "duty": {"power": "15 kW", "input_speed": f"{1480 / ratio!r} rpm"},
        "gears": gears,
        "stage": [sizes | {"face_width": f"{stage['face_width_mm']!r} mm"}],
        "rating": rating | {"overload_factor": 1.25},
        "load": [
            {"power": "15 kW", "share": "30 %"},
            {"power": "10 kW", "input_speed": f"{1200 / ratio!r} rpm", "share": "70 %"},
        ],
        "objective": {"density": "7.8 kg/dm^3"},
    }


def test_a_pair_is_the_one_typed_by_hand(kept, drive):
    taken, typed = gearopt.solve(PAIR), gearopt.solve(by_hand(drive))
    same(taken.design, typed.design)
    assert taken.limits == pytest.approx(typed.limits, rel=1e-12)
    digest = linked_files.hashlib.sha256((kept / "drive.json").read_bytes()).hexdigest()
    assert taken.report["inputs"] == {"drive.json": digest}
    assert taken.asked == PAIR


def test_a_stage_is_rated_as_in_its_drive(kept, drive):
    whole = [gear for gear in drive.design["rating"]["gears"]]
    for number in (1, 2, None):
        again = gearopt.rate(RATING, {"gears.stage": number} if number else None)
        rows = again.design["rating"]["gears"]
        mine = [gear for gear in whole if number in (None, gear["stage"])]
        same(rows, mine, () if number is None else ("stage",))
        stages = [s for k, s in enumerate(drive.design["stages"], 1) if number in (None, k)]
        for made, found in zip(again.design["stages"], stages, strict=True):
            for name in ("pinion_mass_kg", "wheel_mass_kg", "pinion_torque_Nm", "pinion_bore_mm"):
                assert made[name] == pytest.approx(found[name], rel=1e-12)


def rings(stage, member):
    """Mass and moment of inertia of a gear by summing thin rings: rim, web, hub, bore."""
    width = stage.get(f"{member}_face_width_mm") or stage["face_width_mm"]
    rim = stage[f"{member}_root_diameter_mm"] - 2 * stage.get(f"{member}_rim_thickness_mm", 0.0)
    bore, web = (stage.get(f"{member}_{name}_mm", 0.0) for name in ("bore", "web_thickness"))
    edges = np.linspace(0.0, 0.5 * stage[f"{member}_diameter_mm"], 200_001)
    middle = 0.5 * (edges[1:] + edges[:-1])
    thick = np.where(middle > 0.5 * bore, width, 0.0)
    if web:
        hub = 0.5 * stage[f"{member}_hub_diameter_mm"]
        thick = np.where((middle > hub) & (middle < 0.5 * rim), web, thick)
    mass = 7.8e-6 * math.pi * (edges[1:] ** 2 - edges[:-1] ** 2) * thick
    return mass.sum(), (mass * middle**2).sum()


def test_bodies_follow_from_their_dimensions(kept, drive):
    """Base circles are m z cos(20 deg); bodies are summed up ring by ring."""
    stage = drive.design["stages"][1]
    scene = gearopt.load(DYNAMICS)
    for member in ("pinion", "wheel"):
        rotor = getattr(scene, member)
        base = stage["normal_module_mm"] * stage[f"{member}_teeth"] * math.cos(math.radians(20))
        assert rotor.base_diameter.value == pytest.approx(base, rel=1e-12)
        mass, inertia = rings(stage, member)
        assert 1e3 * rotor.mass.value == pytest.approx(mass, rel=1e-4)
        assert 1e3 * rotor.inertia.value == pytest.approx(inertia, rel=1e-4)
    assert stage["wheel_web_thickness_mm"] and stage["wheel_hub_diameter_mm"]
    first = drive.design["stages"][0]
    speed = 1480 * math.pi / 30 * first["pinion_teeth"] / first["wheel_teeth"]
    assert scene.mesh.speed.value == pytest.approx(speed, rel=1e-12)
    assert scene.pinion.torque.value == pytest.approx(15e6 / speed, rel=1e-12)
    assert scene.mesh.pressure_angle.value == pytest.approx(math.radians(20), rel=1e-12)


def test_solid_gears_are_discs(tmp_path):
    """Mass (pi/4) d^2 b rho and inertia m d^2/8; shifts chosen by the search count as in drives."""
    tables = tomllib.loads(DRIVE)
    for key in ("rim_over_module", "web_over_face_width", "bore", "pinion_face_width_excess"):
        del tables["gears"][key]
    tables |= {"shift": {"sum": 0.4}, "stage": [{}], "load": []}
    del tables["load"]
    tables["duty"]["output_speed"] = "400 rpm"
    found = gearopt.solve(tables)
    stage = found.design["stages"][0]
    taken = found.stage().dynamics(pinion=BEARINGS, wheel=BEARINGS)
    assert taken.status == "evaluated"
    scene = gearopt.load(found.stage()._file("dynamics", {"pinion": BEARINGS, "wheel": BEARINGS}))
    for member in ("pinion", "wheel"):
        d = stage[f"{member}_diameter_mm"]
        d += 2 * stage[f"{member}_profile_shift"] * stage["normal_module_mm"]
        mass = math.pi / 4 * d**2 * stage["face_width_mm"] * 7.8e-6
        rotor = getattr(scene, member)
        assert stage[f"{member}_profile_shift"] != 0.0
        assert stage[f"{member}_mass_kg"] == pytest.approx(mass, rel=1e-12)
        assert 1e3 * rotor.mass.value == pytest.approx(mass, rel=1e-12)
        assert 1e3 * rotor.inertia.value == pytest.approx(mass * d**2 / 8, rel=1e-12)


CONTRADICTIONS = [
    ("pair", "duty.power", "18 kW", "15 kW"),
    ("pair", "duty.torque", "700 N m", "N m"),
    ("pair", "duty.input_speed", "1480 rpm", "rpm"),
    ("pair", "duty.output_speed", "45 rpm", "rpm"),
    ("pair", "duty.ratio", 5, ""),
    ("pair", "stage[1].module", "5 mm", "mm"),
    ("pair", "stage[1].diametral_pitch", 4, ""),
    ("pair", "stage[1].pinion_teeth", 31, ""),
    ("pair", "stage[1].wheel_teeth", 95, ""),
    ("pair", "stage[1].face_width", "99 mm", "mm"),
    ("pair", "stage[1].face_width_over_diameter", 0.9, ""),
    ("pair", "stage[1].centre_distance", "300 mm", "mm"),
    ("pair", "stage[1].helix_angle", "10 deg", "0 deg"),
    ("pair", "gears.pressure_angle", "25 deg", "20 deg"),
    ("pair", "stage[1].pinion.profile_shift", 0.2, "0"),
    ("pair", "gears.tool_addendum", 1.4, "1.25"),
    ("pair", "stage[1].wheel.bore", "30 mm", "25 mm"),
    ("pair", "gears.treatment", "nitrided", '"carburised"'),
    ("pair", "stage[1].wheel.grade", 1, "2"),
    ("pair", "rating.standard", "both", '"agma"'),
    ("pair", "rating.life", "5 h", "h"),
    ("pair", "rating.reliability", "99.9 %", "0.99"),
    ("pair", "rating.accuracy", 9, "7"),
    ("pair", "rating.minimum_contact_safety", 1.5, "1"),
    ("pair", "load[1].power", "14 kW", "15 kW"),
    ("pair", "load[2].share", "60 %", "0.7"),
    ("pair", "objective.density", "7.2 kg/dm^3", "7.8 kg/dm^3"),
    ("pair", "limits.pinion_teeth", [20, 30], "not given"),
    ("dynamics", "pinion.base_diameter", "100 mm", "mm"),
    ("dynamics", "wheel.mass", "1 kg", "kg"),
    ("dynamics", "wheel.inertia", "1 kg m^2", "kg m^2"),
    ("dynamics", "pinion.torque", "200 N m", "N m"),
    ("dynamics", "wheel.torque", "200 N m", "N m"),
    ("dynamics", "mesh.teeth", 40, ""),
    ("dynamics", "mesh.speed", "3000 rpm", "rpm"),
    ("dynamics", "mesh.pressure_angle", "25 deg", "20 deg"),
    ("dynamics", "mesh.pair", "other.toml", '"drive.json"'),
    ("drive", "duty.power", "18 kW", "15 kW"),
    ("drive", "stages", 2, "not given"),
]


@pytest.mark.parametrize(("kind", "key", "value", "there"), CONTRADICTIONS)
def test_what_contradicts_the_gears_is_refused_by_name(kept, kind, key, value, there):
    changes = {"stage": [{}], "load": [{}, {}]} if kind == "pair" else {}
    changes = {k: v for k, v in changes.items() if key.startswith(k)} | {key: value}
    with pytest.raises(SceneError) as wrong:
        gearopt.load(OF[kind], changes)
    error = wrong.value
    of = "drive.json" if kind == "drive" else "stage 2 of drive.json"
    assert len(error.errors) == 1 and error.key == key
    assert error.value == (json.dumps(value) if not isinstance(value, list) else "[20, 30]")
    assert error.rule.startswith(f"contradicts {of}, whose gears this file takes: it is ")
    assert there in error.rule and error.remedy == "Remove it"
    assert (error.fix.action, error.fix.key) == ("remove", error.key)


def test_teeth_excite_a_mean_stiffness_by_their_error_under_load(kept):
    """The frequencies are those of the changing stiffness, whose mean is kept."""
    plain = gearopt.solve(DYNAMICS).design["equilibrium"]
    mesh = {"wave": "constant", "transmission_error": "pair"}
    result = gearopt.solve(DYNAMICS | {"mesh": mesh})
    same(result.design["equilibrium"], plain)
    said = " ".join(result.report["assumptions"])
    assert "changes in steps" not in said
    assert "The mesh stiffness is the mean over a base pitch of the normal force over" in said
    assert "as the mesh stiffness is constant, it stands for its variation, too" in said
    bare = gearopt.solve(DYNAMICS | {"mesh": {"transmission_error": "pair"}}).report["assumptions"]
    assert any("changes in steps, as teeth without relief" in sentence for sentence in bare)
    assert any("have no transmission error: nothing is off" in sentence for sentence in bare)
    half = gearopt.solve(DYNAMICS | {"mesh": mesh | {"stiffness": "100 kN/mm"}})
    assert half.design["equilibrium"]["mean_stiffness_N_per_mm"] == 1e5


AGREEING = [
    ("pair", {"duty.power": "15000 W", "gears.treatment": "carburised", "gears.tip_chamfer": 0}),
    ("pair", {"rating.standard": "agma", "rating.accuracy": 7, "rating.reliability": "99 %"}),
    ("pair", {"stage": [{"helix_angle": "0 deg", "minimum_bending_safety": 1.2}]}),
    ("dynamics", {"mesh.pressure_angle": "20.01 deg", "mesh.wave": "pair"}),
    ("drive", {"duty.output_speed": "120 rpm", "objective.density": "7800 kg/m^3"}),
]


@pytest.mark.parametrize(("kind", "changes"), AGREEING)
def test_what_agrees_is_taken_and_changes_nothing(kept, kind, changes):
    """Digits that a file rounds off do not count: the gears are those of the other file."""
    answer = gearopt.rate if kind == "drive" else gearopt.solve
    same(answer(OF[kind], changes).design, answer(OF[kind]).design)


def test_all_contradictions_are_told_at_once(kept):
    changes = {"duty.power": "18 kW", "rating.quality": 8, "duty.input_speed": "18"}
    with pytest.raises(SceneError) as wrong:
        gearopt.load(PAIR, changes)
    assert [error.key for error in wrong.value.errors] == [*changes][:1] + [
        "duty.input_speed",
        "rating.quality",
    ]


@pytest.mark.parametrize(
    ("changes", "key", "rule"),
    [
        ({"gears.stage": 3}, "gears.stage", "none of its stages: drive.json has stages 1 and 2"),
        ({"gears.stage": None}, "gears.stage", "is missing: drive.json has stages 1 and 2"),
        ({"gears.stage": "2"}, "gears.stage", "is a text, not a whole number"),
        ({"gears.from": None}, "gears.stage", "no key `from` names one"),
        ({"gears.from": "none.json"}, "gears.from", "does not exist"),
        ({"gears.from": 7}, "gears.from", "is not the name of a file"),
    ],
)
@pytest.mark.parametrize("kind", ["pair", "dynamics"])
def test_a_wrong_source_is_told(kept, kind, changes, key, rule):
    with pytest.raises(SceneError) as wrong:
        gearopt.load(OF[kind], changes)
    assert wrong.value.key == key and rule in wrong.value.rule


def test_the_name_of_a_missing_file_is_held_to_those_beside(kept):
    with pytest.raises(SceneError) as wrong:
        gearopt.load(PAIR, {"gears.from": "drve.json"})
    assert wrong.value.remedy.startswith('Did you mean "drive.json", which stands beside it? Name')


@pytest.mark.parametrize(("key", "name"), [("stage", "stge"), ("from", "fron")])
def test_a_misspelt_key_is_told_in_the_place_of_the_one_it_lacks(kept, key, name):
    gears = PAIR["gears"] | {key: None, name: PAIR["gears"][key]}
    with pytest.raises(SceneError) as wrong:
        gearopt.load(PAIR | {"gears": {k: v for k, v in gears.items() if v is not None}})
    (error,) = wrong.value.errors
    assert (error.key, error.rule) == (f"gears.{name}", "unknown key")
    assert f"Did you mean {key}?" in str(error)


def test_needed_keys_that_a_taking_file_leaves_out_are_said_to_follow(kept):
    scene, text = gearopt.load(DYNAMICS), reference("dynamics")
    for table in (scene.pinion, scene.mesh):
        needed = {n for n, field in type(table).model_fields.items() if field.is_required()}
        follow = {n for n in needed if f"| `{n}` | yes, or by `from` |" in text}
        assert follow == needed - {*BEARINGS}


def source(folder, name, text):
    (folder / name).write_text(text)
    return {"gears.from": name, "gears.stage": 1}


SPUR = """gearopt = 1
kind = "drive"
[duty]
power = "5 kW"
input_speed = "300 rpm"
[gears]
treatment = "carburised"
[[stage]]
{0}
module = "3 mm"
pinion_teeth = 20
wheel_teeth = 60
face_width = "30 mm"
[rating]
standard = "agma"
life = "20000 h"
quality = 8
"""


@pytest.mark.parametrize("kind", few(["pair", "dynamics"], 1))
def test_stages_that_no_pair_can_be_are_named(kept, kind):
    where = source(kept, "faster.toml", SPUR.format('driver = "wheel"'))
    with pytest.raises(SceneError, match=r"stage 1 of faster.toml is driven by its wheel"):
        gearopt.load(OF[kind], where)
    for name, line in (("spur", ""), ("helical", 'helix_angle = "12 deg"')):
        gearopt.load(OF[kind], source(kept, f"{name}.toml", SPUR.format(line)))


def test_an_impossible_drive_is_told_with_its_status(kept):
    wrong = DRIVE.replace('modules = ["2 mm", "2.5 mm", "3 mm", "4 mm"]', 'modules = ["1 mm"]')
    with pytest.raises(SceneError, match=r"small.toml: its design is an input.*\(infeasible: "):
        gearopt.load(PAIR, source(kept, "small.toml", wrong))


def test_gears_of_a_stopped_run_are_told(kept, drive):
    stopped = json.loads(drive.to_json()) | {"status": "limit"}
    (kept / "drive.json").write_text(json.dumps(stopped))
    for answer in (gearopt.solve(PAIR), gearopt.rate(RATING)):
        assert "those that drive.json had when its time ended" in answer.report["notes"][-1]


def test_files_that_need_each_other_are_refused(kept):
    tables = 'gearopt = 1\nkind = "pair"\n[gears]\nfrom = "{0}.toml"\n'
    for name, other in (("one", "two"), ("two", "one")):
        (kept / f"{name}.toml").write_text(tables.format(other))
    with pytest.raises(SceneError, match="is a file that needs this one as its input"):
        gearopt.load(kept / "one.toml")


@pytest.mark.slow
def test_another_power_moves_all_three(kept, drive):
    """A chain of files: of the stronger drive pair and dynamics have the larger load."""
    (kept / "pair.toml").write_text(
        'gearopt = 1\nkind = "pair"\n[gears]\nfrom = "drive.toml"\nstage = 2\n'
    )
    tables = DYNAMICS | {"gears": {"from": "pair.toml"}}
    forces, masses = [], []
    for power in ("15 kW", "22 kW"):
        (kept / "drive.toml").write_text(DRIVE.replace('"15 kW"', f'"{power}"'))
        pair, motion = gearopt.solve(kept / "pair.toml"), gearopt.solve(tables)
        contact, stage = pair.design["contact"], pair.design["stages"][0]
        force = 2e3 * stage["pinion_torque_Nm"] / stage["pinion_diameter_mm"]
        force /= math.cos(math.radians(20))
        assert contact["loads"][0]["normal_force_N"] == pytest.approx(force, rel=1e-9)
        load = motion.design["equilibrium"]["normal_load_N"]
        assert load == pytest.approx(force, rel=1e-9)
        assert [*motion.report["inputs"]] == ["pair.toml", "drive.toml"]
        forces.append(force)
        masses.append(pair.design["mass_kg"])
    assert masses[1] > masses[0] == pytest.approx(drive.design["stages"][1]["mass_kg"])
    assert forces[1] != pytest.approx(forces[0], rel=1e-3)


def test_stages_of_one_file_are_told_apart(kept, drive):
    """Its answer is kept for the next one that asks, for each stage anew."""
    for number in (2, 1):
        changes = {"gears.from": "drive.toml", "gears.stage": number}
        stage = drive.design["stages"][number - 1]
        scene = gearopt.load(DYNAMICS, changes)
        assert scene.mesh.teeth == stage["pinion_teeth"]
        assert 1e3 * scene.wheel.mass.value == pytest.approx(stage["wheel_mass_kg"])
        contact = scene.mesh.pair.result(None).design["contact"]
        pair = gearopt.solve(PAIR, changes).design["contact"]
        assert contact["base_pitch_mm"] == pair["base_pitch_mm"]
        assert contact["loads"][0]["normal_force_N"] == pair["loads"][0]["normal_force_N"]


@pytest.mark.slow
def test_a_source_is_solved_once_with_the_budget_of_the_asker(kept, monkeypatch):
    solved, budgets = Kind.solve, []

    def counted(kind, scene, ask):
        if kind is kind_named("drive"):
            budgets.append(ask.budget.seconds)
        return solved(kind, scene, ask)

    monkeypatch.setattr(Kind, "solve", counted)
    monkeypatch.setattr(linked_files, "_SOLVED", {})
    changes = {"gears.from": "drive.toml", "relief": {}, "relief.loads": [1]}
    gearopt.explain(PAIR, changes, budget=gearopt.Budget(40))
    assert budgets == [20.0]


@pytest.mark.slow
def test_numbers_of_the_file_itself_are_explained(kept):
    changes = {"relief.loads": [1]}
    explained = gearopt.explain(PAIR, changes, budget=gearopt.Budget(5))
    assert {i.key for i in explained.influences} <= {"relief.loads[1]"}
    assert "the numbers of drive.json are not among these" in explained.message
    scene = gearopt.load(PAIR, changes)
    same(gearopt.solve(scene).design, gearopt.solve(PAIR, changes).design)
    asked = {**PAIR["gears"]}
    assert gearopt.solve(scene).asked["gears"] == asked


@pytest.mark.slow
def test_python_goes_the_same_way(kept, drive):
    same(drive.stage(2).pair().design, gearopt.solve(PAIR).design)
    motion = drive.stage(2).dynamics(pinion=BEARINGS, wheel=BEARINGS)
    same(motion.design, gearopt.solve(DYNAMICS).design)
    pair = drive.stage(2).pair(sharing={"loads": [0.5, 1]})
    again = pair.stage().dynamics(pinion=BEARINGS, wheel=BEARINGS)
    assert again.design["equilibrium"] == motion.design["equilibrium"]
    same(drive.stage().rate().design, gearopt.rate(RATING).design)
    with pytest.raises(GearoptError, match="stage.3.: the result has stages 1 and 2"):
        drive.stage(3)
    with pytest.raises(TypeError, match="write budget=Budget.seconds=10."):
        drive.stage(2).pair(seconds=10)
    packing = gearopt.Result(name="packing", status="feasible", method="", objective={})
    with pytest.raises(SceneError, match="is of kind a problem, not drive or pair"):
        packing.stage().pair()


def test_what_the_other_file_states_is_not_called_a_default(drive):
    """The drive has an overload factor, no reliability."""
    for said in (drive.report, drive.stage(2).rate().report):
        (unstated,) = (words for words in said["assumptions"] if words.startswith("Not in the"))
        assert "reliability 99 % (default)" in unstated and "overload factor" not in unstated


def test_a_kept_result_is_rated_as_it_is(kept, drive, here):
    told = here("rate", kept / "drive.json", "--json")
    assert told.returncode == 0, told.stderr
    same(json.loads(told.stdout)["design"]["rating"], drive.design["rating"], ("flaws",))
    (kept / "odd.json").write_text("{}")
    assert here("rate", kept / "odd.json").returncode == 2


@pytest.mark.parametrize("name", ["same_materials", "three_stage_by_both", "unit_of_r20"])
@pytest.mark.slow
def test_drives_of_materials_spectra_and_distances_are_rated_alike(solved, name):
    drive = solved(name)
    for number in range(1, len(drive.design["stages"]) + 1):
        rated = drive.stage(number).rate().design
        rows = [g for g in drive.design["rating"]["gears"] if g["stage"] == number]
        for mine, held in zip(rated["rating"]["gears"], rows, strict=True):
            for key in ("bending_safety", "contact_safety", "life_h"):
                if mine.get(key) is None or held.get(key) is None:
                    assert mine.get(key) == held.get(key)
                else:
                    assert mine[key] == pytest.approx(held[key], rel=1e-9)
        stage = drive.design["stages"][number - 1]
        for key in ("pinion_mass_kg", "wheel_mass_kg", "mass_kg", "pinion_torque_Nm"):
            assert rated["stages"][0][key] == pytest.approx(stage[key], rel=1e-9)
