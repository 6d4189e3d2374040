"""The search of planetary trains against brute force, and published sets."""

import math
from dataclasses import replace
from fractions import Fraction as F
from itertools import product

import numpy as np
import pytest
from campaigns import few
from train_of_meshes import Mesh, balances, speeds

from gearopt.formulations.epicyclic import problem
from gearopt.formulations.epicyclic.request import (
    COUPLED,
    ERROR,
    GEARS,
    LOSS,
    RING,
    SIMPLE,
    STEPPED,
    WOLFROM,
    Request,
)
from gearopt.formulations.epicyclic.search import best
from gearopt.optimise.clock import Clock
from gearopt.optimise.result import Budget
from gearopt.optimise.solve import solve
from gearopt.physics.planetary.willis import Use

ONE = (("sun", "ring", "carrier"),)
TWO = (("sun", "ring1", "carrier"), ("sun", "ring2", "carrier"))
LOSSES = (F("0.99"), F("0.995"))
USES = {
    SIMPLE: [Use(ONE, "sun", "carrier", ("ring",)), Use(ONE, "sun", "ring", ("carrier",))],
    STEPPED: [Use(ONE, "sun", "carrier", ("ring",)), Use(ONE, "ring", "carrier", ("sun",))],
    WOLFROM: [
        Use(TWO, "sun", "ring2", ("ring1",), True),
        Use(TWO, "ring2", "sun", ("ring1",), True),
    ],
    COUPLED: [
        Use((("sun1", "a", "b"), ("sun1", "b", "out")), "sun1", "out", ("a",)),
        Use((("sun1", "ring1", "c"), ("c", "ring2", "out")), "sun1", "out", ("ring1", "ring2")),
    ],
}
SIZES = {SIMPLE: 9, STEPPED: 7, WOLFROM: 5, COUPLED: 3}


def meshes_of(asked, z):
    """The train as meshes of all its gears."""
    sets = asked.use.sets
    (sun, ring), last = asked.losses[0], asked.losses[-1]
    if asked.arrangement in (SIMPLE, STEPPED):
        p, q = (z[1], z[1]) if len(z) == 3 else z[1:3]
        s, r, c = sets[0]
        return [Mesh(s, "p", c, z[0], p, sun), Mesh("p", r, c, q, -z[-1], ring)]
    if asked.arrangement == WOLFROM:
        one = [Mesh("sun", "p", "carrier", z[0], z[1], sun)]
        one.append(Mesh("p", "ring1", "carrier", z[1], -z[2], ring))
        return [*one, Mesh("p", "ring2", "carrier", z[3], -z[4], last[1])]
    both = []
    for k, (s, r, c) in enumerate(sets):
        sun, ring = asked.losses[k]
        both.append(Mesh(s, f"p{k}", c, z[3 * k], z[3 * k + 1], sun))
        both.append(Mesh(f"p{k}", r, c, z[3 * k + 1], -z[3 * k + 2], ring))
    return both


def whole(angle, z_s, z_p, meshes):
    """Whether some position of a planet's teeth fits the sun and all rings at an angle."""
    turns = ((z_s * angle + k) / z_p for k in range(z_p))
    return any(all((z * angle + p * t).denominator == 1 for z, p in meshes) for t in turns)


def fits(asked, z):
    """Assembly of all planets, gaps, differences and centre distances, set by set."""
    if asked.arrangement == SIMPLE:
        sets = [(z[0], z[1], [(z[2], z[1])], z[1] + 2)]
    elif asked.arrangement == STEPPED:
        sets = [(z[0], z[1], [(z[3], z[2])], max(z[1], z[2]) + 2)]
    elif asked.arrangement == WOLFROM:
        sets = [(z[0], z[1], [(z[2], z[1]), (z[4], z[3])], max(z[1], z[3]) + 2)]
    else:
        sets = [(z[3 * k], z[3 * k + 1], [(z[3 * k + 2], z[3 * k + 1])], z[3 * k + 1] + 2)
                for k in (0, 1)]  # fmt: skip
    for (s, p, rings, tip), n in zip(sets, asked.planets, strict=True):
        if any(abs(r - q - s - p) > asked.coaxial or r - q < asked.difference for r, q in rings):
            return False
        if (s + p) * math.sin(math.pi / n) - tip < asked.clearance - F(1, 10**9):
            return False
        if not all(whole(F(k, n), s, p, rings) for k in range(1, n)):
            return False
    return True


def brute(asked):
    """The best key of all trains, by the linear system of their meshes, in fractions."""
    keys = []
    for z in product(*(range(low, high + 1) for low, high in asked.teeth)):
        if not fits(asked, z):
            continue
        meshes, use = meshes_of(asked, z), asked.use
        try:
            turning = speeds(meshes, {use.source: 1} | dict.fromkeys(use.held, 0))
        except ValueError:
            continue
        if not turning[use.sink]:
            continue
        error = abs(1 / turning[use.sink] / asked.ratio - 1)
        flows = balances(meshes, turning, use.source, use.sink, use.held)
        eta = min((flow.efficiency for flow in flows), default=0)
        if asked.tolerance is not None and error > asked.tolerance:
            continue
        if asked.efficiency is not None and eta < asked.efficiency:
            continue
        rings = [t for t, name in zip(z, asked.gears, strict=True) if name.startswith("ring")]
        keys.append(({ERROR: error, LOSS: 1 - eta, RING: max(rings)}[asked.goal], sum(z), z))
    return min(keys, default=None)


def request(seed):
    """A random request; its ratio is near that of a random train of its ranges."""
    rng = np.random.default_rng(seed)
    kind = (SIMPLE, STEPPED, WOLFROM, COUPLED)[seed % 4]
    lows = [int(v) for v in rng.integers(12, 24, len(GEARS[kind]))]
    if kind == SIMPLE or kind == COUPLED:
        for k in range(2, len(lows), 3):
            lows[k] = lows[k - 2] + 2 * lows[k - 1]
    elif kind == STEPPED:
        lows[3] = sum(lows[:3])
    else:
        lows[2], lows[4] = lows[0] + 2 * lows[1], lows[0] + lows[1] + lows[3]
    teeth = tuple((low, low + SIZES[kind] - 1) for low in lows)
    use = USES[kind][int(rng.integers(2))]
    goal = (ERROR, LOSS, RING)[int(rng.integers(3))]
    asked = Request(
        kind,
        use,
        teeth,
        tuple(int(v) for v in rng.integers(2, 5, 2 if kind == COUPLED else 1)),
        (LOSSES, (F("0.98"), F("0.99")))[: len(use.sets)],
        goal,
        difference=int(rng.integers(8, 40)),
        clearance=F(int(rng.integers(0, 3)), 2),
        coaxial=int(rng.integers(0, 3)),
        efficiency=F(int(rng.integers(900, 985)), 1000) if rng.integers(2) else None,
    )
    if kind == WOLFROM:
        asked = replace(asked, losses=(LOSSES, (F("0.99"), F("0.98"))))
    near = [int(rng.integers(low, high + 1)) for low, high in teeth]
    ratio = F(round(float(asked.exact_ratio(near) or 1) * 100) or 7, 100)
    tolerance = F(int(rng.integers(1, 200)), 1000) if goal != ERROR or rng.integers(2) else None
    return replace(asked, ratio=ratio, tolerance=tolerance)


@pytest.mark.parametrize("seed", few(range(50), (0, 1, 3, 4, 5, 6)))
def test_the_best_is_that_of_all_trains(seed):
    asked = request(seed)
    known = best(asked, Clock())
    assert known.done and known.key == brute(asked)
    result = solve(problem(asked))
    if known.key is None:
        assert result.status == "infeasible"
    else:
        assert result.status == "optimal" and result.gap < 1e-9
        assert result.value == pytest.approx(float(known.key[0]), rel=1e-9, abs=1e-15)


def test_requests_of_the_campaign_are_of_every_sort():
    known = [best(request(seed), Clock()).key for seed in range(50)]
    assert sum(k is None for k in known) >= 5 and sum(k is not None for k in known) >= 20


def test_a_bound_rises_on_the_way_and_a_budget_ends_the_search():
    asked = Request(
        WOLFROM,
        USES[WOLFROM][0],
        ((12, 60), (12, 60), (30, 300), (12, 60), (30, 300)),
        (3,),
        (LOSSES, LOSSES),
        RING,
        F(117),
        F(1, 10_000),
    )
    events = []
    whole_search = best(asked, Clock(watch=events.append))
    bounds = [event.bound for event in events if event.bound is not None]
    assert whole_search.done and bounds == sorted(bounds) and bounds[0] <= whole_search.key[0]
    assert len(bounds) > 1
    stopped = best(asked, Clock(Budget(evaluations=1)))
    assert not stopped.done and stopped.bound <= whole_search.key[0]


def test_a_module_of_its_own_for_the_second_step():
    """The 3K set 5/4/13, 6/21 of CKraft11/pygeartrain has modules of 15 to 9: 50.4."""
    asked = Request(
        WOLFROM,
        USES[WOLFROM][0],
        ((5, 5), (4, 4), (13, 13), (6, 6), (21, 21)),
        (3,),
        (LOSSES, LOSSES),
        ERROR,
        F("50.4"),
        difference=9,
        clearance=F(-10),
        modules=F(9, 15),
    )
    known = best(asked, Clock())
    assert known.key == (0, 49, (5, 4, 13, 6, 21))
    assert best(replace(asked, planets=(6,)), Clock()).key is None
    assert best(replace(asked, modules=F(1)), Clock()).key is None
