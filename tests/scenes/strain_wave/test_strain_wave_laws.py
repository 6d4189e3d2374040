"""Teeth by other laws than the involute: given gears alone, each refusal at its key."""

import math

import numpy as np
import pytest
from campaigns import few

from gearopt.errors import SceneError
from gearopt.formulations.strain_wave.design import WaveDesign
from gearopt.optimise.typed import typed
from gearopt.report.kinds.strain_wave import cutter, moving, numbers, shift
from gearopt.report.kinds.strain_wave.motion import drawn, running
from gearopt.report.measures import METRIC
from gearopt.scenes.reading.load import read
from gearopt.scenes.strain_wave import KIND

EXAMPLE = KIND.example.text

LAWS = few(("strain_wave_double_arc", "strain_wave_half_locus"), 0)
ARC = EXAMPLE.replace('"involute" ', '"double arc"')


def scene(text):
    return read(text.encode())[1]


@pytest.mark.parametrize("name", LAWS)
def test_loads_of_a_law_hold_the_torque_and_close_its_clearances(name, solved):
    """Sum of load times arm is M; arms lie between those of flanks of 0 and 85 degrees."""
    found = typed(WaveDesign, solved(name).design)
    moment = 0.5 * 1e5 * (1.0 + 1.0 / 80.0)
    total = sum(t.force_N for t in found.teeth)
    assert (
        moment / 0.5 / found.root_diameter_mm < total < moment / (0.6 * found.tip_diameter_mm / 2)
    )
    assert found.carrying_teeth >= round(found.pairs_in_contact)
    assert found.effective_teeth <= found.carrying_teeth
    loose = [t.clearance_mm for t in found.teeth if t.force_N == 0.0]
    assert min(loose) > max(t.clearance_mm for t in found.teeth if t.force_N > 50.0)
    assert found.least_clearance_mm == 0.0 and solved(name).feasible


@pytest.mark.parametrize("name", LAWS)
def test_no_drawn_tooth_of_a_law_cuts_the_drawn_spline(name, solved):
    """Corners of every tooth at some moments against the drawn space, by its chords; 1 um."""
    found = typed(WaveDesign, solved(name).design)
    animation, made = running(found, "runs", METRIC), drawn(found)
    radius, half = np.hypot(*made.space.T), np.arctan2(*made.space.T)
    bodies = [b for b in animation.views[1].bodies if b.title == "tooth of the flexspline"]
    looked = 0
    for body in bodies:
        for x, y, turn in np.asarray(body.places)[::12]:
            u, v = np.asarray(body.outline).T
            px, py = (
                x + u * np.cos(turn) - v * np.sin(turn),
                y + u * np.sin(turn) + v * np.cos(turn),
            )
            at = np.hypot(px, py)
            inside = (at > radius[0]) & (at < radius[-1])
            pitch = 2 * math.pi / 162
            aside = np.mod(np.arctan2(px, py)[inside] + pitch / 2, pitch) - pitch / 2
            room = at[inside] * (np.interp(at[inside], radius, half) - np.abs(aside))
            looked += room.size
            assert room.size == 0 or room.min() > -1e-3
    assert looked > 100


@pytest.mark.parametrize("name", LAWS)
def test_sections_of_a_law(name, solved):
    result = solved(name)
    mesh = moving(result, METRIC)
    assert mesh.figures[0].layout["shapes"][0]["x1"] > 20.0
    assert shift(result, METRIC) is None
    assert any("touches at two points" in words for words in result.report["assumptions"])
    rows = {row[0] for row in numbers(result, METRIC).tables[0].rows}
    assert "thickness at half the height [mm]" in rows and "base diameter [mm]" not in rows
    names = [t.name for t in cutter(result, METRIC).tables]
    assert names == ["points of the cutting edge"]


@pytest.mark.parametrize("name", LAWS)
def test_few_involutes_and_many_arcs_touch_but_arcs_press_harder(name, solved):
    """Convex on convex: R of 0.2 to 0.5 mm against 300 mm of a conjugate involute."""
    base, own = solved("strain_wave_base").design, solved(name).design
    assert own["pairs_in_contact"] > 10 * base["pairs_in_contact"]
    assert own["shared_pressure_MPa"] > 10 * base["shared_pressure_MPa"]
    assert own["windup_mrad"] < 0.5 * base["windup_mrad"]


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("deflection = 1\n", "", "gears.deflection: is missing"),
        ("# [design]", "[design]\nrim = ['1 mm', '2 mm']\n#", "design.rim"),
        ('"double arc"', '"half locus"', "gears.pressure_angle"),
        ('"double arc"', '"involute"\nthickness = "1 mm"', "teeth.thickness"),
        ('"double arc"', '"double arcs"', "teeth.law"),
        ('"double arc"', '"double arc"\nconvex_radius = "0.2 mm"', "teeth.convex_radius"),
        ('"double arc"', '"double arc"\nconcave_radius = "0.2 mm"', "teeth.concave_radius"),
        ('"double arc"', '"double arc"\nthickness = "0.1 mm"', "teeth.thickness"),
        ('"double arc"', '"double arc"\nthickness = "2 mm"', "teeth.thickness"),
        ('"double arc"', '"double arc"\ntangent = "2 mm"', "teeth.tangent"),
        ("deflection = 1\n", "deflection = 0.3\n", "gears.deflection"),
        ('tool_angle = "20 deg"', 'tool_angle = "25 deg"', "cutter.tool_angle"),
    ],
)
def test_what_a_law_cannot_do_is_refused_at_its_key(old, new, place):
    text = ARC.replace('tool_angle = "20 deg"\n', "") if "tool" not in old else ARC
    assert old in text
    with pytest.raises(SceneError) as wrong:
        scene(text.replace(old, new))
    assert place.split(":")[0] in str(wrong.value)


def test_a_locus_that_is_too_low_is_refused():
    text = EXAMPLE.replace('pressure_angle = "20 deg"\n', "").replace('tool_angle = "20 deg"\n', "")
    text = text.replace("addendum = 0.6", "addendum = 1.1").replace('"involute" ', '"half locus"')
    with pytest.raises(SceneError, match=r"gears.addendum"):
        scene(text)
