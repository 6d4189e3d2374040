"""docs/notebook.md: its code prints what it shows; the notebook to download is the page."""

import json
import re

import notebook
import pytest

PAGE = notebook.PAGE.read_text(encoding="utf-8")
BLOCKS = notebook.BLOCK.findall(PAGE)


def test_the_first_blocks_print_what_the_page_shows():
    assert notebook.run(PAGE, first=2) == [shown for _, shown in BLOCKS[:2]]


@pytest.mark.slow
def test_every_block_prints_what_the_page_shows():
    """In order, in one namespace, in an empty folder with the file that `gearopt new` prints."""
    assert notebook.solved() == PAGE, "run: python docs/generate.py --solve"


def test_the_first_output_takes_less_than_ten_lines():
    code, shown = BLOCKS[0]
    assert notebook.BEGIN in PAGE.split("```python")[0]
    assert len(code.splitlines()) + 1 < 10 and "proven optimal" in shown


def test_every_code_of_the_page_is_a_block_that_is_run():
    assert len(BLOCKS) == PAGE.count("```python\n") >= 8
    assert PAGE.count("```") == 2 * (len(BLOCKS) + sum(bool(shown) for _, shown in BLOCKS))


def test_the_notebook_is_the_page():
    """By the keys that nbformat 4.5 asks for."""
    path = notebook.PAGE.with_suffix(".ipynb")
    assert path.read_text(encoding="utf-8") == notebook.ipynb(), "run: python docs/generate.py"
    book = json.loads(notebook.ipynb())
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    cells = book["cells"]
    assert len({cell["id"] for cell in cells}) == len(cells)
    assert all(re.fullmatch(r"[a-zA-Z0-9_-]{1,64}", cell["id"]) for cell in cells)
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert code[0]["source"] == "!gearopt new drive > drive.toml"
    assert [c["source"] + "\n" for c in code[1:]] == [text for text, _ in BLOCKS]
    assert all(cell["source"] and "```" not in cell["source"] for cell in cells)
