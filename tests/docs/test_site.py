"""The site: it builds without a warning, has every page, and needs no network."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted(path.stem for path in DOCS.glob("*.md"))
LOADED = {"src", "srcset", "data", "poster", "action", "formaction", "background", "xlink:href"}
ELSEWHERE = re.compile(r"^\s*(?:https?:)?//", re.I)
QUOTED = re.compile(r"""["'`(]\s*((?:https?:)?//[a-z][^"'`)\s]*)""", re.I)


class Loads(HTMLParser):
    """What a page makes a browser fetch: links that a reader clicks are none of it."""

    def __init__(self, html):
        super().__init__()
        self.found, self.styles, self.inside = [], [], ""
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        self.inside = tag if tag in ("style", "script") else ""
        for name, value in attributes:
            if name in LOADED or (name == "href" and tag != "a"):
                self.found.append(value or "")
            elif name == "style":
                self.styles.append(value or "")

    def handle_endtag(self, tag):
        self.inside = ""

    def handle_data(self, data):
        if self.inside:
            self.styles.append(data)


def from_elsewhere(html):
    """Addresses beyond the site that a page loads from, in tags, styles or scripts."""
    page = Loads(html)
    quoted = [u for text in page.styles for u in QUOTED.findall(text) if "w3.org" not in u]
    return [url for url in page.found if ELSEWHERE.match(url)] + quoted


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    room = tmp_path_factory.mktemp("site")
    command = ["-m", "sphinx", "-q", "-W", "--keep-going", "-d", f"{room}/trees", "-b", "html"]
    done = subprocess.run(
        [sys.executable, *command, str(DOCS), f"{room}/html"], capture_output=True, text=True
    )
    assert done.returncode == 0 and not done.stderr, done.stderr
    return room / "html"


@pytest.mark.slow
def test_every_page_is_built(site):
    assert len(PAGES) >= 15 and all((site / f"{name}.html").exists() for name in PAGES)
    assert len(list((site / "_downloads").rglob("*.toml"))) >= 30  # the gallery's files


@pytest.mark.slow
def test_no_page_needs_a_network(site):
    pages = list(site.rglob("*.html"))
    assert len(pages) >= len(PAGES)
    assert {str(p): f for p in pages if (f := from_elsewhere(p.read_text("utf-8")))} == {}
    for path in (*site.rglob("*.css"), *site.rglob("*.js"), *site.rglob("*.svg")):
        text = re.sub(r"/\*.*?\*/", "", path.read_text("utf-8"), flags=re.S)
        assert [u for u in QUOTED.findall(text) if "w3.org" not in u] == [], path


@pytest.mark.parametrize(
    "html",
    [
        '<script src="https://x.org/a.js"></script>',
        '<link rel="stylesheet" href="//x.org/a.css">',
        '<img src="http://x.org/a.png">',
        "<style>@import url(https://x.org/a.css);</style>",
        "<p style=\"background: url('//x.org/a.png')\">",
        "<script>fetch('https://x.org')</script>",
    ],
)
def test_what_would_need_one_is_seen(html):
    assert from_elsewhere(html)


def test_a_link_to_click_needs_none():
    assert not from_elsewhere('<a href="https://x.org">x</a><img src="a.png">')


def test_the_index_names_every_page():
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    links = set(re.findall(r"\]\((\w+)\.md\)", index))
    assert links == set(PAGES) - {"index"}
