"""Data checks: what no angles can mend, found before any search and told in numbers."""

from gearopt.formulations.layout.gearbox import Gearbox
from gearopt.formulations.layout.slabs import Clash, arrangements, clashes


def faults(box: Gearbox) -> list[str]:
    """Sentences about axes that are too close and a box that is too long; empty if none is."""
    one = arrangements(box)[0]
    found = [_sentence(clash) for clash in clashes(box, one)]
    if not found and one.length > box.largest[2] * (1.0 + 1e-9):
        most = f"{box.largest[2]:.7g} mm"
        found = [f"The box is at least {one.length:.2f} mm long, and may be {most} at most."]
    return found


def _sentence(clash: Clash) -> str:
    """What two axes lack, in numbers: `wheel 1 and shaft 3 ...`."""
    first, last = clash.need.between
    a, b = (k + 1 for k in clash.shafts)
    between = f"stage {a}" if b == a + 1 else f"stages {a} to {b - 1} in one line"
    radii = clash.need.distance - clash.need.clearance
    return (
        f"{first[0].upper()}{first[1:]} and {last} are {clash.short:.2f} mm too close: the axes of "
        f"shafts {a} and {b} are at most {clash.there:.2f} mm apart (centre distance of {between}) "
        f"and need {clash.need.distance:.2f} mm ({radii:.2f} for both radii, "
        f"{clash.need.clearance:g} clearance)."
    )
