"""Pages of these tests hold a word in place of the library that draws their figures."""

import pytest

from gearopt.report.pages import frame


@pytest.fixture(autouse=True, scope="module")
def short_pages(request):
    """4.8 MB less to write and to read on every page; test_compare_page has the library itself."""
    if request.module.__name__ == "test_compare_page":
        yield
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(frame, "plots_script", lambda: "/* plotly.js */")
        yield
