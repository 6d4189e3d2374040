"""The table [optimise]: the search, what proves it impossible, and what is said of the best."""

from collections.abc import Sequence
from dataclasses import replace

from gearopt.formulations.dynamics.design import Chosen
from gearopt.formulations.dynamics.orbit.climbing import JUDGE_MARGIN, begun, posed
from gearopt.formulations.dynamics.orbit.impossible import impossible, limited
from gearopt.formulations.dynamics.orbit.least_vibration import (
    Exchanged,
    exchange,
    least,
    methods,
    response_over_speed,
)
from gearopt.formulations.dynamics.orbit.task import MICRO, UNITS, VARIABLES, Task
from gearopt.optimise.certified import run
from gearopt.optimise.clock import Clock, in_part, of_others
from gearopt.optimise.explaining.explanation import Remedies
from gearopt.optimise.problem import Problem
from gearopt.optimise.result import Outcome, Result
from gearopt.physics.motion.moving_pair import MovingPair
from gearopt.scenes.dynamics.scene import Scene
from gearopt.scenes.explaining.explanations import remedies as each_alone
from gearopt.scenes.explaining.possible import Verdict, of_status
from gearopt.scenes.reading.ask import Ask

WHOLE_FROM = 1e4  # numbers that are told without decimals
AT_END = 1e-5  # of a range, within which its end counts as reached
PRICED = 1.0  # s: a budget that leaves time for multipliers, some half a second, once it is spent
BEST = ("bearing_stiffness_N_per_mm", "contact_ratio", "ramp", "face_width_mm", "rim")


def whole_problem(task: Task) -> Problem:
    """Return the problem on the speeds of a task, with its own method."""
    return posed(task, methods(task))


def resolvable(scene: Scene, result: Result) -> bool:
    """Return whether a changed file can be solved from the answer of this one."""
    task = scene.task
    return result.status == "stationary" and task.backlash is None and task.most_growth is None


def beside(scene: Scene, other: Scene, result: Result) -> Problem:
    """Return the problem of a changed file over the speeds of an answer, which is its guess.

    Where the range of speeds changes, those of the answer are stretched to it.
    """
    best, task, speeds = result.design["chosen"], other.task, scene.task.speeds_rpm
    if len(task.speeds_rpm) == len(speeds):
        low, high = task.speeds_rpm[0], task.speeds_rpm[-1]
        stretch = (high - low) / (speeds[-1] - speeds[0])
        moved = tuple(low + stretch * (speed - speeds[0]) for speed in best["speed_rpm"])
        task = replace(task, speeds_rpm=moved, harmonics=best["harmonics"])
    return begun(task, [best[name] for name in BEST])


def optimised(
    scene: Scene, ask: Ask, before: MovingPair, clock: Clock
) -> tuple[Result, Chosen | None, Task]:
    """Return the certified result, the design over all speeds, and the task with its speeds.

    before: the pair of the file, to compare with. No design: the result says why.
    """
    assert scene.optimise is not None
    task, least_vibration, in_mm = scene.task, None, in_part(clock.watch, "mm", factor=1.0 / MICRO)
    if impossible(task) is not None:
        result, _ = run(whole_problem(task), "screened", clock.left, ask.seed, in_mm)
    elif ask.method is None:
        inner = Clock(ask.budget, of_others(ask.watch), clock.start)
        least_vibration = (exchange if scene.optimise.exchange else least)(task, inner, ask.seed)
        task = task if least_vibration is None else least_vibration.task
        result = _certified(task, least_vibration, inner, ask)
        clock.stopped = inner.stopped
    else:
        result, _ = run(whole_problem(task), ask.method, clock.left, ask.seed, in_mm, ask.gap)
    result = replace(result, name="dynamics", seconds=clock.seconds)
    if result.value is None:
        return result, None, task
    values = tuple(float(v) for v in list(result.design.values())[: len(VARIABLES)])
    best = response_over_speed(
        task, values, before, least_vibration.rounds if least_vibration else (), clock
    )
    return _judged(result, best, task), best, task


def _certified(task: Task, made: Exchanged | None, clock: Clock, ask: Ask) -> Result:
    """Return the certified result of a search, which has spent a clock.

    Of a search that a budget below PRICED ended, without multipliers and the residuals by them.
    """
    if made is None:
        nothing = Outcome(None, not clock.stopped, message="no start led to a design")
        problem = posed(task, {"screened": lambda *_: nothing})
    else:
        problem = made.best.problem.starting(made.best.whole)
    if made is not None and clock.stopped and (ask.budget.seconds or PRICED) < PRICED:
        plain = Outcome(made.best.whole, False, stationary=False, evaluations=1)
        problem = replace(problem, methods={"screened": lambda *_: plain})
    result, _ = run(problem, "screened", seed=ask.seed, gap=ask.gap)
    status = "limit" if clock.stopped else result.status
    return replace(result, status=status, evaluations=clock.evaluations)


def _judged(result: Result, best: Chosen, task: Task) -> Result:
    """Return the result with its objective in mm: simulated, where motions were collocated.

    What is simulated JUDGE_MARGIN the objective of the problem leaves the status as it is.
    """
    assert result.value is not None
    value, limits = result.value / MICRO, {k: v for k, v in result.limits.items() if "[" not in k}
    parted = [v for k, v in result.limits.items() if "separation" in k]
    limits |= {"separation": max(parted)} if parted else {}
    if task.most_growth is not None and best.largest_multiplier is not None:
        limits["stability"] = best.largest_multiplier / task.most_growth
    elif task.most_growth is not None:
        result = replace(result, status="limit")
    if task.backlash is not None:
        at = dict(zip(best.dense_rpm, best.dense_mm, strict=True))
        simulated = max(at[speed] for speed in best.speed_rpm)
        if simulated > (1.0 + JUDGE_MARGIN) * value and result.status == "stationary":
            text = (
                f"simulated, the objective is {MICRO * simulated:.4g} µm, not that of its problem"
            )
            result = replace(result, status="feasible", message=text)
        value = simulated
    objective = result.objective | {"value": value, "unit": "mm"}
    prices = {name: price / MICRO for name, price in result.multipliers.items()}
    return replace(result, objective=objective, limits=limits, multipliers=prices)


def at_ends(task: Task, values: Sequence[float]) -> list[str]:
    """Say which VARIABLES, given as they are, are at ends of their ranges."""
    each = []
    for name, unit, value in zip(VARIABLES, UNITS, values, strict=True):
        low, high = task.ranges[name]
        near = [s for s, end in (("lower", low), ("upper", high)) if _is_at(value, end, high - low)]
        if low < high and near:
            ends = (f"{v:,.0f}" if abs(v) >= WHOLE_FROM else f"{v:.5g}" for v in (low, high))
            span = f"{' to '.join(ends)} {unit}".rstrip()
            each.append(f"{name.replace('_', ' ')} ({near[0]} end of {span})")
    return [f"At ends of their ranges: {', '.join(each)}."] if each else []


def _is_at(value: float, end: float, width: float) -> bool:
    return abs(value - end) <= AT_END * width


def told(best: Chosen, result: Result, periods: int) -> list[str]:
    """Return warnings that precede the numbers of the best design."""
    sentences, objective = [], result.value or 0.0
    if best.dense_maximum_mm > (1.0 + JUDGE_MARGIN) * objective:
        more = 100.0 * (best.dense_maximum_mm / objective - 1.0)
        measure = "RMS of the" if result.objective["name"] == "rms" else "peak-to-peak"
        sentences.append(
            f"Between the {len(best.speed_rpm)} speeds the {measure} deformation reaches "
            f"{MICRO * best.dense_maximum_mm:.4g} µm, {more:.0f} % above the objective: "
            "exchange = true adds the speeds of its maxima."
        )
    if best.parting_speeds:
        sentences.append(
            f"Teeth part at {best.parting_speeds} of {len(best.dense_rpm)} speeds: the "
            f"deformation rises to {MICRO * best.highest_mm:.3g} µm."
        )
    if best.longest_repeat > periods:
        sentences.append(
            f"A motion repeats after {best.longest_repeat} mesh periods, not after {periods}: "
            f"write periods = {best.longest_repeat}."
        )
    return sentences


def remedies(scene: Scene, clock: Clock, result: Result, soon: bool) -> Remedies:
    """Each number of the file that alone makes it possible."""
    left = Clock(clock.left, of_others(clock.watch))
    return each_alone(scene, limited(scene.task), left, possible)


def possible(scene: Scene, clock: Clock) -> Verdict:
    """Return whether a file has a design.

    Without a limit of motions, what the ranges allow is possible; with one the file is solved.
    """
    task = scene.task
    if impossible(task) is not None:
        return Verdict(False)
    if task.margin is None and task.most_growth is None:
        return Verdict(True)
    return of_status(run(whole_problem(task), None, clock.left, watch=clock.watch)[0].status)
