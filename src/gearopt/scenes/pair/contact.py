"""From the tables of a pair to the contact of its gears: bores, materials, models, loads."""

from collections.abc import Iterator
from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations.pair.contact import DEAR, PairMesh, contact
from gearopt.formulations.pair.design import PairContact
from gearopt.frozen import dataclass
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.contact import usable_path
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.iso6336.stiffness import (
    mean_blank_factor,
    mesh_stiffness,
    single_stiffness,
)
from gearopt.physics.tooth.elastic import POISSON, STEEL, ElasticPair
from gearopt.physics.tooth.foundation import SAINSOT_BORE_RATIOS
from gearopt.physics.tooth.ladder import COUPLINGS, LEVELS, USUAL
from gearopt.physics.tooth.slices import normal_section
from gearopt.physics.tooth.validity import (
    EXACT,
    cheapest,
    cheapest_in_mesh,
    doubts,
    finest,
    installed,
    refused,
    usual_coupling,
    usual_level,
    usual_plane,
)
from gearopt.scenes.drive.rating.gears import Tables, blanks, gear_tables
from gearopt.scenes.pair.scene import Scene
from gearopt.units import Quantity

Materials = tuple[str, str]
UNBORED = 3.0  # root circle over the circle at which a gear without a bore is held
LEAST_SECONDS = 0.5  # of a budget in which a dear level is begun: it takes up to twice as long
BORNE = 4000.0  # MPa; from it on hardened rollers keep dents (static rating of ISO 76)
NEAR_WHOLE = 0.02  # of a contact ratio to a whole number, where TE is discontinuous


def contact_of(scene: Scene, made: PairMesh, materials: Materials) -> PairContact:
    """Return the contact of a pair of a file in mesh; materials: as of `mesh_of`."""
    name = coupling_name(models_of(scene, made.elastic)[1])
    pair = made.elastic.pair
    beyond = doubts_of(scene, pair, made.elastic, made.level, materials)
    iso = stiffnesses_by_iso(scene, pair, made.elastic, materials)
    computed = contact(made, name, iso, (*beyond, *_near_whole(pair)))
    most = max(one.largest_contact_stress_MPa for one in computed.loads)
    return replace(computed, validity=(*computed.validity, *yielding(most)))


def doubts_of(
    scene: Scene, pair: GearPair, elastic: ElasticPair, level: str, materials: Materials
) -> tuple[str, ...]:
    """Sentences on what the models do not cover of a pair, and why the level is not the usual."""
    name = coupling_name(models_of(scene, elastic)[1])
    return (
        *_chosen(scene, elastic, level),
        *_webs(scene, pair, materials),
        *_validity(pair, elastic, level, name),
    )


def yielding(most: float) -> Iterator[str]:
    """Yield what a contact stress [MPa] means that hardened steel does not bear."""
    if most > BORNE:
        yield (
            f"The contact stress reaches {most:,.0f} MPa, and hardened steel yields from "
            f"{BORNE:,.0f} MPa on: the gears are too small, or the load in the file is wrong."
        )


@dataclass(frozen=True)
class Teeth:
    """The teeth of a pair of a file: elastic in their normal section, by a level, at loads.

    coupling: c_12 [mm/N] in the normal section, or as given.
    """

    elastic: ElasticPair
    level: str
    coupling: float
    loads: tuple[float, ...]


def mesh_of(
    scene: Scene, pair: GearPair, materials: Materials = ("", ""), seconds: float | None = None
) -> PairMesh:
    """Return a spur pair of a file in mesh at its loads; see `teeth_of`."""
    try:
        teeth = teeth_of(scene, pair, materials, seconds)
        torque, steps = scene.duty.input_torque, scene.sharing.positions
        mesh = PairMesh.of(teeth.elastic, teeth.level, torque, teeth.coupling, steps, teeth.loads)
    except ImportError as reason:  # of finite elements, an extra
        raise SolveError(str(reason)) from None
    _check_coupling(mesh)
    check_length(scene, float(mesh.elastic.path.transverse_ratio))
    return mesh


def teeth_of(
    scene: Scene, pair: GearPair, materials: Materials = ("", ""), seconds: float | None = None
) -> Teeth:
    """Return the teeth of a pair of a file; SolveError where contact does not go on.

    materials: names of those chosen for pinion and wheel; "": there was no choice. TimeoutError
    where so few seconds are left that finite elements of its teeth are not begun; ImportError
    where they are not installed.
    """
    fatal = [flaw.sentence for flaw in flaws(pair) if flaw.fatal]
    if fatal:
        raise SolveError(f"there is no contact to compute: {fatal[0][0].lower()}{fatal[0][1:-1]}")
    asked, relief = scene.sharing, scene.relief
    elastic = elastic_pair(scene, pair, materials)
    loads = sorted({float(load) for load in (*asked.loads, *((relief and relief.loads) or ()))})
    level, coupling = models_of(scene, elastic)
    if excluded := refused(elastic, level):
        raise SolveError(f'[sharing] level = "{level}" does not suit the gears. {excluded[0]}')
    if seconds is not None and seconds < LEAST_SECONDS:
        dear = "level" if LEVELS[level].cost > DEAR else "coupling" if coupling == EXACT else ""
        if dear:
            raise TimeoutError(
                f'{dear} "{EXACT}" takes a second or two: allow more time, or write another {dear} '
                "in [sharing]"
            )
    coupled = coupling.value if isinstance(coupling, Quantity) else COUPLINGS[coupling](elastic)
    return Teeth(elastic, level, coupled, tuple(loads))


def check_length(scene: Scene, path: float) -> None:
    """Refuse a relief that is longer than the path of contact; path: in base pitches."""
    asked = scene.relief
    if asked is not None and asked.length is not None and asked.length[1] > path:
        raise SolveError(
            f"[relief] length goes up to {float(asked.length[1]):g} base pitches, but the path of "
            f"contact has {path:.3f}. Write, for example, length = 0.6 or length = [0.1, 0.8]"
        )


def _check_coupling(made: PairMesh) -> None:
    """Refuse a coupling as large as what a pair of teeth gives way under its own load."""
    least = float(made.mesh.compliances.min())
    if made.mesh.coupling >= least:
        other = f', or level = "{USUAL}"' if _usual_suits(made) else ""
        raise SolveError(
            f"[sharing] coupling is {1e6 * made.mesh.coupling:.3g} um/kN, but a pair of teeth "
            f"gives way by {1e6 * least:.3g} um/kN under its own load by level = "
            f'"{made.level}": the load of a neighbour cannot move it as far. Write coupling = '
            f'"none" or a smaller one{other}'
        )


def _usual_suits(made: PairMesh) -> bool:
    """Return whether teeth by the usual model, if it is another, give way beyond the coupling."""
    if made.level == USUAL or refused(made.elastic, USUAL):
        return False
    return made.least_compliance(USUAL) > made.mesh.coupling


def models_of(scene: Scene, elastic: ElasticPair) -> tuple[str, str | Quantity]:
    """Return level and coupling that a file asks for, or whose errors it bears.

    Of a relief, where it says nothing on either, the finest ones: what is best by a model that is
    off is not the best of the gears. Of helical gears the coupling by finite elements, with which
    their errors are known, where they are installed.
    """
    asked = scene.sharing
    if asked.error is not None and asked.coupling is None and not scene.helical:
        return cheapest_in_mesh(elastic, float(asked.error))
    if asked.error is not None:
        level = cheapest(elastic, float(asked.error))
    elif scene.relief and not scene.helical and asked.level is None and asked.coupling is None:
        return finest(elastic)
    else:
        level = asked.level or usual_level(elastic)
    usual = EXACT if scene.helical and installed() else usual_coupling(level)
    return level, usual if asked.coupling is None else asked.coupling


def coupling_name(coupling: str | Quantity) -> str:
    """Name of a coupling: its model, or that it is given as a number."""
    return coupling if isinstance(coupling, str) else "given"


def elastic_pair(scene: Scene, pair: GearPair, materials: Materials = ("", "")) -> ElasticPair:
    """Return a pair, in its normal section, with its bores, materials and plane state."""
    tables, bodies = _tables(scene, materials), blanks_of(scene, pair, materials)
    bores = [
        bore_of(blank, float(g.root_diameter)) for blank, g in zip(bodies, pair.gears, strict=True)
    ]
    moduli = [t.elastic_modulus.value if t.elastic_modulus else STEEL for t in tables]
    poissons = [float(t.poisson_ratio) if t.poisson_ratio is not None else POISSON for t in tables]
    plane = scene.sharing.plane or usual_plane(pair)
    ends = (moduli[0], moduli[1]), (poissons[0], poissons[1])
    return normal_section(pair, (bores[0], bores[1]), *ends, plane)


def blanks_of(scene: Scene, pair: GearPair, materials: Materials) -> tuple[Blank, Blank]:
    """Blanks of the gears of a pair."""
    return blanks(_tables(scene, materials), pair)


def _tables(scene: Scene, materials: Materials) -> Tables:
    drive = scene.drive
    return gear_tables(drive.stage_tables[0], drive.gears, drive.material, 0, materials)


def bore_of(blank: Blank, root: float) -> float:
    """Return the diameter [mm] at which a gear is held: its bore, or a third of the root circle."""
    return blank.bore if blank.bore and blank.hub < root else root / UNBORED


def line_load(scene: Scene, pair: GearPair) -> float:
    """Return F_t/b [N/mm] at the reference circle, at the torque of the duty."""
    load = 2.0 * scene.duty.input_torque
    return float(load / (pair.pinion.reference_diameter * pair.face_width))


def stiffnesses_by_iso(
    scene: Scene, pair: GearPair, elastic: ElasticPair, materials: Materials
) -> tuple[float, float]:
    """Return c' and c_gamma_alpha [MPa] of ISO 6336-1 at the torque of the duty."""
    line = line_load(scene, pair)
    blanks = blanks_of(scene, pair, materials)
    webs = tuple(blank.web(gear) for blank, gear in zip(blanks, pair.gears, strict=True))
    single = single_stiffness(pair, line, elastic.moduli, mean_blank_factor((webs[0], webs[1])))
    ratio = usable_path(pair).transverse_ratio
    return float(single), float(mesh_stiffness(single, ratio)[0])


def _chosen(scene: Scene, elastic: ElasticPair, level: str) -> Iterator[str]:
    """Yield why the model of the teeth is not the usual one, where the file names none."""
    asked = scene.sharing
    if asked.level is None and asked.error is None and level == usual_level(elastic) != USUAL:
        yield (
            f'The file names no level, and the bores are too small for "{USUAL}", whose body was '
            f"fitted to a root circle of up to {SAINSOT_BORE_RATIOS[1]:g} bores: teeth are "
            f'computed by "{level}", within 7 % of finite elements there.'
        )


def _webs(scene: Scene, pair: GearPair, materials: Materials) -> Iterator[str]:
    """Yield gears with rims on webs, of which the models know only the bore."""
    bodies = blanks_of(scene, pair, materials)
    for name, blank, gear in zip(MEMBERS, bodies, pair.gears, strict=True):
        web, rim = blank.web(gear) or (1.0, 0.0)
        if web < 1.0:
            yield (
                f"The {name} has a rim of {rim:.3g} m_n on a web of {100.0 * web:.3g} % of its "
                "face width: stiffness is that of a full ring down to the bore, the real one lower."
            )


def _validity(pair: GearPair, elastic: ElasticPair, level: str, coupling: str) -> Iterator[str]:
    """Yield what the models do not cover of these gears, and flaws that a designer may accept."""
    if LEVELS[level].body == "half plane" and coupling in ("ring torsion", "finite elements"):
        yield (
            f"{level} has no torsion of the rings, which the coupling by {coupling} has: "
            'stiffness and coupling are then of two different bodies. Write coupling = "none".'
        )
    sentences = doubts(elastic, level)
    yield from sentences
    thin = any("tips" in sentence for sentence in sentences)
    for flaw in flaws(pair):
        if flaw.name != "interference" and not (thin and flaw.name == "thin tip"):
            yield flaw.sentence


def _near_whole(pair: GearPair) -> Iterator[str]:
    """Yield that the contact ratio of a spur pair is next to a whole number."""
    ratio = float(usable_path(pair).transverse_ratio)
    whole = round(ratio)
    if whole > 1 and abs(ratio - whole) < NEAR_WHOLE:
        yield (
            f"The contact ratio of {ratio:.4f} is close to {whole}, at which the transmission "
            "error jumps with it: errors of the gears decide on which side it is."
        )
