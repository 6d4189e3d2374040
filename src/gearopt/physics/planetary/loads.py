"""The mesh load factor K_gamma of planetary stages, by rules that are named."""

from gearopt.frozen import dataclass


@dataclass(frozen=True)
class SharingRule:
    """K_gamma by number of planets; more: of any number above these, None: unknown.

    verified: whether two sources have it.
    """

    values: dict[int, float]
    more: float | None = None
    verified: bool = False


# wind: gfsReboucas/Drivetrain, 1.10 of three printed in its reports; class society: rules of one,
# as a vendor's help has them; square root: 1 + 0.25 sqrt(N - 3), memory
SHARING_RULES = {
    "wind": SharingRule({3: 1.10, 4: 1.25, 5: 1.35, 6: 1.44, 7: 1.47}),
    "class society": SharingRule({3: 1.0, 4: 1.2, 5: 1.3, 6: 1.4}, 1.4, verified=True),
    "square root": SharingRule({n: 1.0 + 0.25 * (n - 3) ** 0.5 for n in range(3, 13)}),
}


def mesh_load_factor(planets: int, rule: str) -> float:
    """K_gamma of a number of planets by one of SHARING_RULES; 1 of a single planet.

    ValueError for another rule, and for a number of planets that the rule has not.
    """
    if rule not in SHARING_RULES:
        raise ValueError(f"no rule {rule!r} of K_gamma; known: {', '.join(SHARING_RULES)}")
    known = SHARING_RULES[rule]
    if planets == 1:
        return 1.0
    if planets > max(known.values) and known.more is not None:
        return known.more
    if planets not in known.values:
        numbers = f"{min(known.values)} to {max(known.values)}"
        raise ValueError(f"no K_gamma of {planets} planets by {rule!r}: {numbers}; give K_gamma")
    return known.values[planets]
