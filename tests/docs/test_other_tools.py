"""The page for users of other tools: its texts run, and agree."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "other_tools.md").read_text(encoding="utf-8")
FIRST, *PROVEN, FRONT = re.findall(r"```python\n(.*?)```", PAGE, re.S)


def run(*texts):
    """The names of our texts, which were run."""
    names = {}
    for text in texts:
        exec(text, names)
    return names


def test_our_texts_print_what_the_page_says(capsys):
    run(FIRST, *PROVEN)
    told = capsys.readouterr().out
    assert "volume 126.49, proven optimal" in told and "cost 5,850.4, proven optimal" in told


@pytest.mark.slow
def test_the_texts_of_other_tools_agree():
    room = run(FIRST, FRONT)
    assert len(room["front"].points) > 20
    theirs = {part.split("\n")[0]: part for part in re.findall(r"```py\n# (.*?)```", PAGE, re.S)}
    other = {}
    exec("# " + theirs["cvxpy"], other)
    assert other["problem"].value == pytest.approx(126.4911, rel=1e-5)
    exec("# " + theirs["pymoo"], other)
    found = [p.values for p in room["front"].points]
    for first, second in other["front"][::20]:  # none of theirs beats a point of ours
        assert not any(first < f and second < s * (1 - 1e-6) for f, s in found)
