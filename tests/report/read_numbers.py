"""What a page shows as words and numbers: by place, each number once."""

import re
from collections import Counter
from html.parser import HTMLParser

VOID = {"meta", "link", "br", "img", "input", "hr", "line", "rect", "circle", "polygon", "path"}
HIDDEN = {"script", "style", "title", "footer", "details", "head"}  # a fold is not read at first
PLACES = {"dl": "tiles", "figcaption": "captions", "svg": "drawings", "header": "sentences"}
NUMBER = re.compile(r"(?<![\w.#])[-+−±]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?(?![\w]*[A-Za-z]\w*\d)")


class Page(HTMLParser):
    """Pieces of visible text: (place, which of its tables, text)."""

    def __init__(self, html):
        super().__init__(convert_charrefs=True)
        self.pieces, self.open, self.tables = [], [], 0
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attributes):
        if tag == "table":
            self.tables += 1
        if tag not in VOID:
            self.open.append((tag, dict(attributes).get("class") or ""))

    def handle_endtag(self, tag):
        while tag not in VOID and self.open and self.open.pop()[0] != tag:
            pass

    def handle_data(self, data):
        tags = [tag for tag, _ in self.open]
        if not data.strip() or HIDDEN & set(tags) or self.open[-1][1] == "csv":
            return
        place = next((PLACES[tag] for tag in tags if tag in PLACES), "sentences")
        place = "tables" if "table" in tags else place
        self.pieces.append((place, self.tables if place == "tables" else 0, data.strip()))


def words(html):
    """Return how many words are visible, by place and in all."""
    found = Counter()
    for place, _, text in Page(html).pieces:
        found[place] += len(text.split())
    return dict(found) | {"all": sum(found.values())}


def figures(text):
    """Return the significant digits of every number of three or more in a text."""
    for found in NUMBER.findall(text):
        mantissa = re.sub(r"e.*", "", found.lower())
        digits = re.sub(r"\D", "", mantissa).strip("0")
        if len(digits) >= 3:
            yield digits


def repeated(html):
    """Return numbers that stand twice outside tables, or in two tables; drawings are apart.

    The same digits are the same number, whatever their unit. Across tables only numbers of four
    digits and more count: shorter ones are the same by chance, as teeth and percentages are.
    """
    outside, tables = Counter(), {}
    for place, table, text in Page(html).pieces:
        for digits in figures(text):
            if place == "tables":
                tables.setdefault(digits, set()).add(table)
            elif place != "drawings":
                outside[digits] += 1
    twice = {digits: f"{n} times outside tables" for digits, n in outside.items() if n > 1}
    many = {d: len(t) for d, t in tables.items() if len(t) > 1 and len(d) > 3}
    return twice | {d: f"in {n} tables" for d, n in many.items()}
