"""Warnings that precede the numbers of the motion of a pair."""

import math
from collections.abc import Iterator, Sequence

from gearopt.formulations.dynamics.design import OUT_OF_MESH, DynamicsDesign, Response, Speeds
from gearopt.formulations.dynamics.motion.stability import UNSTABLE
from gearopt.formulations.dynamics.motions_over_speed import ranges
from gearopt.formulations.dynamics.orbit.task import MICRO
from gearopt.formulations.dynamics.standard_factors import Toothing
from gearopt.formulations.dynamics.steady_motion import MOST_PERIODS
from gearopt.scenes.dynamics.tables import MOST_OUTPUTS

APART = 0.1  # modules by which axes part or teeth give way without changing the stiffness much
CLEARANCE = 0.25  # modules between tips and roots (ISO 53)
SETTLED = 0.02  # of the peak to peak of its last quarter by which a motion may still fall
OUTPUTS_PER_PERIOD = 10.0  # times in a period of the fastest motion at which it is told, at least


def warnings(design: DynamicsDesign, module: float, teeth: Toothing) -> list[str]:
    """Return warnings: unstable, parting or jammed motions, limits of the model, of the time.

    First of all whether the teeth leave mesh. module [mm]: of the teeth.
    """
    sentences, stability = _out_of_range(design, module, teeth), design.stability
    if design.response is not None:
        sentences += _of_response(design.response, design)
    if stability is not None and stability.here is not None and stability.here > 1.0 + UNSTABLE:
        held = "Its motion grows without end."
        if stability.limited_rms_mm is not None:
            limit = MICRO * stability.limited_rms_mm
            held = f"Teeth part, which limits the motion to an RMS of {limit:.3g} µm."
        sentences.append(
            f"The pair is unstable at its speed: the largest Floquet multiplier is "
            f"{stability.here:.4f} a mesh period. {held}"
        )
    if design.speeds is not None:
        sentences += _of_speeds(design.speeds)
    return sentences


def _out_of_range(design: DynamicsDesign, module: float, teeth: Toothing) -> list[str]:
    """Return where axes or teeth move so far that the stiffness of the file is not theirs."""
    rest, moved, sentences = design.equilibrium, design.response, list[str]()
    growths, pressed = [rest.centre_distance_growth_mm], [rest.deformation_mm]
    apart = rest.centre_distance_mm - rest.centre_distance_growth_mm
    if moved is not None:
        pressed += moved.deformation_mm
        if moved.axes_mm:
            growths += (
                math.hypot(apart + x2 - x1, y2 - y1) - apart
                for x1, y1, x2, y2 in zip(*moved.axes_mm, strict=True)
            )
    most, least, deep = max(growths) / module, -min(growths) / module, -min(pressed) / module
    far = f"axes move apart by up to {most * module:.3g} mm, {most:.3g} modules"
    left = teeth.apart(apart, most * module)
    if left < 1.0 <= teeth.contact_ratio:
        sentences.append(_out_of_mesh(far, teeth, left))
    elif most > APART:
        sentences.append(
            f"The {far}: the contact ratio falls to {left:.3g}, and with it the stiffness; the "
            f"model keeps both as at rest. It holds up to about {APART:g} modules."
        )
    if least > CLEARANCE:
        sentences.append(
            f"The axes come together by up to {least * module:.3g} mm, {least:.3g} modules: tips "
            f"touch roots from some {CLEARANCE:g} modules on, which the model neglects."
        )
    if deep > APART:
        sentences.append(
            f"The mesh deforms by up to {deep * module:.3g} mm, {deep:.3g} modules: teeth would "
            "break long before, and their stiffness is that of small deformations."
        )
    return sentences


def _out_of_mesh(far: str, teeth: Toothing, left: float) -> str:
    """Say that teeth leave mesh."""
    where = ", below 1, so that a pair of teeth parts before the next one touches"
    if left <= 0.0:
        where = ", so that none touch"
    return (
        f"{OUT_OF_MESH}: the {far}, where the contact ratio is {max(left, 0.0):.3g}{where}; it is "
        f"{teeth.contact_ratio:.3g} where the axes do not move. The model neglects this, and its "
        "numbers mean nothing from there on."
    )


def _of_response(response: Response, design: DynamicsDesign) -> list[str]:
    sentences = _too_few(response.time_ms, design)
    if response.error > response.error_asked:
        sentences.append(
            f"The error asked, {response.error_asked:.1e}, was not reached: the estimate is "
            f"{response.error:.1e}."
        )
    if response.steady_ms is not None:
        sentences.append(
            "Every impact of the teeth enlarges small differences: from "
            f"{response.steady_ms:.4g} ms on rounding alone causes more than the error asked, "
            "however short the steps. Until then the motion is known to that error; afterwards "
            "rely on the RMS and the spectrum, not on single peaks."
        )
    if response.jammed_ms is not None:
        sentences.append(
            f"The axes come together until the backlash is used up, first at "
            f"{response.jammed_ms:.4g} ms: both flanks are pressed at once, where the model of one "
            "flank at a time does not hold. The motion is wrong from there on."
        )
    if response.highest_mm > 0.0 and response.separations == 0:
        sentences.append(
            f"The deformation rises to {MICRO * response.highest_mm:.3g} µm: teeth would part "
            "there, and a mesh without backlash pulls instead."
        )
    return [*sentences, *_settling(response)]


def _settling(response: Response) -> Iterator[str]:
    """Yield that the start of a motion still counts in its second half."""
    quarter = max(1, len(response.deformation_mm) // 4)
    values = response.deformation_mm[-2 * quarter :]
    third, last = (max(part) - min(part) for part in (values[:quarter], values[quarter:]))
    if response.steady_ms is None and third > (1.0 + SETTLED) * last:
        yield (
            f"The motion still settles: the deformation varies by {MICRO * third:.4g} µm in the "
            f"third quarter of the time and by {MICRO * last:.4g} µm in the last. Numbers of the "
            'second half count the start: take a longer duration, or start = "equilibrium".'
        )


def _too_few(times_ms: Sequence[float], design: DynamicsDesign) -> list[str]:
    """Return a warning where a motion is stated at too few times to show its peaks."""
    fastest = max(design.mesh_frequency_Hz, design.equilibrium.frequencies_Hz[-1])
    duration = 1e-3 * (times_ms[-1] - times_ms[0])
    needed = math.ceil(OUTPUTS_PER_PERIOD * fastest * duration) + 1
    if len(times_ms) >= needed:
        return []
    most = MOST_OUTPUTS / (OUTPUTS_PER_PERIOD * fastest)
    change = f"outputs = {needed}" if needed <= MOST_OUTPUTS else f"at most {1e3 * most:.3g} ms"
    return [
        f"The motion is given at {len(times_ms):,} times, {len(times_ms) / fastest / duration:.2g} "
        f"in a period of {fastest:,.0f} Hz: peaks, RMS and spectrum may miss what lies between. "
        f"Take {change}."
    ]


def _of_speeds(speeds: Speeds) -> list[str]:
    """Return where motions over speed are unstable, part, jam, or take more than a period."""
    sentences, unstable = list[str](), [g > 1.0 + UNSTABLE for g in speeds.growth]
    falling = speeds.falling_rms_mm or speeds.rms_mm
    endless = [None in both for both in zip(speeds.rms_mm, falling, strict=True)]
    limited = [u and not e for u, e in zip(unstable, endless, strict=True)]
    if any(endless):
        sentences.append(
            f"At {ranges(speeds.speed_rpm, endless)} the pair is unstable: its motion grows "
            "without limit, so that there is no amplitude."
        )
    if any(limited):
        sentences.append(
            f"At {ranges(speeds.speed_rpm, limited)} contact is unstable: teeth part, "
            "which limits the amplitude."
        )
    pulls = [h is not None and h > 0.0 for h in speeds.highest_mm]
    if any(pulls) and not speeds.teeth_part:
        sentences.append(
            f"At {ranges(speeds.speed_rpm, pulls)} the deformation rises above zero: teeth would "
            "part there, and a mesh without backlash pulls instead."
        )
    ways = {"rising": speeds.repeats, "falling": speeds.falling_repeats}
    if speeds.repeats == speeds.falling_repeats:
        ways = {"rising or falling": speeds.repeats}
    for way, repeats in ways.items():
        for count in sorted(set(repeats) - {1}, reverse=True):
            where = ranges(speeds.speed_rpm, [r == count for r in repeats])
            takes = (
                f"repeats only after {count}" if count else f"does not repeat within {MOST_PERIODS}"
            )
            sentences.append(f"With {way} speed the motion {takes} periods of the mesh at {where}.")
    if speeds.jammed_rpm:
        jammed = [n in speeds.jammed_rpm for n in speeds.speed_rpm]
        sentences.append(
            f"At {ranges(speeds.speed_rpm, jammed)} the axes come together until the backlash is "
            "used up: both flanks are pressed at once, where the model of one flank at a time does "
            "not hold."
        )
    return sentences
