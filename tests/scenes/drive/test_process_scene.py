"""[process_one] and [process_two] in a drive's file: methods, parts, and what is refused."""

import re
from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.scenes.reading.load import read

PROBLEMS = Path(__file__).parents[3] / "problems"
ELEVATOR = (PROBLEMS / "elevator_processes.toml").read_text(encoding="utf-8")
BARE = ELEVATOR.split("[process_one]")[0]
LAYOUT = '[layout]\nshaft_stress = "40 MPa"\n'


def scene(text):
    return read(text.encode(), "a.toml")[1]


@pytest.fixture(scope="module")
def elevator():
    return gearopt.solve(scene(ELEVATOR))


def test_processes_are_parts_under_the_bound_of_the_optimum(elevator):
    sizing, one, two = elevator.parts
    assert (sizing.name, one.name, two.name) == ("sizing", "process one", "process two")
    assert elevator.status == "optimal" and elevator.value == pytest.approx(5782370.7, abs=0.06)
    for part, method in ((one, "process-one"), (two, "process-two")):
        assert part.method == method and part.status == "feasible"
        assert part.bound == elevator.bound and part.certificate["feasibility"] <= 1e-8
        assert part.gap == pytest.approx(1 - elevator.bound / part.value)
        assert part.limits.keys() == elevator.limits.keys() and max(part.limits.values()) <= 1
    assert one.value > two.value > elevator.value


def test_the_optimum_is_that_of_the_file_without_processes(elevator):
    plain = gearopt.solve(scene(BARE))
    assert plain.design == elevator.design and plain.bound == elevator.bound
    assert [p.name for p in plain.parts] == ["sizing"]


def test_only_the_tables_that_are_there_are_parts():
    text = ELEVATOR.split("[process_two]")[0]
    assert [p.name for p in gearopt.solve(scene(text)).parts] == ["sizing", "process one"]


def test_as_methods_they_are_held_to_a_proven_bound(elevator):
    for part in elevator.parts[1:]:
        alone = gearopt.solve(scene(ELEVATOR), method=part.method)
        assert alone.design == part.design and alone.status == "feasible"
        assert alone.bound == pytest.approx(5618183.49, abs=0.01)  # of real-valued sizes
        assert [p.name for p in alone.parts] == ["sizing"]


def test_compare_names_their_gaps_to_the_optimum(elevator):
    found = gearopt.compare(
        scene(ELEVATOR),
        methods="exact,process-one,process-two",
        seeds=3,
        evaluations=10,
        seconds=0.05,
    )
    (group,) = found.groups
    rows = {row.method: row for row in group.rows}
    assert not any(row.random for row in rows.values())
    for part in elevator.parts[1:]:
        (run,) = rows[part.method].equal_time.runs
        assert run.objective == part.value and run.status == "feasible"
    names = gearopt.scenes.drive.methods_to_compare(scene(ELEVATOR))
    assert names[:3] == ("exact", "process-one", "process-two")


@pytest.mark.parametrize("method", ["process-one", "process-two"])
def test_a_method_without_its_table_says_what_to_write(method):
    table = method.replace("-", "_")
    with pytest.raises(SolveError, match=rf"needs a table \[{table}\] in the file, with"):
        gearopt.solve(scene(BARE), method=method)
    continuous = re.sub(r"\[teeth\].*", "", BARE, flags=re.S)
    with pytest.raises(SolveError, match=rf"{method} needs a \[teeth\] table"):
        gearopt.solve(scene(continuous), method=method)


def test_a_design_that_breaks_a_limit_stays_a_part_without_a_value():
    text = re.sub(r"\[process_two\]\n(.*\n)stage_ratios.*\n", r"[process_two]\n\1", ELEVATOR)
    assert text != ELEVATOR
    part = gearopt.solve(scene(text)).parts[2]
    assert (part.name, part.status, part.value) == ("process two", "failed", None)
    assert part.message == "k_factor[1] is violated by 0.253."


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"process_two.pinion_teeth": [43, 26]}, "pinion_teeth[1] = 43 is above its bound 40."),
        (
            {"process_two.modules": ["2.1 mm", "3.1 mm"]},
            "module[1] = 2.1 is not one of its values.",
        ),
    ],
)
def test_a_process_beyond_the_choices_of_the_file_says_which(change, message):
    result = gearopt.solve(PROBLEMS / "elevator_processes.toml", change)
    assert result.parts[-1].message == message


def test_a_free_width_leaves_the_processes_out_and_says_so():
    text = ELEVATOR.replace(
        "face_width_over_diameter = 0.6", "face_width_over_diameter = [0.3, 0.6]"
    )
    result = gearopt.solve(scene(text))
    assert result.status == "optimal" and [p.name for p in result.parts] == ["sizing"]
    words = " ".join(result.report["notes"])
    assert words.count("face_width_over_diameter as one number") == 2


@pytest.mark.slow
def test_an_impossible_drive_has_no_processes():
    text = ELEVATOR.replace(
        "pinion_teeth = [20, 40]", 'pinion_teeth = [20, 40]\nwheel_diameter = "250 mm"'
    )
    result = gearopt.solve(scene(text))
    assert result.status == "infeasible" and "ways_out" in result.report
    keys = str(result.report["ways_out"])
    assert "process" not in keys  # no number of theirs is a remedy


@pytest.mark.slow
def test_explain_prices_none_of_their_numbers():
    found = gearopt.explain(scene(ELEVATOR))
    assert found.influences and not any("process" in n.key for n in found.influences)


def test_a_layout_keeps_them_with_its_gears():
    result = gearopt.solve(scene(ELEVATOR + LAYOUT))
    gears = next(p for p in result.parts if p.name == "gears")
    assert [p.name for p in gears.parts] == ["sizing", "process one", "process two"]


WRONG = {  # what is written -> where, rule, remedy
    "a ratio too many": (
        (
            "stage_ratios = [4.96, 4.36] # as printed; the paper's rule",
            "stage_ratios = [5, 4, 3] # ",
        ),
        "process_one.stage_ratios = [5, 4, 3]: does not have one entry for each of the 2 stages. "
        "Write, for example, stage_ratios = [5.0, 4.0]",
    ),
    "a module too few": (
        ('modules = ["2 mm", "3 mm"]', 'modules = ["2 mm"]'),
        'process_two.modules = ["2 mm"]: does not have one entry for each of the 2 stages. '
        'Write, for example, modules = ["2 mm", "2 mm"]',
    ),
    "neither modules nor teeth": (
        ('modules = ["2 mm", "3 mm"]', ""),
        "process_two.modules: is missing (or give pinion_teeth). "
        'Write, for example, modules = ["2 mm", "3 mm"]',
    ),
    "no centre distance": (
        ('first_centre_distance = "150 mm"', ""),
        "process_two.first_centre_distance: is missing. "
        'Write, for example, first_centre_distance = "150 mm"',
    ),
    "no ratios": (
        ("stage_ratios = [4.96, 4.36] # as printed; the paper's rule", "# "),
        "process_one.stage_ratios: is missing. Write, for example, stage_ratios = [4.96, 4.36]",
    ),
    "a bare centre distance": (
        ('"150 mm"', "150"),
        "process_two.first_centre_distance = 150: is a bare number: length needs a unit "
        '(mm, cm, m, um, in, ft, uin). Write first_centre_distance = "150 mm"',
    ),
    "no teeth": (
        ('[teeth]\nmodules = "ISO 54 I"', ""),
        "process_one = {",
    ),
}


@pytest.mark.parametrize("change", WRONG, ids=list(WRONG))
def test_every_mistake_has_one_clear_message(change):
    (old, new), message = WRONG[change]
    assert old in ELEVATOR
    text = ELEVATOR.replace(old, new, 1)
    with pytest.raises(SceneError) as wrong:
        scene(text)
    assert str(wrong.value).startswith(f"a.toml: {message}")


def test_more_stages_need_their_ratios():
    """Niemann's rules are for two and three stages."""
    four = (PROBLEMS / "four_stages.toml").read_text(encoding="utf-8").split("[x-expected]")[0]
    table = '[process_two]\nfirst_centre_distance = "100 mm"\npinion_teeth = [20, 20, 20, 20]\n'
    with pytest.raises(
        SceneError, match="Niemann's ratios are for two and three stages, not for 4"
    ):
        scene(four + table)
    assert scene(four + table + "stage_ratios = [5, 4, 3, 3]\n").process_two is not None
