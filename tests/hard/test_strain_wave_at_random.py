"""Strain wave gearings at random: an answer of finite numbers, or a refusal with its key."""

import json
import math
import random

import pytest

import gearopt
from gearopt.errors import SceneError
from gearopt.scenes.reading.load import read

LAWS = ("involute", "involute", "double arc", "half locus")


def file_of(seed):
    """A file of usual numbers, of wild ones for every second seed."""
    draw = random.Random(seed)
    wild, law, ratio = seed % 2 == 1, draw.choice(LAWS), draw.choice((30, 50, 80, 160, 320))
    m = math.exp(draw.uniform(math.log(0.05), math.log(2.0)))

    def some(usual, far, unit=None, scale=1.0):
        value = scale * draw.uniform(*(far if wild else usual))
        return f"{value:.5g}" if unit is None else f'"{value:.5g} {unit}"'

    gears = {
        "module": f'"{m:.5g} mm"',
        "profile_shift": some((0.0, 1.5), (-2.0, 5.0)),
        "addendum": some((0.4, 0.8), (0.05, 2.0)),
        "deflection": some((0.9, 1.2), (0.1, 2.0)),
        "rim": some((0.01, 0.03), (0.001, 0.3), "mm", m * ratio),
        "face_width": some((0.1, 0.3), (0.01, 1.0), "mm", 2.0 * m * ratio),
        "clearance": some((0.2, 0.3), (0.01, 1.0)),
    }
    if law != "half locus":
        gears["pressure_angle"] = some((12.0, 28.0), (1.0, 40.0), "deg")
    teeth = {"law": f'"{law}"'}
    if law == "double arc":
        teeth |= {
            "convex_radius": some((1.2, 1.6), (0.2, 4.0), "mm", m),
            "concave_radius": some((1.3, 1.8), (0.2, 4.0), "mm", m),
            "tangent": some((0.0, 0.2), (0.0, 1.0), "mm", m),
        }
    if law != "involute" and wild:
        teeth["thickness"] = some((1.4, 1.6), (0.1, 3.2), "mm", m)
    wave = {"shape": f'"{draw.choice(("cosine", "ellipse", "discs"))}"'}
    sharing = {"rim": f'"{draw.choice(("rigid", "elastic"))}"'}
    duty = {"torque": f'"{math.exp(draw.uniform(-7.0, 9.0)):.4g} N m"', "ratio": str(ratio)}
    tables = {"duty": duty, "gears": gears, "teeth": teeth, "wave_generator": wave}
    tables |= {"sharing": sharing}
    lines = ["gearopt = 1", 'kind = "strain_wave"']
    for name, keys in tables.items():
        lines += [f"[{name}]", *(f"{key} = {value}" for key, value in keys.items())]
    return "\n".join(lines) + "\n"


def numbers(value):
    """All numbers of plain data."""
    if isinstance(value, dict | list):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from numbers(inner)
    elif isinstance(value, float):
        yield value


def answered(seed):
    """Whether a file is answered; what is refused names a key, what is answered is finite."""
    try:
        found = gearopt.solve(read(file_of(seed).encode())[1])
    except SceneError as wrong:
        assert any(f"{table}." in str(wrong) for table in ("gears", "teeth")), seed
        return False
    assert found.status == "evaluated", seed
    assert all(map(math.isfinite, numbers(json.loads(found.to_json())["design"]))), seed
    assert found.feasible == (max(found.limits.values()) <= 1.0 + 1e-6), seed
    return True


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 24, 6))
def test_files_at_random(first):
    """Some are answered, and wild ones refused."""
    found = [answered(seed) for seed in range(first, first + 6)]
    assert any(found)
