"""What commands say: units that a file asks for, and materials that are not rated."""

from pathlib import Path

from typer.testing import CliRunner

from gearopt.cli import app

PAIR = Path(__file__).parents[2] / "problems" / "catalogue_pair.toml"


def shown(*words):
    """Exit code and output of a command."""
    answer = CliRunner().invoke(app, [str(word) for word in words])
    return answer.exit_code, answer.output, str(answer.exception or "")


def test_units_of_the_file(tmp_path):
    file, kept = tmp_path / "pair.toml", tmp_path / "pair.json"
    text = PAIR.read_text(encoding="utf-8")
    file.write_text(text.replace("gearopt = 1", 'gearopt = 1\nunits = "inch"'), encoding="utf-8")
    _, inch, _ = shown("rate", PAIR, "--units", "inch")
    assert " psi" in inch or "[psi]" in inch
    body = inch.splitlines()[3:-3]
    assert shown("rate", file)[1].splitlines()[3:-3] == body
    assert "psi" not in shown("rate", file, "--units", "metric")[1]
    kept.write_text(shown("rate", file, "--json")[1], encoding="utf-8")
    assert "psi" in shown("report", kept)[1]
    file.write_text(text.replace("gearopt = 1", 'gearopt = 1\nunits = "inches"'), encoding="utf-8")
    code, output, said = shown("rate", file)
    assert code != 0
    assert 'is not "metric" or "inch"' in output + said


def test_of_a_plastic_it_is_said_that_none_is_rated():
    code, output, said = shown("materials", "POM")
    assert code != 0
    assert "VDI 2736 is not supported" in output + said
