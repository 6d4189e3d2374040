"""The page on the stiffness of teeth holds what the program records and computes."""

from pathlib import Path

import pytest
from reference_pairs import elastic, five, force, stiffness

from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.foundation import torsion_compliance
from gearopt.physics.tooth.hertz import contact_compliance, linear_contact_compliance
from gearopt.physics.tooth.ladder import COUPLINGS, LEVELS

PAGE = (Path(__file__).parents[2] / "docs" / "tooth_stiffness.md").read_text(encoding="utf-8")
# of finite elements, which slow tests compute: tests/physics/tooth/test_finite_elements.py
ELEMENTS = "| `finite elements` | 9.30 | 12.48 | 12.68 | 12.61 | 9.58 |"
BORES = "| profile + Sainsot, % | -23.2 | -13.1 | -5.5 | -1.7 | +3.3 |"


def level_row(name):
    level = LEVELS[name]
    errors = [f"{100 * low:+.1f} to {100 * high:+.1f}" for low, high in (level.error, level.wider)]
    return f"| `{name}` | {level.tooth} | {level.body} | {' | '.join(errors)} | {level.cost:,g} |"


def five_row(name):
    pair = elastic("reference")
    if name == "finite elements":
        return ELEMENTS
    found = stiffness(LEVELS[name].compliance(pair, five(pair), force("reference")), pair)
    return f"| `{name}` | {' | '.join(f'{each:.2f}' for each in found)} |"


@pytest.mark.parametrize("name", LEVELS)
def test_rows_of_the_tables(name):
    assert level_row(name) in PAGE
    assert five_row(name) in PAGE


@pytest.mark.parametrize("name", [*LEVELS, *COUPLINGS])
def test_every_name_stands_on_the_page(name):
    assert f"`{name}`" in PAGE or f'`"{name}"`' in PAGE


def test_parts_of_the_deflection():
    """Micrometres at the load of the reference pair, at the pitch point."""
    pair, load = elastic("reference"), 1e3 * force("reference")
    lines = pair.load_lines(0.0)
    linear = load * linear_contact_compliance(pair)
    log = load * contact_compliance(pair, 0.0, lines, force("reference"))
    narrow = ElasticPair(pair.pair, pair.bores, plane="stress")
    stress = load * contact_compliance(narrow, 0.0, lines, force("reference"))
    assert f"{linear:.2f} µm" in PAGE and f"{log:.1f} µm" in PAGE and f"{stress:.1f} µm" in PAGE
    first, second = (load * torsion_compliance(member) for member in pair.members)
    assert f"{first:.2f} + {second:.2f} µm" in PAGE


def test_numbers_of_finite_elements_are_those_of_their_tests():
    source = Path(__file__).parents[1] / "physics" / "tooth" / "test_finite_elements.py"
    text = source.read_text(encoding="utf-8")
    assert BORES in PAGE
    assert "(1.15, -23.2), (1.4, -13.1), (2.25, -5.5), (4.0, -1.7), (7.0, 3.3)" in text
    assert "4.53 µm" in PAGE and "4.53)" in text
    assert "6.01 µm" in PAGE and "6.01)" in text
