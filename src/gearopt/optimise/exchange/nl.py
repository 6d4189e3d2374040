"""A problem as AMPL's .nl file (text), which most solvers of optimisation problems read.

Format: D. M. Gay, "Writing .nl files", Sandia National Laboratories, SAND2005-7907P (2005). All
rows are written as nonlinear ones; what is used more than once is a defined variable. Names stand
beside the file, in FILE.col and FILE.row, as AMPL writes them.
"""

from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gearopt.errors import SolveError
from gearopt.optimise.problem import Problem
from gearopt.optimise.tape import walk

NUMBER, VARIABLE = "n", "v"


class Node(NamedTuple):
    """An operation of a tape: a number, a variable's place, or .nl's operator and operands."""

    word: str
    operands: tuple[int, ...] = ()


def write(problem: Problem, file: str | Path) -> None:
    """Write a problem at its parameter values as FILE, FILE.col and FILE.row without the ending.

    SolveError for listed values, which .nl has not, and for operations that it has not.
    """
    columns = problem.columns
    if listed := [name for v, name in columns if v.values is not None]:
        raise SolveError(
            f"{problem.name}: an .nl file has no list of values, as {listed[0]} has; number them "
            "by an integer variable, or choose by variables of 0 and 1"
        )
    order = sorted(range(len(columns)), key=lambda k: columns[k][0].integer)  # whole ones last
    path, rows = Path(file), problem.rows
    lines = _lines(problem, order)
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    names = [columns[k][1] for k in order]
    path.with_suffix(".col").write_text("\n".join(names) + "\n", encoding="utf-8")
    names = [*(row.name for row in rows.inequalities), *rows.equalities, *rows.objectives]
    path.with_suffix(".row").write_text("\n".join(names) + "\n", encoding="utf-8")


def _lines(problem: Problem, order: list[int]) -> list[str]:
    """Return the lines of a problem's .nl file, whose variable k is its column order[k]."""
    nodes, (f, g, h) = _nodes(problem, order)
    lower, upper, guess = (ends[order] for ends in problem.bounds())
    limits, shared = [*g, *h], _shared(nodes, [*f, *g, *h])
    n, m = len(order), len(limits)
    named = {node: n + k for k, node in enumerate(shared)}
    jacobian = [_variables(nodes, row) for row in limits]
    gradients = [_variables(nodes, row) for row in f]
    whole = sum(v.integer for v, _ in problem.columns)
    lines = [
        f"g3 1 1 0\t# problem {problem.name}",
        f" {n} {m} {len(f)} 0 {len(h)}\t# vars, constraints, objectives, ranges, eqns",
        f" {m} {len(f)}\t# nonlinear constraints, objectives",
        " 0 0\t# network constraints: nonlinear, linear",
        f" {n} {n} {n}\t# nonlinear vars in constraints, objectives, both",
        " 0 0 0 1\t# linear network variables; functions; arith, flags",
        f" 0 0 {whole} 0 0\t# discrete variables: binary, integer, nonlinear (b,c,o)",
        f" {sum(map(len, jacobian))} {sum(map(len, gradients))}\t# nonzeros in Jacobian, gradients",
        " 0 0\t# max name lengths: constraints, variables",
        f" {len(shared)} 0 0 0 0\t# common exprs: b,c,o,c1,o1",
    ]
    for node in shared:
        lines += [f"V{named[node]} 0 0", *_expression(nodes, node, named, own=True)]
    for letter, sense, some in (("C", "", limits), ("O", " 0", f)):
        for k, row in enumerate(some):
            lines += [f"{letter}{k}{sense}", *_expression(nodes, row, named)]
    lines += [f"x{n}", *(f"{k} {value!r}" for k, value in enumerate(guess.tolist()))]
    lines += ["r", *len(g) * ["1 1"], *len(h) * ["4 1"]]
    lines += ["b", *map(_ends, lower.tolist(), upper.tolist())]
    used = Counter(v for row in jacobian for v in row)
    lines += [f"k{n - 1}", *map(str, np.cumsum([used[k] for k in range(n - 1)], dtype=int))]
    for letter, rows in (("J", jacobian), ("G", gradients)):
        for k, there in enumerate(rows):
            lines += [f"{letter}{k} {len(there)}", *(f"{v} 0" for v in there)] if there else []
    return lines


def _ends(low: float, high: float) -> str:
    """The bounds of a variable: both, one, none, or fixed."""
    if low == high:
        return f"4 {low!r}"
    if low > -np.inf:
        return f"0 {low!r} {high!r}" if high < np.inf else f"2 {low!r}"
    return f"1 {high!r}" if high < np.inf else "3"


def _nodes(problem: Problem, order: list[int]) -> tuple[list[Node], list[list[int]]]:
    """The operations of a tape, and those that are its objectives, limits and equal rows."""
    nodes: list[Node] = []

    def add(node: Node) -> int:
        nodes.append(node)
        return len(nodes) - 1

    def apply(operation: int, operands: list[int]) -> int:
        form = _forms().get(operation)
        if form is None:
            name = _names()[operation].lower()
            raise SolveError(f"{problem.name}: an .nl file has no operation {name}")
        word, *parts = form
        if word == "same":
            return operands[0]
        return add(Node(word, tuple(_part(p, operands, apply, add) for p in parts)))

    place = {column: k for k, column in enumerate(order)}
    x = [add(Node(f"{VARIABLE}{place[k]}")) for k in range(len(order))]
    p = [add(_number(value)) for value in problem.parameter_values().tolist()]
    function = problem.traced().terms.expand()
    return nodes, walk(function, [x, p], lambda value: add(_number(value)), apply)


def _part(part: Any, operands: list[int], apply: Any, add: Any) -> int:
    """An operand of a form: by its place, a number, or an operation of its own."""
    if isinstance(part, int):
        return operands[part]
    if isinstance(part, float):
        return int(add(_number(part)))
    return int(apply(part[0], [_part(p, operands, apply, add) for p in part[1:]]))


def _number(value: float) -> Node:
    return Node(f"{NUMBER}{float(value)!r}")


def _shared(nodes: list[Node], rows: list[int]) -> list[int]:
    """Operations that are used more than once, each after those that it uses."""
    uses, reached = Counter(rows), set[int]()
    stack = list(rows)
    while stack:
        node = stack.pop()
        if node not in reached:
            reached.add(node)
            uses.update(nodes[node].operands)
            stack += nodes[node].operands
    return sorted(k for k in reached if uses[k] > 1 and nodes[k].operands)


def _variables(nodes: list[Node], row: int) -> list[int]:
    """The places of the variables of a row, in order."""
    places, reached, stack = set[int](), {row}, [row]
    while stack:
        word, operands = nodes[stack.pop()]
        if word.startswith(VARIABLE):
            places.add(int(word[1:]))
        stack += set(operands) - reached
        reached.update(operands)
    return sorted(places)


def _expression(nodes: list[Node], row: int, named: dict[int, int], own: bool = False) -> list[str]:
    """Lines of an expression in prefix order; own: of a defined variable itself."""
    lines, stack = [], [row]
    while stack:
        node = stack.pop()
        if node in named and not (own and node == row):
            lines.append(f"{VARIABLE}{named[node]}")
            continue
        word, operands = nodes[node]
        lines.append(word)
        stack += reversed(operands)
    return lines


@cache
def _names() -> dict[int, str]:
    import casadi as ca

    return {value: name for name, value in vars(ca).items() if name.startswith("OP_")}


@cache
def _forms() -> dict[int, tuple[Any, ...]]:
    """Operations of casadi as .nl's operator and operands: places, numbers, operations."""
    import casadi as ca

    unary, binary, apart = range(1), range(2), (ca.OP_FABS, (ca.OP_SUB, 0, 1))
    return {
        ca.OP_ASSIGN: ("same",),
        **{op: (f"o{code}", *binary) for op, code in (
            (ca.OP_ADD, 0), (ca.OP_SUB, 1), (ca.OP_MUL, 2), (ca.OP_DIV, 3), (ca.OP_POW, 5),
            (ca.OP_CONSTPOW, 5), (ca.OP_ATAN2, 48),
        )},
        **{op: (f"o{code}", *unary) for op, code in (
            (ca.OP_NEG, 16), (ca.OP_FABS, 15), (ca.OP_SQRT, 39), (ca.OP_EXP, 44), (ca.OP_LOG, 43),
            (ca.OP_SIN, 41), (ca.OP_COS, 46), (ca.OP_TAN, 38), (ca.OP_ASIN, 51), (ca.OP_ACOS, 53),
            (ca.OP_ATAN, 49), (ca.OP_SINH, 40), (ca.OP_COSH, 45), (ca.OP_TANH, 37),
            (ca.OP_ASINH, 50), (ca.OP_ACOSH, 52), (ca.OP_ATANH, 47), (ca.OP_FLOOR, 13),
            (ca.OP_CEIL, 14),
        )},
        ca.OP_FMIN: ("o2", 0.5, (ca.OP_SUB, (ca.OP_ADD, *binary), apart)),  # readers lack min, max
        ca.OP_FMAX: ("o2", 0.5, (ca.OP_ADD, (ca.OP_ADD, *binary), apart)),
        ca.OP_SQ: ("o5", 0, 2.0),
        ca.OP_TWICE: ("o2", 2.0, 0),
        ca.OP_INV: ("o3", 1.0, 0),
        ca.OP_EXPM1: ("o1", (ca.OP_EXP, 0), 1.0),
        ca.OP_LOG1P: ("o43", (ca.OP_ADD, 1.0, 0)),
        ca.OP_HYPOT: ("o39", (ca.OP_ADD, (ca.OP_SQ, 0), (ca.OP_SQ, 1))),
    }  # fmt: skip
