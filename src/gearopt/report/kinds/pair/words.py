"""Answers to an engineer's questions on a pair's contact, in sentences."""

import math
from collections.abc import Sequence
from typing import TypeVar

from gearopt.formulations.pair.design import ContactLoad, LoadedMesh, PairContact
from gearopt.physics.gears import GearPair
from gearopt.physics.iso6336.accuracy import deviations
from gearopt.physics.mesh_cycle import NARROW
from gearopt.physics.tooth.measured import PAIRS, Errors
from gearopt.physics.tooth.validity import EXACT
from gearopt.report.measures import METRIC, Measures, rounded
from gearopt.report.words import micrometres, share

Load = TypeVar("Load", bound=LoadedMesh)
ALWAYS = {2: "two", 3: "three"}  # pairs, by the whole part of the contact ratio


def of_duty(loads: Sequence[Load]) -> Load:
    """Contact at the torque of the duty, else at the largest load."""
    return next((load for load in loads if load.load == 1.0), max(loads, key=lambda it: it.load))


def answers(
    contact: PairContact,
    pair: GearPair | None = None,
    frequency: float | None = None,
    relieved: bool = False,
    measures: Measures = METRIC,
) -> list[str]:
    """Passing of the load, evenness of the motion, a change to try, and how sure that all is.

    pair: its gears, of whole teeth. frequency: of the mesh [Hz]. relieved: the gears have relief,
    which is told elsewhere; the contact told here is without it.
    """
    load = of_duty(contact.loads)
    even = _even(contact, load, frequency, measures)
    if pair is not None and (alike := graded(pair, load.peak_to_peak_mm)):
        even = f"{even} {alike}"
    first = ["The results here are those of the gears without relief."] if relieved else []
    change = [] if relieved or not load.normal_force_N else [_changed(contact, measures)]
    return [*first, _shared(contact, load), even, *change, _stiff(contact, load), _sure(contact)]


def graded(pair: GearPair, error: float) -> str:
    """Accuracy grade that a peak-to-peak transmission error [mm] compares with; "" for none.

    The form deviation of a profile doubles with two grades of ISO 1328-1 (1995).
    """
    if error <= 0.0:
        return ""
    middle = float(deviations(pair, (5.0, 5.0), smooth=True).profile_form)
    grade = 5.0 + 2.0 * math.log2(error / middle)
    alike = f"about the profile form tolerance of accuracy grade {grade:.0f} of ISO 1328-1"
    if grade < 0.5:
        alike = "below the profile form tolerance of every accuracy grade of ISO 1328-1"
    elif grade > 12.5:
        alike = "above the profile form tolerance of every accuracy grade of ISO 1328-1"
    return (
        f"The peak-to-peak value is {alike}: in coarser gears manufacturing errors matter more, "
        "in finer ones the load."
    )


def _changed(contact: PairContact, measures: Measures) -> str:
    """Relief by rule, and its effect."""
    first, second = (micrometres(each, measures) for each in contact.rule_relief_mm)
    return (
        f"Tip relief of about {first} on the pinion and {second} on the wheel would "
        "let every pair of teeth enter and leave contact without load at the torque of [duty]. A "
        "table [relief] finds the best amounts for several loads."
    )


def _shared(contact: PairContact, load: ContactLoad) -> str:
    """Say how much one pair of teeth carries and where."""
    first, last = load.share[0], load.share[-1]
    ends = (
        f"comes into contact with {share(first)} % of the load and leaves it with {share(last)} %"
    )
    if not load.normal_force_N:
        return "Without load no pair of teeth carries anything."
    alone = 2.0 - contact.contact_ratio
    if alone <= NARROW:
        least = ALWAYS.get(int(contact.contact_ratio + NARROW), "several")
        most = f"at most {share(load.largest_share)} % of the load"
        return f"One pair of teeth carries {most}, as {least} pairs always touch; it {ends}."
    length = rounded(alone * contact.base_pitch_mm, 3)
    return (
        f"One pair of teeth carries the whole load, {rounded(load.normal_force_N, 4)} N, over "
        f"{length} mm of its path ({share(alone / contact.contact_ratio)} %); a pair {ends}."
    )


def _even(
    contact: PairContact, load: ContactLoad, frequency: float | None, measures: Measures
) -> str:
    """Say how much the transmission error varies."""
    each = [
        f"{micrometres(it.peak_to_peak_mm, measures)} at {100.0 * it.load:g} % of the torque"
        for it in contact.loads
        if it.load
    ]
    if not each:
        return "Without load the transmission error does not vary."
    of = f" of {rounded(frequency, 3)} Hz" if frequency else ""
    return (
        f"The transmission error varies by {', '.join(each)}, peak to peak. Its first harmonic, at "
        f"the mesh frequency{of}, has an amplitude of "
        f"{micrometres(load.harmonics_mm[0], measures)} at {100.0 * load.load:g} %."
    )


def _stiff(contact: PairContact, load: ContactLoad) -> str:
    """Say how the mesh stiffness compares with ISO 6336-1."""
    if not load.mean_mesh_stiffness_MPa:
        return "Without load there is no mesh stiffness."
    off = 100.0 * (load.mean_mesh_stiffness_MPa / contact.iso_mesh_stiffness_MPa - 1.0)
    return (
        f"The mean mesh stiffness is {rounded(abs(off), 2)} % {'above' if off > 0 else 'below'} "
        "c_γα of ISO 6336-1, which does not depend on the bores."
    )


def _sure(contact: PairContact) -> str:
    """Say how wrong stiffness and transmission error may be."""
    if contact.level == contact.coupling == EXACT:
        return (
            "Accuracy: teeth and coupling are by finite elements, the finest models; elements of "
            "half the size change a stiffness by up to 0.1 %, a peak to peak by 0.2 %."
        )
    low, high = contact.error_percent
    stiff = (
        f"Accuracy: for 34 pairs of steel gears the stiffness by {contact.level} was "
        f"{between(low, high)} that by finite elements"
    )
    name = {
        "none": "without coupling of neighbouring teeth",
        "given": "with the coupling that the file gives",
    }.get(contact.coupling, f"with neighbouring teeth coupled by {contact.coupling}")
    if contact.in_mesh is None:
        return f"{stiff}. Of the transmission error {name} no error has been measured here."
    return f"{stiff}. The peak-to-peak transmission error {name}, {off_in_mesh(contact.in_mesh)}."


def off_in_mesh(known: Errors) -> str:
    """How far the peak-to-peak transmission error by a model was off, in words."""
    least, _, most = known.peak_to_peak
    off = between(100.0 * least, 100.0 * most)
    return f"measured on {PAIRS} random pairs: {off} finite elements"


def between(low: float, high: float) -> str:
    """Two errors in per cent in words."""
    near, far = (rounded(value, 2 if value < 100.0 else 3) for value in (abs(low), abs(high)))
    if low < 0.0 < high:
        return f"{near} % below to {far} % above"
    near, far = (near, far) if low >= 0.0 else (far, near)
    way = "above" if low >= 0.0 else "below"
    return f"{near} to {far} % {way}"
