"""Wrong packing files: one SceneError each, with file, key, value, and what to write."""

import dataclasses
import json
import re
import tomllib
from itertools import product
from pathlib import Path
from random import Random

import pytest
from campaigns import few

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.formulations import packing
from gearopt.formulations.packing.container_bound import Bound
from gearopt.report.answer import proof
from gearopt.scenes.packing import KIND
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.load import read

EXAMPLE = KIND.example.text

PROBLEMS = Path(__file__).parents[3] / "problems"
ROW = (PROBLEMS / "six_cylinders_row.toml").read_text(encoding="utf-8")


def wrong(text):
    with pytest.raises(SceneError) as found:
        read(text.encode(), "packing.toml")
    return found.value


CHANGES = {  # change of the example: key, part of the rule, what to write
    "typo": (("[container]", "[contaner]"), "contaner", "unknown", "Did you mean container?"),
    "typo in a key": (("diameter =", "diametre ="), "cylinder[1].diametre", "unknown", "diameter"),
    "no unit": (('"20 mm"\nheight', '"20"\nheight'), "cylinder[1].diameter", "no unit", '"20 mm"'),
    "bare": (('= "20 mm"\nheight', "= 20\nheight"), "cylinder[1].diameter", "bare", '"20 mm"'),
    "other unit": (('"0 mm"', '"0 kW"'), "container.gap", "kW", "gap"),
    "negative gap": (('"0 mm"', '"-1 mm"'), "container.gap", "below zero", '"1 mm"'),
    "zero diameter": (('"20 mm"\nhei', '"0 mm"\nhei'), "cylinder[1].diameter", "greater", "20 mm"),
    "shape": (('"rectangle"', '"cirle"'), "container.shape", "is not one of", '"circle"'),
    "no count": (("count = 3", "count = 0"), "cylinder[1].count", "whole number", "count = 1"),
    "too many": (("count = 3", "count = 49"), "cylinder[1].count", "at most 50", "count = 47"),
    "narrow": (("[layers]", 'width = "19 mm"\n[layers]'), "container.width", "20 mm", '"20 mm"'),
    "both layers": (
        ("most = 2", "most = 2\nexactly = 2"),
        "layers.most",
        "conflicts with",
        "Remove it",
    ),
    "no layers": (("most = 2", ""), "layers.most", "missing", "most = 2"),
    "too many layers": (("most = 2", "exactly = 7"), "layers.exactly", "empty", "exactly = 6"),
    "objective": (('"volume"', '"mass"'), "objective.minimise", "is not one of", "volume"),
    "layer": (("count = 3", "count = 3\nlayer = 3"), "cylinder[1].layer", "above the 2", "= 2"),
    "at and count": (
        ("count = 3", 'count = 3\nat = ["0 mm", "0 mm"]'),
        "cylinder[1].count",
        "one cylinder",
        "count = 1",
    ),
    "one coordinate": (("count = 3", 'at = ["0 mm"]'), "cylinder[1].at", "place [x, y]", "at ="),
    "bare place": (("count = 3", "at = [1, 2]"), "cylinder[1].at", "bare", '["1 mm", "2 mm"]'),
    "nothing to pack": (("[[cylinder]]", "[[x-cylinder]]"), "cylinder", "missing", "[[cylinder]]"),
}


@pytest.mark.parametrize("case", CHANGES.values(), ids=CHANGES)
def test_a_wrong_file_is_one_error_with_a_cure(case):
    (old, new), key, rule, remedy = case
    assert old in EXAMPLE
    count = -1 if old == "[[cylinder]]" else 1
    error = wrong(EXAMPLE.replace(old, new, count))
    assert (error.file, error.key) == ("packing.toml", key)
    assert rule in error.rule and remedy in error.remedy


def test_fixed_cylinders_that_overlap_say_by_how_much_and_where_they_fit():
    text = ROW.replace('["30 mm", "10 mm"]', '["28 mm", "10 mm"]')
    error = wrong(text)
    assert error.key == "cylinder[2].at" and error.value == '["28 mm", "10 mm"]'
    assert "the gap between large 2 and large 1 is 2 mm too small" in error.rule
    assert error.fix.value == '["30 mm", "10 mm"]'
    read(ROW.encode())


def test_a_cure_is_rounded_away_from_the_overlap():
    text = ROW.replace('["30 mm", "10 mm"]', '["20 mm", "22 mm"]')
    cured = text.replace('["20 mm", "22 mm"]', wrong(text).fix.value)
    assert cured != text
    read(cured.encode())


def test_fixed_cylinders_over_one_another_ask_for_layers():
    text = ROW.replace('["30 mm", "10 mm"]', '["12 mm", "10 mm"]')
    text = text.replace('["50 mm", "10 mm"]', '["14 mm", "10 mm"]')
    error = wrong(text + "\n[layers]\nmost = 2\n")
    assert error.key == "layers.most" and "need 3 layers" in error.rule
    assert error.fix.value == "3"
    read((text + "\n[layers]\nmost = 3\n").encode())


def test_a_width_holds_what_is_fixed():
    error = wrong(ROW + '\n[container]\nwidth = "50 mm"\nwall = "1 mm"\n')
    assert error.key == "container.width" and error.fix.value == '"62 mm"'


def test_a_remedy_is_in_the_unit_of_the_file():
    """25.4 mm to the inch: 60 mm are 2.362204724... in, rounded up; whole inches stay whole."""
    error = wrong(ROW + '\n[container]\nwidth = "2 in"\n')
    assert error.fix.value == '"2.362205 in"' and "needs 2.362205 in" in error.rule
    inches = ROW.replace(" mm", " in")
    error = wrong(inches + '\n[container]\nwidth = "50 in"\nwall = "1 in"\n')
    assert error.fix.value == '"62 in"'
    error = wrong(inches.replace('["30 in", "10 in"]', '["28 in", "10 in"]'))
    assert error.fix.value == '["30 in", "10 in"]' and "is 2 in too small" in error.rule


def test_a_width_is_for_a_rectangle():
    error = wrong(ROW + '\n[container]\nwidth = "90 mm"\nshape = "circle"\n')
    assert error.key == "container.width" and error.fix.action == "remove"


def test_all_fixed_leaves_nothing_to_do():
    error = wrong(ROW.replace("count = 3", 'at = ["99 mm", "-20 mm"]'))
    assert error.key == "cylinder[4].at" and "nothing is left" in error.rule


def test_units_and_signs_of_places():
    text = ROW.replace('["50 mm", "10 mm"]', '["-1 in", "0 mm"]')
    _, scene = read(text.encode())
    assert scene.plan().cylinders[2].at == pytest.approx((-25.4, 0.0))


@pytest.mark.parametrize(
    ("tables", "names"),
    [
        ([("large", 3), ("large", 2)], ["large 1", "large 2", "large 3", "large 4", "large 5"]),
        ([("large", 1), ("small", 1), ("large", 1)], ["large 1", "small", "large 2"]),
        ([("", 1), ("", 2)], ["d 20 mm 1", "d 20 mm 2", "d 20 mm 3"]),
        ([("large 1", 1), ("large", 2), ("small", 1)], ["large 1", "large 2", "large 3", "small"]),
        ([("large", 1), ("small", 2)], ["large", "small 1", "small 2"]),
    ],
)
def test_every_cylinder_has_a_name_of_its_own(tables, names):
    size = 'diameter = "20 mm"\nheight = "10 mm"'
    rows = [f'[[cylinder]]\n{size}\nname = "{name}"\ncount = {n}\n' for name, n in tables]
    _, scene = read(('gearopt = 1\nkind = "packing"\n' + "\n".join(rows)).encode())
    assert [cylinder.name for cylinder in scene.plan().cylinders] == names


@pytest.mark.slow
def test_the_terminal_shows_the_packing_and_json_its_design(here):
    path = PROBLEMS / "six_cylinders_two_layers.toml"
    done = here("solve", path)
    assert done.returncode == 0
    assert all(line.startswith("Compiling, once") for line in done.stderr.splitlines())
    for words in (
        "proven optimal",
        "large 3",
        "container volume [cm³]        16 ",
        "layer 2, from the floor [mm]",
        "10 to 20",
    ):
        assert words in done.stdout, words
    found = json.loads(here("solve", path, "--json").stdout)
    assert found["scene"] == "packing" and found["objective"]["unit"] == "mm3"
    assert found["design"]["container"]["area_mm2"] == pytest.approx(800)


@pytest.mark.slow
def test_an_impossible_request_is_one_message_and_exit_2(tmp_path, here):
    path = tmp_path / "packing.toml"
    path.write_text(ROW.replace('["30 mm", "10 mm"]', '["28 mm", "10 mm"]'))
    for command in ("solve", "check", "compare"):
        done = here(command, path)
        assert done.returncode == 2 and done.stdout == ""
        assert done.stderr.count("\n") == 1 and "is 2 mm too small" in done.stderr


@pytest.mark.slow
def test_words_without_a_proof_say_so():
    short = gearopt.Budget(evaluations=4_000)
    result = gearopt.solve(PROBLEMS / "six_cylinders_one_layer.toml", budget=short)
    assert result.report["notes"][0].startswith("Best found, not proven")


@pytest.mark.parametrize("method", few(["sa", "ipopt", "annealing", "nsga2"], 0))
def test_every_method_is_held_against_the_bound(method):
    short = gearopt.Budget(evaluations=4_000)
    result = gearopt.solve(PROBLEMS / "six_cylinders_one_layer.toml", method=method, budget=short)
    assert result.value > result.bound > 15_109 and result.gap < 0.5
    assert len(result.design["cylinders"]) == 6


def test_gradient_methods_take_no_free_layers():
    with pytest.raises(SolveError, match="layer"):
        gearopt.solve(PROBLEMS / "six_cylinders.toml", method="ipopt")


@pytest.mark.slow
def test_compare_takes_a_packing():
    found = gearopt.compare(
        PROBLEMS / "six_cylinders.toml", seeds=2, evaluations=3_000, seconds=0.2
    )
    assert [r.method for r in found.groups[0].rows][:2] == ["hop", "sa"]
    assert "gradient methods need fixed layers" in found.groups[0].rows[2].refused
    assert not found.groups[0].proven and len(found.groups) == 1


NAMED = EXAMPLE.replace("count = 3", "layer = 2", 1).replace("count = 3", "count = 2")


def test_a_named_layer_with_cylinders_below_it():
    """One in layer 2, two small ones free: one of them at least lies below; 20 x 20 x 20."""
    result = gearopt.solve(read(NAMED.encode())[1], budget=gearopt.Budget(evaluations=50_000))
    assert result.status == "optimal" and result.value == pytest.approx(8_000.0, rel=1e-8)
    assert sorted(v["layer"] for v in result.design["layers"]) == [1, 2]


def test_a_layer_below_a_named_one_that_must_stay_empty_is_refused():
    text = NAMED.replace("layer = 2", "layer = 6").replace("most = 2", "most = 6")
    error = wrong(text)
    assert error.key == "cylinder[1].layer" and error.value == "6"
    assert (
        "only 2 cylinders are free to fill layers, and every layer below it must be filled"
        in error.rule
    )
    assert error.fix.value == "3"
    read(text.replace("layer = 6", "layer = 3").encode())


TWO = NAMED.replace("layer = 2", "layer = 3").replace("count = 2", "layer = 2\ncount = 4")
TWO = TWO.replace("most = 2", "exactly = 4")
LAYERS = re.compile(r"(layers\.exactly|cylinder\[(\d+)\]\.layer) = (\d+)")


def mended(text, error):
    """A file with the layers that an error's remedy asks for."""
    words = error.remedy if error.fix is None else f"{error.fix.key} = {error.fix.value}"
    edits = LAYERS.findall(words)
    assert edits
    content = tomllib.loads(text)
    for _, cylinder, layer in edits:
        if cylinder:
            content["cylinder"][int(cylinder) - 1]["layer"] = int(layer)
        else:
            content["layers"]["exactly"] = int(layer)
    lines = [f"{k} = {json.dumps(v)}" for k, v in content.items() if isinstance(v, str | int)]
    for name, tables in content.items():
        for table in tables if isinstance(tables, list) else [tables]:
            if isinstance(table, dict):
                lines.append(f"[[{name}]]" if isinstance(tables, list) else f"[{name}]")
                lines += [f"{k} = {json.dumps(v)}" for k, v in table.items()]
    return "\n".join(lines)


def test_layers_that_no_single_number_fills_get_all_their_numbers():
    error = wrong(TWO)
    assert error.key == "layers.exactly" and error.value == "4" and error.fix is None
    assert error.remedy == ("Write layers.exactly = 2 and cylinder[1].layer = 1, all of them")
    scene = read(mended(TWO, error).encode())[1]
    result = gearopt.solve(scene, budget=gearopt.Budget(evaluations=20_000))
    assert result.status == "optimal" and len(result.design["layers"]) == 2


def some_layers(random):
    """Some cylinders with and without a layer of their own, and [layers]."""
    tables = []
    for _ in range(random.randint(1, 4)):
        own = random.choice(["", f"layer = {random.randint(1, 6)}\n"])
        size = f'diameter = "{random.randint(5, 20)} mm"\nheight = "10 mm"\n'
        tables.append(f"[[cylinder]]\n{size}{own}count = {random.randint(1, 2)}\n")
    number = f"{random.choice(['most', 'exactly'])} = {random.randint(1, 6)}"
    return "\n".join(["gearopt = 1", 'kind = "packing"', *tables, "[layers]", number])


def fillable(text):
    """Whether some choice of layers fills every one that must be, by trying all."""
    content = tomllib.loads(text)
    least, most = content["layers"].get("exactly", 1), max(content["layers"].values())
    cylinders = [c.get("layer") for c in content["cylinder"] for _ in range(c["count"])]
    open_ = [k for k, layer in enumerate(cylinders) if layer is None]
    if any(layer is not None and layer > most for layer in cylinders):
        return False
    for choice in product(range(1, most + 1), repeat=len(open_)):
        used = {layer for layer in cylinders if layer is not None} | set(choice)
        if used == set(range(1, max(used) + 1)) and max(used) >= least:
            return True
    return False


@pytest.mark.parametrize("seed", range(60))
def test_what_is_to_be_written_for_layers_loads_and_is_possible(seed):
    """One message mends every file but one with two layers above the top, each told alone."""
    text = some_layers(Random(seed))
    assert fillable(text) == loads(text)
    for _ in range(4):
        if loads(text):
            break
        error, before = wrong(text), text
        text = mended(text, error)
        assert text != before and ("above the" in error.rule or loads(text)), str(error)
    assert loads(text) and fillable(text)


def loads(text):
    try:
        read(text.encode())
    except SceneError:
        return False
    return True


def test_words_of_a_bound_say_where_its_time_ended_it():
    result = gearopt.solve(read(NAMED.encode())[1], budget=gearopt.Budget(evaluations=50_000))
    words = " ".join(proof(result))
    assert (
        "for each of the 2 ways to assign the cylinders to layers" in words
        and "Stopped early" not in words
    )
    early = dataclasses.replace(result, proof=packing.proof(Bound(1.0, 2, complete=False)))
    assert "Stopped early: the bound is weaker than it could be." in " ".join(proof(early))


@pytest.mark.slow
def test_nothing_is_posed_for_sensitivities_once_time_is_over(solved, monkeypatch):
    file = "problems/six_cylinders_two_layers.toml"
    result, scene = solved("six_cylinders_two_layers"), gearopt.load(file)
    monkeypatch.delattr("gearopt.scenes.packing.at_point")
    known = KIND.influences(scene, Ask(budget=gearopt.Budget(seconds=0.0)), result)
    assert known.message.startswith("the time sufficed for 0 of ")
