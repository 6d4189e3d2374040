"""Files for CAD: outlines against the closed formula of the thickness, DXF by its own audit."""

import io
import math
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import gearopt
from gearopt.errors import GearoptError
from gearopt.formulations.drive.design import drive_design
from gearopt.optimise.result import Result
from gearopt.physics.gears import ISO_53_A, Cutter, Gear, reference_diameter
from gearopt.physics.geometry.fillet import form_diameter
from gearopt.physics.geometry.tooth import transverse_thickness
from gearopt.report.drawing.dxf import dxf
from gearopt.report.drawing.gear_sections import outline, sections
from gearopt.report.drawing.sheet import Place, Sheet, Window
from gearopt.report.measures import METRIC

PROBLEMS = Path(__file__).parents[2] / "problems"
PICTURES = Path(__file__).parents[2] / "docs" / "pictures"
GEARS = {  # module, teeth, helix angle [deg], shift, allowance, cutter
    "spur": (2.0, 30, 0.0, 0.0, 0.0, None),
    "shifted, undercut without": (3.0, 12, 0.0, 0.45, 0.0, None),
    "undercut": (3.0, 12, 0.0, 0.0, 0.0, None),
    "helical": (4.0, 25, 18.0, 0.2, -0.06, None),
    "large": (21.0, 18, 0.0, 0.389, -0.13, None),
    "ring": (21.0, -93, 0.0, 0.1171, -0.32, None),
    "ring by a cutter": (2.0, -78, 0.0, 0.1, 0.0, Cutter(25.0, 0.0, 1.25, 0.2)),
    "helical ring": (4.0, -61, 12.0, 0.0, -0.08, None),
}


def gear(name):
    module, teeth, beta, shift, allowance, cutter = GEARS[name]
    helix = math.radians(beta)
    return Gear(
        *(module, teeth, reference_diameter(module, teeth, helix), 30.0, helix, ISO_53_A),
        profile_shift=shift,
        thickness_allowance=allowance,
        cutter=cutter,
    )


def traced(points, bulges, steps=64):
    """Points along the arcs of a closed polyline with bulges, as the DXF reference has them.

    An arc of angle a = 4 arctan(bulge), to the right of its chord for a > 0.
    """
    start, bulge = np.array(points), np.array(bulges)[:, None]
    way = np.roll(start, -1, axis=0) - start
    half = np.where(np.abs(bulge) < 1e-12, 1e-9, 2.0 * np.arctan(bulge))
    chord = np.hypot(*way.T)[:, None]
    turn = np.linspace(-1.0, 1.0, steps, endpoint=False)[None, :] * half
    radius = 0.5 * chord / np.sin(half)
    along, away = radius * np.sin(turn) / chord, radius * (np.cos(turn) - np.cos(half)) / chord
    (ux, uy), (x, y) = way.T[:, :, None], (start + 0.5 * way).T[:, :, None]
    return np.column_stack(
        ((x + along * ux + away * uy).ravel(), (y + along * uy - away * ux).ravel())
    )


def thicknesses(curve, radius):
    """Arcs [mm] between the crossings of a circle, in turn of teeth and of spaces."""
    r, angle = np.hypot(*curve.T), np.unwrap(np.arctan2(curve[:, 1], curve[:, 0]))
    off = np.append(r, r[0]) - radius
    angle = np.append(angle, angle[0] + np.sign(angle[-1] - angle[0]) * 2.0 * math.pi)
    at = np.flatnonzero(off[:-1] * off[1:] < 0.0)
    share = off[at] / (off[at] - off[at + 1])
    crossings = np.sort(angle[at] + share * (angle[at + 1] - angle[at]))
    return radius * np.diff(crossings)


FAST = ("undercut", "ring by a cutter")
ALL = [name if name in FAST else pytest.param(name, marks=pytest.mark.slow) for name in GEARS]


@pytest.mark.parametrize("name", ALL)
def test_thickness_of_an_exported_outline_is_that_of_the_formula(name):
    """At five diameters between form circle and tip, of every tooth, to 0.02 um."""
    body = gear(name)
    points, bulges = outline(body, -0.5 * abs(float(body.reference_diameter)))
    curve = traced(points, bulges)
    ends = float(form_diameter(body)), float(body.tip_diameter)
    for share in (0.02, 0.25, 0.5, 0.75, 0.98):
        diameter = ends[0] + share * (ends[1] - ends[0])
        exact = abs(float(transverse_thickness(body, diameter)))
        arcs = thicknesses(curve, 0.5 * abs(diameter))
        assert len(arcs) == 2 * abs(body.teeth) - 1
        off = min(np.max(np.abs(arcs[k::2] - exact)) for k in (0, 1))
        assert off < 2e-5


@pytest.mark.parametrize("name", ALL)
def test_tips_and_roots_of_an_outline_are_arcs_of_their_circles(name):
    body = gear(name)
    curve = traced(*outline(body, -0.5 * abs(float(body.reference_diameter))))
    radii = np.hypot(*curve.T)
    tip = 0.5 * abs(float(body.tip_diameter))
    end = radii.max() if body.teeth > 0 else radii.min()
    assert end == pytest.approx(tip, abs=1e-9)
    assert np.count_nonzero(np.abs(radii - tip) < 1e-9) >= 64 * abs(body.teeth)


@pytest.fixture(scope="module")
def box():
    return Result.from_json((PICTURES / "elevator_box.json").read_text("utf-8"))


def read(result):
    """The DXF of a result as ezdxf reads it, without a fault."""
    ezdxf = pytest.importorskip("ezdxf")
    made = gearopt.export(result, "dxf")
    document = ezdxf.read(io.StringIO(made.decode()))
    assert not document.audit().errors
    return document


def test_every_mark_of_a_sheet_is_in_its_layer():
    ezdxf = pytest.importorskip("ezdxf")
    sheet = Sheet(Window(0.0, 40.0, 0.0, 30.0), 8.0)
    sheet.outline([(5, 5), (9, 5), (9, 9), (5, 9), (4, 7)], "tip", bulges=(0, 0, 0, 0, 0.5))
    sheet.circle(20.0, 15.0, 7.0, "reference")
    sheet.ring(20.0, 15.0, (9.0, 8.0), "tip")
    sheet.rectangle((1.0, 1.0), (39.0, 29.0), "box")
    sheet.slice((20.0, 15.0), 3.0, (0.0, 1.0), "far", rim=True)
    sheet.cross(20.0, 15.0, 7.0)
    sheet.dimension((13.0, 15.0), (27.0, 15.0), 60.0, "⌀ 14.00")
    sheet.label("a name", [Place(100.0, 100.0, -90.0)], "size")
    document = ezdxf.read(io.StringIO(dxf([sheet.drawing("test", "a sheet")]).decode()))
    assert not document.audit().errors and document.units == ezdxf.units.MM
    space = document.modelspace()
    counts = Counter((entity.dxftype(), entity.dxf.layer) for entity in space)
    assert counts == {
        ("LWPOLYLINE", "teeth"): 1,
        ("LWPOLYLINE", "bodies"): 1,
        ("CIRCLE", "circles"): 3,
        ("ARC", "circles"): 1,
        ("LINE", "axes"): 2,
        ("DIMENSION", "dimensions"): 1,
        ("TEXT", "text"): 2,
    }
    (left, bottom), _ = sheet.drawing("test", "a sheet").frame
    circle = space.query("CIRCLE")[0].dxf
    assert (circle.center.x + left, circle.center.y + bottom) == pytest.approx((20.0, 15.0))
    assert space.query("DIMENSION")[0].get_measurement() == pytest.approx(14.0)
    assert space.query("TEXT")[0].dxf.rotation == pytest.approx(90.0)


def test_without_ezdxf_the_command_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    sheet = Sheet(Window(0.0, 1.0, 0.0, 1.0), 1.0)
    sheet.circle(0.5, 0.5, 0.5, "tip")
    with pytest.raises(ImportError, match=r"pip install 'gearopt\[dxf\]'"):
        dxf([sheet.drawing("test", "a circle")])
    with pytest.raises(ValueError, match="nothing to draw"):
        dxf([])


@pytest.mark.slow
def test_dimensions_of_a_box_measure_what_they_say(box):
    document, ezdxf = read(box), pytest.importorskip("ezdxf")
    assert document.units == ezdxf.units.MM
    space = document.modelspace()
    layers = {entity.dxf.layer for entity in space}
    assert layers == {"teeth", "circles", "bodies", "axes", "dimensions", "text"}
    dimensions = space.query("DIMENSION")
    assert len(dimensions) >= 4
    for dimension in dimensions:
        said = float(dimension.dxf.text.replace("%%c", "").replace(",", ""))
        assert dimension.get_measurement() == pytest.approx(said, abs=0.01)


@pytest.mark.slow
def test_teeth_of_a_dxf_are_the_outlines_of_the_gears():
    """Alone and in mesh, as far about their axes as the tips."""
    result = Result.from_json((PICTURES / "reference_pair.json").read_text("utf-8"))
    pair = drive_design(result.design).stages[0].pair
    space = read(result).modelspace()
    teeth = [entity for entity in space.query("LWPOLYLINE") if entity.dxf.layer == "teeth"]
    whole = [np.array(each.get_points("xy")) for each in teeth if len(each) > 2000]
    reach = [np.hypot(*(points - points.mean(axis=0)).T).max() for points in whole]
    tips = [0.5 * float(gear.tip_diameter) for gear in pair.gears]
    assert sorted(reach) == pytest.approx(sorted(2 * tips), abs=1e-6)
    assert all(each.closed for each in teeth)


@pytest.mark.slow
def test_drawings_of_gears_are_recorded_to_scale(box):
    first, *_ = sections(drive_design(box.design), METRIC)
    sizes = {mark.size for mark in first.marks if mark.form == "circle"}
    pinion = drive_design(box.design).stages[0].pair.pinion
    assert min(abs(size - 0.5 * pinion.base_diameter) for size in sizes) < 1e-12


def test_places_of_shafts_are_exported_as_csv(box):
    text = gearopt.export(box, "csv").decode()
    assert text.startswith("places of shafts\r\n,shaft 1,shaft 2,shaft 3\r\n")


@pytest.mark.slow
def test_drawing_data_are_exported_as_csv():
    rated = gearopt.rate(PROBLEMS / "wind_planetary_stage.toml", {"drawing": {}})
    text = gearopt.export(rated, "csv").decode()
    assert text.startswith("drawing data\r\n,sun,planet,ring\r\n") and "\r\nbacklash\r\n" in text


@pytest.mark.slow
def test_flanks_and_cutter_of_a_strain_wave(solved):
    result = solved("strain_wave_base")
    text = gearopt.export(result, "csv").decode()
    assert "points of the flexspline's flank" in text and "points of the circular" in text
    document = read(result)
    tooth = document.modelspace().query("LWPOLYLINE")[0].get_points("xy")
    wide = max(x for x, _ in tooth) - min(x for x, _ in tooth)
    assert wide == pytest.approx(2.0 * max(result.design["tooth_half_mm"]), rel=1e-12)


def test_the_command_writes_a_file_and_says_what_it_cannot(here, tmp_path, box):
    kept = tmp_path / "box.json"
    kept.write_text(box.to_json(), "utf-8")
    done = here("export", str(kept), "--csv")
    assert (done.returncode, done.stdout[:16]) == (0, "places of shafts")
    out = tmp_path / "places.csv"
    assert here("export", str(kept), "--csv", "-o", str(out)).returncode == 0
    assert out.read_text("utf-8").startswith("places of shafts")
    for command, said in (
        (("export", str(kept)), "name one format"),
        (("export", str(kept), "--csv", "--dxf"), "name one format"),
        (("export", str(kept), "--csv", "-o", str(tmp_path)), "is a folder"),
        (("export", str(kept), "--csv", "-o", str(tmp_path / "a.toml")), "is a problem file"),
        (("export", str(PROBLEMS / "seven_points.toml"), "--dxf"), "is not exported as dxf"),
    ):
        wrong = here(*command)
        assert (wrong.returncode, said in wrong.stderr) == (2, True), wrong.stderr


def test_a_result_without_such_tables_says_what_asks_for_them():
    cases = ("reference_pair", "this pair has no relief"), ("shigley_14_4", "this drive has no CSV")
    for name, said in cases:
        with pytest.raises(GearoptError, match=said):
            gearopt.export(PROBLEMS / f"{name}.toml", "csv")
