"""Servo axes: ratio, train, box, errors, tolerances and stiffness."""

from gearopt.optimise.result import Result
from gearopt.report.kinds import Kind
from gearopt.report.kinds.generic import ASKED, FIRST, LAST, TOLD
from gearopt.report.measures import Measures
from gearopt.report.pages import outcome
from gearopt.report.pages.servo import (
    beside,
    box,
    drawn,
    errors,
    ratio,
    stiffness,
    tolerances,
    train,
    trains,
)
from gearopt.report.pages.servo.tiles import tiles
from gearopt.report.result_words import goal
from gearopt.report.section import Section, Tile
from gearopt.report.terminal import servo


def key_figures(result: Result, measures: Measures) -> list[Tile]:
    """Of ratio, train, stiffness, tolerances and box."""
    return tiles(result.design, goal(result)[0], measures)


def on_terminal(result: Result, measures: Measures) -> Section | None:
    """The design as the terminal shows it."""
    if result.value is None:
        return None
    return Section("", terminal=servo.design(result, measures))


KIND = Kind(
    sections=(
        *FIRST,
        ratio.section,
        train.section,
        box.section,
        beside.section,
        beside.stage_counts,
        trains.by_inertia,
        trains.by_mass,
        errors.section,
        tolerances.section,
        drawn.section,
        stiffness.section,
        *ASKED,
        *LAST,
    ),
    terminal=(on_terminal, outcome.limits, *TOLD),
    tiles=key_figures,
)
