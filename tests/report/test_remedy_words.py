"""Words for why a request is impossible."""

import pytest

from gearopt.report.explained import remedy_words


@pytest.mark.parametrize(
    ("conflict", "said"),
    [
        (["ratio_low"], "This limit cannot be kept, even if all others are dropped: ratio low"),
        (
            ["ratio_low", "wheel_diameter[1]"],
            "These cannot hold together, and none of them is to spare: ratio low",
        ),
    ],
)
def test_one_limit_is_not_told_as_several(conflict, said):
    why, rows, _ = remedy_words({"conflict": conflict, "remedies": [], "message": ""})
    assert why[0].startswith(said) and not rows
