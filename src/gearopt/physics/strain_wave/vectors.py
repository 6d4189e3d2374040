"""Vectors of the plane whose components are floats, arrays or casadi scalars."""

from typing import Any

import numpy as np

from gearopt.frozen import dataclass


@dataclass(frozen=True)
class Vector:
    """A vector (x, y)."""

    x: Any
    y: Any

    def __add__(self, other: "Vector") -> "Vector":
        return Vector(self.x + other.x, self.y + other.y)

    def __sub__(self, other: "Vector") -> "Vector":
        return Vector(self.x - other.x, self.y - other.y)

    def __neg__(self) -> "Vector":
        return Vector(-self.x, -self.y)

    def __mul__(self, factor: Any) -> "Vector":
        return Vector(self.x * factor, self.y * factor)

    def __getitem__(self, index: Any) -> "Vector":
        return Vector(self.x[index], self.y[index])

    @property
    def length(self) -> Any:
        """Length sqrt(x^2 + y^2)."""
        return np.sqrt(self.x * self.x + self.y * self.y)

    @property
    def angle(self) -> Any:
        """Polar angle [rad], from -pi to pi."""
        return np.arctan2(self.y, self.x)

    @property
    def left(self) -> "Vector":
        """The vector turned by a right angle, counter-clockwise."""
        return Vector(-self.y, self.x)

    def turned(self, angle: Any) -> "Vector":
        """Return the vector turned by an angle [rad], counter-clockwise."""
        cosine, sine = np.cos(angle), np.sin(angle)
        return Vector(cosine * self.x - sine * self.y, sine * self.x + cosine * self.y)

    def dot(self, other: "Vector") -> Any:
        """Return the scalar product."""
        return self.x * other.x + self.y * other.y

    def cross(self, other: "Vector") -> Any:
        """Return x1 y2 - y1 x2."""
        return self.x * other.y - self.y * other.x


def polar(radius: Any, angle: Any) -> Vector:
    """Return the vector of a length and a polar angle [rad]."""
    return Vector(radius * np.cos(angle), radius * np.sin(angle))
