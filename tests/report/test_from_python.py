"""What is shown of an answer from Python."""

from pathlib import Path

import gearopt
from gearopt.cli.reporting import again, checked
from gearopt.report.pages.result import page

ELEVATOR = Path(__file__).parents[2] / "problems" / "elevator.toml"


def test_changes_of_a_file_are_told():
    """In the footer, and by the line that makes the page again: no command of the shell does."""
    changes = {"duty.power": "9 kW", "teeth.coprime": True, "source": None}
    result = gearopt.solve(ELEVATOR, changes)
    html = page(result, again(result, checked(Path("page.html"), None, "metric")))
    assert "…, changed: duty.power = &#34;9 kW&#34;, teeth.coprime = true, no source" in html
    assert f"gearopt.solve({str(ELEVATOR)!r}, {changes!r})".replace("'", "&#39;") in html
