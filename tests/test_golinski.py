"""The Golinski speed reducer of docs/own_problem.md: all eight optima of its variants."""

import re
from functools import cache
from pathlib import Path

import pytest
from campaigns import few

from gearopt import solve

PAGE = Path(__file__).parents[1] / "docs" / "own_problem.md"
OPTIMA = {  # (A, B, least x5): optimum
    (7.477, 16.9e6, 7.3): 2994.341315684,
    (7.477, 16.91e6, 7.3): 2994.424465757,
    (7.4777, 16.9e6, 7.3): 2994.471066147,
    (7.4777, 16.91e6, 7.3): 2994.554223911,
    (7.477, 16.9e6, 7.8): 2996.218412818,
    (7.477, 16.91e6, 7.8): 2996.301562890,
    (7.4777, 16.9e6, 7.8): 2996.348164969,
    (7.4777, 16.91e6, 7.8): 2996.431322733,
}


def page_code():
    """The Python block of the page, as a newcomer would paste it."""
    code = re.search(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)[1]
    assert code.strip().count("\n") <= 45
    return code


def test_the_page_runs_as_printed(capsys):
    scope = {}
    exec(compile(page_code(), str(PAGE), "exec"), scope)
    assert "2994.4710661" in capsys.readouterr().out
    price = scope["result"].multipliers["stress_2"]
    words = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert f'`result.multipliers["stress_2"]` is {price:.1f} cm³' in words
    assert f"about {-0.01 * price:.1f} cm³" in words


@cache
def reducer():
    scope = {}
    exec(compile(page_code(), str(PAGE), "exec"), scope)
    return scope["reducer"]


@pytest.mark.parametrize(("a", "b", "least"), few(OPTIMA, 1))
def test_optimum(a, b, least, capsys):
    result = solve(reducer().at(A=a, B=b, x5_least=least))
    assert result.status == "optimal" and result.method == "spatial"  # a signomial
    assert result.bound <= OPTIMA[a, b, least] and "stress_2" in result.multipliers
    assert result.value == pytest.approx(OPTIMA[a, b, least], abs=1.5e-9)
    assert result.certificate["stationarity"] < 1e-9
    assert max(result.limits.values()) <= 1 + 1e-9
