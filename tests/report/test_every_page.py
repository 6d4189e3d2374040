"""Every file of problems/ makes a page, in both systems of units, and CSV files."""

from pathlib import Path

import pytest
from html_reader import Reader

import gearopt
from gearopt.report.measures import INCH
from gearopt.report.pages.result import page, tables

PROBLEMS = sorted((Path(__file__).parents[2] / "problems").glob("*.toml"))


@pytest.mark.slow
@pytest.mark.parametrize("path", PROBLEMS, ids=lambda p: p.stem)
def test_a_problem_file_makes_a_page(path):
    result = gearopt.solve(path, top=3, budget=gearopt.Budget(1.0))
    again = gearopt.Result.from_json(result.to_json())
    html = page(again, "gearopt solve x.toml")
    words = "".join(Reader(html).text)
    assert result.asked["title"] in words and "What is proven, and how" in words
    assert "None" not in words and "nan" not in words.split()
    assert "What is proven, and how" in page(again, "gearopt solve x.toml", INCH)
    assert all(text.strip() for text in tables(again).values())
