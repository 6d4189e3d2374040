"""What a caller asks of a scene beside the file: method, budget, how many answers."""

from dataclasses import dataclass, field, replace

from gearopt.optimise.result import Budget, Watch
from gearopt.optimise.solve import GAP


@dataclass(frozen=True)
class Ask:
    """method: None for the scene's own choice. top: answers in proven order. gap: see `solve`."""

    method: str | None = None
    budget: Budget = field(default_factory=Budget)
    seed: int = 0
    watch: Watch | None = None
    gap: float = GAP
    top: int = 1

    @property
    def half(self) -> "Ask":
        """Return the same in half of its seconds: an answer that leaves time to explain it."""
        seconds = self.budget.seconds and 0.5 * self.budget.seconds
        return replace(self, budget=replace(self.budget, seconds=seconds))
