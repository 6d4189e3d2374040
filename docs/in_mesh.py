"""Write the table of errors in mesh on the page on stiffness: `gearopt bench levels`, as kept."""

import re
from pathlib import Path

from gearopt.physics.tooth.measured import IN_MESH, Errors, Spread

PAGE = Path(__file__).with_name("tooth_stiffness.md")
HEAD = r"(\| level \| coupling \|[^\n]*\n\|[-|: ]*\n)(?:\|[^\n]*\n)*"


def page() -> str:
    """The page with its table as it is now."""
    lines = "".join(f"{_row(names, errors)}\n" for names, errors in IN_MESH.items())
    text = PAGE.read_text(encoding="utf-8")
    return re.sub(HEAD, lambda head: f"{head[1]}{lines}", text, count=1)


def _row(names: tuple[str, str], errors: Errors) -> str:
    spreads = errors.peak_to_peak, errors.amount, errors.proven, errors.judged, errors.penalty
    return "| " + " | ".join((*(f"`{name}`" for name in names), *map(_span, spreads))) + " |"


def _span(spread: Spread) -> str:
    least, median, largest = (f"{100.0 * value:+.0f}" for value in spread)
    return f"{least} to {largest} ({median})"
