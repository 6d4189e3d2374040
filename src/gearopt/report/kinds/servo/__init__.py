"""Servo axes: ratio, train, box, errors, tolerances and stiffness."""

from gearopt.formulations.servo.servo_design import GOALS, RatioDesign, TrainDesign
from gearopt.optimise.result import Result
from gearopt.report import answer
from gearopt.report.headline import PROVEN
from gearopt.report.kinds import MakeSection, Pages
from gearopt.report.kinds.generic import AFTER_DESIGN, CLOSING, OPENING, REQUEST
from gearopt.report.kinds.servo import accuracy as axis_accuracy
from gearopt.report.kinds.servo import gearhead as axis_gearhead
from gearopt.report.kinds.servo import housing as axis_housing
from gearopt.report.kinds.servo import motion as axis_motion
from gearopt.report.kinds.servo import trains as axis_trains
from gearopt.report.kinds.servo.words import aged, arc_minutes, degrees, design_of, report_of
from gearopt.report.measures import METRIC, Measures, error_of
from gearopt.report.section import Section, Tile
from gearopt.report.words import REACHED, amount, goal, number

OBJECTIVE_TIE = 1e-6  # relative: objectives that are equal
FULL_TORQUE = "motor_torque"  # used up wherever an acceleration is largest


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """Reason beside the limits: a box, or the inertias of motor and load."""
    design = design_of(result)
    if _costs(result):
        return f"the box determines the {goal(result)[0]}: without it there is a better train"
    full = [n for n, u in result.limits.items() if u >= 1.0 - REACHED and n != FULL_TORQUE]
    if design.train is not None or design.ratio is None or full or result.value is None:
        return ""
    return (
        "the inertias of motor and load determine the total ratio; no limit of the motor is active"
    )


def _costs(result: Result) -> bool:
    """Whether a train that leaves the box aside is better than the proven answer.

    The Pareto front keeps all limits but the box, and so has the best of these trains.
    """
    asked = GOALS.get(str(result.objective.get("name")))
    if result.status not in PROVEN or design_of(result).box is None or asked is None:
        return False
    best = [t for t in report_of(result).trains or () if t.best_of == asked.label]
    reached, there = goal(result)[2], getattr(best[0], asked.key) if best else None
    return bool(reached and there and abs(there - reached) > OBJECTIVE_TIE * abs(reached))


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Key figures beside the objective."""
    design, name = design_of(result), goal(result)[0]
    figures = []
    if design.ratio is not None:
        figures += _ratio(design.ratio, name, measures)
    if design.train is not None:
        figures += _train(design.train, name, aged(design), measures)
    if (chain := design.stiffness) is not None:
        stiff, frequency = amount(chain.output_Nm_per_rad, "Nm_per_rad", measures), ""
        if chain.frequency_Hz is not None:
            frequency = f"natural frequency {number(chain.frequency_Hz)} Hz, motor locked"
        figures.append(Tile("stiffness at the output", stiff, frequency))
    if (cost := design.allocation) is not None and name != "cost":
        figures.append(Tile("cost of tolerances", number(cost.cost)))
    if (drawn := design.drawn) is not None:
        good = f"{100.0 * drawn.yield_share:.4g} %"
        figures.append(Tile("yield", good, f"of {drawn.count:,} Monte Carlo trains"))
        worst, remark = degrees(drawn.worst_case_deg), arc_minutes(drawn.worst_case_deg)
        if worst not in {degrees(drawn.limit_deg), *(tile.value for tile in figures)}:
            remark += ", all at their limits at once"
            figures.append(Tile("worst-case error, new tolerances", worst, remark))
    return figures


def _ratio(ratio: RatioDesign, name: str, measures: Measures) -> list[Tile]:
    """Value of the chosen train, unless that is the objective, and the best ratio."""
    figures, chosen = [], ratio.chosen
    if chosen is not None and not ratio.name.endswith(name):
        worse = f"{chosen.loss_percent:.3g} % worse than at the best ratio without gears"
        value = amount(chosen.value, ratio.unit, measures)
        figures.append(Tile(f"{ratio.name} of the train", value, worse))
    without = "without the inertia of gears" if chosen is not None else ""
    return [*figures, Tile("best total ratio", number(ratio.total_ratio), without)]


def _train(train: TrainDesign, name: str, of: str, measures: Measures) -> list[Tile]:
    """Figures of a train; of: its tolerances, in words."""
    error, angle = train.ratio_error_percent, train.error_deg
    off = "" if error is None else f", {error_of(error)}"
    teeth = " · ".join(f"{s.wheel_teeth}/{s.pinion_teeth}" for s in train.stages)
    figures = [Tile("ratio of the train", number(train.ratio), f"{teeth}{off}")]
    if name != "error" and angle is not None:
        figures.append(Tile("error at the output", degrees(angle), f"{arc_minutes(angle)}{of}"))
    if name != "inertia" and train.inertia_kg_m2 is not None:
        inertia = amount(train.inertia_kg_m2, "kg_m2", measures)
        figures.append(Tile("inertia at the motor", inertia))
    if name != "mass" and train.mass_kg is not None:
        figures.append(Tile("mass of the gears", amount(train.mass_kg, "kg", measures)))
    return figures


def _answered(make: MakeSection) -> MakeSection:
    """A section that is shown of an answer only."""

    def made(result: Result, measures: Measures) -> Section | None:
        return None if result.value is None else make(result, measures)

    return made


PAGES = Pages(
    whole="axis",
    sections=(
        *OPENING,
        axis_motion.section,
        axis_gearhead.section,
        axis_trains.section,
        axis_housing.box,
        axis_trains.compared_with_given,
        axis_trains.stage_counts,
        axis_trains.by_inertia,
        axis_trains.by_mass,
        axis_accuracy.errors,
        axis_accuracy.tolerances,
        axis_accuracy.drawn,
        axis_housing.stiffness,
        *REQUEST,
        *CLOSING,
    ),
    terminal=(
        _answered(axis_motion.section),
        _answered(axis_gearhead.section),
        _answered(axis_trains.section),
        _answered(axis_trains.best),
        _answered(axis_trains.compared_with_given),
        _answered(axis_trains.stage_counts),
        _answered(axis_accuracy.errors),
        _answered(axis_accuracy.tolerances),
        _answered(axis_accuracy.drawn),
        _answered(axis_housing.stiffness),
        _answered(axis_housing.box),
        answer.limits,
        *AFTER_DESIGN,
    ),
    tiles=tiles,
    binding_limit=binding_limit,
)
