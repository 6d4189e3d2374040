"""The values of a Pareto front in the units that are shown, and the ends of its axes."""

from collections.abc import Sequence
from dataclasses import dataclass

from gearopt.optimise.pareto.front import Front
from gearopt.report.front import head, rules, unit_of
from gearopt.report.measures import Measures

AXIS_MARGIN = 0.06  # of the range of a front, free around it
FARTHEST_SHOWN = 0.35  # of the range: beaten designs that are farther off are left out
MAX_BEATEN = 1500  # beaten designs that are drawn, those nearest to the front
Span = tuple[float, float]


@dataclass(frozen=True)
class Drawn:
    """A front in the units that are shown: heads, values, and the places of its picks.

    points, beaten: values by design; corners: limits under which there is none, None for any.
    """

    heads: tuple[str, ...]
    points: list[tuple[float, ...]]
    beaten: list[tuple[float, ...]]
    corners: list[tuple[float | None, ...]]
    picks: dict[int, str]
    curve: bool

    def column(self, k: int) -> list[float]:
        """Return the values of an objective."""
        return [p[k] for p in self.points]

    def span(self, k: int) -> Span:
        """Return the ends of an objective's axis."""
        low, high = min(self.column(k)), max(self.column(k))
        room = AXIS_MARGIN * (high - low) or 0.02 * abs(high) or 1.0
        return low - room, high + room


def drawn(front: Front, measures: Measures) -> Drawn:
    """Return what is drawn of a front that has points."""
    units = [unit_of(one) for one in front.objectives]

    def shown(values: Sequence[float]) -> tuple[float, ...]:
        return tuple(measures.of(v, unit) for v, unit in zip(values, units, strict=True))

    corners = [
        tuple(
            None if (v := one.limits.get(o.name)) is None else measures.of(v, unit_of(o))
            for o in front.objectives
        )
        for one in front.impossible
    ]
    return Drawn(
        tuple(head(one, measures) for one in front.objectives),
        [shown(p.values) for p in front.points],
        [shown(p) for p in near(front)],
        corners,
        {place: ", ".join(names) for place, names in rules(front).items()},
        front.error is not None,
    )


def near(front: Front) -> list[tuple[float, ...]]:
    """Return the beaten designs that are drawn: within the plot, the nearest to its corner."""
    columns = list(zip(*(p.values for p in front.points), strict=True))
    ends = [(min(c), (max(c) - min(c)) or 1.0) for c in columns]

    def far(values: Sequence[float]) -> float:
        shares = [(v - low) / wide for v, (low, wide) in zip(values, ends, strict=True)]
        return float(max(shares))

    inside = [values for values in front.beaten if far(values) <= 1.0 + FARTHEST_SHOWN]
    return sorted(inside, key=far)[:MAX_BEATEN]
