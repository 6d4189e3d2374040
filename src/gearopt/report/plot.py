"""Plots of a page: plain plotly specifications in the page's look.

Colours are CSS variables of frame.css, written "--ink" or "--series-1/0.2" (with opacity): frame.js
resolves them, and again when the reader's system turns dark or prints.
"""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Figure:
    """A plot: its plotly data and layout, and what a reader is told below it."""

    data: list[dict[str, Any]]
    layout: dict[str, Any]
    caption: str


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
        "margin": {"l": 8, "r": 12, "t": 8, "b": 8},
        "paper_bgcolor": "--card",
        "plot_bgcolor": "--card",
        "font": {"family": "--font", "size": 13, "color": "--ink"},
        "hoverlabel": {"bgcolor": "--card", "bordercolor": "--axis", "font": {"color": "--ink"}},
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
    return look | more
