"""What a servo axis achieves with its train, and files that ask for less than everything."""

import io
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from scene_files import dump, parse

import gearopt
from gearopt.errors import SceneError
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.report.pages.result import page, sections, tables
from gearopt.report.terminal import show
from gearopt.scenes.reading.load import read
from gearopt.scenes.servo.explain import remedies

PROBLEMS = Path(__file__).parents[3] / "problems"
FAST = (PROBLEMS / "servo_gimbal_fast.toml").read_text(encoding="utf-8")
QUICK = (PROBLEMS / "servo_gimbal_quick.toml").read_text(encoding="utf-8")
FEW = {"modules": ["0.3 mm", "0.5 mm"], "pinion_teeth": [16, 26]}  # of trains, for quick tests
SWING = {"motion": "swing", "amplitude": "20 deg", "frequency": "2 Hz"}


def scene(base, **tables_of):
    """A file with keys of its tables set, dropped (None), or a whole table set or dropped."""
    content = parse(base)
    for name, keys in tables_of.items():
        if isinstance(keys, dict) and isinstance(content.get(name), dict):
            content[name] |= keys
            content[name] = {k: v for k, v in content[name].items() if v is not None}
        else:
            content[name] = keys
    content = {k: v for k, v in content.items() if v is not None}
    return read(dump(content).encode(), "my.toml")[1]


@pytest.fixture(scope="module")
def fast(solved):
    return solved("servo_gimbal_fast")


@pytest.fixture(scope="module")
def ranged():
    """Least inertia of a train whose ratio has a range: the duty is judged, it does not choose."""
    told = scene(FAST, train=FEW | {"ratio": [40, 60], "maximise": None, "minimise": "inertia"})
    return gearopt.Result.from_json(gearopt.solve(told).to_json())


def shown(result):
    console = Console(width=99, record=True, file=io.StringIO())
    show(result, console)
    return console.export_text()


def law(n, gears):
    """Acceleration of the gimbal with gears [kg m2] at the motor, by the balance of torques."""
    friction = 4.3 * 0.0980665
    return (n * (0.05 - 0.003) - friction) / (1.98e-2 + n**2 * (8.6e-6 + gears))


def test_a_duty_is_judged_at_the_chosen_train_not_amid_a_range(ranged):
    found, train = ranged.design["ratio"], ranged.design["train"]
    first, second = train["stages"]
    n = first["wheel_teeth"] * second["wheel_teeth"]
    n /= first["pinion_teeth"] * second["pinion_teeth"]
    assert train["ratio"] == pytest.approx(n, rel=1e-15) and 40.0 <= n < 41.0
    chosen = found["chosen"]
    assert chosen["total_ratio"] == train["ratio"]
    assert chosen["value"] == pytest.approx(law(n, train["inertia_kg_m2"]), rel=1e-12)
    assert chosen["loss_percent"] == pytest.approx(100 * (1 - chosen["value"] / found["value"]))
    assert found["given"] is None and "given_load_acceleration_rad_per_s2" not in ranged.report
    assert "ratio_error_percent" not in train
    key = "load_acceleration_rad_per_s2"
    assert ranged.report[f"chosen_{key}"] == chosen["value"]
    assert ranged.report[f"given_train_{key}"] == pytest.approx(law(48, 7.534246e-7), rel=1e-9)
    (one,) = ranged.report["stage_counts"][0]["ratios_of_least_inertia"]
    assert one == pytest.approx(n, rel=1e-12)


def test_the_chosen_train_is_told_on_terminal_and_page(ranged):
    number = f"{ranged.design['ratio']['chosen']['value']:.5g}"
    value = f"{number} rad/s²"
    section = {s.heading: s for s in sections(ranged)}["Total ratio"]
    _, rows = section.tables[0].on_terminal
    cells = {row[0].text: [cell.text for cell in row[1:]] for row in rows}
    assert number in cells["load acceleration [rad/s²]"] and "48" in cells["total ratio"]
    assert "7.5342" in cells["inertia of the train [g cm²]"] and number in shown(ranged)
    assert "ratio error" not in shown(ranged) and "ratio error" not in page(ranged, "x")
    table = tables(ranged)["motor-and-load.csv"]
    heads = "best ratio, without gears", "best ratio, same inertia", "chosen train", "given train"
    assert all(head in table.splitlines()[0] for head in heads)
    tiles = {t.name: t for t in sections(ranged)[0].tiles}
    assert tiles["load acceleration of the train"].value == value


@pytest.mark.slow
def test_nothing_exceeds_the_best_ratio_without_gears(fast):
    found = fast.design["ratio"]
    ladder = [found[who]["value"] for who in ("best", "best_with_train", "chosen", "given_train")]
    assert ladder == sorted(ladder, reverse=True) and ladder[0] == found["value"]
    bound = fast.report["real_valued_bound_load_acceleration_rad_per_s2"]
    assert found["best"]["value"] > bound >= found["chosen"]["value"]
    assert fast.bound <= fast.value == pytest.approx(1.0 / found["chosen"]["value"], rel=1e-12)
    assert "Not even real-valued teeth and modules within the limits give more" in shown(fast)


def test_the_torque_of_the_motor_is_shared_out(ranged):
    for who in ("best", "chosen", "given_train"):
        one = ranged.design["ratio"][who]
        parts = [v for k, v in one.items() if k.startswith("torque_to_")]
        assert sum(parts) == pytest.approx(100.0) and len(parts) == 3 + (who != "best")
        assert one["motor_torque_used_percent"] == pytest.approx(100.0)
        gears = one.get("gear_inertia_kg_m2", 0.0)
        n = one["total_ratio"]
        ratio = 1.98e-2 / n**2 / (8.6e-6 + gears)
        assert one["inertia_ratio"] == pytest.approx(ratio, rel=1e-12)
        rotor = 100.0 * one["value"] * n * 8.6e-6 / 0.05
        assert one["torque_to_rotor_percent"] == pytest.approx(rotor, rel=1e-12)
        assert "motor_speed_rpm" not in one  # at standstill


@pytest.mark.slow
def test_speed_of_the_motor_in_a_move():
    move = {"motion": "move", "angle": "90 deg"}
    told = scene(QUICK, duty=move, train=FEW | {"ratio": [40, 50], "minimise": "inertia"})
    result = gearopt.solve(told)
    one = result.design["ratio"]["chosen"]
    n, gears = one["total_ratio"], one["gear_inertia_kg_m2"]
    a = law(n, gears)
    braking = 0.053 * n + 4.3 * 0.0980665  # friction brakes too
    both = 1.0 / a + (1.98e-2 + n * n * (8.6e-6 + gears)) / braking
    peak = math.sqrt(math.pi / both)
    assert peak < 800.0 / n and one["value"] == pytest.approx(math.sqrt(math.pi * both))
    assert one["motor_speed_rpm"] == pytest.approx(30 / math.pi * n * peak, rel=1e-12)
    assert one["motor_speed_used_percent"] == pytest.approx(100 * n * peak / 800, rel=1e-12)


@pytest.fixture(scope="module")
def swung():
    told = scene(
        FAST,
        duty=SWING,
        load={"friction": "0.1 N m"},
        train=FEW | {"maximise": None, "minimise": "rms_torque"},
    )
    return gearopt.solve(told)


@pytest.mark.slow
def test_torque_of_a_swing_is_rms_and_peak(swung):
    one = swung.design["ratio"]["chosen"]
    n, rotor = one["total_ratio"], 8.6e-6 + one["gear_inertia_kg_m2"]
    turn, w = 2 * math.pi * (np.arange(20_000) + 0.5) / 20_000, 4 * math.pi
    inertia = -math.radians(20) * w * w * np.sin(turn) * (1.98e-2 / n + n * rotor)
    torque = inertia + np.copysign(0.1 / n + 0.003, np.cos(turn))
    rms = math.sqrt(np.mean(torque**2))
    assert one["value"] == swung.value == pytest.approx(rms, rel=1e-6)
    assert one["peak_motor_torque_Nm"] == pytest.approx(np.abs(torque).max(), rel=1e-3)
    assert one["motor_torque_used_percent"] == pytest.approx(100 * one["value"] / 0.05, rel=1e-12)
    assert swung.status == "optimal" and swung.limits["motor_torque"] == pytest.approx(
        swung.value / 0.05
    )
    speed = 30 / math.pi * n * math.radians(20) * 4 * math.pi
    assert one["motor_speed_rpm"] == pytest.approx(speed, rel=1e-12)


@pytest.mark.slow
def test_the_word_of_the_file_is_understood(fast):
    """What `minimise = "acceleration"` asks for is the largest one, and the answer says so."""
    same = gearopt.solve(scene(FAST, train={"maximise": None, "minimise": "acceleration"}))
    assert same.value == fast.value and same.design["train"] == fast.design["train"]
    assert any("read as maximise" in note for note in same.report["notes"])
    assert "read as maximise" not in str(fast.report)
    assert "acceleration: acceleration 46.831 rad/s², proven" in shown(fast)
    assert 1.0 / fast.bound == pytest.approx(46.831, abs=5e-4) and fast.bound <= fast.value


UNASKED = ("error", "arcmin", "backlash", "shaft between", "tolerance", "stiffness", "nan", "None")


@pytest.mark.slow
def test_what_is_not_asked_for_is_neither_computed_nor_shown():
    """A train alone: no shaft, no deviations, no accuracy, no motor."""
    bare = scene(
        FAST,
        **dict.fromkeys(("motor", "load", "duty", "mesh")),
        train=FEW | {"maximise": None, "ratio": 48, "minimise": "mass"},
    )
    result = gearopt.Result.from_json(gearopt.solve(bare).to_json())
    assert result.status == "optimal" and result.design.keys() == {"train"}
    assert not any("error" in limit for limit in result.limits)
    told = json.dumps({"design": result.design, "report": result.report})
    assert "error_deg" not in told and "J_s" not in told
    headings = {s.heading for s in sections(result)}
    assert {"Train", "Mass and inertia"} <= headings
    assert not headings & {"Total ratio", "Error and inertia", "Error and mass", "Stiffness"}
    text = shown(result).replace("ratio error", "")
    html = re.sub(r"<script.*?</script>|<style.*?</style>|data:[^\"]*", "", page(result, "x"),
                  flags=re.S).replace("ratio error", "")  # fmt: skip
    html = html.replace("the ratio itself, not to its tolerance", "")
    for word in UNASKED:
        assert word not in text, word
        assert not re.search(rf"\b{word}", re.sub(r"<[^>]*>", " ", html)), word
    assert "no shaft is counted" in str(result.report["assumptions"])
    explained = gearopt.explain(bare)
    assert explained.result.value == result.value and explained.binding


@pytest.mark.slow
def test_a_shaft_adds_its_inertia_and_nothing_else():
    plain = FEW | {"maximise": None, "ratio": 48, "minimise": "mass"}
    shaft = {"diameter": "8 mm", "length": "50 mm"}
    both = [gearopt.solve(scene(FAST, train=plain, shaft=s)) for s in (None, shaft)]
    one, two = (r.design["train"] for r in both)
    assert one["stages"] == two["stages"] and one["mass_kg"] == two["mass_kg"]
    more = math.pi / 32 * 7750 * 0.05 * 0.008**4 / one["stages"][0]["ratio"] ** 2
    assert two["inertia_kg_m2"] - one["inertia_kg_m2"] == pytest.approx(more, rel=1e-9)


@pytest.mark.slow
def test_an_error_without_a_limit_is_told_and_not_held():
    free, held = (gearopt.solve(scene(QUICK, train=FEW, **one)) for one in ({"accuracy": None}, {}))
    assert "error" not in free.limits and held.limits["error"] <= 1.0
    assert free.value < held.value and free.design["train"]["error_deg"] > 0.12
    made = {s.heading: s for s in sections(gearopt.Result.from_json(free.to_json()))}
    assert "allowed" not in " ".join(made["Where the error comes from"].words)
    least = gearopt.solve(scene(QUICK, accuracy=None, train=FEW | {"minimise": "error"}))
    bound = least.report["real_valued_bound_error_deg"]
    assert least.status == "optimal" and bound <= least.value < 1.2 * bound


IMPOSSIBLE = [
    (
        {"duty": {"motion": "acceleration", "load_speed": "50 rad/s"},
         "motor": {"speed_limit": "800 rad/s"}},
        "the motor's speed limit allows a total ratio of at most 16",
        {"speed_limit", "ratio_low"},
    ),
    ({"load": {"friction": "10 N m"}, "train": {"ratio": [20, 50]}}, "with none of them", set()),
    (
        {"duty": SWING, "motor": {"torque": "0.02 N m"},
         "train": {"maximise": None, "minimise": "rms_torque"}},
        "above the motor's 0.02 N m", {"torque"},
    ),
    ({"train": {"bending_stress": "1 MPa"}}, "real-valued teeth and modules", {"bending_stress"}),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("edits", "words", "blamed"), IMPOSSIBLE)
def test_why_no_train_does_the_duty_is_said(edits, words, blamed):
    edits = edits | {"train": FEW | edits.get("train", {})}
    explained = gearopt.explain(scene(FAST, **edits))
    assert explained.result.status == "infeasible"
    assert all(way.verified["with"] == "feasible" for way in explained.remedies)
    assert words in explained.message and blamed <= set(explained.conflict)
    assert words in " ".join(shown(explained.result).split()) or explained.conflict


@pytest.mark.slow
def test_a_train_that_the_motor_cannot_drive_is_noted():
    """Least inertia at 20:1 and more, but 50 rad/s of the load are 1000 rad/s of the motor."""
    told = scene(
        FAST,
        duty={"motion": "acceleration", "load_speed": "50 rad/s"},
        motor={"speed_limit": "800 rad/s"},
        train=FEW | {"maximise": None, "minimise": "inertia"},
    )
    result = gearopt.solve(told)
    assert result.status == "optimal" and "chosen" not in result.design["ratio"]
    chosen, given = (n for n in result.report["notes"] if n.startswith("With the"))
    assert chosen.startswith("With the chosen train, of ratio 20") and "800 rad/s" in chosen
    assert given.startswith("With the given train, of ratio 48, the motor would turn at 2400")
    assert "chosen train, of" not in shown(result).split("Proof:")[0]


@pytest.mark.slow
def test_wide_ratios_are_held_to_box_and_stiffness(solved):
    """127 million trains: as many as cannot be listed at once, so that they come in order."""
    box = {"width": "75 mm", "height": "130 mm", "motor_diameter": "24 mm", "hub_diameter": "16 mm"}
    box |= {"swept_angle": "180 deg"}
    free = solved("servo_gimbal_fast")
    tight = gearopt.solve(scene(FAST, space=box), budget=Budget(seconds=60))
    assert tight.status == "optimal" and tight.design["box"]["fits"]
    assert tight.design["box"]["needed_width_mm"] <= 75.0 and tight.value > free.value
    loose = gearopt.solve(scene(FAST, space=box | {"required": False}))
    assert not loose.design["box"]["fits"] and loose.value == free.value


@pytest.mark.slow
def test_a_look_through_many_trains_stops_in_time():
    narrow = {
        "width": "40 mm",
        "height": "130 mm",
        "motor_diameter": "24 mm",
        "hub_diameter": "8 mm",
    }
    late = gearopt.solve(scene(FAST, space=narrow), budget=Budget(seconds=0.3))
    assert late.status in ("limit", "infeasible") and late.value is None and late.seconds < 5.0
    assert late.status == "infeasible" or "Stopped b" in shown(late)


@pytest.mark.parametrize(
    ("edits", "key"),
    [
        ({"train": {"maximise": "move_time"}}, "train.maximise"),
        ({"train": {"minimise": "inertia"}}, "train.minimise"),
        ({"duty": {"motion": "move", "angle": "90 deg"}}, "duty.motion"),
        ({"accuracy": {"error": "1 deg"}}, "mesh[1].pitch"),
        ({"stiffness": {"shear_modulus": "79 GPa", "line_stiffness": "10 GPa"}}, "shaft"),
    ],
)
def test_files_that_ask_for_what_they_do_not_say_are_refused(edits, key):
    with pytest.raises(SceneError) as wrong:
        scene(FAST, **edits)
    assert wrong.value.key == key


@pytest.mark.slow
def test_a_box_that_no_train_keeps_is_told_once():
    narrow = {
        "width": "25 mm",
        "height": "130 mm",
        "motor_diameter": "24 mm",
        "hub_diameter": "8 mm",
    }
    few = {"maximise": None, "minimise": "mass", "ratio": 48, "modules": ["0.5 mm"]}
    few |= {"pinion_teeth": [20, 24]}
    result = gearopt.solve(scene(FAST, space=narrow, train=few))
    assert result.status == "infeasible"
    assert " ".join(shown(result).split()).count("that meets all other limits fits the box") == 1


@pytest.mark.slow
@pytest.mark.parametrize("aim", [{}, {"maximise": None, "minimise": "inertia"}])
def test_an_output_shaft_in_the_way_is_named_without_an_error_to_hold(aim):
    """No accuracy is asked for, with the duty as objective or not: the largest shaft is told."""
    told = scene(FAST, train=FEW | aim | {"ratio": 48, "output_shaft_diameter": "95 mm"})
    explained = gearopt.explain(told)
    assert explained.result.status == "infeasible" and explained.conflict == ("output_shaft",)
    (way,) = (r for r in explained.remedies if r.what == "train.output_shaft_diameter")
    assert way.bound is None and way.verified["with"] == "feasible"
    assert way.verified["with_less"] == "infeasible"
    assert "room for the output shaft" in explained.message


def test_no_reason_is_given_where_time_ran_out_before_it_was_known():
    """Not even that real-valued teeth keep all limits, which nobody had the time to look at."""
    asked = scene(QUICK, accuracy=None, train=FEW | {"minimise": "inertia"})
    found = remedies(asked, Clock(gearopt.Budget(0.0)))
    assert (found.conflict, found.remedies) == (
        (),
        (),
    ) and found.message == "time ran out before the cause was identified"


LOADED = """
gearopt = 1
kind = "servo"
[motor]
inertia = "1.1e-4 kg m^2"
torque = "0.90 N m"
speed_limit = "4500 rpm"
[load]
inertia = "0.05 kg m^2"
friction = "0.3 N m"
[duty]
motion = "move"
angle = "120 deg"
[train]
ratio = [20, 24]
modules = ["0.5 mm", "0.8 mm"]
pinion_teeth = [17, 18]
wheel_teeth = 100
face_width = "8 mm"
density = "7.85 g/cm^3"
second_pinion_diameter = "14 mm"
wheel_tip_diameters = ["90 mm", "130 mm"]
output_torque = "0.01 N m"
bending_stress = "180 MPa"
minimise = "move_time"
"""


@pytest.mark.slow
def test_teeth_carry_what_the_motor_puts_on_them():
    """The motor's torque less what turns its rotor and the gears before each mesh."""
    result = gearopt.solve(scene(LOADED))
    train, one = result.design["train"], result.design["ratio"]["chosen"]
    (first, second), n = train["stages"], train["ratio"]
    a = (n * 0.9 - 0.3) / (0.05 + n**2 * (1.1e-4 + train["inertia_kg_m2"]))
    disc = math.pi / 32 * 7850.0 * 8e-3
    pinion = disc * (1e-3 * first["pinion_diameter_mm"]) ** 4
    middle = disc * sum(
        (1e-3 * d) ** 4 for d in (first["wheel_diameter_mm"], second["pinion_diameter_mm"])
    )
    torque = 0.9 - (1.1e-4 + pinion) * n * a
    later = first["ratio"] * torque - middle * second["ratio"] * a
    for stage, t in ((first, torque), (second, later)):
        z, m, b = stage["pinion_teeth"], stage["normal_module_mm"], stage["face_width_mm"]
        stress = 2e3 * t / (z * m * m * b * math.pi * (0.154 - 0.912 / z))
        assert stage["pinion_torque_Nm"] == pytest.approx(t, rel=1e-9)
        assert stage["bending_stress_MPa"] == pytest.approx(stress, rel=1e-9) and stress <= 180.0
    assert one["peak_load_torque_Nm"] == pytest.approx(0.05 * a + 0.3, rel=1e-9)
    assert result.limits["bending_stress[2]"] == pytest.approx(stress / 180.0, rel=1e-9)
    assert train["motion_torque_Nm"] == pytest.approx(second["ratio"] * later)
    assert "this governs, as output_torque, 0.01 N m, is less" in " ".join(shown(result).split())


@pytest.mark.slow
def test_the_larger_of_output_torque_and_motion_governs_and_is_named():
    same = gearopt.solve(scene(LOADED, train={"output_torque": None}))
    assert "the teeth carry this torque" in " ".join(shown(same).split())
    more = gearopt.solve(scene(LOADED, train={"output_torque": "10 N m"}))
    assert "output_torque, 10 N m, is larger and governs" in " ".join(shown(more).split())


def test_an_output_torque_may_be_left_out_beside_a_motion_alone():
    with pytest.raises(SceneError, match=r"train.output_torque: is missing: the teeth carry it"):
        none = {"duty": None, "motor": None, "load": None}
        scene(LOADED, train={"output_torque": None, "minimise": "mass"}, **none)


@pytest.mark.slow
def test_teeth_too_weak_for_the_motor_are_named_with_the_torque_they_carry():
    weak = {"output_torque": None, "bending_stress": "100 MPa"}
    result = gearopt.solve(scene(LOADED, train=weak))
    ways = result.report["ways_out"]
    assert result.status == "infeasible" and "the torque that the motor puts" in ways["message"]
    keys = [way["what"] for way in ways["remedies"]]
    assert {"train.bending_stress", "motor.torque"} <= set(keys)
