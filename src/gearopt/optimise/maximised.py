"""Objectives that are maximised: their negatives are minimised, answers are in the user's own."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gearopt.optimise.result import MAXIMISE, Result
from gearopt.optimise.terms import FALLING

if TYPE_CHECKING:
    from gearopt.optimise.explaining.explanation import Explanation


def as_asked(result: Result) -> Result:
    """A result in the user's objective: of one that is maximised, not of its negative."""
    name = str(result.objective.get("name", ""))
    if not name.startswith(FALLING):
        return result
    asked = {"name": name.removeprefix(FALLING), "value": _negative(result.value)}
    report = dict(result.report)
    if "progress" in report:
        report["progress"] = [_step(step) for step in report["progress"]]
    return replace(
        result,
        objective=result.objective | asked | {"sense": MAXIMISE},
        bound=_negative(result.bound),
        multipliers={key: -price for key, price in result.multipliers.items()},
        report=report,
        parts=tuple(map(as_asked, result.parts)),
    )


def explained_as_asked(known: "Explanation") -> "Explanation":
    """An explanation in the user's objective."""
    result = as_asked(known.result)
    if not result.maximised:
        return known
    influences = tuple(
        replace(
            one,
            sensitivity=_negative(one.sensitivity),
            resolved=(_negative(one.resolved[0]), _negative(one.resolved[1])),
        )
        for one in known.influences
    )
    return replace(known, result=result, influences=influences)


def _step(step: dict[str, Any]) -> dict[str, Any]:
    return step | {key: _negative(step[key]) for key in ("best", "bound") if key in step}


def _negative(value: float | None) -> float | None:
    return None if value is None else -value
