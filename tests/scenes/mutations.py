"""Wrong problem files on purpose: each mutation makes (random generator, base text) -> bytes."""

import datetime as dt
import re
import string
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from random import Random

from scene_files import drop, dump, keys, parse, put, quantities, rename, tables_of, walk

DEPTH = 5000
NUMBERS = {
    "negative": -3,
    "zero": 0,
    "nan": Decimal("nan"),
    "infinite": Decimal("-inf"),
    "huge_integer": 10**400,
    "huge_float": Decimal("1e400"),
    "endless_float": Decimal("1e999999999"),
    "tiny_float": Decimal("1e-999999999"),
    "hex_of_thousands_of_digits": 16**DEPTH,
}
TYPES = (
    10**40,  # what may be meant is in NUMBERS and no_unit
    Decimal("1e40"),
    "abc",
    "",
    [],
    [True],
    [1, "a"],
    [1, 2, 3],
    ["x", "y"],
    [[]],
    {},
    {"a": 1},
    [{"a": 1}],
    True,
    dt.datetime(2020, 1, 2, 3, 4, 5),
    dt.date(2020, 1, 2),
    dt.time(3, 4, 5),
    Decimal("nan"),
)
UNITS = ("kW", "rpm", "mm", "MPa", "deg", "kg/dm^3", "%", "Nm", "parsec", "KW", "Rpm", "MM", "mpa")
TEXTS = {
    "empty_text": "",
    "spaces": "   ",
    "unicode_digits": "\u0667\u0665 kW",
    "fullwidth_digits": "\uff17.\uff15 mm",
    "long_text": "x" * 100_000,
    "long_number": "1" * 3000 + " mm",
    "control_characters": "7.5 \x1bkW\n\u2028",
    "huge_quantity": "1" + "0" * 60 + "e400 kW",
    "quantity_with_an_endless_exponent": "1e9999 mm",
    "not_a_number": "nan kW",
    "infinite_quantity": "inf kW",
    "signs": "+-7 kW",
    "two_units": "7 kW kW",
    "decimal_comma": "7,5 kW",
    "thousands_comma": "1,450 rpm",
    "code": "__import__('os').system('true')",
}


@dataclass(frozen=True)
class Mutation:
    """steps: how many remedies a file may need, where the mutation makes several mistakes."""

    make: Callable[[Random, str], bytes]
    steps: int = 1


MUTATIONS: dict[str, Mutation] = {}


def mutation(steps=1, kinds=MUTATIONS):
    def register(make):
        kinds[make.__name__] = Mutation(make, steps)
        return make

    return register


def typo(rng, word):
    """A word with one slip: a letter lost, doubled, swapped, replaced, or other case."""
    k = rng.randrange(1, len(word) - 1)
    return rng.choice(
        [
            word[:k] + word[k + 1 :],
            word[: k + 1] + word[k:],
            word[: k - 1] + word[k] + word[k - 1] + word[k + 1 :],
            word[:k] + rng.choice(string.ascii_lowercase) + word[k + 1 :],
            word.upper(),
            word.replace("_", "-"),
        ]
    )


def _number_kind(name, value):
    def make(rng, text):
        place = rng.choice(keys(parse(text)))
        old = walk(parse(text), place)
        if isinstance(old, list) and old:
            new = list(old)
            new[rng.randrange(len(new))] = value
            return put(text, place, new)
        if isinstance(old, str) and name in ("negative", "zero") and rng.random() < 0.7:
            return put(text, place, f"-{old}" if value else re.sub("^[0-9.]+", "0", old))
        return put(text, place, value)

    MUTATIONS[name] = Mutation(make)


def _text_kind(name, value):
    def make(rng, text):
        place = rng.choice(keys(parse(text)))
        return put(text, place, value)

    MUTATIONS[name] = Mutation(make)


for _name, _number in NUMBERS.items():
    _number_kind(_name, _number)
for _name, _text in TEXTS.items():
    _text_kind(_name, _text)


@mutation()
def wrong_unit(rng, text):
    place = rng.choice(quantities(parse(text)))
    number = walk(parse(text), place).split()[0]
    return put(text, place, f"{number} {rng.choice(UNITS)}")


@mutation()
def no_unit(rng, text):
    place = rng.choice(quantities(parse(text)))
    number = walk(parse(text), place).split()[0]
    return put(text, place, rng.choice([number, Decimal(number), int(Decimal(number))]))


@mutation(steps=2)  # a list of one wrong entry is also too short
def wrong_type(rng, text):
    return put(text, rng.choice(keys(parse(text))), rng.choice(TYPES))


@mutation(steps=7)  # three entries that are no [[stage]], then four lists that go with their number
def wrong_type_of_table(rng, text):
    places = [place[:1] for place, _ in tables_of(parse(text))]
    return put(text, rng.choice(places), rng.choice(TYPES))


@mutation()
def missing_key(rng, text):
    return drop(text, rng.choice(keys(parse(text))))


@mutation(steps=3)
def missing_table(rng, text):
    return drop(text, rng.choice([place[:1] for place, _ in tables_of(parse(text))]))


@mutation()
def misspelt_key(rng, text):
    words = [p for p in keys(parse(text)) if p[-1].isidentifier() and len(p[-1]) > 2]
    place = rng.choice(words)
    return rename(text, place, typo(rng, place[-1]))


@mutation()
def misspelt_table(rng, text):
    name = rng.choice([place[0] for place, _ in tables_of(parse(text))])
    return rename(text, (name,), typo(rng, name))


@mutation()
def unknown_key(rng, text):
    names = (
        "colour",
        "a.b",
        "",
        'q"uote',
        "new\nline",
        "k" * 5000,
        "\u00e9t\u00e9",
        "\x1b[31m",
        "[1]",
    )
    table = rng.choice([place for place, _ in tables_of(parse(text))] + [()])
    return put(text, (*table, rng.choice(names)), rng.choice(TYPES))


@mutation()
def unknown_table(rng, text):
    names = ("bearings", "shaft.first", "", "long" * 2000)
    value = rng.choice([{}, {"a": 1}, {"a": {"b": []}}, [{"a": 1}, {}]])
    return put(text, (rng.choice(names),), value)


@mutation(steps=2)
def key_in_the_wrong_table(rng, text):
    content = parse(text)
    place = rng.choice([p for p in keys(content) if len(p) > 1])
    value = walk(content, place)
    return put(drop(text, place).decode(), (place[-1],), value)


@mutation(steps=6)  # with the number of stages, lists of shafts and slabs change
def table_for_list_of_tables(rng, text):
    content = parse(text)
    name = rng.choice([place[0] for place, _ in tables_of(content)])
    value = content[name]
    return put(text, (name,), value[0] if isinstance(value, list) else [value])


@mutation()
def ends_swapped(rng, text):
    content = parse(text)
    places = [p for p in keys(content) if isinstance(v := walk(content, p), list) and len(v) == 2]
    place = rng.choice(places or keys(content))
    value = walk(content, place)
    return put(text, place, value[::-1] if isinstance(value, list) else [value, value, value])


@mutation()
def output_too_fast(rng, text):
    content = parse(text)
    content["duty"].pop("ratio", None)
    speed = f"{rng.randint(2, 9)}e12 rpm"  # more than a million times the input's
    return put(dump(content), ("duty", "output_speed"), speed)


@mutation()
def two_that_exclude_each_other(rng, text):
    content = parse(text)
    limits, stages = content["limits"], content.get("stage", [])
    choices = [
        (("duty", "ratio"), 20),
        (("duty", "output_speed"), "20 rpm"),
        (("limits", "k_factor"), "2 MPa"),
        (("stages",), len(stages) + 1),
    ]
    if "k_factor" in limits:
        choices = [c for c in choices if c[0] != ("limits", "k_factor")]
    if stages and "face_width" in stages[-1]:
        choices += [(("stage", len(stages) - 1, "face_width_step"), "2 mm")]
        choices += [(("stage", len(stages) - 1, "face_width_over_diameter"), Decimal("0.05"))]
    if "face_width_step" in str(content):
        choices += [(("gears", "face_width_over_diameter"), Decimal("0.7"))]
    place, value = rng.choice(choices)
    return put(text, place, value)


@mutation()
def no_module_left(rng, text):
    range_ = rng.choice([["2.1 mm", "2.2 mm"], ["60 mm", "70 mm"], ["0.1 mm", "0.01 in"]])
    stages = parse(text).get("stage", [])
    places = [("limits", "module")] + [("stage", k, "module") for k in range(len(stages))]
    return put(text, rng.choice(places), range_)


@mutation(steps=5)
def too_many_stages(rng, text):
    content = parse(text)
    content.pop("stages", None)
    content["stage"] = [{"face_width_over_diameter": [Decimal("0.3"), 1]}] * 7
    return dump(content).encode()


@mutation(steps=5)
def several(rng, text):
    """Two or three mistakes at once."""
    of_keys = [*NUMBERS, *TEXTS, "wrong_type", "missing_key", "misspelt_key", "unknown_key"]
    for name in rng.choices(of_keys, k=rng.choice([2, 3])):
        text = MUTATIONS[name].make(rng, text).decode()
    return text.encode()
