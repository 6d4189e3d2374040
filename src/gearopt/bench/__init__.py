"""Speed against error: each module is a bench, `run(repeat) -> rows`; `gearopt bench NAME`."""

from pkgutil import iter_modules


def names() -> tuple[str, ...]:
    """Names of the benches: the modules of this folder."""
    return tuple(sorted(m.name for m in iter_modules(__path__)))
