"""Seconds asked for against seconds used: every problem file by every command with a budget.

The contract is the budget, 0.2 s and one step of a search. Of wall and processor time the smaller
counts, so that other work on the machine does not. Files: `problems/*.toml` of the folder in which
it is run. Machine code is compiled, and every command has been run once, before it is timed.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from gearopt import api
from gearopt.errors import GearoptError
from gearopt.optimise.result import Budget

FOLDER = Path("problems")
SECONDS = 0.5  # asked for
ALLOWED = 0.2  # s beside them

Call = Callable[[Path, float], Any]
COMMANDS: dict[str, Call] = {
    "solve": lambda file, seconds: api.solve(file, budget=Budget(seconds)),
    "explain": lambda file, seconds: api.explain(file, budget=Budget(seconds)),
    "pareto": lambda file, seconds: api.pareto(file, budget=Budget(seconds)),
    "compare": lambda file, seconds: _slowest(
        api.compare(file, seconds=seconds, seeds=1, evaluations=1)
    ),
}


def run(repeat: int) -> list[dict[str, Any]]:
    """Return a row for each file and command that takes more than is allowed, the worst first.

    Times are the least of so many runs. Without any such row, one with the worst of all.
    """
    files = sorted(FOLDER.glob("*.toml"))
    if not files:
        raise GearoptError(f"there is no problem file in {FOLDER.resolve()}: run it beside them")
    found = [measured(file, name, repeat) for file in files for name in COMMANDS]
    rows = sorted((r for r in found if r is not None), key=lambda r: -float(r["over_s"]))
    return [r for r in rows if r["over_s"] > ALLOWED] or rows[:1]


def measured(file: Path, command: str, repeat: int) -> dict[str, Any] | None:
    """Return the times of a command on a file; None where the file is not for it."""
    used = []
    for _ in range(repeat + 1):
        wall, processor = time.perf_counter(), time.process_time()
        try:
            known = COMMANDS[command](file, SECONDS)
        except GearoptError:
            return None
        both = time.perf_counter() - wall, time.process_time() - processor
        used.append(known if isinstance(known, float) else min(both))
    seconds = min(used[1:])
    return {
        "file": file.name,
        "command": command,
        "asked_s": SECONDS,
        "used_s": round(seconds, 2),
        "over_s": round(max(0.0, seconds - SECONDS), 2),
    }


def _slowest(found: Any) -> float:
    """Return the seconds of the slowest run of a comparison that was to end by its time."""
    samples = [row.equal_time for group in found.groups for row in group.rows]
    runs = [run.seconds for sample in samples if sample is not None for run in sample.runs]
    return float(max(runs, default=0.0))
