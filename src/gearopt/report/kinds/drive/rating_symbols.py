"""Symbols of the standards: those of stresses, and factors as engineers write them, in Greek."""

import re

from gearopt.formulations.drive.rating import DriveRating

SHORT = {"AGMA": "AGMA", "ISO 6336": "ISO"}  # a standard in a column's head
SYMBOLS = {  # of stresses, by standard
    "AGMA": {
        "bending_stress_MPa": "s_t",
        "permissible_bending_stress_MPa": "s_t",
        "contact_stress_MPa": "s_c",
        "permissible_contact_stress_MPa": "s_c",
    },
    "ISO 6336": {
        "bending_stress_MPa": "sigma_F",
        "permissible_bending_stress_MPa": "sigma_FG",
        "contact_stress_MPa": "sigma_H",
        "permissible_contact_stress_MPa": "sigma_HG",
    },
}
WRITTEN = {  # symbols that differ from their letters
    "c_prime": "c'",
    "c_gamma_alpha": "c_γα",
    "c_gamma_beta": "c_γβ",
    "Z_BD": "Z_B, Z_D",
}
GREEK = {"alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "eps": "ε", "sigma": "σ"}
_SYMBOL = re.compile(r"\b[A-Za-z]{1,5}_\w+")  # a letter or its name, and an index
_NAME = re.compile("|".join(GREEK))
SHOWN_UNITS = {  # units of factors that are shown in others: deviations of flanks, stiffnesses
    **dict.fromkeys(("f_pb", "f_falpha", "f_ma", "C_a"), "um_or_uin"),
    **dict.fromkeys(("c_prime", "c_gamma_alpha", "c_gamma_beta"), "N_per_mm_um"),
}


def greek(text: str) -> str:
    """Return a text with its symbols as engineers write them: "K_Hbeta" as "K_Hβ"."""
    return _SYMBOL.sub(lambda found: _written(found[0]), text)


def _written(symbol: str) -> str:
    return WRITTEN.get(symbol) or _NAME.sub(lambda name: GREEK[name[0]], symbol)


def stress_words(found: DriveRating, key: str, words: str) -> str:
    """Return what a stress is called, with its symbol by every standard: "stress s_t, sigma_F"."""
    symbols = [SYMBOLS[one.by][key] for one in found.each if key in SYMBOLS[one.by]]
    return " ".join([words, ", ".join(symbols)]) if symbols else words


def of_standards(found: DriveRating, values: list[str], joint: str = ", ") -> str:
    """Return values, one by each standard, as words; a value alone without its standard."""
    if len(values) == 1:
        return values[0]
    pairs = zip(found.each, values, strict=True)
    return joint.join(f"{value} by {one.by}" for one, value in pairs)
