"""What is certain of a result, in sentences, as the terminal and its page both show it."""

from gearopt.optimise.result import Result
from gearopt.report.kinds import kind_of
from gearopt.report.measures import METRIC, Measures
from gearopt.report.result_words import goal, leading
from gearopt.report.words import amount, limit_words


def proof(result: Result, measures: Measures = METRIC) -> list[str]:
    """What is certain: the bound, how it is known, what other ways give, what to keep in mind."""
    lines = bound_words(result, measures) + _method(result)
    lines += kind_of(result).beside(result, measures)
    lines += result.report.get("notes", []) if result.status != "infeasible" else []
    if result.message and result.status != "infeasible" and not leading(result):
        lines.append(result.message[0].upper() + result.message[1:].rstrip(".") + ".")
    lines.append(f"{result.method}, {result.evaluations:,} evaluations, {result.seconds:.3g} s.")
    return lines


def bound_words(result: Result, measures: Measures) -> list[str]:
    """The bound in a sentence; nothing without one."""
    name, unit, _, bound, side = goal(result)
    if bound is None or result.gap is None:
        return []
    least = f"no {name} {side} {amount(bound, unit, measures)} is possible"
    return [f"Bound: {least}{scope(result)}; {gap_words(result)}."]


def gap_words(result: Result) -> str:
    """The gap of a result, and what it is relative to where that is not the objective's value."""
    if result.gap is None:
        return ""
    of = " of the objective's scale (its value is zero)" if "scale" in result.certificate else ""
    return f"gap {100 * result.gap:.3g} %{of}"


def scope(result: Result) -> str:
    """Of what a bound is true: of all designs, or of the gears that were laid out."""
    return " with these gears" if any(part.name == "gears" for part in result.parts) else ""


def _method(result: Result) -> list[str]:
    """What the method itself tells of its proof, and which limits cannot hold together."""
    known, found = result.bound is not None or result.status == "infeasible", result.proof
    lines = [found["sentence"]] if known and "sentence" in found else []
    if result.status == "infeasible" and found.get("conflict") and "least_violation" in found:
        names = ", ".join(limit_words(n) for n in found["conflict"])
        least = 100 * found["least_violation"]
        missed = f"{least:.2g}" if least < 100 else f"{least:,.0f}"
        lines.append(
            "Proof: whatever the sizes, even with real-valued teeth and modules, one of these "
            f"limits is missed by at least {missed} %: {names}."
        )
    return lines
