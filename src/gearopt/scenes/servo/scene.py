"""A servo axis's file as a whole: its tables, how they fit together, the axis they describe."""

import math
from dataclasses import replace
from typing import Any

from pydantic import Field, model_validator

from gearopt.formulations.servo import servo_box
from gearopt.formulations.servo.choice import Choice
from gearopt.formulations.servo.ratio import ServoDuty
from gearopt.formulations.servo.split import ServoTrain, StiffTrain
from gearopt.formulations.servo.split.bodies import Pairs
from gearopt.formulations.servo.split.springs import Springs
from gearopt.formulations.servo.tolerance.stack import RUN_OUT
from gearopt.physics.stiffness import stiffness_of_frequency
from gearopt.scenes.reading.fields import ProblemFile, refuse
from gearopt.scenes.servo.tables.mesh import (
    TWO_SIDED,
    Accuracy,
    BudgetTable,
    CostTable,
    Mesh,
    Price,
    Source,
    Tolerances,
    check_costs,
    price,
)
from gearopt.scenes.servo.tables.motion import Duty, Load, Motor, servo_duty
from gearopt.scenes.servo.tables.planetary import Planetary
from gearopt.scenes.servo.tables.trains import (
    AIMS,
    Lightest,
    Shaft,
    Space,
    Stiffness,
    Train,
    bodies,
    check_sector,
    check_shafts,
    half_sweep,
)

__all__ = ["Scene"]  # messages show tables of the example
OF_PAIRS = "train mesh tolerances cost budget shaft stiffness lightest space".split()


class Scene(ProblemFile):
    """A servo axis: motor, two-stage spur gear train, load. Tables switch its parts on.

    Or a planetary stage that is given, in place of the train.
    """

    motor: Motor | None = None
    load: Load | None = None
    duty: Duty | None = None
    train: Train | None = None
    shaft: Shaft | None = None
    mesh: tuple[Mesh, ...] = Field((), description="One table per stage, from the motor on")
    accuracy: Accuracy = Field(default_factory=Accuracy)
    tolerances: Tolerances | None = None
    cost: tuple[CostTable, ...] = Field((), description="One table per deviation")
    budget: tuple[BudgetTable, ...] = Field((), description="One table per budget")
    stiffness: Stiffness | None = None
    lightest: Lightest | None = None
    space: Space | None = None
    planetary: Planetary | None = None

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        if not (self.motor or self.load or self.duty or self.train or self.mesh):
            rule = "is missing, as are [train] and [[mesh]]: nothing is asked for"
            raise refuse(rule, at=("duty",))
        self._check_motion()
        self._check_planetary()
        self._check_meshes()
        self._check_train()
        self._check_tolerances()
        return self

    def _check_motion(self) -> None:
        if self.motor is None and self.duty is None and (self.stiffness or self.load is None):
            return
        for name in ("motor", "load", "duty"):
            if getattr(self, name) is None:
                rule = "is missing: [motor], [load] and [duty] belong together"
                raise refuse(rule, at=(name,))
        assert self.duty and self.motor and self.load
        self.duty.check(self.motor, self.load)

    def _check_planetary(self) -> None:
        """Check that a planetary stage is the whole train, and of a motion that knows losses."""
        if self.planetary is None:
            return
        for name in OF_PAIRS:
            if getattr(self, name):
                rule = "does not go together with [planetary]: it is of a train of gear pairs"
                raise refuse(rule, at=(name,), action="remove")
        if self.duty and self.duty.motion == "swing" and self.planetary.friction is not None:
            rule = 'does not go together with motion = "swing", of a train without losses'
            raise refuse(rule, at=("planetary", "friction"), action="remove")

    def _check_meshes(self) -> None:
        if len(self.mesh) > 2:
            raise refuse("is one more than the two stages", at=("mesh", 2), action="remove")
        if len(self.mesh) == 1:
            raise refuse("is missing: one table [[mesh]] for each of the two stages", at=("mesh",))
        if not self.mesh and self.tolerances:
            raise refuse("is missing: [tolerances] needs one per stage", at=("mesh",))
        if not self.mesh and "accuracy" in self.model_fields_set:
            raise refuse("needs tables [[mesh]]", at=("accuracy",), action="remove")
        given = [mesh.given for mesh in self.mesh]
        if any(given) and not all(given):
            rule = "is missing: the gears of the other [[mesh]] are given"
            raise refuse(rule, at=("mesh", given.index(False), "module"))
        self._check_deviations()
        self._check_backlash()
        for k, mesh in enumerate(self.mesh):
            if mesh.grade is not None and self.train is not None:
                rule = "conflicts with [train], which chooses the diameters that it depends on"
                raise refuse(rule, at=("mesh", k, "grade"), action="remove")
        if self.mesh and self.train is None:
            if self.tolerances is None:
                raise refuse("is missing: [[mesh]] needs it, or [tolerances]", at=("train",))
            if not any(given):
                rule = "is missing: without [train] tolerances are for given gears"
                raise refuse(rule, at=("mesh", 0, "module"))

    def _check_deviations(self) -> None:
        """Check that both meshes have deviations or neither has; what counts errors needs them."""
        deviates = [mesh.deviates for mesh in self.mesh]
        if not self.mesh or all(deviates):
            return
        needs = {
            "the other [[mesh]] has one": any(deviates),
            "[tolerances] are made of them": self.tolerances is not None,
            "[accuracy] holds their error": self.accuracy.error is not None,
        }
        for why, needed in needs.items():
            if needed:
                rule = f"is missing, as is any deviation: {why}"
                raise refuse(rule, at=("mesh", deviates.index(False), "pitch"))

    def _check_backlash(self) -> None:
        """Check that every mesh can open at all, and that a minimum backlash has deviations."""
        for k, mesh in enumerate(self.mesh):
            deviations = [s for s in self.sources if s.stage == k + 1]
            if deviations and sum(s.per_mm * s.most for s in deviations) <= 0.0:
                key = next(n for n in TWO_SIDED if isinstance(getattr(mesh, n), tuple))
                raise refuse("leaves no backlash at all: the gears bind", at=("mesh", k, key))
            if mesh.minimum_backlash is None:
                continue
            if not deviations:
                rule = "is missing, as is any deviation: minimum_backlash needs one"
                raise refuse(rule, at=("mesh", k, "centre_distance"))
            if self.tolerances is not None and self.tolerances.grades is not None:
                rule = "is not supported yet beside grades of [tolerances]"
                raise refuse(rule, at=("mesh", k, "minimum_backlash"), action="remove")

    def backlash(self, k: int, run_outs: bool = True) -> tuple[float, float]:
        """Return the minimum and maximum circumferential backlash of stage k [mm].

        Every deviation is at the end that closes or opens the mesh; a run-out closes it by as much
        as it opens it. run_outs: whether they are counted at the minimum.
        """
        deviations = [s for s in self.sources if s.stage == k and s.kind == "backlash"]
        closed = [
            s.start - (s.tolerance if run_outs and s.law is RUN_OUT else 0.0) for s in deviations
        ]
        low = math.fsum(0.5 * s.per_mm * end for s, end in zip(deviations, closed, strict=True))
        return low, math.fsum(0.5 * s.per_mm * s.most for s in deviations)

    def _check_aim(self, train: Train) -> None:
        """Check that the objective is known: an error needs deviations, a motion needs [duty]."""
        key = "minimise" if train.maximise is None else "maximise"
        aim = f'{key} = "{train.aim}"'
        needs = f"{aim} needs"
        if train.goal == "error" and not self.sources:
            if not self.mesh:
                raise refuse(f"is missing: {needs} one per stage", at=("mesh",))
            raise refuse(f"is missing, as is any deviation: {needs} one", at=("mesh", 0, "pitch"))
        motion = AIMS[train.aim].motion
        if not motion:
            return
        if self.duty is None:
            raise refuse(f"is missing: {needs} it", at=("duty",))
        if self.duty.motion != motion:
            raise refuse(f"does not suit {aim} of [train]", motion, ("duty", "motion"))

    def _check_train(self) -> None:
        if self.train is None:
            for name in ("shaft", "stiffness", "lightest", "space"):
                if getattr(self, name) is not None:
                    raise refuse("needs a table [train]", at=(name,), action="remove")
            return
        self._check_aim(self.train)
        if self.train.output_torque is None and (self.duty is None or self.lightest is not None):
            needs = (
                "[lightest] needs it" if self.lightest else "the teeth carry it (or give [duty])"
            )
            raise refuse(f"is missing: {needs}", at=("train", "output_torque"))
        check_shafts(self.train, self.shaft, self.space, self.mesh)
        check_sector(self.train, self.space, self.duty)
        stiff = self.stiffness
        if stiff is not None and self.shaft is None:
            raise refuse("is missing: [stiffness] counts how it twists", at=("shaft",))
        if stiff is not None and stiff.frequency is not None and self.load is None:
            raise refuse("needs a table [load]", at=("stiffness", "frequency"), action="remove")
        if self.lightest is None:
            return
        if stiff is None:
            raise refuse("needs a table [stiffness]", at=("lightest",), action="remove")
        if stiff.line_stiffness is None:
            rule = "is missing: [lightest] does not know the teeth that youngs_modulus asks for"
            raise refuse(rule, "10300 MPa", ("stiffness", "line_stiffness"), "sample")
        if stiff.frequency is None and stiff.windup is None:
            rule = "is missing (or give windup): [lightest] needs it"
            raise refuse(rule, at=("stiffness", "frequency"))

    def _check_tolerances(self) -> None:
        if self.tolerances is None:
            for name in ("budget", "cost"):
                if getattr(self, name):
                    raise refuse("needs a table [tolerances]", at=(name,), action="remove")
            return
        check_costs(self.cost, self.sources)
        rules = [b.rule for b in self.budget]
        for k, rule in enumerate(rules):
            if rule in rules[:k]:
                text = "repeats a rule: one budget for each"
                raise refuse(text, at=("budget", k), action="remove")
        if self.tolerances.grades is not None:
            if len(rules) > 1:
                rule = "is one too many: grades are chosen within one budget"
                raise refuse(rule, at=("budget", 1), action="remove")
            if rules == ["mean_plus_sd"]:
                rule = "is not for grades, which add up"
                raise refuse(rule, "worst_case", ("budget", 0, "rule"))
        self._check_weights()

    def _check_weights(self) -> None:
        """Check that something holds every deviation: kappa = 0 leaves out run-outs."""
        assert self.tolerances is not None
        unheard = {s.name for s in self.sources if s.law.mean == 0.0}
        blind = [b.rule == "mean_plus_sd" and b.kappa == 0 for b in self.budget]
        if not unheard or not any(blind):
            return
        if len(unheard) == len(self.sources):
            rule = "leaves nothing to count: the mean of run-outs is 0"
            raise refuse(rule, 3, ("budget", blind.index(True), "kappa"))
        if all(blind) and self.tolerances.largest_factor is None:
            rule = "is missing: with kappa = 0 no budget counts the run-outs, whose mean is 0"
            raise refuse(rule, 4, ("tolerances", "largest_factor"), "sample")

    @property
    def prices(self) -> tuple[Price, ...]:
        """Costs of `sources`."""
        assert self.tolerances is not None
        return tuple(price(source, self.tolerances, self.cost) for source in self.sources)

    @property
    def sources(self) -> tuple[Source, ...]:
        """Return all deviations above zero, stage by stage."""
        angle = self.accuracy.pressure_angle.value
        by_stage = [mesh.sources(k, angle) for k, mesh in enumerate(self.mesh, 1)]
        return tuple(source for stage in by_stage for source in stage)

    def servo_duty(self) -> ServoDuty | None:
        """Return the motion of the load and its drive, in plain numbers; None for none."""
        if self.duty is None or self.motor is None or self.load is None:
            return None
        duty = servo_duty(self.duty, self.motor, self.load)
        if (stage := self.planetary) is None or stage.friction is None:
            return duty
        left = duty.drive.efficiency * (stage.design().efficiency or 1.0)
        return replace(duty, drive=replace(duty.drive, efficiency=left))

    def servo_train(self) -> ServoTrain:
        """Return the train to be chosen, in plain numbers."""
        table, shaft, error = self.train, self.shaft, self.accuracy.error
        assert table is not None
        ratio, tolerance = table.ratios
        lost = [sum(s.per_mm * s.most for s in self.sources if s.stage == k) for k in (1, 2)]
        first, second = (q.exact[0] for q in table.wheel_tip_diameters)
        return ServoTrain(
            ratio=ratio,
            tolerance=tolerance,
            modules=tuple(sorted(m.exact[0] for m in table.modules)),
            pinion_teeth=table.pinion_teeth,
            max_wheel_teeth=table.wheel_teeth,
            face_width=table.face_width.value,
            density=table.density.value,
            output_torque=table.output_torque.value if table.output_torque else 0.0,
            bending=table.bending_stress.value,
            bore=table.second_pinion_diameter.exact[0],
            wheel_tips=(first, second),
            shaft=None if shaft is None else (shaft.diameter.value, shaft.length.value),
            lost_motion=(lost[0], lost[1]) if self.sources else None,
            error=math.inf if error is None else error.value,
            sector=float(table.sector),
            duty=self.servo_duty(),
            bodies=bodies(table, shaft, self.space),
            elastic=self.elastic,
        )

    @property
    def elastic(self) -> Springs | None:
        """Return springs whose windup varies, an error beside those of deviations; None: none."""
        springs = self.springs
        varies = springs is not None and springs.variation and springs.load_torque is not None
        return springs if varies and self.sources else None

    @property
    def springs(self) -> Springs | None:
        """Return meshes and shaft as springs, in plain numbers; None without [stiffness]."""
        table, shaft, train, load = self.stiffness, self.shaft, self.train, self.load
        if table is None or shaft is None or train is None:
            return None
        line, elastic, torque = table.line_stiffness, table.youngs_modulus, table.load_torque
        inertia, needed = None if load is None else load.inertia.value, []
        if table.frequency is not None and inertia is not None:
            needed.append(float(stiffness_of_frequency(table.frequency.value, inertia)))
        if table.windup is not None and torque is not None:
            needed.append(torque.value / table.windup.value)
        return Springs(
            shear_modulus=table.shear_modulus.value,
            shaft=(shaft.diameter.value, shaft.length.value),
            line_stiffness=None if line is None else line.value,
            youngs_modulus=math.nan if elastic is None else elastic.value,
            load_inertia=inertia,
            load_torque=None if torque is None else torque.value,
            minimum=max(needed, default=None),
            variation=float(table.mesh_variation or 0),
        )

    def choice(self, boxed: bool = True) -> Choice:
        """The train to be chosen, and its limits; boxed: a required box too."""
        assert self.train is not None
        held = boxed and self.space is not None and self.space.required
        asked = [(k, m.minimum_backlash) for k, m in enumerate(self.mesh, 1)]
        return Choice(
            self.servo_train(),
            self.train.goal,
            self.springs,
            self.room() if held else None,
            tuple((k, self.backlash(k)[0], q.value) for k, q in asked if q is not None),
        )

    def box(self, pairs: Pairs) -> servo_box.ServoBox:
        """Return the box of a train, as its layout sees it."""
        return servo_box.of_train(pairs, self.room())

    def room(self) -> servo_box.Room:
        """Return the box, motor and hub of a file, in plain numbers."""
        space, train = self.space, self.train
        assert space is not None and train is not None
        return servo_box.Room(
            0.5 * space.motor_diameter.value,
            0.5 * space.hub_diameter.value,
            half_sweep(train, space),
            (space.width.value, space.height.value),
        )

    def stiff_train(self) -> StiffTrain:
        """Return the lightest train to be sized, in plain numbers."""
        train, table, springs = self.servo_train(), self.lightest, self.springs
        assert table and springs and springs.minimum and springs.line_stiffness
        assert train.bodies is not None
        module = float(train.modules[0])
        teeth = train.pinion_teeth[0]
        second = max(teeth, -(-train.bore // train.modules[0]))
        numbers: dict[str, Any] = {
            name: getattr(train, name)
            for name in ("density", "output_torque", "bending", "lost_motion", "error", "sector")
        }
        return StiffTrain(
            stiffness=springs.minimum,
            line_stiffness=springs.softest * springs.line_stiffness,
            shear_modulus=springs.shear_modulus,
            ratio=(float(train.ratios[0]), float(train.ratios[1])),
            module=module,
            pinion_teeth=(teeth, int(second)),
            bore=(float(train.bore), table.shaft_wall.value),
            wheel_tips=(float(train.wheel_tips[0]), float(train.wheel_tips[1])),
            face_width=table.face_width.value,
            shaft_diameter=table.shaft_diameter.value,
            shaft_length=springs.shaft[1],
            inertia=table.inertia.value,
            output=float(train.bodies.output_shaft),
            motor=float(train.bodies.motor),
            elastic=train.elastic,
            **numbers,
        )
