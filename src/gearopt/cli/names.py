"""Names that commands offer: kinds, methods, benches, files; for help and completion.

All is looked up when help or the Tab key asks for it, so that the start of a command pays nothing.
"""

import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

PROBLEMS, RESULTS = (".toml",), (".json",)  # endings of files
SYSTEMS = ("metric", "inch")


def kinds() -> dict[str, str]:
    """Return the kinds of problem file, each with what it is for."""
    from gearopt.scenes.reading.kinds import kinds
    from gearopt.scenes.reading.load import kind_named

    return {name: kind_named(name).example.about for name in kinds()}


def examples() -> dict[str, str]:
    """Return the problem files to start from, each with what it is for."""
    from gearopt.scenes.reading.load import kind_named

    known = kinds()
    listed = [kind_named(kind).examples for kind in known]
    return known | {name: each.about for of_kind in listed for name, each in of_kind.items()}


def benches() -> dict[str, str]:
    """Return the benches, each with what it measures."""
    from gearopt.bench import names

    return {name: _said(import_module(f"gearopt.bench.{name}").__doc__) for name in names()}


FOR_ANY_PROBLEM = "any problem that suits"


def methods() -> dict[str, tuple[str, ...]]:
    """Return the methods of `--method`: of each kind its own, and those for any problem."""
    from gearopt.scenes.reading.kinds import kinds
    from gearopt.scenes.reading.load import kind_named

    by_kind = {name: kind_named(name).methods for name in kinds()}
    return by_kind | {FOR_ANY_PROBLEM: back_ends()}


def back_ends() -> tuple[str, ...]:
    """Return the back ends for any problem: the modules of `optimise/solvers`."""
    import gearopt

    folder = Path(gearopt.__file__).parent / "optimise" / "solvers"
    return tuple(sorted(m.name for m in iter_modules([str(folder)])))


def _said(text: str | None, head: str = "") -> str:
    """Return the first sentence of a module's text, without its head."""
    words = " ".join((text or "").split("\n\n")[0].split())
    return re.sub(f"^{head}", "", words).removesuffix(".")


def filled(text: str) -> str:
    """Return a help text with the names that its {kinds}, {examples} ... stand for."""
    for place, names in (
        ("{kinds}", kinds),
        ("{examples}", examples),
        ("{benches}", benches),
    ):
        if place in text:
            listed = "; ".join(f"{name} ({words})" for name, words in names().items())
            text = text.replace(place, listed)
    return text.replace("{methods}", _methods()) if "{methods}" in text else text


def _methods() -> str:
    return "; ".join(f"{of}: {', '.join(names)}" for of, names in methods().items())


def kind_words(incomplete: str) -> list[tuple[str, str]]:
    """Return the kinds that begin with what is typed, with a word on each."""
    return _begun(kinds(), incomplete)


def example_words(incomplete: str) -> list[tuple[str, str]]:
    """Return the problem files to start from that begin with what is typed."""
    return _begun(examples(), incomplete)


def bench_words(incomplete: str) -> list[tuple[str, str]]:
    """Return the benches that begin with what is typed, with a word on each."""
    return _begun(benches(), incomplete)


def method_words(incomplete: str) -> list[tuple[str, str]]:
    """Return the methods that begin with what is typed, with the problems they are for."""
    problems_of: dict[str, list[str]] = {}
    for of, names in methods().items():
        for name in names:
            problems_of.setdefault(name, []).append(of)
    return _begun({name: ", ".join(of) for name, of in problems_of.items()}, incomplete)


def method_lists(incomplete: str) -> list[str]:
    """A list of methods as it is typed, with every name that its last may be."""
    head, comma, last = incomplete.rpartition(",")
    return [f"{head}{comma}{name}" for name, _ in method_words(last)]


def system_words(incomplete: str) -> list[str]:
    """Return the systems of units that begin with what is typed."""
    return [name for name in SYSTEMS if name.startswith(incomplete)]


def problem_files(incomplete: str) -> list[str]:
    """Return the problem files and folders that begin with what is typed."""
    return list(_files(incomplete, PROBLEMS))


def result_files(incomplete: str) -> list[str]:
    """Return the JSON files and folders that begin with what is typed."""
    return list(_files(incomplete, RESULTS))


def _begun(names: dict[str, str], incomplete: str) -> list[tuple[str, str]]:
    return [(name, words) for name, words in names.items() if name.startswith(incomplete)]


def _files(incomplete: str, endings: tuple[str, ...]) -> Iterator[str]:
    """Yield files of an ending and folders; of a single folder what is in it too, to go on."""
    head, _, tail = incomplete.rpartition("/")
    folder = Path(f"{head}/" if "/" in incomplete else ".").expanduser()
    shown = incomplete[: len(incomplete) - len(tail)]
    try:
        there = sorted(p for p in folder.iterdir() if p.name.startswith(tail))
    except OSError:
        return
    there = [p for p in there if not p.name.startswith(".") or tail.startswith(".")]
    folders = [p for p in there if p.is_dir()]
    files = [p for p in there if p.suffix.lower() in endings and not p.is_dir()]
    yield from (f"{shown}{p.name}" for p in files)
    yield from (f"{shown}{p.name}/" for p in folders)
    if len(folders) == 1 and not files:
        yield from _files(f"{shown}{folders[0].name}/", endings)


def fill(command: Any) -> None:
    """Fill the names into the help texts of a command and of those below it."""
    for each in (command, *getattr(command, "commands", {}).values()):
        for parameter in each.params:
            if text := getattr(parameter, "help", None):
                parameter.help = filled(text)
