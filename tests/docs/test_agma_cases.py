"""Published ratings on the page are met, value by value, within the tolerance printed there."""

import agma_cases
import pytest

ROWS = [(case, row) for case in agma_cases.cases() for row in case.rows]


@pytest.mark.parametrize(
    ("case", "row"), ROWS, ids=[f"{case.title.split(':')[0]} {row.quantity}" for case, row in ROWS]
)
def test_a_published_value_is_met(case, row):
    assert len(row.printed) == len(row.computed)
    held = {"abs": row.within, "rel": 0.0} if row.within else {"rel": row.tolerance}
    assert row.computed == pytest.approx(row.printed, **held)
