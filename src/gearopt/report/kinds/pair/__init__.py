"""A spur pair: how its teeth share the load, how smoothly they run, and how well that is known."""

import math
from collections.abc import Sequence
from dataclasses import replace

from gearopt.formulations.pair.design import ContactLoad, PairContact, PairRelief
from gearopt.optimise.result import Result
from gearopt.optimise.typed import held
from gearopt.report.answer import asked, assumptions, limits, summary
from gearopt.report.design_tables import stage_label
from gearopt.report.drawing import mesh_view, train_views
from gearopt.report.exports import drawn, gears, listed, solids
from gearopt.report.kinds import Pages, drive
from gearopt.report.kinds.drive import rating_words
from gearopt.report.kinds.generic import AFTER_DESIGN, CLOSING, OPENING, REQUEST
from gearopt.report.kinds.pair import flank
from gearopt.report.kinds.pair import relief as pair_relief
from gearopt.report.kinds.pair.contact import (
    TABLES,
    in_space,
    moving,
    pair_of,
    points,
    teeth,
    travel,
)
from gearopt.report.kinds.pair.relief import relief_of
from gearopt.report.kinds.pair.words import answers, of_duty, off_in_mesh
from gearopt.report.measures import METRIC, Measures
from gearopt.report.section import Section, Table, Tile
from gearopt.report.words import amount, number, share

STIFFNESS = "N_per_mm_um"  # of MPa


def contact_of(result: Result) -> PairContact | None:
    """The contact that a design holds; None without one."""
    return held(PairContact, result.design, "contact")


def tiles(result: Result, measures: Measures) -> list[Tile]:
    """Load on a tooth, transmission error and stiffness as key figures."""
    if flanks := flank.flank_of(result):
        return [*flank.tiles(flanks, measures), *rating_words.tiles(result, measures)]
    if (pair_contact := contact_of(result)) is None:
        return []
    relief = relief_of(result)
    modified = pair_relief.tiles(relief, measures) if relief else []
    of_contact = _contact_tiles(pair_contact, of_duty(pair_contact.loads), measures, relief)
    return [*modified, *of_contact, *rating_words.tiles(result, measures)]


def _contact_tiles(
    pair_contact: PairContact, load: ContactLoad, measures: Measures, relief: PairRelief | None
) -> list[Tile]:
    """The figures of contact without relief; relief: that peak to peak is at its loads."""
    torque = f"at {share(load.load)} % of the duty's torque"
    part = f"{share(load.largest_share)} % of the normal force, {torque}"
    iso = amount(pair_contact.iso_mesh_stiffness_MPa, STIFFNESS, measures)
    off = off_in_mesh(pair_contact.in_mesh) if pair_contact.in_mesh else ""
    plain, at, height = " without relief" * bool(relief), torque, load.peak_to_peak_mm
    if relief:
        height, at = max(relief.rows[0].peak_to_peak_mm), pair_relief.at_loads(relief)
    return [
        Tile(
            f"largest load on a tooth{plain}",
            amount(load.largest_tooth_force_N, "N", measures),
            part,
        ),
        Tile(
            f"peak to peak{plain}" if relief else "transmission error, peak to peak",
            amount(height, "um", measures),
            f"{at}; {off}" if off else at,
        ),
        Tile(
            f"mean mesh stiffness{plain}",
            amount(load.mean_mesh_stiffness_MPa, STIFFNESS, measures),
            f"c_γα of ISO 6336-1: {iso}",
        ),
        Tile(
            "contact ratio",
            number(pair_contact.contact_ratio),
            "flanks removed by undercut are not counted",
        ),
    ]


def binding_limit(result: Result, measures: Measures = METRIC) -> str:
    """Largest load of one tooth and evenness of the pair, in words."""
    if relief := relief_of(result):
        return pair_relief.relief_words(relief, measures)
    flanks = flank.flank_of(result)
    if flanks and (result.value is None or any(flanks.relief_mm)):
        return _with_rating(result, flank.binding_words(flanks, measures), measures)
    if (pair_contact := contact_of(result)) is None or result.value is not None:
        return ""
    load = of_duty(pair_contact.loads)
    force = amount(load.largest_tooth_force_N, "N", measures)
    error = amount(load.peak_to_peak_mm, "um", measures)
    words = f"one tooth carries up to {force}; the transmission error varies by {error}"
    if pair_contact.in_mesh and load.peak_to_peak_mm:
        words += f" ({off_in_mesh(pair_contact.in_mesh)})"
    return _with_rating(result, words, measures)


def _with_rating(result: Result, words: str, measures: Measures) -> str:
    """Words on the contact, after those on the rating where there is one."""
    rated = rating_words.binding_limit(result, measures)
    return f"{rated}; {words}" if rated else words


def sentences_on_parts(result: Result, measures: Measures) -> list[str]:
    """Cost of whole teeth; nothing of a relief, whose part is the gears."""
    return [] if relief_of(result) else drive.sentences_on_parts(result, measures)


def warns(result: Result, measures: Measures = METRIC) -> Sequence[str]:
    """Unsafe gears by the rating, and cases that the models of contact do not cover."""
    pair_contact = contact_of(result) or flank.flank_of(result)
    warnings = rating_words.warns(result, measures)
    return [
        *warnings,
        *(s for s in (pair_contact.validity if pair_contact else ()) if s not in warnings),
    ]


def contact(result: Result, measures: Measures) -> Section | None:
    """Say how the load passes from tooth to tooth, with tables; None without contact."""
    if (pair_contact := contact_of(result)) is None:
        return None
    relieved = bool(result.design.get("relief"))
    tables = [points(pair_contact, measures, relieved)]
    tables += [table(pair_contact, measures) for table in TABLES]
    sentences = answers(pair_contact, pair_of(result), _frequency(result), relieved, measures)
    words = list(map(measures.words, sentences))
    tables = [replace(table, appendix=True) for table in tables]
    shown = [table for table in tables if not table.folded]
    return Section("Contact", words=words, tables=tables, terminal=("\n".join(words), *shown))


def _frequency(result: Result) -> float:
    """The mesh frequency [Hz]: reference circles pass a pitch of pi times the module."""
    stage = result.design["stages"][0]
    speed, module = stage["pitch_line_velocity_m_per_s"], stage["normal_module_mm"]
    return float(1e3 * speed / (math.pi * module))


def relief(result: Result, measures: Measures) -> Section | None:
    """Relief to grind, and its effect at every load; None without relief."""
    modified, pair_contact = relief_of(result), contact_of(result)
    if modified is None or pair_contact is None:
        return None
    tables = [
        pair_relief.grinding(modified, measures),
        pair_relief.after(pair_contact, modified, measures),
        pair_relief.rules(modified, measures),
        pair_relief.profile(pair_contact, modified, measures),
        travel(pair_contact, measures, modified.at, "transmission error with relief"),
    ]
    words = list(map(measures.words, pair_relief.answers(modified, measures)))
    shown = [table for table in tables if not table.folded]
    blocks: tuple[str | Table, ...] = ("\n".join(words), *shown)
    if (pair := pair_of(result)) is None:
        return Section("Relief", words=words, tables=tables, terminal=blocks)
    flanks = pair_relief.flanks(pair_contact, modified, pair)
    figures = [pair_relief.profile_plot(flank, measures) for flank in flanks]
    tables += [pair_relief.steps(flank, measures) for flank in flanks]
    return Section("Relief", words=words, figures=figures, tables=tables, terminal=blocks)


def mesh(result: Result, measures: Measures) -> Section | None:
    """Show the teeth in mesh; None without contact or whole teeth."""
    pair_contact, pair = contact_of(result), pair_of(result)
    if pair_contact is None or pair is None:
        return None
    return moving(pair_contact, relief_of(result), pair, measures)


def harmonics(result: Result, measures: Measures) -> Section | None:
    """Show the harmonics of the transmission error before and after; None without relief."""
    pair_contact, modified = contact_of(result), relief_of(result)
    if pair_contact is None or modified is None:
        return None
    return pair_relief.harmonics(pair_contact, modified, measures)


def numbers(result: Result, measures: Measures) -> Section | None:
    """The tables of the gears, as a drive of one stage has them, with the contact ratio."""
    gears = {k: v for k, v in result.design.items() if k not in ("contact", "relief", "flank")}
    section = drive.numbers(replace(result, design=gears), measures)
    if section is None:
        return None
    ratio = stage_label("transverse_contact_ratio", measures)
    shown = [
        replace(part, page_only=[head for head in part.page_only if head != ratio])
        if isinstance(part, Table)
        else part
        for part in section.terminal
    ]
    return replace(section, terminal=shown)


NO_RELIEF = "this pair has no relief to export; a table [relief] asks for one"
CONTACT = (relief, mesh, harmonics, contact, flank.section)
DRAWINGS = (teeth, in_space, train_views.section)
RATINGS = tuple(make for make in drive.RATINGS if make is not mesh_view.section)  # mesh is better
PAGES_OF_GIVEN = Pages(
    sections=(summary, *CONTACT, *DRAWINGS, *RATINGS, numbers, asked, assumptions),
    terminal=(
        *(numbers, contact, flank.section, relief),
        *drive.PAGES_OF_GIVEN.terminal,
        summary,
    ),
    tiles=tiles,
    binding_limit=binding_limit,
    warns=warns,
)
PAGES = Pages(
    sections=(
        *OPENING,
        *CONTACT,
        *DRAWINGS,
        numbers,
        *RATINGS,
        *REQUEST,
        *CLOSING,
    ),
    terminal=(
        *(numbers, limits, *drive.PAGES_OF_GIVEN.terminal),
        *(contact, flank.section, relief, *AFTER_DESIGN),
    ),
    tiles=tiles,
    binding_limit=binding_limit,
    sentences_on_parts=sentences_on_parts,
    warns=warns,
    whole="pair",
    exports={
        "dxf": drawn(teeth, also=gears),
        "step": solids,
        "csv": listed(relief, lacking=NO_RELIEF, ending="profile"),
    },
    pages_of_given=PAGES_OF_GIVEN,
)
