"""Write the generated pages and pictures of the docs: `python docs/generate.py`.

With --solve the problem files whose pictures are shown are solved again first. Tests hold every
file to what is written here.
"""

import sys
from pathlib import Path

import gallery
import pictures
import python_api

from gearopt.cli.reference import reference

DOCS = Path(__file__).parent
PAGES = {"commands.md": reference, "gallery.md": gallery.page, "python.md": python_api.page}


def main() -> None:
    """Write all of them."""
    if "--solve" in sys.argv:
        for name in pictures.PICTURES:
            (pictures.ROOM / f"{name}.json").write_text(pictures.solve(name), encoding="utf-8")
    for name in pictures.PICTURES:
        (pictures.ROOM / f"{name}.svg").write_text(pictures.draw(name), encoding="utf-8")
    for name, page in PAGES.items():
        (DOCS / name).write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
