"""Terms of the field that no kind of problem file has: types of gears, checks, parts of machines.

Each is a sentence with the names it is looked for by: symbols of ISO and AGMA, words of programs
and German ones. They are compared as `plain` writes them.
"""

import re
from collections.abc import Mapping
from functools import cache

from gearopt.scenes.reading.kinds import kinds

GEARS: dict[str, str] = {  # types of gears: kinds that people ask for, and their keys
    "Ravigneaux sets and bevel differentials are": "ravigneaux differential differential_gear "
    "ausgleichsgetriebe",
    "worm gears are": "worm worms worm_gear worm_wheel worm_starts number_of_starts "
    "number_of_threads threads lead_angle diameter_quotient schnecke schneckenrad "
    "schneckengetriebe gangzahl globoid",
    "bevel and hypoid gears are": "bevel bevels bevel_gear bevel_gears spiral_bevel hypoid "
    "hypoid_offset shaft_angle cone_angle pitch_angle spiral_angle mean_spiral_angle "
    "cone_distance outer_cone_distance mitre miter kegelrad kegelraeder kegelradgetriebe spiroid "
    "zerol klingelnberg gleason",
    "crossed helical gears are": "crossed crossed_axes crossed_helical screw_gears skew_axes "
    "schraubrad schraubenrad schraubraeder",
    "face gears are": "face_gear face_gears crown_gear kronenrad kronrad",
    "herringbone and double helical gears are": "herringbone double_helical double_helix "
    "pfeilverzahnung doppelschraegverzahnung gap_width",
    "racks are": "rack racks rack_pinion rack_and_pinion rack_length rack_drive zahnstange "
    "zahnstangengetriebe",
    "cycloidal gears are": "cycloidal cycloid cyclo cycloidal_drive zykloide zykloidengetriebe "
    "exzentergetriebe eccentric_drive pin_wheel lobes",
    "gears other than involute ones are": "novikov wildhaber lantern non_circular "
    "noncircular elliptical_gears magnetic_gears",
    "splines and couplings are": "spline splines coupling_spline curvic hirth zahnwelle "
    "passverzahnung",
    "belts and chains are": "belt belts timing_belt v_belt chain chains sprocket roller_chain "
    "riemen kette",
    "friction drives are": "traction_drive friction_drive variator cvt",
}

CHECKS: dict[str, str] = {  # what is not computed of gears, by any kind
    "scuffing (ISO/TS 6336-20 and -21, AGMA 925) is not rated": "scuffing scuffing_safety "
    "minimum_scuffing_safety scuffing_safety_factor required_scuffing_safety scoring "
    "scoring_safety sb s_b_min s_int s_s_min s_intsmin s_intmin flash_temperature "
    "integral_temperature fzg fzg_stage fzg_load_stage scuffing_load_stage scuffing_temperature "
    "fressen fresssicherheit fresstragfaehigkeit",
    "micropitting (ISO/TS 6336-22) is not rated": "micropitting micro_pitting micropitting_safety "
    "minimum_micropitting_safety s_lambda s_lambda_min lambda_gfp film_thickness "
    "specific_film_thickness lambda_ratio graufleckigkeit grauflecken grey_staining",
    "flank fracture (ISO/TS 6336-4) is not rated": "flank_fracture tooth_flank_fracture tff "
    "minimum_flank_fracture_safety flankenbruch case_crushing",
    "wear of flanks is not rated": "wear wear_safety wear_coefficient minimum_wear_safety "
    "verschleiss verschleisssicherheit",
    "thermal ratings (ISO/TR 14179) are not computed": "thermal_rating thermal_power heat "
    "heat_dissipation cooling temperature_rise sump_temperature power_loss power_losses churning "
    "churning_loss housing_area waermeleistung thermische_grenzleistung verlustleistung",
    "lives of bearings are not computed": "bearing_life minimum_bearing_life l10 l10h l_10 l_10h "
    "dynamic_load_rating static_load_rating lagerlebensdauer",
    "deflections of shafts are not computed": "shaft_deflection maximum_deflection "
    "bending_of_shaft durchbiegung wellendurchbiegung",
    "keys, fits and other hubs of shafts are not computed": "keyway keyways shaft_key press_fit "
    "interference_fit shrink_fit shaft_hub_connection passfeder pressverband",
    "housings, seals and bolts are not computed": "casing seal seals bolts screws gehaeuse "
    "dichtung schrauben",
    "depths of cases are not checked": "case_depth effective_case_depth eht eht_depth chd cht",
    "sound is not computed": "noise_level sound sound_pressure sound_power acoustics schall "
    "schallpegel geraeusch",
}

OPTIONS = {  # of the command that solves a file: how it is given, and its names as a key
    "--method NAME": "method methods algorithm solver optimizer optimiser",
    "--seconds NUMBER": "time_limit timeout max_time maximum_time",
    "--units inch": "units unit_system units_system imperial",
}
SENTENCES = {f"{what} not supported": names for what, names in GEARS.items()} | CHECKS
OF_KINDS = re.compile(r"_?(gear|drive|train|set|stage|reducer|box|unit|pair)s?$")


def plain(name: str) -> str:
    """Return a name as the tables of terms are searched: lower case, ASCII, without separators."""
    letters = {"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "α": "alpha", "β": "beta"}
    lower = "".join(letters.get(c, c) for c in name[:80].lower())
    return re.sub(r"[^a-z0-9.]", "", lower)


def looked_up(table: Mapping[str, str], name: str) -> str | None:
    """Return the key of a table {key: names} whose names hold this one."""
    short = plain(name)
    return next((key for key, names in table.items() if short in map(plain, names.split())), None)


def absent(name: str) -> str | None:
    """Return that no kind has what a key or a table is called; None of any other name."""
    return looked_up(_without(kinds()), name)


@cache
def _without(there: tuple[str, ...]) -> dict[str, str]:
    """SENTENCES without those of gears that a kind, or a word of its name, is called by."""
    words = {word for kind in there for word in (kind, *kind.split("_"))}
    return {said: names for said, names in SENTENCES.items() if not {*names.split()} & words}


def option(name: str) -> str | None:
    """Return the option of the command that a key stands for; None of any other name."""
    return looked_up(OPTIONS, name)


def absent_kind(name: str) -> str | None:
    """Return that gearopt does not have the gears that a kind of file is called by."""
    words = [name, *re.findall(r"[^\W_]+", name)]
    stems = (OF_KINDS.sub("", word.lower()) for word in words)
    gears = {said: names for said, names in _without(kinds()).items() if said not in CHECKS}
    return next((said for word in (*words, *stems) if (said := looked_up(gears, word))), None)
