"""The page and the terminal table of a comparison: self-contained, escaped, complete."""

import json
import re
import time
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from page_reader import ATTACK, Reader
from rich.console import Console

import gearopt
from gearopt import Problem, Terms, Var
from gearopt.optimise.result import Outcome
from gearopt.report import comparison as words
from gearopt.report.pages import frame
from gearopt.report.pages.comparison import colours, page
from gearopt.report.terminal import show_comparison

ROOM = Path(frame.__file__).parent


def problem():
    def evaluate(x, p):
        a, b, c = x.side
        return Terms({"inverse": 1.0 / (a * b * c)}, {"surface": (a * b + b * c + c * a) / 3.0})

    def wrong(problem, budget, seed, watch):
        return Outcome(np.full(3, 1.1 if seed else 0.9))

    side = Var("side", "m", 0.01, 100.0, 2.0, size=3, log=True)
    return Problem("box", (side,), (), evaluate, methods={"wrong": wrong})


@pytest.fixture(scope="module")
def found():
    methods = ("ipopt", "annealing", "wrong", "gp")
    made = gearopt.compare(problem(), methods=methods, seeds=3, evaluations=640, seconds=0.02)
    (group,) = made.groups
    *others, last = group.rows
    refused = replace(
        last, refused=f"no {ATTACK}", equal_evaluations=None, equal_time=None, start_up_seconds=None
    )
    group = replace(group, rows=(*others, refused), words=f"Boxes {ATTACK}")
    return replace(made, title=f"Title {ATTACK}", groups=(group,), message=f"stopped {ATTACK}")


@pytest.fixture(scope="module")
def read(found):
    return Reader(page(found))


def test_nothing_is_loaded_from_anywhere(found, read):
    loads = [
        value
        for _, attributes in read.tags
        for name, value in attributes.items()
        if name in ("src", "href", "data", "action", "srcset", "poster")
    ]
    assert loads == ["data:,"]  # the icon that browsers would otherwise ask for
    for name in ("frame.css", "frame.html", "frame.js", "figure.html", "comparison.html"):
        text = (ROOM / name).read_text(encoding="utf-8")
        assert not re.search(r"https?://|//[a-z]|@import|url\(|fetch\(|import\(", text), name


def test_plotly_is_inlined_once(found, read):
    bundles = [text for _, text in read.scripts if "plotly.js v" in text[:400]]
    assert len(bundles) == 1
    assert len(page(found)) < 1.2 * len(bundles[0])


def test_titles_and_reasons_are_escaped(read):
    assert {tag for tag, _ in read.tags}.isdisjoint({"b"})
    kinds = [kind for kind, _ in read.scripts]
    assert kinds.count("") == 1 and set(kinds) == {"", "application/json", "text/plain"}
    assert not any("alert(" in text for kind, text in read.scripts if "json" in kind)
    text = "".join(read.text)
    for word in ("Title", "Boxes", "stopped", "no"):
        assert f"{word} {ATTACK}" in text


def test_every_method_its_verdict_numbers_and_settings_are_shown(found, read):
    text = re.sub(r"\s+", " ", "".join(read.text))
    for group in found.groups:
        for row in group.rows:
            assert f"{row.method}: {words.verdict(group, row)}." in text
            for sample in (row.equal_evaluations, row.equal_time):
                for cell in words.cells(found, sample) if sample else ():
                    assert cell in text
    assert "chains 32" in text and "deterministic" in text
    for line in words.FAIRNESS:
        assert line in text
    assert words.command(found) in text
    assert gearopt.Result("", "", "", {}).gearopt in text


def test_figures_are_plotly_specifications_in_the_page_colours(read):
    style = (ROOM / "frame.css").read_text(encoding="utf-8")
    known = set(re.findall(r"(--[\w-]+):", style))
    figures = [json.loads(text) for kind, text in read.scripts if "json" in kind]
    assert len(figures) == 4
    for figure in figures:
        assert figure["data"] and figure["layout"]["yaxis"]["type"] == "log"
        used = set(re.findall(r'"(--[\w-]+)(?:/[\d.]+)?"', json.dumps(figure)))
        assert used and used <= known
    names = {trace["name"] for figure in figures for trace in figure["data"] if "name" in trace}
    assert names == {"ipopt", "annealing", "wrong"}


def test_a_method_has_one_colour_on_every_page():
    alone, together = colours(["scip"]), colours(["exact", "mine", "scip", "annealing", "other"])
    assert alone["scip"] == together["scip"]
    assert len(set(together.values())) == 5


def test_dark_colours_are_those_of_the_light_page():
    style = (ROOM / "frame.css").read_text(encoding="utf-8")
    light, dark = (re.findall(r"(--[\w-]+): #", part) for part in style.split("@media", 2)[:2])
    assert len(light) == len(dark) and set(light) == set(dark)


def printed(found, width=110):
    out = StringIO()
    show_comparison(found, Console(file=out, width=width, highlight=False))
    return out.getvalue()


def test_terminal_shows_the_same_words(found):
    text = printed(found, 300)
    for group in found.groups:
        for row in group.rows:
            assert f"- {row.method}: {words.verdict(group, row)}" in text
    assert "Equal evaluations: 640 per run" in text and "Equal time: 0.02 s per run" in text
    assert ATTACK in text and words.command(found) in text


def test_terminal_fits_80_columns(found):
    assert max(map(len, printed(found, 80).splitlines())) <= 80


def test_verdicts():
    made = gearopt.compare(
        problem(), methods=("ipopt", "wrong"), seeds=3, evaluations=64, seconds=5.0
    )
    (group,) = made.groups
    ipopt, wrong = group.rows
    assert words.reference(group).startswith(
        "Gaps are measured from the proven lower bound of the inverse, 1"
    )
    assert words.verdict(group, ipopt).startswith("reaches the proven optimum in ")
    missed = "0 of 3 seeds within 0.1 %, 2 without a feasible point"
    assert words.verdict(group, wrong).startswith(
        f"no feasible point in the median seed; {missed} ("
    )
    unknown = replace(group, proven=False, bound_from="")
    assert "Nothing is proven here" in words.reference(unknown)
    assert "best design found" in words.verdict(unknown, ipopt)
    volume = replace(unknown, objective="volume")
    assert "from the best container volume found, " in words.reference(volume, "packing")


@pytest.mark.parametrize(
    ("size", "finished", "said"),
    [
        (0.9, True, "37.2 % above the proven optimum, in the one run it needs"),
        (0.9, False, "37.2 % above the proven optimum, where the time ended its one run"),
        (1.1, True, "no feasible point (surface is violated by 0.21)"),
        (
            1.1,
            False,
            "no feasible point before the time ended its one run (surface is violated by 0.21)",
        ),
    ],
)
def test_a_run_that_the_time_ended_is_not_all_that_its_method_needs(size, finished, said):
    def best(problem, budget, seed, watch):
        return Outcome(np.ones(3))

    def once(problem, budget, seed, watch):
        return Outcome(np.full(3, size), finished=finished)

    both = replace(problem(), methods={"best": best, "once": once})
    (group,) = gearopt.compare(both, methods=("best", "once"), seeds=1, seconds=0.01).groups
    assert words.verdict(group, replace(group.rows[1], random=False)) == said


@pytest.mark.parametrize(
    ("gap", "text"),
    [
        (None, "none"),
        (0.0, "0"),
        (3e-12, "3e-10"),
        (0.00123, "0.12"),
        (0.0842, "8.4"),
        (2.9, "290"),
    ],
)
def test_percent(gap, text):
    assert words.percent(gap) == text


def test_runs_that_the_clock_ended_are_named():
    def slow(problem, budget, seed, watch):
        end = time.perf_counter() + min(budget.seconds, 0.1)
        while time.perf_counter() <= end:
            pass
        return Outcome(np.full(3, 0.9), finished=False, evaluations=3)

    made = gearopt.compare(
        replace(problem(), methods={"slow": slow}),
        methods=("slow",),
        seeds=2,
        evaluations=9,
        seconds=0.001,
    )
    words_of_it = "2 runs of slow ended by the clock, after 0.01 s"
    assert words_of_it in printed(made) and words_of_it in page(made)


@pytest.mark.slow
def test_a_proof_that_nothing_is_feasible_is_the_verdict():
    made = gearopt.compare(
        "problems/elevator_small_wheels.toml",
        methods=("exact", "annealing"),
        seeds=2,
        evaluations=640,
        seconds=0.25,
    )
    (group,) = made.groups
    assert words.reference(group).startswith("No design meets all limits, proven (exact)")
    assert words.verdict(group, group.rows[0]) == "proves that no design meets the limits"
    assert words.verdict(group, group.rows[1]).startswith("no feasible point in any of 2 seeds")
    assert "figure" not in {tag for tag, _ in Reader(page(made)).tags}


def test_gaps_to_a_bound_of_zero_are_said_in_the_scale_of_the_objective(found):
    (group,) = found.groups
    group = replace(group, reference=-1.4e-73, best=1.7e-3, scale=4.0, proven=True, bound_from="qp")
    said = words.reference(group)
    assert "scale, 4" in said and "best found is 0.0017" in said and "e-73" not in said
    assert "%" not in said
    assert "a feasible point attains: it is the optimum" in words.reference(
        replace(group, best=1e-9)
    )


def test_the_call_on_the_page_of_comparisons_runs():
    text = (Path(__file__).parents[2] / "docs" / "compare.md").read_text(encoding="utf-8")
    (call,) = re.findall(r"`(gearopt\.compare\(problem.*?\))`", text)
    small = call.replace("seeds=25", "seeds=1, evaluations=40, seconds=0.01")
    made = eval(small, {"gearopt": gearopt, "problem": problem()})
    assert [row.method for row in made.groups[0].rows] == ["ipopt", "annealing"]
    with pytest.raises(ValueError, match="methods="):
        gearopt.compare(problem(), ["ipopt", "annealing"])
