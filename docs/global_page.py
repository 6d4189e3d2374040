"""Write the tables of the page on public problems from what the benches measured.

gearopt bench global --repeat 1 --json > rows.json
gearopt bench growth --json > growth.json
python docs/global_page.py rows.json growth.json
"""

import json
import re
import sys
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
NAMES = ("proven", "median", "sum")


def main() -> None:
    """Write both tables into their pages."""
    rows, growth = (json.loads(Path(file).read_text(encoding="utf-8")) for file in sys.argv[1:3])
    totals = [row for row in rows if row["problem"].split()[0] in NAMES]
    cases = [row for row in rows if row not in totals]
    write("global.md", "set", _totals(totals))
    write("global.md", "problem", "\n".join(map(_case, cases)))
    write("methods.md", "family", _sizes(growth))


def write(page: str, head: str, lines: str) -> None:
    """Put lines below the head of the table whose first column has a name."""
    path = DOCS / page
    text = path.read_text(encoding="utf-8")
    table = rf"(\| {head} \|[^\n]*\n\|[-|: ]*\n)(?:\|[^\n]*\n)*"
    new = re.sub(table, lambda found: f"{found[1]}{lines}\n", text, count=1)
    path.write_text(new, encoding="utf-8")


def _totals(rows: list[dict[str, Any]]) -> str:
    lines = []
    for name in dict.fromkeys(row["set"] for row in rows):
        proven, median, total = (row for row in rows if row["set"] == name)
        seconds = (f"{r[k]:.2g}" for r in (median, total) for k in ("cpu_s", "scip_cpu_s"))
        cells = (name, proven["status"], proven["scip"], median["problem"].split()[-1], *seconds)
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _case(row: dict[str, Any]) -> str:
    size = str(row["variables"]) + (f", {row['whole']} whole" if row["whole"] else "")
    proven = row["scip"] in ("optimal", "gaplimit")
    cells = (
        row["problem"],
        row["set"],
        size,
        f"{row['quoted']:.9g}",
        "-" if row["value"] is None else f"{row['value']:.9g}",
        "proven" if row["status"] == "optimal" else f"no, gap {row['gap']:.2g}",
        f"{row['cpu_s']:.2g}",
        f"{row['scip_cpu_s']:.2g}" if proven else "no",
    )
    return "| " + " | ".join(cells) + " |"


def _sizes(rows: list[dict[str, Any]]) -> str:
    lines = []
    for family in dict.fromkeys(row["family"] for row in rows):
        some = [row for row in rows if row["family"] == family]
        done = [f"{r['variables']}: {r['cpu_s']:.2g}" for r in some if r["status"] == "optimal"]
        left = [f"{r['variables']}: gap {r['gap']:.2g}" if r["gap"] else f"{r['variables']}"
                for r in some if r["status"] != "optimal"]  # fmt: skip
        lines.append(f"| {family} | {', '.join(done)} | {', '.join(left)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
