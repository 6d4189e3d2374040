"""The words of a run that is under way."""

import pytest

from gearopt.cli.watching import progress
from gearopt.optimise.result import Event


@pytest.mark.parametrize(
    ("event", "said"),
    [
        (Event(1.0, 1200), "1,200 evaluations, 9 s left"),
        (Event(1.0, 0, part="other numbers"), "other numbers: 0 evaluations, 9 s left"),
        (
            Event(1.0, 20, 25455260.4, 25000000.0, "layout", "box_volume", "mm3"),
            "layout: 20 evaluations, best 25,455,260.4 mm³, gap 1.8 %, 9 s left",
        ),
        (
            Event(1.0, 20, 12.5, None, "teeth", "mass", "kg"),
            "teeth: 20 evaluations, best 12.5 kg, 9 s left",
        ),
        (
            Event(1.0, 20, None, 12.5, "teeth", "mass", "kg"),
            "teeth: 20 evaluations, bound 12.5 kg, 9 s left",
        ),
        (
            Event(1.0, 20, 5.0899e-07, 5e-07, "train", "inertia", "kg_m2"),
            "train: 20 evaluations, best 5.0899 g cm², gap 1.8 %, 9 s left",
        ),
        (Event(1.0, 20, 0.0, 0.0), "20 evaluations, best 0, gap 0 %, 9 s left"),
        (Event(1.0, 20, -4.0, -5.0), "20 evaluations, best -4, gap 25 %, 9 s left"),
    ],
)
def test_progress_names_part_value_and_unit(event, said):
    assert progress(event, 9.2) == said
