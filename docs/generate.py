"""Write the generated pages and pictures of the docs: `python docs/generate.py`.

In the page of a kind of problem file the example and the tables of keys are written. With --solve
the problem files whose pictures are shown are solved again first, and the notebook is run. Tests
hold every file to this.
"""

import re
import sys
from pathlib import Path

import agma
import commands
import gallery
import in_mesh
import iso6336
import notebook
import pictures
import python_api
import rate_page

from gearopt.scenes.reading.json_schema import reference as tables
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import kind_named

DOCS = Path(__file__).parent
PAGES = {
    "agma.md": agma.page,
    "commands.md": commands.page,
    "gallery.md": gallery.page,
    "iso6336.md": iso6336.page,
    "python.md": python_api.page,
    "rate.md": rate_page.page,
    "tooth_stiffness.md": in_mesh.page,
}


def page_of(kind: str) -> str:
    """The page of a kind with its example and its tables of keys as they are now."""
    path = DOCS / f"{kind}.md"
    if not path.exists():
        raise SystemExit(f"kind {kind} needs a page docs/{kind}.md: see docs/compound.md")
    page = path.read_text(encoding="utf-8")
    example = f"```toml\n{kind_named(kind).example.text}```"
    page = re.sub(r"```toml\ngearopt = 1\n.*?```", lambda _: example, page, count=1, flags=re.S)
    keys = r"### top of the file\n.*?(?=\n## |\Z)"
    return re.sub(keys, lambda _: tables(kind), page, count=1, flags=re.S)


def with_code() -> str:
    """The page of the compound train with the code of its two files as it is now."""
    page = (DOCS / "compound.md").read_text(encoding="utf-8")
    head, *blocks = page.split("```python\n")
    files = ("formulations/compound/__init__.py", "scenes/compound/__init__.py")
    for file, block in zip(files, blocks, strict=True):
        code = (DOCS.parent / "src" / "gearopt" / file).read_text(encoding="utf-8")
        head += f"```python\n{code}" + block[block.index("```\n") :]
    return head


def main() -> None:
    """Write all of them."""
    if "--solve" in sys.argv:
        for name in pictures.PICTURES:
            (pictures.ROOM / f"{name}.json").write_text(pictures.solve(name), encoding="utf-8")
        for name in pictures.FRONTS:
            (pictures.ROOM / f"{name}.json").write_text(
                pictures.solve_front(name), encoding="utf-8"
            )
        notebook.PAGE.write_text(notebook.solved(), encoding="utf-8")
    (DOCS / "notebook.ipynb").write_text(notebook.ipynb(), encoding="utf-8")
    for name in pictures.PICTURES:
        (pictures.ROOM / f"{name}.svg").write_text(pictures.draw(name), encoding="utf-8")
    for name in pictures.FRONTS:
        (pictures.ROOM / f"{name}.svg").write_text(pictures.draw_front(name), encoding="utf-8")
    for name, page in PAGES.items():
        (DOCS / name).write_text(page(), encoding="utf-8")
    (DOCS / "compound.md").write_text(with_code(), encoding="utf-8")
    for kind in kinds():
        (DOCS / f"{kind}.md").write_text(page_of(kind), encoding="utf-8")


if __name__ == "__main__":
    main()
