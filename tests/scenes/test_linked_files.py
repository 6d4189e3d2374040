"""A file that names another one, or its kept result, as an input; the kind is one of this test."""

import hashlib
import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

import gearopt
import gearopt.scenes
from gearopt.cli import app
from gearopt.errors import SceneError
from gearopt.scenes import compound
from gearopt.scenes.plan import one_step
from gearopt.scenes.reading.json_schema import json_schema
from gearopt.scenes.reading.load import load, read

TRAIN = compound.KIND.example.text.encode()


@pytest.fixture(autouse=True)
def kinds(monkeypatch):
    """The kinds of `more_kinds` are kinds as well."""
    folder = Path(__file__).parent / "more_kinds"
    monkeypatch.setattr(gearopt.scenes, "__path__", [*gearopt.scenes.__path__, str(folder)])
    yield
    sys.modules.pop("gearopt.scenes.checked", None)


@pytest.fixture
def folder(tmp_path):
    """A compound train's file and its kept result, and a file that names one of them."""
    (tmp_path / "trains").mkdir()
    (tmp_path / "trains" / "train.toml").write_bytes(TRAIN)
    kept = gearopt.solve(tmp_path / "trains" / "train.toml")
    (tmp_path / "trains" / "train.json").write_text(kept.to_json())
    return tmp_path


def checking(folder, train, **more):
    """The path of a file that checks a train."""
    lines = {"train": json.dumps(train), "ratio": 6.931, "most_error": 0.01, **more}
    body = "\n".join(f"{key} = {value}" for key, value in lines.items())
    path = folder / "check.toml"
    path.write_text(f'gearopt = 1\nkind = "checked"\ntitle = "A check"\n\n[check]\n{body}\n')
    return path


@pytest.mark.parametrize("train", ["trains/train.json", "trains/train.toml"])
def test_the_result_of_another_file_is_an_input(folder, train, monkeypatch):
    """It is looked for beside the file, wherever the command is run."""
    monkeypatch.chdir(folder / "trains")
    result = gearopt.solve(checking(folder, train))
    assert result.status == "evaluated" and result.feasible
    assert result.limits["error"] == pytest.approx(result.value / 0.01)
    data = (folder / train).read_bytes()
    assert result.report["inputs"] == {train: hashlib.sha256(data).hexdigest()}
    assert result.asked["check"]["train"] == train
    again = gearopt.Result.from_json(result.to_json())
    assert again.report == result.report
    absolute = gearopt.solve(checking(folder, str(folder / train)))
    assert absolute.limits == result.limits


def test_an_evaluated_file_is_shown_and_has_exit_codes(folder):
    train, page = "trains/train.json", folder / "page.html"
    for ratio, code, words in ((6.931, 0, "all limits met"), (7.5, 3, "a limit is exceeded")):
        path = checking(folder, train, ratio=ratio)
        shown = CliRunner().invoke(app, ["solve", str(path), "--html", str(page)])
        assert shown.exit_code == code and words in shown.output, shown.output
        assert words in page.read_text()
    data = json.loads(CliRunner().invoke(app, ["solve", str(path), "--json"]).output)
    assert data["status"] == "evaluated" and data["report"]["inputs"]


@pytest.mark.parametrize(
    ("name", "content", "rule"),
    [
        ("none.json", None, "does not exist"),
        ("none.toml", None, "does not exist"),
        ("odd.json", b"{", "is not JSON"),
        ("odd.json", b"\xff\xfe", "is not JSON"),
        ("odd.json", b'{"a": 1}', "is not a result of `gearopt solve --json`"),
        ("check.toml", None, "is a file that needs this one as its input"),
    ],
)
def test_an_input_that_cannot_be_used_is_told(folder, name, content, rule):
    if content is not None:
        (folder / name).write_bytes(content)
    path = checking(folder, name)
    with pytest.raises(SceneError) as wrong:
        load(path)
    error = wrong.value
    assert (error.file, error.key, error.value) == (str(path), "check.train", json.dumps(name))
    assert error.rule.startswith(rule)
    assert error.remedy.startswith("Name a problem file of kind compound, or the file of")


def test_an_input_of_another_kind_or_without_a_design_is_told(folder):
    drive = Path(__file__).parents[2] / "problems" / "elevator.toml"
    with pytest.raises(SceneError, match=r"train = .*: is of kind drive, not compound\. Name a"):
        load(checking(folder, str(drive)))
    kept = json.loads((folder / "trains" / "train.json").read_text())
    for edit, rule in (
        ({"scene": "drive"}, "is of kind drive, not compound"),
        ({"scene": None}, "is of kind a problem of one's own, not compound"),
        ({"design": {}, "status": "failed"}, r"holds a result without a design \(failed\)"),
    ):
        (folder / "edited.json").write_text(json.dumps(kept | edit))
        with pytest.raises(SceneError, match=rule):
            load(checking(folder, "edited.json"))
    with pytest.raises(SceneError, match="is not the name of a file in quotes"):
        load(checking(folder, 7))


def test_an_input_that_is_wrong_itself_says_where(folder):
    (folder / "train.toml").write_bytes(TRAIN.replace(b"ratio = 6.931", b"ratio = -6.931"))
    with pytest.raises(SceneError) as wrong:
        load(checking(folder, "train.toml"))
    assert wrong.value.file == str(folder / "train.toml") and wrong.value.key == "train.ratio"


def test_an_input_whose_solving_finds_no_design_is_told(folder, monkeypatch):
    path = checking(folder, "trains/train.toml")
    none = gearopt.Result("compound", "limit", "exact", {"name": "error"}, message="out of time")
    kind = replace(compound.KIND, steps=one_step(lambda scene, ask, known: none))
    monkeypatch.setattr(compound, "KIND", kind)
    words = r"it has none \(limit: out of time\)\. See what `gearopt solve trains/train.toml` says"
    with pytest.raises(SceneError, match=words):
        gearopt.solve(path)


def test_files_that_name_each_other_are_told(folder):
    (folder / "other.toml").write_text(checking(folder, "check.toml").read_text())
    path = checking(folder, "other.toml")
    with pytest.raises(SceneError, match="check.train.*needs this one as its input"):
        load(path)


def test_text_without_a_file_and_schemas(folder, monkeypatch):
    monkeypatch.chdir(folder)
    text = checking(folder, "trains/train.json").read_bytes()
    scene = read(text)[1]
    assert scene.check.train.kind == "compound"
    assert gearopt.solve(scene).report["inputs"].keys() == {"trains/train.json"}
    assert type(scene).model_validate(dict(scene)).check.train is scene.check.train
    assert '"train"' in json.dumps(json_schema("checked"))
