"""Files of strain wave gearings: what is given, chosen, refused, assumed."""

import math
import sys
from dataclasses import replace

import pytest

import gearopt
from gearopt.errors import SceneError, SolveError
from gearopt.formulations.strain_wave.demand import equal_pressure, loads_at, pressures
from gearopt.formulations.strain_wave.design import Deflected, WaveDesign, used
from gearopt.formulations.strain_wave.exchange import Exchanged, RangeEnd, design_of
from gearopt.formulations.strain_wave.sizing import variables
from gearopt.optimise.result import Outcome, Result
from gearopt.optimise.typed import typed
from gearopt.report.kinds.strain_wave.tables import loads
from gearopt.report.measures import METRIC
from gearopt.scenes import strain_wave
from gearopt.scenes.explaining.explanations import explanation
from gearopt.scenes.reading.ask import Ask
from gearopt.scenes.reading.load import read
from gearopt.scenes.strain_wave import KIND, methods_to_compare, objectives, posed, traded
from gearopt.scenes.strain_wave import KIND as WAVES
from gearopt.scenes.strain_wave.explain import costs, of_pressure
from gearopt.scenes.strain_wave.notes import assumptions, notes, range_notes

FROM_DUTY = WAVES.examples["strain-wave-from-duty"].text

EXAMPLE = KIND.example.text


def scene(text):
    return read(text.encode())[1]


def test_a_given_gearing_is_evaluated_and_its_design_is_typed(solved):
    given = solved("strain_wave_base")
    assert given.status == "evaluated" and given.feasible and not given.objective
    found = typed(WaveDesign, given.design)
    assert found.flexspline_teeth == 160 and found.circular_spline_teeth == 162
    assert found.pairs_in_contact == pytest.approx(1.09613, abs=5e-6)
    assert found.carrying_teeth == 6 and found.effective_teeth == pytest.approx(4.34, abs=5e-3)
    assert sum(t.force_N for t in found.teeth) == pytest.approx(5e4 / 38.05755114, rel=1e-8)
    assert found.cutter.regular and found.cutter.straight_deg == pytest.approx(20.097, abs=6e-4)
    assert found.least_clearance_mm == 0.0
    assert [row.profile_shift for row in found.shifts] == pytest.approx([0.3 * k for k in range(8)])


def test_loads_over_the_wave_are_those_of_the_teeth(solved):
    """Where a tooth stands its load by turning the wave generator is that of the table."""
    found = typed(WaveDesign, solved("strain_wave_base").design)
    for tooth in found.teeth:
        k = min(
            range(len(found.load_N)),
            key=lambda i: abs(found.load_angle_deg[i] - tooth.wave_angle_deg),
        )
        assert found.load_N[k] == pytest.approx(tooth.force_N, abs=1e-6)


def test_other_deflections_of_the_same_teeth(solved):
    """um, from another program on coarser poses, which miss up to 0.05 um at an end of contact."""
    rows = solved("strain_wave_base").design["deflections"]
    found = {d["deflection"]: 1e3 * d["least_clearance_mm"] for d in rows}
    assert found == pytest.approx({0.95: 5.56, 0.98: 3.16, 1.02: -3.33, 1.05: -8.55}, abs=6e-3)
    assert found[0.95] == pytest.approx(5.61, abs=0.06)


def test_a_deflection_without_play_is_told(solved):
    """Of the base case a smaller deflection has backlash; 15.4 and 4.6 um are cut by the best."""
    base = typed(WaveDesign, solved("strain_wave_base").design)
    assert not any("tolerance" in note for note in notes(base))
    assert any(
        "No interference was found: the least clearance was sought" in n for n in notes(base)
    )
    less, more = (
        Deflected(deflection=w, least_clearance_mm=g)
        for w, g in ((0.98, -0.0154), (1.02, -0.00464))
    )
    (told,) = [n for n in notes(replace(base, deflections=(less, more))) if "No deviation" in n]
    assert told.endswith("by 15.4 µm at 0.98 modules and 4.64 µm at 1.02 modules.")


def test_what_is_assumed_is_told_until_it_is_given():
    told = " ".join(assumptions(scene(EXAMPLE)))
    for word in (
        *("100,000 N/mm", "400 MPa", "230 MPa", "3,000 N/mm", "chain of springs", "206 GPa"),
        *(
            "notch factor of 1.6",
            "safety of 1.5",
            "0.6 times as thick",
            "30 mm long",
            "0.25 modules",
        ),
        *("Poisson's ratio 0.3", "3 mm of the circular spline", "3 times the torque"),
    ):
        assert word in told
    limits = '[material]\nbending_limit = "400 MPa"\n'
    more = EXAMPLE.replace('rim = "elastic"', 'rim = "rigid"\npair_compliance = "9 um/kN"') + limits
    told = " ".join(assumptions(scene(more)))
    assert "400 MPa" not in told and "1e+05" not in told and "springs" not in told
    assert "230 MPa" in told and "notch factor" in told


def test_every_assumption_can_be_given():
    """A file that gives all is told no number as assumed but what has no key."""
    given = EXAMPLE.replace("# [design]", "[design]\n" + "\n".join(LIMITS) + "\n# [design]")
    sizes = 'face_width = "10 mm"\nclearance = 0.25\nshell = "3 mm"'
    given = given.replace('face_width = "10 mm"', sizes) + "[material]\n" + "\n".join(STEEL)
    given = given.replace('rim = "elastic"', 'wall_over_rim = 0.6\npair_compliance = "9 um/kN"')
    told = assumptions(scene(given))
    assert not [words for words in told if words.startswith("Assumed")]


STEEL = (
    'elastic_modulus = "200 GPa"',
    "poisson_ratio = 0.29",
    'shear_limit = "230 MPa"',
    'bending_limit = "400 MPa"',
)
LIMITS = (
    *("notch = 1.6", "safety = 1.5", "ratcheting = 3", "pairs = 1"),
    'radial_compliance = "333 um/kN"',
)


def test_assumed_ranges_are_told_until_they_are_given():
    (told,) = [w for w in assumptions(scene(FROM_DUTY)) if "ranges of what" in w]
    for words in ("profile shift 0 to 2", "pressure angle 15° to 30°", "deflection 0.97 to 1.25"):
        assert words in told
    own = scene(FROM_DUTY + "[design]\nprofile_shift = [0, 1]\n")
    (told,) = [w for w in assumptions(own) if "ranges of what" in w]
    assert "profile shift" not in told and "addendum 0.4 to 0.9" in told


def test_ends_of_ranges_are_told_with_what_decides():
    ends = (
        RangeEnd(name="deflection", value=0.97, least=True, gain=2.46),
        RangeEnd(name="rim", value=1.4, least=False, gain=0.161),
    )
    own = scene(FROM_DUTY + '[design]\nrim = ["0.4 mm", "1.4 mm"]\n')
    first, second = range_notes(own, ends)
    assert "deflection 0.97 (lower end, assumed) and rim 1.4 mm (upper end, of [design])" in first
    assert second == (
        "The ends of the ranges of deflection and rim limit the contact pressure: a slightly wider "
        "range of any one, with all other sizes chosen anew, would lower it (first order)."
    )
    assert "The end of the range of deflection limits" in range_notes(own, ends[:1])[1]
    assert range_notes(own, ()) == []


def test_a_gearing_of_another_modulus_carries_loads_in_proportion_to_it():
    """Dimensions: all stiffnesses and the torque r times as great, all strains are the same."""
    part = 70.0 / 206.0
    soft = EXAMPLE.replace('"100 N m"', f'"{100.0 * part!r} N m"')
    soft += '[material]\nelastic_modulus = "70 GPa"\n'
    own, steel = scene(soft), scene(EXAMPLE)
    made = design_of(steel.demand(), steel.start())
    (teeth, less), (_, more) = (loads_at(one.loads(), made) for one in (own, steel))
    assert less.windup == pytest.approx(more.windup, rel=1e-12)
    assert less.forces == pytest.approx(part * more.forces, rel=1e-12)
    stresses = [
        pressures(one.loads(), made, teeth, one_load)
        for one, one_load in ((own, less), (steel, more))
    ]
    assert stresses[0] == pytest.approx(part * stresses[1], rel=1e-12)
    slow, fast = (used(one.demand(), made) for one in (own, steel))
    assert slow["ratcheting"] == pytest.approx(fast["ratcheting"], rel=1e-12)
    assert set(fast) - set(slow) == {"rim_fatigue"}  # no fatigue limit of such a material is known


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (FROM_DUTY, "material.bending_limit"),
        (EXAMPLE + '[material]\nbending_limit = "100 MPa"\n', "material.shear_limit"),
        (EXAMPLE + "[design]\nsafety = 2\n", "material.bending_limit"),
    ],
)
def test_fatigue_limits_of_steel_are_not_assumed_of_another_material(text, key):
    soft = '[material]\nelastic_modulus = "70 GPa"\n'
    text = text.replace("\n[material]\n", f"\n{soft}")
    text = text if soft in text else text + soft
    with pytest.raises(SceneError, match="no steel") as refused:
        scene(text)
    assert key in str(refused.value)


@pytest.mark.parametrize(("rim", "told"), [("rigid", "teeth alone"), ("elastic", "teeth, rim")])
def test_the_windup_says_of_which_parts_it_is(solved, rim, told):
    found = typed(WaveDesign, solved("strain_wave_base").design)
    found = replace(found, elastic_rim=rim == "elastic")
    rows = {label: cell.value for label, cell in loads(found, METRIC).rows}
    assert next(v for k, v in rows.items() if "windup" in k and told in k) == found.windup_mrad
    assert any("windup" in note and told in note for note in notes(found))


@pytest.mark.parametrize(("line", "held"), [("", 1.0125), ('torque_of = "output"', 1.0)])
def test_teeth_carry_what_the_circular_spline_holds(line, held):
    """Equilibrium: the spline holds the torques of output and input, T (1 + 1/80)."""
    own = scene(EXAMPLE.replace("[sharing]", f"[sharing]\n{line}"))
    duty, made = own.loads(), design_of(own.demand(), own.start())
    _, loads = loads_at(duty, made)
    assert 2.0 * loads.forces.sum() * 38.05755114 == pytest.approx(1e5 * held, rel=1e-8)
    assert equal_pressure(duty, made) == pytest.approx(117.38 * math.sqrt(held), abs=0.01)


@pytest.mark.slow
def test_interference_is_told_before_numbers(solved):
    found = solved("strain_wave_interferes")
    assert not found.feasible and "interference" in found.message
    assert found.limits["interference"] > 1.05
    assert not found.design["cutter"].get("regular") and "x_mm" not in found.design["cutter"]


def test_no_contact_is_refused_with_the_deflection_that_it_takes():
    low = EXAMPLE.replace("deflection = 1", "deflection = 0.8")
    told = r"deflection = 0\.8: is too small: there is no contact at the major axis below 0\.8139"
    with pytest.raises(SceneError, match=told) as wrong:
        scene(low)
    enough = str(wrong.value).rpartition("Write deflection = ")[2]
    assert scene(low.replace("deflection = 0.8", f"deflection = {enough}"))


def test_a_flank_without_conjugate_points_is_refused_with_an_angle_that_has_them():
    flat = EXAMPLE.replace('pressure_angle = "20 deg"', 'pressure_angle = "6 deg"')
    flat = flat.replace("profile_shift = 0.9", "profile_shift = -0.978")
    flat = flat.replace("deflection = 1", "deflection = 1.073")
    with pytest.raises(SceneError, match="without conjugate contact") as wrong:
        scene(flat)
    angle = str(wrong.value).rpartition("Write pressure_angle = ")[2]
    assert scene(flat.replace('"6 deg"', angle))


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("deflection = 1\n", "", "duty.outer_diameter"),
        ('face_width = "10 mm"', "", "gears.face_width"),
        ('shape = "cosine"', 'shape = "cosine"\nwrap_angle = "30 deg"', "wave_generator"),
        ("# [design]", "[design]\nprofile_shift = [0, 1]\n#", "design.profile_shift"),
        ("ratio = 80", "ratio = 5", "duty.ratio"),
    ],
)
def test_wrong_files_are_told_where(old, new, place):
    with pytest.raises(SceneError) as wrong:
        scene(EXAMPLE.replace(old, new))
    assert place in str(wrong.value)


def test_ranges_of_a_duty_alone_are_those_of_its_size():
    """The module that fits 90 mm, 20 % up and 10 % less; given numbers are held."""
    own = scene(FROM_DUTY)
    assert own.usual_module == pytest.approx((90.0 - 6.0) / 165.5, rel=1e-12)
    ranges = own.ranges()
    assert ranges["module"] == pytest.approx((0.8 * own.usual_module, 1.1 * own.usual_module))
    assert ranges["pressure_angle"] == pytest.approx((math.radians(15), math.radians(30)))
    held = scene(FROM_DUTY + "[gears]\nprofile_shift = 0.9\n")
    assert held.ranges()["profile_shift"] == (0.9, 0.9)
    assert own.demand().duty.face_width == 10.0 and own.demand().outer_radius == 45.0


def test_problems_of_a_duty_alone():
    own = scene(FROM_DUTY)
    assert methods_to_compare(own) == ("exchange", "annealing", "nsga2")
    assert set(posed(own, "").problem.methods) == {"exchange"}
    assert len(posed(own, "nsga2").problem.columns) == 6
    assert list(objectives(own)) == ["pressure", "volume_per_torque", "load_share"]
    tradeoff = traded(own, ("pressure", "load_share"), Ask("nsga2"))
    assert tradeoff.problem.rows.objectives == ("pressure", "load_share")
    tradeoff = traded(own, ("volume_per_torque", "pressure"), Ask())
    assert tradeoff.limiting.names == ("pressure",)
    tradeoff = traded(own, ("pressure", "volume_per_torque"), Ask())
    assert tradeoff.limiting.names == ("volume_per_torque",)
    with pytest.raises(SolveError, match="load_share counts teeth"):
        traded(own, ("pressure", "load_share"), Ask())
    for call in (methods_to_compare, objectives, lambda s: posed(s, "")):
        with pytest.raises(SolveError, match="the gearing is given"):
            call(scene(EXAMPLE))


def test_a_gearing_of_any_size_is_posed():
    own = scene(FROM_DUTY.replace("90 mm", "180000000 mm"))
    (change,) = [v for v in variables(own.demand(), own.start()) if v.name == "change"]
    assert change.lower < change.guess < change.upper == -change.lower > 1e3


def test_methods_that_are_not_there_are_refused():
    with pytest.raises(SolveError, match="no method 'gp'"):
        gearopt.solve(scene(FROM_DUTY), method="gp")
    with pytest.raises(SolveError, match="changes nothing here: the gearing is given"):
        gearopt.solve(scene(EXAMPLE), method="exchange")


def test_explain_of_given_gears_names_what_decides(solved):
    told = replace(solved("strain_wave_base"), limits={"pairs": 1.0, "ratcheting": 0.5})
    found = explanation(KIND, scene(EXAMPLE), Ask(), told)
    assert found.binding == ("pairs",) and not found.influences
    assert "the gearing is given" in found.message


def test_what_limits_cost_is_told_in_their_units():
    """Of the sum over passages; equations and rounding are left out."""
    found = costs({"outer_radius": -97.0, "interference[1]": -1.0, "interference[2]": -0.5})
    assert found.endswith("outer radius 0.97 MPa for 1 %, interference 0.015 MPa for 1 µm")
    assert costs({"length": -29.0, "pairs": -1e-12}) == ""


@pytest.mark.slow
def test_explain_of_a_duty_follows_the_laws_of_similar_gearings():
    """Hertz's pressure of similar gearings goes with (T/D^3)^(1/2), whatever the limits are."""
    found = explanation(KIND, scene(FROM_DUTY.replace("[cutter]\n", "")), Ask())
    by = {i.key: i for i in found.influences}
    assert set(found.binding) == {"outer_radius", "interference"}
    for key, power in (("duty.torque", 0.5), ("duty.outer_diameter", -1.5)):
        assert by[key].sensitivity == pytest.approx(power, abs=1e-3)
        assert by[key].resolved == pytest.approx((power, power), abs=1e-3)
    assert by["duty.ratio"].step == "+1" and by["duty.ratio"].price < 0.0
    assert "outer radius 0.974 MPa for 1 %, interference 0.0142 MPa for 1 µm" in found.message


@pytest.mark.slow
@pytest.mark.parametrize(
    ("torque", "diameter", "status", "conflict"),
    [
        ("400 N m", "90 mm", "infeasible", ("ratcheting",)),
        ("300 N m", "90 mm", "failed", ("ratcheting", "rim_fatigue")),
    ],
)
def test_an_impossible_duty_is_told_what_would_do(torque, diameter, status, conflict):
    """Torque times size^-3 is what the teeth carry, so that both remedies are one law."""
    text = FROM_DUTY.replace("100 N m", torque).replace("90 mm", diameter)
    own = scene(text.replace("[cutter]\n", ""))
    found = gearopt.solve(own)
    ways = found.report["ways_out"]
    assert found.status == status and set(ways["conflict"]) == set(conflict)
    told = found.message + ways["message"]
    assert "ratcheting: at" in told and "N m of" in told and "a safety of" in told
    wider, less = ways["remedies"]
    assert less["what"] == "duty.torque" and wider["what"] == "duty.outer_diameter"
    assert less["factor"] ** (1.0 / 3.0) == pytest.approx(wider["factor"], rel=2e-3)
    assert explanation(KIND, own, Ask(), found).remedies[0].factor == wider["factor"]


@pytest.mark.slow
def test_a_sampler_tells_what_it_hides():
    own = scene(FROM_DUTY.replace("[cutter]\n", ""))
    found = gearopt.solve(own, method="nsga2", seed=3, budget=gearopt.Budget(evaluations=2000))
    assert found.status == "feasible" and 92.0 < found.value < 110.0
    least = found.design["least_clearance_mm"]
    assert (least < -1e-6) == ("overlap" in found.message)


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "diameter"), [(30, "90 mm"), (100, "200 mm")])
def test_other_ratios_and_sizes_from_a_duty_alone(ratio, diameter):
    torque = "100 N m" if diameter == "90 mm" and ratio < 100 else "30 N m"
    text = FROM_DUTY.replace("ratio = 80", f"ratio = {ratio}").replace("90 mm", diameter)
    text = text.replace("100 N m", torque).replace("[cutter]\n", "")
    found = gearopt.solve(scene(text))
    assert found.status in ("stationary", "feasible") and found.feasible
    assert found.design["flexspline_teeth"] == 2 * ratio
    assert found.design["least_clearance_mm"] >= 0.0
    assert found.design["outer_diameter_mm"] <= float(diameter.split()[0]) * (1 + 1e-8)


def test_what_time_is_short_for_is_named(monkeypatch):
    monkeypatch.setattr(strain_wave, "TELLING_SECONDS", 0.0)
    found = gearopt.solve("problems/strain_wave_base.toml", budget=gearopt.Budget(seconds=0.0))
    assert found.status == "evaluated" and found.feasible
    assert found.report["notes"][-1] == (
        "Left out for lack of time: teeth within a clearance, other deflections, the largest "
        "addendum, the largest profile shift at which one pair always touches, the least "
        "deflection with contact, the curve over profile shifts and straight and circular edges of "
        "the cutter."
    )
    page = found.to_html()
    for heading in ("Contact pressure against profile shift", "other deflections</"):
        assert heading not in page


def test_sensitivities_that_time_is_short_for_are_left_out(monkeypatch):
    scene = gearopt.load("problems/strain_wave_from_duty.toml")
    found = Result("strain wave gearing", "stationary", "exchange", {})
    nothing = Exchanged(found, Outcome(None), None, None)
    monkeypatch.setattr(sys.modules[of_pressure.__module__], "exchange", lambda *_: nothing)
    known = explanation(KIND, scene, Ask(), found)
    assert known.result is found and not known.influences and "no time" in known.message
