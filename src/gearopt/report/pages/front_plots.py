"""The plots of a Pareto front: pairs of objectives, three in space, parallel lines, its growth."""

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from gearopt.optimise.pareto.front import Front
from gearopt.report.pages.front_designs import Numbers
from gearopt.report.pages.front_stills import in_space, lines, scatter
from gearopt.report.pages.front_values import AXIS_MARGIN, FARTHEST_SHOWN, Drawn, Span
from gearopt.report.plots import LOOK, Figure, axis, layout
from gearopt.report.plots import lines as curve

GREY = "--axis"
DESIGN, CHOSEN = "designs", "chosen"  # what the page's script moves


def pairs(found: Drawn) -> list[Figure]:
    """Plot every two objectives against each other."""
    return [_pair(found, i, k) for i, k in combinations(range(len(found.heads)), 2)]


def _pair(found: Drawn, i: int, k: int) -> Figure:
    whole = len(found.heads) == 2
    across, up = _wide(found, i), _wide(found, k)
    traces = [_line(found)] if whole and len(found.points) > 1 else []
    if found.beaten:
        x, y = ([p[n] for p in found.beaten] for n in (i, k))
        traces.append(_marks("dominated", x, y, {"color": f"{GREY}/0.7", "size": 5}))
    if (corners := _corners(found, i, k)) and whole:
        x, y = [min(a, across[1]) for a, _ in corners], [min(b, up[1]) for _, b in corners]
        look = {
            "color": GREY,
            "size": 9,
            "symbol": "x-thin",
            "line": {"color": GREY, "width": 2},
        }
        crosses = _marks("limits without a design", x, y, look)
        traces.append(crosses | {"cliponaxis": False})
    traces += _designs(found, (i, k))
    told = {"legend": {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"}}
    plot = layout(
        axis(found.heads[i], range=list(across)),
        axis(found.heads[k], range=list(up)),
        460 if whole else 360,
        hovermode="closest",
        **told,
    )
    caption = _caption(found, i, k)
    return Figure(traces, plot, caption, scatter(found, i, k, (across, up), corners, caption))


def _wide(found: Drawn, k: int) -> Span:
    """Return the ends of an axis, with the limits that have no design if they are near."""
    low, high = found.span(k)
    reach = FARTHEST_SHOWN * (high - low)
    known = [c[k] for c in found.corners]
    lowest = [v for v in known if v is not None and low - reach < v < low]
    farther = [p[k] for p in found.beaten if p[k] > high]
    room = AXIS_MARGIN * (high - low)
    return min([low, *(v - room for v in lowest)]), max([high, *(v + room for v in farther)])


def _corners(found: Drawn, i: int, k: int) -> list[Span]:
    """Return limits of two objectives alone that leave no design; inf for any."""
    rows = []
    for corner in found.corners:
        others = [v for n, v in enumerate(corner) if n not in (i, k)]
        if all(v is None for v in others):
            a, b = (float("inf") if corner[n] is None else float(corner[n] or 0.0) for n in (i, k))
            rows.append((a, b))
    return rows


def _caption(found: Drawn, i: int, k: int) -> str:
    names = [found.heads[n].split(" [")[0] for n in (i, k)]
    words = f"{names[0][0].upper()}{names[0][1:]} against {names[1]}."
    if len(found.heads) > 2:
        words += " A point that looks dominated here is better in the third objective."
    elif len(found.points) > 1:
        line = (
            "chords between points"
            if found.curve
            else "the boundary of what these designs dominate"
        )
        words += f" Line: {line}."
    if found.beaten:
        words += " Grey dots: dominated designs."
    if found.corners and len(found.heads) == 2:
        words += " Grey crosses: limits that no design meets."
    return words


def _line(found: Drawn) -> dict[str, Any]:
    """Draw chords of a curve, or the steps of single designs."""
    shape = "linear" if found.curve else "hv"
    trace = curve(found.column(0), found.column(1), "--series-1/0.45", 1.4, shape=shape)
    return trace | {"hoverinfo": "skip", "showlegend": False}


def _marks(
    name: str, x: Sequence[float], y: Sequence[float], look: dict[str, Any]
) -> dict[str, Any]:
    kind = {"type": "scatter", "mode": "markers", "name": name, "x": list(x), "y": list(y)}
    return kind | {"marker": look, "hoverinfo": "skip"}


def _designs(found: Drawn, at: tuple[int, ...]) -> list[dict[str, Any]]:
    """Draw the designs, those that rules pick, and an empty ring for the one that is clicked."""
    letters = "xyz"[: len(at)]
    space = len(at) == 3
    kind = {"type": "scatter3d" if space else "scatter"}
    told = "<br>".join(
        f"{found.heads[n]} %{{{letter}:.5g}}" for letter, n in zip(letters, at, strict=True)
    )
    hover = {"hovertemplate": f"design %{{customdata}}<br>{told}<extra></extra>"}
    every = {letter: found.column(n) for letter, n in zip(letters, at, strict=True)}
    count = len(found.points)
    marker: dict[str, Any] = {
        "color": "--series-1",
        "size": 4 if space else 8 if count < 100 else 6,
    }
    some = sorted(found.picks)
    picked = {letter: [values[p] for p in some] for letter, values in every.items()}
    star: dict[str, Any] = {"color": "--series-2", "size": 7 if space else 14}
    star |= {"symbol": "diamond" if space else "star", "line": {"color": "--card", "width": 1}}
    ring = {"color": "--series-4", "size": 9 if space else 16, "symbol": "circle-open"}
    named: dict[str, Any] = {"mode": "markers+text", "text": [found.picks[p] for p in some]}
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


def space(found: Drawn) -> Figure | None:
    """Plot three objectives in space; None where there are two."""
    if len(found.heads) != 3:
        return None
    plain = {
        "backgroundcolor": "--card",
        "gridcolor": "--grid",
        "showbackground": False,
    }
    names = ("xaxis", "yaxis", "zaxis")
    scene: dict[str, Any] = {
        name: plain | {"title": {"text": h}, "color": "--ink", "linecolor": "--axis"}
        for name, h in zip(names, found.heads, strict=True)
    }
    scene |= {"aspectmode": "cube", "camera": {"eye": {"x": 1.5, "y": 1.5, "z": 1.0}}}
    margin = {"l": 0, "r": 0, "t": 0, "b": 0}
    traces = _designs(found, (0, 1, 2))
    if found.beaten:
        rows = dict(zip("xyz", map(list, zip(*found.beaten, strict=True)), strict=True))
        look = {"color": f"{GREY}/0.6", "size": 2.5}
        grey = {"type": "scatter3d", "mode": "markers", "name": "dominated"}
        traces.insert(0, grey | rows | {"marker": look, "hoverinfo": "skip"})
    legend = {"orientation": "h", "x": 0, "y": 1.0}
    plot = LOOK | {"height": 560, "margin": margin, "scene": scene, "legend": legend}
    caption = "The three objectives in space: drag to turn, click a point to see its design."
    return Figure(traces, plot, caption, in_space(found))


def parallel(front: Front, found: Drawn, each: Sequence[Numbers], names: Sequence[str]) -> Figure:
    """Plot every design as a line across an axis for each objective and main number."""
    columns = [list(zip(found.column(k), _texts(found, k), strict=True)) for k in _count(found)]
    columns += [[(float(one[n].value), one[n].text) for one in each] for n in names]
    heads = [*found.heads, *names]
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
    own = {"customdata": [k for k in range(1, len(rows) + 1) for _ in steps], "meta": DESIGN}
    traces = [look | hover | own | at | {"name": "designs", "line": line}]
    for place, words in sorted(found.picks.items()):
        row: dict[str, Any] = {"x": steps[:-1], "y": list(rows[place]), "hoverinfo": "skip"}
        traces.append(look | row | {"name": words, "line": {"color": "--series-2", "width": 2.6}})
    ring = {"x": [], "y": [], "meta": CHOSEN, "hoverinfo": "skip", "name": "shown beside"}
    traces.append(look | ring | {"line": {"color": "--series-4", "width": 3}})
    caption = (
        "Every line is a design; at the ends of an axis its least and largest value. Filters of "
        "the table below leave lines out here, too."
    )
    plot = _axes(heads, ends)
    return Figure(traces, plot, caption, lines(heads, ends, rows, sorted(found.picks), caption))


def _count(found: Drawn) -> range:
    return range(len(found.heads))


def _texts(found: Drawn, k: int) -> list[str]:
    return [f"{v:,.5g}" for v in found.column(k)]


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
