"""The terminal that shows what answers and messages hold, and obeys none of it."""

from collections.abc import Iterable
from unicodedata import category

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

JOINERS = "\u200c\u200d"  # between letters of some scripts, and within emoji


def harmless(text: str) -> str:
    """A text with a ? for every character that a terminal obeys or that hides others.

    Those are controls (ESC and C1 among them) but for line ends and tabs, marks of the direction of
    writing, which can show a text in another order, and halves of characters.
    """
    return text if text.isprintable() else "".join(c if _shown(c) else "?" for c in text)


def _shown(c: str) -> bool:
    return c.isprintable() or c in "\n\t" or c in JOINERS or category(c) == "Zs"


class Screen(Console):
    """A console for texts that others may have written; an interface of rich."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Yield what is printed, with harmless texts; colours come after them."""
        for segment in super().render(renderable, options):
            text, style, control = segment
            yield segment if control else Segment(harmless(text), style)
