"""Duty, load spectrum and life of a REXS model, carried to the input shaft without losses."""

import math
from collections.abc import Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any

from gearopt.scenes.drive.rexs.gears_read import Keys
from gearopt.scenes.drive.rexs.model import Component, Model, Said, in_unit, wrong

TORQUE, SPEED = "torque_around_u_axis", "rotational_speed"
KW = 30000.0 / math.pi  # N m/min in a kilowatt


def loads(
    model: Model,
    bodies: Mapping[int, int],
    shafts: Mapping[int, Fraction],
    unit: Component | None,
    remarks: list[str],
) -> Keys:
    """Duty, life and load spectrum; shafts: speed of the input over theirs."""
    torque, speed, _ = _duty(model, {}, bodies, shafts)
    cases = [_duty(model, case, bodies, shafts) for case in model.cases]
    for k, (t, n, _) in enumerate(cases, 1):
        if t is None or n is None:
            name, what = (TORQUE, "torque") if t is None else (SPEED, "speed")
            rule = f"has no {what} of input or output shaft"
            raise wrong(f"load case {k}", None, rule, f"Write {name} of a shaft or its load")
    if len({enters for *_, enters in cases}) > 1:
        remarks.append(
            "torque changes its sign between load cases: amounts are taken; write reversed_load = "
            "true at gears whose teeth are bent both ways"
        )
    if (torque is None or speed is None) and cases:
        torque, speed, _ = max(cases, key=lambda c: float(c[0].value if c[0] else 0))
    duty = {
        "torque": _with(torque, "N m") or Said("100 N m", "", True),
        "input_speed": _with(speed, "1 / min") or Said("1000 rpm", "", True),
    }
    shares, life = _shares(model, unit)
    levels = []
    for (t, n, _), share in zip(cases, shares if len(cases) > 1 else [], strict=False):
        assert t is not None and n is not None
        power = Said(in_unit(float(t.value) * float(n.value) / KW, "kW"), t.origin)
        levels.append({"power": power, "input_speed": _with(n, "1 / min"), "share": share})
    return {"duty": duty, "load": levels, "life": life}


def _with(said: Said | None, unit: str) -> Said | None:
    return None if said is None else Said(in_unit(said.value, unit), said.origin)


def _duty(
    model: Model,
    case: Mapping[int, Component],
    bodies: Mapping[int, int],
    shafts: Mapping[int, Fraction],
) -> tuple[Said | None, Said | None, bool]:
    """Torque [N m] and speed [1/min] of the input shaft, by whatever shaft they are said of.

    A load case says what changes. The last value: whether both have one sign.
    """
    speed = torque = None
    signs = []
    for c in changed_first(model.of_type("shaft"), case, SPEED):
        here = says(c, case, SPEED)
        if bodies[c.id] not in shafts:
            continue
        if speed is None and (n := here.number(SPEED)):
            speed = Said(_times(abs(n), shafts[bodies[c.id]]), here.at(SPEED))
            signs.append(n > 0)
    ends = (next(iter(shafts)), [*shafts][-1])
    for c in changed_first(model.of_type("external_load"), case, TORQUE):
        if bodies[c.id] not in shafts:
            continue
        here, power = says(c, case, TORQUE), says(c, case, "power").number("power")
        slower, value = shafts[bodies[c.id]], here.number(TORQUE)
        if not value and power and speed is not None:
            value, slower = Decimal(repr(float(power) * KW / float(speed.value))), Fraction(1)
            here = says(c, case, "power")
        if torque is None and value:
            if bodies[c.id] not in ends:
                rule = "acts between two stages, and a drive has one input and one output"
                raise wrong(here.at(TORQUE), str(value), rule, "Remove it")
            torque = Said(_times(abs(value), 1 / slower), here.at(TORQUE))
            signs.append(value > 0)
    return torque, speed, len(set(signs)) < 2


def changed_first(
    components: Sequence[Component], case: Mapping[int, Component], name: str
) -> list[Component]:
    """Components, first those of which a load case says an attribute."""
    return sorted(components, key=lambda c: says(c, case, name) is c)


def says(component: Component, case: Mapping[int, Component], name: str) -> Component:
    """The component as a load case has it, where that says an attribute."""
    here = case.get(component.id, component)
    return here if here.has(name) else component


def _times(value: Decimal, ratio: Fraction) -> Decimal:
    """A number times a ratio, to 28 digits."""
    return value * ratio.numerator / ratio.denominator


def _shares(model: Model, unit: Component | None) -> tuple[list[Any], Said | None]:
    """Shares of the load cases, and the life."""
    if unit is None:
        return [], None
    life = unit.said("operating_time")
    fractions, hours = [], []
    for case in model.cases:
        here = case.get(unit.id)
        fractions.append(here.said("operating_time_fraction") if here else None)
        hours.append(here.number("operating_time") if here else None)
    known = [h for h in hours if h is not None]
    if life is None and known and len(known) == len(hours):
        life = Said(
            in_unit(sum(known, Decimal(0)), "h"), model.cases[0][unit.id].at("operating_time")
        )
    if len(model.cases) < 2:
        return fractions, life
    if None in fractions and len(known) == len(hours):
        total = sum(known, Decimal(0))
        return [Said(in_unit(100 * h / total, "%"), unit.at("operating_time")) for h in known], life
    for k, share in enumerate(fractions, 1):
        if share is None:
            at = f"load case {k}, {unit}.operating_time_fraction"
            raise wrong(at, None, "is missing", "Write the share of each load case, in %")
    total = sum((Decimal(share.value.split()[0]) for share in fractions if share), Decimal(0))
    if abs(total - 100) > Decimal("1e-9"):
        at = f"{unit}.operating_time_fraction"
        raise wrong(at, f"{total} %", "of all load cases is not 100 %", "Correct the shares")
    return fractions, life
