"""The tables of a pair on moving axes: gears, mesh, and what is asked of its motion."""

from fractions import Fraction
from typing import Annotated

from pydantic import Field

from gearopt.physics.motion.kinematics import KINEMATICS
from gearopt.scenes.reading.fields import FOLLOWS, Table, choice, number, quantity, truth, whole
from gearopt.scenes.reading.linked_files import Input, result_of, takes_gears
from gearopt.scenes.reading.lists import several, span
from gearopt.units import Quantity

AXES = ("fixed", "line", "plane")
WAVES = ("constant", "rectangle", "trapezoid", "fourier", "pair")
DAMPING = ("in_contact", "always")
ERRORS = ("harmonics", "pair")
MOST_OUTPUTS = 20001
SHARE = number(0.03, 0, 1, percent=True, zero=True)
SPEEDS = span(quantity("speed", "1500 rpm"), ["1500 rpm", "6000 rpm"])


@takes_gears
class GearsTable(Table):
    """The pair, where another file has it: base circles, bodies, torque, speed and stiffness."""


class RotorTable(Table):
    """A gear on its bearings."""

    base_diameter: Annotated[Quantity, quantity("length", "120 mm"), FOLLOWS] = Field(
        description="Diameter of the base circle"
    )
    mass: Annotated[Quantity, quantity("mass", "0.6 kg"), FOLLOWS] = Field(
        description="Mass of the gear"
    )
    inertia: Annotated[Quantity, quantity("inertia", "0.002 kg m^2"), FOLLOWS] = Field(
        description="Moment of inertia about its axis"
    )
    torque: Annotated[Quantity | None, quantity("torque", "200 N m", zero=True, signed=True)] = (
        Field(
            None,
            description="Torque on the gear, positive counter-clockwise; of the wheel by default "
            "the one that balances the pinion's",
        )
    )
    bearing_stiffness: Annotated[Quantity, quantity("stiffness", "1000 N/mm")] = Field(
        description="Stiffness of its bearings along the line of centres, and across it, too, "
        "where nothing else is said"
    )
    bearing_stiffness_across: Annotated[Quantity | None, quantity("stiffness", "3000 N/mm")] = (
        Field(None, description="Stiffness of its bearings across the line of centres")
    )
    bearing_damping: Annotated[Fraction, SHARE] = Field(
        Fraction(0), description="Damping ratio of the gear's mass on its bearings"
    )


class MeshTable(Table):
    """How the teeth touch."""

    pressure_angle: Annotated[Quantity, quantity("angle", "20 deg", "45 deg"), FOLLOWS] = Field(
        description="Pressure angle of the unloaded pair"
    )
    kinematics: Annotated[str, choice(*KINEMATICS)] = Field(
        "exact", description="What displaced axes add to the deformation of the mesh"
    )
    axes: Annotated[str, choice(*AXES)] = Field(
        "plane", description="Where the axes may move: nowhere, along the line of action, anywhere"
    )
    wave: Annotated[str, choice(*WAVES)] = Field(
        "constant", description="Shape of the mesh stiffness over a period"
    )
    stiffness: Annotated[Quantity | None, quantity("stiffness", "200 kN/mm")] = Field(
        None,
        description="Mean mesh stiffness; of a constant wave by default the mean of that of `pair`",
    )
    depth: Annotated[Fraction | None, number(0.5, 0, Fraction(3, 2))] = Field(
        None, description="Rectangle or trapezoid: (maximum - minimum)/mean of the stiffness"
    )
    duty: Annotated[Fraction | None, number(0.68, 0, 1)] = Field(
        None, description="Rectangle or trapezoid: its mean, from 0 (one pair) to 1 (two pairs)"
    )
    ramp: Annotated[Fraction | None, number(0.1, 0, Fraction(1, 2))] = Field(
        None, description="Trapezoid: share of the period in which the stiffness rises"
    )
    cosines: Annotated[
        tuple[Quantity, ...],
        several(quantity("stiffness", "20 kN/mm", signed=True), ["20 kN/mm"], in_order=True),
    ] = Field((), description="Fourier series: amplitudes of the cosines")
    sines: Annotated[
        tuple[Quantity, ...],
        several(quantity("stiffness", "20 kN/mm", signed=True), ["20 kN/mm"], in_order=True),
    ] = Field((), description="Fourier series: amplitudes of the sines")
    pair: Annotated[Input | None, result_of("pair")] = Field(
        None,
        description="File of kind pair, or its kept result, whose teeth give the stiffness, the "
        "transmission error, or both",
    )
    transmission_error: Annotated[str, choice(*ERRORS)] = Field(
        "harmonics",
        description="Transmission error that excites the mesh: that of its harmonics below, or "
        "that of the file of kind pair, and those besides",
    )
    error_cosines: Annotated[
        tuple[Quantity, ...],
        several(quantity("length", "2 um", signed=True), ["2 um"], in_order=True),
    ] = Field((), description="Transmission error: amplitudes of its cosines")
    error_sines: Annotated[
        tuple[Quantity, ...],
        several(quantity("length", "2 um", signed=True), ["2 um"], in_order=True),
    ] = Field((), description="Transmission error: amplitudes of its sines")
    damping: Annotated[Fraction, SHARE] = Field(
        Fraction(0), description="Damping ratio of the mesh on both inertias"
    )
    damping_acts: Annotated[str, choice(*DAMPING)] = Field(
        "in_contact",
        description="When the mesh damps: while teeth are in contact, or always, also while they "
        "are apart, as Kahraman and Singh have it",
    )
    backlash: Annotated[Quantity | None, quantity("length", "0.1 mm", zero=True)] = Field(
        None,
        description="Backlash along the line of action: teeth may part. Without it the mesh is a "
        "spring that also pulls, and separation is only reported",
    )
    teeth: Annotated[int, whole(30, 5, 2000), FOLLOWS] = Field(description="Teeth of the pinion")
    face_width: Annotated[Quantity | None, quantity("length", "20 mm")] = Field(
        None, description="Face width, for K_v of ISO 6336 and AGMA; by default that of `pair`"
    )
    accuracy_grade: Annotated[int | None, whole(6, 0, 12, scale=True)] = Field(
        None,
        description="Accuracy grade of ISO 1328-1 of both gears, for K_v of ISO 6336 and AGMA; "
        "with `from` the coarser one of the rating by ISO 6336",
    )
    speed: Annotated[Quantity | None, quantity("speed", "2000 rpm")] = Field(
        None, description="Speed of the pinion, which sets the mesh frequency"
    )


class SimulateTable(Table):
    """The motion in time."""

    duration: Annotated[Quantity, quantity("time", "20 ms", "1000 s")] = Field(
        description="Duration of the motion"
    )
    outputs: Annotated[int, whole(2001, 11, MOST_OUTPUTS)] = Field(
        2001, description="Number of equally spaced output times"
    )
    error: Annotated[Fraction, number(1e-6, 0, Fraction(1, 10))] = Field(
        Fraction(1, 10**6),
        description="Permissible error of the deformation, relative to its largest value",
        json_schema_extra={"default": 1e-6},
    )
    start: Annotated[str, choice("rest", "equilibrium")] = Field(
        "rest", description="Unloaded and at rest, or at rest under the load"
    )


class StabilityTable(Table):
    """The map of stability."""

    mesh_frequency: Annotated[
        tuple[Quantity, Quantity], span(quantity("frequency", "500 Hz"), ["500 Hz", "14 kHz"])
    ] = Field(description="Range of mesh frequencies")
    depth: Annotated[
        tuple[Fraction, Fraction], span(number(0.05, 0, Fraction(3, 2)), [0.05, 0.75])
    ] = Field(
        (Fraction(1, 20), Fraction(3, 4)),
        description="Range of depths of the wave",
        json_schema_extra={"default": [0.05, 0.75]},
    )
    frequencies: Annotated[int, whole(271, 2, 2000)] = Field(
        271, description="Mesh frequencies of the map"
    )
    depths: Annotated[int, whole(15, 2, 200)] = Field(15, description="Depths of the map")


class SpeedsTable(Table):
    """Periodic motions over a range of speeds."""

    range: Annotated[tuple[Quantity, Quantity], SPEEDS] = Field(
        description="Range of speeds of the pinion"
    )
    points: Annotated[int, whole(91, 2, 1000)] = Field(
        91, description="Number of equally spaced speeds"
    )
    harmonics: Annotated[int, whole(20, 1, 100)] = Field(
        20,
        description="Minimum number of harmonics of the mesh frequency in a motion: more where "
        "natural modes need them",
    )


class OptimiseTable(Table):
    """The pair of least vibration over a range of speeds; ranges are [minimum, maximum]."""

    speeds: Annotated[tuple[Quantity, Quantity], SPEEDS] = Field(
        description="Speeds of the pinion over which the vibration is judged"
    )
    points: Annotated[int, whole(16, 2, 200)] = Field(
        16, description="Initial number of equally spaced speeds"
    )
    harmonics: Annotated[int, whole(10, 2, 30)] = Field(
        10, description="Initial number of harmonics of a motion"
    )
    minimise: Annotated[str, choice("rms", "peak_to_peak")] = Field(
        "rms", description="Vibration: RMS of the deformation about its mean, or peak to peak"
    )
    exchange: Annotated[bool, truth()] = Field(
        True, description="Whether speeds are added until the dense grid agrees"
    )
    elements: Annotated[int, whole(24, 8, 200)] = Field(
        24, description="Collocation elements per mesh period, for motions with backlash"
    )
    periods: Annotated[int, whole(1, 1, 8)] = Field(
        1, description="Maximum period of motions with backlash, in mesh periods"
    )
    bearing_stiffness: Annotated[
        tuple[Quantity, Quantity],
        span(quantity("stiffness", "30 kN/mm"), ["30 kN/mm", "500 kN/mm"]),
    ] = Field(description="Stiffness of every bearing, alike in both directions")
    contact_ratio: Annotated[
        tuple[Fraction, Fraction], span(number(1.25, 1, Fraction(199, 100)), [1.25, 1.95])
    ] = Field(description="Transverse contact ratio")
    ramp: Annotated[
        tuple[Fraction, Fraction], span(number(0.02, 0, Fraction(1, 2)), [0.02, 0.25])
    ] = Field(description="Ramp of the stiffness, over the period")
    face_width: Annotated[
        tuple[Quantity, Quantity], span(quantity("length", "8 mm"), ["8 mm", "25 mm"])
    ] = Field(description="Face width")
    rim: Annotated[tuple[Fraction, Fraction], span(number(0.6, 0, 10), [0.6, 1.4])] = Field(
        description="Ratio of mass and inertia of both gears to those of solid discs"
    )
    density: Annotated[Quantity, quantity("density", "7850 kg/m^3")] = Field(
        description="Density of the gears"
    )
    single_stiffness: Annotated[Quantity, quantity("stress", "13591 MPa")] = Field(
        description="Stiffness c' of one pair of teeth, per face width"
    )
    mass: Annotated[Quantity, quantity("mass", "2 kg")] = Field(
        description="Maximum mass of both gears"
    )
    displacement: Annotated[Quantity, quantity("length", "40 um")] = Field(
        description="Maximum displacement of an axis under the mean load"
    )
    multiplier: Annotated[Fraction | None, number(0.98, 0, 1)] = Field(
        None,
        description="Maximum of the largest Floquet multiplier over all speeds: designs that "
        "exceed it are left out",
    )
    margin: Annotated[Quantity | None, quantity("length", "1 um", zero=True)] = Field(
        None, description="Minimum compression of the mesh, so that teeth never separate"
    )
