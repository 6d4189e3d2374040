"""Pages and their drawings taken apart: tags, text, marks, and the room that texts fill."""

import re
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import numpy as np

from gearopt.report.drawing.sheet import LETTER, SIZE

ATTACK = "</title><script>alert('x')</script><b>&"


class Reader(HTMLParser):
    """Tags with their attributes, visible text, and the content of scripts by type."""

    def __init__(self, html):
        super().__init__(convert_charrefs=True)
        self.tags, self.text, self.scripts, self.open = [], [], [], ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self.open = tag if tag in ("script", "style") else ""
        if tag == "script":
            self.scripts.append((dict(attributes).get("type", ""), ""))

    def handle_endtag(self, tag):
        self.open = ""

    def handle_data(self, data):
        if self.open == "script":
            self.scripts[-1] = (self.scripts[-1][0], self.scripts[-1][1] + data)
        elif not self.open:
            self.text.append(data)


def drawings(html):
    """Every SVG of a page as a tree, but for stills of views in space."""
    found = [ET.fromstring(text) for text in re.findall(r"<svg .*?</svg>", ours(html), re.S)]
    return [svg for svg in found if not svg.get("aria-label").endswith("in space")]


def ours(html):
    """A page without its scripts."""
    return re.sub(r"<script.*?</script>", "", html, flags=re.S)


def marks(svg, tag, style):
    return [e for e in svg.iter(tag) if style in e.get("class", "").split()]


def numbers(element, *names):
    return [float(element.get(name)) for name in names]


def extents(svg):
    """Rectangles that the upright or level texts of a drawing fill: x, y, half sizes."""
    for text in svg.iter("text"):
        x, y = numbers(text, "x", "y")
        half = 0.5 * LETTER * SIZE * len(text.text), 0.4 * SIZE
        turn = text.get("transform", "rotate(0 ")
        angle = float(re.match(r"rotate\(([-\d.]+) ", turn)[1])
        if angle in (0.0, -90.0):
            yield text.text, np.array([x, y]), np.array(half if angle == 0.0 else half[::-1])


def on_screen(html):
    """A page without what it says on paper alone."""
    return re.sub(r'<(p|span) class="on-paper">.*?</\1>', "", html, flags=re.S)


def without_input(html):
    """A page without the numbers of the file, which stand as they were written."""
    return re.sub(r"<details>\s*<summary><h2>Input data.*?</details>", "", html, flags=re.S)
