"""Limits of the models of elastic teeth, in sentences; the cheapest that suits, and the finest."""

from importlib.util import find_spec

from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.flaws import THIN_TIP
from gearopt.physics.geometry.tooth import tip_thickness
from gearopt.physics.tooth.elastic import ElasticGear, ElasticPair
from gearopt.physics.tooth.foundation import SAINSOT_BORE_RATIOS, SAINSOT_HALF_ANGLES
from gearopt.physics.tooth.ladder import LEVELS, RINGED, USUAL
from gearopt.physics.tooth.measured import IN_MESH, Errors
from gearopt.physics.tooth.trapezoid import is_waisted

# modules of face width from which plane strain describes teeth better (an assumption)
PLANE_STRAIN_FROM = 6.0
EXACT = "finite elements"
MEASURED = 1.4, 5.0  # bore ratios of the pairs on which `LEVELS` records errors
WIDEST_ROOT = 0.17  # half angle of a root [rad] up to which they do
WIDEST_SAINSOT = 15.0  # bore ratio beyond which Sainsot's body, 2 times too soft at 50, is refused
ANY_BORE = ("half plane and ring", "elements")  # bodies that larger ones suit as well
WIDEST = 50.0  # bore ratio up to which these are known, and beyond which every level is refused


def usual_plane(pair: GearPair) -> str:
    """Return "strain" for a face width of at least 6 normal modules, else "stress"."""
    return "strain" if pair.face_width >= PLANE_STRAIN_FROM * pair.normal_module else "stress"


def usual_level(elastic: ElasticPair) -> str:
    """Return the model used where the file names none, of `LEVELS`.

    USUAL up to a root-over-bore ratio of 7, above it RINGED (a ring of any bore).
    """
    widest = max(member.bore_ratio for member in elastic.members)
    return USUAL if widest <= SAINSOT_BORE_RATIOS[1] else RINGED


def unsupported(elastic: ElasticPair, level: str) -> tuple[str, ...]:
    """Return why a level of `LEVELS` must not be used for a pair, in sentences; () if it may."""
    rows = list(zip(MEMBERS, elastic.members, strict=True))
    model, reasons = LEVELS[level], []
    if model.tooth == "trapezoid":
        reasons += [
            f"The teeth of the {name} are undercut: a trapezoid has no waist."
            for name, member in rows
            if is_waisted(member.gear)
        ]
    if model.body == "Sainsot":
        least = SAINSOT_BORE_RATIOS[0]
        reasons += [
            f"The ring of the {name} is thin: root over bore {member.bore_ratio:.2f}, below the "
            f"{least:g} from which Sainsot's body was fitted; at 1.15 it is 23 % too soft."
            for name, member in rows
            if member.bore_ratio < least
        ]
        reasons += [
            f"The root circle of the {name} is {member.bore_ratio:.4g} times its bore: Sainsot's "
            f"body is known up to {WIDEST_SAINSOT:g}, and up to 2.4 times too soft at 50. Take "
            f'level = "{RINGED}"'
            for name, member in rows
            if member.bore_ratio > WIDEST_SAINSOT
        ]
    return tuple(reasons)


def refused(elastic: ElasticPair, level: str) -> tuple[str, ...]:
    """Return why a level says nothing of a pair, in sentences: trapezoid, Sainsot's body, bores."""
    model, bores = LEVELS[level], [member.bore_ratio for member in elastic.members]
    if max(bores) > WIDEST:
        name = MEMBERS[bores.index(max(bores))]
        least = 2.0 * elastic.members[bores.index(max(bores))].root_radius / WIDEST
        return (
            f"The root circle of the {name} is {max(bores):.4g} times its bore: no model of teeth "
            f"is known beyond {WIDEST:g}. Write a bore of {least:.3g} mm or more, or none",
        )
    far = model.body == "Sainsot" and max(bores) > WIDEST_SAINSOT
    return unsupported(elastic, level) if far or model.tooth == "trapezoid" else ()


def doubts(elastic: ElasticPair, level: str) -> tuple[str, ...]:
    """Sentences on effects that a level leaves out of a pair; `unsupported` ones first.

    A rigid shaft, and teeth that touch over the whole face width, are assumed of every pair and not
    said here.
    """
    sentences = list(unsupported(elastic, level))
    model = LEVELS[level]
    for name, member in zip(MEMBERS, elastic.members, strict=True):
        if model.body == "Sainsot":
            sentences += _outside_fit(name, member)
        elif member.bore_ratio < SAINSOT_BORE_RATIOS[0] and model.body != "disc":
            sentences.append(
                f"The ring of the {name} is thin, root over bore {member.bore_ratio:.2f}, and its "
                "bore is taken as rigid: a real rim is softer."
            )
        thin = float(tip_thickness(member.gear)) / float(member.gear.normal_module)
        if thin < THIN_TIP:
            sentences.append(
                f"The tips of the {name} are {thin:.2f} m_n thick, below {THIN_TIP:g} m_n: near "
                "them the model means little."
            )
        if is_waisted(member.gear) and model.tooth != "trapezoid":
            sentences.append(
                f"The teeth of the {name} are undercut: they touch from the form circle outwards."
            )
    return tuple(sentences) + _of_pair(elastic)


def cheapest(elastic: ElasticPair, error: float) -> str:
    """Return the cheapest level whose stiffness is known to within an error (0.05: 5 %).

    Of two that cost the same the more accurate one; none that is `unsupported`, and none outside
    the bore ratios on which its error is known. Known: the largest error that `LEVELS` records, of
    two pairs and of random ones; other teeth and materials may lie outside. An error below that of
    every model gives finite elements, whatever it is.
    """
    suited = [
        (level.cost, level.worst, name)
        for name, level in LEVELS.items()
        if level.worst <= error and _measured(elastic, name) and not unsupported(elastic, name)
    ]
    return min(suited)[2] if suited else EXACT


def installed() -> bool:
    """Return whether finite elements can be computed here: they are an extra."""
    return find_spec("skfem") is not None


def errors_in_mesh(elastic: ElasticPair, level: str, coupling: str) -> Errors | None:
    """Return how far a level with a coupling was off in mesh; None where that is not known."""
    ratios = [member.bore_ratio for member in elastic.members]
    known = MEASURED[0] <= min(ratios) and max(ratios) <= MEASURED[1]
    return IN_MESH.get((level, coupling)) if known else None


def cheapest_in_mesh(elastic: ElasticPair, error: float) -> tuple[str, str]:
    """Return the cheapest level and coupling known to within an error: of stiffness and in mesh.

    In mesh: of the peak-to-peak transmission error, as measured on random pairs. Finite elements
    of both where no other model is known to suit.
    """
    suited = [
        (LEVELS[level].cost + LEVELS[EXACT].cost * (coupling == EXACT), worst, level, coupling)
        for (level, coupling), worst in _worst_in_mesh(elastic).items()
        if max(worst, LEVELS[level].worst) <= error
    ]
    return min(suited)[2:] if suited else (EXACT, EXACT)


def finest(elastic: ElasticPair) -> tuple[str, str]:
    """Return the level and coupling that are nearest: finite elements, where they are installed.

    Else the analytic ones whose transmission error was least off, where that is known.
    """
    if installed():
        return EXACT, EXACT
    known = _worst_in_mesh(elastic)
    rows = [(worst, *names) for names, worst in known.items() if EXACT not in names]
    return min(rows)[1:] if rows else (usual_level(elastic), usual_coupling(usual_level(elastic)))


def usual_coupling(level: str) -> str:
    """Return the coupling of neighbours that goes with a level where the file names none."""
    return EXACT if level == EXACT else "ring torsion"


def _worst_in_mesh(elastic: ElasticPair) -> dict[tuple[str, str], float]:
    """Largest errors of the peak to peak by models that suit a pair, where they are known."""
    return {
        names: max(abs(errors.peak_to_peak[0]), abs(errors.peak_to_peak[2]))
        for names in IN_MESH
        if (errors := errors_in_mesh(elastic, *names)) and not unsupported(elastic, names[0])
    }


def _measured(elastic: ElasticPair, level: str) -> bool:
    """Return whether the bore ratios of a pair are those on which the error of a level is known."""
    ratios = [member.bore_ratio for member in elastic.members]
    large = max(ratios) > MEASURED[1] and LEVELS[level].body not in ANY_BORE
    return min(ratios) >= MEASURED[0] and not large


def _outside_fit(name: str, member: ElasticGear) -> list[str]:
    """Return where a gear lies outside the range over which Sainsot's body was fitted."""
    sentences, most = [], SAINSOT_BORE_RATIOS[1]
    if most < member.bore_ratio <= WIDEST_SAINSOT:
        sentences.append(
            f"Root over bore of the {name} is {member.bore_ratio:.2f}: Sainsot's body was fitted "
            f"up to {most:g}. At 7 to 15 it makes teeth 4 to 36 % too stiff."
        )
    low, high = SAINSOT_HALF_ANGLES
    if not low <= member.root_half_angle <= WIDEST_ROOT:
        sentences.append(
            f"Half the root of a tooth of the {name} spans {member.root_half_angle:.3f} rad: "
            f"Sainsot's body was fitted from {low:g} to {high:g} rad, and its error is known up to "
            f"{WIDEST_ROOT:g} rad, where stiffness was 5 to 9 % too low."
        )
    return sentences


def _of_pair(elastic: ElasticPair) -> tuple[str, ...]:
    """Remarks on both gears: contact that breaks off, an unlikely plane."""
    sentences, ratio = [], float(elastic.path.transverse_ratio)
    if ratio < 1.0:
        sentences.append(
            f"Tips and form circles leave a contact ratio of {ratio:.3f}: contact breaks off."
        )
    usual = usual_plane(elastic.pair)
    if elastic.plane != usual:
        wide = float(elastic.pair.face_width / elastic.pair.normal_module)
        off = "high" if elastic.plane == "strain" else "low"
        sentences.append(
            f"The face is {wide:.3g} modules wide: plane {usual} describes it better than plane "
            f"{elastic.plane}, with which the stiffness is about 7 % too {off}."
        )
    return tuple(sentences)
