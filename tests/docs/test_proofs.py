"""The page of proofs: what it names exists, and every exact method has its lemmas."""

import ast
import re
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "proofs.md").read_text(encoding="utf-8")
SOURCE = ROOT / "src" / "gearopt"
ROOMS = "|".join(("formulations", "optimise", "physics"))
CODE = sorted(set(re.findall(rf"`((?:{ROOMS})\.[\w.]+)`", PAGE)))
TESTS = sorted(set(re.findall(r"`(tests/[\w/]+\.py::\w+)`", PAGE)))
METHODS = {"exact", "enumeration", "hop"}  # of `Problem.methods`: they bring a bound


@cache
def text_of(path):
    return path.read_text(encoding="utf-8")


@cache
def tree(path):
    return ast.parse(text_of(path))


def module_of(parts):
    """The file of a dotted name's module, and what is left of the name."""
    folder = SOURCE
    for k, part in enumerate(parts):
        if (folder / f"{part}.py").exists():
            return folder / f"{part}.py", parts[k + 1 :]
        if not (folder / part).is_dir():
            return folder / "__init__.py", parts[k:]
        folder = folder / part
    return folder / "__init__.py", ()


def defined(text, names, indent=0):
    """Whether functions or classes inside each other have these names."""
    head, _, body = text.partition(next(iter(re.findall(heading(names[0], indent), text)), "\0"))
    body = re.split(rf"(?m)^ {{0,{indent}}}[\w@]", body)[0]
    return head != text and (len(names) == 1 or defined(body, names[1:], indent + 4))


def heading(name, indent):
    """The line that a function or class begins with."""
    return rf"(?m)^ {{{indent}}}(?:def|class) {name}\b"


def modules_with_methods():
    """Modules of the formulations with a dictionary of methods that are proven or bring a bound."""
    for path in sorted(SOURCE.glob("formulations/**/*.py")):
        if not re.search("|".join(f'"{method}"' for method in METHODS), text_of(path)):
            continue
        for node in ast.walk(tree(path)):
            keys = node.keys if isinstance(node, ast.Dict) else ()
            names = {k.value for k in keys if isinstance(k, ast.Constant)}
            looped = isinstance(node, ast.DictComp) and "exact" in ast.unparse(node)
            if names & METHODS or looped:
                parts = path.relative_to(SOURCE).with_suffix("").parts
                yield ".".join(p for p in parts if p != "__init__")


def is_function(name):
    """Whether the page names a function that there is."""
    path, names = module_of(tuple(name.split(".")))
    return path.exists() and names and defined(text_of(path), names)


def is_test(name):
    """Whether the page names a test that there is."""
    path, test = name.split("::")
    return (ROOT / path).exists() and f"\ndef {test}(" in text_of(ROOT / path)


def test_every_function_and_test_of_the_page_exists():
    assert len(CODE) > 100 and [name for name in CODE if not is_function(name)] == []
    assert len(TESTS) > 100 and [name for name in TESTS if not is_test(name)] == []


def test_every_exact_method_has_a_section():
    found = set(modules_with_methods())
    assert len(found) >= 10
    named = {m for m in found if any(c == m or c.startswith(f"{m}.") for c in CODE)}
    assert found - named == set(), "each of these needs a lemma in docs/proofs.md"


def test_every_lemma_is_numbered_and_followed_by_its_code_and_tests():
    numbers = [int(n) for n in re.findall(r"^\*\*Lemma (\d+)", PAGE, re.M)]
    assert numbers == list(range(1, len(numbers) + 1)) and len(numbers) > 50
    for part in re.split(r"^##+ ", PAGE, flags=re.M):
        section = " ".join(part.split())
        if "**Lemma" in section and not section.startswith("Branch and bound"):
            assert "Code: `" in section and re.search(r"Tests?: `tests/", section), section[:40]
    assert PAGE.count("*Proof") == PAGE.count("∎") == len(numbers)
