"""The page "From drive to dynamics": its files are those of problems/, its numbers theirs."""

import math
import re
from pathlib import Path

import pytest

import gearopt

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "from_drive_to_dynamics.md").read_text(encoding="utf-8")
NAMES = ("unit_15_kw", "unit_15_kw_pair", "unit_15_kw_dynamics")


def test_the_files_are_those_of_the_problems():
    shown = re.findall(r"(?s)```toml\n(gearopt = 1.*?)```", PAGE)
    texts = [(ROOT / "problems" / f"{name}.toml").read_text(encoding="utf-8") for name in NAMES]
    assert shown == [text.split("[x-expected]")[0].rstrip() + "\n" for text in texts]


@pytest.mark.slow
def test_what_is_refused_reads_as_shown(tmp_path, here):
    text = (ROOT / "problems" / "unit_15_kw.toml").read_text(encoding="utf-8")
    (tmp_path / "drive.toml").write_text(text)
    (tmp_path / "pair.toml").write_text(
        'gearopt = 1\nkind = "pair"\nduty.power = "18 kW"\n[gears]\nfrom = "drive.toml"\n'
        'stage = 2\ntreatment = "nitrided"\n[[stage]]\nwheel.bore = "40 mm"\n'
    )
    told = here("check", tmp_path / "pair.toml").stderr
    lines = [
        line.removeprefix("gearopt: ") for line in told.replace(f"{tmp_path}/", "").split("\n")
    ]
    assert len(lines) == 4 and all(line.strip() in PAGE for line in lines)


def numbers(folder):
    """The numbers of the page, of the chain of files in a folder."""
    drive, pair, motion = (gearopt.solve(folder / f"{name}.toml") for name in NAMES)
    modes = motion.design["equilibrium"]["frequencies_Hz"]
    return drive.value, drive.design["stages"][1], modes, pair


@pytest.mark.slow
def test_its_numbers(tmp_path):
    mass, stage, modes, pair = numbers(ROOT / "problems")
    assert f"{mass:.2f} kg" in PAGE and stage["normal_module_mm"] == 4
    assert (stage["pinion_teeth"], stage["wheel_teeth"]) == (17, 70)
    assert f"{stage['pinion_torque_Nm']:.1f} N m at {1480 * 17 / 132:.1f} rpm" in PAGE
    load = pair.design["flank"]["loads"][0]
    before = 1e3 * load["plain_peak_to_peak_mm"]
    assert f"{before:.2f} µm to {1e3 * pair.value:.2f} µm" in PAGE
    assert f"{load['face_load_factor']:.2f} times the mean" in PAGE
    helix, normal = math.radians(12), math.radians(20)
    across = [4 * z / math.cos(helix) for z in (17, 70)]
    base = [d * math.cos(math.atan(math.tan(normal) / math.cos(helix))) for d in across]
    assert f"{base[0]:.2f} and {base[1]:.2f} mm" in PAGE
    discs = [7.85e-6 * math.pi / 4 * d**2 * 51 for d in across]
    assert f"{discs[0]:.3f} and {discs[1]:.2f} kg" in PAGE
    inertias = [1e-6 * m * d**2 / 8 for m, d in zip(discs, across, strict=True)]
    assert f"{inertias[0]:.6f} and {inertias[1]:.4g} kg m²" in PAGE
    assert f"{modes[0]:.0f}, {modes[1]:.0f} and {modes[2]:.0f} Hz" in PAGE
    for name in NAMES:
        text = (ROOT / "problems" / f"{name}.toml").read_text(encoding="utf-8")
        (tmp_path / f"{name}.toml").write_text(text.replace('"15 kW"', '"20 kW"'))
    mass, stage, modes, pair = numbers(tmp_path)
    assert f"{mass:.2f} kg" in PAGE
    assert f"{stage['pinion_teeth']} and\n{stage['wheel_teeth']} teeth of 4 mm" in PAGE
    assert f"error is {1e3 * pair.value:.2f} µm" in PAGE
    assert f"{modes[0]:.0f}, {modes[1]:.0f} and {modes[2]:.0f} Hz" in PAGE
