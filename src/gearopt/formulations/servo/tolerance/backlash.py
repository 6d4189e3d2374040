"""Tolerances of both signs with a minimum backlash: the offset that they need, as another stack.

The radial deviations of a mesh lie within +-t, and an offset c of its centre distance (or of its
tooth thickness) keeps j_min = 2 tan(alpha) (c - sum t) at the minimum backlash j. So
c = j/(2 tan alpha) + sum t, and j_max = j + 4 tan(alpha) sum t: the sensitivities of the radial
tolerances double, and the error of j itself comes off the budget.
"""

import math
from dataclasses import dataclass, replace

from gearopt.formulations.servo.tolerance.stack import UNIFORM, Component, Stack, offset
from gearopt.optimise.terms import Array


@dataclass(frozen=True)
class Mesh:
    """The radial tolerances of one mesh, by their places in the stack, from 0.

    backlash: minimum circumferential backlash j [mm] >= 0. pressure_angle [rad] at the pitch
    circles.
    """

    name: str
    components: tuple[int, ...]
    backlash: float
    pressure_angle: float


def bilateral(stack: Stack, meshes: tuple[Mesh, ...]) -> Stack:
    """Return the stack of tolerances +-t about offset meshes; its t are those of `offset_of`.

    Sensitivities s are those of one radial tolerance one-sided, 2 tan(alpha) times the error per mm
    of backlash. A distribution of the radial deviations is meant on [-t, t], UNIFORM too.
    ValueError for an rss budget, which knows no offset, for sensitivities that differ in a mesh,
    for a component of two meshes, and for budgets that the minimum backlashes use up.
    """
    if any(b.rule == "rss" for b in stack.budgets):
        raise ValueError("an rss budget leaves out the offset: use worst_case or mean_plus_sd")
    radial = [k for mesh in meshes for k in mesh.components]
    if len(set(radial)) < len(radial):
        raise ValueError("a radial tolerance belongs to one mesh, once")
    lost = math.fsum(_error(stack, mesh) for mesh in meshes)
    for budget in stack.budgets:
        if lost >= budget.error:
            raise ValueError(
                f"the minimum backlashes alone use {lost:.6g} of the {budget.error:.6g} of the "
                f"budget {budget.label}"
            )
    return Stack(
        tuple(_doubled(c) if k in radial else c for k, c in enumerate(stack.components)),
        tuple(replace(b, error=b.error - lost) for b in stack.budgets),
    )


def offset_of(mesh: Mesh, t: Array) -> float:
    """Return the offset c [mm] of a mesh at tolerances t [mm] of the stack."""
    inner = mesh.backlash / (2.0 * math.tan(mesh.pressure_angle))
    return inner + math.fsum(t[k] for k in mesh.components)


def _error(stack: Stack, mesh: Mesh) -> float:
    """Return the error of the minimum backlash of a mesh."""
    found = {stack.components[k].sensitivity for k in mesh.components}
    if len(found) != 1:
        raise ValueError(f"the radial tolerances of {mesh.name} have {len(found)} sensitivities")
    return mesh.backlash * found.pop() / (2.0 * math.tan(mesh.pressure_angle))


def _doubled(one: Component) -> Component:
    """Return twice the sensitivity; uniform on [-t, t] offset by t is uniform on [0, 2 t]."""
    law = one.distribution
    law = law if law is UNIFORM else offset(law)
    return replace(one, sensitivity=2.0 * one.sensitivity, distribution=law)
