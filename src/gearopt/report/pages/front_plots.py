"""The plots of a Pareto front and their stills: pairs, three in space, parallel lines, growth."""

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from gearopt.frozen import dataclass
from gearopt.optimise.pareto.front import Front
from gearopt.report.drawing.number_line import even_ticks
from gearopt.report.drawing.sheet import Drawing, Place, Sheet, Window, around
from gearopt.report.drawing.still import edges, outside, view
from gearopt.report.front import heads, rules, unit_of
from gearopt.report.measures import Measures
from gearopt.report.pages.front_designs import Numbers
from gearopt.report.plots import LOOK, Figure, axis, layout
from gearopt.report.plots import lines as curve

GREY = "--axis"
DESIGN, CHOSEN = "designs", "chosen"  # what the page's script moves
AXIS_MARGIN = 0.06  # of the range of a front, free around it
FARTHEST_SHOWN = 0.35  # of the range: beaten designs that are farther off are left out
MAX_BEATEN = 1500  # beaten designs that are drawn, those nearest to the front
Span = tuple[float, float]
WIDE, HIGH = 620.0, 340.0  # px of a plot inside its axes
LEFT, BELOW, EDGE = 74.0, 46.0, 16.0  # px around it
CUBE = 330.0  # px of the view in space
DOT = 2.6  # px, radius of a design
TICK_SPACING = 60.0  # px from one tick to the next, at least


@dataclass(frozen=True)
class Drawn:
    """A front in the units that are shown: heads, values, and the places of its picks.

    points, beaten: values by design; corners: limits under which there is none, None for any.
    """

    heads: tuple[str, ...]
    points: list[tuple[float, ...]]
    beaten: list[tuple[float, ...]]
    corners: list[tuple[float | None, ...]]
    picks: dict[int, str]
    curve: bool

    def column(self, k: int) -> list[float]:
        """The values of an objective."""
        return [p[k] for p in self.points]

    def span(self, k: int) -> Span:
        """The ends of an objective's axis."""
        low, high = min(self.column(k)), max(self.column(k))
        room = AXIS_MARGIN * (high - low) or 0.02 * abs(high) or 1.0
        return low - room, high + room


def drawn(front: Front, measures: Measures) -> Drawn:
    """A front that has points, in the units that are shown."""
    units = [unit_of(objective) for objective in front.objectives]

    def shown(values: Sequence[float]) -> tuple[float, ...]:
        return tuple(measures.of(v, unit) for v, unit in zip(values, units, strict=True))

    corners = [
        tuple(
            None if (v := step.limits.get(o.name)) is None else measures.of(v, unit_of(o))
            for o in front.objectives
        )
        for step in front.impossible
    ]
    return Drawn(
        heads(front, measures),
        [shown(p.values) for p in front.points],
        [shown(p) for p in near(front)],
        corners,
        {place: ", ".join(names) for place, names in rules(front).items()},
        front.error is not None,
    )


def near(front: Front) -> list[tuple[float, ...]]:
    """The beaten designs that are drawn: within the plot, the nearest to its corner."""
    columns = list(zip(*(p.values for p in front.points), strict=True))
    ends = [(min(c), (max(c) - min(c)) or 1.0) for c in columns]

    def far(values: Sequence[float]) -> float:
        shares = [(v - low) / wide for v, (low, wide) in zip(values, ends, strict=True)]
        return float(max(shares))

    inside = [values for values in front.beaten if far(values) <= 1.0 + FARTHEST_SHOWN]
    return sorted(inside, key=far)[:MAX_BEATEN]


def pairs(front: Drawn) -> list[Figure]:
    """Plot every two objectives against each other."""
    return [_pair(front, i, k) for i, k in combinations(range(len(front.heads)), 2)]


def _pair(front: Drawn, i: int, k: int) -> Figure:
    whole = len(front.heads) == 2
    across, up = _wide(front, i), _wide(front, k)
    traces = [_line(front)] if whole and len(front.points) > 1 else []
    if front.beaten:
        x, y = ([p[n] for p in front.beaten] for n in (i, k))
        traces.append(_marks("dominated", x, y, {"color": f"{GREY}/0.7", "size": 5}))
    if (corners := _corners(front, i, k)) and whole:
        x, y = [min(a, across[1]) for a, _ in corners], [min(b, up[1]) for _, b in corners]
        look = {
            "color": GREY,
            "size": 9,
            "symbol": "x-thin",
            "line": {"color": GREY, "width": 2},
        }
        crosses = _marks("limits without a design", x, y, look)
        traces.append(crosses | {"cliponaxis": False})
    traces += _designs(front, (i, k))
    legend = {"legend": {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"}}
    plot = layout(
        axis(front.heads[i], range=list(across)),
        axis(front.heads[k], range=list(up)),
        460 if whole else 360,
        hovermode="closest",
        **legend,
    )
    caption = _caption(front, i, k)
    return Figure(traces, plot, caption, scatter(front, i, k, (across, up), corners, caption))


def _wide(front: Drawn, k: int) -> Span:
    """The ends of an axis, with the limits that have no design if they are near."""
    low, high = front.span(k)
    reach = FARTHEST_SHOWN * (high - low)
    known = [c[k] for c in front.corners]
    lowest = [v for v in known if v is not None and low - reach < v < low]
    farther = [p[k] for p in front.beaten if p[k] > high]
    room = AXIS_MARGIN * (high - low)
    return min([low, *(v - room for v in lowest)]), max([high, *(v + room for v in farther)])


def _corners(front: Drawn, i: int, k: int) -> list[Span]:
    """Limits of two objectives alone that leave no design; inf for any."""
    rows = []
    for corner in front.corners:
        others = [v for n, v in enumerate(corner) if n not in (i, k)]
        if all(v is None for v in others):
            a, b = (float("inf") if corner[n] is None else float(corner[n] or 0.0) for n in (i, k))
            rows.append((a, b))
    return rows


def _caption(front: Drawn, i: int, k: int) -> str:
    names = [front.heads[n].split(" [")[0] for n in (i, k)]
    words = f"{names[0][0].upper()}{names[0][1:]} against {names[1]}."
    if len(front.heads) > 2:
        words += " A point that looks dominated here is better in the third objective."
    elif len(front.points) > 1:
        line = (
            "chords between points"
            if front.curve
            else "the boundary of what these designs dominate"
        )
        words += f" Line: {line}."
    if front.beaten:
        words += " Grey dots: dominated designs."
    if front.corners and len(front.heads) == 2:
        words += " Grey crosses: limits that no design meets."
    return words


def _line(front: Drawn) -> dict[str, Any]:
    """Draw chords of a curve, or the steps of single designs."""
    shape = "linear" if front.curve else "hv"
    trace = curve(front.column(0), front.column(1), "--series-1/0.45", 1.4, shape=shape)
    return trace | {"hoverinfo": "skip", "showlegend": False}


def _marks(
    name: str, x: Sequence[float], y: Sequence[float], look: dict[str, Any]
) -> dict[str, Any]:
    kind = {"type": "scatter", "mode": "markers", "name": name, "x": list(x), "y": list(y)}
    return kind | {"marker": look, "hoverinfo": "skip"}


def _designs(front: Drawn, at: tuple[int, ...]) -> list[dict[str, Any]]:
    """Draw the designs, those that rules pick, and an empty ring for the one that is clicked."""
    letters = "xyz"[: len(at)]
    space = len(at) == 3
    kind = {"type": "scatter3d" if space else "scatter"}
    axis_lines = "<br>".join(
        f"{front.heads[n]} %{{{letter}:.5g}}" for letter, n in zip(letters, at, strict=True)
    )
    hover = {"hovertemplate": f"design %{{customdata}}<br>{axis_lines}<extra></extra>"}
    every = {letter: front.column(n) for letter, n in zip(letters, at, strict=True)}
    count = len(front.points)
    marker: dict[str, Any] = {
        "color": "--series-1",
        "size": 4 if space else 8 if count < 100 else 6,
    }
    some = sorted(front.picks)
    picked = {letter: [values[p] for p in some] for letter, values in every.items()}
    star: dict[str, Any] = {"color": "--series-2", "size": 7 if space else 14}
    star |= {"symbol": "diamond" if space else "star", "line": {"color": "--card", "width": 1}}
    ring = {"color": "--series-4", "size": 9 if space else 16, "symbol": "circle-open"}
    named: dict[str, Any] = {"mode": "markers+text", "text": [front.picks[p] for p in some]}
    named |= {"textposition": "top right", "textfont": {"size": 12, "color": "--ink"}}
    return [
        kind | hover | every
        | {"mode": "markers", "name": "designs", "meta": DESIGN, "marker": marker}
        | {"customdata": list(range(1, count + 1))},
        kind | hover | picked | named
        | {"name": "picked by a rule", "marker": star, "customdata": [p + 1 for p in some]},
        kind | {letter: [] for letter in letters}
        | {"mode": "markers", "name": "shown beside", "meta": CHOSEN, "hoverinfo": "skip"}
        | {"marker": ring | {"line": {"color": "--series-4", "width": 3}}},
    ]  # fmt: skip


def space(front: Drawn) -> Figure | None:
    """Plot three objectives in space; None where there are two."""
    if len(front.heads) != 3:
        return None
    plain = {
        "backgroundcolor": "--card",
        "gridcolor": "--grid",
        "showbackground": False,
    }
    names = ("xaxis", "yaxis", "zaxis")
    scene: dict[str, Any] = {
        name: plain | {"title": {"text": h}, "color": "--ink", "linecolor": "--axis"}
        for name, h in zip(names, front.heads, strict=True)
    }
    scene |= {"aspectmode": "cube", "camera": {"eye": {"x": 1.5, "y": 1.5, "z": 1.0}}}
    margin = {"l": 0, "r": 0, "t": 0, "b": 0}
    traces = _designs(front, (0, 1, 2))
    if front.beaten:
        rows = dict(zip("xyz", map(list, zip(*front.beaten, strict=True)), strict=True))
        look = {"color": f"{GREY}/0.6", "size": 2.5}
        grey = {"type": "scatter3d", "mode": "markers", "name": "dominated"}
        traces.insert(0, grey | rows | {"marker": look, "hoverinfo": "skip"})
    legend = {"orientation": "h", "x": 0, "y": 1.0}
    plot = LOOK | {"height": 560, "margin": margin, "scene": scene, "legend": legend}
    caption = "The three objectives in space: drag to turn, click a point to see its design."
    return Figure(traces, plot, caption, in_space(front))


def parallel(
    front: Front, drawn_front: Drawn, each: Sequence[Numbers], names: Sequence[str]
) -> Figure:
    """Plot every design as a line across an axis for each objective and main number."""
    columns = [
        list(zip(drawn_front.column(k), _texts(drawn_front, k), strict=True))
        for k in _count(drawn_front)
    ]
    columns += [[(float(named[n].value), named[n].text) for named in each] for n in names]
    heads = [*drawn_front.heads, *names]
    shares, ends = [], []
    for column in columns:
        low, high = min(column), max(column)
        wide = (high[0] - low[0]) or 1.0
        shares.append([(v - low[0]) / wide if high[0] > low[0] else 0.5 for v, _ in column])
        ends.append((low[1], high[1]))
    rows = list(zip(*shares, strict=True))
    steps: list[float | None] = [*range(len(heads)), None]
    at = {"x": steps * len(rows), "y": [v for row in rows for v in (*row, None)]}
    line = {"color": f"--series-1/{0.5 if len(rows) < 100 else 0.25}", "width": 1.2}
    look: dict[str, Any] = {"type": "scatter", "mode": "lines", "hoveron": "points"}
    hover = {"hovertemplate": "design %{customdata}<extra></extra>"}
    of_designs = {"customdata": [k for k in range(1, len(rows) + 1) for _ in steps], "meta": DESIGN}
    traces = [look | hover | of_designs | at | {"name": "designs", "line": line}]
    for place, words in sorted(drawn_front.picks.items()):
        row: dict[str, Any] = {"x": steps[:-1], "y": list(rows[place]), "hoverinfo": "skip"}
        traces.append(look | row | {"name": words, "line": {"color": "--series-2", "width": 2.6}})
    ring = {"x": [], "y": [], "meta": CHOSEN, "hoverinfo": "skip", "name": "shown beside"}
    traces.append(look | ring | {"line": {"color": "--series-4", "width": 3}})
    caption = (
        "Every line is a design; the ends of an axis are its minimum and maximum. Filters of the "
        "table below leave lines out here, too."
    )
    plot = _axes(heads, ends)
    return Figure(
        traces, plot, caption, lines(heads, ends, rows, sorted(drawn_front.picks), caption)
    )


def _count(front: Drawn) -> range:
    return range(len(front.heads))


def _texts(front: Drawn, k: int) -> list[str]:
    return [f"{v:,.5g}" for v in front.column(k)]


def _axes(heads: Sequence[str], ends: Sequence[tuple[str, str]]) -> dict[str, Any]:
    names = [h.replace(": ", "<br>").replace(" [", "<br>[") for h in heads]
    notes = [
        {"x": k, "y": y, "text": text, "showarrow": False, "yanchor": anchor, "font": {"size": 11}}
        for k, both in enumerate(ends)
        for y, text, anchor in ((-0.02, both[0], "top"), (1.02, both[1], "bottom"))
    ]
    rules = [
        {"type": "line", "x0": k, "x1": k, "y0": 0, "y1": 1, "layer": "below"}
        | {"line": {"color": "--axis", "width": 1}}
        for k in range(len(heads))
    ]
    plain = {"showgrid": False, "ticks": "", "showline": False}
    across = {"tickvals": list(range(len(heads))), "ticktext": names, "side": "top"}
    return layout(
        axis("", range=[-0.5, len(heads) - 0.5], **plain, **across),
        axis("", range=[-0.1, 1.1], showticklabels=False, **plain),
        420,
        annotations=notes,
        shapes=rules,
        hovermode="closest",
        showlegend=False,
        dragmode=False,
    )


def grown(front: Front) -> Figure | None:
    """Plot the part of the hypervolume that was found against time; None without steps."""
    steps = [g for g in front.growth if g.seconds > 0.0]
    if len(front.growth) < 2 or not steps or not front.hypervolume:
        return None
    whole = [100.0 * g.hypervolume / front.hypervolume for g in steps]
    seconds = [g.seconds for g in steps]
    hover = "%{y:.4g} % after %{x:.3g} s, %{customdata:,} evaluations<extra></extra>"
    trace = curve(seconds, whole, "--series-1", 2.2, shape="hv", hover=hover, name=front.method)
    trace |= {"mode": "lines+markers", "marker": {"color": "--series-1", "size": 5}}
    trace["customdata"] = [g.evaluations for g in steps]
    plot = layout(
        axis("time [s]", type="log"), axis("hypervolume [% of the whole]", rangemode="tozero"), 320
    )
    caption = (
        f"{front.method}: hypervolume of the designs found so far, relative to that of the front "
        "above, each point where it grew."
    )
    return Figure([trace], plot, caption)


def scatter(
    front: Drawn, i: int, k: int, ends: tuple[Span, Span], corners: Sequence[Span], caption: str
) -> Drawing:
    """Draw two objectives against each other as the plot does."""
    free = (LEFT, EDGE, BELOW, EDGE)
    sheet = Sheet(Window(0.0, WIDE, 0.0, HIGH, free), 1.0)

    def at(x: float, y: float) -> tuple[float, float]:
        (x0, x1), (y0, y1) = ends
        return WIDE * (x - x0) / (x1 - x0), HIGH * (y - y0) / (y1 - y0)

    _frame(sheet, ends, (front.heads[i], front.heads[k]))
    if len(front.heads) == 2 and len(front.points) > 1:
        _chords(sheet, [sheet.at(*at(*values)) for values in front.points], front.curve)
    for values in front.beaten:
        sheet.circle(*at(values[i], values[k]), DOT, "beaten")
    for corner in corners:
        spot = (min(v, end[1]) for v, end in zip(corner, ends, strict=True))
        _cross(sheet, *at(*spot))
    for values in front.points:
        sheet.circle(*at(values[i], values[k]), DOT, "design")
    for place, words in sorted(front.picks.items()):
        x, y = at(front.points[place][i], front.points[place][k])
        sheet.circle(x, y, 2.0 * DOT, "picked", "--series-2")
        sheet.label(words, around(sheet.at(x, y), (22.0, 34.0, 48.0), 6.0), "name")
    return sheet.drawing(caption, caption)


def _frame(sheet: Sheet, ends: tuple[Span, Span], heads: tuple[str, str]) -> None:
    """Draw both axes with round numbers and what they are."""
    sheet.line((0.0, 0.0), (WIDE, 0.0), "axes")
    sheet.line((0.0, 0.0), (0.0, HIGH), "axes")
    (x0, x1), (y0, y1) = ends
    for value in even_ticks(x0, x1):
        x, _ = sheet.at(WIDE * (value - x0) / (x1 - x0), 0.0)
        sheet.tick((x, EDGE + HIGH), (x, EDGE + HIGH + 5.0))
        sheet.label(f"{value:,.6g}", [Place(x, EDGE + HIGH + 14.0)], "size")
    for value in even_ticks(y0, y1):
        _, y = sheet.at(0.0, HIGH * (value - y0) / (y1 - y0))
        sheet.tick((LEFT - 5.0, y), (LEFT, y))
        text = f"{value:,.6g}"
        sheet.label(text, [Place(LEFT - 6.0 - Place(0, 0).half_width(text), y)], "size")
    sheet.label(heads[0], [Place(LEFT + 0.5 * WIDE, EDGE + HIGH + 34.0)], "plain")
    sheet.label(heads[1], [Place(12.0, EDGE + 0.5 * HIGH, -90.0)], "plain")


def _chords(sheet: Sheet, spots: Sequence[tuple[float, float]], curve: bool) -> None:
    """Draw chords of a curve, or the steps of single designs [px]."""
    (x, y), *others = spots
    steps = " ".join(f"L {x:.1f} {y:.1f}" if curve else f"H {x:.1f} V {y:.1f}" for x, y in others)
    sheet.shape(f"M {x:.1f} {y:.1f} {steps}", "lines")


def _cross(sheet: Sheet, x: float, y: float) -> None:
    for turn in (-1.0, 1.0):
        sheet.line((x - 4.0, y - 4.0 * turn), (x + 4.0, y + 4.0 * turn), "without")


def in_space(front: Drawn) -> Drawing:
    """Draw three objectives in a cube, seen from where the view that turns begins."""
    spans = [front.span(k) for k in range(3)]
    seen, room = view(), ((0.0, 0.0, 0.0), (CUBE, CUBE, CUBE))

    def at(values: Sequence[float]) -> tuple[float, float]:
        x, y, z = (CUBE * (v - a) / (b - a) for v, (a, b) in zip(values, spans, strict=True))
        return seen.at((x, y, z))

    ends = (0.0, CUBE)
    us, vs = zip(*(seen.at((x, y, z)) for x in ends for y in ends for z in ends), strict=True)
    side = 2.0 * max(Place(0.0, 0.0).half_width(name) for name in front.heads) + EDGE
    window = Window(min(us), max(us), min(vs), max(vs), (side, side, BELOW, EDGE))
    sheet = Sheet(window, 1.0)
    for pair in (pair for some in edges(*room, seen) for pair in some):
        sheet.line(seen.at(pair[0]), seen.at(pair[1]), "far")
    for style, rows in (("beaten", front.beaten), ("design", front.points)):
        for values in rows:
            sheet.circle(*at(values), DOT, style)
    for place, words in sorted(front.picks.items()):
        x, y = at(front.points[place])
        sheet.circle(x, y, 2.0 * DOT, "picked", "--series-2")
        sheet.label(words, around(sheet.at(x, y), (22.0, 34.0, 48.0), 6.0), "name")
    outside(sheet, room, seen, front.heads)
    caption = "The three objectives in space, in parallel projection."
    return sheet.drawing("front in space", caption)


def lines(
    heads: Sequence[str],
    ends: Sequence[tuple[str, str]],
    rows: Sequence[Sequence[float]],
    picks: Sequence[int],
    caption: str,
) -> Drawing:
    """Draw every design as a line across parallel axes; rows: shares of every axis, 0 to 1."""
    count = len(heads)
    pitch = WIDE / max(1, count - 1)
    sheet = Sheet(Window(0.0, WIDE, 0.0, HIGH, (LEFT, LEFT, 24.0, 74.0)), 1.0)
    for k, row in enumerate(rows):
        if k not in picks:
            _path(sheet, row, pitch, "lines")
    for k in picks:
        _path(sheet, rows[k], pitch, "lines chosen")
    for k, (name, (low, high)) in enumerate(zip(heads, ends, strict=True)):
        sheet.line((k * pitch, 0.0), (k * pitch, HIGH), "axes")
        x, bottom = sheet.at(k * pitch, 0.0)
        top = bottom - HIGH
        sheet.label(low, [Place(x, bottom + 12.0)], "size")
        sheet.label(high, [Place(x, top - 9.0)], "size")
        for n, word in enumerate(reversed(_parts(name))):
            sheet.label(word, [Place(x, top - 25.0 - 14.0 * n)], "plain")
    return sheet.drawing("parallel coordinates", caption.partition(" Filters")[0])


def _parts(name: str) -> list[str]:
    """The lines of the name of an axis: "stage 1", "teeth z1"."""
    stage, _, rest = name.rpartition(": ")
    words, _, unit = rest.partition(" [")
    return [part for part in (stage, words, f"[{unit}" if unit else "") if part]


def _path(sheet: Sheet, row: Sequence[float], pitch: float, style: str) -> None:
    spots = (sheet.at(k * pitch, HIGH * share) for k, share in enumerate(row))
    sheet.shape("M " + " L ".join(f"{x:.1f} {y:.1f}" for x, y in spots), style)
