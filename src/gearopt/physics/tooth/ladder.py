"""The compliance of a pair of teeth by models of one signature, from simple to exact."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from gearopt.physics.tooth.beam import profile_compliance
from gearopt.physics.tooth.elastic import ElasticPair
from gearopt.physics.tooth.foundation import ring_torsion, sainsot_compliance
from gearopt.physics.tooth.hertz import contact_compliance


@dataclass(frozen=True)
class Level:
    """A model of the compliance of one pair of teeth.

    compliance(elastic, positions, force): [mm/N] along the line of action, of positions s [mm]
    (0 at the pitch point, positive towards the pinion's tip) and a force F > 0 [N] on this pair of
    teeth, floats or arrays; ValueError for positions outside the path of contact.
    """

    compliance: Callable[[ElasticPair, Any, Any], Any]


def _profile_sainsot(elastic: ElasticPair, positions: Any, force: Any) -> Any:
    lines = elastic.load_lines(positions)
    rows = list(zip(elastic.members, lines, strict=True))
    teeth = sum(profile_compliance(m, line) + sainsot_compliance(m, line) for m, line in rows)
    return teeth + contact_compliance(elastic, positions, lines, force)


LEVELS: Mapping[str, Level] = MappingProxyType({"profile + Sainsot": Level(_profile_sainsot)})
COUPLINGS: Mapping[str, Callable[[ElasticPair], float]] = MappingProxyType(
    {"none": lambda elastic: 0.0, "ring torsion": ring_torsion}
)
