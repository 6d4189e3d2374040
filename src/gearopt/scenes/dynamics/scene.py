"""A file of a pair on moving axes as a whole: the pair that it describes, and what must fit."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import zip_longest

from pydantic import model_validator

from gearopt.formulations.dynamics.orbit.task import Task
from gearopt.formulations.dynamics.standard_factors import Toothing
from gearopt.physics.gears import GearPair, Rack
from gearopt.physics.geometry.contact import contact_path
from gearopt.physics.motion.linear import static
from gearopt.physics.motion.moving_pair import MovingPair, Rotor, damping_of
from gearopt.physics.motion.stiffness_wave import Wave, constant, fourier, trapezoid
from gearopt.scenes.dynamics.handed_on import TAKES_ROTORS
from gearopt.scenes.dynamics.tables import (
    GearsTable,
    MeshTable,
    OptimiseTable,
    RotorTable,
    SimulateTable,
    SpeedsTable,
    StabilityTable,
)
from gearopt.scenes.reading.fields import ProblemFile, refuse

NEEDED = {  # keys of [mesh] that a shape of the wave asks for; others change nothing
    "constant": ("stiffness",),
    "rectangle": ("stiffness", "depth", "duty"),
    "trapezoid": ("stiffness", "depth", "duty", "ramp"),
    "fourier": ("stiffness", "cosines"),
    "pair": ("pair",),
}
DEEPEST = 3.0  # transverse contact ratio of the deepest spur teeth
MOST_PERIODS = 100_000  # of the mesh in a motion
SHAPED = ("stiffness", "depth", "duty", "ramp", "cosines", "sines", "pair")


class Scene(ProblemFile):
    """A spur pair whose axes move on their bearings."""

    gears: GearsTable | None = None
    pinion: RotorTable
    wheel: RotorTable
    mesh: MeshTable
    simulate: SimulateTable | None = None
    stability: StabilityTable | None = None
    speeds: SpeedsTable | None = None
    optimise: OptimiseTable | None = None

    @property
    def to_size(self) -> bool:
        """Whether there is anything to choose, and limits of it."""
        return self.optimise is not None

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        mesh = self.mesh
        if self.pinion.torque is None or self.pinion.torque.value <= 0.0:
            rule = "drives the pair, counter-clockwise: a torque above zero"
            raise refuse(rule, at=("pinion", "torque"))
        averaged = mesh.wave == "constant" and mesh.pair is not None
        for name in NEEDED[mesh.wave]:
            if not (getattr(mesh, name) or averaged):
                rule = f'is missing: wave = "{mesh.wave}" needs it'
                raise refuse(rule, at=("mesh", name))
        idle = set(SHAPED) - set(NEEDED[mesh.wave])
        idle -= {"sines"} if mesh.wave == "fourier" else set()
        used = averaged and mesh.stiffness is None or mesh.transmission_error == "pair"
        idle -= {"pair"} if used or self.gears is not None else set()
        for name in idle & mesh.model_fields_set:
            rule = f'changes nothing of wave = "{mesh.wave}"'
            raise refuse(rule, at=("mesh", name), action="remove")
        if mesh.duty is not None and mesh.ramp is not None:
            if mesh.ramp > min(mesh.duty, 1 - mesh.duty):
                rule = "does not fit the duty: at most the duty, and 1 less the duty"
                raise refuse(rule, float(min(mesh.duty, 1 - mesh.duty)), ("mesh", "ramp"))
        if mesh.kinematics.startswith("paper") and mesh.axes != "plane":
            raise refuse("is of axes in the plane", "plane", ("mesh", "axes"))
        if mesh.axes == "line" and self._uneven:
            rule = "is of bearings alike in both directions: else axes leave the line of action"
            raise refuse(rule, "plane", ("mesh", "axes"))
        if self._pull <= 0.0:
            rule = "pulls the teeth apart: the normal load of both torques is not above zero"
            raise refuse(rule, at=("wheel", "torque"), action="remove")
        self._check_positive()
        self._check_error_and_damping()
        self._check_in_mesh()
        self._check_teeth()
        self._check_asked()
        self._check_optimise()
        return self

    _taken = TAKES_ROTORS

    @property
    def _pull(self) -> float:
        """Measure of the force on the driving flanks: above zero where the pinion drives."""
        if self.wheel.torque is None:
            return 1.0
        return sum(
            r.base_diameter.value * r.torque.value / r.inertia.value
            for r in (self.pinion, self.wheel)
            if r.torque is not None
        )

    @property
    def _uneven(self) -> bool:
        """Whether a gear has other bearings across the line of centres than along it."""
        rotors = self.pinion, self.wheel
        return any(r.bearing_stiffness_across not in (None, r.bearing_stiffness) for r in rotors)

    def _check_positive(self) -> None:
        """Refuse a mesh whose stiffness falls to zero or below within its period."""
        mesh, asked = self.mesh, self.stability
        if mesh.wave == "fourier" and fourier_of(mesh).least <= 0.0:
            rule = "makes the stiffness fall to zero or below within the period"
            raise refuse(rule, at=("mesh", "cosines"))
        if mesh.duty is None:
            return
        rule = "makes the stiffness fall to zero: below 1/duty"
        if mesh.depth is not None and mesh.depth * mesh.duty >= 1:
            raise refuse(rule, round(float(Fraction(9, 10) / mesh.duty), 2), ("mesh", "depth"))
        if asked is not None and asked.depth[1] * mesh.duty >= 1:
            low = float(asked.depth[0])
            ends = [low, round(max(low, float(Fraction(9, 10) / mesh.duty)), 2)]
            raise refuse(rule, ends, ("stability", "depth"))

    def _check_error_and_damping(self) -> None:
        """Refuse a transmission error or damping that is incomplete, or that changes nothing."""
        mesh = self.mesh
        if mesh.transmission_error == "pair" and mesh.pair is None:
            raise refuse('is missing: transmission_error = "pair" needs it', at=("mesh", "pair"))
        for name in ("error_cosines", "error_sines", "transmission_error"):
            if self.optimise is not None and name in mesh.model_fields_set:
                rule = "is not in [optimise], which is of teeth without errors"
                raise refuse(rule, at=("mesh", name), action="remove")
        if "damping_acts" in mesh.model_fields_set and (mesh.backlash is None or not mesh.damping):
            rule = "changes nothing without backlash, as teeth never part, and without damping"
            raise refuse(rule, at=("mesh", "damping_acts"), action="remove")

    def _check_in_mesh(self) -> None:
        """Refuse bearings that let the load move the axes so far apart that no teeth touch."""
        if self.mesh.axes == "fixed" or self.optimise is not None:
            return
        pair, teeth = self.pair(constant(1.0)), self.toothing
        if self.mesh.duty is None:
            teeth = replace(teeth, contact_ratio=DEEPEST)  # their tips are not known
        start, growth, times = pair.rest.centre_distance, _growth(pair), 1
        if teeth.apart(start, growth) > 0.0:
            return
        while teeth.apart(start, _growth(_stiffer(pair, times))) < 1.0:
            times *= 2
        name = min(("pinion", "wheel"), key=lambda n: getattr(self, n).bearing_stiffness.value)
        rule = f"lets the load move the axes apart by {growth:.3g} mm, where no teeth touch"
        remedy = f"Write bearings that are at least {times} times as stiff, or less torque"
        raise refuse(rule, remedy, (name, "bearing_stiffness"), "tell")

    def _check_teeth(self) -> None:
        """Refuse data of K_v that change nothing."""
        mesh = self.mesh
        wider = mesh.face_width is not None
        if wider and (mesh.pair is not None or self.optimise is not None):
            source = "the file of `pair`" if mesh.pair is not None else "[optimise]"
            raise refuse(f"follows from {source}", at=("mesh", "face_width"), action="remove")
        for name in ("face_width", "accuracy_grade"):
            beside = self.simulate or self.speeds or self.gears
            if getattr(mesh, name) is not None and not beside:
                rule = "changes nothing without [simulate] and [speeds], beside which K_v is told"
                raise refuse(rule, at=("mesh", name), action="remove")

    @property
    def _shaken(self) -> bool:
        """Whether a transmission error excites the mesh."""
        mesh = self.mesh
        return bool(mesh.error_cosines or mesh.error_sines) or mesh.transmission_error == "pair"

    def _check_asked(self) -> None:
        """Refuse what is asked of a mesh that cannot give it."""
        mesh = self.mesh
        ranges = [(("speeds", "range"), self.speeds.range)] if self.speeds else []
        ranges += [(("optimise", "speeds"), self.optimise.speeds)] if self.optimise else []
        for place, (low, high) in ranges:
            if low == high:
                raise refuse("is one speed: a range has a lower and a higher end", at=place)
        if self.stability is not None and mesh.wave == "constant":
            rule = 'maps a stiffness that changes: wave = "constant" has no map'
            raise refuse(rule, at=("stability",), action="remove")
        varies = mesh.wave != "constant" or self._shaken
        if self.simulate is not None and varies and mesh.speed is None:
            rule = "is missing: what changes over a mesh period has a mesh frequency"
            raise refuse(rule, at=("mesh", "speed"))
        if self.simulate is not None:
            periods = self.simulate.duration.value * self.mesh_frequency
            if periods > MOST_PERIODS:
                rule = f"spans {periods:,.0f} periods of the mesh: at most {MOST_PERIODS:,}"
                most = f"{MOST_PERIODS / self.mesh_frequency:.3g} s"
                raise refuse(rule, most, ("simulate", "duration"))
        curved = mesh.axes == "plane" and mesh.kinematics in ("exact", "paper")
        if self.speeds is not None and curved and (self._uneven or mesh.kinematics == "paper"):
            rule = (
                "is by harmonic balance of a mesh whose line of action does not turn: "
                'kinematics = "tangent"'
            )
            raise refuse(rule, at=("speeds",), action="remove")

    def _check_optimise(self) -> None:
        """Refuse what [optimise] would leave out: balanced torques, one damping, axes on a line."""
        mesh, wheel, pinion = self.mesh, self.wheel, self.pinion
        if self.optimise is None:
            return
        if wheel.torque is not None and not math.isclose(wheel.torque.value, self._balance):
            rule = "changes nothing of [optimise], whose torques balance"
            raise refuse(rule, at=("wheel", "torque"), action="remove")
        if wheel.bearing_damping != pinion.bearing_damping:
            rule = "changes nothing of [optimise]: all bearings have the damping of the pinion's"
            raise refuse(rule, float(pinion.bearing_damping), ("wheel", "bearing_damping"))
        if mesh.axes != "line":
            rule = "does not fit [optimise], whose axes move along the line of action"
            raise refuse(rule, "line", ("mesh", "axes"))
        if "kinematics" in mesh.model_fields_set:
            rule = "changes nothing of [optimise], whose axes move along the line of action"
            raise refuse(rule, at=("mesh", "kinematics"), action="remove")
        idle = ("elements", "periods") if mesh.backlash is None else ("margin", "multiplier")
        rules = (
            "is of a mesh with backlash",
            "is of a mesh without backlash, whose teeth never part",
        )
        for name in sorted({*idle} & self.optimise.model_fields_set):
            rule = rules[mesh.backlash is not None]
            raise refuse(rule, at=("optimise", name), action="remove")

    @property
    def _balance(self) -> float:
        """The torque of the wheel that balances the pinion's [N mm]."""
        assert self.pinion.torque is not None
        ratio = self.wheel.base_diameter.value / self.pinion.base_diameter.value
        return float(self.pinion.torque.value * ratio)

    def pair(self, wave: Wave, error: tuple[complex, ...] = ()) -> MovingPair:
        """Return the pair with a wave of stiffness and the error of its teeth, besides its own."""
        mesh = self.mesh
        drive = self.pinion.torque.value if self.pinion.torque else 0.0
        balance = self._balance if self.wheel.torque is None else self.wheel.torque.value
        rotors = [
            _rotor(table, torque) for table, torque in ((self.pinion, drive), (self.wheel, balance))
        ]
        undamped = MovingPair(
            rotors[0],
            rotors[1],
            mesh.pressure_angle.value,
            wave,
            kinematics=mesh.kinematics,
            backlash=None if mesh.backlash is None else mesh.backlash.value,
            mesh_frequency=self.mesh_frequency,
            error=_error_of(mesh, error),
        )
        damping = damping_of(float(mesh.damping), wave.mean, undamped.mesh_mass)
        if mesh.damping_acts == "always":
            return replace(undamped, drag=damping)
        return replace(undamped, damping=damping)

    @property
    def mesh_frequency(self) -> float:
        """Mesh frequency at the speed of the file [Hz]; 0 without one."""
        speed = self.mesh.speed.value if self.mesh.speed else 0.0
        return self.mesh.teeth * speed / (2.0 * math.pi)

    @property
    def module(self) -> float:
        """Module of the teeth [mm]: base pitch over pi cos(alpha)."""
        radius = 0.5 * self.pinion.base_diameter.value
        return float(2.0 * radius / (self.mesh.teeth * math.cos(self.mesh.pressure_angle.value)))

    @property
    def toothing(self) -> Toothing:
        """Teeth of ISO 53 without profile shift, with the contact ratio of the file's `duty`."""
        mesh, module = self.mesh, self.module
        ratio = self.wheel.base_diameter.value / self.pinion.base_diameter.value
        width = mesh.face_width.value if mesh.face_width else None
        rack = Rack(pressure_angle=mesh.pressure_angle.value)
        numbers = module, mesh.teeth, mesh.teeth * ratio, width or module
        gears = GearPair.of_teeth(*numbers, rack=rack)
        overlap = 1.0 + float(mesh.duty) if mesh.duty else contact_path(gears).transverse_ratio
        return Toothing(gears, float(overlap), width, mesh.accuracy_grade)

    @property
    def task(self) -> Task:
        """Return the task that [optimise] states."""
        asked, mesh = self.optimise, self.mesh
        assert asked is not None and self.pinion.torque is not None
        bases = (0.5 * self.pinion.base_diameter.value, 0.5 * self.wheel.base_diameter.value)
        angle = mesh.pressure_angle.value
        ranges: dict[str, tuple[float, float]] = {}
        for name in ("bearing_stiffness", "contact_ratio", "ramp", "face_width", "rim"):
            low, high = (float(getattr(end, "value", end)) for end in getattr(asked, name))
            ranges[name] = (low, high)
        first, last = (30.0 / math.pi * end.value for end in asked.speeds)
        return Task(
            torque=self.pinion.torque.value,
            base_radii=bases,
            radii=(bases[0] / math.cos(angle), bases[1] / math.cos(angle)),
            teeth=mesh.teeth,
            pressure_angle=angle,
            density=asked.density.value,
            single=asked.single_stiffness.value,
            mesh_damping=float(mesh.damping),
            bearing_damping=float(self.pinion.bearing_damping),
            speeds_rpm=tuple(
                first + (last - first) * k / (asked.points - 1) for k in range(asked.points)
            ),
            ranges=ranges,
            most_mass=asked.mass.value,
            most_displacement=asked.displacement.value,
            margin=None if asked.margin is None else asked.margin.value,
            most_growth=None if asked.multiplier is None else float(asked.multiplier),
            measure=asked.minimise,
            harmonics=asked.harmonics,
            backlash=None if mesh.backlash is None else mesh.backlash.value,
            elements=asked.elements,
            periods=asked.periods,
            always=mesh.damping_acts == "always",
        )


def _growth(pair: MovingPair) -> float:
    """By how much the centre distance grows at rest under the load [mm]."""
    u, v = static(pair).apart
    start = pair.rest.centre_distance
    return math.hypot(start + u, v) - start


def _stiffer(pair: MovingPair, times: float) -> MovingPair:
    """Return a pair whose bearings are so many times as stiff."""
    rotors = [
        replace(r, stiffness=(times * r.stiffness[0], times * r.stiffness[1])) for r in pair.rotors
    ]
    return replace(pair, pinion=rotors[0], wheel=rotors[1])


def _rotor(table: RotorTable, torque: float) -> Rotor:
    along = table.bearing_stiffness.value
    across = table.bearing_stiffness_across.value if table.bearing_stiffness_across else along
    mass, ratio = table.mass.value, float(table.bearing_damping)
    damping = (damping_of(ratio, along, mass), damping_of(ratio, across, mass))
    return Rotor(
        0.5 * table.base_diameter.value, mass, table.inertia.value, (along, across), damping, torque
    )


def _error_of(mesh: MeshTable, teeth: tuple[complex, ...]) -> tuple[complex, ...]:
    """Return a_h - i b_h [mm] of cosines a and sines b, and of the teeth."""
    rows = zip_longest(mesh.error_cosines, mesh.error_sines)
    given = [complex(a.value if a else 0.0, -b.value if b else 0.0) for a, b in rows]
    return tuple(a + b for a, b in zip_longest(given, teeth, fillvalue=0.0))


def fourier_of(mesh: MeshTable) -> Wave:
    """Return a Fourier series of the stiffness."""
    assert mesh.stiffness is not None
    sums = [[c.value for c in each] for each in (mesh.cosines, mesh.sines)]
    return fourier(mesh.stiffness.value, *sums)


def wave_of(mesh: MeshTable) -> Wave:
    """Return the stiffness over a period that a file describes without another file."""
    mean = mesh.stiffness.value if mesh.stiffness else 0.0
    if mesh.wave == "constant":
        return constant(mean)
    if mesh.wave == "fourier":
        return fourier_of(mesh)
    ramp = float(mesh.ramp) if mesh.ramp is not None else 0.0
    assert mesh.depth is not None and mesh.duty is not None
    return trapezoid(mean, float(mesh.depth), float(mesh.duty), ramp)
