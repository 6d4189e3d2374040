"""Remedies of an impossible drive whose number of stages is chosen, or could be another."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from gearopt.optimise.clock import Clock
from gearopt.optimise.explaining.explanation import Change, Remedies, Remedy
from gearopt.optimise.result import Budget
from gearopt.scenes.drive.explain.load_limit_remedies import remedies
from gearopt.scenes.drive.explain.tried import Case
from gearopt.scenes.drive.scene import MOST_STAGES, Scene
from gearopt.scenes.explaining.numbers import allowed
from gearopt.scenes.reading.toml_writing import toml_text

LESS = ("with_less", "nearer")  # of a remedy: whether a smaller change is impossible


def remedies_of_counts(asked: Scene, scene: Scene, clock: Clock) -> Remedies:
    """Return the remedies of an impossible drive, those of all its numbers of stages in one list.

    Of changes of the same numbers the smallest counts. Another number of stages is one to choose,
    where no table [[stage]] names them. asked: the file as it is, with its layout and processes.
    """
    if scene.stage:
        return remedies(scene, clock)
    by_count: dict[int, Remedies] = {}
    for k, n in enumerate(scene.counts):
        left = clock.left.seconds
        share = None if left is None else left / (len(scene.counts) - k)
        by_count[n] = remedies(scene.held(n), Clock(Budget(share), clock.watch))
    joined = _joined(by_count) if scene.several else by_count[scene.counts[0]]
    return replace(joined, remedies=(*joined.remedies, *_other_counts(asked, scene, clock)))


def _joined(found: Mapping[int, Remedies]) -> Remedies:
    """Return one list of what the counts need; conflicts are those of each count, and not named."""
    best: dict[tuple[str, ...], tuple[int, Remedy]] = {}
    for n, ways in found.items():
        for way in ways.remedies:
            keys = _keys(way)
            if any(key.startswith("stage[") for key in keys):  # no table for them in the file
                continue
            if keys not in best or way.factor < best[keys][1].factor:
                best[keys] = n, way
    known = [_held_against(found, *one) for one in best.values()]
    nearest = sorted((r for r in known if r.kind not in ("less", "choice")), key=lambda r: r.factor)
    nearest = [replace(r, kind=_kind(r), what=", ".join(_keys(r))) for r in nearest]
    if nearest:
        sure = not any(ways.message for ways in found.values())
        others = {"others": "need more" if sure else "not all known"}
        nearest[0] = replace(nearest[0], kind="least", verified={**nearest[0].verified, **others})
    rest = [r for kind in ("less", "choice") for r in known if r.kind == kind]
    late = next((ways.message for ways in found.values() if ways.message), "")
    return Remedies((), (*nearest, *rest), late)


def _keys(way: Remedy) -> tuple[str, ...]:
    return tuple(sorted(c.key for c in way.changes))


def _kind(way: Remedy) -> str:
    return "alone" if len(way.changes) == 1 else "pair"


def _held_against(found: Mapping[int, Remedies], count: int, way: Remedy) -> Remedy:
    """Return a remedy of a count; that less does not suffice must be known of the others too."""
    verified = {k: v for k, v in way.verified.items() if k != "others"}
    for other, ways in found.items():
        alike = [r for r in ways.remedies if _keys(r) == _keys(way)]
        complete = len(way.changes) == 1 and not ways.message
        words = [r.verified.get(k, "infeasible") for r in alike for k in LESS]
        known = all(w == "infeasible" for w in words) if alike else complete
        if other != count and not known:
            verified |= {k: "undecided" for k in LESS if k in verified}
    return replace(way, verified=verified, bound=None)


def _other_counts(asked: Scene, scene: Scene, clock: Clock) -> Iterator[Remedy]:
    """Yield the next number of stages, up or down, with which the drive is possible."""
    low, high = scene.counts[0], scene.counts[-1]
    near = [*range(high + 1, MOST_STAGES + 1), *range(low - 1, 0, -1)]
    for n in sorted(near, key=lambda n: abs(n - low) if n < low else n - high):
        span = (min(low, n), max(high, n)) if scene.several else (n, n)
        if not allowed(asked.model_copy(update={"stages": span})):
            continue
        other = scene.model_copy(update={"stages": (n, n)})
        if Case(other, clock).status(other) == "feasible":
            was = toml_text([low, high] if scene.several else low)
            write = toml_text(list(span) if scene.several else n)
            factor = low / n if n < low else n / high
            change = Change("stages", was, write, factor)
            yield Remedy("choice", "stages", (change,), change.factor, None, {"with": "feasible"})
            return
