"""The docs say what the program does: keys, limits, commands, examples, links."""

import re
import tomllib
from fractions import Fraction
from pathlib import Path

import pytest

import gearopt
from gearopt import api, cli
from gearopt.formulations.drive import continuous_sizing, teeth
from gearopt.optimise.methods import back_ends
from gearopt.report.measures import METRIC
from gearopt.scenes.reading.json_schema import reference
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import kind_named, read
from gearopt.units import UNITS

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def text(name):
    return (ROOT / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", kinds())
def test_the_reference_page_holds_the_generated_tables_and_the_example_file(kind):
    assert (DOCS / f"{kind}.md").exists(), f"kind {kind} needs a page docs/{kind}.md"
    page = text(f"docs/{kind}.md")
    assert reference(kind) in page
    assert kind_named(kind).example.text in page


def test_the_reference_page_holds_every_unit():
    page = text("docs/drive.md")
    for dimension, units in UNITS.items():
        if dimension != "fraction":
            assert f"{dimension}: {', '.join(f'`{u}`' for u in units)}" in page


def test_every_limit_name_is_documented():
    """All limits that a drive with everything switched on can have."""
    _, scene = read(EVERYTHING.encode())
    problems = (teeth.problem(scene.train()), continuous_sizing.problem(scene.train()))
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


def printed(code, capsys, monkeypatch):
    """What a page's Python prints, run in the project's folder."""
    monkeypatch.chdir(ROOT)
    exec(compile(code, "page", "exec"), {})
    return capsys.readouterr().out


def test_python_of_the_start_page_runs(capsys, monkeypatch):
    code = re.findall(r"```python\n(.*?)```", text("docs/start.md"), re.S)
    said = printed("".join(code), capsys, monkeypatch)
    assert said.startswith("optimal 5782370.7") and "2.0 21 115" in said
    assert "7.5 kW 5782370.7" in said and "11 kW 8507482.2" in said


def test_python_of_the_conic_section_runs(capsys, monkeypatch):
    section = text("docs/contract.md").split("## Conic problems")[1]
    code = re.search(r"```python\n(.*?)```", section, re.S)[1]
    best = (3**0.5 + 2.0 + 3**0.5) ** 2 / 0.2  # (sum sqrt(a s))^2 / E
    assert printed(code, capsys, monkeypatch) == f"optimal {round(best, 6)}\n"


def test_the_walk_of_the_start_page(tmp_path):
    """Copied, changed, misspelt, mended, laid out: every answer printed there is the program's."""
    page, path = text("docs/start.md"), tmp_path / "my.toml"
    right = text("problems/elevator.toml")
    duty = re.search(r"\[duty\]\n.*?(?=\n```)", page, re.S)[0]
    assert duty in right
    wrong = {right.replace("input_speed", "input_sped"), right.replace("7.5 kW", "7,5 kW")}
    told = set()
    for content in wrong:
        path.write_text(content, encoding="utf-8")
        with pytest.raises(gearopt.SceneError) as error:
            gearopt.load(path)
        told.add(f"gearopt: {error.value}".replace(str(path), "my.toml"))
    assert told == set(re.findall(r"(?m)^gearopt: my.toml: .*$", page))
    path.write_text(stronger := right.replace('"7.5 kW"', '"11 kW"'), encoding="utf-8")
    assert f"needs {METRIC.amount(gearopt.solve(path).value, 'mm3')}" in page
    path.write_text(
        stronger + re.search(r"\[layout\]\n.*?(?=```)", page, re.S)[0], encoding="utf-8"
    )
    assert f"has {METRIC.amount(gearopt.solve(path).value, 'mm3')}" in page


def test_readme_shows_what_the_command_prints(here, monkeypatch):
    """Every line of the shortened output, in order; and README's two commands, that CI reads."""
    page = text("README.md")
    command, shown = re.findall(r"(?ms)^```\n(.*?)^```$", page)[:2]
    assert re.findall(r"(?m)^python3 -m venv.*$", page)[0] == command.strip()
    assert len(re.findall(r"(?m)^python3 -m venv", page)) == 2
    monkeypatch.chdir(ROOT)
    said = here("solve", "problems/elevator.toml").stdout
    lines = iter([line.rstrip() for line in said.splitlines()])
    assert all(line in lines for line in shown.splitlines() if line != "...")


def test_paths_of_the_contributors_page_exist():
    page = text("docs/contributing.md")
    paths = set(re.findall(r"`((?:src|docs|tests|problems|\.ci)[\w/.]*)`", page))
    assert len(paths) >= 10
    for path in paths:
        assert "NAME" in path or "FILE" in path or (ROOT / path).exists(), path


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
    own = ("exact", "process-one", "process-two", "hop", "sa", "sa-polish", "sa-paper", "smooth")
    for name in (*own, *back_ends()):
        assert f"| `{name}` |" in page, name


@pytest.mark.parametrize("page", sorted(p.name for p in DOCS.glob("*.md")) + ["../README.md"])
def test_no_sentence_breaks_into_a_list(page):
    """A line of a paragraph that starts with a sign or a number and a point becomes a bullet."""
    lines = re.sub(r"```.*?```", "", text(f"docs/{page}"), flags=re.S).splitlines()
    for before, line in zip(lines, lines[1:], strict=False):
        if re.match(r"[+*] |\d+[.)] ", line):
            assert not before.strip() or re.match(r"\s*([-+*]|\d+[.)]) |  ", before), line
