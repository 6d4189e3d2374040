"""What each kind of result shows is found by its name, and so is what any other kind shows."""

import io
from dataclasses import replace
from pkgutil import iter_modules

import layout_cases as cases
import pytest
from rich.console import Console

import gearopt
from gearopt.report import kinds
from gearopt.report.kinds import generic, kind_named
from gearopt.report.pages.result import sections
from gearopt.report.terminal import show
from gearopt.scenes.reading import load


def test_every_module_is_a_kind_of_problem_file():
    assert {m.name for m in iter_modules(kinds.__path__)} - {"generic"} <= set(load.kinds())


@pytest.mark.parametrize("kind", load.kinds())
def test_a_kind_has_a_drawing_or_says_that_it_has_none(kind):
    """A kind whose designs have no drawing declares `drawn=False` in report/kinds/KIND.py."""
    _, scene = load.read(load.scene_module(kind).EXAMPLE.encode())
    result = gearopt.solve(scene, budget=gearopt.Budget(5.0))
    drawn = any(section.drawings for section in sections(result))
    assert drawn is kind_named(kind).drawn


@pytest.mark.parametrize("scene", [None, "a_new_kind"])
def test_other_kinds_are_shown_by_what_their_design_holds(scene):
    """Stages as a table and a drawing, the rest by keys with units; the same on the terminal."""
    design = {"stages": cases.drive(cases.ELEVATOR)["stages"], "shift_mm": 1.5, "hubs": [1, 2]}
    result = replace(cases.elevator(), scene=scene, design=design, parts=())
    assert kind_named(scene) is generic.KIND
    made = {section.heading: section for section in sections(result)}
    assert len(made["Gears in one line"].drawings) == 2
    assert [t.name for t in made["Design"].tables] == ["stages", "volume and mass", "totals"]
    out = io.StringIO()
    show(result, Console(file=out, width=99))
    for words in ("face width b [mm]", "shift [mm]", "limit used, %"):
        assert words in out.getvalue()
