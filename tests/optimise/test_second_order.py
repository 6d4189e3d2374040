"""Second-order conditions number by number: what counts as curvature, as held, and as a fall."""

import numpy as np
import pytest
from campaigns import few

from gearopt.optimise.form import form
from gearopt.optimise.problem import Problem
from gearopt.optimise.stationarity import evaluated, no_minimum
from gearopt.optimise.terms import Terms, Var

NAMES = "abcd"
OPEN = "not known to be a minimum: limits are active with Lagrange multipliers of zero"


def word(minimise, at, ends=(-3.0, 3.0), guess=1.0, rows=(), prices=(), equal=(), forces=()):
    """What is said of a point: what the objective falls along, "open", or "" of a minimum.

    ends, guess: of all variables, or a list of each one's. rows, equal: texts whose value is 0 at
    their limit, with their multipliers.
    """
    count = len(at)
    ends = ends if isinstance(ends, list) else [ends] * count
    guesses = guess if isinstance(guess, list) else [guess] * count

    def text(x, p):
        own = list(vars(x).values())
        return Terms(
            {"f": minimise(*own)},
            {f"g{k}": 1.0 + row(*own) for k, row in enumerate(rows)},
            equal={f"h{k}": 1.0 + row(*own) for k, row in enumerate(equal)},
        )

    given = zip(NAMES, ends, guesses, strict=False)
    problem = Problem("point", tuple(Var(n, "", *e, g) for n, e, g in given), (), text)
    shape = form(problem)
    low, high, _ = problem.bounds()
    lam = (np.array(m, float) for m in (prices, forces))
    with np.errstate(all="ignore"):  # as in the certificate
        point = evaluated(problem, shape, np.array(at, float), low, high, *lam)
        said = no_minimum(point).words
    return "open" if said == OPEN else said.rpartition(" falls along ")[2]


@pytest.mark.parametrize(("bend", "said"), [(2e-6, "a, b"), (0.5e-6, "")])
def test_curvature_counts_from_a_millionth_of_what_acts(bend, said):
    found = word(lambda a, b: (a**2 + b**2) / 2 + (1 + bend) * a * b, (0, 0))
    assert ", ".join(sorted(found.split(", "))) == said


@pytest.mark.parametrize(("bend", "said"), [(1.2e-6, "a, b"), (0.8e-6, "")])
@pytest.mark.parametrize("unit", [1.0, 100.0])
def test_slopes_of_limits_act_too(bend, said, unit):
    """Along a = -b, which a limit with price 1 leaves free; over the scale of the variables."""

    def text(a, b):
        return -(a + b) / unit - bend * (a - b) ** 2 / 2 / unit**2

    row = {"rows": (lambda a, b: (a + b) / unit,), "prices": (1.0,)}
    found = word(text, (0, 0), (-3 * unit, 3 * unit), unit, **row)
    assert ", ".join(sorted(found.split(", "))) == said
    row = {"rows": (lambda a, b: a + b,), "prices": (1.0,)}
    bend = bend / unit
    found = word(
        lambda a, b: -(a + b) - bend * (a - b) ** 2 / 2, (0, 0), (-3 * unit, 3 * unit), unit, **row
    )
    assert ", ".join(sorted(found.split(", "))) == said


@pytest.mark.parametrize(("bend", "said"), [(2e-2, "b"), (0.5e-2, "")])
def test_beside_a_variable_that_is_acted_on_much_a_little_is_rounding(bend, said):
    assert word(lambda a, b: 5e11 * a**2 - bend * b**2 / 2, (0, 0)) == said
    assert word(lambda a, b, c: 5e11 * a**2 - bend * b**2 / 2, (0, 0, 0)) == said  # c is idle


def test_neither_a_factor_nor_an_idle_variable_hides_curvature():
    assert word(lambda a: -1e-20 * a**2, (0,)) == "a"
    assert word(lambda a, b: -5e-10 * a**2, (0, 0), equal=(lambda a, b: a + b,), forces=(0,)) != ""


PRICES = [(1.0, 0.6e-6, ""), (1.0, 0.4e-6, "a"), (100.0, 6e-5, ""), (100.0, 4e-5, "a")]


@pytest.mark.parametrize(("unit", "slope", "said"), PRICES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_bound_holds_from_a_millionth_of_what_acts(unit, slope, said, sign):
    """The curvature is 1 and acts by half its square; the slope points to the bound."""
    ends = (0.0, 3.0 * unit) if sign > 0.0 else (-3.0 * unit, 0.0)
    given = {"ends": ends, "guess": sign * unit}
    assert word(lambda a: sign * slope * a - a**2 / 2, (0,), **given) == said


@pytest.mark.parametrize(("unit", "price", "said"), PRICES)
@pytest.mark.parametrize("sign", [1.0, -1e3])
def test_a_limit_holds_from_a_millionth_of_what_acts(unit, price, said, sign):
    """It need not be of all variables; by its slope times its price."""
    given = {"ends": (-3.0 * unit, 3.0 * unit), "guess": unit}
    rows = {"rows": (lambda a, b: sign * a,), "prices": (price / abs(sign),)}
    found = word(
        lambda a, b: -np.sign(sign) * price * a - a**2 / 2 + b**2 / 2, (0, 0), **given, **rows
    )
    assert found == said


@pytest.mark.parametrize(
    ("slope", "at", "ends", "said"),
    [
        (-1.0, 0.0, (0.0, 3.0), "a"),  # away from the bound
        (1.0, 3.0, (0.0, 3.0), "a"),
        (0.5, 3.0, (0.0, 3.0), "a"),
        (0.5, 0.0, (0.0, 3.0), ""),
        (1.0, 1.0, (0.0, 3.0), "a"),  # no bound
        (-1.0, 1.0, (0.0, 3.0), "a"),
        (1.0, 1e-6, (0.0, 3.0), ""),
        (1.0, 1.1e-6, (0.0, 3.0), "a"),
        (-1.0, -1e-6, (-3.0, 0.0), ""),
        (-1.0, -1.1e-6, (-3.0, 0.0), "a"),
        (1.0, 0.9e-4, (0.0, 300.0), ""),
        (1.0, 1.1e-4, (0.0, 300.0), "a"),
        (-1.0, -0.9e-4, (-300.0, 0.0), ""),
        (-1.0, -1.1e-4, (-300.0, 0.0), "a"),
        (0.0, 1.0, (1.0, 1.0), ""),  # nowhere to go
    ],
)
def test_which_bounds_hold(slope, at, ends, said):
    """The objective curves down: it falls unless a bound that the slope points to is near."""
    unit = max(1.0, max(map(abs, ends)) / 3.0)
    guess = max(ends[0], min(ends[1], unit if sum(ends) > 0.0 else -unit))
    given = {"ends": [ends, (-1.0, 1.0)], "guess": [guess, 0.0]}
    text = lambda a, b: slope * a - (a - at) ** 2 / 2 / unit + b**2  # noqa: E731
    assert word(text, (at, 0.0), **given) == said


@pytest.mark.parametrize(
    ("ends", "sign"), [([(0, 3), (0, 3)], 1), ([(-3, 0), (-3, 0)], 1), ([(0, 3), (-3, 0)], -1)]
)
def test_bounds_without_a_price_block_one_side(ends, sign):
    """a b is least at the corner; seen from inside it falls. c is anything."""
    guess = [sum(e) / 3 for e in ends]
    assert word(lambda a, b: sign * a * b, (0, 0), ends, guess) == "open"
    more = [*ends, (-3, 3)]
    assert word(lambda a, b, c: sign * a * b, (0, 0, 0), more, [*guess, 1.0]) == "open"
    more = [*ends, (0, 3)]  # c is on a bound of its own
    assert word(lambda a, b, c: sign * a * b, (0, 0, 0), more, [*guess, 1.0]) == "open"
    assert word(lambda a, b, c: a**2 + b**2, (0, 0, 0), more, [*guess, 1.0]) == ""
    hold = {"equal": (lambda a, b, c: c,), "forces": (0.0,)}
    more = [*ends, (-3, 3)]
    found = word(lambda a, b, c: sign * a * b - c**2, (0, 0, 0), more, [*guess, 1.0], **hold)
    assert found == "open"
    inside = word(lambda a, b: -sign * a * b, (0, 0), ends, guess)
    assert inside == "a, b"


@pytest.mark.parametrize(
    ("level", "said"), [(0.0, "open"), (0.9e-6, "open"), (1.1e-6, "a"), (1.0, "a")]
)
@pytest.mark.parametrize("steep", [1.0, 1e-8])
def test_which_limits_without_a_price_block(level, said, steep):
    rows = (lambda a: steep * a - level, lambda a: -steep * a - level)
    assert word(lambda a: -(a**2), (0,), rows=rows, prices=(0, 0)) == said


@pytest.mark.parametrize(("slant", "said"), [(2e-6, "open"), (0.5e-6, "b")])
def test_a_direction_along_a_limit_is_free(slant, said):
    rows = [lambda a, b, s=s, t=t: s * a + t * slant * b for s in (1.0, -1.0) for t in (1.0, -1.0)]
    found = word(lambda a, b: a**2 / 2 - b**2 / 2, (0, 0), rows=rows, prices=(0,) * 4)
    assert found == said


def test_edges_of_limits_without_a_price_are_looked_at():
    """The curvature's own directions are blocked, but it falls along the line that is left."""
    rows = (lambda a, b: a + 0.1 * b, lambda a, b: -a - 0.1 * b)
    found = word(lambda a, b: -(a**2) - b**2 / 2, (0, 0), rows=rows, prices=(0, 0))
    assert found == "b"


def test_limits_without_a_price_are_those_of_the_variables():
    rows = (lambda a, b: a / 100 + b, lambda a, b: -a / 100 - b)
    wide = {"ends": [(-300, 300), (-3, 3)], "guess": [100.0, 1.0]}
    found = word(lambda a, b: -((a / 100 + b) ** 2), (0, 0), **wide, rows=rows, prices=(0, 0))
    assert found == "open"


def test_rows_without_a_slope_hold_nothing():
    assert word(lambda a, b: b**2, (0, 0), equal=(lambda a, b: a**2,), forces=(0,)) == ""


@pytest.mark.parametrize(("turn", "said"), [(5e-9, ""), (5e-10, "b")])
def test_rows_that_repeat_others_hold_nothing_more(turn, said):
    rows = (lambda a, b: -a, lambda a, b: -a - turn * b)
    given = {"rows": rows, "prices": (0.5, 0.5)}
    assert word(lambda a, b: a + turn * b / 2 - b**2, (0, 0), **given) == said


@pytest.mark.parametrize("steep", [1.0, 1e-6])
def test_directions_across_a_limit_with_a_price_do_not_count(steep):
    """Whatever its slope, of an inequality and of an equality."""
    rows, price = (lambda a, b: -steep * a,), (1.0 / steep,)
    assert word(lambda a, b: a - a**2 + b**2, (0, 0), rows=rows, prices=price) == ""
    assert word(lambda a, b: a - a**2 + b**2, (0, 0), equal=rows, forces=price) == ""
    assert word(lambda a, b: a + a**2 - b**2, (0, 0), rows=rows, prices=price) == "b"


@pytest.mark.parametrize(("along", "falls"), [((1.0, 1.0), False), ((1.0, 0.05), True)])
def test_directions_along_a_limit_are_those_of_the_variables(along, falls):
    """50 a^2 + 20 a b + b^2/2 rises along (1, -1) and falls along (0.05, -1)."""
    p, q = along
    text = lambda a, b: 50 * a**2 + 20 * a * b + b**2 / 2 + p * a + q * b  # noqa: E731
    found = word(text, (0, 0), equal=(lambda a, b: -p * a - q * b,), forces=(1.0,))
    assert (found != "") == falls


BENT = {  # objective, equality; whether the objective falls along a
    "level valley": (lambda a, b: (b - a**2) ** 2, None, False),
    "rising valley": (lambda a, b: (b - a**2) ** 2 + a**4, None, False),
    "falling valley": (lambda a, b: (b - a**2) ** 2 - a**4, None, True),
    "between parabolas": (lambda a, b: (b - a**2) * (b - 3 * a**2), None, True),
    "coupled": (lambda a, b: b**2 + 3 * a**2 * b + a**4, None, True),
    "coupled, held": (lambda a, b: b**2 + a**2 * b + a**4, None, False),
    "on a curve": (lambda a, b: 2 * b**2 - a**4, lambda a, b: b - a**2, False),
    "on a low curve": (lambda a, b: 2 * b**2 - a**4, lambda a, b: 0.2 * (b - a**2), False),
    "off a line": (lambda a, b: -(b**2), lambda a, b: b - a**2, True),
    "falls with a force": (lambda a, b: a**2 - b - a**4, lambda a, b: b - a**2, True),
    "rises with a force": (lambda a, b: a**2 - b + a**4, lambda a, b: b - a**2, False),
    "steep": (lambda a, b: 1e3 * (b - a**2) ** 2 - a**4, None, True),
}


@pytest.mark.parametrize("name", BENT)
@pytest.mark.parametrize("turn", few([0.0, 0.4], [0.4]))
def test_valleys_are_followed_along_their_floor(name, turn):
    """Straight on a bent valley rises, and a line leaves an equality; turned and moved too."""
    minimise, row, falls = BENT[name]
    c, s = np.cos(turn), np.sin(turn)

    def turned(text):
        return lambda a, b: text(c * (a - turn) - s * (b - turn), s * (a - turn) + c * (b - turn))

    equal = {} if row is None else {"equal": (turned(row),)}
    force = 1.0 if "force" in name else 0.0
    found = word(turned(minimise), (turn, turn), **equal, forces=(force,) * len(equal))
    assert (found != "") == falls


@pytest.mark.parametrize("name", [n for n in BENT if "force" in n])
def test_what_is_left_of_a_limit_hardly_changes_the_lagrangian(name, monkeypatch):
    """One step towards the curve leaves a cube of the step's length, and it falls by its fourth."""
    monkeypatch.setattr("gearopt.optimise.stationarity.NEWTON", 1)
    test_valleys_are_followed_along_their_floor(name, 0.4)
    sign = -1.0 if "falls" in name else 1.0

    def limit(a, b):
        return (a + b) ** 2 - (b - a) - 3 * (b - a) ** 2

    given = {"rows": (limit,), "prices": (1.0,)}
    found = word(lambda a, b: sign * (a + b) ** 4 - limit(a, b), (0, 0), **given)
    assert (found != "") == (sign < 0.0)


def test_where_nothing_bends_a_direction_is_followed_straight():
    """Curvature of 1e-9 of what acts, and a fourth power that rises or falls."""
    given = {"rows": (lambda a, b: a + b,), "prices": (1.0,)}
    for sign, said in ((1.0, ""), (-1.0, "a, b")):

        def text(a, b, sign=sign):
            return -(a + b) + 1e-9 * (a - b) ** 2 + sign * (a - b) ** 4

        found = word(text, (0, 0), **given)
        assert ", ".join(sorted(found.split(", "))) == said


def test_rounding_of_the_curvature_is_no_fall():
    """Of level valleys in any direction."""
    rng = np.random.default_rng(3)
    for _ in range(4):
        (c, s), (p, q, r) = (f(rng.uniform(0, 7)) for f in (np.cos, np.sin)), rng.normal(size=3)

        def level(a, b, c=c, s=s, p=p, q=q, r=r):
            u, v = c * a - s * b, s * a + c * b
            return (u + p * u**2 + q * u * v + r * v**2) ** 2

        assert word(level, (0, 0)) == ""


def test_slopes_and_curvature_that_are_too_small_to_count_are_no_fall():
    for slope, bend in ((1e-8, 0.0), (-1e-8, 0.0), (0.0, 1e-7), (0.0, -1e-7)):

        def text(a, b, slope=slope, bend=bend):
            return (a - b) ** 2 / 2 + slope * (a + b - 2) + bend * (a + b - 2) ** 2

        assert word(text, (1, 1)) == ""
    assert word(lambda a, b: (b - a**2) ** 2 - 0.01 * a**4 + 4e-7 * b, (0, 0)) == "a"


def test_a_floor_that_bends_by_less_than_a_millionth_is_flat():
    """In the sum and the difference of the variables; rounding of the floor is not divided by."""

    def text(a, b):
        return (b - a - (a + b) ** 2) ** 2 - (a + b) ** 4 + 2e-7 * (a + b) ** 2

    assert word(text, (0, 0)) != ""


def test_a_valley_that_a_limit_bends_is_followed():
    for sign, said in ((-1.0, "a"), (1.0, "")):
        row = {"rows": (lambda a, b: a**2 - b,), "prices": (1.0,)}
        assert word(lambda a, b, s=sign: b - a**2 + s * a**4, (0, 0), **row) == said


@pytest.mark.parametrize(("size", "said"), [(4e-4, "a"), (1e-4, "")])
@pytest.mark.parametrize("unit", [1.0, 100.0])
def test_a_fall_must_be_seen_above_the_rounding(size, said, unit):
    """Of 1 + x^4: at a hundredth of the scale, 1e-12 of what is added up."""
    for offset in (1.0, -1.0):
        text = lambda a, offset=offset: offset - size * (a / unit) ** 4  # noqa: E731
        assert word(text, (0,), (-3 * unit, 3 * unit), unit) == said


def test_rounding_is_that_of_all_terms():
    """1e3 beside a fall of 4e-12, which is seen without it; of limits and equalities too."""
    text = lambda a, b: -4e-4 * a**4 + 1e3 * b  # noqa: E731
    ends = {"ends": [(-3.0, 3.0), (0.0, 3.0)]}
    assert word(lambda a, b: -4e-4 * a**4 + b, (0, 0), **ends) == "a"
    row = (lambda a, b: -b,)
    assert word(text, (0, 0), rows=row, prices=(1e3,)) == ""
    assert word(text, (0, 0), equal=row, forces=(1e3,)) == ""
    back = (lambda a, b: b,)
    assert word(text, (0, 0), equal=back, forces=(-1e3,)) == ""


@pytest.mark.parametrize(
    ("minimise", "said"),
    [
        (lambda a: a**4 - 200 * a**6, ""),  # rises at first
        (lambda a: 0.01 + a**4 - 1e5 * a**6, ""),  # to a thousandth
        (lambda a: -(a**4) + 200 * a**6, ""),  # rises further on
        (lambda a: -(a**4) + 50 * a**6, "a"),
        (lambda a: a**3, "a"),
        (lambda a: -(a**3), "a"),
        (lambda a: a**2 - 50 * a**4, ""),  # not flat
    ],
)
def test_a_fall_is_one_at_every_step(minimise, said):
    assert word(minimise, (0,)) == said


def test_flat_directions_end_at_bounds():
    """Beyond the bound the objective would rise, and on the other side too."""

    def walled(a):
        beyond = np.maximum(a - 1.05, 0.0) + np.maximum(0.95 - a, 0.0)
        return -((a - 1) ** 4) + 1e9 * beyond**2

    assert word(walled, (1,), (0.95, 4.0)) == "a"
    assert word(walled, (1,), (-4.0, 1.05)) == "a"
    assert word(walled, (1,), (-4.0, 4.0)) == ""


def test_variables_with_a_price_stay_while_flat_directions_are_followed():
    text = lambda a, b: a + 1e3 * a**4 - b**4  # noqa: E731
    assert word(text, (0, 0), [(0.0, 3.0), (-3.0, 3.0)]) == "b"


def test_the_variables_are_named_by_their_share_of_their_scale():
    """Most first; those above 0.3 of the largest; three at the most."""
    wide = {"ends": [(-300, 300), (-3, 3)], "guess": [100.0, 1.0]}
    for share, said in ((2.0, "b, a"), (3.2, "b, a"), (3.5, "b")):
        assert word(lambda a, b, s=share: -((s * a / 100 + b) ** 2), (0, 0), **wide) == said
    assert word(lambda a, b, c, d: -((a + b + c + d) ** 2), (0, 0, 0, 0)).count(",") == 2
