"""Wrong files of a servo axis: each loads, or is refused in one line that mends it."""

from collections import Counter
from random import Random

import pytest
from campaigns import few
from mutations import MUTATIONS
from scene_files import dump, mended, parse

import gearopt
from gearopt.errors import SceneError
from gearopt.optimise.result import Budget
from gearopt.scenes.reading.load import read
from gearopt.scenes.servo import KIND

EXAMPLE = KIND.example.text

OF_DRIVES = (  # mutations that look for tables of a drive
    *("output_too_fast", "two_that_exclude_each_other", "no_module_left", "too_many_stages"),
)
KINDS = [k for k in MUTATIONS if k not in OF_DRIVES]
STEPS = 12  # a table that comes back brings those that it needs, each with its keys
GEARS = 'module = "0.5 mm"\npinion_teeth = 20\nwheel_teeth = 120'
GIVEN = EXAMPLE.replace("[[mesh]]", f"[[mesh]]\n{GEARS}")
ALONE = ("gearopt", "kind", "title", "mesh", "accuracy", "tolerances", "cost", "budget")
LONE = dump({k: v for k, v in parse(GIVEN).items() if k in ALONE})
MOVE = EXAMPLE.replace('motion = "acceleration"', 'motion = "move"\nangle = "90 deg"')
BASES = {"example": EXAMPLE, "given": GIVEN, "lone": LONE, "move": MOVE}


def fate(kind, base, seed):
    """What became of a file: loaded, mended or, without a remedy for machines, refused."""
    data, steps = MUTATIONS[kind].make(Random(f"{kind} {base} {seed}"), BASES[base]), 0
    while True:
        try:
            read_as, scene = read(data, "my.toml")
        except SceneError as wrong:
            assert wrong.rule and wrong.remedy
            for message in str(wrong).splitlines():
                assert message.startswith("my.toml: ") and len(message) < 900, message
                assert message.isprintable(), message
            if wrong.fix is None or wrong.fix.action == "replace":
                return "refused"
            steps += 1
            assert steps <= STEPS, str(wrong)
            data = mended(data.decode("utf-8-sig"), wrong.fix).encode()
            continue
        if read_as == "servo":  # it may have become another kind
            plain_numbers(scene)
        return "mended" if steps else "loaded"


def plain_numbers(scene):
    """What a file that loads is asked for at least."""
    assert scene.sources is not None
    if scene.train is not None:
        assert scene.servo_train().error > 0.0
    if scene.tolerances is not None:
        assert all(price.cost > 0.0 and price.exponent > 0.0 for price in scene.prices)
    if scene.lightest is not None:
        assert scene.stiff_train().stiffness > 0.0


@pytest.mark.parametrize("base", BASES)
def test_the_bases_load(base):
    kind, scene = read(BASES[base].encode())
    plain_numbers(scene)
    assert kind == "servo"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", few(range(3), 1))
def test_every_mutation_of_every_base(kind, seed):
    """Of seed 0, which the default tests have, two bases."""
    assert {fate(kind, base, seed) for base in (BASES if seed else ("example", "lone"))}


def answer(kind, base, seed):
    """Status of a file's answer after its mutation and remedies; empty where it does not load."""
    data = MUTATIONS[kind].make(Random(f"{kind} {base} {seed}"), BASES[base])
    for _ in range(STEPS):
        try:
            read_as, scene = read(data, "my.toml")
        except SceneError as wrong:
            if wrong.fix is None or wrong.fix.action == "replace":
                return ""
            data = mended(data.decode("utf-8-sig"), wrong.fix).encode()
            continue
        if read_as != "servo":
            return ""
        return gearopt.solve(scene, budget=Budget(seconds=0.2)).status
    return ""


@pytest.mark.slow
@pytest.mark.parametrize("block", range(8))
def test_what_loads_is_solved(block):
    """Within little time, and without another error than one that names the file's limits."""
    found = Counter()
    for seed in range(block * 6, (block + 1) * 6):
        kind, base = KINDS[seed % len(KINDS)], list(BASES)[seed % len(BASES)]
        found[answer(kind, base, seed)] += 1
    assert found.keys() <= {"", "optimal", "feasible", "infeasible", "limit"}, found
    assert found["optimal"] > 0


@pytest.mark.slow
@pytest.mark.parametrize("block", range(8))
def test_hundreds_of_files(block):
    found = Counter()
    for seed in range(block * 100, (block + 1) * 100):
        found[fate(KINDS[seed % len(KINDS)], list(BASES)[seed % len(BASES)], seed)] += 1
    assert found["mended"] > 50, found
