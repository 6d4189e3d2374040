"""Public problems with known optima: proofs by the default method beside SCIP, and seconds of both.

Both have SECONDS and a gap of 1e-6. CPU seconds of a solve are all it takes, reading the text and
the certificate included; SCIP's begin where it reads the .nl file of the same text.
"""

import statistics
import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from gearopt.bench.public import engineering, functions, hock_schittkowski, minlplib
from gearopt.bench.public.case import Case
from gearopt.optimise.exchange.nl import write
from gearopt.optimise.own_problems import solve_own
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Result

SECONDS, GAP = 10.0, 1e-6
SETS: dict[str, tuple[Case, ...]] = {
    "engineering": engineering.CASES,
    "Hock-Schittkowski": hock_schittkowski.CASES,
    "MINLPLib": minlplib.CASES + minlplib.MORE,
    "functions": functions.CASES,
    "chosen unseen": hock_schittkowski.FURTHER + minlplib.FURTHER,
}
WARMING = ("hs5", "nvs03", "hs64")  # of whose kinds all kernels and back ends are
SCIP_PROVEN = ("optimal", "gaplimit", "infeasible")


def cases() -> dict[str, Case]:
    """All problems by name."""
    return {case.name: case for some in SETS.values() for case in some}


def run(repeat: int) -> list[dict[str, Any]]:
    """Rows of all problems, then of every set and of all: proven, median and sum of seconds.

    off: of the value from the quoted one, relative to it (to 1 where that is 0).
    Medians and sums are of the problems that both prove, where SCIP (pyscipopt) is installed.
    """
    for name in WARMING:
        solved(cases()[name].problem())
    rows = {name: [_row(name, case, repeat) for case in some] for name, some in SETS.items()}
    every = [row for some in rows.values() for row in some]
    totals = [line for name, some in rows.items() for line in _totals(name, some)]
    return [*every, *totals, *_totals("all", every)]


def solved(problem: Problem) -> Result:
    """Answer of the default method."""
    return solve_own(problem, None, Budget(seconds=SECONDS, gap=GAP), 0, None, GAP, None)


def _row(family: str, case: Case, repeat: int) -> dict[str, Any]:
    result, seconds = _timed(lambda: solved(case.problem()), repeat)
    scip, scip_seconds = ("", None, None), None
    if find_spec("pyscipopt"):
        with TemporaryDirectory() as room:
            file = Path(room) / "case.nl"
            write(case.problem(), file)
            scip, scip_seconds = _timed(lambda: by_scip(file), repeat)
    size = abs(case.optimum) or 1.0
    return {
        "problem": case.name,
        "set": family,
        "variables": len(case.box),
        "whole": sum(whole for *_, whole in case.box),
        "status": result.status,
        "value": result.value,
        "quoted": case.optimum,
        "off": None if result.value is None else (result.value - case.optimum) / size,
        "bound": result.bound,
        "gap": result.gap,
        "method": result.method,
        "cpu_s": seconds,
        "scip": scip[0],
        "scip_value": scip[1],
        "scip_bound": scip[2],
        "scip_cpu_s": scip_seconds,
    }


def _timed(call: Callable[[], Any], repeat: int) -> tuple[Any, float]:
    """The last result of a call and its median CPU seconds."""
    times = []
    for _ in range(repeat):
        begin = time.process_time()
        result = call()
        times.append(time.process_time() - begin)
    return result, round(statistics.median(times), 4)


def by_scip(file: Path) -> tuple[str, float | None, float | None]:
    """Status, value and bound that SCIP claims of an .nl file, with its own tolerances."""
    from pyscipopt import Model

    scip = Model()
    scip.hideOutput()
    scip.readProblem(str(file))
    scip.setParams({"limits/time": SECONDS, "limits/gap": GAP, "timing/clocktype": 1})
    scip.optimize()
    value = float(scip.getPrimalbound()) if scip.getNSols() else None
    return str(scip.getStatus()), value, float(scip.getDualbound())


def _totals(name: str, rows: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Rows of a set: how many are proven; median and sum of what both prove, or of all proven."""
    ours = [row["status"] in ("optimal", "infeasible") for row in rows]
    theirs = [row["scip"] in SCIP_PROVEN for row in rows]
    known = any(row["scip"] for row in rows)
    both = [r for r, a, b in zip(rows, ours, theirs, strict=True) if a and (b or not known)]
    empty = dict.fromkeys(rows[0], None) | {"set": name}
    scip = f"{sum(theirs)} of {len(rows)}" if known else ""
    yield empty | {"problem": "proven", "status": f"{sum(ours)} of {len(rows)}", "scip": scip}
    for word, total in (("median", statistics.median), ("sum", sum)):
        seconds = {
            key: round(total([row[key] for row in both]), 4)
            for key in ("cpu_s", *(("scip_cpu_s",) if known else ()))
            if both
        }
        yield empty | {"problem": f"{word} of {len(both)}"} | seconds
