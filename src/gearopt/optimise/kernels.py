"""Compiled kernels: numba modules `*_kernel.py`, whose machine code is kept between runs."""

import hashlib
import logging
import os
from functools import cache
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

logger = logging.getLogger("gearopt.kernels")
_SOURCES = Path(__file__).parents[1]


@cache
def kernel(module: str) -> ModuleType:
    """Import a kernel module by its full name; its first use on a machine compiles it.

    numba would keep the code beside the source and look at that file alone, so that a change in a
    kernel that another one calls went unnoticed. Here the folder's name holds a hash of all kernels
    and numba's version. NUMBA_CACHE_DIR, where the user sets it, is the place of these folders.
    """
    import numba

    folder = _folder() / _key()
    numba.config.CACHE_DIR = str(folder)
    if not any(folder.rglob(f"{module.rsplit('.', 1)[-1]}.*.nbi")):
        words = "compiling kernels, once on this machine: this may take a minute"
        logger.info("%s (Ctrl-C twice ends it)", words)
    return import_module(module)


@cache
def _folder() -> Path:
    from platformdirs import user_cache_path

    chosen = os.environ.get("NUMBA_CACHE_DIR")
    return Path(chosen) if chosen else user_cache_path("gearopt") / "numba"


@cache
def _key() -> str:
    """Return A name that changes with the text of any kernel and with numba's version."""
    text = hashlib.sha256(version("numba").encode())
    for path in sorted(_SOURCES.rglob("*_kernel.py")):
        text.update(path.name.encode() + path.read_bytes())
    return text.hexdigest()[:16]
