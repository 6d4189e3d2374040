"""Seconds asked for against seconds used: every problem file by every command with a budget.

The promise: a command ends within OVER times its budget and BESIDE seconds, its page and its tables
included. Of wall and processor time the smaller counts, so that other work on the machine does not.
Files: `problems/*.toml` of the folder in which it is run. Machine code is compiled, and every
command has been run once, before it is timed.
"""

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from gearopt import api
from gearopt.errors import GearoptError
from gearopt.optimise.comparing.compare import attempt, enter
from gearopt.optimise.result import Budget
from gearopt.scenes.reading.load import kind_named, kind_of

FOLDER = Path("problems")
SECONDS = (0.1, 0.5)  # asked for
OVER, BESIDE = 1.5, 1.0  # times the seconds asked for, and seconds beside: what is promised
OBJECTIVES = 2  # of a front: the first ones that a file has

Call = Callable[[Path, float], Any]


def _solved(file: Path, seconds: float) -> None:
    top = 1 if "top" in api.idle_options(file, None) else 10
    result = api.solve(file, budget=Budget(seconds), top=top, prices=1.0)
    result.to_html(), result.tables, result.to_json()


def _front(file: Path, seconds: float) -> None:
    scene = api.load(file)
    kind = kind_named(kind_of(scene))
    names = list(kind.trades.objectives(scene))[:OBJECTIVES]
    api.pareto(file, objectives=names, budget=Budget(seconds)).to_html()


def _rated(file: Path, seconds: float) -> None:
    result = api.rate(file)
    result.to_html(), result.tables, result.to_json()


def _compared(file: Path, seconds: float) -> float:
    """Seconds of the slowest method of a comparison that was to end by its time."""
    scene = api.load(file)
    kind = kind_named(kind_of(scene))
    used = [0.0]
    for method in kind.methods_to_compare(scene):
        entry = enter(method, lambda one: kind.posed(scene, one))
        if not entry.refused:
            processor = time.process_time()
            result = attempt(entry, 0, Budget(seconds), lambda _: True)
            used.append(min(result.seconds if result else 0.0, time.process_time() - processor))
    return max(used)


COMMANDS: dict[str, Call] = {
    "solve": lambda file, seconds: api.solve(file, budget=Budget(seconds)),
    "solve --html --csv": _solved,
    "explain": lambda file, seconds: api.explain(file, budget=Budget(seconds)),
    "pareto --html": _front,
    "compare": _compared,
    "rate --html": _rated,
}


def run(repeat: int) -> list[dict[str, Any]]:
    """Return a row for each file and command that breaks the promise, the worst first.

    Times are the least of so many runs. Without any such row, one with the worst of all. A command
    that fails by a fault of its own is a row, too, with the fault, before all others.
    """
    files = sorted(FOLDER.glob("*.toml"))
    if not files:
        raise GearoptError(f"there is no problem file in {FOLDER.resolve()}: run it beside them")
    rows = [
        measured(file, name, seconds, repeat)
        for seconds in SECONDS
        for file in files
        for name in COMMANDS
    ]
    known = sorted((r for r in rows if r is not None), key=lambda r: -float(r["over_s"]))
    return [r for r in known if r["over_s"] > 0.0] or known[:1]


def measured(file: Path, command: str, asked: float, repeat: int) -> dict[str, Any] | None:
    """Return the times of a command on a file; None where the file is not for it."""
    used = []
    for _ in range(repeat + 1):
        wall, processor = time.perf_counter(), time.process_time()
        try:
            known = COMMANDS[command](file, asked)
        except GearoptError:
            return None
        except Exception as fault:
            return _row(file, command, asked, math.inf) | {"fault": repr(fault)}
        both = time.perf_counter() - wall, time.process_time() - processor
        used.append(known if isinstance(known, float) else min(both))
    return _row(file, command, asked, min(used[1:]))


def _row(file: Path, command: str, asked: float, seconds: float) -> dict[str, Any]:
    promised = OVER * asked + BESIDE
    return {
        "file": file.name,
        "command": command,
        "asked_s": asked,
        "promised_s": promised,
        "used_s": round(seconds, 2),
        "over_s": round(seconds - promised, 2),
    }
