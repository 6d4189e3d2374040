"""Duty, load spectrum and life of a REXS model, carried to the input shaft without losses."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

from gearopt.scenes.drive.rexs.model import Component, Keys, Model, Said, in_unit, wrong

TORQUE, SPEED = "torque_around_u_axis", "rotational_speed"
TIME, SHARE = "operating_time", "operating_time_fraction"
KW = 30000.0 / math.pi  # N m/min in a kilowatt
Case = Mapping[int, Component]


def loads(
    model: Model,
    bodies: Mapping[int, int],
    shafts: Mapping[int, Fraction],
    unit: Component | None,
    remarks: list[str],
) -> Keys:
    """Duty, life and load spectrum; shafts: speed of the input over theirs."""
    torque, speed, _ = _duty(model, {}, bodies, shafts)
    cases = []
    for k, case in enumerate(model.cases, 1):
        t, n, enters = _duty(model, case, bodies, shafts)
        if t is None or n is None:
            name, what = (TORQUE, "torque") if t is None else (SPEED, "speed")
            rule = f"has no {what} of input or output shaft"
            raise wrong(f"load case {k}", None, rule, f"Write {name} of a shaft or its load")
        cases.append((t, n, enters))
    if len({enters for *_, enters in cases}) > 1:
        remarks.append(
            "torque changes its sign between load cases: amounts are taken; write reversed_load = "
            "true at gears whose teeth are bent both ways"
        )
    if (torque is None or speed is None) and cases:
        torque, speed, _ = max(cases, key=lambda case: case[0].value)
    shares, life = _shares(model, unit)
    duty = {
        "torque": _with(torque or Said(Decimal(100), "", True), "N m"),
        "input_speed": _with(speed or Said(Decimal(1000), "", True), "1 / min"),
    }
    levels = [
        {
            "power": Said(in_unit(float(t.value) * float(n.value) / KW, "kW"), t.origin),
            "input_speed": _with(n, "1 / min"),
            "share": share,
        }
        for (t, n, _), share in zip(cases, shares, strict=False)
    ]
    return {"duty": duty, "load": levels, "life": life}


def _with(said: Said, unit: str) -> Said:
    return replace(said, value=in_unit(said.value, unit))


def _duty(
    model: Model, case: Case, bodies: Mapping[int, int], shafts: Mapping[int, Fraction]
) -> tuple[Said | None, Said | None, bool]:
    """Torque [N m] and speed [1/min] of the input shaft, by whatever shaft they are said of.

    A load case says what changes. The last value: whether both have one sign.
    """
    speed = torque = None
    signs = set[bool]()
    on_path = [c for c in model.of_type("shaft", "external_load") if bodies[c.id] in shafts]
    for c in said_first(on_path, case, SPEED, "shaft"):
        slower = shafts[bodies[c.id]]
        if speed is None and (n := c.number(SPEED)):
            speed = Said(abs(n) * slower.numerator / slower.denominator, c.at(SPEED))
            signs.add(n > 0)
    powers = {c.id: c for c in said_first(on_path, case, "power", "external_load")}
    for c in said_first(on_path, case, TORQUE, "external_load"):
        slower, value, at = shafts[bodies[c.id]], c.number(TORQUE), c.at(TORQUE)
        power = powers[c.id].number("power")
        if not value and power and speed is not None:
            value, slower = Decimal(repr(float(power) * KW / float(speed.value))), Fraction(1)
            at = powers[c.id].at("power")
        if torque is None and value:
            if bodies[c.id] not in (next(iter(shafts)), [*shafts][-1]):
                rule = "acts between two stages, and a drive has one input and one output"
                raise wrong(at, str(value), rule, "Remove it")
            torque = Said(abs(value) * slower.denominator / slower.numerator, at)
            signs.add(value > 0)
    return torque, speed, len(signs) < 2


def said_first(
    components: Sequence[Component], case: Case, name: str, type: str
) -> list[Component]:
    """Components of a type as a load case has them, where that says an attribute, and first."""
    here = [(c, case.get(c.id, c)) for c in components if c.type == type]
    said = [changed if changed.has(name) else c for c, changed in here]
    return sorted(said, key=lambda c: not c.place)


def _shares(model: Model, unit: Component | None) -> tuple[list[Any], Said | None]:
    """Shares of the load cases, where there are two or more, and the life."""
    if unit is None:
        return [], None
    life = unit.said(TIME)
    here = [case.get(unit.id) for case in model.cases]
    fractions = [c.said(SHARE) if c else None for c in here]
    hours = [h for c in here if c and (h := c.number(TIME)) is not None]
    total, timed = sum(hours, Decimal(0)), len(hours) == len(here) > 0
    if life is None and timed:
        life = Said(in_unit(total, "h"), model.cases[0][unit.id].at(TIME))
    if len(here) < 2:
        return [], life
    if None in fractions and timed and total:
        return [Said(in_unit(100 * h / total, "%"), unit.at(TIME)) for h in hours], life
    at = f"{unit}.{SHARE}"
    if None in fractions:
        case = f"load case {fractions.index(None) + 1}, "
        raise wrong(case + at, None, "is missing", "Write the share of each load case, in %")
    whole = sum((c.number(SHARE) or Decimal(0) for c in here if c), Decimal(0))
    if abs(whole - 100) > Decimal("1e-9"):
        raise wrong(at, f"{whole} %", "of all load cases is not 100 %", "Correct the shares")
    return fractions, life
