"""Drawings side by side at one scale, on the page and on a printed sheet."""

from collections.abc import Sequence
from dataclasses import dataclass

from gearopt.report.drawing.sheet import Drawing

SHEET = 660.0  # px across an A4 sheet inside its margins
GUTTER = 18.0  # px between drawings, as in drawing.css
TALL = 480.0  # px of a sheet that drawings may take, where their text stays legible
LEGIBLE = 0.58  # of a text of 12 px: 5.2 pt on paper


@dataclass(frozen=True)
class Row:
    """Drawings that stand side by side where there is room, and shrink alike."""

    drawings: Sequence[Drawing]

    @property
    def widest(self) -> float:
        """Return the width of the widest drawing [px]; all shrink with it, to keep one scale."""
        return max(drawing.width for drawing in self.drawings)

    @property
    def sheet(self) -> float:
        """Return what an A4 sheet has room for [px]."""
        return SHEET

    @property
    def printed(self) -> float:
        """Return how much the drawings shrink in print so that all stand side by side, or two.

        They leave room on the sheet for other things, but their text stays legible.
        """
        low = max(TALL / max(drawing.height for drawing in self.drawings), LEGIBLE)
        for some in (self.drawings, self.drawings[:2]):
            wide = sum(drawing.width + GUTTER for drawing in some) - GUTTER
            if (share := SHEET / wide) > LEGIBLE:
                return min(1.0, share, low)
        return min(1.0, low)
