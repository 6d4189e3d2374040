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
    "over_module": "face_width_over_module",
}
ENDS_OF = (1, "low"), (2, "high")
ENDS: dict[str, tuple[str, int | None]] = {
    **{f"{stem}_{end}": (key, k) for k, end in ENDS_OF for stem, key in RANGES.items()},
    "least_width": ("minimum_face_width", None),
    "wheel_diameter": ("wheel_diameter", None),
    "helix_cosine": ("helix_angle", None),
}
