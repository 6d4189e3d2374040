"""Tables and changes from Python: what they give is what an edited file gives."""

import pickle
import re
import tomllib
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.scenes.explaining.numbers import numbers, written

PROBLEMS = Path(__file__).parents[2] / "problems"
FILES = sorted(PROBLEMS.glob("*.toml"))
ELEVATOR = PROBLEMS / "elevator.toml"
WIDTH = "face_width_over_diameter"


def tables(path=ELEVATOR):
    return tomllib.loads(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", few(FILES, FILES[::6]), ids=lambda p: p.stem)
def test_the_tables_of_a_file_are_its_scene_and_every_number_has_its_key(path, monkeypatch):
    """Floats of Python are the decimals of the file, so scenes with exact fractions are equal.

    A number written where it stands, by the key that `explain` writes, changes nothing. A series
    of modules has a name instead.
    """
    monkeypatch.chdir(PROBLEMS)  # from where tables name other files
    scene, given = gearopt.load(path.name), tables(path)
    assert gearopt.load(given) == scene == gearopt.load(scene)
    own = [
        n
        for n in numbers(scene)
        if n.path[1:2] != ("modules",)
        or not isinstance(given.get(n.path[0], {}).get("modules"), str)
    ]
    changes = {n.key: written(n.value, n.path) for n in own}
    assert changes and gearopt.load(path, changes) == scene == gearopt.load(scene, changes)


def test_changes_are_edits_of_the_file(tmp_path):
    """Each beside its edit by hand: set, an end of a range, a table begun, one more, removed."""
    text = ELEVATOR.read_text(encoding="utf-8")
    third = f"[[stage]]\n{WIDTH} = 0.75\n"
    for changes, old, new in (
        ({"duty.power": "9 kW"}, "7.5 kW", "9 kW"),
        ({f"stage[2].{WIDTH}": 0.7}, "0.75", "0.7"),
        ({"limits.pinion_teeth[2]": 60}, "[20, 40]", "[20, 60]"),
        (
            {"layout.shaft_stress": "40 MPa"},
            "[teeth]",
            '[layout]\nshaft_stress = "40 MPa"\n[teeth]',
        ),
        ({f"stage[3].{WIDTH}": 0.75}, third, 2 * third),
        ({"stage[3]": {WIDTH: 0.75}}, third, 2 * third),
        ({"stage[2]": None}, third, ""),
        ({"title": None, "source": None}, "title =", "x-title = 1\n#"),
        (
            {f"stage[1].{WIDTH}": None, "stage[1].module": "6 mm"},
            f"{WIDTH} = 0.6",
            'module = "6 mm"',
        ),
    ):
        assert old in text
        path = tmp_path / "edited.toml"
        edited = text.replace(old, new)
        if "title" in changes:
            edited = re.sub(r"(?m)^(title|source) = .*\n", "", text)
        path.write_text(edited, encoding="utf-8")
        try:
            right = gearopt.load(path)
        except gearopt.SceneError as wrong:
            with pytest.raises(gearopt.SceneError) as told:
                gearopt.load(ELEVATOR, changes)
            assert (told.value.rule, told.value.key) == (wrong.rule, wrong.key)
        else:
            assert gearopt.load(ELEVATOR, changes) == right, changes


def test_a_result_says_what_was_changed():
    changes = {"duty.power": "9 kW", f"stage[2].{WIDTH}": np.float64(0.7)}
    result = gearopt.solve(ELEVATOR, changes)
    plain = gearopt.solve(ELEVATOR)
    assert (result.file, result.file_sha256) == (str(ELEVATOR), plain.file_sha256)
    assert result.options["changes"] == {"duty.power": "9 kW", f"stage[2].{WIDTH}": 0.7}
    assert "changes" not in plain.options
    expected = plain.asked | {"duty": plain.asked["duty"] | {"power": "9 kW"}}
    assert result.asked == expected | {"stage": [{WIDTH: 0.6}, {WIDTH: 0.7}]}
    own = gearopt.solve(result.asked)
    assert own.file is None and own.file_sha256 is None and own.design == result.design
    assert gearopt.Result.from_json(result.to_json()) == pickle.loads(pickle.dumps(result))
    loaded = gearopt.solve(gearopt.load(ELEVATOR), changes)
    assert loaded.design == result.design and loaded.asked["duty"] == result.asked["duty"]


def test_edits_of_a_remedy_are_values_of_python():
    texts = {"a.b": '"9 kW"', "c[2]": "[20, 0.5]", "d": "false", "e": ""}
    changes = tuple(Change(k, "", w, 1.0) for k, w in texts.items())
    remedy = Remedy("one", "", changes, 1.0, None)
    assert remedy.edits == {"a.b": "9 kW", "c[2]": [20, 0.5], "d": False, "e": None}


@pytest.mark.slow
def test_the_remedies_of_an_impossible_file_are_changes():
    file = PROBLEMS / "elevator_small_wheels.toml"
    remedies = gearopt.explain(file).remedies
    assert len(remedies) > 4
    for remedy in remedies:
        assert gearopt.solve(file, remedy.edits).value is not None, remedy
    found = gearopt.explain(file, remedies[0].edits)
    assert found.result.options == {"changes": remedies[0].edits} and found.influences


def test_numbers_of_python_are_taken():
    same = gearopt.load(ELEVATOR)
    for value in (0.6, np.float32(0.6), np.float64(0.6), Decimal("0.6"), Fraction(3, 5)):
        assert gearopt.load(ELEVATOR, {f"stage[1].{WIDTH}": value}) == same
    assert gearopt.load(ELEVATOR, {"teeth.coprime": np.bool_(True)}).teeth.coprime is True
    for value in ((20, 40), [20, np.int64(40)], np.array([20, 40])):
        assert gearopt.load(ELEVATOR, {"limits.pinion_teeth": value}) == same


def test_what_was_given_is_not_touched():
    given, changes = tables(), {"limits.pinion_teeth[2]": 60, "teeth": {"modules": "ISO 54 I"}}
    gearopt.load(given, changes)
    assert given == tables() and changes["teeth"] == {"modules": "ISO 54 I"}


def test_other_files_stand_in_the_working_directory(tmp_path, monkeypatch):
    """Of a file beside the file: as `scenes.reading.linked_files` is told."""
    from gearopt.scenes.reading.load import load

    seen = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("gearopt.scenes.reading.load.Opened", lambda files, ask: seen.append(files))
    load(tables())
    load(ELEVATOR, {"duty.power": "9 kW"})
    assert [files[-1].parent for files in seen] == [tmp_path, PROBLEMS]


@pytest.mark.parametrize(
    ("changes", "key", "words"),
    [
        ({"duty.pwoer": "9 kW"}, "duty.pwoer", "unknown key beside power, which"),
        ({"duty.power": 9}, "duty.power", 'Write power = "9 kW"'),
        ({"duty.power": "9 kw"}, "duty.power", 'Write power = "9 kW"'),
        ({"layuot.shaft_stress": "40 MPa"}, "layuot", "Did you mean layout?"),
        (
            {"duty.powr": None},
            "duty.powr",
            "not in the file and cannot be removed. Did you mean duty.power?",
        ),
        ({"duty.ratio": None}, "duty.ratio", "Leave it out of the changes"),
        (
            {"layout.shaft_stress": None},
            "layout.shaft_stress",
            "not in the file and cannot be removed",
        ),
        ({"duty.power": None}, "duty.power", "is missing"),
        ({"stage[4].module": 2}, "stage[4].module", "stage has 2 entries. Write stage[1], ..."),
        ({"stage[0].module": 2}, "stage[0].module", "counted from 1"),
        ({"stage.module": 2}, "stage.module", "Write stage[1].module, ..."),
        ({"stage.1.module": 2}, "stage.1.module", "Write stage[1], ..."),
        ({"duty.power.value": 2}, "duty.power.value", "duty.power is not a table"),
        ({"duty.power[1]": 2}, "duty.power[1]", "duty.power is not a list"),
        ({"a b": 2}, "a b", "is not a key of a file"),
        ({7: 2}, "7", "is not a key of a file"),
        ({f"stage[1].{WIDTH}": float("nan")}, f"stage[1].{WIDTH}", "is not a finite number"),
        ({"kind": "driv"}, "kind", 'Write kind = "drive"'),
    ],
)
def test_a_wrong_change_is_told_in_one_message(changes, key, words):
    """With the place in the file, what stands there and what to write; by every way in."""
    for call in (gearopt.load, gearopt.solve, gearopt.explain, gearopt.compare):
        with pytest.raises(gearopt.SceneError) as told:
            call(ELEVATOR, changes)
        assert told.value.key == key and words in str(told.value)
        assert str(told.value).startswith(f"{ELEVATOR} (changed): {key}")


def test_wrong_tables_are_told():
    for given, words in (
        ({}, "<tables>: is empty"),
        ({"gearopt": 1}, "<tables>: kind: is missing"),
        (tables() | {"stages": 2.5}, "stages = 2.5: is not a whole number"),
        (tables() | {"duty": None}, "duty"),
    ):
        with pytest.raises(gearopt.SceneError, match=re.escape(words)):
            gearopt.solve(given)
    deep = inner = {}
    for _ in range(5000):
        inner["a"] = inner = {}
    with pytest.raises(gearopt.SceneError, match="nested too deeply"):
        gearopt.load(deep)


def test_a_key_deeper_than_python_recurses_is_refused(tmp_path):
    """As of the reader, and of the changes that Python gives."""
    file = tmp_path / "deep.toml"
    file.write_text(f'gearopt = 1\nkind = "drive"\n[duty]\npower{".a" * 1100} = 1\n')
    with pytest.raises(gearopt.SceneError, match="deep.toml: is nested too deeply"):
        gearopt.load(file)


def test_changes_deeper_than_python_recurses_are_refused():
    deep = inner = {}
    for _ in range(5000):
        inner["a"] = inner = {}
    for changes in ({"duty.power": deep}, {"x-own": deep}, {"duty.power": [deep]}):
        with pytest.raises(gearopt.SceneError, match="nested too deeply"):
            gearopt.load(ELEVATOR, changes=changes)


@pytest.mark.parametrize(
    ("call", "wrong", "words"),
    [
        ("solve", {"metod": "exact"}, "has no option metod: did you mean method?"),
        ("solve", {"seconds": 3}, r"write budget=Budget\(seconds=...\)"),
        ("explain", {"evaluations": 3}, r"write budget=Budget\(evaluations=...\)"),
        ("solve", {"colour": 3}, "options: changes, method, budget"),
        ("compare", {"method": "exact"}, "did you mean methods?"),
        ("solve", {"budget": 3}, r"budget=3: budget is a Budget, such as budget=Budget\(seconds"),
        ("explain", {"budget": "3 s"}, "budget is a Budget"),
        ("solve", {"gap": "x"}, "gap='x': gap is a number of at least 0"),
        ("solve", {"gap": -0.1}, "gap is a number of at least 0"),
        ("solve", {"gap": float("nan")}, "gap is a number of at least 0"),
        ("solve", {"seed": -1}, "seed is a whole number of at least 0"),
        ("solve", {"seed": 1.5}, "seed is a whole number of at least 0"),
        ("solve", {"top": 0}, "top is a whole number of at least 1"),
        ("solve", {"method": 3}, 'such as method="ipopt"'),
        ("solve", {"watch": 3}, "watch is a function"),
        ("solve", {"prices": "yes"}, "prices is True, False or a share"),
        ("solve", {"changes": "exact"}, "is not a dict of changes.*method='exact'"),
        ("compare", {"seeds": 0}, "seeds is a whole number of at least 1"),
        ("solve", {"what": 3}, "int: write the path of a problem file"),
        (
            "solve",
            {"what": 'gearopt = 1\nkind = "drive"'},
            "is the text of a file: .* tomllib.loads",
        ),
    ],
)
def test_a_wrong_option_is_refused_by_name(call, wrong, words):
    sort = TypeError if words.startswith("has no") or "options:" in words else ValueError
    sort = (
        TypeError if set(wrong) & {"seconds", "evaluations", "method"} and call != "solve" else sort
    )
    sort = TypeError if "write budget" in words else sort
    with pytest.raises(sort, match=words):
        getattr(gearopt, call)(**({"what": ELEVATOR} | wrong))


@pytest.mark.parametrize(
    "wrong",
    [{"seconds": -1}, {"seconds": "3"}, {"evaluations": 2.5}, {"gap": None}, {"seconds": True}],
)
def test_a_wrong_budget_is_refused_by_name(wrong):
    ((name, value),) = wrong.items()
    with pytest.raises(ValueError, match=re.escape(f"Budget({name}={value!r}): write a")):
        gearopt.Budget(**wrong)


def test_a_problem_takes_no_changes():
    x = gearopt.Var("x", "", 1.0, 2.0, 1.5)
    own = gearopt.Problem("own", (x,), (), lambda x, p: gearopt.Terms({"f": x.x}))
    for call in (gearopt.solve, gearopt.explain, gearopt.compare):
        with pytest.raises(ValueError, match=r"write problem.at\(name=value\)"):
            call(own, {"x": 1.0})
