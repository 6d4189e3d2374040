"""A file without a right kind is told the kind that knows its tables."""

import re
import sys

import pytest
from pydantic import ValidationError

import gearopt.scenes
from gearopt.errors import SceneError, SolveError
from gearopt.scenes.reading.changes import as_written
from gearopt.scenes.reading.fields import Reads
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import kind_named, read
from gearopt.scenes.reading.mistakes import tables


@pytest.mark.parametrize("kind", kinds())
@pytest.mark.parametrize("line", ['kind = ""', ""])
def test_the_kind_is_guessed_from_the_tables(kind, line):
    text = re.sub(r"(?m)^kind = .*$", line, kind_named(kind).example.text)
    with pytest.raises(SceneError) as wrong:
        read(text.encode())
    assert wrong.value.fix.value == f'"{kind}"', "a kind is told by a table that no other has"


def test_a_kind_that_cannot_be_imported_is_named_and_leaves_the_others_alone(tmp_path, monkeypatch):
    (tmp_path / "broken.py").write_text("from gearopt.units import nothing\n")
    monkeypatch.setattr(gearopt.scenes, "__path__", [*gearopt.scenes.__path__, str(tmp_path)])
    for text in (kind_named("compound").example.text, "gearopt = 1\n"):  # and of no kind's tables
        with pytest.raises(SceneError) as wrong:
            read(re.sub(r"(?m)^kind = .*$", "", text).encode())
        assert wrong.value.fix.value == '"compound"'
    words = r"kind 'broken' cannot be imported: .*nothing.* \(broken.py, line 1\)"
    with pytest.raises(SolveError, match=words):
        read(b'gearopt = 1\nkind = "broken"\n')
    assert "gearopt.scenes.broken" not in sys.modules


def test_a_scene_and_its_tables_are_frozen():
    _, scene = read(kind_named("drive").example.text.encode())
    for table, key in ((scene, "duty"), (scene.duty, "power")):
        with pytest.raises(ValidationError, match="frozen"):
            setattr(table, key, None)


def test_every_reader_takes_its_example_and_what_it_returned():
    """Values that were read are read again where a scene is made from another one."""
    for kind in kinds():
        for _, table in tables(kind_named(kind).scene):
            for name, info in table.model_fields.items():
                for reads in (m for m in info.metadata if isinstance(m, Reads) and not m.opens):
                    try:
                        found = reads.reader(as_written(reads.example), reads.example)
                    except Exception as reason:
                        reason.add_note(f"the example of {kind}: {table.__name__}.{name}")
                        raise
                    assert reads.reader(found, reads.example) == found, (table, name)


def test_numbers_that_a_remedy_may_move_are_places_of_the_file():
    """A step of a place that its scene lacks is an error, and not every place is empty."""
    for kind in (kind_named(name) for name in kinds() if kind_named(name).moves is not None):
        _, scene = read(kind.example.text.encode())
        values = {move.path: move.inherits(scene, move.path) for move in kind.moves(scene)}
        assert values and any(value is not None for value in values.values()), kind.scene
