"""The page for users of other tools: its texts run, and agree."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "other_tools.md").read_text(encoding="utf-8")


def test_the_texts_of_the_page_agree(capsys):
    ours = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    theirs = {part.split("\n")[0]: part for part in re.findall(r"```py\n# (.*?)```", PAGE, re.S)}
    room = {}
    for text in ours:
        exec(text, room)
    told = capsys.readouterr().out
    assert "volume 126.49, proven optimal" in told and "cost 5,850.4, proven optimal" in told
    other = {}
    exec("# " + theirs["cvxpy"], other)
    assert other["problem"].value == pytest.approx(126.4911, rel=1e-5)
    exec("# " + theirs["pymoo"], other)
    found = [p.values for p in room["front"].points]
    for first, second in other["front"][::20]:  # none of theirs beats a point of ours
        assert not any(first < f and second < s * (1 - 1e-6) for f, s in found)
    assert len(found) > 20
