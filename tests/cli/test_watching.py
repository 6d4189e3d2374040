"""The words of a run that is under way."""

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from gearopt.cli.watching import progress, watching
from gearopt.optimise.result import Budget, Event, Result
from gearopt.scenes.reading.ask import Ask

PROBLEMS = Path(__file__).parents[2] / "problems"


@pytest.mark.parametrize(
    ("event", "said"),
    [
        (Event(1.0, 1200), "1,200 evaluations"),
        (Event(1.0, 0, part="compiling: 3 of 18"), "compiling: 3 of 18"),
        (
            Event(1.0, 20, 25455260.4, 25000000.0, "layout", "box_volume", "mm3"),
            "layout: best 25.455 dm³, bound 25 dm³, gap 1.8 %, 20 evaluations",
        ),
        (
            Event(1.0, 20, 12.5, None, "teeth", "mass", "kg"),
            "teeth: best 12.5 kg, 20 evaluations",
        ),
        (
            Event(1.0, 20, None, 12.5, "teeth", "mass", "kg"),
            "teeth: bound 12.5 kg, 20 evaluations",
        ),
        (
            Event(1.0, 20, 5.0899e-07, 5e-07, "train", "inertia", "kg_m2"),
            "train: best 5.0899 g cm², bound 5 g cm², gap 1.8 %, 20 evaluations",
        ),
        (Event(1.0, 20, 0.0, 0.0), "best 0, bound 0, gap 0 %, 20 evaluations"),
        (Event(1.0, 20, -4.0, -5.0), "best -4, bound -5, gap 25 %, 20 evaluations"),
    ],
)
def test_progress_names_part_value_and_unit(event, said):
    assert progress(event) == said


TERMINAL = """
import sys, time
from gearopt.cli.watching import watching
from gearopt.optimise.result import Event

with watching(60.0, quiet=False) as watch:
    time.sleep(float(sys.argv[1]))
    watch(Event(1.0, 1200, 12.5, 12.0, "teeth", "mass", "kg"))
    time.sleep(float(sys.argv[1]))
print("done")
"""


def on_a_terminal(seconds):
    """What a terminal is sent by a run that reports once."""
    screen, child = os.openpty()
    command = [sys.executable, "-c", TERMINAL, str(seconds)]
    env = os.environ | {"TERM": "xterm", "COLUMNS": "120"}
    running = subprocess.Popen(command, stdout=child, stderr=child, env=env)
    os.close(child)
    sent = b""
    try:
        while block := os.read(screen, 65536):
            sent += block
    except OSError:  # the other end is closed
        pass
    assert running.wait() == 0
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", sent.decode())


@pytest.mark.slow
def test_a_terminal_shows_what_is_reached_and_seconds_that_move():
    said = on_a_terminal(1.6)
    assert "1 of 60 s  begins" in said  # before anything is reported
    assert "2 of 60 s  teeth: best 12.5 kg, bound 12 kg, gap 4 %, 1,200 evaluations" in said
    assert "3 of 60 s  teeth" in said and said.rstrip().endswith("done")


@pytest.mark.slow
def test_a_short_run_shows_nothing():
    assert on_a_terminal(0.1).split() == ["done"]


def test_what_is_proven_is_told_before_remedies_are_sought(capsys):
    proof = {"conflict": ["unit_load[1]", "unit_load[2]", "wheel_diameter[2]"]}
    known = Result("sizing", "infeasible", "ipopt", {"name": "gear_volume", "value": None})
    with watching(60.0, quiet=False) as watch:
        for _ in range(2):
            assert watch(Event(1.0, 20, known=replace(known, proof=proof)))
    said = " ".join(capsys.readouterr().err.split())
    assert said.count("Impossible, proven: the limits on unit load of stages 1 and 2") == 1
    assert said.endswith(
        "Looking for changes with which a design exists (at most 59 s); Ctrl-C ends it."
    )


def test_the_first_change_that_helps_is_told_as_soon_as_it_is_known(here, tmp_path):
    text = (PROBLEMS / "given_distance.toml").read_text(encoding="utf-8")
    text = text.replace("[limits]\n", "[limits]\nwheel_teeth = [20, 24]\n", 1)
    (tmp_path / "drive.toml").write_text(text.split("[x-expected]")[0], encoding="utf-8")
    said = " ".join(here("explain", tmp_path / "drive.toml").stderr.split())
    assert said.count("A design exists with ") == 1
    assert said.endswith("; smaller changes are looked for.")


def test_sensitivities_of_a_page_take_no_longer_than_its_answer():
    ask = Ask(budget=Budget(60.0))
    times = [ask.for_prices(*case).budget.seconds for case in ((True, 4.0), (1.0, 4.0), (1.0, 0.1))]
    assert times == [56.0, 4.0, 2.0] and ask.for_prices(1.0, 59.0).budget.seconds == 1.0


DEAF = """
import os, signal, sys, time
from gearopt.cli.watching import watching
from gearopt.optimise.result import Event

with watching(60.0, quiet=True) as watch:
    watch(Event(1.0, 1200, None, 12.0, "teeth", "mass", "kg"))
    os.kill(os.getpid(), signal.SIGINT)
    assert watch(Event(1.0, 1200, None, 12.0, "teeth", "mass", "kg")) is False
    time.sleep(float(sys.argv[1]))
print("done")
"""


@pytest.mark.slow
def test_a_run_that_does_not_hear_ctrl_c_is_ended():
    """After half a second, with what it has said; one that ends by itself goes on to its answer."""
    ended, kept = (
        subprocess.run([sys.executable, "-c", DEAF, seconds], capture_output=True, text=True)
        for seconds in ("30", "0.01")
    )
    assert ended.returncode == 130 and ended.stdout == ""
    assert ended.stderr == "gearopt: interrupted (teeth: bound 12 kg, 1,200 evaluations)\n"
    assert kept.returncode == 0 and kept.stdout == "done\n"
