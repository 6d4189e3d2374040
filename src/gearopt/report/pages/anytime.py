"""How the answer came about: best value and bound against time."""

from typing import Any

from gearopt.optimise.result import Result
from gearopt.optimise.scale import gap
from gearopt.report.measures import Measures
from gearopt.report.plot import Figure, axis, layout
from gearopt.report.result_words import objective
from gearopt.report.section import Section
from gearopt.report.words import number

LEAST = 1e-4  # s; the logarithmic axis begins here at the earliest


def section(result: Result, measures: Measures) -> Section | None:
    """The progress of the run; None where it was not recorded."""
    name, unit = objective(result)
    steps = [_converted(s, unit, measures) for s in result.report.get("progress") or []]
    best = [s for s in steps if s.get("best") is not None]
    if not best:
        return None
    bound = [s for s in steps if s.get("bound") is not None]
    end = max(result.seconds, steps[-1]["seconds"])
    times = [max(LEAST, s["seconds"]) for s in steps]
    wide = max(times) > 30.0 * min(times)
    sign = measures.unit(unit)
    traces = [_line("best", best, "best", "--series-1", sign, end)]
    if bound:
        traces.append(_line("bound", bound, "bound", "--series-2", sign, end))
    plot = layout(
        axis("wall time [s]", type="log" if wide else "linear"),
        axis(f"{name} [{sign}]" if sign else name, tickformat="," if _large(best) else ""),
        340,
    )
    words = "Best value found so far" + (" and the bound below it" if bound else "")
    return Section("Progress", figures=(Figure(traces, plot, f"{words}, against wall time."),))


def _converted(step: dict[str, Any], unit: str, measures: Measures) -> dict[str, Any]:
    """A step with its best value and bound in the unit that is shown."""
    values = {k: measures.of(step[k], unit) for k in ("best", "bound") if step.get(k) is not None}
    return step | values


def _line(
    name: str, steps: list[dict[str, Any]], key: str, colour: str, unit: str, end: float
) -> dict[str, Any]:
    """Steps that hold to the end of the run."""
    last = [*steps, steps[-1] | {"seconds": end}]
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": name,
        "x": [max(LEAST, s["seconds"]) for s in last],
        "y": [s[key] for s in last],
        "text": [_hover(s, key, unit) for s in last],
        "hovertemplate": "%{text}<extra></extra>",
        "line": {"color": colour, "width": 2.2, "shape": "hv"},
        "marker": {"color": colour, "size": [6] * len(steps) + [0]},
    }


def _hover(step: dict[str, Any], key: str, unit: str) -> str:
    words = f"{key} {number(step[key])} {unit} at {step['seconds']:.3g} s"
    words += f", {step['evaluations']:,} evaluations"
    best, bound = step.get("best"), step.get("bound")
    if best and bound is not None:
        words += f"; gap {100.0 * gap(best, bound):.3g} %"
    return words


def _large(steps: list[dict[str, Any]]) -> bool:
    return any(abs(s["best"]) >= 1e5 for s in steps)
