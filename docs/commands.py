"""What `--help` says of every command, as the page docs/commands.md."""

import inspect
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from typer.models import ArgumentInfo, OptionInfo

from gearopt.cli import app
from gearopt.cli.names import filled

HEAD = """\
# Commands

What `gearopt --help` and `gearopt COMMAND --help` print, on one page. `gearopt --version` prints
the version; `python -m gearopt` is the same as `gearopt`. `gearopt --install-completion` makes the
Tab key complete commands, options, problem files, kinds, methods and benches in bash, zsh, fish and
PowerShell, from the next shell on; `--show-completion` prints what it would install.
"""
EXIT_CODES = {
    0: "done: a design was found (its status says how good it is), gears were rated, safe or not; "
    "the files are right",
    1: "`doctor`: a solver does not work on this machine",
    2: "the file or the command is wrong; a line for every mistake says where and what to write",
    3: "proven: no design meets the limits; or a given design, evaluated, exceeds one, or its "
    "gears do not fit",
    4: "nothing found within the time",
    130: "interrupted: there was nothing to keep, a step did not end, or by a second Ctrl-C",
}
KINDS: dict[Any, str] = {int: "N", float: "NUMBER", str: "TEXT", Path: "FILE"}


@dataclass(frozen=True)
class Word:
    """An argument or an option: as one writes it, its default, what it means."""

    name: str
    default: str
    meaning: str
    option: bool


def page() -> str:
    """Every command with its arguments, options and defaults, then the exit codes, in Markdown."""
    commands = [c for c in app.registered_commands if not c.hidden and c.callback is not None]
    named = [(c.name or c.callback.__name__, c.callback) for c in commands if c.callback]
    lines = ["| command | what it does |", "|---|---|"]
    lines += [f"| [`gearopt {n}`](#gearopt-{n}) | {_doc(call)} |" for n, call in named]
    parts = [HEAD, "\n".join(lines) + "\n", *(_command(n, call) for n, call in named)]
    codes = ["## Exit codes\n", "| code | means |", "|---|---|"]
    codes += [f"| {code} | {words} |" for code, words in EXIT_CODES.items()]
    return "\n".join([*parts, "\n".join(codes), ""])


def _command(name: str, call: Callable[..., Any]) -> str:
    words = list(_words(call))
    given = [w.name for w in words if not w.option]
    asked = ["[OPTIONS]"] if any(w.option for w in words) else []
    usage = " ".join(["gearopt", name, *asked, *given])
    lines = [f"## gearopt {name}\n", f"{_doc(call)}\n", f"```\n{usage}\n```\n"]
    if words:
        lines += ["| argument or option | default | meaning |", "|---|---|---|"]
        lines += [f"| `{w.name}` | {w.default} | {w.meaning} |" for w in words]
    return "\n".join(lines) + "\n"


def _words(call: Callable[..., Any]) -> Iterator[Word]:
    """The arguments and options of a command, read from its signature."""
    hints = get_type_hints(call, include_extras=True)
    for name, parameter in inspect.signature(call).parameters.items():
        hint = hints[name]
        if get_origin(hint) is not Annotated:
            raise TypeError(f"{name} of {call.__name__} says nothing of itself")
        kind, info = get_args(hint)[:2]
        if not info.hidden:
            yield _word(name, kind, info, parameter.default)


def _word(name: str, kind: Any, info: ArgumentInfo | OptionInfo, default: Any) -> Word:
    needed = default is inspect.Parameter.empty
    shown = "needed" if needed else ""
    if not needed and default is not None and default is not False:
        plain = default.value if isinstance(default, Enum) else default
        shown = f"`{plain:g}`" if isinstance(plain, float) else f"`{plain}`"
    meaning = _plain(filled(info.help or "")) + _range(info)
    if isinstance(info, ArgumentInfo):
        many = "..." if get_origin(kind) is list else ""
        value = name.upper().removesuffix("S" if many else "") + many
        return Word(value if needed else f"[{value}]", shown, meaning, False)
    spelt = [info.default] if isinstance(info.default, str) else []  # typer keeps the first there
    spelt += info.param_decls or ()
    written = ", ".join(spelt or [f"--{name.replace('_', '-')}"])
    return Word(f"{written}{_value(kind)}", shown, meaning, True)


def _value(kind: Any) -> str:
    """What follows an option of a type: nothing, one of some words, or what kind of text."""
    if get_origin(kind) is Literal:
        return " " + "/".join(map(str, get_args(kind)))
    if inner := [k for k in get_args(kind) if k is not NoneType]:
        return _value(inner[0])
    if issubclass(kind, Enum):
        return " " + "/".join(str(member.value) for member in kind)
    return "" if kind is bool else f" {KINDS[kind]}"


def _range(info: ArgumentInfo | OptionInfo) -> str:
    low, high = info.min, info.max
    if low is None and high is None:
        return ""
    if high is None:
        return f" At least {low:g}."
    return f" From {low:g} to {high:g}." if low is not None else f" At most {high:g}."


def _doc(call: Callable[..., Any]) -> str:
    return _plain(" ".join((call.__doc__ or "").split()))


def _plain(words: str) -> str:
    """A help text as Markdown: no escapes of the terminal, pages as links, no broken table."""
    words = words.replace("\\[", "[").replace("|", "\\|")
    return re.sub(r"docs/(\w+\.md)", r"[\1](\1)", words)
