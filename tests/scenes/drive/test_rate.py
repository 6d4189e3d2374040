"""`gearopt rate` of files: units, given factors, geometry of a stage, refusals, sized drives."""

import math
from pathlib import Path

import pytest
from rated_files import numbers_of, pair, two_stages, without

import gearopt
from gearopt.scenes.explaining.numbers import numbers

PROBLEMS = Path(__file__).parents[3] / "problems"


def rated(tables):
    result = gearopt.rate(tables)
    assert result.status == "evaluated" and result.value is None
    return result.design["rating"]


def of(rows, **which):
    """The one row of a table with these values."""
    (row,) = (r for r in rows if which.items() <= r.items())
    return row


def test_safety_factors_are_the_limits_as_utilisations():
    result = gearopt.rate(pair({"minimum_bending_safety": 1.5, "minimum_contact_safety": 1.2}))
    rows = result.design["rating"]["gears"]
    used = {f"{r['member']}_bending[1]": 1.5 / r["bending_safety"] for r in rows}
    used |= {f"{r['member']}_contact[1]": 1.2 / r["contact_safety"] for r in rows}
    assert result.limits == pytest.approx(used, rel=1e-14)
    assert result.feasible == result.design["rating"]["safe"] == (max(used.values()) <= 1.0)


def test_at_its_power_capacity_a_pair_is_just_safe():
    """K_v depends on speed alone, so that stresses are those of the power."""
    for asked in ({}, {"minimum_contact_safety": 2.5}, {"minimum_bending_safety": 6}):
        found = rated(pair(asked))
        power = f"{found['power_capacity_kW']!r} kW"
        result = gearopt.rate(pair(asked, {"power": power}))
        assert max(result.limits.values()) == pytest.approx(1.0, rel=1e-12)
        assert result.design["rating"]["governs"] == found["governs"]


INCH = 25.4
PSI = 0.45359237 * 9.80665 / INCH**2  # MPa
HORSEPOWER = 550 * 0.3048 * 0.45359237 * 9.80665 * 1e-3  # kW


def test_inches_are_millimetres():
    """Every number of the design, of a pair in in, hp, psi and degF and the same in mm, kW, MPa."""
    inch = pair(
        {"temperature": "284 degF", "oil_viscosity": "40 mPa s"}
        | {"given": {"s_at": "50 ksi", "C_p": "2300 sqrt(psi)"}},
        {"power": "20 hp"},
        {"elastic_modulus": "30000 ksi", "roughness": "32 uin"},
        {"profile_shift": 0.2, "thickness_allowance": "-0.002 in", "rim_thickness": "0.25 in"},
        face_width="1.5 in",
        helix_angle="15 deg",
        centre_distance="4.15 in",
    )
    inch = without(inch, "stage", "module")
    inch["stage"][0]["diametral_pitch"] = 10
    given = {"s_at": f"{50e3 * PSI!r} MPa", "C_p": f"{2300 * math.sqrt(PSI)!r} sqrt(MPa)"}
    metric = pair(
        {"temperature": "140 degC", "oil_viscosity": "40 mPa s", "given": given},
        {"power": f"{20 * HORSEPOWER!r} kW"},
        {"elastic_modulus": f"{30e6 * PSI!r} MPa", "roughness": f"{32e-3 * INCH!r} um"},
        {
            "profile_shift": 0.2,
            "thickness_allowance": f"-{0.002 * INCH!r} mm",
            "rim_thickness": "6.35 mm",
        },
        module="2.54 mm",
        face_width="38.1 mm",
        helix_angle="15 deg",
        centre_distance="105.41 mm",
    )
    theirs, ours = (numbers_of(gearopt.rate(t).design) for t in (inch, metric))
    assert len(ours) > 100 and theirs == pytest.approx(ours, rel=1e-9)


def test_a_module_in_pitches_is_a_diametral_pitch():
    by_module = gearopt.rate(pair(module="8 1/in")).design
    pitch = without(pair(diametral_pitch=8), "stage", "module")
    assert gearopt.rate(pitch).design == by_module
    assert by_module["stages"][0]["normal_module_mm"] == pytest.approx(3.175, rel=1e-15)


def test_a_centre_distance_sets_the_working_angle_and_backlash():
    """cos alpha_w = a cos alpha/a_w; d_w = 2 a_w/(u + 1); a wider one leaves backlash."""
    found = rated(pair(centre_distance="120.4 mm"))
    (mesh,) = found["meshes"]
    angle = math.acos(120.0 * math.cos(math.radians(20.0)) / 120.4)
    assert mesh["working_pressure_angle_deg"] == pytest.approx(math.degrees(angle), rel=1e-12)
    assert found["teeth"][0]["working_pitch_diameter_mm"] == pytest.approx(60.2, rel=1e-12)
    radial = mesh["radial_force_N"] / mesh["tangential_force_N"]
    assert radial == pytest.approx(math.tan(angle), rel=1e-12)
    opening = 240.8 * (math.tan(angle) - angle - math.tan(math.radians(20.0)) + math.radians(20.0))
    assert mesh["circumferential_backlash_mm"] == pytest.approx(opening, rel=1e-9)


def test_a_pair_that_one_of_two_standards_finds_unsafe_is_not_safe():
    coarse = {"standard": "both", "iso6336": {"accuracy_grade": 10}}
    found = rated(pair(coarse))
    agma, iso = (min(g["contact_safety"] for g in r["gears"]) for r in (found, found["beside"]))
    assert agma > iso
    between = {"minimum_contact_safety": round(0.5 * (agma + iso), 3)}
    result = gearopt.rate(pair(coarse | between))
    rating = result.design["rating"]
    assert not result.feasible and not rating["safe"] and not rating["beside"]["safe"]
    assert "safe by AGMA alone" in str(result)


@pytest.mark.parametrize("standard", ["agma", "both"])
def test_gears_that_do_not_fit_are_not_safe(standard):
    """In 119.6 mm instead of 120: 2 a_w (inv(alpha_w) - inv(alpha)) is -0.287 mm."""
    more = {"iso6336": {"accuracy_grade": 6}} if standard == "both" else {}
    result = gearopt.rate(pair({"standard": standard, **more}, centre_distance="119.6 mm"))
    found = result.design["rating"]
    both = [found, *([found["beside"]] if standard == "both" else [])]
    assert max(result.limits.values()) < 1.0  # strength is not the reason
    assert not result.feasible and not any(one["safe"] for one in both)
    assert "the backlash is -0.287 mm" in found["misfits"][0]
    shown = str(result)
    assert ": not safe" in shown and "The gears do not fit" in shown and ": safe" not in shown
    assert result.certificate["feasibility"] >= 0.2865 / 3.0  # in modules


def test_a_centre_distance_far_off_is_told_first():
    """1.062 mm: 250 (inv(alpha_w) - inv(alpha)) less 2 x tan(alpha) m_n of x = 0.5."""
    found = gearopt.rate(
        pair(
            module="2.5 mm",
            pinion_teeth=24,
            wheel_teeth=74,
            centre_distance="125 mm",
            pinion={"profile_shift": 0.5},
        )
    )
    shown = " ".join(str(found).split("gear  ")[0].split())
    assert found.feasible and ": safe, with warnings" in shown
    assert "is 1.062 mm" in shown and "1.072 in sum, and the gears have 0.5" in shown
    assert "contact ratio of stage 1 is small, 1.107" in shown


@pytest.mark.parametrize(
    ("own", "fits"),
    [({"bore": "55 mm"}, False), ({"bore": "52.5 mm"}, False), ({"bore": "40 mm"}, True)],
)
def test_a_bore_wider_than_its_root_circle_does_not_fit(own, fits):
    """Of 52.5 mm; a bore of all gears leaves a small one solid, as on a pinion shaft."""
    found = gearopt.rate(pair(pinion=own))
    assert found.feasible is fits and ("misfits" in found.design["rating"]) is not fits
    assert gearopt.rate(pair(gears=own)).feasible


@pytest.mark.parametrize("standard", ["iso6336", "both"])
def test_a_face_that_is_loaded_in_part_is_warned_of(standard):
    """b_cal/b = 2/K_Hbeta: the line load falls straight to 0 at b_cal, its mean is F/b."""
    asked = {"standard": standard, "iso6336": {"accuracy_grade": 6}}
    asked |= {"quality": 8} if standard == "both" else {}
    tables = pair(asked, {"power": "2 kW"})
    tables["rating"] = {k: v for k, v in tables["rating"].items() if k != "quality"} | asked
    for power, partly in (("2 kW", True), ("25 kW", False)):
        result = gearopt.rate(tables, {"duty.power": power})
        found = result.design["rating"]
        row = of((found.get("beside") or found)["factors"], symbol="K_Hbeta")
        assert (row["pinion"] > 2.0) is partly
        loaded = f"Only {200.0 / row['pinion']:.3g} % of the face width of stage 1"
        assert any(loaded in said for said in found.get("flaws", ())) is partly
        assert (f"(K_Hβ {row['pinion']:.4g}) is in contact; above" in str(result)) is partly


def test_faces_that_are_loaded_in_part_are_one_sentence_for_all_stages():
    tables = without(two_stages(duty={"power": "1 kW"}), "rating", "quality")
    tables["rating"] |= {"standard": "iso6336", "iso6336": {"accuracy_grade": 6}}
    found = rated(tables)
    (said,) = (words for words in found["flaws"] if "in contact" in words)
    first, second = (row["pinion"] for row in found["factors"] if row["symbol"] == "K_Hbeta")
    assert min(first, second) > 2.0
    assert said.startswith(
        f"Only {200.0 / first:.3g} % of the face width of stage 1 (K_Hbeta {first:.4g}) and "
        f"{200.0 / second:.3g} % of the face width of stage 2 (K_Hbeta {second:.4g}) are in contact"
    )


def test_main_resonance_and_speeds_beyond_the_curve_of_K_v_are_said_first():
    """Q_v 8: B = 4^(2/3)/4, A = 50 + 56 (1 - B), the curve ends at (A + 5)^2 ft/min; d1 60 mm."""
    tables = pair({"standard": "both", "iso6336": {"accuracy_grade": 7}})
    b = 4.0 ** (2.0 / 3.0) / 4.0
    most = (50.0 + 56.0 * (1.0 - b) + 5.0) ** 2 * 0.3048 / 60.0  # m/s
    seen = set()
    for speed in (1450, 6000, 9500, 15000, 20000):
        result = gearopt.rate(tables, {"duty.input_speed": f"{speed} rpm", "duty.power": "30 kW"})
        found = result.design["rating"]
        (mesh,), rows = found["meshes"], found["beside"]["factors"]
        line = mesh["tangential_force_N"] * 1.25 / 30.0
        begins = 0.5 + 0.35 * min(1.0, line / 100.0) ** 0.5  # of ISO 6336-1
        near = begins < of(rows, symbol="N")["pinion"] <= 1.15
        fast = mesh["pitch_line_velocity_m_per_s"] > most
        flaws = found.get("flaws", ())
        assert any("runs in its main resonance, N = " in said for said in flaws) is near
        assert any(f"ends at {most:.1f} m/s: K_v" in said for said in flaws) is fast
        assert not (result.feasible and flaws) or "safe, with warnings" in str(result)
        seen |= {(near, fast)}
    assert {(False, False), (True, True), (False, True)} <= seen


def test_helix_and_pressure_angle_are_those_of_the_stage():
    """m_F = b sin beta/(pi m_n); tan alpha_t = tan alpha_n/cos beta; else those of [gears]."""
    tables = two_stages(
        {"helix_angle": "18 deg", "pressure_angle": "25 deg"}, gears={"helix_angle": "10 deg"}
    )
    for mesh, helix, pressure, width, module in zip(
        rated(tables)["meshes"], (18, 10), (25, 20), (30, 60), (3, 4), strict=True
    ):
        beta, alpha = math.radians(helix), math.radians(pressure)
        overlap = width * math.sin(beta) / (math.pi * module)
        assert mesh["overlap_ratio"] == pytest.approx(overlap, rel=1e-12)
        transverse = math.degrees(math.atan(math.tan(alpha) / math.cos(beta)))
        assert mesh["working_pressure_angle_deg"] == pytest.approx(transverse, rel=1e-12)
        thrust = mesh["axial_force_N"] / mesh["tangential_force_N"]
        assert thrust == pytest.approx(math.tan(beta), rel=1e-12)


def test_a_ratio_that_is_not_met_is_said():
    """60/20 = 3, 25 % below 4; within its tolerance nothing is said."""
    said = "The gears have a ratio of 3, 25 % below the one asked for."
    assert rated(pair(duty={"ratio": 4}))["flaws"] == [said]
    near = {"ratio": 3.01, "ratio_tolerance": "1 %"}
    assert "flaws" not in rated(pair(duty=near)) and "flaws" not in rated(pair())


def test_cold_gears_are_rated():
    cold = rated(pair({"temperature": "-20 degC"}))
    assert of(cold["factors"], symbol="K_T")["pinion"] == 1.0


SPAN, BALLS = ("span_teeth", "span_mm"), ("ball_diameter_mm", "over_balls_mm")


@pytest.mark.parametrize(
    ("pinion", "stage", "missing"),
    [
        ({}, {}, ()),
        ({}, {"helix_angle": "30 deg", "face_width": "8 mm"}, SPAN),  # three teeth lie 12 mm apart
        ({"profile_shift": 0.8}, {}, BALLS),  # 1.728 m_n, below the tips of the pinion
    ],
)
def test_measurements_that_cannot_be_made_are_not_told(pinion, stage, missing):
    row = rated(pair(pinion=pinion, **stage))["teeth"][0]
    assert {key for key in (*SPAN, *BALLS) if row.get(key) is None} == set(missing)


LOADS = ("K_o", "K_v", "K_m")  # in both stresses, with K_s of each gear
GIVEN = {  # how stresses and safety factors change as a factor is given 1.5 times as large
    **dict.fromkeys(LOADS, {"bending_stress": 1.5, "contact_stress": 1.5**0.5}),
    "K_s": {"bending_stress": 1.5, "contact_stress": 1.5**0.5},
    "K_B": {"bending_stress": 1.5},
    "J": {"bending_stress": 1 / 1.5},
    "C_f": {"contact_stress": 1.5**0.5},
    "I": {"contact_stress": 1.5**-0.5},
    "C_p": {"contact_stress": 1.5},
    **dict.fromkeys(("K_R", "K_T"), {"bending_safety": 1 / 1.5, "contact_safety": 1 / 1.5}),
    **dict.fromkeys(("s_at", "Y_N"), {"bending_safety": 1.5}),
    **dict.fromkeys(("s_ac", "Z_N", "C_H"), {"contact_safety": 1.5}),
}
UNITS = {"s_at": "{} MPa", "s_ac": "{} MPa", "C_p": "{} sqrt(MPa)"}


@pytest.mark.parametrize("symbol", GIVEN)
def test_every_factor_may_be_given(symbol):
    plain = rated(pair())
    row = of(plain["factors"], symbol=symbol)
    value = UNITS.get(symbol, "{}").format(1.5 * row["pinion"])
    given = {symbol: value if symbol in UNITS else float(value)}
    found = rated(pair({"given": given}))
    told = of(found["factors"], symbol=symbol)
    assert told["source"] == "given" and told["pinion"] == pytest.approx(1.5 * row["pinion"])
    assert (told.get("wheel") is None) == (row.get("wheel") is None)
    stressed = GIVEN[symbol]
    for name in ("bending", "contact"):
        stress = stressed.get(f"{name}_stress", 1.0)
        safety = stressed.get(f"{name}_safety", 1.0) / stress
        before, after = plain["gears"][0], found["gears"][0]
        grown = after[f"{name}_stress_MPa"] / before[f"{name}_stress_MPa"]
        assert grown == pytest.approx(stress, rel=1e-9)
        grown = after[f"{name}_safety"] / before[f"{name}_safety"]
        assert grown == pytest.approx(safety, rel=1e-9)


def test_factors_of_a_stage_stand_before_those_of_all():
    tables = two_stages({"given": {"K_m": 1.6}}, rating={"given": {"K_m": 1.3, "K_o": 2}})
    found = rated(tables)["factors"]
    assert [of(found, stage=k, symbol="K_m")["pinion"] for k in (1, 2)] == [1.6, 1.3]
    assert [of(found, stage=k, symbol="K_o")["pinion"] for k in (1, 2)] == [2.0, 2.0]


def test_a_later_stage_turns_slower_with_more_torque():
    found = rated(two_stages())
    second = 7.5e6 / (1450 * math.pi / 30) * 3.0 * 2.0 / 72.0  # T u/r, N
    assert found["meshes"][1]["tangential_force_N"] == pytest.approx(second, rel=1e-12)
    cycles = [r["cycles"] for r in found["gears"]]
    first = 20000 * 60 * 1450
    assert cycles == pytest.approx([first, first / 3, first / 3, first / 3 * 18 / 67], rel=1e-12)
    assert [s["speed_rpm"] for s in found["shafts"]] == pytest.approx(
        [1450, 1450 / 3, 1450 / 3 * 18 / 67], rel=1e-12
    )


REFUSED = {  # (sqrt(33^2 - 28.19^2) + sqrt(93^2 - 84.57^2) - 125 sin 25.56 deg)/8.856 = 0.215
    "pointed": ({"pinion": {"profile_shift": 1.2}, "pinion_teeth": 12}, "teeth of the pinion are"),
    "no contact": ({"centre_distance": "125 mm"}, "contact ratio is 0.215: contact breaks off"),
    "few teeth": ({"pinion_teeth": 5}, "form circles leave a transverse contact ratio of"),
    "tool": ({"pressure_angle": "40 deg"}, "flanks of the tool of the pinion meet"),
    "distance": ({"centre_distance": "80 mm"}, "the base circles overlap"),
    "shifts": ({"pinion": {"profile_shift": -2.5}}, "inside its base circle"),
    "high teeth": (
        {
            "pinion_teeth": 30,
            "gears": {"addendum": 1.4, "tool_addendum": 1.6, "tool_tip_radius": 0.2},
        },
        "transverse contact ratio of 2 or more",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_teeth_that_cannot_be_rated_are_refused_by_stage_and_name(name):
    changes, said = REFUSED[name]
    with pytest.raises(gearopt.SolveError) as wrong:
        gearopt.rate(pair(**changes))
    assert str(wrong.value).startswith("stage 1 cannot be rated: ") and said in str(wrong.value)
    own = {k: v for k, v in changes.items() if k not in ("pinion_teeth", "gears")}
    if "gears" not in changes and own:
        teeth = {"pinion_teeth": changes.get("pinion_teeth", 20), "wheel_teeth": 60}
        later = two_stages(second={"module": "3 mm"} | teeth | own)
        with pytest.raises(gearopt.SolveError, match="stage 2 cannot be rated"):
            gearopt.rate(later)


@pytest.mark.parametrize(
    "stage",
    [
        {"module": "0.1 mm", "face_width": "1 mm"},
        {"module": "50 mm", "face_width": "500 mm"},
        {"pinion_teeth": 1000, "wheel_teeth": 1000},
        {"wheel_teeth": 1000},
        {"module": "200 1/in", "face_width": "1 mm"},
    ],
    ids=["0.1 mm", "50 mm", "1000/1000", "20/1000", "200/in"],
)
def test_extreme_gears_have_a_finite_rating(stage):
    found = numbers_of(rated(pair(**stage)))
    assert len(found) > 60 and all(map(math.isfinite, found.values()))


def test_a_refusal_tells_what_else_is_wrong_with_the_teeth():
    """121 mm are too close for teeth whose reference circles touch at 120/cos 15 deg."""
    with pytest.raises(gearopt.SolveError) as wrong:
        gearopt.rate(pair(helix_angle="15 deg", centre_distance="121 mm"))
    assert "the teeth do not fit in: the backlash is -2." in str(wrong.value)


def test_undercut_is_a_warning():
    found = rated(pair(pinion_teeth=12))
    assert (
        "pinion of stage 1 is undercut (z = 12). A rack cuts 17 teeth or more" in found["flaws"][0]
    )


def test_the_optimum_of_a_sized_drive_is_rated_as_its_gears_are(solved):
    """Beside a file in which what `solve` found is given."""
    result = solved("sized_and_rated")
    stages = [
        {
            "module": f"{s['normal_module_mm']!r} mm",
            "pinion_teeth": s["pinion_teeth"],
            "wheel_teeth": s["wheel_teeth"],
            "face_width": f"{s['face_width_mm']!r} mm",
        }
        for s in result.design["stages"]
    ]
    tables = two_stages(stages[0], stages[1], gears={"helix_angle": "25 deg"})
    ours, theirs = (numbers_of(d) for d in (rated(tables), result.design["rating"]))
    assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-12)


@pytest.mark.slow
def test_the_best_number_of_stages_is_rated():
    """`stages` as a range, continuous sizes; the example's duty."""
    tables = {
        "gearopt": 1,
        "kind": "drive",
        "stages": [1, 2],
        "duty": {"power": "7.5 kW", "input_speed": "1450 rpm", "ratio": 8},
        "gears": {"face_width_over_diameter": 0.6, "treatment": "carburised"},
        "limits": {"preset": "chong-lee-elevator", "pinion_teeth": [20, 40]},
        "rating": {"life": "20000 h", "quality": 8},
    }
    result = gearopt.solve(tables)
    gears = result.design["rating"]["gears"]
    assert result.status == "optimal" and len(gears) == 2 * len(result.design["stages"])
    assert all(g["material"] == "carburised, grade 1" for g in gears)


def test_without_its_rating_a_sized_drive_is_the_same(solved):
    assert solved("sized_and_rated").value == solved("elevator").value


def test_numbers_of_a_rating_size_nothing_and_are_not_explained():
    from gearopt.scenes.drive.without import without

    scene = gearopt.load(PROBLEMS / "sized_and_rated.toml")
    keys = {n.key for n in numbers(without(scene, "rating"))}
    assert "duty.power" in keys and "gears.helix_angle" in keys
    assert not any("rating" in key or "treatment" in key or "load" in key for key in keys)


@pytest.mark.slow
def test_explain_of_a_sized_drive_lists_the_numbers_of_its_rating():
    one_stage = {"stage[2]": None, "duty.output_speed": "300 rpm"}
    found = gearopt.explain(PROBLEMS / "sized_and_rated.toml", one_stage)
    keys = {influence.key for influence in found.influences}
    assert "limits.k_factor" in keys
    assert {"rating.life", "rating.quality"} <= keys


@pytest.mark.slow
@pytest.mark.parametrize("power", ["20 kW", "400 kW"])
@pytest.mark.parametrize("file", ["pair_by_both", "two_stages_rated"])
def test_the_power_capacity_by_iso_6336_is_rated_at_that_power(file, power):
    """Its load factors depend on the load: rated at its capacity a stage is just safe."""
    changes = {"rating.standard": "both", "duty.power": power}
    if file == "two_stages_rated":
        changes |= {"rating.iso6336": {"accuracy_grade": 7}}
    path = PROBLEMS / f"{file}.toml"
    found = gearopt.rate(path, changes).design["rating"]["beside"]
    levels = gearopt.rate(path, changes).asked.get("load", [])
    capacity, least = found["power_capacity_kW"], found["minimum_bending_safety"]
    if levels:
        largest = max(float(level["power"].split()[0]) for level in levels)
        changes |= {
            f"load[{k}].power": f"{float(level['power'].split()[0]) * capacity / largest!r} kW"
            for k, level in enumerate(levels, 1)
        }
    again = gearopt.rate(path, changes | {"duty.power": f"{capacity!r} kW"})
    gears = again.design["rating"]["beside"]["gears"]
    used = [least / gear["bending_safety"] for gear in gears]
    used += [found["minimum_contact_safety"] / gear["contact_safety"] for gear in gears]
    assert max(used) == pytest.approx(1.0, abs=1e-9)
