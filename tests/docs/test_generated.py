"""Pages that are written by docs/generate.py say what the program and problems/ say now."""

import re
import tomllib
from pathlib import Path

import commands
import gallery
import generate
import pytest
import python_api

import gearopt
from gearopt.cli import app
from gearopt.cli.app import EXIT
from gearopt.scenes.reading.json_schema import reference as tables
from gearopt.scenes.reading.kinds import kinds
from gearopt.scenes.reading.load import kind_named

ROOT = Path(__file__).parents[2]
FAST = ("elevator", "elevator_box", "three_stages_ratio_cap", "sandgren_train")


def page(name):
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", generate.PAGES)
def test_the_page_is_what_is_written_now(name):
    assert page(name) == generate.PAGES[name](), "run: python docs/generate.py"


def section(name):
    return commands.page().split(f"\n## gearopt {name}\n")[1].split("\n## ")[0]


@pytest.mark.parametrize("command", app.registered_commands, ids=lambda c: c.callback.__name__)
def test_the_reference_has_what_help_prints(command, here, monkeypatch):
    """Options, defaults and first words of each help, against typer's own reading."""
    name = command.name or command.callback.__name__
    monkeypatch.setenv("COLUMNS", "2000")
    done = here(name, "--help")
    assert done.returncode == 0
    printed = [line for line in done.stdout.splitlines() if re.search(r"^\W*--", line)]
    helped = {re.search(r"--[\w-]+", line)[0] for line in printed} - {"--help"}
    rows = dict(re.findall(r"(?m)^\| `(--[\w-]+)[^`]*` \| (.*) \|$", section(name)))
    assert rows.keys() == helped
    words = " ".join(done.stdout.replace("│", " ").split())
    for option, row in rows.items():
        default, meaning = row.split(" | ", 1) if " | " in row else ("", row)
        assert meaning.split(".")[0].split("[")[0].strip(" |") in words, option
        if default.strip(" `"):
            near = words.split(f"{option} ")[1]
            assert same(re.search(r"\[default: (.*?)\]", near)[1], default.strip("`"))


def same(a, b):
    return a == b or float(a) == float(b)


def test_every_exit_code_is_told():
    assert {*EXIT.values(), 0, 2, 3, 4} <= set(commands.EXIT_CODES)
    assert all(f"| {code} | " in page("commands.md") for code in commands.EXIT_CODES)


@pytest.mark.parametrize("kind", kinds())
def test_tables_of_keys_are_written_where_they_belong(kind, tmp_path, monkeypatch):
    """A page as a contributor begins it becomes one that holds all of its kind."""
    begun = f"# A page\n\n```toml\ngearopt = 1\n```\n\n### top of the file\n\n## More\n\n{kind}\n"
    (tmp_path / f"{kind}.md").write_text(begun, encoding="utf-8")
    assert generate.page_of(kind) == page(f"{kind}.md")
    monkeypatch.setattr(generate, "DOCS", tmp_path)
    made = generate.page_of(kind)
    assert kind_named(kind).example.text in made and tables(kind) in made
    assert made.startswith("# A page\n") and made.endswith(f"\n## More\n\n{kind}\n")


def test_a_problem_file_without_a_line_in_the_gallery_is_named(tmp_path, monkeypatch):
    for path in gallery.PROBLEMS.glob("*.toml"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    monkeypatch.setattr(gallery, "PROBLEMS", tmp_path)
    assert gallery.page() == page("gallery.md")
    (tmp_path / "another.toml").write_text('gearopt = 1\nkind = "drive"\n')
    with pytest.raises(ValueError, match="another"):
        gallery.page()


@pytest.mark.parametrize("name", FAST)
def test_the_gallery_names_objectives_as_the_program_does(name, solved):
    path = gallery.PROBLEMS / f"{name}.toml"
    found = solved(name).objective
    name, unit = gallery.objective(tomllib.loads(path.read_text(encoding="utf-8")))
    assert (name, unit.replace("³", "3").replace("²", "2")) == (found["name"], found["unit"])


def test_the_python_page_names_all_that_is_public(monkeypatch):
    assert all(f"### {name}\n" in page("python.md") for name in gearopt.__all__)
    monkeypatch.setattr(gearopt, "__all__", [*gearopt.__all__, "novelty"])
    with pytest.raises(ValueError, match="novelty"):
        python_api.page()


def test_the_compound_page_shows_the_code_as_it_is():
    assert page("compound.md") == generate.with_code(), "run: python docs/generate.py"
    assert page("compound.md").count("def exact(") == 1


@pytest.mark.parametrize("name", ["agma.md", "iso6336.md"])
def test_python_of_the_pages_on_ratings_runs(capsys, name):
    """What it prints are safety factors, the least of which governs."""
    block = page(name).split("```python\n")[1].split("```")[0]
    exec(compile(block, name, "exec"), {})
    numbers, member, mode = re.search(
        r"\[(.*)\] \('(\w+)', '(\w+)'\)", capsys.readouterr().out
    ).groups()
    values = [float(n) for n in numbers.split(", ")]
    names = [(m, k) for k in ("bending", "contact") for m in ("pinion", "wheel")]
    of_load = [v**2 if k == "contact" else v for v, (_, k) in zip(values, names, strict=True)]
    assert names[of_load.index(min(of_load))] == (member, mode)


def test_python_of_the_page_on_rings_runs_after_that_of_pairs(capsys):
    """It prints four safety factors and names what no second source has."""
    known = {}
    for part in page("iso6336.md").split("```python\n")[1:]:
        exec(compile(part.split("```")[0], "iso6336.md", "exec"), known)
    printed = capsys.readouterr().out.splitlines()[-1]
    numbers, names = re.fullmatch(r"\[(.*)\] \((.*)\)", printed).groups()
    assert all(float(n) > 0.5 for n in numbers.split(", "))
    assert "'K_Hbeta'" in names
