"""One front of several, of problems of which a design solves any: numbers of stages."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from gearopt.optimise.pareto.front import Front, Growth
from gearopt.optimise.pareto.measures import hypervolume, reference, unbeaten
from gearopt.optimise.pareto.pick import picks

CERTAIN = ("complete", "infeasible")


def united(fronts: Sequence[Front], weights: Mapping[str, float] | None) -> Front:
    """Return the designs of fronts that none of any of them beats; of equal ones the first.

    The fronts have the same objectives. It is complete where all of them are, or are proven to be
    empty; what is proven of single points of a front says nothing of the others.
    """
    every = [point for front in fronts for point in front.points]
    values = np.array([p.values for p in every]).reshape(-1, len(fronts[0].objectives))
    kept = unbeaten(values).tolist()
    done = all(front.status in CERTAIN for front in fronts)
    points = tuple(every[k] if done else replace(every[k], proven=False) for k in kept)
    corner = reference(values[kept]) if kept else np.empty(0)
    whole = hypervolume(values[kept], corner) if kept else None
    seconds, spent = (sum(getattr(f, n) for f in fronts) for n in ("seconds", "evaluations"))
    lost = tuple(every[k].values for k in range(len(every)) if k not in set(kept))
    said = " ".join(str(front.proof.get("sentence", "")) for front in fronts)
    return replace(
        fronts[0],
        status=_status(fronts, done, bool(kept)),
        points=points,
        error=None,
        picks=tuple(picks(values[kept], fronts[0].names, weights)),
        beaten=sum((front.beaten for front in fronts), lost),
        impossible=sum((front.impossible for front in fronts), ()),
        corner=tuple(map(float, corner)),
        hypervolume=whole,
        growth=() if whole is None else (Growth(seconds, spent, whole),),
        proof={**fronts[0].proof, "sentence": f"For each number of stages: {said}"},
        message="" if kept else next((f.message for f in fronts if f.message), ""),
        evaluations=spent,
        seconds=seconds,
    )


def _status(fronts: Sequence[Front], done: bool, some: bool) -> str:
    if done:
        return "complete" if some else "infeasible"
    return "limit" if any(front.status == "limit" for front in fronts) else "not proven"
