"""Stress cycle factors Y_N and Z_N, and the lives that follow from them.

A curve is a power law of the numbers of cycles to 1e7 (or 3e6) and another beyond, joined where
they cross, so that it is continuous and has an inverse: the standard's join is off by up to 2e-4
there. Numbers of cycles are floats or arrays; hardness is a float.
"""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass

# Y = A N^-B below 3e6 cycles, by Brinell hardness of through-hardened steel, and by treatment.
# Source: AGMA 2001-D04, figure 18 (Shigley, figure 14-14); two public programs have the same
BENDING = {160.0: (2.3194, 0.0538), 250.0: (4.9404, 0.1045), 400.0: (9.4518, 0.148)}
CARBURISED, NITRIDED = (6.1514, 0.1192), (3.517, 0.0817)
BENDING_LONG = {"general": (1.3558, 0.0178), "critical": (1.6831, 0.0323)}
# Source: AGMA 2001-D04, figure 17 (Shigley, figure 14-15); the same two programs
PITTING, PITTING_NITRIDED = (2.466, 0.056), (1.249, 0.0138)
PITTING_LONG = {"general": (1.4488, 0.023), "critical": (2.466, 0.056)}
SHORTEST_BENDING, SHORTEST_PITTING = 1e3, 1e4  # cycles; the curves are flat below
LONGEST_LIFE = 1e10  # cycles up to which the curves are drawn
KINDS = ("through-hardened", "carburised", "nitrided", "iron")
SERVICES = ("general", "critical")


@dataclass(frozen=True)
class Curve:
    """A stress cycle factor A N^-B: the larger of short and long (the smaller where `least`).

    short and long are (A, B). shortest: cycles below which it is flat.
    """

    short: tuple[float, float]
    long: tuple[float, float]
    shortest: float
    least: bool = False

    def factor(self, cycles: Any) -> Any:
        """Return the factor of a number of cycles."""
        at = np.maximum(cycles, self.shortest)
        short, long = (a * at**-b for a, b in (self.short, self.long))
        return np.minimum(short, long) if self.least else np.maximum(short, long)

    def life(self, factor: Any) -> Any:
        """Return the number of cycles at which the factor is reached; the inverse of `factor`.

        0 where even the shortest life has a smaller factor: the tooth breaks or pits at once.
        Beyond LONGEST_LIFE it is an extrapolation.
        """
        with np.errstate(over="ignore", divide="ignore"):
            short, long = (
                (np.asarray(factor) / a) ** (-1.0 / b) for a, b in (self.short, self.long)
            )
            cycles = np.minimum(short, long) if self.least else np.maximum(short, long)
        return np.where(cycles < self.shortest * (1.0 - 1e-12), 0.0, cycles)[()]

    def take(self, place: Any) -> "Curve":
        """Return the curve of some rows of arrays, which is that of all."""
        return self


def bending_curve(kind: str, hardness: float = 250.0, service: str = "general") -> Curve:
    """Return the curve of Y_N; hardness [HB] of through-hardened steel, 160 to 400.

    kind: one of KINDS (flame and induction hardened steels count as carburised, iron, of which the
    standard has no curve, has the lowest of steel: unverified);
    service: one of SERVICES, "critical" where little pitting and wear is allowed. Between the
    curves of 160, 250 and 400 HB ln Y_N is linear in the hardness, outside it is that of the
    nearest; the standard says nothing. ValueError for other words. Source: AGMA 2001-D04, clause
    17.
    """
    _check(kind, service)
    known = {"carburised": CARBURISED, "nitrided": NITRIDED, "iron": BENDING[160.0]}
    short = known.get(kind) or _between(hardness)
    return Curve(short, BENDING_LONG[service], SHORTEST_BENDING)


def pitting_curve(kind: str, service: str = "general") -> Curve:
    """Return the curve of Z_N of one of KINDS; service as of `bending_curve`.

    Source: AGMA 2001-D04, clause 17.
    """
    _check(kind, service)
    if kind in ("nitrided", "iron"):
        return Curve(PITTING_NITRIDED, PITTING_LONG[service], SHORTEST_PITTING, least=True)
    return Curve(PITTING, PITTING_LONG[service], SHORTEST_PITTING)


def _check(kind: str, service: str) -> None:
    for word, known in ((kind, KINDS), (service, SERVICES)):
        if word not in known:
            raise ValueError(f"no curve for {word!r}; known: {', '.join(known)}")


def _between(hardness: float) -> tuple[float, float]:
    known = sorted(BENDING)
    logs = [float(np.log(BENDING[h][0])) for h in known]
    slopes = [BENDING[h][1] for h in known]
    found = float(np.interp(hardness, known, logs)), float(np.interp(hardness, known, slopes))
    return float(np.exp(found[0])), found[1]


def cycles_of(hours: Any, speed_rpm: Any, contacts: Any = 1.0) -> Any:
    """Return the number of stress cycles 60 L n q of a tooth; contacts q a revolution."""
    return 60.0 * hours * speed_rpm * contacts
