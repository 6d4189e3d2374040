"""The docs say what the program does: keys, limits, commands, examples, links."""

import re
import subprocess
import sys
import tomllib
from fractions import Fraction
from pathlib import Path

import pytest

from gearopt import api, cli
from gearopt.formulations import sizing, teeth
from gearopt.optimise.solve import back_ends
from gearopt.scenes.reading.load import kinds, read, scene_module
from gearopt.scenes.reading.schema import reference
from gearopt.units import UNITS

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def text(name):
    return (ROOT / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", kinds())
def test_the_reference_page_holds_the_generated_tables_and_the_example_file(kind):
    page = text(f"docs/{kind}.md")
    assert reference(kind) in page
    assert scene_module(kind).EXAMPLE in page


def test_the_reference_page_holds_every_unit():
    page = text("docs/drive.md")
    for dimension, units in UNITS.items():
        if dimension != "fraction":
            assert f"{dimension}: {', '.join(f'`{u}`' for u in units)}" in page


def test_every_limit_name_is_documented():
    """All limits that a drive with everything switched on can have."""
    _, scene = read(EVERYTHING.encode())
    problems = (teeth.problem(scene.train()), sizing.problem(scene.train()))
    rows = [row.name for problem in problems for row in problem.rows.inequalities]
    names = {re.sub(r"\[\d+\]", "", name) for name in rows}
    page = text("docs/drive.md")
    assert len(names) >= 14
    for name in names:
        assert re.search(rf"`{name}(\[i\])?`", page), name


EVERYTHING = """
gearopt = 1
kind = "drive"
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
ratio = 20
[[stage]]
face_width_over_diameter = [0.3, 0.6]
[[stage]]
face_width_over_diameter = 0.6
[limits]
preset = "chong-lee-elevator"
pinion_teeth = [20, 30]
wheel_teeth = [30, 300]
module = ["1 mm", "8 mm"]
stage_ratio = [2, 8]
wheel_diameter = "500 mm"
[teeth]
coprime = true
[objective]
minimise = "mass"
density = "7.85 kg/dm^3"
"""


def test_every_command_and_option_is_documented():
    pages = "\n".join(p.read_text(encoding="utf-8") for p in DOCS.glob("*.md")) + text("README.md")
    for command in cli.app.registered_commands:
        name = command.name or command.callback.__name__
        assert f"gearopt {name}" in pages, name
        assert command.callback.__doc__


@pytest.mark.parametrize("page", sorted(p.name for p in DOCS.glob("*.md")) + ["../README.md"])
def test_links_lead_somewhere(page):
    path = DOCS / page
    for target in re.findall(r"\]\(([^)#]+)\)", path.read_text(encoding="utf-8")):
        assert "://" in target or (path.parent / target).exists(), target


def test_python_of_the_start_page_runs():
    code = re.search(r"```python\n(.*?)```", text("docs/start.md"), re.S)[1]
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("optimal 5782370.7")
    assert "2.0 21 115" in done.stdout


def test_python_of_the_conic_section_runs():
    section = text("docs/contract.md").split("## Conic problems")[1]
    code = re.search(r"```python\n(.*?)```", section, re.S)[1]
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    best = (3**0.5 + 2.0 + 3**0.5) ** 2 / 0.2  # (sum sqrt(a s))^2 / E
    assert done.stdout == f"optimal {round(best, 6)}\n"


def test_readme_table_is_what_the_files_give():
    """Each row: file, stages, paper, optimum; the optimum is the file's own expected value."""
    rows = re.findall(r"\| `(\w+)\.toml` \|[^|]*\|[^|]*\| ([\d,.]+) \|", text("README.md"))
    assert len(rows) >= 2
    for name, value in rows:
        content = tomllib.loads(text(f"problems/{name}.toml"))
        expected = content["x-expected"]["objective"]
        assert Fraction(value.replace(",", "")) == round(Fraction(str(expected)))


def test_schema_command_prints_what_the_library_holds():
    assert api.load(ROOT / "problems" / "elevator.toml").title == "Two-stage elevator drive"


def test_every_method_has_its_row():
    page = text("docs/methods.md")
    own = ("exact", "process-one", "process-two", "hop", "sa", "sa-polish", "sa-paper")
    for name in (*own, *back_ends()):
        assert f"| `{name}` |" in page, name
