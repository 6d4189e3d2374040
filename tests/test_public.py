"""The public names are those of `__all__`, each documented."""

import inspect
import subprocess
import sys

import pytest

import gearopt
from gearopt import api
from gearopt.optimise.result import Budget


def test_all_is_what_the_package_offers():
    assert gearopt.__all__ == sorted(gearopt.__all__) == dir(gearopt)
    assert gearopt.solve is api.solve and gearopt.Budget is Budget
    with pytest.raises(AttributeError, match="'gearopt' has no attribute 'nothing'"):
        gearopt.nothing  # noqa: B018


def test_a_name_is_imported_when_it_is_asked_for():
    """Before that Ctrl-C has nothing to interrupt."""
    code = (
        "import sys, gearopt, gearopt.__main__; print('numpy' in sys.modules)\n"
        "from gearopt import *; print(solve.__name__, Budget(1.0).seconds)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.split() == ["False", "solve", "1.0"] and done.stderr == ""


def test_public_names_are_documented():
    for name in gearopt.__all__:
        assert inspect.getdoc(getattr(gearopt, name)), name
