"""The title block of a page, from the table [report]; header and footer of its printed sheets."""

from collections.abc import Mapping
from typing import Any

from gearopt.report.measures import INCH, METRIC, Measures

LABELS = {  # keys of [report]: what stands before their text
    "company": "Company",
    "customer": "Customer",
    "number": "Report no.",
    "revision": "Revision",
    "date": "Date",
    "engineer": "Prepared by",
    "approved": "Approved by",
    "note": "Note",
}
PAPERS = {METRIC: "A4", INCH: "Letter"}
LONGEST = 70  # characters of a text in a margin, which is one line


def block(asked: Mapping[str, Any]) -> dict[str, str]:
    """What a title block says, by its labels; asked: the tables of the file."""
    table = head(asked)
    return {label: str(table[key]) for key, label in LABELS.items() if table.get(key)}


def margins(title: str, asked: Mapping[str, Any]) -> str:
    """Rules of CSS for the margins of printed sheets: who, what, which revision, page x of y.

    Browsers that have no boxes in margins leave them out.
    """
    entries = block(asked)
    which = [f"{k} {entries[k]}" if k == "Revision" else entries[k] for k in SHORT if k in entries]
    texts = {
        "@top-left": _text(entries.get("Company", "")),
        "@top-right": _text(title),
        "@bottom-left": _text(", ".join(which)),
        "@bottom-right": '"Page " counter(page) " of " counter(pages)',
    }
    return "".join(f"{box} {{ content: {text} }} " for box, text in texts.items())


SHORT = ("Report no.", "Revision", "Date")  # in the footer


def paper(asked: Mapping[str, Any], measures: Measures) -> str:
    """The paper of a PDF: that of the file, else the one usual where these units are."""
    wanted = str(head(asked).get("paper"))
    return wanted if wanted in PAPERS.values() else PAPERS[measures]


def head(asked: Mapping[str, Any]) -> Mapping[str, Any]:
    """The table [report] of a file; empty without one."""
    table = asked.get("report")
    return table if isinstance(table, Mapping) else {}


def _text(words: str) -> str:
    """A string of CSS, in which no sign but letters and digits stands as it is."""
    short = words if len(words) <= LONGEST else f"{words[: LONGEST - 1]}…"
    return (
        '"' + "".join(c if c.isalnum() and c.isascii() else f"\\{ord(c):x} " for c in short) + '"'
    )
