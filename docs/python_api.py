"""The page docs/python.md: the names of `import gearopt`, from their own docstrings."""

import inspect
import re
import textwrap
from collections.abc import Iterator
from typing import Any

import gearopt

HEAD = """\
# Python

What `import gearopt` offers. The rest of the package is its inside, and may change. A file is
solved in three lines ([How to start](start.md#from-python)); a problem of your own takes
[a page](own_problem.md); the words are explained in [The contract](contract.md).
"""
GROUPS = {  # heading: names, in reading order
    "From a file to an answer": (
        *("solve", "rate", "explain", "pareto", "compare", "load", "export", "read_rexs"),
    ),
    "Answers": ("Result", "Explanation", "Front", "Comparison"),
    "Problems of your own": (
        "Problem",
        "Var",
        "Param",
        "Terms",
        "Repeat",
        "Conic",
        "evaluate",
        "Outcome",
    ),
    "Limits of a run, and its progress": ("Budget", "Event"),
    "Errors": ("GearoptError", "SceneError", "SolveError", "CertificateError"),
}


def page() -> str:
    """The page; ValueError names what is public and in no group."""
    named = [name for names in GROUPS.values() for name in names]
    if odd := sorted(set(named) ^ set(gearopt.__all__)):
        raise ValueError(f"GROUPS of docs/python_api.py and gearopt.__all__ differ: {odd}")
    parts = [HEAD]
    for heading, names in GROUPS.items():
        parts.append(f"## {heading}\n")
        parts += [_entry(name, getattr(gearopt, name)) for name in names]
    return "\n".join(parts)


def _entry(name: str, it: Any) -> str:
    doc = inspect.getdoc(it) or ""
    lines = [f"### {name}\n", f"```\n{_call(name, it)}\n```\n", f"{_prose(doc)}\n"]
    if members := list(_members(it)):
        lines += ["| member | what it is |", "|---|---|"]
        lines += [f"| `{member}` | {words} |" for member, words in members]
        lines.append("")
    return "\n".join(lines)


def _call(name: str, it: Any) -> str:
    """How it is called or made: names and defaults, without types, which the words tell."""
    if inspect.isclass(it) and issubclass(it, Exception):
        return f"except gearopt.{name}"
    signature = inspect.signature(it)
    plain = [p.replace(annotation=p.empty) for p in signature.parameters.values()]
    bare = signature.replace(parameters=plain, return_annotation=signature.empty)
    words = f"gearopt.{name}{bare}".replace("<factory>", "...")
    return textwrap.fill(words, 88, subsequent_indent="    ", break_on_hyphens=False)


def _members(it: Any) -> Iterator[tuple[str, str]]:
    """Public methods and properties with the first sentence of their docstrings."""
    if not inspect.isclass(it):
        return
    for name, member in vars(it).items():
        plain = member.__func__ if isinstance(member, classmethod | staticmethod) else member
        doc = inspect.getdoc(plain)
        if name.startswith("_") or not doc or not (callable(plain) or isinstance(plain, property)):
            continue
        words = " ".join(doc.split("\n\n")[0].split()).replace("|", "\\|")
        yield (name if isinstance(plain, property) else f"{name}()"), words


def _prose(doc: str) -> str:
    """A docstring as Markdown: outside code, stars and angle brackets mean themselves."""
    parts = doc.split("`")
    parts[::2] = [re.sub(r"(\*|<(?=\w))", r"\\\1", part) for part in parts[::2]]
    return "`".join(parts)
