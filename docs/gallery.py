"""The gallery: every file of problems/ with what it shows and the answer the tests hold it to.

A new file needs a line in GROUPS; title, source, kind and answer come from the file itself.
"""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pictures import FRONTS, PICTURES, ROOM

from gearopt.api import load
from gearopt.report.measures import METRIC
from gearopt.report.words import VERDICTS

PROBLEMS = Path(__file__).parents[1] / "problems"
HEAD = """\
# Gallery

Every file of `problems/`, with the answer that the tests hold it to. Each is a start for a file of
your own: copy it, change its numbers, solve it. With `--html page.html` the answer comes as a page;
of a gearbox or a packing it holds drawings like those below.
"""
GROUPS = {  # heading: {file: what it shows, in a line}
    "Sizing a drive": {
        "elevator": "Teeth, modules and face widths of minimum gear volume, proven.",
        "three_stage": "One stage more.",
        "elevator_both_series": "Modules of both series of ISO 54, not of the first alone.",
        "three_stage_both_series": "Here the second series brings nothing.",
        "elevator_coprime": "Hunting teeth, `coprime = true`: the best train has them already.",
        "three_stage_coprime": "Here hunting teeth cost a little volume.",
    },
    "Rating gears": {
        "catalogue_pair": "A carburised pair with profile shift and backlash: safety, forces, "
        "efficiency, tooth geometry.",
        "two_stages_rated": "Two helical stages under a load spectrum, `[[load]]`.",
        "elevator_by_agma": "Sized by the safety factors of AGMA 2001: `[rating]` as the limit.",
        "three_stage_by_agma": "One stage more.",
        "elevator_by_both": "The same by AGMA and by ISO 6336, grade 8, helix uncorrected.",
        "three_stage_by_both": "Three stages by both standards.",
        "wind_pair_sized": "The pair of `wind_pair`, its teeth, module and width chosen.",
        "servo_pair_by_agma": "A pair of 50 W.",
        "idler": "A pinion, an idler and a wheel: the idler's teeth are chosen, too, proven.",
        "planetary_stage": "Sun, planets and ring: teeth, number of planets, module and width.",
        "planetary_or_parallel": "`type` is a list: every choice is sized, the best found.",
        "planetary_gearhead": "100:1 in two planetary stages.",
        "wind_gearbox": "5 MW: two planetary stages and a parallel one, increasing the speed.",
        "wind_planetary_stage": "A planetary stage as a report has it, rated mesh by mesh.",
        "planets_that_do_not_fit": "Five planets that have no room: impossible, and why.",
        "unit_15_kw": "A helical unit, whose slow stage two other files take.",
        "helical_unit": "A unit as of catalogues: hunting teeth, whole widths, both standards.",
        "given_distance": "Teeth, module and shifts chosen for a housing of 125 mm, proven.",
        "preferred_distance": "A distance of the series R20 and a helix angle chosen, too.",
        "unit_of_r20": "Two stages whose centre distances are preferred numbers.",
        "coaxial_unit": "The same, the output in line with the input: `coaxial = true`.",
        "iso_tr_6336_30_at_distance": "The pair of `iso_tr_6336_30` chosen anew at its distance.",
        "wind_pair_at_distance": "The pair of `wind_pair` chosen anew at its centre distance.",
        "minimum_volume_pair": "A spur pair of minimum volume, as a paper has it, proven.",
        "materials_by_cost": "Materials chosen of a list, `[[material]]`, at least cost.",
        "cutting_by_cost": "Cost of material, heat treatment and cutting, split by gear.",
        "light_wheels": "Least mass with rims, webs and hubs, which the rating knows, too.",
        "same_materials": "The same with one for all pinions and one for all wheels.",
        "sized_and_rated": "Sized by load limits and ratings; here the load limits bind.",
        "shigley_14_4": "A textbook's pair, met factor by factor; its I and J given.",
        "shigley_14_4_by_908": "The same with I and J by AGMA 908: the contact stress is higher.",
        "shigley_14_5": "A textbook's helical pair; its I and J given.",
        "shigley_14_5_by_908": "The same with I and J by AGMA 908.",
        "pair_by_both": "One pair by AGMA and by ISO 6336, side by side.",
        "iso_tr_6336_30": "The example of ISO/TR 6336-30, pitting met to every printed digit.",
        "wind_pair": "A pair of a wind turbine beside the report of another program, ISO 6336.",
    },
    "Inches": {
        "inch_drive": "Diametral pitches, horsepower and psi; shown by `--units inch`.",
    },
    "The paper's processes": {
        "elevator_processes": "The rules of a paper beside the optimum, `[process_one]` and "
        "`[process_two]`.",
        "elevator_processes_rated": "The same beside a table `[rating]`: rule and optimum are both "
        "rated.",
        "three_stage_processes": "The rules for three stages, widths of the paper's table.",
    },
    "Ratio and widths": {
        "elevator_fine_ratio": "A tolerance of the ratio ten times finer.",
        "elevator_fine_ratio_coprime": "The same with hunting teeth.",
        "three_stage_fine_ratio": "With three stages a fine ratio costs less.",
        "three_stage_fine_ratio_coprime": "The same with hunting teeth.",
        "elevator_exact_ratio": "Real-valued sizes (no `[teeth]`), the ratio met exactly.",
        "three_stage_exact_ratio": "The same for three stages.",
        "elevator_free_width": "`face_width_over_diameter` as a range: widths are chosen too.",
        "three_stage_free_width": "The same for three stages.",
        "three_stages_ratio_cap": "A limit on the ratio of every stage, `stage_ratio`.",
    },
    "Long trains": {
        "four_stages": "300:1, proven like the short ones.",
        "five_stages": "1000:1.",
        "six_stages": "3000:1, the most stages a drive may have.",
        "how_many_stages": "`stages = [1, 5]`: the best number of stages, with a table of each.",
        "five_stages_continuous": "1000:1 with real-valued sizes and an exact ratio.",
    },
    "Impossible requests": {
        "elevator_small_wheels": "Wheels are too small for the load: what to write instead.",
        "elevator_by_agma_small_wheels": "Too small for safe gears: the conflict, and remedies.",
        "three_stage_small_wheels": "Modules too large for the wheels allowed.",
        "thousand_in_two_stages": "1000:1 does not go into two stages of at most 10.",
    },
    "The box around a drive": {
        "planetary_box": "A planetary stage, a disc with both shafts in one line, and two pairs.",
        "elevator_box": "Shafts placed past a motor, a floor, a ceiling and a brake.",
        "table4_process_one_layout": "Gears all given, only laid out; beside the box of a paper.",
        "four_stage_box": "A slab for each stage, and an output shaft level with the input.",
    },
    "Gears and box at once": {
        "three_stage_together": "Teeth, modules and places together make a smaller box.",
        "elevator_box_rated": "Two stages, limited by the safety factors of AGMA 2001.",
        "unit_in_box": "Two stages whose centre distances are preferred numbers, by ISO 6336.",
    },
    "How the teeth of a pair share the load": {
        "reference_pair": "Load shares, stiffness and transmission error of given gears.",
        "shifted_pair": "The same with profile shifts, in plane stress.",
        "pair_from_duty": "Duty and steel alone: sized by AGMA 2001, then its contact.",
        "unit_15_kw_pair": "Another file's second stage; contact over its flanks.",
        "relief_two_loads": "The tip relief of least transmission error at two loads, proven.",
        "paper_program": "Duty in, relieved gears out: sized by AGMA 2001, then the relief.",
        "undercut_pair": "Eight teeth: what undercut leaves of the path of contact.",
        "almost_two_pairs": "A contact ratio of 1.999, which a uniform grid takes for two.",
        "helical_pair": "A helical pair out of line: load and pressure over the flank.",
    },
    "Strain wave gearing": {
        "strain_wave_base": "Teeth in contact, loads, stress against profile shift, cutter.",
        "strain_wave_from_duty": "80:1, 100 N m, 90 mm: all else chosen, free of interference.",
        "strain_wave_interferes": "Teeth that cut each other as they disengage; a cutter's cusp.",
        "strain_wave_modified_involute": "Relieved involutes, cut by a straight-sided hob.",
        "strain_wave_discs": "Two discs as wave generator instead of cos 2 phi.",
        "strain_wave_320": "320:1 with an elastic rim.",
        "strain_wave_double_arc": "Double circular arcs: many teeth touch, and press harder.",
        "strain_wave_half_locus": "Teeth by half the locus of their motion: a third of all touch.",
    },
    "The motion of a spur pair": {
        "soft_bearings": "Soft bearings: how far the axes give way, and the motion from rest.",
        "soft_bearings_as_printed": "The kinematics of a paper, which are not those of involutes.",
        "unstable_speed": "A map of stability, and a motion that grows without end.",
        "unit_15_kw_dynamics": "The same pair on bearings: all but these follows.",
        "teeth_as_springs": "Stiffness by the teeth of a file of kind pair; motions over speed.",
        "driven_by_transmission_error": "Kahraman and Singh's oscillator: teeth part, loads, K_v.",
        "least_vibration": "Bearings, contact ratio, ramp, face width and rim of least vibration.",
        "least_vibration_parting": "The same of teeth that part and meet, by direct collocation.",
    },
    "Packing of cylinders": {
        "six_cylinders": "Three large and three small ones; the number of layers is chosen too.",
        "six_cylinders_one_layer": "In one layer, which is the best found of all.",
        "six_cylinders_two_layers": "In just two layers, proven.",
        "six_cylinders_three_layers": "In just three layers, proven.",
        "six_cylinders_row": "Some cylinders fixed by `at`: the large ones in a row.",
        "six_cylinders_triangle": "The large ones fixed in a triangle.",
        "six_cylinders_row_two_layers": "The row, and a second layer above it.",
        "seven_points": "Equal circles in a square: points as far apart as they can be.",
    },
    "A servo axis": {
        "servo_gimbal": "Ratio, teeth, stiffness, box and tolerances of a paper's gimbal drive.",
        "servo_axis": "A turntable on a motor of a data sheet, every table in use.",
        "servo_gimbal_ratio": "The best ratio with friction, and how little 48 loses.",
        "servo_gimbal_move": "A move from rest to rest, at the motor's speed limit.",
        "servo_gimbal_fast": "Ratio and train together for maximum acceleration; no errors "
        "and no shaft asked for.",
        "servo_gimbal_quick": "Ratio and train together for the quickest move, accurate enough.",
        "servo_gimbal_swing": "A sine at minimum rms torque.",
        "servo_gimbal_light": "Minimum mass instead of minimum inertia.",
        "servo_gimbal_backlash": "Two-sided allowances, and a minimum backlash in both stages.",
        "servo_gimbal_fine": "Only trains that fit the box are chosen.",
        "servo_gimbal_stiff": "Stiff enough for 200 Hz; real-valued sizes beside whole teeth.",
        "servo_gimbal_tolerances": "Given gears: the same error for 29 % less cost.",
        "servo_gimbal_trade_off": "What less error costs: `gearopt pareto`, cost against error.",
        "servo_gimbal_costs": "The same with costs that grow differently.",
        "servo_gimbal_grades": "The same by choice among nine grades.",
        "servo_planetary": "A planetary gearhead: inertia, losses, stiffness, lost motion.",
        "servo_gimbal_impossible": "No train is so accurate: what to write instead.",
    },
    "A compound train": {
        "sandgren_train": "Four numbers of teeth nearest to 1/6.931, proven in rationals.",
    },
    "Planetary trains": {
        "epicyclic_wolfrom": "A 3K train: speeds, torques, rolling power, efficiency.",
        "epicyclic_stepped": "Stepped planets, which fit by their greatest common divisor.",
        "epicyclic_coupled": "Two sets with joined members, as in a gearbox that is shifted.",
        "epicyclic_impossible": "Too many planets: what to write instead.",
    },
}
KINDS = {  # of a file: the page about it, and what is minimised
    "drive": ("drive.md", lambda file: _of_drive(file)),
    "packing": ("packing.md", lambda file: file.get("objective", {}).get("minimise", "volume")),
    "compound": ("compound.md", lambda file: file["train"].get("minimise", "ratio_error")),
    "epicyclic": (
        "epicyclic.md",
        lambda file: file.get("objective", {}).get("minimise", "ratio_error"),
    ),
    "servo": ("servo.md", lambda file: _of_servo(file)),
    "pair": ("pair.md", lambda file: _of_pair(file)),
    "strain_wave": ("strain_wave.md", lambda file: "pressure"),
    "dynamics": ("dynamics.md", lambda file: file["optimise"].get("minimise", "rms")),
}
UNITS = {  # as keys of a result have them
    "gear_volume": "mm3",
    "box_volume": "mm3",
    "volume": "mm3",
    "area": "mm2",
    "squared_error": "",
    "ratio_error": "",
    "loss": "",
    "ring_teeth": "",
    "pressure": "MPa",
    "inertia": "kg_m2",
    "mass": "kg",
    "error": "deg",
    "inverse_acceleration": "",
    "move_time": "s",
    "peak_to_peak": "um_or_uin",
    "rms": "um_or_uin",
    "rms_torque": "Nm",
    "cost": "",
    "axial_force": "N",
    "specific_sliding": "",
    "inverse_contact_ratio": "",
}


def page() -> str:
    """The page; ValueError names a file without a line in GROUPS, and a line without a file."""
    named = [name for files in GROUPS.values() for name in files]
    there = sorted(path.stem for path in PROBLEMS.glob("*.toml"))
    if sorted(named) != there:
        odd = sorted(set(named) ^ set(there)) or "a file is named twice"
        raise ValueError(f"GROUPS of docs/gallery.py and problems/ differ: {odd}")
    parts = [HEAD]
    for heading, files in GROUPS.items():
        parts.append(f"## {heading}\n")
        parts += [_entry(name, words) for name, words in files.items()]
    return "\n".join(parts)


def objective(file: Mapping[str, Any]) -> tuple[str, str]:
    """What a file minimises, as results name it, and the unit."""
    if file["kind"] not in KINDS:
        raise ValueError(f"KINDS of docs/gallery.py does not know the kind {file['kind']}")
    name = KINDS[file["kind"]][1](file)
    if name not in UNITS:
        raise ValueError(f"UNITS of docs/gallery.py does not know the objective {name}")
    return name, UNITS[name]


def _of_drive(file: Mapping[str, Any]) -> str:
    found: str = file.get("objective", {}).get("minimise", "gear_volume")
    if "layout" in file:
        found = file["layout"].get("minimise", "box_volume")
    return found


def _of_pair(file: Mapping[str, Any]) -> str:
    relief = file.get("relief")
    return "gear_volume" if relief is None else str(relief.get("minimise", "peak_to_peak"))


def _of_servo(file: Mapping[str, Any]) -> str:
    if "train" in file:
        train: dict[str, str] = file["train"]
        return "inverse_acceleration" if "maximise" in train else train.get("minimise", "inertia")
    if "duty" not in file:
        return "cost"
    names = {"move": "move_time", "swing": "rms_torque"}
    return names.get(file["duty"].get("motion", "acceleration"), "inverse_acceleration")


def _entry(name: str, words: str) -> str:
    file = tomllib.loads((PROBLEMS / f"{name}.toml").read_text(encoding="utf-8"))
    lines = [f"### {file['title']}\n"]
    if name in PICTURES:
        views = "views" if len(PICTURES[name].drawings) > 1 else "view"
        lines.append(f"![{file['title']}: {views} to scale]({ROOM.name}/{name}.svg)\n")
    for front in (one for one, it in FRONTS.items() if it.file == name):
        lines.append(f"![{file['title']}: a Pareto front]({ROOM.name}/{front}.svg)\n")
        traded = f"gearopt pareto problems/{name}.toml --objectives {FRONTS[front].objectives}"
        words = f"{words} The picture shows the Pareto front, by `{traded}`: "
        words += "[Trade-offs](trade_offs.md)."
    lines += [
        f"{words}\n",
        f"```\ngearopt {_command(file)} problems/{name}.toml\n```\n",
        f"- Answer: {_answer(file)}",
        f"- File: [{name}.toml](../problems/{name}.toml), kind "
        f"[{file['kind']}]({KINDS[file['kind']][0]})",
        f"- Source: {file['source']}\n",
    ]
    return "\n".join(lines)


def _command(file: Mapping[str, Any]) -> str:
    return "rate" if "governs" in file["x-expected"] and _given(file) else "solve"


def _given(file: Mapping[str, Any]) -> bool:
    return bool(file["x-expected"]["status"] == "evaluated")


def _answer(file: Mapping[str, Any]) -> str:
    """The file's own [x-expected] in words."""
    expected = file["x-expected"]
    if _given(file):
        if file["kind"] == "dynamics":
            return ", ".join(_moved(expected))
        return ", ".join(_rated(expected) if "governs" in expected else _contact(expected))
    words = "least for these gears, sized first" if _of_gears_first(file) else ""
    parts = [f"**{words or VERDICTS[expected['status']][0]}**"]
    name, unit = objective(file)
    if "objective" in expected:
        value = expected["objective"]
        if name == "inverse_acceleration":  # as reports tell it
            name, unit, value = "acceleration", "rad_per_s2", 1.0 / value
        parts.append(f"{name.replace('_', ' ')} {METRIC.amount(value, unit)}")
    if "gap" in expected:
        parts.append(f"gap at most {100 * expected['gap']:g} %")
    if "sizing" in expected:
        value = METRIC.amount(expected["sizing"], unit)
        parts.append(f"with real-valued teeth and modules {value}")
    if "bound" in expected and expected["status"] == "feasible":
        parts.append(f"lower bound {METRIC.amount(expected['bound'], unit, -1)}")
    if "least_factor" in expected:
        parts.append(f"limits must move by a factor of at least {expected['least_factor']:g}")
    rated = _rated(expected) if "governs" in expected else []
    return ", ".join(parts + rated)


def _of_gears_first(file: Mapping[str, Any]) -> bool:
    """Return whether a file asks for the box of gears that are sized before it."""
    return "layout" in file and not file["layout"].get("together") and not load(file).given


def _contact(expected: Mapping[str, Any]) -> list[str]:
    """What a file expects of the contact of a pair, in words."""
    if "pairs_in_contact" in expected:
        return _wave(expected)
    parts = [f"**evaluated**, contact ratio {expected['contact_ratio']:.4g}"]
    if "peak_to_peak_um" in expected:
        parts.append(f"transmission error {expected['peak_to_peak_um']:.3g} µm peak to peak")
    return parts


def _wave(expected: Mapping[str, Any]) -> list[str]:
    """What a file expects of a strain wave gearing, in words."""
    parts = [f"**evaluated**, {expected['pairs_in_contact']:g} conjugate pairs per lobe and flank"]
    if "shared_pressure_MPa" in expected:
        parts.append(f"pressure {expected['shared_pressure_MPa']:g} MPa")
    if "least_clearance_um" in expected:
        parts.append(f"teeth cut each other by {-expected['least_clearance_um']:g} µm")
    return parts


def _moved(expected: Mapping[str, Any]) -> list[str]:
    """What a file expects of the motion of a pair, in words."""
    parts = ["**evaluated**"]
    if "centre_distance_growth_mm" in expected:
        parts.append(f"axes apart by {expected['centre_distance_growth_mm']:.3g} mm")
    if "unstable_percent" in expected:
        parts.append(f"{expected['unstable_percent']:.4g} % of the map is unstable")
    if "frequencies_Hz" in expected:
        parts.append(f"mesh mode at {expected['frequencies_Hz'][-1]:,.0f} Hz")
    if "normal_load_N" in expected:
        parts.append(f"normal load {expected['normal_load_N']:,.0f} N")
    return parts


def _near(expected: Mapping[str, Any]) -> str:
    if "tolerance" in expected:
        return f"{expected['tolerance']:.1%}"
    most = max(expected.get("within", {}).values(), default=0.0)
    stresses = f", or {most:.1%} where more digits count" if most else ""
    return f"{expected['digits']} of the last digit{stresses}"


def _rated(expected: Mapping[str, Any]) -> list[str]:
    """What a file expects of a rating, in words."""
    words = "**rated: safe**" if expected["safe"] else "**rated: not safe**"
    parts = [words, f"governed by {expected['governs']}"]
    if "power_capacity_kW" in expected:
        parts.append(f"power capacity {expected['power_capacity_kW']:g} kW")
    if "printed" in expected:
        parts.append(f"{len(expected['printed'])} quantities met within {_near(expected)}")
    return parts
