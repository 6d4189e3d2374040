"""Random files of impossible rated drives, and every candidate of a drive rated alone."""

import math
from fractions import Fraction

import numpy as np

from gearopt.formulations.drive.teeth.columns import spans

WIDTHS = 40  # of a free face, between its ends
STEELS = (
    {"treatment": "carburised", "grade": 1, "iso_quality": "ML"},
    {"treatment": "carburised", "grade": 2, "iso_quality": "MQ"},
    {"treatment": "through-hardened", "hardness": "300 HB", "flank_hardness": "300 HV"},
)
SERIES = ("1 mm", "1.25 mm", "1.5 mm", "2 mm", "2.5 mm", "3 mm", "4 mm")


def some_file(seed):
    """Return the tables of a random drive of one or two stages, often impossible."""
    rng = np.random.default_rng(seed)
    count, standard = 1 + (seed % 8 == 7), str(rng.choice(["agma", "agma", "iso6336"]))
    low, begin = int(rng.integers(17, 26)), int(rng.integers(0, 4))
    steel = dict(STEELS[int(rng.integers(0, 3))])
    if standard == "agma":
        steel.pop("iso_quality", None), steel.pop("flank_hardness", None)
    else:
        steel.pop("grade", None), steel.pop("treatment"), steel.pop("hardness", None)
        steel["iso_material"] = "V alloy" if "flank_hardness" in steel else "Eh"
    stage = {}
    face = round(float(rng.uniform(0.3, 1.0)), 2)
    stage["face_width_over_diameter"] = face
    if rng.random() < 0.3:
        stage |= {"face_width_over_diameter": [round(0.6 * face, 2), face]}
        stage |= {"face_width_step": "2 mm"}
    limits = {"pinion_teeth": [low, low + int(rng.integers(1, 4))]}
    if rng.random() < 0.6:
        limits["module"] = [SERIES[begin], SERIES[begin + 2]]
    if rng.random() < 0.6 or "module" not in limits:
        limits["wheel_diameter"] = f"{int(rng.integers(60, 260))} mm"
    ratio = int(rng.integers(20, 50) if count == 1 else rng.integers(60, 140)) / 10
    rating = {"standard": standard, "life": f"{int(10 ** rng.uniform(2, 4.6))} h"}
    rating |= {"minimum_bending_safety": round(float(rng.uniform(1, 2)), 2)}
    rating |= {"minimum_contact_safety": round(float(rng.uniform(1, 1.5)), 2)}
    rating |= {"quality": 8} if standard == "agma" else {"iso6336": {"accuracy_grade": 7}}
    return {
        "gearopt": 1,
        "kind": "drive",
        "duty": {
            "power": f"{10 ** rng.uniform(0, 1.5):.3g} kW",
            "input_speed": f"{int(10 ** rng.uniform(2.2, 3.3))} rpm",
            "ratio": ratio,
        },
        "gears": steel | {"helix_angle": f"{int(rng.choice([0, 12, 20]))} deg"},
        "stage": [dict(stage) for _ in range(count)],
        "limits": limits,
        "teeth": {"modules": list(SERIES)},
        "rating": rating,
    }


def has_a_design(train):
    """Return whether some candidate meets all limits, each rated by the text of its option."""

    def onward(k, torque, reached):
        if k == len(train.stages):
            return train.lowest_ratio <= reached <= train.highest_ratio
        ratios = safe_ratios(train, k, torque, reached)
        return any(onward(k + 1, torque * float(u), reached * u) for u in ratios)

    return onward(0, train.torque, Fraction(1))


def safe_ratios(train, k, torque, reached):
    """Return the ratios of the pairs of a stage that some module and width make safe."""
    stage, last = train.stages[k], k == len(train.stages) - 1
    rows = []
    for z1, start, stop in spans(train, k, train.highest_ratio):
        for z2 in range(start, stop + 1):
            total = reached * Fraction(z2, z1)
            if total > train.highest_ratio or (last and total < train.lowest_ratio):
                continue
            if train.coprime and math.gcd(z1, z2) > 1:
                continue
            rows += [(z1, z2, float(m), b) for m in stage.modules for b in faces(stage, m, z1, z2)]
    if not rows:
        return []
    z1, z2, module, width = np.array(rows).T
    pair = train.pair(k, module, z1, z2, width)
    safe = np.zeros(len(rows), bool)
    for option in stage.options:
        used = option.utilisations(pair, torque, train.speed_at(torque), train.safety)
        safe |= np.max(list(used.values()), axis=0) <= 1.0 + 1e-11
    return {Fraction(int(a), int(b)) for a, b in zip(z2[safe], z1[safe], strict=True)}


def faces(stage, module, z1, z2):
    """Return the face widths of a pair to be tried; none where the wheel is too large."""
    face, cosine, m = stage.face_width, stage.toothing.cosine, float(module)
    if stage.wheel_diameter is not None and m * z2 / cosine > float(stage.wheel_diameter) + 1e-9:
        return []
    d = m * z1 / cosine
    if face.fixed is not None:
        return [float(face.fixed)]
    low, high = max(float(face.low) * d, float(face.least)), float(face.high) * d
    if face.step is not None:
        step = float(face.step)
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        return [step * n for n in range(max(1, first), last + 1)]
    if face.low == face.high:
        return [high]
    return list(np.geomspace(low, high, WIDTHS)) if low <= high else []
