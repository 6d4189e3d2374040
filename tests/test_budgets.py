"""Every problem file by every command: stopped at once, it ends, and says that it was stopped.

Seconds are measured by `gearopt bench budget`; here only what does not depend on the machine.
"""

from pathlib import Path

import pytest

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.scenes.reading.load import kind_named, kind_of

FILES = sorted(Path("problems").glob("*.toml"))
ASKED = 5  # times that all parts of a command may ask a watcher that refuses


def front(file, **stopped):
    scene = gearopt.load(file)
    names = kind_named(kind_of(scene)).trades.objectives(scene)
    return gearopt.pareto(file, objectives=list(names)[:2], **stopped)


COMMANDS = {
    "solve": gearopt.solve,
    "explain": lambda file, **stopped: gearopt.explain(file, **stopped).result,
    "pareto": front,
}


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_command_that_is_stopped_at_once_ends(file):
    known = 0
    for command, run in COMMANDS.items():
        asked = []
        try:
            answer = run(
                file,
                budget=gearopt.Budget(seconds=0.0),
                watch=lambda event, asked=asked: bool(asked.append(event)),
            )
        except SolveError:  # not for this file
            continue
        except SceneError as why:  # its gears are those of another file, whose search was stopped
            assert "its design is an input here" in str(why) and len(asked) <= ASKED
            known += 1
            continue
        known += 1
        assert len(asked) <= ASKED, (command, len(asked))
        assert answer.status in ("limit", "evaluated", "optimal", "infeasible", "complete")
    assert known or gearopt.rate(file).status == "evaluated"
