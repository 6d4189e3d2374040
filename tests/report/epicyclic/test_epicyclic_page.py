"""The page of a planetary train: gears stay in mesh as they turn, and sentences are true."""

import numpy as np
import pytest

import gearopt
from gearopt.report.drawing.planetary_view import outline
from gearopt.report.kinds.epicyclic import turning
from gearopt.report.measures import METRIC
from gearopt.report.pages.result import page
from gearopt.report.shown import table_rows

FILES = ("epicyclic_wolfrom", "epicyclic_stepped", "epicyclic_coupled")


def views(result):
    (animation,) = turning(result, METRIC).animations
    return animation.views


def centre(body):
    return body.places[:, 0] + 1j * body.places[:, 1]


def phase(body, direction, inside=False):
    """Pitches from a tooth to a direction, at each moment."""
    teeth = len(body.outline) // 4
    return teeth * (direction - body.places[:, 2]) / (2.0 * np.pi)


@pytest.mark.parametrize("name", FILES)
def test_teeth_meet_spaces_at_every_moment(solved, name):
    """On the line of centres: a tooth of a sun or planet against a space of the other gear."""
    seen = set()
    for view in views(solved(name)):
        sun = [b for b in view.behind if b.title.startswith("sun")]
        rings = [b for b in view.behind if b.title.startswith("ring")]
        planets = [b for b in view.behind if b.title.startswith("planet")]
        assert len(planets) == 3
        for planet in planets:
            line = np.angle(centre(planet))
            for body in sun:
                both = phase(body, line) + phase(planet, line + np.pi)
                assert np.allclose(np.mod(both, 1.0), 0.5, atol=1e-6)
                seen.add("sun")
            for body in rings:
                apart = phase(planet, line) - phase(body, line)
                assert np.allclose(np.mod(apart, 1.0), 0.5, atol=1e-6)
                seen.add("ring")
    assert seen == {"sun", "ring"}


def test_an_outline_has_the_teeth_and_diameters_of_a_gear():
    for teeth, inside in ((20, False), (63, True)):
        radius = np.hypot(*outline(teeth, 2.0, inside).T)
        tip, root = (teeth - 2, teeth + 2.5) if inside else (teeth + 2, teeth - 2.5)
        assert len(radius) == 4 * teeth
        assert sorted({round(r, 9) for r in radius}) == pytest.approx(sorted((tip, root)))


def test_sentences_and_tables_of_a_page(solved):
    result = solved("epicyclic_coupled")
    text = page(result, "")
    assert "spaced equally" in text and "ring1 = carrier2" in text
    rows = table_rows(result, "members", "metric")
    assert {row["member"] for row in rows} >= {"sun1 = sun2", "ring1 = carrier2", "carrier1"}
    power = sum(row["power/input power"] for row in rows)
    lost = sum(row["loss/input power"] for row in table_rows(result, "meshes", "metric"))
    assert power == pytest.approx(lost, rel=1e-12)
    assert len(result.table("planets")) == 6


def test_planets_one_after_the_other_and_at_unequal_places():
    tables = {"gearopt": 1, "kind": "epicyclic", "teeth": {"sun": 17, "planet": 22, "ring": 61}}
    train = {"arrangement": "simple", "ratio": "78/17", "input": "sun", "output": "carrier"}
    result = gearopt.solve(tables | {"train": train | {"planets": 3, "fixed": "ring"}})
    assert "one after the other at the sun" in page(result, "")
    near = train | {"planets": 4, "fixed": "ring", "spacing": "nearest"}
    result = gearopt.solve(tables | {"train": near})
    assert "at 0, 10/39, 1/2, 59/78 of a turn" in page(result, "")
