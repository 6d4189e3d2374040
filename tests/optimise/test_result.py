"""Results go to JSON and back without loss, and hold no NaN."""

import json
import math

import numpy as np
import pytest

from gearopt.optimise.result import Result


def sample():
    part = Result("sizing", "optimal", "ipopt", {"name": "v", "value": 1.0, "unit": "mm3"})
    return Result(
        "drive",
        "optimal",
        "exact",
        {"name": "v", "value": 1.25, "unit": "mm3"},
        bound=1.25,
        gap=0.0,
        proof={"method": "exhausted", "nodes": 3},
        certificate={"feasibility": 0.0},
        design={"stages": [{"face_width_mm": 0.1}]},
        limits={"k[1]": 0.5},
        parts=(part,),
        seed=7,
    )


def test_round_trip():
    result = sample()
    again = Result.from_json(result.to_json())
    assert again == result
    assert again.parts[0].name == "sizing"


def test_keys_are_those_of_the_documented_object():
    wanted = {
        "result",
        "gearopt",
        "scene",
        "file",
        "file_sha256",
        "asked",
        "options",
        "method",
        "status",
        "objective",
        "bound",
        "gap",
        "proof",
        "certificate",
        "design",
        "limits",
        "multipliers",
        "report",
        "parts",
        "evaluations",
        "seconds",
        "seed",
        "versions",
        "name",
        "message",
    }
    assert set(sample().to_dict()) == wanted


def test_no_nan_no_numpy():
    odd = Result(
        "x",
        "failed",
        "ipopt",
        {"value": np.float64(2.0)},
        bound=math.inf,
        report={"a": np.array([1.0, math.nan])},
    )
    text = odd.to_json()
    assert json.loads(text)["bound"] is None
    assert json.loads(text)["report"]["a"] == [1.0, None]


def test_other_formats_are_refused():
    data = sample().to_dict()
    with pytest.raises(ValueError, match="format 2"):
        Result.from_dict(data | {"result": 2})
    with pytest.raises(ValueError, match="keys that no result has: extra"):
        Result.from_dict(data | {"extra": 1})
