"""The frame of a page: header, sections, tables, figures, footer; light and dark; printable."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from gearopt.report.pages.title_block import block, margins


@cache
def templates() -> Any:
    """The jinja2 environment of our templates; all that is put into them is escaped."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader("gearopt.report", "pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


@cache
def plots_script() -> str:
    """The library that draws the figures of a page, 4.8 MB."""
    from plotly.offline import get_plotlyjs

    script: str = get_plotlyjs()
    return script


def render(
    template: str,
    title: str,
    subtitle: str,
    versions: Mapping[str, str],
    command: str,
    asked: Mapping[str, Any],
    plots: bool = True,
    moves: bool = False,
    **content: Any,
) -> str:
    """A page from a template that extends frame.html; all but our own files is escaped.

    asked: the tables of the file, of which [report] is the title block. plots: the page has
    figures, which need plotly (4.8 MB) inside it. moves: it has animations.
    """
    from markupsafe import Markup

    room = templates()

    def inlined(name: str) -> Markup:
        return Markup(room.loader.get_source(room, name)[0])

    page: str = room.get_template(template).render(
        title=title,
        subtitle=subtitle,
        versions=versions,
        command=command,
        block=block(asked),
        margins=Markup(margins(title, asked)),
        style=inlined("frame.css"),
        script=inlined("frame.js"),
        player=inlined("player.js") if moves else "",
        plotly=Markup(plots_script()) if plots else "",
        **content,
    )
    return page
