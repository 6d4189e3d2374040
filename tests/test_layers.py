"""Who may import whom, read from the source by ast (docs/contract.md has the table)."""

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

SRC = Path(__file__).parents[1] / "src" / "gearopt"

INSIDE = {
    "physics": {"physics"},
    "optimise": {"optimise", "errors"},
    "formulations": {"physics", "optimise", "formulations", "errors"},
    "scenes": {"formulations", "physics", "optimise", "scenes", "units", "errors"},
    "report": {"physics", "formulations", "optimise", "scenes", "report", "units", "errors"},
    "bench": {"physics", "formulations", "optimise", "scenes", "bench", "errors", "api"},
}
OUTSIDE = {  # at module level; what is imported inside functions is free
    "physics": {"numpy"},
    "optimise": {"numpy"},
    "formulations": {"numpy"},
    "scenes": {"pydantic", "pydantic_core", "defusedxml"},
    "report": {"numpy", "rich"},  # cli imports it inside functions
    "bench": {"numpy"},
}
TOP = {"units": set(), "errors": set(), "frozen": set()}
TOP["stages"] = {"errors", "optimise", "scenes", "api"}


@cache
def _statements(path: Path):
    """(import, at module level) of every import of a file; TYPE_CHECKING blocks are left out."""

    def of(node, top):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node, top
        elif not (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"):
            top = top and not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
            for child in ast.iter_child_nodes(node):
                if not isinstance(child, ast.expr):  # which hold no import
                    yield from of(child, top)

    return tuple(of(ast.parse(_with_imports(path.read_text(encoding="utf-8"))), True))


def _with_imports(text: str) -> str:
    """The statements of a file as far as imports stand in them; the rest takes seconds to parse."""
    last = max((m.end() for m in re.finditer(r"(?m)^ *(?:from|import) ", text)), default=0)
    later = re.compile(r"(?m)^(?:def|class|@)").search(text, last)
    return text[: later.start()] if later else text


def _imports(path: Path, whole: bool = False):
    """(module, at module level) of every import of a file.

    whole: with the imported name, which may be a module.
    """
    for node, top in _statements(path):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names = [f"{node.module}.{a.name}" for a in node.names]
            for name in names if whole or node.module == "gearopt" else [node.module]:
                yield name, top
        else:
            for alias in node.names:
                yield alias.name, top


def _files():
    return sorted(SRC.rglob("*.py"))


def test_every_room_is_in_the_table():
    rooms = {p.name for p in SRC.iterdir() if p.is_dir() and p.name != "__pycache__"}
    assert rooms == {*INSIDE, "cli"}


def _wrong(path):
    """What a file imports against the table."""
    parts = path.relative_to(SRC).parts
    room = parts[0] if len(parts) > 1 else path.stem
    if room in ("__init__", "__main__", "api", "cli"):
        return
    inside = INSIDE.get(room, TOP.get(room))
    outside = OUTSIDE.get(room, set())
    for module, top_level in _imports(path):
        first, *rest = module.split(".")
        if first == "gearopt":
            right = bool(rest) and rest[0] in inside | {"frozen"}
        elif not top_level or first in sys.stdlib_module_names:
            right = True
        else:
            right = path.stem.endswith("_kernel") if first == "numba" else first in outside
        if not right:
            yield f"{'/'.join(parts)} imports {module}{' at module level' * top_level}"


def test_imports_follow_the_layers():
    assert len(_files()) > 300
    assert [fault for path in _files() for fault in _wrong(path)] == []


def test_one_module_asks_the_report_room_by_name():
    """What shows an answer (docs/contract.md); the room itself, cli and api may."""
    rooms = ("physics", "optimise", "formulations", "scenes")
    asking = {
        str(path.relative_to(SRC))
        for path in _files()
        if path.relative_to(SRC).parts[0] in rooms
        and re.search(r"[\"']gearopt\.report", path.read_text(encoding="utf-8"))
    }
    assert asking == {"optimise/result.py"}


def test_modules_do_not_import_each_other_in_a_circle():
    """At module level; what is imported inside functions is read when all modules are there."""
    names = {".".join(("gearopt", *p.relative_to(SRC).with_suffix("").parts)): p for p in _files()}
    names = {name.removesuffix(".__init__"): path for name, path in names.items()}

    def known(module):
        """The module itself, or the one that the name stands in."""
        return module if module in names else module.rpartition(".")[0]

    graph = {
        name: {known(m) for m, top in _imports(path, whole=True) if top} & set(names) - {name}
        for name, path in names.items()
    }
    while free := [name for name, needs in graph.items() if not needs & set(graph)]:
        for name in free:
            del graph[name]
    assert not graph


def test_files_are_one_idea_long():
    long = {p.name: n for p in _files() if (n := p.read_text().count("\n")) > 600}
    assert not long


HEAVY = ("pint", "numba", "cvxpy", "pymoo", "scipy", "plotly", "jinja2", "matplotlib")
OTHERS = tuple(
    f"gearopt.{name}"
    for name in (
        *("scenes.servo", "formulations.servo", "scenes.drive.layout", "scenes.drive.explain"),
        *("optimise.comparing.runs", "optimise.pareto.tradeoff", "optimise.spatial"),
    )
)


def test_sizing_path_stays_light():
    """`gearopt solve` of a drive imports nothing heavy, and nothing of other questions."""
    problem = SRC.parents[1] / "problems" / "elevator.toml"
    code = (
        "import sys; sys.argv = ['gearopt', 'solve', sys.argv[1], '--json']\n"
        "from gearopt.__main__ import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code, end.code\n"
        f"print([m for m in {(*HEAVY, *OTHERS)!r} if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(problem)], capture_output=True, text=True, check=True
    )
    assert done.stderr.strip() == "[]"
