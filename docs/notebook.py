"""The page docs/notebook.md: its code run in an empty folder; the same for Jupyter."""

import contextlib
import io
import json
import os
import re
import tempfile
from pathlib import Path

from gearopt.scenes.reading.load import kind_named

PAGE = Path(__file__).parent / "notebook.md"
FILE = "drive.toml"
BEGIN = f"gearopt new drive > {FILE}"  # the command that writes it
BLOCK = re.compile(r"```python\n(.*?)```\n(?:\n```\n(.*?)```\n)?", re.S)


def run(page: str, first: int | None = None) -> list[str]:
    """What each block of a page prints, run in order in one namespace; first: so many."""
    scope: dict[str, object] = {}
    said, before = [], Path.cwd()
    with tempfile.TemporaryDirectory() as room:
        os.chdir(room)
        try:
            Path(FILE).write_text(kind_named("drive").example.text, encoding="utf-8")
            for code, _ in BLOCK.findall(page)[:first]:
                with contextlib.redirect_stdout(io.StringIO()) as out:
                    exec(compile(code, "docs/notebook.md", "exec"), scope)
                said.append(out.getvalue())
        finally:
            os.chdir(before)
    return said


def solved() -> str:
    """Return the page with what its blocks print now."""
    page = PAGE.read_text(encoding="utf-8")
    said = iter(run(page))

    def block(found: re.Match[str]) -> str:
        out = next(said)
        return f"```python\n{found[1]}```\n" + (f"\n```\n{out}```\n" if out else "")

    return BLOCK.sub(block, page)


def ipynb() -> str:
    """Return the page as a notebook: its text, its code, and what that prints."""
    page = PAGE.read_text(encoding="utf-8")
    first = page.index("\n\n")
    cells = [_text(page[:first]), _code(f"!{BEGIN}", "")]
    end = first
    for found in BLOCK.finditer(page):
        cells += [_text(page[end : found.start()]), _code(found[1], found[2] or "")]
        end = found.end()
    cells = [cell | {"id": f"cell-{k}"} for k, cell in enumerate([*cells, _text(page[end:])], 1)]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    book = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(book, indent=1, ensure_ascii=False) + "\n"


def _text(words: str) -> dict[str, object]:
    return {"cell_type": "markdown", "metadata": {}, "source": words.strip()}


def _code(code: str, out: str) -> dict[str, object]:
    outputs = [{"output_type": "stream", "name": "stdout", "text": out}] if out else []
    cell = {"cell_type": "code", "metadata": {}, "execution_count": None}
    return cell | {"source": code.rstrip("\n"), "outputs": outputs}
