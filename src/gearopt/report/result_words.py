"""A result in cells, as the terminal and its page both show it."""

import re
from collections.abc import Mapping

from gearopt.optimise.result import Result
from gearopt.report.words import VERDICTS, limit_words

RULED = ("process one", "process two")  # parts that are designs by rules
EXACT = 1e-6  # a gap below it is called optimal, one above it is named

INVERSE = {"inverse acceleration": ("acceleration", "rad/s²")}  # name and unit of the inverse


def certainty(result: Result) -> tuple[str, str]:
    """The status in words, and its colour."""
    words, colour = VERDICTS[result.status]
    if result.status == "evaluated" and not result.feasible:
        words, colour = "evaluated, a limit is exceeded", "red"
    if result.status == "optimal" and (result.gap or 0.0) > EXACT:
        words = f"proven within {100 * (result.gap or 0.0):.2g} % of the optimum"
    if "achieved" in result.report:  # something is come near to
        words = words.replace("optimal", "nearest")
    return words, colour


def verdict(result: Result) -> tuple[str, str]:
    """What a reader must know first, and its colour: what is achieved, and how sure that is."""
    words, colour = certainty(result)
    achieved = result.report.get("achieved")
    return (f"{achieved}; {words}" if achieved else words), "yellow" if leading(result) else colour


def leading(result: Result) -> list[str]:
    """What must be read before the numbers: how far the wanted is out of reach; else nothing."""
    reach = result.report.get("reach")
    return [result.message] if reach and not reach["within"] and result.message else []


def title(result: Result) -> str:
    """What a result is called: the title of its file, or the file's name."""
    return str(result.asked.get("title") or result.file or result.scene or result.name)


def objective(result: Result) -> tuple[str, str]:
    """Name of the objective in words, and its unit as a key has it."""
    name, unit = (str(result.objective.get(key, "")) for key in ("name", "unit"))
    return name.replace("_", " "), unit


def goal(result: Result) -> tuple[str, str, float | None, float | None, str]:
    """The objective as a reader asks for it: name, unit, value, bound, on which side none is.

    An inverse that is made least is told as what is made largest by it.
    """
    name, unit = objective(result)
    if name not in INVERSE:
        return name, unit, result.value, result.bound, "below"
    value, bound = (None if not v else 1.0 / v for v in (result.value, result.bound))
    return *INVERSE[name], value, bound, "above"


def limit_rows(limits: Mapping[str, float]) -> tuple[int, list[tuple[str, list[float | None]]]]:
    """Number of stages; every limit with its utilisation in each stage, then in the whole."""
    rows: dict[str, dict[int, float]] = {}
    for name, value in limits.items():
        match = re.fullmatch(r"(.*)\[(\d+)\]", name)
        stem, index = (match[1], int(match[2])) if match else (name, 0)
        rows.setdefault(stem, {})[index] = value
    stages = max((i for r in rows.values() for i in r), default=0)
    order = (*range(1, stages + 1), 0)
    return stages, [(limit_words(stem), [r.get(k) for k in order]) for stem, r in rows.items()]
