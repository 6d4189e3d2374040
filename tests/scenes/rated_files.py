"""Files of given gears to be rated, as tables; every call gives new ones."""

import copy

PAIR = {
    "duty": {"power": "7.5 kW", "input_speed": "1450 rpm"},
    "gears": {"treatment": "carburised"},
    "stage": [{"module": "3 mm", "pinion_teeth": 20, "wheel_teeth": 60, "face_width": "30 mm"}],
    "rating": {"life": "20000 h", "quality": 8, "overload_factor": 1.25},
}
SECOND = {"module": "4 mm", "pinion_teeth": 18, "wheel_teeth": 67, "face_width": "60 mm"}


def pair(rating=None, duty=None, gears=None, pinion=None, wheel=None, load=None, **stage):
    """The tables of a file of one stage, with keys of its tables changed."""
    made = copy.deepcopy({"gearopt": 1, "kind": "drive"} | PAIR)
    made["stage"][0] |= stage | {"pinion": pinion or {}, "wheel": wheel or {}}
    for name, more in (("rating", rating), ("duty", duty), ("gears", gears)):
        made[name] |= more or {}
    return made | ({"load": load} if load else {})


def two_stages(first=None, second=None, **more):
    """The tables of a file of two stages."""
    made = pair(**more)
    made["stage"][0] |= first or {}
    made["stage"].append(SECOND | (second or {}))
    return made


def without(tables, table, key):
    """The tables without a key of one of them."""
    place = tables[table][0] if table == "stage" else tables[table]
    del place[key]
    return tables


def numbers_of(held, place=""):
    """Every number of nested tables by its place."""
    if isinstance(held, dict):
        return {k: v for n, h in held.items() for k, v in numbers_of(h, f"{place}.{n}").items()}
    if isinstance(held, list):
        rows = enumerate(held)
        return {k: v for n, h in rows for k, v in numbers_of(h, f"{place}[{n}]").items()}
    number = isinstance(held, int | float) and not isinstance(held, bool)
    return {place: held} if number else {}
