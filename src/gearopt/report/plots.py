"""Plots of a page: figures, axes and layouts in its look, and the traces and shapes they hold.

Traces and shapes are dicts as plotly has them; more: other keys of these.
"""

from collections.abc import Iterable
from typing import Any

from gearopt.frozen import dataclass
from gearopt.report.drawing.sheet import Drawing

Dict = dict[str, Any]
TEXT = "%{text}<extra></extra>"  # of a hover that says the text of a point and no more


@dataclass(frozen=True)
class Figure:
    """A plot: its plotly data and layout, and its caption.

    still: what is seen before it is drawn, and in print; of a view in space without WebGL, too.
    follows: the name of an animation of the page, whose moment lines mark on the x axis. appendix:
    as of a `Section`.
    """

    data: list[dict[str, Any]]
    layout: dict[str, Any]
    caption: str
    still: Drawing | None = None
    follows: str = ""
    appendix: bool = False

    @property
    def space(self) -> bool:
        """Whether it is a view in space, which needs WebGL."""
        return "scene" in self.layout


LOOK = {  # of any plot
    "paper_bgcolor": "--card",
    "font": {"family": "--font", "size": 13, "color": "--ink"},
    "hoverlabel": {"bgcolor": "--card", "bordercolor": "--axis", "font": {"color": "--ink"}},
}


def axis(title: str, **more: Any) -> dict[str, Any]:
    """A plot's axis in the page's look."""
    look = {
        "title": {"text": title, "standoff": 10, "font": {"size": 13}},
        "gridcolor": "--grid",
        "linecolor": "--axis",
        "zeroline": False,
        "showline": True,
        "ticks": "outside",
        "ticklen": 4,
        "tickcolor": "--axis",
        "automargin": True,
    }
    return look | more


def layout(x: dict[str, Any], y: dict[str, Any], height: int = 360, **more: Any) -> dict[str, Any]:
    """A plot's layout in the page's look."""
    look = {
        "height": height,
        "margin": {"l": 8, "r": 28, "t": 8, "b": 8},
        "plot_bgcolor": "--card",
        "legend": {
            "orientation": "h",
            "traceorder": "normal",
            "x": 0,
            "xanchor": "left",
            "y": 1.02,
            "yanchor": "bottom",
        },
        "xaxis": x,
        "yaxis": y,
    }
    return LOOK | look | more


def lines(
    x: Iterable[Any],
    y: Iterable[Any],
    colour: str,
    width: float = 2.0,
    dash: str = "",
    shape: str = "",
    hover: str = "",
    **more: Any,
) -> Dict:
    """A curve; hover: what it says where the pointer rests."""
    line = {"color": colour, "width": width} | _given(dash=dash, shape=shape)
    trace = {"type": "scatter", "mode": "lines", "x": [*x], "y": [*y], "line": line}
    return trace | _given(hovertemplate=hover) | more


def _given(**texts: str) -> dict[str, str]:
    return {key: text for key, text in texts.items() if text}


def points(
    x: Iterable[Any],
    y: Iterable[Any],
    name: str,
    marker: Dict,
    hover: str,
    **more: Any,
) -> Dict:
    """Marks of a colour, size and symbol."""
    trace = {"type": "scatter", "mode": "markers", "name": name, "x": [*x], "y": [*y]}
    return trace | {"marker": marker, "hovertemplate": hover} | more


def bars(x: Iterable[Any], y: Iterable[Any], marker: Dict, hover: str, **more: Any) -> Dict:
    """Bars from the left to x at the heights y, unless `orientation` is "v"."""
    trace = {"type": "bar", "orientation": "h", "x": [*x], "y": [*y]}
    return trace | {"marker": marker, "hovertemplate": hover} | more


def heat(x: Iterable[Any], y: Iterable[Any], z: Any, title: str, hover: str, **more: Any) -> Dict:
    """A map of colours with its scale, of this title."""
    scale = {"title": {"text": title}, "thickness": 12, "outlinewidth": 0}
    trace = {"type": "heatmap", "x": [*x], "y": [*y], "z": z, "name": ""}
    return trace | {"colorbar": scale, "hovertemplate": hover} | more


def band(low: float, high: float, colour: str = "--grid", **more: Any) -> Dict:
    """A shape: a band over the whole height, behind the curves."""
    place = {"yref": "paper", "x0": low, "x1": high, "y0": 0.0, "y1": 1.0, "layer": "below"}
    return {"type": "rect", "fillcolor": colour, "line": {"width": 0}} | place | more


def upright(place: float, layer: str = "below") -> Dict:
    """A shape: a dotted line over the whole height."""
    line = {"color": "--axis", "width": 1, "dash": "dot"}
    ends = {"yref": "paper", "x0": place, "x1": place, "y0": 0.0, "y1": 1.0, "layer": layer}
    return {"type": "line", "line": line} | ends
