"""Hold two folders of `freeze.py` against each other: `compare.py BEFORE AFTER`.

Prints `case key before after` for everything that differs and ends with 1 if anything does; floats
may differ by --tolerance (relative), 0 for equal bits. CPU seconds are summed beside that.
"""

import argparse
import json
import sys
from pathlib import Path

FREE = {"cpu"}  # keys that may differ


def differences(before, after, tolerance, place=""):
    """Places where two records differ, with both values."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in [*before, *(k for k in after if k not in before)]:
            if key not in FREE:
                there = f"{place}.{key}" if place else key
                yield from differences(before.get(key), after.get(key), tolerance, there)
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for k, (one, other) in enumerate(zip(before, after, strict=True), 1):
            yield from differences(one, other, tolerance, f"{place}[{k}]")
    elif before != after and not close(before, after, tolerance):
        yield place, before, after


def close(before, after, tolerance):
    """Whether two floats in hex differ by at most a relative tolerance."""
    try:
        one, other = float.fromhex(before), float.fromhex(after)
    except (TypeError, ValueError):
        return False
    return abs(one - other) <= tolerance * max(abs(one), abs(other))


def main():
    """Compare all cases of two folders."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--tolerance", type=float, default=1e-12)
    given = parser.parse_args()
    names = {p.name for folder in (given.before, given.after) for p in folder.glob("*.json")}
    differs, cpu = 0, [0.0, 0.0]
    for name in sorted(names - {"evaluations.json"}):
        records = []
        for folder in (given.before, given.after):
            path = folder / name
            records.append(json.loads(path.read_text(encoding="utf-8")) if path.exists() else {})
        for place, before, after in differences(*records, given.tolerance):
            print(f"{name.removesuffix('.json')}\t{place}\t{before!r}\t{after!r}")
            differs += 1
        cpu = [total + held.get("cpu", 0.0) for total, held in zip(cpu, records, strict=True)]
    spent = f"CPU {cpu[0]:.1f} s before, {cpu[1]:.1f} s after"
    print(f"{len(names)} cases, {differs} differences; {spent}")
    sys.exit(differs > 0)


if __name__ == "__main__":
    main()
