"""Ways out that move no limit: a tolerance where the file allows none, switches of [teeth]."""

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from gearopt.optimise.explaining.explanation import Change, Remedy
from gearopt.optimise.explaining.repair import TAKEN_BACK, least_value
from gearopt.physics.gears import MODULES
from gearopt.scenes.drive.explaining.tried import Case
from gearopt.scenes.explaining.numbers import eased, put, written
from gearopt.scenes.reading.toml import dotted, toml_text

TOLERANCES = (Fraction(1, 10**5), Fraction(1, 2))  # tried where the file allows none


def eased_tolerance(case: Case) -> Remedy | None:
    """The least ratio tolerance with which a drive of none is possible."""
    path = ("duty", "ratio_tolerance")

    def works(value: float, back: float = 0.0) -> bool | None:
        word = case.status(put(case.scene, path, Fraction(value * (1.0 - back))))
        return {"feasible": True, "infeasible": False}.get(word)

    low, high = map(float, TOLERANCES)
    least = least_value(low, (high,), works)
    if least is None:
        return None
    value = eased(Fraction(least), 1.0, 1)
    texts = [toml_text(written(v, path)) for v in (Fraction(0), value)]
    change = Change(dotted(path), texts[0], texts[1], math.inf)
    words = [case.status(put(case.scene, path, value * Fraction(1 - b))) for b in (0, TAKEN_BACK)]
    if words[0] != "feasible":
        return None
    verified = {"with": words[0], "with_less": words[1]}
    return Remedy("less", path[-1], (change,), change.factor, None, verified)


def switches(case: Case) -> Iterator[Remedy]:
    """Switches of [teeth] that suffice alone: hunting teeth off, a module more, both series."""
    teeth = case.scene.teeth
    assert teeth is not None
    ways: list[tuple[str, str, str, dict[str, Any]]] = []
    if teeth.coprime:
        ways.append(("coprime", "true", "false", {"coprime": False}))
    named = next((f'"{n}"' for n, s in MODULES.items() if s == teeth.modules), None)
    both = MODULES["ISO 54 I+II"]
    if named is None:
        ways += [
            ("modules", _listed(teeth.modules), _listed(more), {"modules": more})
            for more in _one_more(teeth.modules)
        ]
    if not set(both) <= set(teeth.modules):
        was = named or _listed(teeth.modules)
        ways.append(("modules", was, '"ISO 54 I+II"', {"modules": both}))
    done = set()
    for field, was, write, update in ways:
        kind = (field, write.startswith("["))
        other = case.scene.model_copy(update={"teeth": teeth.model_copy(update=update)})
        if kind not in done and case.possible(other.train()):
            done.add(kind)
            change = Change(f"teeth.{field}", was, write, 1.0)
            yield Remedy("choice", field, (change,), 1.0, None, {"with": "feasible"})


def _one_more(modules: tuple[Fraction, ...]) -> list[tuple[Fraction, ...]]:
    """The list with one module of ISO 54 more: series I first, those near the list's first."""

    def far(module: Fraction) -> float:
        return min(float(max(m, module) / min(m, module)) for m in modules)

    found: list[Fraction] = []
    for series in MODULES.values():
        new = sorted(set(series) - set(modules) - set(found), key=far)
        found += new
    return [tuple(sorted((*modules, m))) for m in found]


def _listed(modules: Sequence[Fraction]) -> str:
    return toml_text([written(m, ("teeth", "modules")) for m in modules])
