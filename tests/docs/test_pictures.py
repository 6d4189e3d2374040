"""Pictures of the docs are what the program draws of stored results, and those are right."""

import hashlib
import re
import tomllib
import xml.etree.ElementTree as ET
from itertools import pairwise

import pictures
import pytest

EVERY = (*pictures.PICTURES, *pictures.FRONTS)
NUMBER = re.compile(r"-?\d+\.?\d*")
PIXEL = 0.011  # two decimals are written


def content(name):
    return (pictures.ROOM / f"{name}.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", EVERY)
def test_the_picture_is_what_is_drawn_now(name):
    """Words alike, numbers to rounding: sines differ in the last digit between machines."""
    draw = pictures.draw if name in pictures.PICTURES else pictures.draw_front
    written, drawn = content(name), draw(name)
    assert NUMBER.sub("#", written) == NUMBER.sub("#", drawn), "run: python docs/generate.py"
    pairs = zip(NUMBER.findall(written), NUMBER.findall(drawn), strict=True)
    assert all(abs(float(a) - float(b)) <= PIXEL for a, b in pairs)


@pytest.mark.parametrize("name", pictures.PICTURES)
def test_the_stored_result_is_of_the_file_as_it_is_and_what_it_expects(name):
    data = (pictures.ROOT / "problems" / f"{name}.toml").read_bytes()
    result, expected = pictures.stored(name), tomllib.loads(data.decode())["x-expected"]
    assert result.file_sha256 == hashlib.sha256(data).hexdigest(), (
        "run: python docs/generate.py --solve"
    )
    assert result.file == f"problems/{name}.toml" and result.status == expected["status"]
    digits = expected.get("tolerance", 1e-8)  # some packings are printed with fewer
    if result.status != "evaluated":
        assert result.value == pytest.approx(expected["objective"], rel=digits)


@pytest.mark.parametrize("name", pictures.FRONTS)
def test_the_stored_front_is_complete_and_of_the_file_as_it_is(name):
    path = pictures.ROOT / "problems" / f"{pictures.FRONTS[name].file}.toml"
    front, data = pictures.stored_front(name), path.read_bytes()
    assert front.file_sha256 == hashlib.sha256(data).hexdigest(), (
        "run: python docs/generate.py --solve"
    )
    least = tomllib.loads(data.decode())["x-expected"]["objective"]
    assert front.status == "complete" and front.points[0].values[0] == pytest.approx(least)
    rows = [p.values for p in front.points]
    assert all(a < c and b > d for (a, b), (c, d) in pairwise(rows))


@pytest.mark.parametrize("name", EVERY)
def test_the_picture_stands_alone(name):
    """Small, well-formed, with both looks inside, and nothing from elsewhere."""
    text = content(name)
    root = ET.fromstring(text)
    assert len(text.encode()) < 40_000
    assert "prefers-color-scheme: dark" in text and "@import" not in text and "url(" not in text
    assert not re.search(r"href|src=|https?://(?!www\.w3\.org/2000/svg)", text)
    used = set(re.findall(r"var\((--[\w-]+)\)", text))
    assert used and all(f"{name}:" in text for name in used)
    assert float(root.get("width")) <= 1000 and float(root.get("height")) <= pictures.HIGH


def test_every_picture_is_made_and_none_is_left_over():
    there = {path.name for path in pictures.ROOM.iterdir()}
    assert there == {f"{name}.{end}" for name in EVERY for end in ("svg", "json")}


def test_the_pages_show_no_picture_that_is_missing():
    shown = {
        target
        for path in (*pictures.ROOM.parent.glob("*.md"), pictures.ROOT / "README.md")
        for target in re.findall(r"!\[[^\]]*\]\([^)]*?pictures/([^)]+)\)", path.read_text("utf-8"))
    }
    assert shown == {f"{name}.svg" for name in EVERY}
