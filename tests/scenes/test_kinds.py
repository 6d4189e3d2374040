"""A file without a right kind is told the kind that knows its tables."""

import re

import pytest

from gearopt.errors import SceneError
from gearopt.scenes.reading.load import kinds, read, scene_module


@pytest.mark.parametrize("kind", kinds())
@pytest.mark.parametrize("line", ['kind = ""', ""])
def test_the_kind_is_guessed_from_the_tables(kind, line):
    text = re.sub(r"(?m)^kind = .*$", line, scene_module(kind).EXAMPLE)
    with pytest.raises(SceneError) as wrong:
        read(text.encode())
    assert wrong.value.fix.value == f'"{kind}"'
