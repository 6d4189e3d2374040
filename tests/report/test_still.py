"""The still of a view in space: to scale, the nearest body in front, its texts clear."""

import math
import re
import xml.etree.ElementTree as ET

import layout_cases as cases
import numpy as np
import pytest
from campaigns import few
from page_reader import extents, marks

from gearopt.report.drawing.still import Block, Rod, Texts, covers, in_order, still, view
from gearopt.report.measures import METRIC
from gearopt.report.pages.result import page, sections

MADE = {
    "three stages": cases.three_stage,
    "elevator": cases.elevator,
    "boxed in": cases.boxed_in,
    "shafts in part": cases.partial_span,
    "packing": cases.packing,
    "round": cases.round_packing,
}


def stills(made):
    figures = [f for section in sections(made) for f in section.figures]
    return [ET.fromstring(f.still.svg) for f in figures if f.still]


def rods(seed, count=14):
    """Rods that are apart, by rejection."""
    rng, found = np.random.default_rng(seed), []
    while len(found) < count:
        (b, c), r = rng.uniform(-50.0, 50.0, 2), rng.uniform(4.0, 18.0)
        start = rng.uniform(0.0, 60.0)
        new = Rod((b, c), r, start, start + rng.uniform(4.0, 40.0), "gear")
        if all(apart(new, old) for old in found):
            found.append(new)
    return found


def apart(one, other):
    along = one.start >= other.end or other.start >= one.end
    return along or np.hypot(*np.subtract(one.centre, other.centre)) > one.radius + other.radius


def depth(rod, at, seen):
    """Where the line of sight through a point of the picture leaves a rod; -inf if it misses."""
    basis = np.array([seen.right, seen.up, seen.eye])
    start, eye = np.array([*at, 0.0]) @ basis, basis[2]
    t = np.sort((np.array([rod.start, rod.end]) - start[0]) / eye[0])
    off, across = start[1:] - rod.centre, eye[1:]
    square, half = across @ across, off @ across
    root = half**2 - square * (off @ off - rod.radius**2)
    if root <= 0.0:
        return -np.inf
    low, high = (-half - root**0.5) / square, (-half + root**0.5) / square
    first, last = max(t[0], low), min(t[1], high)
    return last if last > first else -np.inf


@pytest.mark.parametrize("seed", few(range(8), 2))
@pytest.mark.parametrize("axes", ["xyz", "zxy"])
def test_what_is_drawn_last_is_nearest_to_the_eye(seed, axes):
    seen, found = view(axes), rods(seed)
    order = in_order(found, seen)
    assert sorted(map(id, order)) == sorted(map(id, found))
    hit = 0
    for at in np.random.default_rng(seed).uniform(-70.0, 70.0, (150, 2)):
        reached = [depth(rod, at, seen) for rod in order]
        there = [k for k, d in enumerate(reached) if np.isfinite(d)]
        if there:
            hit += len(there) > 1
            assert there[-1] == int(np.argmax(reached))
    assert hit > 2


@pytest.mark.parametrize("seed", few(range(4), 1))
def test_a_place_is_covered_where_its_line_of_sight_meets_a_rod(seed):
    seen, rng, count = view(), np.random.default_rng(seed), 0
    for rod in rods(seed):
        for spot in rng.uniform(-60.0, 60.0, (40, 3)):
            line = spot + np.outer(np.linspace(0.0, 300.0, 6001)[1:], seen.eye)
            inside = np.hypot(*(line[:, 1:] - rod.centre).T) < rod.radius
            inside &= (line[:, 0] > rod.start) & (line[:, 0] < rod.end)
            count += inside.any()
            if inside.sum() != 1:  # not grazed
                assert covers(rod, tuple(spot), seen) == inside.any()
    assert count > 5


def test_the_view_is_from_the_output_end_the_left_and_above():
    seen = view()
    basis = np.array([seen.right, seen.up, seen.eye])
    assert np.allclose(basis @ basis.T, np.eye(3)) and np.linalg.det(basis) > 0.0
    assert seen.eye[0] > 0.0 > seen.eye[1] and seen.eye[2] > 0.0 and seen.right[2] == 0.0
    turned = view("zxy")
    assert turned.at((3.0, 1.0, 2.0)) == pytest.approx(seen.at((1.0, 2.0, 3.0)))


def test_a_rod_is_as_large_as_it_is():
    """Long axes of its ellipses are diameters; a block spans what its corners do."""
    seen, texts = view(), Texts(("x", "y", "z"), ())
    rod, block = (
        Rod((30.0, 40.0), 12.0, 10.0, 50.0, "gear"),
        Block((0, 0, 0), (60, 10, 9), "blocked"),
    )
    drawn = still([rod, block], ((0.0, 0.0, 0.0), (60.0, 80.0, 90.0)), seen, texts, "x")
    spots = [seen.at((a, b, c)) for a in (0.0, 60.0) for b in (0.0, 80.0) for c in (0.0, 90.0)]
    tall = max(v for _, v in spots) - min(v for _, v in spots)
    scale = (drawn.height - 30.0 - 28.0) / tall
    radii = re.findall(r"A ([\d.]+) ([\d.]+) ", drawn.svg)
    assert radii and all(abs(float(r) - 12.0 * scale) < 0.06 for r, _ in radii)
    assert all(abs(float(s) - 12.0 * scale * seen.eye[0]) < 0.06 for _, s in radii)


@pytest.mark.parametrize("name", MADE)
def test_every_view_in_space_has_a_still_with_clear_texts(name):
    (svg,) = stills(MADE[name]())
    size = np.array(svg.get("viewBox").split()[2:], float)
    assert size[0] <= 600.5 and size[1] <= 450.0
    texts = list(extents(svg))
    for k, (word, at, half) in enumerate(texts):
        assert (at - half >= 0.0).all() and (at + half <= size).all(), word
        for other, there, reach in texts[:k]:
            assert (abs(at - there) >= half + reach - 1.0).any(), (word, other)
    assert marks(svg, "path", "face") and marks(svg, "line", "near")


def test_teeth_reach_from_face_to_face():
    """Side and near face of a star cover all its points, on either face; its flanks are seen."""
    seen = view()
    rim = tuple((k * math.pi / 12, 12.0 if k % 2 else 9.0) for k in range(24))
    rod = Rod((30.0, 40.0), 12.0, 10.0, 50.0, "gear", outline=rim)
    drawn = still([rod], ((0.0, 0.0, 0.0), (60.0, 80.0, 90.0)), seen, Texts(("x",) * 3, ()), "x")
    side, face = (steps(p) for p in re.findall(r'class="(?:side|face) gear" d="(.*?)"', drawn.svg))
    spots = np.array([(30.0 + r * math.cos(t), 40.0 + r * math.sin(t)) for t, r in rim])
    ends = [np.array([seen.at((a, *spot)) for spot in spots]) for a in (10.0, 50.0)]
    scale = np.ptp(face[:, 0]) / np.ptp(ends[1][:, 0])
    offset = face[0] - scale * ends[1][0] * (1, -1)
    near, far = (scale * end * (1, -1) + offset for end in (ends[1], ends[0]))
    assert np.allclose(face, near, atol=0.3)
    for way in (0, 1):
        drawn_ends = np.concatenate((side, face))[:, way]
        assert drawn_ends.min() == pytest.approx(
            min(near[:, way].min(), far[:, way].min()), abs=0.5
        )
        assert drawn_ends.max() == pytest.approx(
            max(near[:, way].max(), far[:, way].max()), abs=0.5
        )
    gaps = [np.hypot(*(np.concatenate((near, far)) - p).T).min() for p in side]
    assert max(gaps) < 0.5 and 12 < len(side) < 2 * len(near)  # only those that face the eye


def steps(path):
    """Points of a path of steps, of all its parts."""
    found = []
    for part in path.rstrip("Z").split("Z"):
        found.append(np.cumsum([tuple(map(float, p.split())) for p in part[1:].split("l")], axis=0))
    return np.concatenate(found)


def test_teeth_of_the_still_are_those_of_the_gears():
    found = cases.three_stage()
    (svg,) = stills(found)
    faces = [e.get("d") for e in marks(svg, "path", "face") if "gear" in e.get("class")]
    drawn = sorted(d.count("l") + 1 for d in faces if "l" in d)
    teeth = sorted(4 * g["teeth"] for g in found.design["layout"]["gears"])
    assert drawn and set(drawn) <= set(teeth)


def test_the_still_is_light():
    html = page(cases.three_stage(), "", METRIC)
    (svg,) = re.findall(r'<svg [^>]*aria-label="the gearbox in space".*?</svg>', html, re.S)
    assert len(svg) < 40_000
