"""The pictures of the docs: drawings that the program makes of stored results, as SVG files.

`python docs/generate.py --solve` solves the files below again and stores what they give beside the
pictures. A picture is drawn from its stored result, because a layout or a packing often has several
designs of equal value, and which of them a search meets first may differ between machines.
"""

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path

import gearopt
from gearopt.optimise.pareto.front import Front
from gearopt.optimise.result import Result
from gearopt.report.drawing import layout_views, sheet, train_views
from gearopt.report.drawing.sheet import Drawing
from gearopt.report.kinds import packing, pair
from gearopt.report.measures import METRIC, Measures
from gearopt.report.pages import front_plots
from gearopt.report.pages.front_plots import drawn
from gearopt.report.section import Section

ROOT = Path(__file__).parents[1]
ROOM = ROOT / "docs" / "pictures"
FREE = 16.0  # px around and between drawings
HIGH = 520.0  # px that a picture is shown high at the most


@dataclass(frozen=True)
class Picture:
    """Which drawings of a section of the page to show, of the result with a seed.

    down: one below the other, not side by side.
    """

    section: Callable[[Result, Measures], Section | None]
    drawings: Sequence[int] = (0,)
    seed: int = 0
    down: bool = False


def moving(result: Result, measures: Measures) -> Section | None:
    """The still of a pair in mesh."""
    section = pair.mesh(result, measures)
    assert section is not None
    return replace(section, drawings=section.animations[0].row.drawings)


PICTURES = {  # by the name of the problem file
    "elevator": Picture(train_views.section, (0, 1)),
    "three_stage": Picture(train_views.section),
    "elevator_box": Picture(layout_views.section, seed=1),
    "table4_process_one_layout": Picture(layout_views.section, (0, 1), seed=1),
    "four_stage_box": Picture(layout_views.section, (0, 1)),
    "reference_pair": Picture(moving),
    "six_cylinders": Picture(packing.plans),
    "six_cylinders_two_layers": Picture(packing.plans, (0, 1), down=True),
    "seven_points": Picture(packing.plans),
}


@dataclass(frozen=True)
class Traded:
    """Which Pareto front to show: of a problem file, its objectives."""

    file: str
    objectives: str


FRONTS = {"elevator_front": Traded("elevator_free_width", "gear_volume,mesh_loss")}


def solve_front(name: str) -> str:
    """The Pareto front as it is stored: the values of its designs, and what is certain."""
    file = f"problems/{FRONTS[name].file}.toml"
    front = gearopt.pareto(ROOT / file, objectives=FRONTS[name].objectives)
    points = tuple(replace(p, design={}, limits={}) for p in front.points)
    kept = replace(front, file=file, points=points, seconds=0.0, versions={}, asked={})
    return json.dumps(kept.to_dict(), separators=(",", ":")) + "\n"


def stored_front(name: str) -> Front:
    """The stored Pareto front."""
    return Front.from_json((ROOM / f"{name}.json").read_text(encoding="utf-8"))


def draw_front(name: str) -> str:
    """The SVG of a stored Pareto front of two objectives."""
    (figure,) = front_plots.pairs(drawn(stored_front(name), METRIC))
    assert figure.still is not None
    return _file("Pareto front", [figure.still], down=False)


def solve(name: str) -> str:
    """The result of a problem file as it is stored: what drawings need, and what is certain."""
    file = f"problems/{name}.toml"
    result = gearopt.solve(ROOT / file, seed=PICTURES[name].seed)
    return replace(result, file=file, parts=(), report={}, versions={}).to_json() + "\n"


def stored(name: str) -> Result:
    """The stored result of a problem file."""
    return Result.from_json((ROOM / f"{name}.json").read_text(encoding="utf-8"))


def draw(name: str) -> str:
    """The SVG of a stored result."""
    picture = PICTURES[name]
    section = picture.section(stored(name), METRIC)
    if section is None:
        raise ValueError(f"{name}: its result has no drawing of that kind")
    return _file(section.heading, [section.drawings[k] for k in picture.drawings], picture.down)


def _file(heading: str, drawings: Sequence[Drawing], down: bool) -> str:
    """Drawings in a row on a card of their own, so that they are legible on every page."""
    parts, x, y, right, bottom = [], FREE, FREE, 0.0, 0.0
    for it in drawings:
        place = f'x="{x:.2f}" y="{y:.2f}" width="{it.width:.2f}" height="{it.height:.2f}"'
        parts.append(re.sub("<title>.*?</title>", "", it.svg).replace("<svg ", f"<svg {place} ", 1))
        right, bottom = max(right, x + it.width + FREE), max(bottom, y + it.height + FREE)
        x, y = (x, bottom) if down else (right, y)
    share = min(1.0, HIGH / bottom)
    size = f'width="{share * right:.0f}" height="{share * bottom:.0f}"'
    inner = "\n".join(parts)
    style = _style('class="moves"' in inner)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="views" {size} '
        f'viewBox="0 0 {right:.2f} {bottom:.2f}" role="img">\n'
        f"<title>{escape(heading)}</title>\n<style>\n{style}</style>\n"
        f'<rect class="paper" width="100%" height="100%" rx="10"/>\n{inner}\n</svg>\n'
    )


def _style(moves: bool) -> str:
    """The colours of frame.css, light and dark, and the rules of drawing.css that colour marks.

    moves: with those of the bodies of an animation.
    """
    room = Path(sheet.__file__).parents[1] / "pages"
    frame, rules, player = (
        (room / f"{name}.css").read_text(encoding="utf-8")
        for name in ("frame", "drawing", "player")
    )
    colours = frame[: frame.index("* { box-sizing")]
    if moves:
        colours, rules = colours + player[: player.index(".player {")], rules + player
    marks = re.findall(r"\.views svg[^{}]*\{[^{}]*\}", rules)
    kept = [rule for rule in marks if "display:" not in rule]
    return colours + "\n".join([*kept, ".paper { fill: var(--card); stroke: var(--line); }", ""])
