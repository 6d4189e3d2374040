"""How the answer came about: best value and bound against time."""

from typing import Any

from gearopt.optimise.result import Result
from gearopt.report.pages.frame import Figure, axis, layout
from gearopt.report.pages.section import Section
from gearopt.report.words import UNITS, number

LEAST = 1e-4  # s; the logarithmic axis begins here at the earliest


def section(result: Result) -> Section | None:
    """The progress of the run; None where it was not recorded."""
    steps = result.report.get("progress") or []
    best = [s for s in steps if s.get("best") is not None]
    if not best:
        return None
    bound = [s for s in steps if s.get("bound") is not None]
    end = max(result.seconds, steps[-1]["seconds"])
    times = [max(LEAST, s["seconds"]) for s in steps]
    wide = max(times) > 30.0 * min(times)
    name = str(result.objective["name"]).replace("_", " ")
    unit = UNITS.get(result.objective.get("unit", ""), result.objective.get("unit", ""))
    traces = [_line("best", best, "best", "--series-1", unit, end)]
    if bound:
        traces.append(_line("bound", bound, "bound", "--series-2", unit, end))
    plot = layout(
        axis("wall time [s]", type="log" if wide else "linear"),
        axis(f"{name} [{unit}]" if unit else name, tickformat="," if _large(best) else ""),
        340,
    )
    words = "Best value found so far" + (" and the bound below it" if bound else "")
    return Section("Progress", figures=(Figure(traces, plot, f"{words}, against wall time."),))


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
        words += f"; gap {100.0 * (best - bound) / abs(best):.3g} %"
    return words


def _large(steps: list[dict[str, Any]]) -> bool:
    return any(abs(s["best"]) >= 1e5 for s in steps)
