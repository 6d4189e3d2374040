"""The public names are those of `__all__`, each documented."""

import inspect
import types

import gearopt


def test_all_is_what_the_package_offers():
    offered = {
        name
        for name, value in vars(gearopt).items()
        if not name.startswith("_") and not isinstance(value, types.ModuleType)
    }
    assert offered == set(gearopt.__all__)
    assert gearopt.__all__ == sorted(gearopt.__all__)


def test_public_names_are_documented():
    for name in gearopt.__all__:
        assert inspect.getdoc(getattr(gearopt, name)), name
