"""Random drives with given teeth, modules and widths, and brute force over every single number.

Written from the file's side: numbers are found by walking its tables, moved in its text, and the
edited text is read anew. Whole teeth are decided by listing every train.
"""

import random
import re
import sys
from fractions import Fraction
from pathlib import Path

from scene_files import dump, parse

from gearopt import solve
from gearopt.formulations.drive import continuous_sizing
from gearopt.physics.gears import MODULES
from gearopt.scenes.reading.load import read
from gearopt.scenes.reading.toml_writing import toml_text

sys.path.append(str(Path(__file__).parents[1] / "formulations"))
from brute_force import every_train  # noqa: E402

HEAD = 'gearopt = 1\nkind = "drive"\n'
STEP = Fraction(1, 1000)  # of a real value, one step smaller
EASIER = {  # limits and the ends of ranges: which way is easier
    "k_factor": 1,
    "unit_load": 1,
    "wheel_diameter": 1,
}
NUMBER = re.compile(r"[0-9.]+(?:[eE][+-]?[0-9]+)?")


def given_drive(seed):
    """The text of a random drive, most of them impossible."""
    draw = random.Random(seed)
    count = draw.choice([1, 2, 2, 2, 3])
    whole = draw.random() < 0.75
    ratio = round(draw.uniform(1.5, 6.5) ** count, draw.choice([0, 1, 2]))
    even = max(ratio, 1.0) ** (1 / count)
    least = draw.randint(17, 22)
    limits = [
        'k_factor = "2.07 MPa"',
        'unit_load = "48 MPa"',
        f"pinion_teeth = [{least}, {least + draw.randint(0, 6)}]",
    ]
    size = 29 * (9.549 * 7.5 / 1.45 * ratio) ** (1 / 3)  # mm, of the last wheel
    if draw.random() < 0.4:
        limits.append(f"wheel_teeth = [{least}, {int(least * even * draw.uniform(0.7, 1.3)) + 5}]")
    elif whole and count == 3:
        limits.append(f"wheel_teeth = [{least}, {int(least * even * 1.5) + 5}]")
    if draw.random() < 0.4:
        limits.append(f'wheel_diameter = "{size * draw.uniform(0.7, 1.5):.0f} mm"')
    if draw.random() < 0.3:
        limits.append(f"stage_ratio = [1, {even * draw.uniform(0.8, 1.4) + 0.2:.2f}]")
    if draw.random() < 0.3:
        limits.append(f'module = ["{draw.choice([1, 1.5, 2])} mm", "{draw.choice([3, 4, 6])} mm"]')
    stages = "\n".join(_stage(draw, least, even, size * even ** (k - count)) for k in range(count))
    lists = ['"ISO 54 I"', '"ISO 54 I+II"', '["1.5 mm", "2 mm", "3 mm", "4 mm"]', '["2 mm"]']
    coprime = draw.choice(["false", "false", "false", "true"])
    teeth = f"[teeth]\nmodules = {draw.choice(lists)}\ncoprime = {coprime}"
    return f"""{HEAD}
[duty]
power = "7.5 kW"
input_speed = "1450 rpm"
ratio = {ratio}
ratio_tolerance = "{draw.choice(["1 %", "2 %", "0.5 %"])}"
{stages}
[limits]
{chr(10).join(limits)}
{teeth if whole else ""}
"""


def _stage(draw, least, even, size):
    """A stage that gives some of its numbers; size [mm] of its wheel, about."""
    lines = ["[[stage]]"]
    pinion = draw.randint(least - 2, least + 8)
    if draw.random() < 0.6:
        lines.append(f"pinion_teeth = {pinion}")
    if draw.random() < 0.6:
        lines.append(
            f"wheel_teeth = {max(pinion, round(pinion * even * draw.uniform(0.85, 1.15)))}"
        )
    if draw.random() < 0.3:
        lines.append(f'module = "{draw.choice([1.5, 2, 2.5, 3, 4])} mm"')
    if draw.random() < 0.25:
        lines.append(f'face_width = "{size * draw.uniform(0.15, 0.4):.0f} mm"')
    else:
        proportion = round(draw.uniform(0.4, 1.0), 2)
        ends = draw.choice([f"{proportion}", f"[0.3, {proportion}]"])
        lines.append(f"face_width_over_diameter = {ends}")
    return "\n".join(lines)


def feasible(text):
    """Whether a file has a design: by listing every train, or by the proof of real-valued sizes."""
    _, scene = read(text.encode())
    train = scene.train()
    if scene.teeth is None:
        status = solve(continuous_sizing.problem(train)).status
        assert status in ("optimal", "infeasible"), status
        return status == "optimal"
    return len(every_train(train).values) > 0


def with_changes(text, changes):
    """The text of the file with changes (key, text to write) applied; None where it is refused."""
    content = parse(text)
    for key, write in changes:
        *tables, name = key.split(".")
        here = content
        for table in tables:
            stem, _, index = table.rstrip("]").partition("[")
            here = here[stem]
            here = here[int(index) - 1] if index else here
        here[name] = parse(f"x = {write}")["x"]
    return dump(content)


def readable(text):
    """Whether the rules of the file take a text."""
    from gearopt.errors import SceneError

    try:
        read(text.encode())
    except SceneError:
        return False
    return True


def smaller(text, change):
    """The text to write for a change one step smaller: a tooth, a module of the list, 0.1 %."""
    return _nearer(text, change.key, change.was, change.write)


def _nearer(text, key, was, write):
    old, new = NUMBER.findall(was), NUMBER.findall(write)
    old = old * len(new) if len(old) == 1 else old
    pairs = iter(zip(old, new, strict=True))
    return NUMBER.sub(lambda _: _one_nearer(text, key, *next(pairs)), write)


def _one_nearer(text, key, was, now):
    a, b = Fraction(was), Fraction(now)
    if a == b:
        return now
    if key.endswith("module") and "teeth" in parse(text):
        between = [m for m in series(text) if min(a, b) < m < max(a, b)]
        return decimal(min([*between, a], key=lambda m: abs(m - b)))
    if key.endswith("_teeth"):
        return str(int(b) + (1 if a > b else -1))
    return decimal(b * (1 - STEP if b > a else 1 + STEP))


def decimal(number):
    return f"{float(number):.12g}"


def series(text):
    """The modules [mm] that [teeth] allows."""
    modules = parse(text)["teeth"].get("modules", "ISO 54 I")
    if isinstance(modules, str):
        return [Fraction(m) for m in MODULES[modules]]
    return [Fraction(NUMBER.match(m)[0]) for m in modules]


def factor(change):
    """How far a change moves its number, from its two texts."""
    old, new = NUMBER.findall(change.was), NUMBER.findall(change.write)
    pairs = zip([Fraction(x) for x in old], [Fraction(x) for x in new], strict=True)
    product = 1.0
    for a, b in pairs:
        product *= float(max(a, b) / min(a, b))
    return product


def single_changes(text, most):
    """Every change (key, text) of one limit or one given size by a factor below `most`."""
    content = parse(text)
    stages = content.setdefault("stage", [])
    for name, value in content["limits"].items():
        yield from _of_number(text, f"limits.{name}", name, value, most)
        for k, stage in enumerate(stages):
            if name not in stage:
                yield from _of_number(text, f"stage[{k + 1}].{name}", name, value, most)
    for k, stage in enumerate(stages, 1):
        for name, value in stage.items():
            yield from _of_number(text, f"stage[{k}].{name}", name, value, most)


def _of_number(text, key, name, value, most):
    if isinstance(value, list):
        for end, way in ((0, -1), (1, 1)):
            for new in _values(text, key, value[end], way, most, False):
                yield key, toml_text([*value[:end], new, *value[end + 1 :]])
        return
    for way in (EASIER.get(name, 0),) if name in EASIER else (1, -1):
        for new in _values(text, key, value, way, most, name not in EASIER):
            yield key, toml_text(new)


def _values(text, key, value, way, most, single):
    """Values of a number on one side within a factor, in its own unit.

    single: it is given, so that all of them count, not the farthest alone.
    """
    number, _, unit = str(value).partition(" ")
    now, limit = Fraction(number), Fraction(most)
    ends = (now, now * limit) if way > 0 else (now / limit, now)
    if key.endswith("_teeth"):
        inside = [v for v in range(int(ends[0]), int(ends[1]) + 2) if ends[0] < v < ends[1]]
        return inside if single else inside[:1] if way < 0 else inside[-1:]
    if key.endswith("module") and "teeth" in parse(text):
        found = [m for m in series(text) if ends[0] < m < ends[1]]
    else:  # of a limit the farthest is the easiest; what is given need not be
        factors = [1 + (limit - 1) * part / 3 for part in (range(1, 4) if single else (3,))]
        found = [now * f if way > 0 else now / f for f in factors]
        found[-1] = found[-1] * (1 - STEP if way > 0 else 1 + STEP)
    return [f"{decimal(v)} {unit}" if unit else parse(f"x = {decimal(v)}")["x"] for v in found]


def faults(text, found):
    """What is wrong with the remedies of a file, by brute force; [] where nothing is."""
    wrong = []
    for way in found.remedies:
        edits = [(c.key, c.write) for c in way.changes]
        if not feasible(with_changes(text, edits)):
            wrong.append(f"{edits} do not make it possible")
        sure = way.verified.get("with_less") == "infeasible"
        whole = way.kind == "even"
        for back in [way.changes] if whole else [(c,) for c in way.changes]:
            less = with_changes(text, _less(text, way, back)) if sure else ""
            if less and readable(less) and feasible(less):
                wrong.append(f"of {edits} less does: {back}")
    least = [way for way in found.remedies if way.kind == "least"]
    if least and least[0].verified["others"] == "need more":
        (way,) = least
        product = 1.0
        for change in way.changes:
            product *= factor(change)
        for key, write in single_changes(text, product * (1 - 1e-9)):
            other = with_changes(text, [(key, write)])
            if readable(other) and feasible(other):
                wrong.append(f"{key} = {write} alone is less than {product} of {way.changes}")
    return wrong


def _less(text, way, back):
    return [(c.key, smaller(text, c) if c in back else c.write) for c in way.changes]
