"""Pages taken apart for tests."""

from html.parser import HTMLParser

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
