"""The page of a Pareto front: to pick a design from, beside the one that a rule picks."""

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearopt.formulations.drive.design import drive_design
from gearopt.optimise.pareto.front import Front
from gearopt.optimise.pareto.tradeoff import RANDOM
from gearopt.report import front as front_words
from gearopt.report.answer import assumptions
from gearopt.report.drawing import layout_views, train_views
from gearopt.report.drawing.sheet import Drawing
from gearopt.report.front import rules, stages_of, words
from gearopt.report.measures import METRIC, Measures
from gearopt.report.pages import front_designs, front_plots
from gearopt.report.pages.frame import render
from gearopt.report.pages.front_designs import Numbers
from gearopt.report.pages.front_plots import Drawn, drawn
from gearopt.report.section import ROWS_ON_TERMINAL, Section, Tile
from gearopt.report.words import effort, sentence

MIN_LINES = 2  # designs at least, that are drawn as lines
MOST_ON_PAGE = 1000  # designs: a browser takes seconds for 15,000


def page(front: Front, html: str = "page.html", measures: Measures = METRIC) -> str:
    """One self-contained HTML page; html: where the command at its foot writes it."""
    data = front.to_dict()
    every = Front.from_dict(data)  # plain numbers, as a file of it has them
    front = _spread(every)
    each = [front_designs.numbers(p.design, measures) for p in front.points]
    sections = _lost(front, measures), _spent(front), assumptions(front, measures)
    return render(
        "front.html",
        front_words.title(front),
        measures.words(sentence(front_words.verdict(front)[0])),
        {"gearopt": front.gearopt, **front.versions},
        front_words.command(front, measures, html),
        front.asked,
        plots=bool(front.points),
        count=len(front.points),
        first=[_summary(front, every, measures), *_drawn(front, measures)],
        last=[section for section in sections if section],
        json=_link(data) if front is every else "",
        source=_source(front),
        rating=front_words.rating_command(front),
        **_picking(front, each, measures),
    )


def _spread(front: Front) -> Front:
    """The front itself, or of one of very many designs MOST_ON_PAGE, evenly, and the picks."""
    places = front_words.chosen(front, MOST_ON_PAGE)
    if len(places) == len(front.points):
        return front
    picked = tuple(replace(pick, place=places.index(pick.place)) for pick in front.picks)
    return replace(front, points=tuple(front.points[k] for k in places), picks=picked)


def tables(front: Front, measures: Measures = METRIC) -> dict[str, str]:
    """The CSV of every table by the name of its file, such as `front.csv`."""
    front = Front.from_dict(front.to_dict())  # plain numbers
    each = [front_designs.numbers(p.design, measures) for p in front.points]
    listed = [
        front_designs.designs(front, each, (), measures) if front.points else None,
        front_designs.beaten(front, measures),
        front_designs.impossible(front, measures),
        front_designs.growth(front),
    ]
    return {f"{table.stem}.csv": table.csv() for table in listed if table is not None}


def _picking(front: Front, each: Sequence[Numbers], measures: Measures) -> dict[str, Any]:
    """Plots and tables to pick a design from; none of a front without a design."""
    if not front.points:
        return {"table": None}
    drawn_front = drawn(front, measures)
    names = front_designs.main(front, each, measures)
    lines = len(front.points) >= MIN_LINES
    beaten = front_designs.beaten(front, measures)
    return {
        "trade": Section(
            "Trade-off", figures=_figures(drawn_front), tables=[beaten] if beaten else ()
        ),
        "parallel": front_plots.parallel(front, drawn_front, each, names) if lines else None,
        "table": front_designs.designs(front, each, names, measures),
        "kept": set(front_words.chosen(front, ROWS_ON_TERMINAL)),
        "told": front_designs.data(front, each, names, measures) | {"pair": _pair(front)},
    }


def _figures(front: Drawn) -> list[Any]:
    space = front_plots.space(front)
    return [*front_plots.pairs(front), *([space] if space else [])]


def _pair(front: Front) -> list[int]:
    """The places of the pick and of the design that is shown beside it at first."""
    picks = list(rules(front))
    ends = [k for k in (0, len(front.points) - 1) if k not in picks]
    return list(dict.fromkeys([*picks, *ends]))[:2]


def _summary(front: Front, every: Front, measures: Measures) -> Section:
    """Key figures, what was found and how sure it is, and the picks with their prices.

    every: the front with all its designs, of which the page shows those of the first.
    """
    count = len(every.points)
    tiles = [Tile("designs", f"{count:,}", front_words.verdict(front)[0])] if count else []
    for k, objective in enumerate(front.objectives if count else ()):
        low, high = front_words.ends(every, k, measures)
        tiles.append(Tile(words(front, objective.name), low, f"to {high}" if high != low else ""))
    lines = front_words.decided(every, measures)[bool(count) :]  # the tiles say the first
    if front is not every:
        lines.append(
            f"This page shows {len(front.points):,} of the designs, evenly spread and numbered "
            "anew; --csv and --json hold all."
        )
    if front.status == "infeasible" and front.file:
        lines.append(f"Which limits are in conflict: gearopt explain {front.file}.")
    limited = [
        f"{words(front, o.name)} at most {front_words.amount_of(front, k, o.most, measures)}"
        for k, o in enumerate(front.objectives)
        if o.most is not None
    ]
    if limited:
        lines.append(f"Asked for: {', '.join(limited)}.")
    shown = map(measures.words, [*lines, *front_words.picked(front, measures)])
    return Section("Result", tiles, list(shown))


def _drawn(front: Front, measures: Measures) -> list[Section]:
    """Drawings of the picks and the ends of the front, all at one scale."""
    names = {place: ", ".join(own) for place, own in rules(front).items()}
    for k, objective in enumerate(front.objectives if front.points else ()):
        values = [p.values[k] for p in front.points]
        names.setdefault(values.index(min(values)), f"least {words(front, objective.name)}")
    drawings = _views(front, names, measures)
    if not drawings:
        return []
    said = (
        "The picks and the ends of the front, along the shafts and at one scale; "
        f"dimensions in {measures.lengths}."
    )
    return [Section("Gears of the picks", words=(said,), drawings=drawings)]


def _views(front: Front, names: dict[int, str], measures: Measures) -> Sequence[Drawing]:
    """Views along the shafts of some designs, by their places; none without gears."""
    called = {f"Design {place + 1}, {name}": place for place, name in sorted(names.items())}
    designs = {name: front.points[place].design for name, place in called.items()}
    if designs and all(design.get("layout") for design in designs.values()):
        layouts = {name: drive_design(design).layout for name, design in designs.items()}
        return layout_views.beside({n: layout for n, layout in layouts.items() if layout}, measures)
    stages = {name: stages_of(design) for name, design in designs.items()}
    if not stages or not all(map(train_views.is_drawn, stages.values())):
        return ()
    return train_views.beside(stages, measures)


def _lost(front: Front, measures: Measures) -> Section | None:
    """The limits under which there is no design; None where every one had some."""
    table = front_designs.impossible(front, measures)
    if table is None:
        return None
    said = "Steps of the search that were skipped: no design is within all limits of a row."
    return Section("Limits without a design", words=(said,), tables=(table,))


def _spent(front: Front) -> Section:
    """Proof, effort, and growth of a front whose method has steps."""
    plot, table = front_plots.grown(front), front_designs.growth(front)
    seed = f", seed {front.seed}" if front.method in RANDOM else ""
    said = [effort(f"{front.method}{seed}", front.evaluations, front.seconds)]
    if plot is None and front.points:
        said.append("It finds the whole front in one pass, so that there is no growth to show.")
    figures, shown = ([plot] if plot else []), ([table] if table else [])
    return Section("How it was found", words=said, figures=figures, tables=shown)


def _link(data: Mapping[str, Any]) -> str:
    """A front as JSON, as an address that needs no network."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return "data:application/json;base64," + b64encode(text.encode()).decode()


def _source(front: Front) -> str | None:
    if front.file is None:
        return None
    return f"File {front.file}, SHA-256 {(front.file_sha256 or '')[:16]}…"
