"""Keep all answers of a tree: `python tests/frozen/freeze.py OUT`, before a change of structure.

Every file of problems/, every example and seeded variants of a kind are solved (given gears:
rated) without a limit of time, and one JSON file a case holds what the result says, floats in hex,
with the text of the terminal and all tables. `compare.py A B` holds two of these folders against
each other. With --explain the explanations of the impossible files of `impossible.json` are kept
instead, and whether each remedy, solved again, has a design, for `compare_explanations.py A B`.

A run that is not over in LONGEST seconds is made again with the number of evaluations that it had
after FIRST seconds; that number stands in OUT/evaluations.json, which a later run is given by
--evaluations, since shares of time are not repeatable.
"""

import argparse
import json
import random
import re
import shutil
import sys
import tempfile
import time
import tomllib
from decimal import Decimal
from pathlib import Path

# Budgets count CPU seconds, from the first import on: a busy machine changes no answer.
time.perf_counter = time.process_time

import gearopt  # noqa: E402
from gearopt.errors import GearoptError  # noqa: E402
from gearopt.report import shown  # noqa: E402
from gearopt.scenes.explaining.explanations import explanation  # noqa: E402
from gearopt.scenes.explaining.numbers import content  # noqa: E402
from gearopt.scenes.reading.ask import Ask  # noqa: E402
from gearopt.scenes.reading.load import examples  # noqa: E402
from gearopt.scenes.reading.toml_writing import toml_text  # noqa: E402

HERE = Path(__file__).parent
sys.path += [str(HERE.parent / "scenes"), str(HERE.parent / "scenes" / "drive")]
from bars import KIND, Bars  # noqa: E402
from edits import edited  # noqa: E402
from given_drives import given_drive  # noqa: E402

PROBLEMS = HERE.parents[1] / "problems"
CHECKED = 10.0  # s, at most, in which a remedy is solved again
DECIMAL = re.compile(r"\d+\.\d+$")
LONGEST, FIRST = 60.0, 20.0  # s of a run without a limit; s after which its evaluations are counted
VARIANTS = 30  # of a kind, every third with a number divided by SHARPER
SHARPER = 4
NUMBER = re.compile(r"^\s*(\d+(?:\.\d+)?)(?=\D*$)")
TRANSIENT = {"seconds", "versions", "gearopt", "ways_out", "file", "file_sha256"}


def numbers(table, path=()):
    """The places of all numbers and quantities of a file's tables."""
    for key, value in table.items() if isinstance(table, dict) else enumerate(table):
        if isinstance(value, dict | list):
            yield from numbers(value, (*path, key))
        elif isinstance(value, Decimal) or isinstance(value, str) and NUMBER.match(value):
            yield (*path, key)


def scaled(value, factor):
    """A number or a quantity's text times a factor, in four digits."""
    if isinstance(value, str):
        return NUMBER.sub(lambda m: f"{float(m[1]) * factor:.4g}", value, count=1)
    return Decimal(f"{float(value) * factor:.4g}")


def variants(kind, texts):
    """Files of a kind: each a file of the kind with some numbers a little larger or smaller.

    Every third has one number divided by SHARPER, so that many of these are impossible.
    """
    rng, tried = random.Random(f"1 {kind}"), 0
    kept = {}
    while len(kept) < VARIANTS and tried < 20 * VARIANTS:
        tried += 1
        content = tomllib.loads(rng.choice(texts), parse_float=Decimal)
        tables = {k: v for k, v in content.items() if isinstance(v, dict | list)}
        places = [p for p in numbers(tables) if p[0] != "x-expected"]
        for path in rng.sample(places, min(3, len(places))):
            moved(content, path, rng.uniform(0.8, 1.25))
        if len(kept) % 3 == 2:
            moved(content, rng.choice(places), 1.0 / SHARPER)
        text = written(content)
        if readable(text):
            kept[f"{kind}-{len(kept) + 1:02d}"] = text
    return kept


def moved(content, path, factor):
    """Change the number at a place of tables by a factor."""
    *above, last = path
    for step in above:
        content = content[step]
    content[last] = scaled(content[last], factor)


def written(content, names=()):
    """Tables as TOML."""
    plain = {k: v for k, v in content.items() if not isinstance(v, dict) and not rows(v)}
    lines = [f"{k} = {toml_text(v)}" for k, v in plain.items()]
    for key, value in content.items():
        if isinstance(value, dict):
            place = (*names, key)
            lines += [f"[{'.'.join(place)}]", written(value, place)]
        elif rows(value):
            place = (*names, key)
            for row in value:
                lines += [f"[[{'.'.join(place)}]]", written(row, place)]
    return "\n".join(lines)


def rows(value):
    """Whether a value is a list of tables."""
    return isinstance(value, list) and value != [] and all(isinstance(v, dict) for v in value)


def readable(text):
    """Whether the reader takes a file's text; files that it names stand in problems/."""
    with tempfile.NamedTemporaryFile("w", dir=PROBLEMS, suffix=".toml") as file:
        file.write(text)
        file.flush()
        try:
            gearopt.load(file.name)
        except GearoptError:
            return False
    return True


def cases():
    """Name and text of every file that is kept."""
    texts = {p.stem: p.read_text(encoding="utf-8") for p in sorted(PROBLEMS.glob("*.toml"))}
    texts |= {f"example-{name.replace(' ', '-')}": text for name, text in examples().items()}
    by_kind = {}
    for text in texts.values():
        by_kind.setdefault(tomllib.loads(text)["kind"], []).append(text)
    for kind, files in sorted(by_kind.items()):
        texts |= variants(kind, files)
    return texts


def asked(path, budget, watch):
    """The result of a file: of one that only rates given gears its rating."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    if content["kind"] == "drive" and "rating" in content and "limits" not in content:
        return gearopt.rate(path)
    return gearopt.solve(path, budget=budget, watch=watch)


def answered(path, counts):
    """The result of a file without a limit of time, or with a number of evaluations."""
    name = path.stem
    if name in counts:
        return asked(path, gearopt.Budget(evaluations=counts[name]), None)
    begun, spent = time.perf_counter(), [0]

    def watch(event):
        late = time.perf_counter() - begun
        if late < FIRST:
            spent[0] = event.evaluations
        return late < LONGEST

    result = asked(path, None, watch)
    if time.perf_counter() - begun < LONGEST:
        return result
    counts[name] = max(1, spent[0])
    return answered(path, counts)


def kept(value):
    """Plain data with floats in hex, without what differs from run to run."""
    if isinstance(value, dict):
        return {k: kept(v) for k, v in value.items() if k not in TRANSIENT}
    if isinstance(value, list | tuple):
        return [kept(v) for v in value]
    return value.hex() if isinstance(value, float) else value


def record(result):
    """What is kept of a result: all that it says, the terminal's text and every table."""
    tables = {name: kept(result.table(name)) for name in result.tables}
    text = re.sub(r"\d+(?:\.\d+)? m?s\b", "TIME", str(shown.lines(result)))
    return kept(result.to_dict()) | {"terminal": text.splitlines(), "tables": tables}


def impossible(folder):
    """Name, and what `explain` takes, of every file of impossible.json.

    A file of problems/ with changes, a seed of random drives whose teeth are given, or bars.
    """
    for name, case in json.loads((HERE / "impossible.json").read_text()).items():
        if "bar" in case:
            table = {k: Decimal(v) if k == "safety" else v for k, v in case["bar"].items()}
            yield name, Bars.model_validate({"bar": table}), {}
        elif "seed" in case:
            path = Path(folder) / f"{name}.toml"
            path.write_text(given_drive(case["seed"]), encoding="utf-8")
            yield name, path, {}
        else:
            changes = {k: plain_number(v) for k, v in case["changes"].items()}
            yield name, Path(folder) / f"{case['file']}.toml", changes


def plain_number(value):
    """A number of a change; decimals are kept as text."""
    return Decimal(value) if isinstance(value, str) and DECIMAL.match(value) else value


def explained(what, changes, seconds):
    """What is kept of an explanation: conflict, remedies, CPU seconds, remedies that hold."""
    begun, budget = time.process_time(), gearopt.Budget(seconds=seconds)
    if isinstance(what, Bars):
        known = explanation(KIND, what, Ask(budget=budget))
    else:
        known = gearopt.explain(what, changes, budget=budget)
    cpu = time.process_time() - begun
    plain = known.to_dict()
    plain["result"] = plain["result"] and {"status": plain["result"]["status"]}
    again = [holds(what, changes, remedy) for remedy in known.remedies]
    return plain | {"cpu": cpu, "holds": again}


def holds(what, changes, remedy):
    """Whether the file with the edits of a remedy has a design; None: not decided in CHECKED."""
    if isinstance(what, Bars):
        return KIND.solve(edited(content(what), remedy, model=Bars), Ask()).value is not None
    budget = gearopt.Budget(seconds=CHECKED)
    answer = gearopt.solve(what, {**changes, **remedy.edits}, budget=budget, gap=1.0)
    if answer.value is not None:
        return bool(answer.feasible)
    return False if answer.status == "infeasible" else None


def main():
    """Freeze all cases into a folder."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--evaluations", type=Path, help="evaluations.json of an earlier run")
    parser.add_argument("--explain", action="store_true", help="explanations of impossible files")
    parser.add_argument("--seconds", type=float, default=20.0, help="at most, of an explanation")
    parser.add_argument("--only", default="", help="regular expression of the cases' names")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    counts = json.loads(given.evaluations.read_text()) if given.evaluations else {}
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(PROBLEMS, folder, dirs_exist_ok=True)
        if given.explain:
            explain_all(given, folder)
            return
        for name, text in cases().items():
            if not re.search(given.only, name):
                continue
            path = Path(folder) / f"{name}.toml"
            path.write_text(text, encoding="utf-8")
            begun = time.process_time()
            try:
                held = record(answered(path, counts))
            except GearoptError as reason:
                held = {"refused": str(reason).replace(folder, "")}
            held |= {"toml": text, "cpu": time.process_time() - begun}
            print(f"{name:<32} {held.get('status', '')!s:<12} {held['cpu']:7.2f} s", flush=True)
            (given.out / f"{name}.json").write_text(json.dumps(held, indent=1), encoding="utf-8")
    (given.out / "evaluations.json").write_text(json.dumps(counts, indent=1), encoding="utf-8")


def explain_all(given, folder):
    """Freeze the explanations of all impossible files into a folder."""
    for name, what, changes in impossible(folder):
        if not re.search(given.only, name):
            continue
        try:
            held = explained(what, changes, given.seconds)
        except GearoptError as reason:
            held = {"refused": str(reason).replace(folder, ""), "cpu": 0.0}
        ways = " ".join(c["key"] for r in held.get("remedies", ()) for c in r["changes"])
        print(f"{name:<16} {held['cpu']:7.2f} s {held.get('holds', '')} {ways}", flush=True)
        (given.out / f"{name}.json").write_text(json.dumps(held, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
