"""Gears as solids: splines against the closed formula, volumes against areas, meshes by Boolean.

What needs Open CASCADE runs where it is installed: pip install -e '.[test,cad]', then
pytest -m "" tests/report/test_step.py.
"""

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_exports import ALL, FAST, gear, thicknesses, traced

import gearopt
from gearopt.optimise.result import Result
from gearopt.physics.blanks import Body
from gearopt.physics.gears import ISO_53_A, Gear, reference_diameter
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.tooth import transverse_thickness
from gearopt.report.drawing import step as cad
from gearopt.report.drawing.gear_sections import outline
from gearopt.report.drawing.placed import Part, mated, parts
from gearopt.report.drawing.solid import Toothed, rings_of, twist
from gearopt.report.drawing.step import curves, place, solid, step

PROBLEMS = Path(__file__).parents[2] / "problems"
PICTURES = Path(__file__).parents[2] / "docs" / "pictures"
WIDTH = 24.0


def polygon(body, steps=48):
    """The outline of the splines, closed, a tooth upright."""
    at = np.linspace(0.0, 1.0, steps, endpoint=False)
    return np.vstack([curve(at) for curve, _ in curves(body)])


def area(points):
    x, y = points.T
    return 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize("name", ALL)
def test_thickness_of_the_splines_is_that_of_the_formula(name):
    """At five diameters between form circle and tip, of every tooth, to 0.2 um."""
    body = gear(name)
    curve = polygon(body, 150 if name in FAST else 600)
    ends = float(form_diameter(body)), float(body.tip_diameter)
    for share in (0.02, 0.25, 0.5, 0.75, 0.98):
        diameter = ends[0] + share * (ends[1] - ends[0])
        exact = abs(float(transverse_thickness(body, diameter)))
        arcs = thicknesses(curve, 0.5 * abs(diameter))
        assert len(arcs) == 2 * abs(body.teeth) - 1
        assert min(np.max(np.abs(arcs[k::2] - exact)) for k in (0, 1)) < 2e-4


def test_a_tooth_stands_upright_and_the_outline_is_closed():
    for name in ("undercut", "ring by a cutter"):
        body, rim = gear(name), list(curves(gear(name)))
        for (a, _), (b, _) in zip(rim, rim[1:] + rim[:1], strict=True):
            assert math.dist(a(1.0), b(0.0)) < 1e-9
        tip = 0.5 * abs(float(body.tip_diameter))
        middles = [
            math.atan2(*c(0.5)[::-1])
            for c, arc in rim
            if arc and abs(math.hypot(*c(0.5)) - tip) < 1e-9
        ]
        assert len(middles) == abs(body.teeth) and min(map(abs, middles)) < 1e-12


def inside(points, rim):
    """Whether points lie inside a closed polygon: an odd number of its edges is on their right."""
    (x, y), (x0, y0) = points.T[:, :, None], rim.T[:, None, :]
    x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        hit = ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return hit.sum(axis=1) % 2 == 1


def in_place(part, steps, thinner=0.0, turned=0.0):
    """The section of a gear at the middle of its width, in its place."""
    it = part.toothed
    c, s = math.cos(it.phase + turned), math.sin(it.phase + turned)
    y, z = polygon(replace(it.gear, thickness_allowance=-thinner), steps).T
    return np.stack((c * y - s * z, s * y + c * z), axis=1) + it.centre


@pytest.mark.slow
def test_teeth_of_sun_planets_and_ring_are_in_spaces():
    """Of a print, without backlash: no corner of thinner planets is in the sun or in the ring.

    Turned by 1.5 mm along the pitch circle, six times what is free on either side, they meet both.
    """
    result = gearopt.rate(PROBLEMS / "wind_planetary_stage.toml")
    sun, *planets, ring = parts(result)
    assert [p.name for p in (sun, *planets, ring)] == ["sun 1", *3 * ["planet 1"], "ring 1"]
    teeth = in_place(sun, 6), in_place(ring, 6)
    for planet in planets:
        for turned in (0.0, 1.5 / 378.0):
            corners = in_place(planet, 6, 0.5, turned)
            reach = np.hypot(*corners.T)
            near = corners[reach < 0.53 * sun.toothed.gear.tip_diameter]
            far = corners[reach > 0.49 * abs(ring.toothed.gear.tip_diameter)]
            assert min(len(near), len(far)) > 20
            assert inside(near, teeth[0]).any() == bool(turned)
            assert inside(far, teeth[1]).all() != bool(turned)


def test_without_open_cascade_it_is_said_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "OCP", None)
    result = Result.from_json((PICTURES / "reference_pair.json").read_text("utf-8"))
    with pytest.raises(gearopt.SolveError, match=r"pip install 'gearopt\[cad\]'"):
        gearopt.export(result, "step")
    with pytest.raises(ValueError, match="nothing to draw"):
        step([])


def part(body, centre=(0.0, 0.0), phase=0.0, blank=None):
    """A gear as wide as WIDTH, a ring four modules beyond its root circle."""
    toothed = Toothed(body, 0.0, WIDTH, centre, phase, 0.5 * WIDTH)
    if body.teeth < 0:
        r = 0.5 * abs(float(body.root_diameter)) + 4.0 * body.normal_module
        contour = (WIDTH, r), (0.0, r)
    else:
        contour = tuple(rings_of(blank or Body(None, None, None, None), body, 0.0, WIDTH))
    return Part("a gear", 1, centre, contour, toothed)


def volume(shape):
    """By Open CASCADE's own integration."""
    properties = cad.occ.GProp_GProps()
    cad.occ.BRepGProp.VolumeProperties_s(shape, properties)
    return properties.Mass()


def common(first, second):
    """The common volume [mm3] of two gears in their places."""
    shapes = (solid(it).Moved(place(it)) for it in (first, second))
    return volume(cad.occ.BRepAlgoAPI_Common(*shapes).Shape())


SOLIDS = "spur", "undercut", "helical", "ring by a cutter", "helical ring"


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_valid_and_their_volume_is_area_times_width(name):
    """To 5e-6 of the outline by arcs; 1e-4 where these follow the cusp of a rack in a ring."""
    pytest.importorskip("OCP")
    body = gear(name)
    bore = Body(None, None, None, 0.5 * float(body.root_diameter)) if body.teeth > 0 else None
    made = part(body, blank=bore)
    shape = solid(made)
    assert cad.occ.BRepCheck_Analyzer(shape).IsValid()
    section = area(traced(*outline(body, -0.5 * abs(float(body.reference_diameter))), 64))
    circle = math.pi * made.contour[0][1] ** 2
    exact = WIDTH * abs(circle - section)
    assert volume(shape) == pytest.approx(exact, rel=1e-4 if name == "helical ring" else 5e-6)


@pytest.mark.slow
def test_a_web_takes_its_rings_away():
    pytest.importorskip("OCP")
    body = gear("spur")
    blank = Body(rim_thickness=5.0, web_thickness=6.0, hub_diameter=20.0, bore=10.0)
    shapes = [solid(part(body, blank=b)) for b in (blank, Body(None, None, None, 10.0))]
    assert all(cad.occ.BRepCheck_Analyzer(shape).IsValid() for shape in shapes)
    inner = 0.5 * float(body.root_diameter) - 5.0
    away = math.pi * (inner**2 - 10.0**2) * (WIDTH - 6.0)
    assert volume(shapes[1]) - volume(shapes[0]) == pytest.approx(away, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("z, beta", [(31, 0.0), (31, 15.0), (-61, 0.0), (-61, 12.0)])
def test_gears_in_mesh_do_not_intersect_but_turned_beyond_their_backlash(z, beta):
    """Teeth thinner by 0.05 mm each: half the backlash is 0.05 mm along the pitch circle."""
    pytest.importorskip("OCP")
    helix, module = math.radians(beta), 3.0
    first, second = (
        Gear(
            *(module, n, reference_diameter(module, n, helix), WIDTH, helix, ISO_53_A),
            thickness_allowance=-0.05,
        )
        for n in (20, z)
    )
    a = 0.5 * abs(float(first.reference_diameter + second.reference_diameter))
    pinion = part(first, phase=0.3)
    it = mated(pinion.toothed, part(second, (a * math.cos(1.0), a * math.sin(1.0))).toothed)
    wheel = replace(part(it.gear, it.centre), toothed=it)
    assert twist(it.gear) * z * twist(pinion.toothed.gear) <= 0.0
    tooth = math.pi * module**2 * WIDTH
    assert common(pinion, wheel) < 1e-6 * tooth
    arc = 2.0 * 0.08 / abs(float(second.reference_diameter))
    assert common(pinion, replace(wheel, toothed=replace(it, phase=it.phase + arc))) > 5e-4 * tooth


@pytest.mark.slow
def test_a_file_is_read_again_with_its_names_and_volumes(tmp_path):
    pytest.importorskip("OCP")
    result = Result.from_json((PICTURES / "reference_pair.json").read_text("utf-8"))
    file = tmp_path / "pair.step"
    file.write_bytes(gearopt.export(result, "step"))
    reader = cad.occ.STEPControl_Reader()
    assert reader.ReadFile(str(file)) == cad.occ.IFSelect_RetDone
    reader.TransferRoots()
    kept = parts(result)
    each = [volume(solid(it)) for it in kept]
    assert volume(reader.OneShape()) == pytest.approx(sum(each), rel=1e-8)
    text = file.read_text("ascii")
    assert all(f"PRODUCT('{it.name}'" in text for it in kept) and "COLOUR_RGB" in text
