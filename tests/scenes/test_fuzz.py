"""Wrong problem files at random: each loads, or every mistake has a line that mends it."""

import faulthandler
import json
import os
import subprocess
import sys
import threading
from collections import Counter
from decimal import Decimal
from random import Random

import jsonschema
import pytest
from campaigns import few
from mutations import MUTATIONS
from scene_files import BASES, ELEVATOR, mended, parse
from scrambles import SCRAMBLES

from gearopt.cli import reporting
from gearopt.errors import SceneError
from gearopt.scenes.drive import KIND
from gearopt.scenes.reading import file_bytes
from gearopt.scenes.reading.json_schema import json_schema
from gearopt.scenes.reading.load import load, read

EXAMPLE = KIND.example.text

KINDS = MUTATIONS | SCRAMBLES
SLOW = ("deep_dotted_key", "deep_keys_of_ones_own")  # a second each inside tomllib
VALID = (  # mutations that leave a file right
    "byte_order_mark",
    "windows_line_ends",
    "deep_keys_of_ones_own",
)
BLOCKS, SIZE = 20, 200
HANG = 300  # s for a block of files that takes some seconds
NO_FIX = (
    "is not valid TOML",
    "is not UTF-8 text",
    "is nested too deeply",
    "has a whole number of",
    "has a NUL",
    "has a comma, which may separate thousands or decimals",
    "has another name here",
    "belongs in another table",
    "is not a key here",
)
VALIDATOR = jsonschema.Draft202012Validator(json_schema("drive"))


@pytest.fixture(autouse=True)
def _no_hang():
    faulthandler.dump_traceback_later(HANG, exit=True, file=sys.__stderr__)
    yield
    faulthandler.cancel_dump_traceback_later()


def refusal(data):
    """The SceneError of a file, its form checked; None if the file loads."""
    try:
        kind, scene = read(data, "my.toml")
    except SceneError as wrong:
        lines = str(wrong).splitlines()
        assert len(lines) == min(len(wrong.errors), SceneError.SHOWN + 1)
        for error, message in zip(wrong.errors, lines, strict=False):
            assert message.startswith("my.toml: ") and len(message) < 600
            assert message.isprintable(), message
            assert error.rule and error.remedy
            assert (error.fix is None) == error.rule.startswith(NO_FIX), message
        return wrong
    if kind == "drive":  # a file that lost its kind and tables may have become another
        scene.train()
    return None


def repaired(data, steps):
    """(whether the file loads in the end, remedies applied); at most `steps` may be needed.

    A mistake without a remedy for machines that stays is one that the file had from the start.
    """
    applied, told = [], set()
    while (wrong := refusal(data)) is not None:
        told = told or {(error.key, error.rule) for error in wrong.errors}
        if wrong.fix is None:
            break
        applied.append(str(wrong))
        assert len(applied) <= steps, "\n".join(applied)
        data = mended(data.decode("utf-8-sig"), wrong.fix).encode()
    assert wrong is None or (wrong.key, wrong.rule) in told, "a remedy broke the file"
    return wrong is None, len(applied)


def judge(kind, base, seed):
    """What became of a file: "loaded", "mended" or, without a remedy for machines, "refused"."""
    data = KINDS[kind].make(Random(f"{kind} {base} {seed}"), BASES[base])
    loads, applied = repaired(data, KINDS[kind].steps)
    if loads and not applied and kind not in SLOW:
        VALIDATOR.validate(plain(parse(data.decode("utf-8-sig"))))
    return "mended" if applied else "loaded" if loads else "refused"


def plain(value):
    """A file's content as JSON has it, without the user's own tables."""
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items() if not k.startswith("x-")}
    if isinstance(value, list):
        return [plain(v) for v in value]
    return float(value) if isinstance(value, Decimal) else value


@pytest.mark.parametrize("base", BASES)
def test_the_bases_load_and_survive_our_own_writer(base):
    assert refusal(BASES[base].encode()) is None
    assert judge("byte_order_mark", base, 0) == "loaded"


EVERY = [(kind, seed) for kind in KINDS for seed in range(1 if kind in SLOW else 3)]
SOME = list(BASES)[::3]  # for the default tests, of seed 0; case 2 is seed 0 of all bases


@pytest.mark.parametrize(
    ("kind", "seed"), few(EVERY, [(kind, 0) for kind in KINDS if kind not in SLOW])
)
def test_every_mutation_of_every_base(kind, seed):
    bases = BASES if seed else SOME[:2] if kind in SLOW else SOME
    found = {judge(kind, base, seed % 2) for base in bases}
    assert (found == {"loaded"}) == (kind in VALID)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(BLOCKS))
def test_thousands_of_files(block):
    fast = [kind for kind in KINDS if kind not in SLOW]
    found = Counter()
    for seed in range(block * SIZE, (block + 1) * SIZE):
        found[judge(fast[seed % len(fast)], list(BASES)[seed % len(BASES)], seed)] += 1
    assert sum(found.values()) == SIZE
    assert found["mended"] > 0.6 * SIZE and found["refused"] > 0.1 * SIZE, found


def refused_file(kind, path):
    """Write the first refused file of a kind, mutations of the elevator."""
    for seed in range(100):
        data = KINDS[kind].make(Random(seed), ELEVATOR)
        if refusal(data) is not None:
            path.write_bytes(data)
            return
    raise AssertionError(f"{kind} is always right")


def refusal_of(path):
    """The SceneError of a file on the disk."""
    with pytest.raises(SceneError) as wrong:
        load(path)
    return wrong.value


def gearopt(*words):
    return subprocess.run(
        [sys.executable, "-m", "gearopt", *map(str, words)],
        capture_output=True,
        text=True,
        timeout=60,
    )


def refused(command, path):
    done = command("solve", path)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.endswith("\n") and "Traceback" not in done.stderr
    lines = done.stderr[:-1].split("\n")
    assert len(lines) <= SceneError.SHOWN + 1
    assert all(line.startswith(f"gearopt: {path}: ") and line.isprintable() for line in lines)
    return lines


@pytest.mark.slow
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in VALID])
def test_the_command_refuses_in_a_line_for_each_mistake(kind, tmp_path, here):
    path = tmp_path / "my.toml"
    refused_file(kind, path)
    lines = refused(here, path)
    assert lines == [f"gearopt: {line}" for line in str(refusal_of(path)).splitlines()]


@pytest.mark.slow
@pytest.mark.parametrize("kind", VALID)
def test_the_command_takes_what_editors_add(kind, tmp_path):
    path = tmp_path / "my.toml"
    path.write_bytes(KINDS[kind].make(Random(0), ELEVATOR))
    done = gearopt("solve", path, "--json")
    assert done.returncode == 0 and done.stderr == ""
    assert json.loads(done.stdout)["objective"]["value"] == pytest.approx(5782370.7, rel=1e-8)


@pytest.mark.slow
def test_the_command_refuses_what_is_no_file(tmp_path, here):
    (tmp_path / "mine.toml").write_text(ELEVATOR)
    assert refused(here, tmp_path)
    assert refused(here, tmp_path / "nine.toml")
    assert refused(here, tmp_path / "none" / "mine.toml")
    assert refused(here, tmp_path / "mine.toml" / "mine.toml")
    assert refused(here, tmp_path / ("long" * 100))
    if os.geteuid() != 0:  # root reads everything
        (tmp_path / "mine.toml").chmod(0)
        assert refused(here, tmp_path / "mine.toml")


def test_paths_that_are_no_file_name_one(tmp_path):
    (tmp_path / "mine.toml").write_text(ELEVATOR)
    for path, words in (
        (tmp_path, "is a directory, not a file. Did you mean"),
        (tmp_path / "nine.toml", "there is no such file. Did you mean"),
    ):
        with pytest.raises(SceneError, match=words) as wrong:
            load(path)
        assert f"Did you mean {tmp_path / 'mine.toml'}?" in wrong.value.remedy
    with pytest.raises(SceneError, match="cannot be read .*null"):
        load("a\0b")


def test_an_unreadable_file_is_refused(tmp_path, monkeypatch):
    def denied(path, flags):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", denied)
    with pytest.raises(SceneError, match="cannot be read .Permission denied.. Check") as wrong:
        load(tmp_path / "mine.toml")
    assert wrong.value.fix is None


def sparse(path):
    """A file of 6 GB without a block on the disk."""
    with path.open("wb") as file:
        file.truncate(6_000_000_000)
    return path


@pytest.mark.parametrize("command", ["solve", "report"])
def test_no_file_is_read_beyond_a_limit(command, here, tmp_path, monkeypatch):
    """Endless or 6 GB: read whole, the process would end for lack of memory."""
    monkeypatch.setattr(reporting, "LARGEST_KEPT", 1_000_000)
    for path in ("/dev/zero", sparse(tmp_path / "large")):
        done = here(command, path)
        assert done.returncode == 2 and done.stderr.count("\n") == 1
        assert f"gearopt: {path}: is larger than a " in done.stderr


def test_a_pipe_is_a_file(tmp_path, monkeypatch):
    """Named, with a writer that comes late; one without is refused; unnamed, as `<(...)` is."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    writer = threading.Timer(0.05, lambda: pipe.write_text(ELEVATOR))
    writer.start()
    assert load(pipe).kind == "drive"
    writer.join()
    monkeypatch.setattr(file_bytes, "PIPE_SECONDS", 0.02)
    with pytest.raises(SceneError, match="nothing comes from this pipe in 0.02 s"):
        load(pipe)
    end, begin = os.pipe()
    os.write(begin, ELEVATOR.encode())
    os.close(begin)
    assert load(f"/dev/fd/{end}").kind == "drive"
    os.close(end)


@pytest.mark.parametrize(
    ("wrong", "write"),
    [
        ('power = "7.5 mW"', 'Write, for example, power = "7.5 kW"'),  # not 7.5 MW
        ('power = "10 horsepower"', 'Write, for example, power = "7.5 kW"'),
        ('power = "9.5 kw"', 'Write power = "9.5 kW"'),
        ('power = "9,5 kW"', 'Write power = "9.5 kW"'),
    ],
)
def test_a_remedy_never_changes_the_unit_of_a_number(wrong, write):
    text = EXAMPLE.replace('power = "7.5 kW"', wrong)
    with pytest.raises(SceneError) as caught:
        read(text.encode(), "a.toml")
    assert caught.value.remedy == write
