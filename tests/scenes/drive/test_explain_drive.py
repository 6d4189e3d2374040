"""Impossible drives and their remedies, possible ones and the influence of every number.

Factors: the drives of Chong and Lee (elastic form with Clarabel and Ipopt, done apart).
"""

import random
from functools import cache
from pathlib import Path

import pytest
from edits import edited, scene_of

from gearopt import Budget, explain, solve
from gearopt.formulations.drive import continuous_sizing, teeth

PROBLEMS = Path(__file__).parents[3] / "problems"
ELEVATOR = (PROBLEMS / "elevator.toml").read_text(encoding="utf-8")
THREE = (PROBLEMS / "three_stage.toml").read_text(encoding="utf-8")
SMALL_WHEELS = (PROBLEMS / "elevator_small_wheels.toml").read_text(encoding="utf-8")
POSSIBLE = ("optimal", "stationary", "feasible")  # with a feasible point, certified


@cache
def explained(text):
    """The explanation of a file's text, for all tests that only read it."""
    return explain(scene_of(text)[0])


def without_teeth(text):
    head, _, rest = text.partition("[teeth]")
    return head + "[x-" + rest.partition("[x-")[2]


def with_limits(text, *lines):
    return text.replace("[limits]", "\n".join(["[limits]", *lines]))


THOUSAND = with_limits(ELEVATOR, "stage_ratio = [1, 10]").replace(
    'output_speed = "66.5 rpm"', "ratio = 1000"
)
COARSE = with_limits(THREE, 'module = ["3 mm", "50 mm"]', 'wheel_diameter = "300 mm"')
EXACT = ('ratio_tolerance = "1 %"', "ratio_tolerance = 0")
CASES = {  # file: factor of all stages and of one at 1 %, the same at the exact ratio, ...
    "1000:1 by two stages of 10": (
        THOUSAND,
        (990**0.5 / 10, 9.9),
        (1000**0.5 / 10, 10.0),
        "stage_ratio",
        "stage_ratio_high[1] [2]",
    ),
    "wheels of 250 mm": (
        SMALL_WHEELS,
        (1.114899, 1.19351),
        (1.12132, 1.20475),
        "wheel_diameter",
        "k_factor[1] [2] wheel_diameter[1] [2]",
    ),
    "modules of 3 mm, wheels of 300 mm": (
        COARSE,
        (1.22179, 1.55630),
        (1.22700, 1.57119),
        "wheel_diameter",
        "k_factor[2] [3] module_low[1] pinion_teeth_low[1] wheel_diameter[1] [2] [3]",
    ),
}


def spelt(names):
    """ "a[1] [2] b" as {"a[1]", "a[2]", "b"}."""
    found, stem = set(), ""
    for word in names.split():
        stem = word.split("[")[0] or stem
        found.add(word if not word.startswith("[") else stem + word)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("exact", [False, True], ids=["1 %", "exact"])
@pytest.mark.parametrize("case", CASES)
def test_least_repair_known_before(case, exact):
    text, percent, precise, where, conflict = CASES[case]
    text = without_teeth(text).replace(*EXACT) if exact else without_teeth(text)
    _, content = scene_of(text)
    found = explained(text)
    assert found.result.status == "infeasible"
    assert set(found.conflict) == spelt(conflict)
    least = found.remedies[0]
    (one,) = (r for r in found.remedies if r.kind == "one" and where in r.what)
    for way, factor in zip((least, one), precise if exact else percent, strict=True):
        assert len(way.changes) == 1 and where in way.changes[0].key
        assert way.bound == pytest.approx(factor, rel=1e-5)
        assert way.bound <= way.factor <= way.bound * (1 + 1.1e-5)  # as written, six digits
        assert verify(content, way)
    assert least.kind == "least" and least.changes[0].key.startswith("limits.")
    assert least.verified["others"] == "need more"


@pytest.mark.slow
def test_even_repair_known_before():
    """The same factor on both wheels: 1.12132 at the exact ratio."""
    text = without_teeth(SMALL_WHEELS).replace(*EXACT)
    _, content = scene_of(text)
    ways = explained(text).remedies
    even = ways[0]  # the least change of all
    assert even.what == "wheel_diameter" and even.bound == pytest.approx(1.12132, rel=1e-5)
    (change,) = even.changes
    expected = ("limits.wheel_diameter", '"250 mm"', '"280.33 mm"')
    assert (change.key, change.was, change.write) == expected
    assert verify(content, even)


@pytest.mark.slow
def test_whole_teeth_need_more_than_real_valued_ones():
    scene, content = scene_of(SMALL_WHEELS)
    moved = [r for r in explain(scene).remedies if r.what != "ratio"]
    assert len(moved) > 4
    for remedy in moved:
        assert remedy.factor > remedy.bound * 1.001
        known = {"with": "feasible", "with_less": "infeasible"}
        assert known.items() <= remedy.verified.items()
        assert verify(content, remedy)


@pytest.mark.slow
def test_only_whole_teeth_are_impossible():
    """Real-valued sizes exist, so no limits conflict; the remedies are for the teeth."""
    fine = ELEVATOR.replace(*EXACT).replace("[20, 40]", "[20, 21]")
    scene, content = scene_of(fine.replace('"ISO 54 I"', '"ISO 54 I"\ncoprime = true'))
    found = explain(scene)
    assert found.result.status == "infeasible" and found.conflict == ()
    assert [r.what for r in found.remedies] and all(verify(content, r) for r in found.remedies)


@pytest.mark.slow
def test_given_teeth_that_contradict_the_ratio():
    """No limit helps, so what is given moves: the teeth, or the ratio."""
    given = without_teeth(ELEVATOR)
    for ratio in ("0.6", "0.75"):
        line = f"face_width_over_diameter = {ratio}"
        given = given.replace(line, line + "\npinion_teeth = 20\nwheel_teeth = 80")
    scene, content = scene_of(given)
    found = explain(scene)
    assert found.result.status == "infeasible"
    assert any("wheel_teeth" in c.key for r in found.remedies for c in r.changes)
    assert all(verify(content, r) for r in found.remedies)


@pytest.mark.slow
def test_solve_says_the_same(solved):
    result = solved("thousand_in_two_stages")
    found = explain(PROBLEMS / "thousand_in_two_stages.toml")
    assert found.remedies and tuple(result.report["ways_out"]["conflict"]) == found.conflict
    assert [r["changes"][0]["write"] for r in result.report["ways_out"]["remedies"]] == [
        r.changes[0].write for r in found.remedies
    ]


def verify(content, remedy):
    """Read the edited file anew: a design exists with the edits, and none with less."""
    assert status(edited(content, remedy)) in POSSIBLE, remedy
    alone = remedy.kind == "least" and remedy.factor < 1.001 * (remedy.bound or 0.0)
    parts = [(c,) for c in remedy.changes] if alone else [remedy.changes]
    for part in parts if remedy.kind != "choice" else []:
        assert status(edited(content, remedy, part)) == "infeasible", remedy
    return True


def status(scene):
    """Whether a scene has a design: real-valued, and with whole teeth where it asks for them."""
    ideal = solve(continuous_sizing.problem(scene.train())).status
    if scene.teeth is None or ideal == "infeasible":
        return ideal
    return solve(teeth.problem(scene.train()), gap=0.9).status


def random_file(seed):
    """A drive whose limits contradict each other, with real-valued sizes or whole teeth."""
    draw = random.Random(seed)
    stages = draw.choice([2, 2, 3])
    ratio = draw.uniform(8, 40) if stages == 2 else draw.uniform(40, 200)
    widths = [round(draw.uniform(0.4, 1.0), 2) for _ in range(stages)]
    least = draw.randint(17, 24)
    wheels = 'wheel_diameter = "{:.0f} mm"'
    rule = draw.randrange(4)
    mean = ratio ** (1 / stages)
    power = draw.uniform(2, 40)
    limits = [
        f'k_factor = "{draw.uniform(1.5, 2.5):.2f} MPa"',
        f'unit_load = "{draw.uniform(40, 60):.1f} MPa"',
        f"pinion_teeth = [{least}, {least + draw.randint(8, 20)}]",
    ]
    size = 29 * (9.549 * power / 1.45 * ratio) ** (1 / 3)  # mm, of the last wheel
    if rule in (0, 3):
        limits.append(wheels.format(size * draw.uniform(0.5, 0.9)))
    if rule == 1:
        limits.append(f"stage_ratio = [1, {mean * draw.uniform(0.7, 0.95):.2f}]")
    if rule == 2:
        limits += [
            f'module = ["{draw.choice([5, 6, 8])} mm", "50 mm"]',
            wheels.format(size * draw.uniform(0.6, 1.0)),
        ]
    if rule == 3:
        limits.append(f"wheel_teeth = [20, {int(least * mean * draw.uniform(0.6, 0.9))}]")
    teeth = '[teeth]\nmodules = "ISO 54 I"' if draw.random() < 0.5 else ""
    body = "\n".join(f"[[stage]]\nface_width_over_diameter = {w}" for w in widths)
    tolerance = draw.choice(["1 %", "2 %", "0.5 %"])
    return f"""
[duty]
power = "{power:.2f} kW"
input_speed = "1450 rpm"
ratio = {ratio:.3f}
ratio_tolerance = "{tolerance}"
[gears]
helix_angle = "{draw.choice([0, 12, 25])} deg"
{body}
[limits]
{chr(10).join(limits)}
{teeth}
"""


@pytest.mark.slow
@pytest.mark.parametrize("block", range(9))
def test_every_remedy_of_a_random_impossible_drive_is_verified(block):
    """The first impossible drive of every block; those drawn possible are left out."""
    for seed in range(1000 * block + 1, 1000 * block + 13):
        scene, content = scene_of(random_file(seed))
        found = explain(scene, budget=Budget(seconds=60))
        if found.result.status not in POSSIBLE:
            break
    assert found.result.status == "infeasible"
    assert found.remedies, seed
    assert all(verify(content, r) for r in found.remedies)


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        pytest.param(ELEVATOR, id="elevator"),
        pytest.param(THREE, id="three stages"),
    ],
)
def test_sensitivity_of_every_number_against_re_solving(text):
    """Multipliers and central differences of independent solves agree to 1e-3 for every input."""
    scene, _ = scene_of(text)
    found = {i.key: i for i in explained(text).influences}
    written = {"duty.power", "duty.input_speed", "duty.output_speed", "duty.ratio_tolerance"}
    written |= {"gears.helix_angle", "gears.pressure_angle", "limits.k_factor", "limits.unit_load"}
    written |= {"limits.pinion_teeth[1]", "limits.pinion_teeth[2]"}
    written |= {f"stage[{k + 1}].face_width_over_diameter" for k in range(len(scene.stage))}
    assert set(found) == written
    for i in found.values():
        assert i.sensitivity == pytest.approx(sum(i.resolved) / 2, abs=1e-3), i.key
    assert found["limits.k_factor"].sensitivity == pytest.approx(-1, abs=1e-9)  # V ~ T/K
    assert found["duty.power"].sensitivity == pytest.approx(1, abs=1e-9)


@pytest.mark.slow
def test_sensitivities_where_other_limits_bind():
    """Large modules, given teeth and width, mass: all kinds of numbers have their effect."""
    text = without_teeth(with_limits(ELEVATOR, 'module = ["3 mm", "10 mm"]'))
    text = text.replace("face_width_over_diameter = 0.6", "pinion_teeth = 25\nface_width = '30 mm'")
    text += '\n[objective]\nminimise = "mass"\ndensity = "7.85 kg/dm^3"\n'
    scene, _ = scene_of(text)
    found = {i.key: i for i in explain(scene).influences}
    for key in ("stage[1].pinion_teeth", "stage[1].face_width", "objective.density"):
        assert abs(found[key].sensitivity) > 0.01
    for i in found.values():
        below, above = i.resolved
        assert min(below, above) - 1e-3 <= i.sensitivity <= max(below, above) + 1e-3, i.key


@pytest.mark.slow
def test_prices_are_those_of_the_drive_solved_again():
    """1 % more K-factor, one tooth less: exact re-solves of the edited file."""
    scene, content = scene_of(ELEVATOR)
    found = explained(ELEVATOR)
    (k,) = (i for i in found.influences if i.key == "limits.k_factor")
    content["limits"]["k_factor"] = "2.0907 MPa"
    again = solve(type(scene).model_validate(content)).value
    assert k.step == "+1%" and k.price == pytest.approx(again / found.result.value - 1, rel=1e-9)
    assert all(i.price is None or i.price < 1e-9 for i in found.influences)  # easing never costs


@pytest.mark.slow
def test_a_stopped_explanation_says_what_it_has():
    """No time: the answer's status stays honest, and nothing is claimed."""
    scene, _ = scene_of(SMALL_WHEELS)
    found = explain(scene, budget=Budget(seconds=0.0))
    assert found.result.status in ("limit", "infeasible") and found.remedies == ()
    calls = iter(range(40))
    stopped = explain(scene, watch=lambda event: next(calls, None) is not None)
    assert all(r.verified.get("with") in POSSIBLE for r in stopped.remedies if r.verified)


ONE_STAGE = """
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
ratio = 5
ratio_tolerance = "1 %"
[[stage]]
face_width_over_diameter = [0.2, 1.0]
{stage}
[limits]
k_factor = "2.07 MPa"
unit_load = "48 MPa"
pinion_teeth = [20, 40]
wheel_diameter = "300 mm"
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stage", "key", "easier"),
    [
        ('module = "4 mm"', "stage[1].module", "smaller"),
        ("pinion_teeth = 30\nmodule = ['2 mm', '8 mm']\nwheel_teeth = [100, 120]", "", ""),
        ('face_width = "400 mm"', "stage[1].face_width", "smaller"),
    ],
    ids=["module", "teeth", "face width"],
)
def test_a_given_size_is_moved_the_way_that_helps(stage, key, easier):
    """4 mm x 20 teeth x 5 is 400 mm: the module must be smaller, not larger."""
    scene, content = scene_of(ONE_STAGE.format(stage=stage))
    found = explain(scene)
    assert found.result.status == "infeasible" and found.remedies
    assert all(r.verified["with"] == "feasible" and verify(content, r) for r in found.remedies)
    if key:
        (change,) = (c for r in found.remedies for c in r.changes if c.key == key)
        assert (size(change.write) < size(change.was)) == (easier == "smaller")


def size(text):
    return float(text.strip('"').split()[0])


@pytest.mark.slow
def test_a_tolerance_of_zero_can_be_eased():
    """Pinions of 19 teeth and a ratio of 20.123: no pair of whole ratios hits it exactly."""
    text = ELEVATOR.replace(*EXACT).replace('output_speed = "66.5 rpm"', "ratio = 20.123")
    scene, content = scene_of(text.replace("[20, 40]", "[19, 19]"))
    found = explain(scene)
    (ease,) = (r for r in found.remedies if r.what == "ratio_tolerance")
    assert ease.changes[0].was == '"0 %"' and verify(content, ease)


@pytest.mark.slow
def test_a_tolerance_is_written_in_few_digits():
    """A stage ratio of 3.96604 instead of 5: 20.6792 % is missing."""
    sizes = "stage_ratio = [1, 3.96604]\nmodule = ['2 mm', '8 mm']"
    text = ONE_STAGE.replace('wheel_diameter = "300 mm"', "").format(stage=sizes)
    scene, content = scene_of(text.replace("2.07 MPa", "20 MPa").replace("48 MPa", "400 MPa"))
    changed = {r.changes[0].key: r for r in explain(scene).remedies}
    ease = changed["duty.ratio_tolerance"]
    assert ease.changes[0].short == '"20.7 %"' and verify(content, ease)


@pytest.mark.slow
def test_standard_modules_move_to_standard_modules():
    text = with_limits(ELEVATOR, 'module = ["1 mm", "2 mm"]', 'wheel_diameter = "260 mm"')
    scene, content = scene_of(text)
    found = explain(scene)
    series = {1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0}
    moved = [c for r in found.remedies for c in r.changes if c.key.endswith("module")]
    assert all(float(c.write.split('"')[3].split()[0]) in series for c in moved)
    assert all(verify(content, r) for r in found.remedies)


@pytest.mark.slow
def test_a_limit_at_a_standard_module_has_a_price_and_no_slope():
    scene, _ = scene_of(with_limits(ELEVATOR, 'module = ["1 mm", "2.5 mm"]'))
    found = {i.key: i for i in explain(scene).influences}
    assert found["limits.module[2]"].sensitivity is None
    assert found["limits.module[2]"].step == "to 3 mm" and found["limits.module[2]"].price < -0.01


@pytest.mark.slow
def test_a_series_that_is_to_blame_is_named():
    """Modules of 8 and 10 mm only: the limit that cannot be kept is the smallest module."""
    scene, _ = scene_of(SMALL_WHEELS.replace('"ISO 54 I"', '["8 mm", "10 mm"]'))
    assert any(name.startswith("module_low") for name in explain(scene).conflict)


@pytest.mark.slow
def test_what_a_stopped_explanation_prints_is_what_the_whole_one_prints():
    scene, _ = scene_of(ELEVATOR)
    whole = {i.key: i for i in explained(ELEVATOR).influences}
    for most in (30, 60, 120, 240):
        calls = iter(range(most))
        part = explain(scene, watch=lambda event, calls=calls: next(calls, None) is not None)
        assert len(part.influences) < len(whole) and part.message
        for i in part.influences:
            full = whole[i.key]
            assert i.sensitivity == pytest.approx(full.sensitivity, abs=1e-9)
            assert i.price is None or i.price == pytest.approx(full.price, abs=1e-9)


PRESET = SMALL_WHEELS.replace('k_factor = "2.07 MPa"', 'preset = "chong-lee-elevator"').replace(
    'unit_load = "48 MPa"\n', ""
)


@pytest.mark.slow
def test_a_better_material_is_worth_as_much_as_less_power():
    """K and U enter as T/K and T/U: both limits times f is the same as the power over f."""
    scene, content = scene_of(without_teeth(PRESET))
    ways = {r.what: r for r in explain(scene).remedies}
    loads, power = ways["k_factor, unit_load"], ways["torque"]
    assert loads.bound == pytest.approx(power.bound, rel=1e-9)
    assert {c.key for c in loads.changes} == {
        f"stage[{k}].{name}" for k in (1, 2) for name in ("k_factor", "unit_load")
    }
    assert verify(content, loads) and verify(content, power)


@pytest.mark.slow
def test_load_limits_of_a_preset_have_their_influence():
    text = PRESET.replace('wheel_diameter = "250 mm"', "")
    found = {i.key: i for i in explain(scene_of(text)[0]).influences}
    assert found["limits.k_factor"].value == "300 psi"
    assert found["limits.k_factor"].sensitivity == pytest.approx(-1, abs=1e-9)
