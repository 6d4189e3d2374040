"""Files of a pair on moving axes: what they ask, what they refuse, what answers hold."""

import json
import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from campaigns import few

import gearopt
from gearopt.cli.app import exit_code
from gearopt.errors import SceneError, SolveError
from gearopt.formulations.dynamics.parts import jammed, nearest_load, of_contact, own_depth, scaled
from gearopt.optimise.kernels import COMPILING
from gearopt.physics.motion.moving_pair import MovingPair, Rotor
from gearopt.physics.motion.stiffness_wave import fourier, trapezoid
from gearopt.scenes.dynamics import KIND
from gearopt.scenes.dynamics.steps import at_ends
from gearopt.scenes.dynamics.stiffness_of_teeth import of_teeth
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.load import load, read

EXAMPLE = KIND.example.text

PROBLEMS = Path(__file__).parents[3] / "problems"


def changed(*pairs, text=EXAMPLE):
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text


BARE = EXAMPLE[: EXAMPLE.index("[simulate]")]


@pytest.mark.parametrize(
    ("pairs", "key", "rule"),
    [
        ((('torque = "200 N m" ', 'torque = "-200 N m" '),), "pinion.torque", "drives the pair"),
        ((("depth = 0.5 ", "# "),), "mesh.depth", 'wave = "trapezoid" needs it'),
        (
            (('"trapezoid"', '"constant"'), ("ramp = 0.1", ""), ("depth = 0.5", "")),
            "mesh.duty",
            "changes nothing",
        ),
        ((("ramp = 0.1", "ramp = 0.4"),), "mesh.ramp", "does not fit the duty"),
        ((('axes = "line"', 'axes = "line"\nkinematics = "paper"'),), "mesh.axes", "in the plane"),
        ((("duty = 0.68", "duty = 0.8"), ("depth = 0.5", "depth = 1.25")), "mesh.depth", "to zero"),
        (
            (('"200 N m"', '"200 N m"\nbearing_stiffness_across = "1 MN/m"'),),
            "mesh.axes",
            "alike in both directions",
        ),
        ((("[wheel]", '[wheel]\ntorque = "-5000 N m"'),), "wheel.torque", "pulls the teeth apart"),
    ],
)
def test_what_does_not_fit_is_refused_with_its_key(pairs, key, rule):
    with pytest.raises(SceneError, match=rule) as wrong:
        read(changed(*pairs, text=BARE).encode())
    assert wrong.value.key == key


@pytest.mark.parametrize(
    ("old", "new", "key", "rule"),
    [
        ("[wheel]", '[wheel]\ntorque = "0 N m"', "wheel.torque", "torques balance"),
        ("0.02\n\n[mesh]", "0.03\n\n[mesh]", "wheel.bearing_damping", "the pinion's"),
        ('axes = "line"', 'axes = "plane"', "mesh.axes", "along the line of action"),
        ("[mesh]", '[mesh]\nkinematics = "tangent"', "mesh.kinematics", "changes nothing"),
        ("[optimise]", "[optimise]\nelements = 30", "optimise.elements", "with backlash"),
        ("[optimise]", "[optimise]\nperiods = 2", "optimise.periods", "with backlash"),
    ],
)
def test_what_an_optimisation_would_leave_out_is_refused(old, new, key, rule):
    text = (PROBLEMS / "least_vibration.toml").read_text()
    read(changed(("[wheel]", '[wheel]\ntorque = "266.6666666667 N m"'), text=text).encode())
    with pytest.raises(SceneError, match=rule) as wrong:
        read(changed((old, new), text=text).encode())
    assert wrong.value.key == key and "optimise" in str(wrong.value)


@pytest.mark.parametrize("line", ['margin = "1 um"', "multiplier = 0.95"])
def test_what_teeth_that_part_cannot_be_limited_by_is_refused(line):
    text = (PROBLEMS / "least_vibration_parting.toml").read_text()
    read(text.encode())
    with pytest.raises(SceneError, match="without backlash") as wrong:
        read(changed(("[optimise]", f"[optimise]\n{line}"), text=text).encode())
    assert wrong.value.key == f"optimise.{line.split()[0]}"


@pytest.mark.slow
def test_a_mass_that_no_pair_of_the_ranges_has(tmp_path):
    """The lightest weighs 1.3406 kg: 8 mm wide, rims of 0.6."""
    path = tmp_path / "light.toml"
    text = (PROBLEMS / "least_vibration.toml").read_text()
    path.write_text(changed(('mass = "2 kg"', 'mass = "0.5 kg"'), text=text))
    result = gearopt.solve(path)
    assert result.status == "infeasible" and result.proof["conflict"] == ["mass"]
    edits = {r["what"]: r["changes"][0] for r in result.report["ways_out"]["remedies"]}
    found = {what: edit["short"] or edit["write"] for what, edit in edits.items()}
    assert found["optimise.mass"] == '"1.35 kg"'
    assert float(found["optimise.rim[1]"]) == pytest.approx(0.6 * 0.5 / 1.3406, abs=1e-3)
    assert found["optimise.face_width[1]"] == '"2.98 mm"'
    told = gearopt.explain(path)
    assert {r.what for r in told.remedies} == set(found)


def test_ends_of_ranges_and_numbers_without_use_are_told():
    scene = gearopt.load(PROBLEMS / "least_vibration.toml")
    (told,) = at_ends(scene.task, (501187.2336, 1.6, 0.25, 12.0, 0.6 + 1e-9))
    assert told == (
        "At ends of their ranges: bearing stiffness (upper end of 31,623 to 501,187 N/mm), "
        "ramp (upper end of 0.02 to 0.25), rim (lower end of 0.6 to 1.4)."
    )
    assert not at_ends(scene.task, (2e5, 1.6, 0.1, 12.0, 1.0))
    assert KIND.assumptions(scene)[-1].startswith("Not used: masses, inertias and bearing")


def test_a_fourier_series_stays_above_zero():
    """200 + 199 cos is above zero, 200 + 199 cos + 20 sin is not."""
    made = changed(
        ("depth = 0.5 ", "#"), ("duty = 0.68 ", "#"), ('"trapezoid"', '"fourier"'), text=BARE
    )
    made = made.replace("ramp = 0.1", 'cosines = ["199 kN/mm"]')
    read(made.encode())
    with pytest.raises(SceneError, match="zero or below"):
        read(made.replace("cosines", 'sines = ["20 kN/mm"]\ncosines').encode())


def test_too_few_outputs_are_told(tmp_path):
    """Half a second at 2001 outputs is 4 kHz: less than the fastest mode has."""
    path = tmp_path / "long.toml"
    path.write_text(BARE + '[simulate]\nduration = "0.5 s"\nerror = 1e-3\n')
    told = gearopt.solve(path).design["warnings"]
    (said,) = [each for each in told if "The motion is given at 2,001 times" in each]
    assert "Take at most" in said


def test_tables_that_cannot_be_answered_are_refused():
    flat = changed(
        ('"trapezoid" ', '"constant" '),
        ("depth = 0.5 ", "# "),
        ("duty = 0.68 ", "# "),
        text=EXAMPLE,
    ).replace("ramp = 0.1\n", "")
    with pytest.raises(SceneError, match="has no map"):
        read(flat.encode())
    uneven = changed(
        ('axes = "line"', 'axes = "plane"'),
        ("bearing_damping = 0.02", 'bearing_damping = 0.02\nbearing_stiffness_across = "1 MN/m"'),
    )
    with pytest.raises(SceneError, match="does not turn"):
        read(uneven.encode())
    with pytest.raises(SceneError, match="has a mesh frequency"):
        read(changed(('speed = "3000 rpm"', "#")).encode())


def test_methods_and_comparisons_need_something_to_choose(tmp_path):
    path = tmp_path / "motion.toml"
    path.write_text(BARE)
    with pytest.raises(SolveError, match="nothing is chosen"):
        gearopt.solve(path, method="screened")
    with pytest.raises(SolveError, match="no table"):
        gearopt.compare(path)


def test_the_wheel_balances_the_pinion_where_nothing_else_is_said(tmp_path):
    path = tmp_path / "motion.toml"
    path.write_text(BARE)
    found = gearopt.solve(path).design["equilibrium"]
    assert found["normal_load_N"] == pytest.approx(2e5 / 60.0)
    assert found["frequencies_Hz"] == pytest.approx([1327.235, 1874.728, 5749.524], abs=1e-3)
    path.write_text(
        BARE.replace('inertia = "0.004 kg m^2"', 'inertia = "0.004 kg m^2"\ntorque = "0 N m"')
    )
    assert gearopt.solve(path).design["equilibrium"]["normal_load_N"] == pytest.approx(30000 / 17)


def test_a_kept_result_reads_and_shows_itself(solved, tmp_path):
    result = solved("soft_bearings")
    kept = tmp_path / "kept.json"
    kept.write_text(result.to_json())
    assert json.loads(kept.read_text())["design"]["kinematics"] == "exact"
    page = result.to_html()
    assert "motion of the axes" in page and "Spectrum of the second half" in page
    moved = result.design["response"]
    assert moved["method"] == "rk8" and moved["error"] <= 1e-6 and moved["met"]
    assert len(moved["time_ms"]) == len(moved["deformation_mm"]) == 2001
    assert max(moved["deformation_mm"]) < 1e-9  # no load, then pressed


def test_depth_of_a_wave_is_scaled():
    for wave in (trapezoid(2e5, 0.5, 0.6, 0.1), trapezoid(2e5, 0.5, 0.6), fourier(2e5, (3e4, 1e4))):
        other = scaled(wave, 0.25)
        assert own_depth(other) == pytest.approx(0.25, rel=1e-4) and other.mean == wave.mean
        phases = np.linspace(0.0, 1.0, 50)
        shape = (wave.value(phases) - wave.mean) / own_depth(wave)
        assert (other.value(phases) - wave.mean) / 0.25 == pytest.approx(shape, rel=1e-3, abs=1.0)


def test_teeth_of_a_pair_keep_their_relief_and_no_others_are_taken(solved, tmp_path):
    """The normal force over the stiffness is the transmission error with relief, 1.2 of 5.0 um."""
    kept, file = tmp_path / "pair.json", tmp_path / "teeth.toml"
    relieved = solved("relief_two_loads")
    kept.write_text(relieved.to_json(), encoding="utf-8")
    text = (
        (PROBLEMS / "teeth_as_springs.toml").read_text(encoding="utf-8").partition("[simulate")[0]
    )
    file.write_text(text.replace("reference_pair.toml", "pair.json"), encoding="utf-8")
    scene = load(file).scene
    wave, _, _, assumed = of_teeth(scene, Ask())
    still = 5675.6148 / wave.value(np.arange(960) / 960)
    assert np.ptp(still) == pytest.approx(relieved.value, rel=5e-3)
    assert "with its relief" in assumed[0] and len(assumed) == 2
    assert assumed[1].startswith(
        'The teeth of pair.json are by level "profile + Sainsot" and coupling "given". For 34 spur '
        "pairs of steel a pair of teeth was -9.8 to +0.8 % off"
    )
    heavier = file.read_text(encoding="utf-8").replace('"200 N m"', '"300 N m"')
    file.write_text(heavier, encoding="utf-8")
    assert "add 1.5 to [sharing] loads" in of_teeth(load(file).scene, Ask()).assumed[1]
    for old, new in (("teeth = 25", "teeth = 28"), ('"140.954 mm"', '"141.2 mm"')):
        file.write_text(heavier.replace(old, new), encoding="utf-8")
        with pytest.raises(
            SceneError, match=r"(28, of the pair's file 25|141.2 mm, .* 140.954 mm)"
        ):
            gearopt.solve(file)


def test_helical_gears_move_by_their_own_stiffness_in_the_transverse_plane(solved, tmp_path):
    """Force over approach along the transverse line of action, less gaps of unloaded flanks."""
    kept, file = tmp_path / "pair.json", tmp_path / "teeth.toml"
    kept.write_text(solved("helical_pair").to_json(), encoding="utf-8")
    flank = solved("helical_pair").design["flank"]
    bearing = 'bearing_stiffness = "200 kN/mm"\nbearing_damping = 0.02\n'
    file.write_text(
        'gearopt = 1\nkind = "dynamics"\ngears.from = "pair.json"\n'
        f"[pinion]\n{bearing}[wheel]\n{bearing}"
        '[mesh]\ndamping = 0.05\naxes = "line"\ntransmission_error = "pair"\n',
        encoding="utf-8",
    )
    result = gearopt.solve(file)
    load = flank["loads"][-1]
    force = load["normal_force_N"]
    assert result.design["equilibrium"]["normal_load_N"] == pytest.approx(force, rel=1e-9)
    gaps, approach = flank["unloaded_error_mm"], load["transmission_error_mm"]
    assert min(gaps) >= 0.0 and max(gaps) > 0.0
    springs = force / (np.array(approach) - np.array(gaps))
    travel = np.array(flank["travel_mm"]) / flank["base_pitch_mm"]
    mean = np.trapezoid(springs, travel)
    assert result.design["equilibrium"]["mean_stiffness_N_per_mm"] == pytest.approx(mean, rel=1e-6)
    assert any("gears are helical" in said for said in result.report["assumptions"])


def test_the_stiffness_of_a_pair_is_load_over_transmission_error(solved):
    from gearopt.formulations.pair.design import PairContact
    from gearopt.optimise.typed import typed

    contact = typed(PairContact, solved("reference_pair").design["contact"], "contact")
    load = nearest_load(contact.loads, 5675.6)
    wave = of_contact(contact, load)
    phase = np.array(contact.travel_mm) / contact.base_pitch_mm
    known = load.normal_force_N / np.array(load.transmission_error_mm)
    inside = (phase > 0.0) & (phase < 1.0)
    left, right = wave.straight(phase[inside], True), wave.straight(phase[inside])
    near = np.minimum(np.abs(left - known[inside]), np.abs(right - known[inside]))
    assert np.max(near / known[inside]) < 1e-12
    jumps = np.abs(left - right) > 1e-3 * wave.mean
    assert len(np.unique(phase[inside][jumps])) >= 1 and wave.mean == pytest.approx(
        np.trapezoid(known, phase), rel=1e-12
    )


@pytest.mark.slow
def test_jumps_between_two_motions(tmp_path):
    """The example's pair: from 4150 to 5250 rpm two motions, one of them with separation.

    A Runge-Kutta program of its own, falling from 6000 rpm: 0.041248 mm at 4150, 0.024893 at 5000.
    """
    path = tmp_path / "motion.toml"
    text = changed(
        ('range = ["500 rpm", "12000 rpm"]', 'range = ["4000 rpm", "6000 rpm"]'),
        ("points = 116", "points = 41"),
    )
    text = text.replace(text[text.index("[stability]") : text.index("[speeds]")], "")
    path.write_text(text)
    found = gearopt.solve(path).design["speeds"]
    speed = np.array(found["speed_rpm"])
    rising, falling = np.array(found["rms_mm"]), np.array(found["falling_rms_mm"])
    two = speed[falling > 1.2 * rising]
    assert (two.min(), two.max()) == (4150.0, 5250.0)
    assert falling[speed == 4150.0] == pytest.approx(0.041248, rel=1e-3)
    assert falling[speed == 5000.0] == pytest.approx(0.024893, rel=1e-3)
    assert falling[speed < 4150.0] == pytest.approx(rising[speed < 4150.0])


@pytest.mark.slow
def test_least_vibration_says_what_lies_between_its_speeds(solved):
    result = solved("least_vibration")
    assert result.status == "stationary" and result.value == pytest.approx(3.2956e-3, rel=1e-4)
    chosen = result.design["chosen"]
    assert chosen["dense_maximum_mm"] == pytest.approx(4.195e-3, rel=1e-3)
    assert "27 % above the objective" in result.design["warnings"][0]
    assert result.limits["ramp_of_one_pair"] == pytest.approx(1.0, abs=1e-6)
    assert max(chosen["before_mm"]) > 5.0 * max(chosen["dense_mm"])
    content = tomllib.loads((PROBLEMS / "least_vibration.toml").read_text())
    assert chosen["mass_kg"] < float(content["optimise"]["mass"].split()[0])


@pytest.mark.parametrize(
    ("looks", "missing"),
    few(
        [
            (0, "the motion in time, 8 of 8 rows of the map, 12 of 12 speeds"),
            (52, "2 of 8 rows of the map, 12 of 12 speeds"),
            (80, "4 of 12 speeds"),
        ],
        2,
    ),
)
def test_a_watcher_ends_a_motion_with_what_there_is(tmp_path, looks, missing):
    """It is asked before the motion, between its runs, before rows, frequencies and speeds."""
    path, seen = tmp_path / "motion.toml", []
    text = changed(
        ('duration = "20 ms"\nerror = 1e-6', 'duration = "2 ms"\nerror = 1e-3'),
        ("frequencies = 136", "frequencies = 5\ndepths = 8"),
        ("points = 116", "points = 12"),
        ('backlash = "0.1 mm"', ""),
    )
    path.write_text(text)

    def watch(event):
        if not event.part.startswith(COMPILING):
            seen.append(event)
        return len(seen) <= looks

    result = gearopt.solve(path, watch=watch)
    assert (result.status, result.message) == ("limit", f"Stopped early: {missing} missing.")
    assert len(seen) == looks + 1 and exit_code(result) == 0
    assert result.design["equilibrium"]["normal_load_N"] == pytest.approx(2e5 / 60.0)
    assert ("response" in result.design) == (looks > 0)
    assert missing in result.to_html() and "no design" not in repr(result)


def test_a_backlash_that_is_used_up_is_told(tmp_path):
    """By 2 u sin(20 deg), 0.2 mm together leave -0.0368 mm of 0.1 mm; 0.1 mm leave 0.0316 mm."""
    path = tmp_path / "motion.toml"
    path.write_text(
        changed(
            ('axes = "line"', 'axes = "plane"'),
            ('"100 kN/mm"', '"10 kN/mm"\nbearing_stiffness_across = "30 kN/mm"'),
            ("bearing_damping = 0.02", ""),
            ('backlash = "0.1 mm" ', 'backlash = "0.02 mm" '),
            ("3000 rpm", "8000 rpm"),
            ('duration = "20 ms"\nerror = 1e-6', 'duration = "4 ms"\nerror = 1e-3'),
            text=EXAMPLE[: EXAMPLE.index("[stability]")],
        )
    )
    rotor = Rotor(60.0, 6e-4, 2.0, (1e4, 1e4), torque=2e5)
    wave, angle = trapezoid(2e5, 0.5, 0.68, 0.1), math.radians(20.0)
    pair = MovingPair(rotor, rotor, angle, wave, backlash=0.1, kinematics="tangent")
    apart = [
        [0.1, 0.0, -0.05, 0.0, 0.0],
        [0.1, 0.0, -0.05, -0.1, 0.0],
        [0.1, 0.0, -0.03, -0.1, 0.0],
    ]
    states = np.hstack([apart, np.zeros((3, 5))])
    assert jammed(pair, "plane", states).tolist() == [False, False, True]
    assert not jammed(pair, "line", states).any()
    told = gearopt.solve(path).design["warnings"]
    assert any("backlash is used up, first at" in each for each in told)


@pytest.mark.slow
def test_a_backlash_that_is_used_up_is_told_of_speeds(tmp_path):
    """Hardly damped, on bearings stiffer across: teeth part, and the axes come together.

    At 3000 and 3500 rpm nothing holds the motion.
    """
    path = tmp_path / "motion.toml"
    text = changed(
        ('axes = "line"', 'axes = "plane"\nkinematics = "tangent"'),
        ('"100 kN/mm"', '"10 kN/mm"\nbearing_stiffness_across = "30 kN/mm"'),
        ("bearing_damping = 0.02", "bearing_damping = 0.001"),
        ("\ndamping = 0.03", "\ndamping = 0.005"),
        ("depth = 0.5", "depth = 0.9"),
        ('backlash = "0.1 mm"', 'backlash = "0.02 mm"'),
        text=BARE,
    )
    path.write_text(text + '[speeds]\nrange = ["3000 rpm", "3500 rpm"]\npoints = 2\n')
    found = gearopt.solve(path).design
    assert found["speeds"]["jammed_rpm"] == [3000.0, 3500.0]
    assert found["speeds"]["rms_mm"] == [None, None]
    grows, jams = found["warnings"]
    assert grows.startswith("At 3,000 to 3,500 rpm the pair is unstable")
    assert jams.startswith("At 3,000 to 3,500 rpm the axes come together until the backlash")


def test_a_motion_spans_so_many_periods_of_the_mesh_at_most(tmp_path):
    """3000 rpm of 30 teeth: 1500 periods a second, 67 s are 100,500 of them."""
    with pytest.raises(SceneError, match="100,500 periods") as wrong:
        read((BARE + '[simulate]\nduration = "67 s"\n').encode())
    assert wrong.value.key == "simulate.duration"
    read((BARE + '[simulate]\nduration = "66 s"\n').encode())


def test_a_long_motion_ends_within_a_slice_of_its_steps(tmp_path):
    """Half a minute at 12 steps or more in a period of 5.75 kHz: looks every 50,000 steps."""
    path, seen = tmp_path / "motion.toml", []
    path.write_text(BARE + '[simulate]\nduration = "30 s"\nerror = 1e-6\n')

    def watch(event):
        if not event.part.startswith(COMPILING):
            seen.append(event.evaluations)
        return len(seen) <= 3

    result = gearopt.solve(path, watch=watch)
    assert result.message == "Stopped early: the motion in time missing." and len(seen) == 4
    assert np.diff(seen) == pytest.approx([12 * 50_000] * 3, rel=0.01)
    assert result.evaluations == seen[-1] + 1


def test_where_contact_is_unstable_the_motion_that_parting_limits_is_told(tmp_path):
    """11.5 kHz, light damping: multiplier 1.0753; an RK4 program of its own: RMS 15.40 um."""
    path = tmp_path / "motion.toml"
    text = changed(
        ("bearing_damping = 0.02", "bearing_damping = 0.005"),
        ("\ndamping = 0.03", "\ndamping = 0.01"),
        ("depth = 0.5", "depth = 0.3"),
        ("3000 rpm", "23000 rpm"),
        text=BARE,
    )
    text += '[stability]\nmesh_frequency = ["11 kHz", "12 kHz"]\nfrequencies = 3\ndepths = 2\n'
    path.write_text(text)
    told = "The pair is unstable at its speed: the largest Floquet multiplier is 1.0753 a mesh"
    limit = "Teeth part, which limits the motion to an RMS of 15.4 µm."
    assert gearopt.solve(path).design["warnings"] == [f"{told} period. {limit}"]
    path.write_text(text.replace('backlash = "0.1 mm"', "#"))
    found = gearopt.solve(path)
    assert found.design["warnings"] == [f"{told} period. Its motion grows without end."]
    assert "own depth of 0.3: 11,500 Hz" in found.to_html()


@pytest.mark.parametrize(
    ("bearing", "said"), [(3e3, "the contact ratio falls to"), (4e2, "where the contact ratio is")]
)
def test_axes_that_move_out_of_the_range_of_the_model_are_told(bearing, said):
    """F = 200 N m/60 mm moves both axes by F/k along the line of action; module 4.257 mm."""
    text = changed(('"100 kN/mm"', f'"{bearing:g} N/mm"'), text=BARE)
    apart = 2.0 * 2e5 / 60.0 / bearing
    distance, angle = 140.0 / math.cos(math.radians(20.0)), math.radians(20.0)
    far = math.hypot(distance + apart * math.sin(angle), apart * math.cos(angle)) - distance
    longer = math.sqrt((distance + far) ** 2 - 140.0**2) - 140.0 * math.tan(angle)
    ratio = 1.68 - longer / (2.0 * math.pi * 60.0 / 30.0)  # of the path, over the base pitch
    found = gearopt.solve(tomllib.loads(text))
    (warned,) = found.design["warnings"]
    told = re.search(r"up to ([0-9.]+) mm, ([0-9.]+) modules", warned)
    assert float(told[1]) == pytest.approx(far, rel=0.1)
    assert float(told[2]) == pytest.approx(float(told[1]) / 4.2567, rel=1e-2)
    assert f"{said} {ratio:.3g}" in warned
    first = str(found).splitlines()[1]
    assert (ratio < 1.0) == warned.startswith("Teeth leave mesh") == ("leave mesh" in first)
    assert not gearopt.solve(tomllib.loads(BARE)).design.get("warnings")


def test_bearings_that_leave_no_teeth_in_mesh_are_refused_with_what_keeps_them():
    text = changed(('"100 kN/mm"', '"100 N/mm"'), text=BARE)
    with pytest.raises(
        SceneError, match="no teeth touch. Write bearings that are at least 8 times"
    ):
        gearopt.solve(tomllib.loads(text))
    (warned,) = gearopt.solve(tomllib.loads(text.replace('"100 N/mm"', '"800 N/mm"'))).design[
        "warnings"
    ]
    assert warned.startswith("The axes move apart")


@pytest.mark.parametrize(
    ("axes", "said"), [("fixed", "masses of the gears"), ("line", "that key has no")]
)
def test_keys_without_effect_are_told(axes, said):
    text = changed(('axes = "line"', f'axes = "{axes}"\nkinematics = "exact"'), text=BARE)
    content = tomllib.loads(text)
    found = [gearopt.solve(content)]
    content["mesh"]["kinematics"] = "tangent"
    if axes == "fixed":
        content["pinion"] |= {"mass": "6 kg", "bearing_stiffness": "7 N/mm"}
    found.append(gearopt.solve(content))
    assert found[0].design["equilibrium"] == found[1].design["equilibrium"]
    assert said in found[0].report["assumptions"][-1]


def test_a_motion_of_too_many_steps_is_refused_with_the_period_of_its_fastest_mode():
    text = changed(('base_diameter = "160 mm"', 'base_diameter = "1.6e14 mm"'))
    _, wide = read(text.encode(), "wide.toml")
    with pytest.raises(SolveError, match="has a period of 3.26e-16 s: a motion of 0.02 s takes"):
        gearopt.solve(wide)


def test_a_motion_that_still_settles_is_told_so():
    """x = e^(-zeta w t) cos w t of one mass under a load put on at once: half-lives by hand."""
    content = tomllib.loads(KIND.example.text)
    content = {key: content[key] for key in ("gearopt", "kind", "pinion", "wheel", "mesh")}
    mesh = {"wave": "constant", "stiffness": "200 kN/mm", "axes": "fixed", "damping": 0.02}
    mesh |= {key: content["mesh"][key] for key in ("pressure_angle", "teeth")}
    content |= {"mesh": mesh, "simulate": {"duration": "4 ms"}}
    rate = 0.02 * math.sqrt(2e5 * 3400.0)  # 1/s
    (said,) = [w for w in gearopt.solve(content).design["warnings"] if "still settles" in w]
    third, last = map(float, re.findall(r"by ([\d.]+) µm", said))
    assert third / last == pytest.approx(math.exp(rate * 1e-3), rel=0.02)
    content["simulate"] = {"duration": "4 ms", "start": "equilibrium"}
    assert not gearopt.solve(content).design.get("warnings")
