"""The command that makes the page of a result again, and what it does by default."""

import shlex

from gearopt.optimise.result import Result
from gearopt.report.measures import METRIC, Measures
from gearopt.report.words import RATING

SECONDS = 60.0  # that a run may take
TOP_ON_PAGE = 10  # trains that a page lists
DEFAULTS = {"seconds": SECONDS, "seed": 0, "top": TOP_ON_PAGE}


def again(result: Result, html: str, measures: Measures) -> str:
    """Return the command that makes a page again, without default options; "" if none.

    html: where it writes the page. A run from Python without a limit of time had more of it than
    any command. One that changed the tables of its file was Python's.
    """
    if result.file is None:
        return ""
    verb = "rate" if result.name == RATING else "solve"
    if changes := result.options.get("changes"):
        return f"gearopt.{verb}({result.file!r}, {changes!r})"
    words = ["gearopt", verb, result.file]
    if result.options and result.options.get("seconds") is None:
        words += ["--seconds", "1e9"]
    for name in ("method", "seconds", "gap", "seed", "top"):
        value = result.options.get(name)
        if value is not None and value != DEFAULTS.get(name):
            words += [f"--{name}", f"{value:.12g}" if isinstance(value, float) else str(value)]
    if measures is not METRIC:
        words += ["--units", measures.name]
    return shlex.join([*words, "--html", html])
