"""Gears, shafts and bearings as solids in a STEP file (AP214, mm): named, coloured, in place.

Flanks and fillets are cubic splines through points of `gear_sections.outline`, those of helical
teeth swept along the helix by splines of degree 5, whose faces share their edges exactly.
"""

import io
import math
from collections.abc import Iterable, Iterator, Sequence
from importlib import import_module
from typing import Any

import numpy as np

from gearopt.physics.gears import Gear, signed
from gearopt.physics.geometry.fillet import half_angle
from gearopt.report.drawing.gear_sections import POINTS, outline
from gearopt.report.drawing.placed import Part
from gearopt.report.drawing.solid import Toothed, twist

EXTRA = "a STEP file needs Open CASCADE: pip install 'gearopt[cad]'"
PALETTE = "cfd6dd 0072b2 d55e00 b07d00 00875f b0558c 2f9fd8 6a51a3 5f6b78".split()  # frame.css
CURVE = 17  # points of a fillet, and of a flank
ARC = 7  # of a tip or a root
HELD = {"Array1": "collections", "Array2": "collections", "List": "collections"}
TURN = 0.1  # rad from point to point of a helix
CLOSE = 1e-6  # mm: faces are sewn where their edges are so near; shorter arcs are none


class _Names:
    """The names of Open CASCADE, each in the module that it begins with."""

    def __getattr__(self, name: str) -> Any:
        module = name.split("_")[0]
        return getattr(import_module(f"OCP.{HELD.get(module, module)}"), name)


occ = _Names()


def step(parts: Sequence[Part]) -> bytes:
    """The bodies as an assembly; ImportError without Open CASCADE, ValueError without gears."""
    if not parts:
        raise ValueError("there is nothing to draw: no gears of whole teeth in known places")
    try:
        import OCP  # noqa: F401
    except ImportError as missing:
        raise ImportError(EXTRA) from missing
    document = occ.TDocStd_Document(occ.TCollection_ExtendedString("XmlOcaf"))
    occ.XCAFApp_Application.GetApplication_s().InitDocument(document)
    occ.XCAFDoc_DocumentTool.SetLengthUnit_s(document, 1e-3)
    shapes = occ.XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = occ.XCAFDoc_DocumentTool.ColorTool_s(document.Main())

    def called(label: Any, name: str) -> Any:
        occ.TDataStd_Name.Set_s(label, occ.TCollection_ExtendedString(name))
        return label

    whole, known = called(shapes.NewShape(), "gears"), dict[Any, Any]()
    for part in parts:
        key = part.name, part.contour, part.toothed and part.toothed.gear
        if key not in known:
            known[key] = called(shapes.AddShape(solid(part), False), part.name)
            red, green, blue = bytes.fromhex(PALETTE[part.colour % len(PALETTE)])
            colour = occ.Quantity_Color(red / 255, green / 255, blue / 255, occ.Quantity_TOC_sRGB)
            colours.SetColor(known[key], colour, occ.XCAFDoc_ColorGen)
        called(shapes.AddComponent(whole, known[key], place(part)), part.name)
    shapes.UpdateAssemblies()
    return _written(document)


def _written(document: Any) -> bytes:
    """A document as STEP, with nothing on the terminal."""
    for printer in occ.Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(occ.Message_Fail)
    writer, text = occ.STEPCAFControl_Writer(), io.BytesIO()
    occ.Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)  # half the size
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    if not writer.Transfer(document, occ.STEPControl_AsIs):
        raise ValueError("Open CASCADE did not translate the gears")
    if writer.WriteStream(text) != occ.IFSelect_RetDone:
        raise ValueError("Open CASCADE did not write the gears")
    return text.getvalue()


def place(part: Part) -> Any:
    """The location of a body that was made about the axis x."""
    turned, moved = occ.gp_Trsf(), occ.gp_Trsf()
    phase = part.toothed.phase if part.toothed else 0.0
    turned.SetRotation(occ.gp_Ax1(occ.gp_Pnt(0.0, 0.0, 0.0), occ.gp_Dir(1.0, 0.0, 0.0)), phase)
    moved.SetTranslation(occ.gp_Vec(0.0, *part.centre))
    return occ.TopLoc_Location(moved.Multiplied(turned))


def solid(part: Part) -> Any:
    """A body about the axis x, the middle of a tooth upright on it at `middle`."""
    sewing = occ.BRepBuilderAPI_Sewing(CLOSE)
    for face in (*_revolved(part.contour), *(_teeth(part) if part.toothed else ())):
        sewing.Add(face)
    sewing.Perform()
    shell = sewing.SewedShape()
    if not sewing.NbFreeEdges() and shell.ShapeType() == occ.TopAbs_SHELL:
        body = occ.BRepBuilderAPI_MakeSolid(occ.TopoDS.Shell(shell)).Solid()
        occ.BRepLib.OrientClosedSolid_s(body)
        if occ.BRepCheck_Analyzer(body).IsValid():
            return body
    raise ValueError(f"{part.name} is no solid: its outline crosses itself or does not close")


def _revolved(contour: Sequence[tuple[float, float]]) -> Iterator[Any]:
    """Yield the faces that a contour sweeps about the axis."""
    axis = occ.gp_Ax1(occ.gp_Pnt(0.0, 0.0, 0.0), occ.gp_Dir(1.0, 0.0, 0.0))
    for (a, first), (b, second) in zip(contour, contour[1:], strict=False):
        if (first or second) and (a, first) != (b, second):
            edge = occ.BRepBuilderAPI_MakeEdge(
                occ.gp_Pnt(a, first, 0.0), occ.gp_Pnt(b, second, 0.0)
            ).Edge()
            yield occ.BRepPrimAPI_MakeRevol(edge, axis).Shape()


def _teeth(part: Part) -> Iterator[Any]:
    """Yield the faces of the teeth and both ends of a gear."""
    assert part.toothed is not None
    it, rate = part.toothed, twist(part.toothed.gear)
    rim = list(curves(it.gear))
    if rate:
        way = _helix(it, rate)
        yield from (occ.BRepBuilderAPI_MakeFace(_swept(c, way), 0.1 * CLOSE).Face() for c, _ in rim)
    else:
        yield occ.BRepPrimAPI_MakePrism(
            _wire(rim, it.start), occ.gp_Vec(it.end - it.start, 0, 0)
        ).Shape()
    for x, (_, r) in ((it.end, part.contour[0]), (it.start, part.contour[-1])):
        yield _end(_wire(rim, x, rate * (x - it.middle)), x, r, it.gear.teeth < 0)


def curves(gear: Gear) -> Iterator[tuple[Any, bool]]:
    """Yield the outline of a gear, a tooth upright, as splines in (y, z) [mm].

    Beside each whether it is an arc about the axis: of a tip, or of a root.
    """
    at = 0.5 * abs(float(gear.reference_diameter))
    turn = float(half_angle(gear, signed(at, gear.teeth)))
    (x, z), c, s = np.array(outline(gear, -at)[0]).T, math.cos(turn), math.sin(turn)
    sides = np.stack((c * z - s * x, c * x + s * z), axis=1).reshape(-1, POINTS, 2)
    for k, (side, after) in enumerate(zip(sides, np.roll(sides, -1, axis=0), strict=True)):
        out = 1 if k % 2 == 0 else -1  # from the root to the tip, or back
        fillet, flank = side[::out][: POINTS // 2 + 1], side[::out][POINTS // 2 :]
        for points in (_unfolded(fillet), flank)[::out]:
            picked = points[np.linspace(0, len(points) - 1, CURVE).round().astype(int)][::out]
            chords = np.hypot(*np.diff(picked, axis=0).T)
            yield _spline(picked, np.concatenate(([0.0], np.cumsum(chords))), 3), False
        p, q, r = side[-1], after[0], math.hypot(*side[-1])
        over = math.atan2(p[0] * q[1] - p[1] * q[0], p @ q)
        if abs(over) * r > CLOSE:
            angles = math.atan2(p[1], p[0]) + over * np.linspace(0.0, 1.0, ARC)
            arc = r * np.stack((np.cos(angles), np.sin(angles)), axis=1)
            yield _spline(np.vstack((p, arc[1:-1], q)), angles - angles[0], 5), True


def _unfolded(fillet: Any) -> Any:
    """A fillet without its cusp, a few um wide, where a rack in a ring cuts back over its way."""
    ways, end = np.diff(fillet, axis=0), fillet[-1]
    back = np.flatnonzero((ways[1:] * ways[:-1]).sum(axis=1) < 0.0)
    if not len(back):
        return fillet
    before = (end - fillet) @ ways[back[0]] > math.hypot(*ways[0]) * math.hypot(*ways[back[0]])
    return np.vstack((fillet[: back[0] + 1][before[: back[0] + 1]], end))


def _spline(points: Any, at: Any, degree: int) -> Any:
    """The spline through points, from 0 to 1."""
    from scipy.interpolate import make_interp_spline

    return make_interp_spline(at / at[-1], points, k=degree)


def _helix(it: Toothed, rate: float) -> Any:
    """Cosine, sine and x along the teeth, as a spline."""
    count = max(6, 1 + math.ceil(abs(rate) * (it.end - it.start) / TURN))
    x = np.linspace(it.start, it.end, count)
    angle = rate * (x - it.middle)
    return _spline(np.stack((np.cos(angle), np.sin(angle), x), axis=1), x - x[0], 5)


def _listed(of: Any, values: Iterable[Any]) -> Any:
    """Values as an array of Open CASCADE."""
    rows = list(values)
    array = of(1, len(rows))
    for k, value in enumerate(rows, 1):
        array.SetValue(k, value)
    return array


def _knots(spline: Any) -> tuple[Any, Any, int]:
    """Knots, how often each counts, and the degree of a spline."""
    values, counts = np.unique(spline.t, return_counts=True)
    counted = _listed(occ.Array1_int, counts.tolist())
    return _listed(occ.Array1_double, values.tolist()), counted, spline.k


def _swept(curve: Any, way: Any) -> Any:
    """The surface of a curve along a helix; its poles are those of one turned by the other's."""
    poles = occ.Array2_gp_Pnt(1, len(curve.c), 1, len(way.c))
    for i, (y, z) in enumerate(curve.c.tolist(), 1):
        for j, (c, s, x) in enumerate(way.c.tolist(), 1):
            poles.SetValue(i, j, occ.gp_Pnt(x, c * y - s * z, s * y + c * z))
    (u, of_u, k), (v, of_v, n) = _knots(curve), _knots(way)
    return occ.Geom_BSplineSurface(poles, u, v, of_u, of_v, k, n)


def _wire(rim: Sequence[tuple[Any, bool]], x: float, turn: float = 0.0) -> Any:
    """The outline across the axis at x, turned by an angle."""
    c, s = math.cos(turn), math.sin(turn)

    def at(points: Any) -> list[Any]:
        return [occ.gp_Pnt(x, c * y - s * z, s * y + c * z) for y, z in points.tolist()]

    edges = occ.List_TopoDS_Shape()
    for spline, is_arc in rim:
        if is_arc:
            curve = occ.GC_MakeArcOfCircle(*at(spline(np.array([0.0, 0.5, 1.0])))).Value()
        else:
            curve = occ.Geom_BSplineCurve(_listed(occ.Array1_gp_Pnt, at(spline.c)), *_knots(spline))
        edges.Append(occ.BRepBuilderAPI_MakeEdge(curve).Edge())
    wire = occ.BRepBuilderAPI_MakeWire()
    wire.Add(edges)
    return wire.Wire()


def _end(rim: Any, x: float, radius: float, is_ring: bool) -> Any:
    """The end of a gear at x, from its outline to a circle, if any."""
    centre, along = occ.gp_Pnt(x, 0.0, 0.0), occ.gp_Dir(1.0, 0.0, 0.0)
    wires = [rim]
    if radius:
        edge = occ.BRepBuilderAPI_MakeEdge(occ.gp_Circ(occ.gp_Ax2(centre, along), radius)).Edge()
        wires.append(occ.BRepBuilderAPI_MakeWire(edge).Wire())
    first, *others = wires[::-1] if is_ring else wires
    face = occ.BRepBuilderAPI_MakeFace(occ.gp_Pln(centre, along), first)
    for wire in others:
        face.Add(wire)
    fixed = occ.ShapeFix_Face(face.Face())
    fixed.FixOrientation()
    return fixed.Face()
