"""Names, numbers and the first words of a result, and the command that makes its page again."""

import math
import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any

from gearopt.formulations.strength.laws import laws
from gearopt.optimise.result import Result
from gearopt.report.measures import DIGITS, METRIC, Measures, gap_percent, read_in, rounded

REACHED = 1e-6  # nearer to a limit than that, it is reached
MODULE = "normal_module_mm"
_MODULES = "module_mm"  # how keys of modules end
VERDICTS = {
    "optimal": ("proven optimal", "green"),
    "stationary": ("locally optimal (no bound)", "yellow"),
    "feasible": ("feasible, not proven optimal", "yellow"),
    "evaluated": ("evaluated, all limits met", "green"),
    "infeasible": ("impossible, proven", "red"),
    "limit": ("stopped early", "yellow"),
    "failed": ("failed", "red"),
}
RATING = "rating"  # name of a result that rates gears that are given
SIDES = ("left", "right", "front", "bottom", "top")  # keys of where a box ends
RULED = ("process one", "process two")  # parts that are designs by rules
EXACT = 1e-6  # a gap below it is called optimal, one above it is named

GOALS = {  # objectives whose names alone do not say of what they are, by kind
    "dynamics.peak_to_peak": "peak-to-peak deformation",
    "dynamics.rms": "RMS of the deformation about its mean",
    "packing.area": "plan area",
    "packing.volume": "container volume",
    "pair.peak_to_peak": "peak-to-peak transmission error",
    "strain_wave.pressure": "contact pressure of conjugate pairs",
}
NAMES = {  # of numbers of designs and of objectives, where their keys are not what is said
    "sector": "last wheel, share of a disc",
    "equal_pressure": "contact pressure of conjugate pairs",
    "shared_pressure": "contact pressure, load shared",
    "total_length": "total length in one line",  # of a drive, in whichever way it is drawn
}
LIMITS = {  # the same of limits
    "multiplier": "Floquet multiplier",
    "pairs": "conjugate pairs",
    "rss": "root-sum-square error",
    "worst_case": "worst-case error",
}
INVERSE = {  # name and unit of the inverse
    "inverse acceleration": ("acceleration", "rad/s²"),
    "inverse contact ratio": ("contact ratio", ""),
}
_NUMBER = r"-?[0-9.]+(?:e[+-]?[0-9]+)?"
VIOLATION = re.compile(  # a sentence of `optimise.scale.broken`
    rf"(?P<name>\S+) (?:is violated by (?P<excess>{_NUMBER})|= (?P<value>{_NUMBER}) is "
    rf"(?:not one of its values|(?P<way>above|below) its bound (?P<end>{_NUMBER})))"
)
SECONDS = 60.0  # that a run may take
TOP_ON_PAGE = 10  # trains that a page lists
DEFAULTS = {"seconds": SECONDS, "seed": 0, "top": TOP_ON_PAGE}


def limit_words(name: str, staged: bool = True) -> str:
    """`k_factor[2]` as "K-factor of stage 2"; not staged, of a user's problem, as [2]."""
    stem, _, index = name.rstrip("]").partition("[")
    said = LIMITS[stem] if staged and stem in LIMITS else _stem_words(stem)
    if not index:
        return said
    return f"{said} of stage {index}" if staged else f"{said}[{index}]"


def violation_words(message: str) -> str:
    """Return a message on the largest violation of a problem file's limits in words.

    "k_factor[2] is violated by 0.03" as "K-factor of stage 2 exceeds its limit by 3 %",
    "pinion_teeth[1] = 43 is above its bound 40" as "pinion teeth of stage 1: 43, at most 40".
    Another message as it is, and what follows the first sentence.
    """
    said, stop, rest = message.partition(". ")
    end = "." if said.endswith(".") else ""
    fits = VIOLATION.fullmatch(said.removesuffix("."))
    if fits is None:
        return message
    name, value, excess = limit_words(fits["name"]), fits["value"], fits["excess"]
    unit = " mm" if fits["name"].startswith("module") else ""
    if excess is not None:
        verbs = {"minimum": "is missed", "maximum": "is exceeded"}
        verb = verbs.get(name.split(" ")[0], "exceeds its limit")
        words = f"{name} {verb} by {100.0 * float(excess):.3g} %"
    elif fits["way"] is None:
        words = f"{name}: {value}{unit}, not one to choose from"
    else:
        most = "at most" if fits["way"] == "above" else "at least"
        words = f"{name}: {value}{unit}, {most} {fits['end']}{unit}"
    return f"{words}{end}{stop}{rest}"


def of_problem_file(result: Result) -> bool:
    """Whether a result answers a problem file, whose blocks of limits are of stages."""
    return result.scene is not None


OF_PLANETS = {  # endings of limits of a mesh with planets: what its gears are called
    "_of_sun": {"pinion": "sun", "wheel": "planet_at_the_sun"},
    "_of_ring": {"pinion": "planet_at_the_ring", "wheel": "ring"},
}


def _stem_words(stem: str) -> str:
    """`k_factor` as "K-factor", `ratio_low` as "minimum ratio"."""
    known = {limit.name: limit.label for law in laws() for limit in law.limits}
    for end, words in (("_low", "minimum"), ("_high", "maximum")):
        if stem.endswith(end):
            return f"{words} {stem.removesuffix(end).replace('_', ' ')}"
    if "_after_idler" in stem:  # of the mesh of an idler, its pinion, and the wheel
        stem = stem.replace("_after_idler", "").replace("pinion", "idler_towards_the_wheel_in")
    for end, names in OF_PLANETS.items():  # of the meshes of planets
        if end in stem:
            member, _, mode = stem.replace(end, "").partition("_")
            stem = f"{names[member]}_{mode}" if member in names else stem
    name, static, _ = stem.removesuffix("_iso").partition("_static")
    words = f"{'static ' if static else ''}{known.get(name, name.replace('_', ' '))}"
    return words if not stem.endswith("_iso") else f"{words} by ISO 6336"


def own_limits(result: Result) -> dict[str, float]:
    """Limits of a result, of a pinion in a ring by the name of the ring."""
    rings = {
        f"[{k}]"
        for k, stage in enumerate(result.design.get("stages", ()), 1)
        if stage.get("type") == "internal"
    }
    return {
        re.sub("^wheel_", "ring_", name) if name[name.find("[") :] in rings else name: used
        for name, used in result.limits.items()
    }


def grouped(names: Iterable[str], staged: bool = True) -> list[str]:
    """Limits in words, those of several stages as one: "K-factor of stages 1 and 2"."""
    if not staged:
        return [limit_words(name, staged) for name in sorted(names)]
    stages: dict[str, list[str]] = {}
    for name in sorted(names):
        stem, _, index = name.rstrip("]").partition("[")
        stages.setdefault(stem, []).append(index)
    return [
        limit_words(stem)
        if not all(of_stem)
        else f"{limit_words(stem)} of stage{'s' if len(of_stem) > 1 else ''} {counted(of_stem)}"
        for stem, of_stem in stages.items()
    ]


def counted(indices: Sequence[str]) -> str:
    """Indices as words, those without a break as "1 to 4"."""
    numbers = sorted(map(int, indices))
    whole = len(numbers) > 2 and numbers[-1] - numbers[0] == len(numbers) - 1
    return f"{numbers[0]} to {numbers[-1]}" if whole else series_of(list(map(str, numbers)))


def series_of(words: Sequence[str]) -> str:
    """Several words as a list: "a, b and c"."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def sentence(words: str) -> str:
    """Words with a capital and a full stop."""
    return f"{words[0].upper()}{words[1:].rstrip('.')}." if words else ""


def edit(change: Mapping[str, Any]) -> str:
    """A change as it is written in the file."""
    key, write = change["key"], change.get("short") or change["write"]
    if key.startswith("stage[") and key.endswith("]") and not change["was"]:  # a table of its own
        held = write.strip("{} ")
        return f"one more table [[stage]]{f' with {held}' if held else ''}"
    return f"{key} = {write}" if write else f"remove {key}"


@lru_cache(4096)
def heading(key: str, measures: Measures = METRIC) -> str:
    """`face_width_mm` as "face width [mm]", `left_mm` as "left side at [mm]"."""
    stem, suffix = parted(key, measures)
    words = f"{stem} side at" if stem in SIDES else NAMES.get(stem, stem.replace("_", " "))
    return f"{words} [{measures.unit(suffix)}]" if suffix else words


def is_module(key: str) -> bool:
    """Whether a key holds normal modules [mm], shown as diametral pitches in inches."""
    return key.endswith(_MODULES)


@lru_cache(4096)
def parted(key: str, measures: Measures = METRIC) -> tuple[str, str]:
    """Name and unit of a key: `face_width_mm` is ("face_width", "mm")."""
    if is_module(key):
        name, _, unit = measures.module
        return f"{key.removesuffix(_MODULES)}{name} [{unit}]", ""
    units = [unit for unit in measures.units if key.endswith(f"_{unit}")]
    unit = max(units, key=len, default="")
    return (key.removesuffix(f"_{unit}"), unit) if unit else (key, "")


def amount(value: Any, unit: str, measures: Measures = METRIC, beside: float | None = None) -> str:
    """A number of a result with its unit, for reading; beside: as of `Measures.amount`."""
    return measures.amount(value, unit, beside=beside)


def micrometres(value: float, measures: Measures, digits: int = 3) -> str:
    """A length [mm] of micrometres for a sentence, with so many digits."""
    return f"{rounded(measures.of(value, 'um'), digits)} {measures.unit('um')}"


def module_words(module: float, measures: Measures) -> str:
    """A normal module [mm] as drawings name it: "m_n 2 mm", "P_nd 10 1/in"."""
    _, sign, unit = measures.module
    return f"{sign} {measures.of_module(module):g} {unit}"


def share(used: float) -> str:
    """A part of a whole in per cent; 100.0 only where it is reached."""
    text = f"{100.0 * used:.1f}"
    below = text == "100.0" and used < 1.0 - REACHED
    return f"{math.floor(1e4 * used) / 100.0:.2f}" if below else text


def effort(method: str, evaluations: int, seconds: float) -> str:
    """Method, evaluations and seconds of an answer, in words."""
    return (
        f"Method {method}: {evaluations:,} evaluation{'s' * (evaluations != 1)}, {seconds:.3g} s."
    )


def teeth_of(stage: Mapping[str, Any]) -> str:
    """Numbers of teeth of the gears of a stage of a design, z1/z2 or z_s/z_p/z_r."""
    members = ("sun", "planet", "ring") if stage.get("sun_teeth") else ("pinion", "wheel")
    return "/".join(number(stage[f"{member}_teeth"]) for member in members)


def number(value: Any) -> str:
    """A number without a unit for reading: whole ones in full, others to five digits."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return f"{value:,}" if isinstance(value, int) else rounded(value, DIGITS)


def certainty(result: Result) -> tuple[str, str]:
    """The status in words, and its colour."""
    words, colour = VERDICTS[result.status]
    if result.status == "evaluated" and not result.meets_limits:
        words, colour = "evaluated, a limit is exceeded", "red"
    if result.status == "evaluated" and not result.limits:
        words = "evaluated"
    if result.name == RATING:
        words, colour = ("safe", "green") if result.feasible else ("not safe", "red")
        if result.feasible and result.design["rating"].get("flaws"):
            words, colour = "safe, with warnings", "yellow"
    if result.status == "stationary" and result.bound is not None:
        words = "locally optimal"  # its gap is told beside
    if of_gears_first(result):
        return impossible_for(result.proof["scope"]), colour
    scope = "" if result.value is None else str(result.proof.get("scope", ""))
    these = bool(scope) and any(part.name == "gears" for part in result.parts)
    if result.status == "optimal" and these:
        words = "least for these gears"
    if result.status == "optimal" and (result.gap or 0.0) > EXACT:
        of = "the least for these gears" if these else "the optimum"
        words = f"proven within {gap_percent(result.gap or 0.0)} of {of}"
    if result.status == "infeasible" and "checked" in result.proof:
        words = "impossible by a bound that is checked, not proven"
    if "achieved" in result.report:  # something is come near to
        words = words.replace("optimal", result.report.get("best", "nearest"))
    return f"{words} ({scope})" if scope else words, colour


def impossible_for(scope: str) -> str:
    """Headline where some gears, and they alone, are proven impossible."""
    return f"impossible for these gears ({scope.removeprefix('gears ')}), proven"


def of_gears_first(result: Result) -> bool:
    """Whether only gears sized first are proven impossible to lay out."""
    return result.status == "infeasible" and "scope" in result.proof


def verdict(result: Result) -> tuple[str, str]:
    """Achievement and its certainty, and their colour."""
    words, colour = certainty(result)
    if achieved := result.report.get("achieved"):
        words = f"{achieved}; {words}"
    if fault := unusable(result):
        words = f"{fault}; {words}"
    return words, "yellow" if leading(result) or fault else colour


def unusable(result: Result) -> str:
    """Reason why an optimum cannot be used although it meets the limits of its search."""
    rating = result.design.get("rating") or {}
    if result.report.get("misfits"):
        return "teeth interfere"
    safe = all(one["safe"] for one in (rating, rating.get("beside")) if one)
    return "" if safe or not result.objective else "not safe by its rating"


def leading(result: Result) -> list[str]:
    """Distance of a request out of reach, to be read before the numbers."""
    reach = result.report.get("reach")
    return [result.message] if reach and not reach["within"] and result.message else []


def title(result: Result) -> str:
    """The name of a result: the title of its file, or the file's name."""
    return str(result.asked.get("title") or result.file or result.scene or result.name)


def objective(result: Result) -> tuple[str, str]:
    """The name of the objective in words, and its unit as a key has it."""
    name, unit = (str(result.objective.get(key, "")) for key in ("name", "unit"))
    return goal_words(name, result.scene), read_in(name, unit)


def goal_words(name: str, scene: str | None) -> str:
    """The name of an objective of a kind of file (None: of one's own problem) in words."""
    known = GOALS.get(f"{scene}.{name}") or (NAMES.get(name) if scene else None)
    return known or name.replace("_", " ")


def goal(result: Result) -> tuple[str, str, float | None, float | None, str]:
    """Name, unit, value and bound of the objective, and on which side no design is.

    Of an inverse that is minimised, what it maximises is shown.
    """
    name, unit = objective(result)
    if name not in INVERSE:
        return name, unit, result.value, result.bound, "above" if result.maximised else "below"
    value, bound = (None if not v else 1.0 / v for v in (result.value, result.bound))
    return *INVERSE[name], value, bound, "above"


def limit_rows(
    limits: Mapping[str, float], staged: bool = True
) -> tuple[int, list[tuple[str, list[float | None]]]]:
    """The number of stages; every limit with its use per stage, then of the whole."""
    if not staged:
        return 0, [(limit_words(name, staged), [value]) for name, value in limits.items()]
    rows: dict[str, dict[int, float]] = {}
    for name, value in limits.items():
        match = re.fullmatch(r"(.*)\[(\d+)\]", name)
        stem, index = (match[1], int(match[2])) if match else (name, 0)
        rows.setdefault(stem, {})[index] = value
    stages = max((i for r in rows.values() for i in r), default=0)
    order = (*range(1, stages + 1), 0)
    return stages, [(limit_words(stem), [r.get(k) for k in order]) for stem, r in rows.items()]


def again(result: Result, html: str, measures: Measures) -> str:
    """The command that makes a page again, without default options; "" if none.

    html: where it writes the page. A run from Python without a limit of time had more of it than
    any command. One that changed the tables of its file was Python's.
    """
    if result.file is None:
        return ""
    verb = "rate" if result.name == RATING and result.scene == "drive" else "solve"
    if changes := result.options.get("changes"):
        return f"gearopt.{verb}({result.file!r}, {changes!r})"
    words = ["gearopt", verb, result.file]
    if design := result.options.get("design"):
        words += ["--design", str(design)]
    elif result.options and result.options.get("seconds") is None:
        words += ["--seconds", "1e9"]
    for name in ("method", "seconds", "gap", "seed", "top"):
        value = result.options.get(name)
        if value is not None and value != DEFAULTS.get(name):
            words += [f"--{name}", f"{value:.12g}" if isinstance(value, float) else str(value)]
    if measures is not METRIC:
        words += ["--units", measures.name]
    return shlex.join([*words, "--html", html])
