"""`gearopt bench budget`: rows of what takes longer than is promised."""

import pytest

from gearopt.bench import budget, names
from gearopt.errors import GearoptError, SolveError


def test_what_takes_too_long_is_listed_the_worst_first(monkeypatch, tmp_path):
    """Clocks are those of the test: two seconds more with every look, one of the processor."""
    now = iter(range(1000))
    monkeypatch.setattr(budget.time, "perf_counter", lambda: 2.0 * next(now))
    monkeypatch.setattr(budget.time, "process_time", lambda: float(next(now)))
    monkeypatch.setattr(budget, "FOLDER", tmp_path)
    with pytest.raises(GearoptError, match="no problem file"):
        budget.run(1)

    def refused(file, seconds):
        raise SolveError("not for this file")

    calls = {"kept": lambda f, s: 1.1, "late": lambda f, s: None, "not for it": refused}
    monkeypatch.setattr(budget, "COMMANDS", calls)
    (tmp_path / "a.toml").write_text("")
    first, second = budget.run(1)
    assert {first["command"], second["command"]} == {"late"}
    assert (first["file"], first["asked_s"], first["promised_s"]) == ("a.toml", 0.1, 1.15)
    assert first["over_s"] == pytest.approx(first["used_s"] - 1.15)
    monkeypatch.setattr(budget, "COMMANDS", {"kept": calls["kept"]})
    (worst,) = budget.run(1)  # none over it: the nearest
    assert worst["over_s"] == pytest.approx(-0.05) and "budget" in names()
    monkeypatch.setattr(budget, "COMMANDS", {"torn": lambda f, s: {}["key"]})
    assert [row["fault"] for row in budget.run(1)] == 2 * ["KeyError('key')"]


@pytest.mark.slow
def test_every_command_is_timed(monkeypatch):
    """Small files, one for each command."""
    monkeypatch.chdir(budget.FOLDER.resolve().parent)
    timed = {
        "solve": "undercut_pair",
        "solve --html --csv": "undercut_pair",
        "explain": "thousand_in_two_stages",
        "pareto --html": "thousand_in_two_stages",
        "compare": "thousand_in_two_stages",
        "rate --html": "shigley_14_4",
    }
    assert timed.keys() == budget.COMMANDS.keys()
    for command, stem in timed.items():
        row = budget.measured(budget.FOLDER / f"{stem}.toml", command, 0.1, 1)
        assert row is not None and row["used_s"] > 0.0, command
