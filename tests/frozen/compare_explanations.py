"""Hold the explanations of two trees against each other: `compare_explanations.py BEFORE AFTER`.

Both are folders of `freeze.py OUT --explain`. Asked of the later one, file by file: equal
conflicts; every set of keys that a remedy moved, with a factor of at most CLOSE that of before;
each remedy, solved again, has a design; what is proven of a little less stays proven; CPU of a
file at most TWICE or SLACK seconds more, of a group of files (the name before its number) at most
GROUP, of all at most that of before. Ends with 1 if anything is not so.
"""

import json
import re
import sys
from pathlib import Path

CLOSE = 1.001  # ratio of factors that are as small as each other
TWICE, SLACK, GROUP = 2.0, 2.0, 1.5
SURE = (
    "infeasible",
    "mixed",
    "undecided",
    None,
)  # of a remedy taken back a little, the surest first


def keys(remedy):
    """The keys that a remedy moves, and where a range moves its end, the way."""
    return tuple(sorted(change["key"] for change in remedy["changes"]))


def factor(remedy):
    """How far a remedy moves; infinite where a number is shifted."""
    return float("inf") if remedy["factor"] is None else remedy["factor"]


def sureness(remedy):
    """Place in SURE of what is known of a little less."""
    word = remedy["verified"].get("with_less")
    return SURE.index(word) if word in SURE else len(SURE)


def best(remedies):
    """The smallest remedy of every set of keys."""
    found = {}
    for remedy in remedies:
        if keys(remedy) not in found or factor(remedy) < factor(found[keys(remedy)]):
            found[keys(remedy)] = remedy
    return found


def faults(before, after):
    """What is worse in the later explanation of a file."""
    if before.get("refused") or after.get("refused"):
        if before.get("refused") != after.get("refused"):
            yield f"refused: {before.get('refused')!r} -> {after.get('refused')!r}"
        return
    if sorted(before["conflict"]) != sorted(after["conflict"]):
        yield f"conflict: {before['conflict']} -> {after['conflict']}"
    was, now = best(before["remedies"]), best(after["remedies"])
    for moved, remedy in was.items():
        if moved not in now:
            yield f"lost: {', '.join(moved)} (factor {factor(remedy):.5g})"
            continue
        if factor(now[moved]) > CLOSE * factor(remedy):
            yield f"larger: {', '.join(moved)} {factor(remedy):.6g} -> {factor(now[moved]):.6g}"
        if sureness(now[moved]) > sureness(remedy):
            words = [r["verified"].get("with_less") for r in (remedy, now[moved])]
            yield f"weaker: {', '.join(moved)} {words[0]} -> {words[1]}"
    for remedy, again in zip(after["remedies"], after["holds"], strict=True):
        if not again and keys(remedy) not in undecided(before):
            yield f"no design: {', '.join(keys(remedy))} ({again})"
    if after["cpu"] > max(TWICE * before["cpu"], before["cpu"] + SLACK):
        yield f"CPU: {before['cpu']:.2f} -> {after['cpu']:.2f} s"


def undecided(record):
    """The keys of remedies that were not decided when they were solved again."""
    return [
        keys(r) for r, again in zip(record["remedies"], record["holds"], strict=True) if not again
    ]


def main():
    """Compare all explanations that both folders hold."""
    folders = [Path(name) for name in sys.argv[1:3]]
    names = sorted(
        {p.name for p in folders[0].glob("*.json")} & {p.name for p in folders[1].glob("*.json")}
    )
    spent, worse, more = {}, 0, 0
    for name in names:
        before, after = (json.loads((folder / name).read_text()) for folder in folders)
        stem = name.removesuffix(".json")
        for fault in faults(before, after):
            print(f"{stem}\t{fault}")
            worse += 1
        new = [
            k for k in best(after.get("remedies", ())) if k not in best(before.get("remedies", ()))
        ]
        more += len(new)
        group = re.sub(r"-\d+$", "", stem)
        spent.setdefault(group, [0.0, 0.0])
        for k, record in enumerate((before, after)):
            spent[group][k] += record["cpu"]
    total = [sum(both[k] for both in spent.values()) for k in (0, 1)]
    for group, (before, after) in spent.items():
        late = after > GROUP * before
        worse += late
        print(f"{group}: CPU {before:.1f} -> {after:.1f} s{' (too long)' * late}")
    cpu = f"CPU {total[0]:.1f} -> {total[1]:.1f} s"
    print(f"{len(names)} files, {worse} faults, {more} remedies more; {cpu}")
    sys.exit(worse > 0 or total[1] > total[0])


if __name__ == "__main__":
    main()
