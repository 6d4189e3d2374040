"""A packing of cylinders in three dimensions."""

import math
from html import escape

from gearopt.formulations.packing.design import ContainerDesign, packing_design
from gearopt.optimise.result import Result
from gearopt.report.measures import Measures
from gearopt.report.pages.packing_views import sizes, span, words
from gearopt.report.pages.solid import Point, edges, line_trace, mesh_trace, rod, space, upright
from gearopt.report.plot import Figure
from gearopt.report.section import Section

CAPTION = "Drag to turn, scroll to come nearer, click a name to hide or show it."


def section(result: Result, measures: Measures) -> Section | None:
    """The packing to turn; None where there is none."""
    if not result.design:
        return None
    design = packing_design(result.design)
    left, right, front, back = span(design.container)
    corners = (left, front, 0.0), (right, back, design.container.height_mm)
    colours, seen = sizes(design.cylinders), set()
    traces = [line_trace(_container(design.container), "container", "--ink", 3.0)]
    for it in sorted(design.cylinders, key=lambda c: -c.diameter_mm):
        d = it.diameter_mm
        mesh = upright(rod((it.x_mm, it.y_mm), d / 2, it.from_mm, it.to_mm))
        group = f"diameter {measures.of(d, 'mm'):.4g} {measures.unit('mm')}"
        first = d not in seen
        seen.add(d)
        name = escape(words(it, measures))
        traces.append(mesh_trace(mesh, name, colours[d], group, showlegend=first))
    view = space(*corners, measures, 520)
    return Section("In three dimensions", figures=(Figure(traces, view, CAPTION),))


def _container(container: ContainerDesign) -> list[Point | None]:
    left, right, front, back = span(container)
    height = container.height_mm
    if container.shape != "circle":
        return edges((left, front, 0.0), (right, back, height))
    r, x, y = 0.5 * (right - left), 0.5 * (left + right), 0.5 * (front + back)
    ring = [
        (x + r * math.cos(k * math.pi / 36), y + r * math.sin(k * math.pi / 36)) for k in range(73)
    ]
    found: list[Point | None] = [(u, v, 0.0) for u, v in ring]
    found += [None, *[(u, v, height) for u, v in ring]]
    for u, v in ring[:72:18]:
        found += [None, (u, v, 0.0), (u, v, height)]
    return found
