"""Contact lines of a helical pair in its plane of action, and the closed form of their length.

The plane of action is as long as the path of contact g_alpha and as wide as the face b. Lines lie
in it at the base helix angle, one transverse base pitch apart; places y [mm] across the face count
from its middle towards the end at which contact begins. A pair of teeth is named by where it would
touch in the middle of the face: s + y tan(beta_b) is its position at y.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from gearopt.frozen import dataclass
from gearopt.physics.gears import GearPair
from gearopt.physics.geometry.contact import ContactPath
from gearopt.physics.geometry.tooth import base_helix_angle
from gearopt.physics.mesh_cycle import Cycle, cycle


@dataclass(frozen=True)
class Face:
    """A face in slices of one width: its width b [mm], their number, and tan(beta_b) >= 0."""

    width: float
    count: int
    slope: float

    @classmethod
    def of(cls, pair: GearPair, count: int) -> "Face":
        """Return the face of a pair in so many slices."""
        slope = abs(float(np.tan(base_helix_angle(pair.pinion))))
        return cls(float(pair.face_width), count, slope)

    @property
    def slice_width(self) -> float:
        """Width [mm] of a slice."""
        return self.width / self.count

    @property
    def places(self) -> Any:
        """Middles y [mm] of the slices (count,)."""
        return self.width * ((np.arange(self.count) + 0.5) / self.count - 0.5)

    @property
    def reach(self) -> float:
        """How far [mm] the ends of a contact line are ahead of its middle, and behind."""
        return 0.5 * self.width * self.slope

    def cycle(self, path: ContactPath, steps: int) -> Cycle:
        """Return all contact lines over a base pitch by their middles, corners exactly.

        The path of middles is longer than the path of contact by the reach at either end; of spur
        gears it is the same one.
        """
        whole = replace(path, start=path.start - self.reach, end=path.end + self.reach)
        inner = (path.start + self.reach, path.end - self.reach) if self.reach else ()
        return cycle(whole, steps, also=inner)

    def parts(self, path: ContactPath, middles: Any) -> tuple[Any, Any]:
        """Part of each slice that is in contact, and the position of its middle [mm].

        middles (...) of lines, NaN where there is none; answers (..., count), positions on the path
        also where nothing touches.
        """
        line = np.asarray(middles)[..., None] + self.slope * self.places
        if self.slope == 0.0:
            there = np.isfinite(line)
            inside = np.where(there, line, 0.5 * (path.start + path.end))
            return there.astype(float), inside
        half = 0.5 * self.slope * self.slice_width
        low = np.clip(np.nan_to_num(line - half, nan=path.start), path.start, path.end)
        high = np.clip(np.nan_to_num(line + half, nan=path.start), path.start, path.end)
        return (high - low) / (2.0 * half), 0.5 * (low + high)


def mean_length(pair: GearPair, path: ContactPath) -> float:
    """Return the mean length eps_alpha b/cos(beta_b) [mm] of all contact lines together.

    Source: area g_alpha b of the plane of action over p_bt cos(beta_b), the distance of the lines.
    """
    cosine = np.cos(base_helix_angle(pair.pinion))
    return float(path.transverse_ratio * pair.face_width / cosine)


def length_range(transverse_ratio: float, overlap_ratio: float) -> tuple[float, float]:
    """Return least and largest length of the contact lines over their mean.

    With the fractional parts f of eps_alpha and eps_beta least 1 - f_a f_b/(eps_a eps_b) and
    largest 1 + min(f_a, f_b) (1 - max(f_a, f_b))/(eps_a eps_b) for f_a + f_b <= 1, else least
    1 - (1 - f_a) (1 - f_b)/(eps_a eps_b) and the same largest. Source: derived; the least ones are
    those of ISO/TR texts on helical pairs. eps_beta > 0.
    """
    first, second = transverse_ratio % 1.0, overlap_ratio % 1.0
    area = transverse_ratio * overlap_ratio
    lost = first * second if first + second <= 1.0 else (1.0 - first) * (1.0 - second)
    won = min(first, second) * (1.0 - max(first, second))
    return 1.0 - lost / area, 1.0 + won / area
