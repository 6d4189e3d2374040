"""A stage as it is drawn: its gears, the pins of its planets, and the plates that hold them."""

import math
from collections.abc import Sequence

from gearopt.formulations.drive.layout.layout_design import GearDesign, ShaftDesign
from gearopt.frozen import dataclass
from gearopt.physics.gears import MEMBERS
from gearopt.physics.planetary import assembly
from gearopt.physics.planetary.willis import ENDS
from gearopt.report.drawing.bodies import Plate, RingDesign

PLATE = (2.0, 7.0)  # px from the gears to a plate, and to its other face
PIN = 0.35  # of a planet's reference diameter: a pin as it is drawn, but in a bore
PINS = 100  # numbers of pins of a stage


@dataclass(frozen=True)
class DrawnStage:
    """Dimensions of a stage that are drawn, by the keys of a result."""

    normal_module_mm: float
    pinion_teeth: float
    wheel_teeth: float
    face_width_mm: float
    pinion_diameter_mm: float
    wheel_diameter_mm: float
    pinion_tip_diameter_mm: float
    wheel_tip_diameter_mm: float
    centre_distance_mm: float
    pinion_face_width_mm: float | None = None
    wheel_face_width_mm: float | None = None
    driver: str = "pinion"
    idler: bool = False  # the pinion is the wheel of the stage before
    type: str = "parallel"
    fixed: str = ""
    planets: int | None = None
    ring_teeth: float | None = None
    ring_diameter_mm: float | None = None
    ring_tip_diameter_mm: float | None = None
    ring_outside_diameter_mm: float | None = None
    wheel_bore_mm: float | None = None
    carrier_diameter_mm: float | None = None
    carrier_width_mm: float | None = None

    @property
    def is_set(self) -> bool:
        """Whether it has planets, its shafts being in one line."""
        return self.type == "planetary"

    @property
    def members(self) -> tuple[str, ...]:
        """The member that drives and the one that is driven."""
        ends = ENDS[self.fixed] if self.is_set else MEMBERS
        return ends if self.driver == "pinion" else ends[::-1]

    @property
    def offset(self) -> float:
        """Distance of its shafts [mm]."""
        return 0.0 if self.is_set else self.centre_distance_mm

    @property
    def largest(self) -> tuple[float, float]:
        """Diameters [mm] of all that is about the first and about the second shaft."""
        outside = self.ring_outside_diameter_mm or 0.0
        if self.is_set:
            return outside, outside
        ends = self.pinion_tip_diameter_mm, max(self.wheel_tip_diameter_mm, outside)
        return ends if self.driver == "pinion" else ends[::-1]

    def width(self, member: str) -> float:
        """Face width [mm] of a gear."""
        return getattr(self, f"{member}_face_width_mm", None) or self.face_width_mm

    @property
    def room(self) -> float:
        """Length [mm] along the shafts of its widest gear, or of a set and the carrier's cheeks."""
        return max(map(self.width, MEMBERS)) + (self.carrier_width_mm or 0.0)

    @property
    def turns(self) -> list[float]:
        """Angles of the planets [rad], as equal as teeth allow."""
        whole = round(self.pinion_teeth + (self.ring_teeth or 0.0))
        return [2.0 * math.pi * float(turn) for turn in assembly.turns(whole, self.planets or 1)]

    def gears(self, k: int, middle: float, idlers: Sequence[int]) -> list[GearDesign]:
        """Gears of the stage of number k, about a middle along the shafts [mm]; idlers: shafts."""
        shafts = {member: shaft for shaft, member in enumerate(self.members, k)}
        if self.is_set:
            parts = [("pinion", "sun", shafts.get("sun", k))]
            parts += [("wheel", "planet", -(PINS * k + n)) for n in range(len(self.turns))]
            parts.append(("ring", "ring", shafts.get("ring", k)))
        else:
            ring = self.type == "internal"
            rows = [*shafts.items()][self.idler :]
            parts = [("ring" if ring and m == "wheel" else m, m, shaft) for m, shaft in rows]
        drawn = []
        for part, name, shaft in parts:
            called = "idler" if shaft in idlers else "ring" if part == "ring" else name
            drawn.append(self._gear(part, f"{called} {k}", k, shaft, middle))
        return drawn

    def _gear(self, part: str, name: str, k: int, shaft: int, middle: float) -> GearDesign:
        """A gear; part: the first word of its keys."""
        b = self.width(part)
        words = {
            "name": name,
            "stage": k,
            "member": part,
            "shaft": shaft,
            "teeth": getattr(self, f"{part}_teeth"),
            "normal_module_mm": self.normal_module_mm,
            "reference_diameter_mm": getattr(self, f"{part}_diameter_mm"),
            "tip_diameter_mm": getattr(self, f"{part}_tip_diameter_mm"),
            "root_diameter_mm": 0.0,
            "helix_angle_deg": 0.0,
            "from_mm": middle - 0.5 * b,
            "to_mm": middle + 0.5 * b,
        }
        outside = self.ring_outside_diameter_mm
        if part == "ring" and outside is not None:
            return RingDesign(**words, outside_diameter_mm=outside)
        return GearDesign(**words)

    def pins(self, k: int, middle: float, y: float) -> list[ShaftDesign]:
        """Pins of the planets of the stage of number k, about an axis y [mm]."""
        a, half = self.centre_distance_mm, 0.5 * self.face_width_mm
        return [
            ShaftDesign(
                shaft=-(PINS * k + n),
                y_mm=y + a * math.cos(turn),
                z_mm=0.0 if math.isclose(abs(math.cos(turn)), 1.0) else a * math.sin(turn),
                diameter_mm=self.wheel_bore_mm or PIN * self.wheel_diameter_mm,
                from_mm=middle - half,
                to_mm=middle + half,
            )
            for n, turn in enumerate(self.turns if self.is_set else [])
        ]

    def plates(self, k: int, middle: float, scale: float) -> list[Plate]:
        """Plates of the carrier, and of a ring that turns, beside the gears; scale [px/mm]."""
        shafts = {member: shaft for shaft, member in enumerate(self.members, k)}
        outer, reach = 0.5 * (self.ring_outside_diameter_mm or 0.0), self.centre_distance_mm
        reach += PIN * self.wheel_diameter_mm
        ring = shafts.get("ring") if self.is_set else shafts["wheel"]
        rows = [(ring, outer)] if ring is not None and self.type != "parallel" else []
        plates = []
        carrier = shafts.get("carrier", 2 * k + 1 - (ring or k))
        if self.is_set and self.carrier_width_mm and self.carrier_diameter_mm:
            for side in (-1.0, 1.0):
                gears, end = (middle + 0.5 * side * b for b in (self.face_width_mm, self.room))
                ends = min(gears, end), max(gears, end)
                radius = 0.5 * self.carrier_diameter_mm
                plates.append(Plate(k, carrier, radius, *ends, sized=True))
        elif self.is_set:
            rows.append((carrier, reach))
        for shaft, radius in rows:
            side = 1.0 if shaft > k else -1.0
            start, end = (middle + side * (0.5 * self.face_width_mm + px / scale) for px in PLATE)
            plates.append(Plate(k, shaft, radius, min(start, end), max(start, end)))
        return plates
