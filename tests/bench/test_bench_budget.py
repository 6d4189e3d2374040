"""`gearopt bench budget`: rows of what takes longer than was asked for."""

import pytest

from gearopt.bench import budget, names
from gearopt.errors import GearoptError, SolveError


def test_what_takes_too_long_is_listed_the_worst_first(monkeypatch, tmp_path):
    """Clocks are those of the test: a second more with every look, half of it of the processor."""
    now = iter(range(1000))
    monkeypatch.setattr(budget.time, "perf_counter", lambda: 2.0 * next(now))
    monkeypatch.setattr(budget.time, "process_time", lambda: float(next(now)))
    monkeypatch.setattr(budget, "FOLDER", tmp_path)
    with pytest.raises(GearoptError, match="no problem file"):
        budget.run(1)

    def refused(file, seconds):
        raise SolveError("not for this file")

    calls = {"kept": lambda f, s: 0.3, "late": lambda f, s: None, "not for it": refused}
    monkeypatch.setattr(budget, "COMMANDS", calls)
    (tmp_path / "a.toml").write_text("")
    (row,) = budget.run(1)
    assert (row["file"], row["command"]) == ("a.toml", "late") and row["over_s"] > 1.0
    monkeypatch.setattr(budget, "COMMANDS", {"kept": calls["kept"]})
    assert budget.run(1)[0] | {"over_s": 0.0} == budget.run(1)[0] and "budget" in names()
