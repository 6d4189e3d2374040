"""The first sentence of page and terminal: what decides the answer, or keeps one from existing."""

from collections.abc import Collection, Mapping, Sequence

from gearopt.optimise.result import INTERRUPTED, Result
from gearopt.report.measures import rounded
from gearopt.report.words import (
    INVERSE,
    REACHED,
    grouped,
    limit_words,
    objective,
    of_problem_file,
    own_limits,
    sentence,
    series_of,
    share,
    verdict,
)

PROVEN = ("optimal", "stationary")  # where a limit that is reached decides
NAMED_FROM = 0.95  # of a limit; one used so far is named
NAMED = 3  # limits that a sentence names, where more are reached it counts them
RATIO_ENDS = ("ratio_low", "ratio_high")  # limits of one range
DISTANCE = "centre_distance"  # a limit that no conflict was proven without
GIVEN = ("common_divisor",)  # rules that every design of the file is at the end of


def headline(result: Result, text: str = "") -> str:
    """The status and what decides the answer, in one sentence; text: as of `lead`."""
    return sentence(f"{verdict(result)[0]}: {lead(result, text)}")


def lead(result: Result, text: str = "") -> str:
    """One sentence: what decides, is exceeded, or cannot be met together.

    text: the words of the kind of result on a design, instead of its limits.
    """
    if result.status == "infeasible":
        return _impossible(result)
    if result.value is None and not result.given:
        return f"{_stopped(result)}: no design was found, which does not prove that there is none"
    if text or not result.given:
        return text or of_limits(result)
    return exceeded(result) or of_limits(result)


def exceeded(result: Result) -> str:
    """The limits that a given design exceeds, in words; "" where it meets all."""
    over = _over(own_limits(result), of_problem_file(result)) if result.given else []
    return f"the given design exceeds {_on(over)}" if over else ""


def _stopped(result: Result) -> str:
    if INTERRUPTED in result.message:
        return f"the search {INTERRUPTED}"
    return "the budget ended" if result.status == "limit" else "the search ended"


def _impossible(result: Result) -> str:
    """Limits that exclude each other, else the words of the search."""
    ways = result.report.get("ways_out") or {}
    names = ways.get("conflict") or result.proof.get("conflict") or ()
    if not names:
        return (result.message or "no design meets all limits").rstrip(".")
    unsure = [
        name for name in ways.get("unsure") or result.proof.get("unsure") or () if name in names
    ]
    names = [name for name in names if name not in unsure]
    if not names and result.message:
        return result.message.rstrip(".")  # a known cause
    if not names:
        perhaps = f"perhaps because of {_some(result, unsure)} (not decided in the time)"
        return f"no design meets all limits, {perhaps}"
    together = _on(grouped(names, of_problem_file(result)), len(names))
    ratio = {*RATIO_ENDS} & ({*(result.proof.get("conflict") or ())} - {*names})
    held = " at the ratio asked" if ratio else ""
    if unsure:
        with_ = f"cannot be met together with {_some(result, unsure)}"
        return f"{together} {with_} (which of these take part was not decided in the time)"
    if [_stem(name) for name in names] == [DISTANCE] and result.message:
        return result.message.rstrip(".")  # what keeps teeth from it is never dropped whole
    if len(names) == 1 or result.proof.get("each_alone"):
        kept = "with what else the file gives, even if all other limits are dropped"
        cause = result.message.rstrip(".") if ways.get("untried") else ""
        return f"{f'{cause}; ' * bool(cause)}{together} cannot be met {kept}"
    if ways.get("any_resolves"):
        return (
            f"{together} cannot all be met{held}; dropping any one of them makes a design possible"
        )
    return f"{together} cannot be met together{held}"


def _some(result: Result, names: Sequence[str]) -> str:
    """Limits in words, those of [limits] first; of many families the first ones and a count."""
    limits = result.asked.get("limits") or ()
    families = list(dict.fromkeys(map(_stem, names)))
    families.sort(key=lambda stem: stem.removesuffix("_low").removesuffix("_high") not in limits)
    shown = families if len(families) <= NAMED + 1 else families[:NAMED]
    words = [
        word
        for stem in shown
        for word in grouped([n for n in names if _stem(n) == stem], of_problem_file(result))
    ]
    more = len(families) - len(shown)
    return series_of([*words, f"{more} others"] if more else words)


def _over(limits: Mapping[str, float], staged: bool) -> list[str]:
    """The limits that are exceeded, and by how much."""
    worst = sorted((u, n) for n, u in limits.items() if u > 1.0 + REACHED)[::-1]
    exceeded = [
        f"{limit_words(n, staged)} by {rounded(100.0 * (u - 1.0), 2)} %" for u, n in worst[:NAMED]
    ]
    more = len(worst) - NAMED
    return exceeded if more <= 0 else [*exceeded, f"{more} other limits"]


def of_limits(result: Result, shown: Collection[str] = ()) -> str:
    """Limits that decide, else the nearest one; shown: limits that are not named here.

    Of whole teeth and standard sizes, which come in steps, the limits that decide are those that
    their real-valued relaxation reaches; without one, as under ratings, those that are reached
    may decide or not.
    """
    left_out = {*GIVEN, *RATIO_ENDS, *shown}
    limits = {n: u for n, u in own_limits(result).items() if _stem(n) not in left_out}
    reached = [n for n, u in limits.items() if u >= 1.0 - REACHED]
    relaxed = next((part.limits for part in result.parts if part.name == "sizing"), {})
    decisive = [n for n in limits if relaxed.get(n, 0.0) >= 1.0 - REACHED] or reached
    if result.status not in PROVEN:
        decisive = reached
    if result.method == "exact" and result.design.get("rating") and not relaxed:
        decisive = []
    ends = [n for n in reached if n not in decisive]
    rest = {n: u for n, u in limits.items() if n not in (*decisive, *ends) and not _is_end(n)}
    parts = [_decided(result, decisive)] if decisive else []
    parts += (
        [f"{_on(grouped(ends, of_problem_file(result)), len(ends))} {_verb(len(ends))} active"]
        if ends
        else []
    )
    parts += _nearest(rest, not decisive and not ends, of_problem_file(result)) + _tolerance(result)
    best = "in the best design found " if result.status == "limit" and parts else ""
    return best + "; ".join(parts) or _free(result)


def _is_end(name: str) -> bool:
    """Whether a limit is an end of a range, which a design may be anywhere in."""
    return _stem(name).endswith(("_low", "_high"))


def _whole(used: float) -> str:
    """A part in whole per cent; where that would be 100 and is not reached, as tables have it."""
    percent = round(100.0 * used)
    below = percent == 100 and used < 1.0 - REACHED
    return share(used) if below else f"{percent:,}"


def _stem(name: str) -> str:
    return name.partition("[")[0]


def _decided(result: Result, names: list[str]) -> str:
    """Sentence that limits determine the optimum, where that is certain; else that they bind."""
    limits = grouped(names, of_problem_file(result))
    if len(limits) > NAMED:
        limits = [*limits[: NAMED - 1], f"{len(limits) - NAMED + 1} other limits"]
    if result.status not in PROVEN:
        return f"{_on(limits, len(names))} {_verb(len(names))} active"
    determine = "determines" if len(names) == 1 else "determine"
    return f"{_on(limits, len(names))} {determine} the {_goal(result)}"


def _on(words: Sequence[str], count: int | None = None) -> str:
    """Limits in words as "the limits on ..."; count: of limits, where words group them."""
    several = (len(words) if count is None else count) > 1
    return f"the limit{'s' * several} on {series_of(words)}"


def _verb(count: int) -> str:
    return "is" if count == 1 else "are"


def _goal(result: Result) -> str:
    name = objective(result)[0]
    return INVERSE[name][0] if name in INVERSE else name


def _nearest(limits: Mapping[str, float], alone: bool, staged: bool) -> list[str]:
    """The limit that is nearest; alone: none is active."""
    if not limits:
        return []
    name, used = max(limits.items(), key=lambda item: item[1])
    limit = limit_words(name, staged)
    if alone and used < 0.0:
        return ["no limit is active"]
    if alone:
        return [f"no limit is active; the closest by utilisation is {limit}, at {_whole(used)} %"]
    return [f"{limit} is at {_whole(used)} % of its limit"] if used >= NAMED_FROM else []


def _tolerance(result: Result) -> list[str]:
    """Use of the tolerance of a total ratio; nothing where it has none."""
    low, high = (result.limits.get(name) for name in RATIO_ENDS)
    error, ratio = result.design.get("ratio_error_percent"), result.design.get("ratio")
    if low is None or high is None or error is None or ratio is None:
        return []
    asked = ratio / (1.0 + error / 100.0)
    room = 1.0 - low * ratio / asked if error < 0.0 else ratio / high / asked - 1.0
    if room <= REACHED:
        return []
    used = _whole(abs(error) / 100.0 / room)
    return [f"the ratio error is {used} % of its tolerance of {100.0 * room:.4g} %"]


def _free(result: Result) -> str:
    """Sentence where no limit is reported."""
    if result.status in PROVEN:
        return "no limit is active at the optimum"
    return "no limit is active" if result.status == "evaluated" else "a better design may exist"
