"""Bonmin (branch and bound over Ipopt, B-BB) on the logarithms of a problem's posynomials.

Its branching is exact for convex relaxations only, and the logarithm of an integer is none: the
answer is a point, never a proof. The other algorithms, B-OA and B-Hyb, are not offered: they claim
success 3 to 95 % above the optimum of drives.

Bonmin runs in a process of its own, because it writes to the standard output whatever its options
say, has had loops that its time limit does not end, and calls nothing back. Within a budget it ends
by its own limit, as a rule with its best point; killed, by a longer node or by the watcher, it
takes with it what it had found after its first point.
"""

import json
import math
import os
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise import discrete, posynomial
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Budget, Event, Outcome, Watch

POLL = 0.05  # seconds between two looks at budget and watcher
MOST = 700.0  # logarithm of the largest double
SHARE = 0.6  # of the time left is Bonmin's own limit, which it looks at between nodes
GRACE = 0.1  # seconds beyond the budget after which it is killed
AMPLE = 10.0  # seconds left with which a first point is asked for before the best one
SCALE = 1e3  # the objective at the guess: Bonmin cuts off what is better by less than 1e-5
OPTIONS = {
    "algorithm": "B-BB",
    "sb": "yes",
    "tol": 1e-9,
    # Ipopt's relaxed bounds let an integer pass its branch by more than Bonmin's tolerance for
    # integers, and the same node is then branched for ever.
    "bound_relax_factor": 0.0,
    "integer_tolerance": 1e-5,
}
POLISH = {"tol": 1e-12, "constr_viol_tol": 1e-12, "bound_relax_factor": 0.0, "sb": "yes"}
RANDOM = False
COUNTS = "not counted"
SETTINGS = {k: v for k, v in OPTIONS.items() if k != "sb"}
CHILD = "from gearopt.optimise.solvers.bonmin import child; child()"


def run(problem: Problem, budget: Budget, seed: int, watch: Watch | None) -> Outcome:
    """Solve by Bonmin's B-BB; SolveError where the text is no posynomial or Bonmin breaks.

    Bonmin is deterministic: the seed changes nothing, and its evaluations are not counted.
    """
    clock = time.perf_counter()
    columns = [_column(problem, k) for k in range(len(problem.columns))]
    job = _job(problem, columns)
    if not job["guess"]:  # one point is all there is; Bonmin would crash
        return _outcome(problem, columns, {"status": "SUCCESS", "x": []})
    if budget.seconds is not None:
        job["deadline"] = time.time() + budget.seconds - (time.perf_counter() - clock)
    process = _started()
    text: str | None = json.dumps(job)
    try:
        while True:
            seconds = time.perf_counter() - clock
            late = budget.seconds is not None and seconds > budget.seconds + GRACE
            if late or (watch is not None and watch(Event(seconds, 0)) is False):
                process.kill()
                return _stopped(problem, columns, process.communicate()[0])
            try:
                answer, broken = process.communicate(text, timeout=POLL)
                break
            except subprocess.TimeoutExpired:
                text = None  # it has been sent
    finally:
        process.kill()
        process.communicate()
    if process.returncode != 0 or not answer:
        reason = (broken.strip().splitlines() or [f"it ended with {process.returncode}"])[-1]
        raise SolveError(f"bonmin on {problem.name}: {reason}")
    return _outcome(problem, columns, json.loads(answer.splitlines()[-1]))


@dataclass(frozen=True)
class _Column:
    """How a variable of the problem stands in the model.

    logarithm: casadi expression; unknowns: its symbols (binaries, an integer or the logarithm);
    allowed: the values its binaries stand for; whole: it is an integer; low, high, guess: of the
    unknowns.
    """

    logarithm: Any
    unknowns: Any
    allowed: tuple[float, ...] = ()
    whole: bool = False
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    guess: tuple[float, ...] = ()


def _column(problem: Problem, index: int) -> _Column:
    import casadi as ca

    variable, name = problem.columns[index]
    low, high, guess = (float(b[index]) for b in problem.bounds())
    if not low > 0.0:
        raise SolveError(f"bonmin takes positive variables only; {name} may be {low:g}")
    values: tuple[float, ...] = ()
    if variable.values is not None:
        values = tuple(discrete.values(problem, index))
    elif variable.integer:
        low, high = discrete.ends(problem, index)
        guess = min(max(guess, low), high)
    if len(values) == 1 or low == high:
        only = values or (low,)
        return _Column(ca.SX(math.log(only[0])), ca.SX(0, 1), only)
    if values:
        picks = ca.SX.sym(name, len(values))
        count = len(values)
        logs = ca.dot(ca.DM([math.log(v) for v in values]), picks)
        share = (1.0 / count,) * count
        return _Column(logs, picks, values, True, (0.0,) * count, (1.0,) * count, share)
    one = ca.SX.sym(name)
    if variable.integer:
        return _Column(ca.log(one), one, (), True, (low,), (high,), (guess,))
    logs = (math.log(b) for b in (low, high, guess))
    return _Column(one, one, (), False, *((b,) for b in logs))


def _job(problem: Problem, columns: list[_Column]) -> dict[str, Any]:
    """What the other process needs: the model as text, its bounds and guess."""
    import casadi as ca

    model = posynomial.read(problem)
    logs = [c.logarithm for c in columns]

    def logarithm(term: posynomial.Posynomial) -> Any:
        parts = [
            math.log(c) + sum(float(e) * v for e, v in zip(row, logs, strict=True) if e)
            for c, row in zip(term.coefficients, term.exponents, strict=True)
        ]
        return parts[0] if len(parts) == 1 else ca.log(sum(ca.exp(part) for part in parts))

    unknowns = ca.vertcat(*(c.unknowns for c in columns))
    guess = [v for c in columns for v in c.guess]
    objective = ca.exp(logarithm(model.objective))
    first = float(ca.Function("first", [unknowns], [objective])(guess))
    sets = [ca.sum1(c.unknowns) for c in columns if len(c.guess) > 1]
    rows = ca.vertcat(
        ca.SX(0, 1),
        *(logarithm(term) for term in model.inequalities),
        *(logarithm(term) for term in model.equalities),
        *sets,
    )
    limits, equal = len(model.inequalities), len(model.equalities)
    nlp = ca.Function("nlp", [unknowns], [objective * (SCALE / first), rows])
    return {
        "nlp": nlp.serialize(),
        "discrete": [c.whole for c in columns for _ in c.guess],
        "low": [v for c in columns for v in c.low],
        "high": [v for c in columns for v in c.high],
        "guess": guess,
        "least": [-math.inf] * limits + [0.0] * equal + [1.0] * len(sets),
        "most": [0.0] * (limits + equal) + [1.0] * len(sets),
        "options": dict(OPTIONS),
    }


def _started() -> Any:
    """A Python of our own kind that waits for a job; Ctrl-C does not reach it."""
    return subprocess.Popen(
        [sys.executable, "-c", CHILD],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
    )


def _outcome(problem: Problem, columns: list[_Column], answer: dict[str, Any]) -> Outcome:
    """The natural point, discrete variables set to the value they mean."""
    status, unknowns = answer["status"], answer["x"]
    if status == "INFEASIBLE":
        return Outcome(None, message="Bonmin claims infeasible; not proven by us")
    finished, message = status == "SUCCESS", f"Bonmin: {status}, which is its word"
    if not np.isfinite(unknowns).all():
        return Outcome(None, finished, message=message)
    lower, upper, _ = problem.bounds()
    point, start = lower.copy(), 0
    for k, column in enumerate(columns):
        part = unknowns[start : start + len(column.guess)]
        start += len(part)
        if column.allowed:
            point[k] = column.allowed[int(np.argmax(part)) if part else 0]
        else:
            point[k] = float(round(part[0])) if column.whole else np.exp(min(part[0], MOST))
    return Outcome(np.clip(point, lower, upper), finished, message=message)


def _stopped(problem: Problem, columns: list[_Column], text: str) -> Outcome:
    """What a killed process had said: its first point, if it had one."""
    lines = [line for line in text.splitlines() if line.endswith("}")]
    if not lines:
        return Outcome(None, finished=False, message="Bonmin was stopped without a point")
    first = _outcome(problem, columns, json.loads(lines[-1]))
    return replace(first, finished=False, message="Bonmin was stopped; this is its first point")


def child() -> None:
    """Solve the job on the standard input, in the process of its own; a line for each answer.

    Where time is ample Bonmin is first run up to its first point, so that there is one if the
    longer run is killed.
    """
    job = json.loads(sys.stdin.read())
    answers = os.fdopen(os.dup(1), "w")
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    short = "deadline" in job and job["deadline"] - time.time() < AMPLE
    for options in ({},) if short else ({"solution_limit": 1}, {}):
        answers.write(json.dumps(_answer(job, options)) + "\n")
        answers.flush()
    answers.close()


def _answer(job: dict[str, Any], options: dict[str, Any]) -> dict[str, Any]:
    """Bonmin's status and point; continuous variables polished by Ipopt, discrete ones held."""
    import casadi as ca

    function = ca.Function.deserialize(job["nlp"])
    x = ca.SX.sym("x", function.size1_in(0))
    f, g = function(x)
    nlp, discrete = {"x": x, "f": f, "g": g}, np.array(job["discrete"], bool)
    ends = {"lbg": job["least"], "ubg": job["most"]}
    quiet = {"print_time": False, "error_on_fail": False, "show_eval_warnings": False}
    own = job["options"] | options
    if "deadline" in job:  # counted from here, where this process is up
        own["time_limit"] = max(SHARE * (job["deadline"] - time.time()), 1e-3)
    solver = ca.nlpsol("s", "bonmin", nlp, quiet | {"discrete": job["discrete"], "bonmin": own})
    found = solver(x0=job["guess"], lbx=job["low"], ubx=job["high"], **ends)
    status = str(solver.stats()["return_status"])
    point = np.array(found["x"]).ravel()
    low, high = np.array(job["low"], float), np.array(job["high"], float)
    point[discrete] = np.rint(point[discrete])
    if not discrete.all() and np.isfinite(point).all():
        low[discrete] = high[discrete] = point[discrete]
        polish = ca.nlpsol("p", "ipopt", nlp, quiet | {"ipopt": POLISH})
        point = np.array(polish(x0=point, lbx=low, ubx=high, **ends)["x"]).ravel()
    return {"status": status, "x": point.tolist()}
