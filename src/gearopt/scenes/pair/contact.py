"""From the tables of a pair to the contact of its gears: bores, materials, models, loads."""

from collections.abc import Iterator
from dataclasses import replace

from gearopt.errors import SolveError
from gearopt.formulations.pair.contact import DEAR, PairMesh, contact
from gearopt.formulations.pair.design import PairContact
from gearopt.physics.blanks import Blank
from gearopt.physics.gears import MEMBERS, GearPair
from gearopt.physics.geometry.flaws import flaws
from gearopt.physics.iso6336.stiffness import (
    mean_blank_factor,
    mesh_stiffness,
    single_stiffness,
)
from gearopt.physics.tooth.elastic import POISSON, STEEL, ElasticPair
from gearopt.physics.tooth.foundation import SAINSOT_BORE_RATIOS
from gearopt.physics.tooth.ladder import COUPLINGS, LEVELS, USUAL
from gearopt.physics.tooth.validity import cheapest, doubts, refused, usual_level, usual_plane
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
    coupling = scene.sharing.coupling
    name = "given" if isinstance(coupling, Quantity) else coupling
    pair = made.elastic.pair
    beyond = (*_chosen(scene, made), *_webs(scene, pair, materials), *_validity(made, name))
    computed = contact(
        made, name, _stiffnesses_by_iso(scene, pair, made.elastic, materials), beyond
    )
    most = max(one.largest_contact_stress_MPa for one in computed.loads)
    if most <= BORNE:
        return computed
    said = (
        f"The contact stress reaches {most:,.0f} MPa, and hardened steel yields from "
        f"{BORNE:,.0f} MPa on: the gears are too small, or the load in the file is wrong."
    )
    return replace(computed, validity=(*computed.validity, said))


def mesh_of(
    scene: Scene, pair: GearPair, materials: Materials = ("", ""), seconds: float | None = None
) -> PairMesh:
    """Return a pair of a file in mesh at its loads; SolveError where contact does not go on.

    materials: names of those chosen for pinion and wheel; "": there was no choice. TimeoutError
    where so few seconds are left that finite elements of its teeth are not begun.
    """
    fatal = [flaw.sentence for flaw in flaws(pair) if flaw.fatal]
    if fatal:
        raise SolveError(f"there is no contact to compute: {fatal[0][0].lower()}{fatal[0][1:-1]}")
    asked, duty, relief = scene.sharing, scene.duty, scene.relief
    elastic = elastic_pair(scene, pair, materials)
    coupling = asked.coupling
    moved = duty.input_torque
    loads = sorted({float(load) for load in (*asked.loads, *((relief and relief.loads) or ()))})
    level = level_of(scene, elastic)
    if excluded := refused(elastic, level):
        raise SolveError(f'[sharing] level = "{level}" does not suit the gears. {excluded[0]}')
    if seconds is not None and seconds < LEAST_SECONDS and LEVELS[level].cost > DEAR:
        raise TimeoutError(
            f'level = "{level}" in [sharing] takes a second or two: allow more time, or write '
            "another level"
        )
    try:
        coupled = coupling.value if isinstance(coupling, Quantity) else COUPLINGS[coupling](elastic)
        mesh = PairMesh.of(elastic, level, moved, coupled, asked.positions, loads)
    except ImportError as reason:  # of finite elements, an extra
        raise SolveError(str(reason)) from None
    _check_coupling(mesh)
    _check_length(scene, mesh)
    return mesh


def _check_length(scene: Scene, made: PairMesh) -> None:
    """Refuse a relief that is longer than the path of contact."""
    asked, path = scene.relief, float(made.elastic.path.transverse_ratio)
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


def level_of(scene: Scene, elastic: ElasticPair) -> str:
    """Return the model of the teeth's compliance that a file asks for, or whose error it bears."""
    asked = scene.sharing
    if asked.error is not None:
        return cheapest(elastic, float(asked.error))
    return asked.level or usual_level(elastic)


def elastic_pair(scene: Scene, pair: GearPair, materials: Materials = ("", "")) -> ElasticPair:
    """Return a pair with its bores, materials and plane state."""
    tables, bodies = _tables(scene, materials), blanks_of(scene, pair, materials)
    bores = [
        bore_of(blank, float(g.root_diameter)) for blank, g in zip(bodies, pair.gears, strict=True)
    ]
    moduli = [t.elastic_modulus.value if t.elastic_modulus else STEEL for t in tables]
    poissons = [float(t.poisson_ratio) if t.poisson_ratio is not None else POISSON for t in tables]
    plane = scene.sharing.plane or usual_plane(pair)
    return ElasticPair(
        pair, (bores[0], bores[1]), (moduli[0], moduli[1]), (poissons[0], poissons[1]), plane
    )


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


def _stiffnesses_by_iso(
    scene: Scene, pair: GearPair, elastic: ElasticPair, materials: Materials
) -> tuple[float, float]:
    """Return c' and c_gamma_alpha [MPa] of ISO 6336-1 at the torque of the duty."""
    line = line_load(scene, pair)
    blanks = blanks_of(scene, pair, materials)
    webs = tuple(blank.web(gear) for blank, gear in zip(blanks, pair.gears, strict=True))
    single = single_stiffness(pair, line, elastic.moduli, mean_blank_factor((webs[0], webs[1])))
    return float(single), float(mesh_stiffness(single, elastic.path.transverse_ratio)[0])


def _chosen(scene: Scene, made: PairMesh) -> Iterator[str]:
    """Yield why the model of the teeth is not the usual one, where the file names none."""
    asked = scene.sharing
    if asked.level is None and asked.error is None and made.level != USUAL:
        yield (
            f'The file names no level, and the bores are too small for "{USUAL}", whose body was '
            f"fitted to a root circle of up to {SAINSOT_BORE_RATIOS[1]:g} bores: teeth are "
            f'computed by "{made.level}", within 7 % of finite elements there.'
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


def _validity(made: PairMesh, coupling: str) -> Iterator[str]:
    """Yield what the models do not cover of these gears, and flaws that a designer may accept."""
    if LEVELS[made.level].body == "half plane" and coupling in ("ring torsion", "finite elements"):
        yield (
            f"{made.level} has no torsion of the rings, which the coupling by {coupling} has: "
            'stiffness and coupling are then of two different bodies. Write coupling = "none".'
        )
    sentences = doubts(made.elastic, made.level)
    yield from sentences
    thin = any("tips" in sentence for sentence in sentences)
    for flaw in flaws(made.elastic.pair):
        if flaw.name != "interference" and not (thin and flaw.name == "thin tip"):
            yield flaw.sentence
    ratio = float(made.elastic.path.transverse_ratio)
    whole = round(ratio)
    if whole > 1 and abs(ratio - whole) < NEAR_WHOLE:
        yield (
            f"The contact ratio of {ratio:.4f} is close to {whole}, at which the transmission "
            "error jumps with it: errors of the gears decide on which side it is."
        )
