"""Answers: `Outcome` from a method (a claim), `Result` after certification (a fact)."""

import json
import math
import platform
import sys
from collections.abc import Callable, Mapping
from dataclasses import MISSING, field, fields, is_dataclass, replace
from functools import cache
from importlib import import_module
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.optimise.terms import Array
from gearopt.optimise.typed import SINGLE

if TYPE_CHECKING:
    from gearopt.optimise.conic.cone_bound import Leaf
    from gearopt.optimise.spatial.enumeration import Enumerated
    from gearopt.optimise.spatial.step import Record

FORMAT = 1
MAXIMISE = "maximise"
CLOSED_FORM = "Proof: the optimum in closed form, and a lower bound that follows from convexity."
INTERRUPTED = "was interrupted"  # message of a search that its watcher ended
THERE = ("optimal", "stationary", "feasible")  # a design exists
STATUSES = ("optimal", "stationary", "feasible", "evaluated", "infeasible", "limit", "failed")
FEASIBLE = 1e-8  # of its own scale a variable, of 1 a row is off; that is below any data error


def is_number(value: Any) -> bool:
    """Return whether a value is a finite real number."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


@cache
def _version(name: str) -> str:
    """Version of a package; where it is not loaded from its metadata, which takes time."""
    if loaded := getattr(sys.modules.get(name), "__version__", ""):
        return str(loaded)
    from importlib.metadata import version

    return version(name)


@dataclass(frozen=True)
class Budget:
    """Effort that a method may spend: wall seconds and evaluations (None: no bound).

    gap: a method with a bound of its own may stop when its relative gap is this small.
    """

    seconds: float | None = None
    evaluations: int | None = None
    gap: float = 0.0

    def __post_init__(self) -> None:
        for name in ("seconds", "evaluations", "gap"):
            value, whole = getattr(self, name), name == "evaluations"
            if value is None and name != "gap":
                continue
            if not is_number(value) or value < 0.0 or (whole and value != int(value)):
                sort = "whole number" if whole else "number"
                raise ValueError(f"Budget({name}={value!r}): write a {sort} of at least 0")

    def less(self, seconds: float, evaluations: int = 0) -> "Budget":
        """Rest of the budget after some effort."""
        return replace(
            self,
            seconds=None if self.seconds is None else max(0.0, self.seconds - seconds),
            evaluations=None
            if self.evaluations is None
            else max(0, self.evaluations - evaluations),
        )


@dataclass(frozen=True)
class Event:
    """Progress of a run, given to `watch(event)`; returning False stops the run.

    seconds: since the run began. evaluations: of all its parts so far, as their methods count.
    best, bound: reached so far in the part; None where nothing is. part: what is solved now, such
    as "sizing" or "layout"; "other numbers" where `explain` and prices solve changed problems, or
    other trains of a servo axis are listed, whose values are left out; "compiling, once for this
    version of gearopt: 3 of 22" while functions are compiled, in the time of no budget. objective,
    unit: of best and bound; unit "" for a plain number. known: a result that is proven to be
    impossible, told before remedies are sought; else None.
    """

    seconds: float
    evaluations: int
    best: float | None = None
    bound: float | None = None
    part: str = ""
    objective: str = ""
    unit: str = ""
    known: "Result | None" = None


Watch = Callable[[Event], bool]


@dataclass(frozen=True)
class Outcome:
    """A method's claim; `certify` judges it.

    x: the best point (n,), or None. finished: it ran to its own end, not out of budget.
    lam_g, lam_h: multipliers of the form's rows. infeasible: it claims there is no feasible point,
    by lam_g, lam_h (a Farkas certificate) or by `proof`. bound and proof: of an exact algorithm;
    proof["sentence"] states it for a reader, beside a bound or an impossibility.
    others: further points, of an exact algorithm in proven order, of several objectives the rest of
    the Pareto front. leaves: of a conic problem, the parts of its box with
    their multipliers. message: what it has to say. stationary: of an own algorithm, whether x was
    certified as stationary in a traced form that equals the text there; None: to be judged.
    records: of spatial branch and bound, its boxes with their duals.
    """

    x: Array | None
    finished: bool = True
    lam_g: Array | None = None
    lam_h: Array | None = None
    infeasible: bool = False
    bound: float | None = None
    proof: Mapping[str, Any] | None = None
    others: tuple[Array, ...] = ()
    leaves: tuple["Leaf", ...] = ()
    evaluations: int = 0
    message: str = ""
    stationary: bool | None = None
    records: tuple["Record | Enumerated", ...] = ()


def as_dict(self: Any) -> dict[str, Any]:
    """Return plain dicts, lists and numbers; no NaN and no infinity (None instead)."""
    return {f.name: plain(getattr(self, f.name)) for f in fields(self)}


def as_json(self: Any) -> str:
    """Return one JSON object."""
    return json.dumps(self.to_dict(), indent=2, allow_nan=False)


@dataclass(frozen=True)
class Result:
    """The answer to a problem, as `--json` prints it.

    status: optimal (our bound within the stated gap), stationary (a local minimum, its bound, if
    there is one, further off), feasible, evaluated (nothing was minimised; `feasible` says whether
    the design given meets all limits), infeasible (proven), limit (stopped early), failed.
    objective: {name, value, unit}, and sense "maximise" where it is; empty where nothing was
    minimised. bound: nothing feasible is better; gap: |objective - bound|/|objective|, of an
    objective of zero relative to certificate["scale"], its own scale. proof: {method, sentence,
    ...}. certificate: {feasibility, stationarity, complementarity}. limits: utilisations by name.
    multipliers: shadow prices of limits and equalities by name, d objective / d right-hand side:
    where 1.01 instead of 1 is allowed, the objective changes by 0.01 of it, in its own unit; of a
    limit never for the worse, and 0 where it does not bind. Empty where they are not known:
    discrete variables, an exact search.
    file_sha256: of the file as it is. asked: its tables, with the changes; options: what was asked
    for beside it (method, seconds, gap, seed, top, prices, and changes {key: value} if there were).
    """

    name: str
    status: str
    method: str
    objective: dict[str, Any]
    bound: float | None = None
    gap: float | None = None
    proof: dict[str, Any] = field(default_factory=dict)
    certificate: dict[str, float | None] = field(default_factory=dict)
    design: dict[str, Any] = field(default_factory=dict)
    limits: dict[str, float] = field(default_factory=dict)
    multipliers: dict[str, float] = field(default_factory=dict)
    report: dict[str, Any] = field(default_factory=dict)
    parts: tuple["Result", ...] = ()
    message: str = ""
    evaluations: int = 0
    seconds: float = 0.0
    seed: int = 0
    scene: str | None = None
    file: str | None = None
    file_sha256: str | None = None
    asked: dict[str, Any] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    result: int = FORMAT
    gearopt: str = field(default_factory=lambda: _version("gearopt"))

    @property
    def value(self) -> float | None:
        """Return the objective's value, None without a feasible design."""
        value = self.objective.get("value")
        return None if value is None else float(value)

    @property
    def maximised(self) -> bool:
        """Return whether larger values of the objective are better."""
        return self.objective.get("sense") == MAXIMISE

    @property
    def given(self) -> bool:
        """Return whether a given design was evaluated, wholly or until the run was stopped."""
        stopped = self.status == "limit" and not self.objective and bool(self.design)
        return self.status == "evaluated" or stopped

    @property
    def feasible(self) -> bool:
        """Return whether there is a design that meets all limits, as the certificate says."""
        return bool(self.design) and self.meets_limits

    @property
    def meets_limits(self) -> bool:
        """Return whether its certificate says that all limits are met; of a part, too."""
        excess = self.certificate.get("feasibility")
        return excess is not None and excess <= FEASIBLE

    def __repr__(self) -> str:
        return str(shown("lines", self))

    def _repr_html_(self) -> str:
        return str(shown("fragment", self))

    @property
    def tables(self) -> tuple[str, ...]:
        """Return names of the tables of its page, which `table` takes."""
        return tuple(shown("table_names", self, "metric"))

    def table(self, name: str, units: str = "metric") -> list[dict[str, Any]]:
        """Return a table of its page as rows {column: value}, in full precision.

        A row for every stage in "stages", for every train in "best-trains"; columns are those of
        the CSV files. units: "metric" or "inch". ValueError names the tables there are.
        """
        rows: list[dict[str, Any]] = shown("table_rows", self, name, units)
        return rows

    def stage(self, number: int | None = None) -> Any:
        """Return a stage of the gears found, counted from 1; without a number the only one.

        Of it `pair`, `rate` and `dynamics` are answered as files are that take their gears from it.
        """
        return import_module(STAGES).StageOfResult(self, number)

    def to_html(self, units: str = "metric") -> str:
        """Return its page, one self-contained HTML text; units: "metric" or "inch"."""
        return str(shown("whole_page", self, units))

    def to_rexs(self) -> bytes:
        """Return the gears of a drive as a REXS file, XML of version 2.0.0, for other programs."""
        return bytes(import_module(API).export(self, "rexs"))

    def to_pdf(self, path: str | Path, units: str = "metric") -> None:
        """Write its page as PDF, by an installed browser; units: "metric" or "inch"."""
        shown("write_pdf", self.to_html(units), path, self.asked, units)

    to_dict, to_json = as_dict, as_json

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Result":
        """Inverse of `to_dict`; ValueError for a dict that is none, or of another format."""
        if not isinstance(data, Mapping) or "result" not in data:
            raise ValueError("is not a result of `gearopt solve --json`: it has no key `result`")
        if isinstance(data["result"], Mapping):
            raise ValueError("is an explanation, or holds a result inside, but is none itself")
        if data["result"] != FORMAT:
            raise ValueError(
                f"has the result format {data['result']!r}; this gearopt reads {FORMAT}"
            )
        known = {f.name for f in fields(cls)}
        if unknown := sorted(set(data) - known):
            raise ValueError(f"has keys that no result has: {', '.join(unknown)}")
        needed = {f.name for f in fields(cls) if f.default is f.default_factory is MISSING}
        if missing := sorted(needed - set(data)):
            raise ValueError(f"lacks the keys {', '.join(missing)} of a result")
        _check_sorts(data)
        return cls(**{**data, "parts": tuple(cls.from_dict(p) for p in data.get("parts", ()))})

    @classmethod
    def from_json(cls, text: str) -> "Result":
        """Return the inverse of `to_json`."""
        return cls.from_dict(loads(text))


API, STAGES = (
    "gearopt.api",
    "gearopt.stages",
)  # what is made of the gears of an answer, likewise by name
SHOWN = "gearopt.report.shown"  # who shows an answer, by name: this room imports no report


def shown(what: str, *of: Any) -> Any:
    """An answer as a function of the report room shows it, imported when it is asked."""
    return getattr(import_module(SHOWN), what)(*of)


def loads(text: str) -> Any:
    """Return plain data from JSON text; ValueError for NaN, infinities, and endless depth."""

    def refuse_non_number(word: str) -> None:
        raise ValueError(f"holds {word}, which is not a JSON number")

    try:
        return json.loads(text, parse_constant=refuse_non_number)
    except RecursionError:
        raise ValueError("is nested too deeply") from None


_SORTS: dict[str, Any] = {  # of what a result's keys hold
    **dict.fromkeys(("name", "status", "method", "message", "gearopt"), str),
    **dict.fromkeys(("scene", "file", "file_sha256"), str | None),
    "seed": int,
    **dict.fromkeys(("objective", "proof", "certificate", "design", "limits"), Mapping),
    "multipliers": Mapping,
    **dict.fromkeys(("report", "versions", "asked", "options"), Mapping),
    "parts": list | tuple,
    "bound": int | float | None,
    "gap": int | float | None,
    "seconds": int | float,
    "evaluations": int,
}


def _check_sorts(data: Mapping[str, Any]) -> None:
    """Raise ValueError where a key of a result holds another sort of value than it can."""
    if data["status"] not in STATUSES:
        raise ValueError(f"has the status {str(data['status'])[:40]!r}, which no result has")
    for key, sort in _SORTS.items():
        if key in data and not isinstance(data[key], sort):
            raise ValueError(f"has a value of the wrong type in {key}")
    value = data["objective"].get("value")
    if not isinstance(value, int | float | None):
        raise ValueError("has an objective whose value is not a number")
    absent = "" if data["status"] in ("evaluated", "limit") else None
    words = [data["objective"].get("name", absent), data["objective"].get("unit", "")]
    if not all(isinstance(word, str) for word in words):
        raise ValueError("has an objective without a name, or whose unit is not a text")


def versions(*packages: str) -> dict[str, str]:
    """Return versions of Python and of the packages a result rests on."""
    return {"python": platform.python_version()} | {name: _version(name) for name in packages}


def plain(value: Any) -> Any:
    """Return a value as JSON holds it: dicts, lists, numbers; None for NaN and infinities."""
    if value.__class__ is float:
        return value if math.isfinite(value) else None
    if value.__class__ in SINGLE:
        return value
    if is_dataclass(value) and not isinstance(value, type):
        return as_dict(value)
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
