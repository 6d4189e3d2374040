"""What an engineer asks of a pair's contact, answered in sentences."""

from gearopt.formulations.pair_contact import ContactLoad, PairContact
from gearopt.report.measures import rounded
from gearopt.report.words import share


def of_duty(found: PairContact) -> ContactLoad:
    """Return what happens at the torque of the duty, else at the largest load."""
    loads = {one.load: one for one in found.loads}
    return loads.get(1.0) or loads[max(loads)]


def answers(found: PairContact) -> list[str]:
    """Return how the load passes, how even the motion is, and how the numbers compare."""
    load = of_duty(found)
    return [_shared(found, load), _even(found, load), _stiff(found, load)]


def _shared(found: PairContact, load: ContactLoad) -> str:
    """Say how much one pair of teeth carries and where."""
    first, last = load.share[0], load.share[-1]
    ends = f"it begins with {share(first)} % of it and ends with {share(last)} %"
    if load.largest_share < 1.0:
        most = f"at most {share(load.largest_share)} % of the load, as two pairs always touch"
        return f"One pair of teeth carries {most}; {ends}."
    alone = 2.0 - found.contact_ratio
    length = rounded(alone * found.base_pitch_mm, 3)
    return (
        f"One pair of teeth carries the whole load, {rounded(load.normal_force_N, 4)} N, over "
        f"{length} mm of its path ({share(alone / found.contact_ratio)} % of it); {ends}."
    )


def _even(found: PairContact, load: ContactLoad) -> str:
    """Say how much the transmission error varies."""
    each = [
        f"{rounded(1e3 * one.peak_to_peak_mm, 3)} µm at {100.0 * one.load:g} % of the torque"
        for one in found.loads
    ]
    part = 100.0 * load.harmonics_mm[0] / load.peak_to_peak_mm if load.peak_to_peak_mm else 0.0
    return (
        f"The transmission error varies by {', '.join(each)}, peak to peak; its first harmonic, at "
        f"the mesh frequency, is {rounded(1e3 * load.harmonics_mm[0], 3)} µm "
        f"({rounded(part, 2)} % of that)."
    )


def _stiff(found: PairContact, load: ContactLoad) -> str:
    """Say how the mesh stiffness compares with ISO 6336-1."""
    if not load.mean_mesh_stiffness_MPa:
        return "Without load there is no mesh stiffness."
    off = 100.0 * (load.mean_mesh_stiffness_MPa / found.iso_mesh_stiffness_MPa - 1.0)
    return (
        f"The mean mesh stiffness is {rounded(abs(off), 2)} % {'above' if off > 0 else 'below'} "
        "the value that ISO 6336-1 has for all gears of its kind."
    )
