"""The request of a caller beside the file: method, budget, how many answers."""

from dataclasses import field, replace

from gearopt.errors import SolveError
from gearopt.frozen import dataclass
from gearopt.optimise.certified import GAP
from gearopt.optimise.clock import of_others
from gearopt.optimise.result import Budget, Watch

LEAST_PRICES = 2.0  # s, for sensitivities that may take a share of the answer's seconds
# Back ends that another seed leads elsewhere.
RANDOM = ("annealing", "multistart", "nsga2", "scip", "spatial")


@dataclass(frozen=True)
class Ask:
    """The request of a caller beside the file: method, budget, how many answers.

    method: None for the scene's own choice. top: answers in proven order. gap: see `solve`.
    """

    method: str | None = None
    budget: Budget = field(default_factory=Budget)
    seed: int = 0
    watch: Watch | None = None
    gap: float = GAP
    top: int = 1

    @property
    def half(self) -> "Ask":
        """The request in half of its seconds: an answer that leaves time to explain it."""
        seconds = self.budget.seconds and 0.5 * self.budget.seconds
        return replace(self, budget=replace(self.budget, seconds=seconds))

    @property
    def beforehand(self) -> "Ask":
        """What is asked of gears that come first: in half of the seconds, by any method."""
        budget = Budget(seconds=self.half.budget.seconds)
        return Ask(budget=budget, watch=of_others(self.watch))

    def for_prices(self, share: bool | float, spent: float) -> "Ask":
        """The request for sensitivities, after an answer that took so many seconds.

        share: True for all that is left; else of these seconds, and LEAST_PRICES, at most.
        """
        left = self.budget.less(spent)
        if share is not True:
            most = max(LEAST_PRICES, share * spent)
            left = replace(left, seconds=most if left.seconds is None else min(most, left.seconds))
        return replace(self, budget=left)


def unseeded(method: str | None) -> dict[str, str]:
    """Return that a seed changes nothing, for a kind whose own methods are not random."""
    return {} if method in RANDOM else {"seed": f"{method or 'the method'} is not random"}


def without_method(ask: Ask, nothing: str) -> None:
    """Raise SolveError where a method is named although nothing is chosen; nothing: why."""
    if ask.method is not None:
        raise SolveError(f"--method {ask.method} changes nothing here: {nothing}; leave it out")
