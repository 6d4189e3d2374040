"""From an answer to the next question: a stage of its gears as a pair, its rating, its dynamics."""

import hashlib
from pathlib import Path
from typing import Any

from gearopt import api
from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.result import Budget, Result
from gearopt.scenes.reading.linked_files import Input
from gearopt.scenes.reading.load import FORMAT

USUAL = Budget(60.0)  # of the command line, too


@dataclass(frozen=True)
class StageOfResult:
    """A stage of the gears of a result, counted from 1; None: the only one.

    Each answer is that to a file which takes its gears from the result: tables are those that the
    file has besides, as in `pair(sharing={"loads": [0.5, 1]})`. budget: by default the 60 s of the
    command line.
    """

    result: Result
    number: int | None = None

    def __post_init__(self) -> None:
        count = len(self.result.design.get("stages", ()))
        if self.number is not None and count and not 1 <= self.number <= count:
            known = " and ".join(map(str, range(1, count + 1)))
            raise SolveError(
                f"stage({self.number}): the result has stage{'s' * (count > 1)} {known}"
            )

    def pair(self, budget: Budget | None = None, **tables: Any) -> Result:
        """Return the contact of its teeth, and their relief with a table `relief`."""
        return api.solve(self._file("pair", tables), budget=budget or USUAL)

    def rate(self, **tables: Any) -> Result:
        """Return its rating, by that of the result unless it has none."""
        return api.rate(self._file("drive", tables))

    def dynamics(self, budget: Budget | None = None, **tables: Any) -> Result:
        """Return its motions; the tables `pinion` and `wheel` have their bearings."""
        return api.solve(self._file("dynamics", tables), budget=budget or USUAL)

    def _file(self, kind: str, tables: dict[str, Any]) -> dict[str, Any]:
        """The tables of a file that takes its gears from the stage."""
        if option := next((name for name in ("seconds", "evaluations") if name in tables), None):
            raise TypeError(f"{option} is no table: write budget=Budget({option}={tables[option]})")
        kept = self.result
        digest = hashlib.sha256(kept.to_json().encode()).hexdigest()
        name = kept.file or "the result"
        source = Input(name, digest, kept.scene or "a problem", kept, Path(name).resolve())
        number = {} if self.number is None else {"stage": self.number}
        gears = tables.get("gears", {}) | {"from": source} | number
        return {"gearopt": FORMAT, "kind": kind, **tables, "gears": gears}
