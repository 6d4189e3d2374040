"""What a page is made of: sections of key figures, sentences, drawings, plots and tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gearopt.report.measures import Measures
from gearopt.report.pages.frame import Figure
from gearopt.report.pages.sheet import Drawing
from gearopt.report.pages.table import Table

SHEET = 660.0  # px across an A4 sheet inside its margins
GUTTER = 18.0  # px between drawings, as in drawing.css
LEGIBLE = 0.6  # of a text of 12 px: 5.4 pt on paper
COLOURS = 8  # --series-1 ... in frame.css, told apart by the colour-blind


@dataclass(frozen=True)
class Tile:
    """A key figure: what it is called, its value with the unit, a remark."""

    name: str
    value: str
    remark: str = ""


@dataclass(frozen=True)
class Section:
    """A heading, then key figures, sentences, drawings at one scale, plots, tables.

    half: two such sections stand side by side where the page is wide.
    """

    heading: str
    tiles: Sequence[Tile] = ()
    words: Sequence[str] = ()
    drawings: Sequence[Drawing] = ()
    figures: Sequence[Figure] = ()
    tables: Sequence[Table] = ()
    half: bool = False

    @property
    def widest(self) -> float:
        """Width of the widest drawing [px]: all shrink with it, so that they keep one scale."""
        return max(drawing.width for drawing in self.drawings)

    @property
    def printed(self) -> float:
        """How much the drawings shrink in print so that the first two stand side by side.

        1 where their text would become too small.
        """
        both = sum(drawing.width for drawing in self.drawings[:2]) + GUTTER
        share = SHEET / both
        return min(1.0, share) if share > LEGIBLE else 1.0


def series(k: int) -> str:
    """The colour of the k-th of a series, from 1; after eight they begin again."""
    return f"--series-{(k - 1) % COLOURS + 1}"


def meaning(gear: Mapping[str, Any], measures: Measures) -> str:
    """A gear in a line, as drawings tell it where the pointer rests."""
    unit = measures.unit("mm")
    return (
        f"{gear['name']}: z {gear['teeth']:.6g}, m_n {gear['normal_module_mm']:g} mm, "
        f"d {measures.length(gear['reference_diameter_mm'])} {unit}, "
        f"d_a {measures.length(gear['tip_diameter_mm'])} {unit}, "
        f"b {measures.length(gear['to_mm'] - gear['from_mm'])} {unit}"
    )
