"""A file without a right kind is told the kind that knows its tables."""

import re
import sys

import pytest

import gearopt.scenes
from gearopt.errors import SceneError, SolveError
from gearopt.scenes.reading.load import kinds, read, scene_module


@pytest.mark.parametrize("kind", kinds())
@pytest.mark.parametrize("line", ['kind = ""', ""])
def test_the_kind_is_guessed_from_the_tables(kind, line):
    text = re.sub(r"(?m)^kind = .*$", line, scene_module(kind).EXAMPLE)
    with pytest.raises(SceneError) as wrong:
        read(text.encode())
    assert wrong.value.fix.value == f'"{kind}"'


def test_a_kind_that_cannot_be_imported_is_named_and_leaves_the_others_alone(tmp_path, monkeypatch):
    (tmp_path / "broken.py").write_text("from gearopt.units import nothing\n")
    monkeypatch.setattr(gearopt.scenes, "__path__", [*gearopt.scenes.__path__, str(tmp_path)])
    with pytest.raises(SceneError) as wrong:
        read(re.sub(r"(?m)^kind = .*$", "", scene_module("compound").EXAMPLE).encode())
    assert wrong.value.fix.value == '"compound"'
    with pytest.raises(SolveError, match="kind 'broken' cannot be imported: .*nothing"):
        read(b'gearopt = 1\nkind = "broken"\n')
    assert "gearopt.scenes.broken" not in sys.modules
