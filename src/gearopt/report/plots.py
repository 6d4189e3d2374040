"""Plots of a page: figures, axes and layouts in its look."""

from dataclasses import dataclass
from typing import Any

from gearopt.report.drawing.sheet import Drawing


@dataclass(frozen=True)
class Figure:
    """A plot: its plotly data and layout, and its caption.

    still: what is seen before it is drawn, and in print; of a view in space without WebGL, too.
    follows: the name of an animation of the page, whose moment lines mark on the x axis.
    """

    data: list[dict[str, Any]]
    layout: dict[str, Any]
    caption: str
    still: Drawing | None = None
    follows: str = ""

    @property
    def space(self) -> bool:
        """Return whether it is a view in space, which needs WebGL."""
        return "scene" in self.layout


LOOK = {  # of any plot
    "paper_bgcolor": "--card",
    "font": {"family": "--font", "size": 13, "color": "--ink"},
    "hoverlabel": {"bgcolor": "--card", "bordercolor": "--axis", "font": {"color": "--ink"}},
}


def axis(title: str, **more: Any) -> dict[str, Any]:
    """Return a plot's axis in the page's look."""
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
    """Return a plot's layout in the page's look."""
    look = {
        "height": height,
        "margin": {"l": 8, "r": 12, "t": 8, "b": 8},
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
