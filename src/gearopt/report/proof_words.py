"""What is certain of a result, in sentences, as the terminal and its page both show it."""

from collections.abc import Mapping
from typing import Any

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
    """How it was proven: whole teeth exhausted, cells of angles bounded, or a dual bound."""
    proof, lines = result.proof, []
    if "trains_compared" in proof:
        lines.append(_compared(result))
    elif "trains_looked_at" in proof and proof["method"] == "exhausted":
        rest = "meets all limits" if result.status == "infeasible" else "can be better"
        lines.append(
            f"Proof: {proof['trains_looked_at']:,} choices of teeth and modules looked at"
            f"{_feasible(proof)}; no other {rest}."
        )
    elif "pairs_matched" in proof:
        lines.append(
            f"Proof: {proof['pairs_matched']:,} ratios of a pair, each with the two that miss "
            "least with it, in rational arithmetic."
        )
    elif "ways_to_share_out" in proof:
        lines.append(_shared_out(proof))
    elif "trains_laid_out" in proof:
        count = sum(proof["nodes"].values())
        lines.append(
            f"Proof: {count:,} trains and parts of trains bounded, {proof['trains_laid_out']:,} "
            f"laid out in full ({proof['method']})."
        )
    elif "pruning_margin" in proof and "nodes" in proof:
        lines.append(
            f"Proof: {proof['nodes']:,} cells of link angles, each bounded by intervals "
            f"({proof['method']})."
        )
    elif proof.get("method") == "dual" and result.bound is not None:
        lines.append(
            "Proof: the problem is convex in logarithms; the bound is a dual one, computed "
            "from our own derivatives."
        )
    elif proof.get("method") == "closed form" and result.bound is not None:
        lines.append("Proof: a closed form, and a bound that follows from convexity alone.")
    return lines + _impossible(result)


def _feasible(proof: Mapping[str, Any]) -> str:
    """How many trains meet the limits, where all were counted."""
    if "feasible_trains" not in proof:
        return ""
    apart = " and ".join(proof.get("not_counted", ()))
    but = f" but {apart}" if apart else ""
    return f", {proof['feasible_trains']:,} meet all limits{but}"


def _impossible(result: Result) -> list[str]:
    """Why nothing meets the limits, of what is proven to be impossible."""
    proof = result.proof
    if result.status != "infeasible":
        return []
    if proof.get("conflict") and "least_violation" in proof:
        names = ", ".join(limit_words(n) for n in proof["conflict"])
        least = 100 * proof["least_violation"]
        missed = f"{least:.2g}" if least < 100 else f"{least:,.0f}"
        return [
            "Proof: whatever the sizes, even with real-valued teeth and modules, one of these "
            f"limits is missed by at least {missed} %: {names}."
        ]
    if proof.get("conflict") or proof.get("components"):
        return [f"Proof: {result.message}."]
    return [f"Proof: {proof['reason']}."] if proof.get("reason") else []


def _compared(result: Result) -> str:
    """Of a search over whole teeth."""
    proof, infeasible = result.proof, result.status == "infeasible"
    if proof["method"] == "exhausted" and infeasible:
        return (
            "Proof: every choice of teeth and modules was compared or excluded; none meets all "
            "limits."
        )
    count = f"Proof: {proof['trains_compared']:,} trains compared,"
    opened = f"(nodes opened: {proof['nodes']:,})."
    if proof["method"] == "exhausted":
        return f"{count} all others excluded by lower bounds {opened}"
    return f"{count} those not looked at are bounded from below {opened}"


def _shared_out(found: Mapping[str, Any]) -> str:
    """How the bound is known, in a sentence."""
    if found["method"] == "volume":
        return "Bound: the volume of the cylinders, and the widest with the highest of them."
    ways = found["ways_to_share_out"]
    shared = f"{ways:,} ways" if ways > 1 else "one way"
    early = (
        " Its time ended it: it is weaker than it could be." if "early" in found["method"] else ""
    )
    return (
        f"Bound: {shared} to share the cylinders out among layers; for each the least plan that "
        f"discs, pairs and triples in any order need, by subdivision of the width.{early}"
    )
