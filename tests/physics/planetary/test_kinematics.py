"""Speeds, torques and efficiencies of planetary trains: published, in closed form, two ways."""

from fractions import Fraction as F
from itertools import permutations

import numpy as np
import pytest
from campaigns import few
from train_of_meshes import Mesh, balances, speeds

from gearopt.physics.planetary.willis import Use, efficiency, flow, ratio_parts, set_teeth

SIMPLE = ("sun", "ring", "carrier")
WOLFROM = (("sun", "ring1", "carrier"), ("sun", "ring2", "carrier"))
ETA = F(97, 100)


def simple(sun, planet, ring, eta=F(1), names=SIMPLE, moon="planet"):
    s, r, c = names
    return [Mesh(s, moon, c, sun, planet, eta), Mesh(moon, r, c, planet, -ring)]


def wolfrom(sun, p1, r1, p2, r2, etas=(F(1), F(1), F(1))):
    return [
        Mesh("sun", "planet", "carrier", sun, p1, etas[0]),
        Mesh("planet", "ring1", "carrier", p1, -r1, etas[1]),
        Mesh("planet", "ring2", "carrier", p2, -r2, etas[2]),
    ]


def only(flows):
    (flow,) = flows
    return flow


@pytest.mark.parametrize(
    ("held", "source", "eta"),
    [
        ("ring", "sun", 0.976),
        ("ring", "carrier", 0.975855130784708),
        ("sun", "ring", 0.994),
        ("sun", "carrier", 0.9938524590164),
        ("carrier", "sun", 0.97),
        ("carrier", "ring", 0.97),
    ],
)
def test_six_directions_of_a_simple_set(held, source, eta):
    """r = 4, basic efficiency 0.97: (1 + r eta)/(1 + r), (1 + r)/(1 + r/eta) and so on."""
    (sink,) = {*SIMPLE} - {held, source}
    meshes = simple(20, 30, 80, ETA)
    flow = only(balances(meshes, speeds(meshes, {source: 1, held: 0}), source, sink, [held]))
    assert float(flow.efficiency) == pytest.approx(eta, rel=1e-12)
    use = Use((SIMPLE,), source, sink, (held,))
    assert efficiency(use, [(F(20), F(80))], [(ETA, F(1))]) == flow.efficiency
    if (held, source) == ("ring", "sun"):
        torques = [flow.torques.get(name) for name in SIMPLE]
        assert torques == [1, F("3.88"), F("-4.88")]


def test_published_speeds():
    """Sources: see each line; all exact."""
    meshes = simple(18, 36, 93)  # 5 MW wind gearbox, public report: 294.5/min, 162105.5 N m
    turning = speeds(meshes, {"sun": F("294.5"), "ring": 0})
    assert float(turning["carrier"]) == pytest.approx(47.8, abs=0.05)
    slip = turning["planet"] - turning["carrier"]
    assert abs(float(slip)) == pytest.approx(123.4, abs=0.05)
    flow = only(balances(meshes, turning, "sun", "carrier", ["ring"]))
    torques = {name: 162105.5 * float(t) for name, t in flow.torques.items()}
    assert torques["carrier"] == pytest.approx(-999650.881, rel=1e-6)
    assert torques["ring"] == pytest.approx(837545.3, rel=1e-6)
    ratio = 1 / speeds(simple(21, 39, 99), {"sun": 1, "ring": 0})["carrier"]  # 750 kW test gearbox
    assert float(ratio) == pytest.approx(5.7142857142857, rel=1e-12)
    assert float(ratio * F(82, 23) * F(88, 22)) == pytest.approx(81.491, abs=5e-4)
    ratio = 1 / speeds(simple(26, 31, 89), {"sun": 1, "ring": 0})["carrier"]  # 10 MW reference
    assert float(ratio) == pytest.approx(4.42307692307692, rel=1e-12)
    split = speeds(simple(30, 24, 78), {"carrier": 2333, "sun": 6500})  # power split, 2008
    assert float(split["ring"]) == pytest.approx(730.0, abs=0.5)
    book = speeds(simple(20, 30, 80), {"sun": 100, "ring": 0})  # a textbook's example
    assert book["carrier"] == 20 and book["planet"] == F(-100, 3)


def test_the_paradox_of_three_suns():
    """A planet on wheels of 99, 100 (held) and 101 teeth: -1/99 and 1/101 of the carrier."""
    meshes = [Mesh(f"z{z}", "planet", "carrier", z, 20) for z in (99, 100, 101)]
    turning = speeds(meshes, {"carrier": 1, "z100": 0})
    assert (turning["z99"], turning["z101"]) == (F(-1, 99), F(1, 101))


def test_three_k_sets():
    """50.4: public repository CKraft11/pygeartrain. 116: ratio of Willis, losses by balance."""
    turning = speeds(wolfrom(5, 4, 13, 6, 21), {"sun": 1, "ring1": 0})
    assert 1 / turning["ring2"] == F("50.4")
    meshes = wolfrom(18, 36, 90, 33, 87, (F("0.99"), F("0.995"), F("0.995")))
    turning = speeds(meshes, {"sun": 1, "ring1": 0})
    assert 1 / turning["ring2"] == 116 and turning["carrier"] == F(1, 6)
    flow = only(balances(meshes, turning, "sun", "ring2", ["ring1"]))
    assert float(flow.efficiency) == pytest.approx(0.834865616964, rel=1e-9)
    assert float(flow.torques["ring1"]) == pytest.approx(95.8444115679, rel=1e-9)
    ring = float(flow.meshes[1].rolling - flow.meshes[1].lost)
    assert ring == pytest.approx(15.974068594643, rel=1e-9)
    lost = sum(mesh.lost for mesh in flow.meshes)
    assert 1 - lost == flow.efficiency  # what meshes lose is what the output lacks
    use = Use(WOLFROM, "sun", "ring2", ("ring1",), True)
    teeth = [(F(18), F(90)), (F(18 * 33), F(36 * 87))]
    assert efficiency(use, teeth, [(F("0.99"), F("0.995"))] * 2) == flow.efficiency


def test_a_stepped_set():
    """24/48/20/92: 10.2; input torque over 1 + r eta^2."""
    meshes = [Mesh("sun", "p", "c", 24, 48, ETA), Mesh("p", "ring", "c", 20, -92, ETA)]
    turning = speeds(meshes, {"sun": 1, "ring": 0})
    assert 1 / turning["c"] == F("10.2")
    flow = only(balances(meshes, turning, "sun", "c", ["ring"]))
    assert flow.efficiency == (1 + F("9.2") * ETA**2) / F("10.2")


def test_a_three_k_set_locks_itself_as_a_speed_increaser():
    """Of high ratio and rough teeth: driven from the slow ring nothing comes out."""
    rough = (F("0.95"), F("0.95"), F("0.95"))
    meshes = wolfrom(18, 36, 90, 33, 87, rough)
    turning = speeds(meshes, {"ring2": 1, "ring1": 0})
    assert balances(meshes, turning, "ring2", "sun", ["ring1"]) == []
    use = Use(WOLFROM, "ring2", "sun", ("ring1",), True)
    teeth = [(F(18), F(90)), (F(18 * 33), F(36 * 87))]
    assert efficiency(use, teeth, [rough[:2]] * 2) == 0


def test_losses_that_balance_a_ratio_are_no_division_by_zero():
    """r_1 = 4, r_2 = 3.96 and a ring mesh of 0.99: with one sign of its power r_1' = r_2'."""
    meshes = wolfrom(20, 30, 80, 25, 66, (F(1), F(1), F("0.99")))
    use = Use(WOLFROM, "sun", "ring2", ("ring1",), True)
    turning = speeds(meshes, {"sun": 1, "ring1": 0})
    flows = balances(meshes, turning, "sun", "ring2", ["ring1"])
    losses = [(F(1), F(1)), (F(1), F("0.99"))]
    teeth = [(F(20), F(80)), (F(20 * 25), F(30 * 66))]
    assert efficiency(use, teeth, losses) == min((f.efficiency for f in flows), default=0)
    arrays = [(np.array([float(a)]), np.array([float(b)])) for a, b in teeth]
    eta = efficiency(use, arrays, [(float(a), float(b)) for a, b in losses])
    assert eta[0] == pytest.approx(float(efficiency(use, teeth, losses)), rel=1e-9)


def test_speeds_that_contradict_each_other_or_do_not_suffice():
    for given in ({"sun": 1}, {"sun": 1, "ring": 0, "carrier": 1}):
        with pytest.raises(ValueError, match="set those of all members"):
            speeds(simple(20, 30, 80), given)


def case(rng):
    """A random train of one of four arrangements: meshes, sets, their teeth and losses."""
    z = [int(v) for v in rng.integers(12, 90, 6)]
    etas = [F(int(v), 1000) for v in rng.integers(900, 1000, 4)]
    kind = int(rng.integers(4))
    s, p, q = z[:3]
    if kind == 0:
        meshes = [Mesh("sun", "p", "carrier", s, p, etas[0])]
        meshes.append(Mesh("p", "ring", "carrier", p, -(s + 2 * p), etas[1]))
        sets, teeth, shared = (SIMPLE,), [(s, p, p, s + 2 * p)], False
    elif kind == 1:
        r = s + p + q
        meshes = [Mesh("sun", "p", "carrier", s, p, etas[0])]
        meshes.append(Mesh("p", "ring", "carrier", q, -r, etas[1]))
        sets, teeth, shared = (SIMPLE,), [(s, p, q, r)], False
    elif kind == 2:
        r, t = s + 2 * p, s + p + q
        meshes = wolfrom(s, p, r, q, t, (etas[0], etas[1], etas[2]))
        etas = [etas[0], etas[1], etas[0], etas[2]]
        sets, teeth, shared = WOLFROM, [(s, p, p, r), (s, p, q, t)], True
    else:
        names, teeth = [f"{n}{k}" for k in (1, 2) for n in SIMPLE], []
        joined = JOINED[int(rng.integers(len(JOINED)))]
        names = [joined.get(name, name) for name in names]
        meshes = []
        sets = (tuple(names[:3]), tuple(names[3:]))
        for k, name in enumerate(sets):
            s, p = z[2 * k : 2 * k + 2]
            teeth.append((s, p, p, s + 2 * p))
            meshes.append(Mesh(name[0], f"p{k}", name[2], s, p, etas[2 * k]))
            meshes.append(Mesh(f"p{k}", name[1], name[2], p, -s - 2 * p, etas[2 * k + 1]))
        shared = False
    return meshes, sets, teeth, etas, shared


JOINED = (
    {"carrier2": "ring1"},
    {"sun2": "carrier1"},
    {"sun2": "sun1", "carrier2": "ring1"},
    {"carrier2": "ring1", "ring2": "carrier1"},
    {"sun2": "sun1", "ring2": "carrier1"},
    {"carrier1": "sun1", "ring2": "sun1"},  # the first set turns as one
)


@pytest.mark.parametrize("seed", few(range(5), 2))
def test_two_ways_agree(seed):
    """200 random trains: the linear system of all meshes against Willis and Cramer, exactly."""
    rng = np.random.default_rng(seed)
    for _ in range(40):
        meshes, sets, numbers, etas, shared = case(rng)
        teeth = set_teeth(numbers)
        names = list(dict.fromkeys(n for group in sets for n in group))
        held = len(names) - len(sets) - 1
        order = [str(n) for n in rng.permutation(names)]
        if shared:  # the carrier is free
            order = [str(n) for n in rng.permutation(["sun", "ring1", "ring2"])]
        source, sink, fixed = order[0], order[1], tuple(order[2 : 2 + held])
        use = Use(sets, source, sink, fixed, shared)
        above, below = ratio_parts(use, teeth)
        if above == 0 or below == 0:
            continue
        turning = speeds(meshes, {source: 1} | dict.fromkeys(fixed, 0))
        assert 1 / turning[sink] == F(above, below)
        flows = balances(meshes, turning, source, sink, fixed)
        exact = [(F(a), F(b)) for a, b in teeth]
        losses = [(etas[2 * k], etas[2 * k + 1]) for k in range(len(sets))]
        eta = efficiency(use, exact, losses)
        assert eta == min((f.efficiency for f in flows), default=0)
        for other in flows:
            assert sum(other.torques.values()) == 0
            power = sum(t * turning[n] for n, t in other.torques.items())
            assert power == sum(m.lost for m in other.meshes) and 0 < other.efficiency <= 1
        known = flow(use, numbers, losses)
        assert [*known.speeds.values()] == [*turning.values()]
        if not flows:
            assert (known.torques, known.meshes, known.efficiency) == ({}, (), 0)
            continue
        least = min(flows, key=lambda f: f.efficiency)
        assert {n: t for n, t in known.torques.items() if t} == {
            n: t for n, t in least.torques.items() if t
        }
        powers = [(m.rolling, m.lost, m.driver in names) for m in known.meshes]
        assert powers == [(m.rolling, m.lost, m.driver in names) for m in least.meshes]
        arrays = [(np.array([a]), np.array([b])) for a, b in teeth]
        by_floats = efficiency(use, arrays, [(float(a), float(b)) for a, b in losses])
        assert by_floats[0] == pytest.approx(float(eta), rel=1e-11, abs=1e-300)


def test_every_permutation_of_a_simple_set_has_the_ratio_of_willis():
    for source, sink, held in permutations(SIMPLE):
        turning = speeds(simple(23, 31, 85), {source: 1, held: 0})
        row = {"sun": F(23), "ring": F(85), "carrier": F(-108)}
        assert turning[sink] == -row[source] / row[sink]
