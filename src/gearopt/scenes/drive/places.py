"""Places of the numbers of `Train.numbers` in a file of a drive."""

Keys = dict[str, str | tuple[str, ...]]
KEYS: Keys = {  # of those of the whole drive
    "speed": "duty.input_speed",
    **dict.fromkeys(("lowest_ratio", "highest_ratio"), "duty.ratio_tolerance"),
    "density": "objective.density",
    "bending_safety": "rating.minimum_bending_safety",
    "contact_safety": "rating.minimum_contact_safety",
}
RANGES = {  # stem of the two limits of a stage: the key of their range
    "width": "face_width_over_diameter",
    "module": "module",
    "pinion": "pinion_teeth",
    "wheel": "wheel_teeth",
    "ratio": "stage_ratio",
}
ENDS: dict[str, tuple[str, int | None]] = {
    **{f"{stem}_low": (key, 1) for stem, key in RANGES.items()},
    **{f"{stem}_high": (key, 2) for stem, key in RANGES.items()},
    "over_module_low": ("face_width_over_module", 1),
    "over_module_high": ("face_width_over_module", 2),
    "least_width": ("minimum_face_width", None),
    "wheel_diameter": ("wheel_diameter", None),
    "helix_cosine": ("helix_angle", None),
}
